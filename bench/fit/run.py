#!/usr/bin/env python3
"""Error against run time of fitting one shape: ours compared with PCL's sample consensus and CGAL's efficient RANSAC.

    python3 bench/fit/run.py --bin build/release/bin --out /tmp/fits [--seeds 100] [--again GROUP] [--report]

Each scene is made anew for each seed, and all methods take turns on it. Rows go to OUT/GROUP.jsonl, one per fit; a group
that is there is not measured again. OUT/report.md and its pictures are drawn from them (bench/fit/report.py).
"""
import argparse
import json
import math
import os
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import report  # noqa: E402

OWN = ["own-ransac", "own-msac", "own-mlesac", "own-prosac", "own-rransac", "own-rmsac"]
PCL = ["pcl-ransac", "pcl-msac", "pcl-mlesac", "pcl-prosac", "pcl-rransac", "pcl-rmsac"]
SOME = ["own-msac", "pcl-ransac", "pcl-msac", "pcl-rmsac", "cgal"]
MAP = "500000 4800000 100"
KINDS = ("plane", "cylinder", "sphere")


def scenes():
    """Group, case, options of bench_fit, methods, share of the seeds."""
    for kind in KINDS:
        yield "table", f"{kind} 30 %", f"--kind {kind} --threshold 0.015", OWN + PCL + ["pcl-ransac-raw", "cgal"], 1
        yield "endless", kind, f"--kind {kind} --threshold 0.015", ["pcl-rransac-default", "pcl-rmsac-default"], 0.1
        yield "table", f"{kind} 60 %", f"--kind {kind} --threshold 0.015 --outliers 0.6 --probability 0.9999", OWN + PCL + ["pcl-ransac-raw", "cgal"], 1
        yield "automatic", kind, f"--kind {kind}", ["own-msac"], 1
        yield "automatic", f"{kind}, normals not given", f"--kind {kind} --threshold 0.015 --without-normals", ["own-msac", "pcl-ransac"], 1
        for percent in range(20, 90, 10):
            yield ("outliers", f"{kind} {percent}", f"--kind {kind} --threshold 0.015 --outliers {percent / 100}",
                   ["own-msac", "own-prosac", "own-rmsac", "pcl-ransac", "pcl-rmsac", "cgal"], 1)
        yield ("budgets", kind, f"--kind {kind} --threshold 0.015 --outliers 0.6 --probability 0.9999999 --iterations 5 10 20 50 100 200 500 1000 2000",
               ["own-msac", "own-rmsac", "pcl-ransac", "pcl-rmsac"], 0.3)
        for milliseconds in (2, 5, 10, 20, 50):
            yield ("seconds", f"{kind} {milliseconds}",
                   f"--kind {kind} --threshold 0.015 --outliers 0.7 --probability 0.999999999999 --iterations 100000000 --seconds {milliseconds / 1000}",
                   ["own-msac", "own-rmsac", "pcl-ransac", "pcl-rmsac", "pcl-rransac-default"], 0.2)
        for sigma in (0.0005, 0.001, 0.002, 0.005, 0.01, 0.02):
            yield "noise", f"{kind} {sigma}", f"--kind {kind} --sigma {sigma} --threshold {3 * sigma}", ["own-msac", "pcl-ransac", "cgal"], 0.3
        for place, offset in (("origin", "0 0 0"), ("map", MAP)):
            yield "offsets", f"{kind} {place}", f"--kind {kind} --sigma 0.001 --threshold 0.003 --offset {offset}", ["own-msac", "pcl-ransac", "cgal"], 1
    yield "table", "cone 30 %", "--kind cone --radius 0.8 --size 2 --threshold 0.015", OWN + PCL + ["pcl-ransac-raw", "cgal"], 1
    stiff = ["own-msac", "pcl-ransac", "pcl-msac", "cgal"]
    for degrees, radius in ((60, 0.5), (40, 0.5), (20, 0.5), (2, 50)):
        yield ("stiff", f"cylinder {degrees}° R {radius}", f"--kind cylinder --arc {degrees} --radius {radius} --size 1 --sigma 0.001 --threshold 0.003",
               stiff, 1)
    for ratio in (10, 100, 1000):
        yield "stiff", f"sphere {ratio} x patch", f"--kind sphere --radius {ratio} --patch 1 --sigma 0.001 --threshold 0.003", stiff, 1
    yield "large", "cylinder", "--kind cylinder --points 100000 --threshold 0.015", SOME, 0.1


def run_case(arguments, options, methods, seeds):
    command = [str(arguments.bin / "bench_fit"), *options.split(), "--seeds", str(seeds), "--methods", *methods]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}\n{done.stderr}")
    return [json.loads(line) for line in done.stdout.splitlines()]


def measure(arguments):
    groups = {}
    for group, case, options, methods, share in scenes():
        groups.setdefault(group, []).append((case, options, methods, share))
    for group, cases in groups.items():
        path = arguments.out / f"{group}.jsonl"
        if path.exists() and group not in arguments.again:
            continue
        lines = []
        for case, options, methods, share in cases:
            rows = run_case(arguments, options, methods, max(1, round(arguments.seeds * share)))
            lines += [json.dumps({"case": case, **row}) for row in rows]
            print(f"{group}: {case}", flush=True)
        path.with_suffix(".part").write_text("\n".join(lines) + "\n")
        path.with_suffix(".part").rename(path)


def measure_memory(arguments):
    """What one fit takes at most, each method in a process of its own."""
    path = arguments.out / "memory.json"
    if path.exists() and "memory" not in arguments.again:
        return
    found = {}
    for method in SOME:
        points = 2000 if arguments.smoke else 100000
        last = run_case(arguments, f"--kind cylinder --points {points} --threshold 0.015 --memory", [method], 1)[-1]
        found[method] = last["taken_mb"]
    path.write_text(json.dumps(found, indent=1) + "\n")


def check(arguments):
    """What has to hold of any run: ours end with finite numbers, and find what is easy."""
    wrong = []
    for row in report.rows_of(arguments.out, "table"):
        if row["method"] == "oracle" or row["method"].startswith("own-"):
            good = row["found"] and all(math.isfinite(row[key]) for key in ("surface", "angle", "position", "radius"))
            if not good or row["surface"] > 0.015:
                wrong.append(row)
    if wrong:
        sys.exit(f"{len(wrong)} fits are wrong, the first: {wrong[0]}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--again", nargs="*", default=[], help="groups to measure again")
    parser.add_argument("--report", action="store_true", help="only draw what is there")
    parser.add_argument("--smoke", action="store_true", help="two seeds of a few scenes")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    if arguments.smoke:
        arguments.seeds = 2
        arguments.again = ["table", "memory"]
        everything = list(scenes())
        globals()["scenes"] = lambda: [row for row in everything if row[0] in ("table", "offsets") and "60" not in row[1]]
    if not arguments.report:
        measure(arguments)
        measure_memory(arguments)
        (arguments.out / "sys_info.txt").write_text(system_info())
    check(arguments)
    report.write(arguments.out)


def system_info():
    model = next((line.split(":")[1].strip() for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("model name")), "?")
    return f"{model}, {os.cpu_count()} threads; load {os.getloadavg()[0]:.1f} at the end\n"


if __name__ == "__main__":
    main()
