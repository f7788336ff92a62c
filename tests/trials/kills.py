"""Commands that change a tree are killed at a random moment: afterwards the tree is the old one or the new one, whole, and the same
command, given again where nothing was done, comes to the same result."""

import shutil
import subprocess
import time

from trial import COMMAND, Trial, good, make_tree, pcmlab

BOX = ("--box", "500000", "4800000", "90", "500025", "4800025", "120")


def state(tree):
    """What a tree says of itself once it is verified: the points, and how many are of class 30."""
    verified = pcmlab("verify", tree, "--json")
    if verified.code != 0:
        return f"not whole: {verified.code} {verified.out[-300:]} {verified.err[-300:]}"
    marked = good("query", tree, "--where", "classification=30")["points"]
    return verified.json()["points"], marked


def operations(folder):
    """Name -> (command, whether it changes the tree in place)."""
    tree, more = folder / "work.pct", folder / "more.las"
    return {
        "append": ("append", tree, more), "delete": ("delete", tree, *BOX), "set": ("set", tree, "classification=30", *BOX),
        "compact": ("compact", tree), "repair": ("repair", tree), "build": ("build", more, "-o", tree, "--overwrite"),
        "transform": ("transform", folder / "site.pct", tree, "--translate", "1", "2", "3", "--overwrite"),
        "run": ("run", more, "--outliers", "8,3", "--transform", "0,0,1", "--normals", "8", "-o", tree, "--overwrite"),
        "convert": ("convert", more, folder / "out.laz", "--overwrite"),
    }


def kill_after(command, seconds):
    """Whether the command was killed before it ended by itself."""
    process = subprocess.Popen([COMMAND, *map(str, command)], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
    try:
        process.wait(seconds)
        return False
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        return True


def run(folder, rounds, seconds, seed):
    trial = Trial("kills", rounds, seconds, seed)
    make_tree(folder / "site.pct", 150000, 100000, 2000, 5)
    tree = folder / "work.pct"
    commands = operations(folder)
    before, after, duration = {}, {}, {}
    for name, command in commands.items():  # the results, undisturbed
        shutil.rmtree(tree, ignore_errors=True)
        shutil.copytree(folder / "site.pct", tree)
        before[name] = state(tree)
        started = time.monotonic()
        result = pcmlab(*command)
        duration[name] = time.monotonic() - started
        trial.expect(result.code == 0, f"{name}: {result}")
        after[name] = state(tree)
    for number in trial:
        name = sorted(commands)[number % len(commands)]
        shutil.rmtree(tree, ignore_errors=True)
        shutil.copytree(folder / "site.pct", tree)
        old_output = (folder / "out.laz").read_bytes()
        killed = kill_after(commands[name], trial.chance.random() * 1.2 * duration[name])
        trial.counts["killed before the end"] += killed
        found = state(tree)
        trial.expect(found in (before[name], after[name]), f"{name} left {found}, neither {before[name]} nor {after[name]}")
        trial.expect((folder / "out.laz").read_bytes() == old_output, f"{name} left another out.laz")
        if found == after[name] and found != before[name]:
            trial.counts["already in effect"] += 1
        else:
            result = pcmlab(*commands[name])
            trial.expect(result.code == 0 and state(tree) == after[name], f"{name} again: {result} {state(tree)}")
        left = {path.name for path in folder.iterdir()} - {"site.las", "more.las", "site.pct", "work.pct", "out.laz"}
        left = {name for name in left if not name.endswith(".json") and "truth" not in name}
        trial.expect(not left, f"{name} left {left} beside the tree, even after it was given again")
    return trial.report("kills")
