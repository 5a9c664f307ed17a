"""Every source of the library is compiled, and compiled together with others (src/together.cmake) or known to be better by itself: read off
the lists."""

import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
SOURCES = ROOT / "src"
# Compiled by themselves: for each instruction set, with definitions or headers of their own, with those of another library
# (src/io/CMakeLists.txt), for one system, of two that stand for each other, and with much of Eigen (src/together.cmake).
ALONE = re.compile(r"^(build_info|cloud/heights|cpu/.*|io/(e57|laz|pack_laz)\w*|io/float_text_c|mesh/screened_poisson\w*|.*_(posix|windows|none))$")


def names(pattern, path):
    return re.findall(pattern, re.sub(r"#.*", "", path.read_text(encoding="utf-8")))


def compiled():
    """The sources that the lists of src/CMakeLists.txt and its folders have, without .cpp."""
    found = set()
    for path in (SOURCES / "CMakeLists.txt", *sorted(SOURCES.glob("*/CMakeLists.txt"))):
        folder = path.parent.relative_to(SOURCES)
        for prefix, choice, name in names(r"(?<![\\\w])(\w*)(\$<IF:[^ ]*,(?:\w+),(?:\w+)>)?(\w*)\.cpp\b", path):
            endings = re.findall(r",(\w+)", choice) if choice else [""]
            found |= {(folder / (prefix + ending + name)).as_posix() for ending in endings}
    return found


def grouped():
    """How often each source is in a group."""
    out = {}
    for group in names(r"g3r_together\(\w+ ([^)$]*)\)", SOURCES / "together.cmake"):
        for name in group.split():
            out[name] = out.get(name, 0) + 1
    return out


class SourceLists(unittest.TestCase):
    def setUp(self):
        self.sources = {path.relative_to(SOURCES).with_suffix("").as_posix() for path in SOURCES.rglob("*.cpp")}

    def test_every_source_is_compiled(self):
        embedded = {"gpu/kernel_files", "view/page_files"}  # made of texts (cmake/EmbedText.cmake)
        self.assertEqual(compiled() - embedded, self.sources)

    def test_every_source_is_in_one_group_or_known_to_be_alone(self):
        groups = grouped()
        self.assertEqual(sorted(set(groups) - self.sources), [])
        self.assertEqual([name for name, count in groups.items() if count != 1 or ALONE.match(name)], [])
        self.assertEqual(sorted(name for name in self.sources - set(groups) if not ALONE.match(name)), [])


if __name__ == "__main__":
    unittest.main()
