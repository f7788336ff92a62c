"""Centroids of voxels."""
import numpy

from report.lab import Call, Command
from voxels.run import errors, exact

TITLE = "Voxel centroids"
WHAT = ("The centroid of the points of each voxel of 0.5 m. Truth: sums of whole steps of the grid, which are exact. The error is the largest of any coordinate of any voxel; where a program "
        "has other voxels than there are, it is the voxel's size. *NumPy* is what a user writes in three lines, in doubles and in floats.")
ERROR = "largest error, m"
EXACT = "VoxelGrid.EqualsAMapOfVoxelsOnCloudsOfAllKinds"
FLOOR = 2e-9
SIZE = 0.5


def by_numpy(xyz, kind):
    positions = xyz.astype(kind)
    _, voxel = numpy.unique(numpy.floor(positions / kind(SIZE)).astype(numpy.int64), axis=0, return_inverse=True)
    counts = numpy.bincount(voxel.ravel())
    return numpy.stack([numpy.bincount(voxel.ravel(), positions[:, axis]) / counts for axis in range(3)], axis=1)


def measure(lab):
    rows = []
    for place in lab.places:
        scene = lab.scene(place)
        numbers, centroids = exact(scene.xyz, SIZE, 0)
        result = lab.work / "voxels.pct"
        mine = Command(lab, ["pcmlab", "voxel", scene.tree, "-s", SIZE, "-o", result, "--overwrite", "--json", "-q", "-t", 1], "as it is", default=True,
                       read=lambda _, result=result: lab.columns(result, [])[0])
        peers = [Call("NumPy, doubles", "", lambda: by_numpy(scene.xyz, numpy.float64), "numpy.unique, numpy.bincount, float64"),
                 Call("NumPy, floats", "", lambda: by_numpy(scene.xyz, numpy.float32), "numpy.unique, numpy.bincount, float32")]

        def judge(found, _):
            error = errors(numpy.asarray(found, float), numbers, centroids, SIZE, 0)
            return {"error": SIZE if error is None else error, "voxels": len(found), "true voxels": len(numbers)}

        rows += lab.take_turns(place, [mine, *peers], judge)
    return rows


def absent(lab):
    return [] if lab.has("bench_voxels_pcl") else ["PCL's VoxelGrid: libpcl-filters is not here; with it `bench/voxels/run.py` compares (its floats lose three fifths of the voxels of 5 cm on the map)"]
