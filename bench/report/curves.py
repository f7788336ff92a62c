"""What a curve says: whether the default is at its knee, and whether ours is below and left of every peer.

Settings are compared with margins that the noise of processor times asks for: within 20 % two times are the same, within 2 % two errors. Errors below
the feature's FLOOR are the same: they are the last digits of doubles.
"""
SAME_TIME, SAME_ERROR = 1.2, 1.02


def number(value):
    if value is None:
        return ""
    if isinstance(value, int) or value == int(value) and abs(value) < 1e9:
        return f"{int(value):,}"
    return f"{value:.1e}" if abs(value) < 1e-3 else f"{value:.3g}" if abs(value) < 1000 else f"{value:,.0f}"


def ours(row):
    return row["program"].startswith("pcmlab")


def name_of(row):
    return f"{row['program']}, {row['setting']}" if row["setting"] else row["program"]


def curves(rows):
    """(place, what is chosen for a curve of its own) -> its rows. A row's `curve` sets rows of one place apart."""
    found = {}
    for row in rows:
        found.setdefault((row["place"], row.get("curve", "")), []).append(row)
    return found


def worth(row, floor):
    return max(row["error"], floor)


def knee(default, others, floor):
    """Whether the default is at the knee of its curve: a sentence, and whether it is."""
    error = worth(default, floor)
    cheaper = [row for row in others if row["cpu"] * SAME_TIME < default["cpu"] and worth(row, floor) <= error * SAME_ERROR]
    if cheaper:
        best = min(cheaper, key=lambda row: row["cpu"])
        return f"not at the knee: *{best['setting']}* has no larger error in {best['cpu'] / default['cpu']:.2f} of the time", False
    better = [row for row in others if error > floor and row["cpu"] <= SAME_TIME * default["cpu"] and 2 * worth(row, floor) <= error]
    if better:
        best = min(better, key=lambda row: row["error"])
        return f"not at the knee: *{best['setting']}* has {best['error'] / default['error']:.2f} of the error in {best['cpu'] / default['cpu']:.2f} of the time", False
    nearly = [row for row in others if 2 * row["cpu"] <= default["cpu"] and worth(row, floor) <= 1.1 * error]
    if nearly:
        best = min(nearly, key=lambda row: row["cpu"])
        return f"past the knee: *{best['setting']}* has {worth(best, floor) / error:.2f} of the error in {best['cpu'] / default['cpu']:.2f} of the time", False
    if default["error"] <= floor:
        least = min([row["cpu"] for row in others], default=default["cpu"])
        return f"exact; the cheapest other setting takes {least / default['cpu']:.2f} of its time", True
    return "at the knee: no setting has half its error for as much time, or its error for half the time", True


def against(row, mine, floor):
    """A row of a peer compared with ours: a sentence, and whether ours is below and left of it."""
    as_good = [own for own in mine if worth(own, floor) <= worth(row, floor) * SAME_ERROR]
    if not as_good:
        best = min(mine, key=lambda own: own["error"])
        return f"**not beaten**: {name_of(row)} has an error of {number(row['error'])} where our least is {number(best['error'])}", False
    best = min(as_good, key=lambda own: own["cpu"])
    if best["cpu"] <= row["cpu"] * SAME_TIME:
        return f"{name_of(row)}: ours of no larger error ({best['setting'] or 'as it is'}) takes {best['cpu'] / row['cpu']:.2f} of its time", True
    return f"**not beaten**: {name_of(row)} takes {row['cpu'] / best['cpu']:.2f} of our time at an error of {number(row['error'])} (ours {number(best['error'])})", False


def judged(rows, floor=0.0):
    """Of each default and each setting of a peer: (whether it is a default, its curve's name, a sentence, whether it is good, its name)."""
    for (place, curve), of_curve in curves(rows).items():
        where = ", ".join(part for part in (curve, place) if part)
        mine = [row for row in of_curve if ours(row)]
        for row in mine:
            others = [other for other in mine if other["program"] == row["program"] and other is not row]
            if row["default"] and others:
                said, good = knee(row, others, floor)
                yield True, where, f"the default ({row['setting']}) is {said}", good, row["setting"]
        for row in of_curve:
            if not ours(row) and mine:
                said, good = against(row, mine, floor)
                yield False, where, said, good, name_of(row)


def sentences(rows, floor=0.0):
    """What the curves of a feature say, a line for each."""
    return [f"{where}: {said}." for _, where, said, _, _ in judged(rows, floor)]


def off_the_knee(rows, floor=0.0):
    """A line for each default that is not at the knee of its curve."""
    return [f"{where}: {said}." for is_default, where, said, good, _ in judged(rows, floor) if is_default and not good]


def summary(rows, floor=0.0):
    """Of all curves: (defaults that are at the knee, of so many; settings of peers that ours is below and left of, of so many; those that are not)."""
    found = list(judged(rows, floor))
    defaults, peers = ([good for is_default, _, _, good, _ in found if is_default is of] for of in (True, False))
    return sum(defaults), len(defaults), sum(peers), len(peers), [f"{name} ({where})" for is_default, where, _, good, name in found if not is_default and not good]
