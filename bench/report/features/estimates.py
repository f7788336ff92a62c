"""Estimates of how many points a query finds."""
import numpy

from report.lab import Call

TITLE = "Estimates of a query"
WHAT = ("How many points lie in boxes of 2 to 20 m: estimated from the tree's index alone, or counted. Through our Python module, all boxes in one process, chunks not in the cache at first. "
        "The error is that of the expected number, over the true one or 100, whichever is larger; the 95th percentile. *Within*: boxes whose true number is between the least and the most that the estimate states. "
        "*NumPy*: a mask over positions in memory.")
ERROR = "95 % error of the number, %"
EXACT = "QueryTest.FindsTheSelectedPoints"
FLOOR = 0.0


def boxes(scene, count):
    random = numpy.random.default_rng(5)
    centre = scene.xyz[random.integers(0, len(scene.xyz), count)]
    half = random.uniform(1, 10, (count, 3))
    return numpy.stack([centre - half, centre + half], axis=1)


def measure(lab):
    rows = []
    for place in lab.places:
        scene = lab.scene(place)
        asked = boxes(scene, lab.size.sample)
        true = numpy.array([((scene.xyz >= low) & (scene.xyz <= high)).all(axis=1).sum() for low, high in asked])
        peers = [Call("NumPy", "mask", lambda: [{"points_expected": int(((scene.xyz >= low) & (scene.xyz <= high)).all(axis=1).sum())} for low, high in asked], "((xyz >= low) & (xyz <= high)).all(1).sum()")]
        mine = []
        if lab.module():
            cloud = lab.module().open(str(scene.tree))
            mine = [Call("pcmlab", "query", lambda: [{"points_expected": len(cloud.query(box, attributes=[])["xyz"])} for box in asked], "len(cloud.query(box, attributes=[])['xyz'])", default=True),
                    Call("pcmlab", "estimate", lambda: [cloud.estimate(box) for box in asked], "cloud.estimate(box)")]

        def judge(found, _):
            off = abs(numpy.array([one["points_expected"] for one in found]) - true) / numpy.maximum(true, 100)
            within = [one["points_least"] <= number <= one["points_most"] for one, number in zip(found, true) if "points_least" in one]
            return {"error": 100 * float(numpy.percentile(off, 95)), **({"within, %": 100 * float(numpy.mean(within))} if within else {})}

        rows += lab.take_turns(place, [*mine, *peers], judge)
    return rows


def absent(lab):
    return [] if lab.module() else ["ours: the Python module is not built (-DPCM_WITH_PYTHON=ON)"]
