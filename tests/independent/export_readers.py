"""What other programs find in exported files, compared with the cloud that was exported (see exports.py).

A check gets the file, the cloud, the largest position error that pcmlab stated for it, and the options it was written with.
It returns lines about what differs.
"""
import os
import re
import subprocess

import numpy as np

from compare import Cloud

COLOUR_NAMES = ("red", "green", "blue")
SINGLE = 2.0**-24  # half a unit of the last place of a float, relative


def values_of(attribute):
    """As a person sees them: raw * scale + offset."""
    return attribute.values.astype(np.float64) * attribute.scale + attribute.offset


def is_scaled(attribute):
    return attribute.scale != 1 or attribute.offset != 0


def same(ours, theirs):
    """Equal as numbers, NaN and NaN too."""
    ours, theirs = np.asarray(ours), np.asarray(theirs)
    if ours.shape != theirs.shape:
        return False
    kinds = ours.dtype.kind + theirs.dtype.kind
    return np.array_equal(ours, theirs, equal_nan=kinds == "ff") if "f" not in kinds or kinds == "ff" else \
        np.array_equal(ours.astype(np.float64), theirs.astype(np.float64), equal_nan=True)


def position_lines(truth, theirs, error, single=False):
    theirs = np.asarray(theirs, dtype=np.float64)
    if theirs.shape != truth.positions.shape:
        return [f"{len(theirs)} points, expected {len(truth.positions)}"]
    most = error * (1 + 1e-9) + 1e-300
    if single:
        most = most + np.abs(truth.positions) * SINGLE
    off = np.abs(theirs - truth.positions)
    wrong = ~((off <= most) | (np.isnan(theirs) & np.isnan(truth.positions)))
    if not wrong.any():
        return []
    row = int(np.flatnonzero(wrong.any(axis=1))[0])
    return [f"{int(wrong.any(axis=1).sum())} positions differ: point {row} is {theirs[row]}, expected {truth.positions[row]}, "
            f"error stated {error}"]


def bytes_of_colours(attribute):
    """The colours with 8 bits, as the writers of PLY and PCD round them."""
    raw = attribute.values.astype(np.float64)
    most = np.nanmax(raw, initial=0)
    kind = attribute.values.dtype
    if kind == np.uint8:
        factor = 1
    elif kind == np.uint16:
        whole = attribute.values
        step = 257 if not (whole % 257).any() else 256 if not (whole % 256).any() else 1 if not (whole > 255).any() else 257
        factor = 1 / step
    elif kind.kind == "f" and most <= 1:
        factor = 255
    else:
        factor = 1 if most <= 255 else 1 / 257 if most <= 65535 else 255 / most
    return np.nan_to_num(np.clip(np.rint(raw * factor), 0, 255)).astype(np.uint8)


def eight_bits_hold(attribute):
    whole = attribute.values
    if whole.dtype == np.uint8:
        return True
    return whole.dtype == np.uint16 and bool(not (whole % 257).any() or not (whole % 256).any() or not (whole > 255).any())


def without_points_that_are_not_finite(truth):
    kept = np.isfinite(truth.positions).all(axis=1)
    for attribute in truth.attributes.values():
        attribute.values = attribute.values[kept]
    truth.positions = truth.positions[kept]
    return truth


# ------------------------------------------------------------------------------------------------------------ LAS and LAZ

MASKS = {"return_number": (7, 15), "number_of_returns": (7, 15), "scan_direction_flag": (1, 1), "edge_of_flight_line": (1, 1),
         "classification": (31, 255), "synthetic": (1, 1), "key_point": (1, 1), "withheld": (1, 1), "overlap": (1, 1),
         "scanner_channel": (3, 3)}


