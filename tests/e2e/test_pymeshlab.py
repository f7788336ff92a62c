"""PyMeshLab, without a display: our importers, exporters and filters in the library of MeshLab 2025.07, in double precision."""
import os
import pathlib
import shutil
import sys
import unittest

import pymeshlab_session as session
from pymeshlab_session import BUILD, FILTER, IO, SOURCE, PyMeshLabTest, pcmlab, sample

if __name__ == "__main__" and "--in-pymeshlab" not in sys.argv:
    session.go_on_in_pymeshlab(__file__)

import numpy as np  # noqa: E402
import pymeshlab  # noqa: E402
from pymeshlab import PyMeshLabException  # noqa: E402

sys.path.insert(0, str(SOURCE / "tests" / "independent"))
import compare  # noqa: E402

DUMP = str(BUILD / "bin" / "dump_cloud")

# One cloud a format: what it is saved as, and whether that file has all that the first one has.
ONE_A_FORMAT = {
    "las/certainty3d-color-utm-feet-navd88.las": "las", "crossformat/ripple.laz": "laz", "ply/csf_sample_double.ply": "ply",
    "ply/text_extradim.ply": "ply", "pcd/milk_color.pcd": "pcd", "pcd/autzen-utm.pcd": "pcd", "pts/bunnyData.pts": "pts",
    "e57/bunnyDouble.e57": "pcd", "crossformat/ripple.txt": "txt", "xyz/sphere_20k_normal.xyz": "xyz",
    "ptx/1.2-with-color.ptx": "pcd", "las/pdrf10-1.4.laz": "pcd",
}


class Files(PyMeshLabTest):
    def test_one_cloud_a_format_comes_back_equal(self):
        for name, extension in ONE_A_FORMAT.items():
            with self.subTest(name):
                file = sample(name)
                meshes = pymeshlab.MeshSet()
                meshes.load_new_mesh(str(file))
                source = compare.read_ours(DUMP, str(file))
                self.assertEqual(meshes.current_mesh().vertex_number(), int(np.isfinite(source.positions).all(axis=1).sum()))
                saved = self.folder / f"saved.{extension}"
                # PyMeshLab proposes no normals for PLY.
                meshes.save_current_mesh(str(saved), **({"save_vertex_normal": True} if extension == "ply" else {}))
                again = compare.read_ours(DUMP, str(saved))
                found = [line for line in compare.differences(again, source) if "grid" not in line]
                self.assertEqual(found, [], name)

    def test_coordinates_are_those_of_the_source_whatever_was_opened_before(self):
        near, far = self.generated("near.las", origin="0,0,0"), self.generated("far.las", origin="500000,5700000,300")
        expected = compare.read_ours(DUMP, str(far)).positions
        for order in ([far], [near, far], [far, near]):
            meshes = pymeshlab.MeshSet()
            for file in order:
                meshes.load_new_mesh(str(file))
            meshes.set_current_mesh(order.index(far))
            self.assertTrue((meshes.current_mesh().vertex_matrix() == expected).all())

    def test_a_moved_layer_is_exported_where_it_is(self):
        meshes = pymeshlab.MeshSet()
        file = self.generated()
        meshes.load_new_mesh(str(file))
        meshes.apply_filter("compute_matrix_from_translation", traslmethod="XYZ translation", axisx=0.001, axisy=-2, freeze=False)
        meshes.save_current_mesh("moved.ply")
        shift = compare.read_ours(DUMP, "moved.ply").positions - compare.read_ours(DUMP, str(file)).positions
        self.assertLess(abs(shift - [0.001, -2, 0]).max(), 2e-9)

    def test_meshes_are_meshlab_s(self):
        meshes = pymeshlab.MeshSet()
        meshes.load_new_mesh(str(sample("ply/mesh.ply")))
        self.assertGreater(meshes.current_mesh().face_number(), 0)
        meshes.save_current_mesh("mesh.ply", binary=False)
        again = pymeshlab.MeshSet()
        again.load_new_mesh("mesh.ply")
        self.assertEqual(again.current_mesh().face_number(), meshes.current_mesh().face_number())
        self.assertIn(b"format ascii", pathlib.Path("mesh.ply").read_bytes()[:200])

    def test_layers_of_pymeshlab_are_exported(self):
        points = np.array([[500000.125, 5700000.25, 1], [500001.5, 5700003.75, 2.5], [500002, 5700001, 7]])
        meshes = pymeshlab.MeshSet()
        meshes.add_mesh(pymeshlab.Mesh(points))
        meshes.save_current_mesh("points.pcd")
        self.assertTrue((compare.read_ours(DUMP, "points.pcd").positions == points).all())

    def test_attributes_are_variables_of_meshlab_s_filters(self):
        meshes = pymeshlab.MeshSet()
        file = sample("las/certainty3d-color-utm-feet-navd88.las")
        meshes.load_new_mesh(str(file))
        values = compare.read_ours(DUMP, str(file)).attributes["classification"].values[:, 0]
        self.assertTrue((meshes.current_mesh().vertex_custom_scalar_attribute_array("classification") == values).all())

    def test_a_tree_goes_where_the_caller_says(self):
        file = self.generated()
        meshes = pymeshlab.MeshSet()
        with self.assertRaisesRegex(PyMeshLabException, "has 60,000 points .* tree_folder"):
            meshes.load_new_mesh(str(file), most_points_in_ordinary_layer=1000)
        self.assertEqual(meshes.mesh_number(), 0)
        self.assertEqual(sorted(os.listdir()), ["city.las"])
        os.mkdir("trees")
        meshes.load_new_mesh(str(file), most_points_in_ordinary_layer=1000, tree_folder=str(self.folder / "trees"))
        self.assertEqual(sorted(os.listdir()), ["city.las", "trees"])
        self.assertEqual(len(os.listdir("trees")), 1)
        # MeshLab's sample of it is in source coordinates; its export has all points.
        box, truth = meshes.current_mesh().bounding_box(), compare.read_ours(DUMP, str(file)).positions
        self.assertLess(abs(box.min() - truth.min(axis=0)).max(), 1e-3)
        self.assertLess(abs(box.max() - truth.max(axis=0)).max(), 1e-3)
        meshes.save_current_mesh("all.las")
        self.assertEqual(len(compare.read_ours(DUMP, "all.las").positions), 60000)


