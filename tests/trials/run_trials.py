"""Long trials of the command as an unlucky user meets it: killed, damaged, many at once, extreme. packaging/trials runs them."""

import argparse
import pathlib
import sys
import tempfile

import damage
import extremes
import kills
import races

TRIALS = {"kills": (kills, 184), "damage": (damage, 1230), "races": (races, 8), "extremes": (extremes, 1000)}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=1800, help="at most, each trial")
    parser.add_argument("--rounds", type=int, help="instead of each trial's own number")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--folder", type=pathlib.Path, help="for the clouds; a temporary one otherwise")
    parser.add_argument("trials", nargs="*", help=" ".join(TRIALS))
    arguments = parser.parse_args()
    wanted = arguments.trials or list(TRIALS)
    if set(wanted) - set(TRIALS):
        parser.error(f"there is no trial {', '.join(sorted(set(wanted) - set(TRIALS)))}; there are {', '.join(TRIALS)}")
    faults = 0
    for name in wanted:
        module, rounds = TRIALS[name]
        with tempfile.TemporaryDirectory(dir=arguments.folder) as folder:
            faults += module.run(pathlib.Path(folder), arguments.rounds or rounds, arguments.seconds, arguments.seed)
    sys.exit(faults > 0)


if __name__ == "__main__":
    main()
