"""One function for each claim that an operation makes of its error: asks it, and holds the printed error against the true one.

Each yields rows (operation, kind, claimed, true, unit). The oracles are brute force over the points and know nothing of trees.
"""
import numpy

BLOCK = 1 << 22  # distances at a time


def nearest(of, among):
    """The distance of each point to the nearest of others."""
    found = numpy.empty(len(of))
    rows = max(1, BLOCK // max(1, len(among)))
    for start in range(0, len(of), rows):
        part = of[start:start + rows]
        squares = sum((part[:, a, None] - among[None, :, a]) ** 2 for a in range(3))
        found[start:start + rows] = numpy.sqrt(squares.min(axis=1))
    return found


def row(name, answer, true):
    return name, answer["error_kind"], answer["error"], float(true), answer["error_unit"]


def level(stage):
    for number in range(stage.levels - 1):
        answer = stage.ask("convert", stage.tree, "level.ply", "--level", number, "--overwrite")
        yield row("convert --level", answer, nearest(stage.xyz, stage.columns("level.ply")["xyz"]).max())


def fast_level(stage):
    answer = stage.ask("build", stage.source, "-o", "fast.pct", "--fast", "--chunk-points", 1000)
    for number in range(answer["levels"] - 1):
        answer = stage.ask("convert", "fast.pct", "level.ply", "--level", number, "--overwrite")
        yield row("convert --level, after build --fast", answer, nearest(stage.xyz, stage.columns("level.ply")["xyz"]).max())


def places(stage, count):
    picked = stage.xyz[stage.chance.integers(0, len(stage.xyz), count)]
    return picked + stage.extent * 0.05 * stage.chance.normal(size=(count, 3))


def nearest_point(stage):
    for number, place in enumerate(places(stage, 4)):
        answer = stage.ask("query", stage.tree, "--nearest", *place, "--level", number % max(1, stage.levels - 1))
        yield row("query --nearest --level", answer, answer["neighbours"][0]["distance"] - nearest(place[None], stage.xyz)[0])


def estimate(stage):
    for place in places(stage, 4):
        half = stage.extent * stage.chance.uniform(0.02, 0.3)
        answer = stage.ask("query", stage.tree, "--estimate", "--sphere", *place, half)
        inside = (nearest(stage.xyz, place[None]) <= half).sum()
        yield row("query --estimate", answer, abs(answer["points_expected"] - inside))


def about_z(angle):
    return numpy.array([[numpy.cos(angle), -numpy.sin(angle), 0], [numpy.sin(angle), numpy.cos(angle), 0], [0, 0, 1]])


def grid(stage):
    answer = stage.ask("convert", stage.source, "grid.las", "--grid", stage.extent / 2000, "--overwrite")
    yield row("convert --grid", answer, numpy.abs(stage.columns("grid.las")["xyz"] - stage.source_xyz).max())


def moved(stage):
    angle, pivot, shift = numpy.radians(30), stage.xyz.mean(axis=0), numpy.array([3.0, -2, 0.5])
    answer = stage.ask("transform", stage.tree, "-o", "moved.pct", "--rotate", 0, 0, 1, 30, "--pivot", *pivot, "--translate", *shift,
                       "--overwrite")
    turn = about_z(angle)
    found = stage.columns("moved.pct")
    where = numpy.empty_like(stage.source_xyz)
    where[found["number"].astype(int)] = found["xyz"]
    wanted = (stage.source_xyz - pivot) @ turn.T + pivot + shift
    yield row("transform", answer, max(0, numpy.abs(where - wanted).max() - 8 * numpy.spacing(numpy.abs(wanted).max())))


def thinned(stage):
    for part in (15, 60):
        asked = stage.extent / part
        answer = stage.ask("subsample", stage.tree, "--spacing", asked, "--nearest-level", "-o", "thin.pct", "--overwrite")
        yield row("subsample --nearest-level", answer, max(0, nearest(stage.xyz, stage.columns("thin.pct")["xyz"]).max() - asked))


def volume(stage):
    if not stage.cloud.surface:
        return
    cloud, side = stage.cloud, 400
    for _ in range(8):
        low, high, height = stage.chance.uniform([0.02, 0.6, -0.1], [0.4, 0.98, 0.15])
        middles = low + (numpy.arange(side) + 0.5) * (high - low) / side
        x, y = numpy.meshgrid(middles, middles)
        true = (cloud.surface(x, y) - height).mean() * (high - low) ** 2 * cloud.size ** 3
        corners = [value for a, b in ((low, low), (high, low), (high, high), (low, high))
                   for value in (numpy.array([a, b]) * cloud.size + cloud.origin[:2])]
        answer = stage.ask("volume", stage.tree, "--reference", height * cloud.size + cloud.origin[2], "--polygon", *corners)
        yield row("volume", answer, abs(answer["net"] - true))


def distance(stage):
    if not stage.cloud.surface or stage.cloud.noise > 0:
        return
    cloud = stage.cloud
    for _ in range(4):
        plan = stage.chance.uniform(0.05, 0.95, (2, 2))
        ends = numpy.column_stack([plan, cloud.surface(plan[:, 0], plan[:, 1])]) * cloud.size + cloud.origin
        answer = stage.ask("measure", "distance", "-p", *ends.ravel(), "--from", stage.tree)
        value = answer["measures"][-1]["values"]["distance"]["value"]
        yield row("measure --from", answer, abs(value - numpy.linalg.norm(ends[0] - ends[1])))


def fit(stage):
    shape = stage.cloud.shape
    if not shape:
        return
    for start in range(3):
        at = stage.xyz[stage.chance.integers(len(stage.xyz))]
        answer = stage.ask("fit", stage.tree, "--shape", shape["kind"], "--at", *at, "--seed", start + 1, codes=(0, 1))
        if answer["error_kind"] == "exact":
            continue  # refused
        off = numpy.array(answer["primitive"]["point"]) - shape["point"]
        if shape["kind"] == "plane":
            off = off @ shape["axis"]
        elif shape["kind"] == "cylinder":
            middle = stage.xyz.mean(axis=0)  # where the claim is made
            axis = numpy.array(answer["primitive"]["axis"])
            off = off + axis * ((middle - numpy.array(answer["primitive"]["point"])) @ axis)
            off = off - shape["axis"] * (off @ shape["axis"])
        yield row(f"fit --shape {shape['kind']}", answer, numpy.linalg.norm(off))


def align(stage):
    for number in (3, 6):
        sigma = stage.extent * 0.004
        true = stage.xyz[stage.chance.permutation(len(stage.xyz))[:number]]
        angle, pivot, shift = 0.2, stage.xyz.mean(axis=0), stage.extent * numpy.array([0.3, 0.1, -0.2])
        turn = about_z(angle)
        fixed = (true - pivot) @ turn.T + pivot + shift + sigma * stage.chance.normal(size=true.shape)
        moving = true + sigma * stage.chance.normal(size=true.shape)
        pairs = [value for pair in zip(moving, fixed) for point in pair for value in point]
        answer = stage.ask("align", stage.tree, "--pick-error", sigma, "--pair", *pairs, codes=(0, 1))
        if "matrix" not in answer:
            continue  # refused: the pairs lie on a line
        low, high = stage.xyz.min(axis=0), stage.xyz.max(axis=0)
        corners = numpy.array([[(low, high)[i >> a & 1][a] for a in range(3)] for i in range(8)])
        matrix = numpy.array(answer["matrix"])
        off = corners @ matrix[:, :3].T + matrix[:, 3] - ((corners - pivot) @ turn.T + pivot + shift)
        yield row("align", answer, numpy.linalg.norm(off, axis=1).max())


def detect(stage):
    if not stage.cloud.shape:
        return
    answer = stage.ask("detect", stage.tree, "--label", "shape", "-o", "labelled.pct", "--overwrite")
    found = stage.columns("labelled.pct")
    most = 0.0
    for primitive in answer["primitives"]:
        xyz = found["xyz"][found["shape"] == primitive["label"]] - numpy.array(primitive["point"])
        if primitive["kind"] == "sphere":
            off = numpy.linalg.norm(xyz, axis=1) - primitive["radius"]
        elif primitive["kind"] == "plane":
            off = xyz @ numpy.array(primitive["axis"])
        else:
            off = numpy.linalg.norm(numpy.cross(xyz, numpy.array(primitive["axis"])), axis=1) - primitive["radius"]
        most = max(most, float(numpy.abs(off).max(initial=0)))
    yield row("detect", answer, max(0, most - 8 * stage.last_bit))


ALL = (level, fast_level, nearest_point, estimate, grid, moved, thinned, volume, distance, fit, align, detect)
