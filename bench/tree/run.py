#!/usr/bin/env python3
"""What a tree costs: building it, at growing sizes and compared with another program, and getting at its points again.

    run.py --bin BUILD/bin [--points 5e6,20e6] [--peer "NAME=COMMAND"] [--repeat N] [--memory 512M] [--json FILE] [--keep]
    run.py --bin BUILD/bin --smoke     a tiny scene, once: that it works

A peer's COMMAND has {input}, {output} (a name in a folder of its own), {threads} and {memory_mb}. Builders take turns in one run so that all
meet the same machine; medians count. Input and tree are dropped from the system's cache before each run. Time, processor time
and peak memory are those of the whole process, scratch is the largest size that the output's folder had less what is left
in the end, and an exponent says how a figure grows with the number of points (1: in proportion).
"""
import argparse
import json
import math
import os
import pathlib
import platform
import shlex
import shutil
import statistics
import subprocess
import sys
import threading
import time


def drop_cache(path):
    files = [path] if path.is_file() else [f for f in path.rglob("*") if f.is_file()]
    for file in files:
        with open(file, "rb") as f:
            os.fsync(f.fileno())
            os.posix_fadvise(f.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)


def bytes_on_disk(folder):
    total = 0
    for root, _, files in os.walk(folder):
        for name in files:
            try:
                total += os.stat(os.path.join(root, name)).st_blocks * 512
            except FileNotFoundError:
                pass
    return total


