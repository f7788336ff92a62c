"""Clouds of extreme shape and size: every position comes back bit for bit, and questions have the answer of brute force; or the
cloud is refused, and says why."""

import csv
import math
import shutil
import struct

from trial import Trial, good, pcmlab

POINTS = 5000
# What may be refused: coordinates that no grid can hold beside the others, and sizes whose squares are no doubles.
REFUSABLE = ("box of 2^-1060", "box of 2^-1000", "box of 2^-600", "box of 2^-500", "box of 2^600", "box of 2^1000", "box of 2^1020",
             "denormals", "no data")


def clouds(chance):
    """Name -> rows of doubles."""
    gauss, uniform = chance.gauss, chance.uniform
    box = lambda size, at: [[a + uniform(-size, size) for a in at] for _ in range(POINTS)]
    shapes = {f"box of 2^{k}": box(2.0 ** k, (0, 0, 0)) for k in
              (-1060, -1000, -600, -500, -400, -150, -126, -60, -30, -10, 0, 10, 30, 60, 120, 126, 150, 400, 500, 600, 1000, 1020)}
    shapes.update({
        "one place": [[1.5, -2.25, 1e6]] * POINTS,
        "two places": [[0.0, 0.0, 0.0] if i % 2 else [1e9, 1e-9, 1.0] for i in range(POINTS)],
        "a line along x": [[uniform(0, 1e7), 3.0, 4.0] for _ in range(POINTS)],
        "a plane": [[uniform(0, 1000), uniform(0, 1000), 7.125] for _ in range(POINTS)],
        "map coordinates": box(50.0, (3.5e6, 5.8e6, 300.0)),
        "map coordinates, nanometres": [[3.5e6 + i * 1e-9, 5.8e6, 0.0] for i in range(POINTS)],
        "far from the origin": box(1.0, (1e15, -1e15, 1e12)),
        "unlike axes": [[uniform(0, 1e-6), uniform(0, 1.0), uniform(0, 1e9)] for _ in range(POINTS)],
        "dense and sparse": [[gauss(0, 10.0 ** chance.randrange(-9, 6)) for _ in range(3)] for _ in range(POINTS)],
        "one far point": box(1.0, (0, 0, 0)) + [[1e12, 0.0, 0.0]],
        "one value of no data": box(1.0, (500, 600, 7)) + [[3.4e38, 600.0, 7.0]],
        "zeros of both signs": [[0.0, -0.0, uniform(-1, 1)] for _ in range(POINTS)],
        "denormals": [[chance.randrange(1, 1000) * 5e-324 for _ in range(3)] for _ in range(POINTS)],
    })
    return shapes


def write_ply(path, rows, kind):
    """float or double positions, binary; returns the rows as they are stored."""
    code = "<3f" if kind == "float" else "<3d"
    with open(path, "wb") as file:
        file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {len(rows)}\n".encode())
        file.write("".join(f"property {kind} {axis}\n" for axis in "xyz").encode() + b"end_header\n")
        data = [struct.pack(code, *row) for row in rows]
        file.write(b"".join(data))
    return [struct.unpack(code, row) for row in data]


def fits(rows):
    return all(abs(value) < 3e38 for row in rows for value in row)


def read_csv(path):
    with open(path, newline="") as file:
        return [tuple(float(value) for value in row[:3]) for row in list(csv.reader(file))[1:]]


def questions(rows, chance, count):
    """Boxes around two points each, and places to find the nearest points of."""
    for _ in range(count):
        a, b = chance.choice(rows), chance.choice(rows)
        yield "box", [min(p) for p in zip(a, b)] + [max(p) for p in zip(a, b)]
        yield "nearest", list(chance.choice(rows))


def distance(a, b):
    """Without overflow or underflow on the way."""
    unit = max(abs(x - y) for x, y in zip(a, b))
    return unit * math.hypot(*((x - y) / unit for x, y in zip(a, b))) if unit and math.isfinite(unit) else unit


def ask(trial, tree, rows, name):
    for kind, numbers in questions(rows, trial.chance, 12):
        trial.counts["questions"] += 1
        text = [repr(number) for number in numbers]
        if kind == "box":
            result = pcmlab("query", tree, "--box", *text, "--json")
            expected = sum(all(numbers[a] <= row[a] <= numbers[a + 3] for a in range(3)) for row in rows)
            found = result.json()["points"] if result.code == 0 else result
            trial.expect(found == expected, f"{name}: box {text}: {found}, not {expected}")
        else:
            result = pcmlab("query", tree, "--nearest", *text, "-k", 4, "--json")
            expected = sorted(distance(numbers, row) for row in rows)[:4]
            found = [near["distance"] for near in result.json()["neighbours"]] if result.code == 0 else result
            close = result.code == 0 and len(found) == 4 and all(
                a == b or (a is not None and abs(a - b) <= 1e-12 * max(a, b)) for a, b in zip(found, expected))
            trial.expect(close, f"{name}: nearest {text}: {found}, not {expected}")


def run(folder, rounds, seconds, seed):
    trial = Trial("extremes", rounds, seconds, seed)
    shapes = clouds(trial.chance)
    cases = [(name, kind) for name in shapes for kind in ("double", "float") if kind == "double" or fits(shapes[name])]
    for number in trial:
        if number >= len(cases):
            break
        name, kind = cases[number]
        shutil.rmtree(folder / "cloud.pct", ignore_errors=True)
        rows = write_ply(folder / "cloud.ply", shapes[name], kind)
        name = f"{name}, {kind}"
        built = pcmlab("build", folder / "cloud.ply", "-o", folder / "cloud.pct", "--chunk-points", 1000, "--json")
        if built.code != 0:
            trial.counts["refused"] += 1
            print(f"  refused: {name}: {built.err.strip()}", flush=True)
            trial.expect(any(part in name for part in REFUSABLE), f"{name} is refused")
            trial.expect(built.code == 1 and not (folder / "cloud.pct").exists(), f"{name}: {built}")
            continue
        verified = pcmlab("verify", folder / "cloud.pct")
        if not trial.expect(verified.code == 0, f"{name}: {verified.out} {verified.err}"):
            continue
        error = built.json()["position_error"]
        good("convert", folder / "cloud.pct", folder / "cloud.csv", "--overwrite")
        back = read_csv(folder / "cloud.csv")
        exact = sorted(back) == sorted(rows)
        if error == 0:
            trial.expect(exact, f"{name}: positions differ, and no error is reported")
        else:
            trial.counts["rounded, and said so"] += 1
            extent = max(max(column) - min(column) for column in zip(*rows))
            trial.expect(error <= 1e-6 * extent, f"{name}: error {error} of extent {extent}")
        ask(trial, folder / "cloud.pct", back, name)
    return trial.report("extreme clouds")
