"""Breaks the core on purpose, one line at a time, and counts the faults that the unit tests notice. packaging/mutate runs it.

The faults are made in a copy of the sources with a build folder of its own. For each, the tests of the room are built and run;
then, if they pass, the tests of the rooms that stand on it.
"""

import argparse
import os
import pathlib
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time

import operators

LEFT_OUT = ("core/examples/", "core/decoders/", "core/cli/", "core/offscreen/")
SLOW = "*KilledAtAnyCall*:*Kill*"  # tests that are left out
MEMORY = 12 << 30  # address space of a test program: a fault may ask for any amount


def sources(root):
    """Path -> lines of every source of the core that has tests of its own and is built: without PCL, not what needs it."""
    listed = subprocess.run(["git", "-C", root, "ls-files", "core"], capture_output=True, text=True, check=True).stdout.split()
    left_out = LEFT_OUT if (root / "build" / "pcl-sdk").is_dir() else (*LEFT_OUT, "core/fit/pcl/")
    return {name: (root / name).read_text(encoding="utf-8").split("\n")
            for name in listed if name.endswith((".cpp", ".h")) and not name.startswith(left_out)}


def all_faults(files):
    """Every fault that could be made: (file, index of the line, what, the faulty line)."""
    return [(name, i, what, faulty) for name, lines in sorted(files.items()) for i, line in enumerate(lines)
            for what, faulty in operators.faults_of(line)]


def choose(faults, count, seed):
    """A sample without two faults in one line, spread evenly over the files' lines; the same for the same seed."""
    lines = {}
    for fault in faults:
        lines.setdefault(fault[:2], []).append(fault)
    chance = random.Random(seed)
    chosen = chance.sample(sorted(lines), min(count, len(lines)))
    return [chance.choice(lines[line]) for line in chosen]


def arrows(text):
    """Room -> rooms that it uses, from the list in core/README.md."""
    block = re.search(r"^```arrows\n(.*?)^```", text, re.MULTILINE | re.DOTALL)[1]
    return {room.strip(): used.split() for room, used in (line.split(":") for line in block.splitlines() if ":" in line)}


def test_of(room):
    return "test_" + {"point_cloud": "query", "make_cloud": "query"}.get(room, room.split("/")[0])


def tests_for(name, rooms, programs):
    """The test programs to run for a fault in a file: those of its room, then those of the rooms that stand on it."""
    room = max((room for room in rooms if name.startswith((f"core/{room}/", f"core/{room}."))), key=len, default="")
    above, grown = {room}, True
    while grown:
        more = {user for user, used in rooms.items() if above & set(used)} | above
        grown, above = len(more) > len(above), more
    first = [test_of(room)] if test_of(room) in programs else []
    return first, sorted({test_of(user) for user in above} & set(programs) - set(first))


def suites_near(name, folder):
    """A filter of GoogleTest: the suites in those sources of a room's tests that include the header of a faulty file, or are
    named like it. They are the likeliest to notice a fault. Empty where there are none."""
    path = pathlib.Path(name).with_suffix("")
    header = f'"pcm/{path.relative_to("core")}.h"'
    suites = set()
    for source in sorted(folder.rglob("*.cpp")):
        text = source.read_text(encoding="utf-8")
        if header in text or source.stem == path.name + "_test":
            suites |= set(re.findall(r"^(?:TYPED_)?TEST(?:_[FP])?\((\w+),", text, re.MULTILINE))
    return ":".join(f"{suite}.*:*/{suite}.*:{suite}/*" for suite in sorted(suites))


