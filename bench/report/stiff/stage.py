"""One case on disk: its files, its tree, and the places and lengths that commands are given."""
import json
import shutil
import subprocess

import numpy

import ply

MOST_SECONDS = 60  # of one command: more is a hang


class Answer:
    """What a command answered; `code` is None for a hang."""

    def __init__(self, code, out, err):
        self.code, self.out, self.err = code, out, err

    @property
    def done(self):
        return self.code in (0, 3)  # 3: done, with a warning

    def json(self):
        """Throws ValueError for NaN and infinity, which are no JSON."""
        def refuse(word):
            raise ValueError(f"the answer has {word}")
        return json.loads(self.out, parse_constant=refuse)


def run(program, words, folder):
    try:
        done = subprocess.run([program, *words], cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace",
                              timeout=MOST_SECONDS)
    except subprocess.TimeoutExpired:
        return Answer(None, "", "")
    return Answer(done.returncode, done.stdout, done.stderr)


def write_text(path, xyz):
    path.write_text("".join(" ".join(repr(float(value)) for value in row) + "\n" for row in xyz))


def write_case(case, folder):
    """Returns the path of the file, or of the folder of files."""
    if case.text:
        write_text(folder / "cloud.xyz", case.xyz)
        return folder / "cloud.xyz"
    if case.parts == 1:
        ply.write(folder / "cloud.ply", case.xyz, case.attributes, case.kind)
        return folder / "cloud.ply"
    parts = folder / "parts"
    parts.mkdir()
    for number, rows in enumerate(numpy.array_split(case.xyz, case.parts)):
        ply.write(parts / f"{number}.ply", rows, {})
    return parts


class Stage:
    """`source`: the case's file or folder of files; `cloud`: its tree, or the source where it cannot be built; `xyz` and `columns`: what
    the tree holds. `low`, `high`, `middle` and `size` (of the longest axis) are of the points that are coordinates."""

    def __init__(self, case, folder, program):
        self.case, self.folder, self.program = case, folder, program
        self.settings = case.settings
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        self.source = write_case(case, folder).resolve()
        tree = folder.resolve() / "cloud.pct"
        self.built = self.ask(["build", str(self.source), "-o", str(tree), "--json"])
        self.has_tree = self.built.done and tree.exists()
        self.cloud = tree if self.has_tree else self.source
        self.columns = self.points_of(tree) if self.has_tree else {"xyz": case.xyz}
        self.xyz = self.columns["xyz"]
        self.measure()
        self.primitives = folder.resolve() / "primitives.json"
        self.write_primitives()

    def copy(self):
        """A copy of the tree, made anew, or the source where there is none."""
        if not self.has_tree:
            return self.source
        copy = self.cloud.with_name("copy.pct")
        shutil.rmtree(copy, ignore_errors=True)
        shutil.copytree(self.cloud, copy)
        return copy

    def measure(self):
        sane = self.xyz[(numpy.abs(self.xyz) < 1e150).all(axis=1)] if len(self.xyz) else self.xyz
        if not len(sane):
            sane = numpy.zeros((1, 3))
        self.low, self.high = sane.min(axis=0), sane.max(axis=0)
        self.middle = numpy.median(sane, axis=0)
        self.size = float((numpy.percentile(sane, 95, axis=0) - numpy.percentile(sane, 5, axis=0)).max())
        self.reach = self.size if self.size > 0 else 1.0  # of cameras, rays and lines
        order = numpy.argsort(((sane - self.middle) / max(self.size, 1e-300) ** 1 @ numpy.array([0.3, 0.5, 0.8])), kind="stable")
        self.places = sane[order[numpy.linspace(0.1 * (len(sane) - 1), 0.9 * (len(sane) - 1), 8).astype(int)]]

    def ask(self, words, folder=None):
        return run(self.program, words, folder or self.folder)

    def points_of(self, tree):
        """The columns of a tree or file, by 'pcmlab convert' to PLY."""
        path = tree.with_name(tree.name + ".read.ply")
        answer = self.ask(["convert", str(tree), str(path), "--overwrite", "-q"])
        if not answer.done:
            raise RuntimeError(f"its result cannot be read: {answer.err.strip()}")
        columns = ply.read(path)
        path.unlink()
        return columns

    def write_primitives(self):
        """A plane and a sphere of the case's size."""
        size, at = max(self.size, 1e-300), self.middle.tolist()
        corners = [(self.middle + size * numpy.array(corner)).tolist() for corner in ([0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0])]
        ask = [{"name": "P", "kind": "plane", "point": at, "axis": [0, 0, 1], "bounds": {"outline": corners}},
               {"kind": "sphere", "name": "S", "point": at, "radius": size}]
        self.primitive_radius = size
        self.primitives.write_text(json.dumps({"format": "pcm primitives", "version": 1, "angles": "radians", "primitives": ask}))
