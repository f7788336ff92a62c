#!/usr/bin/env python3
"""Writes small files of every format as the fuzzer's first inputs: the project's own, made by `pcmlab` and by hand.

    make_seeds.py PCMLAB FOLDER     fills FOLDER/las, FOLDER/ply, ...: one folder per fuzz target
"""
import json
import pathlib
import random
import struct
import subprocess
import sys
import tempfile

POINTS = 40
# Bytes of a record of the point formats 0 to 10.
RECORD = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67]


def las(point_format, version, extra=b"", vlrs=(), points=POINTS):
    """A LAS file of random records."""
    noise = random.Random(point_format)
    header_size = 375 if version == 4 else 235 if version == 3 else 227
    records = b"".join(struct.pack("<H16sHH32s", 0, user, number, len(value), b"") + value for user, number, value in vlrs)
    length = RECORD[point_format] + len(extra)
    start = header_size + len(records)
    header = struct.pack("<4sHHIHH8sBB32s32sHHHIIBHI5I", b"LASF", 0, 0, 0, 0, 0, b"", 1, version, b"", b"", 1, 2026,
                         header_size, start, len(vlrs), point_format, length, 0 if point_format >= 6 else points,
                         0, 0, 0, 0, 0)
    header += struct.pack("<12d", 0.001, 0.001, 0.01, 5e5, 4.8e6, 0, 5e5 + 9, 5e5, 4.8e6 + 9, 4.8e6, 9, 0)
    if version >= 3:
        header += struct.pack("<Q", 0)
    if version >= 4:
        header += struct.pack("<QIQ15Q", 0, 0, points, *[0] * 15)
    assert len(header) == header_size
    body = b"".join(struct.pack("<3i", *(noise.randrange(9000) for _ in range(3))) + noise.randbytes(length - 12)
                    for _ in range(points))
    return header + records + body


def extra_bytes_vlr():
    def descriptor(kind, options, name):
        return struct.pack("<HBB32s4s24s24s24s3d3d32s", 0, kind, options, name, b"", b"", b"", b"", 0.5, 1, 1, 7, 0, 0, b"")
    return b"LASF_Spec", 4, descriptor(3, 0x18, b"height") + descriptor(30, 0, b"vector") + descriptor(0, 2, b"raw")


def las_seeds():
    for point_format in range(11):
        version = 2 if point_format <= 3 else 3 if point_format <= 5 else 4
        yield f"format{point_format}.las", las(point_format, version)
    yield "old.las", las(1, 0)
    yield "extra.las", las(7, 4, bytes(28), [extra_bytes_vlr()])
    yield "vlrs.las", las(3, 2, b"", [(b"LASF_Projection", 34735, bytes(16)), (b"someone", 7, b"text")])


def ply_seeds():
    properties = [("float", "f"), ("double", "d"), ("uchar", "B"), ("short", "h"), ("int", "i")]
    for kind, order in (("ascii", ""), ("binary_little_endian", "<"), ("binary_big_endian", ">")):
        header = f"ply\nformat {kind} 1.0\ncomment made for a test\nelement vertex 20\n"
        header += "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
        header += "".join(f"property uchar {name}\n" for name in ("red", "green", "blue"))
        header += "".join(f"property {name} value_{name}\n" for name, _ in properties)
        header += "property list uchar int links\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
        codes = "6f3B" + "".join(code for _, code in properties) + "B2i"
        body = b""
        for i in range(20):
            row = [i * 0.25] * 6 + [i, 2 * i, 3 * i] + [i / 8, i / 3, i, -i, i * 1000] + [2, i, i + 1]
            body += struct.pack(order + codes, *row) if order else (" ".join(map(str, row)) + "\n").encode()
        for i in range(2):
            body += struct.pack(order + "B3i", 3, i, 1, 2) if order else b"3 0 1 2\n"
        yield f"{kind}.ply", header.encode() + body


def text_rows(separator=" ", columns=7):
    noise = random.Random(columns)
    for _ in range(POINTS):
        row = [f"{noise.uniform(4.8e5, 4.9e5):.3f}", f"{noise.uniform(5e6, 5.1e6):.3f}", f"{noise.uniform(-9, 9):.4g}",
               str(noise.randrange(-2048, 2048))] + [str(noise.randrange(256)) for _ in range(3)]
        yield separator.join(row[:columns])


def text_seeds():
    for name, separator, columns, head in (("plain.xyz", " ", 3, ""), ("colours.txt", "\t", 7, ""), ("semicolons.csv", ";", 4, ""),
                                           ("header.csv", ",", 7, "X,Y,Z,Intensity,Red,Green,Blue\n"),
                                           ("quoted.csv", ",", 3, '"X","Y","Z"\n'), ("comment.asc", " ", 6, "# x y z i r g\n")):
        yield name, (head + "\n".join(text_rows(separator, columns)) + "\n").encode()
    yield "windows.txt", ("\r\n".join(text_rows(" ", 6)) + "\r\n").encode()
    yield "odd_numbers.xyz", b"1e5 -2.5E-3 nan\n+1 .5 2.\n1.#IND 0x10 inf\n//\n0 0 0\n"


