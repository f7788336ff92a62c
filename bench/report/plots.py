"""Curves of error over processor time, drawn by Matplotlib."""
import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot, ticker  # noqa: E402

from report import curves  # noqa: E402

OURS = ["#d62728", "#ff7f0e", "#8c564b", "#e377c2"]
PEERS = ["#1f77b4", "#2ca02c", "#9467bd", "#17becf", "#7f7f7f", "#bcbd22"]


def colours(rows):
    """Program -> colour: warm ones are ours."""
    names = list(dict.fromkeys(row["program"] for row in rows))
    mine = [name for name in names if name.startswith("pcmlab")]
    peers = [name for name in names if name not in mine]
    return {**{name: OURS[i % len(OURS)] for i, name in enumerate(mine)}, **{name: PEERS[i % len(PEERS)] for i, name in enumerate(peers)}}


def front(rows):
    """The rows, by time, that no faster one is as good as: what a curve joins."""
    least, found = float("inf"), []
    for row in sorted(rows, key=lambda row: (row["cpu"], row["error"])):
        if row["error"] < least:
            least = row["error"]
            found.append(row)
    return found


def set_ticks(axis, values):
    """Plain numbers, a few: 1, 2 and 5 of a decade, or those of a linear axis where values are near each other."""
    span = max(values) / min(values)
    axis.set_major_locator(ticker.MaxNLocator(4) if span < 4 else ticker.LogLocator(subs=(1, 2, 5) if span < 50 else (1,), numticks=6))
    axis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(ticker.NullFormatter())


def draw_curve(axes, rows, label, title, small=False):
    """One panel. A line joins the settings of a program that none of its faster ones is as good as. An error of 0 lies on the dotted line at the bottom; the default has a ring."""
    errors = [row["error"] for row in rows if row["error"] > 0]
    floor = min(errors) / 4 if errors else 1e-3
    of_program = colours(rows)
    for program, colour in of_program.items():
        mine = [row for row in rows if row["program"] == program]
        best = front(mine)
        axes.plot([row["cpu"] for row in best], [row["error"] or floor for row in best], color=colour, linewidth=1)
        axes.plot([row["cpu"] for row in mine], [row["error"] or floor for row in mine], "o" if program.startswith("pcmlab") else "x", color=colour, markersize=4 if small else 5, label=program)
        for row in mine:
            at = (row["cpu"], row["error"] or floor)
            if row["default"]:
                axes.plot(*at, "o", markersize=11, markerfacecolor="none", markeredgecolor="black")
            if not small and row["setting"] and (row in best or row["default"]):
                axes.annotate(row["setting"], at, fontsize=6, xytext=(4, 3), textcoords="offset points", color=colour)
    if len(errors) < len(rows):
        axes.axhline(floor, linestyle=":", linewidth=0.8, color="grey")
        axes.annotate("error 0", (0.99, floor), xycoords=("axes fraction", "data"), fontsize=6, ha="right", va="bottom", color="grey")
    axes.set(xscale="log", yscale="log", xlabel="CPU, s")
    axes.set_ylabel(label, fontsize=8)
    axes.set_title(title, fontsize=9)
    axes.margins(0.16, 0.12)
    set_ticks(axes.xaxis, [row["cpu"] for row in rows])
    set_ticks(axes.yaxis, [row["error"] or floor for row in rows])
    axes.grid(True, which="major", alpha=0.3)
    axes.tick_params(labelsize=7)
    axes.legend(fontsize=6)


def save(figure, file):
    figure.tight_layout()
    figure.savefig(file, dpi=80, metadata={"Software": None})
    pyplot.close(figure)


def feature(file, rows, label):
    """All curves of a feature, side by side, at most three in a row."""
    found = list(curves.curves(rows).items())
    across = min(3, len(found)) if len(found) != 4 else 2
    down = -(-len(found) // across)
    figure, panels = pyplot.subplots(down, across, figsize=(4.6 * across, 3.5 * down), squeeze=False)
    for panel in panels.ravel()[len(found):]:
        panel.set_axis_off()
    for panel, ((place, curve), of_curve) in zip(panels.ravel(), found):
        draw_curve(panel, of_curve, label, ", ".join(part for part in (curve, place) if part))
    save(figure, file)


def overview(file, chosen):
    """`chosen`: (title, label, rows of one curve) of each panel."""
    across = min(3, len(chosen))
    down = -(-len(chosen) // across)
    figure, panels = pyplot.subplots(down, across, figsize=(3.9 * across, 2.9 * down), squeeze=False)
    for panel in panels.ravel()[len(chosen):]:
        panel.set_axis_off()
    for panel, (title, label, rows) in zip(panels.ravel(), chosen):
        draw_curve(panel, rows, label, title, small=True)
    save(figure, file)
