"""report.md and pictures out of the rows of bench/fit/run.py."""
import json
import pathlib

KINDS = ("plane", "cylinder", "sphere")
FOUND = 0.045  # m, three thresholds: a shape whose surface is farther from the true one is another shape
COLOURS = {"own-msac": "#d62728", "own-prosac": "#ff9896", "own-rmsac": "#e6a817", "pcl-ransac": "#1f77b4", "pcl-msac": "#17becf", "pcl-rmsac": "#9467bd", "cgal": "#2ca02c",
           "oracle": "black"}


def rows_of(out, group):
    path = pathlib.Path(out) / f"{group}.jsonl"
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


def quantile(values, share):
    values = sorted(values)
    return values[min(len(values) - 1, int(share * len(values)))] if values else None


def number(value, digits=3):
    if value is None:
        return ""
    if value == 0 or 0.01 <= abs(value) < 1000:
        return f"{value:.{digits}g}" if abs(value) < 100 else f"{value:.0f}"
    return f"{value:.1e}" if abs(value) < 0.01 else f"{value:,.0f}"


class Runs:
    """All fits of one case by one method (and one limit of samples)."""

    def __init__(self, rows):
        self.rows = rows

    def figure(self, key, share=0.5):
        """Of the found ones; not found ones count as infinitely wrong."""
        values = [row[key] if row["found"] else float("inf") for row in self.rows]
        found = quantile(values, share)
        return None if found == float("inf") else found

    def cpu(self, share=0.5):
        return quantile([row["cpu_ms"] for row in self.rows], share)

    def success(self, within=FOUND):
        return 100 * sum(row["found"] and row["surface"] <= within for row in self.rows) / len(self.rows)

    def misled(self):
        """Not found, and not flagged."""
        return 100 * sum(row["found"] and row["surface"] > FOUND and row.get("verdict", "good") == "good" for row in self.rows) / len(self.rows)

    def flagged(self):
        return 100 * sum(row.get("verdict", "good") != "good" for row in self.rows) / len(self.rows)


def grouped(out, group):
    """case -> (method, samples) -> Runs, in the order of the rows."""
    cases = {}
    for row in rows_of(out, group):
        cases.setdefault(row["case"], {}).setdefault((row["method"], row["iterations"]), []).append(row)
    return {case: {key: Runs(rows) for key, rows in methods.items()} for case, methods in cases.items()}


def by_name(methods):
    return {name: runs for (name, _), runs in methods.items()}


def ratio(value, reference):
    return number(value / reference) if value is not None and reference else "–" if value is None else ""


def tables_of_methods(out):
    for case, methods in grouped(out, "table").items():
        methods = by_name(methods)
        oracle = methods["oracle"]
        yield f"\n### {case} outliers{', probability 0.9999' if '60' in case else ''}\n"
        yield ("| method | CPU ms, median | 90 % | × PCL RANSAC | × that without its least squares | samples | surface × oracle, median | 90 % | "
               "radius × oracle | found, % |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|")
        for name, runs in methods.items():
            reference = [methods[other].cpu() if other in methods else None for other in ("pcl-ransac", "pcl-ransac-raw")]
            cells = [name, number(runs.cpu()), number(runs.cpu(0.9))]
            cells += ["" if name == "oracle" or not other else number(runs.cpu() / other) for other in reference]
            cells += [number(quantile([row["samples"] for row in runs.rows], 0.5), 5), ratio(runs.figure("surface"), oracle.figure("surface")),
                      ratio(runs.figure("surface", 0.9), oracle.figure("surface", 0.9)), ratio(runs.figure("radius"), oracle.figure("radius")),
                      number(runs.success())]
            yield "| " + " | ".join(cells) + " |"


def table_by(out, group, figure, title, unit):
    """Rows: kind and method; columns: what the cases of that kind differ in."""
    cases = grouped(out, group)
    if not cases:
        return
    columns = list(dict.fromkeys(case.split(" ", 1)[1] for case in cases))
    yield f"\n| {title} | " + " | ".join(f"{column}{unit}" for column in columns) + " |"
    yield "|---|" + "---:|" * len(columns)
    for kind in KINDS:
        methods = list(dict.fromkeys(name for case, found in cases.items() if case.startswith(kind + " ") for name, _ in found))
        for name in methods:
            cells = []
            for column in columns:
                found = by_name(cases.get(f"{kind} {column}", {}))
                cells.append(figure(found[name], found) if name in found else "")
            yield f"| {kind}: {name} | " + " | ".join(cells) + " |"


