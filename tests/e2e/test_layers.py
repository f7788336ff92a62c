"""Ordinary layers are drawn as point clouds, and follow their vertices; a sample that was changed does not mislead."""

import signal
import subprocess
import unittest

from meshlab import FIXED_VIEW, MeshLabTest, different


class DrawnCopies(MeshLabTest):
    def cached(self):
        """The trees in the cache folder."""
        return sorted((self.folder / "cache" / "pcm-meshlab").glob("session-*/*.pct"))

    def test_a_small_cloud_is_drawn_like_a_large_one_and_stays_an_ordinary_layer(self):
        las, tree = self.generate("small", 60000, "--seed", 6)
        large, small, screen = (self.result(f"{name}.png") for name in ("large", "small", "screen"))
        saved = self.folder / "saved.las"
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {FIXED_VIEW}
            wait-status complete
            picture {large}
            trigger Delete Current Mesh
            wait-layers 0
            open {las}
            wait-layers 1
            wait-status complete
            picture {small}
            screen {screen}
            print-layers
            export {saved}
            pause 500
            wait-log Wrote 60,000 points of the layer
            quit
            """)
        self.assertDriven(run)
        self.assertLess(different(large, small), 0.001)
        self.assertEqual([(layer["vertices"], layer["label"]) for layer in run.layers()], [(60000, "small.las")])
        self.assertEqual(self.cached(), [], "the temporary tree is left")

    def test_the_picture_follows_the_vertices(self):
        las = self.generate_file("small", 60000, "--seed", 6)
        whole, half, moved = (self.result(f"{name}.png") for name in ("whole", "half", "moved"))
        run = self.gui(f"""
            wait-view
            open {las}
            wait-layers 1
            {FIXED_VIEW}
            wait-status complete
            print-status
            picture {whole}
            trigger Conditional Vertex Selection
            set boolean function = vi < 30000
            press Apply
            press Close
            trigger Delete Selected Vertices
            wait-log Deleted 30000 vertices
            wait-status 30000 points of
            wait-status complete
            picture {half}
            print-layers
            move-layer 0 3 0 0
            wait-status complete
            picture {moved}
            trigger Delete Current Mesh
            wait-layers 0
            quit
            """)
        self.assertDriven(run)
        self.assertEqual([layer["vertices"] for layer in run.layers()], [30000])
        self.assertGreater(different(whole, half), 0.05)
        self.assertGreater(different(half, moved), 0.05)
        self.assertEqual(self.cached(), [])


if __name__ == "__main__":
    unittest.main()
