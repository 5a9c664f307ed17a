"""Hooks of mkdocs: what the program, the sources and other files say already is taken from them, so that nothing is said twice.

In a page, <!-- python --> becomes the docstrings and <!-- headers --> the public headers.
"""

import ast
import pathlib
import posixpath
import re
import textwrap

from mkdocs.structure.files import File

ROOT = pathlib.Path(__file__).resolve().parent.parent
COPIES = {"README.md": "index.md", "CHANGELOG.md": "changelog.md", "CONTRIBUTING.md": "contributing.md", "SECURITY.md": "security.md",
          "bench/README.md": "protocol.md"}
LINK = re.compile(r"(!?)\[([^\]]*)\]\((?!https?:|#)([^)#\s]+)(#[^)]*)?\)")
MARK = re.compile(r"<!-- (python|headers) -->")


def on_files(files, config):
    for source, page in COPIES.items():
        files.append(File.generated(config, page, content=(ROOT / source).read_text()))
    return files


def on_page_markdown(markdown, page, **_):
    copied = {page: source for source, page in COPIES.items()}
    source = copied.get(page.file.src_uri, "docs/" + page.file.src_uri)
    makers = {"python": python_api, "headers": header_texts}
    return relink(MARK.sub(lambda mark: makers[mark.group(1)](), markdown), source, page.file.src_uri)


def relink(markdown, source, page):
    """Links between files of the repository become links between pages; where there is no page, the text remains."""

    def target(match):
        image, text, path, anchor = match.groups()
        goal = posixpath.normpath(posixpath.join(posixpath.dirname(source), path))
        if goal in COPIES:
            goal = COPIES[goal]
        elif goal.startswith("include/g3r"):
            goal = "cpp.md"
        elif goal.startswith("docs/"):
            goal = goal[len("docs/"):]
        else:
            return text if text.startswith("`") else f"`{text}`"
        return f"{image}[{text}]({posixpath.relpath(goal, posixpath.dirname(page) or '.')}{anchor or ''})"

    return LINK.sub(target, markdown)


# --- Python


def python_api():
    """What g3r.__all__ names, in its order of use."""
    folder = ROOT / "python" / "g3r"
    found = {node.name: node for path in sorted(folder.glob("_*.py")) for node in ast.parse(path.read_text()).body
             if isinstance(node, (ast.FunctionDef, ast.ClassDef)) and ast.get_docstring(node)}
    names = next(ast.literal_eval(node.value) for node in ast.parse((folder / "__init__.py").read_text()).body
                 if isinstance(node, ast.Assign) and node.targets[0].id == "__all__")
    first = ["orient", "reconstruct", "run", "Result", "Field", "mesh_oriented", "read", "read_mesh", "write", "Cloud", "show", "View",
             "Error"]
    rest = sorted(set(names) - set(first) - {"__version__", "tiles"})
    text = "".join(class_text(found[name]) if isinstance(found[name], ast.ClassDef) else function_text(found[name], "##", "g3r")
                   for name in first + rest)
    tiles = ast.parse((folder / "tiles.py").read_text())
    text += f"\n## `g3r.tiles`\n\n{docstring_text(tiles)}\n"
    return text + "".join(function_text(node, "###", "g3r.tiles") for node in tiles.body
                          if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"))


def docstring_text(node):
    """As Markdown: `name: what it is` starts a line of its own."""
    named = re.compile(r"^([a-z_][a-z_, ]*): ")
    return "\n".join(named.sub(r"\n`\1`: ", line) for line in (ast.get_docstring(node) or "").splitlines())


def function_text(node, level, owner):
    returns = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    line = f"{node.name}({ast.unparse(node.args)}){returns}"
    code = "\n".join(textwrap.wrap(line, 95, subsequent_indent="    ", break_long_words=False, break_on_hyphens=False))
    return f"\n{level} `{owner}.{node.name}`\n\n```python\n{code}\n```\n\n{docstring_text(node)}\n"


def class_text(node):
    text = f"\n## `g3r.{node.name}`\n\n{docstring_text(node)}\n"
    for member in node.body:
        if not isinstance(member, ast.FunctionDef) or not ast.get_docstring(member):
            continue
        if any(isinstance(decorator, ast.Name) and decorator.id == "property" for decorator in member.decorator_list):
            text += f"\n`.{member.name}`: {ast.get_docstring(member)}\n"
        else:
            text += function_text(member, "###", node.name)
    return text


# --- C++ and C


def header_texts():
    names = ["g3r", "hints", "names", "points", "mesh", "io", "tiles", "metrics", "view", "error", "eigen"]
    text = "".join(header_text(f"g3r/{name}.h") for name in names)
    return text + f"\n## g3r/g3r_c.h\n\n```c\n{(ROOT / 'include/g3r/g3r_c.h').read_text().rstrip()}\n```\n"


def header_text(name):
    """The comment on top, then every declaration under its name: its comment as text, the rest as code."""
    comment, code = (ROOT / "include" / name).read_text().split("#pragma once\n")
    text = f"\n## {name}\n\n" + comment_text(comment.splitlines())
    inner = code[code.index("namespace"):code.rindex("}  // namespace g3r")]
    for block in blocks(inner.split("\n", 1)[1]):
        about = [line for line in block if line.startswith("///")]
        rest = [line for line in block if not line.startswith("///")]
        title = declared(rest)
        if rest and not all(line.startswith("// ") for line in rest):
            text += (f"\n### {title}\n\n" if title else "\n") + comment_text(about) + "\n```cpp\n" + "\n".join(rest) + "\n```\n"
    return text


def blocks(code):
    """Parts of the code between blank lines, where no brace is open."""
    block, depth = [], 0
    for line in code.splitlines():
        depth += line.count("{") - line.count("}")
        if line.strip() or depth:
            block.append(line)
        elif block:
            yield block
            block = []
    if block:
        yield block


def declared(lines):
    """The names that a block declares, without members."""
    names = []
    for line in lines:
        found = (re.match(r"(?:enum class|class|struct|using) (\w+)", line) or
                 re.match(r"(?:\[\[nodiscard\]\] )?[\w:<>, ]*?[\w>] (\w+)\(", line))
        if found and found.group(1) not in names:
            names.append(found.group(1))
    return ", ".join(names)


def comment_text(lines):
    """Comment lines as Markdown; what is set in by three blanks is code, and < stays what it is."""
    lines = [re.sub(r"^//+ ?", "", line) for line in lines]
    return "\n".join("    " + line.strip() if line.startswith("  ") else line.replace("<", "&lt;") for line in lines) + "\n"