class Failures(PyMeshLabTest):
    def test_errors_have_our_text_and_leave_the_folder(self):
        meshes = pymeshlab.MeshSet()
        pathlib.Path("broken.las").write_bytes(b"LASF" + bytes(100))
        with self.assertRaisesRegex(PyMeshLabException, "broken.las: "):
            meshes.load_new_mesh("broken.las")
        self.assertEqual(os.getcwd(), str(self.folder.resolve()))
        with self.assertRaisesRegex(PyMeshLabException, "no tree is given, and there is no current layer"):
            meshes.apply_filter("point_cloud_tree_information")
        with self.assertRaisesRegex(PyMeshLabException, "none.pct"):
            meshes.apply_filter("point_cloud_tree_information", tree="none.pct")
        meshes.load_new_mesh(str(self.generated()))  # all is well afterwards

    def test_nothing_is_printed(self):
        tree, file = self.folder / "city.pct", self.generated()
        text, code = self.alone(f"""
meshes = pymeshlab.MeshSet()
meshes.load_new_mesh('{file}')
meshes.apply_filter('build_point_cloud_tree', inputs='{file}', output='{tree}')
meshes.apply_filter('detect_primitives', least_points=300)
meshes.save_current_mesh('{self.folder}/saved.laz')
try:
    meshes.load_new_mesh('{self.folder}/city.pct/nothing.las')
except pymeshlab.PyMeshLabException: pass
""")
        self.assertEqual((text, code), ("", 0))

    def test_what_is_for_another_meshlab_is_refused_by_name(self):
        file = self.generated()
        for name in ("libio_00_pcm.so", "libpcm_filter.so"):
            other = BUILD / "plugins" / name  # of MeshLab 2020.09
            text, code = self.alone(f"""
try:
    pymeshlab.load_plugin('{other}')
except pymeshlab.PyMeshLabException as error:
    print(error)
pymeshlab.MeshSet().load_new_mesh('{file}')
""")
            self.assertEqual(code, 0, text)
            # One of MeshLab 2022.02 looks first whether its like is there.
            self.assertRegex(text, f"{name}|loaded already")


