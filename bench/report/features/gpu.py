"""Radii on the graphics card and on the processor."""
from report.features import by_neighbours, radii
from report.lab import Command

TITLE = "Radii on the graphics card and on the processor"
WHAT = ("The radii of the chapter above by compute shaders. The error is that of radii. Seconds are those of the processor; where OpenGL is drawn by the processor, as the machine's line says, "
        "the card's work is in them, and a curve of a card has to be measured on one: [neighbours/gpu.md](neighbours/gpu.md) has that of an H100.")
ERROR = radii.ERROR
EXACT = "GpuRadii.NeighboursAreThoseThatDoublesGive"
FLOOR = radii.FLOOR


def measure(lab):
    rows = []
    for place in lab.places:
        scene = lab.scene(place)
        sample = by_neighbours.Sample(lab, scene, radii.K)
        true, result = sample.distances[:, -1], lab.work / "computed.pct"
        common = ["pcmlab", "radii", scene.tree, "-k", radii.K, "-o", result, "--overwrite", "--json", "-q"]
        read = by_neighbours.column_reader(lab, scene, result, ["radius"])
        programs = [Command(lab, common, "processor", default=True, read=read), Command(lab, [*common, "--device", "gpu"], "graphics", read=read)]
        rows += lab.take_turns(place, programs, lambda found, _: {"error": by_neighbours.p95(100 * abs(found[sample.points] - true) / true)}, repeat=1)
    return rows


def absent(lab):
    return ["a graphics card"] if "llvmpipe" in lab.gl() or lab.gl().startswith("no") else []
