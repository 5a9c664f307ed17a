"""The tables of README.md and docs are those of docs/results, whose rows are each of one commit."""

import json
import pathlib
import re
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "bench"))
import summary  # noqa: E402

MOST_FILES = 5
LARGEST = 3000  # lines of all files of docs/results: a repository is read by people
COMMIT = re.compile(r"[0-9a-f]{7,40}")


@unittest.skipUnless((ROOT / "docs" / "results").is_dir(), "source archives have no docs/results")
class Results(unittest.TestCase):
    def test_tables_of_the_pages_are_those_of_the_files(self):
        self.assertEqual([str(page) for page in summary.stale_pages(summary.Results())], [], "run bench/summary.py tables")

    def test_every_table_has_rows(self):
        results = summary.Results()
        for name, table in summary.TABLES.items():
            with self.subTest(name):
                self.assertGreater(len(table(results).splitlines()), 4)

    def test_the_tables_of_models_have_the_worst_ones_first(self):
        results = summary.Results()
        for table, rows, score in (("models-50k", results.of("default", "clean", 50000), 0),
                                   ("mesh-models", results.meshes["default", "clean", 50000], 1)):
            said = [line.split("|")[1].strip() for line in summary.TABLES[table](results).splitlines() if line.startswith("|")][2:]
            errors = [rows[model][1][score] for model in said]
            self.assertEqual(len(said), summary.WORST, table)
            self.assertEqual(errors, sorted((scores[score] for _, scores in rows.values()), reverse=True)[:summary.WORST], table)

    def test_every_row_says_its_commit_and_a_table_all_of_its_own(self):
        results = summary.Results()
        rows = [row for table in results.files.values() for kind in summary.LISTS for row in table[kind]]
        for row in rows:
            self.assertRegex(row[4], COMMIT, row)
        for name, table in summary.TABLES.items():
            said = table(results).splitlines()[0]
            self.assertRegex(said, "^Commit ", name)
            for commit in COMMIT.findall(said):
                self.assertIn(commit, {row[4] for row in rows}, name)

    def test_files_are_few_and_small(self):
        self.assertLessEqual(len(list(summary.RESULTS.glob("*.json"))), MOST_FILES)
        lines = sum(len(path.read_text().splitlines()) for path in summary.RESULTS.glob("*.json"))
        self.assertLess(lines, LARGEST)


class Summary(unittest.TestCase):
    def reduced(self, *tables):
        with tempfile.TemporaryDirectory() as folder:
            paths = [pathlib.Path(folder, f"{i}.json") for i in range(len(tables))]
            for path, table in zip(paths, tables):
                path.write_text(json.dumps(table))
            output = pathlib.Path(folder, "out.json")
            summary.write_results(summary.reduce_tables(paths), output)
            return json.loads(output.read_text()), output.read_text()

    def table(self, label, rows):
        return {"label": label, "seed": 1, "rows": rows}

    def row(self, model, **more):
        return {"model": model, "input": "clean", "points": 100, "method": "default", "ae_p": 0.0123456, "pco": 0.987, "cpu_seconds": 1.5,
                **more}

    def test_a_row_is_one_line(self):
        mesh = {"cd": 1e-4, "ae_m": 0.01, "hd": 0.02, "components": 1, "genus": None, "self_intersections": 0, "cpu_seconds": 2.0}
        results, text = self.reduced(self.table("abcdef0", [self.row("a"), self.row("b", mesh=mesh)]))
        self.assertEqual(results["normals"][0], ["default", "clean", 100, "a", "abcdef0", 0.01235, 0.987, 1.5])
        self.assertEqual(results["meshes"], [["default", "clean", 100, "b", "abcdef0", 1e-4, 0.01, 0.02, 1, None, 0, 2.0]])
        self.assertEqual(sum("0.01235" in line for line in text.splitlines()), 2)

    def test_rows_with_an_error_are_left_out(self):
        results, _ = self.reduced(self.table("abcdef0", [self.row("a"), {"model": "b", "error": "no such file"}]))
        self.assertEqual(len(results["normals"]), 1)

    def test_tables_of_two_commits_are_refused(self):
        with self.assertRaises(SystemExit):
            self.reduced(self.table("abcdef0", [self.row("a")]), self.table("abcdef1", [self.row("b")]))

    def test_rows_that_are_measured_anew_take_the_place_of_earlier_ones(self):
        def results(commit, *models):
            return {"seed": 1, "normals": [["default", "clean", 100, model, commit, 0.1, 0.9, 1] for model in models], "meshes": []}

        both = summary.updated(results("abcdef0", "a", "b"), results("abcdef1", "b", "c"))
        self.assertEqual([row[3:5] for row in both["normals"]], [["a", "abcdef0"], ["b", "abcdef1"], ["c", "abcdef1"]])
        with self.assertRaises(SystemExit):
            summary.updated({**results("abcdef0", "a"), "seed": 2}, results("abcdef1", "b"))

    def test_a_changed_figure_is_found(self):
        results = summary.Results()
        if not results.files:
            self.skipTest("no results")
        text = summary.with_tables("<!-- results clean-5k -->\n<!-- /results -->\n", results)
        self.assertIn("| g3r |", text)
        self.assertEqual(summary.with_tables(text.replace("| g3r |", "| g4r |"), results), text)


if __name__ == "__main__":
    unittest.main()
