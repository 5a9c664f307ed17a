"""bench/plots.py: draws one line per method, of the right number of points, as SVG that parses."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

PLOTS = pathlib.Path(__file__).resolve().parent.parent / "bench" / "plots.py"
SVG = "{http://www.w3.org/2000/svg}"


def row(model, kind, points, method, ae):
    return {"model": model, "input": kind, "points": points, "method": method, "ae_p": ae, "pco": 1 - ae}


class Plots(unittest.TestCase):
    def draw(self, kind, data, *options):
        with tempfile.TemporaryDirectory() as folder:
            table, svg = pathlib.Path(folder, "table.json"), pathlib.Path(folder, "plot.svg")
            table.write_text(json.dumps(data), encoding="utf-8")
            subprocess.run([sys.executable, "-B", PLOTS, kind, table, "-o", svg, *options], check=True)
            return ElementTree.parse(svg).getroot()

    def names(self, root):
        return [text.text for text in root.iter(SVG + "text")]

    def test_cdf_has_a_dot_per_model(self):
        rows = [row(m, "clean", 100, "default", a) for m, a in (("a", 0.01), ("b", 0.02), ("c", 0.0))]
        root = self.draw("cdf", {"rows": rows}, "--points", "100")
        self.assertEqual(len(list(root.iter(SVG + "circle"))), 3)
        self.assertIn("default", self.names(root))

    def test_points_and_noise_compare_common_models_only(self):
        rows = [row("a", "clean", n, "default", 1 / n) for n in (100, 1000)] + [row("b", "clean", 100, "default", 0.5)]
        self.assertIn("clean, 1 models", self.names(self.draw("points", {"rows": rows})))
        rows = [row("a", kind, 100, m, 0.1) for kind in ("clean", "noise:0.5", "gradient:10") for m in ("default", "wnnc")]
        root = self.draw("noise", {"rows": rows}, "--points", "100")
        self.assertEqual(len(list(root.iter(SVG + "circle"))), 4)

    def test_vary_reads_the_option_from_the_method(self):
        rows = [row("a", "clean", 100, f"default;epsilon={e}h", e) for e in (0.1, 0.2, 0.4)]
        root = self.draw("vary", {"rows": rows}, "--key", "epsilon")
        self.assertEqual(len(list(root.iter(SVG + "circle"))), 3)
        self.assertIn("default", self.names(root))

    def test_table_joins_methods_and_averages_common_models(self):
        rows = [row("a", "clean", 100, "default", 0.01), row("a", "clean", 100, "wnnc", 0.03), row("b", "clean", 100, "wnnc", 0.5)]
        with tempfile.TemporaryDirectory() as folder:
            tables = []
            for i, some in enumerate((rows[:1], rows[1:])):
                tables.append(pathlib.Path(folder, f"{i}.json"))
                tables[-1].write_text(json.dumps({"label": f"commit{i}", "rows": some}), encoding="utf-8")
            out = pathlib.Path(folder, "t.md")
            subprocess.run([sys.executable, "-B", PLOTS, "table", *tables, "-o", out, "--points", "100"], check=True)
            text = out.read_text(encoding="utf-8")
        self.assertTrue(text.startswith("# Clean, 100 points: default, wnnc\n"))
        self.assertIn("default on commit0, wnnc on commit1.", text)
        self.assertIn("| a | 1.000 / 99.000 | 3.000 / 97.000 |\n| b | - | 50.000 / 50.000 |", text)
        self.assertIn("mean of the 1 that all have** | **1.000 / 99.000** | **3.000 / 97.000** |", text)

    def test_spectra_have_a_line_each(self):
        data = {"mesh": "m", "points": 2, "spectra": {"one": [1, 0.5], "two": [1, 0]}}
        self.assertTrue({"one", "two"} <= set(self.names(self.draw("spectra", data))))


if __name__ == "__main__":
    unittest.main()
