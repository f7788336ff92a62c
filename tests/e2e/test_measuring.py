"""The tool Measure in the real window: clicks on a real scan at map coordinates, the list, projects and exports."""

import unittest

from meshlab import NO_TIME_LIMIT, MeshLabTest, pcmlab, sample


class Measuring(MeshLabTest):
    def test_thin(self):
        tree = self.folder / "autzen.pct"
        pcmlab("build", sample("las/autzen_trim.laz"), "-o", tree)
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {NO_TIME_LIMIT}
            view-size 800 600
            wait-status complete
            trigger Measure
            wait-log Measure: click points
            click 0.4 0.5
            pause 500
            click 0.6 0.5
            pause 500
            hover 0.7 0.6
            pause 200
            screen {self.result("draft.png")}
            key Return
            wait-rows PointCloudMeasureList 1
            print-table PointCloudMeasureList
            print-table PointCloudMeasureValues
            pause 300
            screen {self.result("screen.png")}
            print-log
            quit
            """)
        print(run.text)
        self.assertDriven(run)


if __name__ == "__main__":
    unittest.main()
