"""packaging/release refuses what must not be released: before it fetches or builds anything."""

import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ["PCM_SOURCE_DIR"])
MAINTAINER = "Ada Lovelace <ada@example.org>"


class Release(unittest.TestCase):
    """A repository with what the script reads, at a commit with the tag of its version; no cargo is there."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name) / "checkout"
        for name in (".gitignore", "CMakeLists.txt", "packaging/release", "packaging/lib.sh", "packaging/debian/control"):
            (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(SOURCE / name, self.folder / name)
        self.programs = pathlib.Path(temporary.name) / "bin"
        self.programs.mkdir()
        (self.programs / "cargo").write_text("#!/bin/sh\necho no crates here >&2\nexit 1\n")
        (self.programs / "cargo").chmod(0o755)
        self.git("init", "-q")
        self.git("add", ".")
        self.git("-c", "user.name=A", "-c", "user.email=a@example.org", "commit", "-qm", "All")

    def git(self, *words):
        subprocess.run(["git", *words], cwd=self.folder, check=True, capture_output=True)

    def tag(self):
        text = (self.folder / "CMakeLists.txt").read_text(encoding="utf-8")
        self.git("tag", "v" + text.split("project(pcm VERSION ")[1].split()[0])

    def refusal(self, *options):
        # The script asks for cargo in /usr/bin first: an empty source has no crates there either.
        result = subprocess.run([self.folder / "packaging" / "release", *options], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                                timeout=60, check=False, env=dict(os.environ, PATH=f"{self.programs}:{os.environ['PATH']}"))
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        return result

    def begins(self, *options):
        """It is not refused: it begins with the source, whose crates cannot be had."""
        self.assertIn("== Source of pcmlab-", self.refusal(*options).stdout)

    def test_a_release_names_a_maintainer(self):
        self.begins()  # a commit without a tag is not a release
        self.tag()
        refused = self.refusal()
        self.assertIn("--maintainer 'NAME <ADDRESS>'", refused.stderr)
        self.assertEqual(refused.stdout, "")
        self.begins("--maintainer", MAINTAINER)
        self.begins("--without-debs")

    def test_an_address_that_is_none(self):
        for wrong in ("Ada", "ada@example.org", "<ada@example.org>", "Ada <example.org>", "Ada <a@b> <c@d>", "Ada, Charles <ada@example.org>"):
            with self.subTest(wrong):
                self.assertIn("not a name with an address", self.refusal("--maintainer", wrong).stderr)

    def test_a_tag_of_another_version(self):
        self.git("tag", "v99.0.0")
        self.assertIn("Make them agree", self.refusal("--maintainer", MAINTAINER).stderr)

    def test_changes_that_are_not_committed(self):
        (self.folder / "new.txt").touch()
        self.assertIn("not committed", self.refusal().stderr)


if __name__ == "__main__":
    unittest.main()
