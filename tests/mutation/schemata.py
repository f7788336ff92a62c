"""Many faults in one build: each faulty expression or statement stands in the source next to the good one, and the environment
variable PCM_CHOSEN_FAULT says which of the faults is at work (chosen_fault.h)."""

import re

import operators

OPEN, CLOSE = "([{", ")]}"
KEYWORDS = {"return", "case", "throw", "else", "do"}
CONSTANT = re.compile(r"^\s*(?:static |inline )*constexpr [\w:<>, ]+ (?P<name>\w+)(?:\[.*\])?(?: = |\{)")


def code_of(line):
    """The line with a word in place of each string and character, and without a comment, of the same length."""
    word = lambda match: "s" * len(match[0])
    line = re.sub(r'"(\\.|[^"\\])*"|\'(\\.|[^\'\\])*\'', word, line)
    return re.sub(r"//.*", lambda match: " " * len(match[0]), line)


def without_comment(line):
    return line[:len(code_of(line).rstrip())].lstrip()


def change(good, faulty):
    """The columns [begin, end) of the good line that the faulty one has otherwise."""
    begin = 0
    while begin < min(len(good), len(faulty)) and good[begin] == faulty[begin]:
        begin += 1
    after = 0
    while after < min(len(good), len(faulty)) - begin and good[-1 - after] == faulty[-1 - after]:
        after += 1
    return begin, len(good) - after


def ends_expression(code, i):
    """Whether the character ends an expression that is not in brackets: no operand of it is on the other side."""
    if code[i] in ";,?":
        return True
    if code[i] == ":":
        return code[i - 1] != ":" and code[i + 1:i + 2] != ":"
    return code[i] == "=" and code[i + 1:i + 2] != "=" and code[i - 1] not in "=<>!"


def begin_of_expression(code, first):
    depth, closed = 0, None
    while first > 0:
        c = code[first - 1]
        if depth == 0 and (ends_expression(code, first - 1) or c in OPEN or c == "}" and code[first:first + 1].isspace()):
            return first
        if depth == 0 and c.isspace():
            word = re.search(r"\b([a-z]+)\s$", code[max(0, first - 8):first])
            if word and word[1] in KEYWORDS:
                return first
        if depth == 0 and c in CLOSE:
            closed = first
        depth += (c in CLOSE) - (c in OPEN)
        first -= 1
        if depth == 0 and c == "(" and re.search(r"\b(if|for|while|switch) $", code[max(0, first - 8):first]):
            return closed  # the condition before a statement
    return first


def end_of_expression(code, last, operator_end):
    depth = 0
    while last < len(code):
        c = code[last]
        if depth == 0 and (c in CLOSE or c == "{" and code[max(0, last - 100):last].rstrip().endswith(")")):  # the latter is a body
            return last
        if depth == 0 and ends_expression(code, last) and last >= operator_end:
            return last
        depth += (c in OPEN) - (c in CLOSE)
        last += 1
    return last


def expression_around(code, begin, end, operator_end):
    """The widest [first, last) around [begin, end) that is an expression, without a comma, an assignment, or the operands of ?: .
    `operator_end`: where an operator of assignment ends that is itself changed."""
    first, last = begin_of_expression(code, begin), end_of_expression(code, end, operator_end)
    while first < begin and code[first].isspace():
        first += 1
    while last > end and code[last - 1].isspace():
        last -= 1
    return first, last


class Source:
    """A source whose faults are inserted; the lines keep their numbers."""

    def __init__(self, text):
        self.text = text
        self.lines = text.split("\n")
        self.code = "\n".join(map(code_of, self.lines))
        self.starts = [0]
        for line in self.lines:
            self.starts.append(self.starts[-1] + len(line) + 1)
        self.around = []     # (begin, end, text before it, text after it)
        self.constants = set()  # where a constexpr becomes a const

    def fault(self, index, what, faulty, number, lenient=False):
        """Inserts a fault; the lines in which its code begins and ends. `lenient`: for constexpr functions."""
        call = f"pcm_fault{'_at_run_time' if lenient else ''}({number})"
        line, start = self.lines[index], self.starts[index]
        if what.endswith(("-> if (false)", "-> if (true)")):
            begin = line.index("if (") + len("if (")
            end = operators.closing(code_of(line), begin - 1)
            before, after = f"!{call} && (" if what.endswith("(false)") else f"{call} || (", ")"
            begin, end = start + begin, start + end
        elif what.endswith("; -> nothing"):
            begin, end = start + len(line) - len(line.lstrip()), start + len(line)
            before, after = f"{{ if (!{call}) {{ ", " } }"
        elif what == "break; -> continue;":
            begin = start + change(line, faulty)[0]
            end = begin + len("break;")
            before, after = f"{{ if ({call}) continue; else ", " }"
        else:
            first, last = change(line, faulty)
            operator_end = start + first + (2 if re.match(r"[-+]=", what) else 0)
            begin, end = expression_around(self.code, start + first, start + last, operator_end)
            wrong = self.text[begin:start + first] + faulty[first:len(faulty) - len(line) + last] + self.text[start + last:end]
            before, after = f"({call} ? ({' '.join(map(without_comment, wrong.split(chr(10))))}) : (", "))"
            constant = None if lenient else CONSTANT.match(line)
            if constant:
                self.constants.add(start + line.index("constexpr"))
        self.around.append((begin, end, before, after))
        return self.text.count("\n", 0, begin), self.text.count("\n", 0, end)

    def broken(self, header):
        """The text with all its faults, none of which is at work by itself."""
        inserted = {}  # position -> [(order, text)]: what ends before what begins, the wider around the narrower
        for order, (begin, end, before, after) in enumerate(self.around):
            inserted.setdefault(begin, []).append(((1, -(end - begin), order), before))
            inserted.setdefault(end, []).append(((0, end - begin, -order), after))
        for begin in self.constants:
            inserted.setdefault(begin, []).append(((2, 0, 0), "const"))
        parts, at = [], 0
        for position in sorted(inserted):
            parts += [self.text[at:position], *(text for _, text in sorted(inserted[position]))]
            at = position + (len("constexpr") if position in self.constants else 0)
        return f'#include "{header}"\n#line 1\n' + "".join(parts) + self.text[at:]
