"""All plugins in one file, in a MeshLab that has none of ours: from the user's folder of plugins, and loaded by Help > Plugin Info."""

import os
import re
import shutil
import unittest

from meshlab import BUILD, MeshLabTest, NO_TIME_LIMIT, pcmlab

FILE = BUILD / "whole" / "pcm_point_clouds.so"
REFUSED = BUILD / "refused"


class OneFile(MeshLabTest):
    @classmethod
    def setUpClass(cls):
        if not FILE.exists():
            raise unittest.SkipTest("MeshLab 2020.09 has no plugins of a user's own")
        super().setUpClass()
        cls.with_ours, cls.prefix = cls.prefix, BUILD / "e2e-meshlab-alone"
        shutil.rmtree(cls.prefix, ignore_errors=True)
        shutil.copytree(cls.with_ours, cls.prefix, symlinks=True)
        for link in cls.prefix.rglob("*.so"):
            if str(os.readlink(link)).startswith(str(BUILD)) and link.name != "libpcm_test_driver.so":
                link.unlink()

    def setUp(self):
        super().setUp()
        # Each test starts with a folder of plugins of its own.
        self.environment["XDG_DATA_HOME"] = str(self.folder / "data")
        self.plugins = self.folder / "data" / "VCG" / "MeshLab_64bit_fp" / "MeshLabExtraPlugins"

    def draws_and_measures(self, las):
        return f"""
            {NO_TIME_LIMIT}
            open {las}
            wait-layers 1
            wait-status 400000 points of 1 clouds, complete
            trigger Pick Point
            pause 500
            trigger Pick Point
            trigger Point Cloud Tree Information
            press Apply
            wait-log 400,000 points
            press Close
            """

    def test_from_the_folder_of_the_user(self):
        _, tree = self.generate("city", 400000, "--seed", 5)
        version = re.search(r"(\d{4}\.\d\d)", self.own_gui("wait-view\nquit").text)  # makes the folder
        folders = list(self.plugins.iterdir())
        self.assertEqual(len(folders), 1, version)
        shutil.copy(FILE, folders[0])
        saved = self.folder / "saved.las"
        run = self.own_gui(f"""
            wait-view
            {self.draws_and_measures(tree)}
            export {saved}
            wait-log Wrote 400,000 points
            quit
            """)
        self.assertDriven(run)
        self.assertEqual(pcmlab("info", saved)["points"], 400000)

    def load(self, file):
        return f"""
            trigger Plugin Info
            press Load Plugins
            pick {file}
            """

    def test_loaded_while_meshlab_runs(self):
        _, tree = self.generate("city", 400000, "--seed", 5)
        run = self.own_gui(f"""
            wait-view
            {self.load(FILE)}
            pause 1000
            screen {self.result("loaded.png")}
            close-dialog
            {self.draws_and_measures(tree)}
            quit
            """)
        self.assertDriven(run)

    def test_a_second_one_is_refused_by_name(self):
        self.prefix = self.with_ours
        run = self.own_gui(f"""
            wait-view
            {self.load(FILE)}
            answer OK
            close-dialog
            quit
            """)
        self.assertDriven(run)
        self.assertIn("loaded already, from another file", run.text)

    def test_each_of_the_others_is_refused_beside_it(self):
        names = ("libio_00_pcm.so", "libpcm_filter.so", "libpcm_render.so", "libpcm_edit.so")
        loads = "".join(f"press Load Plugins\npick {BUILD / 'plugins' / name}\nanswer OK\n" for name in names)
        run = self.own_gui(f"""
            wait-view
            {self.load(FILE)}
            {loads}
            close-dialog
            quit
            """)
        self.assertDriven(run)
        self.assertEqual(run.text.count("loaded already, from another file"), len(names))

    def test_what_does_not_fit_is_refused_by_name(self):
        reasons = {"version": "has different version", "scalar": "has different floating point precision",
                   "symbol": "pcm_that_is_nowhere"}
        for name, reason in reasons.items():
            with self.subTest(name):
                run = self.own_gui(f"""
                    wait-view
                    {self.load(REFUSED / f"refused_{name}.so")}
                    answer OK
                    close-dialog
                    quit
                    """)
                self.assertDriven(run)
                self.assertRegex(run.text, rf"driver: message: .*refused_{name}.so(.|\n)*{reason}")


if __name__ == "__main__":
    unittest.main()
