"""Fits at a place, by the neighbourhood."""
import numpy

from report.lab import Command

TITLE = "Fits at a place by neighbourhood"
WHAT = ("A click on a cylinder or a sphere of the generated site: its radius, from this number of points around the place, or from a neighbourhood that is chosen by itself, and then followed through "
        "the cloud (the default) or not. The error is the difference to the true radius, over it; the median of the places, where a fit that finds another radius by more than that, or none, counts as 100 %. "
        "*Flagged*: fits that are reported as doubtful, or refused. Time is that of the whole process, one fit.")
ERROR = "median error of the radius, %"
EXACT = ""
COUNTS = (30, 100, 300, 1000, 3000)


class Clicks(Command):
    """Fits at all places, a process each; the time of one. A fit that is refused has no radius."""

    def __init__(self, lab, tree, places, setting, *options, default=False):
        super().__init__(lab, ["pcmlab", "fit", tree, "--json", "-q", "-t", 1, *options], setting, default)
        self.places, self.common, self.found = places, self.words, []

    def run(self):
        cpu, self.found = 0.0, []
        for place, kind, _ in self.places:
            self.words = [*self.common, "--shape", kind, "--at", *(f"{value:.4f}" for value in place)]
            try:
                cpu += super().run()["cpu"]
                self.found.append(super().read()["primitive"])
            except RuntimeError:
                self.found.append(None)
        return {"cpu": cpu / len(self.places)}

    def read(self):
        return self.found


def clicks(scene, count):
    """Points of the largest cylinders and spheres: (place, kind, true radius)."""
    round_ones = sorted((one for one in scene.truth if one["kind"] in ("cylinder", "sphere")), key=lambda one: -one["points"])[:count]
    random = numpy.random.default_rng(2)
    for one in round_ones:
        of_it = numpy.flatnonzero(scene.ids == one["id"])
        yield scene.xyz[random.choice(of_it)], one["kind"], one["radius"]


def measure(lab):
    rows = []
    for place in lab.places:
        scene = lab.scene(place)
        places = list(clicks(scene, lab.size.seeds))
        mine = [Clicks(lab, scene.tree, places, "chosen, followed", default=True), Clicks(lab, scene.tree, places, "chosen", "--no-grow")]
        mine += [Clicks(lab, scene.tree, places, f"{count} points", "--no-grow", "--count", count) for count in COUNTS]

        def judge(found, _):
            errors = [100.0 if one is None else min(100.0, 100 * abs(one["radius"] - radius) / radius) for one, (_, _, radius) in zip(found, places)]
            flagged = [one is None or one["verdict"] != "good" for one in found]
            return {"error": float(numpy.median(errors)), "95 %": float(numpy.percentile(errors, 95)), "flagged, %": 100 * float(numpy.mean(flagged))}

        rows += lab.take_turns(place, mine, judge, repeat=1)
    return rows


def absent(lab):
    return ["CloudCompare, which fits to points that were cut out by hand, and PCL, which has no fit at a place: `fits` compares the fit itself"]
