"""What tests of PyMeshLab share: the module with our two plugins, the sample clouds, and the command to compare with."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(os.environ["PCM_BUILD_DIR"])
SOURCE = pathlib.Path(os.environ["PCM_SOURCE_DIR"])
SAMPLES = pathlib.Path(os.environ.get("PCM_TEST_DATA", SOURCE.parent / "shared" / "data"))
PLUGINS = BUILD / "second" / "plugins"
IO, FILTER = PLUGINS / "libio_00_pcm.so", PLUGINS / "libpcm_filter.so"
PYTHON = pathlib.Path(os.environ.get("PCM_TEST_PYTHON", SOURCE / "build" / "test-python" / "bin" / "python3"))
SKIPPED = 77


def go_on_in_pymeshlab(script):
    """Runs the script in the Python that has PyMeshLab. Without it, or without our plugins, the test is skipped."""
    reason = None
    if not (IO.exists() and FILTER.exists()):
        reason = "the plugins for PyMeshLab are not built (packaging/meshlab-sdk build/pymeshlab-sdk 2025.07, and cmake -DPCM_SECOND_MESHLAB_SDK)"
    elif not PYTHON.exists() or subprocess.run([PYTHON, "-c", "import pymeshlab"], capture_output=True).returncode:
        reason = f"{PYTHON} has no PyMeshLab (packaging/test-python)"
    if reason:
        print("skipped:", reason)
        sys.exit(SKIPPED)
    os.execv(PYTHON, [str(PYTHON), "-B", script, "--in-pymeshlab", *sys.argv[1:]])


def pcmlab(*arguments):
    done = subprocess.run([str(BUILD / "bin" / "pcmlab"), *map(str, arguments), "--json"], capture_output=True, text=True, check=True)
    return json.loads(done.stdout) if done.stdout.strip() else None


def sample(name):
    if not (SAMPLES / name).exists():
        raise unittest.SkipTest(f"{SAMPLES / name} is not there")
    return SAMPLES / name


class PyMeshLabTest(unittest.TestCase):
    """Each test works in a folder of its own."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="pcm-pymeshlab-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        os.chdir(self.folder)

    def generated(self, name="city.las", points=60000, origin="500000,5700000,300"):
        pcmlab("generate", "--points", points, "--seed", 3, "--origin", origin, "--no-truth", self.folder / name)
        return self.folder / name

    def alone(self, text):
        """What a process of its own prints, and its exit code; `text` starts with the plugins loaded."""
        start = f"import pymeshlab\npymeshlab.load_plugin('{IO}')\npymeshlab.load_plugin('{FILTER}')\n"
        done = subprocess.run([sys.executable, "-c", start + text], capture_output=True, text=True, timeout=300)
        return done.stdout + done.stderr, done.returncode
