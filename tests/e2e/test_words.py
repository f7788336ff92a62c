"""What MeshLab shows and says about clouds, in a user's words: the text in the view, the settings, the first view, messages."""

import math
import shutil
import unittest

from meshlab import NO_TIME_LIMIT, MeshLabTest, different, pcmlab


class Words(MeshLabTest):
    first_view = 0  # as a user sees it

    def test_one_box_for_all_layers(self):
        _, first = self.generate("first", 60000, "--seed", 6)
        _, second = self.generate("second", 40000, "--seed", 7)
        run = self.gui(f"""
            wait-view
            {NO_TIME_LIMIT}
            open {first}
            wait-layers 1
            open {second}
            wait-layers 2
            wait-status full resolution
            print-boxes
            parameter MeshLab::PointCloud::Details = 1
            wait-status full resolution
            print-boxes
            screen {self.result("details.png")}
            """)
        self.assertDriven(run)
        plain, detailed = run.boxes()
        self.assertEqual(plain, {"title": "Point Cloud", "layer": "", "text": "all points shown"})
        for line in ("all points shown<br>", " ms per frame", "first (", "second: ", "video memory: ", "main memory: "):
            self.assertIn(line, detailed["text"])
        self.assertNotIn("<t", detailed["text"])

    def test_first_paint_shows_the_tree(self):
        """MeshLab's own points, dark without normals, are not even shown for an instant."""
        _, tree = self.generate("first", 60000, "--seed", 6)
        opening = f"open {tree}\nwait-layers %d\nwait-status complete\n"
        run = self.gui(f"""
            wait-view
            count-paints
            {opening % 1}
            print-paints
            count-paints
            {opening % 2}
            trigger Reload
            pause 300
            wait-status complete
            print-paints
            """)
        self.assertDriven(run)
        for paints in run.paints():
            self.assertGreater(paints["all"], 0)
            self.assertEqual(paints["native"], 0)

    def test_first_view(self):
        """Opened alone, a tree is seen obliquely; a camera that was moved, or that shows something else, is left alone."""
        _, tree = self.generate("first", 60000, "--seed", 6)
        _, other = self.generate("other", 40000, "--seed", 7)
        mesh = self.folder / "triangle.ply"
        mesh.write_text("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
                        "property list uchar int vertex_indices\nend_header\n0 0 0\n30 0 0\n0 30 0\n3 0 1 2\n")
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            wait-status complete
            print-camera oblique
            screen {self.result("oblique.png")}
            drag 0.4 0.5 0.6 0.6
            print-camera moved
            trigger Reload
            pause 200
            wait-status complete
            print-camera reloaded
            open {other}
            wait-layers 2
            wait-status 2 clouds
            print-camera both
            trigger Close Project
            pause 300
            trigger New Empty Project...
            wait-view
            open {mesh}
            wait-layers 1
            open {tree}
            wait-layers 2
            wait-status complete
            print-camera beside
            parameter MeshLab::PointCloud::FirstView = 1
            trigger Delete Current Mesh
            trigger Delete Current Mesh
            wait-layers 0
            open {tree}
            wait-layers 1
            wait-status complete
            print-camera above
            """)
        self.assertDriven(run)
        cameras = run.cameras()

        def slope(name):
            """How far down the camera looks: 1 straight down."""
            eye, centre = cameras[name]["eye"], cameras[name]["centre"]
            away = [e - c for e, c in zip(eye, centre)]
            return away[2] / sum(a * a for a in away) ** 0.5

        self.assertAlmostEqual(slope("oblique"), 0.58, delta=0.01)
        self.assertNotAlmostEqual(slope("moved"), 0.58, delta=0.01)
        self.assertEqual(cameras["moved"]["eye"], cameras["reloaded"]["eye"])
        self.assertAlmostEqual(slope("both"), 0.58, delta=0.01)  # MeshLab has put it straight above
        self.assertAlmostEqual(slope("beside"), 1, delta=0.001)
        self.assertAlmostEqual(slope("above"), 1, delta=0.001)

    def test_split_views(self):
        """A view that is split off looks obliquely too, with the same background."""
        _, tree = self.generate("first", 60000, "--seed", 6)
        one, other = self.result("one.png"), self.result("other.png")
        run = self.gui(f"""
            wait-view
            {NO_TIME_LIMIT}
            open {tree}
            wait-layers 1
            panel Background = White
            wait-status full resolution
            trigger Vertically
            wait-views 2
            wait-status full resolution
            view-size 400 400
            wait-status full resolution
            print-camera one
            picture {one}
            screen {self.result("screen.png")}
            trigger Close current view
            wait-views 1
            view-size 400 400
            wait-status full resolution
            print-camera other
            picture {other}
            """)
        self.assertDriven(run)
        # A narrower view looks from further away. The background is most of the picture.
        directions = [[a - b for a, b in zip(camera["eye"], camera["centre"])] for camera in run.cameras().values()]
        for a, b in zip(*([x / math.hypot(*direction) for x in direction] for direction in directions)):
            self.assertAlmostEqual(a, b, delta=1e-3)
        self.assertLess(different(one, other), 0.5)

    def test_panel(self):
        """The panel appears with the first tree, its settings apply at once, and it shows what MeshLab's own panel changes."""
        _, tree = self.generate("first", 60000, "--seed", 6)
        names = ("plain", "lit", "unlit", "large", "height", "black")
        pictures = {name: self.result(f"{name}.png") for name in names}
        # In a MeshLab of its own: what it keeps is for its next start.
        run = self.own_gui(f"""
            wait-view
            {NO_TIME_LIMIT}
            open {tree}
            wait-layers 1
            panel EyeDomeLightingOn = off
            wait-status full resolution
            picture {pictures["plain"]}
            panel EyeDomeLightingOn = on
            wait-status full resolution
            picture {pictures["lit"]}
            panel EyeDomeLightingOn = off
            wait-status full resolution
            picture {pictures["unlit"]}
            panel Splats = Squares of one size
            panel SplatSize = 9
            wait-status full resolution
            picture {pictures["large"]}
            panel Colour = Height
            wait-status full resolution
            picture {pictures["height"]}
            panel Background = Black
            wait-status full resolution
            picture {pictures["black"]}
            print-parameters changed
            screen {self.result("screen.png")}
            pause 600
            unfold
            press Reset
            pause 300
            print-parameters reset
            panel SplatSize = 5
            press Keep
            pause 100
            trigger Point Cloud
            pause 300
            quit
            """)
        self.assertDriven(run)
        self.assertEqual(different(pictures["plain"], pictures["unlit"]), 0)
        for before, after in (("plain", "lit"), ("unlit", "large"), ("large", "height"), ("height", "black")):
            self.assertGreater(different(pictures[before], pictures[after]), 0.01, f"{before}, {after}")
        changed, reset = run.parameters()["changed"], run.parameters()["reset"]
        self.assertEqual((changed["SplatSize"], changed["EyeDomeLighting"]), (9, 0))
        self.assertEqual((reset["SplatSize"], reset["Background"]), (2, 0))
        self.assertEqual(changed["without_default"], [])
        # What was kept is there at the next start, and the panel stays hidden.
        run = self.own_gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            wait-status complete
            print-parameters kept
            screen {self.result("hidden.png")}
            quit
            """)
        self.assertDriven(run)
        self.assertEqual(run.parameters()["kept"]["SplatSize"], 5)

    def test_files_are_picked(self):
        first, second = (self.generate_file(name, 30000, "--seed", 6) for name in ("first", "second file"))
        _, tree = self.generate("t", 30000, "--seed", 6)
        made = self.folder / "made.pct"
        # In a MeshLab of its own: the dialog keeps what was typed before.
        run = self.own_gui(f"""
            wait-view
            trigger Build Point Cloud Tree
            field-button Input files = Add files
            pick {first}
            field-button Input files = Add files
            pick {second}
            print-field Input files
            field-button Output folder = Name a tree
            pick {self.folder / "made"}
            print-field Output folder
            screen {self.result("dialog.png")}
            press Apply
            wait-layers 1
            wait-log 60,000 points
            press Close
            trigger Point Cloud Tree Information
            field-button Tree folder = Choose a tree
            pick {tree / "index.pct"}
            print-field Tree folder
            press Apply
            wait-log points to here
            set Tree folder = {tree / "index.pct"}
            press Apply
            pause 300
            press Close
            quit
            """)
        self.assertDriven(run)
        self.assertEqual(run.fields(), [f"{first}; {second}", str(made), str(tree)])
        self.assertEqual(pcmlab("info", made)["points"], 60000)
        self.assertEqual(run.text.count(f"LOG: 2 {tree}\n"), 2, "an index.pct stands for its tree")

    def test_box_is_taken_from_the_view(self):
        _, tree = self.generate("t", 200000, "--seed", 6)
        run = self.gui(f"""
            wait-view
            view-size 480 360
            parameter MeshLab::PointCloud::FirstView = 1
            open {tree}
            wait-layers 1
            wait-status complete
            trigger Delete Points of Point Cloud Tree
            field-button Box = Box of what the view shows
            print-field Box
            wheel -8
            pause 100
            field-button Box = Box of what the view shows
            print-field Box
            field-button Box = Box of the selected vertices
            press OK
            expect-message No vertex of the current layer is selected
            set Count only = on
            press Apply
            wait-log would be deleted
            press Close
            trigger Select All
            press Apply
            trigger Delete Points of Point Cloud Tree
            field-button Box = Box of the selected vertices
            print-field Box
            """)
        self.assertDriven(run)
        whole, part, selected = ([float(n) for n in text.split()] for text in run.fields())
        bounds = pcmlab("info", tree)["bounds"]
        expected = [*bounds["min"], *bounds["max"]]
        for box in (whole, selected):
            for found, value in zip(box, expected):
                self.assertAlmostEqual(found, value, delta=0.02)
        for axis in (0, 1):
            self.assertGreater(part[axis], whole[axis])
            self.assertLess(part[3 + axis], whole[3 + axis])

    def test_new_defaults_replace_stored_ones(self):
        """MeshLab stores defaults at its first start: former ones give way, what the user chose or kept stays."""
        for name, value in (("SplatSize", 3.5), ("RadiusScale", 3.5), ("EyeDomeLighting", 3.5)):
            self.store(self.folder, name, "RichFloat", value)
        with open(self.folder / "config" / "VCG" / "MeshLab_64bit_fp.conf", "a", encoding="utf-8") as file:
            file.write("\n[PointCloud]\ndefaults\\SplatSize=3.5\ndefaults\\RadiusScale=1\ndefaults\\EyeDomeLighting=kept\n")
        for session in ("first", "second"):
            # In a MeshLab of its own: its settings are stored before it starts.
            run = self.own_gui("wait-view\nprint-parameters now\nquit\n")
            self.assertDriven(run)
            now = run.parameters()["now"]
            self.assertEqual((now["SplatSize"], now["RadiusScale"], now["EyeDomeLighting"]), (2, 3.5, 3.5), session)

    def test_project_keeps_settings(self):
        """Saved and opened in another session, a project looks the same; a save that is cancelled changes nothing."""
        _, tree = self.generate("city", 60000, "--seed", 6)
        project = self.folder / "p.mlp"
        before, after = self.result("before.png"), self.result("after.png")
        run = self.gui(f"""
            wait-view
            {NO_TIME_LIMIT}
            view-size 480 360
            open {tree}
            wait-layers 1
            panel SplatSize = 6
            panel Colour = Height
            panel EyeDomeLightingOn = on
            panel EyeDomeLighting = 2.5
            panel Background = Grey
            parameter MeshLab::PointCloud::Memory = 300
            wait-status full resolution
            picture {before}
            print-parameters before
            trigger Save Project As...
            pick {project}
            wait-file {project}
            panel SplatSize = 7
            trigger Save Project As...
            press Cancel
            pause 300
            """)
        self.assertDriven(run)
        saved = project.read_text()
        self.assertEqual(saved.count("<PointCloudSettings>"), 1)
        self.assertLess(saved.index("city.pct"), saved.index("<PointCloudSettings>"))
        shutil.rmtree(self.folder / "config" / "VCG")
        # In a MeshLab of its own: another session.
        run = self.own_gui(f"""
            wait-view
            view-size 480 360
            open-project {project}
            wait-layers 1
            wait-log the settings of the view are those of {project}
            wait-status full resolution
            picture {after}
            print-parameters after
            screen {self.result("screen.png")}
            quit
            """)
        self.assertDriven(run)
        found = run.parameters()["after"]
        self.assertEqual((found["SplatSize"], found["EyeDomeLighting"], found["Background"], found["FrameBudget"]), (6, 2.5, 2, 100000))
        self.assertEqual(found["Memory"], 512, "memory belongs to the computer")
        self.assertLess(different(before, after), 0.02)

    def test_export_proposes_what_works(self):
        """Both entries of the menu propose a new file of a type that can be written; the layer stays that of the tree."""
        las, tree = self.generate("city", 60000, "--seed", 6)
        project = self.folder / "p.mlp"
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            wait-status complete
            trigger Export Mesh...
            pick
            expect-message city.laz
            expect-message LAZ
            press OK
            wait-log Wrote 60,000 points
            trigger Export Mesh As...
            pick
            expect-message city-export.laz
            field-button Box = Box of what the view shows
            print-field Box
            press OK
            wait-log city-export.laz in
            trigger Reload
            wait-status complete
            trigger Save Project As...
            pick {project}
            wait-file {project}
            open {las}
            wait-layers 2
            trigger Export Mesh...
            press Cancel
            expect-no-dialog
            """)
        self.assertDriven(run)
        self.assertEqual(len(run.fields()[0].split()), 6)
        for name in ("city.laz", "city-export.laz"):
            self.assertEqual(pcmlab("info", self.folder / name)["points"], 60000)
        self.assertIn('filename="city.pct"', project.read_text())

    def test_escape_is_no_failure(self):
        """Of an import, a filter and an export."""
        las = self.generate_file("large", 3000000, "--seed", 4)
        _, tree = self.generate("t", 2000000, "--seed", 6)
        run = self.gui(f"""
            wait-view
            open {las}
            wait-building
            escape
            press OK
            expect-message Cancelled: Opening {las} was cancelled.
            wait-log Opening {las} was cancelled.
            trigger Build Point Cloud Tree
            set Input files = {las}
            press Apply
            wait-building
            escape
            press OK
            expect-message Cancelled: Build Point Cloud Tree was cancelled.
            press Close
            open {tree}
            wait-layers 1
            export {self.folder / "out.laz"}
            wait-building
            escape
            press OK
            expect-message Cancelled: Saving {self.folder / "out.laz"} was cancelled.
            expect-no-dialog
            print-log
            """)
        self.assertDriven(run)
        for word in ("Cannot", "Failure", "warning"):
            self.assertNotIn(word, "\n".join(line for line in run.text.splitlines() if "driver: log" in line))

    def test_damaged_index_says_how_to_repair(self):
        _, tree = self.generate("t t", 50000, "--seed", 6)
        index = (tree / "index.pct").read_bytes()
        (tree / "index.pct").write_bytes(index[:200] + b"x" + index[201:])
        run = self.gui(f"""
            wait-view
            open {tree / "index.pct"}
            press OK
            expect-message pcmlab repair '{tree}'
            wait-log pcmlab repair '{tree}'
            """)
        self.assertDriven(run)
        pcmlab("repair", tree)
        self.assertEqual(pcmlab("info", tree)["points"], 50000)


if __name__ == "__main__":
    unittest.main()
