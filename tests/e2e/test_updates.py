"""Filters that change trees: append, delete and compact; layers show the changed tree."""

import shutil
import unittest

from meshlab import BUILD, FIXED_VIEW, MeshLabTest, different, pcmlab


def add(tree, inputs, output="", in_place=False):
    return ("Append to Point Cloud Tree", {
        "Tree": ("RichString", tree), "Inputs": ("RichString", inputs), "Output": ("RichString", output),
        "InPlace": ("RichBool", "true" if in_place else "false"), "IgnoreCrs": ("RichBool", "false"),
        "SkipBadLines": ("RichBool", "false"), "SkipBadFiles": ("RichBool", "false"), "LargestCoordinate": ("RichFloat", 0),
        "MemoryMB": ("RichInt", 256), "Threads": ("RichInt", 2)})


def delete(tree, box="", where="", count=False, output="", in_place=False):
    return ("Delete Points of Point Cloud Tree", {
        "Tree": ("RichString", tree), "Box": ("RichString", box), "Where": ("RichString", where),
        "CountOnly": ("RichBool", "true" if count else "false"), "Output": ("RichString", output),
        "InPlace": ("RichBool", "true" if in_place else "false")})


def compact(tree):
    return ("Compact Point Cloud Tree", {
        "Tree": ("RichString", tree), "MemoryMB": ("RichInt", 256), "Threads": ("RichInt", 2)})


class Updates(MeshLabTest):
    def scenes(self):
        """A tree, and a file of points next to those of the tree: (tree, file)."""
        _, tree = self.generate("first", 60000, "--seed", 3, "--extent", 20, "--origin", "500000,4800000,100")
        las = self.folder / "second.las"
        pcmlab("generate", "--points", 40000, "--seed", 4, "--extent", 20, "--origin", "500020,4800000,100", "--no-truth", las)
        return tree, las

    def assertGood(self, tree, points):
        report = pcmlab("verify", tree)
        self.assertEqual(report["faults"], [])
        self.assertEqual(report["points"], points)

    def test_a_script_changes_trees(self):
        tree, las = self.scenes()
        both, less = self.folder / "both.pct", self.folder / "less.pct"
        box = "500000 4800000 0 500010 4800020 1000"
        run = self.server([add(tree, las, both), delete(both, box, count=True), delete(both, box, output=less), compact(less)])
        self.assertEqual(run.code, 0, run.text)
        self.assertGood(tree, 60000)  # unchanged
        self.assertGood(both, 100000)
        self.assertIn("40,000 points added", run.text)
        info = pcmlab("info", less)
        self.assertGood(less, info["points"])
        self.assertLess(info["points"], 100000)
        self.assertGreater(info["points"], 40000)
        self.assertIn(f"{100000 - info['points']:,} of 100,000 points would be deleted", run.text)
        self.assertIn(f"{100000 - info['points']:,} points deleted", run.text)

    def test_in_place(self):
        tree, las = self.scenes()
        run = self.server([add(tree, las, in_place=True), delete(tree, where="x >= 500020", in_place=True)])
        self.assertEqual(run.code, 0, run.text)
        points = pcmlab("info", tree)["points"]
        self.assertGood(tree, points)
        self.assertLess(abs(points - 60000), 6000)  # a few points are beyond the border

    def test_an_update_that_may_not_last_is_done(self):
        """The index was replaced, and flushing the folder to disk fails: the filter has done its work and warns."""
        tree, las = self.scenes()
        before = self.folder / "before.pct"
        shutil.copytree(tree, before)
        count = self.folder / "calls"

        def erase(fault, at=0):
            return self.server([delete(tree, where="x < 500005", in_place=True)],
                               started_by=["env", f"LD_PRELOAD={BUILD / 'tests' / 'faults' / 'libpcm_faults.so'}",
                                           f"PCM_FAULT={fault}", f"PCM_FAULT_AT={at}", f"PCM_FAULT_UNDER={tree}",
                                           f"PCM_FAULT_COUNT={count}"])

        run = erase("count")
        self.assertEqual(run.code, 0, run.text)
        points = pcmlab("info", tree)["points"]
        self.assertLess(points, 60000)
        warned = 0
        for at in range(int(count.read_text()), 0, -1):
            shutil.rmtree(tree)
            shutil.copytree(before, tree)
            run = erase("eio", at)
            self.assertGood(tree, points if run.code == 0 else 60000)
            if run.code != 0:
                break
            if "the update is part of the tree" in run.text:
                self.assertIn("do not repeat", run.text)
                warned += 1
                break
        self.assertEqual(warned, 1, run.text)

    def test_refuses_and_leaves_the_tree_alone(self):
        tree, las = self.scenes()
        for filters, words in (
                ([add(tree, las)], ["'In place'"]),
                ([add(tree, self.folder / "none.las", in_place=True)], ["none.las", "no such file"]),
                ([delete(tree, in_place=True)], ["no points were chosen to be deleted"]),
                ([delete(tree, where="colour = 1", in_place=True)], ["colour", "intensity"]),
                ([delete(tree, box="1 2 3", in_place=True)], ["takes 6 numbers, and got 3"]),
                ([delete(tree, where="x >= 0", output=tree)], ["the output is the input tree"]),
                ([compact(self.folder / "none.pct")], ["none.pct", "no such tree"])):
            with self.subTest(words[0]):
                run = self.server(filters)
                self.assertNotEqual(run.code, 0, run.text)
                for word in words:
                    self.assertIn(word, run.text)
                self.assertGood(tree, 60000)

    def test_a_layer_shows_what_its_tree_became(self):
        tree, las = self.scenes()
        before, after, compacted = (self.result(f"{name}.png") for name in ("before", "after", "compacted"))
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {FIXED_VIEW}
            wait-status complete
            picture {before}
            trigger Delete Points of Point Cloud Tree
            set Where = x < 500010
            set In place = on
            screen {self.result("dialog.png")}
            press Apply
            wait-log points deleted
            press Close
            wait-status complete
            picture {after}
            trigger Compact Point Cloud Tree
            press Apply
            wait-log before)
            press Close
            wait-status complete
            picture {compacted}
            trigger Append to Point Cloud Tree
            set Input files = {las}
            set In place = on
            press Apply
            wait-log 40,000 points added
            press Close
            wait-layers 1
            wait-status complete
            screen {self.result("appended.png")}
            """)
        self.assertDriven(run)
        self.assertGreater(different(before, after), 0.05)
        self.assertLess(different(after, compacted), 0.05)
        self.assertGood(tree, pcmlab("info", tree)["points"])


if __name__ == "__main__":
    unittest.main()
