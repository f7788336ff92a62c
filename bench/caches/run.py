#!/usr/bin/env python3
"""The caches' study: what size of chunk, of VBO, of L1 and of L2, which policy and container, from cold storage and from warm.

    run.py --bin BUILD/bin --out FOLDER [--quick | --smoke] [--cloud NAME=FILE]... [--path FILE]... [--work FOLDER]
        [--again STUDY]...
    run.py --out FOLDER --report       plots and report of what is in FOLDER, nothing is measured

FOLDER gets results.csv (a row for each run), sys_info.txt, plots, and report.md with the defaults that it recommends. Clouds are
generated and built into WORK (by default FOLDER/work; they stay for the next time). A --cloud is a file that `pcm build` reads, built with each chunk size, or a
tree, measured as it is. A --path is a camera path as bench/README.md describes it, beside the generated ones.

A run that was interrupted goes on where it was: what is in results.csv is not measured again. Repetitions take turns in random
order, so that all configurations meet the same machine; medians count, and quartiles tell the spread.
"""
import argparse
import json
import os
import pathlib
import random
import subprocess
import sys
import time

import machine
import paths
import plan
import report
from table import Table

HERE = pathlib.Path(__file__).resolve().parent


def call(command):
    result = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    if result.returncode:
        raise RuntimeError(f"{pathlib.Path(str(command[0])).name} {' '.join(map(str, command[1:3]))}: "
                           f"{(result.stderr or result.stdout).strip()[-500:] or f'ended with {result.returncode}'}")
    return result.stdout


def count_name(points):
    return f"{points / 1e6:g} M" if points >= 1_000_000 else f"{points / 1000:g} K"


class Run:
    def __init__(self, arguments, size):
        self.arguments, self.size = arguments, size
        self.program = arguments.bin / "bench_caches"
        self.pcm = arguments.bin / "pcm"
        self.work = arguments.work or arguments.out / "work"
        self.work.mkdir(parents=True, exist_ok=True)
        self.about = {k: int(v) if isinstance(v, float) and v.is_integer() else v for k, v in json.loads(call([self.program, "about"])).items()}
        self.defaults = {"block_mb": 2, "policy": "lru", "container": "hash", "l1_mb": 512, **self.about}
        self.trees = {}   # (cloud, chunk size): folder
        self.failed = 0

    def build(self, cloud, source, chunk):
        tree = self.work / f"{cloud.replace(' ', '')}-{chunk}.pct"
        if not (tree / "index.pct").exists():
            print(f"building {tree.name}", flush=True)
            call([self.pcm, "build", source, "-o", tree, "--chunk-points", chunk, "-t", os.cpu_count(), "--json"])
        self.trees[cloud, chunk] = tree

    def make_clouds(self):
        """Name: chunk sizes."""
        clouds = {}
        for points in self.size.clouds:
            name = count_name(points)
            scene = self.work / f"scene-{points}.las"
            if any(not (self.work / f"{name.replace(' ', '')}-{chunk}.pct" / "index.pct").exists() for chunk in self.size.chunks):
                if not scene.exists():
                    print(f"generating {name} points", flush=True)
                    part = scene.with_name("new-" + scene.name)
                    call([self.pcm, "generate", "-n", points, "--no-truth", part])
                    part.rename(scene)
            for chunk in self.size.chunks:
                self.build(name, scene, chunk)
            clouds[name] = self.size.chunks
        for text in self.arguments.cloud:
            name, _, file = text.rpartition("=")
            file = pathlib.Path(file)
            name = name or file.stem
            if (file / "index.pct").exists():
                self.trees[name, plan.AS_BUILT] = file
                clouds[name] = [plan.AS_BUILT]
            else:
                for chunk in self.size.chunks:
                    self.build(name, file, chunk)
                clouds[name] = self.size.chunks
        return clouds

    def make_paths(self):
        """Name: file."""
        files = {name: file for name, file in paths.write(self.work / "paths", self.size.frames).items() if name in self.size.paths}
        for file in self.arguments.path:
            files[json.loads(file.read_text(encoding="utf-8")).get("name", file.stem)] = file
        return files

    def measure(self, table):
        clouds, path_files = self.make_clouds(), self.make_paths()
        rows = plan.configurations(self.size, clouds, list(path_files), self.defaults, bool(self.about["gl"]))
        todo = []
        for repetition in range(1, self.size.repeat + 1):
            turn = [{**row, "repetition": repetition} for row in rows]
            random.Random(repetition).shuffle(turn)
            todo += [row for row in turn if not table.has(row)]
        print(f"{len(rows)} configurations, {self.size.repeat} repetitions; {len(todo)} runs are to be made", flush=True)
        start = time.monotonic()
        for done, row in enumerate(todo):
            tree = self.trees[row["cloud"], row["chunk_points"]]
            command = [self.program, *plan.command_line(row, self.size, tree, path_files.get(row["path"]))]
            load = os.getloadavg()[0]
            try:
                figures = json.loads(call(command))
            except (RuntimeError, ValueError) as error:
                self.failed += 1
                print(f"failed: {error}", file=sys.stderr, flush=True)
                continue
            figures.pop("mode")
            figures.pop("gl", None)
            table.add({**row, "load": load, **figures})
            if (done + 1) % 25 == 0 or done + 1 == len(todo):
                spent = time.monotonic() - start
                print(f"{done + 1} of {len(todo)} runs, {spent:.0f} s, {spent / (done + 1) * (len(todo) - done - 1):.0f} s to go", flush=True)
        return rows


