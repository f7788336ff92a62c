"""The page: REPORT.md with its pictures next to it, and REPORT.html, which has them inside."""
import base64
import html
import re

from report import chapters, curves, features, plots

# What a newcomer meets first, in this order: (feature, part of the name of the curve; the last place of it is shown).
FIRST = [("pictures", "town, at rest"), ("nearest", ""), ("normals", ""), ("fits", "cylinder"), ("volume", ""), ("subsample", "")]
HEAD = """A setting of a feature that trades accuracy for time is a point of a curve: its **true** error, against an exact answer or generated truth, over seconds of the processor, on one
thread. The default has a ring. All programs of a curve take turns in one run; times are medians. *map*: the same cloud at x 500,000, y 4,500,000 m, where a float has steps of half a metre.
Times of `pcmlab` are of the whole process, from the tree on disk to the result on disk, unless a chapter says otherwise; those of peers are of the computation alone, with the positions in memory."""


def label(row):
    return "**" + row["setting"] + "** (default)" if row["default"] else row["setting"]


def extras(rows):
    """Columns that only this feature has: name of the column -> key of the rows."""
    known = {"place", "program", "setting", "default", "cpu", "cpu_range", "error", "command", "curve"}
    return list(dict.fromkeys(key for row in rows for key in row if key not in known))


def table_of(rows):
    more = extras(rows)
    has_curve = any(row.get("curve") for row in rows)
    head = [*(["curve"] if has_curve else []), "place", "program", "setting", "CPU s", "least to most", "error", *more, "command"]
    cells = []
    for row in rows:
        spread = "" if row["cpu_range"][0] == row["cpu_range"][1] else " to ".join(curves.number(value) for value in row["cpu_range"])
        values = [row.get(key) for key in more]
        cells.append([*([row.get("curve", "")] if has_curve else []), row["place"], row["program"], label(row), curves.number(row["cpu"]), spread, curves.number(row["error"]),
                      *(value if isinstance(value, str) else curves.number(value) for value in values), f"`{row['command']}`"])
    return head, cells


def cell(key, value):
    return f"`{value}`" if key == "command" else value if isinstance(value, str) else curves.number(value)


def machine_line(figures):
    what = figures["machine"]
    load = ", ".join(f"{value:.1f}" for value in figures["load"])
    return (f"Measured on {what['processor']}, {what['cores']} cores, {what['memory']}, {what['kernel']}; OpenGL {what['OpenGL']}; {what['versions']}; load {load} before and after; "
            f"size *{figures['size']}*; a start of `pcmlab` takes {what['start of pcmlab, CPU ms']} ms of the processor; {figures['took']:.0f} s in all.")


def chapter(name, figures, folder):
    feature = features.load(name)
    rows, floor = figures["rows"], getattr(feature, "FLOOR", 0.0)
    is_curve = rows and not hasattr(feature, "TABLE")
    yield "heading", 2, feature.TITLE
    yield "text", feature.WHAT
    if hasattr(feature, "TABLE"):
        yield "table", "", list(feature.TABLE), [[cell(key, row.get(key)) for key in feature.TABLE] for row in rows]
    if is_curve:
        plots.feature(folder / f"{name}.png", rows, feature.ERROR)
        yield "picture", f"report/{name}.png", f"{feature.TITLE}: {feature.ERROR} over CPU seconds"
        yield "list", curves.sentences(rows, floor)
        if curves.summary(rows, floor)[-1] and hasattr(feature, "WHY"):
            yield "text", f"Why not: {feature.WHY}"
    if hasattr(feature, "NOTES"):
        yield "list", feature.NOTES
    if feature.EXACT:
        yield "text", "Held by " + ", ".join(f"`{test}`" for test in features.tests_of(feature)) + "."
    if figures["absent"]:
        yield "text", "Absent here: " + "; ".join(figures["absent"]) + "."
    if is_curve:
        yield "table", f"The figures, and `run.py --only {name}`", *table_of(rows)
    yield "text", machine_line(figures)


def overview(kept, folder):
    chosen = []
    for name, part in FIRST:
        figures = kept.get(name)
        found = [rows for (_, curve), rows in curves.curves(figures["rows"]).items() if part in curve] if figures else []
        if found:
            feature = features.load(name)
            chosen.append((f"{feature.TITLE}, {found[-1][0]['place']}".rstrip(", "), feature.ERROR, found[-1]))
    if not chosen:
        return
    plots.overview(folder / "overview.png", chosen)
    yield "picture", "report/overview.png", "Error over processor time of the features that a newcomer meets first; a ring is the default, warm colours are ours"


def contents(kept, names):
    """A line for each feature: defaults at the knee, and peers that ours is below and left of."""
    cells = []
    for name in names:
        feature, figures = features.load(name), kept.get(name)
        if hasattr(feature, "TABLE"):
            continue
        at_knee, defaults, beaten, peers, left = curves.summary(figures["rows"], getattr(feature, "FLOOR", 0.0))
        cells.append([feature.TITLE, f"{at_knee} of {defaults}" if defaults else "", f"{beaten} of {peers}" if peers else "", "; ".join(left)])
    return ["feature", "defaults at the knee", "points of peers that ours is below and left of", "not beaten"], cells


def off_the_knee(kept, names):
    """A line for each default that its curve speaks against, and what a feature's DEFAULT_KEPT answers."""
    lines = []
    for name in names:
        feature, figures = features.load(name), kept.get(name)
        if hasattr(feature, "TABLE"):
            continue
        found = curves.off_the_knee(figures["rows"], getattr(feature, "FLOOR", 0.0))
        lines += [f"{feature.TITLE}: {line}" for line in found]
        if found and hasattr(feature, "DEFAULT_KEPT"):
            lines.append(f"{feature.TITLE}: {feature.DEFAULT_KEPT}")
    return lines


