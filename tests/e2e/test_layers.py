"""Ordinary layers are drawn as point clouds, and follow their vertices; a sample that was changed does not mislead."""

import unittest

from meshlab import FIXED_VIEW, NO_TIME_LIMIT, MeshLabTest, different, pcmlab


class DrawnCopies(MeshLabTest):
    def cached(self, folder):
        """The trees in the cache of the MeshLab whose folder this is."""
        return sorted((folder / "cache" / "pcm-meshlab").glob("session-*/*.pct"))

    def test_a_small_cloud_is_drawn_like_a_large_one_and_stays_an_ordinary_layer(self):
        las, tree = self.generate("small", 60000, "--seed", 6)
        large, small, screen = (self.result(f"{name}.png") for name in ("large", "small", "screen"))
        saved = self.folder / "saved.las"
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {FIXED_VIEW}
            wait-status complete
            picture {large}
            trigger Delete Current Mesh
            wait-layers 0
            open {las}
            wait-layers 1
            wait-status complete
            picture {small}
            screen {screen}
            print-layers
            export {saved}
            wait-log Wrote 60,000 points of the layer
            """)
        self.assertDriven(run)
        self.assertLess(different(large, small), 0.001)
        self.assertEqual([(layer["vertices"], layer["label"]) for layer in run.layers()], [(60000, "small.las")])
        self.assertEqual(self.cached(self.shared.folder), [], "the temporary tree is left")

    def test_the_picture_follows_the_vertices(self):
        las = self.generate_file("small", 60000, "--seed", 6)
        whole, selected, half, moved = (self.result(f"{name}.png") for name in ("whole", "selected", "half", "moved"))
        run = self.gui(f"""
            wait-view
            open {las}
            wait-layers 1
            {FIXED_VIEW}
            wait-status complete
            print-status
            picture {whole}
            trigger Conditional Vertex Selection
            set boolean function = vi < 30000
            press Apply
            press Close
            wait-status complete
            picture {selected}
            trigger Delete Selected Vertices
            wait-log Deleted 30000 vertices
            wait-status 30000 points of
            wait-status complete
            picture {half}
            print-layers
            move-layer 0 3 0 0
            wait-status complete
            picture {moved}
            trigger Delete Current Mesh
            wait-layers 0
            """)
        self.assertDriven(run)
        self.assertEqual([layer["vertices"] for layer in run.layers()], [30000])
        self.assertGreater(different(whole, selected), 0.05, "the selection is covered by our points")
        self.assertGreater(different(whole, half), 0.05)
        self.assertGreater(different(half, moved), 0.05)
        self.assertEqual(self.cached(self.shared.folder), [])

    def test_the_picture_follows_edit_tools_and_reload(self):
        las = self.generate_file("small", 60000, "--seed", 6)
        whole, one, many, again = (self.result(f"{name}.png") for name in ("whole", "one", "many", "again"))
        run = self.gui(f"""
            wait-view
            open {las}
            wait-layers 1
            {FIXED_VIEW}
            wait-status complete
            picture {whole}
            paint-layer 0 1 13
            pause 1500
            wait-status complete
            picture {one}
            paint-layer 0 0 30000
            pause 1000
            wait-status complete
            picture {many}
            trigger Reload
            wait-layers 1
            wait-status complete
            picture {again}
            """)
        self.assertDriven(run)
        self.assertGreater(different(whole, one), 0)
        self.assertGreater(different(one, many), 0.05)
        self.assertLess(different(whole, again), 0.001)

    def test_a_killed_meshlab_leaves_trees_until_the_next_start(self):
        las = self.generate_file("small", 60000, "--seed", 6)
        # In a MeshLab of its own: it is killed.
        self.own_gui(f"wait-view\nopen {las}\nwait-layers 1\nwait-status complete\nno such command\n")
        self.assertEqual(len(self.cached(self.folder)), 1)  # the driver ended MeshLab without any cleaning up
        self.assertDriven(self.own_gui("wait-view\nquit\n"))
        self.assertEqual(list((self.folder / "cache" / "pcm-meshlab").iterdir()), [])

    def test_one_click_draws_any_layer_of_points(self):
        las = self.generate_file("small", 60000, "--seed", 6)
        run = self.gui(f"""
            wait-view
            {FIXED_VIEW}
            parameter MeshLab::PointCloud::DrawOrdinaryLayersAsPointClouds = 0
            open {las}
            wait-layers 1
            pause 500
            wait-no-status complete
            trigger Show Point Cloud
            wait-status complete
            wait-status 60000 points of
            trigger Show Point Cloud
            wait-no-status complete
            trigger Show Point Cloud
            wait-status complete
            """)
        self.assertDriven(run)


class Samples(MeshLabTest):
    SELECT_AND_DELETE = """
        trigger Conditional Vertex Selection
        set boolean function = {}
        press Apply
        press Close
        trigger Delete Selected Vertices
        wait-log Deleted
        """

    def test_deleted_vertices_of_the_sample_can_be_deleted_from_the_cloud(self):
        _, tree = self.generate("city", 400000, "--seed", 5)
        before, asked, after = (self.result(f"{name}.png") for name in ("before", "asked", "after"))
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {FIXED_VIEW}
            wait-status complete
            picture {before}
            {self.SELECT_AND_DELETE.format("x > 5")}
            pause 500
            screen {asked}
            press Delete the points of the cloud
            wait-log of the 400,000 points of {tree}
            wait-notice none
            wait-status complete
            picture {after}
            print-layers
            """)
        self.assertDriven(run)
        self.assertGreater(different(before, after), 0.05)
        left = pcmlab("info", tree)["points"]
        self.assertGreater(left, 100000)
        self.assertLess(left, 300000)
        self.assertRegex(run.layers()[0]["label"], f"^city \\([0-9,]+ of {left:,}\\)$")

    def test_a_sample_is_restored_or_named_in_red(self):
        _, tree = self.generate("city", 400000, "--seed", 5)
        before, red, restored = (self.result(f"{name}.png") for name in ("before", "red", "restored"))
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {FIXED_VIEW}
            wait-status complete
            picture {before}
            {self.SELECT_AND_DELETE.format("x > 5")}
            press Leave it
            wait-notice vertices were deleted
            screen {red}
            export {self.folder / "out.las"}
            wait-log Wrote 400,000 points
            wait-log Warning: The layer
            trigger Reload
            wait-notice none
            wait-status complete
            {self.SELECT_AND_DELETE.format("x > 5")}
            press Restore the sample
            wait-log is restored
            wait-notice none
            wait-status complete
            picture {restored}
            print-layers
            """)
        self.assertDriven(run)
        self.assertEqual(different(before, restored), 0)
        self.assertEqual(pcmlab("info", tree)["points"], 400000)

    def test_a_rectangle_of_a_turned_view_is_deleted_from_the_cloud(self):
        _, tree = self.generate("city", 400000, "--seed", 5)
        before, after = (self.result(f"{name}.png") for name in ("before", "after"))
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {FIXED_VIEW}
            drag 0.4 0.5 0.6 0.7
            wait-status complete
            picture {before}
            trigger Select Vertices
            press-at 0.4 0.45
            move-to 0.45 0.5
            pause 100
            move-to 0.5 0.6
            pause 200
            release-at 0.5 0.6
            pause 200
            trigger Select Vertices
            trigger Delete Selected Vertices
            wait-log Deleted
            press Delete the points of the cloud
            expect-message a rectangle of this view
            wait-log of the 400,000 points of {tree}
            wait-notice none
            wait-status complete
            picture {after}
            """)
        self.assertDriven(run)
        self.assertGreater(different(before, after), 0.01)
        self.assertLess(pcmlab("info", tree)["points"], 400000)

    def test_a_frozen_matrix_moves_the_cloud(self):
        _, tree = self.generate("city", 400000, "--seed", 5)
        before, moved = (self.result(f"{name}.png") for name in ("before", "moved"))
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {FIXED_VIEW}
            wait-status complete
            print-layers
            picture {before}
            trigger Transform: Translate, Center, set Origin
            set X Axis = 12
            press Apply
            wait-log is the layer's matrix again
            press Close
            wait-notice none
            wait-status complete
            picture {moved}
            print-layers
            """)
        self.assertDriven(run)
        first, second = run.layers()
        self.assertEqual(first["min"], second["min"])
        self.assertEqual(second["matrix"][3], 12)
        self.assertGreater(different(before, moved), 0.1)

    def test_without_a_window_an_export_warns(self):
        _, tree = self.generate("city", 400000, "--seed", 5)
        out = self.folder / "out.las"
        run = self.server([("Conditional Vertex Selection", {"condSelect": ("RichString", "x > 5")}),
                           ("Delete Selected Vertices", {})], "-i", tree, "-o", out)
        self.assertRegex(run.text, "Warning: The layer 'city .*': [0-9,]+ of [0-9,]+ vertices were deleted, but only in")
        self.assertEqual(pcmlab("info", out)["points"], 400000)
        self.assertFalse((self.folder / "cache" / "pcm-meshlab").exists())

    def test_a_project_keeps_names_and_matrices(self):
        _, tree = self.generate("city", 400000, "--seed", 5)
        names = ["roof", "city (16,731 of 400,000)", "city (16,731 of 400,000)"]
        matrix = "1 0 0 5 \n0 1 0 0 \n0 0 1 0 \n0 0 0 1 \n"
        layers = "".join(f'<MLMesh label="{name}" filename="city.pct" visible="1"><MLMatrix44>\n{matrix}</MLMatrix44></MLMesh>'
                         for name in names)
        project = self.folder / "saved.mlp"
        project.write_text(f"<!DOCTYPE MeshLabDocument><MeshLabProject><MeshGroup>{layers}</MeshGroup><RasterGroup/>"
                           "</MeshLabProject>")
        run = self.gui(f"wait-view\nopen-project {project}\nwait-layers 3\nwait-status complete\nwait-status 3 clouds\nprint-layers")
        self.assertDriven(run)
        self.assertEqual([layer["label"] for layer in run.layers()], names)
        self.assertEqual([layer["matrix"][3] for layer in run.layers()], [5, 5, 5])

    def test_closing_a_cloud_gives_its_memory_back(self):
        _, tree = self.generate("large", 6000000, "--seed", 9)
        # In a MeshLab of its own: its memory is measured.
        run = self.own_gui(f"""
            wait-view
            {NO_TIME_LIMIT}
            pause 500
            memory empty
            open {tree}
            wait-layers 1
            wait-status complete
            memory full
            trigger Delete Current Mesh
            wait-layers 0
            pause 500
            memory closed
            quit
            """)
        self.assertDriven(run)
        memory = {name: now for name, (now, _) in run.memory().items()}
        print({name: f"{now / 1e6:.0f} MB" for name, now in memory.items()})
        self.assertGreater(memory["full"] - memory["empty"], 2e8)
        self.assertLess(memory["closed"] - memory["empty"], 0.5 * (memory["full"] - memory["empty"]))


if __name__ == "__main__":
    unittest.main()