def source_version():
    result = subprocess.run(["git", "-C", HERE, "describe", "--always", "--dirty"], capture_output=True, text=True, check=False)
    return result.stdout.strip() or "of unknown source"


TOUR = {"format": "pcm camera path", "version": 1, "name": "tour", "coordinates": "source", "frames": [
    {"eye": [500000, 4800000, 160], "target": [500020, 4800020, 100], "angle": 60},
    {"eye": [500020, 4800020, 300], "target": [500020, 4800020, 100], "up": [0, 1, 0], "height": 60, "rest": True}]}


def add_own(run):
    """A cloud and a path as a user has them, and paths that are none."""
    file = run.work / "tour.json"
    file.write_text(json.dumps(TOUR), encoding="utf-8")
    run.arguments.path.append(file)
    run.make_clouds()
    tree = next(iter(run.trees.values()))
    run.arguments.cloud.append(f"own={tree}")
    for wrong, message in (({"frames": []}, "no frames"), ({"coordinates": "screen"}, "coordinates"), ({"version": 2}, "version 1"),
                           ({"frames": [TOUR["frames"][0], {**TOUR["frames"][1], "up": [0, 0, 1]}]}, "frame 2"),
                           ({"frames": [{**TOUR["frames"][0], "angle": 180}]}, "angle")):
        bad = run.work / "wrong.json"
        bad.write_text(json.dumps({**TOUR, **wrong}), encoding="utf-8")
        try:
            call([run.program, "replay", tree, "--path", bad])
        except RuntimeError as error:
            assert message in str(error) or not run.about["gl"], error
        else:
            raise AssertionError(f"a camera path with {wrong} was taken")


def check_smoke(run, table, rows, out):
    """That nothing was left out: every configuration has its figures, and nothing would be measured a second time."""
    assert all(table.has({**row, "repetition": 1}) for row in rows), "a configuration was not measured"
    again = Table(table.file)
    assert all(again.has({**row, "repetition": 1}) for row in rows), "what was written is not found again"
    for row in again.select(mode="replay"):
        assert row["l1_uploaded_mb"] > 0 and row["given_up"] == 0 and 0 <= row["l1_hit_rate"] <= 1, row
        assert row["l1_compulsory"] + row["l1_capacity"] > 0 and row["l2_asked"] > 0, row
    for row in again.select(mode="scan"):
        assert row["mpoints_s"] > 0 and (row["storage"] == "warm" or row["share_in_system_cache"] < 0.5), row
    text = (out / "report.md").read_text(encoding="utf-8")
    assert "## Defaults" in text and (not run.about["gl"] or "VBO" in text)
    for line in text.splitlines():
        if line.startswith("!["):
            picture = out / line.rpartition("(")[2].rstrip(")")
            assert picture.stat().st_size > 1000, f"{picture} is empty"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, help="where pcm and bench_caches are")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--work", type=pathlib.Path, help="for clouds and trees; take one on the disk that is to be measured")
    parser.add_argument("--cloud", action="append", default=[], help="NAME=FILE or FILE, besides the generated ones")
    parser.add_argument("--path", action="append", default=[], type=pathlib.Path, help="a camera path, besides the generated ones")
    parser.add_argument("--points", type=lambda t: [int(float(p)) for p in t.split(",") if p], help="of the generated clouds, e.g. 5e6,20e6")
    parser.add_argument("--repeat", type=int)
    parser.add_argument("--again", action="append", default=[], metavar="STUDY", help="measure it again, whatever results.csv has of it")
    parser.add_argument("--report", action="store_true", help="only plots and report")
    group = parser.add_mutually_exclusive_group()
    group.add_argument("--quick", action="store_true", help="smaller clouds and fewer repetitions: half an hour on two cores")
    group.add_argument("--smoke", action="store_true", help="tiny, once: that it works")
    arguments = parser.parse_args()
    size = plan.SMOKE if arguments.smoke else plan.QUICK if arguments.quick else plan.FULL
    if arguments.points is not None:
        size.clouds = arguments.points
    if arguments.repeat:
        size.repeat = arguments.repeat
    arguments.out.mkdir(parents=True, exist_ok=True)
    if arguments.smoke:
        (arguments.out / "results.csv").unlink(missing_ok=True)
    table = Table(arguments.out / "results.csv")
    for study in arguments.again:
        table.drop(study)
    about_file = arguments.out / "sys_info.txt"
    if arguments.report:
        report.write(table, arguments.out)
        return
    if not arguments.bin:
        parser.error("--bin is needed to measure")
    run = Run(arguments, size)
    if not run.about["gl"]:
        print(f"no camera paths: {run.about['why_not']}", flush=True)
    report.load_plots()  # so that the versions are known
    if not about_file.exists():
        about_file.write_text(machine.describe(run.work, run.about, source_version()), encoding="utf-8")
    (arguments.out / "defaults.json").write_text(json.dumps(run.about, indent=1) + "\n", encoding="utf-8")
    if arguments.smoke:
        add_own(run)
    rows = run.measure(table)
    report.write(table, arguments.out)
    if run.failed:
        sys.exit(f"{run.failed} runs failed; they are made again when this is started again")
    if arguments.smoke:
        check_smoke(run, table, rows, arguments.out)


if __name__ == "__main__":
    main()
