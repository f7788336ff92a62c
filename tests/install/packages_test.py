#!/usr/bin/env python3
"""What the packages hold is what the build installs, and its pages, completion and desktop files are those that a system reads.

    packages_test.py --source SOURCE --build BUILD --cmake CMAKE --work FOLDER

Nothing is compiled: `cmake --install` puts each component of the build into FOLDER, as packaging/debian/rules does. Lintian, man, and
the validators of desktop files are asked where they are installed.
"""
import argparse
import fnmatch
import json
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

# Backends that packaging/debian/rules leaves out, as Debian would have them as packages of their own.
LEFT_OUT = {"usr/lib/pcmlab/libpcm_flann.so", "usr/lib/pcmlab/libpcm_pcl.so", "usr/lib/pcmlab/libpcm_step.so"}
# Which package has which component.
PACKAGES = {"command": "pcmlab", "modules": "pcmlab", "manual": "pcmlab", "mpi": "pcmlab-mpi", "meshlab": "meshlab-plugin-pcmlab", "library": "libpcmlab-dev",
            "python": "python3-pcmlab"}
ARGUMENTS = None


def run(*command, **more):
    result = subprocess.run([str(part) for part in command], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False, **more)
    assert result.returncode == 0, (command, result.stdout, result.stderr)
    return result.stdout


def without_triplet(path):
    """A package's libraries lie in a folder of the architecture, those of a build in /usr/local do not."""
    return re.sub(r"^usr/lib/([a-z0-9_]+-linux-gnu|\$\{DEB_HOST_MULTIARCH\})/", "usr/lib/", path)


def patterns_of(package):
    """(pattern, folder that it is moved to or None) of each line of an install list."""
    lines = (ARGUMENTS.source / "packaging" / "debian" / f"{package}.install").read_text().split("\n")
    return [(without_triplet(words[0]), words[1] if len(words) > 1 else None) for words in map(str.split, lines) if words]


def matches(path, pattern):
    return fnmatch.fnmatch(path, pattern) or path.startswith(pattern + "/")


def components_of(build):
    """The components that the build's install scripts name."""
    texts = [script.read_text() for script in build.rglob("cmake_install.cmake")]
    return set(re.findall(r'CMAKE_INSTALL_COMPONENT STREQUAL "(\w+)"', "\n".join(texts))) - {"Unspecified"}


def unpacked(lists, files):
    """What is wrong between install lists (package -> patterns) and files (path -> component): one line of text per fault."""
    faults = []
    for path, component in sorted(files.items()):
        owners = [package for package, patterns in lists.items() if any(matches(path, pattern) for pattern, _ in patterns)]
        if owners != [PACKAGES.get(component)]:
            faults.append(f"{path} of component {component} is in {owners or 'no package'}")
    here = {PACKAGES.get(component) for component in files.values()}
    for package, patterns in lists.items():
        for pattern, _ in patterns:
            manual = pattern.endswith("/manual") and "manual" not in files.values()  # where it was not made
            if package in here and not manual and not any(matches(path, pattern) for path in files):
                faults.append(f"{pattern} of {package} is not installed")
    return faults


