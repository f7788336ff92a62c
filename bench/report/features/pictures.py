"""Pictures by the budget of a frame, moving, and by the frames of a mean, at rest."""
import importlib.util
import json
import shutil
import struct
import sys

from report.lab import BENCH
from study import process

TITLE = "Pictures by budget, moving and at rest"
WHAT = ("A generated town from 50 m and a furnished room, scanned with shadows, drawn without eye-dome lighting. Truth: the same surfaces ray-traced. The error is FLIP against truth, of the pixels that show what a scanner saw. "
        "*Moving*: a frame on arrival, with a budget of time (the default) or of points; *at rest*: all points, the mean of a number of frames, and its time is that of all these frames. Time is of all threads, "
        "of a frame. *Potree's rule* and *CloudCompare-like* (squares of the constant size that has the least error) are re-made: the rules of other programs by our code, with all points in video memory; their pictures are "
        "the same moving and at rest.")
ERROR = "FLIP against truth"
EXACT = ""
WHY = ("frames of peers are drawn out of buffers in video memory that hold the whole cloud, and in one pass; ours come out of a tree of any size, close gaps, and at rest are the mean of 16 frames. "
       "Where a peer has an error as small, as among thin things, its dots leave open what lies behind.")
DEFAULT_KEPT = ("the mean of 16 frames is for what FLIP of one picture does not show: colours that do not swim when the camera turns "
                "([pictures/truth/report.md](pictures/truth/report.md), *swim*). It is spent while the camera rests, and ends at a touch. "
                "Moving, the budget of time follows a machine that other work slowed down: which number of points it comes to differs from run to run.")
VIEWS = ("town", "interior")
BUDGETS = {"full": (30_000, 100_000, 300_000, 1_000_000), "quick": (30_000, 60_000, 120_000), "smoke": (10_000,)}  # no fewer than a chunk has
MILLISECONDS = {"full": (5, 15, 50, 150), "quick": (5, 15, 50), "smoke": (15,)}
FRAMES = {"full": (1, 2, 4, 8, 16, 32), "quick": (1, 4, 16, 32), "smoke": (1, 16)}
SIZES = (1, 2, 3, 5)  # pixels
PACKAGES = ("skimage", "flip_evaluator")
PROGRAMS = ("bench_pictures", "bench_scenes", "bench_peers")


def missing(lab):
    return [name for name in PACKAGES if not importlib.util.find_spec(name)] + [name for name in PROGRAMS if not lab.has(name)]


def tools():
    """views.py and metrics.py of bench/pictures, which are written to be found in their folder."""
    folder = str(BENCH / "pictures")
    if folder not in sys.path:
        sys.path.append(folder)
    return importlib.import_module("views"), importlib.import_module("metrics")


