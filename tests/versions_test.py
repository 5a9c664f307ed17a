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
                ("addons/blender/g3r_point_cloud_to_mesh.py", r'^    "version": \((.+)\),$'),
                ("CHANGELOG.md", r"^## (\d\S*) - \d{4}-\d\d-\d\d$"),
                ("docs/start.md", r"source distribution, g3r-(.+)\.tar\.gz"),
                ("packaging/Containerfile", r"image\.version=(\S+)"),
                ("packaging/conda/meta.yaml", r'^  version: "(.+)"$'),
                ("packaging/debian/changelog", r"^g3r \((.+)-\d+\) "),
                ("packaging/homebrew/g3r.rb", r'^  url ".*/g3r-(.+)\.tar\.gz"$'),
                ("packaging/vcpkg/g3r/vcpkg.json", r'^  "version": "(.+)",$')):
            with self.subTest(file):
                self.assertEqual(found(file, pattern).replace(", ", "."), version)

    def test_the_shared_library_of_debian_has_its_name(self):
        major, minor = found("CMakeLists.txt", r"^project\(g3r VERSION (\d+\.\d+)").split(".")
        name = "libg3r%s.%s" % (major, minor)
        self.assertIn("Package: %s\n" % name, (ROOT / "packaging/debian/control").read_text())
        self.assertTrue((ROOT / ("packaging/debian/%s.install" % name)).exists())


if __name__ == "__main__":
    unittest.main()
