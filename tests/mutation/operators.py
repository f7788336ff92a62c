"""Faults of one line, as a tired programmer makes them. They rely on the layout of .clang-format: blanks stand around binary
operators, and a statement that fits stands on one line."""

import re

SWAPS = [(" < ", " <= "), (" <= ", " < "), (" > ", " >= "), (" >= ", " > "), (" == ", " != "), (" != ", " == "),
         (" + ", " - "), (" - ", " + "), (" * ", " / "), (" / ", " * "), (" % ", " / "), (" && ", " || "), (" || ", " && "),
         (" << ", " >> "), (" >> ", " << "), (" & ", " | "), (" | ", " & "), (" += ", " -= "), (" -= ", " += "),
         ("std::min(", "std::max("), ("std::max(", "std::min("), ("true", "false"), ("false", "true"), ("break;", "continue;"),
         ("std::floor(", "std::ceil("), ("std::ceil(", "std::floor("), ("std::abs(", "("), ("std::fabs(", "(")]
WORD = re.compile(r"\w")
NUMBER = re.compile(r"(?<![\w.\"'])(\d+)(?![\w.'])")
NOT = re.compile(r"!(?=[a-z(])")
STATEMENT = re.compile(r"^\s+(?!return\b|throw\b|case\b|using\b|delete\b|typedef\b|static_assert\b|friend\b|else\b)"
                       r"[\w.:>\[\]-]+(\(.*\)| (\+|-|\*|/|\||&)?= .*);$")
# Lines without faults: text output, what is no statement, and hints that change no result.
STREAM = re.compile(r"std::c(out|err)|ofstream|#include|#pragma|static_assert|template|operator")
HINT = re.compile(r"^\s*(?:for \(.*\) |if \(.*\) )?[\w.:>\[\]-]+(\.|->)(reserve|shrink_to_fit)\(.*\);$")


def code_of(line):
    """The line with strings, characters and comments blanked out, of the same length."""
    blank = lambda match: " " * len(match[0])
    line = re.sub(r'"(\\.|[^"\\])*"|\'(\\.|[^\'\\])*\'', blank, line)
    return re.sub(r"//.*", blank, line)


def faults_of(line):
    """The faults of a line: (what was changed, the line with the fault)."""
    code = code_of(line)
    if not code.strip() or STREAM.search(code) or HINT.match(code):
        return []
    faults = []

    def replace(begin, end, new):
        faults.append((f"{line[begin:end].strip()} -> {new.strip() or 'nothing'}", line[:begin] + new + line[end:]))

    for old, new in SWAPS:
        for match in re.finditer(re.escape(old), code) if old in code else ():
            begin, end = match.span()
            part_of_a_word = (WORD.match(old[0]) and begin and WORD.match(code[begin - 1])) or \
                (WORD.match(old[-1]) and end < len(code) and WORD.match(code[end]))
            if not part_of_a_word:
                replace(begin, end, new)
    for match in NUMBER.finditer(code):
        replace(*match.span(), str(int(match[1]) + 1))
    for match in NOT.finditer(code):
        replace(*match.span(), "")
    condition = re.match(r"^\s*(?:\} else )?if \(", code)
    if condition and " = " not in code:
        end = closing(code, condition.end() - 1)
        if end:
            inside = line[condition.end():end]
            faults.append((f"if ({inside}) -> if (false)", f"{line[:condition.end()]}false{line[end:]}"))
            faults.append((f"if ({inside}) -> if (true)", f"{line[:condition.end()]}true{line[end:]}"))
    if STATEMENT.match(code) and code.count("(") == code.count(")") and not re.match(r"^\s+(const|auto|std::\w+ |\w+ \w+)", code):
        indent = len(line) - len(line.lstrip())
        faults.append((f"{line.strip()} -> nothing", line[:indent] + ";"))
    return faults


def closing(code, opening):
    """The index of the bracket that closes the one at `opening`, or None when it is on another line."""
    depth = 0
    for i in range(opening, len(code)):
        depth += (code[i] == "(") - (code[i] == ")")
        if depth == 0:
            return i
    return None
