"""Trees with damaged files: no command crashes or hangs, and none gives a wrong answer of a tree that it calls whole."""

import shutil

from trial import Trial, make_tree, pcmlab

MEMORY = 4 << 30
QUESTIONS = (("--sphere", 500030, 4800030, 100, 9), ("--box", 500000, 4800000, 90, 500020, 4800020, 120),
             ("--where", "intensity>5000"), ("--nearest", 500030, 4800030, 100, "-k", 5), ("--level", 1))


def answers(tree):
    """Of every question: the exit code, and what is found."""
    found = []
    for question in QUESTIONS:
        result = pcmlab("query", tree, *question, "--json", memory=MEMORY)
        parsed = result.json() if result.code == 0 else {}
        found.append((result.code, parsed.get("points"), str(parsed.get("bounds")), str(parsed.get("neighbours"))))
    return found


def damage(path, chance):
    """Changes a file a little, and says how."""
    data = bytearray(path.read_bytes())
    at = chance.randrange(max(1, len(data)))
    kind = chance.choice(("bit", "byte", "zeros", "ones", "cut", "longer", "moved", "word"))
    if kind == "bit":
        data[at] ^= 1 << chance.randrange(8)
    elif kind == "byte":
        data[at] = chance.randrange(256)
    elif kind in ("zeros", "ones"):
        length = chance.randrange(1, 600)
        data[at:at + length] = (b"\0" if kind == "zeros" else b"\xff") * len(data[at:at + length])
    elif kind == "cut":
        del data[at:]
    elif kind == "longer":
        data += bytes(chance.randrange(256) for _ in range(chance.randrange(1, 100)))
    elif kind == "moved":
        length = chance.randrange(1, 200)
        data[at:at] = data[at:at + length]
    else:
        data[at:at + 8] = chance.choice((b"\xff" * 8, b"\0" * 7 + b"\x80", b"\xff" * 7 + b"\x7f", b"\0\0\0\0\1\0\0\0"))
    if bytes(data) == path.read_bytes():
        data[at] ^= 1
    path.write_bytes(data)
    return f"{path.name}: {kind} at {at}"


def run(folder, rounds, seconds, seed):
    trial = Trial("damage", rounds, seconds, seed)
    make_tree(folder / "site.pct", 20000, 5000, 1000, 3)
    right = answers(folder / "site.pct")
    assert all(code == 0 for code, *_ in right), right
    tree = folder / "work.pct"
    for _ in trial:
        shutil.rmtree(tree, ignore_errors=True)
        shutil.copytree(folder / "site.pct", tree)
        files = sorted(path for path in tree.iterdir() if path.is_file() and path.stat().st_size)
        what = damage(trial.chance.choice(files), trial.chance)
        commands = [("info", tree), ("verify", tree), ("repair", tree, "--check"), ("convert", tree, folder / "out.ply", "--overwrite")]
        results = {command[0]: pcmlab(*command, memory=MEMORY) for command in commands}
        for name, result in results.items():
            trial.expect(result.code in (0, 1), f"{what}: {name} ended with {result.code}: {result.err[-300:]}")
        whole = results["verify"].code == 0
        trial.counts["called whole"] += whole
        trial.expect((results["repair"].code == 0) == whole or not whole, f"{what}: whole to verify, not to repair --check")
        for question, found, expected in zip(QUESTIONS, answers(tree), right):
            trial.expect(found[0] in (0, 1), f"{what}: query {question} ended with {found[0]}")
            if whole or found[0] == 0:
                trial.expect(found == expected, f"{what}: query {question} answers {found}, not {expected}")
        if trial.chance.random() < 0.3:
            repaired = pcmlab("repair", tree, memory=MEMORY)
            trial.expect(repaired.code in (0, 1), f"{what}: repair ended with {repaired.code}")
            if repaired.code == 0:
                verified = pcmlab("verify", tree)
                trial.counts["repaired"] += 1
                trial.expect(verified.code == 0, f"{what}: repaired, but {verified.out[-300:]} {verified.err[-300:]}")
    return trial.report("damaged trees")
