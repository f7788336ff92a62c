"""Open3D's normals and outliers for bench/neighbours/run.py: started as filter_files.h says."""
import json
import os
import sys
import time

name, neighbours, threads, sigmas, share, positions, result = sys.argv[1:]
os.environ["OMP_NUM_THREADS"] = threads
import numpy  # noqa: E402
import open3d  # noqa: E402

cloud = open3d.geometry.PointCloud()
cloud.points = open3d.utility.Vector3dVector(numpy.fromfile(positions).reshape(-1, 3))
count = int(neighbours) + 1  # the point itself is one of them
start, cpu = time.perf_counter(), time.process_time()
if name == "normals":
    cloud.estimate_normals(open3d.geometry.KDTreeSearchParamKNN(count))
    out = numpy.asarray(cloud.normals).astype(numpy.float32)
else:
    kept = cloud.remove_statistical_outlier(count, float(sigmas))[1]
    out = numpy.ones(len(cloud.points), numpy.uint8)
    out[numpy.asarray(kept)] = 0
seconds, cpu = time.perf_counter() - start, time.process_time() - cpu
out.tofile(result)
print(json.dumps({"seconds": seconds, "cpu_seconds": cpu}))
