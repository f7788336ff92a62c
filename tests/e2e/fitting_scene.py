"""Small clouds with a pipe on a floor, and clicks of the tool Fit Primitives, for the tests of fitting."""

import json
import math
import random
import re
import xml.etree.ElementTree

from meshlab import NO_TIME_LIMIT, MeshLabTest, pcmlab

LIST, VALUES = "PointCloudFitList", "PointCloudFitValues"
FOUND, MESSAGE = "PointCloudFitFound", "PointCloudFitMessage"


def kept_in(project):
    """The primitives in a project file."""
    text = xml.etree.ElementTree.parse(project).getroot().findtext("PointCloudPrimitives")
    return json.loads(text)["primitives"] if text else []


def number(text):
    return float(re.search(r"-?[0-9.]+(?:e-?\d+)?", text.replace(",", ""))[0])


def pipe_on_a_floor(folder, name="pipe", seed=5, points=45000):
    """The tree of a floor at z = 0, and above it a pipe along y of radius 0.5 with its axis at x = 3, z = 1; 2 mm noise. A third
    of the points is on the pipe. The class is 6 where y > 0, else 2."""
    chance = random.Random(seed)
    cloud = folder / f"{name}.csv"
    with open(cloud, "w", encoding="utf-8") as file:
        file.write("x,y,z,classification\n")
        for i in range(points):
            if i % 3:
                x, y, z = chance.uniform(-5, 5), chance.uniform(-5, 5), chance.gauss(0, 0.002)
            else:
                angle, r = chance.uniform(0, math.pi), 0.5 + chance.gauss(0, 0.002)
                x, y, z = 3 + r * math.cos(angle), chance.uniform(-4, 4), 1 + r * math.sin(angle)
            file.write(f"{x:.6f},{y:.6f},{z:.6f},{6 if y > 0 else 2}\n")
    tree = folder / f"{name}.pct"
    pcmlab("build", cloud, "-o", tree)
    return tree


class FittingTest(MeshLabTest):
    def setUp(self):
        super().setUp()
        self.fits = 0

    def start(self, *trees, more="", project=None):
        """The trees or the project, in a view of fixed size, with the tool on."""
        self.fits = 0
        opened = f"open-project {project}" if project else "\n".join(
            f"open {tree}\nwait-layers {i + 1}" for i, tree in enumerate(trees))
        return f"""
            wait-view
            {NO_TIME_LIMIT}
            {opened}
            wait-layers {len(trees)}
            view-size 800 600
            wait-status complete
            {more}
            trigger Fit Primitives
            wait-log click a surface
            """

    def click(self, place, modifiers="none", command="click"):
        """A click, and its answer."""
        self.fits += 1
        return f"""
            modifiers {modifiers}
            {command} {place}
            wait-property pcm_fit_tool "fits":{self.fits},
            modifiers none
            """

    def click_place(self, place, modifiers="none"):
        return self.click(place, modifiers, "click-place")
