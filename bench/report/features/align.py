"""Alignment by the number of pairs."""
import numpy
from scipy.spatial.transform import Rotation

from report.lab import Call, Command

TITLE = "Alignment by the number of pairs"
WHAT = ("A motion of 30 degrees about a tilted axis and 12 m, found from pairs of places in a site of 60 m that were picked 5 mm wrong (a standard deviation for each coordinate). The error is the "
        "largest distance of a corner of the site's box from where it belongs; the median of several draws of pairs. *Claimed*: what the answer states for the cloud's farthest corner, a standard deviation. "
        "Time of ours is that of the process. *SciPy*: `Rotation.align_vectors` about the centroids.")
ERROR = "error at the farthest corner, m"
EXACT = ""
WHY = "the errors are the same to four digits, and solving takes less than a millisecond in either; our time is that of a process that starts, opens the tree, and looks at the points around each pair to state their uncertainty."
HAS_DEFAULT = False
NUMBERS, PICKED = (3, 4, 6, 10, 20, 50, 100), 0.005


class Draws:
    """Pairs drawn several times: places in the moving cloud, and in the fixed one."""

    def __init__(self, low, high, count, seeds):
        self.turn = Rotation.from_rotvec(numpy.radians(30) * numpy.array([0.1, 0.2, 1]) / numpy.linalg.norm([0.1, 0.2, 1]))
        self.middle, self.away = (low + high) / 2, numpy.array([10.0, -6.0, 2.0])
        self.corners = numpy.array([[(low, high)[i >> axis & 1][axis] for axis in range(3)] for i in range(8)])
        self.pairs = []
        for seed in range(seeds):
            random = numpy.random.default_rng(100 * count + seed)
            moving = random.uniform(low, high, (count, 3))
            self.pairs.append((moving + random.normal(0, PICKED, moving.shape), self.moved(moving) + random.normal(0, PICKED, moving.shape)))

    def moved(self, places):
        return self.turn.apply(places - self.middle) + self.middle + self.away

    def error(self, matrices):
        """Median over the draws of the farthest corner's error."""
        found = [self.corners @ numpy.array(matrix)[:3, :3].T + numpy.array(matrix)[:3, 3] for matrix in matrices]
        return float(numpy.median([numpy.linalg.norm(corners - self.moved(self.corners), axis=1).max() for corners in found]))


class Ours(Command):
    """All draws, a process each; the time of one."""

    def __init__(self, lab, tree, draws, count):
        super().__init__(lab, ["pcmlab", "align", tree, "--pairs", lab.work / "pairs.txt", "--json", "-q"], f"{count} pairs")
        self.draws, self.answers = draws, []

    def run(self):
        cpu, self.answers = 0.0, []
        for moving, fixed in self.draws.pairs:
            numpy.savetxt(self.lab.work / "pairs.txt", numpy.column_stack([moving, fixed]), fmt="%.6f")
            cpu += super().run()["cpu"]
            self.answers.append(super().read())
        return {"cpu": cpu / len(self.draws.pairs)}

    def read(self):
        return [answer["matrix"] for answer in self.answers], numpy.median([answer["error_of_cloud"] for answer in self.answers])


def by_scipy(draws):
    matrices = []
    for moving, fixed in draws.pairs:
        turn = Rotation.align_vectors(fixed - fixed.mean(axis=0), moving - moving.mean(axis=0))[0].as_matrix()
        matrices.append(numpy.column_stack([turn, fixed.mean(axis=0) - turn @ moving.mean(axis=0)]))
    return matrices, None


def measure(lab):
    rows = []
    for place in lab.places:
        scene = lab.scene(place)
        low, high = scene.xyz.min(axis=0), scene.xyz.max(axis=0)
        for count in NUMBERS:
            draws = Draws(low, high, count, lab.size.seeds)
            programs = [Ours(lab, scene.tree, draws, count), Call("SciPy", f"{count} pairs", lambda draws=draws: by_scipy(draws), "Rotation.align_vectors, each draw once")]
            rows += lab.take_turns(place, programs, lambda found, _: {"error": draws.error(found[0]), **({} if found[1] is None else {"claimed, m": float(found[1])})}, repeat=1)
    return rows


def absent(lab):
    return ["MeshLab's and CloudCompare's alignment: windows alone"]
