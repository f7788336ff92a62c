"""Imported before numpy: a Python without it starts that of packaging/test-python, or skips the test."""

import os
import sys

try:
    import numpy
except ImportError as error:
    other = os.environ.pop("PCM_TEST_PYTHON", "")
    if os.path.exists(other):
        os.execv(other, [other, "-B", *sys.argv])
    print(f"skipped: {error} (Debian: python3-numpy)")
    sys.exit(77)
