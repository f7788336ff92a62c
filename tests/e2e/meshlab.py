"""Runs the real meshlab, and meshlabserver where MeshLab has it, with our plugins and the test driver on a virtual display."""

import atexit
import fcntl
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import tempfile
import threading
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


class MeshLab:
    """A running MeshLab whose driver plays scripts, one after another."""

    def __init__(self, command, environment, folder, driver="on"):
        self.process = subprocess.Popen([*map(str, command)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        stderr=subprocess.STDOUT, text=True, errors="replace", cwd=folder,
                                        env=dict(environment, DISPLAY=Display.name(), PCM_TEST_DRIVER=driver))

    def play(self, script, timeout, ends=False):
        """What MeshLab prints until it has played the script, or until it ends. `ends`: the script ends MeshLab."""
        late = threading.Timer(timeout, self.process.kill)
        late.start()
        text = ""
        try:
            self.process.stdin.write(f"{script}\n")
            self.process.stdin.flush()
        except BrokenPipeError:
            pass  # what it printed says why
        for line in self.process.stdout:
            text += line
            if line.endswith("driver: played\n") and not ends:
                break
        else:
            self.process.wait()
        late.cancel()
        return Run(self.process.poll() or 0, text)

    def end(self):
        """Without regard to what it does."""
        self.process.kill()
        self.process.communicate()


class Run:
    """Output and exit code of a program, and what the driver printed. A MeshLab that goes on has no code yet: 0."""

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


def facts_of(tree):
    """What pcmlab says of a tree, without what saying it took."""
    taken = ("seconds", "cpu_seconds", "points_read", "bytes_read", "peak_memory")
    return {key: value for key, value in pcmlab("info", tree).items() if key not in taken}


def different(a, b, border=0):
    """The fraction of pixels that differ between two pictures, without a border of this width; 1 if the sizes differ."""
    done = subprocess.run([str(COMPARE), str(a), str(b), str(border)], capture_output=True, text=True, timeout=60, check=True)
    return json.loads(done.stdout)["different"]


def needs_server():
    """Skips what runs meshlabserver where MeshLab has none: 2020.09 is the last that has it."""
    if not shutil.which("meshlabserver", path="/usr/bin"):
        raise unittest.SkipTest("this MeshLab has no meshlabserver; scripts run in PyMeshLab there (test_pymeshlab.py)")


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


class Shared:
    """A MeshLab for several tests, in a folder that is its own."""

    def __init__(self, test, settings):
        self.settings = settings
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="pcm-e2e-shared-"))
        self.meshlab = MeshLab([test.prefix / "bin" / "meshlab"], test.home(self.folder), self.folder, "shared")

    def quit(self):
        script = self.folder / "quit.txt"
        script.write_text("quit\n")
        run = self.meshlab.play(script, 120, ends=True)
        if run.code != 0:
            raise AssertionError(f"MeshLab quit with code {run.code}:\n{run.text[-3000:]}")

    def end(self):
        self.meshlab.end()
        shutil.rmtree(self.folder, ignore_errors=True)


