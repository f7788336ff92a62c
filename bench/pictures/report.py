"""Plots and report.md of what is in the table."""
import math

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter  # noqa: E402

import plan  # noqa: E402
from table import median  # noqa: E402

COLOURS = {"feedback": "#1b6ca8", "best first": "#3a8f4d", "root first": "#d1662c", "root first, filled": "#c9a227"}
MODE_COLOURS = ["#8d4fa3", "#1b6ca8", "#3a8f4d", "#d1662c", "#c9a227"]  # in turns
FIGURES = {"flip": "FLIP error", "ssim": "SSIM", "holes": "hole fraction", "spill": "spill fraction"}
BASELINE, OURS = "root first", "feedback"


def splat_modes(table):
    return table.values("mode", study="error")


def curve(table, figure, **where):
    """Medians over the repetitions, one a budget: frame time and figure, by rising time."""
    points = []
    for budget in table.values("budget", study="error", **where):
        times = table.series("frame_ms_median", study="error", budget=budget, **where)
        values = table.series(figure, study="error", budget=budget, **where)
        if times and values:
            points.append((median(times), median(values)))
    return sorted(points)


def at_time(points, ms):
    """The curve at a frame time, linear over its logarithm; nothing outside of what was measured."""
    times, values = np.array(points).T if points else (np.array([]), np.array([]))
    if len(times) < 2 or not times[0] <= ms <= times[-1]:
        return None
    return float(np.interp(math.log(ms), np.log(times), values))


def time_axis(ax):
    """Logarithmic, with plain numbers."""
    ax.set_xscale("log")
    ax.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    ax.xaxis.set_major_formatter(FuncFormatter(lambda ms, _: f"{ms:g}"))
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.grid(alpha=0.3)
    ax.tick_params(labelsize=7)


def draw_curves(table, out, cloud, path):
    shown = splat_modes(table)
    figure, axes = plt.subplots(len(FIGURES), len(shown), figsize=(3.4 * len(shown), 2.6 * len(FIGURES)), squeeze=False, sharex=True)
    for ax, mode in zip(axes[0], shown):
        ax.set_title(mode, fontsize=9)
    for row, (name, title) in zip(axes, FIGURES.items()):
        for ax, mode in zip(row, shown):
            for variant in plan.VARIANTS:
                points = curve(table, name, cloud=cloud, path=path, mode=mode, variant=variant)
                if points:
                    ax.plot(*zip(*points), marker="o", markersize=3, linewidth=1.2, color=COLOURS[variant], label=variant)
            time_axis(ax)
        row[0].set_ylabel(title, fontsize=8)
        low = min((ax.get_ylim()[0] for ax in row), default=0)
        high = max((ax.get_ylim()[1] for ax in row), default=1)
        for ax in row:
            ax.set_ylim(min(low, 0) if name != "ssim" else low, high)
    for ax in axes[-1]:
        ax.set_xlabel("median frame time, ms", fontsize=8)
    axes[0][0].legend(fontsize=7)
    figure.suptitle(f"{cloud}, {path}: error against frame time, each mode against its own full-resolution picture", fontsize=10)
    figure.tight_layout()
    file = f"error-{cloud}-{path}.png".replace(" ", "-")
    figure.savefig(out / file, dpi=80)
    plt.close(figure)
    return file


def draw_modes(table, out, clouds, all_paths):
    """All modes against the full-resolution picture of the perspective one."""
    figure, axes = plt.subplots(1, len(clouds) * len(all_paths), figsize=(4 * len(clouds) * len(all_paths), 3.2), squeeze=False)
    for ax, (cloud, path) in zip(axes[0], [(c, p) for c in clouds for p in all_paths]):
        for i, mode in enumerate(splat_modes(table)):
            points = curve(table, "flip_to_perspective", cloud=cloud, path=path, mode=mode, variant=OURS)
            if points:
                ax.plot(*zip(*points), marker="o", markersize=3, linewidth=1.2, color=MODE_COLOURS[i % len(MODE_COLOURS)], label=mode)
        time_axis(ax)
        ax.set_ylim(bottom=0)
        ax.set_title(f"{cloud}, {path}", fontsize=9)
        ax.set_xlabel("median frame time, ms", fontsize=8)
    axes[0][0].set_ylabel("FLIP to perspective, full resolution", fontsize=8)
    axes[0][0].legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(out / "modes.png", dpi=80)
    plt.close(figure)
    return "modes.png"


def number(value, digits=3):
    return "" if value is None or value == "" else f"{value:.{digits}g}" if isinstance(value, float) else f"{value:,}"


def rows_of(header, rows):
    return ["| " + " | ".join(header) + " |", "|" + "---|" * len(header), *("| " + " | ".join(row) + " |" for row in rows), ""]


def equal_time(table, clouds, all_paths):
    """Ours against the baseline, which is interpolated at our frame times."""
    rows, better = [], {name: [0, 0] for name in FIGURES}
    for cloud in clouds:
        for path in all_paths:
            for mode in splat_modes(table):
                base = {name: curve(table, name, cloud=cloud, path=path, mode=mode, variant=BASELINE) for name in FIGURES}
                ours = {name: dict(curve(table, name, cloud=cloud, path=path, mode=mode, variant=OURS)) for name in FIGURES}
                for ms in ours["flip"]:
                    other = {name: at_time(base[name], ms) for name in FIGURES}
                    if other["flip"] is None:
                        continue
                    for name, count in better.items():
                        count[1] += 1
                        count[0] += ours[name][ms] >= other[name] - 0.001 if name == "ssim" else ours[name][ms] <= other[name] + 0.001
                    rows.append([cloud, path, mode, number(ms), *(text for name in FIGURES for text in (number(ours[name][ms]), number(other[name])))])
    lines = ["## At equal frame time", "",
             f"*Ours* ({plan.VARIANTS[OURS]}) against the *baseline* ({plan.VARIANTS[BASELINE]}), whose curve is read at our frame times. Frame times that the baseline's",
             "budgets do not enclose are left out. *At least as good* allows 0.001, what repetitions of a picture differ by.", ""]
    if not rows:
        return lines + ["No frame times overlap.", ""]
    lines += [", ".join(f"{FIGURES[name]} at least as good in {count[0]} of {count[1]}" for name, count in better.items()) + ".", ""]
    return lines + rows_of(["cloud", "path", "mode", "ms", "FLIP, ours", "baseline", "SSIM, ours", "baseline", "holes, ours", "baseline", "spill, ours", "baseline"], rows)


