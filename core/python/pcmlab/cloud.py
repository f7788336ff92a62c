"""Trees: reading points, searching and changing them."""

import base64
import contextlib
import html
import io
import os
import tempfile
import typing

import numpy

from . import _pcmlab
from .progress import callback


class Attribute(typing.NamedTuple):
    """What points have besides their position. The value in the attribute's unit is raw * scale + offset."""

    name: str
    dtype: numpy.dtype
    components: int
    scale: float
    offset: float
    description: str


class Level(typing.NamedTuple):
    """A level of detail: the number of points of the cloud at this level, and the distance within which every point of
    the cloud has one of them, in source units; 0 for the whole cloud."""

    points: int
    spacing: float


def _text(*numbers):
    return " ".join(repr(float(number)) for number in numbers)


def _region(region, sphere, polygon):
    if sum(shape is not None for shape in (region, sphere, polygon)) > 1:
        raise _pcmlab.ArgumentError("give one of region, sphere and polygon")
    if sphere is not None:
        centre, radius = sphere if len(sphere) == 2 else (sphere[:3], sphere[3])
        return "sphere " + _text(*centre, radius)
    if polygon is not None:
        return "polygon " + _text(*numpy.asarray(polygon, dtype=float).ravel())
    return region


def _wanted(box, sphere, polygon, region, level, where, attributes):
    if box is not None:
        box = [float(number) for number in numpy.asarray(box, dtype=float).ravel()]
    where = [where] if isinstance(where, str) else list(where)
    attributes = [attributes] if isinstance(attributes, str) else attributes
    names = None if attributes is None else list(attributes)
    return _pcmlab.Wanted(box, _region(region, sphere, polygon), level, where, names)


