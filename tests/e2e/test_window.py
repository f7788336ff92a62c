"""MeshLab's window: a tree opens, is drawn, turned, deleted; errors leave MeshLab usable."""

import unittest

from meshlab import REFERENCE, MeshLabTest, compare

# Two renderings of one view under the same software renderer are alike but for the pixels where another version of it rounds
# otherwise, along the edges of splats.
SAME_PICTURE = 0.02


class Window(MeshLabTest):
    def test_open_draw_orbit_delete_quit(self):
        _, tree = self.generate("scene", 400000, "--seed", 5)
        before, after, gone = self.result("1-open.png"), self.result("2-turned.png"), self.result("3-deleted.png")
        run = self.gui(f"""
            wait-view
            wait-layers 1
            time opened
            wait-status complete
            time complete
            resize 1200 900
            pause 500
            wait-status complete
            print-status
            picture {before}
            screen {self.result("1-screen.png")}
            drag 0.4 0.5 0.6 0.6
            pause 300
            wait-status complete
            picture {after}
            wheel 3
            pause 300
            wait-status complete
            print-status
            screen {self.result("2-screen.png")}
            trigger Delete Current Mesh
            wait-layers 0
            pause 300
            picture {gone}
            import {self.folder / "scene.pct" / "index.pct"}
            wait-layers 1
            wait-status complete
            trigger Close Project
            pause 500
            quit
            """, tree)
        self.assertDriven(run)
        opened = compare(before, after)
        self.assertGreater(opened["drawn"][0], 0.1, "nothing was drawn")
        self.assertGreater(opened["different"], 0.05, "the drag did not turn the cloud")
        self.assertLess(compare(gone, gone)["drawn"][0], 0.001, "the deleted cloud is still drawn")
        reference = compare(before, REFERENCE / "scene.png")
        self.assertTrue(reference["same_size"])
        self.assertLess(reference["different"], SAME_PICTURE)
        print("opened after", run.times()["opened"], "ms, complete after", run.times()["complete"], "ms")

    def test_errors_leave_meshlab_usable(self):
        las, tree = self.generate("good", 50000, "--seed", 6)
        (self.folder / "broken.las").write_bytes(las.read_bytes()[:50000])
        (self.folder / "empty.pct").mkdir()
        run = self.gui(f"""
            wait-view
            import {self.folder / "broken.las"}
            press OK
            expect-message broken.las
            expect-message 50000
            import {self.folder / "empty.pct"}
            press OK
            expect-message empty.pct
            wait-layers 0
            import {tree / "index.pct"}
            wait-layers 1
            wait-status complete
            import {las}
            wait-layers 2
            picture {self.result("usable.png")}
            screen {self.result("screen.png")}
            quit
            """)
        self.assertDriven(run)
        self.assertGreater(compare(self.result("usable.png"), self.result("usable.png"))["drawn"][0], 0.1)

    def test_filter_from_the_menu(self):
        las, _ = self.generate("input", 60000, "--seed", 8)
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
            pause 500
            screen {self.result("built.png")}
            quit
            """)
        self.assertDriven(run)
        self.assertTrue((output / "index.pct").exists())

    def test_memory_is_bounded_by_the_caches(self):
        """Not by the cloud: a cloud eight times as large takes about as much."""
        empty = self.gui("wait-view\npause 500\nmemory empty\nquit\n")
        self.assertDriven(empty)
        taken = {}
        for points in (500000, 4000000):
            _, tree = self.generate(f"cloud{points}", points, "--seed", 9)
            run = self.gui("wait-view\nwait-layers 1\nwait-status complete\nmemory full\nquit\n", tree)
            self.assertDriven(run)
            taken[points] = run.memory()["full"][1] - empty.memory()["empty"][1]
            print(f"{points} points: peak {taken[points] / 1e6:.0f} MB above the empty start, "
                  f"first status after {run.times()}")
        # Caches of 512 MB each at most, and the proxy.
        self.assertLess(taken[4000000], 1.2e9)


if __name__ == "__main__":
    unittest.main()