class MeshLabTest(unittest.TestCase):
    """A test with its own folder. The tests of a module share one MeshLab, which starts over after each script; a test that needs a
    new one says why. After a test that fails, the next one has a new MeshLab."""

    # Most tests look straight down, as MeshLab does: their cameras and pictures shall not depend on ours.
    first_view = 1
    # Pictures are compared as a whole, and when their points are complete.
    scale_bar = False
    smooth = False

    shared = None  # the MeshLab of the module's tests, and the settings that it was started with

    @classmethod
    def setUpClass(cls):
        cls.prefix = BUILD / "e2e-meshlab"
        RESULTS.mkdir(exist_ok=True)
        # Modules run side by side; the first makes what the others find made.
        with open(BUILD / "e2e-meshlab.lock", "w", encoding="utf-8") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            subprocess.run([SOURCE / "packaging" / "meshlab-prefix", BUILD, cls.prefix, BUILD / "test-plugins"], check=True,
                           capture_output=True, timeout=60)
        unittest.addModuleCleanup(MeshLabTest.quit_shared)

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="pcm-e2e-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.environment = self.home(self.folder)

    def run(self, result):
        faults = len(result.failures) + len(result.errors)
        super().run(result)
        if len(result.failures) + len(result.errors) > faults:
            self.forget_shared()

    @classmethod
    def home(cls, folder):
        """Settings of MeshLab's first start in a folder, and the environment of a MeshLab that has them."""
        (folder / "config" / "VCG").mkdir(parents=True)
        (folder / "runtime").mkdir(mode=0o700)
        if cls.first_view:
            cls.store(folder, "FirstView", "RichEnum", cls.first_view, enum_cardinality=2, enum_val0="", enum_val1="")
        if not cls.scale_bar:
            cls.store(folder, "ScaleBar", "RichBool", "false", tooltip="Default on.")
        if not cls.smooth:
            cls.store(folder, "Smooth", "RichBool", "false", tooltip="Default on.")
        return dict(os.environ, XDG_CONFIG_HOME=str(folder / "config"), LC_ALL="C.UTF-8", XDG_RUNTIME_DIR=str(folder / "runtime"),
                    XDG_CACHE_HOME=str(folder / "cache"), LIBGL_ALWAYS_SOFTWARE="1",
                    MESA_SHADER_CACHE_DIR=str(BUILD / "e2e-shaders"))

    @staticmethod
    def store(folder, name, kind, value, **more):
        """Stores one of our settings as MeshLab does, before it is started."""
        name = "MeshLab::PointCloud::" + name
        attributes = " ".join(f"{key}={quoteattr(str(text))}" for key, text in dict(more, type=kind, name=name, value=value).items())
        document = f"<!DOCTYPE MeshLabSettings><Param {attributes}/>".replace('"', '\\"')
        with open(folder / "config" / "VCG" / "MeshLab_64bit_fp.conf", "a", encoding="utf-8") as file:
            file.write(f'{name.replace(":", "%3A")}="{document}"\n')

    def result(self, name):
        """Path of a picture or log of this test."""
        return RESULTS / f"{type(self).__name__}-{self._testMethodName}-{name}"

    def script(self, commands):
        """A file with commands for the driver, in the test's folder."""
        path = self.folder / "script.txt"
        path.write_text(f"folder {self.folder}\nfailure-picture {self.result('failure.png')}\n{commands}\n")
        return path

    def kept(self, run, timeout):
        """Keeps what a program printed, for inspection."""
        self.result("log.txt").write_text(run.text)
        if run.code == -signal.SIGKILL:
            raise AssertionError(f"killed, after {timeout} s if not by another program:\n{run.text[-3000:]}")
        return run

    def gui(self, script, timeout=240):
        """The driver plays the script in the MeshLab that the module's tests share."""
        settings = (self.first_view, self.scale_bar, self.smooth)
        if MeshLabTest.shared and MeshLabTest.shared.settings != settings:
            self.quit_shared()
        if not MeshLabTest.shared:
            MeshLabTest.shared = Shared(self, settings)
        run = MeshLabTest.shared.meshlab.play(self.script(f"{script}\nstart-over"), timeout)
        if run.code != 0:
            self.forget_shared()
        return self.kept(run, timeout)

    def own_gui(self, script, *arguments, timeout=240):
        """The driver plays the script, which ends with `quit`, in a MeshLab with the test's own settings and these arguments."""
        meshlab = MeshLab([self.prefix / "bin" / "meshlab", *arguments], self.environment, self.folder)
        self.addCleanup(meshlab.end)
        return self.kept(meshlab.play(self.script(script), timeout, ends=True), timeout)

    @staticmethod
    def forget_shared():
        if MeshLabTest.shared:
            MeshLabTest.shared.end()
        MeshLabTest.shared = None

    @staticmethod
    def quit_shared():
        """As the user does it, after the last test of a module."""
        if not MeshLabTest.shared:
            return
        try:
            MeshLabTest.shared.quit()
        finally:
            MeshLabTest.forget_shared()

    def server(self, filters, *arguments, timeout=240, started_by=()):
        """Runs meshlabserver with a script of filters: [(name, {parameter: (type, value)})], or
        (type, value, further attributes) of a parameter. `started_by` is a command that starts it, such as env."""
        needs_server()
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
        command = [*started_by, self.prefix / "bin" / "meshlabserver", *arguments, "-s", script]
        done = subprocess.run([*map(str, command)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              errors="replace", env=dict(self.environment, DISPLAY=Display.name()), cwd=self.folder,
                              timeout=timeout)
        return self.kept(Run(done.returncode, done.stdout), timeout)

    def assertDriven(self, run):
        """The script was completed, and MeshLab closed its documents, or quit by itself."""
        self.assertNotIn("driver: FAILED", run.text)
        self.assertIn("driver: played", run.text, run.text[-3000:])
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
