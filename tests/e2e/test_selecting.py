"""The tools Select Points and Clip Box in the real MeshLab: what they select and hide against the same arithmetic here."""

import csv
import math
import re
import unittest

from meshlab import NO_TIME_LIMIT, MeshLabTest, pcmlab, sample

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
            open {tree}
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
            """)
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


    def test_front_brush_and_grow(self):
        """On a curved surface, where the answers are known: the front is a part, and a brush and growing stay near."""
        tree, points = self.scan()
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {VIEW}
            trigger Select Points
            wait-log the left button selects
            draw 0.2 0.3 0.7 0.6
            wait-label PointCloudSelectMessage rectangle,
            print-label PointCloudSelectCount
            print-property pcm_camera
            set Depth = Front only
            draw 0.2 0.3 0.7 0.6
            wait-label PointCloudSelectMessage front only
            print-label PointCloudSelectCount
            wait-status complete
            screen {self.result("front.png")}
            set Select by = Brush
            set Brush radius = 12
            draw 0.3 0.48 0.4 0.5
            wait-label PointCloudSelectMessage brush of radius
            wait-label PointCloudSelectCount class
            print-label PointCloudSelectCount
            wait-status complete
            screen {self.result("brush.png")}
            set Select by = Grow
            set Grow distance = 12
            click 0.35 0.49
            wait-label PointCloudSelectMessage grown
            print-label PointCloudSelectCount
            print-label PointCloudSelectMessage
            press Select none
            wait-label PointCloudSelectMessage none
            set Not farther than = 30
            click 0.35 0.49
            wait-label PointCloudSelectMessage grown
            wait-label PointCloudSelectCount class
            print-label PointCloudSelectCount
            set Normals within = 91
            click 0.35 0.49
            wait-label PointCloudSelectMessage from 0 to 90
            set Normals within = 20
            click 0.35 0.49
            wait-label PointCloudSelectMessage the cloud has no normals
            press Panel defaults
            set Select by = Grow
            print-field Grow distance
            print-field Normals within
            press Select none
            wait-label PointCloudSelectMessage none
            click 0.35 0.49
            wait-label PointCloudSelectMessage grown
            print-label PointCloudSelectMessage
            set Grow distance = none
            click 0.35 0.49
            wait-label PointCloudSelectMessage is not a grow distance
            press Panel defaults
            set Select by = Brush
            press Select none
            wait-label PointCloudSelectMessage none
            click 0.35 0.49
            wait-label PointCloudSelectMessage brush of radius
            wait-label PointCloudSelectCount class
            print-label PointCloudSelectCount
            set Select by = Brush
            set Brush radius = 12
            draw 0.02 0.02 0.05 0.05
            wait-label PointCloudSelectMessage met no point
            print-label PointCloudSelectCount
            """)
        self.assertDriven(run)
        camera = Camera(run.properties("pcm_camera")[0])
        through, front, brush, grown, near, plain, unchanged = self.counts(run)
        self.assertLess(front, through)
        self.assertGreater(front, through / 20)
        self.assertGreater(brush, 20)
        # All that the brush has selected appears near its stroke: the ball's radius, and what perspective adds to it.
        box = re.findall(r"([xyz]) from (\S+) to (\S+)", run.labels("PointCloudSelectCount")[2])
        size = [float(high) - float(low) for _, low, high in box]
        middle = [(float(high) + float(low)) / 2 for _, low, high in box]
        at = camera.device(middle)
        self.assertLess(abs((at[0] + 1) / 2 - 0.35) + abs((1 - at[1]) / 2 - 0.49), 0.06)
        self.assertGreater(max(size), 20)
        self.assertGreater(grown, brush)
        self.assertGreater(near, 5)
        self.assertLess(near, grown / 5)
        # One click of the brush takes a patch, not a handful, and a round number is the step.
        self.assertGreater(plain, 20)
        self.assertEqual(unchanged, plain)
        self.assertEqual(run.fields(), ["", ""])
        first, second = run.labels("PointCloudSelectMessage")
        self.assertIn("points of the cloud: take a shorter step", first)
        self.assertRegex(second, r"grown by steps of 0*\.?0*[125]0* source units")

    def test_clip_box(self):
        """Typed, dragged, undone, kept in a project, and only what it shows can be selected."""
        tree, points = self.scan()
        project, kept = self.folder / "clipped.mlp", self.folder / "kept.pct"
        wanted = {"Centre x": 636500.25, "Centre y": 849200.5, "Centre z": 430, "Size x": 300.5, "Size y": 200, "Size z": 40,
                  "Turn": 30}
        typed = "".join(f"\nset {name} = {value}" for name, value in wanted.items())
        shown = "".join(f"\nprint-field {name}" for name in wanted)
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {VIEW}
            trigger Clip Box
            wait-log drag a coloured cross
            {shown}
            screen {self.result("around.png")}
            {typed}
            wait-status complete
            print-property pcm_camera
            {shown}
            screen {self.result("typed.png")}
            set Size x = nothing
            wait-label PointCloudClipBoxMessage is not a size
            print-field Size x
            key-in PointCloudClipBoxAxis Ctrl+Z
            print-field Turn
            key-in PointCloudClipBoxAxis Ctrl+Shift+Z
            trigger Save Project As...
            pick {project}
            wait-file {project}
            press Keep the box's points
            pick {kept}
            wait-label PointCloudClipBoxMessage extracted
            wait-layers 2
            trigger Select Points
            wait-log the left button selects
            press Select shown
            wait-label PointCloudSelectMessage all shown
            print-label PointCloudSelectCount
            screen {self.result("selected.png")}
            """)
        self.assertDriven(run)
        fields = run.fields()
        count = len(wanted)
        self.assertEqual([float(text) for text in fields[count:2 * count]], list(wanted.values()))
        self.assertEqual(fields[2 * count:], ["300.5", "0"])
        centre = [wanted[f"Centre {a}"] for a in "xyz"]
        half = [wanted[f"Size {a}"] / 2 for a in "xyz"]
        c, s = math.cos(math.radians(30)), math.sin(math.radians(30))

        def local(p):
            d = [a - b for a, b in zip(p, centre)]
            return [c * d[0] + s * d[1], -s * d[0] + c * d[1], d[2]]

        inside_box = sum(all(abs(v) <= h for v, h in zip(local(p), half)) for p, _ in points)
        self.assertGreater(inside_box, 1000)
        self.assertLess(inside_box, len(points) / 2)
        self.assertEqual(self.counts(run), [inside_box])
        self.assertEqual(pcmlab("info", kept)["points"], inside_box)
        for text in fields[:6]:  # around what is seen: the digits of the file, and one more for the centre
            self.assertLessEqual(len(text.partition(".")[2]), 3, text)
        self.assertIn("<PointCloudClipBox>", project.read_text())

        # Reopened, a face is dragged by a third of the box's width; with the same camera as before.
        camera = Camera(run.properties("pcm_camera")[-1])
        face = [centre[0] + c * half[0], centre[1] + s * half[0], centre[2]]
        goal = [centre[0] + c * half[0] * 5 / 3, centre[1] + s * half[0] * 5 / 3, centre[2]]
        places = [((x + 1) / 2 + 1e-4, (1 - y) / 2 + 1e-4) for x, y in map(camera.device, (face, goal))]
        # In a MeshLab of its own: another session, with the project on its command line.
        run = self.own_gui(f"""
            wait-view
            wait-layers 1
            {VIEW}
            trigger Clip Box
            wait-log drag a coloured cross
            key-down Ctrl+Z
            {shown}
            hover {words(places[:1])}
            screen {self.result("hovered.png")}
            draw {words(places)}
            {shown}
            wait-status complete
            screen {self.result("dragged.png")}
            set Slab axis = z
            set Thickness = 5
            press Slab
            wait-status complete
            screen {self.result("slab.png")}
            key-down Up
            {shown}
            press Remove box
            wait-status complete
            quit
            """, project)
        self.assertDriven(run)
        fields = [float(text) for text in run.fields()]
        for found, value in zip(fields[:count], wanted.values()):
            self.assertAlmostEqual(found, value, delta=1e-9)
        # The pixel of the cursor is a whole number.
        self.assertAlmostEqual(fields[count + 3], wanted["Size x"] * 4 / 3, delta=3)
        self.assertEqual(fields[count + 4:count + 6], [200, 40])
        opposite = [fields[count + a] - axis * fields[count + 3] / 2 for a, axis in enumerate((c, s))]
        for a, axis in enumerate((c, s)):
            self.assertAlmostEqual(opposite[a], centre[a] - axis * half[0], delta=0.02)  # of the grid's 0.01
        self.assertEqual(fields[2 * count + 5], 5)
        self.assertAlmostEqual(fields[2 * count + 2], 435, delta=1e-9)

    def test_uses(self):
        """What is done with selected points: a layer, a file, a copy without them, classes, an attribute, in place."""
        tree, points = self.scan()
        layer, file, copy, classified = (self.folder / name for name in ("part.pct", "part.las", "rest.pct", "class.pct"))
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {VIEW}
            trigger Select Points
            wait-log the left button selects
            press To a layer
            wait-label PointCloudSelectMessage no point is selected
            set Condition = z>=450
            press By condition
            wait-label PointCloudSelectMessage z>=450
            press To a file
            pick {file}
            wait-label PointCloudSelectMessage extracted
            press To a layer
            pick {layer}
            wait-layers 2
            wait-label PointCloudSelectMessage part.pct
            press Delete points
            press Into a copy
            pick {copy}
            wait-label PointCloudSelectMessage deleted
            wait-layers 3
            press Undo selection
            press Classify
            press OK
            press Into a copy
            pick {classified}
            wait-label PointCloudSelectMessage classified
            wait-layers 4
            press Undo selection
            wait-status complete
            screen {self.result("layers.png")}
            press Delete points
            press Cancel
            press Save as attribute
            press OK
            press In place
            wait-label PointCloudSelectMessage saved
            wait-layers 4
            wait-status complete
            """)
        self.assertDriven(run)
        high = sum(p[2] >= 450 for p, _ in points)
        self.assertGreater(high, 1000)
        self.assertEqual(pcmlab("info", layer)["points"], high)
        self.assertEqual(pcmlab("info", file)["points"], high)
        self.assertEqual(pcmlab("info", copy)["points"], len(points) - high)
        for path, condition in ((classified, "classification=2"), (tree, "selected=1")):
            listed = self.folder / (path.stem + "-found.csv")
            pcmlab("convert", path, listed, "--where", condition)
            with open(listed, newline="", encoding="utf-8") as rows:
                found = [float(row["z"]) for row in csv.DictReader(rows)]
            expected = high if path == tree else sum(p[2] >= 450 or c == 2 for p, c in points)
            self.assertEqual(len(found), expected)
        self.assertEqual(pcmlab("verify", tree)["faults"], [])


if __name__ == "__main__":
    unittest.main()
