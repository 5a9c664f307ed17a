"""tools/check_docs.py: the documentation is right in a source archive too, which lacks some folders; and what is wrong is still seen there."""

import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
LEFT_OUT = [".ci", ".git", "build", "docs/images", "docs/results"]  # sdist.exclude of pyproject.toml, and what is no source


class Archive(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.tree = pathlib.Path(folder.name) / "g3r"
        left_out = {ROOT / name for name in LEFT_OUT}
        shutil.copytree(ROOT, self.tree, ignore=lambda at, names: [name for name in names if pathlib.Path(at, name) in left_out])

    def check(self):
        return subprocess.run([sys.executable, "-B", self.tree / "tools" / "check_docs.py"], capture_output=True, text=True)

    def test_pages_that_an_archive_lacks_are_not_missed(self):
        done = self.check()
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)

    def test_other_pages_are(self):
        (self.tree / "docs" / "formats.md").unlink()
        done = self.check()
        self.assertEqual(done.returncode, 1)
        self.assertIn("docs/formats.md does not exist", done.stdout)


if __name__ == "__main__":
    unittest.main()
