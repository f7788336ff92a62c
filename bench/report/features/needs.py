"""What a scene takes: columns, bytes, nodes, programs and libraries."""
import json
import os
import re

from study import process

TITLE = "What a scene does not need"
WHAT = ("What eight scenes take, counted by the program itself (`reads` and `pictures` of `pcmlab render --json`, the loader's log for the libraries). *Columns* are those that are decoded of the chunks that are read; "
        "*of the tree* is the share of the tree's bytes. *Vertex*: bytes of a point in video memory. *Programs*: shader permutations that are compiled, those of the lighting and of the mean of frames among them. "
        "*Libraries*: those of the system are OpenGL's and its driver's where something is drawn.")
TABLE = ("scene", "attributes", "columns decoded", "nodes read", "nodes", "points decoded", "bytes read", "of the tree, %", "vertex, bytes", "uploaded, bytes", "points drawn", "programs", "libraries", "command")
EXACT = ("Needs.APictureDecodesAndUploadsWhatItShows", "Needs.NormalsAndRadiiAreReadWhereSplatsAreMadeOfThem", "Needs.AClipBoxAndAFarViewReadTheirNodesAlone", "Needs.ProgramsAreThoseOfThePicture",
         "Needs.LibrariesThatDrawOrFitForOthersAreNotLoaded", "NearPointsTest.ReadsThePositionsOfTheNodesNearby")
NOTES = [
    "Found and left: every command loads libdxflib, which writing a DXF alone needs: 171 KB of address space and 0.1 ms of the processor at each start (1.15 against 1.05 ms of a program that does nothing, 400 starts in turns).",
    "Found and left: point sizes are decoded where a cloud has radii of its own, as they stand in for radii that are missing; a tree does not know that none is. They are 13 % of the bytes of positions.",
    "Found and left: of the nodes that a clip box cuts all points are read and uploaded, and the shaders leave out those that are not in it, so that the box can be moved without an upload.",
    "Found and left: a fit at a place decodes the nodes near it once in each of its passes (neighbourhood, growth in rounds, edges, refinement, stations): here each point some twelve times, a tenth of the fit's processor time. "
    "A cache of decoded positions would leave eleven of them out.",
    "Found and left: without `--eye` the first view reads the header of the root's chunk once more, 1,286 bytes.",
]
BIG = {"full": 20_000_000, "quick": 5_000_000, "smoke": 20_000}


def libraries(folder):
    """Names of the libraries in the logs of the loader there; the logs are removed."""
    names = set()
    for file in folder.glob("loaded.*"):
        for name in re.findall(r"calling init: (\S+)", file.read_text(encoding="utf-8", errors="replace")):
            names.add(os.path.basename(name).split(".so")[0])
        file.unlink()
    return sorted(name for name in names if not name.startswith("ld-"))