def in_las_field(name, attribute, field, extended):
    """What the field of an attribute holds that it cannot hold exactly."""
    values = values_of(attribute)
    low, high = (0, MASKS[name][extended]) if name in MASKS else (None, None)
    if low is None and field.dtype.kind in "iu":
        low, high = np.iinfo(field.dtype).min, np.iinfo(field.dtype).max
    finite = attribute.values[np.isfinite(attribute.values)].astype(np.float64)
    least, most = (finite.min(), finite.max()) if len(finite) else (0, 0)
    real = attribute.values.dtype.kind == "f"
    if name in ("intensity", "rgb"):
        raw = attribute.values.astype(np.float64)
        if real and least >= 0 and most <= 1:
            values = raw * 65535
        elif name == "rgb" and most <= 255:
            values = raw * 257
        elif not (least >= 0 and most <= 65535 and (name == "rgb" or (raw == np.rint(raw)).all() or most >= 255)):
            values = raw * (65535 / (most - least)) - least * (65535 / (most - least))
    if field.dtype.kind == "f":
        return values
    return np.nan_to_num(np.clip(np.rint(values), low, high))


def laspy(output, truth, error, options):
    import laspy as module

    import las_by_laspy
    theirs = las_by_laspy.read(output)
    truth = without_points_that_are_not_finite(truth)
    found = position_lines(truth, theirs.positions, error)
    header = module.open(output).header
    if "--las-version" in options and str(header.version) != options[-1]:
        found.append(f"version {header.version}, expected {options[-1]}")
    extended = header.point_format.id >= 6
    for name, attribute in truth.attributes.items():
        exact = theirs.attributes.get(f"{name}_exact")
        field = theirs.attributes.get(name)
        if exact is not None:
            if not same(exact.values, attribute.values) or (exact.scale, exact.offset) != (attribute.scale, attribute.offset):
                found.append(f"{name}_exact differs")
            if field is not None and field.values.shape == attribute.values.shape:
                expected = in_las_field(name, attribute, field.values, extended)
                # Half a number: sums in another order.
                if not (np.abs(field.values - expected) <= (1 if expected.size and name == "intensity" else 0)).all():
                    found.append(f"the field {name} is {field.values[:3].tolist()}, expected {expected[:3].tolist()}")
            continue
        if field is None:  # the name is that of something else in LAS, or has too many components
            field = theirs.attributes.get(f"{name}_2")
        names = [f"{name}[{i}]" for i in range(attribute.values.shape[1])]
        if name == "normal":
            names = ["NormalX", "NormalY", "NormalZ"]
        if field is None and names[0] in theirs.attributes:
            parts = [theirs.attributes[part] for part in names]
            field = parts[0]
            field.values = np.concatenate([part.values for part in parts], axis=1)
        if field is None:
            found.append(f"{name} is missing; there are {', '.join(theirs.attributes)}")
        elif name == "rgb" and attribute.values.dtype == np.uint8:
            if not same(field.values, attribute.values.astype(np.uint16) * 257):
                found.append("the colours differ")
        elif not same(field.values, attribute.values) or (field.scale, field.offset) != (attribute.scale, attribute.offset):
            found.append(f"{name} differs: {field.values[:2].tolist()}, expected {attribute.values[:2].tolist()}")
    return found


# ------------------------------------------------------------------------------------------------------------ PLY and PCD

def field_names(name, components, columns):
    """The columns of an attribute, with the names that a header can hold."""
    base = re.sub(r"[^A-Za-z0-9_.+-]", "_", name)
    for stem in (base, f"attribute_{base}", f"{base}_2"):
        names = [stem] if components == 1 else [f"{stem}_{i}" for i in range(components)]
        if all(n in columns for n in names):
            return names
    return None


def columns_of(names, columns):
    return np.stack([np.asarray(columns[n]) for n in names], axis=1)


def scaled_lines(name, attribute, theirs, raw):
    """Of a column of values; `raw` is that of the raw numbers beside it, or None."""
    values = values_of(attribute)
    if raw is not None and not same(raw, attribute.values):
        return [f"the raw numbers of {name} differ"]
    if attribute.values.dtype.kind == "f" or raw is not None:
        return [] if same(values, theirs) else [f"the values of {name} differ"]
    if theirs.dtype.kind != "f" or not (np.abs(theirs.astype(np.float64) - values) <= abs(attribute.scale) / 8).all():
        return [f"{name} is {theirs[:3].tolist()}, expected {values[:3].tolist()}"]
    return []