def blocks(kept, folder):
    names = [name for name in features.NAMES if kept.get(name)]
    yield "heading", 1, "Error over time, of every feature"
    yield "text", HEAD
    yield from overview(kept, folder)
    yield "text", "One command made this page, and makes it again: `python3 bench/report/run.py --bin build/release/bin --quick`, with the packages of `packaging/test-python`."
    yield "table", "", *contents(kept, names)
    missing = [features.load(name).TITLE for name in features.NAMES if name not in names]
    if missing:
        yield "text", "Not measured here: " + ", ".join(missing) + "."
    lines = off_the_knee(kept, names)
    if lines:
        yield "heading", 2, "Defaults that are not at the knee"
        yield "text", "A default is at the knee where no setting has its error (to 2 %) in less time (by a sixth), half of its error in as much time (to a fifth), or nearly its error (to a tenth) in half of the time."
        yield "list", lines
    for name in names:
        yield from chapter(name, kept.get(name), folder)
    yield "heading", 2, "Further chapters"
    yield "list", chapters.lines()


def markdown(block):
    kind, *what = block
    if kind == "heading":
        return "#" * what[0] + " " + what[1]
    if kind == "text":
        return what[0]
    if kind == "picture":
        return f"![{what[1]}]({what[0]})"
    if kind == "list":
        return "\n".join(f"- {line}" for line in what[0])
    title, head, cells = what
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head), *("| " + " | ".join(row) + " |" for row in cells)]
    table = "\n".join(lines)
    return f"<details><summary>{inline(title)}</summary>\n\n{table}\n\n</details>" if title else table


def inline(text):
    text = html.escape(text, quote=False)
    for pattern, tag in ((r"`([^`]+)`", "code"), (r"\*\*([^*]+)\*\*", "b"), (r"\*([^*]+)\*", "i")):
        text = re.sub(pattern, rf"<{tag}>\1</{tag}>", text)
    return re.sub(r"\[([^\]]+)\]\(([^)]+)\)", r'<a href="\2">\1</a>', text)


def as_html(block, out):
    kind, *what = block
    if kind == "heading":
        return f"<h{what[0]}>{html.escape(what[1])}</h{what[0]}>"
    if kind == "text":
        return f"<p>{inline(what[0])}</p>"
    if kind == "picture":
        data = base64.b64encode((out / what[0]).read_bytes()).decode()
        return f'<p><img alt="{html.escape(what[1])}" src="data:image/png;base64,{data}"></p>'
    if kind == "list":
        return "<ul>" + "".join(f"<li>{inline(line)}</li>" for line in what[0]) + "</ul>"
    title, head, cells = what
    rows = "".join("<tr>" + "".join(f"<td>{inline(cell)}</td>" for cell in row) + "</tr>\n" for row in cells)
    table = "<table><tr>" + "".join(f"<th>{html.escape(cell)}</th>" for cell in head) + f"</tr>\n{rows}</table>"
    return f"<details><summary>{inline(title)}</summary>{table}</details>" if title else table


STYLE = ("body{font:16px/1.5 sans-serif;max-width:70em;margin:2em auto;padding:0 1em}img{max-width:100%}table{border-collapse:collapse;font-size:13px}"
         "td,th{border:1px solid #ccc;padding:2px 6px;text-align:left}code{background:#f3f3f3}")


def write(out, kept):
    made = list(blocks(kept, out / "report"))
    (out / "REPORT.md").write_text("\n\n".join(markdown(block) for block in made) + "\n", encoding="utf-8")
    body = "\n".join(as_html(block, out) for block in made)
    (out / "REPORT.html").write_text(f'<!DOCTYPE html><html lang="en"><meta charset="utf-8"><title>Error over time</title><style>{STYLE}</style>\n{body}\n</html>\n', encoding="utf-8")


def check(out, kept, names):
    """Of a smoke run: every feature has its chapter, curve and figures on the page, a default is marked, and what is exact has no error."""
    text, page = (out / "REPORT.md").read_text(encoding="utf-8"), (out / "REPORT.html").read_text(encoding="utf-8")
    for name in names:
        feature, figures = features.load(name), kept.get(name)
        assert figures and figures["rows"], f"{name} has no figures"
        assert f"## {feature.TITLE}\n" in text and f"<h2>{feature.TITLE}</h2>" in page, f"{name} has no chapter"
        if hasattr(feature, "TABLE"):
            continue
        assert (out / "report" / f"{name}.png").stat().st_size > 5000, f"the curve of {name} is empty"
        for place in {row["place"] for row in figures["rows"]}:
            mine = [row for row in figures["rows"] if row["place"] == place and curves.ours(row)]
            assert not mine or not getattr(feature, "HAS_DEFAULT", True) or any(row["default"] for row in mine), f"{name}, {place}: no default is marked"
            exact = [row for row in mine if row["default"] and feature.EXACT]
            assert all(row["error"] <= max(feature.FLOOR, 0) for row in exact), f"{name}, {place}: what is exact has an error"
            assert all(row["command"] in text for row in mine), f"{name}, {place}: a command is not on the page"
    assert not features.without_test(names), f"tests that are named and not there: {features.without_test(names)}"
    assert page.count("data:image/png;base64,") == text.count("![") and 'src="report' not in page, "REPORT.html needs files next to it"
