"""Clouds to hold claims against: generated ones, of which the truth is known, and samples of files.

A cloud has no more than POINTS points, so that every distance can be computed by brute force.
"""
import dataclasses
import zlib

import numpy

POINTS = 6000
MAP = numpy.array([512000.0, 4812000.0, 300.0])


@dataclasses.dataclass
class Cloud:
    name: str
    xyz: numpy.ndarray          # n x 3, source units
    surface: object = None      # height above x and y, both from 0 to 1 times `size`, at `origin`
    shape: dict = None          # kind, point, axis, radius: what all points lie on, but for the noise
    size: float = 1.0
    origin: numpy.ndarray = dataclasses.field(default_factory=lambda: numpy.zeros(3))
    noise: float = 0.0          # standard deviation of the points, across the surface

    @property
    def chance(self):
        return numpy.random.default_rng(zlib.crc32(self.name.encode()))


def waves(x, y):
    return 0.08 * numpy.sin(6 * x) * numpy.cos(5 * y) + 0.05 * x


def slope(x, y):
    return 0.3 * x - 0.2 * y


def step(x, y):
    return numpy.where(x + 0.1 * y > 0.52, 0.12, 0.0)


def surfaces():
    for name, height in (("waves", waves), ("slope", slope), ("step", step)):
        for noise in (0.0, 0.002, 0.01):
            for place, origin in (("at the origin", numpy.zeros(3)), ("on the map", MAP)):
                cloud = Cloud(f"{name}, noise {noise}, {place}", None, height, None, 40.0 if origin.any() else 1.0, origin, noise)
                chance = cloud.chance
                plan = chance.random((POINTS, 2))
                z = height(plan[:, 0], plan[:, 1]) + noise * chance.normal(size=POINTS)
                cloud.noise = noise * cloud.size
                cloud.xyz = numpy.column_stack([plan, z]) * cloud.size + origin
                yield cloud


def directions(chance, count):
    found = chance.normal(size=(count, 3))
    return found / numpy.linalg.norm(found, axis=1)[:, None]


def shapes():
    for number, (kind, noise) in enumerate((kind, noise) for kind in ("plane", "sphere", "cylinder") for noise in (0.001, 0.004)):
        for place, origin in (("at the origin", numpy.zeros(3)), ("on the map", MAP)):
            cloud = Cloud(f"a {kind}, noise {noise}, {place}", None, origin=origin, noise=noise)
            chance = cloud.chance
            axis = directions(chance, 1)[0]
            across = numpy.cross(axis, [0.3, 0.5, 0.8])
            across /= numpy.linalg.norm(across)
            third = numpy.cross(axis, across)
            off = noise * chance.normal(size=(POINTS, 1))
            if kind == "plane":
                xyz = chance.random((POINTS, 1)) * across + chance.random((POINTS, 1)) * third + off * axis
            elif kind == "sphere":
                xyz = (0.5 + off) * directions(chance, POINTS)
            else:
                turn = 2 * numpy.pi * chance.random((POINTS, 1))
                xyz = (0.3 + off) * (numpy.cos(turn) * across + numpy.sin(turn) * third) + 2 * chance.random((POINTS, 1)) * axis
            cloud.xyz = xyz + origin
            cloud.shape = {"kind": kind, "point": origin, "axis": axis, "radius": {"sphere": 0.5, "cylinder": 0.3}.get(kind)}
            yield cloud


def volumes():
    def cloud(name, make):
        made = Cloud(name, None)
        made.xyz = make(made.chance)
        return made
    yield cloud("a cube of points", lambda chance: chance.random((POINTS, 3)))
    yield cloud("a ball of points", lambda chance: directions(chance, POINTS) * chance.random((POINTS, 1)) ** (1 / 3))
    yield cloud("clusters, density 1 to 1e6", lambda chance: numpy.concatenate(
        [chance.random((POINTS // 2, 3)), 0.5 + 0.01 * chance.normal(size=(POINTS - POINTS // 2, 3))]))
    yield cloud("scan lines 1 to 50", lambda chance: numpy.column_stack(
        [chance.random(POINTS), numpy.floor(chance.random(POINTS) * 40) / 40, 0.001 * chance.normal(size=POINTS)]))
    yield cloud("a line", lambda chance: chance.random((POINTS, 1)) * [3.0, 2, 1])
    yield cloud("each point five times", lambda chance: numpy.repeat(chance.random((POINTS // 5, 3)) * [1, 1, 0.1], 5, axis=0))
    yield cloud("rings around a scanner", lambda chance: rings(chance))


def rings(chance):
    turn, down = 2 * numpy.pi * chance.random(POINTS), numpy.round(chance.random(POINTS) * 60) / 60
    reach = 1.5 / numpy.tan(0.05 + 1.2 * down)
    return numpy.column_stack([reach * numpy.cos(turn), reach * numpy.sin(turn), 0.003 * chance.normal(size=POINTS)])


def generated():
    yield from surfaces()
    yield from shapes()
    yield from volumes()


def sample_of(name, xyz):
    """A part of a file's points, by chance."""
    cloud = Cloud(name, None)
    xyz = xyz[numpy.isfinite(xyz).all(axis=1)]
    if len(xyz) > POINTS:
        xyz = xyz[cloud.chance.permutation(len(xyz))[:POINTS]]
    cloud.xyz = xyz
    return cloud