def run(command, environment=None, watch=None):
    """Wall and processor seconds, peak memory, largest size of the folder `watch`, output."""
    largest, done = 0, threading.Event()

    def look():
        nonlocal largest
        while not done.wait(0.1):
            largest = max(largest, bytes_on_disk(watch))

    if watch:
        thread = threading.Thread(target=look)
        thread.start()
    start = time.monotonic()
    process = subprocess.Popen([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               env={**os.environ, **(environment or {})})
    out, err = process.communicate()
    seconds = time.monotonic() - start
    if watch:
        done.set()
        thread.join()
        largest = max(largest, bytes_on_disk(watch))
    return {"seconds": seconds, "out": out, "err": err, "code": process.returncode, "largest": largest}


def measured(command, watch):
    """run(), with the processor time and the peak memory of the process alone: a process of its own waits for it."""
    helper = ("import os, resource, subprocess, sys; code = subprocess.call(sys.argv[1:]); u = resource.getrusage(resource.RUSAGE_CHILDREN);"
              "print('\\nCOST', u.ru_utime + u.ru_stime, u.ru_maxrss * 1024); sys.exit(code)")
    result = run([sys.executable, "-c", helper, *command], watch=watch)
    if result["code"]:
        return {"failed": (result["err"] or result["out"]).strip()[-300:]}
    out, _, cost = result["out"].rpartition("\nCOST")
    cpu, memory = cost.split()
    return {"seconds": result["seconds"], "cpu": float(cpu), "rss": int(memory), "largest": result["largest"], "out": out}


def build_rows(arguments, memory_mb):
    pcm = arguments.bin / "pcmlab"
    ours = [pcm, "build", "{input}", "-o", "{output}.pct", "-m", arguments.memory, "-t", arguments.threads, "--json"]
    rows = {"pcmlab": ours, "pcmlab --fast": [*ours, "--fast"]}
    for peer in arguments.peer:
        name, command = peer.split("=", 1)
        rows[name] = shlex.split(command)
    return rows


def fill(command, **values):
    return [str(part).format(**values) if "{" in str(part) else str(part) for part in command]


def exponent(points, values):
    if len(points) < 2 or min(values) <= 0:
        return None
    x, y = [math.log(p) for p in points], [math.log(v) for v in values]
    mx, my = statistics.mean(x), statistics.mean(y)
    return sum((a - mx) * (b - my) for a, b in zip(x, y)) / sum((a - mx) ** 2 for a in x)


def build_all(arguments, work):
    memory_mb = int(arguments.memory.rstrip("M"))
    rows = build_rows(arguments, memory_mb)
    table = []
    for points in arguments.points:
        scene = work / f"scene-{points}.las"
        if not scene.exists():
            subprocess.run([arguments.bin / "pcmlab", "generate", "-n", str(points), *(["--extent", str(arguments.extent)] if arguments.extent else []), str(scene)], check=True, stdout=subprocess.DEVNULL)
        results = {name: [] for name in rows}
        for turn in range(arguments.repeat):
            for name, command in rows.items():
                if results[name] and "failed" in results[name][-1]:
                    continue
                folder = work / "output"
                shutil.rmtree(folder, ignore_errors=True)
                folder.mkdir()
                drop_cache(scene)
                result = measured(fill(command, input=scene, output=folder / "tree", threads=arguments.threads, memory_mb=memory_mb),
                                  folder)
                result["bytes"] = bytes_on_disk(folder)
                results[name].append(result)
                if name == "pcmlab" and turn == arguments.repeat - 1 and "failed" not in result:
                    shutil.rmtree(work / f"tree-{points}.pct", ignore_errors=True)
                    shutil.move(folder / "tree.pct", work / f"tree-{points}.pct")
        for name, runs in results.items():
            row = {"points": points, "builder": name}
            failed = [r["failed"] for r in runs if "failed" in r]
            if failed:
                row["failed"] = failed[0]
            else:
                median = lambda key: statistics.median(r[key] for r in runs)
                row.update(seconds=median("seconds"), mpoints_s=points / median("seconds") / 1e6, cpu_us=median("cpu") / points * 1e6,
                           rss_mb=max(r["rss"] for r in runs) / 1e6, bytes_point=median("bytes") / points,
                           scratch_point=max(0, median("largest") - median("bytes")) / points)
                if name.startswith("pcmlab"):
                    report = json.loads(runs[-1]["out"])
                    if "scratch_bytes" in report:
                        row["scratch_point"] = report["scratch_bytes"] / points
            table.append(row)
            print_build(row)
        shutil.rmtree(work / "output", ignore_errors=True)
        if not arguments.keep and points != arguments.points[-1]:
            scene.unlink()
    for name in rows:
        of_it = [r for r in table if r["builder"] == name and "failed" not in r]
        sizes = [r["points"] for r in of_it]
        for key, what in (("seconds", "time"), ("rss_mb", "memory"), ("bytes_point", "bytes a point")):
            e = exponent(sizes, [r[key] for r in of_it])
            if e is not None:
                print(f"{name}: {what} grows with points to the power of {e:.3f}")
    return table


def print_build(row):
    if "failed" in row:
        print(f"{row['points']:>12,} {row['builder']:<14} failed: {row['failed']}", flush=True)
        return
    print(f"{row['points']:>12,} {row['builder']:<14} {row['mpoints_s']:6.2f} M points/s  {row['cpu_us']:5.2f} µs CPU/pt  "
          f"{row['rss_mb']:6.0f} MB  {row['bytes_point']:5.2f} B/pt  scratch {row['scratch_point']:5.2f} B/pt", flush=True)


def ask(arguments, command, tree, repeat, cold, environment=None):
    """Medians of the times of `repeat` processes, each first dropping the tree from the cache when `cold`."""
    answers = []
    for _ in range(repeat):
        if cold:
            drop_cache(tree)
        result = run([arguments.bin / "bench_tree", *command], environment)
        if result["code"]:
            sys.exit(f"bench_tree {command[0]}: {result['err']}")
        answer = json.loads(result["out"])
        answer["process_ms"] = result["seconds"] * 1000
        answers.append(answer)
    return {key: statistics.median(a[key] for a in answers) for key in answers[0]}


def read_tree(arguments, tree, work):
    table = []
    info = json.loads(run([arguments.bin / "pcmlab", "info", "--json", tree])["out"])
    points = info["points"]
    for wanted in arguments.first:
        for cold in (True, False):
            row = ask(arguments, ["first", tree, wanted, arguments.threads], tree, arguments.repeat, cold)
            row.update(tree_points=points, what="first", wanted=wanted, cold=cold)
            table.append(row)
            print(f"{points:>12,} first {wanted:,} points, {'cold' if cold else 'warm'}: {row['process_ms']:.1f} ms the whole process, "
                  f"{row['open_ms']:.1f} to open, {row['total_ms']:.1f} to have {row['points']:,.0f} in memory", flush=True)
    for cold in (True, False):
        row = ask(arguments, ["box", tree, 20, arguments.boxes, arguments.threads, "cold" if cold else "warm"], tree, 1, cold)
        row.update(tree_points=points, what="box", cold=cold)
        table.append(row)
        print(f"{points:>12,} column of 20 m, {'cold' if cold else 'warm'}: {row['box_ms']:.2f} ms ({row['open_ms']:.2f} ms to open the tree before), "
              f"again in the same process {row['again_ms']:.2f} ms, {row['points']:,.0f} points", flush=True)
    library = next(iter(sorted(arguments.bin.parent.rglob("libpcm_latency.so"))), None)
    for latency in arguments.latency if library else []:
        environment = {"LD_PRELOAD": str(library), "PCM_LATENCY_UNDER": str(tree), "PCM_LATENCY_MS": str(latency),
                       "PCM_LATENCY_MBS": str(arguments.bandwidth)}
        for what, command in (("first", ["first", tree, arguments.first[0], arguments.threads]), ("box", ["box", tree, 20, 3, arguments.threads, "warm"])):
            row = ask(arguments, command, tree, arguments.repeat, False, environment)
            row.update(tree_points=points, what=what, latency_ms=latency, mb_s=arguments.bandwidth)
            table.append(row)
            took = row["total_ms"] if what == "first" else row["open_ms"] + row["box_ms"]
            print(f"{points:>12,} {what} over a network of {latency} ms and {arguments.bandwidth} MB/s: {took:.1f} ms from the start", flush=True)
    return table


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("bench-tree"))
    parser.add_argument("--points", type=lambda t: [int(float(p)) for p in t.split(",")], default=[5_000_000, 20_000_000])
    parser.add_argument("--first", type=lambda t: [int(float(p)) for p in t.split(",")], default=[1_000_000, 10_000_000])
    parser.add_argument("--extent", type=float, help="side of the scene in metres; by default it grows with the points")
    parser.add_argument("--boxes", type=int, default=15, help="columns that are read in one run")
    parser.add_argument("--peer", action="append", default=[])
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--memory", default="512M", help="in megabytes, with an M")
    parser.add_argument("--latency", type=lambda t: [float(p) for p in t.split(",")], default=[0.5, 5.0, 50.0])
    parser.add_argument("--bandwidth", type=float, default=100.0, help="of the network that is simulated, MB/s")
    parser.add_argument("--json", type=pathlib.Path)
    parser.add_argument("--keep", action="store_true", help="keep scenes and trees")
    parser.add_argument("--smoke", action="store_true")
    arguments = parser.parse_args()
    if arguments.smoke:
        arguments.points, arguments.first, arguments.repeat, arguments.latency = [20_000, 60_000], [10_000], 1, [1.0]
        arguments.boxes = 2
        arguments.memory = "64M"
        arguments.peer = [f"copy={shlex.quote(str(arguments.bin / 'pcmlab'))} convert {{input}} {{output}}.las"]
    arguments.work.mkdir(parents=True, exist_ok=True)
    work = arguments.work.resolve()
    print(f"{platform.machine()}, {os.cpu_count()} processors, load {os.getloadavg()[0]:.2f}")
    try:
        builds = build_all(arguments, work)
        reads = [row for points in arguments.points if (work / f"tree-{points}.pct").exists()
                 for row in read_tree(arguments, work / f"tree-{points}.pct", work)]
    finally:
        if not arguments.keep:
            shutil.rmtree(work, ignore_errors=True)
    if arguments.json:
        arguments.json.write_text(json.dumps({"builds": builds, "reads": reads}, indent=1))
    if failed := [row for row in builds if "failed" in row]:
        sys.exit(f"{len(failed)} builds failed")


if __name__ == "__main__":
    main()
