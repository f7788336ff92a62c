"""The tools on layers that have a matrix, under a clip box and over two layers, and what is cancelled."""

import csv
import math
import re
import unittest

from meshlab import NO_TIME_LIMIT, MeshLabTest, different, pcmlab, sample
from test_measuring import kept_in, positions, rounded
from test_picking import SIZE, TOLERANCE, Camera, t_and_s

PLACES = [(0.5, 0.5), (0.42, 0.55), (0.6, 0.52), (0.47, 0.45)]
MESSAGE = "PointCloudMeasureMessage"
VIEW = NO_TIME_LIMIT + """
    view-size 800 600
    wait-status complete
    """


def matrix_in_source_coordinates(matrix, origin):
    """Of a layer's matrix, which is about the document's origin: rows of four numbers."""
    rows = [matrix[4 * r:4 * r + 4] for r in range(3)]
    return [[*row[:3], row[3] + origin[r] - sum(a * b for a, b in zip(row, origin))] for r, row in enumerate(rows)]


def origin_of(run):
    return [float(v) for v in re.search(r"document's origin (\S+) (\S+) (\S+?)\.?\s", run.text).groups()]


def table(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


class MovedLayers(MeshLabTest):
    TURN_AND_TILT = """
        trigger Matrix: Set from translation/rotation/scale
        set Z Translation = 10
        set X Rotation = 3
        set Z Rotation = 25
        set Freeze Matrix = off
        press Apply
        press Close
        """

    def test_profiles_and_volumes_are_of_the_moved_points(self):
        """A tilted layer, against the same measures of a tree that was moved by the command."""
        before, after, moved = (self.folder / f"{name}.pct" for name in ("before", "after", "moved"))
        pcmlab("build", sample("las/autzen_trim.laz"), "-o", before)
        pcmlab("convert", before, after)
        project, out, values = self.folder / "p.mlp", self.folder / "profile.csv", self.folder / "m.csv"
        run = self.gui(f"""
            wait-view
            open {before}
            wait-layers 1
            open {after}
            wait-layers 2
            {self.TURN_AND_TILT}
            {VIEW}
            print-layers
            trigger Measure
            wait-log Measure: click points
            field PointCloudMeasureKind = Profile
            field PointCloudMeasureCloud = after (18,263 of 110,000)
            field PointCloudMeasureWidth = 20
            click 0.4 0.5
            wait-label PointCloudMeasureHint 1 point
            click 0.6 0.52
            wait-label PointCloudMeasureHint 2 points
            key Return
            wait-label PointCloudProfileWords points
            press Points as CSV
            pick {out}
            wait-label {MESSAGE} moved by the layer's matrix
            field PointCloudMeasureKind = Volume
            field PointCloudMeasureCloud = after (18,263 of 110,000)
            field PointCloudMeasureCompared = before (18,263 of 110,000)
            field PointCloudMeasureCell = 10
            click 0.40 0.40
            wait-label PointCloudMeasureHint 1 point
            click 0.60 0.42
            wait-label PointCloudMeasureHint 2 points
            click 0.55 0.60
            wait-label PointCloudMeasureHint 3 points
            key Return
            wait-label {MESSAGE} ft³
            screen {self.result("volume.png")}
            press Export measures
            pick {values}
            wait-log wrote 2 measures
            trigger Save Project As...
            pick {project}
            wait-file {project}
            """)
        self.assertDriven(run)
        matrix = matrix_in_source_coordinates(run.layers()[1]["matrix"], origin_of(run))
        self.assertGreater(abs(matrix[2][1]), 0.04)  # tilted
        pcmlab("transform", after, moved, "--matrix", *(repr(x) for row in matrix for x in row))
        profile, volume = kept_in(project)
        line = [x for p in positions(profile) for x in p[:2]]
        listed = self.folder / "expected.csv"
        from_command = pcmlab("profile", moved, "-o", listed, "--line", *line, "--width", 20)
        rows, expected = table(out), table(listed)
        self.assertGreater(len(rows), 300)
        self.assertLess(abs(len(rows) - len(expected)), 3, from_command)  # the written tree has a grid
        for column in ("station", "offset", "x", "y", "z"):
            ours, theirs = (sorted(float(row[column]) for row in part) for part in (rows, expected))
            if len(rows) == len(expected):
                self.assertLess(max(abs(a - b) for a, b in zip(ours, theirs)), 0.02, column)
        corners = [x for p in positions(volume) for x in p[:2]]
        from_command = pcmlab("volume", moved, "--polygon", *corners, "--before", before, "--side", 10)
        found = {row["quantity"]: float(row["value"]) for row in table(values) if row["name"] == volume["name"]}
        self.assertGreater(from_command["cut"], 1000)
        for name in ("net", "cut", "fill"):
            self.assertAlmostEqual(found[name] / from_command["cut"], from_command[name] / from_command["cut"], delta=1e-3)


    def test_picks_on_a_moved_layer_and_under_a_clip_box(self):
        """A pick is a point of the file, shown under the cursor where the matrix puts it, and the first that the box leaves."""
        tree, listed = self.folder / "scan.pct", self.folder / "scan.csv"
        pcmlab("build", sample("las/autzen_trim.laz"), "-o", tree)
        pcmlab("convert", tree, listed)
        points = [rounded(float(row[axis]) for axis in "xyz") for row in table(listed)]
        box = (636400, 849000, 400, 636800, 849300, 440)  # cuts off the tops of trees
        run = self.gui(f"""
            wait-view
            {NO_TIME_LIMIT}
            view-size {SIZE[0]} {SIZE[1]}
            open {tree}
            wait-layers 1
            {self.TURN_AND_TILT}
            trigger Set Clip Box
            set Mode = Show what is in it
            set Box = {" ".join(map(str, box))}
            press Apply
            wait-log Shown alone
            press Close
            drag 0.5 0.5 0.5 0.4
            wheel -6
            wait-status complete
            print-layers
            trigger Pick Point
            wait-log Pick Point: click a point
            pause 300
            watch-turns
            {"".join(f"click {x} {y}{chr(10)}wait-label PickPointMessage ,{chr(10)}print-property pcm_pick{chr(10)}" for x, y in PLACES)}
            print-turns
            print-camera picked
            screen {self.result("picked.png")}
            """)
        self.assertDriven(run)
        origin = origin_of(run)
        matrix = matrix_in_source_coordinates(run.layers()[0]["matrix"], origin)
        shown = {p: [math.fsum((*(a * b for a, b in zip(row, p)), row[3])) for row in matrix] for p in points}
        left = [q for q in shown.values() if all(low <= c <= high for low, c, high in zip(box[:3], q, box[3:]))]
        self.assertGreater(len(left), 1000)
        self.assertLess(run.turns()[0]["longest_cpu_ms"], 50, "the window is never blocked for longer")
        self.assertLess(len(left), len(points) / 2)
        camera = Camera(run.cameras()["picked"], origin)
        for place, answer in zip(PLACES, run.properties("pcm_pick")):
            with self.subTest(place):
                found = rounded(float(answer["point"][axis]) for axis in "xyz")
                self.assertIn(found, shown, "every digit of the file")
                self.assertTrue(all(low - 1e-3 <= c <= high + 1e-3 for low, c, high in zip(box[:3], shown[found], box[3:])))
                direction = camera.ray(place)
                t, s = t_and_s(camera, direction, shown[found])
                self.assertLess(s, max(TOLERANCE * camera.pixel(t), 2 * float(answer["point"]["spacing of points"])) + 0.1 * camera.pixel(t))
                near = (t_and_s(camera, direction, q) for q in left)
                least = min((u + v * v / (2 * TOLERANCE * camera.pixel(u)) for u, v in near
                             if v < 0.97 * TOLERANCE * camera.pixel(u)), default=math.inf)
                self.assertLess(t, least + 0.1 * camera.pixel(t))

    def count(self, text):
        """By layer, what the panel of Select Points shows."""
        found = re.findall(r"(\w+)[^|]*?: ([\d,]+) of [\d,]+ points selected", text)
        return {name: int(number.replace(",", "")) for name, number in found}

    def test_brush_and_growing_over_two_layers(self):
        """Two halves of a scan: a stroke over their border selects in both, growing stays in the cloud that is clicked."""
        left, right = self.folder / "left.pct", self.folder / "right.pct"
        pcmlab("convert", sample("las/autzen_trim.laz"), left, "--where", "x<=636590")
        pcmlab("convert", sample("las/autzen_trim.laz"), right, "--where", "x>636590")
        count = "wait-property pcm_select_tool idle\nprint-label PointCloudSelectCount"
        # In a MeshLab of its own: it reads the colour of selected points once.
        run = self.own_gui(f"""
            wait-view
            open {left}
            wait-layers 1
            open {right}
            wait-layers 2
            trigger Reset Trackball
            {VIEW}
            trigger Select Points
            wait-log the left button selects
            picture {self.result("before.png")}
            set Select by = Brush
            set Brush radius = 25
            hover 0.5 0.3
            pause 200
            picture {self.result("ring.png")}
            hover 0.1 0.3
            set Select by = Rectangle
            hover 0.12 0.3
            pause 200
            picture {self.result("no-ring.png")}
            set Select by = Brush
            draw 0.35 0.5 0.65 0.5
            wait-label PointCloudSelectMessage brush of radius
            {count}
            set Layers = All shown layers
            draw 0.35 0.5 0.65 0.5
            wait-label PointCloudSelectMessage brush of radius
            {count}
            set Select by = Rectangle
            hover 0.1 0.1
            wait-status complete
            picture {self.result("brush.png")}
            press Colour...
            set &HTML: = #00ff00
            press OK
            wait-status complete
            picture {self.result("green.png")}
            set Select by = Grow
            set Grow distance = 8
            click 0.4 0.5
            wait-label PointCloudSelectMessage grown
            {count}
            check-cell PointCloudLayers 1 4 on
            set Select by = Brush
            draw 0.35 0.42 0.65 0.42
            wait-label PointCloudSelectMessage brush of radius
            {count}
            quit
            """)
        self.assertDriven(run)
        met, everywhere, grown, locked = map(self.count, run.labels("PointCloudSelectCount"))
        for stroke in (met, everywhere):
            self.assertGreater(min(stroke.get("left", 0), stroke.get("right", 0)), 100)
        self.assertGreaterEqual(everywhere["left"], met["left"])
        self.assertGreater(grown["left"], 100)
        self.assertEqual(grown.get("right", everywhere["right"]), everywhere["right"])
        self.assertNotEqual(locked["left"], grown["left"])
        self.assertEqual(locked["right"], everywhere["right"])
        pictures = {name: self.result(name + ".png") for name in ("before", "ring", "no-ring", "brush", "green")}
        self.assertEqual(different(pictures["before"], pictures["no-ring"]), 0)
        ring = different(pictures["before"], pictures["ring"]) * 800 * 600
        self.assertGreater(ring, 2 * 150)  # a line of 2 pixels around 2 * pi * 25
        self.assertLess(ring, 6 * 160)
        self.assertGreater(different(pictures["brush"], pictures["green"]), 0.002)
        kept = "".join(file.read_text() for file in (self.folder / "config").rglob("*.conf"))
        self.assertIn("SelectedColour=#00ff00", kept)

    def test_cancelled_work_changes_nothing_and_points_are_deleted_in_place(self):
        _, tree = self.generate("scene", 500000, "--seed", 3, "--extent", 60)
        high = pcmlab("query", tree, "--count", "--where", "z>=102")["points"]
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {VIEW}
            trigger Select Points
            wait-log the left button selects
            set Condition = z>=102
            press By condition
            wait-label PointCloudSelectMessage z>=102
            wait-property pcm_select_tool idle
            print-label PointCloudSelectCount
            set Select by = Grow
            set Grow distance = 2
            click 0.5 0.75
            wait-property pcm_select_tool selecting
            escape-in-view
            wait-property pcm_select_tool idle
            print-label PointCloudSelectCount
            trigger Select Points
            pause 100
            trigger Measure
            wait-log Measure: click points
            field PointCloudMeasureKind = Profile
            field PointCloudMeasureWidth = 200
            click 0.4 0.5
            wait-label PointCloudMeasureHint 1 point
            click 0.6 0.5
            wait-label PointCloudMeasureHint 2 points
            key Return
            key Escape
            wait-label {MESSAGE} cancelled
            wait-rows PointCloudMeasureList 1
            pause 300
            expect-no-widget PointCloudProfilePlot
            choose-row PointCloudMeasureList 0
            press Compute
            wait-label PointCloudProfileWords points
            trigger Measure
            pause 100
            trigger Select Points
            wait-label PointCloudSelectCount points selected
            press Delete points
            press In place
            wait-label PointCloudSelectMessage deleted
            wait-status complete
            print-label PointCloudSelectCount
            screen {self.result("deleted.png")}
            """)
        self.assertDriven(run)
        before, cancelled, deleted = map(self.count, run.labels("PointCloudSelectCount"))
        self.assertEqual(before, {"scene": high})
        self.assertEqual(cancelled, before)
        self.assertEqual(deleted, {})
        self.assertEqual(pcmlab("info", tree)["points"], 500000 - high)
        self.assertEqual(pcmlab("query", tree, "--count", "--where", "z>=102")["points"], 0)
        self.assertEqual(pcmlab("verify", tree)["faults"], [])


if __name__ == "__main__":
    unittest.main()
