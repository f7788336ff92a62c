#!/usr/bin/env python3
"""How fast clouds are read: our readers compared with the machine's limits (memcpy, disk) and with other programs, which take turns
in one run so that all meet the same machine; the median counts.

    run.py --bin BUILD/bin [--work FOLDER] [--repeat N] [--python PYTHON] [--json FILE] CLOUD...
    run.py --bin BUILD/bin --smoke     tiny clouds, once: that it works

A CLOUD is a file, or FORMAT=FILE to name its row. Peers run where they are: BUILD/bin/bench_io_pcl and bench_io_meshlab (built
with PCM_BENCH_PEERS=ON), and laspy, Open3D and plyfile in PYTHON. In addition to the speed it shows what a reader kept: how many
values a point, and the largest error of its positions against the file's (as our reader gives them, which
tests/independent compares with others bit for bit).
"""
import argparse
import json
import os
import pathlib
import platform
import statistics
import subprocess
import sys

OURS = "pcmlab"


class Program:
    """A reader that waits for lines."""

    def __init__(self, command):
        self.process = subprocess.Popen([str(part) for part in command], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        stderr=subprocess.DEVNULL, text=True)

    def ask(self, *fields):
        try:
            self.process.stdin.write("\t".join(map(str, fields)) + "\n")
            self.process.stdin.flush()
            while line := self.process.stdout.readline():
                if line.startswith("{"):  # others print what they like
                    return json.loads(line)
        except BrokenPipeError:
            pass
        return {"failed": f"ended with {self.process.wait()}"}

    def close(self):
        self.process.stdin.close()
        self.process.wait()
        self.process.stdout.close()


def programs(arguments):
    """Name of a row: (program, whether it is ours, threads)."""
    ours = Program([arguments.bin / "bench_io"])
    rows = {OURS: (ours, ["1"])}
    if (threads := os.cpu_count()) > 1:
        rows[f"{OURS}, {threads} threads"] = (ours, [str(threads)])
    for name, file in (("PCL", "bench_io_pcl"), ("MeshLab", "bench_io_meshlab")):
        if (arguments.bin / file).exists():
            rows[name] = (Program([arguments.bin / file]), [])
    here = pathlib.Path(__file__).parent
    for name, package in (("laspy", "lazrs"), ("laspy-parallel", "lazrs"), ("open3d", "open3d"), ("plyfile", "plyfile")):
        if arguments.python and subprocess.run([arguments.python, "-c", f"import {package}"], capture_output=True).returncode == 0:
            rows[name] = (Program([arguments.python, here / "peer_python.py", name]), [])
    return ours, rows


def with_threads(format_name):
    return format_name == "laz"  # the one format that is decoded by several threads


def measure(cloud, ours, rows, arguments):
    format_name, path = cloud
    clock = "cpu_seconds" if arguments.cpu else "seconds"
    chosen = {name: row for name, row in rows.items() if not name.startswith(f"{OURS},") or with_threads(format_name)}
    times = {name: [] for name in chosen}
    answers, limits = {}, {"memcpy": [], "disk": []}
    for name, (program, extra) in chosen.items():  # once, not counted: the file comes into the cache
        answers[name] = program.ask("read", path, *extra)
    for _ in range(arguments.repeat):
        for name, (program, extra) in chosen.items():
            if "failed" not in answers[name]:
                answers[name] = program.ask("read", path, *extra)
                times[name].append(answers[name].get(clock))
        for name in limits:
            limits[name].append(ours.ask(name, path).get("seconds" if name == "disk" else clock))

    size = path.stat().st_size
    result = {"format": format_name, "file": path.name, "bytes": size, "points": answers[OURS].get("points"), "readers": {}}
    for name, seconds in limits.items():
        if None not in seconds:
            result[f"{name}_gb_s"] = size / max(statistics.median(seconds), 1e-6) / 1e9
    for name, answer in answers.items():
        if "failed" in answer:
            result["readers"][name] = {"failed": answer["failed"]}
            continue
        seconds = max(statistics.median(times[name]), 1e-6)
        row = {"seconds": seconds, "points": answer["points"], "values": answer["values"],
               "million_points_s": answer["points"] / seconds / 1e6, "gb_s": size / seconds / 1e9}
        if chosen[name][0] is not ours:
            positions = arguments.work / "positions"
            dumped = chosen[name][0].ask("dump", path, positions)
            compared = dumped if "failed" in dumped else ours.ask("compare", path, positions)
            row["error"] = compared.get("error", compared.get("failed"))
            positions.unlink(missing_ok=True)
        else:
            row["error"] = 0.0
        result["readers"][name] = row
    return result


