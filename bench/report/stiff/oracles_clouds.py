"""Oracles of operations that read, write and change clouds: every point is where it has to be, and none is missing or doubled.

Each takes a cell (run.py) and returns (error, its unit); they throw Wrong for a defect.
"""
import struct

import numpy

from exact import LONG, Wrong, extended, in_box, moved_by, relative, require, sample_of

LAS_HEADER = struct.Struct("<96xI4xBHI")  # offset to points, format, length of a record, number of points (up to LAS 1.3)


def within(error, limit, what):
    """A rounding of doubles on top of what is stated."""
    require(error <= limit, f"{what}: {error:.3g}, stated {limit:.3g}")


def slack(xyz):
    """Two last bits of the largest coordinate: conversions between grid and double round once each."""
    return 4 * numpy.spacing(numpy.abs(xyz).max()) if len(xyz) else 0.0


def same_cloud(found, expected, stated):
    """The largest move, which has to be within what the answer states; relative to the cloud's size."""
    error = moved_by(found, expected)
    within(error, stated + (slack(expected) if stated else 0), "positions moved by")
    size = float((expected.max(axis=0) - expected.min(axis=0)).max()) if len(expected) else 0.0
    return (error / size if size > 0 else error), "of the size"


def build(cell):
    source, answer = cell.stage.case.xyz, cell.answer
    require(answer["points_in"] + 0 == answer["points"] + 0 or answer["points_skipped"], "points are missing without a word")
    kept = source[numpy.isfinite(source).all(axis=1)]
    require(answer["points"] + answer["points_skipped"] >= len(kept), f"{answer['points']} points of {len(source)}, {answer['points_skipped']} skipped")
    require(len(kept) == len(source) or answer["points_skipped"] or answer["warnings"], "points that are not finite vanish without a word")
    return same_cloud(cell.points("out.pct")["xyz"], kept, answer["position_error"])


def las_positions(path):
    data = path.read_bytes()
    start, _, length, count = LAS_HEADER.unpack_from(data)
    if data[25] >= 4:
        count, = struct.unpack_from("<Q", data, 247)
    scale, offset = struct.unpack_from("<3d", data, 131), struct.unpack_from("<3d", data, 155)
    whole = numpy.ndarray((count, 3), "<i4", data, start, (length, 4))
    return whole * numpy.array(scale) + numpy.array(offset)


def convert(cell):
    path = cell.folder / cell.output
    if path.suffix == ".las":
        found = las_positions(path)
    elif path.suffix == ".xyz":
        lines = [line.split() for line in path.read_text().splitlines() if line and not line.startswith(("#", "/"))]
        found = numpy.array([[float(word) for word in line[:3]] for line in lines if line[0].lstrip("-")[0] in "0123456789ni" and line[0] != "x"]).reshape(-1, 3)
    else:
        found = cell.points(cell.output)["xyz"]
    if len(cell.stage.case.xyz) > len(cell.xyz):  # NaN and infinity go from file to file as they are, where the format has them
        kept = len(found) + cell.answer["points_skipped"]
        require(kept == len(cell.stage.case.xyz), f"{kept} points, not {len(cell.stage.case.xyz)}")
        found = found[numpy.isfinite(found).all(axis=1)]
    return same_cloud(found, cell.xyz, cell.answer["position_error"])


def info(cell):
    bounds = cell.answer["bounds"]
    require(cell.answer["points"] == len(cell.xyz), f"{cell.answer['points']} points, not {len(cell.xyz)}")
    if bounds is None:
        require(len(cell.xyz) == 0 or not cell.stage.has_tree, "no bounds")  # a file's are known when it is scanned
        return 0.0, "of the size"
    found = numpy.array([bounds["min"], bounds["max"]])
    return same_cloud(found, numpy.array([cell.xyz.min(axis=0), cell.xyz.max(axis=0)]), 0)


def verify(cell):
    require(cell.answer["intact"] and not cell.answer["faults"], f"faults: {cell.answer['faults']}")
    require(cell.answer["points"] == len(cell.xyz), f"{cell.answer['points']} points, not {len(cell.xyz)}")
    return 0.0, "points"


def repair(cell):
    require(cell.answer["whole"] and cell.answer["points_lost"] == 0, "a whole tree is called damaged")
    return 0.0, "points"


def append(cell):
    source = cell.stage.case.xyz
    expected = numpy.concatenate([cell.xyz, source[numpy.isfinite(source).all(axis=1)]])
    return same_cloud(cell.points("out.pct")["xyz"], expected, cell.answer["position_error"])


def unchanged(cell):
    """The same points, whatever was added to them."""
    return same_cloud(cell.points("out.pct")["xyz"], cell.xyz, cell.answer.get("position_error") or 0)


def merge(cell):
    stated = cell.answer["largest_rounding"]
    return same_cloud(cell.points("out.pct")["xyz"], numpy.concatenate([cell.xyz, cell.xyz]), stated)


def delete(cell):
    inside = in_box(cell.xyz, cell.numbers("--box"))
    require(cell.answer["points_deleted"] == inside.sum(), f"{cell.answer['points_deleted']} points deleted, not {inside.sum()}")
    return same_cloud(cell.points("out.pct")["xyz"], cell.xyz[~inside], 0)


