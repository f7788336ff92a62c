"""Clouds with every kind of number that an export has to decide about, as files of formats that need no decision."""
import numpy as np

POINTS = 400


def ply(path, columns):
    """An ascii PLY of columns {name: (type, numbers)}, written here so that nothing else is needed."""
    lines = ["ply", "format ascii 1.0", f"element vertex {POINTS}"]
    lines += [f"property {kind} {name}" for name, (kind, _) in columns.items()] + ["end_header"]
    rows = zip(*([repr(v) for v in numbers.tolist()] for _, numbers in columns.values()))
    path.write_text("\n".join(lines + [" ".join(row) for row in rows]) + "\n")
    return path


def whole(random, low, high):
    """Integers that include both ends."""
    numbers = random.integers(low, high, POINTS, endpoint=True)
    numbers[:2] = low, high
    return numbers


def colours(random, low, high, step=1, kind="ushort"):
    return {name: (kind, whole(random, low, high) * step) for name in ("red", "green", "blue")}


def positions(random, offset, size, decimals=None, kind="double"):
    columns = {}
    for axis, start in zip("xyz", offset):
        numbers = start + random.uniform(-size, size, POINTS)
        if decimals is not None:
            numbers = np.round(numbers, decimals)
        if kind == "float":
            numbers = numbers.astype(np.float32).astype(np.float64)
        columns[axis] = (kind, numbers)
    return columns


def make(folder):
    random = np.random.default_rng(1)
    fractions = np.linspace(0, 1, POINTS).astype(np.float32).astype(np.float64)
    files = {
        # Floats: intensities and colours of 0 to 1, normals, white.
        "floats.ply": {**positions(random, (0, 0, 0), 50, kind="float"), "intensity": ("float", fractions),
                       **{n: ("float", fractions[::-1]) for n in ("red", "green", "blue")},
                       **{n: ("float", np.float32(random.uniform(-1, 1, POINTS)).astype(float)) for n in ("nx", "ny", "nz")}},
        "bytes.ply": {**positions(random, (7, 8, 9), 5, kind="float"), **colours(random, 0, 255, kind="uchar"),
                      "alpha": ("uchar", whole(random, 0, 255)), "classification": ("uchar", whole(random, 0, 31))},
        # Map coordinates of millimetres, colours of 16 bits, classes and returns that need LAS 1.4.
        "map.ply": {**positions(random, (500000, 4800000, 100), 200, 3), **colours(random, 0, 65535),
                    "intensity": ("ushort", whole(random, 0, 65535)), "classification": ("uchar", whole(random, 0, 255)),
                    "return_number": ("uchar", whole(random, 1, 15)), "gps_time": ("double", random.uniform(0, 6e5, POINTS))},
        "steps257.ply": {**positions(random, (500000, 4800000, 100), 200, 2), **colours(random, 0, 255, 257)},
        "steps256.ply": {**positions(random, (0, 0, 0), 20, 3), **colours(random, 0, 255, 256),
                         "intensity": ("short", whole(random, -2048, 2047))},
        "low.ply": {**positions(random, (0, 0, 0), 20, 3), **colours(random, 0, 255),
                    "intensity": ("float", whole(random, 0, 255).astype(float))},
        # 64-bit integers within and beyond doubles; names of LAS fields for other things.
        "wide.ply": {**positions(random, (0, 0, 0), 20, 3), "id": ("int64", whole(random, -2**53 + 1, 2**53 - 1)),
                     "hash": ("uint64", whole(random, 0, 2**63 - 1).astype(np.uint64)),
                     "X_t": ("uchar", whole(random, 0, 255)), "raw_classification": ("int", whole(random, -9, 9)),
                     "scan_angle_rank": ("double", random.uniform(-30, 30, POINTS))},
    }
    paths = [ply(folder / name, columns) for name, columns in files.items()]
    return paths + scaled_las(folder)


def scaled_las(folder):
    """LAS files with scaled attributes, byte by byte: a scan angle and extra bytes with scale and offset."""
    import struct
    random = np.random.default_rng(2)
    paths = []
    for minor, form, length in ((2, 1, 28), (4, 6, 30)):
        extra = b"".join(
            struct.pack("<HBB32s4s24s24s24s3d3d32s", 0, kind, options, name, b"", b"", b"", b"", scale, 0, 0, offset, 0, 0, b"")
            for kind, options, name, scale, offset in ((6, 24, b"amplitude", 0.01, -50), (10, 24, b"drift", 0.5, 1e6)))
        vlr = struct.pack("<H16sHH32s", 0, b"LASF_Spec", 4, len(extra), b"") + extra
        size = 375 if minor == 4 else 227
        header = bytearray(size)
        struct.pack_into("<4sHH16sBB32s32sHHHIIBHI", header, 0, b"LASF", 0, 0, b"", 1, minor, b"test", b"test", 1, 2024, size,
                         size + len(vlr), 1, form, length + 12, 0 if minor == 4 else POINTS)
        struct.pack_into("<3d3d", header, 131, 0.001, 0.001, 0.001, 4000, 5000, 0)
        if minor == 4:
            struct.pack_into("<Q", header, 247, POINTS)
        records = b""
        for i in range(POINTS):
            x, y, z = (int(v) for v in random.integers(-10**5, 10**5, 3))
            amplitude, drift = int(random.integers(-2**31, 2**31)), float(random.normal())
            if form == 1:
                records += struct.pack("<iiiHBBbBHd", x, y, z, i, 9, i % 32, i % 181 - 90, i % 256, i, i * 0.25)
            else:
                records += struct.pack("<iiiHBBBBhHd", x, y, z, i, 17, 0, i % 256, 3, (i - 200) * 150, i, i * 0.25)
            records += struct.pack("<id", amplitude, drift)
        path = folder / f"scaled{form}.las"
        path.write_bytes(bytes(header) + vlr + records)
        paths.append(path)
    return paths
