"""The Python packages of requirements.txt, or an interpreter that has them."""
import importlib.util
import os
import sys

NAMES = ("numpy", "scipy", "matplotlib", "skimage", "flip_evaluator")


def require(names=NAMES):
    """Starts anew with --python; 77, which skips a test, where the packages are not there."""
    if "--python" in sys.argv[:-1]:
        at = sys.argv.index("--python")
        interpreter = sys.argv[at + 1]
        if not os.path.exists(interpreter):
            print(f"skipped: {interpreter} is not there; packaging/test-python makes it")
            sys.exit(77)
        os.execv(interpreter, [interpreter, "-B", *sys.argv[:at], *sys.argv[at + 2:]])
    missing = [name for name in names if not importlib.util.find_spec(name)]
    if missing:
        print(f"skipped: Python packages are missing: {' '.join(missing)}; packaging/test-python installs them")
        sys.exit(77)
