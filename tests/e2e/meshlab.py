"""Runs the real meshlab and meshlabserver with our plugins and the test driver on a virtual display."""

import atexit
import fcntl
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import time
import unittest
from xml.sax.saxutils import quoteattr

BUILD = pathlib.Path(os.environ["PCM_BUILD_DIR"])
SOURCE = pathlib.Path(os.environ["PCM_SOURCE_DIR"])
PCMLAB = BUILD / "bin" / "pcmlab"
COMPARE = BUILD / "bin" / "compare_pictures"
REFERENCE = SOURCE / "tests" / "e2e" / "reference"
# Pictures and logs are kept here for inspection.
RESULTS = BUILD / "e2e-results"


class Display:
    """A virtual display with a window manager, for the tests of one module: they have it one after another."""

    _only = None

    @classmethod
    def name(cls):
        """The value of DISPLAY; the display is started by the first call and ended with this program."""
        if cls._only is None:
            cls._only = cls()
        return cls._only.number

    def __init__(self):
        self.folder = tempfile.mkdtemp(prefix="pcm-display-")
        atexit.register(self.end)
        read, write = os.pipe()
        self.programs = []
        # The server chooses a free number itself, as several displays start at the same time.
        self.start(["Xvfb", "-displayfd", str(write), "-screen", "0", "1600x1200x24", "-nolisten", "tcp", "-noreset"],
                   "xvfb.log", pass_fds=[write])
        os.close(write)
        with os.fdopen(read) as pipe:
            number = pipe.readline().strip()
        if not number:
            raise AssertionError("the virtual display did not start: " + self.text("xvfb.log"))
        self.number = ":" + number
        # The window manager has its own settings, not the user's.
        self.environment = dict(os.environ, DISPLAY=self.number, XDG_CONFIG_HOME=self.folder, XDG_CACHE_HOME=self.folder,
                                LC_ALL="C.UTF-8")
        self.start(["openbox"], "openbox.log", env=self.environment)
        # A window that comes before its manager is left without frame, place and focus.
        deadline = time.monotonic() + 60
        while not self.is_managed():
            if time.monotonic() > deadline or self.programs[1].poll() is not None:
                raise AssertionError("the window manager did not start: " + self.text("openbox.log"))
            time.sleep(0.02)

    def start(self, command, log, **options):
        with open(os.path.join(self.folder, log), "w", encoding="utf-8") as file:
            self.programs.append(subprocess.Popen(command, stdout=file, stderr=file, **options))

    def text(self, log):
        return pathlib.Path(self.folder, log).read_text(errors="replace")

    def is_managed(self):
        asked = subprocess.run(["xprop", "-root", "_NET_SUPPORTING_WM_CHECK"], env=self.environment, capture_output=True,
                               text=True, timeout=60)
        return "window id" in asked.stdout

    def end(self):
        for program in reversed(self.programs):
            program.terminate()
            program.wait(60)
        shutil.rmtree(self.folder, ignore_errors=True)


