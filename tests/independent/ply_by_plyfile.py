"""PLY read by plyfile, in the project's names."""
import numpy as np
import plyfile

from compare import Attribute, Cloud, column

NAMES = {"scalar_intensity": "intensity"}  # CloudCompare's name for it
GROUPS = [("rgb", [("red", "green", "blue"), ("diffuse_red", "diffuse_green", "diffuse_blue"), ("r", "g", "b")]),
          ("normal", [("nx", "ny", "nz"), ("normal_x", "normal_y", "normal_z")])]


def read(path):
    vertices = plyfile.PlyData.read(path)["vertex"]
    values = {p.name: vertices.data[p.name] for p in vertices.properties
              if not isinstance(p, plyfile.PlyListProperty)}
    lower = {name.lower(): name for name in values}
    positions = np.stack([values.pop(lower[axis]).astype(np.float64) for axis in "xyz"], axis=1)

    attributes = {}
    for name, choices in GROUPS:
        for members in choices:
            # An attribute has one type: a red uchar and a blue char stay separate properties.
            if all(member in lower for member in members) and len({values[lower[m]].dtype for m in members}) == 1:
                attributes[name] = Attribute(column(*(values.pop(lower[member]) for member in members)))
                break
    for name, scalars in values.items():
        attributes[NAMES.get(name, name)] = Attribute(np.asarray(scalars).reshape(-1, 1))
    return Cloud(positions, attributes)
