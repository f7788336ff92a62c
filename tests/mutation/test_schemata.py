"""Many faults in one build: where they are inserted, and that tests notice them one by one."""

import os
import pathlib
import subprocess
import tempfile
import unittest

import mutate
import operators
import schemata


def broken(text, index=0, what=None, lenient=False):
    """The text with the fault of a line that is described by `what`, or with its first."""
    source = schemata.Source(text)
    description, faulty = next(fault for fault in operators.faults_of(source.lines[index]) if what in (None, fault[0]))
    source.fault(index, description, faulty, 7, lenient)
    return source.broken("h").split("\n", 2)[2]


class Insertion(unittest.TestCase):
    def test_the_widest_expression_is_chosen_from(self):
        for good, expected in {
                "    return a < b;": "    return (pcm_fault(7) ? (a <= b) : (a < b));",
                "    const int a = f(b) + c, d = e;": "    const int a = (pcm_fault(7) ? (f(b) - c) : (f(b) + c)), d = e;",
                "    f(x, {a * b, c});": "    f(x, {(pcm_fault(7) ? (a / b) : (a * b)), c});",
                "    a[i + 1] = b;": "    a[(pcm_fault(7) ? (i - 1) : (i + 1))] = b;",
                "    if (a) sum += b - c;": "    if (a) sum += (pcm_fault(7) ? (b + c) : (b - c));",
                "    return a == b ? c : d;": "    return (pcm_fault(7) ? (a != b) : (a == b)) ? c : d;",
                "    for (int i = n; i < m; ++i) f();": "    for (int i = n; (pcm_fault(7) ? (i <= m) : (i < m)); ++i) f();",
                "    return Box{a, b}.x > c;": "    return (pcm_fault(7) ? (Box{a, b}.x >= c) : (Box{a, b}.x > c));",
                '    if (f(x) == "a;") return;': '    if ((pcm_fault(7) ? (f(x) != "a;") : (f(x) == "a;"))) return;',
                "    return !done;": "    return (pcm_fault(7) ? (done) : (!done));"}.items():
            self.assertEqual(broken(good), expected)

    def test_assignments_statements_and_conditions(self):
        self.assertEqual(broken("    if (a) n += b;", what="+= -> -="), "    if (a) (pcm_fault(7) ? (n -= b) : (n += b));")
        self.assertEqual(broken("    f(a);", what="f(a); -> nothing"), "    { if (!pcm_fault(7)) { f(a); } }")
        self.assertEqual(broken("    if (a) break;", what="break; -> continue;"),
                         "    if (a) { if (pcm_fault(7)) continue; else break; }")
        self.assertEqual(broken("    } else if (a) {", what="if (a) -> if (false)"), "    } else if (!pcm_fault(7) && (a)) {")
        self.assertEqual(broken("    if (a) return;", what="if (a) -> if (true)"), "    if (pcm_fault(7) || (a)) return;")

    def test_a_constant_is_computed_at_the_start_and_a_constexpr_function_when_it_runs(self):
        self.assertEqual(broken("    static constexpr int size = 3;"), "    static const int size = (pcm_fault(7) ? (4) : (3));")
        self.assertEqual(broken("constexpr int twice(int a) { return 2 * a; }", what="2 -> 3", lenient=True),
                         "constexpr int twice(int a) { return (pcm_fault_at_run_time(7) ? (3 * a) : (2 * a)); }")

    def test_lines_keep_their_numbers_and_faults_may_contain_others(self):
        text = "    return a ||  // why\n        b < c;\n    d();"
        source = schemata.Source(text)
        (what, either), (_, less) = operators.faults_of(source.lines[0])[0], operators.faults_of(source.lines[1])[0]
        self.assertEqual(source.fault(0, what, either, 1), (0, 1))
        source.fault(1, "< -> <=", less, 2)
        self.assertEqual(source.broken("h"), '#include "h"\n#line 1\n'
                         "    return (pcm_fault(1) ? (a && b < c) : ((pcm_fault(2) ? (a || b <= c) : (a ||  // why\n"
                         "        b < c))));\n    d();")


