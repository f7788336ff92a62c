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


if __name__ == "__main__":
    unittest.main()
