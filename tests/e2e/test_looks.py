"""What a user sees and reopens: the camera of a project, dark colours, the legend as a scale, menus, damaged clouds."""

import re
import unittest

from meshlab import FIXED_VIEW, NO_TIME_LIMIT, MeshLabTest, different, pcmlab

NAME = "MeshLab::PointCloud::"


class Looks(MeshLabTest):
    first_view = 0

    def test_the_camera_is_kept_in_projects(self):
        _, tree = self.generate("site", 40000, "--seed", 2, "--extent", 20, "--origin", "500000,4800000,100")
        project, before, after = self.folder / "site.mlp", self.result("before.png"), self.result("after.png")
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {FIXED_VIEW}
            wait-status complete
            drag 0.4 0.5 0.6 0.7
            wheel 4
            pause 300
            wait-status full resolution
            print-camera saved
            picture {before}
            trigger Save Project As...
            pick {project}
            wait-file {project}
            """)
        self.assertDriven(run)
        # In a MeshLab of its own: another session, with the project on its command line.
        again = self.own_gui(f"""
            wait-view
            wait-layers 1
            pause 500
            {FIXED_VIEW}
            wait-status full resolution
            print-camera opened
            picture {after}
            quit
            """, project)
        self.assertDriven(again)
        saved, opened = run.cameras()["saved"], again.cameras()["opened"]
        for key in ("eye", "centre", "above"):
            for a, b in zip(saved[key], opened[key]):
                self.assertAlmostEqual(a, b, delta=2e-3)
        self.assertLess(different(before, after), 0.05)

    def test_brightness_and_gamma(self):
        _, tree = self.generate("site", 40000, "--seed", 2, "--extent", 20)
        pictures = {name: self.result(f"{name}.png") for name in ("neutral", "bright", "gamma", "again")}
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {FIXED_VIEW}
            wait-status full resolution
            picture {pictures["neutral"]}
            panel Brightness = 1.6
            wait-status full resolution
            picture {pictures["bright"]}
            panel Brightness = 1
            panel Gamma = 2
            wait-status full resolution
            picture {pictures["gamma"]}
            panel Gamma = 1
            wait-status full resolution
            picture {pictures["again"]}
            """)
        self.assertDriven(run)
        self.assertGreater(different(pictures["neutral"], pictures["bright"]), 0.05)
        self.assertGreater(different(pictures["neutral"], pictures["gamma"]), 0.05)
        self.assertEqual(different(pictures["neutral"], pictures["again"]), 0)

    def test_the_legend_sets_the_range(self):
        _, tree = self.generate("site", 40000, "--seed", 2, "--extent", 20)
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {FIXED_VIEW}
            parameter {NAME}Colour = 2
            wait-status full resolution
            print-legend automatic
            print-camera before
            press-at 0.91 0.12
            move-to 0.91 0.2
            release-at 0.91 0.2
            wait-status full resolution
            print-legend dragged
            click-right 0.91 0.2
            wait-status full resolution
            print-legend reset
            double-click 0.91 0.2
            dialog-key Backspace
            type 2:7
            dialog-key Return
            wait-status full resolution
            print-legend typed
            print-camera after
            """)
        self.assertDriven(run)
        legends = run.legends()
        ends = {name: [float(value) for value in lines[1:]] for name, lines in legends.items()}
        self.assertEqual(ends["dragged"][0], ends["automatic"][0])
        self.assertLess(ends["dragged"][2], ends["automatic"][2])
        self.assertEqual(ends["reset"], ends["automatic"])
        self.assertEqual(ends["typed"], [2, 4.5, 7])
        self.assertEqual(run.cameras()["before"]["eye"], run.cameras()["after"]["eye"])

    def test_one_menu_for_point_clouds(self):
        _, tree = self.generate("site", 3000)
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            print-menu Point Clouds
            print-menu Help
            trigger Remove Outliers...
            print-field Output folder
            press Close
            """)
        self.assertDriven(run)
        entries = re.findall(r"driver: menu (.*)", run.text)
        help_begins = entries.index("About")
        self.assertIn("Point Clouds", entries[help_begins:])
        entries = entries[:help_begins]
        groups = list(dict.fromkeys(entry.split(" > ")[0] for entry in entries))
        self.assertEqual(groups, ["Open and Build", "Look", "Select", "Clean and Thin", "Move and Align", "Measure", "Fit", "Export"])
        self.assertEqual(len(entries), 35)
        self.assertFalse([entry for entry in entries if "tree" in entry.lower()])
        self.assertIn("Look > Clip Box", entries)
        self.assertIn("Export > Export the Cloud...", entries)
        self.assertEqual(run.fields(), [str(self.folder / "site-clean.pct")])

    def test_the_dialog_of_exports_has_no_dead_ticks(self):
        _, tree = self.generate("site", 3000)
        las, ply = self.folder / "all.las", self.folder / "vertices.ply"
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            export-asking {las}
            pause 300
            screen {self.result("tree.png")}
            print-ticks
            press OK
            wait-log to {las}
            """)
        self.assertDriven(run)
        self.assertNotIn("check_iom", re.search(r"driver: ticks (.*)", run.text)[1])
        self.assertEqual(pcmlab("info", las)["points"], 3000)
        run = self.gui(f"""
            wait-view
            open {las}
            wait-layers 1
            export-asking {ply}
            pause 300
            screen {self.result("vertices.png")}
            print-ticks
            press OK
            wait-log to {ply}
            """)
        self.assertDriven(run)
        ticks = set(re.findall(r"check_iom_(\w+)", re.search(r"driver: ticks (.*)", run.text)[1]))
        self.assertTrue(ticks and ticks <= {"vertcolor", "vertnormal", "vertquality", "vertradius"}, ticks)

    def test_a_damaged_chunk_says_how_to_repair_the_cloud(self):
        _, tree = self.generate("site", 200000, "--seed", 2, "--extent", 20)
        data = max(tree.glob("*"), key=lambda file: file.stat().st_size)
        content = bytearray(data.read_bytes())
        content[len(content) // 2:len(content) // 2 + 64] = b"\x55" * 64
        data.write_bytes(content)
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {NO_TIME_LIMIT}
            wait-status pcmlab repair {tree}
            """)
        self.assertDriven(run)


if __name__ == "__main__":
    unittest.main()
