"""Curvature."""
import numpy
from scipy.spatial import cKDTree

from report.features import by_neighbours
from report.lab import Call

TITLE = "Curvature"
WHAT = ("The share of the smallest eigenvalue in the sum of all three, of every point's 16 neighbours and itself, 0 to 1/3. The error is the difference to that " + by_neighbours.EXACT_WHERE +
        ", in double; the 95th percentile.")
ERROR = "95 % error of the curvature"
EXACT = "NeighbourAttributes.AreThoseOfComparingAllPairs"
FLOOR = 1e-6  # kept as floats
K = 16


def of_neighbours(positions, around):
    """The share of the least eigenvalue, for each row of numbers of points."""
    points = positions[around]
    points = points - points.mean(axis=1, keepdims=True)
    values = numpy.linalg.eigvalsh(numpy.einsum("nki,nkj->nij", points, points))
    return numpy.clip(values[:, 0], 0, None) / numpy.maximum(values.sum(axis=1), 1e-300)


def by_scipy(xyz):
    around = cKDTree(xyz).query(xyz, K + 1)[1]
    return numpy.concatenate([of_neighbours(xyz, around[first:first + 50_000]) for first in range(0, len(xyz), 50_000)])


def measure(lab):
    rows = []
    for place in lab.places:
        scene = lab.scene(place)
        sample = by_neighbours.Sample(lab, scene, K)
        true = of_neighbours(scene.local, numpy.c_[sample.indices, sample.points])
        peers = [Call("SciPy and NumPy, doubles", "", lambda: by_scipy(scene.xyz), "cKDTree(positions).query, numpy.linalg.eigvalsh")]
        programs = [by_neighbours.ours(lab, scene, ["normals", "--no-confidence", "--curvature"], ["curvature"], K), *peers]
        rows += lab.take_turns(place, programs, lambda found, _: {"error": by_neighbours.p95(abs(found[sample.points] - true))})
    return rows


def absent(lab):
    return ["PCL's and CloudCompare's curvature: not in build/pcl-sdk, not installed"]
