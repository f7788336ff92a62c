"""Import and export of every format in MeshLab: as a layer or through a tree, with all points and digits."""

import csv

import pathlib
import shutil

import subprocess
import unittest

from meshlab import FIXED_VIEW, PCMLAB, SAMPLES, MeshLabTest, different, pcmlab, sample

# One cloud per format, and one at map coordinates (LAS, 6.3 million feet east).
ONE_A_FORMAT = {
    "las": "las/certainty3d-color-utm-feet-navd88.las", "laz": "las/autzen_trim.laz", "ply": "ply/screwdriver_BE.ply",
    "pcd": "pcd/milk_color.pcd", "pts": "pts/bunnyData.pts", "ptx": "ptx/1.2-with-color.ptx",
    "xyz": "xyz/sphere_20k_normal.xyz", "txt": "crossformat/ripple.txt", "e57": "e57/bunnyDouble.e57",
}
TEXT = ("xyz", "txt", "asc", "csv")


def in_manifest(name):
    """Number of points, minimum and maximum of a sample, as found by an independent reader."""
    with open(SAMPLES / "MANIFEST.csv", newline="") as file:
        row = next(row for row in csv.DictReader(file) if row["file"] == name)
    box = [float(number) for number in row["bbox"].split()]
    return int(row["points"]), box[:3], box[3:]


def reads(file):
    """Whether this build can read a file: LAZ and E57 are optional."""
    done = subprocess.run([str(PCMLAB), "build", str(file), "-o", "/dev/null/none.pct"], capture_output=True, text=True)
    return not any(word in done.stderr for word in ("readable are", "was built without"))


def source_box(run, layer):
    """The box of a layer in source coordinates: MeshLab's box plus the origin in the log."""
    origin = [0.0, 0.0, 0.0]
    for line in run.text.splitlines():
        if "minus the document's origin" in line:
            origin = [float(n) for n in line.split("origin")[1].strip().rstrip(".").split()]
    return ([m + o for m, o in zip(layer["min"], origin)], [m + o for m, o in zip(layer["max"], origin)])


