"""Clouds as columns, the differences between two clouds, and files as the project's reader reads them."""
import dataclasses
import json
import pathlib
import subprocess
import tempfile
from typing import Dict, List, Optional

import numpy as np

TYPES = {"i8": "<i1", "u8": "<u1", "i16": "<i2", "u16": "<u2", "i32": "<i4", "u32": "<u4", "i64": "<i8", "u64": "<u8",
         "f32": "<f4", "f64": "<f8"}


@dataclasses.dataclass
class Attribute:
    values: np.ndarray  # (points, components), raw
    scale: float = 1.0
    offset: float = 0.0
    any_type: bool = False  # of an independent reader that has doubles alone (text): the values count, not their type


@dataclasses.dataclass
class Cloud:
    positions: np.ndarray  # (points, 3) doubles
    attributes: Dict[str, Attribute]
    grid: Optional[np.ndarray] = None  # (points, 3) integers; position = grid * scale + offset
    scale: Optional[List[float]] = None
    offset: Optional[List[float]] = None
    # Largest rounding error of these positions on any axis; 0 when they are exact: one number, or
    # (points, 3).
    uncertainty: object = 0.0
    notes: List[str] = dataclasses.field(default_factory=list)


def column(*components):
    """The components of one attribute side by side."""
    return np.stack([np.asarray(values) for values in components], axis=1)


def read_dump(description, folder):
    """The cloud that dump_cloud wrote into `folder`; `description` is its line."""
    points = description["points"]

    def load(name, kind, components):
        data = np.fromfile(folder / name, dtype=kind)
        if data.size != points * components:
            raise ValueError(f"the dump's column {name} has {data.size} numbers, expected {points} x {components}")
        return data.reshape(points, components)

    cloud = Cloud(load("positions", "<f8", 3), {}, notes=description["notes"])
    if description["grid"]:
        cloud.grid = load("grid", "<i4", 3)
        cloud.scale, cloud.offset = description["grid"]["scale"], description["grid"]["offset"]
    for index, attribute in enumerate(description["attributes"]):
        cloud.attributes[attribute["name"]] = Attribute(
            load(str(index), TYPES[attribute["type"]], attribute["components"]), attribute["scale"], attribute["offset"])
    return cloud


def read_ours(dump_cloud, path):
    """The file as the project reads it. Raises RuntimeError with the project's message for a refused file."""
    with tempfile.TemporaryDirectory(prefix="pcm-independent-") as name:
        done = subprocess.run([dump_cloud, path, name], capture_output=True, text=True, timeout=300)
        if done.returncode != 0:
            raise RuntimeError(done.stderr.strip() or f"exit code {done.returncode}")
        return read_dump(json.loads(done.stdout), pathlib.Path(name))


def first_of(wrong):
    """The place for a message: the first point of `wrong` (points, components) that is set, and their number."""
    rows = np.flatnonzero(wrong.any(axis=1))
    return int(rows[0]), len(rows)


def same_bits(ours, theirs):
    """Equal, where all NaN are equal: their bits have no meaning."""
    if ours.dtype.kind == "f":
        integer = {4: np.uint32, 8: np.uint64}[ours.dtype.itemsize]
        return (ours.view(integer) == theirs.view(integer)) | (np.isnan(ours) & np.isnan(theirs))
    return ours == theirs


def attribute_difference(ours, theirs):
    if ours.values.shape[1] != theirs.values.shape[1]:
        return f"has {ours.values.shape[1]} components, expected {theirs.values.shape[1]}"
    expected = theirs.values
    if theirs.any_type:
        with np.errstate(invalid="ignore", over="ignore"):
            expected = expected.astype(ours.values.dtype)
        if ours.values.dtype.kind != "f":
            lost = expected.astype(np.float64) != theirs.values
            if lost.any():
                at, count = first_of(lost)
                return f"is {ours.values.dtype}, which cannot hold {theirs.values[at]} of point {at} ({count} points)"
    elif ours.values.dtype != expected.dtype.newbyteorder("<"):
        return f"has type {ours.values.dtype}, expected {expected.dtype}"
    expected = np.ascontiguousarray(expected, dtype=ours.values.dtype)
    wrong = ~same_bits(ours.values, expected)
    if wrong.any():
        at, count = first_of(wrong)
        return f"of point {at} is {ours.values[at]}, expected {expected[at]} ({count} points differ)"
    if (ours.scale, ours.offset) != (theirs.scale, theirs.offset):
        return f"has scale and offset {ours.scale}, {ours.offset}, expected {theirs.scale}, {theirs.offset}"
    return None


def box_of(positions):
    if not np.isfinite(positions).any():
        return None
    return np.nanmin(positions, axis=0).tolist(), np.nanmax(positions, axis=0).tolist()


def differences(ours, theirs):
    """The differences between two clouds, in words; empty when they are equal."""
    found = []
    if len(ours.positions) != len(theirs.positions):
        return [f"{len(ours.positions)} points, expected {len(theirs.positions)}"]

    if theirs.grid is not None:
        if ours.grid is None:
            found.append("positions are not on a grid")
        else:
            if [ours.scale, ours.offset] != [list(theirs.scale), list(theirs.offset)]:
                found.append(f"grid {ours.scale} {ours.offset}, expected {theirs.scale} {theirs.offset}")
            wrong = ours.grid != theirs.grid
            if wrong.any():
                at, count = first_of(wrong)
                found.append(f"grid position of point {at} is {ours.grid[at]}, expected {theirs.grid[at]} "
                             f"({count} points differ)")
    exact = not np.any(theirs.uncertainty)
    if exact:
        wrong = ~same_bits(np.ascontiguousarray(ours.positions), np.ascontiguousarray(theirs.positions))
        wrong &= ~((ours.positions == 0) & (theirs.positions == 0))  # -0 and 0 are one place
    else:
        wrong = ~(np.abs(ours.positions - theirs.positions) <= theirs.uncertainty)
        wrong &= ~(np.isnan(ours.positions) & np.isnan(theirs.positions))
    if wrong.any():
        at, count = first_of(wrong)
        found.append(f"position of point {at} is {ours.positions[at].tolist()}, expected "
                     f"{theirs.positions[at].tolist()} ({count} points differ)")
    if exact and box_of(ours.positions) != box_of(theirs.positions):
        found.append(f"box {box_of(ours.positions)}, expected {box_of(theirs.positions)}")

    for name in theirs.attributes:
        if name not in ours.attributes:
            found.append(f"attribute '{name}' is missing")
    for name, attribute in ours.attributes.items():
        if name not in theirs.attributes:
            found.append(f"attribute '{name}' is not in the file")
        elif difference := attribute_difference(attribute, theirs.attributes[name]):
            found.append(f"attribute '{name}' {difference}")
    return found
