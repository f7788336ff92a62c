"""Open3D's voxel_down_sample for bench/voxels/run.py: started as voxel_files.h says. Its voxels begin half a voxel below
the smallest coordinates."""
import json
import os
import sys
import time

size, threads, positions, result = sys.argv[1:]
os.environ["OMP_NUM_THREADS"] = threads
import numpy  # noqa: E402
import open3d  # noqa: E402

cloud = open3d.geometry.PointCloud()
cloud.points = open3d.utility.Vector3dVector(numpy.fromfile(positions).reshape(-1, 3))
start, cpu = time.perf_counter(), time.process_time()
found = cloud.voxel_down_sample(float(size))
seconds, cpu = time.perf_counter() - start, time.process_time() - cpu
numpy.asarray(found.points).tofile(result)
peak = next(line.split()[1] for line in open("/proc/self/status", encoding="utf-8") if line.startswith("VmHWM:"))
print(json.dumps({"seconds": seconds, "cpu_seconds": cpu, "peak_mb": int(peak) / 1024}))
