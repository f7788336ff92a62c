"""What the studies have in common: a table of runs that grows, and resumes."""
import json
import os
import pathlib
import random
import subprocess
import sys
import time

import machine
import paths
from table import Table

HERE = pathlib.Path(__file__).resolve().parent


def call(command):
    """What it prints; RuntimeError with its error message when it fails."""
    result = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    if result.returncode:
        raise RuntimeError(f"{pathlib.Path(str(command[0])).name} {' '.join(map(str, command[1:3]))}: "
                           f"{(result.stderr or result.stdout).strip()[-500:] or f'ended with {result.returncode}'}")
    return result.stdout


def add_arguments(parser, program, quick):
    parser.add_argument("--bin", type=pathlib.Path, help=f"where pcmlab and {program} are")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--cloud", action="append", default=[], help="NAME=FILE or FILE, in addition to the generated ones")
    parser.add_argument("--path", action="append", default=[], type=pathlib.Path, help="a camera path, in addition to the generated ones")
    parser.add_argument("--repeat", type=int)
    parser.add_argument("--again", action="append", default=[], metavar="STUDY", help="measure it again, whatever results.csv has of it")
    parser.add_argument("--report", action="store_true", help="only plots and report")
    group = parser.add_mutually_exclusive_group()
    group.add_argument("--quick", action="store_true", help=quick)
    group.add_argument("--smoke", action="store_true", help="tiny, once: that it works")


def begin(parser, arguments, plan):
    """The plan's size of study, and what has been measured."""
    size = plan.SMOKE if arguments.smoke else plan.QUICK if arguments.quick else plan.FULL
    size.repeat = arguments.repeat or size.repeat
    arguments.out.mkdir(parents=True, exist_ok=True)
    if arguments.smoke:
        (arguments.out / "results.csv").unlink(missing_ok=True)
    table = Table(arguments.out / "results.csv", plan.KEYS)
    for study in arguments.again:
        table.drop(study)
    if not arguments.report and not arguments.bin:
        parser.error("--bin is needed to measure")
    return size, table


def describe_machine(out, work, about):
    """Written once: a resumed study belongs to the machine that it was started on."""
    file = out / "sys_info.txt"
    if file.exists():
        return
    result = subprocess.run(["git", "-C", HERE, "describe", "--always", "--dirty"], capture_output=True, text=True, check=False)
    file.write_text(machine.describe(work, about, result.stdout.strip() or "of unknown source"), encoding="utf-8")


def path_files(work, size, own):
    """Name: file."""
    files = {name: file for name, file in paths.write(work / "paths", size.frames).items() if name in size.paths}
    for file in own:
        files[json.loads(file.read_text(encoding="utf-8")).get("name", file.stem)] = file
    return files


def measure(table, rows, repeat, figures_of, order=None):
    """Adds the figures of each row that the table lacks; how many failed. In random order, so that all meet the same machine; where there is
    an `order`, by that first, so that there are whole curves when it is ended early."""
    todo = []
    for repetition in range(1, repeat + 1):
        turn = [{**row, "repetition": repetition} for row in rows]
        random.Random(repetition).shuffle(turn)
        if order:
            turn.sort(key=order)
        todo += [row for row in turn if not table.has(row)]
    print(f"{len(rows)} configurations, {repeat} repetitions; {len(todo)} runs are to be made", flush=True)
    failed, start = 0, time.monotonic()
    for done, row in enumerate(todo, 1):
        load = os.getloadavg()[0]
        try:
            table.add({**row, "load": load, **figures_of(row)})
        except (RuntimeError, ValueError) as error:
            failed += 1
            print(f"failed: {error}", file=sys.stderr, flush=True)
        if done % 20 == 0 or done == len(todo):
            spent = time.monotonic() - start
            print(f"{done} of {len(todo)} runs, {spent:.0f} s, {spent / done * (len(todo) - done):.0f} s to go", flush=True)
    return failed


def end(failed):
    if failed:
        sys.exit(f"{failed} runs failed; they are made again when this is started again")


def check_report(table, rows, out):
    """Of a smoke run: every configuration is in the file, and what the report shows is there. Its text."""
    again = Table(table.file, table.keys_of_a_run)
    assert all(again.has({**row, "repetition": 1}) for row in rows), "a configuration was not measured, or is not found again"
    text = (out / "report.md").read_text(encoding="utf-8")
    for line in text.splitlines():
        if line.startswith("!["):
            picture = out / line.rpartition("(")[2].rstrip(")")
            assert picture.stat().st_size > 1000, f"{picture} is empty"
    return text
