"""pcmlab-mpi makes and finds what pcmlab does, by any number of processes, and after any of them was killed at any time."""

import json
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

BIN = pathlib.Path(os.environ["PCM_BUILD_DIR"]) / "bin"
OPTIONS = ["--memory", "64M", "--chunk-points", "5000", "--threads", "1", "-q"]
OPEN_MPI = ["mpirun", "--oversubscribe", "--allow-run-as-root", "--mca", "btl", "self,vader", "--mca", "btl_vader_single_copy_mechanism", "none"]
LAUNCHER = os.environ["PCM_MPI_LAUNCHER"].split() if "PCM_MPI_LAUNCHER" in os.environ else OPEN_MPI  # another MPI's: "mpiexec.mpich"


def with_environment(names):
    """Open MPI hands on the variables that it is given; MPICH does so with all."""
    return [*LAUNCHER, *[word for name in names if LAUNCHER == OPEN_MPI for word in ("-x", name)]]


def processes_of(parent):
    """pcmlab-mpi's processes below a process of mpirun."""
    parents = {}
    for folder in pathlib.Path("/proc").iterdir():
        if folder.name.isdigit():
            try:
                name, fields = (folder / "stat").read_text().rsplit(")", 1)
            except OSError:
                continue
            parents[int(folder.name)] = (int(fields.split()[1]), name.split("(", 1)[1])
    below = {parent}
    for _ in range(4):
        below |= {process for process, (its_parent, _) in parents.items() if its_parent in below}
    return [process for process in below if parents.get(process, (0, ""))[1] == "pcmlab-mpi"]


