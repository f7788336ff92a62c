#!/usr/bin/env python3
"""Adds up CTest's JUnit reports into one line: 'N passed, N failed, N skipped'.

Before it stand the failed tests, each with the end of what it printed. The exit code is 0 only if none failed and one
passed. A test whose program is missing is a failure, though CTest's report calls it skipped.

A report REPORT-again.xml is of tests of REPORT.xml that failed and ran once more: its results count. Those that passed
then are listed as unsteady, with what they printed when they failed.

A test of a report that stands for all tests of an executable (tests/run_room.py) has a report of its own, rooms/NAME.xml
next to it: those tests are counted instead.

With --few-failed nothing is printed: the exit code is 0 if one to three tests of the report failed, 1 otherwise.
"""
import argparse
import pathlib
import sys
import xml.etree.ElementTree as ElementTree

LINES_OF_A_FAILURE = 40
FEW = 3
AGAIN = "-again.xml"


def outcome(case):
    status = case.get("status")
    if status == "run":
        return "passed"
    if status == "disabled":
        return "skipped"
    if status == "notrun":
        skipped = case.find("skipped")
        message = skipped.get("message", "") if skipped is not None else ""
        return "skipped" if message.startswith("SKIP_") else "failed"
    return "failed"


def read_cases(report):
    return {case.get("name"): case for case in ElementTree.parse(report).getroot().iter("testcase")}


def cases_of(report):
    """Name -> case; None where the report cannot be read."""
    end = AGAIN if report.endswith(AGAIN) else ".xml"
    try:
        cases = {}
        for name, case in read_cases(report).items():
            room = pathlib.Path(report).parent / "rooms" / (name + end)
            tests = read_cases(room) if room.exists() else {}
            cases.update(tests)
            # What failed is in neither report where the program that runs the room did.
            if not tests or outcome(case) == "failed" and "failed" not in map(outcome, tests.values()):
                cases[name] = case
        return cases
    except (OSError, ElementTree.ParseError) as error:
        print(f"failed: {report} cannot be read: {error}")
        return None


def show(kind, name, report, case):
    print(f"{kind}: {name} ({report})")
    for line in (case.findtext("system-out") or "").splitlines()[-LINES_OF_A_FAILURE:]:
        print(f"    {line}")


def count_report(report, again, count):
    cases = cases_of(report)
    if cases is None:
        count["failed"] += 1
        return
    second = cases_of(again) if again else {}
    for name, case in cases.items():
        result = outcome(case)
        if result == "failed" and second and name in second and outcome(second[name]) == "passed":
            show("unsteady", name, report, case)
            result = "passed"
        count[result] += 1
        if result == "failed":
            show("failed", name, report, case)


def has_few_failed(report):
    cases = cases_of(report)
    return cases is not None and 0 < sum(outcome(case) == "failed" for case in cases.values()) <= FEW


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--broken", type=int, default=0, help="presets without a report; each is one failure")
    parser.add_argument("--few-failed", action="store_true", help="only say by the exit code whether few tests failed")
    parser.add_argument("reports", nargs="*")
    arguments = parser.parse_args()
    if arguments.few_failed:
        return 0 if all(has_few_failed(report) for report in arguments.reports) else 1

    count = {"passed": 0, "failed": arguments.broken, "skipped": 0}
    for report in arguments.reports:
        if report.endswith(AGAIN):
            continue
        again = report[: -len(".xml")] + AGAIN
        count_report(report, again if again in arguments.reports else None, count)
    print("{passed} passed, {failed} failed, {skipped} skipped".format(**count))
    return 0 if count["failed"] == 0 and count["passed"] > 0 else 1


if __name__ == "__main__":
    sys.exit(main())
