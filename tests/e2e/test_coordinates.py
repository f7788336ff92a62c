"""A cloud at map coordinates is drawn like the same cloud at the origin, and does not jitter."""

import unittest

from meshlab import MeshLabTest, compare


class Coordinates(MeshLabTest):
    def test_far_from_the_origin(self):
        pictures = {}
        for name, origin in (("near", "0,0,0"), ("far", "5000000,4800000,100")):
            _, tree = self.generate(name, 300000, "--seed", 7, "--origin", origin)
            still, moved = self.result(f"{name}.png"), self.result(f"{name}-moved.png")
            run = self.gui(f"""
                wait-view
                wait-layers 1
                resize 1000 800
                pause 500
                wait-status complete
                picture {still}
                drag 0.5 0.5 0.53 0.51 3
                pause 300
                wait-status complete
                picture {moved}
                drag 0.53 0.51 0.5 0.5 3
                quit
                """, tree)
            self.assertDriven(run)
            pictures[name] = (still, moved)
        for near, far in zip(pictures["near"], pictures["far"]):
            # The scene's points lie on a grid of millimetres in both, so they are the same points; what is left is the document
            # origin, whole metres, and float rounding of the last bit.
            self.assertLess(compare(near, far)["different"], 0.01)
        self.assertGreater(compare(*pictures["near"])["different"], 0.01)


if __name__ == "__main__":
    unittest.main()
