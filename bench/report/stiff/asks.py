"""How each operation of the table is asked: one command line for each of its variants.

Required arguments are filled by their types, and results are always written to a name of their own; KNOWN has what the table cannot
know, such as the place of a fit, in the cloud's own measures. An operation that is not in KNOWN is asked with its defaults.
"""
import numpy


def words(*numbers):
    return [repr(float(number)) for number in numpy.concatenate([numpy.atleast_1d(n) for n in numbers])]


def box_of_half(stage):
    """The half of the cloud below its median x."""
    low, high = stage.low, stage.high
    return words(low, [stage.middle[0], high[1], high[2]])


def fit_place(stage):
    return ["{} {} {}".format(*words(stage.places[0]))]


def around(places):
    """Ordered by their directions from their middle in plan, so that a polygon through them does not cross itself."""
    offsets = places[:, :2] - places[:, :2].mean(axis=0)
    return places[numpy.argsort(numpy.arctan2(offsets[:, 1], offsets[:, 0]))]


def matrix_of(stage):
    """A turn about an oblique axis with a translation of the cloud's size, or the case's own."""
    matrix = stage.settings.get("matrix")
    if matrix is None:
        turn = numpy.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0], [0.48, 0.64, 0.6]])
        matrix = numpy.column_stack([turn, stage.middle - turn @ stage.middle + stage.size])
    return words(matrix.ravel())


def pairs_of(stage):
    pairs = stage.settings.get("pairs")
    if pairs is None:
        turn = numpy.array([[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, 1]])
        moving = stage.places[:6]
        pairs = numpy.column_stack([moving, (moving - stage.middle) @ turn.T + stage.middle + stage.size])
    return words(pairs.ravel())


def eye_of(stage):
    return words(stage.settings.get("eye", stage.middle + numpy.array([1.0, -2, 1.5]) * stage.reach))


def target_of(stage):
    return words(stage.settings.get("target", stage.middle))


def angle_of(stage):
    return words(stage.settings.get("angle", 45))


def ray_down(stage):
    """From above through the first place."""
    return words(stage.places[0] + [0, 0, stage.reach], [0, 0, -1])


def fraction_of_size(fraction):
    return lambda stage: words(fraction * stage.reach)


def neighbours(default):
    return lambda stage: [str(stage.settings.get("neighbours", default))]


CAMERA = {"eye": eye_of, "target": target_of, "angle": angle_of}
CORNERS = {key: {"kind": [key], "points": lambda stage, count=count: words(stage.places[:count].ravel())}
           for key, count in (("point", 1), ("distance", 4), ("height", 2), ("angle", 3), ("plane", 5))}