def colour_lines(attribute, theirs, exact, options):
    if "16" in options[-1:]:
        return [] if same(theirs, attribute.values) and theirs.dtype == attribute.values.dtype else ["the colours differ"]
    found = []
    if theirs.dtype != np.uint8 or not same(theirs, bytes_of_colours(attribute)):
        found.append(f"the colours are {theirs[:2].tolist()}, expected {bytes_of_colours(attribute)[:2].tolist()}")
    if eight_bits_hold(attribute) != (exact is None) and "8" not in options[-1:]:
        found.append("the exact colours are missing, or are there for nothing")
    if exact is not None and not same(exact, attribute.values):
        found.append("the exact colours differ")
    return found


def ply_attribute(name, attribute, columns, options):
    components = attribute.values.shape[1]
    if name == "intensity" and "red" in columns and "scalar_intensity" in columns:
        if columns["scalar_intensity"].dtype != np.float32:
            return ["scalar_intensity is no float"]
        name = "scalar_intensity"
    if name == "rgb" and components == 3 and attribute.values.dtype.itemsize < 8:
        exact = [f"{c}_exact" for c in COLOUR_NAMES]
        return colour_lines(attribute, columns_of(COLOUR_NAMES, columns),
                            columns_of(exact, columns) if exact[0] in columns else None, options)
    if name == "normal" and components == 3:
        return [] if same(columns_of(("nx", "ny", "nz"), columns), values_of(attribute)) else ["the normals differ"]
    names = field_names(name, components, columns)
    if is_scaled(attribute):
        raw = field_names(f"{name}_raw", components, columns)
        return scaled_lines(name, attribute, columns_of(names, columns), columns_of(raw, columns) if raw else None)
    if names:
        theirs = columns_of(names, columns)
        whole = attribute.values.dtype.itemsize < 8 or attribute.values.dtype.kind == "f"
        kind = attribute.values.dtype if whole else np.dtype(np.float64)
        return [] if same(theirs, attribute.values) and theirs.dtype == kind else [f"{name} differs"]
    halves = [columns.get(f"{name}{end}") for end in ("_low", "_high")]
    if any(half is None for half in halves):
        return [f"{name} is missing; there are {', '.join(columns)}"]
    low, high = (np.asarray(half).astype(np.int64) for half in halves)
    return [] if same((high << 32 | low).astype(attribute.values.dtype), attribute.values[:, 0]) else [f"{name} differs"]


def plyfile(output, truth, error, options):
    import plyfile as module
    vertices = module.PlyData.read(output)["vertex"]
    columns = {p.name: vertices.data[p.name] for p in vertices.properties}
    found = position_lines(truth, columns_of("xyz", columns), error)
    for name, attribute in truth.attributes.items():
        found += ply_attribute(name, attribute, columns, options)
    return found


def shift_of(path):
    """VIEWPOINT's translation, which has to be added to positions that are relative to it."""
    with open(path, "rb") as file:
        for line in file:
            if line.startswith(b"VIEWPOINT"):
                return np.array(line.split()[1:4], dtype=np.float64)
    return np.zeros(3)


def pcd_column(name, components, columns):
    """A column of the file; pypcd4 has one per component, NAME__0000 and so on."""
    for stem in (name, f"attribute_{name}", f"{name}_2"):
        if stem in columns:
            return columns[stem].values
        parts = [columns.get(f"{stem}__{i:04d}") for i in range(components)]
        if all(part is not None for part in parts):
            return np.concatenate([part.values for part in parts], axis=1)
    return None


