#!/usr/bin/env python3
"""--sweep of the benchmarks: it knows each value of core/*/tuning.h, draws a row for each value, and restores it.

    python3 bench/sweep/test_sweep.py FOLDER_OF_PROGRAMS WORK_FOLDER
"""
import json
import pathlib
import re
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN, WORK = (pathlib.Path(path).resolve() for path in sys.argv[1:3])
DRAWS = ("bench_pictures",) if (BIN / "bench_pictures").exists() else ()


def run(program, *arguments):
    return subprocess.run([BIN / program, *map(str, arguments)], capture_output=True, text=True, cwd=WORK)


def rows(text):
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("|")]


class Sweep(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        WORK.mkdir(parents=True, exist_ok=True)
        for arguments in (["generate", "-q", "--overwrite", "-n", 20000, "site.las"], ["build", "-q", "--overwrite", "site.las"]):
            done = run("pcmlab", *arguments)
            if done.returncode != 0:
                raise RuntimeError(done.stderr)

    def draw(self, program, *arguments):
        done = run(program, *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return rows(done.stdout)

    def test_each_value_has_its_name_and_its_number(self):
        written = {}
        for file in sorted(ROOT.glob("core/*/tuning.h")):
            # With its parts, such as edge_tuning.h.
            text = "\n".join(part.read_text(encoding="utf-8") for part in [file, *sorted(file.parent.glob("*_tuning.h"))])
            members = dict(re.findall(r"^    (\w+Tuning) (\w+);", text, re.MULTILINE))
            for struct, body in re.findall(r"^struct (\w+) \{\n(.*?)^\};", text, re.MULTILINE | re.DOTALL):
                for name, value in re.findall(r"^    (?:double|std::size_t) (\w+) = ([^;]+);", body, re.MULTILINE):
                    written[f"{file.parent.name}.{members[struct]}.{name}"] = float(value)
        self.assertTrue(written)
        for program in ("bench_fit", "bench_place", "bench_detect", "bench_neighbourhoods", *DRAWS):
            listed = run(program, "--sweep", "list").stdout
            self.assertEqual({name: float(value) for name, value in re.findall(r"(\S+) = (\S+)\n", listed)}, written, program)

    def test_a_table_has_a_row_for_each_value(self):
        for program, arguments in (("bench_fit", ["--seeds", 1, "--sweep", "fit.consensus.max_chance=0.001:0.5:2"]),
                                   ("bench_place", ["site.pct", "--clicks", 6, "--sweep", "fit.consensus.max_chance=0.001:0.5:2"]),
                                   ("bench_detect", ["site.pct", "--min-points", 100, "--sweep", "fit.consensus.max_chance=0.001:0.5:2"])):
            table = self.draw(program, *arguments)
            self.assertEqual([row[0] for row in table], ["fit.consensus.max_chance", "---:", "0.001", "**0.42**", "0.5"])
            self.assertEqual({len(row) for row in table}, {len(table[0])})

    def test_neighbours_are_exact_whatever_the_value(self):
        table = self.draw("bench_neighbourhoods", "site.pct", 8, 1, 64, "--sweep", "knn.margin.next_factor=0.01:1.1:2")
        self.assertEqual([row[0] for row in table], ["knn.margin.next_factor", "---:", "0.01", "**1.1**"])
        self.assertEqual(len({row[3] for row in table[2:]}), 1, "mean distance")

    @unittest.skipUnless(DRAWS, "built without OpenGL")
    def test_pictures_follow_the_value(self):
        view = {"eye": [0, -2, 2], "target": [0, 0, 0], "angle": 60}
        (WORK / "path.json").write_text(json.dumps({"format": "pcm camera path", "version": 1, "coordinates": "box",
                                                    "frames": [dict(view, rest=True)]}))
        table = self.draw("bench_pictures", "--sweep", "gl.smoothing.max_points=1000:100000000:2", "views", "site.pct", "--path", "path.json",
                          "--out", "pictures", "--size", "64x48", "--converge", 8)
        self.assertEqual([row[0] for row in table], ["gl.smoothing.max_points", "---:", "1000", "1e+08", "**2e+08**"])
        self.assertEqual({len(row) for row in table}, {len(table[0])})
        averaged = table[0].index("averaged")
        self.assertEqual([int(row[averaged]) for row in table[2:]], [1, 8, 8])
        for arguments, word in ((["about"], "views alone"), ([], "subcommand")):
            done = run("bench_pictures", "--sweep", "gl.smoothing.max_points", *arguments)
            self.assertEqual(done.returncode, 1)
            self.assertIn(word, done.stderr)

    def test_figures_follow_the_value(self):
        table = self.draw("bench_fit", "--seeds", 1, "--sweep", "fit.consensus.max_chance=0.001:0.5:2", "fit.consensus.max_chance=0.4:0.5:2")
        good = {row[0]: int(row[1]) for row in table[:5] if row[1].isdigit()}
        self.assertLess(good["0.001"], good["**0.42**"])
        # The first sweep has restored the value.
        self.assertEqual(table[3][1:5], table[8][1:5])

    def test_what_cannot_be_swept_is_refused(self):
        for sweep, word in (("fit.no_such_value", "--sweep list"), ("fit.consensus.max_chance=1:2", "FROM:TO:STEPS"),
                            ("fit.consensus.max_chance=a:2:3", "not a number")):
            done = run("bench_fit", "--seeds", 0, "--sweep", sweep)
            self.assertEqual(done.returncode, 1)
            self.assertIn(word, done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