def stiff_table(out):
    cases = grouped(out, "stiff")
    if not cases:
        return
    yield ("\n| case | method | radius error, %: median | 90 % | × oracle | more than 30 % wrong and not flagged, % of fits | flagged, % | claimed σ of the radius, %: "
           "median | within 3 σ, % |")
    yield "|---|---|---:|---:|---:|---:|---:|---:|---:|"
    for case, methods in cases.items():
        methods = by_name(methods)
        true_radius = float(case.split(" R ")[1]) if " R " in case else float(case.split()[1])
        oracle = methods["oracle"].figure("radius")
        for name, runs in methods.items():
            half, most = runs.figure("radius"), runs.figure("radius", 0.9)
            wrong = 100 * sum(row["found"] and row["radius"] > 0.3 * true_radius and row.get("verdict", "good") == "good" for row in runs.rows) / len(runs.rows)
            cells = [case, name, number(half and 100 * half / true_radius), number(most and 100 * most / true_radius), ratio(half, oracle), number(wrong)]
            claims = [row for row in runs.rows if "radius_sigma" in row and row["found"]]
            if any("verdict" in row for row in runs.rows):
                cells.append(number(runs.flagged()))
                cells.append(number(100 * quantile([row["radius_sigma"] for row in claims], 0.5) / true_radius) if claims else "")
                cells.append(number(100 * sum(row["radius"] <= 3 * row["radius_sigma"] for row in claims) / len(claims)) if claims else "")
            else:
                cells += ["never" if name != "oracle" else "", "", ""]
            yield "| " + " | ".join(cells) + " |"


def large_table(out):
    for case, methods in grouped(out, "large").items():
        path = pathlib.Path(out) / "memory.json"
        memory = json.loads(path.read_text()) if path.exists() else {}
        yield f"\n| {case}, 100,000 points | CPU ms, median | 90 % | surface error, mm | found, % | memory of the fit, MB |\n|---|---:|---:|---:|---:|---:|"
        for name, runs in by_name(methods).items():
            error = runs.figure("surface")
            yield (f"| {name} | {number(runs.cpu())} | {number(runs.cpu(0.9))} | {number(error and 1e3 * error)} | {number(runs.success())} | "
                   f"{number(memory.get(name))} |")


def plot_curves(out, pyplot):
    figure, places = pyplot.subplots(1, 3, figsize=(15, 4.6))
    for axes, (case, methods) in zip(places, grouped(out, "budgets").items()):
        for name in dict.fromkeys(name for name, _ in methods):
            runs = [(of.cpu(), of.figure("surface")) for (method, _), of in methods.items() if method == name]
            if name == "oracle":
                axes.axhline(1e3 * runs[0][1], color="black", linestyle=":", label="oracle")
                continue
            points = [(cpu, 1e3 * error) for cpu, error in runs if error]
            if points:
                axes.plot(*zip(*points), marker="o" if name.startswith("own") else "x", color=COLOURS.get(name), label=name)
        axes.set(xscale="log", yscale="log", xlabel="CPU, ms (limits of 5 to 2000 samples)", title=f"{case}, 60 % outliers", ylabel="median error of the surface, mm")
        axes.grid(True, alpha=0.3)
        axes.legend(fontsize=8)
    figure.savefig(out / "curves.png", dpi=90, bbox_inches="tight")
    pyplot.close(figure)
    return "curves.png"


def plot_success(out, pyplot):
    figure, places = pyplot.subplots(2, 3, figsize=(15, 8))
    cases = grouped(out, "outliers")
    for column, kind in enumerate(KINDS):
        lines = {}
        for case, methods in cases.items():
            if case.split()[0] == kind:
                for name, runs in by_name(methods).items():
                    if name in COLOURS and name != "oracle":
                        lines.setdefault(name, []).append((float(case.split()[1]), runs.success(), runs.cpu()))
        for name, points in lines.items():
            for row, value in ((0, 1), (1, 2)):
                places[row][column].plot([p[0] for p in points], [p[value] for p in points], marker="o" if name.startswith("own") else "x",
                                         color=COLOURS[name], label=name)
        places[0][column].set(title=kind, ylabel="found, %", ylim=(-3, 103))
        places[1][column].set(yscale="log", xlabel="outliers, %", ylabel="CPU, ms, median")
        for row in (0, 1):
            places[row][column].grid(True, alpha=0.3)
        places[0][column].legend(fontsize=8)
    figure.savefig(out / "success.png", dpi=90, bbox_inches="tight")
    pyplot.close(figure)
    return "success.png"


def plots(out):
    try:
        import matplotlib
    except ImportError:
        return []
    matplotlib.use("Agg")
    from matplotlib import pyplot
    return [draw(out, pyplot) for group, draw in (("budgets", plot_curves), ("outliers", plot_success)) if rows_of(out, group)]


def automatic_table(out):
    yield "\n| scene | method | CPU ms, median | surface × oracle, median | 90 % | found, % |\n|---|---|---:|---:|---:|---:|"
    for case, methods in grouped(out, "automatic").items():
        methods = by_name(methods)
        for name, runs in methods.items():
            if name != "oracle":
                yield (f"| {case} | {name} | {number(runs.cpu())} | {ratio(runs.figure('surface'), methods['oracle'].figure('surface'))} | "
                       f"{ratio(runs.figure('surface', 0.9), methods['oracle'].figure('surface', 0.9))} | {number(runs.success())} |")


