#!/usr/bin/env python3
"""Readers of Python for run.py: peer_python.py laspy|laspy-parallel|open3d|plyfile, then lines as the other programs take."""
import json
import pathlib
import sys
import time


def laspy_reader(backend):
    import laspy
    import numpy as np

    def read(path):
        if pathlib.Path(path).suffix not in (".las", ".laz"):
            raise ValueError("laspy reads no such file")
        las = laspy.read(path, laz_backend=getattr(laspy.LazBackend, backend))
        return len(las.points), len(list(las.point_format.dimension_names)), \
            lambda: np.stack([las.x, las.y, las.z], axis=1)
    return read


def open3d_reader():
    import numpy as np
    import open3d

    def read(path):
        if pathlib.Path(path).suffix not in (".ply", ".pcd", ".pts", ".xyz", ".xyzrgb"):
            raise ValueError("Open3D reads no such file")
        # Its .xyz takes three columns, its .xyzrgb six.
        kind = "xyzrgb" if path.endswith(".xyz") and len(open(path).readline().split()) == 6 else "auto"
        cloud = open3d.io.read_point_cloud(path, format=kind)
        if not cloud.points:
            raise ValueError("no points came")
        return len(cloud.points), 3 + 3 * cloud.has_colors() + 3 * cloud.has_normals(), \
            lambda: np.asarray(cloud.points)
    return read


def plyfile_reader():
    import numpy as np
    import plyfile

    def read(path):
        if not path.endswith(".ply"):
            raise ValueError("plyfile reads no such file")
        data = plyfile.PlyData.read(path)["vertex"].data
        names = data.dtype.names
        # It maps the file: without a look at every column nothing would have been read.
        columns = [np.array(data[name]) for name in names]
        return len(data), len(names), lambda: np.stack([columns[names.index(a)].astype("f8") for a in "xyz"], axis=1)
    return read


READERS = {"laspy": lambda: laspy_reader("Lazrs"), "laspy-parallel": lambda: laspy_reader("LazrsParallel"),
           "open3d": open3d_reader, "plyfile": plyfile_reader}


def main():
    read = READERS[sys.argv[1]]()
    for line in sys.stdin:
        verb, path, *more = line.rstrip("\n").split("\t")
        try:
            started, cpu_started = time.perf_counter(), time.process_time()
            points, values, positions = read(path)
            seconds, cpu = time.perf_counter() - started, time.process_time() - cpu_started
            if verb == "dump":
                positions().astype("<f8").tofile(more[0])
            answer = {"seconds": seconds, "cpu_seconds": cpu, "points": points, "values": values, "error": 0}
            del positions
        except Exception as error:  # whatever a reader of others throws is its answer
            answer = {"failed": f"{type(error).__name__}: {error}"}
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
