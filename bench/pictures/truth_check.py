"""What a quick run of truth.py must have found."""
import numpy as np

import metrics
import views


def check_metrics():
    """On pictures of which the figures are known: two things side by side, a hole of 20 pixels in one, and a rim of 2 pixels of the other."""
    labels = np.zeros((120, 160, 4), np.uint8)
    labels[:, :80], labels[:, 80:] = (200, 0, 0, 255), (0, 90, 0, 255)
    facts = np.zeros_like(labels)
    facts[:, :, 0], facts[:, :, 1] = views.SURFACE, 255
    facts[:10, :, 1] = 0  # no scanner saw it
    view = {"eye": (0, 0, 0), "target": (0, 1, 0), "angle": 50}
    truth = views.Truth(view, labels, labels, facts)
    assert truth.shapes(labels) == {"holes": 0, "spill": 0}, truth.shapes(labels)
    assert truth.likeness(labels)["flip"] == 0 and truth.likeness(labels)["psnr"] == 99 and truth.likeness(labels)["ssim"] > 0.9999
    wrong = labels.copy()
    wrong[50:54, 20:25] = 0
    wrong[:, 80:82] = (200, 0, 0, 255)
    wrong[:10] = 7  # is not asked about
    found = truth.shapes(wrong)
    assert abs(found["holes"] - 20 / truth.inside.sum()) < 1e-9 and abs(found["spill"] - 2) < 1e-9, found
    likeness = truth.likeness(wrong)
    assert likeness["flip"] > 0 and likeness["psnr"] < 40 and likeness["ssim"] < 1, likeness
    elsewhere = labels.copy()
    elsewhere[:10] = 7
    assert truth.likeness(elsewhere)["flip"] == 0 and truth.shapes(elsewhere) == {"holes": 0, "spill": 0}
    assert abs(truth.covered(wrong) - (1 - 20 / (110 * 160))) < 1e-9
    assert truth.offset(np.roll(labels, -2, axis=1))[0] == 2
    brighter = labels.copy()
    brighter[:, :80, 0] = 230
    assert abs(metrics.changed(labels, brighter, np.ones((120, 160), bool)) - 5) < 1e-3  # a third of the channels, half of the pixels, by 30
    assert metrics.changed_share(labels, brighter) == 0.5 and metrics.changed_share(labels, brighter, 31) == 0


def check_turn():
    """A picture of waves, turned by 3 pixels, is moved by 3 pixels to the left in its middle; the camera's frame turns to the right."""
    view = {"eye": (0, 0, 0), "target": (0, 1, 0), "angle": 50}
    waves = np.full((80, 120, 4), 255, np.uint8)
    waves[:, :, :3] = (127 + 100 * np.sin(np.arange(120) / 5)).astype(np.uint8)[None, :, None]
    moved = views.turn_picture(waves, view, 3)
    assert np.abs(moved[:, 55:65] - metrics.on_black(waves)[:, 58:68]).max() < 0.01
    assert views.turning(waves, waves, view, np.zeros((80, 120), bool)) == {"turn": 0, "swim": 0}
    target = np.array(views.turned(view, 10, 80)["target"])
    assert target[0] > 0.05 and abs(np.linalg.norm(target) - 1) < 1e-9, target


def check(result, out):
    check_metrics()
    check_turn()
    rows = {(row["view"], row["method"].split(",")[0] if row["state"] == "both" else row["method"], row["state"]): row for row in result["rows"]}
    text = (out / "report.md").read_text(encoding="utf-8")
    for truth in result["truths"]:
        view = truth["view"]
        assert truth["asked"] > 0.6 and 0.2 < truth["covered"] <= 1, truth
        assert f"![{view}]" in text and 1000 < (out / f"{view}.png").stat().st_size <= 300_000, view
        for method, states in (("default", views.STATES), ("discs", views.STATES)):
            for state in states:
                row = rows[view, method, state]
                assert 0 < row["flip"] < 1 and -1 <= row["ssim"] <= 1 and 5 < row["psnr"] < 99 and row["cpu_ms"] > 0 and row["points"] > 0, row
        potree, constant = rows[view, "Potree's rule", "both"], rows[view, views.CONSTANT, "both"]
        # The cloud lies where the truth is, and splats close its surfaces.
        assert rows[view, "discs", "rest"]["holes"] < 0.02 and rows[view, "default", "rest"]["holes"] < 0.15 and potree["holes"] < 0.1, (view, potree)
        assert 0.4 < potree["spill"] / rows[view, "default", "rest"]["spill"] < 2.2, (view, potree)
        assert 0 < truth["turn"] < 20 and 0 < rows[view, "default", "rest"]["swim"] < 20 and 0 < rows[view, "default", "rest"]["jolt"] < 1, truth
        assert max(map(abs, constant["offset"])) <= 1, (view, constant)
        assert potree["flip"] < 0.7 and constant["flip"] < 0.8, (view, potree, constant)
    wall = {name: rows["wall", name, state] for name, state in (("default", "rest"), (views.CONSTANT, "both"))}
    assert wall["default"]["holes"] < wall[views.CONSTANT]["holes"] and wall["default"]["flip"] < wall[views.CONSTANT]["flip"], wall
    forest = next(truth for truth in result["truths"] if truth["view"] == "forest")
    assert forest["covered"] < rows["forest", "default", "rest"]["covered"], "leaves are smaller than the splats of a thin cloud"
