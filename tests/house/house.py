"""What holds the house together, as checks over the sources: who may include whom, sizes, layout, words.

Each check takes a Tree and returns a list of complaints, one line of text per complaint. test_house.py runs them on the project, and
on small trees with one fault each.
"""
import pathlib
import re
import shutil
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
SOURCES = (".h", ".cpp")
LIST_BEGINS = "```floors"

# Files over 500 lines and functions over 60, each with the reason why it is not divided.
LONG_FILES: dict[str, str] = {}
LONG_FUNCTIONS: dict[str, str] = {
    "core/io/text/text_rows.cpp:template <bool Blanks>": "most of the time of reading text: one loop, its parts inlined",
    "core/build/bins/row_packing.cpp:const std::byte* RowPacking::unpack_block(const std::byte* data, const std::byte* end, "
    "std::byte* rows,": "the shapes of all words, then their bits",
    "core/build/levels/morton_sort.cpp:template <class Coord>": "the sort's passes share their counters",
    "core/build/levels/poisson_pass.cpp:template <class Coord>": "the sampler's inner loop, vectorised as one",
    "tests/build/node_builder_test.cpp:template <class Coord>": "one walk over the nodes, with all their invariants",
}
FILE_LINES = 500
FUNCTION_LINES = 60

TOOLS = ("align", "clip", "fit", "measure", "pick", "select", "walk", "all")

# Headers of other packages and the rooms that may use them; a pattern, then rooms.
PACKAGES = {
    r"<(GL|EGL)/": {"gl/base", "gl/l1", "gl/compute", "gl/draw", "offscreen", "tests", "bench", "plugin/overlay",
                     "plugin/meshlab/render", "examples"},
    r"<png.h>": {"offscreen"},
    r"<dxflib/": {"cad"},
    r"<[A-Za-z0-9_]+\.hxx>": {"cad", "tests"},
    r"<CLI/": {"cli", "bench"},
    r"<Q[A-Za-z0-9]+[>/]": {"plugin/scene", "plugin/panels", "plugin/overlay", "plugin/tools", *("plugin/tools/" + tool for tool in TOOLS),
                      "plugin/meshlab", *("plugin/meshlab/" + part for part in ("io", "render", "filter", "edit", "2021/whole")),
                      "plugin/filter", "plugin/settings", "tests", "bench"},
    r"<pcl/": {"fit", "bench"},
    r"<flann/": {"knn", "bench"},
    r"<nanoflann": {"tests", "bench"},
}


class Tree:
    """The C++ sources below a folder: path relative to it -> text."""

    def __init__(self, sources, arrows):
        self.sources = sources
        self.arrows = arrows

    @staticmethod
    def of_project(root=ROOT):
        names = [path.relative_to(root).as_posix() for folder in ("core", "plugin", "tests", "bench")
                 for path in sorted((root / folder).rglob("*")) if path.suffix in SOURCES]
        return Tree({name: (root / name).read_text(encoding="utf-8") for name in names},
                    read_arrows((root / "core" / "README.md").read_text(encoding="utf-8")))


class Arrows(dict):
    """Room -> set of rooms that it may include: all rooms of lower floors, and those named in its line, of its own floor."""

    def __init__(self):
        super().__init__()
        self.floors = {}  # room -> name of its floor
        self.named = {}   # room -> the rooms that its line names


def read_arrows(text):
    """The block of core/README.md: names of floors, lowest first, and below each, indented, its rooms: ROOM: ROOM..."""
    if LIST_BEGINS not in text:
        raise ValueError(f"core/README.md has no block {LIST_BEGINS}")
    block = text.split(LIST_BEGINS, 1)[1].split("```", 1)[0]
    arrows, floor, below = Arrows(), None, set()
    for line in block.strip().splitlines():
        if not line.startswith(" "):
            floor, below = line.strip(), set(arrows)
            continue
        room, _, rooms = line.partition(":")
        room = room.strip()
        arrows.floors[room] = floor
        arrows.named[room] = set(rooms.split())
        arrows[room] = below | arrows.named[room]
    for room, rooms in arrows.named.items():
        for other in rooms:
            if other not in arrows:
                raise ValueError(f"core/README.md: {room} may use {other}, which is not a room of the list")
    return arrows


