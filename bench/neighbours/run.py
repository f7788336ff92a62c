#!/usr/bin/env python3
"""Error against run time of radii, normals and outliers: ours compared with PCL, CGAL, Open3D and MeshLab,
all in one run in which they take turns.

    run.py --bin BUILD/bin --out FOLDER [--points 1e6] [--cloud NAME=FILE.las ...] [--python PYTHON] [--meshlab PREFIX]
    run.py --bin BUILD/bin --out FOLDER --smoke     a tiny cloud, once: that it works

Times are of the processor, on one thread. Ours are of the whole process, from the tree on disk to a new tree on disk; those of the others are of the
computation alone (MeshLab's: less what loading and saving the same file takes). Peers run where they are: BUILD/bin/bench_filters_pcl and
bench_filters_cgal (built with PCM_BENCH_PEERS=ON), Open3D in PYTHON, and PREFIX/bin/meshlabserver, which needs a display (xvfb-run). The oracles are in
scenes.py. FOLDER gets results.json and report.md, and plots where Matplotlib is.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys

try:
    import numpy
except ImportError:
    print("NumPy is not here", file=sys.stderr)
    sys.exit(77)

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from neighbours import report, scenes  # noqa: E402
from study import machine  # noqa: E402
from study.process import timed  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent


class Ours:
    """One of our commands: run() times it, read() gives its result in the order of the scene's file."""

    def __init__(self, bench, scene, name, options, columns):
        self.bench, self.scene, self.name, self.columns = bench, scene, "pcmlab", columns
        self.result = bench.work / "ours.pct"
        self.command = [bench.bin / "pcmlab", name, scene.tree, "-o", self.result, "-q", "--json", "-t", "1", *options]

    def run(self):
        remove_tree(self.result)
        return timed(self.command)[1]

    def read(self):
        file = self.bench.work / "ours.ply"
        timed([self.bench.bin / "pcmlab", "convert", "-q", "--overwrite", self.result, file])
        table = scenes.read_ply(file)
        file.unlink()
        xyz = numpy.stack([table[a].astype(float) for a in "xyz"], axis=1)
        rows = self.scene.rows_of(numpy.rint((xyz - self.scene.offset) / self.scene.scale).astype(numpy.int64))
        values = numpy.stack([table[c].astype(float) for c in self.columns], axis=1)[rows]
        return values[:, 0] if len(self.columns) == 1 else values


class Peer:
    """A program that filter_files.h describes."""

    def __init__(self, bench, scene, name, program, work, k, share):
        self.scene, self.name, self.filter = scene, name, work
        self.result = bench.work / "peer.bin"
        self.command = [*program, work, k, 1, bench.sigmas, share, scene.positions, self.result]

    def run(self):
        text, usage = timed(self.command, {"OMP_NUM_THREADS": "1"})
        own = json.loads(text[text.index("{"):])
        return {**usage, "cpu": own["cpu_seconds"], "process_cpu": usage["cpu"]}

    def read(self):
        if self.filter == "normals":
            return numpy.fromfile(self.result, numpy.float32).reshape(-1, 3).astype(float)
        return numpy.fromfile(self.result, numpy.uint8)


