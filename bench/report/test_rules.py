"""What the report says of a curve, and how it keeps figures: on rows made up for it."""
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from report import curves, store  # noqa: E402


def row(cpu, error, program="pcmlab", setting="x", default=False, place="map", curve=""):
    return {"place": place, "curve": curve, "program": program, "setting": setting, "default": default, "cpu": cpu, "cpu_range": [cpu, cpu], "error": error, "command": "c"}


class Knee(unittest.TestCase):
    def judge(self, *others, default=(1.0, 10.0), floor=0.0):
        return curves.knee(row(*default, default=True), [row(*other) for other in others], floor)

    def test_a_default_that_nothing_improves_on_is_there(self):
        self.assertTrue(self.judge((0.6, 12), (3, 4), (1.5, 5))[1])

    def test_as_good_in_less_time_is_not(self):
        for cheaper in ((0.8, 10), (0.8, 10.1), (0.1, 3)):
            said, good = self.judge(cheaper)
            self.assertFalse(good)
            self.assertIn(f"in {cheaper[0]:.2f} of the time", said)
        self.assertTrue(self.judge((0.9, 10))[1], "within the noise of times")
        self.assertTrue(self.judge((0.8, 10.5))[1], "a larger error")

    def test_half_of_the_error_for_as_much_time_is_not(self):
        self.assertFalse(self.judge((1.19, 5))[1])
        self.assertTrue(self.judge((1.21, 5))[1])
        self.assertTrue(self.judge((1.19, 5.1))[1])

    def test_nearly_the_error_in_half_of_the_time_is_past_it(self):
        said, good = self.judge((0.5, 11))
        self.assertFalse(good)
        self.assertIn("past the knee", said)
        self.assertTrue(self.judge((0.5, 11.1))[1])

    def test_what_is_exact_cannot_be_better(self):
        said, good = self.judge((1.1, 0), (0.5, 3), default=(1, 0))
        self.assertTrue(good)
        self.assertIn("exact; the cheapest other setting takes 0.50", said)
        self.assertTrue(self.judge((1.0, 1e-12), default=(1, 1e-9), floor=1e-8)[1], "digits of doubles")
        self.assertFalse(self.judge((0.5, 1e-8), default=(1, 1e-9), floor=1e-8)[1], "as exact, and cheaper")


class Peers(unittest.TestCase):
    def test_ours_is_below_and_left_or_it_says_where_not(self):
        mine = [row(1, 10, setting="coarse"), row(4, 1, setting="fine")]
        self.assertTrue(curves.against(row(1, 10, "P"), mine, 0)[1])
        self.assertTrue(curves.against(row(3.4, 1, "P"), mine, 0)[1], "within the noise of times")
        said, good = curves.against(row(2, 1, "P"), mine, 0)
        self.assertFalse(good)
        self.assertIn("takes 0.50 of our time", said)
        said, good = curves.against(row(50, 0.1, "P"), mine, 0)
        self.assertFalse(good)
        self.assertIn("where our least is 1", said)

    def test_curves_are_judged_apart_and_counted(self):
        rows = [row(1, 1, default=True, place="origin"), row(0.1, 1, place="map"), row(1, 1, default=True), row(2, 5, "P"), row(0.01, 0.5, "P", place="origin"),
                row(0.1, 1, "pcmlab, warm", place="origin")]
        self.assertEqual(curves.summary(rows), (0, 1, 1, 2, ["P, x (origin)"]), "a default is compared with settings of its own program")
        self.assertEqual(len(curves.off_the_knee(rows)), 1)
        self.assertTrue(curves.off_the_knee(rows)[0].startswith("map: the default (x)"))
        self.assertEqual(len(curves.sentences(rows)), 3)

    def test_without_ours_a_curve_says_nothing(self):
        self.assertEqual(curves.sentences([row(1, 1, "P")]), [])

    def test_kinds_of_one_place_are_curves_of_their_own(self):
        rows = [row(1, 1, default=True, curve="plane"), row(0.1, 1, curve="sphere")]
        self.assertEqual(len(curves.curves(rows)), 2)
        self.assertEqual(curves.off_the_knee(rows), [])


class Numbers(unittest.TestCase):
    def test_are_short(self):
        for value, text in ((None, ""), (0, "0"), (12345, "12,345"), (0.0004, "4.0e-04"), (0.1234, "0.123"), (1234.5, "1,234"), (2.0, "2")):
            self.assertEqual(curves.number(value), text)


class Kept(unittest.TestCase):
    def test_figures_are_measured_once_for_each_size(self):
        with tempfile.TemporaryDirectory() as folder:
            kept = store.Store(pathlib.Path(folder) / "report", "quick")
            self.assertFalse(kept.has("radii"))
            self.assertIsNone(kept.get("radii"))
            kept.put("radii", {"rows": [1]})
            self.assertTrue(kept.has("radii"))
            self.assertEqual(kept.get("radii")["rows"], [1])
            other = store.Store(pathlib.Path(folder) / "report", "full")
            self.assertFalse(other.has("radii"))
            self.assertEqual(other.get("radii")["rows"], [1])
            kept.drop(["radii", "absent"])
            self.assertFalse(kept.has("radii"))
            self.assertEqual([path.name for path in (pathlib.Path(folder) / "report").iterdir()], [])


if __name__ == "__main__":
    unittest.main()
