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

    # The right half is turned about the vertical axis, tilted, and shifted next to the other.
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
        picked, after = (self.result(name) for name in ("picked.png", "after.png"))
        pairs = self.folder / "pairs.txt"
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
            set Freeze Matrix = off
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
            wait-log points of 1 trees
            wait-layers 2
            press Close
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
            """)
        self.assertDriven(run)
        self.assertEqual(run.layers()[0]["matrix"][3], 12)
        self.assertGreater(different(before, moved), 0.1)

class PointCloudsPanel(MeshLabTest):
    """The panel Point Clouds: current layer, visible, solo, lock, moving by numbers, bookmarks."""

    def two_layers(self):
        return self.generate("a", 60000, "--seed", 1)[1], self.generate("b", 60000, "--seed", 2)[1]

    def tables(self, run, name):
        found = (json.loads(m[1]) for m in re.finditer(r"driver: table (\{.*\})", run.text))
        return [table["rows"] for table in found if table["name"] == name]

    def test_layers_are_chosen_shown_alone_and_locked(self):
        a, b = self.two_layers()
        panel, project = self.result("panel.png"), self.folder / "saved.mlp"
        run = self.gui(f"""
            wait-view
            open {a}
            wait-layers 1
            open {b}
            wait-layers 2
            wait-status complete
            wait-status 2 clouds
            wait-rows PointCloudLayers 2
            print-table PointCloudLayers
            check-cell PointCloudLayers 0 3 on
            wait-no-status 2 clouds
            print-table PointCloudLayers
            check-cell PointCloudLayers 0 3 off
            wait-status 2 clouds
            print-table PointCloudLayers
            check-cell PointCloudLayers 1 2 off
            wait-no-status 2 clouds
            check-cell PointCloudLayers 1 2 on
            wait-status 2 clouds
            trigger Point Clouds
            pause 300
            trigger Point Clouds
            pause 300
            click-cell PointCloudLayers 0 0
            pause 500
            set-text PointCloudMoveX 25
            press Move Layer
            pause 300
            print-layers
            press Undo Move
            pause 300
            print-layers
            press Redo Move
            pause 300
            check-cell PointCloudLayers 0 4 on
            press Move Layer
            wait-label PointCloudMoveMessage is locked
            trigger Transform: Translate, Center, set Origin
            set X Axis = 12
            press Apply
            wait-log is locked
            press Close
            pause 1000
            wait-notice none
            move-layer 0 100 0 0
            wait-log its matrix is what it was
            print-layers
            trigger Delete Points of Point Cloud Tree
            set Where = x > 0
            set In place = on
            press Apply
            wait-log and is locked
            pause 500
            screen {panel}
            press OK
            press Close
            check-cell PointCloudLayers 1 3 on
            trigger Save Project As...
            pick {project}
            wait-file {project}
            """, timeout=400)
        self.assertDriven(run)
        # In a MeshLab of its own: another session, with the project on its command line.
        again = self.own_gui(f"""
            wait-view
            wait-layers 2
            wait-rows PointCloudLayers 2
            pause 500
            print-table PointCloudLayers
            check-cell PointCloudLayers 1 3 off
            wait-status 2 clouds
            print-table PointCloudLayers
            move-layer 0 100 0 0
            wait-log its matrix is what it was
            print-layers
            quit
            """, project)
        self.assertDriven(again)
        self.assertEqual([[row[2:] for row in rows] for rows in self.tables(again, "PointCloudLayers")],
                         [[[False, False, True], [True, True, False]], [[True, False, True], [True, False, False]]])
        self.assertEqual([layer["matrix"][3] for layer in again.layers()], [25, 0])
        first, solo, released = self.tables(run, "PointCloudLayers")
        self.assertEqual([row[1:] for row in first], [["60,000", True, False, False]] * 2)
        self.assertEqual([row[2:4] for row in solo], [[True, True], [False, False]])
        self.assertEqual(released, first)
        shifts = [layer["matrix"][3] for layer in run.layers()]
        self.assertEqual(shifts, [25, 0, 0, 0, 25, 0])  # moved, undone, and locked where it had been moved
        self.assertEqual(pcmlab("info", a)["points"], 60000)

    def test_bookmarks_look_from_where_they_were_made_and_are_kept_in_the_project(self):
        _, tree = self.generate("a", 60000, "--seed", 1)
        path, project = self.folder / "views.json", self.folder / "saved.mlp"
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {FIXED_VIEW}
            wait-status complete
            trigger Point Clouds
            pause 300
            trigger Point Clouds
            pause 300
            drag 0.4 0.5 0.6 0.7
            print-camera one
            press Add Bookmark
            wait-rows PointCloudBookmarks 1
            trigger Toggle Orthographic Camera
            wheel 3
            pause 300
            print-camera two
            press Add Bookmark
            wait-rows PointCloudBookmarks 2
            drag 0.6 0.5 0.3 0.3
            click-cell PointCloudBookmarks 0 0
            press Go To Bookmark
            pause 300
            print-camera one-again
            click-cell PointCloudBookmarks 1 0
            press Go To Bookmark
            pause 300
            print-camera two-again
            press Export Bookmarks...
            pick {path}
            press Delete Bookmark
            wait-rows PointCloudBookmarks 1
            press Import Bookmarks...
            pick {path}
            wait-rows PointCloudBookmarks 3
            print-table PointCloudBookmarks
            screen {self.result("panel.png")}
            trigger Save Project As...
            pick {project}
            wait-file {project}
            """, timeout=400)
        self.assertDriven(run)
        cameras = run.cameras()
        for name in ("one", "two"):
            for key in ("eye", "centre"):
                size = max(map(abs, cameras[name]["eye"])) + 1
                self.assertLess(distance(cameras[name][key], cameras[name + "-again"][key]), 1e-4 * size, name)
            self.assertEqual(cameras[name]["orthographic"], cameras[name + "-again"]["orthographic"])
            self.assertAlmostEqual(cameras[name]["scale"] / cameras[name + "-again"]["scale"], 1, places=4)
        self.assertEqual(self.tables(run, "PointCloudBookmarks")[-1], [["View"], ["View 2"], ["View 3"]])
        written = json.loads(path.read_text())
        self.assertEqual([frame["name"] for frame in written["frames"]], ["View", "View 2"])
        low, high = bounds(tree)
        self.assertTrue(all(a - 200 < x < b + 200 for a, x, b in zip(low, written["frames"][0]["target"], high)))
        pcmlab("render", tree, "-o", self.folder / "frame%02d.png", "--path", path, "--size", "64x48")
        self.assertIn("PointCloudBookmarks", project.read_text())
        # In a MeshLab of its own: another session, with the project on its command line.
        again = self.own_gui("wait-view\nwait-layers 1\nwait-rows PointCloudBookmarks 3\nprint-table PointCloudBookmarks\nquit\n",
                         project)
        self.assertDriven(again)
        self.assertEqual(self.tables(again, "PointCloudBookmarks")[-1], [["View"], ["View 2"], ["View 3"]])


if __name__ == "__main__":
    unittest.main()
