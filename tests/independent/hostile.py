#!/usr/bin/env python3
"""Every sample is read or refused in bounded time and memory, and refusals name what is wrong.

    hostile.py --dump DUMP_CLOUD --data FOLDER

bad/ is refused with the path, a byte or a line; edge/ is read, as many points as EDGE says, or refused with a reason; and no
file of the folder, these and the good ones, takes more than 256 MB of memory or half a minute. Prints the messages.
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import threading
import time

import check

MOST_MEMORY = 256 << 20
MOST_SECONDS = 30

# The expected result: points, or None for a refusal.
EDGE = {
    "InvalidCVHeader.e57": 0,  # the length of a section is a lie, of a section without points
    "all_atomic_types_ok_ascii.ply": None,  # its one element is 'point'; the points of a PLY are its 'vertex'
    "bad_vlr_count.las": 10,  # the header promises a VLR too many: noted, the points do not depend on it
    "badheader.txt": None,  # the columns are X, Y, X
    "cube_binary_header_with_RN_newline.ply": 8,
    "empty.e57": 0,
    "empty_ok_ascii.ply": 0,
    "exponent_values_ok_ascii.ply": None,  # 'point' again
    "leading_spaces_ok_ascii.ply": None,
    "malformed_extrabytes.las": 10,  # they do not fit the records: noted
    "simple_text.ply": 3,
    "sized_dims.ply": None,  # no z
    "unsized_dims.ply": None,
    "utm17_comma.pcd": 10,
    "utm17_tab.pcd": 10,
}


def read(dump, path):
    """(exit code, JSON line or None, message, bytes of memory, seconds)."""
    started = time.monotonic()
    process = subprocess.Popen([dump, path], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    timer = threading.Timer(MOST_SECONDS, process.kill)
    timer.start()
    out, message = process.stdout.read(), process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    timer.cancel()
    process.returncode = os.waitstatus_to_exitcode(status)
    process.stdout.close()
    process.stderr.close()
    line = json.loads(out) if process.returncode == 0 else None
    return process.returncode, line, message.strip(), usage.ru_maxrss * 1024, time.monotonic() - started


def wrong_with(name, path, code, line, message):
    """The difference from the expected result, or None."""
    folder, file = pathlib.PurePath(name).parts[0], path.name
    if code not in (0, 1):
        return f"ended with {code}: a crash, or more than {MOST_SECONDS} s"
    if code == 1 and str(path) not in message:
        return "the message does not name the file"
    if folder == "bad":
        if code == 0:
            return f"read {line['points']} points; it must be refused"
        if not re.search(r"\b(bytes?|lines?) \d+|file is empty", message):
            return "the message names no byte and no line"
    elif folder == "edge":
        if file not in EDGE:
            return "EDGE does not say what is right"
        got = line["points"] if line else None
        if got != EDGE[file]:
            return f"read {got} points, expected {EDGE[file]}"
    elif code != 0:
        return "refused, though it is good"
    return None


def main():
    arguments = check.common_arguments(__doc__)
    files = [path for path in sorted(arguments.data.rglob("*"))
             if path.is_file() and path.suffix not in (".csv", ".json", ".md")]
    if not files:
        check.skip(f"no sample clouds in {arguments.data}")
    failed = 0
    worst = 0
    for path in files:
        name = str(path.relative_to(arguments.data))
        code, line, message, memory, seconds = read(arguments.dump, path)
        worst = max(worst, memory)
        wrong = wrong_with(name, path, code, line, message)
        if not wrong and memory > MOST_MEMORY:
            wrong = "too much memory"
        failed += bool(wrong)
        if wrong or name.startswith(("bad/", "edge/")):
            outcome = f"{line['points']} points of {line['format']}" if line else "refused"
            print(f"{name}: {outcome} ({memory >> 20} MB, {seconds:.2f} s)")
            for text in ([message.replace(str(arguments.data) + "/", "")] if message else []) + (line["notes"] if line else []):
                print(f"    {text}")
            if wrong:
                print(f"    WRONG: {wrong}")
    print(f"{len(files) - failed} of {len(files)} files as they should be, at most {worst >> 20} MB")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
