"""The version is stated in CMakeLists.txt; what repeats it says the same."""

import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent


def found(file, pattern):
    match = re.search(pattern, (ROOT / file).read_text(), re.MULTILINE)
    return match.group(1) if match else None


class Versions(unittest.TestCase):
    def test_every_file_has_that_of_the_project(self):
        version = found("CMakeLists.txt", r"^project\(g3r VERSION (\S+)")
        for file, pattern in (
                ("CITATION.cff", r"^version: (\S+)$"),
                ("CHANGELOG.md", r"^## (\d\S*) - \d{4}-\d\d-\d\d$")):
            with self.subTest(file):
                self.assertEqual(found(file, pattern), version)


if __name__ == "__main__":
    unittest.main()