def modes(table, clouds, all_paths):
    lines = ["## The modes", "",
             "How far the full-resolution picture of each mode is from that of the perspective mode, which the tests compare with a ray caster in double precision; and, with a",
             "fixed number of points, the largest budget: the time of a frame, and how far it is from the same picture.", ""]
    rows = []
    largest = max(table.values("budget", study="error", variant="best first"), default=None)
    for cloud in clouds:
        for path in all_paths:
            for mode in splat_modes(table):
                where = dict(study="error", cloud=cloud, path=path, mode=mode)
                last = dict(variant="best first", budget=largest)
                rows.append([cloud, path, mode, number(median(table.series("flip_of_mode", **where))), number(median(table.series("frame_ms_median", **where, **last))),
                             number(median(table.series("points_drawn", **where, **last))), number(median(table.series("flip_to_perspective", **where, **last))),
                             number(median(table.series("holes_to_perspective", **where, **last)))])
    return lines + rows_of(["cloud", "path", "mode", "FLIP at full resolution", f"ms, {largest:,} points", "points drawn", "FLIP", "holes"], rows)


def all_figures(table, clouds, all_paths):
    columns = ["flip", "ssim", "holes", "spill", "frame_ms_median", "frame_ms_p99", "points_drawn", "screen_error_px", "uploaded_mb_a_frame"]
    rows = []
    for cloud in clouds:
        for path in all_paths:
            for mode in splat_modes(table):
                for variant in plan.VARIANTS:
                    for budget in table.values("budget", study="error", cloud=cloud, path=path, mode=mode, variant=variant):
                        where = dict(study="error", cloud=cloud, path=path, mode=mode, variant=variant, budget=budget)
                        unit = " ms" if variant == OURS else ""
                        rows.append([cloud, path, mode, variant, f"{budget:,}{unit}", *(number(median(table.series(c, **where))) for c in columns)])
    return ["## All figures", "", *rows_of(["cloud", "path", "mode", "variant", "budget", "FLIP", "SSIM", "holes", "spill", "ms", "ms, 99 %", "points", "error, px", "MB uploaded a frame"], rows)]


def fly_through(table):
    found = table.select(study="fly-through")
    if not found:
        return []
    lines = ["## A fly-through", "",
             "A large tree with caches much smaller than it, from cold caches, at the pace of a display. A *blank tile* is one of 16 × 16 pixels in which the picture that the target of",
             "1.4 px asks for covers at least a quarter and the frame nothing.", ""]
    rows = [[r["cloud"], number(r["points"]), f"{r['l1_mb']:g} / {r['l2_mb']:g} MB", number(r["loaded_mb"]), f"{r['budget']:g}", number(r["frame_ms_median"]), number(r["frame_ms_p99"]),
             number(r["frames"]), number(r["points_drawn"]), number(r["holes"]), f"{r['blank_tiles']} ({r['blank_tiles_that_had_points']} had points) in {r['pictures']} pictures",
             f"{number(r['upload_ms_p99'])}, limit {r['upload_limit_ms']:g}", number(r["frames_over_upload_limit"]), number(r["load"])] for r in found]
    return lines + rows_of(["tree", "points", "L1 / L2", "MB loaded", "budget, ms", "ms, median", "ms, 99 %", "frames", "points drawn", "holes", "blank tiles", "upload ms, 99 %",
                            "frames over it by more than one chunk", "load"], rows)


def write(table, out):
    clouds, all_paths = table.values("cloud", study="error"), table.values("path", study="error")
    lines = ["# Pictures against frame time", ""]
    findings = out / "findings.md"
    if findings.exists():
        lines += [findings.read_text(encoding="utf-8").strip(), ""]
    if (out / "sys_info.txt").exists():
        lines += ["```", (out / "sys_info.txt").read_text(encoding="utf-8").strip(), "```", ""]
    if clouds:
        loads = [r["load"] for r in table.select(study="error")]
        lines += ["FLIP, SSIM, the fraction of holes (pixels that the full-resolution picture covers and this one does not) and of spill (pixels that this one covers and the full-resolution one does",
                  f"not, as a share of those that it does) are means over the pictures of a path, on black. Frame times include everything until the last pixel. Load of the machine while this was measured: {min(loads):.1f} to {max(loads):.1f}.", ""]
        for variant, what in plan.VARIANTS.items():
            lines.append(f"- *{variant}*: {what}")
        lines.append("")
        for cloud in clouds:
            for path in all_paths:
                lines += [f"![{cloud}, {path}]({draw_curves(table, out, cloud, path)})", ""]
        lines += equal_time(table, clouds, all_paths)
        lines += [f"![The modes]({draw_modes(table, out, clouds, all_paths)})", "", *modes(table, clouds, all_paths)]
    lines += fly_through(table)
    if clouds:
        lines += all_figures(table, clouds, all_paths)
    (out / "report.md").write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")
