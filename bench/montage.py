#!/usr/bin/env python3
"""Puts pictures of `g3r view` side by side, one row per model: only the first view of each, in few colours so that the file is small.

    montage.py OUT.png --heads truth,field,poisson --tile 240 kitten=truth.png,field.png,poisson.png ...
    montage.py OUT.png --whole --columns 2 --tile 150 1=a.png 2=b.png ...    pictures of g3r view --views 1, layers side by side

Needs Pillow.
"""

import argparse

from PIL import Image, ImageDraw

HEAD = 16  # pixels above the tiles of a row


def first_view(path, tile):
    picture = Image.open(path).convert("RGB")
    side = picture.width // 2  # g3r view draws two by two
    return picture.crop((0, 0, side, side)).resize((tile, tile), Image.LANCZOS)


def whole(path, tile):
    picture = Image.open(path).convert("RGB")
    return picture.resize((round(picture.width * tile / picture.height), tile), Image.LANCZOS)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out")
    parser.add_argument("rows", nargs="+", metavar="NAME=A.png,B.png")
    parser.add_argument("--heads", default="", help="titles of the columns, comma separated")
    parser.add_argument("--tile", type=int, default=240)
    parser.add_argument("--colours", type=int, default=40, help="of the file")
    parser.add_argument("--whole", action="store_true", help="each picture as it is, so high")
    parser.add_argument("--columns", type=int, default=1, help="rows side by side")
    arguments = parser.parse_args()
    rows = [(name, files.split(",")) for name, files in (row.split("=", 1) for row in arguments.rows)]
    heads = arguments.heads.split(",")
    pictures = [[whole(file, arguments.tile) if arguments.whole else first_view(file, arguments.tile) for file in files] for _, files in rows]
    row_width = max(sum(picture.width for picture in row) for row in pictures)
    lines = -(-len(rows) // arguments.columns)
    page = Image.new("RGB", (row_width * arguments.columns, lines * (arguments.tile + HEAD)), "white")
    draw = ImageDraw.Draw(page)
    for r, ((name, _), row) in enumerate(zip(rows, pictures)):
        left, top = r // lines * row_width, r % lines * (arguments.tile + HEAD)
        for c, picture in enumerate(row):
            title = f"{name}: {heads[c]}" if c < len(heads) and heads[c] else name if c == 0 or not arguments.whole else ""
            draw.text((left + 4, top + 2), title, fill="black")
            page.paste(picture, (left, top + HEAD))
            left += picture.width
    page.quantize(arguments.colours, dither=Image.Dither.NONE).save(arguments.out, optimize=True)


if __name__ == "__main__":
    main()
