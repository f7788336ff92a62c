"""Many commands at once on one tree: each does all of its work or refuses, and afterwards no point is missing or doubled."""

import concurrent.futures
import re
import shutil

from trial import Trial, good, pcmlab

AT_ONCE = 14


def act(kind, folder, number, chance):
    """The command of one of those that run at once: (kind, arguments)."""
    tree = folder / "work.pct"
    corner = chance.randrange(0, 15)
    box = ("--box", 500000 + corner, 4800000, 90, 500001 + corner, 4800030, 120)
    return {
        "append": ("append", tree, folder / "more.las"), "delete": ("delete", tree, *box),
        "set": ("set", tree, f"user_data={number}", *box), "compact": ("compact", tree), "repair": ("repair", tree),
        "query": ("query", tree, *box), "verify": ("verify", tree), "info": ("info", tree),
        "convert": ("convert", tree, folder / f"out{number}.bpc", "--overwrite"),
        "build": ("build", folder / "site.las", "-o", folder / "built.pct", "--overwrite"),
    }[kind]


def run(folder, rounds, seconds, seed):
    trial = Trial("races", rounds, seconds, seed)
    good("generate", "--points", 60000, folder / "site.las")
    more = good("generate", "--points", 7000, "--seed", 2, folder / "more.las")["points"]
    good("build", folder / "site.las", "-o", folder / "site.pct", "--chunk-points", 1000)
    kinds = ("append", "append", "append", "delete", "delete", "set", "compact", "repair", "query", "verify", "info", "convert", "build")
    refused = re.compile(r"another process|another build|being changed|is being|locked|lock|in use|changed while|was replaced", re.IGNORECASE)
    for _ in trial:
        shutil.rmtree(folder / "work.pct", ignore_errors=True)
        shutil.copytree(folder / "site.pct", folder / "work.pct")
        points = good("info", folder / "work.pct")["points"]
        commands = [(kind, act(kind, folder, number, trial.chance))
                    for number, kind in enumerate(trial.chance.choices(kinds, k=AT_ONCE))]
        with concurrent.futures.ThreadPoolExecutor(AT_ONCE) as pool:
            results = list(pool.map(lambda command: pcmlab(*command[1], "--json"), commands))
        for (kind, command), result in zip(commands, results):
            if result.code == 0:
                trial.counts["done"] += 1
                if kind == "append":
                    points += more
                elif kind == "delete":
                    points -= result.json()["points_deleted"]
            else:
                trial.counts["refused"] += 1
                trial.expect(result.code == 1 and refused.search(result.err), f"{kind}: {result.code} {result.err[-300:]}")
        verified = pcmlab("verify", folder / "work.pct", "--json")
        trial.expect(verified.code == 0 and verified.json()["points"] == points,
                     f"{[kind for kind, _ in commands]}: {verified.code} {verified.out[-200:]} {verified.err}, not {points} points")
        if (folder / "built.pct").exists():
            trial.expect(pcmlab("verify", folder / "built.pct").code == 0, "the tree built at the same time is not whole")
    return trial.report(f"rounds of {AT_ONCE} commands at once")
