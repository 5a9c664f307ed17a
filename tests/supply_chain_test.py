"""Truths about what g3r is made from: the list of its parts is complete, valid and the same each time, and what is built names no folder
of the machine that built it.

Run by ctest with G3R_SOURCE, the folder of the sources, and G3R_BUILT, programs and libraries of a build without debug information (may
be empty).
"""

import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
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
        fetches = re.findall(r"^ *fetch \w+ from_.*$", text_of("tools/sources.sh"), re.MULTILINE)
        self.assertEqual(len(fetches), len(re.findall(r"\bfetch \w+ from_", text_of("tools/sources.sh"))))
        self.assertEqual(len(fetches), 8)
        for line in fetches:
            self.assertRegex(line, r"\b[0-9a-f]{64}\b")
        helpers = [line for line in text_of("tools/sources_helpers.txt").splitlines() if not line.startswith("#")]
        self.assertGreaterEqual(len(helpers), 4)
        for line in helpers:
            self.assertRegex(line, r"^[\w-]+==[\w.]+(; .*)? --hash=sha256:[0-9a-f]{64}$")

    def test_what_is_built_names_no_folder_of_this_machine(self):
        for path in BUILT:
            with open(path, "rb") as file:
                self.assertNotIn(os.fsencode(SOURCE), file.read(), path)


# Stands for python3 and its pip, and makes environments with itself as their python. It takes archives from $ARCHIVES and keeps what it was
# called with. With $NO_PIP only environments that were asked for a pip have one.
PYTHON = """#!/bin/bash
case "$1 $2" in
  "-m venv") mkdir -p "${@: -1}/bin" && cp "$0" "${@: -1}/bin/python" && exit ;;
  "-m ensurepip") cp "$0" "$(dirname "$0")/pip3" && exit ;;
  "-m pip") [ -z "$NO_PIP" ] || [ -e "$(dirname "$0")/pip3" ] || exit 1 ;;
esac
echo "$@" >> "$ARCHIVES/calls"
[[ " $* " == *" download "* ]] || exit 0
while [ $# -gt 1 ]; do
  case $1 in
    --dest) folder=$2 ;;
    -r) cat "$2" >> "$ARCHIVES/calls" && wanted=$(sed 's/==\\(\\S*\\).*/-\\1.tar.gz/' "$2") ;;
  esac
  shift
done
cp "$ARCHIVES/$wanted" "$folder" || { echo "ERROR: no such package" && echo && exit 1; }
"""


@unittest.skipUnless(shutil.which("sha256sum"), "tools/sources.sh needs coreutils")
class Sources(unittest.TestCase):
    """tools/sources.sh with archives and a pip of this test."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        for name in ("tools", "bin", "archives"):
            (self.folder / name).mkdir()
        (self.folder / "bin" / "python3").write_text(PYTHON)
        (self.folder / "bin" / "python3").chmod(0o755)
        shutil.copy(os.path.join(SOURCE, "tools", "sources_helpers.txt"), self.folder / "tools")
        script = text_of("tools/sources.sh")
        self.sums = {}
        for name, path in (("laszip-0.3.0", "src/vendor/LASzip-1/%s"), ("pye57-0.4.19", "libE57Format/%s")):
            archive = self.folder / "archives" / (name + ".tar.gz")
            with tarfile.open(archive, "w:gz") as tar:
                for file in ("src/a.cpp", "include/a.h", "COPYING.txt", "test/no.cpp"):
                    tar.addfile(tarfile.TarInfo(name + "/" + path % file))
            self.sums[name] = hashlib.sha256(archive.read_bytes()).hexdigest()
            script = re.sub(re.escape(archive.name) + " [0-9a-f]{64}", archive.name + " " + self.sums[name], script)
        (self.folder / "tools" / "sources.sh").write_text(script)

    def run_script(self, cache, no_pip=""):
        return subprocess.run(["bash", "tools/sources.sh"], cwd=self.folder, capture_output=True, text=True,
                              env={**os.environ, "G3R_CACHE": str(cache), "ARCHIVES": str(self.folder / "archives"), "NO_PIP": no_pip,
                                   "PATH": str(self.folder / "bin") + os.pathsep + os.environ["PATH"]})

    def kept(self):
        return sorted(path.name for path in (self.folder / "build" / "sources").rglob("*") if path.is_file())

    def test_what_runs_has_a_checksum_first(self):
        done = self.run_script(self.folder / "cache")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(self.kept(), ["COPYING.txt", "COPYING.txt", "a.cpp", "a.cpp", "a.h", "a.h", "checksum", "checksum"])
        calls = (self.folder / "archives" / "calls").read_text().splitlines()
        for call in calls:
            if " install " in call or " download " in call:
                self.assertIn(" --require-hashes ", call)
        for name, checksum in self.sums.items():
            self.assertIn(name.replace("-", "==") + " --hash=sha256:" + checksum, calls)
        self.assertEqual(len(list((self.folder / "cache").iterdir())), 2)

    def test_a_cache_that_cannot_be_written_costs_nothing(self):
        (self.folder / "file").write_text("")
        done = self.run_script(self.folder / "file" / "cache")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("a.cpp", self.kept())

    def test_a_python_without_pip_gets_one(self):
        done = self.run_script(self.folder / "cache", no_pip="1")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("a.cpp", self.kept())

    def test_failures_say_what_failed(self):
        laszip, pye57 = (self.folder / "archives" / (name + ".tar.gz") for name in self.sums)
        laszip.unlink()
        pye57.write_bytes(pye57.read_bytes() + b"more")
        done = self.run_script(self.folder / "cache")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"LAZ: .*laszip-0.3.0.tar.gz .* cannot be fetched: ERROR: no such package")
        self.assertRegex(done.stderr, r"E57: .*pye57-0.4.19.tar.gz has another checksum")
        self.assertFalse((self.folder / "cache").exists())

    def test_an_archive_of_other_files_cannot_be_unpacked(self):
        for name in self.sums:
            archive = self.folder / "archives" / (name + ".tar.gz")
            script = self.folder / "tools" / "sources.sh"
            archive.write_bytes(b"no archive")
            script.write_text(script.read_text().replace(self.sums[name], hashlib.sha256(b"no archive").hexdigest()))
        done = self.run_script(self.folder / "cache")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"LAZ: .* cannot be unpacked")
        self.assertFalse((self.folder / "build" / "sources" / "laszip").exists())


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
