#!/usr/bin/env python3
"""Reads the sample clouds of one format with the project's reader and with an independent one, and compares every
position and every attribute of every point.

    check.py FORMAT --dump DUMP_CLOUD --data FOLDER [--python PYTHON] [--only TEXT]

Prints a table. The exit code is 0 when all is equal, 1 when not, 77 (skipped) where there are no clouds or no
independent reader. PYTHON, where it exists, runs the comparison: one that has the packages of requirements.txt.
"""
import argparse
import importlib
import os
import pathlib
import sys
import time

SKIPPED = 77
# Extensions of a format, and the module here that reads them.
FORMATS = {
    "las": ((".las",), "las_by_laspy"),
    "laz": ((".laz",), "las_by_laspy"),
    "ply": ((".ply",), "ply_by_plyfile"),
    "pcd": ((".pcd",), "pcd_by_pypcd4"),
    "e57": ((".e57",), "e57_by_pye57"),
    "pts": ((".pts",), "text_by_numpy"),
    "ptx": ((".ptx",), "text_by_numpy"),
    "text": ((".xyz", ".txt", ".pwn", ".csv", ".asc"), "text_by_numpy"),
}


def skip(why):
    print(f"skipped: {why}")
    sys.exit(SKIPPED)


def common_arguments(description, add=lambda parser: None):
    """The arguments that all of these scripts have; continues in the interpreter with the packages."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    add(parser)
    parser.add_argument("--dump", required=True)
    parser.add_argument("--data", type=pathlib.Path, required=True)
    parser.add_argument("--python")
    arguments = parser.parse_args()
    python = arguments.python
    if python and os.path.exists(python) and os.environ.get("PCM_INDEPENDENT") != "1":
        os.environ["PCM_INDEPENDENT"] = "1"
        os.execv(python, [python, "-B", *sys.argv])
    return arguments


def clouds_of(data, extensions):
    """Every sample of these extensions that is a valid cloud: bad/ and edge/ hold the invalid ones."""
    return sorted(path for path in data.glob("*/**/*") if path.suffix.lower() in extensions
                  and path.relative_to(data).parts[0] not in ("bad", "edge"))


def main():
    def add(parser):
        parser.add_argument("format", choices=FORMATS)
        parser.add_argument("--only", default="", help="only files with this text in their path")

    arguments = common_arguments(__doc__, add)
    extensions, module = FORMATS[arguments.format]
    files = [path for path in clouds_of(arguments.data, extensions) if arguments.only in str(path)]
    if not files:
        skip(f"no sample cloud {' '.join(extensions)} in {arguments.data}")
    try:
        compare = importlib.import_module("compare")
        independent = importlib.import_module(module)
    except ImportError as error:
        skip(f"{error}; packaging/test-python installs what the comparison needs")

    failed = 0
    print(f"{'file':<48} {'points':>9}  {'seconds':>7}  attributes compared: result")
    for path in files:
        started = time.monotonic()
        try:
            theirs = independent.read(path)
            ours = compare.read_ours(arguments.dump, path)
            found = compare.differences(ours, theirs)
            names = ", ".join(theirs.attributes) or "none"
            points = len(theirs.positions)
        except Exception as error:  # whatever a reader of others throws is a line of the table
            found, names, points = [f"{type(error).__name__}: {error}"], "-", 0
        failed += bool(found)
        print(f"{str(path.relative_to(arguments.data)):<48} {points:>9}  {time.monotonic() - started:>7.2f}  "
              f"{names}: {'equal' if not found else 'DIFFERENT'}")
        for difference in found:
            print(f"    {difference}")
    print(f"{len(files) - failed} of {len(files)} files equal")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
