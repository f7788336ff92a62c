"""How MeshLab shows clouds: all splat modes, multisampling, both projections, several clouds, and MeshLab's own tools."""

import math
import os
import random
import re
import shutil
import struct
import unittest

from meshlab import REFERENCE, MeshLabTest, different, pcmlab

# Two renderings of a view may differ in pixels along the edges of splats, where versions of the software renderer round
# differently.
SAME_PICTURE = 0.02
MODES = ("constant", "adaptive", "affine", "perspective", "fitted")  # in the order of the setting
VIEW = "view-size 320 240\n"
SIDE = 60  # points along a cloud's edge


def write_ply(path, height, *, splats=True, at=(0, 0, 0), side=SIDE):
    """A surface z = height(x, y) over -1..1 with coloured patches; with or without normals, and radii that close the surface."""
    rng = random.Random(3)
    step = 2 / side
    lines = ["ply", "format binary_little_endian 1.0", f"element vertex {side * side}", "property double x", "property double y",
             "property double z"]
    if splats:
        lines += ["property float nx", "property float ny", "property float nz", "property float radius"]
    lines += ["property uchar red", "property uchar green", "property uchar blue", "end_header"]
    with open(path, "wb") as file:
        file.write(("\n".join(lines) + "\n").encode())
        for i in range(side):
            for j in range(side):
                x, y = (-1 + step * (k + 0.5 + rng.uniform(-0.3, 0.3)) for k in (i, j))
                z, h = height(x, y), 1e-4
                file.write(struct.pack("<3d", x + at[0], y + at[1], z + at[2]))
                if splats:
                    slope = [(height(x + h, y) - height(x - h, y)) / (2 * h), (height(x, y + h) - height(x, y - h)) / (2 * h)]
                    length = math.hypot(*slope, 1)
                    file.write(struct.pack("<4f", -slope[0] / length, -slope[1] / length, 1 / length, 0.9 * step * length ** 0.5))
                patch = (i // 6 + j // 6) % 3
                file.write(bytes(((220, 70, 60), (60, 160, 80), (240, 220, 130))[patch]))


def waves(x, y):
    return 0.25 * math.sin(3 * x) * math.cos(2.5 * y)


def flat(_x, _y):
    return 0.0


class Splats(MeshLabTest):
    def cloud(self, name, *arguments, **options):
        ply, tree = self.folder / f"{name}.ply", self.folder / f"{name}.pct"
        write_ply(ply, *arguments, **options)
        pcmlab("build", ply, "-o", tree)
        return tree

    def test_modes(self):
        """Two reference pictures per mode: a tilted perspective view, and a grazing orthographic one."""
        tree = self.cloud("waves", waves)
        views = {"tilted": "drag 0.5 0.6 0.55 0.42\nwheel -4\n",
                 "grazing": "drag 0.5 0.7 0.5 0.53\ntrigger Toggle Orthographic Camera\npause 100\n"}
        script, pictures = "", {}
        for view, move in views.items():
            script += move
            for number, mode in enumerate(MODES):
                pictures[mode, view] = self.result(f"{mode}-{view}.png")
                script += f"parameter MeshLab::PointCloud::Splats = {number}\n"
                script += f"wait-status full resolution\npicture {pictures[mode, view]}\n"
        run = self.gui(f"""
            wait-view
            {VIEW}
            parameter MeshLab::PointCloud::SplatSize = 3
            parameter MeshLab::PointCloud::EyeDomeLighting = 0
            open {tree}
            wait-layers 1
            {script}
            screen {self.result("screen.png")}
            """)
        self.assertDriven(run)
        for (mode, view), picture in pictures.items():
            reference = REFERENCE / f"splats-{mode}-{view}.png"
            if os.environ.get("PCM_UPDATE_REFERENCE"):
                shutil.copy(picture, reference)
            self.assertLess(different(picture, reference), SAME_PICTURE, f"{mode} {view}")
        for view in views:
            for first, second in zip(MODES, MODES[1:]):
                share = different(pictures[first, view], pictures[second, view])
                if (second, view) == ("perspective", "grazing"):  # in an orthographic view the affine projection is exact
                    self.assertLess(share, 0.005)
                else:
                    self.assertGreater(share, 0.005, f"{first} {second} {view}")

    def test_settings(self):
        """Multisampling, colours and the radius scale change the picture, eye-dome lighting leaves smooth surfaces; a missing attribute is logged once."""
        tree, bare = self.cloud("waves", waves), self.cloud("bare", waves, splats=False)
        names = ("plain", "samples", "domes", "larger", "height", "uniform", "again")
        p = {name: self.result(f"{name}.png") for name in names}
        setting = "parameter MeshLab::PointCloud::"
        shot = "wait-status full resolution\npicture "
        run = self.gui(f"""
            wait-view
            {VIEW}
            open {tree}
            wait-layers 1
            {setting}Splats = 3
            {setting}Samples = 0
            {setting}EyeDomeLighting = 0
            drag 0.5 0.6 0.55 0.42
            {shot}{p["plain"]}
            {setting}Samples = 2
            {shot}{p["samples"]}
            unfold
            pause 200
            screen {self.result("screen.png")}
            {setting}Samples = 0
            {setting}EyeDomeLighting = 1
            {shot}{p["domes"]}
            {setting}EyeDomeLighting = 0
            {setting}RadiusScale = 2
            {shot}{p["larger"]}
            {setting}RadiusScale = 1
            {setting}Colour = 2
            {shot}{p["height"]}
            {setting}Colour = 6
            {shot}{p["uniform"]}
            {setting}Colour = 0
            {shot}{p["again"]}
            trigger Delete Current Mesh
            wait-layers 0
            open {bare}
            wait-layers 1
            wait-log bare:
            wait-status full resolution
            pause 200
            wait-status full resolution
            {setting}Splats = 1
            wait-status full resolution
            {setting}Splats = 3
            wait-status full resolution
            print-log
            """)
        self.assertDriven(run)
        for name in names[1:-1]:
            if name != "domes":
                self.assertGreater(different(p["plain"], p[name]), 0.002, name)
        # A smooth surface has no outlines. (Where there are steps: test_window.)
        self.assertLess(different(p["plain"], p["domes"]), 0.002)
        self.assertEqual(different(p["plain"], p["again"]), 0)
        # Edges only.
        self.assertLess(different(p["plain"], p["samples"]), 0.5)
        notices = [line for line in re.search(r"driver: log (.*)", run.text)[1].split(" | ") if line.startswith("bare: ") and "no normals" in line]
        self.assertEqual(len(notices), 1, notices)

    def test_several_clouds(self):
        """All clouds share the depth buffer, and each is transformed by its layer's matrix."""
        left, right = self.cloud("left", waves), self.cloud("right", waves, at=(2.5, 0, 0.5))
        names = ("both", "left", "right", "left-moved")
        p = {name: self.result(f"{name}.png") for name in names}
        run = self.gui(f"""
            wait-view
            {VIEW}
            parameter MeshLab::PointCloud::Splats = 3
            open {left}
            wait-layers 1
            open {right}
            wait-layers 2
            drag 0.5 0.6 0.52 0.45
            wait-status {2 * SIDE * SIDE} points of 2 clouds, complete, full resolution
            picture {p["both"]}
            screen {self.result("screen.png")}
            show-layer 0 off
            wait-status {SIDE * SIDE} points of 1 clouds, complete, full resolution
            picture {p["right"]}
            show-layer 0 on
            show-layer 1 off
            wait-status {SIDE * SIDE} points of 1 clouds, complete, full resolution
            picture {p["left"]}
            move-layer 0 2.5 0 0.5
            wait-status {SIDE * SIDE} points of 1 clouds, complete, full resolution
            picture {p["left-moved"]}
            move-layer 0 0 0 0
            show-layer 1 on
            wait-status of 2 clouds, complete, full resolution
            trigger Delete Current Mesh
            wait-layers 1
            wait-status of 1 clouds, complete, full resolution
            """)
        self.assertDriven(run)
        self.assertGreater(different(p["both"], p["left"]), 0.05)
        self.assertGreater(different(p["both"], p["right"]), 0.05)
        self.assertGreater(different(p["left"], p["right"]), 0.1)
        # The same points, up to rounding at the edges of splats.
        self.assertLess(different(p["left-moved"], p["right"]), SAME_PICTURE)

    def test_full_resolution_within_budgets(self):
        """A view at rest converges to the same picture under any budget of time, points or video memory (a third of the cloud)."""
        _, tree = self.generate("scene", 1500000, "--seed", 5)
        free, tight, moved = (self.result(f"{name}.png") for name in ("free", "tight", "moved"))
        setting = "parameter MeshLab::PointCloud::"
        run = self.gui(f"""
            wait-view
            {VIEW}
            {setting}FrameBudget = 100000
            open {tree}
            wait-layers 1
            drag 0.5 0.6 0.52 0.45
            wheel -4
            wait-status complete, full resolution
            picture {free}
            {setting}FrameBudget = 5
            {setting}PointBudget = 0.1
            {setting}VideoMemory = 8
            {setting}Memory = 16
            wait-status complete, full resolution
            picture {tight}
            drag 0.5 0.5 0.55 0.5
            drag 0.55 0.5 0.5 0.5
            wait-status complete, full resolution
            picture {moved}
            """)
        self.assertDriven(run)
        self.assertEqual(different(free, tight), 0)
        # More than a million points are in view, and a frame adds a hundred thousand.
        drawn = [(int(points), int(frame)) for points, frame in re.findall(r"driver: picture .* (\d+) points of .* frame (\d+)", run.text)]
        self.assertEqual(len(drawn), 3)
        self.assertGreater(drawn[0][0], 1000000)
        self.assertGreaterEqual(drawn[1][1] - drawn[0][1], 10)
        # After moving there and back the camera is the same up to the last bit.
        self.assertLess(different(free, moved), SAME_PICTURE)

    def test_snapshots(self):
        """A snapshot shows the same as the view; a tiled one the same as a larger view, under any frame budget."""
        _, tree = self.generate("scene", 300000, "--seed", 5)
        shown, large = self.result("shown.png"), self.result("large.png")
        setting = "parameter MeshLab::PointCloud::"
        run = self.gui(f"""
            wait-view
            {VIEW}
            {setting}FrameBudget = 5
            {setting}PointBudget = 0.05
            {setting}TargetSpacing = 0.1
            open {tree}
            wait-layers 1
            drag 0.5 0.6 0.52 0.45
            wheel -2
            wait-status complete, full resolution
            picture {shown}
            trigger Save snapshot
            press Save
            wait-log Snapshot saved to ./snapshot00.png
            wait-status complete, full resolution
            {setting}PointBudget = 20
            trigger Save snapshot
            set Screen Multiplier = 2
            press Save
            wait-log Snapshot saved to ./snapshot01.png
            view-size 640 480
            wait-status complete, full resolution
            picture {large}
            """)
        self.assertDriven(run)
        for name, picture in (("snapshot00.png", shown), ("snapshot01.png", large)):
            shutil.copy(self.folder / name, self.result(name))
            # MeshLab draws a frame around the current view, but not in a snapshot.
            self.assertLess(different(self.folder / name, picture, border=6), SAME_PICTURE, name)

    def test_measuring_tool(self):
        """MeshLab's Measuring Tool picks points from the depth of our splats, with and without multisampling."""
        tree = self.cloud("flat", flat)
        script = ""  # a measurement suspends the tool
        for name, settings in {"constant": (0, 0), "perspective": (3, 0), "samples": (3, 2)}.items():
            script += f"""
                parameter MeshLab::PointCloud::Splats = {settings[0]}
                parameter MeshLab::PointCloud::Samples = {settings[1]}
                wait-status full resolution
                press-at 0.35 0.5
                release-at 0.35 0.5
                pause 100
                move-to 0.5 0.5
                pause 50
                press-at 0.65 0.5
                release-at 0.65 0.5
                pause 100
                print-camera {name}
                screen {self.result(name + ".png")}
                trigger Not editing
                pause 100
                """
        run = self.gui(f"""
            wait-view
            {VIEW}
            parameter MeshLab::PointCloud::SplatSize = 12
            open {tree}
            wait-layers 1
            wait-status full resolution
            trigger Measuring Tool
            wait-log Started Mode Measuring Tool
            {script}
            print-log
            """)
        self.assertDriven(run)
        found = [float(v) for v in re.findall(r"Distance M\d: (\S+)", re.search(r"driver: log (.*)", run.text)[1])]
        # At the plane the view spans 1.75 / scale above and below the centre; 96 of 240 pixels were measured.
        expected = 2 * 1.75 / run.cameras()["constant"]["scale"] * 96 / 240
        self.assertEqual(len(found), 3, found)
        for measured in found:
            self.assertAlmostEqual(measured / expected, 1, delta=2e-3)


if __name__ == "__main__":
    unittest.main()
