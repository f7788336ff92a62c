"""The features of the report, in the order of its chapters. A feature is a file here with

TITLE    of its chapter
WHAT     what is measured, what its truth is, what time counts; a paragraph of Markdown
ERROR    what an error is, with its unit: the label of the curve's axis
HAS_DEFAULT  False where a feature has no default setting; left out otherwise
FLOOR    errors below it are the same: digits of the numbers; left out where there is none
EXACT    the test, or the tests, that hold the setting whose error is 0; empty where no setting is exact
WHY      why a peer is not beaten, where one is not
DEFAULT_KEPT  why a default stays that its curve speaks against; left out where none does
NOTES    what was found, lines of Markdown; left out where nothing was
TABLE    instead of ERROR: the keys of the rows, of a feature that is a table and no curve
measure(lab)   the rows: a list of the dicts that Lab.take_turns() makes
absent(lab)    peers that a user might take and that are not here, each with the reason
"""
import importlib
import pathlib

NAMES = ["pictures", "nearest", "picks", "estimates", "radii", "gpu", "normals", "curvature", "outliers", "subsample", "voxels", "levels", "fits", "place", "detection", "align",
         "profile", "volume", "needs"]


def load(name):
    return importlib.import_module(f"report.features.{name}")


def tests_of(feature):
    return [feature.EXACT] * bool(feature.EXACT) if isinstance(feature.EXACT, str) else list(feature.EXACT)


def without_test(names):
    """Tests that EXACT of a feature names, SUITE.NAME, and that no source in tests/ has."""
    tests = pathlib.Path(__file__).resolve().parents[3] / "tests"
    text = "".join(path.read_text(encoding="utf-8") for path in tests.rglob("*_test.cpp"))
    found = []
    for name, exact in ((name, exact) for name in names for exact in tests_of(load(name))):
        suite, _, test = exact.partition(".")
        if not any(f"({suite}, {before}{test}" in text for before in ("", "PCM_NOT_UNDER_THREAD(", "PCM_NOT_UNDER_SANITIZERS(")):
            found.append(f"{name}: {exact}")
    return found
