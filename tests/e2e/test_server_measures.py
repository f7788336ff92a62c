"""meshlabserver: scripts measure, cut profiles and compute volumes."""

import csv
import json
import unittest

from meshlab import MeshLabTest, needs_server, pcmlab


def setUpModule():
    needs_server()


def flag(on):
    return ("RichBool", "true" if on else "false")


def choice(value, count):
    return ("RichEnum", value, {"enum_cardinality": count, **{f"enum_val{i}": str(i) for i in range(count)}})


def measure(points, kind=0, snap=False, tree="", surface="", name="", listed="", output="", overwrite=False):
    return ("Measure", {
        "Kind": choice(kind, 7), "Points": ("RichString", points), "Snap": flag(snap), "Tree": ("RichString", tree),
        "Surface": ("RichString", surface), "Name": ("RichString", name), "ListFile": ("RichString", listed),
        "OutputFile": ("RichString", output), "Overwrite": flag(overwrite)})


def profile(tree, line, width=1, heights="", level=-1, where="", attributes="", output="", in_place=False, overwrite=False):
    return ("Cross-Section Profile", {
        "Tree": ("RichString", tree), "Line": ("RichString", line), "Width": ("RichFloat", width),
        "Heights": ("RichString", heights), "Level": ("RichInt", level), "Where": ("RichString", where),
        "Attributes": ("RichString", attributes), "InPlace": flag(in_place), "Exaggeration": ("RichFloat", 1),
        "OutputFile": ("RichString", output), "Overwrite": flag(overwrite)})


def volume(tree, polygon="", reference=0, height="0", plane="", before="", side=0, interpolate=False, output=""):
    return ("Cut Volume", {
        "Tree": ("RichString", tree), "Polygon": ("RichString", polygon), "Reference": choice(reference, 3),
        "Height": ("RichString", height), "Plane": ("RichString", plane), "TreeBefore": ("RichString", before),
        "Side": ("RichFloat", side), "CellHeight": choice(0, 3), "Interpolate": flag(interpolate),
        "Level": ("RichInt", -1), "Where": ("RichString", ""), "Name": ("RichString", ""),
        "OutputFile": ("RichString", output), "Overwrite": flag(False)})


class ServerMeasures(MeshLabTest):
    def setUp(self):
        super().setUp()
        las = self.folder / "a.las"
        pcmlab("generate", "--points", 60000, "--seed", 3, "--no-truth", las)
        self.tree = self.folder / "a.pct"
        pcmlab("build", las, "-o", self.tree)

    def test_measures_and_writes_lists(self):
        points = "500010 4800010 100 500030 4800040 102"
        run = self.server([measure(points, snap=True, tree=self.tree, name="across", output=self.folder / "a.json"),
                           measure("0 0 0; 4 0 0; 4 3 0", kind=3, listed=self.folder / "a.json",
                                   output=self.folder / "b.geojson")])
        self.assertEqual(run.code, 0, run.text)
        self.assertIn("across (distance)", run.text)
        self.assertIn("plan area          6", run.text)
        same = pcmlab("measure", "distance", "--from", self.tree, "-p", *points.split())["measures"][0]["values"]
        listed = pcmlab("measure", "--list", self.folder / "a.json")["measures"][0]
        self.assertEqual(listed["values"]["distance"]["value"], same["distance"]["value"])
        features = json.loads((self.folder / "b.geojson").read_text())["features"]
        self.assertEqual([feature["properties"]["name"] for feature in features], ["across", "Area 1"])

    def test_profiles(self):
        line = "500000 4800030 500060 4800030"
        run = self.server([profile(self.tree, line, 2, attributes="intensity", output=self.folder / "p.csv")])
        self.assertEqual(run.code, 0, run.text)
        with open(self.folder / "p.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        count = pcmlab("profile", self.tree, "--line", *line.split(), "-w", 2)["points"]
        self.assertEqual(len(rows), count)
        self.assertIn(f"{count:,} points", run.text)
        self.assertIn("intensity", rows[0])

    def test_volumes(self):
        polygon = "500010 4800010 500050 4800010 500050 4800050"
        run = self.server([volume(self.tree, polygon, height="95.5", side=1, interpolate=True, output=self.folder / "v.json")])
        self.assertEqual(run.code, 0, run.text)
        ours = pcmlab("measure", "--list", self.folder / "v.json")["measures"][0]["values"]
        same = pcmlab("volume", self.tree, "--reference", 95.5, "--side", 1, "--polygon", *polygon.split())
        self.assertEqual(ours["net"]["value"], same["net"])
        self.assertEqual(ours["plan area"]["value"], 800)

    def test_what_is_wrong_is_said(self):
        (self.folder / "x.csv").write_text("precious")
        for one, words in ((measure(""), "takes x y z of each point, not 0 numbers"),
                           (measure("1 2 3 4"), "takes x y z of each point, not 4 numbers"),
                           (measure("1 2 3 4 5 6", output=self.folder / "x.csv"), "exists already"),
                           (measure("1 2 3", kind=5, surface="cube 1"), "is not a shape"),
                           (profile(self.tree, "1 2"), "at least 2 points"),
                           (profile(self.tree, "0 0 1 1", level=77), "there is no level 77"),
                           (volume(self.tree, reference=1), "what to compare with"),
                           (volume(self.tree, reference=2), "what to compare with")):
            with self.subTest(words):
                run = self.server([one])
                self.assertNotEqual(run.code, 0, run.text)
                self.assertIn(words, run.text)
        self.assertEqual((self.folder / "x.csv").read_text(), "precious")


if __name__ == "__main__":
    unittest.main()
