#!/usr/bin/env python3
"""Pipe runs in tables and drawings, against pipes laid here by rotation matrices; drawings read by ezdxf.

    pipe_runs.py --pcmlab PCMLAB --dump DUMP_CLOUD --data FOLDER [--python PYTHON]

Exit code 0 when all is equal, 1 when not, 77 (skipped) without the packages of requirements.txt.
"""
import csv
import json
import math
import pathlib
import sys
import tempfile

from check import common_arguments, skip
from measures import Checks, ORIGIN, faults_of, run

CHORD = 0.002


class Pipe:
    """Straight lines and arcs, one after the other, as shapes and as points of the centre line."""

    def __init__(self, numpy, random, number, bends):
        self.numpy, self.random, self.name = numpy, random, f"pipe {number}"
        frame, _ = numpy.linalg.qr(random.normal(size=(3, 3)))
        self.frame = frame * numpy.sign(numpy.linalg.det(frame))  # its columns: along, left, up
        self.place = numpy.array(ORIGIN) + numpy.array([60.0 * number, 0, 0])
        self.radius, self.length, self.bends = float(random.uniform(0.03, 0.2)), 0.0, bends
        self.shapes, self.points, self.colour = [], [self.place], [int(c) for c in random.integers(0, 256, 3)]
        self.straight(float(random.uniform(1, 4)))
        for _ in range(bends):
            self.bend(float(random.uniform(3, 8)) * self.radius, math.radians(float(random.uniform(15, 120))),
                      float(random.uniform(0, 2 * math.pi)))
            self.straight(float(random.uniform(1, 4)))

    def add(self, shape):
        self.shapes.append({"name": f"{self.name}, part {len(self.shapes) + 1}", "colour": self.colour, **shape})

    def straight(self, length):
        begin, along = self.place, self.frame[:, 0]
        self.place = begin + length * along
        self.add({"kind": "cylinder", "point": begin.tolist(), "axis": along.tolist(), "radius": self.radius,
                  "bounds": {"from": 0, "to": length}})
        self.length += length
        self.points += [begin + t * length * along for t in (0.25, 0.5, 0.75, 1)]

    def bend(self, radius, turn, roll):
        def about(angle, first, second):
            rotation = self.numpy.eye(3)
            rotation[[first, first, second, second], [first, second, first, second]] = (
                math.cos(angle), -math.sin(angle), math.sin(angle), math.cos(angle))
            return rotation

        self.frame = self.frame @ about(roll, 1, 2)
        centre, up, start = self.place + radius * self.frame[:, 1], self.frame[:, 2], -self.frame[:, 1]
        self.add({"kind": "torus", "point": centre.tolist(), "axis": up.tolist(), "radius": radius,
                  "tube_radius": self.radius, "bounds": {"zero": start.tolist(), "begin": 0, "end": turn}})
        for part in range(1, 101):
            turned = self.frame @ about(turn * part / 100, 0, 1)
            self.points.append(centre - radius * turned[:, 1])
        self.frame, self.place = turned, self.points[-1]
        self.length += radius * turn


def distance_to_polyline(numpy, p, corners):
    a, b = corners[:-1], corners[1:]
    d = b - a
    t = numpy.clip(numpy.einsum("ij,ij->i", p - a, d) / numpy.einsum("ij,ij->i", d, d), 0, 1)
    return float(numpy.min(numpy.linalg.norm(a + t[:, None] * d - p, axis=1)))


