"""The tasks of run.py with laspy, and with SciPy where neighbours are needed."""
import laspy
import numpy

NEEDS = "las"


def inside(points, box):
    x, y, z = points.x, points.y, points.z
    return (x >= box[0]) & (x <= box[3]) & (y >= box[1]) & (y <= box[4]) & (z >= box[2]) & (z <= box[5])


def count(files):
    with laspy.open(files["las"]) as file:
        return [file.header.point_count, *file.header.mins, *file.header.maxs]


def box(files):
    las = laspy.read(files["las"])
    found = las.points[inside(las, files["box"])]
    xyz = numpy.stack([found.x, found.y, found.z], axis=1)
    return [len(xyz), xyz.mean(), numpy.asarray(found.intensity).mean(), numpy.asarray(found.classification).mean()]


def mean_height(files):
    count, total = 0, 0.0
    with laspy.open(files["las"]) as file:
        for points in file.chunk_iterator(1_000_000):
            heights = numpy.asarray(points.z)[points.classification == 2]
            count, total = count + len(heights), total + heights.sum()
    return [count, total / count]


def nearest(files):
    from scipy.spatial import cKDTree

    tree = cKDTree(laspy.read(files["las"]).xyz)
    return [tree.query(files["places"], k=8)[0].mean()]


def outliers(files):
    from scipy.spatial import cKDTree

    las = laspy.read(files["las"])
    xyz = las.xyz
    distances = cKDTree(xyz).query(xyz, k=17)[0][:, 1:].mean(axis=1)
    las.points = las.points[distances <= distances.mean() + 3 * distances.std(ddof=1)]
    las.write(files["out"] + ".las")
    return [len(las.points)]


def reclassify(files):
    las = laspy.read(files["las"])
    chosen = inside(las, files["box"])
    las.classification[chosen] = 7
    las.write(files["out"] + ".las")
    return [int(chosen.sum())]
