#!/usr/bin/env python3
"""The table of the stiff and the extreme: every operation of the table of operations, asked on hard clouds, cameras, matrices and pairs.

    python3 bench/report/stiff/run.py --bin build/release/bin --out /tmp/stiff [--only OPERATION...] [--cases TEXT...] [--report]

Rows are the operations that 'pcmlab help --json' lists, so a new one gets its row unasked (asks.py says how it is asked, oracles_*.py
what is right). A cell is right, with the error against brute force in extended precision; refused, with the words; or a defect: a
crash, a hang, NaN, a wrong answer, an output left behind by a failure. Cells go to OUT/cells/CASE.json and are not asked again
unless --again is given; OUT/table.md is the table. NumPy is needed.
"""
import argparse
import dataclasses
import json
import pathlib
import re
import shutil
import subprocess
import sys
import time

try:
    import numpy
except ImportError:
    print("skipped: NumPy is not here")
    sys.exit(77)
sys.path.insert(0, str(pathlib.Path(__file__).parent))
import asks  # noqa: E402
import cases  # noqa: E402
import oracles_clouds  # noqa: E402
import oracles_measures  # noqa: E402
import oracles_points  # noqa: E402
import stage as stages  # noqa: E402
import table  # noqa: E402
import values  # noqa: E402
from exact import Wrong, require  # noqa: E402

ORACLES = {**oracles_clouds.ORACLES, **oracles_points.ORACLES, **oracles_measures.ORACLES}
SMOKE = ("plain, on a map", "0 points", "all in one place", "a coordinate nan", "a stray at 1e100", "a mirrored matrix", "collinear pairs",
         "the camera inside a point")
# Ends of the places in answers that may be null, where that means none, or, of a sigma, infinite: nothing is known.
OPTIONAL = (".level", ".radii_limited", ".left_surface", ".fixed_spacing", ".moving_spacing", ".flipped", ".least_distance",
            ".sigma.position", ".sigma.angle", ".sigma.radius", ".sigma.second", ".condition")
TYPES = {"count": int, "number": (int, float), "text": str, "flag": bool, "list": list, "object": dict}


def holes_in(value, name):
    """The places of nulls in lists and objects that OPTIONAL does not have."""
    if value is None:
        return [] if name.endswith(OPTIONAL) else [name]
    parts = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [hole for key, part in parts for hole in holes_in(part, f"{name}.{key}" if isinstance(key, str) else name)]


class Cell:
    """One variant of an operation on one case: what was asked and answered."""

    def __init__(self, stage, operation, variant, known, more="", oracle=True):
        self.stage, self.operation, self.variant, self.more = stage, operation, variant, more
        self.words = asks.command_line(operation, known, stage)
        self.folder = stage.folder / "out"
        self.output = next((word for word in self.words if word.startswith("out.")), "")
        reads_source = str(stage.source) in self.words
        self.xyz = stage.case.xyz[numpy.isfinite(stage.case.xyz).all(axis=1)] if reads_source else stage.xyz
        self.answer = None
        self.oracle = ORACLES.get(operation["name"]) if oracle else None

    def numbers(self, option):
        """The numbers behind an option."""
        found = []
        for word in self.words[self.words.index(option) + 1:]:
            try:
                found.append(float(word))
            except ValueError:
                break
        return found

    def points(self, name):
        return self.stage.points_of(self.folder.resolve() / name)

    def judge(self):
        """A row of the table."""
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir()
        row = {"operation": self.operation["name"], "variant": " ".join(filter(None, (self.variant, self.more))), "case": self.stage.case.name}
        started = time.monotonic()
        answer = self.stage.ask(self.words, self.folder)
        row["seconds"] = round(time.monotonic() - started, 3)
        try:
            self.judge_answer(answer, row)
        except Wrong as wrong:
            row.update(kind="defect", words=str(wrong))
        except (RuntimeError, ValueError, KeyError, TypeError, OSError, IndexError) as error:
            row.update(kind="defect", words=f"{type(error).__name__}: {error}")
        if row["kind"] == "defect":
            row["command"] = " ".join(self.words)
        return row

    def judge_answer(self, answer, row):
        require(answer.code is not None, f"no answer within {stages.MOST_SECONDS} s")
        require(answer.code in (0, 1, 2, 3), f"ended with {answer.code}: {answer.err[-200:]}")
        self.answer = answer.json()
        if "error" in self.answer and isinstance(self.answer["error"], dict):
            self.judge_refusal(answer, row)
            return
        self.check_keys()
        found = self.oracle(self) if self.oracle else None
        row.update(kind="right", words="; ".join(self.answer["warnings"] + self.answer["notes"]))
        if found is not None:
            require(numpy.isfinite(found[0]), f"an error of {found[0]}")
            row.update(error=float(found[0]), unit=found[1])

    def judge_refusal(self, answer, row):
        words = " ".join(answer.err.split()).replace(str(self.stage.folder.resolve()) + "/", "")
        require(len(words) > 25 and answer.err.startswith("pcmlab"), f"refused without words: {words!r}")
        require(not answer.done, f"ended with {answer.code} after an error")
        left = sorted(path.name for path in self.folder.iterdir())
        require(not left, f"left {', '.join(left)} behind after: {words}")
        require(not self.stage.case.easy, f"refused: {words}")
        row.update(kind="refused", words=words)

    def check_keys(self):
        """Head and declared keys have their types; what cannot be null is not, which is how NaN and infinity show in JSON."""
        for declared in self.operation["head"] + self.operation["results"]:
            value = self.answer[declared["key"]]
            kind = TYPES[declared["type"].rstrip("?")]
            require(isinstance(value, kind) or (value is None and declared["type"].endswith("?")), f"{declared['key']} is {value!r}")
            holes = holes_in(value, declared["key"]) if value is not None else []
            require(not holes, f"{', '.join(holes[:3])}: null, as NaN and infinity are in JSON")


