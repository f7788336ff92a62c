#!/usr/bin/env python3
"""What pcmlab measures, against numpy and shapely, and its drawings read by ezdxf.

    measures.py --pcmlab PCMLAB --dump DUMP_CLOUD --data FOLDER [--python PYTHON]

Exit code 0 when all is equal, 1 when not, 77 (skipped) without the packages of requirements.txt.
"""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

from check import common_arguments, skip

ORIGIN = (500000.0, 4800000.0, 100.0)


class Checks:
    def __init__(self):
        self.failed = 0

    def near(self, what, ours, theirs, tolerance):
        good = abs(ours - theirs) <= tolerance
        self.failed += not good
        if not good:
            print(f"DIFFERENT {what}: {ours!r}, independently {theirs!r}, allowed {tolerance:g}")

    def equal(self, what, ours, theirs):
        self.failed += ours != theirs
        if ours != theirs:
            print(f"DIFFERENT {what}: {ours!r}, independently {theirs!r}")


def run(pcmlab, *arguments):
    done = subprocess.run([pcmlab, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"pcmlab {' '.join(map(str, arguments))}: {done.stderr}")
    return done.stdout


def measure(pcmlab, *arguments):
    return json.loads(run(pcmlab, "measure", *arguments, "--json"))["measures"][-1]["values"]


def flat(points):
    return [repr(float(x)) for point in points for x in point]


def check_areas(pcmlab, checks, numpy, shapely):
    """Random simple polygons at map coordinates; crossing ones are refused exactly where shapely calls them invalid."""
    random = numpy.random.default_rng(1)
    refused = 0
    for round_ in range(60):
        count = int(random.integers(3, 9))
        offsets = random.uniform(-10, 10, (count, 3))
        if round_ % 2:  # a star: simple
            turns = numpy.sort(random.uniform(0, 2 * numpy.pi, count))
            if numpy.max(numpy.diff(numpy.append(turns, turns[0] + 2 * numpy.pi))) > 3:
                continue
            radius = random.uniform(3, 10, count)
            offsets = numpy.stack([radius * numpy.cos(turns), radius * numpy.sin(turns), numpy.zeros(count)], axis=1)
        offsets[:, 2] = 0
        points = offsets + ORIGIN
        polygon = shapely.Polygon(points[:, :2] - points[0, :2])
        done = subprocess.run([pcmlab, "measure", "area", "--json", "-p", *flat(points)], capture_output=True, text=True)
        checks.equal(f"validity of polygon {round_}", done.returncode == 0, polygon.is_valid)
        refused += not polygon.is_valid
        if done.returncode == 0:
            values = json.loads(done.stdout)["measures"][0]["values"]
            checks.near("plan area", values["plan area"]["value"], polygon.area, 1e-9 * polygon.area)
            checks.near("perimeter", values["perimeter"]["value"], polygon.length, 1e-9 * polygon.length)
    checks.equal("polygons of both kinds", refused > 5, True)


def check_planes(pcmlab, checks, numpy):
    random = numpy.random.default_rng(2)
    for _ in range(10):
        turned = numpy.linalg.qr(random.normal(size=(3, 3)))[0]
        points = (random.normal(size=(12, 3)) * (8, 3, 0.05)) @ turned.T + ORIGIN
        others = points[1:] - points[1:].mean(axis=0)
        normal = numpy.linalg.svd(others)[2][2]
        distance = abs(normal @ (points[0] - points[1:].mean(axis=0)))
        values = measure(pcmlab, "plane", "-p", *flat(points))
        checks.near("distance to a plane", values["distance"]["value"], distance, 1e-8)
        checks.near("residual", values["residual"]["value"], numpy.sqrt(numpy.mean((others @ normal) ** 2)), 1e-8)


def key_of(point):
    """The export as text has the decimals of the scan, the profile the doubles that the grid makes."""
    return tuple(round(float(x), 6) for x in point)


def positions_of(pcmlab, tree, folder, numpy):
    run(pcmlab, "convert", tree, folder / "all.xyz", "--quiet")
    return numpy.loadtxt(folder / "all.xyz", usecols=(0, 1, 2))


def check_profile(pcmlab, checks, numpy, shapely, tree, points, folder):
    line = numpy.array([[2, 5], [25, 30], [55, 12]]) + ORIGIN[:2]
    run(pcmlab, "profile", tree, "--line", *flat(line), "-w", 1.5, "-o", folder / "profile.csv")
    with open(folder / "profile.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    ours = {key_of(row[k] for k in "xyz"): (float(row["station"]), float(row["offset"])) for row in rows}
    string = shapely.LineString(line - ORIGIN[:2])
    places = shapely.points(points[:, :2] - ORIGIN[:2])
    distances, stations = shapely.distance(string, places), shapely.line_locate_point(string, places)
    # Flat ends: what is nearest to an end lies before or behind it.
    inside = (distances <= 0.75) & (stations > 1e-12) & (stations < string.length - 1e-12)
    expected = {key_of(p): (s, d) for p, s, d in zip(points[inside], stations[inside], distances[inside])}
    checks.equal("points of the profile", len(ours) == len(expected) and set(ours) == set(expected), True)
    for place, (station, distance) in expected.items():
        if place in ours:
            checks.near("station", ours[place][0], station, 1e-8)
            checks.near("offset", abs(ours[place][1]), distance, 1e-8)
    return len(expected)


def filled(numpy, height, area):
    """Gaps of the heights: a plane by least squares, and Laplace's equation for what is left of it, by Jacobi's rounds."""
    known = (area > 0) & ~numpy.isnan(height)
    x, y = numpy.meshgrid(*(numpy.arange(n, dtype=float) for n in height.shape), indexing="ij")
    weights = area[known]
    x, y = x - numpy.average(x[known], weights=weights), y - numpy.average(y[known], weights=weights)
    mean = numpy.average(height[known], weights=weights)
    sides = numpy.stack([x[known], y[known]])
    slopes = numpy.linalg.solve((sides * weights) @ sides.T + numpy.eye(2) * weights.sum() / 4,
                                (sides * weights) @ (height[known] - mean))
    plane = mean + slopes[0] * x + slopes[1] * y
    rest = numpy.where(known, height - plane, 0)
    inside = numpy.pad(area > 0, 1)
    around = [numpy.roll(inside, s, axis=a)[1:-1, 1:-1] for a in (0, 1) for s in (-1, 1)]
    count = numpy.maximum(1, sum(one.astype(int) for one in around))
    for _ in range(4000):
        padded = numpy.pad(rest, 1)
        sides = [numpy.roll(padded, s, axis=a)[1:-1, 1:-1] for a in (0, 1) for s in (-1, 1)]
        rest = numpy.where(known, rest, sum(numpy.where(i, s, 0) for i, s in zip(around, sides)) / count)
    return plane + rest


def check_volume(pcmlab, checks, numpy, shapely, tree, points):
    """In a polygon; cells by numpy's histograms, their areas by shapely."""
    corners = numpy.array([[5, 5], [50, 8], [40, 30], [52, 52], [8, 45]]) + ORIGIN[:2]
    side, level = 1.7, 98.5
    report = json.loads(run(pcmlab, "volume", tree, "--reference", level, "--polygon", *flat(corners), "--side", side,
                            "--measured-only", "--json"))
    whole = json.loads(run(pcmlab, "volume", tree, "--reference", level, "--polygon", *flat(corners), "--side", side,
                           "--json"))
    polygon = shapely.Polygon(corners - corners.min(axis=0))
    xy = points[:, :2] - corners.min(axis=0)
    inside = shapely.contains_xy(polygon, xy)
    xy, z = xy[inside], points[inside, 2] - level
    columns, rows = numpy.ceil((corners.max(axis=0) - corners.min(axis=0)) / side).astype(int)
    edges = [numpy.arange(columns + 1) * side, numpy.arange(rows + 1) * side]
    count = numpy.histogram2d(*xy.T, bins=edges)[0]
    total = numpy.histogram2d(*xy.T, bins=edges, weights=z)[0]
    cut = fill = empty = 0.0
    areas, heights = numpy.zeros((columns, rows)), numpy.full((columns, rows), numpy.nan)
    for i in range(columns):
        for j in range(rows):
            cell = shapely.box(i * side, j * side, (i + 1) * side, (j + 1) * side)
            area = shapely.intersection(polygon, cell).area
            areas[i, j] = area
            heights[i, j] = total[i, j] / count[i, j] if count[i, j] else numpy.nan
            if count[i, j] == 0:
                empty += area
                continue
            volume = area * total[i, j] / count[i, j]
            cut, fill = cut + max(volume, 0), fill + max(-volume, 0)
    checks.near("area", report["area"], polygon.area, 1e-9 * polygon.area)
    checks.equal("points in the polygon", report["points_of_tree"], int(inside.sum()))
    checks.near("cut", report["cut"], cut, 1e-8 * cut)
    checks.near("fill", report["fill"], fill, 1e-8 * fill)
    checks.near("area without points", report["area_without_data"], empty, 1e-8 * polygon.area)
    checks.equal("some of the area has no points", empty > 0, True)
    checks.near("area interpolated", whole["area_interpolated"], empty, 1e-8 * polygon.area)
    checks.near("part with points", whole["covered"], 1 - empty / polygon.area, 1e-8)
    volume = filled(numpy, heights, areas) * areas
    checks.near("net of the whole polygon", whole["net"], volume.sum(), 1e-4 * empty)
    checks.near("cut of the whole polygon", whole["cut"], volume[volume > 0].sum(), 1e-3 * empty)
    counted = areas[count > 0]
    roughly = empty * numpy.sqrt((counted * heights[count > 0] ** 2).sum() / counted.sum())
    checks.equal("what is left out may hold what the rest does", report["net_uncertainty"] >= 0.999 * roughly, True)
    checks.equal("interpolation is uncertain", whole["net_uncertainty"] > 0, True)


def faults_of(drawing):
    """Nothing is wrong, and nothing has to be mended."""
    audit = drawing.audit()
    return [str(fault.message) for fault in audit.errors + audit.fixes]


def check_drawings(pcmlab, checks, ezdxf, tree, profile_points, folder):
    """Read without a fault, every coordinate bit for bit."""
    from ezdxf.lldxf.encoding import decode_dxf_unicode
    line = [(500000.123456789, 4800000.987654321, 101.1), (500003.3333333333, 4800007.1, 102.0), (500010.1, 4799999.9, 0.1)]
    run(pcmlab, "measure", "distance", "--name", "Länge ≥ 50 %, ^x", "-p", *flat(line), "-o", folder / "a.json")
    run(pcmlab, "measure", "area", "--list", folder / "a.json", "-p", *flat(line), "-o", folder / "b.dxf")
    drawing = ezdxf.readfile(folder / "b.dxf")
    checks.equal("faults that ezdxf finds", faults_of(drawing), [])
    checks.equal("layers", {"pcm_distance", "pcm_area"} <= {layer.dxf.name for layer in drawing.layers}, True)
    lines = [entity for entity in drawing.modelspace() if entity.dxftype() == "POLYLINE"]
    checks.equal("polylines in space", [entity.is_3d_polyline for entity in lines], [True, True])
    checks.equal("closed", [entity.is_closed for entity in lines], [False, True])
    checks.equal("vertices", [tuple(v.dxf.location) for v in lines[0].vertices], line)
    texts = [decode_dxf_unicode(entity.plain_text()) for entity in drawing.modelspace() if entity.dxftype() == "TEXT"]
    checks.equal("text", any(text.startswith("Länge ≥ 50 %, ^x: ") for text in texts), True)
    run(pcmlab, "profile", tree, "--line", *flat([(500002, 4800005), (500025, 4800030), (500055, 4800012)]), "-w", 1.5, "-o",
        folder / "p.dxf", "--in-place")
    drawing = ezdxf.readfile(folder / "p.dxf")
    checks.equal("faults that ezdxf finds", faults_of(drawing), [])
    found = [tuple(entity.dxf.location) for entity in drawing.modelspace() if entity.dxftype() == "POINT"]
    checks.equal("points of the drawing", len(found), profile_points)
    with open(folder / "profile.csv", newline="") as file:
        rows = {tuple(float(row[k]) for k in "xyz") for row in csv.DictReader(file)}
    checks.equal("coordinates of the drawing", set(found), rows)


def check_geojson(pcmlab, checks, shapely, folder):
    run(pcmlab, "measure", "area", "-p", *flat([(500000.1, 4800000, 1), (500000.1, 4800004, 1), (500003.1, 4800004, 1)]),
        "-o", folder / "a.geojson")
    feature = json.loads((folder / "a.geojson").read_text())["features"][0]
    polygon = shapely.geometry.shape(feature["geometry"])
    checks.equal("valid, and counter-clockwise", (polygon.is_valid, polygon.exterior.is_ccw), (True, True))
    checks.near("area", polygon.area, feature["properties"]["plan_area"], 1e-9)


def main():
    arguments = common_arguments(__doc__, lambda parser: parser.add_argument("--pcmlab", required=True))
    try:
        import ezdxf
        import numpy
        import shapely
        import shapely.geometry
    except ImportError as error:
        skip(f"{error}; packaging/test-python installs what the comparison needs")
    checks, pcmlab = Checks(), arguments.pcmlab
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        run(pcmlab, "generate", "-n", 120000, "--seed", 5, "--no-truth", folder / "a.las", "--quiet")
        tree = folder / "a.pct"
        run(pcmlab, "build", folder / "a.las", "-m", "128M", "--quiet")
        points = positions_of(pcmlab, tree, folder, numpy)
        check_areas(pcmlab, checks, numpy, shapely)
        check_planes(pcmlab, checks, numpy)
        count = check_profile(pcmlab, checks, numpy, shapely, tree, points, folder)
        check_volume(pcmlab, checks, numpy, shapely, tree, points)
        check_drawings(pcmlab, checks, ezdxf, tree, count, folder)
        check_geojson(pcmlab, checks, shapely, folder)
    print("equal" if not checks.failed else f"{checks.failed} differences")
    return 1 if checks.failed else 0


if __name__ == "__main__":
    sys.exit(main())
