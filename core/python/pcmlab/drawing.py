"""Pictures of trees. The program pcmlab-render draws them, so that this module loads no OpenGL."""

import json
import os
import pathlib
import shutil
import subprocess
import tempfile

from . import _pcmlab

PROGRAM = "pcmlab-render"


def _error(text, code, path="", hint=""):
    error = _pcmlab.Error(text)
    error.code, error.path, error.hint, error.is_done = code, path, hint, False
    return error


def _program():
    """That of the same build or prefix, in bin/ of a folder above this one; else the first in PATH."""
    for folder in pathlib.Path(__file__).resolve().parents:
        if os.access(folder / "bin" / PROGRAM, os.X_OK):
            return str(folder / "bin" / PROGRAM)
    found = shutil.which(PROGRAM)
    if not found:
        hint = "install the package pcmlab, or build where OpenGL, GLEW, EGL and libpng are available"
        raise _error(f"{PROGRAM}, which draws pictures, is neither next to this module nor in PATH: {hint}", "not_found", hint=hint)
    return found


def _command_line(row, values):
    """The words that the command takes for (key, words; of a flag True or False)."""
    arguments = {argument["key"]: argument for argument in row["arguments"]}
    words, places = [row["name"], "--json"], []
    for key, value in values:
        argument = arguments[key]
        option = argument["option"].split(",")[-1]
        if argument["positional"]:
            places += value
        elif argument["type"] == "flag":
            words += [option] if value != argument["on"] else []
        elif argument["type"] == "numbers":
            words += [option, *value]
        else:
            words += [f"{option}={word}" for word in value]
    return [*words, "--", *places]


def _said_by(program, words, progress):
    """Ends the program where `progress` or Ctrl+C says so; it leaves nothing then."""
    process = subprocess.Popen([program, *words], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    try:
        while True:
            try:
                said, complaints = process.communicate(timeout=0.1 if progress else None)
                break
            except subprocess.TimeoutExpired:
                if progress(0.0, "Drawing") is False:
                    process.terminate()
                    progress = None
    except BaseException:
        process.terminate()
        process.communicate()
        raise
    try:
        return json.loads(said)
    except ValueError:
        text = complaints.decode(errors="replace").strip() or "without a word"
        raise _error(f"{program} ended with {process.returncode}: {text}", "io", program) from None


def run(row, values, progress):
    """As _pcmlab.run(): the answer, the lines that the command prints, and whether all is well."""
    answer = _said_by(_program(), _command_line(row, values), progress)
    error = answer["error"]
    if isinstance(error, dict):  # in an answer it is a number, or null
        if error["code"] == "usage":
            raise _pcmlab.ArgumentError(error["text"])
        raise _error(error["text"], error["code"], error["path"] or "", error["hint"] or "")
    if progress:
        progress(1.0, "Drawing")
    return answer, [f"{picture['file']}: {picture['points_drawn']:,} points" for picture in answer["pictures"]], True


def array_of(draw):
    """The array of bytes, height x width x 4 (x 3 where the background covers everything), in the file that draw(file) writes."""
    import numpy

    with tempfile.TemporaryDirectory(prefix="pcmlab-") as folder:
        file = os.path.join(folder, "picture.npy")
        draw(file)
        return numpy.load(file)
