"""What attributes that are computed of every point's neighbours have in common: our filter, and a sample of points with exact neighbours."""
import numpy

from neighbours import scenes
from report.lab import Command

EXACT_WHERE = "between the neighbours that comparing all points in double finds"


class Sample:
    """Some points of a scene, no two at one place, and their exact neighbours."""

    def __init__(self, lab, scene, k):
        distinct = numpy.unique(scene.q, axis=0, return_index=True)[1]
        self.points = numpy.random.default_rng(1).permutation(distinct)[:lab.size.sample]
        self.distances, self.indices = scenes.neighbours_of(scene, self.points, k)


def column_reader(lab, scene, result, columns):
    """Reads columns of a tree in the order of the scene's file."""
    def read(_):
        xyz, values = lab.columns(result, columns)
        values = values[scene.rows_of(numpy.rint((xyz - scene.offset) / scene.scale).astype(numpy.int64))]
        return values[:, 0] if values.shape[1] == 1 else values

    return read


def ours(lab, scene, words, columns, k):
    result = lab.work / "computed.pct"
    command = ["pcmlab", *words, scene.tree, "-k", k, "-o", result, "--overwrite", "--json", "-q", "-t", 1]
    return Command(lab, command, "all points", default=True, read=column_reader(lab, scene, result, columns))


def p95(errors):
    return float(numpy.percentile(errors, 95))
