"""A cloud at map coordinates is drawn like the same cloud at the origin, and does not jitter when moved slowly."""

import unittest

from meshlab import FIXED_VIEW, MeshLabTest, different

# The points lie on a grid of millimetres in both clouds, so they are the same points. The pictures differ only by the last
# bit of MeshLab's float matrices, which depend on the documents' origins. Coordinates in float would move points by 0.25 m,
# which is a dozen pixels here.
SAME_PICTURE = 0.01
STEPS = 6


class Coordinates(MeshLabTest):
    def test_far_from_the_origin(self):
        pictures = {}
        for name, origin in (("near", "0,0,0"), ("far", "5000000,5000000,5000000")):
            _, tree = self.generate(name, 200000, "--seed", 7, "--origin", origin)
            shots = [self.result(f"{name}-{i}.png") for i in range(STEPS + 1)]
            # Near enough that a pixel is a few centimetres; then move by one or two pixels at a time.
            slow = "".join(f"pan-to {i} {i // 2}\nwait-status complete\npicture {shots[i]}\n"
                           for i in range(1, STEPS + 1))
            run = self.gui(f"""
                wait-view
                {FIXED_VIEW}
                parameter MeshLab::PointCloud::SplatSize = 6
                open {tree}
                wait-layers 1
                wait-status complete
                drag 0.5 0.5 0.5 0.2
                wheel -12
                wait-status complete
                picture {shots[0]}
                pan-from 0 0
                {slow}
                pan-end {STEPS} {STEPS // 2}
                """)
            self.assertDriven(run)
            pictures[name] = shots
        for i, (near, far) in enumerate(zip(pictures["near"], pictures["far"])):
            self.assertLess(different(near, far), SAME_PICTURE, f"step {i}")
        # Every step has moved the picture.
        for before, after in zip(pictures["near"], pictures["near"][1:]):
            self.assertGreater(different(before, after), SAME_PICTURE)


if __name__ == "__main__":
    unittest.main()