def room_of(name, arrows):
    """The room of a source file: the longest folder of its path that the list has, without the leading core/."""
    if name.startswith(("tests/", "bench/")):
        return name.split("/")[0]
    path = name.removeprefix("core/")
    folder = path.rpartition("/")[0]
    if not folder:
        return path.partition(".")[0]  # a source at the root of core/ is a room of its own
    while folder and folder not in arrows:
        folder = folder.rpartition("/")[0]
    return folder or path.split("/")[0]


def includes_of(text):
    return re.findall(r'^#\s*include\s+([<"][^>"]+[>"])', text, re.MULTILINE)


def check_arrows(tree):
    complaints = []
    for name, text in tree.sources.items():
        room = room_of(name, tree.arrows)
        everything = room in ("tests", "bench")
        if not everything and room not in tree.arrows:
            complaints.append(f"{name}: the room {room} is not in the list of core/README.md")
            continue
        for include in includes_of(text):
            path = include[1:-1]
            for pattern, rooms in PACKAGES.items():
                if re.match(pattern, include) and room not in rooms:
                    complaints.append(f"{name}: includes {include}, which only {', '.join(sorted(rooms))} may use")
            if include[0] == "<":
                continue
            target = path.removeprefix("pcm/") if path.startswith("pcm/") else path
            if not path.startswith(("pcm/", "plugin/", "tests/", "bench/")):
                if room.startswith(("plugin/", "tests", "examples")) or room == "bench":
                    continue  # headers of MeshLab, or of the example's own folder
                complaints.append(f"{name}: includes \"{path}\" without the prefix pcm/")
                continue
            other = room_of(target if not path.startswith("pcm/") else "core/" + target, tree.arrows)
            if everything or other == room or other in tree.arrows[room]:
                continue
            complaints.append(f"{name}: includes {path}; {room} may not use {other}")
    return complaints


# MeshLab's and VCG's headers and types, and the folders that may name them: one for each generation of MeshLab,
# the tests of these, and the benchmarks, which measure MeshLab. All else is compiled without MeshLab's headers (plugin/CMakeLists.txt); this finds what such a source only
# mentions, as a forward declaration.
MESHLAB_HEADER = r"[<\"](common|meshlab|vcg|wrap)/"
MESHLAB_TYPE = (r"\b(MeshDocument|MeshModel|GLArea|RasterModel|CMeshO|C(?:Vertex|Face)O|MLSceneGLSharedDataContext|GLLogStream|"
                r"Rich[A-Z]\w+|Mesh(?:Lab)?(?:Common|IO|Filter|Render|Decorate|Edit)Interface(?:Factory)?|(?:Matrix44|Point3|Box3)m|"
                r"Scalarm)\b|\bvcg::")
MESHLAB_FOLDERS = ("plugin/meshlab/", "tests/plugin/", "tests/e2e/", "bench/")


def without_comments_and_texts(text):
    return re.sub(r'//[^\n]*|"(?:\\.|[^"\\\n])*"', "", text)


def check_meshlab(tree):
    """Only plugin/meshlab knows MeshLab, and there one header includes MeshLab's."""
    complaints = []
    for name, text in tree.sources.items():
        if name.startswith("plugin/meshlab/") and not name.endswith("/meshlab.h"):
            complaints += [f"{name}: includes {include}; meshlab.h of its folder does"
                           for include in includes_of(text) if re.match(MESHLAB_HEADER, include)]
        if name.startswith(MESHLAB_FOLDERS):
            continue
        complaints += [f"{name}: includes {include} of MeshLab's" for include in includes_of(text)
                       if re.match(MESHLAB_HEADER, include)]
        complaints += [f"{name}: names MeshLab's {found}" for found in
                       sorted({match[0] for match in re.finditer(MESHLAB_TYPE, without_comments_and_texts(text))})]
    return complaints


