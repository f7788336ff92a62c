"""The command on trees behind addresses: over TLS, in a bucket with signed requests, with round trips of 60 ms, and while a tree is replaced."""

import pathlib
import shutil
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from command_case import SECRET, CommandCase
from range_server import RangeServer, certificate_for


class Addresses(CommandCase):
    def test_a_copy_has_every_point(self):
        copy = self.folder / "copy.pct"
        with RangeServer(self.folder) as server:
            report = self.answer("convert", server.address("site.pct"), "-o", copy)
            here, there = self.answer("info", self.tree), self.answer("info", server.address("site.pct/index.pct"))
        self.assertEqual(report["points_out"] if "points_out" in report else report["points"], 3000000)
        self.assertEqual(self.answer("verify", copy)["faults"], [])
        self.assertEqual(there["requests"], 2)
        self.assertEqual(here["requests"], 0)
        size = sum(file.stat().st_size for file in self.tree.iterdir())
        self.assertLess(report["bytes_received"], 1.2 * size)

    def test_tls_is_checked(self):
        certificate = certificate_for(self.folder)
        with RangeServer(self.folder, certificate=certificate) as server:
            self.assertEqual(self.answer("info", server.address("site.pct"), SSL_CERT_FILE=f"{certificate}.crt")["points"], 3000000)
            run = self.run_command("info", server.address("site.pct"))
            self.assertEqual(run.returncode, 1)
            self.assertIn("certificate", run.stderr)

    def test_a_bucket_is_read_with_signed_requests_and_no_key_is_shown(self):
        keys = {"AWS_ACCESS_KEY_ID": "AKIDEXAMPLE", "AWS_SECRET_ACCESS_KEY": SECRET}
        (self.folder / "scans" / "2026").mkdir(parents=True)
        shutil.copytree(self.tree, self.folder / "scans" / "2026" / "a site.pct")
        address = "s3://scans/2026/a site.pct"
        with RangeServer(self.folder, keys={"AKIDEXAMPLE": SECRET}, region="eu-central-1") as server:
            place = {"AWS_ENDPOINT_URL": server.address().rstrip("/"), "AWS_REGION": "eu-central-1"}
            for more in ({}, {"AWS_SESSION_TOKEN": "a+token/="}):
                self.assertEqual(self.answer("verify", address, **place, **keys, **more)["faults"], [])
            self.assertEqual(server.refusals, [])
            for wrong in ({**keys, "AWS_SECRET_ACCESS_KEY": SECRET + "x"}, {}):
                run = self.run_command("info", address, **{**place, **wrong})
                self.assertEqual(run.returncode, 1)
                self.assertIn("403", run.stderr)
                self.assertNotIn(SECRET, run.stderr + run.stdout)
            self.assertEqual(set(server.refusals), {"a wrong signature", "no signature"})

    def test_secrets_in_an_address_are_refused_and_not_repeated(self):
        for address in ("https://me:hidden@127.0.0.1/site.pct", "https://127.0.0.1/site.pct?key=hidden"):
            run = self.run_command("info", address)
            self.assertEqual(run.returncode, 1)
            self.assertNotIn("hidden", run.stderr + run.stdout)

    def test_few_requests_over_a_slow_network(self):
        with RangeServer(self.folder, delay=0.06) as server:
            report = self.answer("query", server.address("site.pct"), "--count")
            self.assertEqual(report["points"], 3000000)
            # Most of the tree, in requests that grow to 8 MiB.
            size = sum(file.stat().st_size for file in self.tree.iterdir())
            self.assertLess(len(server.requests), 8 + size / (4 << 20))

    def test_a_first_view_of_1_6_million_points_takes_few_requests(self):
        view = ["-o", self.folder / "view.png", "--overwrite", "--size", "320x240", "--converge", "1", "--until", "target", "--target-px", "0.1",
                "--point-budget", "1600000"]
        tried = self.run_command("render", self.tree, "-o", self.folder / "tried.png", "--size", "16x16", "--until", "target", "--point-budget", "10000")
        if tried.returncode != 0 and "OpenGL" in tried.stderr:
            self.skipTest(tried.stderr)
        with RangeServer(self.folder, delay=0.06) as server:
            picture = self.answer("render", server.address("site.pct"), *view)["pictures"][0]
            self.assertGreater(picture["points_drawn"], 1500000)
            # The index, the end of the last data file, and the front in requests that grow.
            self.assertLessEqual(len(server.requests), 8)

    def test_blocks_that_are_kept_serve_again_and_without_the_server(self):
        kept = self.folder / "kept"
        variables = {"PCM_NETWORK_CACHE": "1G", "PCM_NETWORK_CACHE_FOLDER": kept}
        box = ["--box", *"500000 4800000 0 500020 4800020 200".split(), "--count"]
        server = RangeServer(self.folder)
        address = server.address("site.pct")
        first, again = (self.answer("query", address, *box, **variables) for _ in range(2))
        server.stop()
        offline = self.answer("query", address, *box, **variables)
        self.assertEqual(len({report["points"] for report in (first, again, offline)}), 1)
        self.assertEqual(again["bytes_received"], 0)
        run = self.run_command("verify", address, **variables)
        self.assertEqual(run.returncode, 1)
        self.assertIn("cannot be reached", run.stdout + run.stderr)

    def test_a_tree_that_is_replaced_is_never_mixed_with_the_old_one(self):
        served = self.folder / "served"
        served.mkdir()
        shutil.copytree(self.tree, served / "site.pct")
        other = self.made("other.pct", "3000000", "--seed", "2")
        with RangeServer(served) as server:
            address = server.address("site.pct")
            # As an upload goes: the data first, the index last.
            for name in ("chunks-000.bpc", "index.pct"):
                shutil.copyfile(other / name, served / "site.pct" / name)
                run = self.run_command("verify", address)
                if name != "index.pct":
                    self.assertEqual(run.returncode, 1)
                    self.assertIn("not those of the index", run.stderr)
                else:
                    self.assertEqual(run.returncode, 0, run.stderr)

    def test_operations_take_an_address_where_they_take_a_tree(self):
        tree = self.made("small.pct", "100000")
        with RangeServer(self.folder) as server:
            address = server.address("small.pct")
            for name, command in {"normals": ["normals", "TREE", "-o", "OUT.pct"], "radii": ["radii", "TREE", "-o", "OUT.pct"],
                                  "thin": ["subsample", "TREE", "-o", "OUT.pct", "--spacing", "0.5"], "merged": ["merge", "TREE", "TREE", "-o", "OUT.pct"],
                                  "moved": ["transform", "TREE", "-o", "OUT.pct", "--translate", "1", "2", "3"]}.items():
                made = []
                for place, of in (("here", tree), ("there", address)):
                    out = self.folder / f"{name}-{place}"
                    self.answer(*[str(part).replace("TREE", str(of)).replace("OUT", str(out)) for part in command])
                    made.append(self.answer("verify", f"{out}.pct"))
                self.assertEqual([report["faults"] for report in made], [[], []], name)
                chunks = [[file.read_bytes() for file in sorted((self.folder / f"{name}-{place}.pct").glob("chunks-*"))] for place in ("here", "there")]
                self.assertEqual(*chunks, name)
            for command, words in ((["render", address, address, "-o", self.folder / "x.png"], "named twice"),
                                   (["convert", address, address, "-o", self.folder / "x.pct"], "named more than once"),
                                   (["build", server.address("small.pct.las"), "-o", self.folder / "x2.pct"], "files are not read from addresses")):
                run = self.run_command(*command, "-q")
                self.assertIn(words, run.stdout + run.stderr)

    def test_nothing_is_written_to_an_address(self):
        with RangeServer(self.folder) as server:
            address = server.address("site.pct")
            for command in (["compact", address], ["repair", address], ["append", self.folder / "site.pct.las", "--to", address],
                            ["build", self.folder / "site.pct.las", "-o", address], ["convert", self.tree, "-o", server.address("x.las")]):
                run = self.run_command(*command)
                self.assertNotEqual(run.returncode, 0, command)
            run = self.run_command("compact", address)
            self.assertIn("nothing is written to an address", run.stderr)
        self.assertFalse(list(pathlib.Path().glob("http*")))


if __name__ == "__main__":
    unittest.main()
