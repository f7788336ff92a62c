"""Breaks the core on purpose, one line at a time, and counts the faults that the unit tests notice. packaging/mutate runs it.

All faults of a sample are in one build of a copy of the sources (schemata.py); an environment variable puts one to work. Every
test is run once to see which faults' code it executes; then each fault is tried on the tests that execute it, the quickest of
its room first. A fault that cannot stand next to the good code, a constant of a template say, gets a build of its own.
"""

import argparse
import concurrent.futures
import json
import os
import pathlib
import random
import re
import resource
import subprocess
import sys
import tempfile
import time

import operators
import schemata

LEFT_OUT = ("core/examples/", "core/decoders/", "core/cli/", "core/offscreen/")
SLOW = "*KilledAtAnyCall*:*Kill*"  # tests that are left out
MEMORY = 12 << 30  # address space of a test program: a fault may ask for any amount
PLAIN, AT_RUN_TIME, ALONE = range(3)  # how a fault is built: see chosen_fault.h
BATCHES = (3, 20, 100, 1e9)  # seconds of tests that are run before the next
# How the core is compiled: with checked subscripts, since tests under the address sanitizer would notice those out of range; and
# quickly, since the compiler takes most of the time.
CHECKED = b"add_compile_definitions(_GLIBCXX_ASSERTIONS)\nadd_compile_options(-w -Wno-narrowing -O1 -g0)\n"
HERE = pathlib.Path(__file__).resolve().parent


def sources(root):
    """Path -> lines of every source of the core that has tests of its own and is built: without PCL, not what needs it."""
    listed = subprocess.run(["git", "-C", root, "ls-files", "core"], capture_output=True, text=True, check=True).stdout.split()
    left_out = LEFT_OUT if (root / "build" / "pcl-sdk").is_dir() else (*LEFT_OUT, "core/fit/pcl/")
    return {name: (root / name).read_text(encoding="utf-8").split("\n")
            for name in listed if name.endswith((".cpp", ".h")) and not name.startswith(left_out)}


def all_faults(files):
    """Every fault that could be made: (file, index of the line, what, the faulty line)."""
    return [(name, i, what, faulty) for name, lines in sorted(files.items()) for i, line in enumerate(lines)
            for what, faulty in operators.faults_of(line)]


def choose(faults, count, seed):
    """A sample without two faults in one line, spread evenly over the files' lines; the same for the same seed."""
    lines = {}
    for fault in faults:
        lines.setdefault(fault[:2], []).append(fault)
    chance = random.Random(seed)
    chosen = chance.sample(sorted(lines), min(count, len(lines)))
    return [chance.choice(lines[line]) for line in chosen]


def named(faults, paths):
    """The faults in files whose path below core/ begins like one of the paths, or in the line that follows a path: a/b.cpp:12."""
    wanted = [path.removeprefix("core/").partition(":") for path in paths]
    return [fault for fault in faults
            if any(fault[0].startswith(f"core/{path}") and line in ("", str(fault[1] + 1)) for path, _, line in wanted)]


def room_of(name):
    """The room of a source or test: its folder of tests."""
    path = name.removeprefix("core/")
    return {"point_cloud": "query", "make_cloud": "query"}.get(path.partition(".")[0], path.split("/")[0])


