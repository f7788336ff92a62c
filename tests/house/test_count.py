"""packaging/count_tests.py: what is counted, what is shown, and which exit codes follow."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM = pathlib.Path(__file__).resolve().parents[2] / "packaging" / "count_tests.py"
CASES = {
    "passed": '<testcase name="{name}" status="run"/>',
    "failed": '<testcase name="{name}" status="fail"><system-out>why {name}</system-out></testcase>',
    "skipped": '<testcase name="{name}" status="notrun"><skipped message="SKIP_RETURN_CODE=77"/></testcase>',
    "missing": '<testcase name="{name}" status="notrun"><skipped message="Unable to find executable"/></testcase>',
    "disabled": '<testcase name="{name}" status="disabled"/>',
}


class Count(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def report(self, file, **cases):
        path = self.folder / file
        path.write_text("<testsuite>" + "".join(CASES[kind].format(name=name) for name, kind in cases.items()) + "</testsuite>")
        return str(path)

    def run_on(self, *arguments):
        done = subprocess.run([sys.executable, "-B", str(PROGRAM), *arguments], capture_output=True, text=True)
        return done.returncode, done.stdout

    def test_adds_up_reports(self):
        one = self.report("one.xml", a="passed", b="skipped", c="disabled")
        two = self.report("two.xml", a="passed")
        self.assertEqual(self.run_on(one, two), (0, "2 passed, 0 failed, 2 skipped\n"))

    def test_failures_are_shown_and_fail(self):
        code, text = self.run_on(self.report("one.xml", a="passed", b="failed", c="missing"))
        self.assertEqual(code, 1)
        self.assertIn("failed: b (", text)
        self.assertIn("    why b\n", text)
        self.assertTrue(text.endswith("\n1 passed, 2 failed, 0 skipped\n"), text)

    def test_what_cannot_be_read_fails(self):
        good = self.report("one.xml", a="passed")
        (self.folder / "bad.xml").write_text("<testsuite>")
        for bad in (str(self.folder / "bad.xml"), str(self.folder / "absent.xml")):
            code, text = self.run_on(good, bad)
            self.assertEqual((code, text.splitlines()[-1]), (1, "1 passed, 1 failed, 0 skipped"))
        self.assertEqual(self.run_on("--broken", "1", good)[0], 1)
        self.assertEqual(self.run_on(), (1, "0 passed, 0 failed, 0 skipped\n"))

    def test_the_second_time_holds(self):
        first = self.report("one.xml", a="passed", b="failed", c="failed", d="failed")
        second = self.report("one-again.xml", b="passed", c="failed")
        code, text = self.run_on(first, second)
        self.assertEqual((code, text.splitlines()[-1]), (1, "2 passed, 2 failed, 0 skipped"))
        self.assertIn("unsteady: b (", text)
        self.assertIn("    why b\n", text)
        self.assertIn("failed: c (", text)
        self.assertIn("failed: d (", text)
        steady = self.report("one.xml", a="passed", b="failed")
        self.assertEqual(self.run_on(steady, self.report("one-again.xml", b="passed"))[0], 0)
        # A report of another preset says nothing of this one.
        self.assertEqual(self.run_on(steady, self.report("two-again.xml", b="passed"))[0], 1)

    def test_a_room_is_counted_by_its_tests(self):
        (self.folder / "rooms").mkdir()
        for again in ("", "-again"):
            self.report(f"rooms/room{again}.xml", **{"room.a": "passed", "room.b": "skipped", "room.c": "passed" if again else "failed"})
        first = self.report("one.xml", room="failed", other="passed")
        code, text = self.run_on(first)
        self.assertEqual((code, text.splitlines()[-1]), (1, "2 passed, 1 failed, 1 skipped"))
        self.assertIn("failed: room.c (", text)
        self.assertIn("    why room.c\n", text)
        self.assertEqual(self.run_on("--few-failed", first), (0, ""))
        code, text = self.run_on(first, self.report("one-again.xml", room="passed"))
        self.assertEqual((code, text.splitlines()[-1]), (0, "3 passed, 0 failed, 1 skipped"))
        self.assertIn("unsteady: room.c (", text)

    def test_what_its_tests_do_not_know_fails_the_room(self):
        (self.folder / "rooms").mkdir()
        self.report("rooms/room.xml", **{"room.a": "passed"})
        code, text = self.run_on(self.report("one.xml", room="failed"))
        self.assertEqual((code, text.splitlines()[-1]), (1, "1 passed, 1 failed, 0 skipped"))
        self.assertIn("    why room\n", text)

    def test_few(self):
        for failed, few in ((0, 1), (1, 0), (3, 0), (4, 1)):
            report = self.report("one.xml", a="passed", **{f"f{i}": "failed" for i in range(failed)})
            self.assertEqual(self.run_on("--few-failed", report), (few, ""), failed)
        self.assertEqual(self.run_on("--few-failed", str(self.folder / "absent.xml"))[0], 1)


if __name__ == "__main__":
    unittest.main()
