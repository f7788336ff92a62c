#!/usr/bin/env python3
"""Files that are compiled for one level of core/system/cpu.h define nothing that the linker merges with other files.

    python3 tests/system/level_files.py FOLDER    of the objects: all *_avx*.cpp.o below it are looked at

The linker keeps one copy of an inline function that several files define. If it kept that of such a file, the whole
library would need its instructions.
"""
import pathlib
import re
import shutil
import subprocess
import sys

SKIPPED = 77


def merged_symbols(objects):
    """(object, symbol) of each symbol that is weak, or unique in the program, and defined."""
    found = []
    for path in objects:
        lines = subprocess.run(["nm", "-C", path], check=True, capture_output=True, text=True).stdout.splitlines()
        found += [(path.name, line) for line in lines if re.match(r"[0-9a-f]+ [WVu] ", line)]
    return found


def main():
    if not shutil.which("nm"):
        print("there is no nm")
        return SKIPPED
    objects = sorted(pathlib.Path(sys.argv[1]).rglob("*_avx*.cpp.o"))
    if not objects:
        print("no file is compiled for one level here")
        return SKIPPED
    found = merged_symbols(objects)
    for name, line in found:
        print(f"{name}: {line}")
    # The check itself: an ordinary file does define such symbols.
    ordinary = sorted(pathlib.Path(sys.argv[1]).rglob("unit_search.cpp.o"))
    if not ordinary or not merged_symbols(ordinary):
        print("no such symbol in unit_search.cpp.o either: nm is not understood")
        return 1
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
