#!/usr/bin/env python3
"""The comparisons of exports.py must see every difference.

    test_export_readers.py --dump DUMP_CLOUD --data FOLDER [--python PYTHON]
"""
import sys
import unittest

import check

arguments = check.common_arguments(__doc__)
try:
    import numpy as np

    import export_readers as readers
    from compare import Attribute, Cloud
except ImportError as error:
    check.skip(f"{error}; packaging/test-python installs what the comparison needs")


def cloud(**attributes):
    return Cloud(np.arange(9.0).reshape(3, 3), {name: Attribute(np.array(values)) for name, values in attributes.items()})


class Readers(unittest.TestCase):
    def test_positions(self):
        truth = cloud()
        self.assertEqual(readers.position_lines(truth, truth.positions.copy(), 0), [])
        self.assertTrue(readers.position_lines(truth, truth.positions[:2], 0))
        off = truth.positions.copy()
        off[2, 1] += 1e-9
        self.assertTrue(readers.position_lines(truth, off, 0))
        self.assertEqual(readers.position_lines(truth, off, 1.1e-9), [])
        self.assertTrue(readers.position_lines(truth, np.zeros((3, 3)), 0.5), "doubles read as zeros")
        off[0, 0] = np.nan
        self.assertTrue(readers.position_lines(truth, off, 1))

    def test_colours(self):
        white = Attribute(np.full((3, 3), 65535, np.uint16))
        shown, raw = np.full((3, 3), 255, np.uint8), white.values
        self.assertEqual(readers.colour_lines(white, shown, None, []), [])
        self.assertTrue(readers.colour_lines(white, raw, None, []), "16 bits")
        self.assertTrue(readers.colour_lines(white, shown, raw, []), "exact ones for nothing")
        self.assertTrue(readers.colour_lines(white, shown - 1, None, []))
        full = Attribute(np.array([[65535, 300, 0]], np.uint16))
        shown = readers.bytes_of_colours(full)
        self.assertEqual(shown.tolist(), [[255, 1, 0]])
        self.assertTrue(readers.colour_lines(full, shown, None, []), "the exact ones are missing")
        self.assertEqual(readers.colour_lines(full, shown, full.values, []), [])
        self.assertTrue(readers.colour_lines(full, shown, full.values + 1, []))

    def test_scaled_values(self):
        angle = Attribute(np.array([[-30000], [100]], np.int16), 0.006)
        self.assertEqual(readers.scaled_lines("a", angle, np.array([[-180], [0.6]], np.float32), None), [])
        self.assertTrue(readers.scaled_lines("a", angle, angle.values, None), "raw numbers")
        self.assertTrue(readers.scaled_lines("a", angle, np.array([[-180], [0.602]], np.float32), None))

    def test_what_a_viewer_shows(self):
        truth = cloud(rgb=np.full((3, 3), 255, np.uint8), normal=np.eye(3))
        white, normals = np.ones((3, 4)), np.eye(3)
        self.assertEqual(readers.seen_lines(truth, white, normals), [])
        self.assertTrue(readers.seen_lines(truth, None, normals))
        self.assertTrue(readers.seen_lines(truth, white * 0, normals))
        self.assertTrue(readers.seen_lines(truth, white, normals * 0))

    def test_numbers_of_las_fields(self):
        def field(values, name="intensity", kind=np.uint16, extended=False):
            return readers.in_las_field(name, Attribute(np.array(values)), np.zeros(1, kind), extended).ravel().tolist()

        self.assertEqual(field([[0.0], [1.0]]), [0, 65535])
        self.assertEqual(field([[0.0], [255.0]]), [0, 255])
        self.assertEqual(field([[-10], [10]]), [0, 65535])
        self.assertEqual(field([[40]], "classification", np.uint8), [31])
        self.assertEqual(field([[40]], "classification", np.uint8, True), [40])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
