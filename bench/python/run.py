#!/usr/bin/env python3
"""What six tasks take in Python with pcmlab, laspy and Open3D: lines, processor seconds and memory, in turns, on the same cloud.

    PYTHONPATH=BUILD/python run.py --bin BUILD/bin [--python PYTHON] [--points N] [--work FOLDER] [--repeat N] [--task NAME...] [--json FILE]
    run.py --bin BUILD/bin --smoke     a small cloud, once: that it works, and that all agree

A generated scan is written as LAS and built into a tree, whose processor seconds are a row of their own: pcmlab needs them once for
a cloud. Each task runs in a process of its own, with what it imports; the imports alone are a row, too. The answers have to agree.
What this Python lacks is named and left out. Medians of the repetitions; memory is the largest resident set of the process.
"""
import argparse
import importlib
import inspect
import json
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
TASKS = {"imports": "imports alone", "count": "number of points, and bounds", "box": "points of a box of 20 m with two attributes, as arrays",
         "mean_height": "mean height of the ground, in bounded memory", "nearest": "8 neighbours of 1,000 places",
         "outliers": "statistical outliers left out, to a file", "reclassify": "another class for the points of a box, saved"}


def run_task(program, task, files):
    """The task, in its own process."""
    files["box"] = [500010, 4800010, 90, 500030, 4800030, 110]
    module = importlib.import_module(f"with_{program}")
    if task == "nearest":
        import numpy

        files["places"] = numpy.random.default_rng(1).uniform([500000, 4800000, 94], [500060, 4800060, 100], (1000, 3))
    answer = [] if task == "imports" else [float(number) for number in getattr(module, task)(files)]
    used = resource.getrusage(resource.RUSAGE_SELF)
    # Of this program alone: ru_maxrss is at least that of the process that started it.
    memory = next(int(line.split()[1]) * 1024 for line in open("/proc/self/status", encoding="ascii") if line.startswith("VmHWM:"))
    print(json.dumps({"answer": answer, "cpu": used.ru_utime + used.ru_stime, "memory": memory}))


def modules():
    """Name of a program -> its tasks; those that can be imported."""
    found = {}
    for program in ("pcmlab", "laspy", "open3d"):
        try:
            found[program] = importlib.import_module(f"with_{program}")
        except ImportError as error:
            print(f"left out: {program} ({error})", flush=True)
    return found


def lines_of(module, task):
    """Lines of the task's function and of those of its module that it calls; not their heads and blank lines."""
    functions = [getattr(module, task)]
    text = inspect.getsource(functions[0])
    functions += [value for name, value in vars(module).items() if inspect.isfunction(value) and name not in TASKS and f"{name}(" in text]
    return sum(bool(line.strip()) for function in functions for line in inspect.getsource(function).splitlines()[1:])


def agree(a, b):
    return len(a) == len(b) and all(abs(x - y) <= 1e-9 * max(abs(x), abs(y), 1) for x, y in zip(a, b))


def processor_seconds(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def measured(work, programs, tasks, repeat):
    """task -> program -> {"lines", "cpu", "memory"}: medians; the programs take turns."""
    files = {"las": str(work / "scan.las"), "tree": str(work / "scan.pct"), "out": str(work / "out")}
    rows = {}
    for task in tasks:
        runs = {name: [] for name, module in programs.items() if task == "imports" or hasattr(module, task)}
        for _ in range(repeat):
            for name, those in runs.items():
                for old in work.glob("out.*"):
                    old.unlink()
                done = subprocess.run([sys.executable, "-B", str(HERE / "run.py"), "--run", name, task, json.dumps(files)],
                                      stdout=subprocess.PIPE, text=True, check=True)
                those.append(json.loads(done.stdout.splitlines()[-1]))
        answers = {name: run["answer"] for name, those in runs.items() for run in those}
        for name, answer in answers.items():
            if not agree(answer, next(iter(answers.values()))):
                sys.exit(f"{task}: the answers differ: {answers}")
        rows[task] = {name: {"lines": 0 if task == "imports" else lines_of(programs[name], task),
                             "cpu": statistics.median(run["cpu"] for run in those),
                             "memory": statistics.median(run["memory"] for run in those)} for name, those in runs.items()}
    return rows


def show(rows, programs, build):
    print(f"| task | {' | '.join(f'{name}: lines, CPU s, MB' for name in programs)} |\n|---|{'---:|' * len(programs)}")
    print(f"| building the tree, once | {build:.2f} s |{' – |' * (len(programs) - 1)}")
    for task, row in rows.items():
        cells = [f"{row[name]['lines']}, {row[name]['cpu']:.2f}, {row[name]['memory'] / 1e6:.0f}" if name in row else "–" for name in programs]
        print(f"| {TASKS[task]} | {' | '.join(cells)} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path)
    parser.add_argument("--python", type=pathlib.Path, help="the Python that has the other programs (default: this one)")
    parser.add_argument("--points", type=int, default=5_000_000)
    parser.add_argument("--work", type=pathlib.Path, help="folder for the clouds (default: a temporary one)")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--task", choices=list(TASKS), action="append")
    parser.add_argument("--json", type=pathlib.Path)
    parser.add_argument("--smoke", action="store_true")
    parser.add_argument("--run", nargs=3, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.python and arguments.python.exists() and "PCM_TASKS_PYTHON" not in os.environ:
        os.execve(arguments.python, [str(arguments.python), "-B", *sys.argv], dict(os.environ, PCM_TASKS_PYTHON="1"))
    sys.path.insert(0, str(HERE))
    if arguments.run:
        return run_task(*arguments.run[:2], json.loads(arguments.run[2]))
    programs = modules()
    if "pcmlab" not in programs or len(programs) < 2:
        print("skipped: pcmlab and one other program are needed")
        sys.exit(77)
    if arguments.smoke:
        arguments.points, arguments.repeat = 100_000, 1
    with tempfile.TemporaryDirectory() as temporary:
        work = arguments.work or pathlib.Path(temporary)
        work.mkdir(parents=True, exist_ok=True)
        pcmlab = str(arguments.bin.resolve() / "pcmlab")
        subprocess.run([pcmlab, "generate", "-q", "--overwrite", "-n", str(arguments.points), "--no-truth", str(work / "scan.las")], check=True, stdout=subprocess.DEVNULL)
        build = processor_seconds([pcmlab, "build", "-q", "--overwrite", str(work / "scan.las"), "-o", str(work / "scan.pct")])
        rows = measured(work, programs, arguments.task or TASKS, arguments.repeat)
    show(rows, programs, build)
    if arguments.json:
        arguments.json.write_text(json.dumps({"points": arguments.points, "build": build, "tasks": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
