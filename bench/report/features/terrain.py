"""A terrain whose height at every place is a formula, scanned at random places with noise: what volumes and profiles are compared with."""
import laspy
import numpy

from study import process

SIDE, NOISE = 100.0, 0.02  # m
BASE = 20.0                # m: height that volumes are compared with
LOW, HIGH = 7.0, 93.0      # the polygon of volumes: its corners in x and y


def height(x, y):
    """Hills of 3 and 0.8 m, a trench of 2 m, and a heap; 0 in the mean, or nearly."""
    hills = 3 * numpy.sin(x / 17) * numpy.cos(y / 13) + 0.8 * numpy.sin(x / 4.1 + y / 5.3)
    trench = -2 * numpy.exp(-((x - 0.4 * y - 35) / 1.5) ** 2)
    heap = 4 * numpy.exp(-((x - 70) ** 2 + (y - 60) ** 2) / 50)
    return BASE + hills + trench + heap


def true_volumes():
    """Cut (above BASE) and fill (below) within the polygon, m3: midpoints of 2 cm."""
    count = round((HIGH - LOW) / 0.02)
    middle = LOW + (numpy.arange(count) + 0.5) * (HIGH - LOW) / count
    cut = fill = 0.0
    for x in numpy.array_split(middle, 40):
        above = height(x[:, None], middle[None, :]) - BASE
        cut, fill = cut + above.clip(0).sum(), fill - above.clip(None, 0).sum()
    area = ((HIGH - LOW) / count) ** 2
    return cut * area, fill * area


class Terrain:
    """The scan at a place: LAS file, tree, and the positions that the file has."""

    def __init__(self, lab, place):
        self.origin = numpy.array(lab.places[place])
        self.las, self.tree = lab.work / f"terrain-{place}.las", lab.work / f"terrain-{place}.pct"
        if not self.las.exists():
            random = numpy.random.default_rng(3)
            xy = random.uniform(0, SIDE, (lab.size.points, 2))
            z = height(xy[:, 0], xy[:, 1]) + random.normal(0, NOISE, len(xy))
            header = laspy.LasHeader(point_format=0, version="1.2")
            header.scales, header.offsets = [0.001] * 3, self.origin
            cloud = laspy.LasData(header)
            cloud.x, cloud.y, cloud.z = (numpy.column_stack([xy, z]) + self.origin).T
            cloud.write(self.las)
        if not self.tree.exists():
            process.timed([lab.bin / "pcmlab", "build", "-q", "-o", self.tree, self.las])
        self.xyz = numpy.asarray(laspy.read(self.las).xyz)

    def plan(self, *xy):
        """Places of the terrain as words of a command."""
        return [f"{value + self.origin[i % 2]:.3f}" for i, value in enumerate(xy)]
