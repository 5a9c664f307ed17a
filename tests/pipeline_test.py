"""The program is one page, and the drawing of it in docs/design.md has its steps, in their order."""

import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
MOST_LINES = 130  # of one page


def steps_of_drawing(page):
    """The names in the first column of the drawing, which are indented by three spaces."""
    drawing = re.search(r"```\n(.*?)```", page, re.DOTALL).group(1)
    return re.findall(r"^ {3}(\w+)", drawing, re.MULTILINE)


def steps_of_source(source):
    """What orient_in_arena() calls in lines of its own, but for the check of its arguments, its clock, and where members are called."""
    body = re.search(r"^Orientation orient_in_arena\(.*?^}", source, re.DOTALL | re.MULTILINE).group(0).split("{\n", 1)[1]
    calls = [re.match(r" +(?:if \(\w+\) )?(?:(?:\w+ )?\w+ = )?(\w+)\(", line) for line in body.splitlines()]
    return [call.group(1) for call in calls if call and call.group(1) != "require_sound"]


class Pipeline(unittest.TestCase):
    def test_steps_are_read_off_drawings_and_sources(self):
        page = "# Design\n\n```\n points\n   first   what it does   src/cloud\n             more of it\n   second\n -> mesh\n```\n"
        source = "Orientation orient_in_arena(int a,\n                            int b) {\n  require_sound(a);\n  Problem p = first(a);\n" \
                 "  if (is_whole) second(p);\n  clock.finish(p);\n  p.member = value;\n  return p;\n}\n"
        self.assertEqual(steps_of_drawing(page), ["first", "second"])
        self.assertEqual(steps_of_source(source), ["first", "second"])

    def test_the_drawing_has_the_steps_of_the_program(self):
        drawing = steps_of_drawing((ROOT / "docs" / "design.md").read_text(encoding="utf-8"))
        self.assertEqual(drawing, steps_of_source((ROOT / "src" / "pipeline.cpp").read_text(encoding="utf-8")))
        self.assertGreater(len(drawing), 5)

    def test_the_program_is_one_page(self):
        self.assertLessEqual(len((ROOT / "src" / "pipeline.cpp").read_text(encoding="utf-8").splitlines()), MOST_LINES)


if __name__ == "__main__":
    unittest.main()
