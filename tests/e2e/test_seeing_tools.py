"""What tools make visible: the clip box, and what a map has beside its content."""

import re
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
            quit
            """, tree)
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
        # Points beside the border are counted in groups.
        self.assertEqual(self.points_in(run, pictures["all"]), 200000)
        for name, points in (("inside", inside), ("outside", 200000 - inside)):
            shown = self.points_in(run, pictures[name])
            self.assertGreaterEqual(shown, points, name)
            self.assertLess(shown, points + 30000, name)
        self.assertIn(" ".join(f"{v:.0f}" for v in box), run.text)

    def test_a_map_has_a_scale_bar_and_a_grid(self):
        _, tree = self.generate("scene", 100000, "--seed", 3, "--extent", 20, "--origin", ORIGIN)
        pictures = {name: self.result(name + ".png") for name in ("plain", "bar", "north", "grid", "again")}
        run = self.gui(f"""
            wait-view
            {FIXED_VIEW}
            wait-layers 1
            trigger Toggle Orthographic Camera
            wait-status full resolution
            picture {pictures["plain"]}
            parameter MeshLab::PointCloud::ScaleBar = 1
            wait-status full resolution
            picture {pictures["bar"]}
            parameter MeshLab::PointCloud::NorthArrow = 1
            wait-status full resolution
            picture {pictures["north"]}
            parameter MeshLab::PointCloud::PlanGrid = 1
            wait-status full resolution
            picture {pictures["grid"]}
            parameter MeshLab::PointCloud::ScaleBar = 0
            parameter MeshLab::PointCloud::NorthArrow = 0
            parameter MeshLab::PointCloud::PlanGrid = 0
            wait-status full resolution
            picture {pictures["again"]}
            quit
            """, tree)
        self.assertDriven(run)
        for before, after, least, most in (("plain", "bar", 0.005, 0.1), ("bar", "north", 0.002, 0.05), ("north", "grid", 0.01, 0.5)):
            share = different(pictures[before], pictures[after])
            self.assertGreater(share, least, after)
            self.assertLess(share, most, after)
        self.assertEqual(different(pictures["plain"], pictures["again"]), 0)


if __name__ == "__main__":
    unittest.main()
