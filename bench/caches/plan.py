"""Which configurations are measured: studies; each varies one or two settings and holds the others."""
import dataclasses

# What distinguishes configurations, in the order of the columns; "" where a mode has no such thing.
KEYS = ["study", "mode", "cloud", "chunk_points", "path", "storage", "l1_mb", "block_mb", "policy", "container", "l2_mb", "l2_threads",
        "reads", "threads"]
AS_BUILT = "as built"  # chunk_points of a tree that is measured as it is


@dataclasses.dataclass
class Size:
    """How much is measured."""
    clouds: list        # points of the generated ones
    grid_clouds: int    # this number of clouds, the first ones, get the studies of policies, sizes, threads and paths
    chunks: list        # points a chunk
    blocks: list        # MB
    l1: list            # MB
    l2: list
    tight_l1: float     # less than what a path touches, so that there is something to replace
    tight_l2: float
    loaders: list
    paths: list
    frames: int         # of a generated path
    repeat: int
    picture: str
    point_budget: int
    pace_ms: float
    queries: int        # of neighbours
    hit_seconds: float
    timed_hits: int


SMOKE = Size(clouds=[40_000], grid_clouds=2, chunks=[5_000, 10_000], blocks=[1, 2], l1=[2, 8], l2=[1, 8], tight_l1=2, tight_l2=1, loaders=[1],
             paths=["fly-over", "plan"], frames=4, repeat=1, picture="160x120", point_budget=20_000, pace_ms=1, queries=200, hit_seconds=0.005,
             timed_hits=1000)
QUICK = Size(clouds=[5_000_000, 20_000_000], grid_clouds=1, chunks=[5_000, 10_000, 25_000, 50_000, 100_000, 200_000, 400_000], blocks=[1, 2, 4],
             l1=[16, 32, 64, 128, 512], l2=[16, 32, 64, 128, 512], tight_l1=32, tight_l2=48, loaders=[1, 2],
             paths=["fly-over", "walk-through", "orbit", "plan"], frames=40, repeat=3, picture="960x540", point_budget=1_000_000, pace_ms=33,
             queries=20_000, hit_seconds=0.1, timed_hits=200_000)
FULL = Size(clouds=[5_000_000, 20_000_000, 60_000_000], grid_clouds=3, chunks=[2_000, 5_000, 10_000, 25_000, 50_000, 100_000, 200_000, 300_000, 400_000],
            blocks=[1, 2, 4], l1=[32, 64, 128, 256, 512, 1024], l2=[32, 64, 128, 256, 512, 1024], tight_l1=64, tight_l2=96, loaders=[1, 2, 4],
            paths=["fly-over", "walk-through", "orbit", "plan"], frames=120, repeat=7, picture="1280x720", point_budget=2_000_000, pace_ms=33,
            queries=100_000, hit_seconds=0.2, timed_hits=500_000)


def configurations(size, clouds, paths, defaults, with_gl):
    """All of them. `clouds`: name to the chunk sizes its trees have; `paths`: names; `defaults`: those of the library."""
    rows = []

    def add(study, mode, cloud, chunk, **values):
        row = dict.fromkeys(KEYS, "")
        row.update(study=study, mode=mode, cloud=cloud, chunk_points=chunk, **values)
        if row not in rows:
            rows.append(row)

    def replay(study, cloud, chunk, **values):
        row = dict(path=paths[0], storage="warm", l1_mb=size.tight_l1, block_mb=defaults["block_mb"], policy=defaults["policy"],
                   container=defaults["container"], l2_mb=size.tight_l2, l2_threads=defaults["l2_threads"])
        row.update(values)
        add(study, "replay", cloud, chunk, **row)

    for number, (cloud, chunks) in enumerate(clouds.items()):
        usual = defaults["chunk_points"] if defaults["chunk_points"] in chunks else chunks[len(chunks) // 2]
        thorough = number < size.grid_clouds
        for chunk in chunks:
            for storage in ("cold", "warm"):
                add("scan", "scan", cloud, chunk, storage=storage, l2_mb=4096, l2_threads=defaults["l2_threads"], reads=8)
                add("scan", "disk", cloud, chunk, storage=storage)
            add("scan", "decoding", cloud, chunk, storage="warm")
            add("estimation", "neighbours", cloud, chunk, storage="warm", l2_mb=1024, l2_threads=defaults["l2_threads"], threads=1)
            add("hits", "hits", cloud, chunk, storage="warm", l2_mb=1024, l2_threads=defaults["l2_threads"]) if thorough else None
            if with_gl:
                for block in size.blocks if thorough else [defaults["block_mb"]]:
                    replay("chunks and blocks", cloud, chunk, block_mb=block)
        if not with_gl:
            continue
        for megabytes in size.l1:
            replay("L1 size", cloud, usual, l1_mb=megabytes, l2_mb=defaults["l2_mb"])
        for megabytes in size.l2:
            replay("L2 size", cloud, usual, l2_mb=megabytes)
        if not thorough:
            continue
        for policy in ("lru", "naive"):
            for container in ("hash", "ordered"):
                replay("policy and container", cloud, usual, policy=policy, container=container)
        for path in paths:
            for storage in ("cold", "warm"):
                for loaders in size.loaders:
                    replay("paths", cloud, usual, path=path, storage=storage, l2_threads=loaders, l1_mb=defaults["l1_mb"], l2_mb=defaults["l2_mb"])
    return rows


def command_line(row, size, tree, path_file):
    """Of bench_caches."""
    options = {"storage": "--storage", "l1_mb": "--l1-mb", "block_mb": "--block-mb", "policy": "--policy", "container": "--container",
               "l2_mb": "--l2-mb", "l2_threads": "--l2-threads", "reads": "--reads", "threads": "--threads"}
    command = [row["mode"], tree]
    for key, option in options.items():
        if row[key] != "":
            command += [option, row[key]]
    if row["mode"] == "replay":
        command += ["--path", path_file, "--size", size.picture, "--point-budget", size.point_budget, "--pace-ms", size.pace_ms]
    elif row["mode"] == "neighbours":
        command += ["--points", size.queries]
    elif row["mode"] == "hits":
        command += ["--seconds", size.hit_seconds, "--timed", size.timed_hits]
    return command
