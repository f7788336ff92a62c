#!/usr/bin/env python3
"""Trees of all LAS and LAZ samples, asked by the Python module, against the masks of laspy's arrays: the same points with
the same values, bit for bit, for a box, a class and a level.

    python_module.py --dump DUMP_CLOUD --data FOLDER --module FOLDER [--python PYTHON]
"""
import sys
import tempfile
import time

import check


def rows(np, xyz, values):
    """Each point as bytes, sorted: the same for the same points in any order."""
    if not len(xyz):
        return np.zeros(0, "S1")
    parts = [np.ascontiguousarray(part).reshape(len(xyz), -1).view("u1") for part in (xyz, *values)]
    together = np.ascontiguousarray(np.concatenate(parts, axis=1))
    return np.sort(together.view(f"V{together.shape[1]}").ravel().view(f"S{together.shape[1]}"))


def differences(np, pcmlab, path, theirs, folder):
    pcmlab.build([path], output=folder / "cloud.pct", overwrite=True)
    cloud = pcmlab.open(folder / "cloud.pct")
    names = sorted(set(theirs.attributes) & {a.name for a in cloud.attributes})
    xyz = theirs.positions
    values = [theirs.attributes[name].values for name in names]

    def compare(question, mask, **query):
        found = cloud.query(attributes=names, **query)
        chunks = list(cloud.chunks(attributes=names, **query))
        expected = rows(np, xyz[mask], [v[mask] for v in values])
        ours = rows(np, found["xyz"], [found[name] for name in names])
        wrong = [] if np.array_equal(ours, expected) else [f"{question}: {len(ours)} points, laspy has {len(expected)}, or other values"]
        if sum(len(chunk["xyz"]) for chunk in chunks) != len(ours):
            wrong.append(f"{question}: chunks have other points")
        return wrong

    found = compare("all", np.ones(len(xyz), bool))
    if not len(xyz):
        return names, found
    low, high = np.quantile(xyz, [0.2, 0.7], axis=0)
    found += compare("box", ((xyz >= low) & (xyz <= high)).all(1), box=(low, high))
    if "classification" in names:
        classes = theirs.attributes["classification"].values[:, 0]
        some = int(np.bincount(classes.astype(int)).argmax())
        found += compare(f"class {some}", classes == some, where=f"classification={some}")
    level = cloud.query(level=0, attributes=names)
    whole, coarse = (np.unique(r, return_counts=True) for r in (rows(np, xyz, values),
                                                               rows(np, level["xyz"], [level[n] for n in names])))
    at = np.searchsorted(whole[0], coarse[0])
    if len(level["xyz"]) != cloud.levels[0].points or (whole[0][np.minimum(at, len(whole[0]) - 1)] != coarse[0]).any() or \
            (whole[1][np.minimum(at, len(whole[1]) - 1)] < coarse[1]).any():
        found.append("level 0 is no part of the cloud")
    return names, found


def main():
    arguments = check.common_arguments(__doc__, lambda parser: parser.add_argument("--module", required=True))
    files = check.clouds_of(arguments.data, (".las", ".laz"))
    if not files:
        check.skip(f"no LAS or LAZ in {arguments.data}")
    sys.path.insert(0, arguments.module)
    try:
        import numpy as np

        import las_by_laspy
        import pcmlab
    except ImportError as error:
        check.skip(f"{error}; packaging/test-python installs what the comparison needs")
    import pathlib

    failed = compared = 0
    for path in files:
        theirs = las_by_laspy.read(path)
        started = time.monotonic()
        with tempfile.TemporaryDirectory() as folder:
            names, found = differences(np, pcmlab, path, theirs, pathlib.Path(folder))
        failed += bool(found)
        compared += 1
        print(f"{str(path.relative_to(arguments.data)):<48} {len(theirs.positions):>9} {time.monotonic() - started:>7.2f} s "
              f"{len(names)} attributes: {'; '.join(found) or 'equal'}")
    print(f"{compared - failed} of {compared} clouds are equal")
    return 1 if failed or not compared else 0


if __name__ == "__main__":
    sys.exit(main())