class Formats(MeshLabTest):
    def assertOpened(self, run, layer, name):
        points, smallest, largest = in_manifest(name)
        self.assertEqual(layer["vertices"], points, name)
        for found, expected in zip(source_box(run, layer), (smallest, largest)):
            for a, b in zip(found, expected):
                # The manifest has five to nine digits; MeshLab's float has seven of the local coordinate.
                self.assertAlmostEqual(a, b, delta=max(1e-3, 1e-5 * abs(b)) if name.endswith("ptx") else
                                       max(5.1e-3 if abs(b) > 1000 else 1e-4, 1e-7 * abs(b)), msg=name)

    def test_one_cloud_a_format(self):
        empty = self.result("empty.png")
        for extension, name in ONE_A_FORMAT.items():
            with self.subTest(extension):
                file = sample(name)
                if not reads(file):
                    self.skipTest(f"this build does not read {extension}")
                picture = self.result(f"{extension}.png")
                answer = "press OK" if extension in TEXT else ""
                run = self.gui(f"""
                    wait-view
                    {FIXED_VIEW}
                    picture {empty}
                    open {file}
                    {answer}
                    wait-layers 1
                    wait-log Opened mesh
                    expect-no-dialog
                    pause 300
                    picture {picture}
                    print-layers
                    """)
                self.assertDriven(run)
                self.assertEqual(len(run.layers()), 1)
                self.assertOpened(run, run.layers()[0], name)
                self.assertGreater(different(empty, picture), 0.005, "nothing is to be seen")

    def test_size_of_a_layer_and_folder_for_trees(self):
        """A file with fewer and with more points than the user's limit; the tree in the folder that the user has set."""
        las = self.folder / "cloud.las"
        pcmlab("generate", "--points", 30000, "--origin", "500000,4800000,100", "--no-truth", las)
        trees = self.folder / "my trees"
        trees.mkdir()
        run = self.gui(f"""
            wait-view
            {FIXED_VIEW}
            open {las}
            wait-layers 1
            wait-log 30,000 points, LAS
            print-layers
            parameter MeshLab::PointCloud::MostPointsInOrdinaryLayer = 29999
            open {las}
            wait-layers 2
            wait-log Built {self.folder / "cloud.pct"}
            wait-status complete
            parameter MeshLab::PointCloud::TreeFolder = {trees}
            open {las}
            wait-layers 3
            wait-log Built {trees}
            parameter MeshLab::PointCloud::TreeFolder = {self.folder / "none"}
            open {las}
            press OK
            expect-message none
            expect-message folder for trees does not exist
            wait-layers 3
            """)
        self.assertDriven(run)
        layer = run.layers()[0]
        self.assertEqual(layer["vertices"], 30000)
        self.assertIn("classification", layer["attributes"])
        self.assertEqual(pcmlab("info", self.folder / "cloud.pct")["points"], 30000)
        moved, = trees.glob("cloud-*.pct")
        self.assertEqual(pcmlab("info", moved)["points"], 30000)

    def test_text_layout_is_asked_for(self):
        """The dialog sets columns that cannot be detected."""
        text = self.folder / "columns.xyz"
        text.write_text("".join(f"{i % 7} {100 + i} {200 + i % 5} {i % 3}\n" for i in range(500)))
        if not reads(text):
            self.skipTest("this build reads no text")
        run = self.gui(f"""
            wait-view
            open {text}
            set Columns = - x y z
            screen {self.result("dialog.png")}
            press OK
            wait-layers 1
            wait-log 500 points
            print-layers
            open {text}
            set Columns = x y
            press OK
            press OK
            expect-message not once
            wait-layers 1
            open {text}
            set Most points in an ordinary layer = 100
            press OK
            wait-layers 2
            wait-log Built {self.folder / "columns.pct"}
            """)
        self.assertDriven(run)
        layer = run.layers()[0]
        self.assertEqual((layer["min"], layer["max"]), ([100, 200, 0], [599, 204, 2]))

    def test_columns_that_are_not_understood(self):
        """The dialog names the columns of a file that is refused without it, and skips a bad line."""
        text = self.folder / "names.csv"
        text.write_text("foo,bar,baz\n10,20,3\n11,oops,4\n12,22,5\n")
        run = self.gui(f"""
            wait-view
            open {text}
            press OK
            press OK
            expect-message not understood
            open {text}
            set Columns = y x z
            set Skip bad lines = on
            press OK
            wait-layers 1
            wait-log 2 points
            wait-log 1 bad line was skipped
            print-layers
            """)
        self.assertDriven(run)
        layer = run.layers()[0]
        self.assertEqual((layer["min"], layer["max"]), ([20, 10, 3], [22, 12, 5]))

    def test_meshes_stay_meshlabs(self):
        """A PLY with faces is opened and saved as a mesh; one with only vertices is a cloud."""
        mesh = self.folder / "mesh.ply"
        mesh.write_text("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                        "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
        cloud = self.folder / "far.ply"
        cloud.write_text("ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\n"
                         "property double z\nproperty uchar class\nend_header\n"
                         "5000000.125 4800000.001 1 7\n5000001.25 4800000.002 2 9\n")
        written, back = self.folder / "written.ply", self.folder / "back.xyz"
        run = self.gui(f"""
            wait-view
            open {mesh}
            wait-layers 1
            print-layers
            export {written}
            wait-log Saved Mesh
            open {cloud}
            wait-layers 2
            wait-log 2 points, PLY
            export {back}
            wait-log 2 points of the layer
            """)
        self.assertDriven(run)
        self.assertEqual((run.layers()[0]["vertices"], run.layers()[0]["faces"]), (3, 1))
        self.assertIn(b"element face 1", written.read_bytes())
        # All digits are kept, although MeshLab's positions are float.
        self.assertIn("5000000.125 4800000.001 1 7", back.read_text())

    def test_any_file_of_a_tree_opens_it(self):
        """A data file holds a part of the cloud: picked in the tree's folder it opens the tree, on its own it is a cloud."""
        las = self.generate_file("cloud", 150000, "--origin", "500000,4800000,100")
        more = self.generate_file("more", 50000, "--origin", "500000,4800000,100", "--seed", 2)
        tree, loose = self.folder / "cloud.pct", self.folder / "loose.bpc"
        pcmlab("build", las, "-o", tree, "--chunk-points", 1000)
        pcmlab("append", tree, more)
        shutil.copy(tree / "chunks-000.bpc", loose)
        part = pcmlab("info", loose, "--scan")["scanned"]["points"]
        self.assertEqual(part, 150000)
        run = self.gui(f"""
            wait-view
            open {tree / "chunks-000.bpc"}
            wait-layers 1
            wait-log 200,000 points in {tree}
            open {tree / "about.pct"}
            wait-layers 2
            open {tree / "chunks-001.bpc"}
            wait-layers 3
            expect-no-dialog
            open {loose}
            wait-layers 4
            wait-log {part:,} points, BPC
            expect-no-dialog
            print-layers
            """)
        self.assertDriven(run)
        trees = run.layers()[:3]
        self.assertEqual([layer["label"] for layer in trees],
                         [f"cloud ({layer['vertices']:,} of 200,000)" for layer in trees])
        self.assertEqual(run.layers()[3]["vertices"], part)

    def test_bad_files_leave_meshlab_usable(self):
        good = self.folder / "good.las"
        pcmlab("generate", "--points", 1000, "--no-truth", good)
        names = ("bad/missingheader.pcd", "bad/broken_size.laz", "bad/1.2-no-points.las", "bad/bad-crc.e57",
                 "bad/ripple_declares_44M_points.ptx")
        lines = ""
        for name in filter(lambda name: reads(sample(name)), names):
            file = self.folder / pathlib.Path(name).name
            shutil.copy(sample(name), file)
            lines += f"open {file}\npress OK\nexpect-message {file.name}\nwait-layers 0\nexpect-no-dialog\n"
        run = self.gui(f"wait-view\n{lines}\nopen {good}\nwait-layers 1\nwait-log 1,000 points")
        self.assertDriven(run)


class Export(MeshLabTest):
    def tree_of(self, file):
        """What pcmlab reports about the tree of a file."""
        tree = self.folder / f"{pathlib.Path(file).name}.check.pct"
        pcmlab("build", file, "-o", tree)
        return pcmlab("info", tree)

    def test_a_tree_is_written_whole(self):
        """A tree is exported completely and in source coordinates, not its proxy of 50,000 points; also as PLY, which MeshLab writes itself."""
        las, tree = self.generate("large", 200000, "--origin", "500000,4800000,100")
        truth = pcmlab("info", tree)
        ply, bpc, level, old, floats = (self.folder / name for name in ("out.ply", "out.bpc", "level.ply", "old.las", "floats.pcd"))
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            wait-status complete
            export {ply}
            wait-log 200,000 points of the tree
            export {bpc}
            wait-log to {bpc}
            export-asking {level}
            set Level = 0
            screen {self.result("dialog.png")}
            press OK
            wait-log to {level}
            export-asking {old}
            set LAS version = 1.1
            press OK
            wait-log to {old}
            export-asking {floats}
            set Float positions = on
            press OK
            wait-log to {floats}
            """)
        self.assertDriven(run)
        self.assertEqual(old.read_bytes()[24:26], b"\1\1")
        self.assertTrue(b"\nSIZE 4 4 4" in floats.read_bytes().partition(b"\nDATA")[0])
        for file in (ply, bpc, old, floats):
            found = self.tree_of(file)
            self.assertEqual(found["points"], 200000)
            self.assertEqual(found["bounds"], truth["bounds"])
            self.assertEqual([a["name"] for a in found["attributes"]], [a["name"] for a in truth["attributes"]])
        self.assertEqual(self.tree_of(level)["points"], truth["level"][0]["points"])

    def test_meshlabserver(self):
        """Import and export without a window: a tree, a file that becomes a layer, and an error."""
        las, tree = self.generate("cloud", 60000, "--origin", "500000,4800000,100")
        truth = pcmlab("info", tree)
        for given in (tree, las):
            written = [self.folder / f"{given.suffix[1:]}.{extension}" for extension in ("las", "ply", "pcd", "xyz")]
            run = self.server([], "-i", given, *(argument for out in written for argument in ("-o", out)))
            self.assertEqual(run.code, 0, run.text)
            self.assertEqual(run.text.count("60,000 points of the"), len(written), run.text)
            for out in written:
                found = self.tree_of(out)
                self.assertEqual((found["points"], found["bounds"]), (60000, truth["bounds"]), out)
                if out.suffix != ".las":  # it adds the fields that every record has
                    self.assertEqual(sorted(a["name"] for a in found["attributes"]),
                                     sorted(a["name"] for a in truth["attributes"]), out)
        broken = self.folder / "broken.las"
        broken.write_bytes(las.read_bytes()[:100000])
        run = self.server([], "-i", broken, "-o", self.folder / "none.ply")
        self.assertNotEqual(run.code, 0, run.text)
        self.assertIn("broken.las", run.text)
        self.assertIn("100000", run.text)
        self.assertFalse((self.folder / "none.ply").exists())

    def test_escape_cancels(self):
        _, tree = self.generate("large", 3000000)
        out = self.folder / "out.xyz"
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            wait-status complete
            export {out}
            wait-building
            escape
            press OK
            expect-message cancelled
            expect-no-dialog
            """)
        self.assertDriven(run)
        self.assertEqual(list(self.folder.glob("out*")), [])


if __name__ == "__main__":
    unittest.main()
