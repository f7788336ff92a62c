"""What is measured."""
import dataclasses

KEYS = ["study", "cloud", "path", "mode", "variant", "budget"]
# Who chooses how much is drawn. The first is what the library does; `budget` is in milliseconds there and in points for the others.
VARIANTS = {"feedback": "best first, as much as the frame budget allows",
            "best first": "best first, a fixed number of points",
            "root first, filled": "the root first, then depth by depth, a fixed number of points, and gaps filled as ours are",
            "root first": "the root first, then depth by depth, a fixed number of points (baseline)"}


@dataclasses.dataclass
class Size:
    points: int           # of the generated cloud
    paths: list
    frames: int           # of a path
    every: int            # one of this number of frames is compared
    milliseconds: list    # frame budgets
    budgets: list         # points
    repeat: int
    picture: str
    pace_ms: float
    fly_frames: int
    fly_every: int
    chunk_points: int = 0  # 0: as the library has it


SMOKE = Size(points=40_000, paths=["plan"], frames=4, every=2, milliseconds=[50], budgets=[4_000, 20_000], repeat=1, picture="160x120", pace_ms=1,
             fly_frames=8, fly_every=2, chunk_points=1000)
QUICK = Size(points=1_500_000, paths=["fly-over", "orbit"], frames=24, every=8, milliseconds=[15, 30, 60, 120], budgets=[30_000, 75_000, 200_000, 500_000],
             repeat=1, picture="640x480", pace_ms=33, fly_frames=240, fly_every=8)
FULL = Size(points=2_000_000, paths=["fly-over", "walk-through", "orbit", "plan"], frames=120, every=10, milliseconds=[8, 16, 33, 66, 133, 250],
            budgets=[30_000, 60_000, 125_000, 250_000, 500_000, 1_000_000, 2_000_000], repeat=5, picture="640x480", pace_ms=33, fly_frames=600, fly_every=6)


def configurations(size, clouds, paths, modes):
    rows = []
    for cloud in clouds:
        for path in paths:
            for mode in modes:
                for variant in VARIANTS:
                    for budget in size.milliseconds if variant == "feedback" else size.budgets:
                        rows.append({"study": "error", "cloud": cloud, "path": path, "mode": mode, "variant": variant, "budget": budget})
    return rows


def options(row):
    """Of bench_pictures."""
    if row["variant"] == "feedback":
        return ["--order", "error", "--frame-budget-ms", row["budget"], "--target-px", 0.5]
    fixed = ["--frame-budget-ms", 0, "--point-budget", row["budget"], "--target-px", 0.01]
    return fixed + (["--order", "error"] if row["variant"] == "best first" else ["--order", "depth"]) + (["--plain"] if row["variant"] == "root first" else [])
