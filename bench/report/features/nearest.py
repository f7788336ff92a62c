"""Nearest neighbours of places, by level."""
import numpy
from scipy.spatial import cKDTree

from report.lab import Call

TITLE = "Nearest neighbours by level"
WHAT = ("The 8 nearest points of places near the cloud (points of it, moved by up to a metre), all in one call of our Python module, out of a tree whose chunks are in the cache. The error of "
        "an answer is the distance to its 8th neighbour less the true one, over the true one; the 95th percentile is shown. Truth: SciPy's k-d tree over positions that are "
        "exact to the last bit. *cKDTree* has all positions in memory; its time is that of the questions, and the time to make it is a row of its own.")
ERROR = "95 % error of the 8th distance, %"
EXACT = "QueryTest.NeighboursInOrderTiesAndAll"
WHY = "a k-d tree in memory answers in half of our time once it was made; ours has chunks that are decoded from a tree of any size, and no index beside them. With the time to make it, cKDTree takes twice as long as ours."
FLOOR = 1e-6
K = 8


def p95(found, true):
    return float(numpy.percentile(100 * (found - true) / true, 95))


def places(scene, count):
    random = numpy.random.default_rng(7)
    return scene.xyz[random.integers(0, len(scene.xyz), count)] + random.uniform(-1, 1, (count, 3))


def ours(lab, scene, asked):
    cloud = lab.module().open(str(scene.tree))
    cloud.nearest(asked, K, threads=1)  # fills the cache

    def call(level):
        return lambda: cloud.nearest(asked, K, level=level, threads=1)["distance"].reshape(-1, K)[:, -1]

    for level in range(lab.levels(scene.tree) - 1):
        yield Call("pcmlab", f"level {level}", call(level), f"cloud.nearest(places, k={K}, level={level}, threads=1)")
    yield Call("pcmlab", "all points", call(None), f"cloud.nearest(places, k={K}, threads=1)", default=True)


def peers(scene, asked):
    tree = cKDTree(scene.xyz)
    for eps in (0.0, 0.5, 2.0):
        yield Call("SciPy cKDTree", f"eps {eps:g}", lambda eps=eps: tree.query(asked, K, eps=eps)[0][:, -1], f"tree.query(places, {K}, eps={eps:g})")
    yield Call("SciPy cKDTree, made first", "eps 0", lambda: cKDTree(scene.xyz).query(asked, K)[0][:, -1], f"cKDTree(positions).query(places, {K})")


def measure(lab):
    rows = []
    for place in lab.places:
        scene = lab.scene(place)
        asked = places(scene, 10 * lab.size.sample)
        low = scene.q.min(axis=0) * scene.scale + scene.offset
        true = cKDTree(scene.local).query(asked - low, K)[0][:, -1]
        mine = list(ours(lab, scene, asked)) if lab.module() else []
        rows += lab.take_turns(place, [*mine, *peers(scene, asked)], lambda found, _: {"error": max(0.0, p95(found, true))})
    return rows


def absent(lab):
    return ([] if lab.module() else ["ours: the Python module is not built (-DPCM_WITH_PYTHON=ON)"]) + ["FLANN and PCL's KdTreeFLANN: their headers are not in build/pcl-sdk; "
                                                                                                       "`bench_all_knn` compares ours with them where they are installed"]
