"""Radii of splats."""
import laspy
import numpy
from scipy.spatial import cKDTree

from report.features import by_neighbours
from report.lab import Call

TITLE = "Radii"
WHAT = ("The radius of every point's splat is the distance to its 6th neighbour. "
        "The error is the difference to the distance " + by_neighbours.EXACT_WHERE + ", over that distance; the 95th percentile. *SciPy* is what a user writes in a line.")
ERROR = "95 % error of a radius, %"
EXACT = "NeighbourAttributes.AreThoseOfComparingAllPairs"
FLOOR = 1e-5  # floats keep seven digits
K = 6


def from_file_to_file(lab, scene):
    """What a user of Python writes: reads the LAS, computes, and writes another."""
    def work():
        cloud = laspy.read(scene.las)
        found = cKDTree(cloud.xyz).query(cloud.xyz, K + 1)[0][:, -1]
        cloud.add_extra_dim(laspy.ExtraBytesParams("radius", "f4"))
        cloud.radius = found.astype(numpy.float32)
        cloud.write(lab.work / "peer.las")
        return found

    return Call("laspy and SciPy, file to file", "", work, f"laspy.read, cKDTree(xyz).query(xyz, {K + 1}), write")


def measure(lab):
    rows = []
    for place in lab.places:
        scene = lab.scene(place)
        sample = by_neighbours.Sample(lab, scene, K)
        true = sample.distances[:, -1]
        peers = [Call("SciPy cKDTree, doubles", "", lambda: cKDTree(scene.xyz).query(scene.xyz, K + 1)[0][:, -1], f"cKDTree(positions).query(positions, {K + 1})"),
                 from_file_to_file(lab, scene),
                 Call("SciPy cKDTree, floats", "", lambda: cKDTree(scene.xyz.astype(numpy.float32)).query(scene.xyz.astype(numpy.float32), K + 1)[0][:, -1],
                      "the same with float32, as viewers keep positions")]
        programs = [by_neighbours.ours(lab, scene, ["radii"], ["radius"], K), *peers]
        rows += lab.take_turns(place, programs, lambda found, _: {"error": by_neighbours.p95(100 * abs(found[sample.points] - true) / true)})
    return rows


def absent(lab):
    return []