class Filters(PyMeshLabTest):
    def setUp(self):
        super().setUp()
        self.tree = self.folder / "city.pct"
        self.meshes = pymeshlab.MeshSet()
        self.file = self.generated()
        self.built = self.meshes.apply_filter("build_point_cloud_tree", inputs=str(self.file), output=str(self.tree))

    def test_numbers_are_those_of_the_command(self):
        self.assertEqual(self.built["points"], 60000)
        self.assertGreater(self.built["seconds"], 0)
        self.assertEqual(self.meshes.mesh_number(), 1)
        info, found = pcmlab("info", self.tree), self.meshes.apply_filter("point_cloud_tree_information")
        self.assertEqual(found["points"], info["points"])
        self.assertEqual(found["levels"], info["levels"])
        self.assertEqual(found["bounds_min"].tolist(), info["bounds"]["min"])
        made = self.meshes.apply_filter("voxel_grid_of_point_cloud_tree", voxel_size=2.0, output=str(self.folder / "thin.pct"))
        expected = pcmlab("voxel", self.tree, "-o", self.folder / "thin2.pct", "--size", "2")
        self.assertEqual(made["points"], expected["points"])
        self.assertEqual(pcmlab("info", self.folder / "thin.pct")["points"], made["points"])

    def test_a_script_that_cleans_and_finds_shapes(self):
        cleaned = self.meshes.apply_filter("remove_outliers_of_point_cloud_tree", output="clean.pct")
        self.assertEqual(cleaned["points"], pcmlab("info", "clean.pct")["points"])
        self.meshes.apply_filter("estimate_normals_of_point_cloud_tree", output="normals.pct")
        found = self.meshes.apply_filter("detect_primitives", tree="normals.pct", least_points=300, cylinders=False, spheres=False)
        expected = pcmlab("detect", "normals.pct", "--min-points", "300", "--shape", "plane")
        planes = expected["primitives"]
        self.assertEqual(found["primitives_count"], len(planes))
        self.assertEqual(found["primitives_points"].tolist(), [plane["points"] for plane in planes])
        self.assertEqual(found["primitives_point_x"].tolist(), [plane["point"][0] for plane in planes])
        written = self.meshes.apply_filter("export_primitives", output_file="planes.json")
        self.assertGreater(len(planes), 0)
        self.assertTrue(pathlib.Path("planes.json").exists())
        self.assertIn("seconds", written)

    def test_a_fit_returns_its_shape(self):
        meshes = pymeshlab.MeshSet()
        meshes.load_new_mesh(str(sample("primitives/spheres.ply")))
        meshes.apply_filter("build_point_cloud_tree", inputs=str(sample("primitives/spheres.ply")), output="spheres.pct")
        truth = pcmlab("detect", "spheres.pct", "--shape", "sphere")["primitives"][0]
        place = np.array(truth["point"]) + [0, 0, truth["radius"]]
        fitted = meshes.apply_filter("fit_primitive", places=" ".join(map(repr, place.tolist())), shape="Sphere")
        self.assertAlmostEqual(fitted["primitive_radius"], truth["radius"], delta=1e-9)
        self.assertLess(abs(fitted["primitive_point"] - truth["point"]).max(), 1e-9)
        self.assertGreaterEqual(fitted["primitive_points"], truth["points"])

    def test_what_was_opened_is_forgotten(self):
        """50 sets of layers, with a tree and a cloud each: a constant number of open files, and no memory."""
        def rss():
            return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")

        files, memory = [], []
        for _ in range(50):
            meshes = pymeshlab.MeshSet()
            meshes.load_new_mesh(str(self.tree))
            meshes.load_new_mesh(str(self.file))
            meshes.apply_filter("point_cloud_tree_information", tree=str(self.tree))
            del meshes
            files.append(len(os.listdir("/proc/self/fd")))
            memory.append(rss())
        self.assertEqual(len(set(files[2:])), 1, files)
        self.assertLess(memory[-1] - memory[10], 16 << 20, memory)

    def test_a_set_that_is_emptied_and_filled_again(self):
        self.meshes.clear()  # MeshLab gives the same numbers to layers again, and says nothing
        self.meshes.load_new_mesh(str(sample("ply/mesh.ply")))
        with self.assertRaisesRegex(PyMeshLabException, "does not show one"):
            self.meshes.apply_filter("point_cloud_tree_information")
        self.meshes.load_new_mesh(str(self.tree))
        self.assertEqual(self.meshes.apply_filter("point_cloud_tree_information")["points"], 60000)


if __name__ == "__main__":
    sys.argv.remove("--in-pymeshlab")
    pymeshlab.load_plugin(str(IO))
    pymeshlab.load_plugin(str(FILTER))
    unittest.main(verbosity=2)
