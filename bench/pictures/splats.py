"""Radii and normals for a cloud of a few million points, as `pcmlab convert` wrote it to PLY: what the splat modes read.

splats.py IN.ply OUT.ply [NEIGHBOURS]

The normal is the direction in which the nearest neighbours (by default 8) spread least (principal components; the sign is such that it points
upwards), the radius the largest distance of one of them within the plane across it: r = max |(pj - p) - n n'(pj - p)|.
"""
import pathlib
import sys

import numpy as np
from scipy.spatial import cKDTree

TYPES = {"char": "i1", "uchar": "u1", "short": "<i2", "ushort": "<u2", "int": "<i4", "uint": "<u4", "float": "<f4", "double": "<f8",
         "int8": "i1", "uint8": "u1", "int16": "<i2", "uint16": "<u2", "int32": "<i4", "uint32": "<u4", "float32": "<f4", "float64": "<f8"}


def read(file):
    """Header lines before the properties, and the vertices as a structured array."""
    data = file.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    lines = data[:end].decode("ascii").splitlines()
    if "format binary_little_endian 1.0" not in lines:
        raise ValueError(f"{file}: binary_little_endian was expected")
    count, fields = 0, []
    for line in lines:
        words = line.split()
        if words[0] == "element" and words[1] != "vertex":
            raise ValueError(f"{file}: it has the element {words[1]}; vertices alone were expected")
        if words[0] == "element":
            count = int(words[2])
        elif words[0] == "property":
            fields.append((words[2], TYPES[words[1]]))
    return np.frombuffer(data, dtype=fields, count=count, offset=end)


def write(file, points):
    names = {np.dtype(code): name for name, code in TYPES.items() if not name[-1].isdigit()}
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}"]
    header += [f"property {names[points.dtype[name]]} {name}" for name in points.dtype.names] + ["end_header", ""]
    with open(file, "wb") as stream:
        stream.write("\n".join(header).encode("ascii"))
        points.tofile(stream)


def normals_and_radii(xyz, neighbours=8, block=200_000):
    """Of points in any coordinates: float32 (n, 3) and (n,)."""
    local = xyz - xyz.mean(axis=0)
    tree = cKDTree(local)
    neighbours = min(neighbours, len(local) - 1)
    normals = np.zeros((len(local), 3), "f4")
    radii = np.zeros(len(local), "f4")
    for first in range(0, len(local), block):
        part = slice(first, min(first + block, len(local)))
        _, found = tree.query(local[part], neighbours + 1, workers=-1)
        beside = local[found[:, 1:]] - local[part, None, :]
        centred = local[found] - local[found].mean(axis=1, keepdims=True)
        _, vectors = np.linalg.eigh(np.einsum("nki,nkj->nij", centred, centred))
        normal = vectors[:, :, 0]
        normal *= np.where(normal[:, 2:3] < 0, -1, 1)
        within = beside - np.einsum("nki,ni->nk", beside, normal)[:, :, None] * normal[:, None, :]
        normals[part] = normal
        radii[part] = np.linalg.norm(within, axis=2).max(axis=1)
    return normals, radii


def add_splats(source, target, neighbours=8):
    points = read(source)
    normals, radii = normals_and_radii(np.stack([points[a].astype("f8") for a in "xyz"], axis=1), neighbours)
    kept = [name for name in points.dtype.names if name not in ("nx", "ny", "nz", "radius")]
    result = np.empty(len(points), dtype=[(name, points.dtype[name]) for name in kept] + [(name, "<f4") for name in ("nx", "ny", "nz", "radius")])
    for name in kept:
        result[name] = points[name]
    for axis, name in enumerate(("nx", "ny", "nz")):
        result[name] = normals[:, axis]
    result["radius"] = radii
    write(target, result)


if __name__ == "__main__":
    add_splats(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), *map(int, sys.argv[3:]))