class Run:
    """Output and exit code of a program, and what the driver printed."""

    def __init__(self, code, text):
        self.code = code
        self.text = text

    def times(self):
        return {m[1]: int(m[2]) for m in re.finditer(r"driver: time (\S+) (\d+) ms", self.text)}

    def layers(self):
        """What the driver's print-layers printed."""
        return [json.loads(m[1]) for m in re.finditer(r"driver: layer (\{.*\})", self.text)]

    def boxes(self):
        """What the driver's print-boxes printed."""
        return [json.loads(m[1]) for m in re.finditer(r"driver: box (\{.*\})", self.text)]

    def parameters(self):
        """What the driver's print-parameters printed, by name."""
        found = (json.loads(m[1]) for m in re.finditer(r"driver: parameters (\{.*\})", self.text))
        return {values["name"]: values for values in found}

    def docks(self):
        """The least widths of panels that the driver's print-docks printed, by name."""
        return {m[1]: int(m[2]) for m in re.finditer(r"driver: dock (\S+) (\d+)", self.text)}

    def fields(self):
        """What the driver's print-field printed, in order."""
        return re.findall(r"driver: field [^:]*: (.*)", self.text)

    def paints(self):
        """What the driver's print-paints printed."""
        return [json.loads(m[1]) for m in re.finditer(r"driver: paints (\{.*\})", self.text)]

    def legends(self):
        """The lines of the legends that the driver's print-legend printed, by name."""
        found = (json.loads(m[1]) for m in re.finditer(r"driver: legend (\{.*\})", self.text))
        return {legend["name"]: legend["lines"] for legend in found}

    def labels(self, name):
        """The texts of a label that the driver's print-label printed, in order."""
        return re.findall(rf"driver: label {name}: (.*)", self.text)

    def properties(self, name):
        """The values of a property of the view that the driver's print-property printed, in order."""
        found = (json.loads(m[1]) for m in re.finditer(r"driver: property (\{.*\})", self.text))
        return [each["value"] for each in found if each["name"] == name]

    def tables(self, name):
        """The rows of a table that the driver's print-table printed, in order."""
        found = (json.loads(m[1]) for m in re.finditer(r"driver: table (\{.*\})", self.text))
        return [table["rows"] for table in found if table["name"] == name]

    def turns(self):
        """What the driver's print-turns printed, in order."""
        return [json.loads(m[1]) for m in re.finditer(r"driver: turns (\{.*\})", self.text)]

    def cameras(self):
        """What the driver's print-camera printed, by name."""
        found = (json.loads(m[1]) for m in re.finditer(r"driver: camera (\{.*\})", self.text))
        return {camera["name"]: camera for camera in found}

    def memory(self):
        found = re.finditer(r"driver: memory (\S+) now (\d+) peak (\d+)", self.text)
        return {m[1]: (int(m[2]), int(m[3])) for m in found}


def pcmlab(*arguments):
    """Runs the pcmlab command and returns the object it prints."""
    done = subprocess.run([str(PCMLAB), *map(str, arguments), "--json"], capture_output=True, text=True, timeout=600)
    if done.returncode != 0:
        raise AssertionError(f"pcmlab {arguments} ended with {done.returncode}: {done.stderr}")
    return json.loads(done.stdout)


def different(a, b, border=0):
    """The fraction of pixels that differ between two pictures, without a border of this width; 1 if the sizes differ."""
    done = subprocess.run([str(COMPARE), str(a), str(b), str(border)], capture_output=True, text=True, timeout=60, check=True)
    return json.loads(done.stdout)["different"]


SAMPLES = SOURCE / ".." / "shared" / "data"


def sample(name):
    """A sample file; the test is skipped if it does not exist."""
    path = (SAMPLES / name).resolve()
    if not path.exists():
        raise unittest.SkipTest(f"the sample {name} does not exist")
    return path


# Driver commands for a picture that depends only on the cloud: no time limit, so that the view is complete when all detail
# is drawn, and a fixed size. The view must exist already.
NO_TIME_LIMIT = """
    parameter MeshLab::PointCloud::FrameBudget = 100000
    """
FIXED_VIEW = NO_TIME_LIMIT + """
    view-size 480 360
    """


