"""The cases: clouds of extreme shape, size and place, and cameras, matrices and pairs that are hard to compute with.

A case is a cloud and, for operations that take more than a cloud, what is hard about that (`settings`, see asks.py). The oracles know
nothing of the cases: they look at the points.
"""
import dataclasses
import zlib

import numpy

POINTS = 2000


@dataclasses.dataclass
class Case:
    name: str
    xyz: numpy.ndarray  # n x 3, source units
    attributes: dict = dataclasses.field(default_factory=dict)
    settings: dict = dataclasses.field(default_factory=dict)  # camera, matrix, pairs, neighbours, near: see asks.py
    kind: str = "float64"  # of the positions in the file
    text: bool = False     # an .xyz file, so that NaN and infinity are words
    parts: int = 1         # the cloud is divided into this many files
    only: tuple = ()       # operations that the case is for; empty: all
    easy: bool = False     # nothing may be refused


def chance_of(name):
    return numpy.random.default_rng(zlib.crc32(name.encode()))


def scene(chance, count=POINTS, noise=5e-4):
    """Ground, an upright cylinder and a ball on a unit square."""
    ground, pipe = count // 2, count // 4
    ball = count - ground - pipe
    flat = numpy.column_stack([chance.random((ground, 2)), numpy.zeros(ground)])
    turn = chance.random(pipe) * 2 * numpy.pi
    upright = numpy.column_stack([0.3 + 0.1 * numpy.cos(turn), 0.3 + 0.1 * numpy.sin(turn), 0.4 * chance.random(pipe)])
    direction = chance.normal(size=(ball, 3))
    direction /= numpy.linalg.norm(direction, axis=1)[:, None]
    round_ = numpy.array([0.7, 0.7, 0.3]) + 0.15 * direction
    return numpy.concatenate([flat, upright, round_]) + chance.normal(size=(count, 3)) * noise


def attributes_of(count, chance):
    return {"intensity": chance.integers(0, 65536, count).astype(numpy.uint16), "red": chance.integers(0, 256, count).astype(numpy.uint8),
            "green": chance.integers(0, 256, count).astype(numpy.uint8), "blue": chance.integers(0, 256, count).astype(numpy.uint8),
            "quality": chance.random(count).astype(numpy.float32)}


def extents():
    for power in (-12, -9, -6, -3, 3, 6, 9, 12, 15):
        name = f"extent 1e{power}"
        yield Case(name, scene(chance_of(name)) * 10.0 ** power)
    yield Case("axes 1e-6, 1, 1e6", scene(chance_of("axes")) * [1e-6, 1, 1e6])
    far = numpy.array([3.5e6, 5.8e6, 300.0])
    for name, step in (("map, steps of 1 mm", 1e-3), ("map, steps of 0.1 um", 1e-7)):
        yield Case(name, numpy.round((scene(chance_of(name)) * 10 + far) / step) * step)
    yield Case("map, positions in float", (scene(chance_of("float")) * 100 + far).astype(numpy.float32).astype(float), kind="float32")


def strays():
    for text in ("1e9", "1e100", "1e160"):
        name = f"a stray at {text}"
        yield Case(name, numpy.concatenate([scene(chance_of(name)), [[float(text), 0, 0]]]))
    chance = chance_of("clusters")
    yield Case("two clusters, 1e9 apart", numpy.concatenate([scene(chance, 1000), scene(chance, 1000) + [1e9, 0, 0]]))


