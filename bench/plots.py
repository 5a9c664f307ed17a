#!/usr/bin/env python3
"""Draws the results of g3r_bench_table and g3r_bench_spectra as SVG, and joins tables. Python's standard library only.

    plots.py cdf      TABLE.json -o FILE.svg --input clean --points 50000   share of the models below an AE_p, one line per method
    plots.py points   TABLE.json... -o FILE.svg --input clean               mean AE_p against the number of points
    plots.py noise    TABLE.json... -o FILE.svg --points 50000              mean AE_p against the noise (clean: left end)
    plots.py vary     TABLE.json... -o FILE.svg --key epsilon               mean AE_p against an option above 0: "default;epsilon=0.01n"
    plots.py spectra  SPECTRA.json -o FILE.svg                              eigenvalues from the largest down
    plots.py table    TABLE.json... -o FILE.md --input clean --points 50000 methods of several runs side by side, per model, as markdown

Means are over the models that every method of the plot has; --score pco draws 100 % - PCO instead of AE_p.
"""

import argparse
import json
import math
import sys
from xml.sax.saxutils import escape

WIDTH, HEIGHT = 720, 420
LEFT, RIGHT, TOP, BOTTOM = 70, 230, 34, 48
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8c564b", "#7f7f7f"]  # safe for the colour blind
MOST_DOTS = 150  # of a spectrum
SMALLEST = 1e-6  # what zero is drawn as on a logarithmic axis


