"""Levels of detail that are made quickly, and those that are made evenly."""
import numpy
from scipy.spatial import cKDTree

from report.lab import Call, Command

TITLE = "Levels made quickly (`--fast`) and evenly"
WHAT = ("A file becomes a tree; time is that of the whole process. Levels are Poisson samples, or with `--fast` samples on a grid. The error is how uneven the distances to the nearest other point are "
        "in the finest level but one: their standard deviation over their mean. No point is lost by either. *NumPy, random* takes as many points at random, which is what a level of a constant share is; "
        "it makes no tree.")
ERROR = "unevenness of a level, %"
EXACT = ""
WHY = "points at random make no tree: nothing is written, and a view cannot draw a part of them."


def unevenness(points):
    distances = cKDTree(points - points.min(axis=0)).query(points - points.min(axis=0), 2)[0][:, 1]
    return 100 * float(distances.std() / distances.mean())


def measure(lab):
    rows = []
    for place in lab.places:
        scene, tree = lab.scene(place), lab.work / "levels.pct"
        def of_level(_):
            return lab.columns(tree, [], lab.levels(tree) - 2)[0]

        common = ["pcmlab", "build", scene.las, "-o", tree, "--overwrite", "--json", "-q", "-t", 1]
        mine = [Command(lab, common, "evenly", default=True, read=of_level), Command(lab, [*common, "--fast"], "--fast", read=of_level)]
        count = len(scene.xyz) // 4
        peers = [Call("NumPy, random", "", lambda: scene.xyz[numpy.random.default_rng(1).permutation(len(scene.xyz))[:count]], "numpy.random.permutation")]
        rows += lab.take_turns(place, [*mine, *peers], lambda found, _: {"error": unevenness(found), "points of the level": len(found)})
    return rows


def absent(lab):
    return ["PotreeConverter, untwine and copc_converter: not installed; `bench/tree/run.py --peer` compares builds with them"]
