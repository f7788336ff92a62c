"""The manual's pictures of MeshLab at work: packaging/manual/window_pictures keeps those that these tests make."""

import unittest

from fitting_scene import number
from meshlab import RESULTS, SOURCE, MeshLabTest, pcmlab

PICTURES = RESULTS / "manual"  # the whole screen, before it is made small
KEPT = SOURCE / "packaging" / "manual" / "pages"


class WindowPictures(MeshLabTest):
    """The window as a user has it at the first start, with everything that is on by default."""

    first_view = 0
    scale_bar = True
    smooth = False

    def part_of_the_scene(self, points, box):
        """A file with the points of the generated scene in a box."""
        part = self.folder / "part.laz"
        pcmlab("convert", self.generate_file("scene", points), part, "--box", *box)
        return part

    def photograph(self, name, file, clicks=""):
        """The screen when the file is open, the clicks are made, and all points are shown."""
        PICTURES.mkdir(exist_ok=True)
        run = self.gui(f"""
            wait-view
            open {file}
            wait-layers 1
            wait-status complete
            {clicks}
            wait-status complete
            pause 300
            screen {PICTURES / name}
            """, 600)
        self.assertDriven(run)
        self.assertTrue((KEPT / name).is_file(), f"{name} is not in the manual: packaging/manual/window_pictures makes it")
        return run

    def test_window(self):
        self.photograph("window.png", self.generate_file("plant", 1_000_000))

    def test_fit(self):
        """Two tanks and the pipe between them are in the list; a dome is fitted, and waits for Enter."""
        tanks = self.part_of_the_scene(1_000_000, (500033, 4800003, 90, 500057, 4800027, 110))
        clicks = "trigger Fit Primitives\nwait-log click a surface\n"
        places = (("Cylinder", "-5.97 -8.05 0"), ("Plane", "5 -5 2.03"), ("Cylinder", "0 -7 -1.475"), ("Sphere", "4.4 3.1 1.84"))
        for count, (kind, place) in enumerate(places, 1):
            clicks += f"click-place {place}\nwait-property pcm_fit_tool \"fits\":{count},\nwait-label PointCloudFitFound {kind}: \n"
            if count < len(places):
                clicks += f"key Return\nwait-rows PointCloudFitList {count}\nchoose-row PointCloudFitList 0\n"
        run = self.photograph("window-fit.png", tanks, clicks + "print-label PointCloudFitFound\nprint-table PointCloudFitList")
        self.assertIn("Enter accepts it", run.labels("PointCloudFitFound")[-1])
        self.assertEqual([row[0] for row in run.tables("PointCloudFitList")[-1]], ["Cylinder 1", "Plane 1", "Cylinder 2"])

    def test_measure(self):
        """The measures of the page "A facade measured": width and height of a gable, and the area of a window."""
        house = self.part_of_the_scene(3_000_000, (500008, 4800006, 90, 500022, 4800024, 110))
        clicks = "trigger Measure\nwait-log Measure: click points\n"
        for row, (kind, places) in enumerate((("Distance", ("-4.4 -6.4 -1.3", "4.96 -6.01 -1.3")), ("Height", ("-4.4 -6.4 -4", "0.2 -6.2 4.9")),
                                              ("Area", ("0.85 -6.2 0.72", "2 -6.15 0.72", "2 -6.15 -0.62", "0.85 -6.2 -0.62"))), 1):
            clicks += f"field PointCloudMeasureKind = {kind}\n"
            for count, place in enumerate(places, 1):
                clicks += f"click-place {place}\n" + (f"wait-label PointCloudMeasureHint {count} point\n" if kind != "Height" else "pause 1000\n")
            clicks += ("key Return\n" if kind != "Height" else "") + f"wait-rows PointCloudMeasureList {row}\n"
        run = self.photograph("window-measure.png", house, clicks + "choose-row PointCloudMeasureList 2\npause 300\nprint-table PointCloudMeasureValues\nchoose-row PointCloudMeasureList 0\nprint-table PointCloudMeasureList")
        values = [number(row[1]) for row in run.tables("PointCloudMeasureList")[-1]]
        for value, expected in zip(values, (9.4, 8.9, 1.55)):
            self.assertAlmostEqual(value, expected, delta=0.2)


if __name__ == "__main__":
    unittest.main()