def pts_seeds():
    for columns in (3, 4, 6, 7):
        rows = "\n".join(text_rows(" ", columns))
        yield f"count{columns}.pts", f"{POINTS}\n{rows}\n".encode()
    yield "no_count.pts", ("\n".join(text_rows()) + "\n").encode()
    yield "two_blocks.pts", (f"{POINTS}\n" + "\n".join(text_rows()) + f"\n{POINTS}\n" + "\n".join(text_rows()) + "\n").encode()


def ptx_seeds():
    def block(columns, rows, colours):
        head = f"{columns}\n{rows}\n12.5 -7.25 3\n1 0 0\n0 1 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n12.5 -7.25 3 1\n"
        lines = []
        for i in range(columns * rows):
            line = "0 0 0 0.5" if i % 3 == 0 else f"{i * 0.25} {i / 7:.6f} -{i} {i / 100}"
            lines.append(line + (f" {i} {2 * i} 255" if colours else ""))
        return head + "\n".join(lines) + "\n"
    yield "one.ptx", block(4, 5, False).encode()
    yield "two.ptx", (block(3, 3, True) + block(2, 4, True)).encode()


def literal_lzf(data):
    """LZF that compresses nothing: runs of at most 32 literal bytes."""
    return b"".join(bytes([len(data[i:i + 32]) - 1]) + data[i:i + 32] for i in range(0, len(data), 32))


def pcd_seeds():
    def header(version, data):
        return (f"# .PCD v{version} - Point Cloud Data file format\nVERSION {version}\nFIELDS x y z rgb normal_x _ label t\n"
                f"SIZE 4 4 4 4 4 1 4 8\nTYPE F F F F F U U F\nCOUNT 1 1 1 1 1 4 1 1\nWIDTH 5\nHEIGHT 2\n"
                f"VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 10\nDATA {data}\n").encode()
    rows = [(i / 4, i / 3, -i / 7, 4.2108e+06, 0.5, 1, 2, 3, 4, i, i * 1e-3) for i in range(10)]
    binary = b"".join(struct.pack("<5f4BId", *row) for row in rows)
    fields = [struct.pack("<10f", *(row[i] for row in rows)) for i in range(5)]
    fields.append(b"".join(bytes(row[5:9]) for row in rows))
    fields.append(struct.pack("<10I", *(row[9] for row in rows)))
    fields.append(struct.pack("<10d", *(row[10] for row in rows)))
    packed = literal_lzf(b"".join(fields))
    yield "ascii.pcd", header("0.7", "ascii") + "".join(" ".join(map(str, row)) + "\n" for row in rows).encode()
    yield "old.pcd", header(".5", "ascii") + "".join(" ".join(map(str, row)) + "\n" for row in rows).encode()
    yield "binary.pcd", header("0.7", "binary") + binary
    yield "compressed.pcd", header("0.7", "binary_compressed") + struct.pack("<II", len(packed), len(b"".join(fields))) + packed


def primitives_seeds():
    def listed(*primitives):
        return json.dumps({"format": "pcm primitives", "version": 1, "primitives": primitives}).encode()

    fit = {"colour": [1, 2, 255], "hidden": True, "cloud": "a.pct", "rms": 0.1, "noise": 0.2, "threshold": 0.3, "condition": None,
           "sigma": {"position": 0.1, "angle": None, "radius": 1e-9, "second": 0}, "inliers": 5, "points": 6, "iterations": 7,
           "seconds": 0.5, "label": 8, "estimator": "msac", "verdict": "doubtful", "issue": "thin arc", "message": "\u00e4 b"}
    arc = {"zero": [1, 0, 0], "begin": 6, "end": 7.5}
    axis = {"point": [5e5, 48e5, 0.1], "axis": [0, 0, 1]}
    yield "plane.json", listed({"name": "a", "kind": "plane", **axis, **fit,
                                "bounds": {"outline": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]}})
    yield "round.json", listed({"name": "a", "kind": "cylinder", **axis, "radius": 0.5, "bounds": {"from": -1, "to": 2, **arc}},
                               {"name": "b", "kind": "sphere", "point": [1, 2, 3], "radius": 0.5, **fit},
                               {"name": "c", "kind": "cone", **axis, "half_angle": 0.5, "bounds": {"from": 0, "to": 2}},
                               {"name": "d", "kind": "torus", **axis, "radius": 2, "tube_radius": 0.5, "bounds": arc})
    yield "empty.json", listed()


