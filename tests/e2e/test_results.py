"""What filters and tools make of a cloud in the window: at their defaults, next to it, shown in its place."""

import unittest

from meshlab import FIXED_VIEW, NO_TIME_LIMIT, MeshLabTest, different, pcmlab


class Results(MeshLabTest):
    first_view = 0

    def cloud(self, points=30000):
        _, tree = self.generate("site", points, "--seed", 5, "--extent", 20, "--origin", "500000,4800000,100")
        return tree

    def assertShownAlone(self, layers, name):
        """One layer is shown, and it is the current one."""
        self.assertEqual([layer["label"].split(" ")[0] for layer in layers if layer["visible"]], [name], layers)
        self.assertEqual([layer["label"].split(" ")[0] for layer in layers if layer["current"]], [name], layers)
        for layer in layers:
            self.assertEqual(layer["shown"], layer["visible"])

    def test_filters_at_their_defaults(self):
        """A filter that changes a cloud is applied without a field filled in; the next one works on its result."""
        tree = self.cloud()
        filters = [("Estimate Normals of Point Cloud Tree", "computed", "site-normals"),
                   ("Estimate Radii of Point Cloud Tree", "computed", "site-normals-radii"),
                   ("Remove Outliers of Point Cloud Tree", "were removed", "site-normals-radii-clean"),
                   ("Subsample Point Cloud Tree", "Subsample of", "site-normals-radii-clean-thinned"),
                   ("Voxel Grid of Point Cloud Tree", "Voxel grid of", "site-normals-radii-clean-thinned-voxels"),
                   ("Merge Point Cloud Trees", "Merge of", "site-normals-radii-clean-thinned-voxels-merged")]
        lengths = {"Subsample Point Cloud Tree": "print-field Spacing", "Voxel Grid of Point Cloud Tree": "print-field Voxel size"}
        script = "".join(f"""
            trigger {name}
            print-field Output folder
            {lengths.get(name, "")}
            press Apply
            wait-layers {number + 2}
            wait-log Applied filter {name}
            press Close
            print-layers
            """ for number, (name, _, _) in enumerate(filters))
        run = self.gui(f"wait-view\nopen {tree}\nwait-layers 1\nwait-status complete\n{script}\nwait-status complete")
        self.assertDriven(run)
        paths = [field for field in run.fields() if field.endswith(".pct")]
        self.assertEqual(paths, [str(tree.parent / f"{name}.pct") for _, _, name in filters])
        for proposed, of in zip([float(field) for field in run.fields() if field not in paths], ("clean", "clean-thinned"), strict=True):
            levels = pcmlab("info", tree.parent / f"site-normals-radii-{of}.pct")["level"]
            finest = min(level["spacing"] for level in levels if level["spacing"] > 0)
            self.assertTrue(0.6 < proposed / finest < 1.6, (proposed, finest))
        layers, first = run.layers(), 0
        for number, (_, _, name) in enumerate(filters):
            self.assertEqual(pcmlab("verify", tree.parent / f"{name}.pct")["faults"], [])
            self.assertShownAlone(layers[first:first + number + 2], name)
            first += number + 2

    def test_names_follow_the_cloud_and_what_exists(self):
        tree, other = self.cloud(3000), self.folder / "elsewhere" / "other.pct"
        other.parent.mkdir()
        _, made = self.generate("made", 2000, "--seed", 6)
        made.rename(other)
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            wait-status complete
            trigger Remove Outliers of Point Cloud Tree
            print-field Output folder
            set Tree folder = {other}
            print-field Output folder
            set Tree folder =
            print-field Output folder
            press Apply
            wait-layers 2
            wait-log Applied filter
            print-field Output folder
            set Output folder = {self.folder / "mine.pct"}
            set Tree folder = {other}
            print-field Output folder
            press Close
            trigger Selected Points: Extract
            print-field Output
            field-button Output = Name a tree or a file
            pick {self.folder / "part.las"}
            print-field Output
            press Close
            trigger Merge Point Cloud Trees
            field-button Other trees = Add a tree
            pick {other / "index.pct"}
            field-button Other trees = Add a tree
            pick {tree / "index.pct"}
            print-field Other trees
            press Close
            """)
        self.assertDriven(run)
        self.assertEqual(run.fields(), [str(path) for path in (
            self.folder / "site-clean.pct", other.parent / "other-clean.pct", self.folder / "site-clean.pct",
            self.folder / "site-clean-2.pct", self.folder / "mine.pct", self.folder / "site-clean-part.pct",
            self.folder / "part.las", f"{other}; {tree}")])

    def test_outliers_leave_the_picture(self):
        tree = self.cloud()
        before, after = self.result("before.png"), self.result("after.png")
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {FIXED_VIEW}
            move-layer 0 3 1 2
            wait-status complete
            picture {before}
            trigger Delete Points of Point Cloud Tree
            set Where = x < 500010
            press Apply
            wait-layers 2
            wait-log points deleted
            press Close
            wait-status complete
            picture {after}
            print-layers
            print-property pcm_state
            """)
        self.assertDriven(run)
        self.assertShownAlone(run.layers(), "site-without")
        self.assertGreater(different(before, after), 0.02)
        rest = pcmlab("info", self.folder / "site-without.pct")["points"]
        self.assertEqual(run.properties("pcm_state")[-1]["points"], rest)
        # It stands where the cloud stood.
        self.assertEqual(*(layer["matrix"] for layer in run.layers()))

    def test_used_selections(self):
        """The tool's results: in place of the cloud, which has no red points then; no points of MeshLab's appear."""
        tree = self.cloud()
        shown, ended = self.result("shown.png"), self.result("ended.png")
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {FIXED_VIEW}
            wait-status complete
            trigger Select Points
            wait-log the left button selects
            set Condition = x<500010
            press By condition
            wait-label PointCloudSelectMessage x<500010
            press To a layer
            pick
            wait-layers 2
            wait-label PointCloudSelectMessage extracted
            check-cell PointCloudLayers 1 2 off
            wait-status complete
            print-property pcm_state
            press Delete points
            press Into a copy
            pick
            wait-layers 3
            wait-label PointCloudSelectMessage deleted
            wait-status complete
            print-layers
            print-property pcm_state
            press Delete points
            wait-label PointCloudSelectMessage no point is selected
            press By condition
            wait-label PointCloudSelectMessage x<500010
            press Select none
            wait-status complete
            picture {shown}
            trigger Select Points
            pause 500
            wait-status complete
            picture {ended}
            """)
        self.assertDriven(run)
        self.assertShownAlone(run.layers(), "site-without")
        part, rest = (pcmlab("info", self.folder / f"site-{name}.pct")["points"] for name in ("part", "without"))
        self.assertEqual(part + rest, 30000)
        extracted, deleted = run.properties("pcm_state")
        self.assertEqual((extracted["selected"], deleted["selected"], deleted["points"]), (part, 0, rest))
        self.assertEqual(different(shown, ended), 0, "MeshLab's own points appear when the tool ends")

    def test_classes_by_keys(self):
        """Enter takes the class that the dialog shows, and a typed number is that number."""
        tree = self.cloud(5000)
        script = "".join(f"""
            press Classify
            {keys}
            dialog-key Return
            press Into a copy
            pick {self.folder / f"{name}.pct"}
            wait-label PointCloudSelectMessage {name}.pct
            press Select shown
            wait-label PointCloudSelectMessage all shown
            """ for name, keys in (("enter", ""), ("number", "type 6"), ("list", "dialog-key Down"), ("other", "type 77")))
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {NO_TIME_LIMIT}
            wait-status complete
            trigger Select Points
            wait-log the left button selects
            press Select shown
            wait-label PointCloudSelectMessage all shown
            {script}
            press Classify
            type 256
            dialog-key Return
            wait-label PointCloudSelectMessage '256' is not a class
            """)
        self.assertDriven(run)
        for name, number in (("enter", 2), ("number", 6), ("list", 3), ("other", 77)):
            found = self.folder / f"{name}.csv"
            pcmlab("convert", self.folder / f"{name}.pct", found, "--where", f"classification={number}")
            self.assertEqual(len(found.read_text().splitlines()), 5001, name)


if __name__ == "__main__":
    unittest.main()
