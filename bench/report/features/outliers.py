"""Statistical outliers."""
import numpy
from scipy.spatial import cKDTree

from neighbours import scenes
from report.features import by_neighbours
from report.lab import Call, Command

TITLE = "Outliers"
WHAT = ("Points whose mean distance to their 16 neighbours is above the mean of all by 2 standard deviations. The error is the share of all points that are labelled otherwise than by "
        "mean distances in double. It is exact, and has no cheaper setting.")
ERROR = "points labelled otherwise, %"
EXACT = "Outliers.AreThoseOfComparingAllPairsAtAnyOffset"
FLOOR = 0.0
K, SIGMAS = 16, 2


def by_scipy(xyz):
    mean = cKDTree(xyz).query(xyz, K + 1)[0].sum(axis=1) / K
    return mean > mean.mean() + SIGMAS * mean.std()


def measure(lab):
    rows = []
    for place in lab.places:
        scene = lab.scene(place)
        expected = scenes.exact_outliers(scene, K, SIGMAS)
        result = lab.work / "outliers.pct"
        mine = Command(lab, ["pcmlab", "outliers", scene.tree, "-k", K, "-a", SIGMAS, "--label", "-o", result, "--overwrite", "--json", "-q", "-t", 1], "statistical", default=True,
                       read=by_neighbours.column_reader(lab, scene, result, ["outlier"]))
        peers = [Call(f"SciPy cKDTree, {kind.__name__}", "", lambda kind=kind: by_scipy(scene.xyz.astype(kind)), "cKDTree(positions).query(positions, 17), mean, deviation")
                 for kind in (numpy.float64, numpy.float32)]
        rows += lab.take_turns(place, [mine, *peers], lambda found, _: {"error": 100 * float(((found != 0) != expected).mean()), "outliers": int((found != 0).sum())})
    return rows


def absent(lab):
    return ["PCL's StatisticalOutlierRemoval and Open3D: bench/neighbours/run.py compares with them where they are"]
