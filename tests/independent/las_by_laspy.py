"""LAS and LAZ read by laspy, in the project's names. LAZ goes through LASzip, the format's own decoder (lazrs is the crate
that the project decodes with, too)."""
import laspy
import numpy as np

from compare import Attribute, Cloud, column

NAMES = {"wavepacket_index": "wave_packet_descriptor", "wavepacket_offset": "wave_packet_offset",
         "wavepacket_size": "wave_packet_size", "return_point_wave_location": "wave_return_location",
         "ExtraBytes": "extra_bytes"}
GROUPS = {"rgb": ("red", "green", "blue"), "wave_direction": ("x_t", "y_t", "z_t")}
# LAS 1.4, table 14 and following: scan angles of the point formats from 6 on count steps of 0.006 degrees.
SCALES = {"scan_angle": 0.006}


def read(path):
    las = laspy.read(path, laz_backend=laspy.LazBackend.Laszip)
    record = las.points
    extra = {dimension.name: dimension for dimension in las.point_format.extra_dimensions}
    grouped = {member: name for name, members in GROUPS.items() for member in members}

    def raw(name):
        # The stored values: neither scaled, nor a view of bits.
        values = record.array[name] if name in record.array.dtype.names else np.array(record[name])
        return np.asarray(values)

    attributes = {}
    for name in las.point_format.dimension_names:
        if name in ("X", "Y", "Z"):
            continue
        if name in extra:
            add_extra(attributes, extra[name], raw(name))
        elif name in grouped:
            group = grouped[name]
            if group not in attributes:
                attributes[group] = Attribute(column(*(raw(member) for member in GROUPS[group])))
        else:
            attributes[NAMES.get(name, name)] = Attribute(raw(name).reshape(-1, 1), SCALES.get(name, 1.0))
    return Cloud(np.stack([np.asarray(las.x), np.asarray(las.y), np.asarray(las.z)], axis=1), attributes,
                 grid=column(record.array["X"], record.array["Y"], record.array["Z"]),
                 scale=las.header.scales.tolist(), offset=las.header.offsets.tolist())


def add_extra(attributes, dimension, values):
    name = NAMES.get(dimension.name, dimension.name)
    values = values.reshape(len(values), -1)
    count = values.shape[1]
    scales = [1.0] * count if dimension.scales is None else list(map(float, dimension.scales[:count]))
    offsets = [0.0] * count if dimension.offsets is None else list(map(float, dimension.offsets[:count]))
    if len(set(zip(scales, offsets))) <= 1:
        attributes[name] = Attribute(values, scales[0], offsets[0])
    else:  # an attribute has one scale: the components become attributes of their own
        for i in range(count):
            attributes[f"{name}[{i}]"] = Attribute(values[:, i:i + 1], scales[i], offsets[i])
