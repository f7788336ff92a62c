"""Oracles of operations that look at points and their neighbours: by comparing all pairs."""
import numpy

from exact import LONG, Neighbours, distances, extended, in_box, principal_axes, relative, require, sample_of
from oracles_clouds import same_cloud

SAMPLE = 60  # points whose neighbours are found by comparing all
FLOAT = 2.0 ** -22  # two roundings of a float
LEAST_FLOAT = 1.5e-45


def box(cell):
    expected = int(in_box(cell.xyz, cell.numbers("--box")).sum())
    if "--estimate" in cell.words:
        least, most = cell.answer["points_least"], cell.answer["points_most"]
        require(least <= expected <= most, f"{expected} points, estimated {least} to {most}")
        return 0.0, "points"
    require(cell.answer["points"] == expected, f"{cell.answer['points']} points in the box, not {expected}")
    return 0.0, "points"


def sphere(cell):
    *centre, radius = cell.numbers("--sphere")
    far = distances(centre, cell.xyz)
    least, most = (far < radius * (1 - LONG(1e-12))).sum(), (far <= radius * (1 + LONG(1e-12))).sum()
    require(least <= cell.answer["points"] <= most, f"{cell.answer['points']} points in the sphere, not {least} to {most}")
    return 0.0, "points"


def nearest(cell):
    k = int(cell.numbers("--neighbours")[0])
    expected = numpy.sort(distances(cell.numbers("--nearest"), cell.xyz))[:k]
    found = cell.answer["neighbours"] or []
    require(len(found) == len(expected), f"{len(found)} neighbours, not {len(expected)}")
    error = relative([near["distance"] for near in found], expected)
    require(error <= 1e-12, f"distances differ by {error:.3g} of the largest")
    return error, "of the distance"


def first_hit(cell):
    numbers = cell.numbers("--ray")
    start, direction, radius = extended(numbers[:3]), extended(numbers[3:6]), numbers[6]
    offsets = extended(cell.xyz) - start
    along = offsets @ direction
    beside = numpy.sqrt(((offsets - along[:, None] * direction) ** 2).sum(axis=1))
    hits = along[(beside <= radius) & (along >= 0)]
    hit = cell.answer["hit"]
    require((hit is None) == (len(hits) == 0) or numpy.abs(beside / radius - 1).min() < 1e-9, f"hit {hit}, expected {len(hits)} hits")
    if hit is None or not len(hits):
        return 0.0, "of the distance"
    error = relative([hit["along"]], [hits.min()])
    require(error <= 1e-9, f"the first point is at {float(hits.min())}, not {hit['along']}")
    return error, "of the distance"


def frustum(cell):
    """The view is from above and has the width of its height."""
    eye, target, (degrees, aspect, near, far) = *numpy.array(cell.numbers("--frustum")[:6]).reshape(2, 3), cell.numbers("--frustum")[6:10]
    forward = extended(target) - extended(eye)
    forward /= numpy.sqrt((forward ** 2).sum())
    offsets = extended(cell.xyz) - extended(eye)
    depth = offsets @ forward
    reach = numpy.tan(numpy.radians(LONG(degrees)) / 2) * depth
    beside = numpy.abs(offsets[:, :2])

    def count(ease):
        inside = (depth >= near * (1 - ease)) & (depth <= far * (1 + ease))
        return int((inside & (beside[:, 0] <= aspect * reach * (1 + ease)) & (beside[:, 1] <= reach * (1 + ease))).sum())
    least, most = count(LONG(-1e-9)), count(LONG(1e-9))
    require(least <= cell.answer["points"] <= most, f"{cell.answer['points']} points in the frustum, not {least} to {most}")
    return 0.0, "points"


def query(cell):
    return {"box": box, "estimate": box, "sphere": sphere, "nearest": nearest, "first_hit": first_hit, "frustum": frustum}[cell.variant](cell)


def select(cell):
    if cell.variant == "box":
        return box(cell)
    require(cell.answer["points"] >= 1, "the place that is grown from is not selected")
    return None


def neighbours_of(cell, xyz, k):
    """Sampled points of a result with their neighbours by comparing all."""
    for point in sample_of(len(xyz), SAMPLE):
        yield point, Neighbours(xyz, point, k)


def finite(columns, *names):
    for name in names:
        require(numpy.isfinite(columns[name]).all(), f"{name} is not finite")


def mean_distances(cell, columns, k):
    worst = 0.0
    for point, near in neighbours_of(cell, columns["xyz"], k):
        expected = near.distances.mean() if len(near.distances) else LONG(0)
        difference = abs(LONG(columns["mean_distance"][point]) - expected)
        require(difference <= FLOAT * expected + LEAST_FLOAT, f"mean_distance {columns['mean_distance'][point]:.9g}, not {float(expected):.9g}")
        worst = max(worst, float(difference / expected) if expected > 0 else 0.0)
    return worst, "of the distance"