def pcd_lines(read, output, truth, error, options):
    shift = shift_of(output) if "--float-positions" in options else np.zeros(3)
    found = position_lines(truth, read.positions + shift, error)
    columns = read.attributes
    for name, attribute in truth.attributes.items():
        components = attribute.values.shape[1]
        name = re.sub(r"[^A-Za-z0-9_.+-]", "_", name)
        theirs = pcd_column(name, components, columns)
        exact = pcd_column(f"{name}_exact", components, columns)
        if name == "rgb" and components == 3 and theirs is not None:
            found += colour_lines(attribute, theirs, exact, options)
        elif theirs is None:
            found.append(f"{name} is missing; there are {', '.join(columns)}")
        elif is_scaled(attribute):
            found += scaled_lines(name, attribute, theirs, pcd_column(f"{name}_raw", components, columns))
        elif (name, components) in (("intensity", 1), ("normal", 3)):
            kind = attribute.values.dtype
            if theirs.dtype != np.float32 or not same(theirs, attribute.values.astype(np.float32)):
                found.append(f"{name} differs, or is no float")
            if (exact is None) != (kind.itemsize <= 2 or kind == np.float32) or \
                    (exact is not None and not same(exact, attribute.values)):
                found.append(f"{name}_exact differs, is missing, or is there for nothing")
        elif not same(theirs, attribute.values) or theirs.dtype != attribute.values.dtype:
            found.append(f"{name} differs")
    return found


def pypcd4(output, truth, error, options):
    import pcd_by_pypcd4
    if len(truth.positions) < 2:  # pypcd4 reads a line of text as a column, and nothing as an error
        return []
    return pcd_lines(pcd_by_pypcd4.read(output), output, truth, error, options)


# ------------------------------------------------------------------------------------------------------------------- text

def text(output, truth, error, options):
    """A table with a header, read by numpy."""
    if not len(truth.positions):  # a table without lines has no width for numpy
        return []
    with open(output) as file:
        names = file.readline().strip().split(",")
    table = np.genfromtxt(output, delimiter=",", skip_header=1, dtype=np.float64, ndmin=2)
    columns = dict(zip(names, table.T))
    # Coordinates of a grid are printed as the decimals that they stand for, not as the doubles that were computed.
    found = position_lines(truth, columns_of("xyz", columns), error + np.abs(truth.positions).max() * 2.0**-51)
    for name, attribute in truth.attributes.items():
        components = attribute.values.shape[1]
        three = {"rgb": ("r", "g", "b"), "normal": ("nx", "ny", "nz")}.get(name) if components == 3 else None
        chosen = three if three and three[0] in columns else field_names(name, components, columns)
        if not chosen:
            found.append(f"{name} is missing; there are {', '.join(columns)}")
            continue
        values, theirs = values_of(attribute), columns_of(chosen, columns)
        if attribute.values.dtype == np.float32 and not is_scaled(attribute):
            theirs = theirs.astype(np.float32)  # the fewest digits that name the float
        if not (np.abs(theirs - values) <= np.abs(values) * 2.0**-52)[~np.isnan(values)].all():
            found.append(f"{name} differs: {theirs[:2].tolist()}, expected {values[:2].tolist()}")
    return found


# -------------------------------------------------------------------------------------------------------- programs to see

def seen_lines(truth, colours, normals):
    """What a viewer has beside positions: colours of 0 to 1 and normals; None where it has none."""
    found = []
    if "rgb" in truth.attributes and truth.attributes["rgb"].values.shape[1] == 3:
        expected = bytes_of_colours(truth.attributes["rgb"])
        if colours is None or not np.array_equal(np.rint(np.asarray(colours)[:, :3] * 255).astype(np.uint8), expected):
            found.append(f"the colours are {None if colours is None else colours[:2].tolist()}, expected {expected[:2].tolist()}")
    if "normal" in truth.attributes and normals is not None:
        if not np.allclose(normals, values_of(truth.attributes["normal"]), rtol=0, atol=2e-7, equal_nan=True):
            found.append("the normals differ")
    return found


