"""meshlabserver: scripts build trees and print their information, without a window."""

import subprocess
import unittest

from meshlab import BUILD, SOURCE, MeshLabTest, needs_server, pcmlab


def setUpModule():
    needs_server()


def build(inputs, output="", memory=256, threads=2, chunk=20000, overwrite=False, opened=False, fast=False, largest=0,
          ignore_crs=False):
    return ("Build Point Cloud Tree", {
        "Inputs": ("RichString", inputs), "Output": ("RichString", output), "MemoryMB": ("RichInt", memory),
        "LargestCoordinate": ("RichFloat", largest), "Threads": ("RichInt", threads), "ChunkPoints": ("RichInt", chunk),
        "Overwrite": ("RichBool", "true" if overwrite else "false"), "Fast": ("RichBool", "true" if fast else "false"),
        "Open": ("RichBool", "true" if opened else "false"),
        "IgnoreCrs": ("RichBool", "true" if ignore_crs else "false"),
        "SkipBadLines": ("RichBool", "false"), "SkipBadFiles": ("RichBool", "false")})


def information(tree=""):
    return ("Point Cloud Tree Information", {"Tree": ("RichString", tree)})


class Server(MeshLabTest):
    def setUp(self):
        super().setUp()
        self.las = self.folder / "a b.las"  # a space in the name
        pcmlab("generate", "--points", 120000, "--seed", 3, "--origin", "5000000,4800000,100", "--no-truth", self.las)

    def test_builds_and_informs(self):
        tree = self.folder / "out.pct"
        run = self.server([build(self.las, tree), information(tree)])
        self.assertEqual(run.code, 0, run.text)
        self.assertIn("120,000 points", run.text)
        info = pcmlab("info", tree)
        self.assertEqual(info["points"], 120000)
        for corner in ("min", "max"):
            for value in info["bounds"][corner]:
                # Source coordinates with all digits.
                self.assertIn(repr(value).removesuffix(".0"), run.text)
        self.assertEqual(pcmlab("verify", tree)["faults"], [])

    def test_fast_levels(self):
        for fast, sampling in ((False, "levels      Poisson disks"), (True, "levels      sampled on a grid")):
            with self.subTest(fast):
                tree = self.folder / f"fast {fast}.pct"
                run = self.server([build(self.las, tree, fast=fast), information(tree)])
                self.assertEqual(run.code, 0, run.text)
                self.assertIn(sampling, run.text)
                self.assertEqual(pcmlab("verify", tree)["faults"], [])

    def test_default_output_and_layer(self):
        # No layer at first: the first filter adds one, which the second filter uses.
        run = self.server([build(self.las, opened=True), information()])
        self.assertEqual(run.code, 0, run.text)
        self.assertEqual(pcmlab("info", self.folder / "a b.pct")["points"], 120000)

    def test_opens_trees_and_las(self):
        pcmlab("build", self.las, "-o", self.folder / "t.pct")
        for name in ("t.pct", "t.pct/index.pct", "t.pct/chunks-000.bpc", "t.pct/about.pct", "a b.las"):
            with self.subTest(name):
                run = self.server([information(self.folder / "t.pct")], "-i", self.folder / name)
                self.assertEqual(run.code, 0, run.text)
                if name.startswith("t.pct"):
                    self.assertIn(f"120,000 points in {self.folder / 't.pct'}", run.text)

    def test_writes_nothing_into_a_tree(self):
        tree = self.folder / "t.pct"
        pcmlab("build", self.las, "-o", tree)
        before = {file.name: file.read_bytes() for file in tree.iterdir()}
        self.assertRefused([build(self.las, tree / "index.pct", overwrite=True)], "did you mean the tree")
        self.assertRefused([build(self.las, tree / "new.pct")], "inside the folder")
        for name in ("chunks-000.bpc", "new.ply"):
            run = self.server([], "-i", tree, "-o", tree / name)
            self.assertIn("point cloud tree", run.text)
            self.assertIn("outside the tree", run.text)
        self.assertEqual({file.name: file.read_bytes() for file in tree.iterdir()}, before)

    def assertRefused(self, filters, *words):
        run = self.server(filters)
        self.assertNotEqual(run.code, 0, run.text)
        for word in words:
            self.assertIn(word, run.text)

    def test_refuses_with_path_and_reason(self):
        self.assertRefused([build(self.folder / "none.las")], "none.las", "no such file")
        self.assertRefused([build("")], "'Input files' is needed")
        self.assertRefused([information(self.folder / "none.pct")], "none.pct")
        self.assertRefused([build(self.las, memory=1)], "at least 64 MiB of memory")
        broken = self.folder / "broken.las"
        broken.write_bytes(self.las.read_bytes()[:100000])
        self.assertRefused([build(broken)], "broken.las", "100000")
        # The failed builds left no files.
        self.assertFalse(list(self.folder.glob("*.pct*")))

    def test_leaves_out_no_data_values_when_asked(self):
        text = self.folder / "far.xyz"
        text.write_text("".join(f"{i % 40}.5 {i // 40}.25 7.125\n" for i in range(1600)) + "1 2 3.4e38\n")
        tree = self.folder / "far.pct"
        self.assertRefused([build(text, tree)], "1 of 1,601 points", "3.4e+38", "Largest coordinate")
        self.assertFalse(tree.exists())
        run = self.server([build(text, tree, largest=1000)])
        self.assertEqual(run.code, 0, run.text)
        self.assertIn("1 point with a coordinate beyond 1000 was left out", run.text)
        self.assertEqual(pcmlab("info", tree)["points"], 1600)

    def test_refuses_to_overwrite(self):
        pcmlab("build", self.las, "-o", self.folder / "t.pct")
        self.assertRefused([build(self.las, self.folder / "t.pct")], "t.pct")
        run = self.server([build(self.las, self.folder / "t.pct", overwrite=True)])
        self.assertEqual(run.code, 0, run.text)

    def test_a_private_meshlab_has_all_plugins_each_time(self):
        prefix = self.folder / "prefix"
        ours = {path.name for path in (BUILD / "plugins").glob("*.so")}
        listings = set()
        for _ in range(20):
            subprocess.run([SOURCE / "packaging" / "meshlab-prefix", BUILD, prefix], check=True, capture_output=True, timeout=60)
            listings.add(frozenset(path.name for path in prefix.glob("lib/*/meshlab/plugins/*.so")))
            old = next(prefix.glob("lib/*/meshlab/plugins")) / "libpcm_old.so"
            old.symlink_to(prefix / "nothing")
        self.assertEqual(len(listings), 1)
        listing = listings.pop()
        self.assertLessEqual(ours, listing)
        self.assertIn("libfilter_select.so", listing)
        self.assertNotIn("libpcm_old.so", listing, "a plugin that is no more")


if __name__ == "__main__":
    unittest.main()