# Folders that are no format: text and records are what several formats share.
SHARED_FOLDERS = {"text", "records", "pipe", "crs"}


def check_formats(tree):
    """The folders in core/io: a format's includes none of another format's."""
    complaints = []
    for name, text in tree.sources.items():
        match = re.match(r"core/io/(\w+)/", name)
        for include in includes_of(text) if match else ():
            other = re.match(r'"pcm/io/(\w+)/', include)
            if other and other[1] != match[1] and other[1] not in SHARED_FOLDERS:
                complaints.append(f"{name}: includes {include}; a format does not know another")
    return complaints


def check_list(tree):
    """The list itself: lines name rooms of the same floor that stand above them, and every arrow is used."""
    complaints = []
    order = list(tree.arrows)
    for place, room in enumerate(order):
        for other in sorted(tree.arrows.named[room]):
            if tree.arrows.floors[other] != tree.arrows.floors[room]:
                complaints.append(f"the list names {other} for {room}, which is on another floor: lower floors need no name")
            elif order.index(other) >= place:
                complaints.append(f"the list has {room} use {other}, which does not stand above it")
    used = {room: set() for room in order}
    for name, text in tree.sources.items():
        room = room_of(name, tree.arrows)
        for include in includes_of(text):
            if include.startswith(('"pcm/', '"plugin/')) and room in used:
                path = include[1:-1]
                used[room].add(room_of("core/" + path[4:] if path.startswith("pcm/") else path, tree.arrows))
    for room in order:
        for other in sorted(tree.arrows.named[room] - used[room]):
            complaints.append(f"the list lets {room} use {other}, and nothing does")
    return complaints


def functions_of(text):
    """(first line, lines) of each function: its body begins and ends with a brace alone in a line, at the same depth."""
    lines = text.split("\n")
    at = 0
    while at < len(lines):
        match = re.fullmatch(r"(\s*)\{", lines[at])
        if match:
            end = at + 1
            while end < len(lines) and not re.fullmatch(re.escape(match[1]) + r"\}.*", lines[end]):
                end += 1
            head = at
            while head > 0 and not re.fullmatch(r"\s*(|[{};]|.*[;}{:]|//.*|#.*)", lines[head - 1]):
                head -= 1
            yield head + 1, end - head + 1
        at += 1


def long_files(tree):
    return {name: text.count("\n") for name, text in tree.sources.items() if text.count("\n") > FILE_LINES}


def long_functions(tree):
    """FILE:FIRST LINE OF THE FUNCTION -> (line, lines). A test case may be as long as its story: TEST(...) is no function."""
    found = {}
    for name, text in tree.sources.items():
        lines = text.splitlines()
        for line, length in functions_of(text):
            head = lines[line - 1].strip()
            if length > FUNCTION_LINES and not head.startswith("TEST"):
                found[f"{name}:{head}"] = (line, length)
    return found


def check_sizes(tree):
    complaints = [f"{name}: {lines} lines, more than {FILE_LINES}" for name, lines in long_files(tree).items()
                  if name not in LONG_FILES]
    for key, (line, length) in long_functions(tree).items():
        name, _, head = key.partition(":")
        if key not in LONG_FUNCTIONS:
            complaints.append(f"{name}:{line}: a function of {length} lines, more than {FUNCTION_LINES}: {head}")
    return complaints


def check_exceptions(tree, files=None, functions=None):
    files = LONG_FILES if files is None else files
    functions = LONG_FUNCTIONS if functions is None else functions
    return ([f"{name} is not over {FILE_LINES} lines any more" for name in files if name not in long_files(tree)] +
            [f"{key} is not over {FUNCTION_LINES} lines any more" for key in functions if key not in long_functions(tree)])


def formatter():
    """clang-format 14 (Debian 12's): other versions lay out some lines in other ways. None where it is not installed."""
    for name in ("clang-format-14", "clang-format"):
        program = shutil.which(name)
        if program and " 14." in subprocess.run([program, "--version"], capture_output=True, text=True).stdout:
            return program
    return None


