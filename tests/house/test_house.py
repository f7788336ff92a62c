#!/usr/bin/env python3
"""The house as core/README.md draws it, held against the sources; and that each check notices the fault it is there for.

    python3 tests/house/test_house.py            all of it
    python3 tests/house/test_house.py --arrows   prints the arrows that the sources have, in the form of the list
"""
import sys
import unittest

import house

LIST = """
```floors
vocabulary
    system
    cloud: system
trees
    tree
    build: tree
drawing
    gl/base
```
"""


def small(sources):
    return house.Tree(sources, house.read_arrows(LIST))


class Project(unittest.TestCase):
    tree = house.Tree.of_project()

    def none(self, complaints):
        self.assertEqual(complaints, [], "\n" + "\n".join(complaints))

    def test_includes_follow_the_arrows(self):
        self.none(house.check_arrows(self.tree))

    def test_the_list_of_arrows_is_one_way_and_used(self):
        self.none(house.check_list(self.tree))

    def test_meshlab_is_known_to_its_folder_alone(self):
        self.none(house.check_meshlab(self.tree))

    def test_formats_do_not_know_each_other(self):
        self.none(house.check_formats(self.tree))

    def test_files_and_functions_are_short(self):
        self.none(house.check_sizes(self.tree))

    def test_exceptions_from_the_sizes_are_still_needed(self):
        self.none(house.check_exceptions(self.tree))

    def test_reports_take_any_text(self):
        self.none(house.check_reports(self.tree))

    def test_words_are_plain(self):
        self.none(house.check_words({**self.tree.sources, **house.other_texts()}))

    def test_words_are_plain_by_the_second_table(self):
        self.none(house.check_plain_words({**self.tree.sources, **house.other_texts()}))

    def test_tuned_values_have_a_unit_a_provenance_a_reader_and_a_sweep(self):
        for room in ("fit", "place", "detect", "piping", "knn", "gl"):
            self.assertTrue(house.tuned_structs(self.tree.sources[f"core/{room}/tuning.h"]), f"{room} has no tuned values")
        self.none(house.check_tuning(self.tree.sources))

    def test_the_repository_holds_only_what_belongs_to_it(self):
        files = house.tracked_files()
        if files is None:
            self.skipTest("no checkout, or no git")
        self.none(house.check_tracked_files(files))

    def test_layout_is_clang_format_s(self):
        program = house.formatter()
        if not program:
            self.skipTest("clang-format 14 is not installed (Debian 12: clang-format)")
        self.none(house.check_format(program, names=list(self.tree.sources)))


