"""The tools on layers that have a matrix, under a clip box and over two layers, and what is cancelled."""

import csv
import re
import unittest

from meshlab import NO_TIME_LIMIT, MeshLabTest, pcmlab, sample
from test_measuring import kept_in, positions

MESSAGE = "PointCloudMeasureMessage"
VIEW = NO_TIME_LIMIT + """
    view-size 800 600
    wait-status complete
    """


def matrix_in_source_coordinates(matrix, origin):
    """Of a layer's matrix, which is about the document's origin: rows of four numbers."""
    rows = [matrix[4 * r:4 * r + 4] for r in range(3)]
    return [[*row[:3], row[3] + origin[r] - sum(a * b for a, b in zip(row, origin))] for r, row in enumerate(rows)]


def origin_of(run):
    return [float(v) for v in re.search(r"document's origin (\S+) (\S+) (\S+?)\.?\s", run.text).groups()]


def table(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


class MovedLayers(MeshLabTest):
    TURN_AND_TILT = """
        trigger Matrix: Set from translation/rotation/scale
        set Z Translation = 10
        set X Rotation = 3
        set Z Rotation = 25
        set Freeze Matrix = off
        press Apply
        press Close
        """

    def test_profiles_and_volumes_are_of_the_moved_points(self):
        """A tilted layer, against the same measures of a tree that was moved by the command."""
        before, after, moved = (self.folder / f"{name}.pct" for name in ("before", "after", "moved"))
        pcmlab("build", sample("las/autzen_trim.laz"), "-o", before)
        pcmlab("convert", before, after)
        project, out, values = self.folder / "p.mlp", self.folder / "profile.csv", self.folder / "m.csv"
        run = self.gui(f"""
            wait-view
            open {before}
            wait-layers 1
            open {after}
            wait-layers 2
            {self.TURN_AND_TILT}
            {VIEW}
            print-layers
            trigger Measure
            wait-log Measure: click points
            field PointCloudMeasureKind = Profile
            field PointCloudMeasureCloud = after (18,241 of 110,000)
            field PointCloudMeasureWidth = 20
            click 0.4 0.5
            wait-label PointCloudMeasureHint 1 points
            click 0.6 0.52
            wait-label PointCloudMeasureHint 2 points
            key Return
            wait-label PointCloudProfileWords points
            press Points as CSV
            pick {out}
            wait-label {MESSAGE} moved by the layer's matrix
            field PointCloudMeasureKind = Volume
            field PointCloudMeasureCloud = after (18,241 of 110,000)
            field PointCloudMeasureCompared = before (18,241 of 110,000)
            field PointCloudMeasureCell = 10
            click 0.40 0.40
            wait-label PointCloudMeasureHint 1 points
            click 0.60 0.42
            wait-label PointCloudMeasureHint 2 points
            click 0.55 0.60
            wait-label PointCloudMeasureHint 3 points
            key Return
            wait-label {MESSAGE} ft³
            screen {self.result("volume.png")}
            press Export measures
            pick {values}
            wait-log wrote 2 measures
            trigger Save Project As...
            pick {project}
            pause 500
            quit
            """)
        self.assertDriven(run)
        matrix = matrix_in_source_coordinates(run.layers()[1]["matrix"], origin_of(run))
        self.assertGreater(abs(matrix[2][1]), 0.04)  # tilted
        pcmlab("transform", after, moved, "--matrix", *(repr(x) for row in matrix for x in row))
        profile, volume = kept_in(project)
        line = [x for p in positions(profile) for x in p[:2]]
        listed = self.folder / "expected.csv"
        from_command = pcmlab("profile", moved, "-o", listed, "--line", *line, "--width", 20)
        rows, expected = table(out), table(listed)
        self.assertGreater(len(rows), 300)
        self.assertLess(abs(len(rows) - len(expected)), 3, from_command)  # the written tree has a grid
        for column in ("station", "offset", "x", "y", "z"):
            ours, theirs = (sorted(float(row[column]) for row in part) for part in (rows, expected))
            if len(rows) == len(expected):
                self.assertLess(max(abs(a - b) for a, b in zip(ours, theirs)), 0.02, column)
        corners = [x for p in positions(volume) for x in p[:2]]
        from_command = pcmlab("volume", moved, "--polygon", *corners, "--before", before, "--side", 10)
        found = {row["quantity"]: float(row["value"]) for row in table(values) if row["name"] == volume["name"]}
        self.assertGreater(from_command["cut"], 1000)
        for name in ("net", "cut", "fill"):
            self.assertAlmostEqual(found[name] / from_command["cut"], from_command[name] / from_command["cut"], delta=1e-3)


if __name__ == "__main__":
    unittest.main()