def move_las(source, target, by):
    """The same points elsewhere: the offset and the bounds in the header."""
    data = bytearray(source.read_bytes())
    offset = struct.unpack_from("<3d", data, 155)
    struct.pack_into("<3d", data, 155, *(value + more for value, more in zip(offset, by)))
    bounds = struct.unpack_from("<6d", data, 179)  # largest and least of x, of y, of z
    struct.pack_into("<6d", data, 179, *(value + by[i // 2] for i, value in enumerate(bounds)))
    target.write_bytes(data)


def moved_path(path, by):
    frames = [{**frame, **{key: [value + more for value, more in zip(frame[key], by)] for key in ("eye", "target")}} for frame in path["frames"]]
    return {**path, "frames": frames}


class View:
    """A view of a scene: its true picture, and its cloud, tree and camera paths at a place."""

    def __init__(self, lab, name, place):
        self.lab, self.views, self.metrics = lab, *tools()
        self.size = self.views.Size(lab.size.points, 320, 240) if lab.size.name != "full" else self.views.Size(lab.size.points, 640, 480)
        self.pixels = f"{self.size.width}x{self.size.height}"
        about = json.loads(process.timed([lab.bin / "bench_scenes", "about"])[0])["views"]
        self.view = next(view for view in about if view["name"] == name)
        self.folder = lab.work / f"view-{name}"
        self.las, self.tree = self.folder / f"{place}.las", self.folder / f"{place}.pct"
        self.still, self.arriving = self.folder / f"{place}-still.json", self.folder / f"{place}-arriving.json"
        self.prepare(lab.places[place])
        self.truth = self.views.Truth(self.view, *(self.metrics.read(next(self.folder.glob(f"*-{kind}.png"))) for kind in ("colours", "labels", "facts")))

    def prepare(self, by):
        if not (self.folder / "done").exists():
            self.folder.mkdir(exist_ok=True)
            colours = self.folder / "colours.las"
            process.timed([self.lab.bin / "bench_scenes", "scan", self.view["scene"], "--points", self.size.points, "-o", colours, "--labels", self.folder / "labels.las"])
            (self.folder / "path.json").write_text(json.dumps(self.views.paths([self.view], self.size)[0]))
            process.timed([self.lab.bin / "bench_scenes", "truth", self.view["scene"], "--path", self.folder / "path.json", "--out", self.folder, "--size", self.pixels])
            (self.folder / "done").touch()
        still, _, arriving = self.views.paths([self.view], self.size)
        self.still.write_text(json.dumps(moved_path(still, by)))
        self.arriving.write_text(json.dumps(moved_path(arriving, by)))
        move_las(self.folder / "colours.las", self.las, by)
        process.timed([self.lab.bin / "pcmlab", "build", self.las, "-o", self.tree, "--overwrite", "-q"])

    def error(self, file):
        return self.truth.likeness(self.metrics.read(file))["flip"]

    def ours(self, *options):
        """(words, figures, folder) of frames on arrival and at rest."""
        out = self.lab.work / "drawn"
        shutil.rmtree(out, ignore_errors=True)
        words = ["bench_pictures", "views", self.tree, "--path", self.arriving, "--out", out, "--size", self.pixels, "--eye-dome", 0, "--passes", 2, *options]
        text, _ = process.timed([self.lab.bin / words[0], *words[1:]])
        return words, json.loads(text), out

    def peer(self, rule, *options):
        out = self.lab.work / "drawn"
        shutil.rmtree(out, ignore_errors=True)
        words = ["bench_peers", self.las, "--rule", rule, "--path", self.still, "--out", out, "--size", self.pixels, *options]
        text, _ = process.timed([self.lab.bin / words[0], *words[1:]])
        return words, json.loads(text)["cpu_seconds"], sorted(out.glob("*.png"))[0]


def row(lab, view, place, state, program, setting, words, times, error, default=False, **more):
    times = sorted(times)
    return {"curve": f"{view.view['name']}, {state}", "place": place, "program": program, "setting": setting, "default": default, "cpu": times[len(times) // 2],
            "cpu_range": [times[0], times[-1]], "error": error, **more, "command": " ".join(lab.shown(str(word)) for word in words)}


def moving_rows(lab, view, place):
    settings = [("time by itself", (), True)]
    settings += [(f"{ms} ms", ("--frame-budget-ms", ms), False) for ms in MILLISECONDS[lab.size.name]]
    settings += [(f"{budget:,} points", ("--frame-budget-ms", 1e6, "--point-budget", budget), False) for budget in BUDGETS[lab.size.name]]
    for setting, options, default in settings:
        turns = [view.ours("--converge", 1, *options) for _ in range(min(2, lab.size.repeat))]
        words, figures, out = turns[-1]
        error = view.error(sorted(out.glob("*-moving.png"))[0])
        yield row(lab, view, place, "moving", "pcmlab", setting, words, [turn[1]["moving_cpu_seconds"][0] for turn in turns], error, default, points=figures["moving_points"][0])


def resting_rows(lab, view, place):
    for frames in FRAMES[lab.size.name]:
        turns = [view.ours("--converge", frames, "--frame-budget-ms", 1e6) for _ in range(min(2, lab.size.repeat))]
        words, figures, out = turns[-1]
        error = view.error(sorted(out.glob("*-rest.png"))[0])
        yield row(lab, view, place, "at rest", "pcmlab", f"{frames} frames", words, [turn[1]["rest_cpu_seconds"][0] for turn in turns], error, frames == 16, points=figures["rest_points"][0])


def peer_rows(lab, view, place):
    drawn = [("Potree's rule, re-made", "", view.peer("potree"))]
    drawn = [(name, setting, words, times, view.error(file)) for name, setting, (words, times, file) in drawn]
    constant = []
    for px in SIZES:
        words, times, file = view.peer("constant", "--point-size", px)
        constant.append(("CloudCompare-like", f"{px} px", words, times, view.error(file)))
    drawn.append(min(constant, key=lambda one: one[-1]))
    for name, setting, words, times, error in drawn:
        for state in ("moving", "at rest"):
            yield row(lab, view, place, state, name, setting, words, times, error)


def measure(lab):
    rows = []
    for name in VIEWS if not missing(lab) else ():
        for place in lab.places:
            view = View(lab, name, place)
            rows += [*moving_rows(lab, view, place), *resting_rows(lab, view, place), *peer_rows(lab, view, place)]
    return [each for curve in dict.fromkeys(each["curve"] for each in rows) for each in rows if each["curve"] == curve]


def absent(lab):
    return [*([f"what draws and compares: {', '.join(missing(lab))}"] if missing(lab) else []), "Potree and CloudCompare themselves: not installed; their rules are re-made"]
