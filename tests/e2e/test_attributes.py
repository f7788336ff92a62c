"""Filters that compute on points of trees: radii, normals, outliers; the view draws discs afterwards."""

import unittest

from meshlab import FIXED_VIEW, MeshLabTest, different, pcmlab


# As MeshLab writes the choices of a parameter into scripts.
METHODS = {"enum_cardinality": 3, "enum_val0": "Statistical", "enum_val1": "Robust", "enum_val2": "By radius"}


def flag(value):
    return ("RichBool", "true" if value else "false")


def common(tree, output, in_place):
    return {"Tree": ("RichString", tree), "Output": ("RichString", output), "InPlace": flag(in_place),
            "MemoryMB": ("RichInt", 256), "Threads": ("RichInt", 2)}


def radii(tree, output="", in_place=False, neighbours=16):
    return ("Estimate Radii of Point Cloud Tree", {
        **common(tree, output, in_place), "MaxDistance": ("RichFloat", 0), "Neighbours": ("RichInt", neighbours)})


def normals(tree, output="", in_place=False, viewpoint="", direction=""):
    return ("Estimate Normals of Point Cloud Tree", {
        **common(tree, output, in_place), "MaxDistance": ("RichFloat", 0), "Neighbours": ("RichInt", 16),
        "Radii": flag(True), "RadiusNeighbours": ("RichInt", 6), "RadiusLimit": ("RichFloat", 2.5),
        "Curvature": flag(True), "Confidence": flag(True), "Viewpoint": ("RichString", viewpoint),
        "Direction": ("RichString", direction)})


def outliers(tree, output="", in_place=False, method=0, factor=3, radius=0, label=False, count=False):
    return ("Remove Outliers of Point Cloud Tree", {
        **common(tree, output, in_place), "Method": ("RichEnum", method, METHODS), "Neighbours": ("RichInt", 16),
        "Factor": ("RichFloat", factor), "Radius": ("RichFloat", radius), "Label": flag(label), "CountOnly": flag(count),
        "Overwrite": flag(False)})


class Attributes(MeshLabTest):
    def cloud(self, points=20000):
        return self.generate("scan", points, "--seed", 3, "--extent", 20, "--origin", "500000,4800000,100")[1]

    def assertGood(self, tree, points, *attributes):
        report = pcmlab("verify", tree)
        self.assertEqual(report["faults"], [])
        self.assertEqual(report["points"], points)
        names = [attribute["name"] for attribute in pcmlab("info", tree)["attributes"]]
        for name in attributes:
            self.assertIn(name, names)

    def test_a_script_computes_attributes(self):
        tree, clean, both = self.cloud(), self.folder / "clean.pct", self.folder / "both.pct"
        labelled = self.folder / "labelled.pct"
        run = self.server([
            outliers(tree, count=True), outliers(tree, clean), outliers(tree, labelled, method=1, factor=6, label=True),
            radii(clean, in_place=True, neighbours=4), normals(clean, both, viewpoint="500010 4800010 102")])
        self.assertEqual(run.code, 0, run.text)
        left = pcmlab("info", clean)["points"]
        self.assertLess(left, 20000)
        self.assertIn(f"{tree}: {20000 - left:,} of 20,000 points would be removed", run.text)
        self.assertIn(f"{clean}: {20000 - left:,} of 20,000 points removed", run.text)
        self.assertIn("points labelled", run.text)
        self.assertIn(f"{clean}: radii: ", run.text)
        self.assertIn(", exact", run.text)
        self.assertIn(f"{both}: normals, radii and curvature: ", run.text)
        self.assertIn("neighbours on a line", run.text)
        self.assertGood(tree, 20000)
        self.assertGood(clean, left, "radius")
        self.assertGood(both, left, "radius", "normal", "curvature", "normal_confidence")
        self.assertGood(labelled, 20000, "outlier")

    def test_refuses_and_leaves_the_tree_alone(self):
        tree = self.cloud(2000)
        before = {file.name: file.read_bytes() for file in tree.iterdir()}
        for call, words in ((radii(tree), "no output is given"), (radii(tree, tree.parent / "o.pct", neighbours=0), "'0' is not a whole number from 1 to 1024"),
                            (normals(tree, in_place=True, direction="0 0 0"), "0 0 0"),
                            (normals(tree, in_place=True, viewpoint="1 2"), "'Scanner position' takes 3 numbers"),
                            (outliers(tree, in_place=True, method=2), "the method radius needs"),
                            (outliers(tree, in_place=True, label=True, count=True), "nothing is to be changed")):
            with self.subTest(words):
                run = self.server([call])
                self.assertNotEqual(run.code, 0, run.text)
                self.assertIn(words, run.text)
        self.assertEqual({file.name: file.read_bytes() for file in tree.iterdir()}, before)
        self.assertFalse((tree.parent / "o.pct").exists())

    def test_splats_follow_what_was_estimated(self):
        tree = self.cloud()
        before, radii_alone, discs, copy = (self.result(f"{name}.png") for name in ("before", "radii", "discs", "copy"))
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {FIXED_VIEW}
            wheel -2
            parameter MeshLab::PointCloud::RadiusScale = 2
            wait-status full resolution
            picture {before}
            print-camera before
            trigger Estimate Radii of Point Cloud Tree
            set Neighbours = 40
            set In place = on
            screen {self.result("dialog.png")}
            press Apply
            wait-log radii: 
            press Close
            wait-status full resolution
            picture {radii_alone}
            print-parameters radii
            trigger Estimate Normals of Point Cloud Tree
            set In place = on
            screen {self.result("normals.png")}
            press Apply
            wait-log follow them
            press Close
            wait-status full resolution
            print-parameters discs
            picture {discs}
            print-camera first
            trigger Remove Outliers of Point Cloud Tree
            set Factor = 1
            set Output folder = {self.folder / "clean.pct"}
            press Apply
            wait-log were removed
            press Close
            wait-layers 2
            wait-status full resolution
            print-camera second
            screen {self.result("end.png")}
            """)
        self.assertDriven(run)
        self.assertGreater(different(before, radii_alone), 0.02)
        self.assertGreater(different(radii_alone, discs), 0.02)
        self.assertGood(tree, 20000, "radius", "normal")
        cameras = run.cameras()
        for later in ("first", "second"):  # the view is not changed
            self.assertEqual({**cameras[later], "name": ""}, {**cameras["before"], "name": ""})
        settings = run.parameters()
        self.assertEqual(settings["radii"]["Splats"], 4)  # fitted to the surface
        self.assertEqual(settings["discs"]["Splats"], 4)


if __name__ == "__main__":
    unittest.main()
