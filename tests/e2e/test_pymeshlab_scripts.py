"""Six scripts in Python for what was done by scripts of meshlabserver: their results are those of the command, to the byte."""
import csv
import pathlib
import sys
import unittest

import pymeshlab_session as session
from pymeshlab_session import FILTER, IO, PyMeshLabTest, pcmlab

if __name__ == "__main__" and "--in-pymeshlab" not in sys.argv:
    session.go_on_in_pymeshlab(__file__)

import pymeshlab  # noqa: E402

ORIGIN = "500000,4800000,90"
BOX = "500010 4800010 80 500045 4800045 130"


def contents(path):
    """The bytes of a file, or of all files of a tree by name."""
    path = pathlib.Path(path)
    if path.is_file():
        return path.read_bytes()
    return {str(file.relative_to(path)): file.read_bytes() for file in sorted(path.rglob("*")) if file.is_file()}


def shapes(path):
    """The rows of a table of shapes, without the colours, which a list chooses by kind."""
    return [dict(row, colour="") for row in csv.DictReader(pathlib.Path(path).open(encoding="utf-8"))]


class Scripts(PyMeshLabTest):
    def setUp(self):
        super().setUp()
        self.scan = self.generated("scan.las", 100000, ORIGIN)
        pcmlab("build", self.scan, "-o", "site.pct")
        self.meshes = pymeshlab.MeshSet()

    def assertSame(self, ours, expected):
        self.assertTrue(contents(ours) == contents(expected), f"{ours} and {expected} differ")

    def test_1_build_and_ask(self):
        built = self.meshes.apply_filter("build_point_cloud_tree", inputs="scan.las", output="built.pct", memory_mb=512)
        self.assertSame("built.pct", "site.pct")
        info = self.meshes.apply_filter("point_cloud_tree_information", statistics=True)
        self.assertEqual((built["points"], info["points"]), (100000, 100000))

    def test_2_query_a_part_and_save_it(self):
        self.meshes.load_new_mesh("site.pct")
        self.meshes.apply_filter("select_points_of_point_cloud_tree", box=BOX, where="intensity>=100")
        self.meshes.apply_filter("selected_points_extract", output="part.pct")
        pcmlab("select", "site.pct", "--box", *BOX.split(), "--where", "intensity>=100", "--extract", "expected.pct")
        self.assertSame("part.pct", "expected.pct")
        self.meshes.save_current_mesh("part.laz")
        pcmlab("convert", "expected.pct", "expected.laz")
        self.assertSame("part.laz", "expected.laz")

    def test_3_clean_and_thin(self):
        self.meshes.load_new_mesh("site.pct")
        self.meshes.apply_filter("remove_outliers_of_point_cloud_tree", method="Robust", output="clean.pct")
        self.meshes.apply_filter("subsample_point_cloud_tree", spacing=0.5, output="thin.pct")
        self.meshes.apply_filter("estimate_normals_of_point_cloud_tree", output="normals.pct")
        pcmlab("outliers", "site.pct", "-o", "clean2.pct", "--method", "robust")
        pcmlab("subsample", "clean2.pct", "-o", "thin2.pct", "--spacing", "0.5")
        pcmlab("normals", "thin2.pct", "-o", "normals2.pct", "--radii")
        for name in ("clean", "thin", "normals"):
            self.assertSame(f"{name}.pct", f"{name}2.pct")

    def test_4_fit_and_name(self):
        self.meshes.load_new_mesh("site.pct")
        place = "500042.95 4800020 96"
        fitted = self.meshes.apply_filter("fit_primitive", places=place, name="Tank")
        self.meshes.apply_filter("export_primitives", output_file="tank.csv")
        tree = self.folder / "site.pct"
        expected = pcmlab("fit", tree, "--at", *place.split(), "--name", "Tank", "--add", "expected.json")["primitive"]
        pcmlab("primitives", "expected.json", "-o", "expected.csv")
        self.assertEqual((fitted["primitive_radius"], fitted["primitive_points"]), (expected["radius"], expected["points"]))
        self.assertEqual(fitted["primitive_point"].tolist(), expected["point"])
        self.assertSame("tank.csv", "expected.csv")

    def test_5_detect(self):
        self.meshes.load_new_mesh("site.pct")
        found = self.meshes.apply_filter("detect_primitives", least_points=400)
        expected = pcmlab("detect", self.folder / "site.pct", "--min-points", "400", "--out", "expected.csv")["primitives"]
        self.assertGreater(len(expected), 2)
        self.assertEqual(found["primitives_points"].tolist(), [shape["points"] for shape in expected])
        self.meshes.apply_filter("export_primitives", output_file="shapes.csv")
        self.assertEqual(shapes("shapes.csv"), shapes("expected.csv"))

    def test_6_export(self):
        self.meshes.load_new_mesh("site.pct")
        for extension in ("las", "laz", "ply", "pcd", "pts"):
            self.meshes.save_current_mesh(f"all.{extension}")
            pcmlab("convert", "site.pct", f"expected.{extension}")
            self.assertSame(f"all.{extension}", f"expected.{extension}")
        self.meshes.apply_filter("fit_primitive", places="500042.95 4800020 96", name="Tank")
        self.meshes.apply_filter("export_primitives", output_file="tank.dxf", unit="Metres")
        self.meshes.apply_filter("export_primitives", output_file="tank.json")
        pcmlab("primitives", "tank.json", "-o", "expected.dxf", "--unit", "m")
        self.assertSame("tank.dxf", "expected.dxf")


if __name__ == "__main__":
    sys.argv.remove("--in-pymeshlab")
    pymeshlab.load_plugin(str(IO))
    pymeshlab.load_plugin(str(FILTER))
    unittest.main(verbosity=2)
