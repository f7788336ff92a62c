"""report.md and plots out of the rows of bench/neighbours/run.py."""
import pathlib

FIGURES = {
    "normals": [("median_to_exact", "median angle to exact, °"), ("p95_to_exact", "95 %"), ("mean_to_truth", "mean angle to truth, °"),
                ("median_to_truth", "median")],
    "radii": [("median_percent", "median error, %"), ("p95_percent", "95 %")],
    "outliers": [("outliers", "outliers"), ("labels_differ", "labels that differ from the oracle's")],
}
ERROR = {"normals": "p95_to_exact", "radii": "p95_percent"}


def number(value):
    if value is None:
        return ""
    if isinstance(value, int):
        return f"{value:,}"
    return f"{value:.2g}" if abs(value) < 0.1 else f"{value:.3g}" if abs(value) < 100 else f"{value:,.0f}"


def tables(rows):
    for scene in dict.fromkeys(row["scene"] for row in rows):
        of_scene = [row for row in rows if row["scene"] == scene]
        yield f"\n## {scene}, {of_scene[0]['points']:,} points\n"
        for work, figures in FIGURES.items():
            of_work = [row for row in of_scene if row["filter"] == work]
            used = [(key, label) for key, label in figures if any(key in row for row in of_work)]
            if not of_work:
                continue
            yield f"\n### {work}\n"
            yield "| k | program | CPU s | peak MB | " + " | ".join(label for _, label in used) + " |"
            yield "|---:|---|---:|---:|" + "---:|" * len(used)
            for row in of_work:
                cells = [str(row["k"]), row["program"], number(row["cpu"]), f"{row['peak_mb']:.0f}"]
                yield "| " + " | ".join(cells + [number(row.get(key)) for key, _ in used]) + " |"


def ratios(rows):
    """The best other program's time over ours, both exact."""
    yield "\n| cloud | filter | k | best other | its CPU s over ours |"
    yield "|---|---|---:|---|---:|"
    for ours in rows:
        if ours["program"] != "pcmlab":
            continue
        same = [row for row in rows if row["program"] != "pcmlab" and all(row[key] == ours[key] for key in ("scene", "filter", "k"))]
        if same and ours["cpu"] > 0:
            best = min(same, key=lambda row: row["cpu"])
            yield (f"| {ours['scene']} | {ours['filter']} | {ours['k']} | {best['program']} | "
                   f"{best['cpu'] / ours['cpu']:.2f} |")


def plot(out, rows):
    """Error against time, a plot per cloud and filter; the files' names."""
    try:
        import matplotlib
    except ImportError:
        return []
    matplotlib.use("Agg")
    from matplotlib import pyplot
    files = []
    for scene in dict.fromkeys(row["scene"] for row in rows):
        for work, error in ERROR.items():
            lines = {}
            for row in rows:
                if row["scene"] == scene and row["filter"] == work:
                    lines.setdefault((row["program"], row["k"]), []).append((row["cpu"], max(row[error], 1e-6)))
            if not lines:
                continue
            figure, axes = pyplot.subplots(figsize=(7, 4.5))
            for (program, k), points in sorted(lines.items()):
                points.sort()
                axes.plot(*zip(*points), marker="o" if program == "pcmlab" else "x", label=f"{program}, k = {k}")
            axes.set(xscale="log", yscale="log", xlabel="CPU, s", title=f"{work}: {scene}",
                     ylabel="95 % error, °" if work == "normals" else "95 % error, %")
            axes.grid(True, alpha=0.3)
            axes.legend(fontsize=7)
            name = f"{work}-{scene}.png"
            figure.savefig(out / name, dpi=90, bbox_inches="tight")
            pyplot.close(figure)
            files.append(name)
    return files


def write(out: pathlib.Path, rows, arguments):
    findings = out / "findings.md"
    lines = ["# Normals, radii and outliers: error against time", ""]
    if findings.exists():
        lines += [findings.read_text().strip(), ""]
    lines += [f"Seconds of the processor on one thread, medians of {arguments.repeat} runs in turns. Ours are whole processes, from the tree "
              "on disk to a new tree on disk; those of the others are of the computation alone. Peak memory is the whole process's. *Exact* "
              f"are neighbours found by comparing all in double: normals and radii of {arguments.sample} points (normals where the "
              "neighbours define a plane), labels of all points; *truth* are the generator's surfaces, whose points have noise of 3 mm. CGAL "
              "removes a share of the points by another measure: its labels differ for that. [sys_info.txt](sys_info.txt) is the machine.",
              *ratios(rows), *tables(rows), ""]
    lines += [f"![{name}]({name})" for name in plot(out, rows)]
    (out / "report.md").write_text("\n".join(lines).rstrip() + "\n")
