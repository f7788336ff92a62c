"""Every operation of the command `pcmlab` as a function, made of the library's table of operations."""

import inspect
import json
import keyword
import os
import textwrap
import warnings

from . import _pcmlab, drawing
from .progress import callback

__all__ = []


class Answer(dict):
    """The answer of an operation: what `--json` prints, as a dict. `text` is what the command prints; `good` is False
    where what was looked at is damaged."""

    def __init__(self, values, text, good):
        super().__init__(values)
        self.text = text
        self.good = good

    def __str__(self):
        return self.text


def _name(key):
    name = key.replace("-", "_")
    return name + "_" if keyword.iskeyword(name) else name


def _word(value):
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    if isinstance(value, bool):
        raise _pcmlab.ArgumentError(f"{value} is neither a number nor text")
    if hasattr(value, "item"):  # a number of numpy
        value = value.item()
    if isinstance(value, (int, float)):
        return repr(value)
    raise _pcmlab.ArgumentError(f"{value!r} is neither a number nor text")


def _words(argument, value):
    if isinstance(value, (str, os.PathLike, int, float)) or getattr(value, "ndim", 1) == 0:
        return [_word(value)]
    if not hasattr(value, "__iter__"):
        return [_word(value)]
    rows = list(value)
    if rows and hasattr(rows[0], "__len__") and not isinstance(rows[0], str) and argument["type"] == "numbers":
        rows = [number for row in rows for number in row]
    return [_word(row) for row in rows]


def _step_part(argument, value):
    """One argument of a step: "factor=3", or the name that switches a flag on or off."""
    if argument["type"] != "flag":
        return argument["key"] + "=" + ",".join(_words(argument, value))
    if bool(value) == argument["on"]:
        return None
    return argument["option"].split(",")[-1].lstrip("-") if argument["on"] else argument["key"]


def _steps(argument, value):
    """The steps of one operation, as on the command line: a number, text, a tuple of these, or a dict by name is one; a list has
    several."""
    if isinstance(value, list):
        return [step for one in value for step in _steps(argument, one)]
    if isinstance(value, dict):
        known = {_name(a["key"]): a for row in rows if row["name"] == argument["key"] for a in row["arguments"]}
        unknown = [name for name in value if name not in known]
        if unknown:
            raise _pcmlab.ArgumentError(f"{argument['key']} has no argument {unknown[0]}")
        parts = [_step_part(known[name], one) for name, one in value.items()]
        return [",".join(part for part in parts if part is not None)]
    return [",".join(_words(argument, value))]


def _value(argument, value):
    if argument["type"] == "step":
        return _steps(argument, value)
    if argument["type"] == "flag":
        if not isinstance(value, (bool, int)):
            raise _pcmlab.ArgumentError(f"{argument['key']} is True or False")
        return bool(value)
    return _words(argument, value)


def _default(argument):
    return argument["on"] if argument["type"] == "flag" else None


def _parameters(row):
    kinds = inspect.Parameter
    places = [a for a in row["arguments"] if a["positional"]]
    named = [a for a in row["arguments"] if not a["positional"]]
    parameters = [kinds(_name(a["key"]), kinds.POSITIONAL_OR_KEYWORD, default=kinds.empty if a["required"] else None)
                  for a in sorted(places, key=lambda a: not a["required"])]
    parameters += [kinds(_name(a["key"]), kinds.KEYWORD_ONLY, default=kinds.empty if a["required"] else _default(a)) for a in named]
    return parameters + [kinds("progress", kinds.KEYWORD_ONLY, default=None)]


def _describe(argument):
    text = argument["help"].rstrip(".")
    notes = [argument["unit"]] if argument["unit"] else []
    if argument.get("choices"):
        notes.append("one of " + ", ".join(argument["choices"]))
    for word, key in (("at least", "least"), ("above", "above"), ("at most", "most")):
        if key in argument:
            notes.append(f"{word} {argument[key]:.10g}")
    if argument["type"] == "flag":
        notes.append("default " + str(argument["on"]))
    elif argument["default"] is not None:
        notes.append("default " + argument["default"])
    elif argument.get("without"):
        notes.append("default: " + argument["without"])
    return text + (" (" + "; ".join(notes) + ")" if notes else "")


def _document(row):
    lines = [row["help"].rstrip(".") + ".", "", "Arguments:"]
    for argument in row["arguments"]:
        lines.append(textwrap.fill(f"{_name(argument['key'])}: {_describe(argument)}", 110, initial_indent="    ",
                                   subsequent_indent="        "))
    lines.append("    progress: None, True (a bar), or a function of (fraction, stage) that cancels by returning False")
    if row["limits"]:
        lines += ["", textwrap.fill(row["limits"], 110)]
    lines += ["", "Returns a dict with:"]
    for result in row["results"] + row["head"]:
        unit = f", {result['unit']}" if result["unit"] else ""
        lines.append(textwrap.fill(f"{result['key']} ({result['type']}{unit}): {result['help']}", 110, initial_indent="    ",
                                   subsequent_indent="        "))
    return "\n".join(lines) + "\n"


def _answer(row, values, progress):
    if row["name"] == "render":
        answer, lines, good = drawing.run(row, values, progress)
    else:
        answer, lines, good = _pcmlab.run(row["name"], values, progress)
        answer = json.loads(answer)
    for warning in answer["warnings"]:
        warnings.warn(warning, stacklevel=3)
    return Answer(answer, "\n".join(lines), good)


def _function(row):
    arguments = {_name(a["key"]): a for a in row["arguments"]}
    returns = "Union[Answer, numpy.ndarray]" if row["name"] == "render" else Answer
    signature = inspect.Signature(_parameters(row), return_annotation=returns)

    def run(*args, **kwargs):
        given = signature.bind(*args, **kwargs).arguments
        progress = callback(given.pop("progress", None))
        # In the order of the call, which is that of steps.
        given = {**{name: value for name, value in given.items() if name not in kwargs},
                 **{name: given[name] for name in kwargs if name in given}}
        values = [(arguments[name]["key"], _value(arguments[name], value)) for name, value in given.items() if value is not None]
        if row["name"] == "render" and "output" not in dict(values):
            return drawing.array_of(lambda file: _answer(row, [*values, ("output", [file])], progress))
        return _answer(row, values, progress)

    run.__name__ = run.__qualname__ = _name(row["name"])
    run.__module__ = __name__
    run.__signature__ = signature
    run.__doc__ = _document(row)
    return run


rows = [row for row in json.loads(_pcmlab.usage()) if not row["name"].endswith("_selected")]
for _row in rows:
    if _row["name"] == "render":
        _output = next(a for a in _row["arguments"] if a["key"] == "output")
        _output.update(required=False, without="none, and the picture is returned: an array of bytes, height x width x 4, or x 3 "
                                               "where the background is not transparent")
    _made = _function(_row)
    globals()[_made.__name__] = _made
    __all__.append(_made.__name__)
del _row, _made, _output