@unittest.skipUnless(shutil.which(LAUNCHER[0]), "there is no mpirun here")
class Mpi(unittest.TestCase):
    trees_to_kill = 3

    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp())
        cls.scene = cls.folder / "scene.las"
        cls.run_program("pcmlab", "generate", cls.scene, "-n", "600000", "--no-truth", "-q")
        cls.tree = cls.built("whole.pct", cls.scene)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def run_program(cls, program, *arguments, check=True):
        run = subprocess.run([BIN / program, *map(str, arguments)], capture_output=True, text=True, check=False)
        assert not check or run.returncode == 0, run.stderr
        return run

    @classmethod
    def built(cls, name, *arguments):
        cls.run_program("pcmlab", "build", *arguments, "-o", cls.folder / name, *OPTIONS)
        return cls.folder / name

    def command(self, ranks, output, *arguments, environment=()):
        return [*with_environment(environment), "-n", str(ranks), BIN / "pcmlab-mpi", "build", *arguments, "-o", output, *OPTIONS]

    def together(self, ranks, output, *arguments, environment=None):
        command = self.command(ranks, output, *arguments, environment=environment or ())
        return subprocess.run(command, capture_output=True, text=True, check=False, timeout=300, env={**os.environ, **(environment or {})})

    def files(self, folder):
        return {file.name: file.read_bytes() for file in folder.iterdir() if file.name != "lock"}

    def assert_same(self, tree, other, was_killed=False):
        mine, its = self.files(tree), self.files(other)
        self.assertEqual(sorted(mine), sorted(its))
        for name, content in mine.items():
            self.assertTrue(content == its[name], f"{name} differs")
        if not was_killed:  # else it may have had its name already
            self.assertFalse(pathlib.Path(f"{tree}.part").exists())
        shutil.rmtree(f"{tree}.part", ignore_errors=True)
        shutil.rmtree(tree)

    def test_any_number_of_processes_writes_the_same_bytes(self):
        for ranks in (1, 2, 4):
            with self.subTest(ranks=ranks):
                run = self.together(ranks, self.folder / "mpi.pct", self.scene)
                self.assertEqual(run.returncode, 0, run.stderr)
                self.assert_same(self.folder / "mpi.pct", self.tree)

    def test_levels_on_a_grid_laz_and_doubles(self):
        for name in ("scene.laz", "scene.xyz", "scene.ply"):
            self.run_program("pcmlab", "convert", self.scene, self.folder / name, "-q")
        for arguments in ([self.scene, "--fast"], [self.folder / "scene.laz"], [self.folder / "scene.xyz"], [self.folder / "scene.ply"]):
            with self.subTest(arguments=arguments):
                other = self.built("other.pct", *arguments)
                run = self.together(3, self.folder / "mpi.pct", *arguments)
                self.assertEqual(run.returncode, 0, run.stderr)
                self.assert_same(self.folder / "mpi.pct", other)
                shutil.rmtree(other)

    def test_five_hundred_tiles(self):
        """Slices of one cloud: its header with another count, and some of its records."""
        tiles = self.folder / "tiles"
        tiles.mkdir()
        whole = self.scene.read_bytes()
        begin, size, each = int.from_bytes(whole[96:100], "little"), int.from_bytes(whole[105:107], "little"), 200
        self.assertEqual(whole[25], 2)  # LAS 1.2, whose counts are changed here
        for number in range(500):
            at = begin + number * each * size
            counts = each.to_bytes(4, "little") * 2 + bytes(16)
            (tiles / f"{number:03}.las").write_bytes(whole[:107] + counts + whole[131:begin] + whole[at : at + each * size])
        other = self.built("other.pct", tiles)
        run = self.together(2, self.folder / "mpi.pct", tiles)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assert_same(self.folder / "mpi.pct", other)
        shutil.rmtree(other)

    def test_bins_that_are_divided_again(self):
        """A third of the points lies in a clump, and none of every 16th point, of which the sample is."""
        whole = bytearray(self.scene.read_bytes())
        begin, size = int.from_bytes(whole[96:100], "little"), int.from_bytes(whole[105:107], "little")
        for at in (begin + number * size for number in range(600_000) if 0 < number % 16 < 6):
            for axis in range(3):
                value = int.from_bytes(whole[at + 4 * axis : at + 4 * axis + 4], "little", signed=True)
                whole[at + 4 * axis : at + 4 * axis + 4] = (value // 1000).to_bytes(4, "little", signed=True)
        clump = self.folder / "clump.las"
        clump.write_bytes(whole)
        other = self.built("other.pct", clump)
        jobs = self.folder / "mpi.pct.part" / "jobs" / "divisions"
        process = subprocess.Popen(self.command(3, self.folder / "mpi.pct", clump), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        divided = False
        while process.poll() is None:
            divided = divided or jobs.exists()
            time.sleep(0.01)
        self.assertEqual(process.returncode, 0, process.stderr.read())
        process.stderr.close()
        self.assertTrue(divided)
        self.assert_same(self.folder / "mpi.pct", other)
        shutil.rmtree(other)

    def test_a_shared_folder_without_locks_holes_and_exchange_of_names(self):
        """As Lustre and NFS may be mounted; the second build replaces the tree of the first."""
        output = self.folder / "plain.pct"
        without = {
            "LD_PRELOAD": str(BIN.parent / "tests" / "faults" / "libpcm_faults.so"),
            "PCM_FAULT": "count",
            "PCM_FAULT_WITHOUT": "flock,holes,exchange,tmpfile,linkat",
            "PCM_FAULT_UNDER": str(self.folder.resolve()),
        }
        for more in ([], ["--overwrite"]):
            run = self.together(2, output, self.scene, *more, environment=without)
            self.assertEqual(run.returncode, 0, run.stderr)
        self.assert_same(output, self.tree)

    def test_killed_processes_end_the_job_and_the_next_one_goes_on(self):
        chance = random.Random(11)
        output = self.folder / "killed.pct"
        kills = 0
        begun = time.monotonic()
        self.assertEqual(self.together(2, output, self.scene).returncode, 0)
        seconds = time.monotonic() - begun
        self.assert_same(output, self.tree)
        for tree in range(4 * self.trees_to_kill):  # on a machine where builds end before they are killed
            if tree >= self.trees_to_kill and kills > self.trees_to_kill:
                break
            for _ in range(4):
                process = subprocess.Popen(self.command(chance.choice((1, 2, 3)), output, self.scene), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                begun = time.monotonic()
                ranks = []
                while not ranks and process.poll() is None:
                    ranks = processes_of(process.pid)
                time.sleep(0.4 + chance.uniform(0, 0.7 * seconds))  # mpirun itself hangs when one ends before MPI_Init() has
                if process.poll() is None and ranks:
                    try:
                        os.kill(chance.choice(ranks), signal.SIGKILL)
                        kills += 1
                    except ProcessLookupError:
                        pass
                process.wait(timeout=60)
                if output.exists():
                    break
                self.assertNotEqual(process.returncode, 0)
                self.assertLess(time.monotonic() - begun, 60)
            was_killed = output.exists()
            if not was_killed:
                if tree % 3 == 2:  # one process that knows no MPI goes on with what several have begun
                    self.run_program("pcmlab", "build", self.scene, "-o", output, *OPTIONS)
                else:
                    run = self.together(2, output, self.scene)
                    self.assertEqual(run.returncode, 0, run.stderr)
            self.assert_same(output, self.tree, was_killed)
        self.assertGreater(kills, self.trees_to_kill)

    def test_one_that_fails_is_named_and_nothing_is_published(self):
        tiles = self.folder / "bad"
        tiles.mkdir()
        for number in range(3):
            self.run_program("pcmlab", "generate", tiles / f"{number}.las", "-n", "100000", "--no-truth", "--seed", number + 1, "-q")
        whole = (tiles / "1.las").read_bytes()
        (tiles / "1.las").write_bytes(whole[: len(whole) * 2 // 3])
        begun = time.monotonic()
        run = self.together(3, self.folder / "bad.pct", tiles)
        self.assertLess(time.monotonic() - begun, 60)
        self.assertNotEqual(run.returncode, 0)
        self.assertIn("1.las", run.stderr)
        self.assertIn("rank", run.stderr)
        self.assertFalse((self.folder / "bad.pct").exists())

    def operation(self, ranks, *words):
        return [*LAUNCHER, "-n", str(ranks), BIN / "pcmlab-mpi", *map(str, words)]

    def do_together(self, ranks, *words):
        return subprocess.run(self.operation(ranks, *words), capture_output=True, text=True, check=False, timeout=300)

    def test_findings_of_verify_are_those_of_one_process(self):
        damaged = self.folder / "damaged.pct"
        shutil.copytree(self.tree, damaged)
        with open(damaged / "chunks-000.bpc", "r+b") as file:
            for at in (100_000, 1_000_000, 3_000_000):
                file.seek(at)
                file.write(b"damaged!")
        (damaged / "notes.txt").write_text("a stray file")
        for tree in (self.tree, damaged):
            for words in ((), ("--json",), ("--levels", "--json")):
                one = self.run_program("pcmlab", "verify", tree, *words, check=False)
                for ranks in (1, 2, 4):
                    with self.subTest(tree=tree.name, words=words, ranks=ranks):
                        run = self.do_together(ranks, "verify", tree, *words)
                        self.assertEqual(run.returncode, one.returncode)
                        self.assertNotIn("MPI_ABORT", run.stderr)
                        if not words:
                            faults = [line for line in one.stdout.splitlines() if line.startswith(("fault", "note"))]
                            self.assertEqual([line for line in run.stdout.splitlines() if line.startswith(("fault", "note"))], faults)
                            self.assertEqual(len(faults), 4 if tree == damaged else 0)
                            continue
                        expected, found = json.loads(one.stdout), json.loads(run.stdout)
                        for key in ("intact", "bytes", "points_in", "points", "position_error", "levels", "coverage_limit", "faults", "around", "notes"):
                            self.assertEqual(found.get(key), expected.get(key), key)
        shutil.rmtree(damaged)

    # One process has the memory for all values: then its chunks are in the order of the nodes.
    filters = (
        ("normals", "--radii", "--curvature", "-k", "12"),
        ("normals", "--direction", "0", "0", "1"),
        ("radii", "--mean-distance"),
        ("outliers", "-k", "8", "-a", "2"),
        ("outliers", "--method", "robust", "--label"),
    )

    def test_filters_write_the_bytes_of_one_process(self):
        for words in self.filters:
            self.run_program("pcmlab", words[0], self.tree, "-o", self.folder / "one.pct", *words[1:], "--memory", "1G", "-q")
            for ranks in (1, 2, 4):
                with self.subTest(words=words, ranks=ranks):
                    run = self.do_together(ranks, words[0], self.tree, "-o", self.folder / "mpi.pct", *words[1:], "--memory", "96M", "--threads", "1", "-q")
                    self.assertEqual(run.returncode, 0, run.stderr)
                    self.assert_same(self.folder / "mpi.pct", self.folder / "one.pct")
            shutil.rmtree(self.folder / "one.pct")

    def test_filters_in_place_with_ranks_that_report_their_memory(self):
        changed = self.folder / "changed.pct"
        shutil.copytree(self.tree, changed)
        expected = self.folder / "one.pct"
        shutil.copytree(self.tree, expected)
        self.run_program("pcmlab", "radii", expected, "--in-place", "--memory", "1G", "-q")
        run = subprocess.run(
            [*with_environment(["PCM_MPI_REPORT"]), "-n", "2", BIN / "pcmlab-mpi", "radii", changed, "--in-place", "--memory", "96M", "--threads", "1"],
            capture_output=True, text=True, check=False, timeout=300, env={**os.environ, "PCM_MPI_REPORT": "1"},
        )
        self.assertEqual(run.returncode, 0, run.stderr)
        peaks = [int(peak) for peak in re.findall(r"peak memory (\d+) bytes", run.stderr)]
        self.assertEqual(len(peaks), 2)
        self.assertLess(max(peaks), 96 << 20)
        self.assert_same(changed, expected)
        shutil.rmtree(expected)

    # The operation, the name of its result, its options.
    operations_to_kill = (
        ("normals", "killed.pct", "--curvature", "-k", "24"),
        ("radii", "killed.pct", "-k", "24", "--mean-distance"),
        ("outliers", "killed.pct", "-k", "24"),
        ("convert", "killed.laz", "--where", "intensity>100", "--where", "z<100"),
    )

    def wait_for_work(self, process):
        """Until the process has unfinished work on disk: mpirun itself hangs when a rank ends before MPI_Init() has."""
        while process.poll() is None and not any(self.folder.glob("killed*.part")):
            time.sleep(0.002)

    def killed(self, chance, longest, *words):
        """Runs an operation and kills a rank within this time of its work, seconds. Returns whether one was, and the exit code."""
        process = subprocess.Popen(self.operation(chance.choice((1, 2, 3)), *words), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        begun = time.monotonic()
        self.wait_for_work(process)
        ranks = processes_of(process.pid)
        time.sleep(chance.uniform(0, longest))
        was_killed = False
        if process.poll() is None and ranks:
            try:
                os.kill(chance.choice(ranks), signal.SIGKILL)
                was_killed = True
            except ProcessLookupError:
                pass
        process.wait(timeout=60)
        self.assertLess(time.monotonic() - begun, 60)
        return was_killed, process.returncode

    def assert_same_result(self, result, expected, was_killed):
        if expected.is_dir():
            self.assert_same(result, expected, was_killed)
            return
        self.assertTrue(result.read_bytes() == expected.read_bytes())
        if not was_killed:
            self.assertFalse(pathlib.Path(f"{result}.pct.part").exists())
        shutil.rmtree(f"{result}.pct.part", ignore_errors=True)
        result.unlink()

    def test_killed_operations_leave_no_result_and_are_resumed(self):
        chance = random.Random(5)
        for name, result, *options in self.operations_to_kill:
            with self.subTest(operation=name):
                output, expected = self.folder / result, self.folder / f"one{result[6:]}"
                words = lambda result: (name, self.tree, result, *options) if name == "convert" else (name, self.tree, *options, "-o", result)
                self.run_program("pcmlab", *words(expected), "--memory", "1G", "-q")
                begun = time.monotonic()
                self.assertEqual(self.do_together(2, *words(output), "--memory", "96M", "--threads", "1", "-q").returncode, 0)
                longest = time.monotonic() - begun
                self.assert_same_result(output, expected, False)
                before, kills, resumed = self.files(self.tree), 0, 0
                for tries in range(6 * self.trees_to_kill):  # where operations end before they are killed
                    if tries >= self.trees_to_kill and kills > self.trees_to_kill // 2 and resumed > 0:
                        break
                    was_killed, code = self.killed(chance, longest, *words(output), "--memory", "96M", "--threads", "1")
                    kills += was_killed
                    longest *= 1 if was_killed else 0.8
                    had_its_name = output.exists()
                    if not had_its_name:
                        self.assertNotEqual(code, 0)
                        run = self.do_together(2, *words(output), "--memory", "96M", "--threads", "1")
                        self.assertEqual(run.returncode, 0, run.stderr)
                        resumed += "interrupted work was resumed" in run.stdout
                    self.assert_same_result(output, expected, had_its_name)
                    self.assertEqual(self.files(self.tree), before)
                self.assertGreater(kills, self.trees_to_kill // 2)
                self.assertGreater(resumed, 0)
                shutil.rmtree(expected) if expected.is_dir() else expected.unlink()

    def test_parts_of_a_tree_are_the_files_of_one_process(self):
        where = ("--where", "intensity>100", "--where", "z<100")
        for name in ("part.las", "part.laz", "part.ply", "part.pct"):
            one, mpi = self.folder / f"one-{name}", self.folder / f"mpi-{name}"
            self.run_program("pcmlab", "convert", self.tree, one, *where, "-q")
            for ranks in (1, 2, 4):
                with self.subTest(name=name, ranks=ranks):
                    run = self.do_together(ranks, "convert", self.tree, mpi, *where, "--threads", "1", "-q")
                    self.assertEqual(run.returncode, 0, run.stderr)
                    self.assertFalse(pathlib.Path(f"{mpi}.pct.part").exists())
                    if mpi.is_dir():
                        self.assert_same(mpi, one)
                    else:
                        self.assertTrue(mpi.read_bytes() == one.read_bytes())
                        mpi.unlink()

    def test_a_damaged_tree_ends_all_with_the_rank_and_nothing_is_written(self):
        damaged = self.folder / "damaged.pct"
        shutil.copytree(self.tree, damaged)
        with open(damaged / "chunks-000.bpc", "r+b") as file:
            file.seek(1_000_000)
            file.write(b"damaged!" * 100)
        begun = time.monotonic()
        run = self.do_together(3, "normals", damaged, "-o", self.folder / "mpi.pct", "-q")
        self.assertLess(time.monotonic() - begun, 60)
        self.assertNotEqual(run.returncode, 0)
        self.assertIn("chunks-000.bpc", run.stderr)
        self.assertIn("on rank", run.stderr)
        self.assertFalse((self.folder / "mpi.pct").exists())
        shutil.rmtree(self.folder / "mpi.pct.part")
        shutil.rmtree(damaged)

    def test_what_several_processes_do_not_do_is_refused(self):
        run = self.do_together(2, "query", self.tree)
        self.assertEqual(run.returncode, 2)
        self.assertIn("use 'pcmlab query'", run.stderr)
        run = self.do_together(2, "normals", self.scene, "-o", self.folder / "mpi.pct")
        self.assertNotEqual(run.returncode, 0)
        self.assertIn("pcmlab-mpi build", run.stderr)
        run = self.do_together(2, "radii", self.tree, "-o", self.folder / "mpi.pct", "--device", "gpu")
        self.assertNotEqual(run.returncode, 0)
        self.assertIn("graphics card", run.stderr)
        self.assertFalse((self.folder / "mpi.pct").exists())

    def test_buckets_are_refused(self):
        run = self.together(2, "s3://scans/site.pct", self.scene)
        self.assertNotEqual(run.returncode, 0)
        self.assertIn("not in buckets", run.stderr)


if __name__ == "__main__":
    unittest.main()
