"""The tasks of run.py with pcmlab, on a tree. Each returns numbers that all programs have to agree on."""
import pcmlab

NEEDS = "tree"


def count(files):
    cloud = pcmlab.open(files["tree"])
    return [cloud.points, *cloud.bounds[0], *cloud.bounds[1]]


def box(files):
    points = pcmlab.open(files["tree"]).query(box=files["box"], attributes=["intensity", "classification"])
    return [len(points["xyz"]), points["xyz"].mean(), points["intensity"].mean(), points["classification"].mean()]


def mean_height(files):
    count, total = 0, 0.0
    for chunk in pcmlab.open(files["tree"]).chunks(where="classification=2", attributes=[]):
        count, total = count + len(chunk["xyz"]), total + chunk["xyz"][:, 2].sum()
    return [count, total / count]


def nearest(files):
    return [pcmlab.open(files["tree"]).nearest(files["places"], k=8)["distance"].mean()]


def outliers(files):
    return [pcmlab.outliers(files["tree"], output=files["out"] + ".las", neighbours=16, factor=3)["points"]]


def reclassify(files):
    with pcmlab.edit(files["tree"]) as cloud:
        changed = 0
        for chunk in cloud.changes(box=files["box"], attributes=["classification"]):
            chunk["classification"] = 7
            changed += len(chunk["classification"])
    return [changed]
