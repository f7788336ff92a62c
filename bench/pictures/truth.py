#!/usr/bin/env python3
"""Closed surfaces: how much of a generated scene can be seen through, and how far splats stand out, per splat mode.

    truth.py --bin BUILD/bin --out FOLDER [--points N] [--python FILE]

The generated scene is sampled twice, with N points and with ten times as many. Points are coloured by the surface that they lie on, so a picture says which
surface each pixel shows; the picture of the dense sample is the truth. For each view and mode, moving (as much as one frame of 33 ms shows) and at rest:
- see-through: of the pixels inside a surface (farther than a splat from where another one is seen), those that show something else, in percent;
- uncovered: of the pixels that the truth covers, those where nothing is drawn, in percent;
- spill: how far the surfaces stand out at their edges: pixels outside of what the truth covers, as a width along its outline, in pixels, beside the half
  of a splat's side;
- FLIP of the true colours.
Prints a table and writes it to FOLDER/truth.md. Needs the packages of requirements.txt.
"""
import argparse
import json
import pathlib
import sys

import run  # starts anew with --python; skips without the packages

import numpy as np
from scipy.ndimage import binary_dilation, distance_transform_edt

import metrics
import splats
from study import call

SIZE = (998, 714)
EXTENT = 60
# Eye and target relative to the scene's corner (500000, 4800000, 0), and the side of the surface's splats is taken from the picture.
VIEWS = {
    "scene": ((68.86, -20.70, 129.80), (28, 28, 96)),
    "wall 7 m": ((25.58, 11.45, 97.07), (19.70, 15.20, 96.46)),
    "wall 2 m": ((21.41, 16.20, 96.74), (19.70, 15.20, 96.46)),
    "floor 13 m": ((30.0, 30.0, 103.0), (36.0, 36.0, 93.5)),
    "roof 2 m": ((15.0, 9.0, 103.0), (13.5, 11.5, 101.5)),
}
MODES = {"constant": ("plain", "constant"), "adaptive": ("plain", "adaptive"), "radius": ("splats", "adaptive"), "discs": ("splats", "perspective")}


def labelled(points):
    """Colours that are far apart, one for each surface."""
    label = points["point_source_id"].astype(np.uint32)
    mixed = (label + 1) * np.uint32(2654435761)
    for shift, name in ((24, "red"), (16, "green"), (8, "blue")):
        points[name] = ((mixed >> np.uint32(shift)) & np.uint32(255)).astype(points.dtype[name])
    return points


def make_trees(a, name, points):
    trees = {}
    work = a.out / "work"
    work.mkdir(parents=True, exist_ok=True)
    las, ply, other = work / f"{name}.las", work / f"{name}.ply", work / f"{name}-made.ply"
    wanted = ["plain", "splats"] if name == "sparse" else ["plain"]
    kinds = [(kind, labels) for kind in wanted for labels in (False, True)]
    for kind, labels in kinds:
        trees[kind, labels] = work / f"{name}-{kind}{'-labels' if labels else ''}.pct"
    if all((tree / "index.pct").exists() for tree in trees.values()):
        return trees
    call([a.bin / "pcmlab", "generate", "--overwrite", "-n", points, "--extent", EXTENT, "--no-truth", las, "-q"])
    call([a.bin / "pcmlab", "convert", "--overwrite", las, ply, "-q"])
    for kind, labels in kinds:
        source = ply
        if kind == "splats":
            splats.add_splats(ply, other)
            source = other
        if labels:
            made = labelled(splats.read(source).copy())
            source = work / f"{name}-labels.ply"
            splats.write(source, made)
        call([a.bin / "pcmlab", "build", "--overwrite", source, "-o", trees[kind, labels], "-q"])
    for file in work.glob("*.ply"):
        file.unlink()
    las.unlink()
    return trees


def picture(a, tree, view, mode, moving, name, *more):
    file = a.out / "pictures" / f"{name.replace(' ', '-')}.png"
    file.parent.mkdir(parents=True, exist_ok=True)
    corner = (500000, 4800000, 0)
    eye, target = ([str(c + v) for c, v in zip(corner, place)] for place in VIEWS[view])
    state = ["--until", "target", "--frame-budget", "33"] if moving else []
    call([a.bin / "pcmlab-render", tree, "-o", file, "--overwrite", "--size", "x".join(map(str, SIZE)), "--angle", 45, "--eye", *eye, "--target", *target,
          "--splats", mode, *state, *more])
    return metrics.read(file)


def figures(truth, truth_colours, labels, colours):
    covered, drawn = truth[:, :, 3] > 0, labels[:, :, 3] > 0
    edge = np.zeros(covered.shape, bool)
    for axis in (0, 1):
        differs = (np.diff(truth.astype(int), axis=axis) != 0).any(axis=2)
        where = [slice(None)] * 2
        where[axis] = slice(0, -1)
        edge[tuple(where)] |= differs
    inside = covered & (distance_transform_edt(~edge) > 12)
    other = (truth != labels).any(axis=2)
    outline = binary_dilation(covered) & ~covered
    return {"see-through": 100 * (other & inside).sum() / max(1, inside.sum()), "uncovered": 100 * (covered & ~drawn).sum() / max(1, covered.sum()),
            "spill": (drawn & ~covered).sum() / max(1, outline.sum()), "flip": metrics.flip(truth_colours, colours)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--points", type=lambda t: int(float(t)), default=2_000_000)
    parser.add_argument("--python", help="start with this interpreter")
    a = parser.parse_args()
    sparse, dense = make_trees(a, "sparse", a.points), make_trees(a, "dense", 10 * a.points)
    rows = ["| view | mode | | see-through, % | uncovered, % | spill, px | FLIP |", "|---|---|---|---:|---:|---:|---:|"]
    result = []
    for view in VIEWS:
        truth = picture(a, dense["plain", True], view, "adaptive", False, f"{view} truth", "--eye-dome", "0")
        truth_colours = picture(a, dense["plain", False], view, "adaptive", False, f"{view} truth colours", "--eye-dome", "0")
        for mode, (kind, splat) in MODES.items():
            for moving in (True, False):
                name = f"{view} {mode} {'moving' if moving else 'rest'}"
                labels = picture(a, sparse[kind, True], view, splat, moving, name, "--eye-dome", "0")
                colours = picture(a, sparse[kind, False], view, splat, moving, f"{name} colours", "--eye-dome", "0")
                f = figures(truth, truth_colours, labels, colours)
                result.append({"view": view, "mode": mode, "moving": moving, **f})
                rows.append(f"| {view} | {mode} | {'moving' if moving else 'at rest'} | {f['see-through']:.3f} | {f['uncovered']:.3f} | {f['spill']:.2f} | {f['flip']:.4f} |")
                print(rows[-1], flush=True)
    (a.out / "truth.md").write_text("\n".join(rows) + "\n")
    (a.out / "truth.json").write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    sys.exit(main())
