"""Reports with figures of their own: longer runs, other machines, and what no curve shows."""
import pathlib

RESULTS = pathlib.Path(__file__).resolve().parents[1] / "results"
# File below bench/results -> what it is about.
CHAPTERS = {
    "stiff.md": "what is stiff and extreme: every operation on 74 clouds, cameras, matrices and pairs, right or refused",
    "neighbours/report.md": "normals, radii and outliers beside PCL, CGAL, Open3D and MeshLab",
    "neighbours/all_knn.md": "neighbours of all points in memory beside FLANN, nanoflann and PCL",
    "neighbours/gpu.md": "radii by compute shaders on a card",
    "fitting/report.md": "fits beside PCL and CGAL: estimators, samples, outliers, noise, thin arcs",
    "fitting/tuning.md": "curves of tuned numbers",
    "detection.md": "detection on generated sites of 1 to 60 M points, beside CGAL and PCL",
    "picking.md": "picks beside a look at every point, and how long a window waits",
    "pictures/truth/report.md": "pictures against ray-traced truth, and beside what other viewers make of the points",
    "pictures/report.md": "pictures over the time of a frame",
    "pictures/gpu.md": "what a card draws in a frame",
    "report.md": "the caches: sizes, policies and containers, from cold storage and warm",
}


def lines():
    return [f"[{file}]({file}): {what}" for file, what in CHAPTERS.items() if (RESULTS / file).exists()]
