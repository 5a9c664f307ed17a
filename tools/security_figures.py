#!/usr/bin/env python3
"""tools/security_figures.py [TEST...]: runs the tests that SECURITY.md counts (or those named) in build/release and prints what they
measured, as a Markdown table dated by the commit. $G3R_BUILD names another build. Exit status 1 if a test fails, if there is no test of a
name, or if none of them is in the build. Takes minutes.

Figures are what tests record (RecordProperty of GoogleTest, added up over the tests of a program) and what they print of counts.
"""

import collections
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = pathlib.Path(os.environ.get("G3R_BUILD", ROOT / "build" / "release"))
TESTS = ["badinputs_read", "badinputs_orient", "io_sweep_test", "io_fault_test", "cli_fault_test", "cli_hard_machine_test",
         "cli_interrupt_test", "cli_replace_test", "cli_memory_test", "allocation_failure_test", "guest_test", "stress_test", "laz_test",
         "e57_test", "any_size_test", "tiles_mesh_test", "cli_tiles_test", "platform_test", "supply_chain_test"]
# Lines of tests that count, and what to say of them.
PRINTED = [(r"(\d+) \{'pass': (\d+)\}", "{1} of {0} files as declared"), (r"calls that failed: (.*?),?$", "{0}"),
           (r"(stopped after at most \S+ s in \d+ runs)", "{0}"), (r"Ran (\d+) tests? in", "{0} tests"),
           (r"\[  PASSED  \] (\d+) tests?", "{0} tests")]
OF_GOOGLE_TEST = {"name", "file", "line", "status", "result", "timestamp", "time", "classname", "failures", "tests", "disabled", "errors"}


def recorded(path):
    """The properties that the tests of one program have recorded, added up; `failures` is a list where GoogleTest means its own."""
    sums = collections.Counter()
    for suite in json.loads(path.read_text())["testsuites"]:
        for test in suite["testsuite"]:
            for key, value in test.items():
                if isinstance(value, str) and re.fullmatch(r"\d+", value) and (key not in OF_GOOGLE_TEST or key == "failures"):
                    sums[key] += int(value)
    return ["%d %s" % (count, key) for key, count in sums.items()]


def printed(text):
    return [form.format(*found) for pattern, form in PRINTED for line in text.splitlines() for found in [re.findall(pattern, line)] if found
            for found in [found[0] if isinstance(found[0], tuple) else (found[0],)]]


def is_test(name):
    return name in TESTS or any((ROOT / "tests" / (name + ending)).exists() for ending in (".cpp", ".py"))


def run(test):
    """Whether it passed, None where the build does not have it, and its figures."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(["ctest", "--test-dir", str(BUILD), "-V", "-R", "^%s$" % test], capture_output=True, text=True,
                              env={**os.environ, "GTEST_OUTPUT": "json:%s/" % folder})
        figures = printed(done.stdout)
        for path in pathlib.Path(folder).glob("*.json"):
            figures += recorded(path)
    if "No tests were found" in done.stdout + done.stderr:
        return (None, ["not in this build"]) if is_test(test) else (False, ["no test is called so"])
    passed = done.returncode == 0
    return passed, (figures or ["passed"]) if passed else ["FAILED"] + figures


def main(tests):
    commit = subprocess.run(["git", "log", "-1", "--format=%h of %cs"], capture_output=True, text=True, cwd=ROOT).stdout.strip()
    print("Measured at %s:\n\n| test | figures |\n|---|---|" % (commit or "an unknown commit"))
    results = []
    for test in tests:
        passed, figures = run(test)
        results.append(passed)
        print("| `%s` | %s |" % (test, ", ".join(dict.fromkeys(figures))), flush=True)
    return 0 if any(results) and False not in results else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:] or TESTS))
