"""The commands of README.md work as they stand there, one after the other, and those that select points select some."""

import csv
import json
import math
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ["PCM_SOURCE_DIR"])
PROGRAMS = pathlib.Path(os.environ["PCM_BUILD_DIR"]) / "bin"

# What the README speaks of and no command of it makes.
TOUR = {"format": "pcm camera path", "version": 1, "coordinates": "source", "frames": [
    {"eye": [500030, 4799960, 150], "target": [500030, 4800030, 100], "angle": 45},
    {"eye": [500030, 4800030, 400], "target": [500030, 4800030, 100], "up": [0, 1, 0], "height": 100}]}


def commands(text):
    """Lines of the shell blocks that run pcmlab."""
    blocks = re.findall(r"^```sh\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    return [line for block in blocks for line in block.splitlines() if re.search(r"(^|; do )pcmlab ", line)]


def without_points(output):
    """Whether an output is that of a command that selected nothing."""
    counts = [int(number.replace(",", "")) for number in re.findall(r"([\d,]+) points", output)]
    return "no point is selected" in output or "the cloud's points lie" in output or (bool(counts) and counts[0] == 0)


class Readme(unittest.TestCase):
    def run_in(self, folder, line):
        environment = dict(os.environ, PATH=f"{PROGRAMS}:{os.environ['PATH']}")
        return subprocess.run(["bash", "-euc", line], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                              capture_output=True, text=True)

    def test_every_command_works_and_selects_points(self):
        lines = commands((SOURCE / "README.md").read_text(encoding="utf-8"))
        named = {word for line in lines for word in re.findall(r"pcmlab (\w+)", line)}
        help_text = self.run_in(".", "pcmlab help").stdout
        listed = set(re.findall(r"^  ([a-z]+)  ", help_text, re.MULTILINE))
        self.assertEqual(listed - named, set(), "commands that the README does not show")
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "tour.json").write_text(json.dumps(TOUR))
            for line in lines:
                with self.subTest(line):
                    result = self.run_in(folder, line)
                    self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
                    self.assertFalse(without_points(result.stdout), result.stdout)
            self.assertTrue((pathlib.Path(folder) / "tour0002.png").is_file())
            self.check_tutorial(pathlib.Path(folder))

    def test_the_lines_of_python_work(self):
        module = pathlib.Path(os.environ["PCM_BUILD_DIR"]) / "python"
        if not module.is_dir():
            self.skipTest("the Python module is not built")
        blocks = re.findall(r"^```python\n(.*?)^```", (SOURCE / "README.md").read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
        self.assertTrue(blocks)
        pythons = [python for python in ("python3", os.environ.get("PCM_TEST_PYTHON", "")) if python and subprocess.run(
            [python, "-c", "import numpy"], stderr=subprocess.DEVNULL, check=False).returncode == 0]
        if not pythons:
            self.skipTest("no Python here has numpy")
        with tempfile.TemporaryDirectory() as folder:
            for i in (1, 2):
                self.run_in(folder, f"pcmlab generate --points 100000 --seed {i} scan{i}.las")
            for block in blocks:
                result = subprocess.run([pythons[0], "-c", block], cwd=folder, env=dict(os.environ, PYTHONPATH=str(module)),
                                        capture_output=True, text=True, check=False)
                self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
                self.assertRegex(result.stdout, r"(?s)^[1-9]\d* 9\d\.\d+ uint16.*Remove or label points")

    def check_tutorial(self, folder):
        """What the way from a scan to a drawing ends with is what was generated, within four standard deviations."""
        truth = json.loads((folder / "plant.truth.json").read_text(encoding="utf-8"))["primitives"]
        with open(folder / "plant.csv", newline="", encoding="utf-8") as file:
            rows = {row["name"]: row for row in csv.DictReader(file)}
        self.assertEqual(list(rows), ["Tank", "Roof", "Pipe", "Dome"])
        for name, kind in (("Tank", "cylinder"), ("Roof", "plane"), ("Pipe", "cylinder"), ("Dome", "sphere")):
            row = rows[name]
            self.assertEqual((row["kind"], row["verdict"]), (kind, "good"), name)
            place = [float(row[f"{axis} [m]"]) for axis in "xyz"]
            if kind == "plane":
                found = min((one for one in truth if one["kind"] == kind), key=lambda one: math.dist(place, one["point"]))
                off = sum(n * (a - b) for n, a, b in zip(found["direction"], place, found["point"]))
                self.assertLess(abs(off), 4 * float(row["sigma_position [m]"]), name)
                continue
            found = min((one for one in truth if one["kind"] == kind),
                        key=lambda one: abs(one["radius"] - float(row["radius [m]"])))
            self.assertLess(abs(found["radius"] - float(row["radius [m]"])), 4 * float(row["sigma_radius [m]"]), name)
        drawing = (folder / "plant.dxf").read_text(encoding="utf-8")
        script = (folder / "plant.scr").read_text(encoding="utf-8")
        for name in rows:
            self.assertIn(f"\n  8\n{name}\n", drawing)
            self.assertIn(f"; {name}\n", script)
        self.assertEqual((script.count("_.CYLINDER"), script.count("_.SPHERE")), (2, 1))

    def test_a_command_that_selects_nothing_is_noticed(self):
        with tempfile.TemporaryDirectory() as folder:
            self.run_in(folder, "pcmlab generate --points 5000 scan.las && pcmlab build scan.las -o site.pct")
            for command in ("query site.pct", "delete --count site.pct", "set site.pct intensity=1"):
                for region, nothing in (("--sphere 0 0 0 1", True), ("--sphere 500000 4800000 100 1e4", False)):
                    result = self.run_in(folder, f"pcmlab {command} {region}")
                    self.assertEqual(result.returncode, 0, result.stderr)
                    self.assertEqual(without_points(result.stdout), nothing, result.stdout)


if __name__ == "__main__":
    unittest.main()
