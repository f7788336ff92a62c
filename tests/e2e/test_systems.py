"""Clouds of different coordinate systems, or far from each other, in one project: a warning, and a question in a window."""

import struct
import unittest

from meshlab import MeshLabTest, pcmlab
from test_server import build


def las(path, code, offset, unit=9001):
    """A LAS 1.2 file of 1,000 points in a cube of 10 units, with GeoTIFF keys of a projected system."""
    keys = [1, 1, 0, 3, 1024, 0, 1, 1, 3072, 0, 1, code, 3076, 0, 1, unit]
    vlr = struct.pack("<H16sHH32s", 0, b"LASF_Projection", 34735, 2 * len(keys), b"") + struct.pack(f"<{len(keys)}H", *keys)
    points = b"".join(struct.pack("<3iHBBbBH", i % 10 * 1000, i // 10 % 10 * 1000, i // 100 * 1000, i, 9, 2, 0, 0, 0)
                      for i in range(1000))
    head = b"LASF" + bytes(20) + bytes([1, 2]) + struct.pack("<32s32sHHHII", b"test", b"test", 1, 2020, 227, 227 + len(vlr), 1)
    head += struct.pack("<BHI5I", 0, 20, 1000, 1000, 0, 0, 0, 0) + struct.pack("<6d", *[0.001] * 3, *offset)
    for axis in range(3):
        head += struct.pack("<2d", offset[axis] + 9, offset[axis])
    path.write_bytes(head + vlr + points)
    return path


HERE, FAR = (500000, 4800000, 100), (4500000, 5300000, 100)


class Systems(MeshLabTest):
    def test_a_question_in_a_window(self):
        here = las(self.folder / "here.las", 32632, HERE)
        beside = las(self.folder / "beside.las", 32632, (500010, 4800000, 100))
        other = las(self.folder / "other.las", 32633, HERE)
        far = las(self.folder / "far.las", 32632, FAR)
        pcmlab("build", far, "-o", self.folder / "far.pct")
        run = self.gui(f"""
            wait-view
            open {here}
            wait-layers 1
            open {beside}
            wait-layers 2
            expect-no-dialog
            open {other}
            press No
            press OK
            wait-layers 2
            wait-log other.las
            open {other}
            press Yes
            wait-layers 3
            expect-message EPSG:32633
            expect-message EPSG:32632
            open {far}
            press Yes
            wait-layers 4
            expect-message rounded to 0.1
            open {self.folder / "far.pct"}
            press No
            press OK
            wait-layers 4
            print-layers
            """)
        self.assertDriven(run)
        self.assertEqual([layer["vertices"] for layer in run.layers()], [1000] * 4)

    def test_a_warning_without_a_window(self):
        here, other = las(self.folder / "here.las", 32632, HERE), las(self.folder / "other.las", 2229, HERE, 9003)
        far = las(self.folder / "far.las", 32632, FAR)
        tree = self.folder / "both.pct"
        run = self.server([build(f"{here};{other}", tree, ignore_crs=True)], "-i", here, other, far)
        self.assertEqual(run.code, 0, run.text)
        self.assertIn("Warning: other.las: Its coordinate system is EPSG:2229, US survey foot", run.text)
        self.assertIn("Warning: far.las: It lies 4.03e+06 units", run.text)
        self.assertEqual(pcmlab("info", tree)["points"], 2000)

    def test_filters_refuse_and_can_be_asked_not_to(self):
        here, other = las(self.folder / "here.las", 32632, HERE), las(self.folder / "other.las", 32633, HERE)
        run = self.server([build(f"{here};{other}", self.folder / "both.pct")])
        self.assertNotEqual(run.code, 0, run.text)
        self.assertIn("EPSG:32633", run.text)
        self.assertFalse((self.folder / "both.pct").exists())


if __name__ == "__main__":
    unittest.main()
