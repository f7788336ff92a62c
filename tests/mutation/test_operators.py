"""The faults that are made, and the choice of tests for them."""

import pathlib
import subprocess
import tempfile
import unittest

import mutate
import operators


def faulty(line):
    return [fault for _, fault in operators.faults_of(line)]


class Faults(unittest.TestCase):
    def test_operators_and_numbers(self):
        self.assertEqual(faulty("    return a < b;"), ["    return a <= b;"])
        self.assertEqual(faulty("    return a == 1;"), ["    return a != 1;", "    return a == 2;"])
        self.assertIn("    x = b - c;", faulty("    x = b + c;"))
        self.assertIn("    x = b + c;".replace("b + c", "std::max(b, c)"), faulty("    x = std::min(b, c);"))
        self.assertEqual(faulty("    return !found;"), ["    return found;"])
        self.assertEqual(faulty("    return true;"), ["    return false;"])

    def test_statements_and_conditions(self):
        self.assertIn("    ;", faulty("    file.sync();"))
        self.assertIn("    ;", faulty("    count = 3 + n;"))
        self.assertIn("    if (false) return;", faulty("    if (ready(a)) return;"))
        self.assertIn("    if (true) return;", faulty("    if (ready(a)) return;"))
        for line in ("    const int a = b;", "    return f(a);", "    std::string name = f();"):
            self.assertNotIn("    ;", faulty(line), line)

    def test_what_is_no_code_stays(self):
        for line in ("// a < b", '#include "a/1.h"', "", "    // return true;", "template <class T>", '    f("a < 1 + 2", \'1\')',
                     "    std::vector<int> istrue(a);"):
            self.assertEqual([fault for fault in faulty(line) if fault.strip() != ";"], [], line)

    def test_hints_of_capacity_have_no_faults(self):
        for line in ("    found.reserve(2 * n + 1);", "    for (auto& list : lists) list.reserve(8);", "        table->reserve(n);"):
            self.assertEqual(faulty(line), [], line)
        self.assertNotEqual(faulty("    return file.reserve(room + 1);"), [])
        self.assertNotEqual(faulty("    block.offset = spool_.file_.reserve(room);"), [])

    def test_no_fault_is_the_line_itself(self):
        files = mutate.sources(pathlib.Path(__file__).resolve().parents[2])
        faults = mutate.all_faults(files)
        self.assertGreater(len(faults), 10000)
        self.assertTrue(all(fault != files[name][i] for name, i, _, fault in faults))
        chosen = mutate.choose(faults, 100, 1)
        self.assertEqual(len({fault[:2] for fault in chosen}), 100)
        self.assertEqual(chosen, mutate.choose(faults, 100, 1))
        self.assertNotEqual(chosen, mutate.choose(faults, 100, 2))

    def test_tests_of_a_room_come_first(self):
        rooms = {"system": [], "io": ["system"], "io/las": ["io"], "tree": ["system"], "convert": ["tree", "io"]}
        programs = ["test_convert", "test_io", "test_system", "test_tree"]
        self.assertEqual(mutate.tests_for("core/io/las/las_reader.cpp", rooms, programs), (["test_io"], []))
        self.assertEqual(mutate.tests_for("core/io/reader.cpp", rooms, programs), (["test_io"], ["test_convert"]))
        self.assertEqual(mutate.tests_for("core/system/file.cpp", rooms, programs),
                         (["test_system"], ["test_convert", "test_io", "test_tree"]))

    def test_the_fault_is_in_its_line_and_subscripts_are_checked(self):
        text = mutate.with_fault("#include <array>\nstd::array<int, 2> a;\nint main(int n, char**) { return a[n]; }\n", 2,
                                 "int main(int n, char**) { return a[n + 1]; }")
        with tempfile.TemporaryDirectory() as folder:
            program = pathlib.Path(folder) / "a"
            source = program.with_suffix(".cpp")
            source.write_text(text)
            subprocess.run(["c++", "-o", program, source], check=True)
            self.assertLess(subprocess.run([program], capture_output=True).returncode, 0)
            source.write_text(mutate.with_fault("a\nb\nc", 1, "wrong"))
            failed = subprocess.run(["c++", "-fsyntax-only", source], capture_output=True, text=True)
            self.assertIn("a.cpp:1:1", failed.stderr)

    def test_tests_near_the_file_come_first(self):
        with tempfile.TemporaryDirectory() as folder:
            tests = pathlib.Path(folder)
            (tests / "deep").mkdir()
            (tests / "a_test.cpp").write_text('#include "pcm/io/b.h"\nTEST(One, X)\n{\n}\nTEST_F(Two, X)\nTEST_P(Two, Y)\n')
            (tests / "deep" / "c_test.cpp").write_text("TYPED_TEST(Three, X)\n")
            self.assertEqual(mutate.suites_near("core/io/b.cpp", tests), "One.*:*/One.*:One/*:Two.*:*/Two.*:Two/*")
            self.assertEqual(mutate.suites_near("core/io/b.h", tests), mutate.suites_near("core/io/b.cpp", tests))
            self.assertEqual(mutate.suites_near("core/io/deep/c.cpp", tests), "Three.*:*/Three.*:Three/*")
            self.assertEqual(mutate.suites_near("core/io/d.cpp", tests), "")

    def test_the_first_test_that_fails_is_named(self):
        with tempfile.TemporaryDirectory() as folder:
            copy = mutate.Copy.__new__(mutate.Copy)
            copy.build = pathlib.Path(folder)
            (copy.build / "bin").mkdir()
            program = copy.build / "bin" / "test_a"

            def run(script, limit=30, **filters):
                program.write_text("#!/bin/sh\n" + script)
                program.chmod(0o755)
                return copy.run("test_a", limit, **filters)
            self.assertIsNone(run('test "$1" = "--gtest_filter=-*KilledAtAnyCall*:*Kill*"'))
            self.assertIsNone(run('test "$1" = "--gtest_filter=A.*-*KilledAtAnyCall*:*Kill*"', only="A.*"))
            self.assertIsNone(run('test "$1" = "--gtest_filter=-*KilledAtAnyCall*:*Kill*:A.*"', less="A.*"))
            begun = "echo '[ RUN      ] A.x'\necho '[       OK ] A.x'\necho '[ RUN      ] A.y'\n"
            self.assertEqual(run(begun + "exit 1"), "test_a A.y")
            self.assertEqual(run(begun + "kill -SEGV $$"), "test_a A.y")
            self.assertEqual(run(begun + "sleep 30", limit=1), "test_a A.y")
            self.assertEqual(run("exit 1"), "test_a")


if __name__ == "__main__":
    unittest.main()
