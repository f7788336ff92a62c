"""Trees on a server: opened by their address in a script and in the window, and looked at over round trips of 60 ms."""

import os
import re
import shutil
import sys
import threading
import unittest

from meshlab import SOURCE, MeshLabTest, different, pcmlab

sys.path.insert(0, str(SOURCE / "tests" / "remote"))
from range_server import RangeServer


class Addresses(MeshLabTest):
    def setUp(self):
        super().setUp()
        self.environment["PCM_NETWORK_CACHE"] = "0"
        _, self.tree = self.generate("site", 1500000, "--extent", 30, "--origin", "500000,4800000,100")

    def test_a_script_opens_an_address(self):
        with RangeServer(self.folder) as server:
            run = self.server([("Open Point Cloud Tree by Address", {"Address": ("RichString", server.address("site.pct"))}),
                               ("Point Cloud Tree Information", {"Tree": ("RichString", "")})])
            self.assertEqual(run.code, 0, run.text)
            self.assertIn("1,500,000 points", run.text)
            for address, words in (("", "no address was given"), (server.address("none.pct"), "there is no point cloud tree at this address"),
                                   (str(self.tree), "this is not an address"), ("https://me:hidden@host/x", "a user or a password")):
                run = self.server([("Open Point Cloud Tree by Address", {"Address": ("RichString", address)})])
                self.assertIn(words, run.text)
                self.assertNotIn("hidden@", run.text.replace(address, ""))

    def test_the_view_of_an_address_is_that_of_the_folder(self):
        with RangeServer(self.folder, delay=0.06) as server:
            address = server.address("site.pct")
            there = self.own_gui(f"""
                wait-view
                view-size 800 600
                trigger Open Point Cloud Tree by Address
                set Address = {address}
                press Apply
                wait-layers 1
                press Close
                wait-status complete
                wait-standing
                picture {self.result("there.png")}
                screen {self.result("screen.png")}
                print-layers
                quit
                """)
            self.assertDriven(there)
            self.assertLess(len(server.requests), 40)
            self.assertIn("MeshLab does not open addresses that a project names", there.text)
        here = self.own_gui(f"""
            wait-view
            view-size 800 600
            open {self.tree}
            wait-layers 1
            wait-status complete
            wait-standing
            picture {self.result("here.png")}
            quit
            """)
        self.assertDriven(here)
        self.assertEqual(self.result("there.png").read_bytes(), self.result("here.png").read_bytes())
        self.assertEqual(pcmlab("verify", self.tree)["faults"], [])

    def test_a_server_that_is_away_for_a_time_takes_nothing_from_the_view(self):
        _, town = self.generate("town", 5000000, "--extent", 90, "--origin", "500000,4800000,100")
        with RangeServer(self.folder) as server:
            back = self.folder / "back.png"
            server.is_away = lambda: len(server.requests) > 8 and not back.exists()
            away = self.own_gui(f"""
                wait-view
                view-size 800 600
                trigger Open Point Cloud Tree by Address
                set Address = {server.address("town.pct")}
                press Apply
                wait-layers 1
                press Close
                wait-status cannot be reached
                screen {self.result("away.png")}
                wait-status try again later
                wheel -8
                wait-standing
                picture {self.result("moved.png")}
                picture {back}
                wait-no-status cannot be reached
                wait-status complete, full resolution
                wait-standing
                picture {self.result("again.png")}
                quit
                """)
        self.assertDriven(away)
        # What had come was shown meanwhile; afterwards the picture is that of the folder, but for pixels where points of equal depth
        # were drawn in another order.
        shown = int(re.search(r"picture \S+back.png 800x600, (\d+) points", away.text)[1])
        self.assertGreater(shown, 40000)
        self.assertLess(shown, 5000000)
        here = self.own_gui(f"""
            wait-view
            view-size 800 600
            open {town}
            wait-layers 1
            wheel -8
            wait-status complete, full resolution
            wait-standing
            picture {self.result("never_away.png")}
            quit
            """)
        self.assertDriven(here)
        self.assertLess(different(self.result("again.png"), self.result("never_away.png")), 1e-4)
        self.assertLess(different(self.result("moved.png"), self.result("never_away.png")), 0.5)  # coarser, and nowhere blank

    def test_a_tree_that_is_replaced_on_its_server_is_opened_again(self):
        _, town = self.generate("town", 5000000, "--extent", 90, "--origin", "500000,4800000,100")
        # The same bounds, and a hole.
        edited, points, other = self.folder / "edited.pct", self.folder / "other.las", self.folder / "other.pct"
        pcmlab("delete", town, "-o", edited, "--box", 500030, 4800030, 0, 500060, 4800060, 500)
        pcmlab("convert", edited, points)
        pcmlab("build", points, "-o", other)
        with RangeServer(self.folder) as server:
            changing = threading.Lock()
            asked, changed = [], []  # number of requests when the data were replaced; whether the index was

            def replace():
                """The data first, and the index when it has been looked at twice meanwhile."""
                with changing:
                    if len(server.requests) > 8 and not asked:
                        shutil.copy(other / "chunks-000.bpc", self.folder / "part")
                        os.replace(self.folder / "part", town / "chunks-000.bpc")
                        asked.append(len(server.requests))
                    if asked and not changed and sum("index.pct" in path for _, path, _ in server.requests[asked[0]:]) > 2:
                        shutil.copy(other / "index.pct", self.folder / "part")
                        os.replace(self.folder / "part", town / "index.pct")
                        changed.append(True)
                return False

            server.is_away = replace
            there = self.own_gui(f"""
                wait-view
                view-size 800 600
                trigger Open Point Cloud Tree by Address
                set Address = {server.address("town.pct")}
                press Apply
                wait-layers 1
                press Close
                wait-status has been replaced on the server
                wheel -8
                screen {self.result("replaced.png")}
                wait-log has been replaced on its server, and is opened again
                wait-no-status has been replaced
                wait-status complete, full resolution
                wait-standing
                picture {self.result("opened_again.png")}
                quit
                """)
        self.assertDriven(there)
        self.assertIn("shows the changed tree", there.text)
        here = self.own_gui(f"""
            wait-view
            view-size 800 600
            open {other}
            wait-layers 1
            wheel -8
            wait-status complete, full resolution
            wait-standing
            picture {self.result("the_other.png")}
            quit
            """)
        self.assertDriven(here)
        self.assertLess(different(self.result("opened_again.png"), self.result("the_other.png")), 1e-4)


if __name__ == "__main__":
    unittest.main()
