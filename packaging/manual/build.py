#!/usr/bin/env python3
"""Makes the manual: HTML of the pages here, and a page of each operation from the table of operations.

    build.py --bin BUILD/bin --out FOLDER     runs the commands of the pages, in order, for the pictures that they show

Pictures of MeshLab's window lie next to the pages: window_pictures makes them. A command that fails, or that selects no point, ends the build, as does a link or a picture that leads nowhere. Needs the Python package
markdown (Debian: python3-markdown). The pages are read without a network: FOLDER/index.html.
"""
import argparse
import html
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import markdown

HERE = pathlib.Path(__file__).resolve().parent
# The order of the pages, under headings.
CONTENTS = [("", ["index", "install", "window"]), ("From start to end", ["drawing", "facade", "measuring", "epochs", "tile", "notebook"]),
            ("Reference", ["operations", "formats", "servers", "trust", "messages", "python", "library", "glossary"])]
REPOSITORY = "../../"  # links to files that are not part of the manual begin so


class Failure(Exception):
    pass


def title_of(text):
    return re.search(r"^# (.+)$", text, re.MULTILINE)[1]


def commands(text):
    """The lines of the shell blocks of a page."""
    blocks = re.findall(r"^```sh\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    return [line for block in blocks for line in block.splitlines() if line.strip()]


def pictures(text):
    return re.findall(r"!\[[^\]]*\]\(([^)]+)\)", text)


def selects_nothing(output):
    """Whether an output is that of a command that selected no point."""
    output = re.sub(r"^error .*; .* read; peak memory .*$", "", output, flags=re.M)  # what it took, which may be no point
    counts = [int(number.replace(",", "")) for number in re.findall(r"([\d,]+) points", output)]
    return "no point is selected" in output or "the cloud's points lie" in output or (bool(counts) and counts[0] == 0)


def with_picture_size(line, size):
    """The command line with all pictures that `pcmlab render` makes of one size, WIDTHxHEIGHT."""
    return re.sub(r"pcmlab render (?:\"[^\"]*\"|[^;|\"])*", lambda one: re.sub(r" --size \S+", "", one[0].rstrip()) + f" --size {size}", line)


def run_page(name, text, programs, folder, picture_size=None):
    """Runs a page's commands in the folder."""
    environment = dict(os.environ, PATH=f"{programs}:{os.environ['PATH']}")
    for line in commands(text):
        if picture_size:
            line = with_picture_size(line, picture_size)
        result = subprocess.run(["bash", "-euc", line], cwd=folder, env=environment, stdin=subprocess.DEVNULL, capture_output=True,
                                text=True, check=False)
        output = result.stdout + result.stderr
        if result.returncode != 0 or selects_nothing(result.stdout):
            raise Failure(f"{name}: {line}\n{output}")


def default_of(argument):
    if argument.get("default") is not None:
        return str(argument["default"])
    return argument.get("without") or ("" if argument.get("required") else "none")


def row(*cells):
    return "| " + " | ".join(str(cell).replace("|", "\\|").replace("\n", " ") for cell in cells) + " |"


def range_of(argument):
    parts = []
    if argument.get("choices"):
        parts.append(", ".join(f"*{choice}*" for choice in argument["choices"]))
    for key, words in (("least", "at least"), ("above", "more than"), ("most", "at most"), ("below", "less than")):
        if argument.get(key) is not None:
            parts.append(f"{words} {argument[key]:g}")
    return "; ".join(parts)


def plain(text):
    """A help text as Markdown shows it: no character of it is taken for markup."""
    return re.sub(r"([\\`*_<>\[\]])", lambda found: html.escape(found[1]) if found[1] in "<>" else "\\" + found[1], text)


def operation_page(operation):
    lines = [f"# {operation['name']}", "", plain(operation["help"]) + ".", ""]
    if operation.get("details"):
        lines += [operation["details"].replace("<br>", "\n\n"), ""]
    if operation.get("title"):
        lines += [f"In MeshLab: *{operation['title']}*.", ""]
    for advanced, heading in ((False, "Arguments"), (True, "Arguments for special cases")):
        arguments = [argument for argument in operation["arguments"] if bool(argument.get("advanced")) == advanced]
        if arguments:
            lines += [f"## {heading}", "", row("Option", "In a script", "Meaning", "Default", "Unit, range"), row(*["---"] * 5)]
        for argument in arguments:
            unit = "; ".join(part for part in (argument.get("unit") or "", range_of(argument)) if part)
            lines.append(row(f"`{argument['option']}`" if argument.get("option") else "", f"`{argument['script']}`" if argument.get("script") else "",
                             plain(argument["help"]), plain(default_of(argument)) if not argument.get("required") else "*required*", unit))
        lines.append("")
    if operation.get("results"):
        lines += ["## Results", "", "With `--json`, and in Python.", "", row("Key", "Type", "Meaning", "Unit"), row(*["---"] * 4)]
        lines += [row(f"`{result['key']}`", plain(result["type"]), plain(result["help"]), plain(result["unit"])) for result in operation["results"]]
    return "\n".join(lines) + "\n"


def read_pages(programs):
    """Markdown by page name: those written by hand, a list of operations, and a page of each."""
    pages = {path.stem: path.read_text(encoding="utf-8") for path in sorted((HERE / "pages").glob("*.md"))}
    table = json.loads(subprocess.run([programs / "pcmlab", "help", "--json"], capture_output=True, text=True, check=True).stdout)
    listed = ["# All operations", "", f"Version {table['version']}. `pcmlab OPERATION`, in MeshLab *Filters > Point Clouds*, in Python `pcmlab.OPERATION()`.",
              "", row("Operation", "What it does"), row("---", "---")]
    for operation in table["commands"]:
        pages[f"operation-{operation['name']}"] = operation_page(operation)
        listed.append(row(f"[{operation['name']}](operation-{operation['name']}.md)", plain(operation["help"])))
    pages["operations"] = "\n".join(listed) + "\n"
    named = [name for _, names in CONTENTS for name in names]
    forgotten = [name for name in pages if name not in named and not name.startswith("operation-")]
    if forgotten or [name for name in named if name not in pages]:
        raise Failure(f"the contents and the pages differ: {forgotten or named}")
    return pages


def check_links(pages):
    for name, text in pages.items():
        for target in re.findall(r"(?<!!)\[[^\]]*\]\(([^)#]+)[^)]*\)", text):
            inside = target.endswith(".md") and "/" not in target and target[:-3] in pages
            if not inside and not target.startswith("https://") and not (
                    target.startswith(REPOSITORY) and (HERE.parents[1] / target[len(REPOSITORY):]).exists()):
                raise Failure(f"{name}: the link {target} leads nowhere")


def navigation(pages, here):
    lines = []
    for heading, names in CONTENTS:
        if heading:
            lines.append(f"<p>{heading}</p>")
        for name in names:
            marked = ' class="here"' if name == here or (name == "operations" and here.startswith("operation-")) else ""
            title = "Start" if name == "index" else title_of(pages[name])
            lines.append(f'<a href="{name}.html"{marked}>{html.escape(title)}</a>')
    return "\n".join(lines)


def html_of(pages, name):
    text = re.sub(r"\]\((\w[\w-]*)\.md(#[^)]*)?\)", r"](\1.html\2)", pages[name])
    text = re.sub(r"\[([^\]]*)\]\(" + re.escape(REPOSITORY) + r"([^)]+)\)", r"\1 (`\2`)", text)  # the repository is not installed
    body = markdown.markdown(text, extensions=["tables", "fenced_code"])
    return (f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n<meta name="viewport" content="width=device-width">\n'
            f"<title>{html.escape(title_of(pages[name]))}</title>\n<link rel=\"stylesheet\" href=\"style.css\">\n</head>\n<body>\n"
            f"<nav>\n{navigation(pages, name)}\n</nav>\n<main>\n{body}\n</main>\n</body>\n</html>\n")


def copy_pictures(name, text, folder, out):
    """The pictures of a page: those that its commands made in the folder, or that lie next to the page."""
    for picture in pictures(text):
        made = [path for path in (pathlib.Path(folder) / picture, HERE / "pages" / picture) if path.is_file()]
        if not made:
            raise Failure(f"{name}: no command makes the picture {picture}")
        shutil.copy(made[0], out / picture)


def build(programs, out, keep=None, picture_size=None):
    """Makes the manual in the folder `out`. What a page's commands wrote is moved to keep/PAGE, where a folder is given. A test, which
    wants to see that pictures are made, may want them smaller than the pages have them: `picture_size`, WIDTHxHEIGHT."""
    pages = read_pages(programs)
    check_links(pages)
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    for name, text in pages.items():
        (out / f"{name}.html").write_text(html_of(pages, name), encoding="utf-8")
        with tempfile.TemporaryDirectory() as folder:
            run_page(name, text, programs, folder, picture_size)
            copy_pictures(name, text, folder, out)
            if keep and commands(text):
                shutil.copytree(folder, keep / name)
    shutil.copy(HERE / "style.css", out)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True, type=pathlib.Path, help="folder of the programs")
    parser.add_argument("--out", required=True, type=pathlib.Path, help="folder to make; an older manual in it is replaced")
    arguments = parser.parse_args()
    if arguments.out.exists() and not (arguments.out / "index.html").is_file() and any(arguments.out.iterdir()):
        sys.exit(f"{arguments.out}: not a manual, and not empty: choose another folder")
    try:
        build(arguments.bin.resolve(), arguments.out)
    except Failure as failure:
        sys.exit(str(failure))


if __name__ == "__main__":
    main()