class Copy:
    """The sources and their build, in a folder that is kept from run to run."""

    def __init__(self, root, folder, jobs):
        # Laid out like a clone, so that the compiler cache has the objects of release.
        self.source, self.build, self.jobs = folder / "source", folder / "source" / "build" / "release", jobs
        listed = subprocess.run(["git", "-C", root, "ls-files", "-z"], capture_output=True, check=True).stdout
        for name in filter(None, listed.decode().split("\0")):
            old, new = root / name, self.source / name
            if old.is_file() and not (new.is_file() and new.read_bytes() == old.read_bytes()):
                new.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(old, new)
        options = ["-DPCM_WITH_MESHLAB=OFF", "-DPCM_BUILD_BENCHMARKS=OFF", f"-DPCM_DECODERS_FOLDER={folder / 'decoders'}",
                   f"-DPCM_PCL_SDK={root / 'build' / 'pcl-sdk'}",
                   f"-DPCM_TEST_DATA={root.parent / 'shared' / 'data'}", "-DCMAKE_BUILD_TYPE=RelWithDebInfo",
                   "-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O2 -g1 -DNDEBUG"]  # as in release, whose objects the compiler cache has
        subprocess.run(["cmake", "-G", "Ninja", "-S", self.source, "-B", self.build, *options], check=True,
                       stdout=subprocess.DEVNULL)

    def make(self, targets):
        done = subprocess.run(["ninja", "-C", self.build, f"-j{self.jobs}", *targets], capture_output=True, text=True)
        return done.returncode == 0

    def run(self, program, limit, only="", less=""):
        """None where the program's tests pass in `limit` seconds, else the first that does not. `only`, `less`: filters."""
        def restrict():
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        with tempfile.TemporaryDirectory(dir=self.build) as folder:
            environment = dict(os.environ, TMPDIR=folder, GTEST_FAIL_FAST="1")
            log = pathlib.Path(folder) / "log"
            with open(log, "wb") as out:
                try:
                    left_out = SLOW + ":" + less if less else SLOW
                    done = subprocess.run([self.build / "bin" / program, f"--gtest_filter={only}-{left_out}"], cwd=folder,
                                          env=environment, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.DEVNULL,
                                          timeout=limit, preexec_fn=restrict)
                    if done.returncode == 0:
                        return None
                except subprocess.TimeoutExpired:
                    pass
            text = log.read_text(encoding="utf-8", errors="replace")
            failed = re.findall(r"^\[  FAILED  \] ([^\s,]+)", text, re.MULTILINE)
            begun = re.findall(r"^\[ RUN      \] (\S+)", text, re.MULTILINE)  # the last one: a crash, or time ran out
            return " ".join([program, *(failed[:1] or begun[-1:])])


def with_fault(text, index, faulty):
    """The text with the faulty line. Subscripts of the standard library are checked in it: tests under the address sanitizer,
    which are not run here, would notice those out of range."""
    lines = text.split("\n")
    lines[index] = faulty
    return "\n".join(["#define _GLIBCXX_ASSERTIONS 1", "#line 1", *lines])


def noticed_by(copy, tests, limits, near):
    """The first test of the programs that notices a fault, the near suites before the others of their room."""
    for program in tests:
        found = near and copy.run(program, limits[program], only=near)
        found = found or copy.run(program, limits[program], less=near)
        if found:
            return found
    return None


def verdict(copy, rooms, programs, limits, fault):
    """caught, missed, or None for a fault that the compiler refuses; and the test that noticed it."""
    name, index, _, faulty = fault
    path = copy.source / name
    good = path.read_text(encoding="utf-8")
    path.write_text(with_fault(good, index, faulty), encoding="utf-8")
    try:
        first, others = tests_for(name, rooms, programs)
        near = suites_near(name, copy.source / "tests" / first[0].removeprefix("test_")) if first else ""
        for tests, suites in ((first, near), (others, "")):
            if tests and not copy.make(tests):
                return None, None
            found = noticed_by(copy, tests, limits, suites)
            if found:
                return "caught", found
        return "missed", None
    finally:
        path.write_text(good, encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--root", type=pathlib.Path, required=True)
    parser.add_argument("--folder", type=pathlib.Path, required=True)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--faults", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("paths", nargs="*", help="only in files whose path below core/ begins like this")
    arguments = parser.parse_args()
    files = sources(arguments.root)
    if arguments.paths:
        wanted = tuple(f"core/{path.removeprefix('core/')}" for path in arguments.paths)
        files = {name: lines for name, lines in files.items() if name.startswith(wanted)}
    faults = choose(all_faults(files), arguments.faults, arguments.seed)
    if not faults:
        sys.exit("there is no line to break in: " + " ".join(arguments.paths))
    rooms = arrows((arguments.root / "core" / "README.md").read_text(encoding="utf-8"))
    print("Building the tests", flush=True)
    copy = Copy(arguments.root, arguments.folder, arguments.jobs)
    if not copy.make(["unit_tests"]):
        sys.exit(f"the tests do not build: ninja -C {copy.build}")
    programs = sorted(path.name for path in (copy.build / "bin").glob("test_*"))
    limits = {}
    for program in programs:
        started = time.monotonic()
        if copy.run(program, 600):
            sys.exit(f"{program} fails without a fault: {copy.build / 'bin' / program}")
        limits[program] = 20 + 5 * (time.monotonic() - started)
    counts = {"caught": 0, "missed": 0, None: 0}
    for number, fault in enumerate(faults, 1):
        found, test = verdict(copy, rooms, programs, limits, fault)
        counts[found] += 1
        print(f"{number}/{len(faults)} {found or 'does not compile'}{' by ' + test if test else ''}: "
              f"{fault[0]}:{fault[1] + 1}: {fault[2]}", flush=True)
    judged = counts["caught"] + counts["missed"]
    print(f"{counts['caught']} of {judged} faults were noticed ({100 * counts['caught'] / max(1, judged):.0f} %); "
          f"{counts[None]} more did not compile")


if __name__ == "__main__":
    main()
