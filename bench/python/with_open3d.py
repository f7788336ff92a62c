"""The tasks of run.py with Open3D, which keeps positions, colours and normals alone and reads no LAS: laspy reads it."""
import laspy
import open3d

NEEDS = "las"


def cloud_of(files):
    return open3d.geometry.PointCloud(open3d.utility.Vector3dVector(laspy.read(files["las"]).xyz))


def count(files):
    cloud = cloud_of(files)
    return [len(cloud.points), *cloud.get_min_bound(), *cloud.get_max_bound()]


def nearest(files):
    import numpy

    tree = open3d.geometry.KDTreeFlann(cloud_of(files))
    found = [tree.search_knn_vector_3d(place, 8)[2] for place in files["places"]]
    return [numpy.sqrt(numpy.array(found)).mean()]


def outliers(files):
    cloud, _ = cloud_of(files).remove_statistical_outlier(17, 3.0)
    open3d.io.write_point_cloud(files["out"] + ".ply", cloud)
    return [len(cloud.points)]
