#!/usr/bin/env python3
"""Normals, outliers and a voxel grid from file to file, ours and PCL's in turns, and what the sides of normals cost.

    files.py --bin BUILD/bin --work FOLDER [--points 400000,1000000,4000000,10000000] [--rounds 3]

Seconds of the processor of whole processes on one thread, medians. Ours read a LAS file and write a PLY file, or read
and write trees, with all attributes; PCL's programs (bench_filters_pcl and bench_voxels_pcl, built with
PCM_BENCH_PEERS=ON) read doubles and write floats, doubles or bytes: positions alone. The voxel grid also runs on a PLY
file of the positions that PCL reads. Prints Markdown.
"""
import argparse
import pathlib
import statistics
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from study.process import timed  # noqa: E402
from voxels.run import scene  # noqa: E402

NEIGHBOURS, SIGMAS, VOXEL = 16, 2, 0.1
OURS = {"normals": ["-k", NEIGHBOURS, "--no-confidence"], "outliers": ["-k", NEIGHBOURS, "-a", SIGMAS], "voxel": ["-s", VOXEL]}


def positions_as_ply(raw):
    """The positions, doubles in a file, with the header that makes them a PLY file."""
    ply = raw.with_suffix(".ply")
    header = "".join(f"property double {axis}\n" for axis in "xyz")
    ply.write_bytes(f"ply\nformat binary_little_endian 1.0\nelement vertex {raw.stat().st_size // 24}\n{header}end_header\n".encode()
                    + raw.read_bytes())
    return ply


def commands(bench, tree, raw):
    """For each filter: who, and the command."""
    las, common = tree.with_suffix(".las"), ["-q", "-t", 1, "--overwrite"]
    ply, pct, result = (bench.work / name for name in ("files.ply", "files.pct", "files.bin"))
    for name, options in OURS.items():
        yield name, "LAS to PLY", [bench.bin / "pcmlab", name, las, "-o", ply, *options, *common]
        yield name, "tree to tree", [bench.bin / "pcmlab", name, tree, "-o", pct, *options, *common]
        if name == "voxel":
            yield name, "positions alone, PLY to PLY", [bench.bin / "pcmlab", name, positions_as_ply(raw), "-o", ply, *options, *common]
            program, arguments = "bench_voxels_pcl", [VOXEL, 1, raw, result]
        else:
            program, arguments = "bench_filters_pcl", [name, NEIGHBOURS, 1, SIGMAS, 0, raw, result]
        if (bench.bin / program).exists():
            yield name, "PCL", [bench.bin / program, *arguments]
    sides = [bench.bin / "pcmlab", "normals", tree, "-o", pct, *common]
    yield "sides", "the same along each surface", sides
    yield "sides", "by a direction", [*sides, "--direction", 0, 0, 1]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--points", default="400000,1000000,4000000,10000000")
    parser.add_argument("--rounds", type=int, default=3)
    bench = parser.parse_args()
    bench.work.mkdir(parents=True, exist_ok=True)
    print("| points | what | how | CPU s | least to most |\n|---:|---|---|---:|---:|")
    for points in map(int, bench.points.split(",")):
        bench.points = points
        rows = list(commands(bench, *scene(bench, "origin")))
        seconds = [[] for _ in rows]
        for _ in range(bench.rounds):
            for taken, (_, _, command) in zip(seconds, rows):
                taken.append(timed(command, {"OMP_NUM_THREADS": "1"})[1]["cpu"])
        for taken, (name, how, _) in zip(seconds, rows):
            print(f"| {points:,} | {name} | {how} | {statistics.median(taken):.3g} | {min(taken):.3g} to {max(taken):.3g} |", flush=True)


if __name__ == "__main__":
    main()
