"""A view at rest becomes the mean of frames at sub-pixel offsets."""

import re
import shutil

from meshlab import MeshLabTest, different, pcmlab


class Smoothing(MeshLabTest):
    smooth = True

    def test_a_view_at_rest_becomes_smooth(self):
        """By default, and reported; snapshots are as smooth, those in tiles too; a view that moves is not, and off is off."""
        pcmlab("generate", "-n", 100000, "--no-truth", "--seed", 5, self.folder / "scene.las")
        tree = self.folder / "scene.pct"
        pcmlab("build", self.folder / "scene.las", "-o", tree)
        names = ("smooth", "plain", "again", "large", "turned", "back")
        p = {name: self.result(f"{name}.png") for name in names}
        setting = "parameter MeshLab::PointCloud::"
        # In a MeshLab of its own: the module has no other test.
        run = self.own_gui(f"""
            wait-view
            view-size 320 240
            {setting}Details = 1
            {setting}TargetSpacing = 0.1
            open {tree}
            wait-layers 1
            drag 0.5 0.6 0.52 0.45
            wheel -2
            wait-status full resolution, mean of 8
            picture {p["smooth"]}
            print-property pcm_state
            {setting}Smooth = 0
            wait-status complete, full resolution, frame
            picture {p["plain"]}
            print-property pcm_state
            {setting}Smooth = 1
            wait-status full resolution, mean of 8
            picture {p["again"]}
            trigger Save snapshot
            press Save
            wait-log Snapshot saved to ./snapshot00.png
            trigger Save snapshot
            set Screen Multiplier = 2
            press Save
            wait-log Snapshot saved to ./snapshot01.png
            drag 0.5 0.5 0.55 0.5
            wait-status full resolution, mean of 8
            picture {p["turned"]}
            drag 0.55 0.5 0.5 0.5
            wait-status full resolution, mean of 8
            picture {p["back"]}
            view-size 640 480
            wait-status full resolution, mean of 8
            picture {p["large"]}
            print-log
            quit
            """)
        self.assertDriven(run)
        states = run.properties("pcm_state")
        self.assertEqual(len(states), 2)
        self.assertIn("all points shown", states[0]["text"])
        self.assertIn("; mean of 8 frames", states[0]["text"])
        self.assertNotIn("mean of", states[1]["text"])
        self.assertGreater(different(p["smooth"], p["plain"]), 0.03)
        self.assertEqual(different(p["smooth"], p["again"]), 0)
        self.assertGreater(different(p["smooth"], p["turned"]), 0.03)
        self.assertLess(different(p["smooth"], p["back"]), 0.02)
        for name, picture in (("snapshot00.png", p["smooth"]), ("snapshot01.png", p["large"])):
            shutil.copy(self.folder / name, self.result(name))
            # MeshLab draws a frame around the current view, but not in a snapshot.
            self.assertLess(different(self.folder / name, picture, border=6), 0.02, name)
        self.assertNotIn("less detailed", re.search(r"driver: log (.*)", run.text)[1])