def check_drawing(numpy, ezdxf, checks, pipes, folder):
    drawing = ezdxf.readfile(folder / "runs.dxf")
    checks.equal("faults that ezdxf finds", faults_of(drawing), [])
    low, high = drawing.header["$EXTMIN"], drawing.header["$EXTMAX"]
    lines = {e.dxf.layer: e for e in drawing.modelspace() if e.dxf.layer.startswith("Pipe run")}
    checks.equal("entities on layers of runs", sum(e.dxf.layer in lines for e in drawing.modelspace()), len(pipes))
    for number, pipe in enumerate(pipes, 1):
        line = lines[f"Pipe run {number}"]
        checks.equal("what a run is drawn as", (line.dxftype(), line.is_3d_polyline, line.is_closed),
                     ("POLYLINE", True, False))
        checks.equal("colour", tuple(drawing.layers.get(line.dxf.layer).rgb), tuple(pipe.colour))
        corners = numpy.array([tuple(v.dxf.location) for v in line.vertices])
        ends = [float(numpy.linalg.norm(corners[i] - pipe.points[i])) for i in (0, -1)]
        checks.near(f"ends of {pipe.name}", max(ends), 0, 1e-6)
        off = max(distance_to_polyline(numpy, p, corners) for p in pipe.points)
        checks.equal(f"{pipe.name} is within the chord: {off}", off <= CHORD * 1.001, True)
        checks.equal("inside of the extents", bool((corners >= tuple(low)).all() and (corners <= tuple(high)).all()), True)


def check_table(checks, pipes, folder):
    with open(folder / "runs.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    runs = [row for row in rows if row["kind"] == "pipe run"]
    checks.equal("runs", len(runs), len(pipes))
    for row, pipe in zip(runs, pipes):
        checks.near(f"length of {pipe.name}", float(row["length [m]"]), pipe.length, 1e-6)
        checks.equal(f"error of the length of {pipe.name}", row["sigma_length [m]"] == "", True)  # those of its parts are not known
        checks.near(f"radius of {pipe.name}", float(row["radius [m]"]), pipe.radius, 1e-12)
        checks.equal("bends", int(row["bends"]), pipe.bends)
        checks.equal("parts", row["parts"], ", ".join(shape["name"] for shape in pipe.shapes))
        for key, place in (("from", pipe.points[0]), ("to", pipe.points[-1])):
            for axis, value in zip("xyz", place):
                checks.near(f"{key}_{axis}", float(row[f"{key}_{axis} [m]"]), float(value), 1e-6)
        parts = [other["name"] for other in rows if other["run"] == row["name"]]
        checks.equal("parts that name their run", parts, [shape["name"] for shape in pipe.shapes])


def check_answer(checks, pipes, answer):
    checks.equal("runs of the answer", [run["parts"] for run in answer["runs"]],
                 [[shape["name"] for shape in pipe.shapes] for pipe in pipes])
    for run_, pipe in zip(answer["runs"], pipes):
        bends = [piece for piece in run_["line"] if "angle" in piece]
        tori = [shape for shape in pipe.shapes if shape["kind"] == "torus"]
        checks.equal("bends of the line", len(bends), len(tori))
        for bend, torus in zip(bends, tori):
            checks.near("angle", bend["angle"], torus["bounds"]["end"], 1e-6)
            checks.near("bend's radius", bend["radius"], torus["radius"], 1e-6)


def main():
    arguments = common_arguments(__doc__, lambda parser: parser.add_argument("--pcmlab", required=True))
    try:
        import ezdxf
        import numpy
    except ImportError as error:
        skip(f"{error}; packaging/test-python installs what the comparison needs")
    checks, pcmlab = Checks(), arguments.pcmlab
    random = numpy.random.default_rng(11)
    pipes = [Pipe(numpy, random, number, 1 + number % 6) for number in range(24)]
    shapes = [shape for pipe in pipes for shape in pipe.shapes]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "list.json").write_text(json.dumps({"format": "pcm primitives", "version": 1, "primitives": shapes}))
        answer = run(pcmlab, "primitives", folder / "list.json", "-o", folder / "runs.dxf", "-o", folder / "runs.csv",
                     "--unit", "m", "--chord", CHORD, "--json")
        check_drawing(numpy, ezdxf, checks, pipes, folder)
        check_table(checks, pipes, folder)
        check_answer(checks, pipes, json.loads(answer))
    print(f"{len(pipes)} pipe runs: " + ("equal" if not checks.failed else f"{checks.failed} differences"))
    return 1 if checks.failed else 0


if __name__ == "__main__":
    sys.exit(main())
