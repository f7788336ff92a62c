"""The tools Select Points and Clip Box in the real MeshLab: what they select and hide against the same arithmetic here."""

import csv
import json
import re
import unittest

from meshlab import NO_TIME_LIMIT, MeshLabTest, different, pcmlab, sample

VIEW = NO_TIME_LIMIT + """
    view-size 640 480
    wait-status complete
    """


class Camera:
    """The matrices that a view published, column-major, as the view used them."""

    def __init__(self, state):
        self.modelview, self.projection = state["modelview"], state["projection"]
        self.origin, self.size = state["origin"], state["size"]

    def eye_space(self, point):
        p = [a - b for a, b in zip(point, self.origin)]
        m = self.modelview
        return [m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r] for r in range(3)]

    def device(self, point):
        """Normalised device coordinates, or None in front of the near plane and behind the far one."""
        e, m = self.eye_space(point), self.projection
        x, y, z, w = (m[r] * e[0] + m[4 + r] * e[1] + m[8 + r] * e[2] + m[12 + r] for r in range(4))
        return (x / w, y / w) if w > 0 and -w <= z <= w else None

    def to_device(self, pixel):
        return 2 * pixel[0] / self.size[0] - 1, 1 - 2 * pixel[1] / self.size[1]


def inside(polygon, x, y):
    """Even-odd rule."""
    count = 0
    for (ax, ay), (bx, by) in zip(polygon, polygon[1:] + polygon[:1]):
        if (ay > y) != (by > y) and x < ax + (y - ay) / (by - ay) * (bx - ax):
            count += 1
    return count % 2 == 1


def pixels(view, corners):
    """The driver's places, which are fractions of the view, as whole pixels."""
    return [(int(x * view[0]), int(y * view[1])) for x, y in corners]


def words(corners):
    return " ".join(f"{x} {y}" for x, y in corners)


class Selecting(MeshLabTest):
    first_view = 0

    def scan(self, name="autzen_trim.laz"):
        """A real scan's tree, and its points with their classes."""
        tree = self.folder / "scan.pct"
        pcmlab("build", sample(f"las/{name}"), "-o", tree)
        text = self.folder / "scan.csv"
        pcmlab("convert", tree, text)
        with open(text, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        points = [((float(r["x"]), float(r["y"]), float(r["z"])), int(float(r["classification"]))) for r in rows]
        return tree, points

    def counts(self, run):
        """What the panel showed, as numbers of points."""
        found = [re.search(r"([\d,]+) of [\d,]+ points selected", text) for text in run.labels("PointCloudSelectCount")]
        return [int(match[1].replace(",", "")) if match else 0 for match in found]

    def test_shapes(self):
        tree, points = self.scan()
        box = [(0.3, 0.3), (0.6, 0.7)]
        lasso = [(0.25, 0.3), (0.7, 0.35), (0.4, 0.45), (0.65, 0.75), (0.3, 0.7)]
        done = """
            wait-property pcm_select_tool idle
            print-label PointCloudSelectCount
            """
        run = self.gui(f"""
            wait-view
            wait-layers 1
            {VIEW}
            trigger Select Points
            wait-log the left button selects
            draw {words(box)}
            wait-label PointCloudSelectCount points selected
            {done}
            print-property pcm_camera
            screen {self.result("rectangle.png")}
            set Select by = Polygon or lasso
            {" ".join(f"{chr(10)}click {x} {y}" for x, y in lasso)}
            hover 0.28 0.5
            screen {self.result("lasso-open.png")}
            double-click 0.3 0.7
            wait-label PointCloudSelectMessage polygon
            {done}
            wait-status complete
            screen {self.result("lasso.png")}
            modifiers Shift
            draw {words([(0.05, 0.05), (0.2, 0.05), (0.2, 0.3), (0.05, 0.3), (0.05, 0.06)])}
            wait-label PointCloudSelectMessage added
            {done}
            modifiers none
            key-down Ctrl+Z
            {done}
            key-down Ctrl+Shift+Z
            {done}
            press Invert selection
            wait-label PointCloudSelectMessage inverted
            {done}
            press Select none
            wait-label PointCloudSelectMessage none
            {done}
            press Select shown
            wait-label PointCloudSelectMessage all shown
            {done}
            set Condition = classification=2
            press By condition
            wait-label PointCloudSelectMessage classification=2
            {done}
            set Operation = Subtract
            set Condition = z>=420
            press By condition
            wait-label PointCloudSelectMessage subtracted
            {done}
            quit
            """, tree)
        self.assertDriven(run)
        camera = Camera(run.properties("pcm_camera")[0])
        seen = [(camera.device(p), p, c) for p, c in points]

        def covered(corners):
            polygon = [camera.to_device(p) for p in pixels(camera.size, corners)]
            return {i for i, (d, _, _) in enumerate(seen) if d and inside(polygon, *d)}

        rectangle = covered([box[0], (box[1][0], box[0][1]), box[1], (box[0][0], box[1][1])])
        polygon = covered(lasso)
        corner = covered([(0.05, 0.05), (0.2, 0.05), (0.2, 0.3), (0.05, 0.3)])
        ground = {i for i, (_, _, c) in enumerate(seen) if c == 2}
        low = {i for i in ground if seen[i][1][2] < 420}
        counts = self.counts(run)
        self.assertGreater(len(rectangle), 1000)
        self.assertGreater(len(polygon), 1000)
        both = len(polygon | corner)
        self.assertEqual(counts, [len(rectangle), len(polygon), both, len(polygon), both, len(points) - both, 0, len(points),
                                  len(ground), len(low)])


if __name__ == "__main__":
    unittest.main()
