#!/usr/bin/env python3
"""The caches' study: what size of chunk, of VBO, of L1 and of L2, which policy and container, from cold storage and from warm.

    run.py --bin BUILD/bin --out FOLDER [--quick | --smoke] [--cloud NAME=FILE]... [--path FILE]... [--work FOLDER]
        [--again STUDY]...
    run.py --out FOLDER --report       plots and report of what is in FOLDER, nothing is measured

FOLDER gets results.csv (a row for each run), sys_info.txt, plots, and report.md with the defaults that it recommends. Clouds are
generated and built into WORK (by default FOLDER/work; they stay for the next time). A --cloud is a file that `pcmlab build` reads, built with each chunk size, or a
tree, measured as it is. A --path is a camera path as bench/README.md describes it, in addition to the generated ones.

An interrupted run resumes: rows of results.csv are not measured again. Repetitions take turns in random
order, so that all configurations meet the same machine; medians count, and quartiles show the spread.
"""
import argparse
import json
import os
import pathlib
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "study"))
import plan  # noqa: E402
import report  # noqa: E402
import study  # noqa: E402
from study import call  # noqa: E402


def count_name(points):
    return f"{points / 1e6:g} M" if points >= 1_000_000 else f"{points / 1000:g} K"


class Run:
    def __init__(self, arguments, size):
        self.arguments, self.size = arguments, size
        self.program = arguments.bin / "bench_caches"
        self.pcm = arguments.bin / "pcmlab"
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
                    call([self.pcm, "generate", "--overwrite", "-n", points, "--no-truth", part])
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

    def measure(self, table):
        clouds, paths = self.make_clouds(), study.path_files(self.work, self.size, self.arguments.path)
        rows = plan.configurations(self.size, clouds, list(paths), self.defaults, bool(self.about["gl"]))

        def figures_of(row):
            tree = self.trees[row["cloud"], row["chunk_points"]]
            figures = json.loads(call([self.program, *plan.command_line(row, self.size, tree, paths.get(row["path"]))]))
            return {name: value for name, value in figures.items() if name not in ("mode", "gl")}

        self.failed = study.measure(table, rows, self.size.repeat, figures_of)
        return rows


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
    for wrong, message in (({"frames": []}, "no frames"), ({"coordinates": "screen"}, "coordinates"), ({"version": 2}, "'version' is not 1"),
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
    """That nothing was left out: every configuration has its figures."""
    text = study.check_report(table, rows, out)
    for row in table.select(mode="replay"):
        assert row["l1_uploaded_mb"] > 0 and row["given_up"] == 0 and 0 <= row["l1_hit_rate"] <= 1, row
        assert row["l1_compulsory"] + row["l1_capacity"] > 0 and row["l2_asked"] > 0, row
    for row in table.select(mode="scan"):
        assert row["mpoints_s"] > 0 and (row["storage"] == "warm" or row["share_in_system_cache"] < 0.5), row
    assert "## Defaults" in text and (not run.about["gl"] or "VBO" in text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    study.add_arguments(parser, "bench_caches", "smaller clouds and fewer repetitions: half an hour on two cores")
    parser.add_argument("--work", type=pathlib.Path, help="for clouds and trees; take one on the disk that is to be measured")
    parser.add_argument("--points", type=lambda t: [int(float(p)) for p in t.split(",") if p], help="of the generated clouds, e.g. 5e6,20e6")
    arguments = parser.parse_args()
    size, table = study.begin(parser, arguments, plan)
    if arguments.points is not None:
        size.clouds = arguments.points
    if arguments.report:
        report.write(table, arguments.out)
        return
    run = Run(arguments, size)
    if not run.about["gl"]:
        print(f"no camera paths: {run.about['why_not']}", flush=True)
    report.load_plots()  # so that the versions are known
    study.describe_machine(arguments.out, run.work, run.about)
    (arguments.out / "defaults.json").write_text(json.dumps(run.about, indent=1) + "\n", encoding="utf-8")
    if arguments.smoke:
        add_own(run)
    rows = run.measure(table)
    report.write(table, arguments.out)
    study.end(run.failed)
    if arguments.smoke:
        check_smoke(run, table, rows, arguments.out)


if __name__ == "__main__":
    main()
