"""The features of the report, in the order of its chapters. A feature is a file here with

TITLE    of its chapter
WHAT     what is measured, what its truth is, what time counts; a paragraph of Markdown
ERROR    what an error is, with its unit: the label of the curve's axis
HAS_DEFAULT  False where a feature has no default setting; left out otherwise
FLOOR    errors below it are the same: digits of the numbers; left out where there is none
EXACT    the test that holds the setting whose error is 0; empty where no setting is exact
measure(lab)   the rows: a list of the dicts that Lab.take_turns() makes
absent(lab)    peers that a user might take and that are not here, each with the reason
"""
import importlib
import pathlib

NAMES = ["pictures", "nearest", "picks", "estimates", "radii", "gpu", "normals", "curvature", "outliers", "subsample", "voxels", "levels", "fits", "place", "detection", "align",
         "profile", "volume"]


def load(name):
    return importlib.import_module(f"report.features.{name}")


def without_test(names):
    """Features whose EXACT names a test, SUITE.NAME, that no source in tests/ has."""
    tests = pathlib.Path(__file__).resolve().parents[3] / "tests"
    text = "".join(path.read_text(encoding="utf-8") for path in tests.rglob("*_test.cpp"))
    found = []
    for name in names:
        suite, _, test = load(name).EXACT.partition(".")
        if suite and not any(f"({suite}, {before}{test}" in text for before in ("", "PCM_NOT_UNDER_THREAD(", "PCM_NOT_UNDER_SANITIZERS(")):
            found.append(name)
    return found
