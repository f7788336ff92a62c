#!/usr/bin/env python3
"""Pictures against frame time: how far what is drawn in a given time is from the full-resolution picture.

    run.py --bin BUILD/bin --out FOLDER [--quick | --smoke] [--cloud NAME=FILE]... [--path FILE]... [--work FOLDER] [--again STUDY]...
        [--fly TREE] [--fly-budget MS] [--python FILE]
    run.py --out FOLDER --report       plots and report of what is in FOLDER, nothing is measured

FOLDER gets results.csv (a row for each run), sys_info.txt, plots and report.md. A generated cloud, and each --cloud (a file that `pcmlab convert` reads, of a few million
points), is given radii and normals (splats.py) and built into WORK (by default FOLDER/work). Each path is replayed at the pace of a display with each
splat mode and budget, and pictures of it are compared with the full-resolution ones. --fly flies through a large tree with caches much smaller than it, and
looks for regions that go blank. Needs the packages of requirements.txt; --python names an interpreter that has them.

Rows of results.csv are not measured again, so an interrupted run resumes.
"""
import argparse
import json
import os
import pathlib
import shutil
import statistics
import sys

import packages

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "study"))
packages.require()
import metrics  # noqa: E402
import paths  # noqa: E402
import plan  # noqa: E402
import report  # noqa: E402
import splats  # noqa: E402
import study  # noqa: E402
from study import call  # noqa: E402


