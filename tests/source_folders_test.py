"""Folders of src/ and modules of the Python package build on one another, never in a circle, and headers of an operating system stay in the
sources that are for it: read off includes and imports."""

import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
SOURCES = ROOT / "src"
# Headers that not every system has.
OF_A_SYSTEM = re.compile(r"^#include <((?:arpa|linux|mach|net|netinet|sys)/.*|csignal|signal\.h|dirent\.h|dlfcn\.h|fcntl\.h|ftw\.h|glob\.h|io\.h|langinfo\.h|"
                         r"malloc\.h|poll\.h|psapi\.h|pthread\.h|pwd\.h|sched\.h|share\.h|shellapi\.h|spawn\.h|termios\.h|unistd\.h|windows\.h)>", re.MULTILINE)
FOR_A_SYSTEM = re.compile(r"_(posix|windows)\.cpp$")
# Where the standard library's functions take integers alone: the browsers' one has them for no others (io/float_text.h is for those).
OF_INTEGERS = {"io/float_text.h", "io/text_numbers.h", "io/text_numbers.cpp", "io/xml_text.cpp", "io/float_text.cpp", "solve/harmonics.cpp", "sum/device_scope.cpp"}
ENTRY = "src"  # files of src/ itself: the public entry points, which may use every folder


def uses():
    """For every folder the folders that its files include, each with one of these files."""
    out = {}
    for path in sorted(SOURCES.rglob("*")):
        if path.suffix not in (".h", ".cpp"):
            continue
        inside = path.relative_to(SOURCES)
        folder = inside.parts[0] if len(inside.parts) > 1 else ENTRY
        targets = out.setdefault(folder, {})
        for target in re.findall(r'^#include "([^"]+)"', path.read_text(), re.MULTILINE):
            first = target.split("/")[0] if "/" in target else ENTRY
            if first != folder:
                targets.setdefault(first, f"{inside} includes {target}")
    return out


def imports():
    """For every module of the Python package the modules that it imports, inside of functions too."""
    out = {}
    for path in sorted((ROOT / "python" / "g3r").glob("*.py")):
        text = re.sub(r"^if TYPE_CHECKING:\n(?:    .*\n)+", "", path.read_text(), flags=re.MULTILINE)
        out[path.stem] = {target: f"{path.stem} imports {target}" for target in re.findall(r"^ *from \.(\w+) import", text, re.MULTILINE)}
    return out


def circle(graph):
    """The includes of one circle, empty without any."""
    done = set()

    def walk(folder, path):
        if folder in path:
            ring = [*path[path.index(folder) :], folder]
            return [graph[a][b] for a, b in zip(ring, ring[1:])]
        if folder in done:
            return []
        for target in graph.get(folder, {}):
            found = walk(target, [*path, folder])
            if found:
                return found
        done.add(folder)
        return []

    return next(filter(None, (walk(folder, []) for folder in graph)), [])


def strayed():
    """Headers of an operating system that sources of the library or the program include though they are for all systems."""
    found = []
    for folder in ("src", "cli", "include"):
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in (".h", ".cpp") and not FOR_A_SYSTEM.search(path.name):
                found += [f"{path.relative_to(ROOT)} includes {header}" for header in OF_A_SYSTEM.findall(path.read_text())]
    return found


class SourceFolders(unittest.TestCase):
    def test_headers_of_an_operating_system_stay_in_its_sources(self):
        self.assertEqual(OF_A_SYSTEM.findall("#include <sys/stat.h>\n#include <unistd.h>\n#include <system_error>\n"), ["sys/stat.h", "unistd.h"])
        self.assertEqual(strayed(), [])

    def test_numbers_as_text_go_through_one_source(self):
        found = {path.relative_to(SOURCES).as_posix() for path in SOURCES.rglob("*.*") if path.suffix in (".h", ".cpp")
                 and re.search(r"std::(from|to)_chars\(", path.read_text())}
        self.assertEqual(sorted(found - OF_INTEGERS), [])

    def test_no_comparison_is_left_to_standard_containers(self):  # of which the browsers' standard library has no operator<=>
        found = [path.name for path in SOURCES.rglob("*.h") if re.search(r"operator<=>\([^)]*\) const = default", path.read_text())]
        self.assertEqual(found, [])

    def test_bits_go_through_one_function(self):  # bits_as() of io/number_type.h: the browsers' standard library has no std::bit_cast
        found = [path.name for path in SOURCES.rglob("*.*") if path.suffix in (".h", ".cpp") and "std::bit_cast<" in path.read_text()]
        self.assertEqual(found, [])

    def test_a_circle_is_found(self):
        graph = {"a": {"b": "a/1 includes b/2"}, "b": {"c": "b/2 includes c/3"}, "c": {"b": "c/3 includes b/1"}}
        self.assertEqual(circle(graph), ["b/2 includes c/3", "c/3 includes b/1"])
        self.assertEqual(circle({"a": graph["a"], "b": {}}), [])

    def test_folders_do_not_include_in_a_circle(self):
        self.assertEqual(circle(uses()), [])

    def test_no_folder_includes_an_entry_point(self):
        self.assertEqual([targets[ENTRY] for targets in uses().values() if ENTRY in targets], [])

    def test_python_modules_do_not_import_in_a_circle(self):
        self.assertIn("_arrays", imports()["_api"])
        self.assertEqual(circle(imports()), [])

    def test_base_builds_on_nothing(self):
        self.assertEqual(uses()["base"], {})


if __name__ == "__main__":
    unittest.main()
