"""The tool Fit Primitives in the real MeshLab: every change of its list and its undo, what it does not see, layers that are removed
while it works, and primitives of moved layers that are saved, reopened and exported."""

import csv
import json
import math
import re
import unittest

from fitting_scene import FOUND, LIST, MESSAGE, FittingTest, kept_in, number, pipe_on_a_floor
from meshlab import NO_TIME_LIMIT, different, facts_of, pcmlab

FLOOR, PIPE = "-2 1 0", "3 0.5 1.5"


class FittingList(FittingTest):
    def two(self):
        """A pipe and a floor in the list."""
        return f"""
            {self.click_place(PIPE)}
            key Return
            wait-rows {LIST} 1
            {self.click_place(FLOOR)}
            key Return
            wait-rows {LIST} 2
            """

    def test_each_change_is_undone(self):
        tree = pipe_on_a_floor(self.folder)
        states = []

        def state(name):
            states.append(name)
            return f"""
                pause 100
                print-table {LIST}
                press Export
                pick {self.folder / (name + ".json")}
                wait-label {MESSAGE} {name}.json
                """

        run = self.gui(f"""
            {self.start(tree)}
            {self.two()}
            {state("two")}
            choose-row {LIST} 0
            print-docks
            press Colour
            choose-colour cancel
            pause 100
            press Colour
            choose-colour #123456
            {state("coloured")}
            screen {self.result("coloured.png")}
            rename-row {LIST} 1 floor
            {state("renamed")}
            tick-row {LIST} 0 off
            {state("hidden")}
            press Delete
            wait-rows {LIST} 1
            {state("deleted")}
            press Delete all
            wait-rows {LIST} 0
            key Ctrl+Z
            {state("back-deleted")}
            key Ctrl+Z
            {state("back-hidden")}
            key Ctrl+Z
            {state("back-renamed")}
            key Ctrl+Z
            {state("back-coloured")}
            press Undo
            {state("back-two")}
            key Ctrl+Z
            wait-rows {LIST} 1
            key Ctrl+Z
            wait-rows {LIST} 0
            key Ctrl+Z
            key Ctrl+Shift+Z
            wait-rows {LIST} 1
            press Redo
            wait-rows {LIST} 2
            press Redo
            {state("again-coloured")}
            choose-row {LIST} 1
            key Delete
            wait-rows {LIST} 1
            """)
        self.assertDriven(run)
        self.assertLessEqual(run.docks()["PointCloudFitDock"], 300)
        tables = dict(zip(states, run.tables(LIST)))
        files = {name: (self.folder / f"{name}.json").read_text() for name in states}
        names = {name: [(row[0], row[-1]) for row in table] for name, table in tables.items()}
        self.assertEqual(names["two"], [("Cylinder 1", True), ("Plane 1", True)])
        self.assertEqual(names["renamed"], [("Cylinder 1", True), ("floor", True)])
        self.assertEqual(names["hidden"], [("Cylinder 1", False), ("floor", True)])
        self.assertEqual(names["deleted"], [("floor", True)])
        colours = {name: [p["colour"] for p in json.loads(text)["primitives"]] for name, text in files.items()}
        self.assertEqual(colours["coloured"], [[0x12, 0x34, 0x56], colours["two"][1]])
        self.assertNotEqual(colours["two"][0], colours["two"][1])
        for name in ("deleted", "hidden", "renamed", "coloured", "two"):
            self.assertEqual(tables["back-" + name], tables[name])
            self.assertEqual(files["back-" + name], files[name])
        self.assertEqual(files["again-coloured"], files["coloured"])

    def test_alt_and_shift_take_away(self):
        """The floor next to the pipe's foot: with a place on the floor taken away, by either key, the same shape."""
        tree = pipe_on_a_floor(self.folder)
        run = self.gui(f"""
            {self.start(tree)}
            {self.click_place(PIPE)}
            {self.click_place("3 -1 1.5", "Alt")}
            print-label {FOUND}
            key Ctrl+Z
            wait-label {FOUND} 1 place.
            {self.click_place("3 -1 1.5", "Shift")}
            wait-label {FOUND} taken away
            print-label {FOUND}
            """)
        self.assertDriven(run)
        by_alt, by_shift = run.labels(FOUND)
        self.assertIn("1 place taken away", by_alt)
        self.assertEqual(by_alt, by_shift)

    def test_hidden_classes_and_conditions(self):
        """Only points that the view shows belong to a shape: of the pipe, the half that is not hidden."""
        tree = pipe_on_a_floor(self.folder)
        counts = {}
        for name, setting in (("all", ""), ("classes", "parameter MeshLab::PointCloud::HiddenClasses = 6"),
                              ("conditions", "parameter MeshLab::PointCloud::Conditions = y < 0; classification = 2")):
            out = self.folder / f"{name}.csv"
            run = self.gui(f"""
                {self.start(tree, more=setting + chr(10) + "wait-status complete")}
                {self.click_place("3 -0.5 1.5")}
                key Return
                wait-rows {LIST} 1
                trigger Its points to a file...
                pick {out}
                wait-label {MESSAGE} extracted
                """)
            self.assertDriven(run)
            with open(out, newline="", encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
            counts[name] = len(rows)
            classes = {int(float(row["classification"])) for row in rows}
            self.assertEqual(classes, {2, 6} if name == "all" else {2})
        self.assertEqual(counts["classes"], counts["conditions"])
        self.assertAlmostEqual(counts["all"] / counts["classes"], 2, delta=0.2)


class MovedClouds(FittingTest):
    """Two clouds whose layers have matrices: fitted, exported, saved and reopened."""

    # Up by two, and in addition a quarter turn about z.
    MATRICES = ("move-layer 0 0 0 2", "layer-matrix 1 0 -1 0 -11 1 0 0 0 0 0 1 0 0 0 0 1")

    def points_to(self, name):
        return f"""
            trigger Its points to a file...
            pick {self.folder / name}
            wait-label {MESSAGE} extracted
            """

    def counts(self, *names):
        return [pcmlab("info", self.folder / name)["points"] for name in names]

    def check_places(self, primitives):
        """Where the matrices put the two pipes."""
        first, second = primitives
        self.assertLess(math.hypot(first["point"][0] - 3, first["point"][2] - 3), 0.002)
        self.assertAlmostEqual(abs(first["axis"][1]), 1, delta=1e-4)
        self.assertLess(math.hypot(second["point"][1] - 3, second["point"][2] - 1), 0.002)
        self.assertAlmostEqual(abs(second["axis"][0]), 1, delta=1e-4)

    def test_saved_reopened_and_exported(self):
        pipe, other = pipe_on_a_floor(self.folder), pipe_on_a_floor(self.folder, "other", seed=8)
        project = self.folder / "p.mlp"
        moved = chr(10).join(self.MATRICES) + """
            wheel 8
            wait-status complete
            """
        run = self.gui(f"""
            {self.start(pipe, other, more=moved)}
            {self.click_place("3 0.5 3.5")}
            key Return
            wait-rows {LIST} 1
            {self.points_to("0.las")}
            field PointCloudFitGrow = off
            {self.click_place("-11.5 3 1.5")}
            {self.click_place("-11 3 1.5", "Ctrl")}
            {self.click_place("-10.5 3 1.5", "Shift")}
            wait-label {FOUND} taken away
            key Return
            wait-rows {LIST} 2
            {self.points_to("1.las")}
            field PointCloudFitGrow = on
            {self.click_place("-11.5 3 1.5")}
            {self.click_place("-12.5 3 1.5", "Shift")}
            key Return
            wait-rows {LIST} 3
            {self.points_to("2.las")}
            wait-status complete
            screen {self.result("moved.png")}
            trigger Save Project As...
            pick {project}
            wait-file {project}
            press Delete
            wait-rows {LIST} 2
            press Export
            pick {self.folder / "moved.json"}
            wait-label {MESSAGE} moved as the matrices
            layer-matrix 1 2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1
            press Export
            pick {self.folder / "scaled.csv"}
            wait-label {MESSAGE} scales, shears or mirrors Cylinder 2
            """)
        self.assertDriven(run)
        self.check_places(json.loads((self.folder / "moved.json").read_text())["primitives"])
        self.assertFalse((self.folder / "scaled.csv").exists())
        kept = kept_in(project)
        self.assertEqual([p["name"] for p in kept], ["Cylinder 1", "Cylinder 2", "Cylinder 3"])
        for one in kept:  # the clouds' own coordinates
            self.assertLess(math.hypot(one["point"][0] - 3, one["point"][2] - 1), 0.002)
        before = self.counts("0.las", "1.las", "2.las")
        self.assertGreater(before[0], 14000)
        self.assertLess(before[1], 5000, "two neighbourhoods")
        self.assertLess(before[2], before[0] - 300, "a place was taken away")
        table = self.folder / "again.csv"
        # In a MeshLab of its own: another session.
        run = self.own_gui(f"""
            {self.start(pipe, other, project=project)}
            print-table {LIST}
            choose-row {LIST} 0
            pause 100
            {self.points_to("0-again.las")}
            choose-row {LIST} 1
            pause 100
            {self.points_to("1-again.las")}
            choose-row {LIST} 2
            pause 100
            {self.points_to("2-again.las")}
            wait-status complete
            screen {self.result("reopened.png")}
            press Delete
            wait-rows {LIST} 2
            trigger Export Primitives
            set Output file = {table}
            press Apply
            wait-log 2 primitives
            press Close
            quit
            """)
        self.assertDriven(run)
        self.assertEqual([row[0] for row in run.tables(LIST)[0]], [p["name"] for p in kept])
        self.assertEqual(self.counts("0-again.las", "1-again.las", "2-again.las"), before)
        with open(table, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.check_places([{"point": [float(row[k]) for k in ("x", "y", "z")],
                            "axis": [float(row[k]) for k in ("axis_x", "axis_y", "axis_z")]} for row in rows])


    def test_a_shape_is_of_one_cloud(self):
        """A place of the other cloud is refused for it; a click there begins another, and what was selected before is again."""
        moved = chr(10).join(self.MATRICES) + """
            wheel 8
            wait-status complete
            """
        show = """
            wait-status complete
            print-boxes
            """
        run = self.gui(f"""
            {self.start(pipe_on_a_floor(self.folder), pipe_on_a_floor(self.folder, "other", seed=8), more=moved)}
            trigger Select its points
            wait-label {MESSAGE} select a primitive of the list first
            {self.click_place("-2 1 2")}
            key Return
            wait-rows {LIST} 1
            {show}
            {self.click_place("3 0.5 3.5")}
            wait-label {FOUND} Enter
            {show}
            print-label {FOUND}
            modifiers Ctrl
            click-place -11.5 3 1.5
            wait-label {MESSAGE} one cloud
            modifiers none
            print-label {FOUND}
            {show}
            {self.click_place("-11.5 3 1.5")}
            wait-label {FOUND} Enter
            print-label {FOUND}
            {show}
            escape-in-view
            wait-label {MESSAGE} discarded
            {show}
            """)
        self.assertDriven(run)
        selected = [int(re.search(r"([0-9,]+) points selected", box["text"])[1].replace(",", "")) for box in run.boxes()
                    if "points selected" in box["text"]]
        first, same, other = (int(number(re.search(r"([0-9,]+) points", text)[1])) for text in run.labels(FOUND))
        floor = selected[0]
        self.assertGreater(floor, 29000)
        self.assertEqual(same, first)
        self.assertEqual(selected, [floor, first, first, floor + other, floor])


class LayersAndWork(FittingTest):
    """Layers that are removed, and MeshLab closed, while something runs."""

    LONG = "field PointCloudFitNeighbourhood = 1000000"

    def setUp(self):
        super().setUp()
        self.tree = pipe_on_a_floor(self.folder, points=600000)

    def test_a_cancelled_refinement_keeps_the_shape(self):
        run = self.gui(f"""
            {self.start(self.tree)}
            {self.click_place(PIPE)}
            print-label {FOUND}
            {self.LONG}
            wait-property pcm_fit_tool "fitting"
            key Return
            wait-label {MESSAGE} is being fitted
            escape-in-view
            wait-label {MESSAGE} cancelled
            print-label {FOUND}
            print-property pcm_fit_tool
            key Return
            wait-rows {LIST} 1
            """)
        self.assertDriven(run)
        before, after = run.labels(FOUND)
        self.assertEqual(before, after)
        self.assertEqual(run.properties("pcm_fit_tool")[0]["state"], "draft")

    def test_a_layer_is_removed_while_its_shape_is_fitted(self):
        """Which ends the tool: what ran is forgotten, and the tool works with the next layer."""
        run = self.gui(f"""
            {self.start(self.tree)}
            {self.LONG}
            click-place {FLOOR}
            wait-property pcm_fit_tool "fitting"
            trigger Delete Current Mesh
            wait-layers 0
            open {self.tree}
            wait-layers 1
            wait-status complete
            trigger Fit Primitives
            wait-property pcm_fit_tool "idle"
            print-label {FOUND}
            print-table {LIST}
            field PointCloudFitNeighbourhood =
            click-place {PIPE}
            wait-label {FOUND} Enter
            """)
        self.assertDriven(run)
        self.assertIn("Click a point", run.labels(FOUND)[0])
        self.assertEqual(run.tables(LIST), [[]])

    def test_a_layer_with_a_draft_and_primitives_is_removed(self):
        """The draft goes with the tool; primitives stay in the list, without points."""
        other = pipe_on_a_floor(self.folder, "other", seed=8)
        run = self.gui(f"""
            {self.start(other, self.tree)}
            show-layer 0 off
            wait-status complete
            {self.click_place(PIPE)}
            key Return
            wait-rows {LIST} 1
            {self.click_place(FLOOR)}
            wait-label {FOUND} Plane
            trigger Delete Current Mesh
            wait-layers 1
            show-layer 0 on
            wait-status complete
            trigger Fit Primitives
            pause 200
            print-label {FOUND}
            key Return
            wait-label {MESSAGE} nothing to accept
            choose-row {LIST} 0
            pause 100
            trigger Select its points
            wait-label {MESSAGE} no layer shows the cloud
            print-label {MESSAGE}
            press Jump to
            pause 200
            wait-status complete
            screen {self.result("removed.png")}
            """)
        self.assertDriven(run)
        self.assertIn("Click a point", run.labels(FOUND)[0])
        self.assertIn("pipe.pct", run.labels(MESSAGE)[-1])

    def test_meshlab_is_closed_while_it_fits(self):
        # In a MeshLab of its own: it is quit while it fits.
        run = self.own_gui(f"""
            {self.start(self.tree)}
            {self.LONG}
            click-place {FLOOR}
            wait-property pcm_fit_tool "fitting"
            quit
            """)
        self.assertDriven(run)

    def test_the_tool_is_ended_while_it_fits(self):
        """And started again: what ran is forgotten."""
        run = self.gui(f"""
            {self.start(self.tree)}
            {self.LONG}
            click-place {FLOOR}
            wait-property pcm_fit_tool "fitting"
            trigger Fit Primitives
            pause 50
            trigger Fit Primitives
            field PointCloudFitNeighbourhood =
            click-place {PIPE}
            wait-label {FOUND} Enter
            print-label {FOUND}
            """)
        self.assertDriven(run)
        self.assertAlmostEqual(number(run.labels(FOUND)[0]), 0.5, delta=0.001)

    def test_detection_is_cancelled_and_not_closed(self):
        """While the filter runs the window stays open, layers stay, and Esc leaves the list and the tree as they were."""
        before = facts_of(self.tree)
        run = self.gui(f"""
            {self.start(self.tree)}
            trigger Fit Primitives
            trigger Detect Primitives
            set Label the points = on
            set In place = on
            press Apply
            wait-building
            quit
            pause 300
            escape
            press OK
            expect-message Cancelled
            press Close
            print-layers
            print-log
            trigger Fit Primitives
            pause 300
            print-table {LIST}
            """)
        self.assertDriven(run)
        self.assertEqual(run.tables(LIST), [[]])
        self.assertEqual(len(run.layers()), 1)
        self.assertIn("cancelled", run.text)
        self.assertEqual(facts_of(self.tree), before)


if __name__ == "__main__":
    unittest.main()