TOY = """\
int sum(int a, int b)
{
    return a + b;
}
int never(int a)
{
    return a + 1;
}
constexpr int size = 3;
int filled[size];
"""
TESTS = """\
#include <cstdio>
#include <cstring>
int sum(int a, int b);
int never(int a);
int main(int, char** arguments)
{
    if (std::strstr(arguments[1], "Toy.Sum")) {
        std::puts("[ RUN      ] Toy.Sum");
        std::fflush(stdout);
        return sum(1, 2) != 3;
    }
    return never(1) == 7;
}
"""


class OneBuild(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.copy = mutate.Copy(pathlib.Path("/"), pathlib.Path(self.folder.name), 1)
        (self.copy.build / "bin").mkdir(parents=True)

    def faults(self):
        lines = TOY.split("\n")
        return [("core/toy/toy.cpp", i, *operators.faults_of(lines[i])[0]) for i in (2, 6, 8)]

    def compile(self, faults, levels):
        texts, places = mutate.with_all({"core/toy/toy.cpp": TOY.split("\n")}, list(faults), levels)
        source = self.copy.build / "core" / "toy" / "toy.cpp"
        source.parent.mkdir(parents=True, exist_ok=True)
        source.write_text(texts["core/toy/toy.cpp"])
        (self.copy.build / "tests.cpp").write_text(TESTS)
        done = subprocess.run(["c++", "-std=c++17", "-o", self.copy.build / "bin" / "test_toy", source,
                               self.copy.build / "tests.cpp"],
                              capture_output=True, text=True, env=dict(os.environ, LC_ALL="C"))
        return done.stderr if done.returncode else "", places

    def test_faults_are_noticed_one_by_one(self):
        faults = self.faults()
        said, places = self.compile(faults, {})
        refused = mutate.blamed(said, places)
        self.assertEqual(refused, [faults[2]])  # the size of an array
        said, _ = self.compile(faults, {str(faults[2]): mutate.ALONE})
        self.assertEqual(said, "")
        self.copy.tests = lambda: [("test_toy", "Toy.Sum"), ("test_toy", "Toy.Never")]
        times = mutate.reach(self.copy, faults, 1)
        self.assertEqual({name: reached for (_, name), (_, reached) in times.items()}, {"Toy.Sum": {0}, "Toy.Never": {1}})
        tests = {test: seconds for test, (seconds, _) in times.items()}
        self.assertEqual(mutate.noticed_by(self.copy, 0, tests, "toy"), "test_toy Toy.Sum")
        self.assertIsNone(mutate.noticed_by(self.copy, 1, tests, "toy"))
        self.assertIsNone(mutate.noticed_by(self.copy, -1, tests, "toy"))

    def test_the_first_test_that_fails_is_named(self):
        program = self.copy.build / "bin" / "test_a"

        def run(script, limit=30, filters="*"):
            program.write_text("#!/bin/sh\n" + script)
            program.chmod(0o755)
            return self.copy.run("test_a", filters, limit, PCM_CHOSEN_FAULT="3")
        self.assertIsNone(run('test "$1$PCM_CHOSEN_FAULT" = "--gtest_filter=A.*3"', filters="A.*"))
        begun = "echo '[ RUN      ] A.x'\necho '[       OK ] A.x'\necho '[ RUN      ] A.y'\n"
        self.assertEqual(run(begun + "exit 1"), "test_a A.y")
        self.assertEqual(run(begun + "kill -SEGV $$"), "test_a A.y")
        self.assertEqual(run(begun + "sleep 30", limit=1), "test_a A.y")
        self.assertEqual(run("exit 1"), "test_a")

    def test_quick_tests_of_the_room_come_first(self):
        tests = {("test_a", "slow"): 5, ("test_a", "quick"): 1, ("test_b", "quick"): 1, ("test_b", "slower"): 40}
        self.assertEqual(mutate.batches(tests, "a"),
                         [("test_a", ["quick", "slow"], 6), ("test_b", ["quick"], 1), ("test_b", ["slower"], 40)])


if __name__ == "__main__":
    unittest.main()