class Scenes:
    def __init__(self, lab):
        self.lab = lab
        self.scene = lab.scene("map")
        self.low, self.high = self.scene.xyz.min(axis=0), self.scene.xyz.max(axis=0)

    def tree(self, name, *options):
        """A tree of the scene's points with some of its attributes, made once."""
        tree = self.lab.work / f"needs-{name}.pct"
        if not tree.exists():
            file = self.lab.work / f"needs-{name}.bpc"
            process.timed([self.lab.bin / "pcmlab", "convert", "-q", "--overwrite", self.scene.tree, file, *options])
            process.timed([self.lab.bin / "pcmlab", "build", "-q", file, "-o", tree])
        return tree

    def discs(self):
        tree = self.lab.work / "needs-discs.pct"
        if not tree.exists():
            process.timed([self.lab.bin / "pcmlab", "normals", "--radii", "--no-confidence", "-q", self.tree("rgb", "--keep", "rgb"), "-o", tree])
        return tree

    def big(self):
        points = BIG[self.lab.size.name]
        tree, las = self.lab.work / f"big-{points}.pct", self.lab.work / f"big-{points}.las"
        if not tree.exists():
            process.timed([self.lab.bin / "pcmlab", "generate", "-q", "--no-truth", "--overwrite", "-n", points, las])
            process.timed([self.lab.bin / "pcmlab", "build", "-q", las, "-o", tree, "--overwrite"])
            las.unlink()
        return tree

    def camera(self, away, low=None, high=None):
        low, high = (self.low, self.high) if low is None else (low, high)
        middle, size = (low + high) / 2, max(high - low)
        return ["--eye", *(f"{value:.3f}" for value in middle + away * size), "--target", *(f"{value:.3f}" for value in middle)]

    def far(self):
        tree = self.big()
        bounds = self.lab.ask("info", tree)["bounds"]
        low, high = self.low * 0 + bounds["min"], self.low * 0 + bounds["max"]
        return tree, self.camera(12, low, high)

    def all(self):
        """(what, words of the command)."""
        near, drawn = self.camera(1), ["-o", self.lab.work / "needs.png", "--overwrite", "--size", "640x480", "--json", "-q"]
        box = [f"{value:.3f}" for value in (*(self.low - 1), *(self.low + (self.high - self.low) / 4)[:2], self.high[2] + 1)]
        far, camera = self.far()
        full = self.scene.tree
        attributes = [one["name"] for one in self.lab.ask("info", full)["attributes"]]
        yield "xyz alone", ["render", self.tree("xyz", "--drop", ",".join(attributes)), *drawn, *near, "--colour", "uniform"]
        yield "and RGB", ["render", self.tree("rgb", "--keep", "rgb"), *drawn, *near]
        yield "and normals and radii, as discs", ["render", self.discs(), *drawn, *near, "--splats", "perspective"]
        yield "13 attributes, the intensity shown", ["render", full, *drawn, *near, "--colour", "intensity"]
        yield "a clip box of a sixteenth in plan", ["render", full, *drawn, *near, "--clip", "box " + " ".join(box)]
        yield "one class shown", ["render", full, *drawn, *near, "--where", "classification=2"]
        yield f"a far view of {BIG[self.lab.size.name]:,} points", ["render", far, *drawn, *camera, "--until", "target"]
        yield "a fit at a place", ["fit", full, "--at", *self.click(), "--json", "-q", "-t", "1"]

    def click(self):
        one = max((one for one in self.scene.truth if one["kind"] == "cylinder"), key=lambda one: one["points"])
        return [f"{value:.3f}" for value in self.scene.xyz[(self.scene.ids == one["id"]).nonzero()[0][0]]]


def row(lab, what, words):
    text, _ = process.timed([lab.bin / "pcmlab", *words], {"LD_DEBUG": "files", "LD_DEBUG_OUTPUT": str(lab.work / "loaded")})
    answer, loaded = json.loads(text), libraries(lab.work)
    mine = {"scene": what, "libraries": f"{len(loaded)}: {', '.join(loaded)}" if len(loaded) < 10 else f"{len(loaded)}", "command": " ".join(["pcmlab", *(lab.shown(str(word)) for word in words)])}
    if "reads" not in answer:  # a fit: its head has what it read
        schema = lab.ask("info", words[1])
        return {**mine, "attributes": len(schema["attributes"]), "columns decoded": "positions", "nodes": sum(level["nodes"] for level in schema["level"]), "points decoded": answer.get("points_read", answer["points_in"]),
                "bytes read": answer.get("bytes_read")}
    reads, picture = answer["reads"][0], answer["pictures"][0]
    return {**mine, "attributes": reads["attributes"], "columns decoded": ", ".join(reads["columns"]), "nodes read": reads["chunks"], "nodes": reads["nodes"], "points decoded": reads["points"], "bytes read": reads["bytes"],
            "of the tree, %": 100 * reads["bytes"] / reads["bytes_of_tree"], "vertex, bytes": picture["clouds"][0]["vertex_bytes"], "uploaded, bytes": picture["uploaded_bytes"],
            "points drawn": picture["points_drawn"], "programs": picture["programs"]}


def measure(lab):
    return [row(lab, what, words) for what, words in Scenes(lab).all()]


def absent(lab):
    return [f"the far view of 60 M points: {BIG[lab.size.name]:,} are shown"]
