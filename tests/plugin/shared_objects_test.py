#!/usr/bin/env python3
"""What the plugins and the library that they share ask of the dynamic linker.

- BIND_NOW: a missing symbol fails the load, which MeshLab reports, and does not end the process at the first call.
- The core is in the process once: no plugin defines a function that the host library defines.
- Only the plugin that draws needs OpenGL and GLEW. (MeshLab and Qt load both anyway; this is about our own objects.)
"""
import argparse
import pathlib
import re
import subprocess
import unittest

GL_LIBRARY = re.compile(r"lib(GL|GLU|GLEW|GLX|OpenGL|EGL)\.so")
GL_SYMBOL = re.compile(r"_*(gl[A-Z]|glu[A-Z]|glX[A-Z]|egl[A-Z]|glew|GLEW)")


def readelf(*options):
    return subprocess.run(["readelf", "--wide", *options], capture_output=True, text=True, check=True).stdout


def needed(path):
    return re.findall(r"\(NEEDED\).*\[(.*)\]", readelf("--dynamic", path))


def symbols(path):
    """Dynamic symbols: (name, type, bind, defined)."""
    found = []
    for line in readelf("--dyn-syms", path).splitlines():
        field = line.split()
        if len(field) >= 8 and field[0].endswith(":") and field[0] != "Num:":
            found.append((field[7].split("@")[0], field[3], field[4], field[6] != "UND"))
    return found


def functions(path):
    """Strong definitions; templates and inline functions are weak and may be anywhere."""
    return {name for name, kind, bind, defined in symbols(path) if defined and kind == "FUNC" and bind == "GLOBAL"}


class SharedObjects(unittest.TestCase):
    arguments = None

    def each(self, *groups):
        for path in (path for group in groups for path in group):
            with self.subTest(pathlib.Path(path).name):
                yield path

    def test_every_symbol_is_bound_at_load(self):
        for path in self.each([self.arguments.host], self.arguments.no_gl, self.arguments.gl):
            dynamic = readelf("--dynamic", path)
            self.assertRegex(dynamic, r"\(FLAGS\).*BIND_NOW|\(FLAGS_1\).*NOW")

    def test_the_core_is_in_the_process_once(self):
        host = functions(self.arguments.host)
        self.assertTrue(any("pcm4Tree4open" in name for name in host))  # pcm::Tree::open
        for path in self.each(self.arguments.no_gl, self.arguments.gl):
            self.assertIn(pathlib.Path(self.arguments.host).name, needed(path))
            twice = sorted(name for name in functions(path) & host if name not in ("_init", "_fini"))
            self.assertEqual(twice, [])

    def test_only_drawing_needs_opengl(self):
        for path in self.each([self.arguments.host], self.arguments.no_gl):
            self.assertEqual([name for name in needed(path) if GL_LIBRARY.match(name)], [])
            self.assertEqual([name for name, _, _, defined in symbols(path) if not defined and GL_SYMBOL.match(name)], [])
        for path in self.each(self.arguments.gl):  # that the patterns find what they look for
            self.assertTrue(any(GL_LIBRARY.match(name) for name in needed(path)))
            self.assertTrue(any(GL_SYMBOL.match(name) for name, _, _, defined in symbols(path) if not defined))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--host", required=True)
    parser.add_argument("--no-gl", nargs="+", required=True, help="plugins that must not need OpenGL")
    parser.add_argument("--gl", nargs="+", required=True, help="plugins that draw")
    SharedObjects.arguments = parser.parse_args()
    unittest.main(argv=["shared_objects_test"], verbosity=2)