def set_values(cell):
    columns = cell.stage.points_of(cell.stage.folder.resolve() / "copy.pct")
    expected = numpy.where(in_box(columns["xyz"], cell.numbers("--box")), 0.1, 0.0)
    require((columns["tint"] == expected).all(), "other points than those in the box have the value")
    require(cell.answer["points_set"] == (expected > 0).sum(), f"{cell.answer['points_set']} points set, not {(expected > 0).sum()}")
    return same_cloud(columns["xyz"], cell.xyz, 0)


def transform(cell):
    matrix = extended(numpy.array(cell.numbers("--matrix")).reshape(3, 4))
    expected = extended(cell.xyz) @ matrix[:, :3].T + matrix[:, 3]
    found = cell.points("out.pct")["xyz"]
    error = moved_by(found, expected)
    # A double's rounding of each product and sum.
    rounding = 8 * LONG(2) ** -53 * (numpy.abs(extended(cell.xyz)) @ numpy.abs(matrix[:, :3].T) + numpy.abs(matrix[:, 3])).max() if len(found) else 0
    within(error, cell.answer["position_error"] + float(rounding), "positions are off by")
    size = float((expected.max(axis=0) - expected.min(axis=0)).max()) if len(found) else 0.0
    return (error / size if size > 0 else error), "of the size"


def voxel(cell):
    size = cell.numbers("--size")[0]
    voxels, group = numpy.unique(numpy.floor(cell.xyz / size), axis=0, return_inverse=True)
    counts = numpy.bincount(group.ravel(), minlength=len(voxels))
    require(cell.answer["points"] == len(voxels), f"{cell.answer['points']} voxels, not {len(voxels)}")
    require(cell.answer["most_points_in_a_voxel"] == (counts.max() if len(counts) else 0), "another largest number of points in a voxel")
    found = cell.points("out.pct")
    if "--nearest" in cell.words:
        return kept_points(found["xyz"], cell.xyz)
    sums = numpy.zeros((len(voxels), 3), LONG)
    numpy.add.at(sums, group.ravel(), extended(cell.xyz))
    if len(voxels):
        require(int(found["point_count"].sum()) == len(cell.xyz), "the point counts do not add up to the cloud")
    expected = sums / counts[:, None]
    error = moved_by(found["xyz"], expected)
    within(error, slack(cell.xyz) + 1e-9 * size, "centroids are off by")
    return (error / size if len(voxels) else 0.0), "of a voxel"


def kept_points(found, xyz):
    """Every found point is one of the cloud."""
    known = {row.tobytes() for row in xyz + 0.0}
    require(all(row.tobytes() in known for row in found + 0.0), "points that the cloud has not")
    return 0.0, "of a voxel"


def subsample(cell):
    found = cell.points("out.pct")["xyz"]
    kept_points(found, cell.xyz)
    if "--points" in cell.words:
        require(len(found) == min(len(cell.xyz), int(cell.numbers("--points")[0])), f"{len(found)} points")
        return 0.0, "of the spacing"
    spacing, worst = LONG(cell.numbers("--spacing")[0]), LONG(0)
    for row in found[sample_of(len(found), 400)]:
        near = numpy.sort(numpy.sqrt((((extended(found) - row) / spacing) ** 2).sum(axis=1)))
        require((near[1:2] >= 1 - 1e-12).all(), f"two points are {near[1:2].astype(float)} spacings apart")
    for row in cell.xyz[sample_of(len(cell.xyz), 400)]:
        worst = max(worst, numpy.sqrt((((extended(found) - row) / spacing) ** 2).sum(axis=1)).min())
    require(worst <= 1 + 1e-12, f"a point has its nearest one at {float(worst):.6g} spacings")
    return max(0.0, float(worst) - 1), "of the spacing"


def generate(cell):
    found = las_positions(cell.folder / "out.las")
    origin, extent = numpy.array(cell.numbers("--origin")), cell.numbers("--extent")[0]
    require(len(found) == 500, f"{len(found)} points, not 500")
    require(numpy.isfinite(found).all(), "positions that are not finite")
    beyond = numpy.maximum(origin[:2] - found[:, :2], found[:, :2] - origin[:2] - extent).max()
    require(beyond <= 0.05 * extent + slack(found), f"points lie {beyond:.3g} beyond the scene of {extent:.3g}")
    return max(0.0, float(beyond / extent)), "of the size"


def run(cell):
    columns = cell.points("out.pct")
    lengths = numpy.sqrt(sum(extended(columns[name]) ** 2 for name in ("nx", "ny", "nz")))
    require(numpy.isin(numpy.round(lengths.astype(float), 5), (0.0, 1.0)).all(), "normals that are neither unit vectors nor 0")
    # Two operations may round once each; `run` states no error, so that only the doubles' last bits are allowed.
    error = relative(numpy.sort(columns["xyz"], axis=0), numpy.sort(cell.xyz, axis=0)) if len(columns["xyz"]) == len(cell.xyz) else None
    if error is None:
        raise Wrong(f"{len(columns['xyz'])} points, not {len(cell.xyz)}")
    require(error <= 1e-15, f"a translation by 0 moves points by {error:.3g} of their coordinates")
    return error, "of the coordinates"


ORACLES = {"build": build, "convert": convert, "run": run, "info": info, "verify": verify, "append": append, "compact": unchanged, "delete": delete,
           "repair": repair, "set": set_values, "transform": transform, "merge": merge, "voxel": voxel, "subsample": subsample, "generate": generate}
