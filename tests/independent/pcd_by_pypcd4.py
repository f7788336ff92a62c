"""PCD read by pypcd4, in the project's names."""
import io

import numpy as np
import pypcd4

from compare import Attribute, Cloud, column

GROUPS = {"normal": ("normal_x", "normal_y", "normal_z"), "rgb": ("red", "green", "blue")}
# PDAL's names for the fields of LAS.
NAMES = {"Intensity": "intensity", "ReturnNumber": "return_number", "NumberOfReturns": "number_of_returns",
         "ScanDirectionFlag": "scan_direction_flag", "EdgeOfFlightLine": "edge_of_flight_line",
         "Classification": "classification", "ScanAngleRank": "scan_angle_rank", "UserData": "user_data",
         "PointSourceId": "point_source_id", "GpsTime": "gps_time"}



PADDING = "#$%&~~"  # how pypcd4 begins its names for the fields "_"


def load(path):
    """Old PCL files, which pypcd4 refuses: versions other than .7, and headers without COUNT."""
    content = path.read_bytes()
    end = content.index(b"\n", content.index(b"\nDATA") + 1)
    lines = content[:end].split(b"\n")
    lines = [b"VERSION .7" if line.startswith(b"VERSION") else line for line in lines]
    if not any(line.startswith(b"COUNT") for line in lines):
        types = next(i for i, line in enumerate(lines) if line.startswith(b"TYPE"))
        lines.insert(types + 1, b"COUNT" + b" 1" * (len(lines[types].split()) - 1))
    if not any(line.startswith(b"VIEWPOINT") for line in lines):
        lines.insert(-2, b"VIEWPOINT 0 0 0 1 0 0 0")
    return pypcd4.PointCloud.from_fileobj(io.BytesIO(b"\n".join(lines) + content[end:]))


def packed(values):
    """The four bytes of a packed colour: blue, green, red, alpha."""
    return np.ascontiguousarray(values).view("<u4").reshape(-1)


def read(path):
    cloud = load(path)
    values = {name: np.asarray(cloud.pc_data[name]) for name in cloud.pc_data.dtype.names}
    lower = {name.lower(): name for name in values}
    positions = np.stack([values.pop(lower[axis]).astype(np.float64) for axis in "xyz"], axis=1)
    attributes = {}
    for name, members in GROUPS.items():
        if all(member in lower for member in members):
            attributes[name] = Attribute(column(*(values.pop(lower[member]) for member in members)))
    for name, scalars in values.items():
        if name.startswith(PADDING):
            continue
        if name in ("rgb", "rgba"):
            colour = packed(scalars)
            attributes["rgb"] = Attribute(column(*((colour >> shift & 255).astype(np.uint8) for shift in (16, 8, 0))))
            if name == "rgba":
                attributes["alpha"] = Attribute((colour >> 24).astype(np.uint8).reshape(-1, 1))
        else:
            attributes[NAMES.get(name, name)] = Attribute(scalars.reshape(len(scalars), -1))
    return Cloud(positions, attributes)
