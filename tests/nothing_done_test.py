"""Scripts that build, judge and measure fail where there was nothing to do: a mistyped name is no success."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Stands for ctest: of the test that $KNOWN names it says that it passed, of others what ctest says of an unknown one.
CTEST = """#!/bin/sh
for last; do :; done
if [ "$last" = "^$KNOWN\\$" ]; then echo "Ran 3 tests in 0.1s"; else echo "No tests were found!!!"; fi
"""


class NothingDone(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_script(self, *command, **environment):
        return subprocess.run([*map(str, command)], capture_output=True, text=True, env={**os.environ, **environment})

    def test_the_judge_of_the_corpus_wants_files(self):
        entry = {"file": "geo_a.xyz", "expect": "must_fail_with_clear_error", "hint": [], "also_ok": [], "bytes": 1}
        budget = {"seconds": 60, "rss_mib": 1000, "rss_times_size": 1}
        (self.folder / "manifest.json").write_text(json.dumps({"budget": budget, "files": [entry]}))
        (self.folder / "geo_a.xyz").write_text("0")
        judge = [sys.executable, "-B", ROOT / "tests" / "badinputs" / "run_corpus.py", "--corpus", self.folder, "--any-rss"]
        refuse = ["--", "sh", "-c", 'echo "$0" >&2; exit 1', "{in}"]
        self.assertEqual(self.run_script(*judge, "--only", "geo_", *refuse).returncode, 0)
        for only in ("geoo_", "geo_,val_"):
            done = self.run_script(*judge, "--only", only, *refuse)
            self.assertEqual(done.returncode, 1)
            self.assertIn("no file of the corpus", done.stderr)

    def test_the_figures_want_tests(self):
        (self.folder / "ctest").write_text(CTEST)
        (self.folder / "ctest").chmod(0o755)

        def figures(*tests):
            return self.run_script(sys.executable, "-B", ROOT / "tools" / "security_figures.py", *tests, KNOWN="laz_test",
                                   PATH=str(self.folder) + os.pathsep + os.environ["PATH"])

        self.assertEqual(figures("laz_test", "e57_test").returncode, 0)  # a build may lack one
        self.assertEqual(figures("e57_test").returncode, 1)
        done = figures("laz_test", "lazz_test")
        self.assertEqual(done.returncode, 1)
        self.assertIn("no test is called so", done.stdout)

    def test_the_page_for_browsers_has_one_argument(self):
        for arguments in (["tests"], ["test", "more"]):
            self.assertEqual(self.run_script("bash", ROOT / "tools" / "web.sh", *arguments).returncode, 64)


if __name__ == "__main__":
    unittest.main()