def check_format(program, root=ROOT, names=None):
    names = names or list(Tree.of_project(root).sources)
    complaints = []
    for first in range(0, len(names), 100):
        result = subprocess.run([program, "--dry-run", *names[first:first + 100]], cwd=root, capture_output=True,
                                text=True)
        found = sorted(set(re.findall(r"^(\S+?):\d+:\d+: (?:warning|error)", result.stderr, re.MULTILINE)))
        complaints += [f"{name}: not laid out as .clang-format says; run clang-format -i {name}" for name in found]
    return complaints


def check_reports(tree):
    """nlohmann's dump() throws for text that is not UTF-8, unless it is given a handler: commands print by print_json() alone,
    lists are written with a handler."""
    complaints = []
    for name, text in tree.sources.items():
        calls = re.findall(r"[.>]\s*dump\s*\(([^;]*)", text) if name.startswith(("core/", "plugin/")) else []
        for arguments in calls:
            if "error_handler_t::replace" not in arguments:
                complaints.append(f"{name}: dump() without error_handler_t::replace throws for text that is not UTF-8")
            elif name.startswith("core/cli/") and name != "core/cli/common.cpp":
                complaints.append(f"{name}: commands print JSON by print_json() of core/cli/common.h")
        if name == "core/cli/common.cpp" and len(calls) != 1:
            complaints.append(f"{name}: dump() is called {len(calls)} times; print_json() calls it once")
        if name.startswith("core/cli/") and re.search(r"<<\s*(std::setw\(\d+\)\s*<<\s*)?(json|Json)\b", text):
            complaints.append(f"{name}: commands print JSON by print_json() of core/cli/common.h")
    return complaints


# Words of the project's former dialect, and what to write instead. Patterns for comments, messages and read-me files.
WORDS = {
    r"numbers? that (is|are) (none|not a number)": "NaN",
    r"\bgo(es)? on with\b|\bgone on with\b": "resume",
    r"\bwho has it open\b": "open readers",
    r"\bat one (stroke|instant)\b": "atomically",
    r"\bbegun afresh\b|\bbegins? afresh\b": "restart",
    r"\b(a|one) bit a (cell|point|row)\b|\b(a|one) row a node\b": "one ... per ...",
    r"\bexactly the side\b": "edge-on",
    r"\bfor the search of errors\b": "for debugging",
    r"\btold exactly\b|\btold apart\b": "classified, distinguished",
    r"\b(rising|falling) (order|error|distance|number)": "ascending, descending",
    r"\bwho(ever)?\b": "the noun: a caller, an open reader, a person",
    r"\b(told|tells?)\b": "report, say, distinguish, show",
    r"\bthat (is|are) there\b": "existing, present",
    r"\bgo(es|ne)? on\b": "continue, resume",
    r"\bafresh\b": "again, restarted",
}


# The second table: patterns for what people read, which is comments and texts in quotes in sources, and all of a read-me file. Names
# in `backquotes` may stay.
PLAIN_WORDS = {
    r"^Of\b|[.;:] Of [a-z]": "the noun first: what it is, then of what",
    r"^(that|of|by|which|whose) .*(?<=\x00)$": "the noun first: // number of points, // keyed by name",
    r"\b[Bb]eside\b": "next to, in addition to, relative to",
    r"\b[Ss]o many\b|\bby so much\b": "this number of, k; by this amount",
    r"\b[Ss]o (near|far) (of|as they)\b|\bgrows? so far\b": "within this distance",
    r"\b(take|takes|took|taking) (no |any )?part\b": "is used, counts, is ignored",
    r"(?<![Tt]here )\b(is|are|was|were) no (?!(longer|more|less|better|\w+er|\w+-)\b|data\b)[a-z]": "is not a",
    r"\b[Tt]he (most|least) (points|samples|nodes|chunks|memory|distance|size|number)\b": "maximum, minimum",
    r"\b([Ss]aid|says? so|say so)\b": "reported, shown",
    r"(?<!false )\balarms?\b|\bsurely\b|\b[Rr]oughly\b|\b[Aa]like\b": "false alarms; a limit, a tolerance; in both, equal, similar",
    r"\bbe had\b|\bhad back\b": "is available, can be restored",
    r"\bstays? (as|what) (it|they) (is|are|was|were)\b": "is kept, is not changed",
    r"`: of [a-z]": "`name`: the noun of the quantity",
    r"\blets? expect\b": "explains, predicts",
}
# Keys of answers, which scripts spell.
SPELLED = {"core/ops/pick.cpp": "beside"}
COMMENTED = (".h", ".cpp", ".vert", ".frag", ".comp")


