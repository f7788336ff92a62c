"""report.md: plots, tables and the defaults that the figures recommend."""
import json
import math
import sys

from table import median, quartiles, spread

TOLERANCE = 0.05  # maximum distance from the best that counts as good

# What a choice costs: study, mode, figure, and the other conditions. Each counts equally, as a ratio to the best.
COSTS = {
    "chunk_points": ("points a chunk", [
        ("chunks and blocks", "frame_ms_p99", {}, "99 % of frames"),
        ("chunks and blocks", "cpu_seconds", {}, "processor, path"),
        ("chunks and blocks", "converged_ms_median", {}, "picture complete"),
        ("chunks and blocks", "screen_error_px_median", {}, "spacing on screen"),
        ("scan", "seconds", dict(mode="scan", storage="cold"), "cold scan"),
        ("estimation", "cpu_us_query", {}, "radius of a point")]),
    "block_mb": ("VBO, MB", [
        ("chunks and blocks", "l1_load_ms_mean", {}, "upload of a chunk"),
        ("chunks and blocks", "cpu_seconds", {}, "processor, path"),
        ("chunks and blocks", "frame_ms_p99", {}, "99 % of frames"),
        ("chunks and blocks", "converged_ms_median", {}, "picture complete")]),
    "policy": ("policy of L1", [
        ("policy and container", "l1_uploaded_mb", {}, "uploaded"),
        ("policy and container", "cpu_seconds", {}, "processor, path"),
        ("policy and container", "frame_ms_p99", {}, "99 % of frames"),
        ("policy and container", "converged_ms_median", {}, "picture complete")]),
    "container": ("container of L1", [
        ("policy and container", "draw_ms_median", {}, "time in draw()"),
        ("policy and container", "cpu_seconds", {}, "processor, path"),
        ("policy and container", "frame_ms_p99", {}, "99 % of frames")]),
}
RULE = f"""Each value of a choice gets a score: for every cloud and every kind of cost in its table (with the other things held), the median over
the repetitions is divided by that of the best value, and the geometric mean of these ratios is the score; 1 would be best in everything.
A value is as good as the best when its score is within {TOLERANCE:.0%} of the best score, or within the spread of its figures (half the distance
of the quartiles, as a share of the median; the mean over the figures) or of the best one's, whichever is most. The library's default is recommended when it is as
good as the best, for a default is not changed for less than what repetitions differ by; else the best value is. What was measured once shows no
spread, and changes no default."""
SIZE_RULE = """A size is enough when at it, and at each larger one, fewer than 1 % of the requests are capacity misses, on all clouds. L1 must also hold
one picture at the renderer's point budget, 16 bytes a point. The library's default is recommended when it is enough; else the next power of two that is."""


def load_plots():
    """The module, or None with a line that says why."""
    try:
        import plots
        return plots
    except ImportError as error:
        print(f"no plots: {error} (python3-numpy and python3-matplotlib have what is missing)", file=sys.stderr)
        return None


def fixed(parameter, where, table, study, cloud):
    """Each configuration of the other things that were varied in the study."""
    others = [k for k in ("chunk_points", "block_mb", "policy", "container") if k != parameter]
    seen = []
    for row in table.select(study=study, cloud=cloud, **where):
        held = {k: row[k] for k in others}
        if held not in seen:
            seen.append(held)
    return seen


def scores(table, parameter):
    """Value: (score, spread, {label: mean ratio}); only values that were measured in everything."""
    ratios, spreads = {}, {}
    for study, figure, where, label in COSTS[parameter][1]:
        for cloud in table.values("cloud", study=study):
            for held in fixed(parameter, where, table, study, cloud):
                conditions = {**where, "study": study, "cloud": cloud, **held}
                found = {}
                for value in table.values(parameter, **conditions):
                    series = table.series(figure, **{**conditions, parameter: value})
                    if series and median(series) > 0:
                        found[value] = series
                if len(found) < 2:
                    continue
                best = min(median(s) for s in found.values())
                for value, series in found.items():
                    ratios.setdefault(value, {}).setdefault(label, []).append(median(series) / best)
                    spreads.setdefault(value, []).append(spread(series))
    labels = {label for of_value in ratios.values() for label in of_value}
    result = {}
    for value, of_value in ratios.items():
        if set(of_value) != labels:
            continue
        means = {label: math.exp(sum(map(math.log, r)) / len(r)) for label, r in of_value.items()}
        score = math.exp(sum(math.log(m) for m in means.values()) / len(means))
        result[value] = (score, sum(spreads[value]) / len(spreads[value]), means)
    return result


