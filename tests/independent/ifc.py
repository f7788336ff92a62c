#!/usr/bin/env python3
"""Primitives and pipe runs as IFC, read by IfcOpenShell: valid by the schema, exact sizes and places, volumes as solids.

    ifc.py --pcmlab PCMLAB --dump DUMP_CLOUD --data FOLDER [--python PYTHON]

Exit code 0 when all is equal, 1 when not, 77 (skipped) without the packages of requirements.txt.
"""
import json
import math
import pathlib
import sys
import tempfile

from check import common_arguments, skip
from measures import Checks, run
from pipe_runs import Pipe
from primitives import random_list

SCALES = {"m": 1, "mm": 0.001, "cm": 0.01, "ft": 0.3048, "in": 0.0254}
CLASSES = {"plane": "IfcPlate"}


def place_of(numpy, element):
    """Where the element's own coordinates are: by its placement, the building's and the site's."""
    place, placement = numpy.zeros(3), element.ObjectPlacement
    while placement:
        place += placement.RelativePlacement.Location.Coordinates
        placement = placement.PlacementRelTo
    return place


def volume_of(one):
    bounds = one.get("bounds", {})
    if one["kind"] == "sphere":
        return 4 / 3 * math.pi * one["radius"] ** 3
    if one["kind"] == "torus":
        arc = bounds.get("end", 2 * math.pi) - bounds.get("begin", 0)
        return arc * one["radius"] * math.pi * one["tube_radius"] ** 2
    height = bounds["to"] - bounds["from"]
    if one["kind"] == "cylinder":
        return math.pi * one["radius"] ** 2 * height
    slope = math.tan(one["half_angle"])
    return math.pi / 3 * slope ** 2 * abs(bounds["to"] ** 3 - bounds["from"] ** 3)


def check_item(numpy, checks, one, element):
    """Numbers of the file, without a mesh."""
    item = element.Representation.Representations[0].Items[0]
    place, point = place_of(numpy, element), numpy.array(one["point"])
    if one["kind"] == "plane":
        loop = item.SbsmBoundary[0].CfsFaces[0].Bounds[0].Bound
        corners = [place + p.Coordinates for p in loop.Polygon]
        checks.equal("corners", len(corners), len(one["bounds"]["outline"]))
        for ours, theirs in zip(corners, one["bounds"]["outline"]):
            checks.near("corner", float(numpy.abs(ours - theirs).max()), 0, 1e-8)
    elif one["kind"] == "sphere":
        checks.equal("radius", item.TreeRootExpression.Radius, one["radius"])
        centre = place + item.TreeRootExpression.Position.Location.Coordinates
        checks.near("centre", float(numpy.abs(centre - point).max()), 0, 1e-8)
    elif one["kind"] == "torus":
        checks.equal("tube", item.Radius, one["tube_radius"])
        line = place + numpy.array(item.Directrix.Points.CoordList)
        checks.near("circle", float(numpy.abs(numpy.linalg.norm(line - point, axis=1) - one["radius"]).max()), 0, 1e-8)
    else:
        axis = numpy.array(one["axis"]) / numpy.linalg.norm(one["axis"])
        base = place + item.Position.Location.Coordinates
        checks.near("base on the axis", float(numpy.linalg.norm(numpy.cross(base - point, axis))), 0, 1e-8)
        corners = numpy.array([p.Coordinates for p in item.SweptArea.OuterCurve.Points])
        checks.near("length", corners[:, 1].max(), one["bounds"]["to"] - one["bounds"]["from"], 1e-9)
        if one["kind"] == "cylinder":
            checks.equal("radius", corners[:, 0].max(), one["radius"])