def quantile(values, q):
    """Nearest rank."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, max(0, -int(-q * len(ordered) // 1) - 1))]


def frame_figures(drawn):
    """Of the lists that bench_pictures prints."""
    return {"frame_ms_median": statistics.median(drawn["frame_ms"]), "frame_ms_p99": quantile(drawn["frame_ms"], 0.99), "frame_ms_max": max(drawn["frame_ms"]),
            "points_drawn": statistics.median(drawn["points_drawn"]), "screen_error_px": statistics.median(drawn["screen_error_px"]),
            "uploaded_mb_a_frame": statistics.fmean(drawn["uploaded_bytes"]) / 1e6, "uploaded_mb_max": max(drawn["uploaded_bytes"]) / 1e6,
            "upload_ms_p99": quantile(drawn["upload_ms"], 0.99), "upload_ms_max": max(drawn["upload_ms"]), "frames": len(drawn["frame_ms"])}


class Run:
    def __init__(self, arguments, size):
        self.arguments, self.size = arguments, size
        self.program, self.pcm = arguments.bin / "bench_pictures", arguments.bin / "pcmlab"
        self.work = (arguments.work or arguments.out / "work").resolve()
        self.work.mkdir(parents=True, exist_ok=True)
        self.trees, self.failed = {}, 0
        self.modes = []  # of splats
        self.of_modes = {}  # file: FLIP between the references of a mode and of the perspective one

    def make_tree(self, name, source):
        tree = self.work / f"{name.replace(' ', '-')}.pct"
        self.trees[name] = tree
        if (tree / "index.pct").exists():
            return
        print(f"building {tree.name}", flush=True)
        plain, with_splats = self.work / "plain.ply", self.work / "splats.ply"
        call([self.pcm, "convert", source, plain, "--overwrite"])
        splats.add_splats(plain, with_splats)
        call([self.pcm, "build", with_splats, "-o", tree, "--json", *(["--chunk-points", self.size.chunk_points] if self.size.chunk_points else [])])
        plain.unlink()
        with_splats.unlink()

    def make_clouds(self):
        if self.size.points:
            name = f"scene-{self.size.points}"
            if not (self.work / f"{name}.pct" / "index.pct").exists():
                call([self.pcm, "generate", "--overwrite", "-n", self.size.points, "--no-truth", self.work / f"{name}.las"])
            self.make_tree(name, self.work / f"{name}.las")
        for text in self.arguments.cloud:
            name, _, file = text.rpartition("=")
            self.make_tree(name or pathlib.Path(file).stem, file)

    def draw(self, mode, tree, path, folder, every, *options):
        """What bench_pictures prints; its pictures are in the folder, and nothing else is."""
        shutil.rmtree(folder, ignore_errors=True)
        return json.loads(call([self.program, mode, tree, "--path", path, "--out", folder, "--every", every, "--size", self.size.picture, *options]))

    def references(self, cloud, path_name, path, mode):
        """Folder of the full-resolution pictures."""
        folder = self.work / "references" / f"{cloud}-{path_name}-{mode}".replace(" ", "-")
        done = folder / "done.json"
        wanted = {"every": self.size.every, "frames": self.size.frames, "size": self.size.picture}
        if not done.exists() or json.loads(done.read_text()) != wanted:
            self.draw("reference", self.trees[cloud], path, folder, self.size.every, "--splats", mode)
            done.write_text(json.dumps(wanted))
        return folder

    def measure(self, table):
        self.make_clouds()
        files = study.path_files(self.work, self.size, self.arguments.path)
        rows = plan.configurations(self.size, self.trees, files, self.modes)

        def figures_of(row):
            path = files[row["path"]]
            own = self.references(row["cloud"], row["path"], path, row["mode"])
            best = self.references(row["cloud"], row["path"], path, "perspective")
            drawn = self.draw("replay", self.trees[row["cloud"]], path, self.work / "drawn", self.size.every, "--splats", row["mode"], "--passes", 2,
                              "--pace-ms", self.size.pace_ms, *plan.options(row))
            return {**frame_figures(drawn), **self.compare(own, best, self.work / "drawn", row["mode"])}

        names = list(files), list(self.trees)
        self.failed = study.measure(table, rows, self.size.repeat, figures_of, lambda row: (names[0].index(row["path"]), names[1].index(row["cloud"])))
        return rows

    def compare(self, own, best, drawn, mode):
        """Means over the pictures: against the mode's own full-resolution picture, and against that of the perspective mode."""
        figures = {"flip": [], "ssim": [], "holes": [], "spill": [], "flip_of_mode": [], "flip_to_perspective": [], "holes_to_perspective": []}
        for file in sorted(drawn.glob("*.png")):
            picture, reference, perspective = metrics.read(file), metrics.read(own / file.name), metrics.read(best / file.name)
            figures["flip"].append(metrics.flip(reference, picture))
            figures["ssim"].append(metrics.ssim(reference, picture))
            figures["holes"].append(metrics.holes(reference, picture))
            figures["spill"].append(metrics.spill(reference, picture))
            same = mode == "perspective"
            if own / file.name not in self.of_modes:
                self.of_modes[own / file.name] = 0.0 if same else metrics.flip(perspective, reference)
            figures["flip_of_mode"].append(self.of_modes[own / file.name])
            figures["flip_to_perspective"].append(figures["flip"][-1] if same else metrics.flip(perspective, picture))
            figures["holes_to_perspective"].append(metrics.holes(perspective, picture))
        return {name: statistics.fmean(values) for name, values in figures.items()}

    def fly(self, table, tree):
        """A large tree, caches much smaller than it: does anything go blank that had points before?"""
        a, size = self.arguments, self.size
        row = {"study": "fly-through", "cloud": tree.stem, "path": "fly-over", "mode": "constant", "variant": "feedback", "budget": a.fly_budget, "repetition": 1}
        if table.has(row):
            return
        print(f"flying through {tree.name}", flush=True)
        path = paths.write(self.work / "fly-paths", size.fly_frames)["fly-over"]
        reference, drawn_folder = self.work / "fly-reference", self.work / "fly-drawn"
        self.draw("reference", tree, path, reference, size.fly_every, "--to-target", "--target-px", 1.4)
        load = os.getloadavg()[0]
        drawn = self.draw("replay", tree, path, drawn_folder, 1, "--frame-budget-ms", a.fly_budget, "--pace-ms", size.pace_ms, "--l1-mb", a.fly_l1, "--l2-mb", a.fly_l2,
                          "--upload-ms", a.fly_upload)
        blank, gone, held = 0, 0, []
        for file in sorted(reference.glob("*.png")):
            picture, whole = metrics.read(drawn_folder / file.name), metrics.read(file)
            before = drawn_folder / f"{int(file.stem) - 1:04d}.png"
            one, two = metrics.blank_tiles(whole, picture, metrics.read(before) if before.exists() else None)
            blank, gone = blank + one, gone + two
            held.append(metrics.holes(whole, picture))
        # A chunk is uploaded whatever it takes, so a frame's limit can be passed by one chunk.
        over = sum(ms > a.fly_upload and chunks > 1 for ms, chunks in zip(drawn["upload_ms"], drawn["uploaded_chunks"]))
        table.add({**row, "load": load, **frame_figures(drawn), "holes": statistics.fmean(held), "blank_tiles": blank, "blank_tiles_that_had_points": gone,
                   "pictures": len(held), "l1_mb": a.fly_l1, "l2_mb": a.fly_l2, "l1_allocated_mb": drawn["l1_allocated_mb"], "loaded_mb": drawn["loaded_mb"],
                   "upload_limit_ms": a.fly_upload, "frames_over_upload_limit": over, "points": json.loads(call([self.pcm, "info", tree, "--json"]))["points"]})


