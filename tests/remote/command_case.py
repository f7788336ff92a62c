"""Tests that start the command, with settings for servers of their own alone and a tree of 3 million points."""

import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

PROGRAM = pathlib.Path(os.environ["PCM_BUILD_DIR"]) / "bin" / "pcmlab"
SECRET = "wJalrXUtnFEMI/K7MDENG+bPxRfiCYEXAMPLEKEY"


class CommandCase(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp())
        cls.tree = cls.made("site.pct", "3000000")

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def made(cls, name, points, *options):
        file = cls.folder / f"{name}.las"
        for command in (["generate", file, "-n", points, "--no-truth", *options], ["build", file, "-o", cls.folder / name]):
            subprocess.run([PROGRAM, *command, "-q"], check=True, capture_output=True)
        return cls.folder / name

    def run_command(self, *arguments, **variables):
        environment = {name: value for name, value in os.environ.items() if not name.startswith("AWS_")}
        environment.update({"PCM_NETWORK_CACHE": "0", "HOME": str(self.folder), **{name: str(value) for name, value in variables.items()}})
        return subprocess.run([PROGRAM, *map(str, arguments)], env=environment, capture_output=True, text=True, check=False)

    def answer(self, *arguments, **variables):
        run = self.run_command(*arguments, "--json", **variables)
        self.assertEqual(run.returncode, 0, run.stderr)
        return json.loads(run.stdout)
