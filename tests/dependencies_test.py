"""The libraries that CMake asks for are those that every packager's file, the list of Debian's packages, the fetched sources and the
licences name: none is missing, and none is left that went."""

import json
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Names of each library, by the folder of its sources (cmake/Libraries.cmake): conda's, Debian's, Homebrew's, vcpkg's.
NAMES = {"tbb": ("tbb-devel", "libtbb-dev", "tbb", "tbb"),
         "eigen": ("eigen", "libeigen3-dev", "eigen", "eigen3"),
         "json": ("nlohmann_json", "nlohmann-json3-dev", "nlohmann-json", "nlohmann-json"),
         "highway": ("libhwy", "libhwy-dev", "highway", "highway"),
         "zlib": ("zlib", "zlib1g-dev", "zlib", "zlib"),
         "png": ("libpng", "libpng-dev", "libpng", "libpng")}
PROGRAM = ("cli11", "libcli11-dev", "cli11", "cli11")  # of cli/CMakeLists.txt
FORMATS = {"laszip", "e57"}  # always inside
# What builds, and what only the tests, the benchmarks and the checks need.
TOOLS = {"cmake", "ninja", "ninja-build", "pkg-config", "pkgconf", "debhelper-compat", "vcpkg-cmake", "vcpkg-cmake-config", "nanobind",
         "pip", "python", "scikit-build-core"}
OF_TESTS = {"ca-certificates", "clang", "clang-format", "clang-tidy", "dpkg-dev", "g++", "libbenchmark-dev", "libclang-rt-14-dev",
            "libgtest-dev", "lld", "locales", "ocl-icd-libopencl1", "pocl-opencl-icd", "python3", "python3-dev", "python3-venv"}


def text_of(name):
    return (ROOT / name).read_text(encoding="utf-8")


def matches(pattern, name):
    return re.findall(pattern, text_of(name), re.MULTILINE)


def libraries(packager):
    return {names[packager] for names in NAMES.values()} | {PROGRAM[packager]}


class Dependencies(unittest.TestCase):
    def test_cmake_asks_for_these_and_no_others(self):
        self.assertEqual(set(matches(r"^ *g3r_library\(\w+ \S+ (\w+)", "cmake/Libraries.cmake")), set(NAMES))
        self.assertEqual(set(matches(r"^function\(g3r_build_(\w+)", "cmake/Libraries.cmake")), set(NAMES))
        self.assertIn("CLI11", matches(r"^find_package\((\w+)", "cli/CMakeLists.txt"))

    def test_sources_and_licences_are_of_these(self):
        self.assertEqual(set(matches(r"^ *fetch (\w+) from_", "tools/sources.sh")), set(NAMES) | FORMATS)
        licences = matches(r"^ *set\(texts (.*)\)", "cmake/FormatSources.cmake")[0].split()
        self.assertEqual({text.split("/")[0] for text in licences}, set(NAMES))
        self.assertEqual(set(matches(r"build/sources/(\w+)/\*", "packaging/debian/copyright")), set(NAMES) | FORMATS)
        self.assertEqual(set(re.findall(r'"(\w+)": \("', text_of("tools/sbom.py"))), set(NAMES) | FORMATS)

    def test_licences_are_those_of_debian(self):
        spdx = {"Expat": "MIT", "BSD-3-clause": "BSD-3-Clause", "libpng-2.0": "Libpng"}
        found = {}
        for files, licence in matches(r"^Files: (.*(?:\n .*)*)\nCopyright: .*\nLicense: (\S+)$", "packaging/debian/copyright"):
            for folder in re.findall(r"build/sources/(\w+)/", files):
                found.setdefault(folder, set()).add(spdx.get(licence, licence))
        named = dict(re.findall(r'"(\w+)": \("[^"]+", "([^"]+)"\)', text_of("tools/sbom.py")))
        self.assertEqual({folder: set(licences.split(" AND ")) for folder, licences in named.items()}, found)

    def test_packagers_name_these(self):
        conda = text_of("packaging/conda/meta.yaml").split("\n  host:\n")[1].split("\n  run:\n")[0]
        self.assertEqual(set(re.findall(r"^ +- (\S+)", conda, re.MULTILINE)) - TOOLS, libraries(0))
        debian = re.search(r"^Build-Depends: (.*(?:\n .*)*)", text_of("packaging/debian/control"), re.MULTILINE).group(1)
        self.assertEqual({one.split()[0] for one in debian.split(",")} - TOOLS, libraries(1))
        # What g3r-config.cmake and g3r.pc name for the archive; the others are headers that nobody includes from g3r's.
        development = text_of("packaging/debian/control").split("\nPackage: libg3r-dev\n")[1]
        development = re.search(r"^Depends: (.*(?:\n .*)*)", development, re.MULTILINE).group(1)
        linked = {NAMES[name][1] for name in NAMES if name not in ("eigen", "json")}
        self.assertEqual({one.split()[0] for one in development.split(",")} - {"libg3r0.2", "${misc:Depends}"}, linked)
        self.assertEqual(set(text_of("packages.txt").split()) - TOOLS - OF_TESTS, libraries(1))
        self.assertEqual(set(matches(r'^ +(?:depends_on|uses_from_macos) "([^"]+)"', "packaging/homebrew/g3r.rb")) - TOOLS, libraries(2))
        vcpkg = json.loads(text_of("packaging/vcpkg/g3r/vcpkg.json"))
        named = vcpkg["dependencies"] + vcpkg["features"]["tools"]["dependencies"]
        self.assertEqual({one if isinstance(one, str) else one["name"] for one in named} - TOOLS, libraries(3))


if __name__ == "__main__":
    unittest.main()
