"""What the colours of clouds show in MeshLab: ranges, attributes, ramps, conditions, hidden classes, and the legend."""

import re
import unittest

from meshlab import FIXED_VIEW, MeshLabTest, different, pcmlab

MODES = {"rgb": 0, "intensity": 1, "height": 2, "classification": 3, "attribute": 7}
NAME = "MeshLab::PointCloud::"


class Colours(MeshLabTest):
    def cloud(self):
        """A hill without colours and intensities: classes by height, and one point far above everything."""
        lines = []
        for i in range(200):
            for j in range(200):
                x, y = i * 0.1, j * 0.1
                z = 100 + 4 * (1 - ((x - 10) / 10) ** 2) * (1 - ((y - 10) / 10) ** 2)
                lines.append(f"{x:.3f} {y:.3f} {z:.3f} {2 if z < 102 else 5} {i}")
        lines.append("10 10 160 7 0")
        text, tree = self.folder / "hill.txt", self.folder / "hill.pct"
        text.write_text("x y z classification column\n" + "\n".join(lines) + "\n")
        pcmlab("build", text, "-o", tree)
        return tree

    def test_the_legend_says_what_is_shown(self):
        tree = self.cloud()
        script, names = "", []

        def look(name, **parameters):
            nonlocal script
            for key, value in parameters.items():
                script += f"parameter {NAME}{key} = {value}\n"
            script += f"wait-status full resolution\nprint-legend {name}\nprint-status\npicture {self.result(name + '.png')}\n"
            names.append(name)

        look("default")
        look("height", Colour=MODES["height"])
        look("range", Range="100:102")
        look("attribute", Range="", Colour=MODES["attribute"], Attribute="column", Ramp=3)
        look("classes", Colour=MODES["classification"], Ramp=0)
        look("condition", Conditions="z<103; classification=5")
        look("hidden", Conditions="", HiddenClasses="2, 7")
        look("all", HiddenClasses="")
        look("wrong", Conditions="z")
        look("none", Conditions="", Legend="false")
        run = self.gui(f"""
            wait-view
            {FIXED_VIEW}
            open {tree}
            wait-layers 1
            parameter {NAME}Splats = 0
            {script}
            screen {self.result("screen.png")}
            print-log
            """)
        self.assertDriven(run)
        legends = run.legends()
        # The height, without the point far above.
        self.assertEqual(legends["height"][0], "Height (source units)")
        low, _, high = (float(value) for value in legends["height"][1:])
        self.assertLess(high, 105)
        self.assertLess(low, 100.5)
        self.assertEqual(legends["range"], ["Height (source units)", "100", "101", "102"])
        self.assertEqual(legends["attribute"][0], "column")
        self.assertAlmostEqual(float(legends["attribute"][3]), 198, delta=1)
        classes = ["Classification", "2  ground", "5  high vegetation", "7  low point (noise)"]
        self.assertEqual(legends["classes"], classes)
        self.assertEqual(legends["default"], classes)  # there are no colours, and the classes say something
        self.assertEqual(legends["condition"], ["Classification", "5  high vegetation"])
        self.assertEqual(legends["hidden"], ["Classification", "2  ground (hidden)", "5  high vegetation", "7  low point (noise) (hidden)"])
        self.assertEqual(legends["all"], classes)
        self.assertEqual(legends["wrong"], classes)  # what cannot be read has no effect, and the log reports it
        self.assertIn("condition 'z'", re.search(r"driver: log (.*)", run.text)[1])
        self.assertEqual(legends["none"], [])
        picture = {name: self.result(name + ".png") for name in names}
        for a, b in (("default", "height"), ("height", "range"), ("height", "attribute"), ("attribute", "classes"), ("classes", "condition"),
                     ("condition", "hidden"), ("hidden", "all"), ("all", "none")):
            self.assertGreater(different(picture[a], picture[b]), 0.005, (a, b))
        self.assertEqual(different(picture["classes"], picture["all"]), 0)

    def test_a_click_on_a_class_hides_it(self):
        tree = self.cloud()
        run = self.gui(f"""
            wait-view
            {FIXED_VIEW}
            open {tree}
            wait-layers 1
            parameter {NAME}Splats = 0
            parameter {NAME}Colour = {MODES["classification"]}
            wait-status full resolution
            print-camera before
            press-at 0.93 0.105
            release-at 0.93 0.105
            wait-status full resolution
            print-legend clicked
            print-camera after
            press-at 0.93 0.105
            release-at 0.93 0.105
            wait-status full resolution
            print-legend again
            """)
        self.assertDriven(run)
        self.assertEqual(run.legends()["clicked"][1], "2  ground (hidden)")
        self.assertEqual(run.legends()["again"][1], "2  ground")
        cameras = run.cameras()
        self.assertEqual(cameras["before"]["eye"], cameras["after"]["eye"])  # the click was the legend's


if __name__ == "__main__":
    unittest.main()
