"""pack.py G3R_WEB.js G3R.html NAME=LICENCE...: page.html with the style, the scripts, the library and the texts of the licences in it, so that
it is one file that needs no other.
"""

import base64
import gzip
import html
import pathlib
import sys


def in_script(text):
    """Text that may stand in a <script> element; only strings and regular expressions of scripts hold what is changed."""
    return text.replace("</script", "<\\/script").replace("<!--", "<\\!--")


def main():
    glue, output = map(pathlib.Path, sys.argv[1:3])
    licences = [licence.partition("=") for licence in sys.argv[3:]]
    here = pathlib.Path(__file__).parent
    library = gzip.compress(glue.with_suffix(".wasm").read_bytes(), 9, mtime=0)
    parts = {
        "style": (here / "page.css").read_text(),
        "worker": in_script(glue.read_text() + "\n" + (here / "worker.js").read_text()),
        "library": base64.b64encode(library).decode(),
        "licences": html.escape("\n\n".join("%s\n\n%s" % (name, pathlib.Path(file).read_text()) for name, _, file in licences)),
        "page": in_script((here / "page.js").read_text()),
    }
    page = (here / "page.html").read_text()
    for name, text in parts.items():
        before, after = page.split("{{" + name + "}}")
        page = before + text + after
    output.write_text(page)
    print("%s: %.1f MB" % (output, len(page) / 1e6))


main()