class Axis:
    """Maps values to pixels, linearly or by logarithm, and knows where its marks are."""

    def __init__(self, values, start, end, log):
        self.log = log
        low, high = min(values), max(values)
        if low == high:
            low, high = (low / 2, high * 2) if log else (low - 1, high + 1)
        self.low, self.high = self.to_axis(low), self.to_axis(high)
        margin = 0.03 * (self.high - self.low)
        self.low, self.high = self.low - margin, self.high + margin
        self.start, self.end = start, end

    def to_axis(self, value):
        return math.log10(value) if self.log else value

    def pixel(self, value):
        return self.start + (self.to_axis(value) - self.low) / (self.high - self.low) * (self.end - self.start)

    def marks(self):
        if not self.log:
            step = 10 ** math.floor(math.log10((self.high - self.low) / 2))
            if (self.high - self.low) / step > 8:
                step *= 2
            first = math.ceil(self.low / step)
            return [k * step for k in range(first, int(self.high // step) + 1)]
        span = self.high - self.low
        every = max(1, math.ceil(span / 8))
        factors = [1, 2, 5] if span < 3 else [1]
        decades = [d for d in range(math.floor(self.low), math.ceil(self.high) + 1) if d % every == 0]
        marks = [f * 10.0**d for d in decades for f in factors]
        return [m for m in marks if self.low <= math.log10(m) <= self.high]


def number(value):
    return f"{value:.6g}" if 1e-3 <= abs(value) < 1e6 or value == 0 else f"{value:.0e}"


def chart(series, title, x_label, y_label, log_x=True, log_y=True, steps=False, dots=True):
    """SVG of {name: [(x, y), ...]}."""
    x_axis = Axis([x for line in series.values() for x, _ in line], LEFT, WIDTH - RIGHT, log_x)
    y_axis = Axis([y for line in series.values() for _, y in line], HEIGHT - BOTTOM, TOP, log_y)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="12">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
           f'<text x="{LEFT}" y="20" font-size="14">{escape(title)}</text>']
    for mark in x_axis.marks():
        x = x_axis.pixel(mark)
        out.append(f'<path d="M{x:.1f} {TOP}V{HEIGHT - BOTTOM}" stroke="#ddd"/>')
        out.append(f'<text x="{x:.1f}" y="{HEIGHT - BOTTOM + 16}" text-anchor="middle">{number(mark)}</text>')
    for mark in y_axis.marks():
        y = y_axis.pixel(mark)
        out.append(f'<path d="M{LEFT} {y:.1f}H{WIDTH - RIGHT}" stroke="#ddd"/>')
        out.append(f'<text x="{LEFT - 6}" y="{y + 4:.1f}" text-anchor="end">{number(mark)}</text>')
    out.append(f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 10}" text-anchor="middle">{escape(x_label)}</text>')
    middle = (TOP + HEIGHT - BOTTOM) / 2
    out.append(f'<text x="16" y="{middle}" text-anchor="middle" transform="rotate(-90 16 {middle})">{escape(y_label)}</text>')
    for i, (name, line) in enumerate(series.items()):
        colour = COLOURS[i % len(COLOURS)]
        points = [(x_axis.pixel(x), y_axis.pixel(y)) for x, y in line]
        path = f"M{points[0][0]:.1f} {points[0][1]:.1f}"
        for x, y in points[1:]:
            path += f"H{x:.1f}V{y:.1f}" if steps else f"L{x:.1f} {y:.1f}"
        out.append(f'<path d="{path}" fill="none" stroke="{colour}" stroke-width="1.8"/>')
        if dots:
            out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.6" fill="{colour}"/>' for x, y in points]
        y = TOP + 12 + 18 * i
        out.append(f'<path d="M{WIDTH - RIGHT + 12} {y - 4}h20" stroke="{colour}" stroke-width="3"/>')
        out.append(f'<text x="{WIDTH - RIGHT + 38}" y="{y}">{escape(name)}</text>')
    out.append("</svg>")
    return "\n".join(out) + "\n"


def read_rows(paths, score, excluded):
    """Rows with a value each: AE_p in 1e-2, or the points on the wrong side in percent."""
    rows = []
    for path in paths:
        with open(path, encoding="utf-8") as file:
            table = json.load(file)
        rows += [{**row, "label": table.get("label", "")} for row in table["rows"] if "ae_p" in row and row["model"] not in excluded]
    for row in rows:
        row["value"] = max(SMALLEST, 100 * row["ae_p"] if score == "ae_p" else 100 * (1 - row["pco"]))
    return rows


def means(rows, name_of, x_of):
    """{name: [(x, mean over the models that all have)]}, and the number of those models."""
    cells = {}
    for row in rows:
        cells.setdefault((name_of(row), x_of(row)), {})[row["model"]] = row["value"]
    common = set.intersection(*(set(cell) for cell in cells.values())) if cells else set()
    if not common:
        sys.exit("no model that every method has")
    series = {}
    for (name, x), cell in cells.items():
        series.setdefault(name, []).append((x, sum(cell[model] for model in common) / len(common)))
    return {name: sorted(line) for name, line in series.items()}, len(common)


def noise_of(row):
    """Noise in percent of the diagonal, None for other inputs."""
    if row["input"] == "clean":
        return 0.0
    return float(row["input"][6:]) if row["input"].startswith("noise:") else None


def varied(method, key):
    """("default", 0.01) of "default;epsilon=0.01n" and "epsilon"; None when the key is not there."""
    rest, value = [], None
    for part in method.split(";"):
        if part.startswith(key + "="):
            value = float(part[len(key) + 1:].split()[0].rstrip("hn%"))
        else:
            rest.append(part)
    return None if value is None else (";".join(rest), value)


def joined_table(rows, kind, points):
    """Markdown: a row per model and the means, a column per method: AE_p in 1e-2 / PCO in %."""
    if not rows:
        sys.exit("no rows of this input and this number of points")
    methods = list(dict.fromkeys(row["method"] for row in rows))
    cells = {(row["model"], row["method"]): row for row in rows}  # a later file wins
    models = sorted({row["model"] for row in rows})
    labels = ", ".join(dict.fromkeys(f"{row['method']} on {row['label']}" for row in cells.values() if row["label"]))
    size = f", {points:,} points" if points else ""
    out = [f"# {kind.capitalize()}{size}: {', '.join(methods)}", "",
           "AE_p in 1e-2 / PCO in %." + (f" Measured: {labels}." if labels else ""), "",
           "| model | " + " | ".join(methods) + " |", "|---" * (len(methods) + 1) + "|"]
    for model in models:
        found = [cells.get((model, method)) for method in methods]
        out.append(f"| {model} | " + " | ".join(f"{100 * r['ae_p']:.3f} / {100 * r['pco']:.3f}" if r else "-" for r in found) + " |")
    common = [model for model in models if all((model, method) in cells for method in methods)]
    means_of = []
    for method in methods:
        ae, pco = (sum(cells[model, method][key] for model in common) * 100 / len(common) for key in ("ae_p", "pco"))
        means_of.append(f"**{ae:.3f} / {pco:.3f}**")
    out.append(f"| **mean of the {len(common)} that all have** | " + " | ".join(means_of) + " |")
    return "\n".join(out) + "\n"


def draw(arguments):
    label = "mean AE_p, 1e-2" if arguments.score == "ae_p" else "points on the wrong side, %"
    if arguments.kind == "spectra":
        with open(arguments.tables[0], encoding="utf-8") as file:
            data = json.load(file)
        floor = 1e-12
        series = {}
        for name, values in data["spectra"].items():
            kept = range(0, len(values), max(1, len(values) // MOST_DOTS))
            series[name] = [(i + 1, max(values[i], floor)) for i in kept]
        title = f"{data['mesh']}, {data['points']} points"
        return chart(series, title, "eigenvalue number", "eigenvalue / largest", log_x=False, dots=False)
    rows = read_rows(arguments.tables, arguments.score, arguments.exclude.split(","))
    if arguments.kind in ("cdf", "points", "vary", "table"):
        rows = [row for row in rows if row["input"] == arguments.input]
    if arguments.kind in ("cdf", "noise", "vary", "table") and arguments.points:
        rows = [row for row in rows if row["points"] == arguments.points]
    if arguments.kind == "table":
        return joined_table(rows, arguments.input, arguments.points)
    if arguments.kind == "cdf":
        series = {}
        for row in rows:
            series.setdefault(row["method"], []).append(row["value"])
        series = {name: [(v, 100 * (i + 1) / len(values)) for i, v in enumerate(sorted(values))] for name, values in series.items()}
        title = f"{arguments.input}, {arguments.points} points"
        return chart(series, title, label.replace("mean ", ""), "share of the models, %", log_y=False, steps=True)
    if arguments.kind == "points":
        series, count = means(rows, lambda row: row["method"], lambda row: row["points"])
        return chart(series, f"{arguments.input}, {count} models", "points", label)
    if arguments.kind == "noise":
        rows = [row for row in rows if noise_of(row) is not None]
        series, count = means(rows, lambda row: row["method"], noise_of)
        return chart(series, f"{arguments.points} points, {count} models", "noise, % of the diagonal", label, log_x=False)
    rows = [row for row in rows if (varied(row["method"], arguments.key) or ("", 0))[1] > 0]
    series, count = means(rows, lambda row: varied(row["method"], arguments.key)[0], lambda row: varied(row["method"], arguments.key)[1])
    return chart(series, f"{arguments.input}, {count} models", arguments.key, label)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=["cdf", "points", "noise", "vary", "spectra", "table"])
    parser.add_argument("tables", nargs="+", help="JSON files")
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--input", default="clean")
    parser.add_argument("--points", type=int)
    parser.add_argument("--key", default="epsilon")
    parser.add_argument("--score", choices=["ae_p", "pco"], default="ae_p")
    parser.add_argument("--exclude", default="", help="models to leave out, comma separated")
    arguments = parser.parse_args()
    with open(arguments.output, "w", encoding="utf-8") as file:
        file.write(draw(arguments))


if __name__ == "__main__":
    main()