def prose_of(name, line):
    """What people read in a line: its comment and its texts in quotes, or all of it where it is not a source. Names in backquotes
    are left out, and a comment that follows code ends with NUL: it names what stands before it."""
    if not name.endswith(COMMENTED):
        return [line.strip().lstrip("#").strip()]
    if re.match(r'\s*#\s*include\b', line):
        return []
    texts = re.findall(r'"((?:[^"\\]|\\.)*)"', re.split(r'//(?=(?:[^"]*"[^"]*")*[^"]*$)', line)[0])
    comment = re.search(r'//[/<!]*(?=(?:[^"]*"[^"]*")*[^"]*$)\s*(.*)', line)
    if comment:
        after_code = "\0" if line[:comment.start()].strip() else ""
        texts.append(re.sub(r"`[^`]*`(?!: of)", "``", comment[1]) + after_code)
    return texts


def found_in(words, lines):
    """The rows of a table of words that some line may have, compiled: all lines at once take a tenth of the time. Between two lines
    stands what no pattern has, so that none looks from one into the next."""
    together = "\n\1\n".join(lines)
    patterns = [(re.compile(pattern, re.MULTILINE), better) for pattern, better in words.items()]
    return [row for row in patterns if row[0].search(together)]


def check_plain_words(texts):
    """`texts`: name -> text of a source or a read-me file."""
    complaints = []
    for name, text in texts.items():
        lines = [(number, line, prose) for number, line in enumerate(text.splitlines(), 1) for prose in prose_of(name, line)]
        if name in SPELLED:
            lines = [(number, line, re.sub(rf"\b{SPELLED[name]}\b", "", prose)) for number, line, prose in lines]
        for pattern, better in found_in(PLAIN_WORDS, [prose for _, _, prose in lines]):
            for number, line, prose in lines:
                if pattern.search(prose):
                    complaints.append(f"{name}:{number}: {line.strip()}  (write: {better})")
    return complaints


def other_texts(root=ROOT):
    """Read-me files, shaders, and the scripts that speak to a person."""
    paths = [*root.glob("*.md"), *root.glob("core/**/*.md"), *root.glob("plugin/*.md"), *root.glob("bench/*.md"),
             *root.glob("packaging/manual/pages/*.md"), *root.glob("packaging/manual/*.py"), *root.glob("shaders/*"), *(path for path in root.glob("packaging/*") if path.is_file() and path.suffix != ".png")]
    return {path.relative_to(root).as_posix(): path.read_text(encoding="utf-8") for path in paths}


def check_words(texts):
    """`texts`: name -> text of a source or a read-me file."""
    complaints = []
    for name, text in texts.items():
        lines = text.splitlines()
        for pattern, better in found_in(WORDS, lines):
            for number, line in enumerate(lines, 1):
                if pattern.search(line):
                    complaints.append(f"{name}:{number}: {line.strip()}  (write: {better})")
    return complaints


# ---- Tuned numbers: each with its unit and where it was chosen, used, and known to --sweep

TUNED_VALUE = re.compile(r"    (?:double|std::size_t) (\w+) = [^;]+;(.*)")


