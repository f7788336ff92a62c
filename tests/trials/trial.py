"""What the trials share: the command, the time that is left, and the report."""

import collections
import json
import os
import pathlib
import random
import subprocess
import time

COMMAND = pathlib.Path(os.environ.get("PCM_BUILD_DIR", pathlib.Path(__file__).resolve().parents[2] / "build" / "release")) / "bin" / "pcmlab"
MOST_SECONDS = 120  # of one command: more is a hang


class Result(collections.namedtuple("Result", "code out err")):
    def json(self):
        return json.loads(self.out)


def pcmlab(*arguments, memory=None):
    """Runs the command to its end. A signal is a negative code; a hang is None."""
    def restrict():
        import resource
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if memory:
            resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    try:
        done = subprocess.run([COMMAND, *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                              errors="replace", timeout=MOST_SECONDS, preexec_fn=restrict)
    except subprocess.TimeoutExpired:
        return Result(None, "", "")
    return Result(done.returncode, done.stdout, done.stderr)


def good(*arguments):
    result = pcmlab(*arguments, "--json")
    if result.code != 0:
        raise AssertionError(f"pcmlab {' '.join(map(str, arguments))}: {result}")
    return result.json()


def make_tree(tree, points, more_points, chunk_points, radius):
    """A tree with points that were appended and deleted: site.las and more.las beside it are its points."""
    site, more = tree.parent / "site.las", tree.parent / "more.las"
    good("generate", "--points", points, site)
    good("generate", "--points", more_points, "--seed", 2, more)
    good("build", site, "-o", tree, "--chunk-points", chunk_points)
    good("append", tree, more)
    good("delete", tree, "--sphere", 500030, 4800030, 100, radius)


class Trial:
    """Rounds until a number of them or a time is reached; what went wrong is collected, not thrown."""

    def __init__(self, name, rounds, seconds, seed):
        self.name, self.rounds, self.seed = name, rounds, seed
        self.end = time.monotonic() + seconds
        self.chance = random.Random(f"{name} {seed}")
        self.done = 0
        self.faults = []
        self.counts = collections.Counter()

    def __iter__(self):
        while self.done < self.rounds and time.monotonic() < self.end:
            yield self.done
            self.done += 1

    def expect(self, holds, what):
        if not holds:
            self.faults.append(what)
            print(f"{self.name}, round {self.done}: {what}", flush=True)
        return holds

    def report(self, what):
        counts = "".join(f", {count} {name}" for name, count in sorted(self.counts.items()))
        print(f"{self.name}: {self.done} {what}{counts}; {len(self.faults)} faults", flush=True)
        return len(self.faults)