def pairs_seeds():
    corners = [(0, 0, 0), (10, 0, 0), (0, 20.5, 0), (3, 4, 5e-3)]
    rows = ["# moving  fixed  weight"] + [f"{x + 5e5} {y + 48e5:.3f};{z},\t{-y} {x} {z + 1}" for x, y, z in corners]
    yield "turned.txt", "\r\n".join(rows).encode()
    yield "weights.txt", "".join(f"{row} {weight}\n" for row, weight in zip(rows[1:], (0, 1, 0.5, 1e-9))).encode()
    yield "line.txt", "".join(f"{i} {i} 0 {i} {i} 1 # on a line\n" for i in range(4)).encode()
    yield "far.txt", "".join(f"{x * 1e150} {y} {z} {x} {y} {z * 1e-150}\n" for x, y, z in corners).encode()


def measures_seeds():
    def listed(*measures):
        return json.dumps({"format": "pcm measures", "version": 1, "measures": measures}).encode()

    def points(count):
        return [{"position": [5e5 + i * i, 48e5 + 7 * i % 5, i * 0.5], "spacing": 0.1, "grid_step": 1e-3, "cloud": "a.pct"}
                for i in range(count)]

    counts = {"point": 1, "distance": 3, "height": 2, "angle": 3, "area": 4, "plane": 4, "volume": 4, "profile": 2, "surface": 1}
    for kind, count in counts.items():
        more = {"profile": {"width": 2.5}, "surface": {"surface": "cylinder 0 0 0 0 0 1 0.5"},
                "volume": {"computed": [{"name": "net", "value": -1.5, "uncertainty": 0.1, "unit": "^3"}]}}.get(kind, {})
        yield f"{kind}.json", listed({"kind": kind, "name": f"{kind} \u00e4", "points": points(count), **more})
    yield "several.json", listed(*({"kind": "angle", "name": str(i), "hidden": True, "points": points(3)} for i in range(3)))
    yield "empty.json", listed()


def write_e57(folder):
    """E57 files, if the tests' Python packages are installed: the project does not write E57."""
    try:
        import numpy
        import pye57
    except ImportError:
        return
    folder.mkdir(exist_ok=True)
    noise = numpy.random.default_rng(3)
    for name, scans, fields in (("plain", 1, {}), ("poses", 2, {"intensity": noise.random(30)}),
                                ("colours", 1, {f"color{c}": noise.integers(0, 256, 30) for c in ("Red", "Green", "Blue")})):
        path = folder / f"{name}.e57"
        path.unlink(missing_ok=True)
        with pye57.E57(str(path), mode="w") as file:
            for scan in range(scans):
                data = {f"cartesian{axis}": noise.random(30) * 9 for axis in "XYZ"}
                file.write_scan_raw({**data, **fields}, name=f"scan {scan}", rotation=numpy.array([0.6, 0, 0, 0.8]),
                                    translation=numpy.array([1.0, 2, 3]))


BY_HAND = {"las": las_seeds, "ply": ply_seeds, "xyz": text_seeds, "pts": pts_seeds, "ptx": ptx_seeds, "pcd": pcd_seeds,
           "primitives": primitives_seeds, "pairs": pairs_seeds, "measures": measures_seeds}
# Every target of a format is named like its extension; pcmlab writes the seeds of those that it writes.
CONVERTED = sorted({source.stem[len("fuzz_"):] for source in pathlib.Path(__file__).parent.glob("fuzz_*.cpp")} -
                   {"index", "chunk", "primitives", "pairs", "measures"})


def write_trees(pcm, scene, folder):
    """Indices of trees, and files of a tree's chunks."""
    for name in ("index", "chunk"):
        (folder / name).mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as trees:
        several = pathlib.Path(trees) / "several.las"
        subprocess.run([pcm, "generate", several, "--points", "4000", "--no-truth", "-q"], check=True)
        for source in (several, scene, folder / "las" / "format7.las", folder / "ply" / "binary_little_endian.ply"):
            tree = pathlib.Path(trees) / f"{source.stem}.pct"
            subprocess.run([pcm, "build", source, "-o", tree, "--chunk-points", "1000", "-q"], stdout=subprocess.DEVNULL)
            if not tree.exists():
                continue
            (folder / "index" / tree.name).write_bytes((tree / "index.pct").read_bytes())
            (folder / "chunk" / f"{source.stem}.bpc").write_bytes((tree / "chunks-000.bpc").read_bytes())


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    pcm, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    for name, seeds in BY_HAND.items():
        (folder / name).mkdir(parents=True, exist_ok=True)
        for file, content in seeds():
            (folder / name / file).write_bytes(content)
    write_e57(folder / "e57")
    scene = folder / "las" / "scene.las"
    subprocess.run([pcm, "generate", "--overwrite", scene, "--points", "200", "--no-truth", "-q"], check=True)
    write_trees(pcm, scene, folder)
    for extension in CONVERTED:
        (folder / extension).mkdir(exist_ok=True)
        for source in (scene, folder / "las" / "format7.las", folder / "las" / "extra.las", folder / "las" / "format3.las"):
            # Conversion fails where a format cannot hold a source or is not built in; the other seeds remain.
            subprocess.run([pcm, "convert", source, folder / extension / f"{source.stem}_converted.{extension}"],
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


if __name__ == "__main__":
    main()
