#!/usr/bin/env python3
"""Pictures against truth: scenes whose true pictures are known, in several views, compared with what other viewers make of the same points.

    truth.py --bin BUILD/bin --out FOLDER [--work FOLDER] [--quick] [--view NAME]... [--points N] [--before FIGURES] [--cloud FILE]... [--only-clouds] [--converge N] [--python FILE]
    truth.py --out FOLDER --report [--before FIGURES]     the report of what FOLDER/figures.json has, nothing is measured

Scenes are generated (scenes/), and seen by scanners that leave shadows and scan lines. The truth of a view is ray-traced from the same surfaces; what no scanner saw, or at
less than 7 degrees, is left out of all figures. The camera arrives at each view and stays: the picture on arrival (moving), the complete one (rest), and the complete one after
a turn of 0.4 pixels are compared, without eye-dome lighting. A moving frame has a budget of points (views.py), and a complete picture is the mean of --converge frames as in
the window; all else is the library's default. Each --cloud, a file of a
real scan, has no truth: what is covered, calm and spent is measured in an oblique view.

FOLDER gets report.md, a composite of pictures for each view, and figures.json, in which views of earlier runs with as many points stay. Clouds and true pictures are kept in the
work folder (by default FOLDER/work; remove it after a change of scenes/); trees and pictures are made anew. --quick is small enough for a test, and checks what it has found.
Needs the packages of requirements.txt; --python names an interpreter that has them.
"""
import argparse
import json
import pathlib
import shutil
import sys

import packages

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "study"))
packages.require()
import metrics  # noqa: E402
import study  # noqa: E402
import truth_check  # noqa: E402
import truth_report  # noqa: E402
import views  # noqa: E402
from study import call  # noqa: E402


def read_figures(file):
    return json.loads(file.read_text()) if file else None


