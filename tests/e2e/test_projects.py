"""Projects of one generation of MeshLab, opened by another: measures, primitives, bookmarks, clip box, camera and settings."""

import pathlib
import re
import shutil
import unittest
import xml.etree.ElementTree as xml

from fitting_scene import LIST as PRIMITIVES, FittingTest, pipe_on_a_floor
from meshlab import NO_TIME_LIMIT

# One that each generation has saved by the script of make(), of the cloud pipe.pct next to it; @FOLDER@ is their folder.
SAVED = sorted((pathlib.Path(__file__).parent / "projects").glob("*.mlp"))
MEASURES, BOOKMARKS, CAMERA = "PointCloudMeasureList", "PointCloudBookmarks", "PointCloudCamera"
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e-?\d+)?")


def parts(text):
    """What we keep in a project, by the names of the elements; attributes in the order of the alphabet."""
    return {child.tag: xml.canonicalize(xml.tostring(child, encoding="unicode"), strip_text=True)
            for child in xml.fromstring(text) if child.tag.startswith("PointCloud")}


def without_seconds(part):
    """A fit's time is not that of another one."""
    return re.sub(r'"seconds": [0-9.e-]+', '"seconds": 0', part)


class Projects(FittingTest):
    def make(self, project):
        """Clicks and typed numbers, each kind of part once."""
        return f"""
            {self.start(self.tree)}
            {self.click_place("3 0 1.5")}
            key Return
            wait-rows {PRIMITIVES} 1
            trigger Measure
            wait-log Measure: click points
            click-place -4 -3 0
            wait-label PointCloudMeasureHint 1 point
            click-place 1 2 0
            wait-label PointCloudMeasureHint 2 points
            key Return
            wait-rows {MEASURES} 1
            trigger Clip Box
            wait-log drag a coloured cross
            set Centre x = 0.5
            set Centre y = 0
            set Centre z = 1
            set Size x = 8
            set Size y = 7
            set Size z = 3
            set Turn = 15
            trigger Clip Box
            drag 0.4 0.5 0.5 0.6
            wheel 2
            pause 300
            trigger Point Clouds
            pause 300
            trigger Point Clouds
            pause 300
            press Add Bookmark
            wait-rows {BOOKMARKS} 1
            wait-status complete
            trigger Save Project As...
            pick {project}
            wait-file {project}
            """

    def setUp(self):
        super().setUp()
        self.tree = pipe_on_a_floor(self.folder)

    def opened_and_saved(self, project, again):
        """In a MeshLab of its own, which saves what it has opened."""
        run = self.own_gui(f"""
            wait-view
            {NO_TIME_LIMIT}
            view-size 800 600
            open-project {project}
            wait-layers 1
            wait-status complete
            pause 500
            screen {self.result("screen.png")}
            trigger Measure
            wait-rows {MEASURES} 1
            print-table {MEASURES}
            trigger Fit Primitives
            wait-rows {PRIMITIVES} 1
            print-table {PRIMITIVES}
            trigger Save Project As...
            pick {again}
            wait-file {again}
            quit
            """)
        self.assertDriven(run)
        return run

    def assertNear(self, a, b):
        """MeshLab has cameras in float: equal but for numbers, and those nearly."""
        self.assertEqual(NUMBER.sub("#", a), NUMBER.sub("#", b))
        for x, y in zip(map(float, NUMBER.findall(a)), map(float, NUMBER.findall(b))):
            self.assertAlmostEqual(x, y, delta=1e-4 * (1 + abs(x)))

    def test_what_another_meshlab_has_saved(self):
        self.assertEqual(len(SAVED), 2)
        for file in SAVED:
            with self.subTest(file.name):
                project, again = self.folder / file.name, self.folder / f"again-{file.name}"
                project.write_text(file.read_text().replace("@FOLDER@", str(self.folder)))
                run = self.opened_and_saved(project, again)
                self.assertEqual([row[0] for row in run.tables(MEASURES)[0]], ["Distance 1"])
                self.assertEqual([row[0] for row in run.tables(PRIMITIVES)[0]], ["Cylinder 1"])
                kept, saved = parts(project.read_text()), parts(again.read_text())
                self.assertNear(kept.pop(CAMERA), saved.pop(CAMERA))
                self.assertEqual(kept, saved)

    def test_the_same_clicks_make_the_same_parts(self):
        project = self.folder / "made.mlp"
        self.assertDriven(self.gui(self.make(project)))
        shutil.copy(project, self.result("made.mlp"))
        made = parts(project.read_text().replace(str(self.folder), "@FOLDER@"))
        for file in SAVED:
            kept = parts(file.read_text())
            self.assertEqual(set(made), set(kept))
            for name, part in kept.items():
                if name in (CAMERA, BOOKMARKS):
                    self.assertNear(made[name], part)
                else:
                    self.assertEqual(without_seconds(made[name]), without_seconds(part))


if __name__ == "__main__":
    unittest.main()