class MeshLab:
    """MeshLab's own filter, by meshlabserver; what loading and saving takes is taken off."""

    name = "MeshLab"

    def __init__(self, bench, scene, k):
        self.scene = scene
        self.input, self.result = bench.work / f"{scene.name}.ply", bench.work / "meshlab.ply"
        if not self.input.exists():
            header = ("ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty double x\nproperty double y\n"
                      "property double z\nend_header\n" % len(scene.xyz))
            self.input.write_bytes(header.encode() + scene.xyz.astype("<f8").tobytes())
        script = bench.work / f"normals-{k}.mlx"
        script.write_text('<!DOCTYPE FilterScript>\n<FilterScript>\n <filter name="Compute normals for point sets">\n'
                          f'  <Param type="RichInt" value="{k + 1}" name="K"/>\n'
                          '  <Param type="RichInt" value="0" name="smoothIter"/>\n'
                          '  <Param type="RichBool" value="false" name="flipFlag"/>\n'
                          '  <Param type="RichPoint3f" x="0" y="0" z="0" name="viewPos"/>\n </filter>\n</FilterScript>\n')
        empty = bench.work / "nothing.mlx"
        empty.write_text("<!DOCTYPE FilterScript>\n<FilterScript>\n</FilterScript>\n")
        start = [bench.meshlab / "bin" / "meshlabserver", "-i", self.input, "-o", self.result, "-m", "vn", "-s"]
        self.command, self.nothing = [*start, script], [*start, empty]
        self.environment = {"OMP_NUM_THREADS": "1", "XDG_CONFIG_HOME": str(bench.work / "config")}

    def run(self):
        without = timed(self.nothing, self.environment)[1]
        usage = timed(self.command, self.environment)[1]
        return {**usage, "cpu": max(0.0, usage["cpu"] - without["cpu"]), "process_cpu": usage["cpu"]}

    def read(self):
        table = scenes.read_ply(self.result)
        return numpy.stack([table[c].astype(float) for c in ("nx", "ny", "nz")], axis=1)


def remove_tree(folder):
    """A result of a former run: a folder of plain files."""
    if folder.exists():
        for path in sorted(folder.rglob("*"), reverse=True):
            path.rmdir() if path.is_dir() else path.unlink()
        folder.rmdir()


class Bench:
    def __init__(self, arguments):
        self.bin, self.out, self.meshlab = arguments.bin, arguments.out, arguments.meshlab
        self.work = arguments.work or arguments.out / "work"
        self.work.mkdir(parents=True, exist_ok=True)
        self.repeat, self.sigmas, self.sample = arguments.repeat, arguments.sigmas, arguments.sample
        self.ks = [int(k) for k in arguments.neighbours.split(",")]
        self.rows = []
        self.peers = {}
        for name, file in (("PCL", "bench_filters_pcl"), ("CGAL", "bench_filters_cgal")):
            if (self.bin / file).exists():
                self.peers[name] = [self.bin / file]
        if arguments.python and subprocess.run([arguments.python, "-c", "import open3d"], capture_output=True).returncode == 0:
            self.peers["Open3D"] = [arguments.python, HERE / "filters_open3d.py"]

    def take_turns(self, scene, work, k, programs, judge):
        """Runs the programs in turns; `judge` gives the errors of a result."""
        runs = {program: [] for program in programs}
        errors = {}
        for turn in range(self.repeat):
            for program in programs:
                try:
                    runs[program].append(program.run())
                    if turn == 0:
                        errors[program] = judge(program.read())
                except (RuntimeError, OSError, ValueError) as error:
                    print(f"{program.name}: {error}", file=sys.stderr)
        for program in programs:
            if not runs[program] or program not in errors:
                continue
            row = {"scene": scene.name, "points": len(scene.q), "filter": work, "k": k, "program": program.name,
                   **errors[program]}
            for figure in ("cpu", "process_cpu", "peak_mb"):
                values = [run[figure] for run in runs[program] if figure in run]
                if values:
                    row[figure] = statistics.median(values)
            self.rows.append(row)
            print(json.dumps(row), flush=True)

    def normals(self, scene, k, sample, indices):
        exact, defined = scenes.exact_normals(scene, sample, indices)
        plane = defined > 0.05  # where neighbours define a plane
        truth, known = scene.true_normals()

        def judge(found):
            off = scenes.angles(found[sample], exact)[plane]
            errors = {"median_to_exact": float(numpy.median(off)), "p95_to_exact": float(numpy.percentile(off, 95))}
            if known.any():
                from_truth = scenes.angles(found[known], truth[known])
                errors |= {"mean_to_truth": float(from_truth.mean()), "median_to_truth": float(numpy.median(from_truth))}
            return errors

        programs = [Ours(self, scene, "normals", ["-k", k, "--no-confidence"], ["nx", "ny", "nz"])]
        programs += [Peer(self, scene, name, program, "normals", k, 0) for name, program in self.peers.items()]
        if self.meshlab:
            programs.append(MeshLab(self, scene, k))
        self.take_turns(scene, "normals", k, programs, judge)

    def radii(self, scene, k, sample, distances):
        def judge(found):
            off = numpy.abs(found[sample] - distances[:, -1]) / distances[:, -1] * 100
            return {"median_percent": float(numpy.median(off)), "p95_percent": float(numpy.percentile(off, 95))}

        self.take_turns(scene, "radii", k, [Ours(self, scene, "radii", ["-k", k], ["radius"])], judge)

    def outliers(self, scene, k):
        expected = scenes.exact_outliers(scene, k, self.sigmas)
        share = float(expected.mean()) if expected is not None else 0.02

        def judge(found):
            errors = {"outliers": int(found.sum())}
            if expected is not None:
                errors |= {"oracle_outliers": int(expected.sum()), "labels_differ": int(((found != 0) != expected).sum())}
            return errors

        programs = [Ours(self, scene, "outliers", ["-k", k, "-a", self.sigmas, "--label"], ["outlier"])]
        programs += [Peer(self, scene, name, program, "outliers", k, share) for name, program in self.peers.items()]
        self.take_turns(scene, "outliers", k, programs, judge)

    def measure(self, scene):
        if not scene.tree.exists():
            timed([self.bin / "pcmlab", "build", "-q", "-o", scene.tree, scene.las])
        places = numpy.unique(scene.q, axis=0, return_index=True)[1]  # a result is found by its position
        sample = numpy.random.default_rng(1).permutation(places)[: self.sample]
        for k in self.ks:
            distances, indices = scenes.neighbours_of(scene, sample, k)
            self.normals(scene, k, sample, indices)
            self.radii(scene, k, sample, distances)
            self.outliers(scene, k)
            (self.out / "results.json").write_text(json.dumps(self.rows, indent=1) + "\n")