def recommend(found, default):
    best = min(found, key=lambda v: found[v][0])
    good = [v for v in found if found[v][0] <= found[best][0] * (1 + max(TOLERANCE, found[v][1], found[best][1]))]
    return (default if default in good else best), best, good


def text_of(value):
    if isinstance(value, (int, float)):
        return f"{value:,}" if isinstance(value, int) else f"{value:g}"
    return str(value)


def enough(table, study, column, rate):
    """The smallest size from which on capacity misses are rare everywhere; None when there is none."""
    sizes = table.values(column, study=study)
    rates = {s: max((median(table.series(rate, study=study, cloud=c, **{column: s})) or 0) for c in table.values("cloud", study=study)) for s in sizes}
    result = None
    for size in reversed(sizes):
        if rates[size] >= 0.01:
            break
        result = size
    return result, rates


def power_of_two(value):
    return 2 ** math.ceil(math.log2(value))


def size_line(name, default, smallest, least, rates):
    shown = ", ".join(f"{size:g} MB {rate:.1%}" for size, rate in rates.items())
    if smallest is None:
        return f"| {name} | more than was measured | {default:g} | capacity misses: {shown} |"
    needed = max(smallest, least)
    wanted = default if default >= needed else power_of_two(needed)
    return f"| {name} | {wanted:g} (enough: {needed:.0f}) | {default:g} | capacity misses: {shown} |"


def defaults_section(table, about):
    lines = ["## Defaults", "", RULE, "", SIZE_RULE, "", "| | recommended | the library's | as good as the best |", "|---|---|---|---|"]
    tables, differing, unsure = [], [], []
    for parameter, (name, costs) in COSTS.items():
        found = scores(table, parameter)
        default = about.get(parameter)
        if len(found) < 2:
            continue
        chosen, _, good = recommend(found, default)
        if chosen != default:
            differing.append(name)
        if not all(math.isfinite(of_it) for _, of_it, _ in found.values()):
            unsure.append(name)
        lines.append(f"| {name} | {text_of(chosen)} | {text_of(default)} | {', '.join(text_of(v) for v in sorted(good, key=str if isinstance(good[0], str) else None))} |")
        labels = [label for *_, label in costs if any(label in f[2] for f in found.values())]
        tables += ["", f"| {name} | score | " + " | ".join(labels) + " | spread |", "|---:" * (len(labels) + 3) + "|"]
        for value in sorted(found, key=str if isinstance(next(iter(found)), str) else None):
            score, spread_of, means = found[value]
            tables.append(f"| {text_of(value)} | {score:.2f} | " + " | ".join(f"{means[label]:.2f}" for label in labels) + f" | {f'{spread_of:.0%}' if math.isfinite(spread_of) else 'unknown'} |")
    for name, study, column, rate in (("L1, MB", "L1 size", "l1_mb", "l1_capacity_rate"), ("L2, MB", "L2 size", "l2_mb", "l2_capacity_rate")):
        if not table.select(study=study):
            continue
        smallest, rates = enough(table, study, column, rate)
        least = about.get("point_budget", 0) * 16 / 2**20 if column == "l1_mb" else 0
        lines.append(size_line(name, about[column], smallest, least, rates))
        if smallest is not None and max(smallest, least) > about[column]:
            differing.append(name)
    verdict = "The library's defaults are those recommended." if not differing else "**The library's defaults differ from those recommended in: " + ", ".join(differing) + ".**"
    if unsure:
        verdict += f" Some configurations were measured once, so nothing is known of the spread, and so the defaults are kept: {', '.join(unsure)}."
    return [*lines, "", verdict, "", "The scores, and the mean ratios to the best that they are made of:", *tables, ""]