def ask_case(case, operations, arguments, program):
    """The rows of all wanted operations that the case is for."""
    wanted = [operation for operation in operations if (not arguments.only or operation["name"] in arguments.only) and
              (not case.only or operation["name"] in case.only)]
    if not wanted:
        return []
    stage = stages.Stage(case, arguments.out / "work", program)
    rows = [Cell(stage, operation, variant, known).judge()
            for operation in wanted for variant, known in asks.variants(operation, case).items()]
    shutil.rmtree(stage.folder)
    return rows


def ask_values(operations, arguments, program):
    """Each argument of each operation at and beyond its limits (values.py), on the plain case."""
    (arguments.out / "values").mkdir(parents=True, exist_ok=True)
    case = dataclasses.replace(next(cases.all_cases(1, 1)), easy=False)
    stage = None
    for operation in operations:
        path = arguments.out / "values" / f"{operation['name']}.json"
        if (path.exists() and not arguments.again) or (arguments.only and operation["name"] not in arguments.only):
            continue
        stage = stage or stages.Stage(case, arguments.out / "work", program)
        variant, known = next(iter(asks.KNOWN.get(operation["name"], {"": {}}).items()))
        rows = [Cell(stage, operation, variant, words, name, holds).judge() for name, (words, holds) in values.variants(operation, known).items()]
        save(path, rows, operation["name"])


def save(path, rows, name):
    path.write_text(json.dumps(rows, indent=1) + "\n")
    defects = [row for row in rows if row["kind"] == "defect"]
    print(f"{name}: {len(rows)} cells, {len(defects)} defects", flush=True)
    for row in defects:
        print(f"    {table.name_of(row)}: {row['words'][:300]}\n        {row.get('command', '')[:400]}", flush=True)


def file_of(case, arguments):
    return arguments.out / "cells" / (re.sub(r"[^A-Za-z0-9.+-]+", "-", case.name) + ".json")


def ask_all(arguments, operations):
    (arguments.out / "cells").mkdir(parents=True, exist_ok=True)
    chosen = [case for case in cases.all_cases(arguments.many, arguments.files)
              if not arguments.cases or any(text in case.name for text in arguments.cases)]
    for case in chosen:
        if arguments.smoke and case.name not in SMOKE:
            continue
        path = file_of(case, arguments)
        known = json.loads(path.read_text()) if path.exists() else []
        if known and not arguments.again and not arguments.only:
            continue
        rows = ask_case(case, operations, arguments, str(arguments.bin.resolve() / "pcmlab"))
        rows += [row for row in known if arguments.only and row["operation"] not in arguments.only]
        save(path, rows, case.name)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--only", nargs="*", default=[], metavar="OPERATION")
    parser.add_argument("--cases", nargs="*", default=[], metavar="TEXT", help="cases whose names have one of these")
    parser.add_argument("--again", action="store_true", help="ask what is there again")
    parser.add_argument("--many", type=int, default=100000, help="points in one place; 1000000 takes minutes")
    parser.add_argument("--files", type=int, default=500, help="files of a cloud; 65535 takes minutes")
    parser.add_argument("--values", action="store_true", help="each argument at its limits, on the plain case, instead of the cases")
    parser.add_argument("--report", action="store_true", help="only write the table of what is there")
    parser.add_argument("--smoke", action="store_true", help="a few cases, again")
    arguments = parser.parse_args()
    arguments.again |= arguments.smoke
    usage = subprocess.run([arguments.bin / "pcmlab", "help", "--json"], capture_output=True, text=True, check=True)
    operations = json.loads(usage.stdout)["commands"]
    if arguments.values:
        ask_values(operations, arguments, str(arguments.bin.resolve() / "pcmlab"))
    elif not arguments.report:
        ask_all(arguments, operations)
    rows = [row for folder in ("cells", "values") for path in sorted((arguments.out / folder).glob("*.json")) for row in json.loads(path.read_text())]
    defects = table.write(arguments.out / "table.md", rows, operations)
    sys.exit(defects > 0)


if __name__ == "__main__":
    main()