class Cloud:
    """A tree that is open. Reading from several threads is safe.

    Which points: `box` (x0, y0, z0, x1, y1, z1, or two corners; ends included), `sphere` (x, y, z, radius), `polygon`
    (corners in plan, (n, 2)), `region` (text as on the command line: "cone 0 0 9 0 0 -1 20"), `where` (conditions:
    "classification=2,6", "z>=400"; all must hold), `level` (only the cloud at this level of detail). They are combined.

    `attributes`: names of those to read; None reads all, [] none.
    """

    def __init__(self, cloud):
        self._cloud = cloud

    @property
    def points(self) -> int:
        """Number of points."""
        return self._cloud.points

    @property
    def bounds(self) -> numpy.ndarray:
        """Smallest and largest coordinates, (2, 3), float64, in source units."""
        return self._cloud.bounds

    @property
    def attributes(self) -> typing.List[Attribute]:
        """The attributes of the points, in the file's order."""
        return [Attribute(*attribute) for attribute in self._cloud.attributes]

    @property
    def levels(self) -> typing.List[Level]:
        """The levels of detail, coarse ones first; the last one is the whole cloud."""
        return [Level(*level) for level in self._cloud.levels]

    @property
    def folder(self) -> str:
        """The folder of the tree."""
        return self._cloud.folder

    @property
    def info(self) -> dict:
        """What `pcmlab info` says: coordinate system, sources, sizes on disk and more."""
        from . import operations

        return operations.info([self.folder])

    @property
    def crs(self):
        """The coordinate system as a dict, or None where none is stated."""
        return self.info.get("crs")

    def query(self, box=None, *, sphere=None, polygon=None, region=None, level=None, where=(), attributes=None, ids=False,
              scaled=False, progress=None) -> typing.Dict[str, numpy.ndarray]:
        """The points that are asked for, as a dict of arrays with a row for each point.

        "xyz" is float64, (n, 3); attributes have the file's own type, (n,) or (n, components). `scaled`: attributes are
        float64 in their own unit. `ids`: also "node" and "number" (uint32), which together name a point of this tree.
        Memory: that of the arrays, and of some chunks.

        >>> points = open("scan.pct").query(where="classification=2", attributes=["classification"])
        >>> sorted(points), set(points["classification"].tolist())
        (['classification', 'xyz'], {2})
        """
        wanted = _wanted(box, sphere, polygon, region, level, where, attributes)
        return self._cloud.query(wanted, ids, scaled, callback(progress))

    def chunks(self, box=None, *, sphere=None, polygon=None, region=None, level=None, where=(), attributes=None, ids=False,
               scaled=False, progress=None) -> typing.Iterator[typing.Dict[str, numpy.ndarray]]:
        """The same points chunk by chunk, some ten thousand each, in bounded memory.

        >>> cloud = open("scan.pct")
        >>> sum(len(chunk["xyz"]) for chunk in cloud.chunks(attributes=[])) == cloud.points
        True
        """
        wanted = _wanted(box, sphere, polygon, region, level, where, attributes)
        return self._cloud.chunks(wanted, ids, scaled, callback(progress))

    def estimate(self, box=None, *, sphere=None, polygon=None, region=None, level=None, where=()) -> dict:
        """What query() would find, without reading points: points_least and points_most (bounds that hold),
        points_expected (before conditions on attributes), chunks and bytes to read."""
        return self._cloud.estimate(_wanted(box, sphere, polygon, region, level, where, []))

    def nearest(self, places, k=1, *, level=None, max_distance=float("inf"), threads=0, progress=None) -> dict:
        """The k points nearest to each place, nearest first; exact, or of a level of detail.

        places: (3,) or (m, 3). Returns "xyz" (m, k, 3), "distance" (m, k), "node" and "number" (m, k), without the
        first axis for a single place. Where the cloud has no k points within max_distance: distance inf and xyz nan.
        "error": by how much a point of the whole cloud may be nearer, in source units; 0 without a level.

        >>> cloud = open("scan.pct")
        >>> found = cloud.nearest(cloud.query(level=0)["xyz"], k=3)
        >>> found["xyz"].shape[1:], bool((found["distance"][:, 0] == 0).all())
        ((3, 3), True)
        """
        places = numpy.asarray(places, dtype=float)
        found = self._cloud.nearest(numpy.atleast_2d(places), k, level, max_distance, threads, callback(progress))
        if places.ndim == 1:
            for name in ("xyz", "distance", "node", "number"):
                found[name] = found[name][0]
        return found

    def values(self, node, number, attributes=None) -> typing.Dict[str, numpy.ndarray]:
        """"xyz" and attributes of the points that `node` and `number` of a query or search name, in their order."""
        names = [a.name for a in self.attributes] if attributes is None else list(attributes)
        return self._cloud.values(numpy.ravel(node), numpy.ravel(number), names)

    def to_pandas(self, **query):
        """query() as a pandas.DataFrame: x, y, z and a column for each attribute, name_0, name_1 ... of several."""
        import pandas

        points = self.query(**query)
        columns = dict(zip("xyz", points.pop("xyz").T))
        for name, values in points.items():
            if values.ndim == 1:
                columns[name] = values
            else:
                columns.update({f"{name}_{i}": part for i, part in enumerate(values.T)})
        return pandas.DataFrame(columns)

    def to_open3d(self, **query):
        """query() as an open3d.geometry.PointCloud with colours and normals where the cloud has them."""
        import open3d

        names = [a.name for a in self.attributes if a.name in ("rgb", "normal")]
        points = self.query(attributes=names, **query)
        made = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points["xyz"]))
        if "normal" in points:
            made.normals = open3d.utility.Vector3dVector(points["normal"].astype(float))
        if "rgb" in points:
            rgb = points["rgb"]
            most = numpy.iinfo(rgb.dtype).max if rgb.dtype.kind == "u" else 1
            made.colors = open3d.utility.Vector3dVector(rgb.astype(float) / most)
        return made

    def picture(self, **options) -> numpy.ndarray:
        """The cloud drawn from a camera, with the options of pcmlab.render(): an array of bytes, height x width x 4 (red, green,
        blue, alpha), or x 3 where `background` is given a colour."""
        from . import operations

        return operations.render([self.folder], **options)

    def _repr_html_(self):
        """What a notebook shows: a picture, where one can be drawn, above the text."""
        from . import operations

        text = f"<pre>{html.escape(repr(self))}</pre>"
        with tempfile.TemporaryDirectory(prefix="pcmlab-") as folder:
            file = os.path.join(folder, "cloud.png")
            try:
                operations.render([self.folder], output=file, size="640x400", until="target", converge=4)
                with io.open(file, "rb") as picture:
                    return f'<img src="data:image/png;base64,{base64.b64encode(picture.read()).decode()}"/>{text}'
            except _pcmlab.Error:  # no program that draws, or no OpenGL
                return text

    def __len__(self):
        return self.points

    def __repr__(self):
        low, high = self.bounds
        box = "no points" if self.points == 0 else f"from ({_short(low)}) to ({_short(high)})"
        names = ", ".join(f"{a.name} {a.dtype}" + (f" x {a.components}" if a.components > 1 else "") for a in self.attributes)
        return f"<pcmlab.Cloud {self.folder}: {self.points:,} points {box}; {len(self.levels)} levels; {names}>"