class Copy:
    """The sources and their build, in a folder that is kept from run to run."""

    def __init__(self, root, folder, jobs):
        self.root, self.folder, self.jobs = root, folder, jobs
        # Laid out like a clone, so that the compiler cache knows what has no faults.
        self.source, self.build = folder / "source", folder / "source" / "build" / "release"
        self.refused = folder / "refused.json"  # fault -> how it has to be built

    def write(self, broken):
        """Copies the sources that changed; `broken`: path -> text of those with faults."""
        listed = subprocess.run(["git", "-C", self.root, "ls-files", "-z"], capture_output=True, check=True).stdout
        names = set(filter(None, listed.decode().split("\0")))
        for folder in ("core", "tests"):  # what is no longer in the project, and would be compiled
            for old in (self.source / folder).rglob("*.*"):
                if old.is_file() and old.relative_to(self.source).as_posix() not in names:
                    old.unlink()
        for name in sorted(names):
            old, new = self.root / name, self.source / name
            if not old.is_file():
                continue
            added = CHECKED if name == "core/CMakeLists.txt" else b""
            text = broken[name].encode() if name in broken else added + old.read_bytes()
            if not (new.is_file() and new.read_bytes() == text):
                new.parent.mkdir(parents=True, exist_ok=True)
                new.write_bytes(text)

    def configure(self):
        """The tests are compiled as in release, whose objects the compiler cache has."""
        options = ["-DPCM_WITH_MESHLAB=OFF", "-DPCM_BUILD_BENCHMARKS=OFF", f"-DPCM_DECODERS_FOLDER={self.folder / 'decoders'}",
                   f"-DPCM_PCL_SDK={self.root / 'build' / 'pcl-sdk'}", "-DPCM_GROUP_SOURCES=ON",
                   f"-DPCM_TEST_DATA={self.root.parent / 'shared' / 'data'}", "-DCMAKE_BUILD_TYPE=RelWithDebInfo",
                   "-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O2 -g1 -DNDEBUG"]
        subprocess.run(["cmake", "-G", "Ninja", "-S", self.source, "-B", self.build, *options], check=True,
                       stdout=subprocess.DEVNULL)

    def make(self, *targets):
        """Empty, or what the compiler says."""
        done = subprocess.run(["ninja", "-C", self.build, f"-j{self.jobs}", "-k0", *targets], capture_output=True, text=True)
        return done.stdout + done.stderr if done.returncode else ""

    def programs(self):
        return sorted(path.name for path in (self.build / "bin").glob("test_*"))

    def run(self, program, filters, limit, **environment):
        """None where these tests of the program pass in `limit` seconds, else the first that does not."""
        def restrict():
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        with tempfile.TemporaryDirectory(dir=self.build) as folder:
            environment = dict(os.environ, TMPDIR=folder, GTEST_FAIL_FAST="1", **environment)
            log = pathlib.Path(folder) / "log"
            with open(log, "wb") as out:
                process = subprocess.Popen([self.build / "bin" / program, f"--gtest_filter={filters}"], cwd=folder, env=environment,
                                           stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.DEVNULL, preexec_fn=restrict,
                                           start_new_session=True)
                try:
                    if process.wait(limit) == 0:
                        return None
                except subprocess.TimeoutExpired:
                    os.killpg(process.pid, 9)  # what it has started too
                    process.wait()
            text = log.read_text(encoding="utf-8", errors="replace")
            failed = re.findall(r"^\[  FAILED  \] ([^\s,]+)", text, re.MULTILINE)
            begun = re.findall(r"^\[ RUN      \] (\S+)", text, re.MULTILINE)  # the last one: a crash, or time ran out
            return " ".join([program, *(failed[:1] or begun[-1:])])

    def tests(self):
        """Every test that is run: (program, its name)."""
        found = []
        for program in self.programs():
            listed = subprocess.run([self.build / "bin" / program, "--gtest_list_tests", f"--gtest_filter=-{SLOW}"],
                                    capture_output=True, text=True, check=True).stdout
            suite = ""
            for line in listed.splitlines():
                word = line.split("#")[0].strip()
                if line.startswith("  "):
                    found.append((program, suite + word))
                elif re.fullmatch(r"\S+\.", word):
                    suite = word
        return found


def with_all(files, faults, levels):
    """Path -> text of the sources with faults, and fault -> lines that its code begins and ends in."""
    broken, places = {}, {}
    for number, fault in enumerate(faults):
        if levels.get(str(fault), PLAIN) != ALONE:
            source = broken.setdefault(fault[0], schemata.Source("\n".join(files[fault[0]])))
            places[fault] = source.fault(*fault[1:], number, lenient=levels.get(str(fault)) == AT_RUN_TIME)
    return {name: source.broken(HERE / "chosen_fault.h") for name, source in broken.items()}, places


def blamed(said, places):
    """The faults in lines that the compiler complains of: where errors are, else where it says more about them."""
    for kind in ("error:", "(?:error:|note:|  required)"):
        lines = {(path, int(line) - 1) for path, line in
                 re.findall(rf"(?:include/pcm|/core)/(\S+?):(\d+):(?:\d+:)?\s+(?:fatal )?{kind}", said)}
        found = [fault for fault, (first, last) in places.items()
                 if any((fault[0].removeprefix("core/"), i) in lines for i in range(first, last + 1))]
        if found:
            return found
    words = set(re.findall(r"\w+", said))  # the use of a constant that is none any more
    return [fault for fault in places if (constant := schemata.CONSTANT.match(fault[3])) and constant["name"] in words]


def build(copy, files, faults):
    """Builds all faults in one, with those that the compiler refuses in another way or left out; these are the fault's levels."""
    levels = json.loads(copy.refused.read_text()) if copy.refused.is_file() else {}
    for number, target in enumerate(("pcm_core", "unit_tests")):
        while True:
            texts, places = with_all(files, faults, levels)
            copy.write(texts)
            if not number:
                copy.configure()
            said = copy.make(target)
            if not said:
                break
            (copy.folder / "compiler.log").write_text(said)
            again = blamed(said, places)
            if not again:
                sys.exit(f"the tests do not build: {copy.folder / 'compiler.log'}")
            for fault in again:
                levels[str(fault)] = levels.get(str(fault), PLAIN) + 1
            print(f"refused in this form: {', '.join(f'{fault[0]}:{fault[1] + 1}' for fault in again)}", flush=True)
            copy.refused.write_text(json.dumps(levels, indent=1))
    return levels


