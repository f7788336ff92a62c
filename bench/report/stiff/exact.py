"""Brute force in extended precision (numpy.longdouble: 64 bits of mantissa on x86), independent of the code that is checked."""
import numpy

LONG = numpy.longdouble


class Wrong(Exception):
    """A defect: what the answer should have been."""


def require(holds, what):
    if not holds:
        raise Wrong(what)


def extended(values):
    return numpy.asarray(values).astype(LONG)


def relative(found, expected, floor=0.0):
    """The largest |found - expected|, relative to the largest |expected|, or to `floor` where that is larger."""
    found, expected = extended(found), extended(expected)
    if found.size == 0:
        return 0.0
    unit = max(numpy.abs(expected).max(), LONG(floor))
    difference = numpy.abs(found - expected).max()
    return float(difference / unit) if unit > 0 else float(difference > 0)


def sorted_rows(xyz):
    """Rows in an order of their own; zeros of either sign are one."""
    xyz = numpy.asarray(xyz) + 0.0
    return xyz[numpy.lexsort(xyz.T[::-1])]


def moved_by(found, expected):
    """By how much the found positions differ per axis from the expected ones, as sets; source units."""
    require(len(found) == len(expected), f"{len(found)} points, not {len(expected)}")
    if len(found) == 0 or (sorted_rows(found) == sorted_rows(expected)).all():
        return 0.0
    return float(numpy.abs(extended(numpy.sort(found, axis=0)) - extended(numpy.sort(expected, axis=0))).max())


def in_box(xyz, box):
    return ((xyz >= box[:3]) & (xyz <= box[3:])).all(axis=1)


def distances(place, xyz):
    """Lengths are scaled, so that no square overflows or underflows."""
    offsets = extended(xyz) - extended(place)
    unit = numpy.abs(offsets).max(initial=0)
    return numpy.sqrt(((offsets / unit) ** 2).sum(axis=1)) * unit if unit > 0 else numpy.zeros(len(xyz), LONG)


def sample_of(count, most):
    """Numbers of points, spread over all."""
    return numpy.unique(numpy.linspace(0, count - 1, min(count, most)).astype(int)) if count else numpy.zeros(0, int)


class Neighbours:
    """A point's k nearest others, nearest first. `clear`: no other choice of k is as near, within rounding."""

    def __init__(self, xyz, point, k):
        far = distances(xyz[point], xyz)
        far[point] = -1
        order = numpy.argsort(far, kind="stable")[1:]  # without the point itself
        self.chosen = order[:k]
        self.distances = far[self.chosen]
        self.clear = len(order) <= k or far[order[k]] > far[order[k - 1]] * (1 + LONG(1e-12))


def principal_axes(offsets):
    """Variances (ascending) and axes (columns) of offsets about their centroid; the scale is taken out."""
    offsets = extended(offsets)
    offsets = offsets - offsets.mean(axis=0)
    unit = numpy.abs(offsets).max()
    if not unit > 0:
        return None
    offsets = offsets / unit
    covariance = numpy.array([[float((offsets[:, a] * offsets[:, b]).mean()) for b in range(3)] for a in range(3)])
    return numpy.linalg.eigh(covariance)
