"""The tables of README.md and docs are those of docs/results, whose files are each of one commit."""

import json
import pathlib
import re
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "bench"))
import summary  # noqa: E402

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

    # A file is of one commit. Those that one run of tools/measure.sh wrote are all of the same one; a file of an earlier commit is named
    # by it.
    def test_files_are_of_one_commit(self):
        files = summary.Results().files
        for name, table in files.items():
            self.assertRegex(table["commit"], COMMIT, name)
            if COMMIT.fullmatch(name[:-len(".json")]):
                self.assertEqual(name, table["commit"] + ".json")
        current = {table["commit"] for name, table in files.items() if name != table["commit"] + ".json"}
        self.assertLessEqual(len(current), 1, "run tools/measure.sh without restrictions")

    def test_files_are_small(self):
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
        self.assertEqual(results["normals"][0], ["default", "clean", 100, "a", 0.01235, 0.987, 1.5])
        self.assertEqual(results["meshes"], [["default", "clean", 100, "b", 1e-4, 0.01, 0.02, 1, None, 0, 2.0]])
        self.assertEqual(sum("0.01235" in line for line in text.splitlines()), 2)

    def test_rows_with_an_error_are_left_out(self):
        results, _ = self.reduced(self.table("abcdef0", [self.row("a"), {"model": "b", "error": "no such file"}]))
        self.assertEqual(len(results["normals"]), 1)

    def test_tables_of_two_commits_are_refused(self):
        with self.assertRaises(SystemExit):
            self.reduced(self.table("abcdef0", [self.row("a")]), self.table("abcdef1", [self.row("b")]))

    def test_earlier_files_without_a_row_of_their_own_go(self):
        with tempfile.TemporaryDirectory() as folder:
            def write(name, *models):
                path = pathlib.Path(folder, name + ".json")
                rows = [["default", "clean", 100, model, 0.1, 0.9, 1] for model in models]
                summary.write_results({"commit": "abcdef0", "seed": 1, "normals": rows, "meshes": []}, path)
                return path

            inside, beside, new = write("inside", "a"), write("beside", "b", "c"), write("new", "a", "b")
            summary.remove_superseded(new)
            self.assertEqual([inside.exists(), beside.exists(), new.exists()], [False, True, True])

    def test_a_changed_figure_is_found(self):
        results = summary.Results()
        if not results.files:
            self.skipTest("no results")
        text = summary.with_tables("<!-- results clean-5k -->\n<!-- /results -->\n", results)
        self.assertIn("| g3r |", text)
        self.assertEqual(summary.with_tables(text.replace("| g3r |", "| g4r |"), results), text)


if __name__ == "__main__":
    unittest.main()