class Comparison:
    def __init__(self, arguments, size, gl):
        self.a, self.size, self.gl = arguments, size, gl
        self.picture_size = f"{size.width}x{size.height}"
        self.work = arguments.work or arguments.out / "work"
        self.work.mkdir(parents=True, exist_ok=True)
        self.rows, self.truths = [], []
        self.file = arguments.out / "figures.json"
        self.before = read_figures(arguments.before)

    def scenes(self):
        """Name: its views."""
        found = {}
        there = json.loads(call([self.a.bin / "bench_scenes", "about"]))["views"]
        names = [view["name"] for view in there]
        unknown = set(self.a.view) - set(names)
        if unknown:
            sys.exit(f"--view: there is no {', '.join(sorted(unknown))}; there are {', '.join(names)}")
        wanted = [] if self.a.only_clouds else self.a.view or self.size.views or names
        for view in there:
            if view["name"] in wanted:
                found.setdefault(view["scene"], []).append(view)
        return found

    def kept(self, name):
        """A folder for what the generator alone decides; whether it has to be filled."""
        folder = self.work / f"{name}-{self.size.points}-{self.picture_size}"
        return folder, not (folder / "done").exists()

    def build(self, cloud, tree, radii, *options):
        call([self.a.bin / "pcmlab", "build", cloud, "-o", tree, "--overwrite", "-q", *options])
        if radii:
            call([self.a.bin / "pcmlab", "normals", tree, "--in-place", "--radii", "-q"])

    def draw(self, tree, path, folder, *options):
        """Figures and pictures of a tree along the path: the frames on arrival, and complete."""
        shutil.rmtree(folder, ignore_errors=True)
        drawn = json.loads(call([self.a.bin / "bench_pictures", "views", tree, "--path", path, "--out", folder, "--size", self.picture_size, "--eye-dome", 0,
                                 "--passes", 2, "--frame-budget-ms", 1e6, "--point-budget", self.size.moving_points, *options]))
        return drawn, {state: [metrics.read(file) for file in sorted(folder.glob(f"*-{state}.png"))] for state in views.STATES}

    def draw_peer(self, cloud, path, folder, rule, *options):
        drawn = json.loads(call([self.a.bin / "bench_peers", cloud, "--rule", rule, "--path", path, "--out", folder, "--size", self.picture_size, *options]))
        return drawn, [metrics.read(file) for file in sorted(folder.glob("*.png"))]

    def prepare(self, scene, of_scene):
        """Cloud in colours and in labels, camera paths, true pictures."""
        folder, is_new = self.kept(f"{scene}-{'-'.join(view['name'] for view in of_scene)}")
        files = [folder / name for name in ("colours.las", "labels.las", "still.json", "both.json", "arriving.json")]
        if is_new:
            folder.mkdir(exist_ok=True)
            for file, path in zip(files[2:], views.paths(of_scene, self.size)):
                file.write_text(json.dumps(path))
            call([self.a.bin / "bench_scenes", "scan", scene, "--points", self.size.points, "-o", files[0], "--labels", files[1]])
            call([self.a.bin / "bench_scenes", "truth", scene, "--path", files[2], "--out", folder, "--size", self.picture_size])
            (folder / "done").touch()
        read = {kind: [metrics.read(file) for file in sorted(folder.glob(f"*-{kind}.png"))] for kind in ("colours", "labels", "facts")}
        truths = [views.Truth(view, read["colours"][i], read["labels"][i], read["facts"][i]) for i, view in enumerate(of_scene)]
        return files, truths

    def ours(self, scene, of_scene, files, truths, shown):
        for method, (radii, options) in views.OURS.items():
            pictures = {}
            for name, cloud in (("colours", files[0]), ("labels", files[1])):
                tree = self.work / f"{scene}-{name}.pct"
                self.build(cloud, tree, radii)
                # What a pixel shows is asked of its middle: means of labels are no labels.
                frames = self.a.converge if name == "colours" else 1
                drawn, pictures[name] = self.draw(tree, files[4], self.work / "drawn", "--converge", frames, *options)
                if name == "colours":
                    cost = drawn
            for i, (view, truth) in enumerate(zip(of_scene, truths)):
                at_rest = pictures["colours"]["rest"][2 * i]
                for state in views.STATES:
                    picture = pictures["colours"][state][2 * i]
                    figures = truth.figures(picture, pictures["labels"][state][2 * i], pictures["colours"]["rest"][2 * i + 1] if state == "rest" else None)
                    if state == "rest":
                        figures["jolt"] = metrics.changed_share(pictures["colours"]["moving"][2 * i], at_rest)
                    self.add(view["name"], method, state, figures, cost[f"{state}_cpu_seconds"][2 * i], cost[f"{state}_points"][2 * i])
                    shown[view["name"]][f"{method}, {'moving' if state == 'moving' else 'at rest'}"] = picture

    def peers(self, of_scene, files, truths, shown):
        """A peer's picture is the same moving and at rest: these clouds are within the budgets of points that they have."""
        def draw(cloud, px):
            return self.draw_peer(cloud, files[3], self.work / "peer", *(("constant", "--point-size", px) if px else ("potree",)))

        colours = {px: draw(files[0], px) for px in (0, *self.size.sizes)}  # 0: Potree's
        labels = {0: draw(files[1], 0)}
        for i, (view, truth) in enumerate(zip(of_scene, truths)):
            best = min(self.size.sizes, key=lambda px: truth.likeness(colours[px][1][2 * i])["flip"])
            for px, name in ((0, views.POTREE), (best, f"{views.CONSTANT}, {best} px")):
                if px not in labels:
                    labels[px] = draw(files[1], px)
                cost, pictures = colours[px]
                figures = truth.figures(pictures[2 * i], labels[px][1][2 * i], pictures[2 * i + 1])
                self.add(view["name"], name, "both", {**figures, "jolt": 0.0, "offset": truth.offset(labels[px][1][2 * i])}, cost["cpu_seconds"][2 * i], cost["points_drawn"][2 * i])
                shown[view["name"]][name] = pictures[2 * i]

    def add(self, view, method, state, figures, cpu, points):
        self.rows.append({"view": view, "method": method, "state": state, **figures, "cpu_ms": 1000 * cpu, "points": points})
        row = self.rows[-1]
        print(f"{view:10} {method:24} {state:7} " + " ".join(f"{name} {row[name]:.4g}" for name in ("flip", "holes", "spill", "covered", "turn", "swim", "jolt", "cpu_ms") if name in row),
              flush=True)

    def measure(self):
        for scene, of_scene in self.scenes().items():
            files, truths = self.prepare(scene, of_scene)
            shown = {view["name"]: {"truth": truth.colours} for view, truth in zip(of_scene, truths)}
            self.truths += [{"view": view["name"], **truth.own()} for view, truth in zip(of_scene, truths)]
            self.ours(scene, of_scene, files, truths, shown)
            self.peers(of_scene, files, truths, shown)
            for view, pictures in shown.items():
                truth_report.composite(self.a.out / f"{view}.png", pictures)
            self.write()
        for file in self.a.cloud:
            self.real(file)
            self.write()

    def write(self):
        """What was measured, and what earlier runs have of other views."""
        what = {"points": self.size.points, "moving_points": self.size.moving_points, "size": self.picture_size}
        old = json.loads(self.file.read_text()) if self.file.exists() else {}
        if any(old.get(name) != value for name, value in what.items()):
            old = {}
        here = {row["view"] for row in self.rows}
        (self.a.out / "sys_info.txt").unlink(missing_ok=True)
        study.describe_machine(self.a.out, self.work, {"gl": self.gl})
        result = {**what, "machine": (self.a.out / "sys_info.txt").read_text().strip()}
        for name, found in (("truths", self.truths), ("rows", self.rows)):
            result[name] = [row for row in old.get(name, []) if row["view"] not in here] + found
        self.file.write_text(json.dumps(result, indent=1) + "\n")
        truth_report.write(self.a.out, result, self.before)

    def real(self, file):
        """A scan without truth: what is covered, how calm it is, and what it costs."""
        name, shown = file.stem, {}
        for method, (radii, options) in views.OURS.items():
            tree = self.work / f"{name}.pct"
            self.build(file, tree, radii)
            view = views.oblique(json.loads(call([self.a.bin / "pcmlab", "info", tree, "--json"])))
            paths = views.paths([view], self.size)
            for kind, path in zip(("both", "arriving"), paths[1:]):
                (self.work / f"{name}-{kind}.json").write_text(json.dumps(path))
            drawn, pictures = self.draw(tree, self.work / f"{name}-arriving.json", self.work / "drawn", "--converge", self.a.converge, *options)
            for state in views.STATES:
                self.add(name, method, state, views.without_truth(view, pictures, state), drawn[f"{state}_cpu_seconds"][0], drawn[f"{state}_points"][0])
                shown[f"{method}, {'moving' if state == 'moving' else 'at rest'}"] = pictures[state][0]
        try:
            drawn, still = self.draw_peer(file, self.work / f"{name}-both.json", self.work / "peer", "potree")
            self.add(name, views.POTREE, "both", views.without_truth(view, {"rest": still}, "rest"), drawn["cpu_seconds"][0], drawn["points_drawn"][0])
            shown[views.POTREE] = still[0]
        except RuntimeError as error:
            print(f"{name}: no picture by {views.POTREE}: {error}", flush=True)
        truth_report.composite(self.a.out / f"{name}.png", shown)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, help="where pcmlab, bench_pictures, bench_scenes and bench_peers are")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--work", type=pathlib.Path, help="for clouds, true pictures and trees (default: OUT/work)")
    parser.add_argument("--quick", action="store_true", help="three views, small pictures and clouds, with checks: what the tests run")
    parser.add_argument("--view", action="append", default=[], help="only this one; repeatable")
    parser.add_argument("--points", type=lambda t: int(float(t)), help="of each cloud")
    parser.add_argument("--cloud", action="append", default=[], type=pathlib.Path, help="a real scan, in addition")
    parser.add_argument("--before", type=pathlib.Path, metavar="FIGURES", help="figures.json of an earlier run, which the report sets beside these")
    parser.add_argument("--only-clouds", action="store_true", help="of --cloud, without the generated scenes")
    parser.add_argument("--converge", type=int, default=16, help="frames of which a complete picture is the mean (16, as the window has it); 1: a single one")
    parser.add_argument("--report", action="store_true", help="only the report")
    parser.add_argument("--python", help="start with this interpreter")
    a = parser.parse_args()
    size = views.QUICK if a.quick else views.FULL
    size.points = a.points or size.points
    file = a.out / "figures.json"
    if a.report:
        truth_report.write(a.out, read_figures(file), read_figures(a.before))
        return
    if not a.bin:
        parser.error("--bin is needed to measure")
    a.out.mkdir(parents=True, exist_ok=True)
    if a.quick:
        file.unlink(missing_ok=True)
    try:
        about = json.loads(call([a.bin / "bench_pictures", "about"]))
    except RuntimeError as error:
        if not a.quick:
            raise
        print(f"skipped: {error}")
        sys.exit(77)
    comparison = Comparison(a, size, about["gl"])
    comparison.measure()
    if a.quick:
        truth_check.check(read_figures(file), a.out)


if __name__ == "__main__":
    main()
