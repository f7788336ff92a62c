"""The tool Fit Primitives in the real MeshLab: a mug on a table is clicked, fitted, refined, extracted and exported."""

import csv
import json
import math
import random
import re
import unittest
import xml.etree.ElementTree

from meshlab import NO_TIME_LIMIT, MeshLabTest, different, pcmlab, sample

LIST, VALUES = "PointCloudFitList", "PointCloudFitValues"
FOUND, MESSAGE = "PointCloudFitFound", "PointCloudFitMessage"
MUG, HIGHER_ON_MUG, TABLE = "0.48 0.56", "0.5 0.5", "0.35 0.6"  # in the view from where the scanner stood
RADIUS, TOLERANCE = 0.0396, 0.001  # of the mug, metres: the published model


def kept_in(project):
    """The primitives in a project file."""
    text = xml.etree.ElementTree.parse(project).getroot().findtext("PointCloudPrimitives")
    return json.loads(text)["primitives"] if text else []


def number(text):
    return float(re.search(r"-?[0-9.]+(?:e-?\d+)?", text.replace(",", ""))[0])


class Fitting(MeshLabTest):
    def setUp(self):
        super().setUp()
        scan = sample("primitives/table_scene_mug_stereo_textured.pcd")
        near, self.tree = self.folder / "near.pct", self.folder / "mug.pct"
        pcmlab("convert", scan, near, "--box", -0.4, -0.4, 0.5, 0.4, 0.4, 1.3)
        # The scanner looks along z; MeshLab's camera looks against it.
        pcmlab("transform", near, self.tree, "--rotate", 1, 0, 0, 180, "--pivot", 0, 0, 0)
        self.fits = 0

    def start(self, more=""):
        self.fits = 0
        return f"""
            wait-view
            {NO_TIME_LIMIT}
            open {self.tree}
            wait-layers 1
            view-size 800 600
            wait-status complete
            {more}
            trigger Fit Primitives
            wait-log click a surface
            """

    def click(self, place, modifiers="none"):
        """A click, and its answer."""
        self.fits += 1
        return f"""
            modifiers {modifiers}
            click {place}
            wait-property pcm_fit_tool "fits":{self.fits},
            modifiers none
            """

    def points_of(self, path):
        table = self.folder / (path.stem + "-points.csv")
        pcmlab("convert", path, table)
        with open(table, newline="", encoding="utf-8") as file:
            return [tuple(float(row[a]) for a in "xyz") for row in csv.DictReader(file)]

    def test_pick_fit_refine_accept_extract_export(self):
        project, out = self.folder / "p.mlp", self.folder
        layer, file, rest = out / "part.pct", out / "part.las", out / "rest.pct"
        pictures = {name: self.result(f"{name}.png") for name in ("none", "draft", "accepted", "close", "reopened")}
        run = self.gui(f"""
            {self.start()}
            picture {pictures["none"]}
            {self.click(MUG)}
            print-label {FOUND}
            wait-status complete
            picture {pictures["draft"]}
            {self.click(HIGHER_ON_MUG, "Ctrl")}
            wait-label {FOUND} 2 places
            print-label {FOUND}
            {self.click(TABLE, "Shift")}
            wait-label {FOUND} 1 place taken away
            print-label {FOUND}
            key Backspace
            wait-label {FOUND} 2 places.
            key Return
            wait-rows {LIST} 1
            {self.click(TABLE)}
            {self.click(TABLE)}
            key Return
            wait-rows {LIST} 2 Plane 1
            choose-row {LIST} 0
            pause 100
            print-table {LIST}
            print-table {VALUES}
            wait-status complete
            picture {pictures["accepted"]}
            screen {self.result("screen.png")}
            rename-row {LIST} 1 Table <top>
            pause 200
            tick-row {LIST} 1 off
            pause 200
            print-table {LIST}
            press Delete all
            wait-rows {LIST} 0
            key Ctrl+Z
            wait-rows {LIST} 2
            key Ctrl+Z
            pause 200
            choose-row {LIST} 0
            pause 100
            trigger Its points to a file...
            pick {file}
            wait-label {MESSAGE} extracted
            trigger Its points to a layer...
            pick {layer}
            wait-layers 2
            trigger Delete its points...
            press Into a copy
            pick {rest}
            wait-layers 3
            trigger Its points as an attribute...
            press OK
            press Into a copy
            pick {out / "saved.pct"}
            wait-layers 4
            show-layer 1 off
            show-layer 2 off
            show-layer 3 off
            show-layer 0 on
            press Export
            pick {out / "all.dxf"}
            press OK
            wait-label {MESSAGE} wrote 2 primitives
            press Export
            pick {out / "all.scr"}
            wait-label {MESSAGE} all.scr
            press Export
            pick {out / "all.csv"}
            wait-label {MESSAGE} all.csv
            press Export
            pick {out / "all.json"}
            wait-label {MESSAGE} all.json
            press Jump to
            pause 300
            wait-status complete
            picture {pictures["close"]}
            screen {self.result("close-screen.png")}
            trigger Save Project As...
            pick {project}
            wait-file {project}
            """)
        self.assertDriven(run)
        found = run.labels(FOUND)
        for text in found:
            self.assertRegex(text, r"^Cylinder: r [0-9.]+ ± [0-9.]+ ")
            self.assertAlmostEqual(number(text), RADIUS, delta=1.5 * TOLERANCE)
        first, second = run.tables(LIST)
        self.assertEqual([row[0] for row in first], ["Cylinder 1", "Plane 1"])
        self.assertEqual([[row[0], row[-1]] for row in second], [["Cylinder 1", True], ["Table <top>", False]])
        values = dict(run.tables(VALUES)[0])
        self.assertAlmostEqual(number(values["radius"]), RADIUS, delta=TOLERANCE)
        self.assertGreater(different(pictures["none"], pictures["draft"]), 0.005)
        self.assertGreater(different(pictures["draft"], pictures["accepted"]), 0.005)
        self.assertGreater(different(pictures["accepted"], pictures["close"]), 0.1)
        self.check_points(first, layer, file, rest)
        self.check_files(out)
        self.check_reopened(project, pictures)

    def check_points(self, rows, layer, file, rest):
        belonging = int(number(rows[0][3]))
        self.assertGreater(belonging, 10000)
        self.assertEqual(pcmlab("info", layer)["points"], belonging)
        self.assertEqual(pcmlab("info", file)["points"], belonging)
        everything = pcmlab("info", self.tree)["points"]
        self.assertEqual(pcmlab("info", rest)["points"], everything - belonging)
        saved = self.folder / "saved.csv"
        pcmlab("convert", self.folder / "saved.pct", saved, "--where", "selected=1")
        self.assertEqual(len(saved.read_text().splitlines()) - 1, belonging)

    def check_files(self, out):
        primitives = json.loads((out / "all.json").read_text())["primitives"]
        self.assertEqual([p["name"] for p in primitives], ["Cylinder 1", "Table <top>"])
        mug, table = primitives
        self.assertAlmostEqual(mug["radius"], RADIUS, delta=TOLERANCE)
        # The mug stands on the table: its axis is the table's normal.
        along = abs(sum(a * b for a, b in zip(mug["axis"], table["axis"])))
        self.assertLess(math.degrees(math.acos(min(1, along))), 2)
        with open(out / "all.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["name"] for row in rows], ["Cylinder 1", "Table <top>"])
        self.assertIn("CYLINDER", (out / "all.scr").read_text())
        self.assertIn("3DFACE", (out / "all.dxf").read_text())

    def check_reopened(self, project, pictures):
        kept = kept_in(project)
        self.assertEqual([p["name"] for p in kept], ["Cylinder 1", "Table <top>"])
        # In a MeshLab of its own: another session.
        run = self.own_gui(f"""
            wait-view
            {NO_TIME_LIMIT}
            view-size 800 600
            open-project {project}
            wait-layers 4
            wait-status complete
            trigger Fit Primitives
            wait-log click a surface
            print-table {LIST}
            choose-row {LIST} 0
            pause 100
            trigger Select its points
            wait-label {MESSAGE} points selected
            print-label {MESSAGE}
            wait-status complete
            picture {pictures["reopened"]}
            quit
            """)
        self.assertDriven(run)
        rows = run.tables(LIST)[0]
        self.assertEqual([row[0] for row in rows], ["Cylinder 1", "Table <top>"])
        # All points near the surface, connected or not.
        again = int(number(run.labels(MESSAGE)[0].split(": ")[1]))
        self.assertAlmostEqual(again / number(rows[0][3]), 1, delta=0.1)
        self.assertGreater(different(pictures["none"], pictures["reopened"]), 0.005)

    def pipe_on_a_floor(self):
        """A floor at z = 0, and above it a pipe along y of radius 0.5 with its axis at x = 3, z = 1; 2 mm noise."""
        chance = random.Random(5)
        cloud = self.folder / "pipe.xyz"
        with open(cloud, "w", encoding="utf-8") as file:
            for _ in range(30000):
                file.write(f"{chance.uniform(-5, 5):.6f} {chance.uniform(-5, 5):.6f} {chance.gauss(0, 0.002):.6f}\n")
            for _ in range(15000):
                angle, r = chance.uniform(0, math.pi), 0.5 + chance.gauss(0, 0.002)
                file.write(f"{3 + r * math.cos(angle):.6f} {chance.uniform(-4, 4):.6f} {1 + r * math.sin(angle):.6f}\n")
        tree = self.folder / "pipe.pct"
        pcmlab("build", cloud, "-o", tree)
        return tree

    def test_what_is_refused_changes_nothing(self):
        self.tree = self.pipe_on_a_floor()
        floor, pipe = "-2 1 0", "3 0.5 1.5"
        # In a MeshLab of its own: what it keeps is for its next start.
        run = self.own_gui(f"""
            {self.start()}
            {self.click("0.05 0.05")}
            print-label {MESSAGE}
            modifiers Shift
            click 0.3 0.5
            wait-label {MESSAGE} no shape yet
            modifiers none
            field PointCloudFitShape = Sphere
            click-place {floor}
            wait-label {MESSAGE} no sphere was fitted
            print-label {MESSAGE}
            print-label {FOUND}
            key Return
            wait-label {MESSAGE} there is nothing to accept
            field PointCloudFitShape = Cylinder
            click-place {pipe}
            wait-label {FOUND} Enter accepts
            print-label {FOUND}
            wait-status complete
            print-boxes
            screen {self.result("pipe.png")}
            field PointCloudFitThreshold = -3
            wait-label {MESSAGE} is not a number greater than 0
            print-label {FOUND}
            field PointCloudFitThreshold = 0.008
            wait-property pcm_fit_tool "fits":4,
            print-label {FOUND}
            field PointCloudFitShape = Sphere
            wait-property pcm_fit_tool "fits":5,
            print-label {MESSAGE}
            print-label {FOUND}
            escape-in-view
            wait-label {MESSAGE} discarded
            print-label {FOUND}
            wait-status complete
            print-boxes
            escape-in-view
            print-table {LIST}
            print-camera before
            drag 0.5 0.5 0.6 0.6
            print-camera turned
            quit
            """)
        self.assertDriven(run)
        messages, found = run.labels(MESSAGE), run.labels(FOUND)
        self.assertIn("No point within", messages[0])
        self.assertRegex(messages[1], r"no sphere was fitted \(.+\): .+")
        self.assertIn("Click a point", found[0])
        for text in found[1:4]:  # also after a number that is refused
            self.assertRegex(text, "^Cylinder: r 0.[45][0-9]+ ± ")
            self.assertAlmostEqual(number(text), 0.5, delta=0.001)
        self.assertEqual(found[1], found[2])
        # A sphere that is asked for on a pipe touches it along a ring at most.
        self.assertEqual(found[4], found[3])
        self.assertRegex(messages[2], r"no sphere was fitted \(.+\): .+")
        self.assertIn("Click a point", found[5])
        self.assertEqual(run.tables(LIST), [[]])
        self.assertEqual(["points selected" in box["text"] for box in run.boxes()], [True, False])
        self.assertEqual(run.text.count("driver: escape taken"), 1)
        self.assertEqual(run.text.count("driver: escape not taken"), 1)
        self.assertNotEqual(run.cameras()["before"]["eye"], run.cameras()["turned"]["eye"])
        run = self.own_gui(f"""
            {self.start()}
            print-field Shape
            print-field Threshold
            quit
            """)
        self.assertDriven(run)
        self.assertEqual(run.fields(), ["Sphere", ""], "choices are kept, numbers belong to the cloud")

    def test_the_shape_at_the_place_is_shown_before_it_is_followed(self):
        first = self.result("first.png")
        run = self.gui(f"""
            {self.start()}
            click {TABLE}
            wait-property pcm_fit_tool "following"
            print-label {FOUND}
            print-property pcm_fit_tool
            picture {first}
            wait-property pcm_fit_tool "draft"
            print-label {FOUND}
            """)
        self.assertDriven(run)
        found = run.labels(FOUND)
        self.assertIn("Plane", found[0])
        self.assertIn("points around the place. It is followed through the cloud; Esc cancels it.", found[0])
        self.assertIn("Enter accepts it.", found[1])

    def test_escape_and_further_clicks(self):
        """What runs is cancelled by Esc, and replaced by a further click; the camera moves meanwhile."""
        run = self.gui(f"""
            {self.start()}
            field PointCloudFitNeighbourhood = 100000
            click {TABLE}
            wait-property pcm_fit_tool "fitting"
            print-camera before
            drag 0.5 0.5 0.52 0.5
            drag 0.52 0.5 0.5 0.5
            drag 0.5 0.5 0.51 0.5
            print-camera turned
            print-property pcm_fit_tool
            escape-in-view
            wait-label {MESSAGE} cancelled
            print-label {FOUND}
            click {TABLE}
            wait-property pcm_fit_tool "fitting"
            click {TABLE}
            wait-property pcm_fit_tool "draft"
            pause 300
            print-property pcm_fit_tool
            print-label {FOUND}
            escape-in-view
            wait-label {MESSAGE} discarded
            """)
        self.assertDriven(run)
        states, found = run.properties("pcm_fit_tool"), run.labels(FOUND)
        self.assertEqual(states[0], {"fits": 0, "state": "fitting"})
        self.assertNotEqual(run.cameras()["before"]["eye"], run.cameras()["turned"]["eye"])
        self.assertIn("Click a point", found[0])
        self.assertEqual(states[1], {"fits": 2, "state": "draft"}, "the first of two quick clicks has no answer")
        self.assertIn("1 place.", found[1])

    def test_only_what_is_shown_is_fitted(self):
        """Under a clip box: all points of the plane are in it."""
        part = self.folder / "part.pct"
        run = self.gui(f"""
            {self.start('''
            trigger Clip Box
            wait-log drag a coloured cross
            set Centre x = 0
            set Centre y = 0
            set Centre z = -0.9
            set Size x = 0.3
            set Size y = 0.3
            set Size z = 2
            wait-status complete
            trigger Clip Box
            pause 200
            ''')}
            {self.click("0.44 0.62")}
            print-label {FOUND}
            wait-status complete
            screen {self.result("clipped.png")}
            key Return
            wait-rows {LIST} 1
            trigger Its points to a layer...
            pick {part}
            wait-layers 2
            """)
        self.assertDriven(run)
        points = self.points_of(part)
        self.assertGreater(len(points), 1000)
        self.assertLess(len(points), 100000)
        for x, y, _ in points:
            self.assertTrue(abs(x) <= 0.15 + 1e-9 and abs(y) <= 0.15 + 1e-9)

    def test_at_map_coordinates(self):
        """The ground of an airborne scan, in feet: every point that belongs to it is one of the file, near the plane."""
        self.tree = self.folder / "field.pct"
        pcmlab("build", sample("las/autzen_trim.laz"), "-o", self.tree)
        listed, drawing, part = self.folder / "f.json", self.folder / "f.dxf", self.folder / "part.las"
        run = self.gui(f"""
            {self.start()}
            field PointCloudFitShape = Plane
            field PointCloudFitThreshold = 1.5
            field PointCloudFitNeighbourhoodKind = radius
            field PointCloudFitNeighbourhood = 40
            {self.click("0.5 0.55")}
            print-label {FOUND}
            key Return
            wait-label {MESSAGE} not accepted yet: it is doubtful (other surface)
            key Return
            wait-rows {LIST} 1
            {self.click("0.5 0.55")}
            wait-label {MESSAGE} the same as 'Plane 1' of the list
            escape-in-view
            wait-label {MESSAGE} discarded
            wait-status complete
            screen {self.result("field.png")}
            press Export
            pick {listed}
            wait-label {MESSAGE} f.json
            press Export
            pick {drawing}
            wait-label {MESSAGE} f.dxf
            trigger Its points to a file...
            pick {part}
            wait-label {MESSAGE} extracted
            print-table {LIST}
            """)
        self.assertDriven(run)
        row = run.tables(LIST)[0][0]
        self.assertRegex(row[1], r"^area [0-9.e+]+$")  # without an uncertainty: the fit is doubtful
        plane = json.loads(listed.read_text())["primitives"][0]
        points = self.points_of(part)
        self.assertEqual(len(points), plane["points"])
        self.assertGreater(len(points), 1000)
        everything = set(self.points_of(self.tree))
        self.assertLessEqual(set(points), everything)
        # The field bends: the plane was fitted once more to what it had reached.
        far = [abs(sum((a - b) * n for a, b, n in zip(p, plane["point"], plane["axis"]))) for p in points]
        self.assertLess(sum(distance > 1.5 for distance in far), 0.1 * len(far))
        self.assertLess(max(far), 2 * 1.5)
        self.assertIn("$INSUNITS\n 70\n2\n", drawing.read_text().replace("\r", "").replace("     2\n", "2\n"))

    def test_a_moved_layer(self):
        """Fitted in the cloud's own coordinates, drawn where the layer is."""
        shapes, pictures = {}, {}
        for name, more in (("there", ""), ("moved", "move-layer 0 0.02 0 0\nwait-status complete")):
            project = self.folder / f"{name}.mlp"
            pictures[name] = self.result(f"{name}.png")
            run = self.gui(f"""
                {self.start(more)}
                field PointCloudFitShape = Cylinder
                {self.click("0.49 0.56" if name == "there" else "0.516 0.56")}
                key Return
                wait-rows {LIST} 1
                wait-status complete
                picture {pictures[name]}
                trigger Save Project As...
                pick {project}
                wait-file {project}
                """)
            self.assertDriven(run)
            shapes[name] = kept_in(project)[0]
        there, moved = shapes["there"], shapes["moved"]
        self.assertAlmostEqual(there["radius"], moved["radius"], delta=TOLERANCE)
        # The distance between the two axes, where the first one's point is.
        apart = [a - b for a, b in zip(there["point"], moved["point"])]
        along = sum(a * b for a, b in zip(apart, there["axis"]))
        self.assertLess(math.hypot(*(a - along * b for a, b in zip(apart, there["axis"]))), 0.004)
        self.assertGreater(different(pictures["there"], pictures["moved"]), 0.01)


if __name__ == "__main__":
    unittest.main()
