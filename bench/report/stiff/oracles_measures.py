"""Oracles of measures, fits, motions and pictures: the same numbers in extended precision, and what must hold between them."""
import numpy

from exact import LONG, distances, extended, principal_axes, relative, require

ROUNDING = 1e-9  # relative to the size of what is measured
DENORMAL = 1e-310  # lengths below it have no digits to lose


def along(places):
    steps = numpy.diff(extended(places), axis=0)
    unit = numpy.abs(steps).max()
    return (numpy.sqrt(((steps / unit) ** 2).sum(axis=1)) * unit).sum() if unit > 0 else LONG(0)


def angle(places):
    first, second = extended(places[0] - places[1]), extended(places[2] - places[1])
    first, second = first / numpy.abs(first).max(), second / numpy.abs(second).max()
    return numpy.degrees(numpy.arctan2(numpy.sqrt((numpy.cross(first, second) ** 2).sum()), first @ second))


def plan_area(places):
    x, y = (extended(places)[:, :2] - extended(places)[0, :2]).T
    return abs((x * numpy.roll(y, -1) - numpy.roll(x, -1) * y).sum()) / 2


def to_plane(places):
    offsets = extended(places[1:] - places[0])
    found = principal_axes(offsets)
    if found is None or found[0][1] - found[0][0] < 1e-6 * found[0][2]:
        return None
    return abs(offsets.mean(axis=0) @ found[1][:, 0])


