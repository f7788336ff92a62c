"""Clouds of bench/neighbours: their points as integers and doubles, true normals, and oracles in double precision."""
import json
import math
import pathlib
import struct

import numpy


class Scene:
    """A LAS file with its tree. Points are compared by their integer positions, so that their order means nothing."""

    def __init__(self, name, las, work):
        self.name, self.las = name, pathlib.Path(las)
        self.tree = work / f"{name}.pct"
        self.positions = work / f"{name}.xyz"
        data = numpy.memmap(self.las, numpy.uint8, "r")
        header = data[:375].tobytes()
        start, = struct.unpack_from("<I", header, 96)
        point_format, length, count = struct.unpack_from("<BHI", header, 104)
        if count == 0:
            count, = struct.unpack_from("<Q", header, 247)
        self.scale = numpy.array(struct.unpack_from("<3d", header, 131))
        self.offset = numpy.array(struct.unpack_from("<3d", header, 155))
        source_id = 18 if point_format & 63 < 6 else 20
        record = numpy.dtype({"names": ["q", "id"], "formats": ["3<i4", "<u2"], "offsets": [0, source_id], "itemsize": length})
        points = numpy.frombuffer(data, record, count, start)
        self.q = points["q"].astype(numpy.int64)
        self.ids = points["id"].astype(numpy.int64)
        self.xyz = self.q * self.scale + self.offset
        self.local = (self.q - self.q.min(axis=0)) * self.scale  # exact to the last bit or two, wherever the cloud lies
        self.xyz.astype("<f8").tofile(self.positions)
        truth = self.las.with_suffix(".truth.json")
        self.truth = json.loads(truth.read_text())["primitives"] if truth.exists() else None

    def true_normals(self):
        """A normal per point, from the primitive that it lies on, and which points have one."""
        normals, known = numpy.zeros_like(self.xyz), numpy.zeros(len(self.xyz), bool)
        for primitive in self.truth or []:
            mine = self.ids == primitive["id"]
            point, direction = numpy.array(primitive["point"]), numpy.array(primitive["direction"])
            away = self.xyz[mine] - point
            if primitive["kind"] == "plane":
                away = numpy.broadcast_to(direction, away.shape)
            elif primitive["kind"] == "cylinder":
                away = away - numpy.outer(away @ direction, direction)
            normals[mine] = away / numpy.linalg.norm(away, axis=1, keepdims=True)
            known |= mine
        return normals, known

    def rows_of(self, q):
        """For each point of the file the row of `q` that is its position (of several points at one place: one of them)."""
        def as_keys(positions):
            return numpy.ascontiguousarray(positions - self.q.min(axis=0)).astype(">u8").view("V24").ravel()
        keys = as_keys(q)
        order = numpy.argsort(keys)
        found = order[numpy.minimum(numpy.searchsorted(keys[order], as_keys(self.q)), len(order) - 1)]
        assert len(q) == len(self.q) and (q[found] == self.q).all(), "positions of the result are not those of the file"
        return found


def neighbours_of(scene, sample, k):
    """Distances and numbers of the k nearest others of the sampled points, by comparing all in double."""
    distances, indices = numpy.empty((len(sample), k)), numpy.empty((len(sample), k), numpy.int64)
    for row, point in enumerate(sample):
        squares = ((scene.local - scene.local[point]) ** 2).sum(axis=1)
        squares[point] = math.inf
        nearest = numpy.argpartition(squares, k - 1)[:k]
        nearest = nearest[numpy.argsort(squares[nearest], kind="stable")]
        distances[row], indices[row] = numpy.sqrt(squares[nearest]), nearest
    return distances, indices


def exact_normals(scene, sample, indices):
    """By principal components in double, the point itself included; and how well a plane is defined (0: not at all)."""
    normals, defined = numpy.empty((len(sample), 3)), numpy.empty(len(sample))
    for row, point in enumerate(sample):
        around = scene.local[numpy.append(indices[row], point)]
        around = around - around.mean(axis=0)
        values, vectors = numpy.linalg.eigh(around.T @ around)
        normals[row] = vectors[:, 0]
        defined[row] = (values[1] - values[0]) / max(values[2], 1e-300)
    return normals, defined


def exact_outliers(scene, k, sigmas):
    """Labels by comparing mean distances in double, and the mean distances; nothing where SciPy is absent."""
    try:
        from scipy.spatial import cKDTree
    except ImportError:
        return None
    mean = cKDTree(scene.local).query(scene.local, k + 1)[0].sum(axis=1) / k
    return mean > mean.mean() + sigmas * mean.std()


def angles(found, expected):
    """Between lines, degrees; 90 where no normal was found."""
    length = numpy.linalg.norm(found, axis=1)
    cosine = numpy.abs((found * expected).sum(axis=1)) / numpy.where(length > 0, length, 1)
    return numpy.degrees(numpy.arccos(numpy.clip(numpy.nan_to_num(numpy.where(length > 0, cosine, 0)), 0, 1)))


def read_ply(path):
    """The columns of a binary PLY."""
    types = {"double": "<f8", "float": "<f4", "int": "<i4", "uint": "<u4", "short": "<i2", "ushort": "<u2", "char": "i1",
             "uchar": "u1"}
    with open(path, "rb") as file:
        fields, count, reading = [], 0, True
        while reading:
            words = file.readline().decode("latin-1").split()
            if words[:2] == ["element", "vertex"]:
                count = int(words[2])
            elif words[:1] == ["property"] and words[1] != "list":
                fields.append((words[2], types[words[1]]))
            elif words[:1] == ["element"] and words[1] != "vertex":
                assert words[2] == "0", "faces are not expected"
            reading = words != ["end_header"]
        return numpy.fromfile(file, numpy.dtype(fields), count)
