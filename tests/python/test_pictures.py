"""Pictures of the module pcmlab: arrays, files, and what a notebook shows."""

import os
import tempfile
import unittest
import unittest.mock

import with_numpy  # noqa: F401 isort: skip
import numpy
import pcmlab
from pcmlab import drawing


class Pictures(unittest.TestCase):
    """A sheet of points, 100 x 50, red where x < 50 and blue elsewhere, from above: 2 pixels a unit."""

    above = {"eye": (50, 25, 100), "target": (50, 25, 0), "up": (0, 1, 0), "height": 50, "size": "200x100", "converge": 1}

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        x, y = (axis.ravel() for axis in numpy.meshgrid(numpy.arange(0, 100, 0.25) + 0.125, numpy.arange(0, 50, 0.25) + 0.125))
        rgb = numpy.where((x < 50)[:, None], [65535, 0, 0], [0, 0, 65535]).astype("u2")
        cls.cloud = pcmlab.from_arrays(os.path.join(cls.folder.name, "sheet <1>.pct"), numpy.stack([x, y, 0 * x], 1), rgb=rgb)
        try:
            drawing._program()
        except pcmlab.Error as error:
            cls.folder.cleanup()
            raise unittest.SkipTest(str(error)) from None

    @classmethod
    def tearDownClass(cls):
        del cls.cloud
        cls.folder.cleanup()

    def test_a_picture_is_an_array(self):
        picture = self.cloud.picture(**self.above)
        self.assertEqual((picture.shape, picture.dtype), ((100, 200, 4), numpy.uint8))
        numpy.testing.assert_array_equal(picture[50, 20], [255, 0, 0, 255])
        numpy.testing.assert_array_equal(picture[50, 180], [0, 0, 255, 255])
        upper = self.cloud.picture(clip="box 0 25 -1 100 50 1", **self.above)
        self.assertEqual((upper[20, 20, 3], upper[80, 20, 3]), (255, 0))  # the top row comes first

    def test_a_background_leaves_no_transparency(self):
        picture = pcmlab.render([self.cloud.folder], background="#00ff00", **{**self.above, "height": 200})
        self.assertEqual(picture.shape, (100, 200, 3))
        numpy.testing.assert_array_equal(picture[0, 0], [0, 255, 0])

    def test_a_file_has_the_same_answer_as_the_command(self):
        file = os.path.join(self.folder.name, "-a.npy")
        answer = pcmlab.render([self.cloud.folder], output=file, **self.above)
        self.assertEqual((answer["width"], answer["height"], answer["pictures"][0]["file"]), (200, 100, file))
        self.assertIn(f"{self.cloud.points:,} points", str(answer))
        numpy.testing.assert_array_equal(numpy.load(file), self.cloud.picture(**self.above))
        with self.assertRaises(pcmlab.Error) as raised:
            pcmlab.render([self.cloud.folder], output=file, **self.above)
        self.assertEqual((raised.exception.code, raised.exception.path), ("exists", file))
        self.assertIn("--overwrite", raised.exception.hint)

    def test_wrong_arguments_are_named(self):
        for name, value in (("samples", 99), ("eye", (1, 2)), ("colour", "none"), ("size", "3x")):
            with self.assertRaisesRegex((pcmlab.ArgumentError, pcmlab.Error), "--" + name):
                self.cloud.picture(**{name: value})

    def test_the_callback_cancels(self):
        said = []
        with self.assertRaises(pcmlab.Error) as raised:
            self.cloud.picture(size="2000x2000", converge=16, progress=lambda *what: said.append(what) or False)
        self.assertEqual((raised.exception.code, said), ("cancelled", [(0.0, "Drawing")]))
        with self.assertRaises(ZeroDivisionError):
            self.cloud.picture(size="2000x2000", converge=16, progress=lambda *_: 1 / 0)

    def test_a_notebook_shows_picture_and_text(self):
        shown = self.cloud._repr_html_()
        self.assertRegex(shown, '^<img src="data:image/png;base64,[A-Za-z0-9+/]{400,}=*"/><pre>&lt;pcmlab.Cloud .*sheet &lt;1&gt;.pct')

    def test_without_the_program_it_is_said(self):
        with unittest.mock.patch.object(drawing, "PROGRAM", "pcmlab-none"):
            with self.assertRaisesRegex(pcmlab.Error, "install the package pcmlab") as raised:
                self.cloud.picture()
            self.assertEqual(raised.exception.code, "not_found")
            self.assertTrue(self.cloud._repr_html_().startswith("<pre>&lt;pcmlab.Cloud"))

    def test_a_program_that_ends_without_an_answer_is_reported(self):
        with unittest.mock.patch.object(drawing, "_program", lambda: "/bin/false"):
            with self.assertRaisesRegex(pcmlab.Error, "/bin/false ended with 1: without a word"):
                self.cloud.picture()


if __name__ == "__main__":
    unittest.main()