def pymeshlab(output, truth, error, options):
    import pymeshlab as module
    meshes = module.MeshSet()
    meshes.load_new_mesh(str(output))
    mesh = meshes.current_mesh()
    found = position_lines(truth, mesh.vertex_matrix(), error)
    colours = mesh.vertex_color_matrix() if mesh.has_vertex_color() else None
    return found + seen_lines(truth, colours, mesh.vertex_normal_matrix())


def open3d(output, truth, error, options):
    import open3d as module
    if not len(truth.positions):  # an error to it
        return []
    cloud = module.io.read_point_cloud(str(output))
    shift = shift_of(output) if "--float-positions" in options else np.zeros(3)
    found = position_lines(truth, np.asarray(cloud.points) + shift, error)
    return found + seen_lines(truth, np.asarray(cloud.colors) if cloud.has_colors() else None,
                              np.asarray(cloud.normals) if cloud.has_normals() else None)


def run(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=120,
                          env={**os.environ, "LC_ALL": "C"})
    if done.returncode != 0:
        raise RuntimeError(f"{command[0]}: {done.stdout[-300:]} {done.stderr[-300:]}")


def meshlab(output, truth, error, options):
    """Read by stock MeshLab, which has floats, and written by it as PLY."""
    import plyfile as module
    back = output.with_name("meshlab.ply")
    back.unlink(missing_ok=True)
    run("xvfb-run", "-a", "meshlabserver", "-i", output, "-o", back, "-m", "vc", "vn")
    vertices = module.PlyData.read(back)["vertex"]
    columns = {p.name: vertices.data[p.name] for p in vertices.properties}
    found = position_lines(truth, columns_of("xyz", columns), error, single=True)
    colours = columns_of(COLOUR_NAMES, columns) / 255 if "red" in columns else None
    return found + seen_lines(truth, colours, columns_of(("nx", "ny", "nz"), columns) if "nx" in columns else None)


def pcl(output, truth, error, options):
    """Every field through PCL's own reader and writer; positions through its points of floats too."""
    import pcd_by_pypcd4
    if len(truth.positions) < 2:  # see pypcd4()
        return []
    copy = output.with_name("pcl.pcd")
    run("pcl_convert_pcd_ascii_binary", output, copy, 1)
    read = pcd_by_pypcd4.read(copy)
    found = pcd_lines(read, output, truth, error, options)
    header = output.read_bytes()[:1_000_000].partition(b"\nDATA")[0]
    if b"\nSIZE 4 4 4" in header:
        # The tool takes x y z as floats and adds nothing; it writes eight digits.
        run("pcl_add_gaussian_noise", output, copy, "-sd", 0)
        off = np.abs(pcd_by_pypcd4.read(copy).positions - read.positions)
        if not ((off <= np.abs(read.positions) * 2 * SINGLE) | np.isnan(off)).all():
            found.append("PCL's points of floats have other positions")
    return found


BITS = ["--colour-bits"]
EXPORTS = {
    "laspy": [(".las", [], laspy), (".laz", [], laspy), (".las", ["--las-version", "1.2"], laspy),
              (".laz", ["--las-version", "1.4"], laspy)],
    "plyfile": [(".ply", [], plyfile), (".ply", ["--ascii"], plyfile), (".ply", [*BITS, "8"], plyfile),
                (".ply", [*BITS, "16"], plyfile)],
    "pypcd4": [(".pcd", [], pypcd4), (".pcd", ["--ascii"], pypcd4), (".pcd", ["--float-positions"], pypcd4),
               (".pcd", [*BITS, "16"], pypcd4)],
    "text": [(".csv", [], text)],
    "pymeshlab": [(".ply", [], pymeshlab)],
    "open3d": [(".ply", [], open3d), (".pcd", ["--float-positions"], open3d)],
    "meshlab": [(".ply", [], meshlab)],
    "pcl": [(".pcd", [], pcl), (".pcd", ["--float-positions"], pcl)],
}