def check_smoke(table, rows, out):
    """Every configuration has sound figures, and with a budget that holds the whole cloud the picture is the reference."""
    text = study.check_report(table, rows, out)
    for row in table.select(study="error"):
        assert 0 <= row["flip"] <= 1 and -1 <= row["ssim"] <= 1 and 0 <= row["holes"] <= 1 and row["frame_ms_median"] > 0 and row["points_drawn"] > 0, row
    for path in plan.SMOKE.paths:
        for variant in ("best first", "root first"):
            few, many = (table.select(study="error", mode="constant", variant=variant, budget=b, path=path)[0] for b in plan.SMOKE.budgets)
            assert few["points_drawn"] <= plan.SMOKE.budgets[0] and many["points_drawn"] >= few["points_drawn"], (few, many)
            assert many["flip"] <= few["flip"] and many["holes"] <= few["holes"], (few, many)
    fly = table.select(study="fly-through")[0]
    assert fly["pictures"] == plan.SMOKE.fly_frames // plan.SMOKE.fly_every, fly
    assert "## At equal frame time" in text and "## A fly-through" in text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    study.add_arguments(parser, "bench_pictures", "a smaller cloud, fewer frames and budgets, once")
    parser.add_argument("--work", type=pathlib.Path, help="for clouds, trees and pictures")
    parser.add_argument("--python", help="start with this interpreter")
    parser.add_argument("--points", type=lambda t: int(float(t)), help="of the generated cloud; 0: none")
    parser.add_argument("--fly", type=pathlib.Path, metavar="TREE", help="a large tree to fly through")
    parser.add_argument("--fly-budget", type=float, default=33, help="frame budget, ms")
    parser.add_argument("--fly-upload", type=float, default=3, help="limit of uploads in a frame, ms")
    parser.add_argument("--fly-l1", type=float, default=32, help="MiB")
    parser.add_argument("--fly-l2", type=float, default=64, help="MiB")
    parser.add_argument("--no-error", action="store_true", help="without the study of error against frame time")
    arguments = parser.parse_args()
    size, table = study.begin(parser, arguments, plan)
    size.points = size.points if arguments.points is None else arguments.points
    if arguments.report:
        report.write(table, arguments.out)
        return
    run = Run(arguments, size)
    try:
        about = json.loads(call([run.program, "about"]))
        run.modes = about.pop("splats")
    except RuntimeError as error:
        if not arguments.smoke:
            raise
        print(f"skipped: {error}")
        sys.exit(77)
    study.describe_machine(arguments.out, run.work, about)
    rows = [] if arguments.no_error else run.measure(table)
    if arguments.fly or arguments.smoke:
        run.fly(table, (arguments.fly or next(iter(run.trees.values()))).resolve())
    report.write(table, arguments.out)
    study.end(run.failed)
    if arguments.smoke:
        check_smoke(table, rows, arguments.out)


if __name__ == "__main__":
    main()
