"""Truths about what g3r is made from: the list of its parts is complete, valid and the same each time, and what is built names no folder
of the machine that built it.

Run by ctest with G3R_SOURCE, the folder of the sources, and G3R_BUILT, programs and libraries of a build without debug information (may
be empty).
"""

import json
import os
import re
import subprocess
import sys
import unittest

SOURCE = os.environ["G3R_SOURCE"]
BUILT = [path for path in os.environ.get("G3R_BUILT", "").split(",") if path]


def bill(**environment):
    return subprocess.run([sys.executable, "-B", os.path.join(SOURCE, "tools", "sbom.py")], capture_output=True, check=True,
                          env={**os.environ, **environment}).stdout


def text_of(name):
    with open(os.path.join(SOURCE, name)) as file:
        return file.read()


class SupplyChain(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.bill = bill()
        cls.document = json.loads(cls.bill)

    def test_the_list_of_parts_is_the_same_each_time(self):
        self.assertEqual(bill(), self.bill)
        self.assertIn(b'"created": "1970-01-02T00:00:00Z"', bill(SOURCE_DATE_EPOCH="86400"))

    def test_the_list_has_every_package_and_source(self):
        parts = {part["SPDXID"]: part for part in self.document["packages"]}
        names = {part["name"] for part in parts.values()}
        for line in text_of("packages.txt").split():
            self.assertIn(line, names)
        for checksum in re.findall(r"\b[0-9a-f]{64}\b", text_of("tools/sources.sh")):
            wanted = {"algorithm": "SHA256", "checksumValue": checksum}
            self.assertTrue(any(wanted in part.get("checksums", []) for part in parts.values()))
        self.assertTrue({"LASzip", "libE57Format"} <= names)

    def test_the_list_is_spdx(self):
        document = self.document
        self.assertEqual(document["spdxVersion"], "SPDX-2.3")
        self.assertEqual(document["dataLicense"], "CC0-1.0")
        self.assertEqual(document["SPDXID"], "SPDXRef-DOCUMENT")
        self.assertRegex(document["creationInfo"]["created"], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$")
        self.assertTrue(document["documentNamespace"].startswith("https://"))
        known = {"SPDXRef-DOCUMENT"} | {part["SPDXID"] for part in document["packages"]}
        self.assertEqual(len(known), len(document["packages"]) + 1)
        for part in document["packages"]:
            self.assertRegex(part["SPDXID"], r"^SPDXRef-[A-Za-z0-9.-]+$")
            for field in ("name", "downloadLocation", "filesAnalyzed", "licenseConcluded", "licenseDeclared", "copyrightText"):
                self.assertIn(field, part)
        for relation in document["relationships"]:
            self.assertTrue({relation["spdxElementId"], relation["relatedSpdxElement"]} <= known)

    def test_every_download_of_the_sources_has_a_checksum(self):
        fetches = re.findall(r"^fetch .*$", text_of("tools/sources.sh"), re.MULTILINE)
        self.assertGreaterEqual(len(fetches), 2)
        for line in fetches:
            self.assertRegex(line, r"\b[0-9a-f]{64}\b")

    def test_what_is_built_names_no_folder_of_this_machine(self):
        for path in BUILT:
            with open(path, "rb") as file:
                self.assertNotIn(os.fsencode(SOURCE), file.read(), path)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
