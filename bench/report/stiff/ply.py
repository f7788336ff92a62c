"""PLY files of the cases: positions in double or float, attributes by name, binary."""
import numpy

TYPES = {"float64": "double", "float32": "float", "int32": "int", "uint32": "uint", "int16": "short", "uint16": "ushort", "int8": "char",
         "uint8": "uchar"}
KINDS = {name: kind for kind, name in TYPES.items()}


def write(path, xyz, attributes, kind="float64"):
    """`attributes`: name -> array, one value a point."""
    columns = [(axis, kind, xyz[:, i]) for i, axis in enumerate("xyz")]
    columns += [(name, values.dtype.name, values) for name, values in attributes.items()]
    rows = numpy.empty(len(xyz), dtype=[(name, kind) for name, kind, _ in columns])
    for name, _, values in columns:
        rows[name] = values
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(xyz)}\n"
    head += "".join(f"property {TYPES[kind]} {name}\n" for name, kind, _ in columns) + "end_header\n"
    path.write_bytes(head.encode() + rows.tobytes())


def read(path):
    """Name -> array of the vertices; "xyz" has the positions, n x 3, in double."""
    data = path.read_bytes()
    head, _, body = data.partition(b"end_header\n")
    lines = [line.split() for line in head.decode().splitlines()]
    count = next(int(line[2]) for line in lines if line[:2] == ["element", "vertex"])
    kind = numpy.dtype([(line[2], KINDS[line[1]]) for line in lines if line[0] == "property"])
    rows = numpy.frombuffer(body, dtype=kind, count=count)
    columns = {name: rows[name] for name in kind.names}
    columns["xyz"] = numpy.stack([rows[axis].astype(float) for axis in "xyz"], axis=1)
    return columns
