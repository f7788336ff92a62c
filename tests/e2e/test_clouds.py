"""Filters that make another cloud of trees: voxel grid, subsample, merge and transform; layers show the new tree."""

import unittest

from meshlab import MeshLabTest, pcmlab


def on(value):
    return ("RichBool", "true" if value else "false")


def choice(value, *names):
    return ("RichEnum", value, {"enum_cardinality": len(names), **{f"enum_val{i}": name for i, name in enumerate(names)}})


def result(output="", in_place=None, overwrite=False):
    parameters = {"Output": ("RichString", output), "Overwrite": on(overwrite), "MemoryMB": ("RichInt", 256),
                  "Threads": ("RichInt", 2)}
    if in_place is not None:
        parameters["InPlace"] = on(in_place)
    return parameters


def voxel_grid(tree, size, output="", in_place=False, count=False):
    return ("Voxel Grid of Point Cloud Tree", {
        "Tree": ("RichString", tree), "VoxelSize": ("RichFloat", size), "Anchor": ("RichString", ""),
        "Point": choice(0, "Centroid", "Nearest point"), "Count": on(count), "Majority": ("RichString", ""), "Mean": ("RichString", ""),
        **result(output, in_place)})


def subsample(tree, spacing=0.1, points=0, exact=False, output="", in_place=False):
    return ("Subsample Point Cloud Tree", {
        "Tree": ("RichString", tree), "By": choice(1 if points else 0, "Spacing", "Number of points"), "Spacing": ("RichFloat", spacing),
        "Points": ("RichInt", points), "Exact": on(exact), **result(output, in_place)})


def merge(output, trees="", layers=True, source_id=False):
    return ("Merge Point Cloud Trees", {
        "VisibleLayers": on(layers), "ApplyMatrices": on(True), "Trees": ("RichString", trees),
        "SourceId": on(source_id), "IgnoreCrs": on(False), **result(output)})


def transform(tree, output, translate="", rotate="", scale=1):
    return ("Transform Point Cloud Tree", {
        "Tree": ("RichString", tree), "LayerMatrix": on(True), "Translate": ("RichString", translate),
        "Rotate": ("RichString", rotate), "Scale": ("RichFloat", scale), "Pivot": ("RichString", ""), **result(output)})


class Clouds(MeshLabTest):
    def scene(self, name="first", seed=3):
        _, tree = self.generate(name, 60000, "--seed", seed, "--extent", 20, "--origin", "500000,4800000,100")
        return tree

    def assertGood(self, tree, points):
        report = pcmlab("verify", tree)
        self.assertEqual(report["faults"], [])
        self.assertEqual(report["points"], points)

    def test_a_script_makes_clouds(self):
        one, two = self.scene(), self.scene("second", 4)
        grid, thin, both, moved = (self.folder / f"{name}.pct" for name in ("grid", "thin", "both", "moved"))
        run = self.server([voxel_grid(one, 0.3, grid, count=True), subsample(one, points=5000, exact=True, output=thin),
                           merge(both, f"{one};{two}", layers=False, source_id=True),
                           transform(one, moved, translate="100 0 0")])
        self.assertEqual(run.code, 0, run.text)
        expected = pcmlab("voxel", one, "-s", 0.3, "-o", self.folder / "other.pct")["points"]
        self.assertGood(grid, expected)
        self.assertIn(f"{expected:,} points of 60,000", run.text)
        self.assertGood(thin, 5000)
        self.assertGood(both, 120000)
        self.assertGood(moved, 60000)
        self.assertAlmostEqual(pcmlab("info", moved)["bounds"]["min"][0], pcmlab("info", one)["bounds"]["min"][0] + 100)
        self.assertIn("source_id 2: second.pct", run.text)
        # The layers of the new trees, which the script has added, are merged too.
        run = self.server([voxel_grid(one, 0.3, in_place=True), subsample(two, spacing=0.5, exact=True, in_place=True)])
        self.assertEqual(run.code, 0, run.text)
        self.assertGood(one, expected)
        self.assertGood(two, pcmlab("info", two)["points"])

    def test_refuses_with_the_reason(self):
        tree = self.scene()
        for filters, words in (
                ([voxel_grid(tree, 0, self.folder / "a.pct")], ["must be a positive number"]),
                ([voxel_grid(tree, 1)], ["no output is given"]),
                ([subsample(tree, -1, output=self.folder / "a.pct")], ["must be a positive number"]),
                ([merge(self.folder / "a.pct")], ["no trees to merge"]),
                ([transform(tree, self.folder / "a.pct")], ["no transformation was given"]),
                ([voxel_grid(self.folder / "none.pct", 1, self.folder / "a.pct")], ["none.pct"])):
            with self.subTest(words[0]):
                run = self.server(filters)
                self.assertNotEqual(run.code, 0, run.text)
                for word in words:
                    self.assertIn(word, run.text)
        self.assertGood(tree, 60000)
        self.assertFalse(list(self.folder.glob("a.pct*")))

    def test_layers_show_the_results(self):
        tree = self.scene()
        moved, both = self.folder / "moved.pct", self.folder / "both.pct"
        before = pcmlab("info", tree)
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            wait-status complete
            trigger Transform: Translate, Center, set Origin
            set X Axis = 50
            press Apply
            wait-log is the layer's matrix again
            press Close
            wait-notice none
            wait-status complete
            print-layers
            trigger Transform Point Cloud Tree
            set Output folder = {moved}
            press Apply
            wait-log largest position error
            press Close
            wait-layers 2
            print-layers
            screen {self.result("moved.png")}
            check-cell PointCloudLayers 0 2 on
            pause 200
            trigger Merge Point Cloud Trees
            set Output folder = {both}
            set Overwrite = on
            press Apply
            wait-log points of 2 trees
            press Close
            wait-layers 3
            trigger Voxel Grid of Point Cloud Tree
            set Voxel size = 0.5
            set In place = on
            press Apply
            wait-log one for each voxel of 0.5
            press Close
            wait-status complete
            screen {self.result("results.png")}
            """)
        self.assertDriven(run)
        self.assertEqual([layer["matrix"][3] for layer in run.layers()], [50, 50, 0])
        self.assertAlmostEqual(pcmlab("info", moved)["bounds"]["min"][0], before["bounds"]["min"][0] + 50, 3)
        expected = pcmlab("voxel", moved, "-s", 0.5, "-o", self.folder / "other.pct")["points"]
        # The layer's matrix and the transformed tree put the points at the same places.
        self.assertLess(abs(pcmlab("info", both)["points"] / expected - 1), 0.02)
        self.assertGood(both, pcmlab("info", both)["points"])


if __name__ == "__main__":
    unittest.main()