class Packages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(ARGUMENTS.work, ignore_errors=True)
        cls.files = {}
        cls.components = components_of(ARGUMENTS.build)
        for component in sorted(cls.components):
            folder = ARGUMENTS.work / component
            run(ARGUMENTS.cmake, "--install", ARGUMENTS.build, "--prefix", folder / "usr", "--component", component)
            for path in folder.rglob("*"):
                if path.is_file():
                    cls.files[without_triplet(path.relative_to(folder).as_posix())] = component
        cls.share = ARGUMENTS.work / "command" / "usr" / "share"
        cls.pcmlab = ARGUMENTS.work / "command" / "usr" / "bin" / "pcmlab"
        cls.usage = json.loads(run(cls.pcmlab, "help", "--json"))["commands"]

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(ARGUMENTS.work, ignore_errors=True)

    def test_every_installed_file_is_in_one_package(self):
        control = (ARGUMENTS.source / "packaging" / "debian" / "control").read_text()
        packages = re.findall(r"^Package: (\S+)", control, re.MULTILINE)
        self.assertEqual(set(packages), set(PACKAGES.values()))
        lists = {package: patterns_of(package) for package in packages}
        files = {path: component for path, component in self.files.items() if path not in LEFT_OUT}
        self.assertEqual(unpacked(lists, files), [])
        rules = (ARGUMENTS.source / "packaging" / "debian" / "rules").read_text()
        named = set(re.findall(r"\w+", re.search(r"^components := (.*)$", rules, re.MULTILINE)[1]))
        self.assertLessEqual(self.components, named)
        for option, module in (("FLANN", "flann"), ("PCL", "pcl"), ("STEP", "step")):
            self.assertIn(f"usr/lib/pcmlab/libpcm_{module}.so", LEFT_OUT)
            self.assertIn(f"-DPCM_WITH_{option}=OFF", rules)

    def test_what_lists_and_files_do_not_share_is_found(self):
        lists = {"pcmlab": [("usr/bin/pcmlab", None), ("usr/share/man/man1", None)], "libpcmlab-dev": [("usr/lib/*.a", None)]}
        files = {"usr/bin/pcmlab": "command", "usr/share/man/man1/pcmlab.1": "command", "usr/lib/libpcm.a": "library"}
        self.assertEqual(unpacked(lists, files), [])
        self.assertEqual(unpacked(lists, dict(files, **{"usr/bin/other": "command"})),
                         ["usr/bin/other of component command is in no package"])
        self.assertEqual(unpacked(lists, dict(files, **{"usr/lib/x.a": "command"})),
                         ["usr/lib/x.a of component command is in ['libpcmlab-dev']"])
        del files["usr/bin/pcmlab"]
        self.assertEqual(unpacked(lists, files), ["usr/bin/pcmlab of pcmlab is not installed"])

    def test_every_command_has_a_page_that_man_lists(self):
        pages = {path.stem: path for path in (self.share / "man" / "man1").glob("*.1")}
        self.assertEqual(set(pages), {"pcmlab"} | {"pcmlab-" + command["name"] for command in self.usage})
        for name, page in pages.items():
            text = page.read_text()
            self.assertRegex(text, rf'(?m)^\.TH {re.escape(name).replace("-", "-")}'.replace(r"\-", r"\\-") + r" 1 .*\n\.SH NAME\n")
            if shutil.which("lexgrog"):  # what fills the table of whatis(1)
                self.assertRegex(run("lexgrog", page), rf'"{name} - \w')
            if shutil.which("groff"):
                result = subprocess.run(["groff", "-man", "-ww", "-z", "-Tutf8", page], capture_output=True, text=True, check=False)
                self.assertEqual((result.returncode, result.stderr), (0, ""), name)
        overview = pages["pcmlab"].read_text()
        for command in self.usage:
            self.assertIn(command["help"].split("<")[0][:20].replace("-", "\\-"), overview)

    def completed(self, *words):
        script = self.share / "bash-completion" / "completions" / "pcmlab"
        line = f'source "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _pcmlab; printf "%s\\n" "${{COMPREPLY[@]}}"'
        return set(run("bash", "-euc", line, script, *words).split())

    def test_bash_completes_commands_and_options(self):
        names = {command["name"] for command in self.usage}
        self.assertEqual(self.completed("pcmlab", ""), names | {"help", "manual"})
        self.assertEqual(self.completed("pcmlab", "bui"), {"build"})
        self.assertEqual(self.completed("pcmlab", "build", "--mem"), {"--memory"})
        self.assertEqual(self.completed("pcmlab", "help", "com"), {"compact"})
        self.assertEqual(self.completed("pcmlab", "build", "scan"), set())  # files, by bash itself
        self.assertEqual(self.completed("pcmlab", "outliers", "--method", ""), {"statistical", "robust", "radius"})

    def completed_by_zsh(self, *words):
        """What the script hands to zsh's own functions, of which there are stand-ins here, for the last word."""
        stubs = """_describe() { [[ $1 != -o ]] || shift; print -rl -- "${(@P)2}" }
compadd() { shift; print -rl -- "$@" }
_files() { print files }
words=("$@") CURRENT=$# PREFIX=${@[-1]}
source $script"""
        script = self.share / "zsh" / "site-functions" / "_pcmlab"
        return run("env", f"script={script}", "zsh", "-f", "-c", stubs, "zsh", *words).splitlines()

    @unittest.skipUnless(shutil.which("zsh"), "zsh is not here")
    def test_zsh_completes_commands_and_options_and_says_what_they_are(self):
        script = self.share / "zsh" / "site-functions" / "_pcmlab"
        self.assertTrue(script.read_text().startswith("#compdef pcmlab\n"))
        run("zsh", "-n", script)
        named = {line.split(":")[0] for line in self.completed_by_zsh("pcmlab", "")}
        self.assertEqual(named, {command["name"] for command in self.usage} | {"help", "manual"})
        self.assertIn("build:Build a point cloud tree from files", self.completed_by_zsh("pcmlab", ""))
        self.assertNotIn("manual:Open the manual", self.completed_by_zsh("pcmlab", "help", ""))
        for command in self.usage:
            options = [line.split(":")[0] for line in self.completed_by_zsh("pcmlab", command["name"], "--")]
            shown = run(self.pcmlab, "help", command["name"])
            self.assertGreater(len(options), 4, command["name"])
            for option in set(options) - {"--backend", "--flann"}:  # in the help where a backend is installed
                self.assertRegex(shown, re.escape(option) + r"[\s,]", command["name"])
        self.assertEqual(self.completed_by_zsh("pcmlab", "outliers", "--method", ""), ["statistical", "robust", "radius"])
        self.assertEqual(self.completed_by_zsh("pcmlab", "build", "scan"), ["files"])

    def test_desktop_files_are_valid(self):
        folder = ARGUMENTS.source / "packaging" / "desktop"
        types = set(re.findall(r'<mime-type type="([^"]+)"', (folder / "pcmlab.xml").read_text()))
        entry = (folder / "pcmlab-meshlab.desktop").read_text()
        self.assertEqual(set(re.search(r"^MimeType=(.*);$", entry, re.MULTILINE)[1].split(";")), types)
        self.assertEqual(len(types), 4)
        for tool, file in (("desktop-file-validate", "pcmlab-meshlab.desktop"), ("xmllint", "pcmlab.xml"),
                           ("xmllint", "pcmlab-meshlab.metainfo.xml")):
            if shutil.which(tool):
                run(tool, *(["--noout"] if tool == "xmllint" else []), folder / file)
        if shutil.which("appstreamcli"):
            found = subprocess.run(["appstreamcli", "validate", "--no-net", folder / "pcmlab-meshlab.metainfo.xml"],
                                   capture_output=True, text=True)
            # AppStream 1.0 wants a homepage, which the project has not.
            faults = [line for line in found.stdout.splitlines() if re.match("[EW]:", line) and "url-homepage-missing" not in line]
            self.assertEqual(faults, [], found.stdout)

    def test_the_changelog_has_the_version(self):
        version = re.search(r"^project\(pcm VERSION (\S+)", (ARGUMENTS.source / "CMakeLists.txt").read_text(), re.MULTILINE)[1]
        first = re.search(r"^## (\S+?),? ", (ARGUMENTS.source / "packaging" / "CHANGELOG.md").read_text(), re.MULTILINE)[1]
        self.assertEqual(first, version)
        self.assertIn(version, run(self.pcmlab, "--version"))

    def test_the_copyright_names_every_crate(self):
        lock = (ARGUMENTS.source / "core" / "decoders" / "Cargo.lock").read_text()
        crates = set(re.findall(r'^name = "(.+)"$', lock, re.MULTILINE)) - {"pcm_decoders"}
        text = (ARGUMENTS.source / "packaging" / "debian" / "copyright").read_text()
        self.assertEqual(set(re.findall(r"core/decoders/vendor/([\w-]+)-\*", text)), crates)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    for argument in ("source", "build", "cmake", "work"):
        parser.add_argument(f"--{argument}", type=pathlib.Path, required=True)
    ARGUMENTS = parser.parse_args()
    unittest.main(argv=sys.argv[:1], verbosity=2)