def repeated(many):
    chance = chance_of("repeated")
    yield Case("each point 20 times", numpy.repeat(scene(chance, 100), 20, axis=0))
    yield Case(f"one point {many} times", numpy.concatenate([numpy.tile([[0.25, 0.5, 0.0]], (many, 1)), scene(chance)]))
    yield Case("all in one place", numpy.tile([[1.5, -2.25, 1e6]], (POINTS, 1)))
    yield Case("two places", numpy.repeat([[0.0, 0, 0], [1, 0, 0]], POINTS // 2, axis=0))


def degenerate():
    chance = chance_of("degenerate")
    along = numpy.sort(chance.random(POINTS))[:, None]
    yield Case("collinear, along x", along * [1e3, 0, 0] + [0, 3, 4])
    yield Case("collinear, oblique", along * [3, -2, 1] + [1e3, 1e3, 0])
    flat = chance.random((POINTS, 2))
    yield Case("coplanar, level", numpy.column_stack([flat * 10, numpy.full(POINTS, 7.125)]))
    yield Case("coplanar, oblique", flat @ numpy.array([[3.0, 1, 2], [-1, 2, 0.5]]) + 100)
    steps = numpy.arange(12.0)
    yield Case("a lattice", numpy.stack(numpy.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3))


def few():
    for count in (0, 1, 2, 3, 5):
        yield Case(f"{count} points", scene(chance_of("few"), 20)[:count])
    yield Case("k above the points", scene(chance_of("k"), 40), settings={"neighbours": 60})


def numbers():
    base = scene(chance_of("numbers"))
    for word in ("nan", "inf", "-inf"):
        xyz = base.copy()
        xyz[777, 1] = float(word)
        yield Case(f"a coordinate {word}", xyz)
    yield Case("a coordinate nan, text", numpy.where(numpy.arange(POINTS)[:, None] == 777, numpy.nan, base), text=True)
    signs = base.copy()
    signs[::2, 0] = -0.0
    signs[1::2, 1] = 0.0
    yield Case("zeros of both signs", signs)
    yield Case("denormals", chance_of("denormals").integers(1, 1000, (POINTS, 3)) * 5e-324)
    yield Case("denormals next to 1", numpy.concatenate([base, [[5e-324, 0, 0], [0, 1e-310, 0]]]))


def attributes():
    chance = chance_of("attributes")
    base = scene(chance)
    ones = numpy.ones(POINTS)
    yield Case("attributes of one value", base, {"intensity": (7 * ones).astype(numpy.uint16), "quality": (0.25 * ones).astype(numpy.float32)})
    odd = {"quality": chance.random(POINTS).astype(numpy.float32), "other": chance.random(POINTS)}
    odd["quality"][::3] = numpy.nan
    odd["quality"][1::3] = numpy.inf
    odd["other"][::2] = -numpy.inf
    yield Case("attributes nan and inf", base, odd)
    ends = {name: numpy.where(numpy.arange(POINTS) % 2, numpy.iinfo(name).max, numpy.iinfo(name).min).astype(name)
            for name in ("int32", "uint32", "int16", "uint8")}
    ends["largest"] = numpy.where(numpy.arange(POINTS) % 2, 1.7976931348623157e308, -1.7976931348623157e308)
    ends["least"] = numpy.full(POINTS, 5e-324)
    ends["float32"] = numpy.where(numpy.arange(POINTS) % 2, 3.4e38, -3.4e38).astype(numpy.float32)
    yield Case("attributes at their limits", base, {"of_" + name: values for name, values in ends.items()})


def patterns():
    chance = chance_of("patterns")
    yield Case("density 1:1e6", numpy.concatenate([scene(chance, 1000) * 1e-2, scene(chance, 1000) * [1, 1, 1]]) * [100, 100, 100])
    line = numpy.repeat(numpy.arange(20.0), 100)
    yield Case("scan lines 1:100", numpy.column_stack([numpy.tile(numpy.arange(100) * 0.01, 20), line, 0.001 * chance.normal(size=POINTS)]))
    row = 1.5 / numpy.tan(numpy.radians(numpy.linspace(0.2, 10, 40)))  # a scanner 1.5 above the ground
    turn = numpy.linspace(0, numpy.pi / 2, 50)
    grid = numpy.stack([numpy.outer(row, numpy.cos(turn)), numpy.outer(row, numpy.sin(turn)), 0.002 * chance.normal(size=(40, 50))], axis=-1)
    yield Case("grazing rows", grid.reshape(-1, 3))
    arc = numpy.radians(1) * chance.random(POINTS)
    yield Case("an arc of 1 degree", numpy.column_stack([50 * numpy.cos(arc), 50 * numpy.sin(arc), chance.random(POINTS)]))
    disc = chance.random((POINTS, 2)) - 0.5
    yield Case("a sphere 1000 x its patch", numpy.column_stack([disc, 1000 - numpy.sqrt(1e6 - (disc ** 2).sum(axis=1))]))


def motions():
    chance = chance_of("motions")
    base = scene(chance)
    matrices = {"a singular matrix": numpy.diag([1.0, 1, 0]), "a mirrored matrix": numpy.diag([-1.0, 1, 1]),
                "a matrix of 1e-200": numpy.eye(3) * 1e-200, "a matrix of 1e200": numpy.eye(3) * 1e200,
                "a sheared matrix": numpy.array([[1.0, 1e3, 0], [0, 1, 0], [0, 0, 1e-3]]), "a matrix with nan": numpy.eye(3) * numpy.nan}
    for name, matrix in matrices.items():
        yield Case(name, base, settings={"matrix": numpy.column_stack([matrix, [1.0, 2, 3]])}, only=("transform",))
    turn = numpy.array([[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, 1]])
    places = {"needle pairs, 1e-6 wide": numpy.array([[0.0, 0, 0], [1, 0, 0], [0.5, 1e-6, 0]]),
              "collinear pairs": numpy.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]), "coincident pairs": numpy.tile([[1.0, 1, 0]], (3, 1)),
              "two pairs": numpy.array([[0.0, 0, 0], [1, 0, 0]]), "pairs at 1e9": scene(chance, 10) + 1e9,
              "mirrored pairs": scene(chance, 8), "pairs with nan": numpy.array([[0.0, 0, 0], [1, 0, 0], [0, numpy.nan, 0]])}
    for name, moving in places.items():
        fixed = moving * [-1, 1, 1] if name == "mirrored pairs" else moving @ turn.T + [1, 2, 3]
        yield Case(name, base, settings={"pairs": numpy.column_stack([moving, fixed])}, only=("align",))


