#!/usr/bin/env python3
"""Checks the documentation: links and their anchors, paths, columns, and words that the glossary does not have; that sources have
none of these words either, in comments, messages and names, and that the pages which they name are there. Standard library only.

    check_docs.py              prints FILE:LINE: what is wrong; exit code 1 if anything is
    check_docs.py --help-of G3R          that docs/cli.md has what the program G3R says with --help
    check_docs.py --write-help-of G3R    puts it there
"""

import functools
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
COLUMNS = 140  # as in .clang-format
# References whose tables have one long line per entry; a line of a table cannot be broken.
WIDE_TABLES = {"docs/formats.md", "docs/parameters.md", "bench/README.md", "packaging/README.md", "docs/python.md"}
# What each stands for is in docs/glossary.md.
PRIVATE_WORDS = {
    r"told (from|apart)": "distinguished",
    r"tells? (\w+ )?apart": "distinguish",
    r"in doubt": "unsure, ambiguous",
    r"settle[sd]?": "decide",
    r"believed": "trusted",
    r"of no account": "ignored",
    r"looked over": "skipped",
    r"asked of": "evaluated for",
    r"hand(s|ed)? out": "return",
    r"luck of the sample": "sampling variance",
    r"sheets?": "patch, open surface",
    r"specks?": "spurious component",
    r"opinions?": "value",
    r"at odds": "minority sign",
}
# Those that sources do not have either, within names too, and what they stand for there. Keys of the report and of the API stay.
PRIVATE_NAMES = {
    r"(?<!spread)sheet": "patch, layer, open surface",
    r"settle(?!d_share)": "decide",
    r"opinion": "value of an ambiguous corner",
    r"speck(?!le)": "spurious component",
    r"told[ _]?(from|apart)|tells? (\w+ ){1,5}(apart|from)\b": "distinguished",
    r"in[ _]?doubt\b": "unsure, ambiguous",
    r"believed": "trusted",
    r"of no account": "ignored",
    r"looked over": "skipped",
    r"hand(s|ed)? out": "return",
    r"luck of the": "sampling variance",
    r"at_?odds": "minority sign",
    r"(other|another) readings?": "candidate labelling",
    r"field_readings?": "candidate labelling",
}
LEFT_OUT = [ROOT / "docs" / "images", ROOT / "docs" / "results"]  # of source archives (pyproject.toml)
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
PATH = re.compile(r"`((?:addons|src|include|cli|python|tests|bench|fuzz|tools|docs)/[\w./-]+)`")
NAMED = re.compile(r"\bdocs/[\w/]+\.md\b")
SOURCES = {".h", ".cpp", ".c", ".cl", ".py", ".pyi", ".sh", ".txt", ".cmake", ".cff", ".toml", ".yml"}
PRIVATE = re.compile(r"\b(" + "|".join(PRIVATE_WORDS) + r")\b", re.I)
PRIVATE_NAME = re.compile("|".join(PRIVATE_NAMES), re.I)


def pages():
    """Files of the documentation."""
    named = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "bench/README.md", "packaging/README.md"]
    return [ROOT / name for name in named] + sorted((ROOT / "docs").rglob("*.md"))


def prose(text):
    """(number, line, is code) of every line; the text of `code` within a line is left."""
    fenced = False
    for number, line in enumerate(text.splitlines(), 1):
        fence = line.lstrip().startswith("```")
        yield number, line, fenced or fence
        fenced ^= fence


@functools.cache
def anchors(path):
    """What the headings of a page are called, as GitHub and mkdocs name them."""
    found = set()
    for _, line, code in prose(path.read_text(encoding="utf-8")):
        if not code and line.startswith("#"):
            title = re.sub(r"[`*]|\[([^\]]*)\]\([^)]*\)", r"\1", line.lstrip("#").strip())
            found.add(re.sub(r"\s", "-", re.sub(r"[^\w\s-]", "", title.lower())))
    return found


def is_left_out(goal):
    """Whether a path is, or is in, a folder that this tree lacks, as source archives do."""
    return any(folder in (goal, *goal.parents) and not folder.exists() for folder in LEFT_OUT)


