#!/usr/bin/env python3
"""Adds up CTest's JUnit reports into one line: 'N passed, N failed, N skipped'.

Before it stand the failed tests, each with the end of what it printed. The exit code is 0 only if none failed and one
passed. A test whose program is missing is a failure, though CTest's report calls it skipped.
"""
import argparse
import sys
import xml.etree.ElementTree as ElementTree

LINES_OF_A_FAILURE = 40


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


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--broken", type=int, default=0, help="presets without a report; each is one failure")
    parser.add_argument("reports", nargs="*")
    arguments = parser.parse_args()

    count = {"passed": 0, "failed": arguments.broken, "skipped": 0}
    for report in arguments.reports:
        try:
            cases = list(ElementTree.parse(report).getroot().iter("testcase"))
        except (OSError, ElementTree.ParseError) as error:
            print(f"failed: {report} cannot be read: {error}")
            count["failed"] += 1
            continue
        for case in cases:
            result = outcome(case)
            count[result] += 1
            if result == "failed":
                print(f"failed: {case.get('name')} ({report})")
                for line in (case.findtext("system-out") or "").splitlines()[-LINES_OF_A_FAILURE:]:
                    print(f"    {line}")
    print("{passed} passed, {failed} failed, {skipped} skipped".format(**count))
    return 0 if count["failed"] == 0 and count["passed"] > 0 else 1


if __name__ == "__main__":
    sys.exit(main())
