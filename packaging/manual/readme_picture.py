#!/usr/bin/env python3
"""Makes packaging/drawing.png for the README: points of a generated scan next to the DXF of four fitted shapes.

    readme_picture.py --bin BUILD/bin --out PNG     needs ezdxf, matplotlib, numpy and pillow (packaging/test-python has them)
"""
import argparse
import pathlib
import re
import subprocess
import tempfile

import ezdxf
import matplotlib
import numpy
from PIL import Image

matplotlib.use("Agg")
import matplotlib.pyplot as pyplot  # noqa: E402
from matplotlib.collections import PolyCollection  # noqa: E402

PAGE = pathlib.Path(__file__).resolve().parent / "pages" / "drawing.md"
VIEW = ["--eye", "500067", "4799990", "113", "--target", "500044", "4800016", "95.5"]
ANGLE = 40
LIGHT = numpy.array([0.3, -0.5, 0.81])
SIZE = (800, 560)
COLOURS = {"Tank": "#4f81bd", "Roof": "#c0504d", "Pipe": "#9bbb59", "Dome": "#8064a2"}


def draw(drawing, picture):
    """The faces of a DXF as the camera of the scan sees them, coloured by layer, the farther ones first."""
    eye, target = (numpy.array(VIEW[at:at + 3], dtype=float) for at in (1, 5))
    forward = (target - eye) / numpy.linalg.norm(target - eye)
    right = numpy.cross(forward, [0, 0, 1])
    right /= numpy.linalg.norm(right)
    up = numpy.cross(right, forward)
    pixels = SIZE[1] / 2 / numpy.tan(numpy.radians(ANGLE) / 2)
    faces = []
    for face in ezdxf.readfile(drawing).modelspace().query("3DFACE"):
        corners = numpy.array([list(corner) for corner in face.wcs_vertices()]) - eye
        normal = numpy.cross(corners[1] - corners[0], corners[2] - corners[0])
        shade = 0.4 + 0.6 * abs(normal @ LIGHT) / max(numpy.linalg.norm(normal), 1e-12)
        depth = corners @ forward
        plan = pixels * numpy.column_stack([corners @ right, corners @ up]) / depth[:, None]
        nearer = 5 * (face.dxf.layer == "Roof")  # it lies on the tank's end
        faces.append((depth.mean() - nearer, plan, numpy.array(matplotlib.colors.to_rgb(COLOURS[face.dxf.layer])) * shade))
    faces.sort(key=lambda face: -face[0])
    figure = pyplot.figure(figsize=(SIZE[0] / 100, SIZE[1] / 100), dpi=100)
    axes = figure.add_axes([0, 0, 1, 1])
    axes.add_collection(PolyCollection([face[1] for face in faces], facecolors=[face[2] for face in faces], edgecolors="#00000040", linewidths=0.4))
    axes.set_xlim(-SIZE[0] / 2, SIZE[0] / 2)
    axes.set_ylim(-SIZE[1] / 2, SIZE[1] / 2)
    axes.set_axis_off()
    figure.savefig(picture, transparent=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True, type=pathlib.Path)
    parser.add_argument("--out", required=True, type=pathlib.Path)
    arguments = parser.parse_args()
    lines = re.findall(r"^pcmlab (.+)$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    with tempfile.TemporaryDirectory() as folder:
        for line in lines:
            if line.split()[0] in ("generate", "build", "fit", "primitives"):
                subprocess.run([arguments.bin.resolve() / "pcmlab", *line.split()], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        scan, drawn = pathlib.Path(folder) / "scan.png", pathlib.Path(folder) / "drawn.png"
        subprocess.run([arguments.bin.resolve() / "pcmlab", "render", "plant.pct", "-o", scan, "--size", f"{SIZE[0]}x{SIZE[1]}", "--background", "white", "--angle", str(ANGLE),
                        *VIEW],
                       cwd=folder, check=True, stdout=subprocess.DEVNULL)
        draw(pathlib.Path(folder) / "plant.dxf", drawn)
        both = Image.new("RGB", (2 * SIZE[0], SIZE[1]), "white")
        points, faces = Image.open(scan).convert("RGB"), Image.open(drawn).convert("RGBA")
        both.paste(points, (0, 0))
        both.paste(Image.blend(points, Image.new("RGB", SIZE, "white"), 0.8), (SIZE[0], 0))
        both.paste(faces, (SIZE[0], 0), faces)
        both.quantize(200).save(arguments.out, optimize=True)


if __name__ == "__main__":
    main()
