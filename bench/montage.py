#!/usr/bin/env python3
"""Puts pictures of `g3r view` side by side, one row per model: only the first view of each, in few colours so that the file is small.

    montage.py OUT.png --heads truth,field,poisson --tile 240 kitten=truth.png,field.png,poisson.png ...

Needs Pillow.
"""

import argparse

from PIL import Image, ImageDraw

COLOURS = 40
HEAD = 16  # pixels above the tiles of a row


def first_view(path, tile):
    picture = Image.open(path).convert("RGB")
    side = picture.width // 2  # g3r view draws two by two
    return picture.crop((0, 0, side, side)).resize((tile, tile), Image.LANCZOS)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out")
    parser.add_argument("rows", nargs="+", metavar="NAME=A.png,B.png")
    parser.add_argument("--heads", default="", help="titles of the columns, comma separated")
    parser.add_argument("--tile", type=int, default=240)
    arguments = parser.parse_args()
    rows = [(name, files.split(",")) for name, files in (row.split("=", 1) for row in arguments.rows)]
    heads = arguments.heads.split(",")
    width = max(len(files) for _, files in rows) * arguments.tile
    picture = Image.new("RGB", (width, len(rows) * (arguments.tile + HEAD)), "white")
    draw = ImageDraw.Draw(picture)
    for r, (name, files) in enumerate(rows):
        top = r * (arguments.tile + HEAD)
        for c, file in enumerate(files):
            title = f"{name}: {heads[c]}" if c < len(heads) and heads[c] else name
            draw.text((c * arguments.tile + 4, top + 2), title, fill="black")
            picture.paste(first_view(file, arguments.tile), (c * arguments.tile, top + HEAD))
    picture.quantize(COLOURS, dither=Image.Dither.NONE).save(arguments.out, optimize=True)


if __name__ == "__main__":
    main()
