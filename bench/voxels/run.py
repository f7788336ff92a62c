"""Voxel grids: ours in memory and of a tree, compared with PCL's and Open3D's, in turns. Time, memory, the number of voxels,
and the errors of the centroids, of clouds at the origin and at map coordinates.

    python3 bench/voxels/run.py --bin build/release/bin --work /tmp/voxels [--points 2000000] [--rounds 5] [--python PYTHON]

NumPy is needed; PCL's program is built with -DPCM_BENCH_PEERS=ON, PYTHON is one that has Open3D.
"""
import argparse
import json
import pathlib
import statistics
import subprocess
import sys

import numpy

PLACES = {"origin": (0.0, 0.0, 0.0), "map": (500000.0, 4800000.0, 100.0)}


def exact(positions, size, least):
    """The number of points and the centroid of each voxel, in the order of their numbers: exactly but for the last bit.
    Positions are whole steps of a millimetre, so sums of steps are exact."""
    numbers = numpy.floor((positions - least) / size).astype(numpy.int64)
    order = numpy.lexsort(numbers.T)
    numbers = numbers[order]
    begins = numpy.flatnonzero(numpy.r_[True, numpy.any(numbers[1:] != numbers[:-1], axis=1)])
    counts = numpy.diff(numpy.r_[begins, len(order)])
    steps = numpy.round(positions[order] * 1000).astype(numpy.int64)
    first = steps[begins]
    sums = numpy.add.reduceat(steps - numpy.repeat(first, counts, axis=0), begins)
    centroids = (first.astype(numpy.longdouble) + sums / counts[:, None].astype(numpy.longdouble)) / 1000
    return numbers[begins], centroids


def errors(found, numbers, centroids, size, least):
    """The largest difference of a coordinate from the exact centroid of its voxel; none where the voxels are others."""
    voxels = numpy.floor((found - least) / size).astype(numpy.int64)
    order = numpy.lexsort(voxels.T)
    if not numpy.array_equal(voxels[order], numbers):
        return None
    return float(numpy.max(numpy.abs(found[order].astype(numpy.longdouble) - centroids)))


def scene(arguments, place):
    """A generated scan as a tree, and its positions as doubles."""
    las, tree, raw = (arguments.work / f"{place}-{arguments.points}{suffix}" for suffix in (".las", ".pct", ".f64"))
    if not raw.exists():
        pcmlab = arguments.bin / "pcmlab"
        subprocess.run([pcmlab, "generate", "-q", "--overwrite", "--no-truth", "-n", str(arguments.points), "--origin",
                        ",".join(map(str, PLACES[place])), las], check=True)
        subprocess.run([pcmlab, "build", "-q", "--overwrite", las, "-o", tree], check=True, stdout=subprocess.DEVNULL)
        data = las.read_bytes()
        begin, length = int.from_bytes(data[96:100], "little"), int.from_bytes(data[105:107], "little")
        records = numpy.frombuffer(data, numpy.uint8, offset=begin)
        records = records[:len(records) // length * length].reshape(-1, length)[:arguments.points]
        steps = numpy.ascontiguousarray(records[:, :12]).view("<i4").astype(numpy.float64)
        scale, offset = numpy.frombuffer(data, "<f8", 3, 131), numpy.frombuffer(data, "<f8", 3, 155)
        (steps * scale + offset).tofile(raw)
    return tree, raw


def programs(arguments, tree, raw):
    ours = [str(arguments.bin / "bench_voxels")]
    found = {"ours, of a tree": (ours, tree), "ours, in memory": (ours, raw)}
    pcl = arguments.bin / "bench_voxels_pcl"
    if pcl.exists():
        found["PCL"] = ([str(pcl)], raw)
    if arguments.python:
        found["Open3D"] = ([arguments.python, str(pathlib.Path(__file__).parent / "voxels_open3d.py")], raw)
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--points", type=int, default=2000000)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--python", default="", help="a Python that has Open3D")
    parser.add_argument("--smoke", action="store_true", help="few points, once")
    arguments = parser.parse_args()
    if arguments.smoke:
        arguments.points, arguments.rounds = 20000, 1
    arguments.work.mkdir(parents=True, exist_ok=True)
    wrong = []
    print("| points at | voxel, m | program | CPU s | wall s | peak MB | voxels | exact | largest error, m |\n"
          "|---|---:|---|---:|---:|---:|---:|---:|---:|")
    for place in PLACES:
        tree, raw = scene(arguments, place)
        positions = numpy.fromfile(raw).reshape(-1, 3)
        for size in (0.05, 0.5):
            numbers, centroids = exact(positions, size, 0)
            runs = {}
            result = arguments.work / "result.f64"
            for _ in range(arguments.rounds):
                for name, (command, source) in programs(arguments, tree, raw).items():
                    done = subprocess.run([*command, str(size), str(arguments.threads), str(source), str(result)],
                                          capture_output=True, text=True)
                    if done.returncode != 0:
                        sys.exit(f"{name}: {done.stderr}")
                    runs.setdefault(name, []).append(json.loads(done.stdout.splitlines()[-1]))
                    runs[name][-1]["found"] = numpy.fromfile(result).reshape(-1, 3)
            for name, all_runs in runs.items():
                found = all_runs[-1]["found"]
                expected = (numbers, centroids)
                least = 0
                if name == "Open3D":
                    least = positions.min(axis=0) - size / 2
                    expected = exact(positions, size, least)
                error = errors(found, *expected, size, least)
                middle = {key: statistics.median(run[key] for run in all_runs) for key in ("cpu_seconds", "seconds", "peak_mb")}
                print(f"| {place} | {size} | {name} | {middle['cpu_seconds']:.3f} | {middle['seconds']:.3f} | "
                      f"{middle['peak_mb']:.0f} | {len(found):,} | {len(expected[0]):,} | "
                      f"{'-' if error is None else f'{error:.1e}'} |", flush=True)
                if name.startswith("ours") and not (error is not None and error <= 1e-9):
                    wrong.append((place, size, name))
    if wrong:
        sys.exit(f"wrong: {wrong}")


if __name__ == "__main__":
    main()
