"""What the one build command of the README builds is all that `cmake --install` takes: an install after it is whole.

    built_test.py BUILD_FOLDER

Compares the files that the install scripts name with what the build's own graph says the target makes. Exit code 77: the build
is not one of Ninja.
"""

import pathlib
import re
import subprocess
import sys

TARGET = "what_is_installed"
OF_THEIR_OWN = {"manual"}  # targets that take minutes; what they make is installed where it was made


def ninja(build, *arguments):
    return subprocess.run(["ninja", "-C", build, "-t", *arguments], check=True, capture_output=True, text=True).stdout


def main():
    build = pathlib.Path(sys.argv[1]).resolve()
    if not (build / "build.ninja").is_file():
        print("not a build of Ninja: not tried")
        return 77
    made = {line.split(": ")[0] for line in ninja(build, "targets", "all").splitlines()}
    needed = set(re.findall(r" (?:-o|qc) (\S+)", ninja(build, "commands", TARGET)))  # linked, or put into an archive
    installed = set()
    for script in build.rglob("cmake_install.cmake"):
        for files in re.findall(r'\bFILES((?: "[^"]+")+)', script.read_text(encoding="utf-8")):
            for path in map(pathlib.Path, re.findall(r'"([^"]+)"', files)):
                if build in path.parents and str(path.relative_to(build)) in made:
                    installed.add(str(path.relative_to(build)))
    missing = sorted(installed - needed - OF_THEIR_OWN)
    for path in missing:
        print(f"{path} is installed, and the target {TARGET} does not make it (CMakeLists.txt)")
    print(f"{len(installed)} built files are installed: {' '.join(sorted(installed))}")
    if not any("pcmlab" in path for path in installed):
        print("the command is not among them: the install scripts were not understood")
        return 1
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
