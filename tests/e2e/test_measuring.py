"""The tool Measure in the real window: clicks on a real scan at map coordinates, the list, projects and exports."""

import csv
import json
import math
import re
import unittest
import xml.etree.ElementTree

from meshlab import NO_TIME_LIMIT, MeshLabTest, different, pcmlab, sample

LIST, VALUES = "PointCloudMeasureList", "PointCloudMeasureValues"
MESSAGE = "PointCloudMeasureMessage"
RELATIVE = 1e-9  # of numbers against those that are computed here


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def dot(a, b):
    return math.fsum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def vector_area(points):
    """Half of the sum of the corners' cross products, relative to the first one."""
    from_first = [minus(p, points[0]) for p in points]
    parts = [cross(a, b) for a, b in zip(from_first, from_first[1:] + from_first[:1])]
    return [0.5 * math.fsum(part[k] for part in parts) for k in range(3)]


def expected(kind, points):
    """The first numbers of a measure, by name, computed from its points alone."""
    if kind == "distance":
        steps = [minus(b, a) for a, b in zip(points, points[1:])]
        return {"distance": math.fsum(math.hypot(*step) for step in steps),
                "horizontal": math.fsum(math.hypot(*step[:2]) for step in steps),
                "vertical": points[-1][2] - points[0][2]}
    if kind == "height":
        return {"height": points[1][2] - points[0][2]}
    if kind == "angle":
        a, b = minus(points[0], points[1]), minus(points[2], points[1])
        return {"angle": math.degrees(math.atan2(math.hypot(*cross(a, b)), dot(a, b)))}
    if kind == "area":
        area = vector_area(points)
        return {"true area": math.hypot(*area), "plan area": abs(area[2])}
    if kind == "plane":  # through exactly three points
        normal = cross(minus(points[2], points[1]), minus(points[3], points[1]))
        return {"distance": abs(dot(normal, minus(points[0], points[1]))) / math.hypot(*normal)}
    return {}


def rounded(place):
    """The file's steps are 0.01, of which 84921407 * 0.01 is 849214.0700000001 in double."""
    return tuple(round(x, 6) for x in place)


def kept_in(project):
    """The measures in a project file."""
    text = xml.etree.ElementTree.parse(project).getroot().findtext("PointCloudMeasures")
    return json.loads(text)["measures"] if text else []


def positions(measure):
    return [point["position"] for point in measure["points"]]


