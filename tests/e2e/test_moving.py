"""Several clouds: moved by MeshLab's tools and by numbers, aligned by picked pairs, locked, and written where they are shown."""

import json
import math
import re
import unittest

from meshlab import FIXED_VIEW, NO_TIME_LIMIT, MeshLabTest, different, pcmlab, sample


def bounds(tree):
    box = pcmlab("info", tree)["bounds"]
    return box["min"], box["max"]


def corners(tree):
    low, high = bounds(tree)
    return [[(low, high)[i >> a & 1][a] for a in range(3)] for i in range(8)]


def times(rows, p):
    """A matrix of three rows with four numbers, times a point."""
    return [sum(row[c] * p[c] for c in range(3)) + row[3] for row in rows]


def distance(p, q):
    return math.dist(p, q)


class AlignByPicks(MeshLabTest):
    """Two halves of a real scan, one of them turned by a known motion."""

    # The right half is turned about the vertical axis, tilted, and shifted beside the other.
    TURN = ["--rotate", 0.1, 0.05, 1, 20, "--translate", 150, 700, 25, "--pivot", 636590, 849216, 450]

    def halves(self):
        """The trees of the fixed and of the moving half, and points of both that are seen from above: (moving, fixed)."""
        scan = sample("las/autzen_trim.laz")
        left, right, moving = (self.folder / f"{name}.pct" for name in ("left", "right", "moving"))
        pcmlab("convert", scan, left, "--where", "x<=636730")
        pcmlab("convert", scan, right, "--where", "x>=636450")
        pcmlab("transform", right, moving, *self.TURN)
        strip = self.folder / "strip.xyz"
        pcmlab("convert", right, strip, "--where", "x<=636730", "--attributes", "intensity")
        points = [tuple(map(float, line.split()[:3])) for line in strip.read_text().splitlines() if line[:1].isdigit()]
        x, y = [sorted(p[a] for p in points) for a in (0, 1)]
        chosen = []
        for low, high in ((x[0], x[0] + 90), (x[-1] - 90, x[-1])):
            for bottom, top in ((y[0] + 10, y[0] + 120), (y[-1] - 120, y[-1] - 10)):
                chosen.append(max((p for p in points if low <= p[0] <= high and bottom <= p[1] <= top), key=lambda p: p[2]))
        return left, right, moving, [(self.turned(p), p) for p in chosen]

    def turned(self, p):
        """Rodrigues' formula, as pcmlab transform computes it."""
        axis, angle = self.TURN[1:4], math.radians(self.TURN[4])
        shift, pivot = self.TURN[6:9], self.TURN[10:13]
        n = math.sqrt(sum(a * a for a in axis))
        u = [a / n for a in axis]
        d = [a - b for a, b in zip(p, pivot)]
        cross = [u[1] * d[2] - u[2] * d[1], u[2] * d[0] - u[0] * d[2], u[0] * d[1] - u[1] * d[0]]
        along = sum(a * b for a, b in zip(u, d))
        c, s = math.cos(angle), math.sin(angle)
        return [c * d[i] + s * cross[i] + (1 - c) * along * u[i] + pivot[i] + shift[i] for i in range(3)]

    def test_a_turned_half_comes_back_within_the_spacing_of_the_picks(self):
        left, right, moving, places = self.halves()
        low, high = bounds(left)
        origin = [round((a + b) / 2) for a, b in zip(low, high)]

        def place(p):
            return " ".join(f"{a - b:.3f}" for a, b in zip(p, origin))

        table, message = "PointCloudAlignPairs", "PointCloudAlignMessage"
        clicks = ""
        for i, (from_place, to_place) in enumerate(places):
            clicks += f"""
            click-place {place(from_place)}
            wait-label {message} Pair {i + 1}: the moving point is
            click-place {place(to_place)}
            wait-label {message} Pair {i + 1}: the fixed point is
            """
        before, picked, after, pairs = (self.result(name) for name in ("before.png", "picked.png", "after.png", "pairs.txt"))
        pairs.unlink(missing_ok=True)
        exported, tree = self.folder / "moved.las", self.folder / "moving-aligned.pct"
        run = self.gui(f"""
            wait-view
            {NO_TIME_LIMIT}
            view-size 1150 900
            open {left}
            wait-layers 1
            open {moving}
            wait-layers 2
            trigger Reset Trackball
            wait-status complete
            picture {before}
            trigger Align by Picked Pairs
            wait-rows {table} 0
            click-place {place([high[0] + 200, low[1], 450])}
            wait-label {message} No point
            {clicks}
            wait-rows {table} {len(places)}
            print-label PointCloudAlignSummary
            print-table {table}
            screen {picked}
            press Apply Alignment
            wait-log Aligned the layer
            wait-status complete
            screen {after}
            print-layers
            press Undo Alignment
            print-layers
            press Redo Alignment
            print-layers
            press Save Pairs...
            pick {pairs}
            export {exported}
            wait-log Wrote
            press Write Moved Tree...
            pick {tree}
            wait-log Wrote the moved tree
            wait-layers 3
            wait-status complete
            print-layers
            quit
            """, timeout=400)
        self.assertDriven(run)
        result = pcmlab("align", moving, left, "--pairs", pairs)
        spacing = max(max(pair["moving_spacing"], pair["fixed_spacing"]) for pair in result["pairs"])
        print(f"spacing at the picks up to {spacing:.2f}, RMS {result['rms']:.3f}, stated error of the cloud "
              f"{result['error_of_cloud']:.3f}")
        self.assertEqual(len(result["pairs"]), len(places))
        self.assertLess(result["rms"], spacing)
        layers = run.layers()
        applied, undone, again, last = layers[1], layers[3], layers[5], layers[6:]
        identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
        self.assertEqual(undone["matrix"], identity)
        self.assertEqual(again["matrix"], applied["matrix"])
        # The matrix brings the turned half back to where it was cut off.
        rows = [applied["matrix"][4 * r:4 * r + 4] for r in range(3)]
        apart = []
        for p in corners(right):
            turned = [a - b for a, b in zip(self.turned(p), origin)]
            apart.append(distance(times(rows, turned), [a - b for a, b in zip(p, origin)]))
        print(f"the corners of the cloud are {max(apart):.3f} from where they were")
        self.assertLess(max(apart), spacing)
        # What is exported and what is written are where the view shows the layer; the tree in double.
        self.assertEqual(pcmlab("info", tree)["points"], pcmlab("info", moving)["points"])
        self.assertEqual([layer["matrix"] for layer in last][2], identity)
        for file in (exported, tree):
            found = bounds(file) if file == tree else (pcmlab("info", "--scan", file)["scanned"]["bounds"][k] for k in ("min", "max"))
            for a, b in zip(found, bounds(right)):
                self.assertLess(distance(a, b), 2 * spacing, file)
        motion = result["matrix"]
        self.assertLess(max(distance(times(motion, self.turned(p)), p) for p in corners(right)), spacing)
        self.assertGreater(different(before, picked), 0)

    def test_ill_posed_pairs_are_refused_in_the_panel(self):
        left, _, moving, places = self.halves()
        (m0, f0), (m1, f1) = places[:2]
        line = [[a + t * (b - a) for a, b in zip(p, q)] for t in (0, 0.5, 1) for p, q in ((m0, m1), (f0, f1))]
        pairs = self.folder / "pairs.txt"
        pairs.write_text("\n".join(" ".join(map(repr, line[2 * i] + line[2 * i + 1])) for i in range(3)) + "\n")
        run = self.gui(f"""
            wait-view
            open {left}
            wait-layers 1
            open {moving}
            wait-layers 2
            wait-status complete
            trigger Align by Picked Pairs
            wait-rows PointCloudAlignPairs 0
            print-label PointCloudAlignSummary
            press Load Pairs...
            pick {pairs}
            wait-rows PointCloudAlignPairs 3
            print-label PointCloudAlignSummary
            print-table PointCloudAlignPairs
            press Delete Pair
            wait-rows PointCloudAlignPairs 2
            print-label PointCloudAlignSummary
            quit
            """)
        self.assertDriven(run)
        first, second, third = run.labels("PointCloudAlignSummary")
        self.assertIn("needs three pairs of points, and there are 0", first)
        self.assertIn("lie on one line", second)
        self.assertIn("needs three pairs of points, and there are 2", third)


