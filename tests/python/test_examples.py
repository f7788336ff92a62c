"""The examples in the documentation of the module do what they show, one after another in a folder with a scan."""

import doctest
import os
import tempfile
import unittest

import with_numpy  # noqa: F401 isort: skip
import pcmlab
import pcmlab.cloud


class Examples(unittest.TestCase):
    def test_they_do_what_they_show(self):
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            pcmlab.generate("scan.laz", points=20_000)
            tried = 0
            for module in (pcmlab, pcmlab.cloud):  # the first one builds the tree
                results = doctest.testmod(module)
                self.assertEqual(results.failed, 0, "see above")
                tried += results.attempted
            self.assertGreaterEqual(tried, 14)
            os.chdir(before)


if __name__ == "__main__":
    unittest.main()