class Checks(unittest.TestCase):
    """A check that cannot complain is none."""

    def test_an_arrow_that_is_not_in_the_list(self):
        good = {"core/build/a.cpp": '#include "pcm/tree/b.h"\n', "core/tree/b.h": '#include "pcm/cloud/c.h"\n'}
        self.assertEqual(house.check_arrows(small(good)), [])
        bad = dict(good, **{"core/tree/b.h": '#include "pcm/build/a.h"\n'})
        self.assertEqual(house.check_arrows(small(bad)), ["core/tree/b.h: includes pcm/build/a.h; tree may not use build"])

    def test_a_room_that_is_not_in_the_list(self):
        self.assertEqual(len(house.check_arrows(small({"core/attic/a.h": ""}))), 1)

    def test_an_include_without_prefix(self):
        self.assertEqual(len(house.check_arrows(small({"core/tree/a.h": '#include "tree/b.h"\n'}))), 1)

    def test_a_package_in_the_wrong_room(self):
        sources = {"core/gl/base/a.h": "#include <GL/glew.h>\n"}
        self.assertEqual(house.check_arrows(small(sources)), [])
        self.assertEqual(len(house.check_arrows(small({"core/tree/a.h": "#include <GL/glew.h>\n"}))), 1)
        self.assertEqual(len(house.check_arrows(small({"core/tree/a.h": "#include <QString>\n"}))), 1)

    def test_a_room_of_a_higher_floor(self):
        self.assertEqual(house.check_arrows(small({"core/gl/base/a.h": '#include "pcm/cloud/b.h"\n'})), [])
        self.assertEqual(len(house.check_arrows(small({"core/cloud/a.h": '#include "pcm/gl/base/b.h"\n'}))), 1)
        self.assertEqual(len(house.check_arrows(small({"core/system/a.h": '#include "pcm/cloud/b.h"\n'}))), 1)

    def test_a_list_that_goes_back(self):
        with self.assertRaises(ValueError):
            house.read_arrows("```floors\nlow\n    a: b\n```")
        tree = house.Tree({}, house.read_arrows("```floors\nlow\n    a: b\n    b\n```"))
        self.assertIn("the list has a use b, which does not stand above it", house.check_list(tree))

    def test_a_name_of_another_floor(self):
        tree = house.Tree({"core/b/x.h": '#include "pcm/a/y.h"\n'}, house.read_arrows("```floors\nlow\n    a\nhigh\n    b: a\n```"))
        self.assertEqual(house.check_list(tree), ["the list names a for b, which is on another floor: lower floors need no name"])

    def test_an_arrow_that_nothing_uses(self):
        tree = house.Tree({"core/b/x.h": ""}, house.read_arrows("```floors\nlow\n    a\n    b: a\n```"))
        self.assertEqual(house.check_list(tree), ["the list lets b use a, and nothing does"])

    def test_a_type_of_meshlab_s_elsewhere(self):
        good = {"plugin/tools/clip/a.cpp": '// as MeshModel\nconst char* x = "MeshModel";\n#include "plugin/scene/scene.h"\n',
                "plugin/meshlab/meshlab.h": "#include <common/interfaces.h>\n",
                "plugin/meshlab/registry.h": "class GLArea;\nvoid f(vcg::Point3f);\n"}
        self.assertEqual(house.check_meshlab(small(good)), [])
        for line in ("class GLArea;", "void f(MeshModel& layer);", "vcg::Point3f p;", "RichParameterList list;", "Matrix44m m;",
                     "#include <common/interfaces.h>", "#include <meshlab/glarea.h>"):
            self.assertEqual(len(house.check_meshlab(small({**good, "plugin/scene/b.h": line + "\n"}))), 1, line)
        self.assertEqual(len(house.check_meshlab(small({"plugin/meshlab/a.h": "#include <common/interfaces.h>\n"}))), 1)

    def test_a_format_that_reads_another(self):
        sources = {"core/io/las/a.cpp": '#include "pcm/io/ply/b.h"\n'}
        self.assertEqual(len(house.check_formats(small(sources))), 1)
        self.assertEqual(house.check_formats(small({"core/io/las/a.cpp": '#include "pcm/io/reader.h"\n'})), [])

    def test_a_long_function_and_a_long_file(self):
        body = "    call();\n"
        self.assertEqual(house.check_sizes(small({"core/tree/a.cpp": "int f()\n{\n" + body * 57 + "}\n"})), [])
        self.assertEqual(len(house.check_sizes(small({"core/tree/a.cpp": "int f()\n{\n" + body * 58 + "}\n"}))), 1)
        inner = "struct S {\n    int f(int a,\n          int b)\n    {\n" + "        call();\n" * 70 + "    }\n};\n"
        self.assertEqual(house.check_sizes(small({"core/tree/a.cpp": inner})),
                         ["core/tree/a.cpp:2: a function of 74 lines, more than 60: int f(int a,"])
        self.assertEqual(len(house.check_sizes(small({"core/tree/a.cpp": "int a;\n" * 501}))), 1)

    def test_an_exception_that_is_no_longer_needed(self):
        self.assertEqual(len(house.check_exceptions(small({"core/tree/a.h": ""}), {"core/tree/a.h": "x"}, {})), 1)
        self.assertEqual(len(house.check_exceptions(small({"core/tree/a.h": ""}), {}, {"core/tree/a.h:int f()": "x"})), 1)

    def test_a_report_that_throws(self):
        safe = "text = json.dump(1, ' ', false, Json::error_handler_t::replace);\n"
        self.assertEqual(house.check_reports(small({"core/cad/a.cpp": safe, "core/cli/common.cpp": safe})), [])
        self.assertEqual(len(house.check_reports(small({"core/cad/a.cpp": "puts(json.dump(2).c_str());\n"}))), 1)
        self.assertEqual(len(house.check_reports(small({"core/cli/a.cpp": safe}))), 1)
        self.assertEqual(len(house.check_reports(small({"core/cli/common.cpp": safe + safe}))), 1)
        self.assertEqual(len(house.check_reports(small({"core/cli/a.cpp": "std::cout << json;\n"}))), 1)

    def test_a_file_that_does_not_belong(self):
        self.assertEqual(house.check_tracked_files({"core/a.cpp": 10, ".ci/run": 1, "README.md": 5}), [])
        self.assertEqual(len(house.check_tracked_files({"wheel.whl": 10})), 1)
        self.assertEqual(len(house.check_tracked_files({"core/a.laz": 2 << 20})), 1)

    def test_a_word_of_the_dialect(self):
        self.assertEqual(len(house.check_words({"a.h": "// whoever wants to\n// a bit a cell\n// a resumed build\n"})), 2)

    def test_a_word_of_the_second_table(self):
        bad = [
            "// Of each point the distance.\n", "// The median. Of integers exactly.\n",
            "std::size_t n;  // of its points\n", "double d;  // that was used\n", "std::map<int, int> m;  // by name\n",
            "// written beside it\n", "// after so many points\n", "// differ by so much\n", "// it grows so far\n",
            "// takes no part\n", "// points that take part\n", "// what is no list of points\n",
            "// the most samples\n", "// the least size\n", "// a note says so\n", "// it is said to be doubtful\n",
            "// alarms\n", "// surely outside\n", "// roughly near\n", "// all alike\n", "// can be had back\n",
            "// the rest stays as it was\n", "// `sizes`: of the cells\n", "// more than others let expect\n",
            "refuse(\"this is no list of primitives\");\n", "add(\"--size\", size, \"Of the picture\");\n",
        ]
        found = set()
        for line in bad:
            complaints = house.check_plain_words({"core/tree/a.h": line})
            self.assertEqual(len(complaints), 1, line)
            found.add(complaints[0].rpartition("(write: ")[2])
        self.assertEqual(found, {better + ")" for better in house.PLAIN_WORDS.values()})
        self.assertEqual(len(house.check_plain_words({"README.md": "put beside the file\n"})), 1)
        self.assertEqual(len(house.check_plain_words({"packaging/run": "# put beside the file\n"})), 1)
        self.assertEqual(len(house.check_plain_words({"tests/fit/a_test.cpp": "// put beside the file\n"})), 1)
        good = [
            "std::size_t n;  // number of points\n", "// of two points the nearer one\n", "hit.beside = 1;  // distance\n",
            "// `beside` is a path\n", "// points so far\n", "// is no larger than the box\n", "// there is no point\n",
            "// the most recently used\n", "// expected false alarms\n", "#include \"pcm/tree/beside.h\"\n",
            "const char* url = \"http://of this\";\n", "// is no longer open\n",
        ]
        for line in good:
            self.assertEqual(house.check_plain_words({"core/tree/a.h": line}), [], line)

    def test_a_tuned_value_without_its_parts(self):
        header = ("struct ChanceTuning {\n    // Share of points.\n    // Chosen: not swept.\n"
                  "    double max_chance = 0.4;  // share\n};\n\nstruct FitTuning {\n    ChanceTuning chance;\n};\n")
        whole = {"core/fit/tuning.h": header, "core/fit/tuning.cpp": "PCM_TUNED(fit.chance.max_chance)",
                 "core/fit/fit.cpp": "x > fit_tuning().chance.max_chance",
                 "bench/sweep/sweep.cpp": '#include "pcm/fit/tuned_values.h"\n'}
        self.assertEqual(house.check_tuning(whole), [])
        by_name = {**whole, "core/fit/fit.cpp": "const ChanceTuning& tuned = x; y > tuned.max_chance"}
        self.assertEqual(house.check_tuning(by_name), [])
        for file, part, word in (("core/fit/tuning.h", "  // share", "unit"),
                                 ("core/fit/tuning.h", "    // Chosen: not swept.\n", "provenance"),
                                 ("core/fit/tuning.h", "    ChanceTuning chance;\n", "not a member"),
                                 ("core/fit/tuning.cpp", "max_chance", "does not know max_chance"),
                                 ("core/fit/fit.cpp", "fit_tuning().chance.", "nothing reads"),
                                 ("bench/sweep/sweep.cpp", "fit", "does not know the values")):
            complaints = house.check_tuning({**whole, file: whole[file].replace(part, "", 1)})
            self.assertEqual(len(complaints), 1, complaints)
            self.assertIn(word, complaints[0])
        # A second value does not share the first one's provenance.
        two = header.replace("};", "    double min_chance = 0.1;  // share\n};", 1)
        self.assertIn("min_chance has no provenance", "\n".join(house.check_tuning({**whole, "core/fit/tuning.h": two})))

    def test_a_line_that_clang_format_would_change(self):
        program = house.formatter()
        if not program:
            self.skipTest("clang-format 14 is not installed")
        import pathlib
        import tempfile
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / ".clang-format").write_text((house.ROOT / ".clang-format").read_text())
            (root / "good.h").write_text("int a;\n")
            (root / "bad.h").write_text("int   a;\n")
            self.assertEqual(len(house.check_format(program, root, ["good.h", "bad.h"])), 1)


def print_arrows():
    tree = Project.tree
    rooms = {}
    for name, text in tree.sources.items():
        room = house.room_of(name, tree.arrows)
        for include in house.includes_of(text):
            if include.startswith(('"pcm/', '"plugin/')):
                path = include[1:-1]
                other = house.room_of("core/" + path[4:] if path.startswith("pcm/") else path, tree.arrows)
                rooms.setdefault(room, {}).setdefault(other, set()).add(f"{name.rpartition('/')[2]}>{path.rpartition('/')[2]}")
    for room, others in sorted(rooms.items()):
        if room not in ("tests", "bench"):
            print(f"{room}: {' '.join(sorted(other for other in others if other != room))}")
            for other, files in sorted(others.items()):
                if other != room:
                    print(f"    {other}: {' '.join(sorted(files)[:6])}")


if __name__ == "__main__":
    if sys.argv[1:] == ["--arrows"]:
        print_arrows()
    else:
        unittest.main()
