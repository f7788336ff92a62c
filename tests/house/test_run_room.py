"""tests/run_room.py: no test is lost, whatever a process does; each is reported by its name."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

PROGRAM = pathlib.Path(__file__).resolve().parents[1] / "run_room.py"

# Prints what an executable of googletest prints. TESTS: what each test does.
FAKE = '''#!{python}
import os, pathlib, sys, time
TESTS = {tests!r}
log = pathlib.Path(__file__).with_suffix(".log")
if "--gtest_list_tests" in sys.argv:
    print("Running main() from gtest_main.cc")
    suite = None
    for name in TESTS:
        if name.rsplit(".", 1)[0] != suite:
            suite = name.rsplit(".", 1)[0]
            print(suite + ".  # TypeParam = int")
        print("  " + name.rsplit(".", 1)[1] + "  # GetParam() = 7")
    sys.exit(0)
wanted = next(a for a in sys.argv if a.startswith("--gtest_filter="))[15:].split(":")
with open(log, "a") as file:
    file.write(" ".join(wanted) + "\\n")
failed = False
for name in TESTS:
    if name not in wanted:
        continue
    what = TESTS[name]
    print("[ RUN      ] " + name, flush=True)
    print("output of " + name, flush=True)
    if what == "crash":
        os.abort()
    if what == "hang":
        time.sleep(60)
    if what == "fail" or what == "unsteady" and len(log.read_text().splitlines()) < 2:
        failed = True
        print("[  FAILED  ] " + name + ", where GetParam() = 7 (3 ms)", flush=True)
    elif what == "skip":
        print("[  SKIPPED ] " + name + " (0 ms)", flush=True)
    else:
        print("half a line [       OK ] " + name + " (12 ms)", flush=True)
print("[==========] done", flush=True)
if "leak" in TESTS.values():
    print("found a leak", flush=True)
    sys.exit(23)
sys.exit(1 if failed else 0)
'''


class RunRoom(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.report = self.folder / "rooms" / "room.xml"

    def run_on(self, tests, *more, patience=30, **environment):
        """The exit code, what was printed, and the state of each test in the report."""
        program = self.folder / "program"
        program.write_text(FAKE.format(python=sys.executable, tests=tests))
        program.chmod(0o755)
        done = subprocess.run([sys.executable, "-B", str(PROGRAM), "--program", str(program), "--name", "room", "--report",
                               str(self.report), "--patience", str(patience), *more], capture_output=True, text=True,
                              env=dict(os.environ, **environment))
        return done.returncode, done.stdout, self.states(self.report)

    @staticmethod
    def states(report):
        return {case.get("name"): case.get("status") for case in ElementTree.parse(report).getroot().iter("testcase")}

    def calls(self):
        return [line.split() for line in (self.folder / "program.log").read_text().splitlines()]

    def test_all_pass_in_one_process(self):
        code, text, states = self.run_on({"A.a": "", "A.b": "skip", "B/0.c/1": "", "B/0.DISABLED_d": ""})
        self.assertEqual((code, text), (0, "2 passed, 0 failed, 2 skipped\n"))
        self.assertEqual(states, {"room.A.a": "run", "room.A.b": "notrun", "room.B/0.c/1": "run", "room.B/0.DISABLED_d": "disabled"})
        self.assertEqual(self.calls(), [["A.a", "A.b", "B/0.c/1"]])

    def test_a_crash_names_its_test_and_loses_no_other(self):
        code, text, states = self.run_on({"A.a": "", "A.b": "crash", "A.c": "fail", "A.d": "crash", "A.e": ""})
        self.assertEqual(code, 1)
        self.assertEqual(states, {"room.A.a": "run", "room.A.b": "fail", "room.A.c": "fail", "room.A.d": "fail", "room.A.e": "run"})
        self.assertIn("failed: room.A.b\noutput of A.b\n", text)
        self.assertIn("the process ended with -6 during this test", text)
        self.assertEqual(self.calls()[1:], [["A.c", "A.d", "A.e"], ["A.e"]])

    def test_a_test_without_end_is_ended(self):
        code, text, states = self.run_on({"A.a": "hang", "A.b": ""}, patience=1)
        self.assertEqual((code, states), (1, {"room.A.a": "fail", "room.A.b": "run"}))
        self.assertIn("no end after 1.0 s during this test", text)

    def test_what_a_process_reports_after_its_tests_is_a_failure(self):
        code, text, states = self.run_on({"A.a": "leak"})
        self.assertEqual((code, states), (1, {"room.A.a": "run", "room.end": "fail"}))
        self.assertIn("found a leak\nthe process ended with 23 after its tests", text)

    def test_only_those_that_match_run(self):
        tests = {"A.ManyThreads": "", "A.b": "fail", "B/0.OneThread/1": "", "B/0.CanBeCancelled": ""}
        code, _, states = self.run_on(tests, "--only=*Thread*", "--only=*Cancel*")
        self.assertEqual((code, states), (0, {"room.A.ManyThreads": "run", "room.B/0.OneThread/1": "run", "room.B/0.CanBeCancelled": "run"}))
        self.assertEqual(self.run_on(tests, "--only=*Nothing*")[:2], (1, "0 passed, 0 failed, 0 skipped\n"))

    def test_parts_hold_all_and_tear_no_suite(self):
        tests = {f"{suite}.{i}": "" for suite in "ABCDE" for i in range(3)}
        parts = [self.run_on(tests, "--part", f"{i}/2")[2] for i in (1, 2)]
        self.assertEqual(sorted([*parts[0], *parts[1]]), sorted("room." + name for name in tests))
        for suite in "ABCDE":
            self.assertEqual(sum(f"room.{suite}.0" in part for part in parts), 1)
            self.assertIn(sum(name.startswith(f"room.{suite}") for name in parts[0]), (0, 3))
        self.assertEqual(sorted(map(len, parts)), [6, 9])

    def test_only_what_failed_runs_again(self):
        tests = {"A.a": "", "A.b": "unsteady", "A.c": "fail"}
        self.run_on(tests)
        code, text, states = self.run_on(tests, PCM_FAILED_AGAIN="1")
        self.assertEqual(code, 1)
        self.assertEqual(states, {"room.A.a": "run", "room.A.b": "fail", "room.A.c": "fail"}, "the first report stays")
        self.assertEqual(self.states(self.report.with_name("room-again.xml")), {"room.A.b": "run", "room.A.c": "fail"})
        self.assertEqual(self.calls()[1:], [["A.b"], ["A.c"]])

    def test_no_test_is_a_failure(self):
        self.assertEqual(self.run_on({})[0], 1)


if __name__ == "__main__":
    unittest.main()
