"""README.md and the manual: their commands, programs and links work as they stand there, and are all there is to know."""

import csv
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ["PCM_SOURCE_DIR"])
PROGRAMS = pathlib.Path(os.environ["PCM_BUILD_DIR"]) / "bin"
MANUAL = SOURCE / "packaging" / "manual"
PAGES = MANUAL / "pages"

sys.path.append(str(MANUAL))
try:
    import build as manual
except ImportError:  # python3-markdown
    manual = None


def text_of(path):
    return path.read_text(encoding="utf-8")


def commands(text):
    """Lines of the shell blocks that run pcmlab."""
    blocks = re.findall(r"^```sh\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    return [line for block in blocks for line in block.splitlines() if re.search(r"(^|; do )pcmlab ", line)]


def python_blocks(text):
    return re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


def run_in(folder, line):
    environment = dict(os.environ, PATH=f"{PROGRAMS}:{os.environ['PATH']}")
    return subprocess.run(["bash", "-euc", line], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                          capture_output=True, text=True, check=False)


def python_with_numpy():
    pythons = [python for python in ("python3", os.environ.get("PCM_TEST_PYTHON", "")) if python and subprocess.run(
        [python, "-c", "import numpy"], stderr=subprocess.DEVNULL, check=False).returncode == 0]
    return pythons[0] if pythons else None


class Python(unittest.TestCase):
    """The programs in Python of a text, one after the other, in a folder."""

    def run_blocks(self, text, folder):
        module = pathlib.Path(os.environ["PCM_BUILD_DIR"]) / "python"
        python = python_with_numpy()
        if not module.is_dir() or not python:
            self.skipTest("the Python module is not built, or no Python here has numpy")
        blocks = python_blocks(text)
        self.assertTrue(blocks)
        printed = ""
        for block in blocks:
            result = subprocess.run([python, "-c", block], cwd=folder, env=dict(os.environ, PYTHONPATH=str(module)),
                                    capture_output=True, text=True, check=False)
            self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
            printed += result.stdout
        return printed


class Readme(Python):
    def test_it_is_read_in_two_minutes(self):
        self.assertLessEqual(len(text_of(SOURCE / "README.md").splitlines()), 150)

    def test_every_command_works(self):
        text = text_of(SOURCE / "README.md")
        lines = commands(text)
        self.assertGreaterEqual(len(lines), 6)
        with tempfile.TemporaryDirectory() as folder:
            for line in lines:
                with self.subTest(line):
                    result = run_in(folder, line)
                    self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
            self.assertTrue((pathlib.Path(folder) / "site.png").is_file())
            self.assertTrue((pathlib.Path(folder) / "shapes.dxf").is_file())
            self.assertRegex(self.run_blocks(text, folder), r"(?s)^\[5\.000\d+e\+05 .*uint16.*\bgood\b")

    def test_the_manual_is_found_or_its_absence_explained(self):
        with tempfile.TemporaryDirectory() as folder:
            program = pathlib.Path(folder) / "bin" / "pcmlab"
            program.parent.mkdir()
            program.write_bytes((PROGRAMS / "pcmlab").read_bytes())
            program.chmod(0o755)
            environment = {name: value for name, value in os.environ.items() if "DISPLAY" not in name}
            ask = lambda: subprocess.run([program, "manual"], env=environment, capture_output=True, text=True, check=False)
            missing = ask()
            self.assertEqual((missing.returncode, missing.stdout), (1, ""))
            self.assertIn("--target manual", missing.stderr)
            page = pathlib.Path(folder) / "share" / "doc" / "pcmlab" / "manual" / "index.html"
            page.parent.mkdir(parents=True)
            page.write_text("<html>")
            found = ask()
            self.assertEqual((found.returncode, pathlib.Path(found.stdout.strip()).resolve()), (0, page.resolve()))


@unittest.skipUnless(manual, "python3-markdown is not installed")
class Manual(Python):
    def test_its_commands_work_and_its_pages_are_whole(self):
        with tempfile.TemporaryDirectory() as folder:
            out, kept = pathlib.Path(folder) / "manual", pathlib.Path(folder) / "kept"
            manual.build(PROGRAMS, out, kept, "200x120")  # a command that fails or selects nothing is a Failure
            for page in out.glob("*.html"):
                text = text_of(page)
                self.assertNotRegex(text, r"```|\]\(|\.md\b(?!</code>)", page.name)
                for target in re.findall(r'(?:href|src)="([^":]+)"', text):
                    self.assertTrue((out / target).is_file(), f"{page.name}: {target}")
            self.assertTrue((out / "operation-build.html").is_file())
            self.assertIn("at least 1; at most 1024", text_of(out / "operation-outliers.html"))
            self.assertTrue((kept / "tile" / "tour0002.png").is_file())
            self.check_drawing(kept / "drawing")
            self.check_facade(kept / "facade")
            self.assertIn("Remove or label points", self.run_blocks(text_of(PAGES / "python.md"), kept / "python"))
            cells = "".join(python_blocks(text_of(PAGES / "notebook.md"))).replace("\ncloud\n", "\nprint(cloud._repr_html_())\n")
            shown = self.run_blocks(f"```python\n{cells}```\n", kept / "notebook")
            self.assertRegex(shown, r"(?s)^<img src=.*100,000 points.* m +\d+ #.*Cylinder: good.*\(400, 640, 3\) uint8")

    def test_every_operation_is_shown(self):
        shown = " ".join(text_of(page) for page in PAGES.glob("*.md"))
        named = {word for line in commands(shown) for word in re.findall(r"pcmlab (\w+)", line)}
        listed = set(re.findall(r"^  ([a-z]+)  ", run_in(".", "pcmlab help").stdout, re.MULTILINE))
        self.assertGreater(len(listed), 20)
        self.assertEqual(listed - named, set())

    def test_messages_are_those_of_the_programs(self):
        sources = [path for folder in ("core", "plugin", "packaging") for path in (SOURCE / folder).rglob("*")
                   if path.is_file() and (path.suffix in (".cpp", ".h", ".py") or path.parent.name == "packaging") and path.suffix != ".png"]
        # Literals in several pieces are one text.
        texts = re.sub(r'"\s*\n\s*"', "", "\n".join(text_of(path) for path in sources)) + os.strerror(28)
        messages = re.findall(r"^\| `([^`]+)` \|", text_of(PAGES / "messages.md"), re.MULTILINE)
        self.assertGreater(len(messages), 10)
        for message in messages:
            self.assertIn(message, texts)

    def check_drawing(self, folder):
        """What the way from a scan to a drawing ends with is what was generated, within four standard deviations."""
        truth = json.loads(text_of(folder / "plant.truth.json"))["primitives"]
        with open(folder / "plant.csv", newline="", encoding="utf-8") as file:
            rows = {row["name"]: row for row in csv.DictReader(file)}
        self.assertEqual(list(rows), ["Tank", "Roof", "Pipe", "Dome"])
        for name, kind in (("Tank", "cylinder"), ("Roof", "plane"), ("Pipe", "cylinder"), ("Dome", "sphere")):
            row = rows[name]
            self.assertEqual((row["kind"], row["verdict"]), (kind, "good"), name)
            self.assertLess(float(row["sigma_position [m]"]), 0.002, name)
            place = [float(row[f"{axis} [m]"]) for axis in "xyz"]
            if kind == "plane":
                found = min((one for one in truth if one["kind"] == kind), key=lambda one: math.dist(place, one["point"]))
                off = sum(n * (a - b) for n, a, b in zip(found["direction"], place, found["point"]))
                self.assertLess(abs(off), 4 * float(row["sigma_position [m]"]), name)
                continue
            found = min((one for one in truth if one["kind"] == kind),
                        key=lambda one: abs(one["radius"] - float(row["radius [m]"])))
            self.assertLess(abs(found["radius"] - float(row["radius [m]"])), 4 * float(row["sigma_radius [m]"]), name)
        drawing, script = text_of(folder / "plant.dxf"), text_of(folder / "plant.scr")
        for name in rows:
            self.assertIn(f"\n  8\n{name}\n", drawing)
            self.assertIn(f"; {name}\n", script)
        self.assertEqual((script.count("_.CYLINDER"), script.count("_.SPHERE")), (2, 1))

    def check_facade(self, folder):
        """The wall and the width of the house are those that were generated."""
        walls = [one for one in json.loads(text_of(folder / "town.truth.json"))["primitives"] if one["id"] in (1, 2, 4)]
        gap = [a - b for a, b in zip(walls[0]["point"], walls[1]["point"])]
        width = abs(sum(a * b for a, b in zip(gap, walls[0]["direction"])))
        measures = {one["name"]: one for one in json.loads(text_of(folder / "facade-measures.json"))["measures"]}
        self.assertEqual(list(measures), ["Width", "Ridge", "Window"])
        ends = [point["position"] for point in measures["Width"]["points"]]
        self.assertAlmostEqual(math.dist(*ends), width, delta=0.06)  # the nearest points lie up to 4 cm from the corners
        south = json.loads(text_of(folder / "facade.json"))["primitives"][0]
        off = sum(n * (a - b) for n, a, b in zip(walls[2]["direction"], south["point"], walls[2]["point"]))
        self.assertLess(abs(off), 0.001)

    def test_faults_of_a_page_are_noticed(self):
        with tempfile.TemporaryDirectory() as folder:
            for line in ("pcmlab build none.las", "pcmlab generate -q --points 5000 scan.las; pcmlab build -q scan.las -o site.pct; pcmlab query site.pct --sphere 0 0 0 1"):
                with self.assertRaises(manual.Failure):
                    manual.run_page("page", f"# Page\n\n```sh\n{line}\n```\n", PROGRAMS, folder)
            manual.run_page("page", "# Page\n\n```sh\npcmlab query site.pct --sphere 500000 4800000 100 1e4\n```\n", PROGRAMS, folder)
        for link in ("none.md", "../../none.md", "pages/index.md"):
            with self.assertRaises(manual.Failure):
                manual.check_links({"index": f"[a page]({link})"})
        with tempfile.TemporaryDirectory() as folder, self.assertRaisesRegex(manual.Failure, "none.png"):
            manual.copy_pictures("page", "![A picture](none.png)", folder, pathlib.Path(folder))
        manual.check_links({"index": "[itself](index.md), [a file](../../README.md)"})


if __name__ == "__main__":
    unittest.main()
