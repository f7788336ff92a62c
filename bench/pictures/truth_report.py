"""report.md and composites of truth.py."""
import numpy as np
from PIL import Image, ImageDraw

import metrics
import views

LARGEST = 300_000  # bytes of a composite
COLUMNS = {"flip": ("FLIP", "{:.4f}"), "ssim": ("SSIM", "{:.3f}"), "psnr": ("PSNR, dB", "{:.1f}"), "holes": ("holes, %", "{:.3f}", 100), "spill": ("spill, px", "{:.2f}"),
           "covered": ("covered, %", "{:.1f}", 100), "turn": ("turn", "{:.2f}"), "swim": ("swim", "{:.2f}"), "jolt": ("moving → rest, %", "{:.1f}", 100), "cpu_ms": ("CPU, ms", "{:.0f}"),
           "points": ("points", "{:,}")}
MEANING = """*Holes*: share of the pixels inside surfaces that show another thing, or nothing. *Spill*: pixels near outlines that show another thing than they should, for each pixel of outline: how
far things stand out beyond their edges, or are bitten into. *Covered*: share of the pixels where anything is drawn. *Turn*: how much a channel (0 to 255) changes within surfaces when the resting
camera turns by 0.4 px, in the mean, which is much for the truth too where it is finely textured; *swim*: how much it differs from the resting picture turned as a picture. *Moving → rest*: of the pixels that the picture on arrival or the resting one covers, those of which a channel
changes by more than 24. *CPU*: of all threads, of a frame while the camera arrives, or of all frames from arrival to the complete picture, caches warm; of peers, of one frame out of buffers in video memory. What no
scanner saw is left out. No eye-dome lighting; a frame has at most {moving:,} points, whatever the time that it takes; all else is as the library has it by default.

- *default*: a tree as `pcmlab build` makes it. *discs*: after `pcmlab normals --radii`, `--splats perspective`.
- *Potree's rule, re-made*: squares as large as the published source of Potree 1.8 makes adaptive points (`peers/potree_sizes.h`), all nodes shown; not the program itself.
- *CloudCompare-like*: squares of a constant size, of 1, 2, 3 and 5 px that with the least FLIP in the view, which its user would have to find."""


def fit(columns, row):
    cells = []
    for name, (_, text, *factor) in columns.items():
        value = row.get(name)
        cells.append("" if value is None else text.format(value * factor[0] if factor else value))
    return cells


def table(header, rows, text_columns):
    return ["| " + " | ".join(header) + " |", "|" + "---|" * text_columns + "---:|" * (len(header) - text_columns), *("| " + " | ".join(row) + " |" for row in rows), ""]


def find(rows, view, method, state):
    for row in rows:
        if row["view"] == view and row["method"].startswith(method) and row["state"] == state:
            return row
    return {}


def summary(result):
    """FLIP of the resting pictures and of the peers, and what the truth has."""
    rows = []
    for truth in result["truths"]:
        view = truth["view"]
        ours, discs, potree, constant = (find(result["rows"], view, *of) for of in
                                         (("default", "rest"), ("discs", "rest"), (views.POTREE, "both"), (views.CONSTANT, "both")))
        flips = [row["flip"] for row in (ours, discs, potree, constant)]
        best = min(flips)
        rows.append([view, *(f"**{flip:.4f}**" if flip == best else f"{flip:.4f}" for flip in flips), *(f"{flip / potree['flip']:.2f}" for flip in flips[:2]),
                     " / ".join(f"{100 * row['covered']:.0f}" for row in (truth, ours, discs, potree, constant)),
                     " / ".join(f"{row['swim']:.2f}" for row in (truth, ours, discs, potree, constant))])
    return table(["view", "default", "discs", "Potree's rule", "CloudCompare-like", "default / Potree's", "discs / Potree's", "covered: truth / default / discs / Potree's / constant, %",
                  "swim: the same five"], rows, 1)


def changes(before, result):
    """Ours as it was and as it is: of each figure the old value and the new one, where both runs have the same clouds and pictures."""
    if any(before[name] != result[name] for name in ("points", "moving_points", "size")):
        raise ValueError("the figures to compare with are of other clouds or pictures: choose a run with the same --points")
    shown = {name: COLUMNS[name] for name in ("flip", "holes", "spill", "covered", "turn", "swim", "jolt", "cpu_ms")}
    rows = []
    for row in result["rows"]:
        old = find(before["rows"], row["view"], row["method"], row["state"])
        if old and row["state"] != "both":
            rows.append([row["view"], row["method"], row["state"], *(" → ".join(pair) if any(pair) else "" for pair in zip(fit(shown, old), fit(shown, row)))])
    return ["## Before and now", "", *table(["view", "method", "state", *(what[0] for what in shown.values())], rows, 3)]


def write(out, result, before=None):
    lines = ["# Pictures against truth", "", f"`bench/pictures/truth.py`: clouds of about {result['points']:,} points, pictures of {result['size']} pixels.", ""]
    if result["truths"]:
        lines += ["FLIP against truth of the complete pictures, the least in bold:", "", *summary(result)]
    lines += [MEANING.format(moving=result["moving_points"]), ""]
    if before:
        lines += changes(before, result)
    notes = out / "findings.md"
    if notes.exists():
        lines += [notes.read_text(encoding="utf-8").strip(), ""]
    scenes = {truth["view"]: truth for truth in result["truths"]}
    for view in dict.fromkeys(row["view"] for row in result["rows"]):
        lines += [f"## {view}", ""]
        of_view = {name: what for name, what in COLUMNS.items() if any(name in row for row in result["rows"] if row["view"] == view)}
        rows = [[row["method"], row["state"], *fit(of_view, row)] for row in result["rows"] if row["view"] == view]
        if view in scenes:
            rows.insert(0, ["truth", "", *fit(of_view, scenes[view])])
            lines += [f"{100 * scenes[view]['asked']:.0f} % of the pixels show what a scanner saw.", ""]
        lines += [f"![{view}]({view}.png)", ""]
        lines += table(["method", "state", *(what[0] for what in of_view.values())], rows, 2)
    lines += ["```", result["machine"], "```"]
    (out / "report.md").write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")


def composite(file, pictures):
    """Panels of the pictures' middles, pixel by pixel, as large as a file of LARGEST bytes allows."""
    height, width = next(iter(pictures.values())).shape[:2]
    for share in (1, 0.8, 0.65, 0.5, 0.4, 0.3, 0.2):
        w, h = int(share * width), int(share * height)
        x, y = (width - w) // 2, (height - h) // 2
        across = min(4, len(pictures))
        sheet = Image.new("RGB", (across * (w + 4), -(-len(pictures) // across) * (h + 18)), "white")
        draw = ImageDraw.Draw(sheet)
        for i, (name, picture) in enumerate(pictures.items()):
            at = (i % across * (w + 4), i // across * (h + 18))
            sheet.paste(Image.fromarray((255 * metrics.on_black(picture[y:y + h, x:x + w]) + 0.5).astype(np.uint8)), (at[0], at[1] + 14))
            draw.text((at[0] + 2, at[1] + 1), name, fill="black")
        sheet.quantize(128, dither=Image.Dither.NONE).save(file, optimize=True)
        if file.stat().st_size <= LARGEST:
            return
