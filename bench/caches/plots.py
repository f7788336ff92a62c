"""Figures of the same kinds as the source's 5.12 to 5.33, and a few more. Each function draws one file; lines are medians, bars the quartiles."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

from table import median, quartiles  # noqa: E402

COLOURS = ["#1b6ca8", "#d1662c", "#3a8f4d", "#8d4fa3", "#8a7a1f", "#555555", "#c2407a"]
MARKS = ["o", "s", "^", "D", "v", "P", "X"]


def numeric(values):
    return [v for v in values if isinstance(v, (int, float))]


def line(axes, table, x, figure, scale, label, number, divide_x=1, **where):
    points = []
    for value in numeric(table.values(x, **where)):
        series = [v * scale for v in table.series(figure, **{**where, x: value})]
        if series:
            points.append((value / divide_x, median(series), *quartiles(series)))
    if not points:
        return False
    xs, middle, low, high = np.array(points, dtype=float).T
    axes.errorbar(xs, middle, yerr=[middle - low, high - middle], label=label, color=COLOURS[number % len(COLOURS)],
                  marker=MARKS[number % len(MARKS)], markersize=4, linewidth=1.3, capsize=2)
    return True


def panels(clouds, draw, title, xlabel, ylabel, file, log_x=True, from_zero=True):
    """A row with a panel for each cloud. `draw(axes, cloud)` returns whether there was anything."""
    figure, all_axes = plt.subplots(1, len(clouds), figsize=(4.6 * len(clouds) + 0.6, 3.6), squeeze=False)
    drawn = False
    for axes, cloud in zip(all_axes[0], clouds):
        drawn = draw(axes, cloud) or drawn
        axes.set_title(f"cloud {cloud}", fontsize=9)
        axes.set_xlabel(xlabel, fontsize=9)
        if log_x:
            axes.set_xscale("log", base=2 if "MB" in xlabel else 10)
            ticks = sorted({round(float(v), 3) for l in axes.get_lines() for v in l.get_xdata()})
            axes.set_xticks(ticks, [f"{t:g}" for t in ticks])
            axes.minorticks_off()
        if from_zero:
            axes.set_ylim(bottom=0)
        axes.tick_params(labelsize=8)
        axes.grid(alpha=0.3)
        if axes.get_legend_handles_labels()[0]:
            axes.legend(fontsize=7)
    all_axes[0][0].set_ylabel(ylabel, fontsize=9)
    figure.suptitle(title, fontsize=10)
    figure.tight_layout()
    if drawn:
        figure.savefig(file, dpi=80)
    plt.close(figure)
    return drawn


def by_block(table, figure, scale):
    def draw(axes, cloud):
        where = dict(study="chunks and blocks", cloud=cloud)
        return any([line(axes, table, "chunk_points", figure, scale, f"VBO {block:g} MB", n, 1000, **where, block_mb=block)
                    for n, block in enumerate(table.values("block_mb", **where))])
    return draw


def against_chunk(table, lines, **where):
    """`lines`: (figure, scale, label, more conditions)."""
    def draw(axes, cloud):
        return any([line(axes, table, "chunk_points", figure, scale, label, n, 1000, cloud=cloud, **{**where, **more})
                    for n, (figure, scale, label, more) in enumerate(lines)])
    return draw


def against(table, x, lines, **where):
    def draw(axes, cloud):
        return any([line(axes, table, x, figure, scale, label, n, cloud=cloud, **{**where, **more})
                    for n, (figure, scale, label, more) in enumerate(lines)])
    return draw


def bars(table, study, names, figures, clouds, title, file):
    """A panel for each figure (name, scale, label); a bar for each of `names` (label: conditions)."""
    rows = [(cloud, figure) for cloud in clouds for figure in figures]
    figure, all_axes = plt.subplots(1, len(rows), figsize=(3.3 * len(rows), 3.2), squeeze=False)
    drawn = False
    for axes, (cloud, (key, scale, label)) in zip(all_axes[0], rows):
        for n, (name, where) in enumerate(names.items()):
            series = [v * scale for v in table.series(key, study=study, cloud=cloud, **where)]
            if not series:
                continue
            drawn = True
            low, high = quartiles(series)
            axes.bar(n, median(series), color=COLOURS[n % len(COLOURS)], yerr=[[median(series) - low], [high - median(series)]], capsize=3)
        axes.set_xticks(range(len(names)), list(names), rotation=30, ha="right", fontsize=7)
        axes.set_title(f"cloud {cloud}", fontsize=9)
        axes.set_ylabel(label, fontsize=8)
        axes.tick_params(axis="y", labelsize=8)
        axes.grid(axis="y", alpha=0.3)
    figure.suptitle(title, fontsize=10)
    figure.tight_layout()
    if drawn:
        figure.savefig(file, dpi=80)
    plt.close(figure)
    return drawn


def draw_all(table, out):
    """Draws what there are figures for; list of (heading, file name, caption)."""
    made = []
    clouds = table.values("cloud")
    clouds.sort(key=lambda c: median(table.series("points", cloud=c)) or 0)
    with_grid = table.values("cloud", study="chunks and blocks")
    with_grid = [c for c in clouds if c in with_grid]
    sweeps = [c for c in clouds if len(numeric(table.values("chunk_points", cloud=c))) > 1]

    def add(name, caption, *arguments, **more):
        if arguments[0] and panels(*arguments, out / f"{name}.png", **more):
            made.append((f"{name}.png", caption))

    chunk = "points a chunk, K"
    loads = [("l2_load_ms_mean", 1, "cold", dict(storage="cold")), ("l2_load_ms_mean", 1, "warm", dict(storage="warm"))]
    add("l1-hits", "Hit rate of L1 against chunk size, by VBO size (as figures 5.14, 5.19, 5.24, 5.29)", with_grid,
        by_block(table, "l1_hit_rate", 100), "L1: requests that find their chunk", chunk, "hits, %", from_zero=False)
    add("l1-load", "Time to load a chunk into L1 (as figures 5.15, 5.20, 5.25, 5.30)", with_grid,
        by_block(table, "l1_load_ms_mean", 1), "L1: time of an upload", chunk, "ms a chunk")
    add("l1-speed", "The same as speed: what the size of the chunk leaves of it", with_grid,
        by_block(table, "l1_mb_s", 1), "L1: speed of uploads", chunk, "MB/s")
    add("l2-hits", "Hit rate of L2 against chunk size (as figures 5.16, 5.21, 5.26, 5.31)", with_grid,
        by_block(table, "l2_hit_rate", 100), "L2: requests that find their chunk", chunk, "hits, %")
    misses = [("l2_compulsory_rate", 100, "compulsory", {}), ("l2_capacity_rate", 100, "capacity", {})]
    block = table.values("block_mb", study="chunks and blocks")
    block = 2 if 2 in block else block[0] if block else ""
    add("l2-misses", "Misses of L2 against chunk size (as figures 5.17, 5.22, 5.27, 5.32)", with_grid,
        against_chunk(table, misses, study="chunks and blocks", block_mb=block), "L2: misses of all requests", chunk, "misses, %")
    add("l2-load", "Time to load a chunk into L2, in a scan of the whole (as figures 5.18, 5.23, 5.28, 5.33)", sweeps,
        against_chunk(table, loads, study="scan", mode="scan"), "L2: time of a load", chunk, "ms a chunk")
    add("estimation", "Time to estimate radii against chunk size, on the processor (as figures 5.12, 5.13)", sweeps,
        against_chunk(table, [("us_query", 1, "wall", {}), ("cpu_us_query", 1, "processor", {})], study="estimation"),
        "Radius of a point: its 8 nearest neighbours", chunk, "s for a million points")
    add("frames", "Time of a frame of a moving camera against chunk size", with_grid,
        against_chunk(table, [("frame_ms_median", 1, "median", {}), ("frame_ms_p99", 1, "99 % are within", {})], study="chunks and blocks", block_mb=block),
        "Frames of a moving camera", chunk, "ms")
    add("spacing", "What a moving camera sees: the largest spacing of points where finer ones exist", with_grid,
        against_chunk(table, [("screen_error_px_median", 1, "median", {})], study="chunks and blocks", block_mb=block),
        "Spacing of points on screen", chunk, "pixels")
    add("converged", "Time until a camera that rests sees all it wants", with_grid,
        against_chunk(table, [("converged_ms_median", 1, "median", {}), ("converged_ms_max", 1, "longest", {})], study="chunks and blocks", block_mb=block),
        "Until the picture is complete", chunk, "ms")
    scan = [("mpoints_s", 1, "cold, through L2", dict(mode="scan", storage="cold")), ("mpoints_s", 1, "warm, through L2", dict(mode="scan", storage="warm")),
            ("mpoints_cpu_s", 1, "decoding, one core", dict(mode="decoding"))]
    add("scan", "Scan of a whole tree through L2 beside decoding alone", sweeps, against_chunk(table, scan, study="scan"),
        "All points with all attributes", chunk, "M points/s")
    disk = [("mb_s", 1, "cold, through L2", dict(mode="scan", storage="cold")), ("read_mb_s", 1, "the disk's, plain reads", dict(mode="disk", storage="cold")),
            ("direct_mb_s", 1, "the disk's, direct reads", dict(mode="disk", storage="cold"))]
    add("scan-disk", "The same beside what the disk gives of the same files", sweeps, against_chunk(table, disk, study="scan"),
        "The tree's files, from cold storage", chunk, "MB/s")
    sized = [c for c in clouds if c in table.values("cloud", study="L1 size")]
    add("l1-size", "L1 by its size", sized,
        against(table, "l1_mb", [("l1_hit_rate", 100, "hits", {}), ("l1_compulsory_rate", 100, "compulsory misses", {}), ("l1_capacity_rate", 100, "capacity misses", {})], study="L1 size"),
        "L1: share of requests", "size of L1, MB", "%")
    add("l2-size", "L2 by its size, behind a small L1", sized,
        against(table, "l2_mb", [("l2_hit_rate", 100, "hits", {}), ("l2_compulsory_rate", 100, "compulsory misses", {}), ("l2_capacity_rate", 100, "capacity misses", {})], study="L2 size"),
        "L2: share of requests", "size of L2, MB", "%")
    hits = [c for c in clouds if c in table.values("cloud", study="hits")]
    add("hits", "A chunk that L2 holds: what asking for it takes", hits,
        against_chunk(table, [("hit_ns_p50", 1, "median", {}), ("hit_ns_p99", 1, "99 % are within", {})], study="hits"), "L2: time of a hit, one thread", chunk, "ns")
    threads = [(f"mhits_s_{n}", 1, f"{n} thread{'s' if n > 1 else ''}", {}) for n in (1, 2, 4, 8)]
    add("hits-threads", "The same, asked by several threads", hits, against_chunk(table, threads, study="hits"), "L2: hits of all threads", chunk, "M/s")

    def add_bars(name, caption, study, names, figures):
        of_it = [c for c in clouds if c in table.values("cloud", study=study)]
        if of_it and bars(table, study, names, figures, of_it, caption, out / f"{name}.png"):
            made.append((f"{name}.png", caption))

    kinds = {f"{policy}, {container}": dict(policy=policy, container=container) for policy in ("lru", "naive") for container in ("hash", "ordered")}
    add_bars("policies", "Policies and containers of L1, with too little of it", "policy and container", kinds,
             [("l1_hit_rate", 100, "hits of L1, %"), ("l1_uploaded_mb", 1, "uploaded, MB"), ("frame_ms_p99", 1, "99 % of frames within, ms")])
    routes = {f"{path}, {storage}": dict(path=path, storage=storage, l2_threads=table.values("l2_threads", study="paths")[0])
              for path in table.values("path", study="paths") for storage in ("cold", "warm")}
    add_bars("paths", "Camera paths, from cold storage and from warm", "paths", routes,
             [("frame_ms_median", 1, "median frame, ms"), ("converged_ms_median", 1, "picture complete after, ms")])
    return made