def tuned_structs(text):
    """Struct -> [(number of the line, name, what follows the value, the comment above it)] of a tuning.h."""
    structs, struct, above = {}, None, []
    for number, line in enumerate(text.splitlines(), 1):
        head = re.match(r"struct (\w+) \{", line)
        value = TUNED_VALUE.fullmatch(line)
        if head:
            struct, above = head[1], []
        elif value and struct:
            structs.setdefault(struct, []).append((number, value[1], value[2].strip(), "\n".join(above)))
            above = []
        elif line.strip().startswith("//"):
            above.append(line.strip())
        elif line.strip():
            above = []
    return structs


def check_tuning(sources):
    """`sources`: name -> text. The form of core/ROOM/tuning.h and of its parts, core/ROOM/PART_tuning.h, and that each of its values is read and swept."""
    complaints = []
    # What each source of core reads: ROOM_tuning().MEMBER.VALUE, and tuned.VALUE where the struct or the member is named.
    core = [(set(re.findall(r"\w+_tuning\(\)\.\w+\.\w+", text)), set(re.findall(r"\w+_tuning\(\)\.\w+", text)),
             set(re.findall(r"\btuned_?\.(\w+)", text)), set(re.findall(r"\w+", text)))
            for name, text in sources.items() if name.startswith("core/") and not re.search(r"/((\w+_)?tuning|tuned_values)\.(h|cpp)$", name)]
    for file, text in sources.items():
        found = re.fullmatch(r"core/(\w+)/(?:\w+_)?tuning\.h", file)
        if not found:
            continue
        room = found[1]
        if f'#include "pcm/{room}/tuned_values.h"' not in sources.get("bench/sweep/sweep.cpp", ""):
            complaints.append(f"bench/sweep/sweep.cpp: --sweep does not know the values of {file}")
        for struct, values in tuned_structs(text).items():
            member = re.search(rf"^    {struct} (\w+);", sources.get(f"core/{room}/tuning.h", ""), re.MULTILINE)
            if not member:
                complaints.append(f"{file}: {struct} is not a member of the room's struct")
                continue
            group = f"{room}_tuning().{member[1]}"
            for number, value, after, above in values:
                if not after.startswith("// "):
                    complaints.append(f"{file}:{number}: {value} has no unit: write it behind the value")
                if not re.search(r"^// Chosen: \S", above, re.MULTILINE):
                    complaints.append(f"{file}:{number}: {value} has no provenance: a line \"// Chosen: \" above it")
                row = f"PCM_TUNED({room}.{member[1]}.{value})"
                if row not in sources.get(f"core/{room}/tuning.cpp", ""):
                    complaints.append(f"{file}:{number}: --sweep does not know {value}: {row} in core/{room}/tuning.cpp")
                if not any(f"{group}.{value}" in values_read or ((struct in names or group in groups_read) and value in tuned)
                           for values_read, groups_read, tuned, names in core):
                    complaints.append(f"{file}:{number}: nothing reads {value}")
    return complaints


# ---- What is in the repository at all

TOP_LEVEL = {"CMakeLists.txt", "CMakePresets.json", "LICENSE", "README.md", "core", "plugin", "shaders", "tests", "bench", "packaging"}
LARGEST_FILE = 1 << 20


def tracked_files(root=ROOT):
    """Path -> bytes of what git keeps; None where this is not a checkout or git is not installed."""
    if not shutil.which("git") or not (root / ".git").exists():
        return None
    done = subprocess.run(["git", "-C", str(root), "ls-files", "-z"], capture_output=True, check=False)
    if done.returncode != 0:
        return None
    names = [name for name in done.stdout.decode("utf-8").split("\0") if name]
    return {name: (root / name).lstat().st_size for name in names if (root / name).exists()}


def check_tracked_files(files):
    complaints = []
    for name, size in sorted(files.items()):
        top = name.split("/")[0]
        if top not in TOP_LEVEL and not top.startswith("."):
            complaints.append(f"{name}: the top level has only {', '.join(sorted(TOP_LEVEL))}")
        if size > LARGEST_FILE:
            complaints.append(f"{name}: {size} bytes; data and programs do not belong into the repository")
    return complaints
