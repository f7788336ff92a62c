"""The table as Markdown: operations and cases with letters, the words of refusals, and the errors."""
import collections

LETTERS = {"right": "+", "refused": "r", "defect": "D"}
WORST = {"right": 0, "refused": 1, "defect": 2}


def name_of(row):
    return row["operation"] + (" " + row["variant"] if row["variant"] else "")


def letters(rows, names):
    """A line for each case, a column for each operation: the worst of its variants."""
    found = {}
    for row in rows:
        key = row["case"], row["operation"]
        found[key] = max(found.get(key, "right"), row["kind"], key=WORST.get)
    cases = list(dict.fromkeys(row["case"] for row in rows))
    lines = ["| case | " + " | ".join(names) + " |", "|---|" + ":-:|" * len(names)]
    return lines + [f"| {case} | " + " | ".join(LETTERS.get(found.get((case, name)), "") for name in names) + " |" for case in cases]


def shared_words(rows):
    """Words -> the cells that were answered so."""
    found = collections.defaultdict(list)
    for row in rows:
        found[row["words"]].append(f"{name_of(row)} on {row['case']}")
    return found


def list_words(rows):
    lines = []
    for words, cells in sorted(shared_words(rows).items(), key=lambda item: (item[1][0], item[0])):
        more = f" and {len(cells) - 2} more" if len(cells) > 2 else ""
        lines.append(f"- {'; '.join(cells[:2])}{more}: {words}")
    return lines


def errors(rows):
    lines = ["| operation | cells with an oracle | largest error | unit | on |", "|---|--:|--:|---|---|"]
    for name in dict.fromkeys(name_of(row) for row in rows):
        own = [row for row in rows if name_of(row) == name and "error" in row]
        if own:
            worst = max(own, key=lambda row: row["error"])
            lines.append(f"| {name} | {len(own)} | {worst['error']:.2g} | {worst['unit']} | {worst['case'] if worst['error'] > 0 else ''} |")
    return lines


def write(path, rows, operations):
    """Prints the count, and returns the number of defects."""
    names = [operation["name"] for operation in operations]
    rows.sort(key=lambda row: (names.index(row["operation"]) if row["operation"] in names else len(names)))
    kinds = collections.Counter(row["kind"] for row in rows)
    with_oracle = sum("error" in row for row in rows)
    count = (f"{len(rows)} cells of {len({row['operation'] for row in rows})} operations and {len({row['case'] for row in rows})} cases: "
             f"{kinds['right']} right ({with_oracle} against an oracle), {kinds['refused']} refused, {kinds['defect']} defects")
    print(count)
    lines = ["# The stiff and the extreme", "", count + ".", "",
             "`+` right, `r` refused with words, `D` a defect; the worst of an operation's variants. Made by `bench/report/stiff/run.py`.", ""]
    lines += letters(sorted(rows, key=lambda row: row["case"]), names)
    for title, text in (("Errors", errors(rows)), ("Defects", list_words([row for row in rows if row["kind"] == "defect"])),
                        ("Refusals", list_words([row for row in rows if row["kind"] == "refused"]))):
        lines += ["", f"## {title}", "", *(text or ["None."])]
    path.write_text("\n".join(lines) + "\n")
    return kinds["defect"]
