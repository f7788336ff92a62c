#!/usr/bin/env python3
"""Runs the tests of one executable in few processes, and reports each test by its name, as CTest does.

    run_room.py --program test_cloud --name asan.cloud --report asan.cloud.xml [--part 1/3] [--only PATTERN]... [--patience SECONDS]

For the sanitizers, under which a process a test costs more than most tests. A test that crashes, or that takes longer than
the patience, is reported as failed with what it printed; the tests after it run in a further process. What a process reports
when all its tests have passed, such as leaks, is a failure named end, after the report. The report is in JUnit's format with the words of
CTest's (packaging/count_tests.py reads both). The exit code is 0 only if no test failed and one passed.

With PCM_FAILED_AGAIN=1 in the environment only the tests that failed in the report run, each in a process of its own; the
report is then NAME-again.xml beside it.
"""
import argparse
import fnmatch
import os
import pathlib
import re
import signal
import subprocess
import sys
import threading
import xml.etree.ElementTree as ElementTree

END = "end"
RUN = re.compile(r"\[ RUN      \] (\S+)$")
OUTCOME = re.compile(r"\[ *(OK|FAILED|SKIPPED) *\] (\S+?)(?:, where .*)? \((\d+) ms\)$")
STATUS = {"OK": "run", "FAILED": "fail", "SKIPPED": "notrun"}


class Case:
    def __init__(self, status, text="", seconds=0.0):
        self.status = status
        self.text = text
        self.seconds = seconds


def suites_of(program):
    """The tests by suite, as --gtest_filter takes their names; the disabled ones too."""
    listed = subprocess.run([program, "--gtest_list_tests"], capture_output=True, text=True, timeout=300, check=True).stdout
    suites, suite = {}, None
    for line in listed.splitlines():
        name = line.split("  # ")[0].rstrip()
        if not line.startswith(" ") and name.endswith("."):
            suite = suites.setdefault(name, [])
        elif line.startswith("  ") and suite is not None:
            suite.append(next(reversed(suites)) + name.strip())
    return suites


def chosen(suites, patterns):
    """The tests whose names match one of the patterns; all of them where there is none."""
    if not patterns:
        return suites
    return {suite: [test for test in tests if any(fnmatch.fnmatchcase(test, pattern) for pattern in patterns)]
            for suite, tests in suites.items()}


def is_disabled(test):
    return any(word.startswith("DISABLED_") for word in re.split(r"[./]", test))


def part_of(suites, part, parts):
    """The tests of one of so many parts; suites are not torn, as their tests share what one process makes once."""
    loads = [[] for _ in range(parts)]
    for tests in suites.values():
        min(loads, key=len).extend(tests)
    return loads[part - 1]


class Process:
    """One run of the executable. `cases` has the tests that began; `code` is the exit code."""

    def __init__(self, program, tests, patience):
        self.cases = {}
        self.running = None
        self.rest = []  # lines that no test printed
        self.timed_out = False
        self.process = subprocess.Popen([program, "--gtest_color=no", "--gtest_filter=" + ":".join(tests)], text=True,
                                        errors="replace", stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                        stderr=subprocess.STDOUT, start_new_session=True)
        self.patience = patience
        self.timer = None
        self.wind()
        for line in self.process.stdout:
            self.read(line.rstrip("\n"))
        self.code = self.process.wait()
        self.timer.cancel()
        self.kill()  # what a crashed test may have left running

    def wind(self):
        if self.timer:
            self.timer.cancel()
        self.timer = threading.Timer(self.patience, self.expire)
        self.timer.daemon = True
        self.timer.start()

    def expire(self):
        self.timed_out = True
        self.kill()

    def kill(self):
        try:
            os.killpg(self.process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass

    def read(self, line):
        began, ended = RUN.search(line), OUTCOME.search(line)
        if began:
            self.running = began[1]
            self.cases[began[1]] = Case("fail")
            self.wind()
        elif ended and ended[2] == self.running:
            case = self.cases[self.running]
            case.status = STATUS[ended[1]]
            case.seconds = int(ended[3]) / 1000
            case.text += line + "\n"
            self.running = None
            self.wind()
        elif self.running:
            self.cases[self.running].text += line + "\n"
        else:
            self.rest.append(line)


def run_all(program, tests, patience):
    """The cases of all these tests, by name."""
    cases = {test: Case("disabled") for test in tests if is_disabled(test)}
    left = [test for test in tests if test not in cases]
    while left:
        process = Process(program, left, patience)
        cases.update(process.cases)
        if process.running:
            why = f"no end after {patience} s" if process.timed_out else f"the process ended with {process.code}"
            cases[process.running].text += f"\n{why} during this test\n"
        elif process.code != 0 and all(case.status != "fail" for case in process.cases.values()):
            cases[END] = Case("fail", "\n".join(process.rest) + f"\nthe process ended with {process.code} after its tests\n")
        if not process.running:
            for test in left:
                cases.setdefault(test, Case("fail", "this test did not run"))
            break
        left = [test for test in left if test not in process.cases]
    return cases


def write(path, cases):
    root = ElementTree.Element("testsuite", name=path.stem)
    for test, case in cases.items():
        element = ElementTree.SubElement(root, "testcase", name=test, status=case.status, time=f"{case.seconds:.3f}")
        if case.status == "notrun":
            ElementTree.SubElement(element, "skipped", message="SKIP_REGULAR_EXPRESSION_MATCHED")
        if case.status == "fail":
            ElementTree.SubElement(element, "failure", message="failed")
        if case.status in ("fail", "notrun"):
            text = "".join(c if c in "\n\t" or c >= " " else "?" for c in case.text)
            ElementTree.SubElement(element, "system-out").text = text
    path.parent.mkdir(parents=True, exist_ok=True)
    ElementTree.ElementTree(root).write(path, encoding="utf-8", xml_declaration=True)


def failed_in(report, name):
    """The tests that failed in an earlier report, without what failed at the end of a process."""
    end = f"{report.stem}.{END}"
    return [case.get("name")[len(name) + 1:] for case in ElementTree.parse(report).getroot().iter("testcase")
            if case.get("status") == "fail" and case.get("name") != end]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--name", required=True, help="what the names of the tests begin with")
    parser.add_argument("--report", required=True, type=pathlib.Path)
    parser.add_argument("--part", default="1/1", help="which of how many parts")
    parser.add_argument("--only", action="append", default=[], metavar="PATTERN", help="tests whose names match, such as *Thread*; may be repeated")
    parser.add_argument("--patience", type=float, default=600, help="seconds a test may take")
    arguments = parser.parse_args()
    report = arguments.report
    if os.environ.get("PCM_FAILED_AGAIN"):
        cases = {}
        for test in failed_in(report, arguments.name):
            cases.update(run_all(arguments.program, [test], arguments.patience))
        report = report.with_name(report.stem + "-again.xml")
    else:
        report.unlink(missing_ok=True)
        part, parts = map(int, arguments.part.split("/"))
        cases = run_all(arguments.program, part_of(chosen(suites_of(arguments.program), arguments.only), part, parts), arguments.patience)
    cases = {f"{report.stem if test == END else arguments.name}.{test}": case for test, case in cases.items()}
    write(report, cases)
    failed = [test for test, case in cases.items() if case.status == "fail"]
    for test in failed:
        print(f"failed: {test}")
        print(cases[test].text)
    passed = sum(case.status == "run" for case in cases.values())
    print(f"{passed} passed, {len(failed)} failed, {len(cases) - passed - len(failed)} skipped")
    return 0 if passed and not failed else 1


if __name__ == "__main__":
    sys.exit(main())
