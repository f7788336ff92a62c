"""Where features are measured: programs, clouds, and turns."""
import dataclasses
import importlib.util
import json
import os
import pathlib
import statistics
import subprocess
import sys
import time

import numpy

from neighbours import scenes
from study import machine, process


BENCH = pathlib.Path(__file__).resolve().parents[1]


@dataclasses.dataclass
class Size:
    name: str
    points: int   # of a generated cloud
    sample: int   # points, places or boxes that are compared with truth
    repeat: int   # turns of each program; their medians count
    seeds: int    # scenes of a fit


FULL = Size("full", 1_000_000, 1000, 5, 40)
QUICK = Size("quick", 200_000, 300, 3, 12)
SMOKE = Size("smoke", 8_000, 40, 1, 2)

# The map is far enough that a float has steps of half a metre.
PLACES = {"origin": (0.0, 0.0, 0.0), "map": (500000.0, 4500000.0, 100.0)}


class Command:
    """A command of ours, timed as a whole process by the kernel. read(): its JSON answer."""

    def __init__(self, lab, words, setting, default=False, name="pcmlab", read=None):
        self.lab, self.words, self.setting, self.default, self.name, self.reader = lab, [str(word) for word in words], setting, default, name, read
        self.answer = None

    def run(self):
        text, usage = process.timed([self.lab.bin / self.words[0], *self.words[1:]])
        self.answer = text
        return usage

    def read(self):
        answer = json.loads(self.answer)
        return self.reader(answer) if self.reader else answer

    def command(self):
        return " ".join(self.lab.shown(word) for word in self.words)


class Call:
    """A function in this process: a peer's, or the Python module of ours. Its processor time counts, that of preparing it does not."""

    def __init__(self, name, setting, function, text, default=False):
        self.name, self.setting, self.function, self.text, self.default = name, setting, function, text, default
        self.value = None

    def run(self):
        start = time.process_time()
        self.value = self.function()
        return {"cpu": time.process_time() - start}

    def read(self):
        return self.value

    def command(self):
        return self.text


class Lab:
    def __init__(self, binaries, work, size):
        self.bin, self.size = binaries.resolve(), size
        self.work = work / size.name
        self.work.mkdir(parents=True, exist_ok=True)
        self.places = PLACES

    def has(self, program):
        return (self.bin / program).exists()

    def module(self):
        """Our Python module as it was built next to the programs; None where it was not."""
        folder = self.bin.parent / "python"
        if folder.is_dir() and str(folder) not in sys.path:
            sys.path.append(str(folder))
        if not importlib.util.find_spec("pcmlab"):
            return None
        try:
            return importlib.import_module("pcmlab")
        except ImportError:
            return None

    def shown(self, word):
        """A word of a command without the folders of this machine."""
        return word.replace(f"{self.work}/", "").replace(f"{self.bin}/", "")

    def ask(self, *words):
        """The JSON answer of a command that is not timed."""
        return json.loads(process.timed([self.bin / "pcmlab", *words, "--json"])[0])

    def scene(self, place, points=None):
        """The generated site with its truth, as a LAS file and a tree; made once."""
        points = points or self.size.points
        las = self.work / f"{place}-{points}.las"
        if not las.exists():
            process.timed([self.bin / "pcmlab", "generate", "-q", "-n", points, "--origin", *self.places[place], las])
        scene = scenes.Scene(las.stem, las, self.work)
        if not scene.tree.exists():
            process.timed([self.bin / "pcmlab", "build", "-q", "-o", scene.tree, las])
        return scene

    def columns(self, tree, names, level=None):
        """Positions of a tree's points, n x 3, and the columns of these names in a PLY file, n x names."""
        file = self.work / "columns.ply"
        process.timed([self.bin / "pcmlab", "convert", "-q", "--overwrite", tree, file, *([] if level is None else ["--level", level])])
        table = scenes.read_ply(file)
        return tuple(numpy.stack([table[name].astype(float) for name in of], axis=1) if of else None for of in ("xyz", names))

    def levels(self, tree):
        return self.ask("info", tree)["levels"]

    def take_turns(self, place, programs, judge, repeat=None):
        """A row for each program. judge(value, program): {"error": ...} and whatever else a row is to have, of what its first turn found."""
        runs, found = {program: [] for program in programs}, {}
        for turn in range(repeat or self.size.repeat):
            for program in programs:
                runs[program].append(program.run())
                if turn == 0:
                    found[program] = judge(program.read(), program)
        rows = []
        for program in programs:
            times = [run["cpu"] for run in runs[program]]
            rows.append({"place": place, "program": program.name, "setting": program.setting, "default": program.default,
                         "cpu": statistics.median(times), "cpu_range": [min(times), max(times)], **found[program], "command": program.command()})
        return rows

    def machine(self):
        """What the figures belong to: name -> text."""
        revision = subprocess.run(["git", "-C", os.path.dirname(__file__), "describe", "--always", "--dirty"], capture_output=True, text=True, check=False)
        text = machine.describe(self.work, {"gl": self.gl()}, revision.stdout.strip() or process.timed([self.bin / "pcmlab", "--version"])[0].strip())
        start = statistics.median(process.timed([self.bin / "pcmlab", "--version"])[1]["cpu"] for _ in range(5))
        return {**dict(line.split(": ", 1) for line in text.splitlines()), "start of pcmlab, CPU ms": f"{1000 * start:.1f}"}

    def gl(self):
        if not self.has("bench_pictures"):
            return "not asked: bench_pictures is not built"
        about = subprocess.run([self.bin / "bench_pictures", "about"], capture_output=True, text=True, check=False)
        return json.loads(about.stdout)["gl"] if about.returncode == 0 else "none"
