"""PTS, PTX and other text formats, read by a few lines of Python with a list of the columns of every sample."""
import re

import numpy as np

from compare import Attribute, Cloud

# The columns of samples without a header, or with unclear names.
COLUMNS = {
    "ripple.txt": "x y z r g b nx ny nz",
    "cube.pwn": "x y z nx ny nz",
    "sphere_20k_normal.xyz": "x y z nx ny nz",
    "autzen-point-format-3.txt": "r g x y b z",
    "crlf_test.txt": "x y z intensity",
    "with_edgeofflightline.txt": "x y z OffsetTime edge_of_flight_line",
}
GROUPS = {"rgb": "r g b".split(), "normal": "nx ny nz".split()}


def rows_of(lines, columns=None):
    """The numbers of the lines that have any, `columns` of each; headers and blank lines are skipped."""
    rows = []
    for line in lines:
        words = re.split(r"[\s,;]+", line.strip().strip(",;"))
        try:
            rows.append([float(word) for word in words[:columns]])
        except ValueError:
            pass
    return np.array(rows, dtype=np.float64)


def cloud_of(rows, columns):
    values = {name: rows[:, i] for i, name in enumerate(columns)}
    positions = np.stack([values.pop(axis) for axis in "xyz"], axis=1)
    attributes = {}
    for group, members in GROUPS.items():
        if members[0] in values:
            attributes[group] = Attribute(np.stack([values.pop(name) for name in members], axis=1), any_type=True)
    for name, numbers in values.items():
        attributes[name] = Attribute(numbers.reshape(-1, 1), any_type=True)
    return Cloud(positions, attributes)


def read_pts(lines):
    blocks = []
    at = 0
    while at < len(lines):
        words = lines[at].split()
        count = int(words[0]) if len(words) == 1 else len(lines) - at
        at += len(words) == 1
        blocks.append(rows_of(lines[at:at + count]))
        at += count
    rows = np.concatenate(blocks)
    return cloud_of(rows, {3: "x y z", 4: "x y z intensity", 7: "x y z intensity r g b"}[rows.shape[1]].split())


def read_ptx(lines):
    """Every scan: p * M as in the format's description, missing returns (0 0 0) left out."""
    at = 0
    parts = []
    while at < len(lines):
        columns, rows = int(lines[at]), int(lines[at + 1])
        matrix = rows_of(lines[at + 6:at + 10])
        points = rows_of(lines[at + 10:at + 10 + columns * rows])
        at += 10 + columns * rows
        points = points[(points[:, :3] != 0).any(axis=1)]
        terms = np.concatenate([points[:, :3], np.ones((len(points), 1))], axis=1)[:, :, None] * matrix[None, :, :3]
        # Four roundings of products and three of sums, each at most half a unit of the largest partial sum.
        bound = np.abs(terms).sum(axis=1) * 7 * 2.0**-53
        exact = terms.astype(np.longdouble).sum(axis=1).astype(np.float64)
        parts.append((exact, points[:, 3:], bound, len(parts) + 1))
    attributes = {}
    rest = np.concatenate([part[1] for part in parts])
    attributes["intensity"] = Attribute(rest[:, :1], any_type=True)
    if rest.shape[1] == 4:
        attributes["rgb"] = Attribute(rest[:, 1:], any_type=True)
    if len(parts) > 1:
        attributes["scan"] = Attribute(np.concatenate([np.full((len(p[0]), 1), float(p[3])) for p in parts]), any_type=True)
    return Cloud(np.concatenate([part[0] for part in parts]), attributes,
                 uncertainty=np.concatenate([part[2] for part in parts]))


def read(path):
    lines = [line for line in path.read_text(encoding="latin-1").splitlines() if line.strip()]
    if path.suffix == ".pts":
        return read_pts(lines)
    if path.suffix == ".ptx":
        return read_ptx(lines)
    columns = COLUMNS.get(path.name, "x y z").split()
    return cloud_of(rows_of(lines, len(columns)), columns)