def endless_table(out):
    yield ("\nWith PCL's own pretest, a tenth of all points, which PCL by itself would repeat for ever:\n\n| scene | method | samples at which it was ended | CPU ms, median | found, % |\n"
           "|---|---|---:|---:|---:|")
    for case, methods in grouped(out, "endless").items():
        for name, runs in by_name(methods).items():
            if name != "oracle":
                yield f"| {case} | {name} | {quantile([row['samples'] for row in runs.rows], 0.5):,} | {number(runs.cpu())} | {number(runs.success())} |"


def write(out):
    out = pathlib.Path(out)
    findings, info = out / "findings.md", out / "sys_info.txt"
    seeds = len({row["seed"] for row in rows_of(out, "table")})
    pictures = plots(out)
    over_oracle = lambda runs, methods: ratio(runs.figure("surface"), methods["oracle"].figure("surface"))  # noqa: E731
    millimetres = lambda runs, _: number(runs.figure("surface") and 1e3 * runs.figure("surface"))  # noqa: E731
    lines = ["# Fits of one shape: error against run time", ""]
    if findings.exists():
        lines += [findings.read_text().strip(), ""]
    lines += [f"{seeds} scenes a row (30 for the curves and for the noise, 20 where wall time is limited, 10 for 100,000 points and for what never ends), made anew for each seed; on each all methods take turns. 3038 points unless said otherwise: a plane of 3 × 3 m, a cylinder of "
              "radius 0.5 m and length 3 m, a sphere of radius 0.5 m, σ of 5 mm along the normal, outliers evenly in the box around. Times are of the processor, one "
              "thread; normals are estimated beforehand and given to all methods alike. *Surface* is the rms distance of the true surface from the found one; "
              "*oracle* is a least-squares fit in long double to the points that are truly on the shape, by code of its own; *found*: the surface is within 45 mm, three times the threshold. "
              "PCL is 1.13 with single-precision coordinates about the points' middle, "
              "with the least squares that its SACSegmentation does at the end (*-raw*: without); its RRANSAC and RMSAC pretest one point (*-default*: a tenth of all, as PCL does unless asked "
              "otherwise, and would then never end: here they end at 10,000 samples). CGAL is 5.5, its largest shape.",
              "\n```\npackaging/pcl-sdk build/pcl-sdk && apt-get install libcgal-dev\ncmake build/release -DPCM_WITH_PCL=ON -DPCM_BENCH_PEERS=ON && ninja -C build/release bench_fit pcm_pcl\n"
              f"python3 bench/fit/run.py --bin build/release/bin --out DIR --seeds {seeds}\nbuild/release/bin/bench_fit --kind plane --threshold 0.015     # one scene: the table 8.1\n```\n",
              f"Machine: {info.read_text().strip() if info.exists() else ''}"]
    lines += ["\n## The plane of table 8.1, and the same of cylinder and sphere", *tables_of_methods(out), *endless_table(out)]
    lines += ["\n## Time budgets\n\nLimits of 5 to 2000 samples, 60 % outliers.\n", *(f"![Error against run time]({name})" for name in pictures if name.startswith("curves"))]
    with_time = lambda runs, _: f"{number(runs.figure('surface') and 1e3 * runs.figure('surface')) or '–'} ({number(runs.cpu(0.9))})"  # noqa: E731
    lines += ["\nWith a limit of wall time instead, 70 % outliers, and a probability that never ends the search: median surface error in mm (and the CPU, ms, within which 90 % end).",
              *table_by(out, "seconds", with_time, "limit", " ms")]
    lines += ["\n## Outliers\n\nShapes found, % of the scenes; probability 0.99, at most 10,000 samples.", *table_by(out, "outliers", lambda runs, _: number(runs.success()), "found, %", " %")]
    lines += ["\nSomething else found in its place and not flagged, % of the scenes:", *table_by(out, "outliers", lambda runs, _: number(runs.misled()), "wrong, %", " %")]
    lines += ["\nMedian CPU, ms:", *table_by(out, "outliers", lambda runs, _: number(runs.cpu()), "ms", " %")]
    lines += ["", *(f"![Shapes found, and time, over the share of outliers]({name})" for name in pictures if name.startswith("success"))]
    lines += ["\n## Noise\n\nSurface error over the oracle's, medians; the threshold is 3 σ.", *table_by(out, "noise", over_oracle, "σ, m", "")]
    lines += ["\n## Offsets\n\nMedian surface error, mm, σ = 1 mm; *map* is at (500000, 4800000, 100).", *table_by(out, "offsets", millimetres, "mm at", "")]
    lines += ["\n## Stiff shapes\n\nThin arcs of cylinders 1 m long, and patches of 1 m of large spheres, σ = 1 mm, 30 % outliers. *Flagged* are fits that are refused or doubtful.", *stiff_table(out)]
    lines += ["\n## Many points", *large_table(out)]
    lines += ["\n## Automatic threshold, and estimating the normals too", *automatic_table(out)]
    (out / "report.md").write_text("\n".join(lines).rstrip() + "\n")