def reach(copy, faults, jobs):
    """Test -> (seconds, numbers of the faults whose code it executes), of every test that passes without a fault."""
    def one(test):
        with tempfile.NamedTemporaryFile(dir=copy.build) as file:
            file.truncate(1 << 16)
            begin = time.monotonic()
            failed = copy.run(*test, 600, PCM_FAULTS_REACHED=file.name)
            seconds = time.monotonic() - begin
            reached = pathlib.Path(file.name).read_bytes()
        if failed:
            print(f"fails without a fault: {failed}", flush=True)
            return test, None
        return test, (seconds, {i for i in range(len(faults)) if reached[i]})
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        return {test: result for test, result in pool.map(one, copy.tests()) if result}


def batches(tests, room):
    """The tests in the order in which they are tried, as lists for one call: (program, names, seconds). `tests`: (program, name)
    -> seconds. Quick ones first, those of the fault's room before others."""
    order = sorted(tests, key=lambda test: tests[test] * (1 if test[0] == f"test_{room}" else 3))
    calls, spent, steps = [{}], 0, iter(BATCHES)
    most = next(steps)
    for test in order:
        if spent > most and calls[-1]:
            calls.append({})
            spent, most = 0, next(steps)
        calls[-1].setdefault(test[0], []).append(test[1])
        spent += tests[test]
    return [(program, names, sum(tests[program, name] for name in names)) for call in calls for program, names in call.items()]


def noticed_by(copy, number, tests, room):
    """The first test that notices a fault, None where none does. A run that takes five times as long notices it."""
    for program, names, seconds in batches(tests, room):
        found = copy.run(program, ":".join(names), 20 + 5 * seconds, PCM_CHOSEN_FAULT=str(number))
        if found:
            return found
    return None


def noticed_alone(copy, files, fault, times):
    """The same for a fault that is built alone, tried on the tests of its room: None too; "" where it does not compile."""
    path = copy.source / fault[0]
    mixed = path.read_text(encoding="utf-8")
    lines = list(files[fault[0]])
    lines[fault[1]] = fault[3]
    path.write_text("\n".join(lines), encoding="utf-8")
    room = room_of(fault[0])
    try:
        if copy.make(f"test_{room}"):
            return ""
        return noticed_by(copy, -1, {test: seconds for test, (seconds, _) in times.items() if test[0] == f"test_{room}"}, room)
    finally:
        path.write_text(mixed, encoding="utf-8")


def judge(copy, files, faults, levels, jobs):
    """Prints a line for each fault, and the sum."""
    times = reach(copy, faults, jobs)
    counts = {"caught": 0, "missed": 0, "does not compile": 0}

    def tell(number, found, how=""):
        verdict = "caught" if found else "missed" if found is None else "does not compile"
        counts[verdict] += 1
        fault = faults[number]
        print(f"{number + 1}/{len(faults)} {verdict}{' by ' + found if found else ''}{how}: {fault[0]}:{fault[1] + 1}: {fault[2]}",
              flush=True)

    def together(number):
        tests = {test: seconds for test, (seconds, reached) in times.items() if number in reached}
        if not tests and levels.get(str(faults[number])) == AT_RUN_TIME:
            levels[str(faults[number])] = ALONE  # only the compiler evaluates it
        if levels.get(str(faults[number])) != ALONE:
            tell(number, noticed_by(copy, number, tests, room_of(faults[number][0])), "" if tests else ", no test executes it")
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        list(pool.map(together, range(len(faults))))
    for number, fault in enumerate(faults):
        if levels.get(str(fault)) == ALONE:
            tell(number, noticed_alone(copy, files, fault, times), ", built alone")
    judged = counts["caught"] + counts["missed"]
    print(f"{counts['caught']} of {judged} faults were noticed ({100 * counts['caught'] / max(1, judged):.0f} %); "
          f"{counts['does not compile']} more did not compile")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--root", type=pathlib.Path, required=True)
    parser.add_argument("--folder", type=pathlib.Path, required=True)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--faults", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("paths", nargs="*", help="only in files whose path below core/ begins like this, or in a line: FILE:LINE")
    arguments = parser.parse_args()
    files = sources(arguments.root)
    possible = all_faults(files)
    if arguments.paths:
        possible = named(possible, arguments.paths)
    faults = choose(possible, arguments.faults, arguments.seed)
    if not faults:
        sys.exit("there is no line to break in: " + " ".join(arguments.paths))
    copy = Copy(arguments.root, arguments.folder, arguments.jobs)
    print("Building the tests", flush=True)
    levels = build(copy, files, faults)
    print("Running each test once", flush=True)
    judge(copy, files, faults, levels, arguments.jobs)


if __name__ == "__main__":
    main()