def _short(numbers):
    return ", ".join(f"{number:.10g}" for number in numbers)


class EditableCloud(Cloud):
    """A tree that is open for changes: see edit()."""

    def add_attribute(self, name, dtype, components=1, description=""):
        """A new attribute whose values are 0. dtype: an integer of 8 to 64 bits, float32 or float64."""
        self._cloud.add_attribute(name, numpy.dtype(dtype), components, description)

    def changes(self, box=None, *, sphere=None, polygon=None, region=None, level=None, where=(), attributes=None,
                progress=None):
        """The points that are asked for, chunk by chunk, to be changed: chunk["name"] = values.

        A chunk has a row for each point, "xyz" and the attributes; it may be used until the next one is taken. Values
        are raw. A value that the attribute's type cannot hold, a fraction for an integer or one out of range, is an
        error.
        """
        return self._cloud.edits(_wanted(box, sphere, polygon, region, level, where, attributes), callback(progress))


def open(path, *, cache_bytes=0) -> Cloud:
    """Opens a tree: its folder, or a file in it. Takes moments, whatever its size.

    cache_bytes: memory for chunks that are kept; 0 is the library's default, 512 MiB. build() makes trees of files.
    """
    return Cloud(_pcmlab.open(os.fspath(path), False, cache_bytes))


@contextlib.contextmanager
def edit(path, *, cache_bytes=0):
    """Opens a tree to change attributes of its points. At the end of the block all changes become part of the tree, at
    once; after an exception none.

    >>> with edit("scan.pct") as cloud:
    ...     cloud.add_attribute("height", "f4")
    ...     for chunk in cloud.changes(attributes=["height"]):
    ...         chunk["height"] = chunk["xyz"][:, 2] - 92
    >>> bool((open("scan.pct").query()["height"] > 0).any())
    True
    """
    cloud = _pcmlab.open(os.fspath(path), True, cache_bytes)
    try:
        yield EditableCloud(cloud)
    except BaseException:
        cloud.abandon()
        raise
    cloud.close()


def from_arrays(path, xyz, attributes=None, *, overwrite=False, progress=None, **more) -> Cloud:
    """Makes a tree of arrays and opens it.

    xyz: (n, 3), float64 or float32. Attributes, in a dict or by name: (n,) or (n, components), integers of 8 to 64 bits,
    float32 or float64; they come back bit for bit. Positions come back bit for bit where they are float32, or have a
    fixed number of decimals; others are rounded by at most the error that info() states.

    >>> cloud = from_arrays("made.pct", [[0, 0, 0], [1, 0.5, 2]], weight=[3, 4])
    >>> cloud.points, cloud.bounds.tolist(), sorted(cloud.query()["weight"].tolist())
    (2, [[0.0, 0.0, 0.0], [1.0, 0.5, 2.0]], [3, 4])
    """
    values = {**(attributes or {}), **more}
    arrays = [(name, numpy.asarray(array)) for name, array in values.items()]
    _pcmlab.from_arrays(os.fspath(path), numpy.asarray(xyz), arrays, overwrite, callback(progress))
    return open(path)
