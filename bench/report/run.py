#!/usr/bin/env python3
"""True error over processor time of every feature that trades one for the other, on one page.

    run.py --bin BUILD/bin                         measures what is missing, writes bench/results/REPORT.md and REPORT.html
    run.py --bin BUILD/bin --quick                 smaller clouds: within an hour on two cores
    run.py --bin BUILD/bin --only radii normals    these features; the others stay as they were measured
    run.py --bin BUILD/bin --again                 measures anew what is there
    run.py --report                                draws the page again
    run.py --list                                  the names of the features

A feature is a file in features/, which says what an error is and who takes part. It is measured at the origin and on the map; all programs take
turns, and their processor time counts. OUT/report/NAME.json keeps its figures, with the machine and its load: an interrupted run goes on where it
stopped. Peers that are not here are named on the page. Needs NumPy, SciPy, Matplotlib and laspy; packaging/test-python makes build/test-python, which has
them, and --python names an interpreter that has. Our Python module is used where it was built (-DPCM_WITH_PYTHON=ON).
"""
import argparse
import os
import pathlib
import sys
import time

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"  # before NumPy is loaded: peers have one thread, as ours
BENCH = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(BENCH))
from pictures import packages  # noqa: E402

packages.require(("numpy", "scipy", "matplotlib", "laspy"))
from report import features, page, store  # noqa: E402
from report.lab import FULL, QUICK, SMOKE, Lab  # noqa: E402

SMOKE_FEATURES = ["nearest", "voxels"]


def measure(lab, kept, names):
    """Measures the features that are not kept, one after the other; the names of those that failed."""
    failed = []
    for name in names:
        if kept.has(name):
            print(f"{name}: is there", flush=True)
            continue
        start, load = time.monotonic(), os.getloadavg()[0]
        feature = features.load(name)
        try:
            rows, absent = feature.measure(lab), feature.absent(lab)
        except (RuntimeError, OSError, ValueError, KeyError) as error:
            print(f"{name}: not measured: {type(error).__name__}: {error}", file=sys.stderr, flush=True)
            failed.append(name)
            continue
        kept.put(name, {"rows": rows, "absent": absent, "load": [load, os.getloadavg()[0]], "took": time.monotonic() - start, "machine": lab.machine()})
        print(f"{name}: {len(rows)} rows, {time.monotonic() - start:.0f} s", flush=True)
    return failed


def read_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, help="where pcmlab and the benchmarks are")
    parser.add_argument("--out", type=pathlib.Path, default=BENCH / "results", help="gets REPORT.md, REPORT.html and report/ (default: bench/results)")
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("/tmp/pcm-report"), help="folder for clouds (default: /tmp/pcm-report)")
    parser.add_argument("--only", nargs="+", default=[], metavar="FEATURE")
    parser.add_argument("--again", action="store_true", help="measure again what is there")
    parser.add_argument("--report", action="store_true", help="only the page")
    parser.add_argument("--python", help="start with this interpreter")
    parser.add_argument("--list", action="store_true", help="print the names of the features")
    sizes = parser.add_mutually_exclusive_group()
    sizes.add_argument("--quick", action="store_true", help="smaller clouds: within an hour on two cores")
    sizes.add_argument("--smoke", action="store_true", help="tiny clouds, two features, once: that it works")
    arguments = parser.parse_args()
    unknown = [name for name in arguments.only if name not in features.NAMES]
    if unknown:
        parser.error(f"there is no feature {', '.join(unknown)}; there are {', '.join(features.NAMES)}")
    if not (arguments.bin or arguments.report or arguments.list):
        parser.error("--bin is needed to measure")
    return arguments


def main():
    arguments = read_arguments()
    if arguments.list:
        print("\n".join(features.NAMES))
        return
    size = SMOKE if arguments.smoke else QUICK if arguments.quick else FULL
    names = arguments.only or (SMOKE_FEATURES if arguments.smoke else features.NAMES)
    kept = store.Store(arguments.out / "report", size.name)
    failed = []
    if not arguments.report:
        if arguments.again or arguments.smoke:
            kept.drop(names)
        failed = measure(Lab(arguments.bin, arguments.work, size), kept, names)
    page.write(arguments.out, kept)
    if arguments.smoke:
        page.check(arguments.out, kept, names)
    if failed:
        sys.exit(f"not measured: {', '.join(failed)}; they are tried again when this is started again")


if __name__ == "__main__":
    main()