def three_digits(value):
    return f"{value:,.0f}" if value >= 100 else f"{value:.3g}"


def cell(series):
    if not series:
        return ""
    low, high = quartiles(series)
    return f"{three_digits(median(series))} ({three_digits(low)} to {three_digits(high)})"


def storage_section(table):
    lines = ["## Scanning, against disk and decoder", "",
             "All points with all attributes, medians (and quartiles). *Share* is the larger of two: of the disk's plain reads of the same files, and of what one core decodes; what",
             "is nearer to 1 is what binds.", "",
             "| cloud | points a chunk | cold, MB/s | disk plain, MB/s | disk direct, MB/s | cold, M points/s | warm, M points/s | decoding, M points/s a core | share |",
             "|---|---:|---:|---:|---:|---:|---:|---:|---:|"]
    for cloud in table.values("cloud", study="scan"):
        for chunk in table.values("chunk_points", study="scan", cloud=cloud):
            def of(figure, mode, storage):
                return table.series(figure, study="scan", cloud=cloud, chunk_points=chunk, mode=mode, storage=storage)
            cold, disk = of("mb_s", "scan", "cold"), of("read_mb_s", "disk", "cold")
            points, decoding = of("mpoints_s", "scan", "cold"), of("mpoints_cpu_s", "decoding", "warm")
            share = max(median(cold) / median(disk), median(points) / median(decoding)) if cold and disk and decoding else 0
            lines.append(f"| {cloud} | {text_of(chunk)} | {cell(cold)} | {cell(disk)} | {cell(of('direct_mb_s', 'disk', 'cold'))} | {cell(points)} | "
                         f"{cell(of('mpoints_s', 'scan', 'warm'))} | {cell(decoding)} | {share:.2f} |")
    return [*lines, ""]


def hits_section(table):
    if not table.select(study="hits"):
        return []
    lines = ["## Hits of L2", "", "| cloud | points a chunk | p50, ns | p99, ns | 1 thread, M/s | 2 | 4 | 8 |", "|---|---:|---:|---:|---:|---:|---:|---:|"]
    for cloud in table.values("cloud", study="hits"):
        for chunk in table.values("chunk_points", study="hits", cloud=cloud):
            where = dict(study="hits", cloud=cloud, chunk_points=chunk)
            lines.append(f"| {cloud} | {text_of(chunk)} | " + " | ".join(cell(table.series(f, **where)) for f in
                         ("hit_ns_p50", "hit_ns_p99", "mhits_s_1", "mhits_s_2", "mhits_s_4", "mhits_s_8")) + " |")
    return [*lines, ""]


def write(table, out):
    if not table.rows:
        print("nothing was measured yet: no report")
        return
    about = json.loads((out / "defaults.json").read_text(encoding="utf-8"))
    lines = ["# The caches, measured", ""]
    note = out / "findings.md"
    if note.exists():
        lines += [note.read_text(encoding="utf-8").strip(), ""]
    loads = table.series("load")
    repetitions = max(table.values("repetition"))
    lines += [f"{len(table.rows)} runs, up to {repetitions} of a configuration, in turns and in random order; the load of the machine (runnable processes, a minute's "
              f"mean) was {min(loads):.1f} to {max(loads):.1f} when they began, in the middle {median(loads):.1f}. Every run is a row of [results.csv](results.csv). The machine:", "",
              "```", (out / "sys_info.txt").read_text(encoding="utf-8").strip(), "```", ""]
    lines += defaults_section(table, about)
    lines += storage_section(table)
    lines += hits_section(table)
    plots = load_plots()
    if plots:
        lines += ["## Plots", "", "Lines are medians, bars the quartiles.", ""]
        for file, caption in plots.draw_all(table, out):
            lines += [f"{caption}.", "", f"![{caption}]({file})", ""]
    (out / "report.md").write_text("\n".join(lines), encoding="utf-8")
    print(f"{out / 'report.md'} is written")
