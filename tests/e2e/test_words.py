"""What MeshLab shows and says about clouds, in a user's words: the text in the view, the settings, the first view, messages."""

import unittest

from meshlab import NO_TIME_LIMIT, MeshLabTest


class Words(MeshLabTest):
    def test_one_box_for_all_layers(self):
        _, first = self.generate("first", 60000, "--seed", 6)
        _, second = self.generate("second", 40000, "--seed", 7)
        run = self.gui(f"""
            wait-view
            {NO_TIME_LIMIT}
            open {first}
            wait-layers 1
            open {second}
            wait-layers 2
            wait-status full resolution
            print-boxes
            parameter MeshLab::PointCloud::Details = 1
            wait-status full resolution
            print-boxes
            screen {self.result("details.png")}
            quit
            """)
        self.assertDriven(run)
        plain, detailed = run.boxes()
        self.assertEqual(plain, {"title": "Point Cloud", "layer": "", "text": "all points shown"})
        for line in ("all points shown<br>", " ms per frame", "first.pct: ", "second.pct: ", "video memory: ", "main memory: "):
            self.assertIn(line, detailed["text"])
        self.assertNotIn("<t", detailed["text"])


if __name__ == "__main__":
    unittest.main()
