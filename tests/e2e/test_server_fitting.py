"""meshlabserver: scripts fit, detect and export primitives."""

import csv
import json
import math
import random
import unittest

from meshlab import MeshLabTest, needs_server, pcmlab


def setUpModule():
    needs_server()


def flag(on):
    return ("RichBool", "true" if on else "false")


def choice(value, count):
    return ("RichEnum", value, {"enum_cardinality": count, **{f"enum_val{i}": str(i) for i in range(count)}})


def text(value):
    return ("RichString", value)


def drawing(output="", overwrite=False, unit=0):
    return {"OutputFile": text(output), "Overwrite": flag(overwrite), "Unit": choice(unit, 7), "Chord": ("RichFloat", 0)}


WORK = {"MemoryMB": ("RichInt", 256), "Threads": ("RichInt", 2)}
LIMIT = {"Where": text(""), "InClip": flag(True)}


def fit(tree, places, shape=0, others="", threshold=0, name="", points="", **more):
    return ("Fit Primitive", {
        "Tree": text(tree), "Places": text(places), "NotPlaces": text(others), "Shape": choice(shape, 6),
        "Estimator": choice(1, 6), "Threshold": ("RichFloat", threshold), "Radius": ("RichFloat", 0),
        "Count": ("RichInt", 0), "Grow": flag(True), "Step": ("RichFloat", 0), "Outline": choice(0, 4),
        "NormalAngle": ("RichFloat", 0), "LeastRadius": ("RichFloat", 0), "LargestRadius": ("RichFloat", 0),
        "Iterations": ("RichInt", 10000), "Probability": ("RichFloat", 0.99), "Seconds": ("RichFloat", 0),
        "Seed": ("RichInt", 1), "Backend": choice(0, 2), **LIMIT, "Name": text(name), **drawing(**more),
        "PointsOutput": text(points), **WORK})


def detect(tree, labels=False, copy="", **more):
    return ("Detect Primitives", {
        "Tree": text(tree), "Planes": flag(True), "Cylinders": flag(True), "Spheres": flag(True),
        "LeastPoints": ("RichInt", 500), "Threshold": ("RichFloat", 0), "NormalAngle": ("RichFloat", 20),
        "Step": ("RichFloat", 0), "Seed": ("RichInt", 1), "Box": text(""), **LIMIT, **drawing(**more),
        "Labels": flag(labels), "Attribute": text("primitive"), "Output": text(copy), "InPlace": flag(False), **WORK})


def export(output, listed="", **more):
    return ("Export Primitives", {"ListFile": text(listed), "ApplyMatrix": flag(True), **drawing(output, **more)})


class ServerFitting(MeshLabTest):
    """A ball of radius 1 above a floor of 20 x 20, at map coordinates, with 2 mm noise."""

    CENTRE = (500000.0, 4800000.0, 103.0)

    def setUp(self):
        super().setUp()
        chance = random.Random(3)
        cloud = self.folder / "ball.xyz"
        with open(cloud, "w", encoding="utf-8") as file:
            for _ in range(20000):
                x, y = chance.uniform(-10, 10), chance.uniform(-10, 10)
                file.write(f"{500000 + x:.4f} {4800000 + y:.4f} {100 + chance.gauss(0, 0.002):.4f}\n")
            for _ in range(10000):
                d = [chance.gauss(0, 1) for _ in range(3)]
                r = (1 + chance.gauss(0, 0.002)) / math.hypot(*d)
                file.write(" ".join(f"{c + r * a:.4f}" for c, a in zip(self.CENTRE, d)) + "\n")
        self.tree = self.folder / "ball.pct"
        pcmlab("build", cloud, "-o", self.tree)

    def test_fits_writes_and_exports(self):
        listed, part, table = self.folder / "ball.json", self.folder / "part.pct", self.folder / "all.csv"
        run = self.server([fit(self.tree, "500000 4800000 104", name="ball", output=listed, points=part),
                           fit(self.tree, "500005 4800005 100", output=self.folder / "floor.dxf"),
                           export(table), export(self.folder / "all.scr", listed=listed, unit=2)])
        self.assertEqual(run.code, 0, run.text)
        ball = json.loads(listed.read_text())["primitives"][0]
        self.assertEqual((ball["name"], ball["kind"]), ("ball", "sphere"))
        self.assertAlmostEqual(ball["radius"], 1, delta=3 * ball["errors"]["radius"] if "errors" in ball else 0.001)
        self.assertLess(math.dist(ball["point"], self.CENTRE), 0.001)
        self.assertEqual(pcmlab("info", part)["points"], ball["points"])
        self.assertGreater(ball["points"], 9900)
        self.assertIn("radius      1.00", run.text)
        with open(table, newline="", encoding="utf-8") as file:
            self.assertEqual([row["name"] for row in csv.DictReader(file)], ["ball", "Plane 1"])
        self.assertIn("3DFACE", (self.folder / "floor.dxf").read_text())
        script = (self.folder / "all.scr").read_text()
        self.assertIn("SPHERE", script)
        self.assertNotIn("3DPOLY", script)

    def test_detects_and_labels(self):
        listed, copy = self.folder / "all.json", self.folder / "labelled.pct"
        run = self.server([detect(self.tree, labels=True, copy=copy, output=listed)])
        self.assertEqual(run.code, 0, run.text)
        self.assertIn(": 2 primitives with ", run.text)
        found = json.loads(listed.read_text())["primitives"]
        self.assertEqual([p["kind"] for p in found], ["plane", "sphere"])
        for number, least in ((1, 19500), (2, 9500)):
            out = self.folder / f"{number}.csv"
            pcmlab("convert", copy, out, "--where", f"primitive={number}")
            self.assertGreater(len(out.read_text().splitlines()) - 1, least)

    def test_what_is_wrong_is_said(self):
        (self.folder / "x.csv").write_text("precious")
        for one, words in ((fit(self.tree, ""), "'Places' is needed"),
                           (fit(self.tree, "1 2"), "takes x y z of each point, not 2 numbers"),
                           (fit(self.tree, "500005 4800005 100", shape=3), "no sphere was fitted"),
                           (fit(self.tree, "500005 4800005 100", threshold=-1), "'Threshold'"),
                           (fit(self.tree, "500005 4800005 100", output=self.folder / "x.csv"), "exists"),
                           (detect(self.tree, labels=True), "no output is given"),
                           (export(""), "no output file"),
                           (export(self.folder / "y.csv"), "no primitives"),
                           (export(self.folder / "y.stl", listed=self.folder / "x.csv"), "y.stl: the extension says no format")):
            with self.subTest(words):
                run = self.server([one])
                self.assertNotEqual(run.code, 0, run.text)
                self.assertIn(words, run.text)
        self.assertEqual((self.folder / "x.csv").read_text(), "precious")


if __name__ == "__main__":
    unittest.main()