def check_run(numpy, checks, pipe, element):
    item = element.Representation.Representations[0].Items[0]
    checks.near("radius of a run", item.Radius, pipe.radius, 1e-12)
    line = place_of(numpy, element) + numpy.array(item.Directrix.Points.CoordList)
    ends = [pipe.points[0], pipe.points[-1]]
    off = min(max(numpy.linalg.norm(line[0] - a), numpy.linalg.norm(line[-1] - b)) for a, b in (ends, ends[::-1]))
    checks.near("ends of a run", float(off), 0, 1e-7)
    checks.equal("bends", sum(piece.is_a("IfcArcIndex") for piece in item.Directrix.Segments), pipe.bends)
    values = properties(element)
    checks.near("length of a run", values["length"], pipe.length, 1e-7)
    checks.equal("parts of a run", sum(key.startswith("part ") for key in values), len(pipe.shapes))


def properties(element):
    listed = element.IsDefinedBy[0].RelatingPropertyDefinition.HasProperties
    return {one.Name: one.NominalValue.wrappedValue for one in listed}


def check_file(numpy, ifcopenshell, checks, file, unit, primitives, pipes):
    from ifcopenshell import geom, validate
    from ifcopenshell.util import shape as shapes, unit as units
    model = ifcopenshell.open(str(file))
    logger = validate.json_logger()
    validate.validate(model, logger)
    checks.equal("faults of the schema", [str(s)[:200] for s in logger.statements], [])
    checks.near("unit", units.calculate_unit_scale(model), SCALES[unit], 1e-15)
    elements = model.by_type("IfcElement")
    ids = [root.GlobalId for root in model.by_type("IfcRoot")]
    checks.equal("ids", len(set(ids)), len(ids))
    runs = sorted((e for e in elements if e.is_a("IfcPipeSegment")), key=lambda e: int(e.Name.rsplit(" ", 1)[1]))
    others = sorted((e for e in elements if not e.is_a("IfcPipeSegment")), key=lambda e: e.id())
    checks.equal("runs", len(runs), len(pipes))
    checks.equal("names", [e.Name for e in others], [one["name"][:255] for one in primitives])
    for one, element in zip(primitives, others):
        checks.equal("class", element.is_a(), CLASSES.get(one["kind"], "IfcBuildingElementProxy"))
        check_item(numpy, checks, one, element)
    for pipe, element in zip(pipes, runs):
        check_run(numpy, checks, pipe, element)
    settings = geom.settings()
    settings.set("mesher-linear-deflection", 0.002)
    settings.set("mesher-angular-deflection", 0.1)
    for one, element in zip(primitives, others):
        if one["kind"] != "plane":
            volume = volume_of(one) * SCALES[unit] ** 3
            solid = shapes.get_volume(geom.create_shape(settings, element).geometry)
            checks.near(f"volume of a {one['kind']}", solid / volume, 1, 0.02)
    for pipe, element in zip(pipes, runs):
        volume = math.pi * pipe.radius ** 2 * pipe.length * SCALES[unit] ** 3
        solid = shapes.get_volume(geom.create_shape(settings, element).geometry)
        checks.near("volume of a run", solid / volume, 1, 0.03)
    return len(elements)


def main():
    arguments = common_arguments(__doc__, lambda parser: parser.add_argument("--pcmlab", required=True))
    try:
        import ifcopenshell
        import numpy
    except ImportError as error:
        skip(f"{error}; packaging/test-python installs what the comparison needs")
    checks, count = Checks(), 0
    primitives = random_list(numpy, 60)
    random = numpy.random.default_rng(12)
    pipes = [Pipe(numpy, random, number, number % 5) for number in range(1, 13)]
    pipes = [pipe for pipe in pipes if pipe.bends]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for unit in ("m", "ft"):
            listed = primitives + [shape for pipe in pipes for shape in pipe.shapes]
            (folder / "list.json").write_text(json.dumps({"format": "pcm primitives", "version": 1, "primitives": listed}))
            run(arguments.pcmlab, "primitives", folder / "list.json", "-o", folder / f"{unit}.ifc", "--unit", unit)
            count += check_file(numpy, ifcopenshell, checks, folder / f"{unit}.ifc", unit, primitives, pipes)
    print(f"{count} elements: " + ("equal" if not checks.failed else f"{checks.failed} differences"))
    return 1 if checks.failed else 0


if __name__ == "__main__":
    sys.exit(main())
