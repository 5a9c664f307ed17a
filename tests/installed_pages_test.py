"""The pages that are installed have no link that leads nowhere, and are those of the sources in everything else.

Run by ctest with G3R_CMAKE and G3R_BUILD set to the program and the build folder.
"""

import os
import pathlib
import re
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
LINK = re.compile(r"\[([^][]*)\]\(([^()#\s]+)(#[^()]*)?\)")


def words(text):
    """The text with the words of its links alone."""
    return LINK.sub(r"\1", text)


class Pages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.prefix = pathlib.Path(cls.folder.name).resolve()
        subprocess.run([os.environ["G3R_CMAKE"], "--install", os.environ["G3R_BUILD"], "--component", "documentation", "--prefix", cls.prefix],
                       check=True, stdout=subprocess.DEVNULL)
        cls.readme = next(cls.prefix.rglob("README.md"))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def pages(self):
        found = sorted(self.readme.parent.rglob("*.md"))
        self.assertGreater(len(found), 30)
        return found

    def test_every_link_leads_somewhere(self):
        for page in self.pages():
            for _, place, _ in LINK.findall(page.read_text(encoding="utf-8")):
                if "://" in place:
                    continue
                target = pathlib.Path(os.path.normpath(page.parent / place))
                if target.is_relative_to(self.prefix / "include"):
                    target = ROOT / target.relative_to(self.prefix)  # part of another component
                elif not (ROOT / target.relative_to(self.readme.parent)).exists():
                    continue  # left out of a source archive
                self.assertTrue(target.exists(), f"{page.name}: {place}")

    def test_the_words_are_those_of_the_sources(self):
        for page in self.pages():
            source = ROOT / page.relative_to(self.readme.parent)
            self.assertEqual(words(page.read_text(encoding="utf-8")), words(source.read_text(encoding="utf-8")), source)


if __name__ == "__main__":
    unittest.main()
