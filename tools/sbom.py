#!/usr/bin/env python3
"""tools/sbom.py: what g3r is built from, as SPDX 2.3 in JSON, to standard output: the packages of packages.txt with the versions that are
installed here, and the sources that tools/sources.sh brings, with their checksums. Standard library only.

The same tree on the same machine gives the same bytes: the date is SOURCE_DATE_EPOCH, else that of the last commit, else 1970.
"""

import datetime
import hashlib
import json
import os
import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Name and licence of what tools/sources.sh brings, by its folder. libE57Format has CRC++ (BSD-3-Clause) inside.
SOURCES = {"laszip": ("LASzip", "Apache-2.0"), "e57": ("libE57Format", "BSL-1.0 AND MIT AND BSD-3-Clause"), "tbb": ("oneTBB", "Apache-2.0"),
           "highway": ("Highway", "Apache-2.0"), "png": ("libpng", "Libpng"),
           "zlib": ("zlib", "Zlib"), "eigen": ("Eigen", "MPL-2.0"), "json": ("nlohmann-json", "MIT")}


def output_of(*command):
    """What a command prints, or nothing where it fails or is not there."""
    try:
        return subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return ""


def created():
    seconds = os.environ.get("SOURCE_DATE_EPOCH") or output_of("git", "log", "-1", "--format=%ct") or "0"
    return datetime.datetime.fromtimestamp(int(seconds), datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")


def version():
    return re.search(r"project\(g3r VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text()).group(1)


def element(name, spdx_id, **more):
    return {"name": name, "SPDXID": spdx_id, "downloadLocation": "NOASSERTION", "filesAnalyzed": False, "licenseConcluded": "NOASSERTION",
            "licenseDeclared": "NOASSERTION", "copyrightText": "NOASSERTION", **more}


def debian_packages():
    """One element for every line of packages.txt."""
    for line in (ROOT / "packages.txt").read_text().splitlines():
        name = line.split("#")[0].strip()
        if not name:
            continue
        installed = output_of("dpkg-query", "-W", "-f=${Version}", name)
        more = {"versionInfo": installed} if installed else {}
        place = "pkg:deb/debian/" + name + ("@" + installed if installed else "")
        yield element(name, "SPDXRef-deb-" + re.sub(r"[^A-Za-z0-9.-]", "-", name), supplier="Organization: Debian", externalRefs=[
            {"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": place}], **more)


def pinned_sources():
    """One element for every archive that tools/sources.sh fetches, `fetch FOLDER from_HOME ARCHIVE SHA256 ...`, and whether every build
    has it inside; the others are only in builds with G3R_BUNDLED.
    """
    script = (ROOT / "tools/sources.sh").read_text()
    for indent, folder, archive, checksum in re.findall(r"^( *)fetch (\S+) from_\w+ (\S+) ([0-9a-f]{64})", script, re.MULTILINE):
        name, licence = SOURCES[folder]
        yield not indent, element(name, "SPDXRef-source-" + folder, versionInfo=re.search(r"[_-]v?(\d[0-9.]*[0-9])", archive).group(1),
                                  licenseDeclared=licence, licenseConcluded=licence, packageFileName=archive,
                                  checksums=[{"algorithm": "SHA256", "checksumValue": checksum}])


def document():
    main = element("g3r", "SPDXRef-g3r", versionInfo=version(), licenseConcluded="MIT", licenseDeclared="MIT",
                   supplier="Organization: the g3r authors")
    packages, sources = list(debian_packages()), list(pinned_sources())
    relations = [("SPDXRef-DOCUMENT", "DESCRIBES", "SPDXRef-g3r")]
    relations += [(package["SPDXID"], "BUILD_DEPENDENCY_OF", "SPDXRef-g3r") for package in packages]
    relations += [("SPDXRef-g3r", "CONTAINS", source["SPDXID"]) for always, source in sources if always]
    relations += [(source["SPDXID"], "OPTIONAL_DEPENDENCY_OF", "SPDXRef-g3r") for always, source in sources if not always]
    content = [main, *(source for _, source in sources), *packages]
    digest = hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:32]
    return {"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": "g3r-" + version(),
            "documentNamespace": "https://spdx.org/spdxdocs/g3r-%s-%s" % (version(), digest),
            "creationInfo": {"created": created(), "creators": ["Tool: g3r tools/sbom.py"]}, "packages": content,
            "relationships": [{"spdxElementId": a, "relationshipType": kind, "relatedSpdxElement": b} for a, kind, b in relations]}


if __name__ == "__main__":
    print(json.dumps(document(), indent=1))