def views():
    chance = chance_of("views")
    base = scene(chance)
    at = base[0]
    cameras = {"the camera inside a point": (at, at + [1, 0, 0]), "a view from 1e7 away": (at + [0, 0, 1e7], at),
               "a view along up": (at + [0, 0, 3], at), "eye and target in one place": (at, at), "an eye of nan": (at * numpy.nan, at),
               "an eye at 1e155": (at + [1e155, 0, 0], at), "a view 1e-6 away": (at + [1e-6, 0, 1e-6], at)}
    for name, (eye, target) in cameras.items():
        yield Case(name, base, settings={"eye": eye, "target": target}, only=("render", "pick"))
    for name, angle in (("an angle of 1e-4 degrees", 1e-4), ("an angle of 179.9 degrees", 179.9), ("an angle of 180 degrees", 180.0)):
        yield Case(name, base, settings={"eye": at + [2, 2, 2], "target": at, "angle": angle}, only=("render", "pick"))
    yield Case("near : far 1e-6", base * 1e3, settings={"eye": at * 1e3 + [0, 0, 1e-3], "target": at * 1e3 + [1e3, 1e3, 0]}, only=("render", "pick", "query"))


def all_cases(many, files):
    """`many`: points in one place; `files`: parts of the cloud of many files."""
    chance = chance_of("plain")
    yield Case("plain", scene(chance), attributes_of(POINTS, chance), easy=True)
    yield Case("plain, on a map", scene(chance) * 100 + [5e5, 4.8e6, 100], attributes_of(POINTS, chance), easy=True)
    for group in (extents(), strays(), repeated(many), degenerate(), few(), numbers(), attributes(), patterns(), motions(), views()):
        yield from group
    yield Case(f"{files} files", scene(chance, max(POINTS, files)), parts=files)
