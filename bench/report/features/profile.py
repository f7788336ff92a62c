"""Profiles by level."""
import csv

import laspy
import numpy

from report.features.terrain import Terrain, height
from report.lab import Call, Command

TITLE = "Profiles by level"
WHAT = ("The points within 0.25 m of a line of 80 m across the terrain of the chapter on volumes, in order of their stations. The error is the difference of the profile's height, interpolated "
        "between its points every 10 cm, to the terrain's formula; the 95th percentile: it contains the noise of 2 cm, and the slope across the line. *laspy*: reads the file, takes the same points.")
ERROR = "95 % error of the height, m"
EXACT = ""
DEFAULT_KEPT = "a profile is asked for with every point near its line, and a level saves 2 ms of a process here."
WHY = "this file is small enough to be read as a whole in less time than a process takes to start and to write a CSV; ours reads what is near the line, of a cloud of any size."
BEGIN, END, WIDTH = (8.0, 21.0), (88.0, 81.0), 0.5


def stations_of(xy):
    along = numpy.subtract(END, BEGIN) / numpy.hypot(*numpy.subtract(END, BEGIN))
    away = xy - BEGIN
    return away @ along, away @ (along[1], -along[0])


def read_csv(file):
    with open(file, newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    return numpy.array([[float(row["station"]), float(row["z"])] for row in rows])


def error_of(profile, base):
    length = numpy.hypot(*numpy.subtract(END, BEGIN))
    wanted = numpy.arange(0.5, length - 0.5, 0.1)
    place = numpy.add(BEGIN, numpy.outer(wanted / length, numpy.subtract(END, BEGIN)))
    order = numpy.argsort(profile[:, 0])
    found = numpy.interp(wanted, profile[order, 0], profile[order, 1] - base)
    return float(numpy.percentile(abs(found - height(place[:, 0], place[:, 1])), 95))


def by_laspy(terrain):
    xyz = numpy.asarray(laspy.read(terrain.las).xyz)
    station, offset = stations_of(xyz[:, :2] - terrain.origin[:2])
    near = (abs(offset) <= WIDTH / 2) & (station >= 0) & (station <= numpy.hypot(*numpy.subtract(END, BEGIN)))
    return numpy.column_stack([station[near], xyz[near, 2]])


def measure(lab):
    rows = []
    for place in lab.places:
        terrain = Terrain(lab, place)
        file = lab.work / "profile.csv"
        common = ["pcmlab", "profile", terrain.tree, "--line", *terrain.plan(*BEGIN, *END), "-w", WIDTH, "-o", file, "--overwrite", "--json", "-q"]
        mine = [Command(lab, common, "all points", default=True, read=lambda _: read_csv(file))]
        mine += [Command(lab, [*common, "-l", level], f"level {level}", read=lambda _: read_csv(file)) for level in range(lab.levels(terrain.tree) - 2, 1, -1)]
        peers = [Call("laspy", "", lambda: by_laspy(terrain), "laspy.read, a mask by NumPy")]
        rows += lab.take_turns(place, [*mine, *peers], lambda found, _: {"error": error_of(found, terrain.origin[2]), "points": len(found)})
    return rows


def absent(lab):
    return []