def scenes_of(arguments, work):
    """The generated scene at the origin and at map coordinates, and real clouds."""
    for name, origin in (("scene", "0,0,0"), ("scene-on-the-map", "500000,4800000,100")):
        las = work / f"{name}.las"
        if not las.exists():
            timed([arguments.bin / "pcmlab", "generate", "-q", "-n", int(arguments.points), "--origin", *origin.split(","), las])
        yield scenes.Scene(name, las, work)
    for given in arguments.cloud:
        name, _, file = given.partition("=")
        las = work / f"{name}.las"
        if not las.exists():
            timed([arguments.bin / "pcmlab", "convert", "-q", file, las])
        yield scenes.Scene(name, las, work)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--work", type=pathlib.Path, help="folder for clouds and trees (default: work in --out)")
    parser.add_argument("--points", type=float, default=1e6)
    parser.add_argument("--cloud", action="append", default=[], metavar="NAME=FILE")
    parser.add_argument("--neighbours", default="8,16,32")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--sample", type=int, default=1000, help="points that are compared with an oracle")
    parser.add_argument("--sigmas", type=float, default=2)
    parser.add_argument("--python", type=pathlib.Path, help="a Python that has Open3D")
    parser.add_argument("--meshlab", type=pathlib.Path, help="where MeshLab is installed: /usr")
    parser.add_argument("--smoke", action="store_true")
    arguments = parser.parse_args()
    if arguments.smoke:
        arguments.points, arguments.neighbours, arguments.repeat, arguments.sample = 5000, "8", 1, 50
        remove_tree(arguments.out)
    bench = Bench(arguments)
    for scene in scenes_of(arguments, bench.work):
        bench.measure(scene)
    version = timed([arguments.bin / "pcmlab", "--version"])[0].strip()
    (arguments.out / "sys_info.txt").write_text(machine.describe(bench.work, {"gl": "", "why_not": "nothing is drawn"}, version))
    report.write(arguments.out, bench.rows, arguments)
    if arguments.smoke:
        check_smoke(bench.rows)


def check_smoke(rows):
    """What must hold on any machine: exact results are exact."""
    for row in rows:
        if row["program"] == "pcmlab":
            assert row.get("p95_to_exact", 0) < 0.01, row
            assert row.get("p95_percent", 0) < 0.01, row
            assert row.get("labels_differ", 0) == 0, row
    assert {"normals", "radii", "outliers"} <= {row["filter"] for row in rows}


if __name__ == "__main__":
    main()