def crosses_itself(places):
    """Two sides of the polygon, seen from above, cross."""
    def side(a, b, c):
        return numpy.sign((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
    corners = extended(places)[:, :2]
    sides = [(corners[i], corners[(i + 1) % len(corners)]) for i in range(len(corners))]
    return any(side(*first, second[0]) * side(*first, second[1]) < 0 and side(*second, first[0]) * side(*second, first[1]) < 0
               for i, first in enumerate(sides) for second in sides[i + 2:])


def measure(cell):
    places = numpy.array(cell.numbers("--points")).reshape(-1, 3)
    values = {name: value["value"] for name, value in cell.answer["measures"][0]["values"].items()}
    size = float(distances(places[0], places).max())
    pairs = {"distance": ("distance", along, 1), "height": (next(iter(values), None), lambda p: p[1, 2] - p[0, 2], 1),
             "angle": ("angle", angle, 180), "area": ("plan area", plan_area, None), "plane": ("distance", to_plane, 1)}
    if cell.variant not in pairs:
        return None
    name, formula, unit = pairs[cell.variant]
    if cell.variant == "area":
        require(not crosses_itself(places) or cell.answer["notes"] or cell.answer["warnings"], "a polygon that crosses itself has an area without a word")
        if crosses_itself(places):
            return None
    expected = formula(places)
    if expected is None:
        return None
    found = values[name]
    error = relative([abs(found)], [abs(expected)], max({1: size, 180: 180, None: size ** 2}[unit], DENORMAL))
    require(error <= ROUNDING, f"{name} is {float(expected):.17g}, not {found:.17g}")
    return error, "of the size"


def profile(cell):
    line, half = extended(cell.numbers("--line")).reshape(2, 2), LONG(cell.numbers("--width")[0]) / 2
    direction = line[1] - line[0]
    length = numpy.sqrt((direction ** 2).sum())
    offsets = extended(cell.xyz)[:, :2] - line[0]
    station = offsets @ direction / length
    beside = numpy.abs(offsets[:, 0] * direction[1] - offsets[:, 1] * direction[0]) / length
    least, most = (int(((beside <= half + ease) & (station >= -ease) & (station <= length + ease)).sum()) for ease in (-1e-9 * length, 1e-9 * length))
    require(least <= cell.answer["points"] <= most, f"{cell.answer['points']} points, not {least} to {most}")
    rows = len((cell.folder / "out.csv").read_text().splitlines()) - 1
    require(rows == cell.answer["points"], f"{rows} rows for {cell.answer['points']} points")
    error = relative([cell.answer["length"]], [length])
    require(error <= 1e-12, f"a length of {cell.answer['length']}, not {float(length)}")
    return error, "of the length"


def net_volume(xyz, low, high, side, reference):
    """Cells with points count; the last of a row and a column are cut."""
    place = ((xyz[:, :2] - low[:2]) / side).astype(numpy.int64)
    most = numpy.maximum(numpy.ceil((high[:2] - low[:2]) / side).astype(numpy.int64) - 1, 0)
    place = numpy.minimum(place, most)
    cells, group = numpy.unique(place, axis=0, return_inverse=True)
    sums = numpy.zeros(len(cells), LONG)
    numpy.add.at(sums, group.ravel(), extended(xyz[:, 2]) - LONG(reference))
    widths = numpy.minimum(extended(low[:2]) + (cells + 1) * LONG(side), extended(high[:2])) - (extended(low[:2]) + cells * LONG(side))
    return (sums / numpy.bincount(group.ravel()) * widths.prod(axis=1)).sum()


def volume(cell):
    answer, xyz = cell.answer, cell.xyz
    low, high = xyz.min(axis=0), xyz.max(axis=0)
    area = LONG(high[0] - low[0]) * LONG(high[1] - low[1])
    error = relative([answer["area"]], [area])
    require(error <= ROUNDING, f"an area of {answer['area']}, not {float(area)}")
    unit = float(area * max(high[2] - low[2], 5e-324))
    require(abs(answer["net"] - (answer["cut"] - answer["fill"])) <= ROUNDING * unit, "net is not cut less fill")
    inside = xyz[((xyz[:, :2] > low[:2]) & (xyz[:, :2] < high[:2])).all(axis=1)]
    both = [net_volume(points, low, high, answer["side"], cell.numbers("--reference")[0]) for points in (xyz, inside) if len(points)]
    if answer["points"] not in (len(xyz), len(inside)) or len(xyz) > 1e5:
        return error, "of the area"
    error = min(float(abs(LONG(answer["net"]) - net)) for net in both) / unit
    require(error <= 1e-6, f"a net volume of {answer['net']}, not {float(both[0])}")
    return error, "of the box"


def align(cell):
    pairs = extended(cell.numbers("--pair")).reshape(-1, 6)
    moving, fixed = pairs[:, :3], pairs[:, 3:]
    matrix = extended(cell.answer["matrix"])
    linear = matrix[:3, :3]
    size = max(float(distances(fixed[0], fixed).max()), 1e-300)
    scale = LONG(cell.answer["scale"])
    turned = numpy.abs(linear @ linear.T / scale ** 2 - numpy.eye(3)).max()
    require(turned <= 1e-12, f"the matrix is no rotation: by {float(turned):.3g}")
    require(numpy.linalg.det((linear / scale).astype(float)) > 0, "the matrix mirrors")
    residual = numpy.sqrt(((moving @ linear.T + matrix[:3, 3] - fixed) ** 2).sum(axis=1).mean())
    far = float(numpy.abs(pairs).max()) * 1e-15
    require(abs(residual - cell.answer["rms"]) <= ROUNDING * size + far, f"an rms of {cell.answer['rms']}, the matrix has {float(residual)}")
    best = best_residual(moving, fixed, "--scale" in cell.words)
    error = float(residual - best) / size
    require(error <= ROUNDING + far / size, f"an rms of {float(residual):.6g} where {float(best):.6g} is possible")
    return max(0.0, error), "of the size"


def best_residual(moving, fixed, with_scale):
    """Umeyama, IEEE TPAMI 13(4), 1991, on scaled coordinates."""
    a, b = moving - moving.mean(axis=0), fixed - fixed.mean(axis=0)
    unit = max(numpy.abs(a).max(), numpy.abs(b).max())
    if not unit > 0:
        return LONG(0)
    a, b = (a / unit).astype(float), (b / unit).astype(float)
    u, s, v = numpy.linalg.svd(b.T @ a)
    signs = numpy.array([1, 1, numpy.sign(numpy.linalg.det(u @ v))])
    scale = (s * signs).sum() / (a ** 2).sum() if with_scale else 1.0
    left = b - scale * a @ (u @ numpy.diag(signs) @ v).T
    return numpy.sqrt((extended(left) ** 2).sum(axis=1).mean()) * unit


def off_shape(xyz, shape):
    """Distances to an endless plane, cylinder or sphere; None for the others."""
    offsets = extended(xyz) - extended(shape["point"])
    if shape["kind"] == "sphere":
        return numpy.abs(distances(shape["point"], xyz) - shape["radius"])
    if shape["kind"] not in ("plane", "cylinder"):
        return None
    axis = extended(shape["axis"])
    axis = axis / numpy.sqrt((axis ** 2).sum())
    height = offsets @ axis
    if shape["kind"] == "plane":
        return numpy.abs(height)
    across = offsets - height[:, None] * axis
    unit = max(numpy.abs(across).max(), LONG(1e-4900))
    return numpy.abs(numpy.sqrt(((across / unit) ** 2).sum(axis=1)) * unit - shape["radius"])


def check_shape(cell, shape, count):
    """At least `count` points of the cloud are within the threshold; returns how far those nearest are, relative to the size."""
    off = off_shape(cell.xyz, shape)
    if off is None:
        return 0.0
    near = off <= shape["threshold"] * (1 + 1e-6) + 4 * numpy.spacing(numpy.abs(cell.xyz).max())
    require(near.sum() >= count, f"{shape['kind']}: {count} points are said to be within {shape['threshold']:.3g}, {near.sum()} are")
    kept = numpy.sort(off)[:count]
    return float(numpy.sqrt((kept ** 2).mean())) / max(cell.stage.size, 1e-300) if count else 0.0


def fit(cell):
    shape = cell.answer["primitive"]
    if shape["verdict"] == "refused":
        return None
    require(cell.variant == "any" or shape["kind"] == cell.variant, f"a {shape['kind']}")
    return check_shape(cell, shape, shape["inliers"]), "rms of the size"


def detect(cell):
    errors = [check_shape(cell, {"threshold": cell.answer["threshold"], **shape}, int(0.9 * shape["points"])) for shape in cell.answer["primitives"]]
    return max(errors, default=0.0), "rms of the size"


def primitives(cell):
    text = (cell.folder / cell.output).read_text()
    require("nan" not in text.lower() and len(text) > 50, "the file has no numbers")
    if cell.output.endswith(".csv"):
        radius = cell.stage.primitive_radius
        values = [float(word) for word in text.replace("\n", ",").split(",") if word[:1].isdigit()]
        error = min((relative([value], [radius]) for value in values), default=1.0)
        require(error <= 1e-12, f"the radius {radius} is not in the file")
        return error, "of the radius"
    return None


def covered(picture, x, y):
    height, width = picture.shape[:2]
    column, row = int(x), int(y)
    return (picture[max(0, row - 2):min(height, row + 3), max(0, column - 2):min(width, column + 3), 3] > 0).any()


def render(cell):
    picture = numpy.load(cell.folder / "out.npy")
    require(picture.shape == (180, 320, 4), f"a picture of {picture.shape}")
    if cell.variant == "":
        require((picture[:, :, 3] > 0).any(), "the default view shows nothing")
        return None
    eye, target = extended(cell.numbers("--eye")), extended(cell.numbers("--target"))
    forward = (target - eye) / numpy.abs(target - eye).max()
    forward /= numpy.sqrt((forward ** 2).sum())
    right = numpy.array([forward[1], -forward[0], 0])
    if not (right ** 2).sum() > 1e-12:
        return None  # which direction is up is the program's choice
    right /= numpy.sqrt((right ** 2).sum())
    up = numpy.cross(right, forward)
    offsets = extended(cell.xyz) - eye
    depth = offsets @ forward
    reach = numpy.tan(numpy.radians(LONG(cell.numbers("--angle")[0])) / 2) * depth
    ahead = depth > 1e-5 * depth.max() if len(depth) and depth.max() > 0 else numpy.zeros(len(depth), bool)
    x = 160 + 90 * (offsets @ right)[ahead] / reach[ahead] * 1
    y = 90 - 90 * (offsets @ up)[ahead] / reach[ahead]
    seen = (x > 1) & (x < 319) & (y > 1) & (y < 179)
    missing = sum(not covered(picture, *place) for place in zip(x[seen], y[seen]))
    require(missing == 0, f"{missing} of {int(seen.sum())} points in view are not in the picture")
    return 0.0, "points"


ORACLES = {"measure": measure, "profile": profile, "volume": volume, "align": align, "fit": fit, "detect": detect, "primitives": primitives, "render": render}
