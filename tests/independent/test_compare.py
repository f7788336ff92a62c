#!/usr/bin/env python3
"""The comparison itself: it must see every kind of difference, in every column, down to one bit.

    test_compare.py --dump DUMP_CLOUD --data FOLDER [--python PYTHON]
"""
import copy
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import check

arguments = check.common_arguments(__doc__)
try:
    import laspy
    import numpy as np

    import compare
    import las_by_laspy
except ImportError as error:
    check.skip(f"{error}; packaging/test-python installs what the comparison needs")


def write_las(path):
    header = laspy.LasHeader(point_format=7, version="1.4")
    header.scales, header.offsets = [0.001, 0.001, 0.01], [400000.0, 5000000.0, 0.0]
    header.add_extra_dim(laspy.ExtraBytesParams("height", "f4"))
    las = laspy.LasData(header)
    random = np.random.default_rng(1)
    las.X, las.Y, las.Z = random.integers(-2**31, 2**31, (3, 50), dtype=np.int64).astype(np.int32)
    las.intensity, las.red, las.green, las.blue = random.integers(0, 2**16, (4, 50))
    las.gps_time, las["height"] = random.random((2, 50))
    las.write(path)


class Comparison(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        write_las(self.folder / "cloud.las")
        self.theirs = las_by_laspy.read(self.folder / "cloud.las")
        line = subprocess.check_output([arguments.dump, self.folder / "cloud.las", self.folder])
        self.description = json.loads(line)

    def ours(self):
        return compare.read_dump(self.description, self.folder)

    def differences(self):
        return compare.differences(self.ours(), self.theirs)

    def test_equal_clouds_have_no_difference(self):
        self.assertEqual(self.differences(), [])

    def test_one_bit_of_any_column_is_a_difference(self):
        columns = ["positions", "grid"] + [str(i) for i in range(len(self.description["attributes"]))]
        for name in columns:
            path = self.folder / name
            whole = path.read_bytes()
            for at in (0, len(whole) // 2, len(whole) - 1):
                with self.subTest(column=name, byte=at):
                    path.write_bytes(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1:])
                    self.assertNotEqual(self.differences(), [])
            path.write_bytes(whole)

    def test_a_column_of_another_length_is_refused(self):
        path = self.folder / "0"
        path.write_bytes(path.read_bytes()[:-1])
        self.assertRaises(ValueError, self.differences)

    def test_a_missing_an_added_a_renamed_attribute(self):
        for name in self.theirs.attributes:
            with self.subTest(name=name):
                ours = self.ours()
                value = ours.attributes.pop(name)
                self.assertIn(f"attribute '{name}' is missing", compare.differences(ours, self.theirs))
                ours.attributes["other"] = value
                self.assertIn("attribute 'other' is not in the file", compare.differences(ours, self.theirs))

    def test_types_scales_and_components(self):
        for name, attribute in self.theirs.attributes.items():
            for field, value in (("values", attribute.values.astype("<i8")), ("scale", 0.5), ("offset", 1.0),
                                 ("values", np.repeat(attribute.values, 2, axis=1))):
                with self.subTest(name=name, field=field):
                    ours = self.ours()
                    setattr(ours.attributes[name], field, value)
                    self.assertNotEqual(compare.differences(ours, self.theirs), [])

    def test_a_grid_that_moved_and_none(self):
        ours = self.ours()
        ours.scale = [0.001, 0.001, np.nextafter(0.01, 1)]
        self.assertNotEqual(compare.differences(ours, self.theirs), [])
        ours.grid = None
        self.assertNotEqual(compare.differences(ours, self.theirs), [])

    def test_a_point_less_and_two_points_swapped(self):
        ours = self.ours()
        ours.positions = ours.positions[:-1]
        self.assertNotEqual(compare.differences(ours, self.theirs), [])
        ours = self.ours()
        order = np.arange(50)
        order[[3, 4]] = order[[4, 3]]
        ours.positions, ours.grid = ours.positions[order], ours.grid[order]
        self.assertNotEqual(compare.differences(ours, self.theirs), [])

    def test_an_uncertainty_is_a_bound(self):
        theirs = copy.deepcopy(self.theirs)
        theirs.grid, theirs.uncertainty = None, 1e-6
        ours = self.ours()
        ours.positions[7, 2] += 0.9e-6
        self.assertEqual(compare.differences(ours, theirs), [])
        ours.positions[7, 2] += 0.2e-6
        self.assertNotEqual(compare.differences(ours, theirs), [])
        ours.positions[7, 2] = np.nan
        self.assertNotEqual(compare.differences(ours, theirs), [])

    def test_values_of_text_must_fit_the_type(self):
        text = compare.Cloud(np.zeros((2, 3)), {"a": compare.Attribute(np.array([[1.0], [300.0]]), any_type=True)})
        for kind, values, same in (("<u2", [1, 300], True), ("<u1", [1, 44], False), ("<f8", [1, 300], True),
                                   ("<f4", [1, 300.5], False)):
            with self.subTest(kind=kind):
                ours = compare.Cloud(np.zeros((2, 3)),
                                     {"a": compare.Attribute(np.array(values, dtype=kind).reshape(-1, 1))})
                self.assertEqual(compare.differences(ours, text) == [], same)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
