#!/usr/bin/env python3
"""Drawings of primitives read by ezdxf and compared with the exact surfaces; scripts for AutoCAD replayed.

    primitives.py --pcmlab PCMLAB --dump DUMP_CLOUD --data FOLDER [--python PYTHON]

Exit code 0 when all is equal, 1 when not, 77 (skipped) without the packages of requirements.txt.
"""
import collections
import csv
import json
import math
import pathlib
import sys
import tempfile
from fractions import Fraction

from check import common_arguments, skip
from measures import Checks, ORIGIN, faults_of, run
from replay_script import Replay, cross, dot, minus, plus, times

UNITS = {"m": (6, 1), "mm": (4, 1), "cm": (5, 1), "ft": (2, 0), "in": (1, 0)}
NAMES = ["Röhre ≥ 5 </>\"|,", "röhre ≥ 5 </>\"|,", "Wall", "WALL", "0", "a" * 900, "a" * 900, "😀" * 60, "= 1+1", " x "]


def random_list(numpy, count):
    random = numpy.random.default_rng(3)
    primitives = []
    for i in range(count):
        kind = ["cylinder", "sphere", "cone", "torus", "plane"][i % 5]
        axis = random.normal(size=3)
        axis /= numpy.linalg.norm(axis)
        if i % 7 == 0:
            axis = numpy.array([[0, 0, 1], [0, 0, -1], [1, 0, 0], [0, -1, 0]][i // 7 % 4], dtype=float)
        u = numpy.cross(axis, [0.3, 0.5, 0.8])
        u /= numpy.linalg.norm(u)
        v = numpy.cross(axis, u)
        point = numpy.array(ORIGIN) + random.uniform(-50, 50, 3)
        one = {"name": NAMES[i] if i < len(NAMES) else f"{kind} {i}", "kind": kind, "point": point.tolist(),
               "colour": [int(c) for c in random.integers(0, 256, 3)]}
        if kind != "sphere":
            one["axis"] = axis.tolist()
        if kind in ("cylinder", "sphere"):
            one["radius"] = float(random.uniform(0.01, 3))
        begin = float(random.uniform(0, 6.2))
        arc = {"zero": u.tolist(), "begin": begin, "end": begin + float(random.uniform(0.2, 6))}
        if kind == "cylinder":
            one["bounds"] = {"from": float(random.uniform(-5, 0)), "to": float(random.uniform(1, 9)), **arc}
        if kind == "cone":
            one["half_angle"] = float(random.uniform(0.05, 1.4))
            one["bounds"] = {"from": float(max(0, random.uniform(-1, 1))), "to": float(random.uniform(1.1, 4))}
        if kind == "torus":
            one["radius"] = float(random.uniform(0.5, 3))
            one["tube_radius"] = one["radius"] * float(random.uniform(0.05, 0.9))
            if i % 2:
                one["bounds"] = arc
        if kind == "plane":
            turns = numpy.sort(random.uniform(0, 2 * math.pi, 3 + i % 6))
            corners = [point + r * (math.cos(t) * u + math.sin(t) * v)
                       for t, r in zip(turns, random.uniform(0.3 if i % 2 else 2, 2, len(turns)))]
            if numpy.max(numpy.diff(numpy.append(turns, turns[0] + 2 * math.pi))) > 3:
                corners = [point - u - v, point + u - v, point + u + v, point - u + v]
            one["bounds"] = {"outline": [c.tolist() for c in corners]}
        primitives.append(one)
    return primitives


def distance_and_normal(numpy, one, p):
    """From the exact surface, in double precision about the primitive's point."""
    d = p - numpy.array(one["point"])
    if one["kind"] == "sphere":
        r = numpy.linalg.norm(d)
        return r - one["radius"], d / r
    n = numpy.array(one["axis"])
    h, across = n @ d, d - (n @ d) * n
    q = numpy.linalg.norm(across)
    w = across / q if q > 1e-12 else numpy.zeros(3)
    if one["kind"] == "cylinder":
        return q - one["radius"], w
    if one["kind"] == "cone":
        c, s = math.cos(one["half_angle"]), math.sin(one["half_angle"])
        return q * c - h * s, c * w - s * n
    out = q - one["radius"]
    r = math.hypot(out, h)
    return r - one["tube_radius"], (out * w + h * n) / r


def check_mesh(numpy, checks, one, faces, chord):
    name = f"{one['kind']} {one['name'][:20]}"
    edges = collections.Counter()
    bounds = one.get("bounds", {})
    farthest = 0
    for face in faces:
        corners = [p for k, p in enumerate(face) if p != face[k - 1]]
        edges.update((a, b) for a, b in zip(corners, corners[1:] + corners[:1]))
        points = [numpy.array(c) for c in corners]
        farthest = max(farthest, *(abs(distance_and_normal(numpy, one, p)[0]) for p in points))
        middle = sum(points) / len(points)
        normal = numpy.cross(points[1] - points[0], points[2] - points[0])
        normal /= numpy.linalg.norm(normal)
        away, outwards = distance_and_normal(numpy, one, middle)
        if is_cap(numpy, one, bounds, points):
            continue
        checks.equal(f"a face of {name} looks outwards", bool(normal @ outwards > 0), True)
        checks.equal(f"a face of {name} is near", abs(away) <= chord * 1.000001 + 1e-8, True)
    checks.near(f"corners of {name} off the surface", farthest, 0, 1e-6)
    checks.equal(f"{name} is closed", all(edges[b, a] == n == 1 for (a, b), n in edges.items()), True)


def is_cap(numpy, one, bounds, points):
    if one["kind"] in ("cylinder", "cone"):
        n = numpy.array(one["axis"])
        heights = [n @ (p - numpy.array(one["point"])) for p in points]
        return max(heights) - min(heights) < 1e-7
    if one["kind"] == "torus" and "zero" in bounds:
        n, zero = numpy.array(one["axis"]), numpy.array(bounds["zero"])
        for angle in (bounds["begin"], bounds["end"]):
            side = -math.sin(angle) * zero + math.cos(angle) * numpy.cross(n, zero)
            if max(abs(side @ (p - numpy.array(one["point"]))) for p in points) < 1e-7:
                return True
    return False


def check_plane(numpy, shapely, checks, one, entities):
    outline = [tuple(c) for c in one["bounds"]["outline"]]
    lines = [e for e in entities if e.dxftype() == "POLYLINE"]
    checks.equal("an outline, closed, to the bit",
                 [([tuple(v.dxf.location) for v in e.vertices], e.is_closed) for e in lines], [(outline, True)])
    n = numpy.array(one["axis"])
    u = numpy.cross(n, [0.3, 0.5, 0.8])
    u /= numpy.linalg.norm(u)
    flat = lambda points: [(u @ (numpy.array(p) - one["point"]), numpy.cross(n, u) @ (numpy.array(p) - one["point"]))
                           for p in points]
    parts = [shapely.Polygon(flat([e.dxf.vtx0, e.dxf.vtx1, e.dxf.vtx2])) for e in entities if e.dxftype() == "3DFACE"]
    whole = shapely.Polygon(flat(outline))
    checks.near("area of the faces", sum(p.area for p in parts), whole.area, 1e-7)
    checks.near("area of their union", shapely.unary_union(parts).symmetric_difference(whole).area, 0, 1e-6)


def check_lines(numpy, checks, one, entities):
    """Lines on the surface, which programs without faces show; the axis from end to end; circles only across z."""
    polylines = [e for e in entities if e.dxftype() == "POLYLINE"]
    whole = 0
    for e in polylines:
        corners = [numpy.array(tuple(v.dxf.location)) for v in e.vertices]
        whole += e.is_closed and len(corners) > 2
        for p in corners:
            checks.near(f"a line of {one['name'][:20]}", distance_and_normal(numpy, one, p)[0], 0, 1e-6)
    circles = [e for e in entities if e.dxftype() == "CIRCLE"]
    for e in circles:
        checks.equal("a circle's axis", tuple(e.dxf.extrusion), (0, 0, 1))
        for angle in numpy.radians(numpy.arange(0, 360, 40)):
            p = numpy.array(tuple(e.dxf.center)) + e.dxf.radius * numpy.array((math.cos(angle), math.sin(angle), 0))
            checks.near(f"a circle of {one['name'][:20]}", distance_and_normal(numpy, one, p)[0], 0, 1e-6)
    kinds = collections.Counter(e.dxftype() for e in entities)
    ends = 1 if one["kind"] == "cone" and one["bounds"]["from"] == 0 else 2
    upright = one["kind"] in ("cylinder", "cone") and one["axis"][0] == 0 and one["axis"][1] == 0
    checks.equal("circles and arcs", (kinds["CIRCLE"], kinds["ARC"]), (ends if upright else one["kind"] == "sphere", 0))
    expected = {"cylinder": ends, "cone": ends, "sphere": 3}
    if one["kind"] in expected:
        checks.equal("rims", whole + len(circles), expected[one["kind"]])
        checks.equal("straight lines", len(polylines) - whole, 0 if one["kind"] == "sphere" else 4)
    else:
        checks.equal("lines of a torus", len(polylines) >= 7, True)
    for e in (e for e in entities if e.dxftype() == "LINE"):
        ends = [numpy.array(tuple(p)) - numpy.array(one["point"]) for p in (e.dxf.start, e.dxf.end)]
        n = numpy.array(one["axis"])
        size = (-one["tube_radius"], one["tube_radius"]) if one["kind"] == "torus" else (one["bounds"]["from"],
                                                                                         one["bounds"]["to"])
        for d, h in zip(ends, size):
            checks.near("an end of the axis", numpy.linalg.norm(d - h * n), 0, 1e-6)


def check_index(checks, colour, index, palette):
    """The nearest of the index. Greys and pale dark blues, in which palettes of programs differ, take no part."""
    off = {i: math.dist(colour, palette[i]) for i in range(1, 250) if i < 130 or i % 10 not in (7, 9)}
    if index in off:
        checks.near(f"nearest index of {colour}, {index}", off[index], min(off.values()), 4)


def check_drawing(pcmlab, checks, numpy, shapely, ezdxf, primitives, folder):
    from ezdxf.colors import DXF_DEFAULT_COLORS, int2rgb
    from ezdxf.lldxf.encoding import decode_dxf_unicode
    for unit, (insunits, measurement) in UNITS.items():
        run(pcmlab, "primitives", folder / "list.json", "--to", folder / f"{unit}.dxf", "--unit", unit, "--chord", 0.05)
        header = ezdxf.readfile(folder / f"{unit}.dxf").header
        checks.equal(f"unit {unit}", (header["$INSUNITS"], header["$MEASUREMENT"]), (insunits, measurement))
    drawing = ezdxf.readfile(folder / "m.dxf")
    checks.equal("faults that ezdxf finds", faults_of(drawing), [])
    layers = [layer for layer in drawing.layers if layer.dxf.name.lower() not in ("0", "defpoints")]
    checks.equal("layers", len({layer.dxf.name.lower() for layer in layers}), len(primitives))
    by_layer = collections.defaultdict(list)
    for entity in drawing.modelspace():
        by_layer[entity.dxf.layer].append(entity)
    low, high = drawing.header["$EXTMIN"], drawing.header["$EXTMAX"]
    for one, layer in zip(primitives, layers):
        begin = one["name"].strip()[:15].translate(str.maketrans({c: "_" for c in '<>/\\":;?*|,=`'}))
        name = decode_dxf_unicode(layer.dxf.name).encode("utf-16", "surrogatepass").decode("utf-16")
        checks.equal("the layer's name", name[:len(begin)], begin)
        checks.equal("true colour", tuple(layer.rgb), tuple(one["colour"]))
        check_index(checks, one["colour"], layer.dxf.color, [int2rgb(c) for c in DXF_DEFAULT_COLORS])
        entities = by_layer[layer.dxf.name]
        if one["kind"] == "plane":
            check_plane(numpy, shapely, checks, one, entities)
            continue
        faces = [[tuple(p) for p in (e.dxf.vtx0, e.dxf.vtx1, e.dxf.vtx2, e.dxf.vtx3)] for e in entities
                 if e.dxftype() == "3DFACE"]
        check_mesh(numpy, checks, one, faces, 0.05)
        check_lines(numpy, checks, one, entities)
        checks.equal("inside of the extents", all(l <= x <= h for f in faces for p in f for l, x, h in zip(low, p, high)), True)
    return sum(len(entities) for entities in by_layer.values())


def exact(numbers):
    return tuple(Fraction(x) for x in numbers)


def check_script(pcmlab, checks, primitives, folder):
    run(pcmlab, "primitives", folder / "list.json", "--to", folder / "a.scr", "--unit", "m")
    replay = Replay((folder / "a.scr").read_bytes().decode("utf-8")).run()
    checks.equal("layers of the script", len({layer.lower() for layer in replay.layers}), len(primitives) + 1)
    checks.equal("solids", [s["kind"] for s in replay.solids], [p["kind"] for p in primitives])

    def same(what, ours, theirs):
        checks.near(what, float(max(abs(a - b) for a, b in zip(ours, theirs))), 0, 1e-9)

    for one, solid in zip(primitives, replay.solids):
        checks.equal("colour", replay.layers[solid["layer"]], tuple(one["colour"]))
        point, bounds = exact(one["point"]), one.get("bounds", {})
        axis = exact(one.get("axis", (0, 0, 1)))
        kind = one["kind"]
        if kind == "plane":
            for corner, expected in zip(solid["corners"], one["bounds"]["outline"]):
                same("corner", corner, exact(expected))
            checks.equal("corners", len(solid["corners"]), len(one["bounds"]["outline"]))
        elif kind == "cylinder":
            same("base", solid["base"], plus(point, times(Fraction(bounds["from"]), axis)))
            same("axis", solid["z"], axis)
            same("size", (solid["radius"], solid["height"]), exact((one["radius"], bounds["to"] - bounds["from"])))
        elif kind == "sphere":
            same("centre", solid["centre"], point)
            same("radius", (solid["radius"],), exact((one["radius"],)))
        elif kind == "cone":
            slope = math.tan(one["half_angle"])
            same("base", solid["base"], plus(point, times(Fraction(bounds["to"]), axis)))
            same("axis", times(-1, solid["z"]), axis)
            same("size", (solid["radius"], solid["top"], solid["height"]),
                 exact((bounds["to"] * slope, bounds["from"] * slope, bounds["to"] - bounds["from"])))
        else:
            same("centre", solid["centre"], point)
            same("tube", (solid["tube"],), exact((one["tube_radius"],)))
            if not bounds:
                same("axis", solid["z"], axis)
                same("radius", (solid["radius"],), exact((one["radius"],)))
                continue
            same("axis", solid["axis"], axis)
            same("angle", (solid["angle"] / 57,), exact((math.degrees(bounds["end"] - bounds["begin"]) / 57,)))
            zero = exact(bounds["zero"])
            c, s = Fraction(math.cos(bounds["begin"])), Fraction(math.sin(bounds["begin"]))
            begin = times(Fraction(one["radius"]), plus(times(c, zero), times(s, cross(axis, zero))))
            same("begin of the arc", solid["begin"], begin)
            checks.near("across the axis", float(dot(solid["begin"], minus(solid["axis"], axis))), 0, 1e-12)


def check_lists(pcmlab, checks, primitives, folder):
    """JSON comes back with the same numbers, CSV with the same parameters, and --append puts lists together."""
    run(pcmlab, "primitives", folder / "list.json", "--append", folder / "list.json", "--to", folder / "twice.json")
    twice = json.loads((folder / "twice.json").read_text(encoding="utf-8"))["primitives"]
    for one, other in zip(primitives + primitives, twice):
        for key, value in one.items():
            if key == "axis":
                checks.near("axis", max(abs(a - b) for a, b in zip(value, other[key])), 0, 3e-16)
            else:
                checks.equal(key, other[key], value)
    checks.equal("both lists", len(twice), 2 * len(primitives))
    run(pcmlab, "primitives", folder / "list.json", "--to", folder / "a.csv")
    with open(folder / "a.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    checks.equal("rows", [row["name"] for row in rows], [one["name"] for one in primitives])
    for row, one in zip(rows, primitives):
        checks.equal("place", [float(row[k]) for k in "xyz"], one["point"])
        checks.equal("radius", row["radius"] and float(row["radius"]), one.get("radius", ""))
        if one["kind"] == "cone":
            checks.near("half angle", float(row["half_angle [deg]"]), math.degrees(one["half_angle"]), 1e-12)


def main():
    arguments = common_arguments(__doc__, lambda parser: parser.add_argument("--pcmlab", required=True))
    try:
        import ezdxf
        import numpy
        import shapely
    except ImportError as error:
        skip(f"{error}; packaging/test-python installs what the comparison needs")
    checks, pcmlab = Checks(), arguments.pcmlab
    primitives = random_list(numpy, 60)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "list.json").write_text(json.dumps({"format": "pcm primitives", "version": 1, "primitives": primitives}))
        entities = check_drawing(pcmlab, checks, numpy, shapely, ezdxf, primitives, folder)
        check_script(pcmlab, checks, primitives, folder)
        check_lists(pcmlab, checks, primitives, folder)
    print(f"{entities} entities: " + ("equal" if not checks.failed else f"{checks.failed} differences"))
    return 1 if checks.failed else 0


if __name__ == "__main__":
    sys.exit(main())