CORNERS["area"] = {"kind": ["area"], "points": lambda stage: words(around(stage.places[:5]).ravel())}
# Operation -> variant -> key -> words, or what gives words of a stage. None: not given.
KNOWN = {
    "build": {"": {}, "fast": {"fast": True}, "normals": {"normals": neighbours(8)}},
    "convert": {"ply": {"output": ["out.ply"]}, "las": {"output": ["out.las"]}, "xyz": {"output": ["out.xyz"]}},
    "run": {"": {"transform": ["0,0,0"], "normals": neighbours(8)}},
    "info": {"": {}, "statistics": {"statistics": True}},
    "verify": {"": {"levels": True}},
    "append": {"": {}},
    "compact": {"": {}},
    "delete": {"": {"box": box_of_half}},
    "repair": {"": {"check": True}},
    "query": {"box": {"box": box_of_half}, "sphere": {"sphere": lambda s: words(s.places[0], 0.2 * s.size)},
              "nearest": {"nearest": lambda s: words(s.places[0] + 0.01 * s.size), "neighbours": neighbours(5)},
              "first_hit": {"ray": lambda s: ray_down(s) + words(0.02 * s.size), "first_hit": True},
              "estimate": {"box": box_of_half, "estimate": True},
              "frustum": {"frustum": lambda s: words(s.middle + [0, 0, 2 * s.reach], s.middle, 30, 1, 1e-6 * s.reach, 3 * s.reach, [0, 1, 0])}},
    "pick": {"ray": {"ray": ray_down, "pixel_angle": ["0.5"]}, "view": {"at": ["640", "360"], **CAMERA}},
    "select": {"box": {"box": box_of_half, "output": None}, "grow": {"grow_from": lambda s: words(s.places[0]), "distance": fraction_of_size(0.1), "output": None}},
    "fit": {shape: {"at": fit_place, "shape": [shape], "output": None} for shape in ("any", "plane", "cylinder", "sphere")},
    "set": {"": {"new": ["tint:f64"], "values": ["tint=0.1"], "box": box_of_half}},
    "radii": {"": {"neighbours": neighbours(6), "mean_distance": True}},
    "normals": {"": {"neighbours": neighbours(16), "radii": True, "curvature": True}},
    "outliers": {"label": {"label": True, "neighbours": neighbours(16)}, "robust": {"label": True, "method": ["robust"]},
                 "radius": {"count": True, "output": None, "method": ["radius"], "neighbours": ["4"], "radius": fraction_of_size(0.05)}},
    "transform": {"": {"matrix": matrix_of}},
    "align": {"": {"pair": pairs_of}, "scale": {"pair": pairs_of, "scale": True}},
    "merge": {"": {"trees": lambda s: [str(s.cloud), str(s.copy())]}},
    "voxel": {"": {"size": fraction_of_size(0.05), "count": True}, "nearest": {"size": fraction_of_size(0.05), "nearest": True}},
    "subsample": {"spacing": {"spacing": fraction_of_size(0.05)}, "points": {"points": ["100"]}},
    "detect": {"": {"min_points": ["200"], "output": None}},
    "measure": CORNERS,
    "profile": {"": {"line": lambda s: words(s.low[:2], s.high[:2]), "width": fraction_of_size(0.1), "output": ["out.csv"]}},
    "volume": {"": {"reference": lambda s: words(s.middle[2]), "measured_only": True}},
    "primitives": {"dxf": {"list": lambda s: [str(s.primitives)], "output": ["out.dxf"]}, "csv": {"list": lambda s: [str(s.primitives)], "output": ["out.csv"]}},
    "render": {"": {"output": ["out.npy"], "size": ["320x180"], "converge": ["1"]},
               "camera": {"output": ["out.npy"], "size": ["320x180"], "converge": ["1"], "splats": ["constant"], "point_size": ["3"], **CAMERA}},
    "generate": {"": {"output": ["out.las"], "points": ["500"], "origin": lambda s: words(s.low), "extent": ["20"]},
                 "extent": {"output": ["out.las"], "points": ["500"], "origin": ["0", "0", "0"], "extent": lambda s: words(max(s.size, 20)), "scale": lambda s: words(max(s.size, 20) * 1e-6)}},
}
# Variants that look at what a case's settings are about; the others of a case with `only` would repeat the plain case.
ABOUT = {"render": ("camera",), "pick": ("view",), "query": ("frustum",)}


def by_type(argument, stage):
    """The words for a required argument that nothing is known of, or None."""
    kind = argument["type"]
    if kind == "inputs":
        return [str(stage.source)]
    if kind in ("tree", "cloud", "trees"):
        return [str(stage.cloud)]
    if kind == "output_tree":
        return ["out.pct"]
    if kind == "output":
        return ["out.png"] if argument["key"] == "output" else ["out.json"]
    if kind == "real":
        return words(stage.reach * 0.05)
    if kind == "numbers":
        return words(stage.places.ravel()[:argument.get("most_count", 3)])
    if kind == "choice":
        return argument["choices"][:1]
    return None


def wanted(argument, known, stage):
    """The words, True for a flag, or None where the argument is left at its default."""
    if argument["key"] in known:
        value = known[argument["key"]]
        return value(stage) if callable(value) else value
    is_result = argument["key"] == "output" and argument["type"] == "output_tree"
    if argument["required"] or is_result:
        return by_type(argument, stage)
    return None


def command_line(operation, known, stage):
    """The words behind 'pcmlab'. An operation without an output may change its tree, so it gets a copy."""
    if "in_place" in known or not any(argument["key"] == "output" for argument in operation["arguments"]):
        known = {**{argument["key"]: [str(stage.copy())] for argument in operation["arguments"] if argument["type"] == "tree"}, **known}
    keys = {argument["key"] for argument in operation["arguments"]}
    if set(known) - keys:
        raise KeyError(f"{operation['name']} has no argument {', '.join(sorted(set(known) - keys))}: asks.py knows the table of another time")
    options, places = [], []
    for argument in operation["arguments"]:
        value = wanted(argument, known, stage)
        if value is None:
            continue
        option = argument["option"].split(",")[-1]
        if argument["positional"]:
            places += value
        else:
            options += [option] if value is True else [option, *value]
    return [operation["name"], *places, *options, "--json"]


def variants(operation, case):
    found = KNOWN.get(operation["name"], {"": {}})
    if case.only and operation["name"] in ABOUT:
        return {name: known for name, known in found.items() if name in ABOUT[operation["name"]]}
    return found