def table(results):
    print("| cloud | reader | M points/s | GB/s | ours is | points | values a point | largest error |")
    print("|---|---|---:|---:|---:|---:|---:|---:|")
    for result in results:
        own = result["readers"][OURS]
        for name, row in result["readers"].items():
            head = f"| {result['format']} ({result['bytes'] / 1e6:.0f} MB) | {name} |"
            if "failed" in row:
                if "reads no such file" not in row["failed"]:
                    print(f"{head} – | – | – | – | – | {row['failed'][:60]} |")
                continue
            ratio = "" if name == OURS or "seconds" not in own else f"{row['seconds'] / own['seconds']:.1f} ×"
            error = row["error"] if isinstance(row["error"], str) else f"{row['error']:.3g}"
            print(f"{head} {row['million_points_s']:.3g} | {row['gb_s']:.3g} | {ratio} | {row['points']:,} | {row['values']} | {error} |")
        for limit in ("memcpy", "disk"):
            if f"{limit}_gb_s" in result:
                print(f"| | {limit} | | {result[f'{limit}_gb_s']:.3g} | | | | |")


def make_tiny(arguments):
    """A cloud of a few thousand points in every format that `pcmlab convert` writes."""
    pcm = arguments.bin / "pcmlab"
    las = arguments.work / "tiny.las"
    subprocess.run([pcm, "generate", "--overwrite", las, "--points", "3000", "--no-truth", "-q"], check=True, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL)
    clouds = [("las", las)]
    for extension in ("laz", "ply", "pcd", "xyz", "pts", "bpc"):
        path = las.with_suffix(f".{extension}")
        path.unlink(missing_ok=True)
        if subprocess.run([pcm, "convert", las, path, "-q"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode == 0:
            clouds.append((extension, path))
    return clouds


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("."))
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--python")
    parser.add_argument("--json", type=pathlib.Path)
    parser.add_argument("--smoke", action="store_true")
    parser.add_argument("--cpu", action="store_true", help="count the seconds of the processor: for a machine that is busy "
                        "with other things (several threads show no gain then)")
    parser.add_argument("clouds", nargs="*")
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    if arguments.smoke:
        arguments.repeat = 1
        clouds = make_tiny(arguments)
    else:
        clouds = []
        for text in arguments.clouds:
            name, _, file = text.rpartition("=")
            clouds.append((name or pathlib.Path(file).suffix[1:].lower(), pathlib.Path(file).resolve()))
    if not clouds:
        parser.error("which clouds?")

    ours, rows = programs(arguments)
    clocks = [ours.ask("clock")["seconds"]]
    results = []
    for cloud in clouds:
        results.append(measure(cloud, ours, rows, arguments))
        clocks.append(ours.ask("clock")["seconds"])
    for program in {id(program): program for program, _ in rows.values()}.values():
        program.close()
    machine = {"processor": platform.processor() or platform.machine(), "cores": os.cpu_count(),
               "clock_ghz": statistics.median(clocks), "clock_ghz_least": min(clocks), "load": os.getloadavg()[0]}
    print(f"A core does about {machine['clock_ghz']:.2f} GHz (least {machine['clock_ghz_least']:.2f}); {machine['cores']} cores, "
          f"load {machine['load']:.1f}; medians of {arguments.repeat}, "
          f"seconds of {'the processor' if arguments.cpu else 'the clock on the wall'}\n")
    table(results)
    if arguments.json:
        arguments.json.write_text(json.dumps({"machine": machine, "clouds": results}, indent=1) + "\n")
    failed = [result["file"] for result in results if "failed" in result["readers"][OURS]]
    if failed:
        print(f"not read by us: {', '.join(failed)}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