class MovedByMeshLab(MeshLabTest):
    """MeshLab's own tools move a layer, and everything that is written follows."""

    def test_a_matrix_shows_at_once_and_is_exported_merged_and_made_real(self):
        tree = self.folder / "scan.pct"
        pcmlab("convert", sample("las/autzen_trim.laz"), tree)
        low, high = bounds(tree)
        before, moved = self.result("before.png"), self.result("moved.png")
        exported, merged, real = (self.folder / name for name in ("moved.las", "merged.pct", "real.pct"))
        run = self.gui(f"""
            wait-view
            {FIXED_VIEW}
            open {tree}
            wait-layers 1
            wait-status complete
            picture {before}
            trigger Matrix: Set from translation/rotation/scale
            set X Translation = 300
            set Z Rotation = 90
            press Apply
            press Close
            wait-status complete
            picture {moved}
            print-layers
            export {exported}
            wait-log Wrote 110,000 points
            trigger Merge Point Cloud Trees
            set Output folder = {merged}
            press Apply
            wait-log Merge of 1 trees
            wait-layers 2
            press Close
            quit
            """, timeout=400)
        self.assertDriven(run)
        matrix = run.layers()[0]["matrix"]
        self.assertGreater(different(before, moved), 0.1)
        rows = [matrix[4 * r:4 * r + 4] for r in range(3)]
        origin = [round((a + b) / 2) for a, b in zip(low, high)]
        shown = [[a + b for a, b in zip(times(rows, [x - y for x, y in zip(p, origin)]), origin)] for p in corners(tree)]
        expected = [[f(p[a] for p in shown) for a in range(3)] for f in (min, max)]
        for found in (bounds(merged), [pcmlab("info", "--scan", exported)["scanned"]["bounds"][k] for k in ("min", "max")]):
            for a, b in zip(found, expected):
                self.assertLess(distance(a, b), 0.05)

    def test_a_matrix_that_is_frozen_as_the_dialog_closes_moves_the_cloud(self):
        _, tree = self.generate("city", 400000, "--seed", 5)
        before, moved = (self.result(f"{name}.png") for name in ("before", "moved"))
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {FIXED_VIEW}
            wait-status complete
            picture {before}
            trigger Transform: Translate, Center, set Origin
            set X Axis = 12
            press Apply
            press Close
            wait-log is the layer's matrix again
            pause 1000
            wait-notice none
            wait-status complete
            picture {moved}
            print-layers
            quit
            """)
        self.assertDriven(run)
        self.assertEqual(run.layers()[0]["matrix"][3], 12)
        self.assertGreater(different(before, moved), 0.1)


if __name__ == "__main__":
    unittest.main()