class MeshLabTest(unittest.TestCase):
    """A test with its own folder and its own settings of MeshLab."""

    # Most tests look straight down, as MeshLab does: their cameras and pictures shall not depend on ours.
    first_view = 1
    # Pictures are compared as a whole, and when their points are complete.
    scale_bar = False
    smooth = False

    @classmethod
    def setUpClass(cls):
        cls.prefix = BUILD / "e2e-meshlab"
        RESULTS.mkdir(exist_ok=True)
        # Modules run side by side; the first makes what the others find made.
        with open(BUILD / "e2e-meshlab.lock", "w", encoding="utf-8") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            subprocess.run([SOURCE / "packaging" / "meshlab-prefix", BUILD, cls.prefix, BUILD / "test-plugins"], check=True,
                           capture_output=True, timeout=60)

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="pcm-e2e-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.environment = dict(os.environ, XDG_CONFIG_HOME=str(self.folder / "config"), LC_ALL="C.UTF-8",
                                XDG_RUNTIME_DIR=str(self.folder / "runtime"),
                                XDG_CACHE_HOME=str(self.folder / "cache"), LIBGL_ALWAYS_SOFTWARE="1",
                                MESA_SHADER_CACHE_DIR=str(BUILD / "e2e-shaders"))
        (self.folder / "config" / "VCG").mkdir(parents=True)
        if self.first_view:
            self.setting("FirstView", "RichEnum", self.first_view, enum_cardinality=2, enum_val0="", enum_val1="")
        if not self.scale_bar:
            self.setting("ScaleBar", "RichBool", "false", tooltip="Default on.")
        if not self.smooth:
            self.setting("Smooth", "RichBool", "false", tooltip="Default on.")
        (self.folder / "runtime").mkdir(mode=0o700)

    def setting(self, name, kind, value, **more):
        """Stores one of our settings as MeshLab does, before it is started."""
        name = "MeshLab::PointCloud::" + name
        attributes = " ".join(f"{key}={quoteattr(str(text))}" for key, text in dict(more, type=kind, name=name, value=value).items())
        document = f"<!DOCTYPE MeshLabSettings><Param {attributes}/>".replace('"', '\\"')
        with open(self.folder / "config" / "VCG" / "MeshLab_64bit_fp.conf", "a", encoding="utf-8") as file:
            file.write(f'{name.replace(":", "%3A")}="{document}"\n')

    def result(self, name):
        """Path of a picture or log of this test."""
        return RESULTS / f"{type(self).__name__}-{self._testMethodName}-{name}"

    def run_program(self, command, timeout):
        done = subprocess.run([*map(str, command)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              errors="replace", env=dict(self.environment, DISPLAY=Display.name()), cwd=self.folder,
                              timeout=timeout)
        self.result("log.txt").write_text(done.stdout)
        return Run(done.returncode, done.stdout)

    def gui(self, script, *arguments, timeout=240):
        """Runs MeshLab; the driver plays the script."""
        (self.folder / "script.txt").write_text(script)
        self.environment["PCM_TEST_SCRIPT"] = str(self.folder / "script.txt")
        self.environment["PCM_TEST_FAILURE_PICTURE"] = str(self.result("failure.png"))
        return self.run_program([self.prefix / "bin" / "meshlab", *arguments], timeout)

    def server(self, filters, *arguments, timeout=240, started_by=()):
        """Runs meshlabserver with a script of filters: [(name, {parameter: (type, value)})], or
        (type, value, further attributes) of a parameter. `started_by` is a command that starts it, such as env."""
        lines = ["<!DOCTYPE FilterScript>", "<FilterScript>"]
        for name, parameters in filters:
            lines.append(f" <filter name={quoteattr(name)}>")
            for key, (kind, value, *more) in parameters.items():
                attributes = "".join(f" {name}={quoteattr(str(text))}" for name, text in (more[0] if more else {}).items())
                lines.append(f"  <Param type={quoteattr(kind)} value={quoteattr(str(value))} name={quoteattr(key)}{attributes}/>")
            lines.append(" </filter>")
        lines.append("</FilterScript>")
        script = self.folder / "script.mlx"
        script.write_text("\n".join(lines) + "\n")
        self.environment.pop("PCM_TEST_SCRIPT", None)
        return self.run_program([*started_by, self.prefix / "bin" / "meshlabserver", *arguments, "-s", script], timeout)

    def assertDriven(self, run):
        """The script was completed and MeshLab quit by itself."""
        self.assertNotIn("driver: FAILED", run.text)
        self.assertIn("driver: quit", run.text)
        self.assertEqual(run.code, 0, run.text[-3000:])

    def generate_file(self, name, points, *options):
        """A generated cloud as a file."""
        las = self.folder / f"{name}.las"
        pcmlab("generate", "--points", points, *options, "--no-truth", las)
        return las

    def generate(self, name, points, *options):
        """A generated cloud as a file, and its tree."""
        las = self.generate_file(name, points, *options)
        tree = self.folder / f"{name}.pct"
        pcmlab("build", las, "-o", tree)
        return las, tree
