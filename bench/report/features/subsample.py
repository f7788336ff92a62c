"""Thinning to a spacing."""
import numpy
from scipy.spatial import cKDTree

from report.lab import Call, Command

TITLE = "Subsamples"
WHAT = ("A cloud thinned to a spacing of 0.4 m: no two points nearer, and every point of the cloud has one that is. The error is the share of kept points that are nearer to another one, and of "
        "the cloud's points that have none within the spacing, together. *NumPy, random* keeps as many points at random; *NumPy, first of a voxel* the first point of each voxel.")
ERROR = "points that break the promise, %"
EXACT = "Subsample.ExactSpacingOnCloudsOfAllKinds"
WHY = "points at random cost nothing and keep no promise: 99 % break it."
FLOOR = 0.0
SPACING = 0.4


def broken(kept, scene):
    """Steps of a grid are compared, so that points exactly at the spacing count as they should."""
    low = scene.q.min(axis=0)
    steps = numpy.rint((kept - scene.offset) / scene.scale).astype(numpy.int64) - low
    tree, limit = cKDTree(steps), SPACING / scene.scale[0]
    near = tree.query(steps, 2)[0][:, 1] < limit - 1e-6
    alone = tree.query(scene.q - low)[0] > limit + 1e-6
    return 100 * float(near.mean() + alone.mean())


def first_of_voxels(xyz):
    return xyz[numpy.unique(numpy.floor(xyz / SPACING).astype(numpy.int64), axis=0, return_index=True)[1]]


def measure(lab):
    rows = []
    for place in lab.places:
        scene, result = lab.scene(place), lab.work / "subsample.pct"
        common = ["pcmlab", "subsample", scene.tree, "-s", SPACING, "-o", result, "--overwrite", "--json", "-q", "-t", 1]
        mine = [Command(lab, common, "exact", default=True, read=lambda _: lab.columns(result, [])[0]),
                Command(lab, [*common, "--nearest-level"], "nearest level", read=lambda _: lab.columns(result, [])[0])]
        count = len(first_of_voxels(scene.xyz))
        peers = [Call("NumPy, random", "", lambda: scene.xyz[numpy.random.default_rng(1).permutation(len(scene.xyz))[:count]], "numpy.random.permutation"),
                 Call("NumPy, first of a voxel", "", lambda: first_of_voxels(scene.xyz), "numpy.unique(floor(xyz / 0.4), axis=0, return_index=True)")]
        rows += lab.take_turns(place, [*mine, *peers], lambda found, _: {"error": broken(found, scene), "points": len(found)})
    return rows


def absent(lab):
    return ["CloudCompare's spatial subsampling and PDAL's filters.sample: not installed"]