def radii(cell):
    columns, k = cell.points("out.pct"), int(cell.numbers("--neighbours")[0])
    same_cloud(columns["xyz"], cell.xyz, 0)
    finite(columns, "radius", "mean_distance")
    for point, near in neighbours_of(cell, columns["xyz"], k):
        most = near.distances.max() if len(near.distances) else LONG(0)
        require(columns["radius"][point] <= most * (1 + LONG(FLOAT)) + LEAST_FLOAT, f"a radius of {columns['radius'][point]:.9g}, neighbours within {float(most):.9g}")
    return mean_distances(cell, columns, k)


def normals(cell):
    """The angle between normals, where the least variance is clearly the least, and no other choice of neighbours is as near."""
    columns, k = cell.points("out.pct"), int(cell.numbers("--neighbours")[0])
    same_cloud(columns["xyz"], cell.xyz, 0)
    finite(columns, "nx", "ny", "nz", "radius", "curvature")
    require(((columns["curvature"] >= 0) & (columns["curvature"] <= 1 / 3 + 1e-6)).all(), "curvatures beyond 0 to 1/3")
    worst = 0.0
    for point, near in neighbours_of(cell, columns["xyz"], k):
        found = extended([columns[name][point] for name in ("nx", "ny", "nz")])
        length = numpy.sqrt((found ** 2).sum())
        axes = principal_axes(columns["xyz"][[point, *near.chosen]] - columns["xyz"][point])
        if axes is None or not near.clear or len(near.chosen) < 2:
            require(length == 0 or abs(length - 1) < 1e-5, f"a normal of length {float(length):.6g}")
            continue
        require(abs(length - 1) < 1e-5, f"a normal of length {float(length):.6g}, though the points are not at one place")
        (least, middle, most), directions = axes
        if middle - least < 1e-6 * most:
            continue
        worst = max(worst, float(numpy.sqrt(((found / length - directions[:, 0] * numpy.sign(found @ directions[:, 0])) ** 2).sum())))
    require(worst <= 1e-5, f"a normal is turned by {worst:.3g} rad")
    return worst, "rad"


def outliers(cell):
    answer, xyz = cell.answer, cell.xyz
    if not 0 < len(xyz) <= 5000:
        return None
    k = int(cell.numbers("--neighbours")[0]) if "--neighbours" in cell.words else 16
    if cell.variant == "radius":
        radius = LONG(cell.numbers("--radius")[0])
        within = [(lambda far: ((far <= radius * (1 - LONG(1e-12))).sum() - 1, (far <= radius * (1 + LONG(1e-12))).sum() - 1))(distances(place, xyz)) for place in xyz]
        least, most = sum(high < k for _, high in within), sum(low < k for low, _ in within)
        require(least <= answer["outliers"] <= most, f"{answer['outliers']} outliers, not {least} to {most}")
        return 0.0, "points"
    columns = cell.points("out.pct")
    same_cloud(columns["xyz"], xyz, 0)
    means = numpy.array([numpy.sort(distances(place, xyz))[1:k + 1].mean() if len(xyz) > 1 else LONG(0) for place in xyz], LONG)
    unit = means.max() if len(means) and means.max() > 0 else LONG(1)
    if cell.variant == "label":
        centre, deviation = means.mean(), numpy.sqrt(((means / unit - means.mean() / unit) ** 2).mean()) * unit
    else:
        centre = numpy.sort(means)[len(means) // 2] if len(means) % 2 else (numpy.sort(means)[len(means) // 2 - 1:][:2]).mean()
        deviation = LONG("1.4826") * median(numpy.abs(means - centre))
        if (means == means[0]).mean() > 0.5 or deviation == 0:
            return None
    error = relative([answer["centre"], answer["deviation"]], [centre, deviation])
    require(error <= 1e-9, f"centre and deviation {answer['centre']}, {answer['deviation']}, not {float(centre)}, {float(deviation)}")
    threshold = centre + 3 * deviation
    ease = LONG(1e-9) * max(threshold, unit)
    least, most = (means > threshold + ease).sum(), (means > threshold - ease).sum()
    require(least <= answer["outliers"] <= most, f"{answer['outliers']} outliers, not {least} to {most}")
    require(int(columns["outlier"].sum()) == answer["outliers"], "the labels are not those that are counted")
    return error, "of the distance"


def median(values):
    values = numpy.sort(values)
    middle = len(values) // 2
    return values[middle] if len(values) % 2 else (values[middle - 1] + values[middle]) / 2


def pick(cell):
    point = cell.answer["point"]
    if point is not None:
        nearest_one = distances(point["position"], cell.xyz).min()
        require(nearest_one <= 1e-12 * max(1.0, float(numpy.abs(cell.xyz).max())), f"no point of the cloud is at {point['position']}")
    if cell.variant == "ray":
        require(point is not None or not len(cell.xyz), "the ray through a point meets none")
    return None


ORACLES = {"query": query, "select": select, "radii": radii, "normals": normals, "outliers": outliers, "pick": pick}
