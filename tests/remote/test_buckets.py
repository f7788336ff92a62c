"""The command writes trees into a bucket: build, convert, over a tree that is there, and through what goes wrong on the way."""

import pathlib
import random
import shutil
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from command_case import SECRET, CommandCase
from range_server import RangeServer


class Buckets(CommandCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.file = cls.folder / "site.pct.las"

    def setUp(self):
        self.storage = self.folder / "storage"
        (self.storage / "scans").mkdir(parents=True)
        self.server = RangeServer(self.storage, keys={"AKIDEXAMPLE": SECRET})

    def tearDown(self):
        self.server.stop()
        shutil.rmtree(self.storage)

    def run_command(self, *arguments, **variables):
        place = {"AWS_ENDPOINT_URL": self.server.address().rstrip("/"), "AWS_ACCESS_KEY_ID": "AKIDEXAMPLE", "AWS_SECRET_ACCESS_KEY": SECRET}
        return super().run_command(*arguments, **{**place, **variables})

    def files(self, folder):
        return {file.name: file.read_bytes() for file in folder.iterdir() if file.name != "lock"}

    def assert_sent(self, name="site.pct"):
        self.assertEqual(self.files(self.storage / "scans" / name), self.files(self.tree))
        self.assertEqual(self.server.bucket.uploads, {})
        self.assertEqual(list(self.folder.glob("*.upload*")), [])

    def test_a_build_is_sent_and_nothing_stays_here(self):
        report = self.answer("build", self.file, "-o", "s3://scans/2026/site.pct")
        self.assertEqual(report["output"], "s3://scans/2026/site.pct")
        self.assertEqual(self.answer("verify", "s3://scans/2026/site.pct")["faults"], [])
        self.assertEqual(self.answer("info", "s3://scans/2026/site.pct")["points"], 3000000)
        self.assertEqual(list(self.folder.glob("*.upload*")), [])
        self.assertEqual(self.server.refusals, [])
        written = [path for method, path, _ in self.server.requests if method == "PUT"]
        self.assertIn("index.pct", written[-1])
        self.assertEqual([path for path in written if "index.pct" in path], written[-1:])
        parts = [size for method, path, size in self.server.requests if method == "PUT" and "partNumber" in path]
        self.assertGreater(len(parts), 1)

    def test_a_whole_tree_is_sent_as_it_is_and_a_part_of_one_is_built(self):
        report = self.answer("convert", self.tree, "-o", "s3://scans/site.pct/")
        self.assertEqual(report["points_out"] if "points_out" in report else report["points"], 3000000)
        self.assert_sent()
        self.assertTrue((self.tree / "index.pct").is_file())
        self.answer("convert", self.tree, "-o", "s3://scans/part.pct", "--max-points", "100000")
        self.assertLess(self.answer("info", "s3://scans/part.pct")["points"], 100001)
        self.assertEqual(list(self.folder.glob("*.upload*")), [])

    def test_what_is_there_is_replaced_only_when_that_is_asked_for(self):
        self.answer("convert", self.tree, "-o", "s3://scans/site.pct", "--max-points", "100000")
        before = self.files(self.storage / "scans" / "site.pct")
        run = self.run_command("build", self.file, "-o", "s3://scans/site.pct")
        self.assertEqual(run.returncode, 1)
        self.assertIn("there is a tree at this address", run.stderr)
        self.assertEqual(self.files(self.storage / "scans" / "site.pct"), before)
        (self.storage / "scans" / "site.pct" / "chunks-001.bpc").write_bytes(b"of a larger tree")
        self.answer("convert", self.tree, "-o", "s3://scans/site.pct", "--overwrite")
        self.assert_sent()

    def test_what_fails_is_sent_again(self):
        chance = random.Random(7)
        # Where the answer to a beginning is lost nobody knows the upload's name, so that it stays.
        self.server.trouble = lambda method, path, query: chance.choice([None, "busy", "cut", None if "uploads" in query else "lost answer", None])
        self.answer("convert", self.tree, "-o", "s3://scans/site.pct")
        self.assert_sent()
        met = []

        def late(method, _, query):
            if method == "POST" and "uploadId" in query and not met:
                met.append(query)
                return "late error"
            return None

        self.server.trouble = late
        self.answer("convert", self.tree, "-o", "s3://scans/again.pct")
        self.assertEqual(len(met), 1)
        self.assert_sent("again.pct")

    def test_an_upload_that_fails_leaves_no_tree_there_and_the_tree_here(self):
        carried_out = self.server.bucket.carry_out
        self.server.bucket.carry_out = lambda method, name, query, body: (
            (403, {}, b"<Error><Code>QuotaExceeded</Code></Error>") if method == "PUT" and name.endswith("index.pct") else carried_out(method, name, query, body))
        run = self.run_command("build", self.file, "-o", "s3://scans/site.pct")
        self.assertEqual(run.returncode, 1)
        self.assertIn("QuotaExceeded", run.stderr)
        self.assertFalse((self.storage / "scans" / "site.pct" / "index.pct").exists())
        kept = self.folder / "site.upload.pct"
        self.assertIn(f"pcmlab convert {kept} -o s3://scans/site.pct", run.stderr)
        self.assertEqual(self.answer("info", kept)["points"], 3000000)
        self.server.bucket.carry_out = carried_out
        self.answer("convert", kept, "-o", "s3://scans/site.pct")
        shutil.rmtree(kept)
        self.assertEqual(self.answer("verify", "s3://scans/site.pct")["faults"], [])

    def test_what_cannot_be_written_is_refused_before_the_build(self):
        for address, text, variables in (("s3://other/site.pct", "no such bucket", {}),
                                         ("https://example.org/site.pct", "nothing is written to an address", {}),
                                         ("s3://scans/site.laz", "only trees are written", {}),
                                         ("s3://scans/site.pct", "AWS_ACCESS_KEY_ID", {"AWS_ACCESS_KEY_ID": "", "AWS_SECRET_ACCESS_KEY": ""}),
                                         ("s3://scans/site.pct", "403", {"AWS_SECRET_ACCESS_KEY": SECRET + "x"})):
            with self.subTest(address=address, **variables):
                run = self.run_command("build", self.file, "-o", address, **variables)
                self.assertEqual(run.returncode, 1)
                self.assertIn(text, run.stderr)
                self.assertNotIn(SECRET, run.stderr)
                self.assertEqual(list(self.folder.glob("*.upload*")), [])


if __name__ == "__main__":
    unittest.main()
