"""What tools make visible: the clip box, and what a map has in addition to its content."""

import re
import shutil
import unittest

from meshlab import FIXED_VIEW, MeshLabTest, different, pcmlab

# The lower half, in x, of a scene that is 20 units wide at this place; typed as a user does.
ORIGIN = "500000,4800000,100"
HALF = "499990 4799990 -1000 500010 4800030 2000"


def clip(mode, box=""):
    return f"""
            trigger Set Clip Box
            set Mode = {mode}
            {"set Box = " + box if box else ""}
            press Apply
            """


class SeeingTools(MeshLabTest):
    def points_in(self, run, picture):
        return int(re.search(re.escape(str(picture)) + r" \d+x\d+, (\d+) points", run.text)[1])

    def test_a_clip_box_hides_and_shows(self):
        _, tree = self.generate("scene", 200000, "--seed", 3, "--extent", 20, "--origin", ORIGIN)
        names = ["all", "inside", "outside", "off"]
        pictures = {name: self.result(name + ".png") for name in names}
        written = self.folder / "clipped.las"
        run = self.gui(f"""
            wait-view
            open {tree}
            {FIXED_VIEW}
            wait-layers 1
            wait-status full resolution
            picture {pictures["all"]}
            {clip("Show what is in it", HALF)}
            wait-log Shown alone
            press Close
            wait-status full resolution
            picture {pictures["inside"]}
            trigger Delete Points of Point Cloud Tree
            field-button Box = Box around the clip box
            print-field Box
            press Close
            export-asking {written}
            set Only what the clip box shows = on
            press OK
            wait-log to {written}
            {clip("Hide what is in it")}
            wait-log Hidden
            press Close
            wait-status full resolution
            picture {pictures["outside"]}
            {clip("Off")}
            wait-log is off
            press Close
            wait-status full resolution
            picture {pictures["off"]}
            """)
        self.assertDriven(run)
        self.assertEqual(different(pictures["all"], pictures["off"]), 0)
        for name in ("inside", "outside"):
            self.assertGreater(different(pictures["all"], pictures[name]), 0.1, name)
        self.assertGreater(different(pictures["inside"], pictures["outside"]), 0.1)
        box = list(map(float, HALF.split()))
        inside = pcmlab("query", tree, "--count", "--box", *HALF.split())["points"]
        self.assertEqual(pcmlab("info", written)["points"], inside)
        self.assertGreater(inside, 40000)
        self.assertLess(inside, 160000)
        # Points next to the border are counted in groups.
        self.assertEqual(self.points_in(run, pictures["all"]), 200000)
        for name, points in (("inside", inside), ("outside", 200000 - inside)):
            shown = self.points_in(run, pictures[name])
            self.assertGreaterEqual(shown, points, name)
            self.assertLess(shown, points + 30000, name)
        self.assertIn(" ".join(f"{v:.0f}" for v in box), run.text)

    def snapshot(self, number, name):
        """Commands that take a picture of the view, and a snapshot of twice its size."""
        return f"""
            wait-status full resolution
            picture {self.result(name + ".png")}
            trigger Save snapshot
            set Screen Multiplier = 2
            press Save
            wait-log Snapshot saved to ./snapshot{number:02}.png
            """

    def test_a_map_has_a_scale_bar_and_a_grid(self):
        """Also in a snapshot that is made of tiles, where they are as many times as large."""
        _, tree = self.generate("scene", 100000, "--seed", 3, "--extent", 20, "--origin", ORIGIN)
        names = ["plain", "bar", "north", "grid", "legend", "label", "again"]
        run = self.gui(f"""
            wait-view
            open {tree}
            {FIXED_VIEW}
            wait-layers 1
            trigger Toggle Orthographic Camera
            parameter MeshLab::PointCloud::Colour = 3
            parameter MeshLab::PointCloud::Legend = 0
            {self.snapshot(0, "plain")}
            parameter MeshLab::PointCloud::ScaleBar = 1
            {self.snapshot(1, "bar")}
            parameter MeshLab::PointCloud::NorthArrow = 1
            {self.snapshot(2, "north")}
            parameter MeshLab::PointCloud::PlanGrid = 1
            {self.snapshot(3, "grid")}
            parameter MeshLab::PointCloud::ScaleBar = 0
            parameter MeshLab::PointCloud::NorthArrow = 0
            parameter MeshLab::PointCloud::PlanGrid = 0
            parameter MeshLab::PointCloud::Legend = 1
            {self.snapshot(4, "legend")}
            parameter MeshLab::PointCloud::Legend = 0
            trigger Measure
            wait-log Measure: click points
            field PointCloudMeasureKind = Point
            click 0.45 0.55
            wait-rows PointCloudMeasureList 1
            {self.snapshot(5, "label")}
            press Delete measure
            wait-rows PointCloudMeasureList 0
            {self.snapshot(6, "again")}
            """)
        self.assertDriven(run)
        pictures = {name: self.result(name + ".png") for name in names}
        large = {name: self.folder / f"snapshot{i:02}.png" for i, name in enumerate(names)}
        for name, path in large.items():
            shutil.copy(path, self.result(name + "-snapshot.png"))
        for before, after, least, most in (("plain", "bar", 0.005, 0.1), ("bar", "north", 0.002, 0.05), ("north", "grid", 0.01, 0.5),
                                           ("again", "legend", 0.005, 0.2), ("again", "label", 0.005, 0.1)):
            share = different(pictures[before], pictures[after])
            self.assertGreater(share, least, after)
            self.assertLess(share, most, after)
            self.assertAlmostEqual(different(large[before], large[after]) / share, 1, delta=0.25, msg=after)
        for pair in (pictures, large):
            self.assertEqual(different(pair["plain"], pair["again"]), 0)


if __name__ == "__main__":
    unittest.main()
