"""packaging/run refuses what cannot work at once: before it installs or builds anything."""

import os
import pathlib
import subprocess
import tempfile
import unittest

RUN = pathlib.Path(os.environ["PCM_SOURCE_DIR"]) / "packaging" / "run"


class Inputs(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        (self.folder / "scan.las").write_bytes(b"LASF" + bytes(400))
        (self.folder / "scan.dat").write_bytes(b"LASF" + bytes(400))
        (self.folder / "points of today").write_text("1 2 3\n4 5 6\n")
        (self.folder / "empty.las").touch()
        (self.folder / "picture.jpg").write_bytes(b"\xff\xd8\xff\xe0\x00\x10JFIF")
        (self.folder / "nothing").mkdir()
        (self.folder / "hidden").mkdir()
        (self.folder / "hidden" / ".scan.las").touch()
        os.mkfifo(self.folder / "pipe.las")

    def refusal(self, *arguments):
        # A program that it would start first is not there: it would fail with another message.
        result = subprocess.run([RUN, *arguments], cwd=self.folder, stdin=subprocess.DEVNULL, capture_output=True,
                                text=True, timeout=60, env=dict(os.environ, CI="true"))
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        self.assertNotIn("==", result.stdout)
        return result.stderr

    def test_inputs(self):
        good = ["scan.las", "scan.dat", "points of today"]
        for bad, message in (("none.las", "no such file"), ("empty.las", "the file is empty"),
                             ("picture.jpg", "not a point cloud"), ("nothing", "no file in this folder"),
                             ("hidden", "no file in this folder"), ("pipe.las", "neither a file nor a folder")):
            with self.subTest(bad):
                self.assertIn(f"{bad}: ", self.refusal(*good, bad))
                self.assertIn(message, self.refusal(*good, bad))
        self.assertIn("las laz", self.refusal("picture.jpg"))

    def test_the_picture(self):
        for name, message in (("shot.jpg", ".png"), ("nothing", ".png"), ("scan.las/shot.png", "cannot be written")):
            with self.subTest(name):
                self.assertIn(message, self.refusal("--screenshot", name, "scan.las"))
        (self.folder / "folder.png").mkdir()
        self.assertIn("this is a folder", self.refusal("--screenshot", "folder.png", "scan.las"))
        self.assertIn("needs the path", self.refusal("--screenshot"))


# A system as its package manager describes it, in place of the real one. apt-get writes down what it is called with.
PROGRAMS = {
    "apt-get": """echo "$*" >>"$SYSTEM/calls"; case "$*" in *update*) touch "$SYSTEM/updated" ;; esac""",
    "apt-cache": """[ -f "$SYSTEM/updated" ] || exit 0
                    echo "$2:"
                    case "$2" in meshlab) echo "  Candidate: $MESHLAB" ;; cargo-web) echo "  Candidate: (none)" ;;
                                 *) echo "  Candidate: 1" ;; esac""",
    "dpkg-query": "exit 1",
    "sudo": """[ "$1" != -n ] || shift; [ "$1" = true ] || exec "$@" """,
}


class Systems(unittest.TestCase):
    """What is installed on a system, and when it is not even begun."""

    def call(self, version, *command):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            for name, text in PROGRAMS.items():
                (folder / name).write_text(f"#!/bin/bash\n{text}\n")
                (folder / name).chmod(0o755)
            environment = dict(os.environ, CI="true", SYSTEM=str(folder), MESHLAB=version,
                               PATH=f"{folder}:{os.environ['PATH']}")
            result = subprocess.run([RUN.parent / command[0], *command[1:]], stdin=subprocess.DEVNULL, capture_output=True,
                                    text=True, timeout=60, env=environment)
            calls = (folder / "calls").read_text() if (folder / "calls").exists() else ""
            return result, [line for line in calls.splitlines() if " install " in line]

    def test_another_meshlab_is_said_before_anything_is_installed(self):
        for version, named in (("2023.12+dfsg2-1", "2023.12"), ("(none)", "this system has none")):
            for command, code in ((("install-dependencies", "run"), 3), (("install-dependencies", "test"), 3),
                                  (("run",), 1), (("test",), 1)):
                with self.subTest(version=version, command=command):
                    result, installs = self.call(version, *command)
                    self.assertEqual(result.returncode, code, result.stdout + result.stderr)
                    self.assertEqual(installs, [])
                    self.assertIn(named, result.stderr)
                    self.assertIn("--without-meshlab", result.stderr)

    def test_the_right_ones_are_installed(self):
        for version in ("2020.09+dfsg1-2", "2022.02+dfsg1-1"):
            result, installs = self.call(version, "install-dependencies", "run")
            self.assertEqual((result.returncode, len(installs)), (0, 1), result.stderr)
            for package in (" meshlab ", " qtbase5-dev ", " cargo"):
                self.assertIn(package, installs[0] + " ")

    def test_without_meshlab(self):
        result, installs = self.call("2023.12+dfsg2-1", "install-dependencies", "run", "--without-meshlab")
        self.assertEqual((result.returncode, len(installs)), (0, 1), result.stderr)
        words = installs[0].split()
        self.assertIn("cargo", words)  # there is no cargo-web on that system
        self.assertNotIn("cargo-web", words)
        for name in ("meshlab", "qtbase5-dev", "xvfb", "xz-utils"):
            self.assertNotIn(name, words)


if __name__ == "__main__":
    unittest.main()
