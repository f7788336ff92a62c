"""E57 read by pye57 (libE57Format), in the project's names; poses and spherical coordinates by the standard's formulas."""
import numpy as np
import pye57
from pye57 import libe57

from compare import Attribute, Cloud

NAMES = {"returnIndex": "return_index", "returnCount": "number_of_returns", "las:pointSourceId": "point_source_id",
         "timeStamp": "time_stamp", "rowIndex": "row_index", "columnIndex": "column_index"}
# The coordinates, and the marks of points that have none.
OF_POSITIONS = ("cartesianX", "cartesianY", "cartesianZ", "cartesianInvalidState",
                "sphericalRange", "sphericalAzimuth", "sphericalElevation", "sphericalInvalidState")
COLOURS = ("colorRed", "colorGreen", "colorBlue")


def all_fields(file, header):
    """Every field as doubles; pye57's own functions read only those that they know."""
    columns = {name: np.empty(header.point_count) for name in header.point_fields}
    if header.point_count:
        buffers = libe57.VectorSourceDestBuffer()
        for name, values in columns.items():
            buffers.append(libe57.SourceDestBuffer(file.image_file, name, values, header.point_count, True, True))
        reader = header.points.reader(buffers)
        reader.read()
        reader.close()
    return columns


def cartesian(data):
    if "cartesianX" in data:
        return np.stack([data[f"cartesian{axis}"] for axis in "XYZ"], axis=1), data.get("cartesianInvalidState")
    distance, azimuth, elevation = (data[f"spherical{name}"] for name in ("Range", "Azimuth", "Elevation"))
    flat = distance * np.cos(elevation)
    return (np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), distance * np.sin(elevation)], axis=1),
            data.get("sphericalInvalidState"))


def read(path):
    file = pye57.E57(str(path))
    parts = []
    for index in range(file.scan_count):
        header = file.get_header(index)
        data = all_fields(file, header)
        local, state = cartesian(data)
        valid = np.ones(len(local), bool) if state is None else state == 0
        world = local[valid]
        uncertainty = np.zeros(world.shape)
        if "cartesianX" not in data:
            uncertainty += np.abs(world).sum(axis=1, keepdims=True) * 2.0**-50
        if header.has_pose():
            world = (header.rotation_matrix @ world.T).T + header.translation
            uncertainty += (np.abs(local[valid]).sum(axis=1, keepdims=True) + np.abs(header.translation).sum()) * 2.0**-50
        parts.append((world, {name: values[valid] for name, values in data.items() if name not in OF_POSITIONS}, uncertainty))

    names = list(dict.fromkeys(name for _, data, _ in parts for name in data))
    attributes = {}

    def whole(name):
        return np.concatenate([data[name] if name in data else np.zeros(len(world)) for world, data, _ in parts])

    if all(name in names for name in COLOURS):
        attributes["rgb"] = Attribute(np.stack([whole(name) for name in COLOURS], axis=1).astype(np.float64), any_type=True)
    for name in names:
        if name not in COLOURS:
            attributes[NAMES.get(name, name)] = Attribute(whole(name).astype(np.float64).reshape(-1, 1), any_type=True)
    if len(parts) > 1:
        scan = np.concatenate([np.full(len(world), i + 1.0) for i, (world, _, _) in enumerate(parts)])
        attributes["scan"] = Attribute(scan.reshape(-1, 1), any_type=True)
    return Cloud(np.concatenate([world for world, _, _ in parts]), attributes,
                 uncertainty=np.concatenate([bound for _, _, bound in parts]))
