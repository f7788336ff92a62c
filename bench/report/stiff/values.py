"""Values at and beyond the limits, for each argument of each operation, by its type: all else is as in asks.py, on the plain case.

Nothing here knows an operation, so a new argument is asked unasked.
"""

NUMBERS = ["0", "-0.0", "5e-324", "1e-300", "1e150", "1e308", "-1", "nan", "inf"]
OF_TYPE = {
    "whole": ["0", "1", "-1", "4294967295", "4294967296", "18446744073709551615", "1e30", "1.5", "nan"],
    "real": NUMBERS,
    "bytes": ["0", "1", "1K", "64M", "16E", "-1", "nan"],
    "text": ["", "nan", "x" * 5000, "../x", "a\nb", "1e999"],
    "texts": ["", "nan=1", "x" * 5000, "x=1e999", "x>nan"],
    "words": ["", ",", "nan", "x" * 5000],
    "step": ["", ",", "nan", "1e308,1e308,1e308", "-1", "0,0,0,0,0,0,0,0"],
    "file": ["", "/", "/dev/null", "no/such/file", "x" * 5000],
    "output": ["", "/", ".", "no/such/folder/out.ply", "x" * 300 + ".ply", "/dev/null", "out"],
    "output_tree": ["", "/", ".", "no/such/folder/out.pct", "x" * 300 + ".pct", "/dev/null", "out"],
    "outputs": ["", "/", ".", "no/such/folder/out.csv", "/dev/null", "out"],
}
# What is asked for so takes hours, and is not wrong.
HOURS = {("generate", "points")}
# Arguments that change how an answer is found and not which, so that the oracle of asks.py holds.
NEUTRAL = ("memory", "threads", "chunk_points", "checkpoint_seconds", "cache", "reads", "fast", "resume", "overwrite", "flann", "skip_bad_lines",
           "skip_bad_files", "ignore_crs")


def words_of(argument):
    """Each a list of words, or True for a flag."""
    kind = argument["type"]
    if kind == "flag":
        return [True]
    if kind == "numbers":
        count = argument.get("least_count", 3)
        return [[number] * count for number in NUMBERS] + [["1"] * max(1, count - 1)]
    return [[word] for word in OF_TYPE.get(kind, [])]


def name_of(argument, words):
    text = "" if words is True else " " + " ".join(dict.fromkeys(words))
    return f"{argument['key']}{text if len(text) < 30 else text[:10] + '...'}"


def variants(operation, known):
    """Name -> (known, whether the oracle holds): the operation asked as in asks.py, with one more argument."""
    found = {}
    for argument in operation["arguments"]:
        if (operation["name"], argument["key"]) in HOURS:
            continue
        for words in words_of(argument):
            found[name_of(argument, words).replace("\n", " ")] = ({**known, argument["key"]: words}, argument["key"] in NEUTRAL)
    return found
