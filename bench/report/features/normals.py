"""Normals."""
import numpy
from scipy.spatial import cKDTree

from neighbours import scenes
from report.features import by_neighbours
from report.lab import Call

TITLE = "Normals"
WHAT = ("The normal of every point of its 16 neighbours. The error is the angle to the plane " + by_neighbours.EXACT_WHERE + ", by principal components in double, of points whose neighbours "
        "define a plane; the 95th percentile. *To truth*: the mean angle to the generator's surface, whose points have noise of 3 mm: what no program can be rid of. *SciPy* is a k-d tree and NumPy's eigenvectors.")
ERROR = "95 % angle to exact, degrees"
EXACT = "NeighbourAttributes.AreThoseOfComparingAllPairs"
FLOOR = 2e-3  # normals are kept as floats of a thousandth of a degree
K = 16


def by_scipy(xyz, kind):
    positions = xyz.astype(kind)
    around = cKDTree(positions).query(positions, K + 1)[1]
    normals = numpy.empty((len(xyz), 3))
    for first in range(0, len(xyz), 50_000):
        points = positions[around[first:first + 50_000]]
        points = points - points.mean(axis=1, keepdims=True)
        normals[first:first + 50_000] = numpy.linalg.eigh(numpy.einsum("nki,nkj->nij", points, points))[1][:, :, 0]
    return normals


def measure(lab):
    rows = []
    for place in lab.places:
        scene = lab.scene(place)
        sample = by_neighbours.Sample(lab, scene, K)
        exact, defined = scenes.exact_normals(scene, sample.points, sample.indices)
        plane = defined > 0.05
        truth, known = scene.true_normals()

        def judge(found, _):
            return {"error": by_neighbours.p95(scenes.angles(found[sample.points], exact)[plane]), "to truth, degrees": float(scenes.angles(found[known], truth[known]).mean())}

        peers = [Call("SciPy and NumPy, doubles", "", lambda: by_scipy(scene.xyz, numpy.float64), "cKDTree(positions).query, numpy.linalg.eigh"),
                 Call("SciPy and NumPy, floats", "", lambda: by_scipy(scene.xyz, numpy.float32), "the same with float32")]
        rows += lab.take_turns(place, [by_neighbours.ours(lab, scene, ["normals", "--no-confidence"], ["nx", "ny", "nz"], K), *peers], judge)
    return rows


def absent(lab):
    return ["PCL, CGAL, Open3D and MeshLab: bench/neighbours/run.py compares with those that are installed (its report is a chapter below)"]