def broken_links(path, line):
    for target in LINK.findall(re.sub(r"`[^`]*`", "", line)):
        if re.match(r"\w+:", target):
            continue
        file, _, anchor = target.partition("#")
        goal = (path.parent / file).resolve() if file else path
        if is_left_out(goal):
            continue
        if not goal.exists():
            yield f"link to {target}, which does not exist"
        elif anchor and goal.suffix == ".md" and anchor not in anchors(goal):
            yield f"link to {target}, but no heading is called so"


def missing_paths(line):
    """Files and folders that a page names in `code` and that do not exist; NAME stands for any."""
    return [path for path in PATH.findall(line) if "NAME" not in path and not (ROOT / path).exists() and not is_left_out(ROOT / path)]


def complaints(path):
    name = path.relative_to(ROOT).as_posix()
    for number, line, code in prose(path.read_text(encoding="utf-8")):
        wide = name in WIDE_TABLES and line.lstrip().startswith("|")
        if len(line) > COLUMNS and not wide:
            yield number, f"{len(line)} columns, more than {COLUMNS}"
        if code:
            continue
        for text in broken_links(path, line):
            yield number, text
        for missing in missing_paths(line):
            yield number, f"{missing} does not exist"
        for word in PRIVATE.finditer(re.sub(r"`[^`]*`|\]\([^)]*\)", "", line)):
            plain = next(plain for private, plain in PRIVATE_WORDS.items() if re.fullmatch(private, word.group(0), re.I))
            yield number, f"\"{word.group(0)}\": the glossary has \"{plain}\""


def sources():
    """(file, line, its text) of every source, but for this one, which has the words."""
    for folder in ("addons", "bench", "cli", "cmake", "examples", "fuzz", "include", "packaging", "python", "src", "tests", "tools", "web"):
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in SOURCES and path.is_file() and path != pathlib.Path(__file__).resolve():
                for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                    yield path, number, line


def source_complaints(line):
    """Pages that a line of a source names and that do not exist, and private words."""
    for page in NAMED.findall(line):
        if not (ROOT / page).exists() and not is_left_out(ROOT / page):
            yield f"{page} does not exist"
    for word in PRIVATE_NAME.finditer(line):
        plain = next(plain for private, plain in PRIVATE_NAMES.items() if re.match(private, line[word.start():], re.I))
        yield f"\"{word.group(0)}\": the glossary has \"{plain}\""


# --- the command line


def help_of(program, *command):
    return subprocess.run([program, *command, "--help"], capture_output=True, text=True, check=True).stdout.rstrip()


def help_sections(program, *command):
    """The help of a command, and of the commands that it lists."""
    text = help_of(program, *command)
    yield f"## {' '.join(('g3r', *command))}\n\n```text\n{text}\n```\n"
    for name in re.findall(r"^  ([a-z]+) ", text.partition("\nCommands:")[2], re.M):
        yield from help_sections(program, *command, name)


def check_help(program, write):
    """Compares the part of docs/cli.md between its marks with the program, or writes it."""
    page = ROOT / "docs" / "cli.md"
    text = page.read_text(encoding="utf-8")
    begin, _, rest = text.partition("<!-- help -->\n")
    _, _, end = rest.partition("<!-- /help -->")
    right = begin + "<!-- help -->\n\n" + "\n".join(help_sections(program)) + "\n<!-- /help -->" + end
    if write:
        page.write_text(right, encoding="utf-8")
    elif text != right:
        sys.exit(f"docs/cli.md: not what the program says with --help; tools/check_docs.py --write-help-of {program} puts it there")


def main():
    if len(sys.argv) == 3 and sys.argv[1] in ("--help-of", "--write-help-of"):
        return check_help(sys.argv[2], sys.argv[1] == "--write-help-of")
    found = [f"{path.relative_to(ROOT)}:{number}: {text}" for path in pages() for number, text in complaints(path)]
    found += [f"{path.relative_to(ROOT)}:{number}: {text}" for path, number, line in sources() for text in source_complaints(line)]
    print("\n".join(found) if found else f"{len(pages())} pages: links, columns and words are right")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
