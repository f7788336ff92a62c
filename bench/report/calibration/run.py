#!/usr/bin/env python3
"""What operations claim of their errors, held against the true ones.

    python3 bench/report/calibration/run.py --bin build/release/bin --out /tmp/calibration [--data ../shared/data] [--smoke] [--only CLAIM...]
                                            [--write bench/results/calibration.md]

A bound holds always; a claim of 95 % holds in 95 % of the answers, less what chance leaves of so few (one in a hundred such tables). Rows go to OUT/rows.json. NumPy is needed. The exit code is 1 where a claim does not
hold.
"""
import argparse
import csv
import json
import math
import pathlib
import shutil
import sys

try:
    import numpy
except ImportError:
    print("skipped: NumPy is not here")
    sys.exit(77)
sys.path[:0] = [str(pathlib.Path(__file__).parent), str(pathlib.Path(__file__).parent.parent / "stiff")]
import claims  # noqa: E402
import clouds  # noqa: E402
import ply  # noqa: E402
import stage as stages  # noqa: E402

SMOKE = ("waves, noise 0.002, on the map", "a sphere, noise 0.001, at the origin", "a plane, noise 0.004, on the map", "scan lines 1 to 50")
LEAST_OF_FILE = 2000  # points of a file that is taken
MOST_OF_FILE = 3_000_000


class Stage:
    """One cloud on disk, as the file `source` and the tree `tree`; `source_xyz` in the order of the file, `xyz` of the tree."""

    def __init__(self, cloud, folder, program):
        self.cloud, self.folder, self.program, self.chance = cloud, folder, program, cloud.chance
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        self.source, self.tree = "cloud.ply", "cloud.pct"
        ply.write(folder / self.source, cloud.xyz, {"number": numpy.arange(len(cloud.xyz), dtype=numpy.uint32)})
        self.levels = self.ask("build", self.source, "-o", self.tree, "--chunk-points", 1000)["levels"]
        self.source_xyz, self.xyz = cloud.xyz, self.columns(self.tree)["xyz"]
        self.extent = float((self.xyz.max(axis=0) - self.xyz.min(axis=0)).max())
        self.last_bit = float(numpy.spacing(numpy.abs(self.xyz).max()))  # what the oracle's own numbers are rounded to

    def ask(self, *words, codes=(0,)):
        words = [repr(float(word)) if isinstance(word, float) else str(word) for word in words]
        answer = stages.run(self.program, [*words, "--json"], self.folder)
        if answer.code not in codes:
            raise RuntimeError(f"{' '.join(words)[:300]}: {answer.err.strip()}")
        return answer.json() if answer.out else {"error_kind": "exact"}

    def columns(self, name):
        self.ask("convert", name, "read.ply", "--overwrite")
        return ply.read(self.folder / "read.ply")


def clouds_of_files(data, folder, program):
    """Samples of the files of MANIFEST.csv, of copies: opening a file may write next to it."""
    with open(data / "MANIFEST.csv", newline="") as table:
        for entry in csv.DictReader(table):
            points = int(entry["points"]) if entry["points"].isdigit() else 0
            if not LEAST_OF_FILE <= points <= MOST_OF_FILE or entry["note"].startswith("BAD"):
                continue
            folder.mkdir(parents=True, exist_ok=True)
            copy = folder / pathlib.Path(entry["file"]).name
            shutil.copy(data / entry["file"], copy)
            answer = stages.run(program, ["convert", copy.name, "all.ply", "--overwrite", "-q", "--attributes", ""], folder)
            if not answer.done:
                answer = stages.run(program, ["convert", copy.name, "all.ply", "--overwrite", "-q"], folder)
            if answer.done:
                yield clouds.sample_of(entry["file"], ply.read(folder / "all.ply")["xyz"])
            shutil.rmtree(folder)


def rows_of(cloud, arguments):
    stage = Stage(cloud, arguments.out / "work", str((arguments.bin / "pcmlab").resolve()))
    rows = []
    for claim in claims.ALL:
        if arguments.only and claim.__name__ not in arguments.only:
            continue
        rows += [dict(zip(("operation", "kind", "claimed", "true", "unit"), row), cloud=cloud.name) for row in claim(stage)]
    return rows


def holds(row):
    """An exact answer claims 0, a claim that is not known nothing. What doubles round is no error."""
    return row["claimed"] is None or row["true"] <= row["claimed"] * (1 + 1e-9) + 1e-13 * abs(row["true"])


def least_of(count, share=0.95, chance=0.01):
    """The number of `count` claims of 95 % that hold at least, but for the given chance."""
    below = 0.0
    for hold in range(count + 1):
        below += math.comb(count, hold) * share ** hold * (1 - share) ** (count - hold)
        if below > chance:
            return hold
    return count


def summary(rows):
    """operation -> what its rows come to."""
    found = {}
    for operation in sorted({row["operation"] for row in rows}):
        own = [row for row in rows if row["operation"] == operation]
        kinds = sorted({row["kind"] for row in own} - {"exact"}) or ["exact"]
        held = sum(map(holds, own))
        ratios = sorted(row["true"] / row["claimed"] for row in own if row["claimed"])
        least = len(own) if kinds != ["95 %"] else least_of(len(own))
        found[operation] = {"kind": ", ".join(kinds), "rows": len(own), "clouds": len({row["cloud"] for row in own}), "held": held,
                            "good": held >= least, "ratios": ratios}
    return found


def text_of(rows):
    number = len({row["cloud"] for row in rows})
    lines = ["# Claims of error, held against the true error", "",
             f"Made by `python3 bench/report/calibration/run.py`, on {number} clouds. A bound holds always; of single numbers with a claim "
             "of 95 % that share of the rows holds. true / claimed: 1 is a claim that just holds.", "",
             "| operation | claim | clouds | rows | held | true / claimed: median | 95 % | largest | |", "|---|---|---|---|---|---|---|---|---|"]
    for operation, found in summary(rows).items():
        ratios = found["ratios"] or [0]
        at = [ratios[min(len(ratios) - 1, int(share * len(ratios)))] for share in (0.5, 0.95, 1)]
        lines.append(f"| {operation} | {found['kind']} | {found['clouds']} | {found['rows']} | {100 * found['held'] / found['rows']:.1f} % | "
                     + " | ".join(f"{ratio:.2f}" for ratio in at) + f" | {'' if found['good'] else 'does not hold'} |")
    lines += ["", "Clouds: " + "; ".join(sorted({row["cloud"] for row in rows})) + "."]
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--data", type=pathlib.Path)
    parser.add_argument("--write", type=pathlib.Path)
    parser.add_argument("--only", nargs="*", default=())
    parser.add_argument("--smoke", action="store_true", help="a few generated clouds")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    found = [cloud for cloud in clouds.generated() if not arguments.smoke or cloud.name in SMOKE]
    if arguments.data and not arguments.smoke:
        found += clouds_of_files(arguments.data, arguments.out / "file", str((arguments.bin / "pcmlab").resolve()))
    rows = []
    for cloud in found:
        rows += rows_of(cloud, arguments)
        print(f"{cloud.name}: {len(rows)} rows", flush=True)
    (arguments.out / "rows.json").write_text(json.dumps(rows, indent=0))
    text = text_of(rows)
    print(text)
    for row in rows:
        if not holds(row) and (row["kind"] != "95 %" or not summary(rows)[row["operation"]]["good"]):
            print("does not hold:", row)
    if arguments.write:
        arguments.write.write_text(text)
    return 0 if all(one["good"] for one in summary(rows).values()) else 1


if __name__ == "__main__":
    sys.exit(main())
