"""MeshLab's window: a tree is opened, drawn, rotated and deleted; MeshLab stays usable after errors."""

import os
import shutil
import unittest

from meshlab import FIXED_VIEW, NO_TIME_LIMIT, REFERENCE, MeshLabTest, different

# Two renderings of a view may differ in pixels along the edges of splats, where versions of the software renderer round
# differently.
SAME_PICTURE = 0.02


class Window(MeshLabTest):
    def test_open_draw_orbit_delete_quit(self):
        _, tree = self.generate("scene", 400000, "--seed", 5)
        opened, plain, turned, closer, gone = (self.result(f"{name}.png") for name in ("opened", "plain", "turned", "closer", "gone"))
        # In a MeshLab of its own: the tree is on its command line.
        run = self.own_gui(f"""
            wait-view
            wait-layers 1
            {FIXED_VIEW}
            wait-status complete
            picture {opened}
            screen {self.result("screen.png")}
            parameter MeshLab::PointCloud::EyeDomeLighting = 0
            wait-status complete
            picture {plain}
            parameter MeshLab::PointCloud::EyeDomeLighting = 1
            drag 0.4 0.5 0.6 0.6
            wait-status complete
            picture {turned}
            wheel 3
            wait-status complete
            picture {closer}
            trigger Delete Current Mesh
            wait-layers 0
            expect-no-dialog
            picture {gone}
            open {tree / "index.pct"}
            wait-layers 1
            wait-status complete
            trigger Close Project
            pause 300
            expect-no-dialog
            trigger New Empty Project...
            wait-view
            open {tree}
            wait-layers 1
            wait-status complete
            quit
            """, tree)
        self.assertDriven(run)
        self.assertGreater(different(opened, gone), 0.2, "nothing was drawn")
        self.assertGreater(different(opened, plain), 0.005, "eye-dome lighting draws no outlines")
        self.assertGreater(different(opened, turned), 0.1, "the drag did not rotate the cloud")
        self.assertGreater(different(turned, closer), 0.1, "the wheel did not move the camera closer")
        reference = REFERENCE / "scene.png"
        if os.environ.get("PCM_UPDATE_REFERENCE"):
            shutil.copy(opened, reference)
        self.assertLess(different(opened, reference), SAME_PICTURE)

    def test_errors_leave_meshlab_usable(self):
        las, tree = self.generate("good", 50000, "--seed", 6)
        (self.folder / "broken.las").write_bytes(las.read_bytes()[:50000])
        (self.folder / "empty.pct").mkdir()
        damaged = self.folder / "damaged.pct"
        shutil.copytree(tree, damaged)
        index = (damaged / "index.pct").read_bytes()
        (damaged / "index.pct").write_bytes(index[: len(index) // 2])
        empty, usable = self.result("empty.png"), self.result("usable.png")
        run = self.gui(f"""
            wait-view
            {FIXED_VIEW}
            picture {empty}
            open {self.folder / "broken.las"}
            press OK
            expect-message broken.las
            expect-message 50000
            open {self.folder / "empty.pct"}
            press OK
            expect-message empty.pct
            expect-message no point cloud tree
            open {damaged / "index.pct"}
            press OK
            expect-message damaged.pct
            wait-layers 0
            wait-log broken.las
            wait-log empty.pct
            wait-log damaged.pct
            open {tree / "index.pct"}
            wait-layers 1
            wait-status complete
            open {las}
            wait-layers 2
            wait-log 50,000 points, LAS 1.2
            expect-no-dialog
            picture {usable}
            screen {self.result("screen.png")}
            """)
        self.assertDriven(run)
        self.assertGreater(different(empty, usable), 0.1)

    def test_layers(self):
        """Layers share a tree, are reloaded, shown and hidden; MeshLab's own points return when the decorator is switched off."""
        _, tree = self.generate("good", 60000, "--seed", 6)
        mesh = self.folder / "mesh.off"
        mesh.write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
        ours, reloaded, both, native, again, none = (
            self.result(f"{name}.png") for name in ("ours", "reloaded", "both", "native", "again", "none"))
        run = self.gui(f"""
            wait-view
            {FIXED_VIEW}
            parameter MeshLab::PointCloud::SplatSize = 4
            picture {none}
            open {tree}
            wait-layers 1
            wait-status complete
            picture {ours}
            trigger Reload
            wait-status complete
            picture {reloaded}
            open {tree / "index.pct"}
            wait-layers 2
            wait-status complete
            picture {both}
            trigger Delete Current Mesh
            wait-layers 1
            trigger Show Point Cloud
            wait-log Disabled Decorate mode
            wait-no-status complete
            picture {native}
            trigger Show Point Cloud
            wait-log Enabled Decorate mode
            wait-status complete
            picture {again}
            open {mesh}
            wait-layers 2
            trigger Show Point Cloud
            wait-log has faces or edges, not only points
            trigger Close Project
            press Yes
            """)
        self.assertDriven(run)
        self.assertGreater(different(none, ours), 0.1)
        self.assertEqual(different(ours, reloaded), 0)
        # The second layer lies exactly on the first.
        self.assertLess(different(ours, both), SAME_PICTURE)
        self.assertGreater(different(ours, native), 0.01)
        self.assertGreater(different(none, native), 0.01)
        self.assertEqual(different(ours, again), 0)

    def test_two_views(self):
        """A view that is split off shows the cloud too; closing it does not change the other view."""
        _, tree = self.generate("good", 60000, "--seed", 6)
        one, closed = (self.result(f"{name}.png") for name in ("one", "closed"))
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {NO_TIME_LIMIT}
            wait-status complete
            picture {one}
            trigger Vertically
            wait-views 2
            wait-status complete
            screen {self.result("screen.png")}
            trigger Close current view
            wait-views 1
            wait-status complete
            picture {closed}
            """)
        self.assertDriven(run)
        self.assertEqual(different(one, closed), 0)

    def test_filter_from_the_menu(self):
        las = self.generate_file("input", 60000, "--seed", 8)
        output = self.folder / "menu.pct"
        run = self.gui(f"""
            wait-view
            trigger Build Point Cloud Tree
            set Input files = {las}
            set Output folder = {output}
            screen {self.result("dialog.png")}
            press Apply
            wait-layers 1
            wait-log 60,000 points
            press Close
            wait-status complete
            trigger Point Cloud Tree Information
            press Apply
            wait-log points to here
            press Close
            trigger Build Point Cloud Tree
            set Input files = {self.folder / "none.las"}
            press Apply
            press OK
            expect-message none.las
            press Close
            wait-status complete
            screen {self.result("built.png")}
            """)
        self.assertDriven(run)
        self.assertTrue((output / "index.pct").exists())

    def test_large_file_becomes_a_tree_beside_it(self):
        las = self.generate_file("large", 1100000, "--seed", 4)
        tree = las.with_suffix(".pct")
        run = self.gui(f"""
            wait-view
            open {las}
            wait-layers 1
            wait-log Built {tree}
            wait-status complete
            open {las}
            wait-layers 2
            wait-log is up to date
            wait-status complete
            """)
        self.assertDriven(run)
        self.assertTrue((tree / "index.pct").exists())

    def test_escape_cancels_a_build(self):
        las = self.generate_file("large", 6000000, "--seed", 4)  # no build is over before Escape is pressed
        # The script continues during the build. Until it is cancelled, the window cannot be closed.
        run = self.gui(f"""
            wait-view
            open {las}
            wait-building
            quit
            escape
            press OK
            expect-message cancelled
            wait-layers 0
            expect-no-dialog
            """)
        self.assertDriven(run)
        self.assertEqual([path.name for path in self.folder.glob("large*.pct*")], [])

    def test_time_and_memory(self):
        """Times are only printed, as machines differ. Memory must be bounded by the caches, not by the cloud."""
        taken = {}
        for points in (500000, 4000000):
            _, tree = self.generate(f"cloud{points}", points, "--seed", 9)
            # In a MeshLab of its own: the peak of memory is that of its whole life.
            run = self.own_gui(f"""
                wait-view
                pause 500
                memory empty
                open {tree}
                wait-first-picture
                wait-layers 1
                {NO_TIME_LIMIT}
                wait-status complete
                time complete
                memory full
                quit
                """)
            self.assertDriven(run)
            taken[points] = run.memory()["full"][1] - run.memory()["empty"][1]
            print(f"{points} points: first picture {run.times()['first-picture']} ms after opening, peak "
                  f"{taken[points] / 1e6:.0f} MB above the empty start")
        # At most two caches of 512 MB each, and the proxy.
        self.assertLess(taken[4000000], 1.2e9)


if __name__ == "__main__":
    unittest.main()
