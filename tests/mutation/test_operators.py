"""The faults that are made, and the choice of tests for them."""

import pathlib
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

    def test_files_and_lines_are_named(self):
        faults = [("core/io/a.cpp", 1, "", ""), ("core/io/a.cpp", 11, "", ""), ("core/io/b.h", 1, "", "")]
        self.assertEqual(mutate.named(faults, ["io/a.cpp:2"]), faults[:1])
        self.assertEqual(mutate.named(faults, ["core/io/a.cpp", "io/c"]), faults[:2])
        self.assertEqual(mutate.named(faults, ["io"]), faults)


if __name__ == "__main__":
    unittest.main()
