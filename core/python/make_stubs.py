"""Writes operations.pyi: signatures of the operations for editors and type checkers, made of the module itself."""

import argparse
import importlib
import inspect
import pathlib
import sys
import textwrap
import types

TYPES = {"flag": "bool", "whole": "int", "real": "float", "bytes": "Union[int, str]", "text": "str", "choice": "str",
         "words": "Sequence[str]", "texts": "Sequence[str]", "numbers": "Sequence[float]", "file": "Path", "output": "Path",
         "outputs": "Sequence[Path]", "output_tree": "Path", "tree": "Path", "trees": "Sequence[Path]", "inputs": "Sequence[Path]",
         "cloud": "Union[Path, Sequence[Path]]", "step": "Union[Step, Sequence[Step]]"}
HEAD = '''"""Made of the table of operations; not to be edited."""

import os
from typing import Any, Callable, Optional, Sequence, Union

import numpy

Path = Union[str, "os.PathLike[str]"]
Step = Union[float, str, tuple, dict[str, Any]]
Progress = Union[None, bool, Callable[[float, str], Optional[bool]]]

class Answer(dict[str, Any]):
    text: str
    good: bool
'''


def stub(function, row, name_of):
    arguments = {name_of(a["key"]): a for a in row["arguments"]}
    parts = []
    for parameter in inspect.signature(function).parameters.values():
        if parameter.kind is parameter.KEYWORD_ONLY and "*" not in parts:
            parts.append("*")
        kind = "Progress" if parameter.name == "progress" else TYPES[arguments[parameter.name]["type"]]
        if parameter.default is parameter.empty:
            parts.append(f"{parameter.name}: {kind}")
        elif parameter.default is None and parameter.name != "progress":
            parts.append(f"{parameter.name}: Optional[{kind}] = ...")
        else:
            parts.append(f"{parameter.name}: {kind} = ...")
    document = textwrap.indent(inspect.getdoc(function), "    ")
    returns = inspect.signature(function).return_annotation
    returns = returns if isinstance(returns, str) else returns.__name__
    return f'def {function.__name__}({", ".join(parts)}) -> {returns}:\n    """{document.strip()}\n    """\n'


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--package", type=pathlib.Path, required=True)
    package = parser.parse_args().package
    # Without the package's __init__, which needs numpy.
    whole = types.ModuleType("pcmlab")
    whole.__path__ = [str(package)]
    sys.modules["pcmlab"] = whole
    operations = importlib.import_module("pcmlab.operations")

    stubs = [stub(getattr(operations, operations._name(row["name"])), row, operations._name) for row in operations.rows]
    (package / "operations.pyi").write_text(HEAD + "\n" + "\n".join(stubs), encoding="utf-8")


if __name__ == "__main__":
    main()