class Measuring(MeshLabTest):
    """On the field south of the trees, of which a view from above shows the middle."""

    def start(self, tree):
        return f"""
            wait-view
            {NO_TIME_LIMIT}
            open {tree}
            wait-layers 1
            view-size 800 600
            wait-status complete
            trigger Measure
            wait-log Measure: click points
            """

    def tree(self, name):
        tree = self.folder / "scan.pct"
        pcmlab("build", sample(name), "-o", tree)
        return tree

    def clicks(self, *places):
        """Clicks, each answered before the next one."""
        return "\n".join(f"click {x} {y}\nwait-label PointCloudMeasureHint {i + 1} point{'s' if i else ''}"
                         for i, (x, y) in enumerate(places))

    def kind(self, name):
        return f"field PointCloudMeasureKind = {name}\n"

    def test_numbers_list_project_and_files(self):
        tree = self.tree("las/autzen_trim.laz")
        project, out = self.folder / "p.mlp", self.folder
        pictures = {name: self.result(f"{name}.png") for name in ("none", "all", "hidden", "shown", "close", "reopened")}
        run = self.gui(f"""
            {self.start(tree)}
            picture {pictures["none"]}
            {self.clicks((0.40, 0.50), (0.60, 0.50))}
            click 0.5 0.6
            wait-label PointCloudMeasureHint 3 points
            screen {self.result("draft.png")}
            key Return
            wait-rows {LIST} 1
            {self.kind("Height")}
            click 0.42 0.53
            click 0.3 0.55
            wait-rows {LIST} 2
            {self.kind("Angle")}
            click 0.35 0.52
            click 0.40 0.62
            click 0.46 0.56
            wait-rows {LIST} 3
            {self.kind("Area")}
            {self.clicks((0.30, 0.50), (0.40, 0.52), (0.40, 0.60), (0.31, 0.62))}
            double-click 0.31 0.62
            wait-rows {LIST} 4
            {self.kind("Point to plane")}
            {self.clicks((0.60, 0.55), (0.30, 0.50), (0.40, 0.52), (0.36, 0.60))}
            click-right 0.5 0.5
            wait-rows {LIST} 5
            {self.kind("Point")}
            click 0.5 0.55
            wait-rows {LIST} 6
            print-table {LIST}
            print-table {VALUES}
            wait-status complete
            picture {pictures["all"]}
            screen {self.result("screen.png")}
            rename-row {LIST} 1 Kerb & "gutter" <1>
            pause 200
            tick-row {LIST} 0 off
            pause 200
            picture {pictures["hidden"]}
            key Ctrl+Z
            pause 200
            picture {pictures["shown"]}
            tick-row {LIST} 3 off
            pause 200
            choose-row {LIST} 2
            pause 100
            key Delete
            wait-rows {LIST} 5
            key Ctrl+Z
            wait-rows {LIST} 6
            key Ctrl+Shift+Z
            wait-rows {LIST} 5
            print-table {LIST}
            press Export measures
            pick {out / "m.csv"}
            wait-log wrote 5 measures to {out / "m.csv"}
            press Export measures
            pick {out / "m.geojson"}
            wait-log wrote 5 measures to {out / "m.geojson"}
            press Export measures
            pick {out / "m.dxf"}
            wait-log wrote 5 measures to {out / "m.dxf"}
            choose-row {LIST} 0
            press Jump to
            pause 500
            wait-status complete
            picture {pictures["close"]}
            screen {self.result("close-screen.png")}
            trigger Save Project As...
            pick {project}
            wait-file {project}
            """)
        self.assertDriven(run)
        self.check_numbers(run, project, out)
        self.check_pictures(pictures)
        # In a MeshLab of its own: another session.
        run = self.own_gui(f"""
            wait-view
            view-size 800 600
            open-project {project}
            wait-layers 1
            wait-status complete
            pause 500
            picture {pictures["reopened"]}
            trigger Measure
            wait-log Measure: click points
            print-table {LIST}
            quit
            """)
        self.assertEqual(run.tables(LIST)[0], self.second_list)
        self.assertGreater(different(pictures["none"], pictures["reopened"]), 0.001, "labels without the tool")
        self.assertDriven(run)

    def check_numbers(self, run, project, out):
        first, self.second_list = run.tables(LIST)
        self.assertEqual([row[0] for row in first],
                         ["Distance 1", "Height 1", "Angle 1", "Area 1", "Plane 1", "Point 1"])
        for row in first[:-1]:
            self.assertRegex(row[1], r"^-?[0-9.]+ ± [0-9.]+ ?(ft|ft²|ft\^2|°)$")
        self.assertRegex(first[-1][1], r"^636[0-9.]+ 849[0-9.]+ 4[0-9.]+$")
        self.assertEqual([row[::2] for row in self.second_list],
                         [["Distance 1", True], ['Kerb & "gutter" <1>', True], ["Area 1", False], ["Plane 1", True],
                          ["Point 1", True]])
        measures = kept_in(project)
        self.assertEqual([m["name"] for m in measures], [row[0] for row in self.second_list])
        points = self.points_of_the_file()
        for measure in measures:
            for place in positions(measure):
                self.assertIn(rounded(place), points, "not a point of the file")
        with open(out / "m.csv", encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        compared = 0
        for measure in measures:
            for name, value in expected(measure["kind"], positions(measure)).items():
                written = [r for r in rows if r["name"] == measure["name"] and r["quantity"] == name]
                self.assertEqual(len(written), 1, (measure["name"], name))
                self.assertAlmostEqual(float(written[0]["value"]) / value, 1, delta=RELATIVE)
                self.assertGreater(float(written[0]["uncertainty"]), 0)
                compared += 1
        self.assertEqual(compared, 7)
        features = json.loads((out / "m.geojson").read_text(encoding="utf-8"))["features"]
        self.assertEqual([f["properties"]["name"] for f in features], [m["name"] for m in measures])
        self.assertEqual(features[0]["geometry"]["coordinates"], positions(measures[0]))
        drawing = (out / "m.dxf").read_text()
        self.assertIn("pcm_distance", drawing)
        numbers = [float(text) for text in re.findall(r"^\s*(-?[0-9.]+)\s*$", drawing, re.M)]
        for coordinate in positions(measures[0])[0]:
            self.assertIn(coordinate, numbers)

    def points_of_the_file(self):
        table = self.folder / "points.csv"
        pcmlab("convert", sample("las/autzen_trim.laz"), table)
        with open(table, encoding="utf-8", newline="") as file:
            return {rounded(float(row[axis]) for axis in "xyz") for row in csv.DictReader(file)}

    def check_pictures(self, pictures):
        self.assertGreater(different(pictures["none"], pictures["all"]), 0.01)
        self.assertGreater(different(pictures["all"], pictures["hidden"]), 0.001)
        self.assertGreater(different(pictures["hidden"], pictures["shown"]), 0.001)
        self.assertGreater(different(pictures["all"], pictures["close"]), 0.1)

    def test_what_is_clicked_wrongly_changes_nothing(self):
        """Clicks next to the cloud, too few points, Backspace, Esc; dragging and the wheel move the camera."""
        tree = self.tree("las/autzen_trim.laz")
        run = self.gui(f"""
            {self.start(tree)}
            print-camera before
            click 0.05 0.05
            wait-label {MESSAGE} No point
            click 0.4 0.5
            wait-label PointCloudMeasureHint 1 point
            key Return
            wait-label {MESSAGE} 1 of at least 2 points
            click 0.6 0.5
            wait-label PointCloudMeasureHint 2 points
            click 0.95 0.95
            wait-label {MESSAGE} No point
            key Backspace
            wait-label PointCloudMeasureHint 1 point
            key Escape
            wait-label {MESSAGE} cancelled
            print-camera clicked
            print-table {LIST}
            drag 0.5 0.5 0.6 0.6
            print-camera turned
            wheel 2
            print-camera zoomed
            print-table {LIST}
            {self.kind("Angle")}
            click 0.5 0.55
            click 0.5 0.55
            click 0.5 0.55
            wait-label {MESSAGE} angle
            wait-label PointCloudMeasureHint 2 points
            print-table {LIST}
            {self.kind("Distance")}
            wait-rows {LIST} 0
            key Escape
            pause 200
            drag 0.5 0.5 0.4 0.4
            print-camera suspended
            trigger Measure
            pause 200
            trigger Measure
            pause 200
            print-layers
            """)
        self.assertDriven(run)
        self.assertEqual(run.tables(LIST), [[], [], []])
        cameras = run.cameras()
        self.assertEqual(cameras["before"]["eye"], cameras["clicked"]["eye"])
        self.assertNotEqual(cameras["clicked"]["eye"], cameras["turned"]["eye"])
        self.assertNotEqual(cameras["turned"]["scale"], cameras["zoomed"]["scale"])
        self.assertNotEqual(cameras["zoomed"]["eye"], cameras["suspended"]["eye"])
        self.assertEqual([layer["modified"] for layer in run.layers()], [False])

    def test_profile(self):
        """All points within half of the width are in the plot and in its file, as a look at every point finds them."""
        tree = self.tree("las/autzen_trim.laz")
        project, out = self.folder / "p.mlp", self.folder / "profile.csv"
        run = self.gui(f"""
            {self.start(tree)}
            {self.kind("Profile")}
            field PointCloudMeasureWidth = no number
            {self.clicks((0.40, 0.50), (0.60, 0.50))}
            key Return
            wait-label {MESSAGE} Width
            key Backspace
            field PointCloudMeasureWidth = 20
            click 0.60 0.50
            wait-label PointCloudMeasureHint 2 points
            key Return
            wait-label PointCloudProfileWords points
            print-label PointCloudProfileWords
            window-picture PointCloudProfilePlot {self.result("plot.png")}
            press Points as CSV
            pick {out}
            wait-label {MESSAGE} wrote
            print-label {MESSAGE}
            print-table {LIST}
            print-table {VALUES}
            trigger Save Project As...
            pick {project}
            wait-file {project}
            press Panel defaults
            {self.clicks((0.40, 0.50), (0.60, 0.50))}
            key Return
            wait-rows {LIST} 2
            print-table {VALUES}
            """)
        self.assertDriven(run)
        (measure,) = kept_in(project)
        self.assertEqual((measure["kind"], measure["width"]), ("profile", 20))
        (usual,) = [row[1] for row in run.tables(VALUES)[1] if row[0] == "width"]
        self.assertRegex(usual, r"^[125]0* ft$")
        a, b = (p[:2] for p in positions(measure))
        length = math.dist(a, b)
        u = [(y - x) / length for x, y in zip(a, b)]
        expected_rows, unclear = {}, set()  # the ends of the line are points of the cloud
        for p in self.points_of_the_file():
            d = minus(p[:2], a)
            along, right = dot(u, d), d[0] * u[1] - d[1] * u[0]
            if -1e-6 <= along <= length + 1e-6 and abs(right) <= 10 + 1e-6:
                expected_rows[p] = (along, right)
                if min(abs(along), abs(length - along), 10 - abs(right)) < 1e-6:
                    unclear.add(p)
        with open(out, encoding="utf-8", newline="") as file:
            rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
        self.assertGreater(len(rows), 500)
        self.assertEqual(({rounded(row[axis] for axis in "xyz") for row in rows} ^ set(expected_rows)) - unclear, set())
        self.assertLess(len(unclear), 5)
        for row in rows:
            along, right = expected_rows[rounded(row[axis] for axis in "xyz")]
            self.assertAlmostEqual(row["station"], along, delta=1e-9 * length)
            self.assertAlmostEqual(row["offset"], right, delta=1e-9 * length)
        self.assertEqual(run.labels("PointCloudProfileWords"), [f"{len(rows):,} points"])
        self.assertIn(f"wrote {len(rows):,} points to {out}", run.labels(MESSAGE)[0])

    def test_volume(self):
        """The numbers are those of the command, for the polygon that was clicked."""
        tree = self.tree("las/autzen_trim.laz")
        project, out = self.folder / "p.mlp", self.folder / "m.csv"
        run = self.gui(f"""
            {self.start(tree)}
            {self.kind("Volume")}
            field PointCloudMeasureLevel = 425
            field PointCloudMeasureCell = 10
            {self.clicks((0.30, 0.50), (0.40, 0.52), (0.40, 0.60), (0.31, 0.62))}
            key Return
            wait-label {MESSAGE} ft³
            print-table {LIST}
            print-table {VALUES}
            screen {self.result("screen.png")}
            press Export measures
            pick {out}
            wait-log wrote 1 measures
            trigger Save Project As...
            pick {project}
            wait-file {project}
            """)
        self.assertDriven(run)
        (measure,) = kept_in(project)
        corners = [coordinate for p in positions(measure) for coordinate in p[:2]]
        from_command = pcmlab("volume", tree, "--polygon", *corners, "--reference", 425, "--side", 10)
        with open(out, encoding="utf-8", newline="") as file:
            values = {row["quantity"]: float(row["value"]) for row in csv.DictReader(file)}
        self.assertGreater(from_command["cut"], 0)
        for name in ("net", "cut", "fill"):
            self.assertAlmostEqual(values[name], from_command[name], delta=RELATIVE * from_command["cut"])
        self.assertEqual(values["level"], 425)
        self.assertAlmostEqual(values["plan area"] / abs(vector_area(positions(measure))[2]), 1, delta=RELATIVE)


if __name__ == "__main__":
    unittest.main()
