"""Truths about what the g3r program puts on standard output and standard error, on a terminal and elsewhere.

Run by ctest with G3R_PROGRAM set to the program.
"""

import json
import os
import pty
import shutil
import subprocess
import sys
import unittest

from cli_support import *


class Streams(ProgramTest):
    def setUp(self):
        super().setUp()
        write_points(self.path("ball.ply"), sphere(300))

    def test_standard_output_carries_only_data(self):
        result = self.expect(OK, "orient", "ball.ply", "out.ply")
        self.assertEqual(result.out, b"")
        self.assertIn("300 points", result.err)
        self.assertIn("out.ply", result.err)
        result = self.expect(OK, "orient", "ball.ply", "-")
        self.assertEqual(len(read_ply(result.out)[1]), 300)
        self.assertTrue(result.out == self.bytes_of("out.ply"))
        json.loads(self.expect(OK, "orient", "ball.ply", "out.ply", "--report", "-").out)
        json.loads(self.expect(OK, "info", "ball.ply", "--report", "-").out)
        json.loads(self.expect(OK, "eval", "out.ply", "--truth", "out.ply").out)

    def test_standard_input_is_a_file_like_any(self):
        self.expect(OK, "orient", "ball.ply", "file.ply")
        self.expect(OK, "orient", "-", "stdin.ply", data=self.bytes_of("ball.ply"))
        self.assertTrue(self.bytes_of("file.ply") == self.bytes_of("stdin.ply"))

    def test_quiet_is_silent(self):
        result = self.expect(OK, "orient", "ball.ply", "out.ply", "--quiet")
        self.assertEqual((result.out, result.err), (b"", ""))

    def test_without_a_terminal_there_is_no_bar(self):
        for flags in ([], ["-v"]):
            result = self.expect(OK, "orient", "ball.ply", "out.ply", *flags)
            self.assertNotIn("\r", result.err)
            self.assertNotIn("\x1b", result.err)

    def terminal_output(self, *flags):
        main, other = pty.openpty()
        process = self.start("orient", "ball.ply", "out.ply", *flags, stdout=subprocess.DEVNULL, stderr=other,
                             env={**os.environ, "TERM": "xterm"})
        os.close(other)
        text = all_of_terminal(main)
        self.assertEqual(process.wait(), OK)
        return text

    @needs("pseudo-terminals")
    def test_a_terminal_shows_a_bar_unless_told_otherwise(self):
        self.assertIn(b"\r\x1b[K", self.terminal_output())
        self.assertNotIn(b"\x1b", self.terminal_output("--no-progress"))
        self.assertEqual(self.terminal_output("--quiet"), b"")

    def test_text_from_files_cannot_control_the_terminal(self):
        evil = "\x1b]0;owned\x07\x1b[2J"
        write_ply(self.path("evil.ply"), [("double", "x"), ("double", "y"), ("double", "z"), ("float", evil)],
                  [(*p, 0.0) for p in sphere(50)])
        with open(self.path("evil.xyz"), "w") as file:
            file.write("0 0 " + evil + "\n")
        write_points(self.path(evil.replace("/", "") + ".ply"), sphere(50))
        for name in ("evil.ply", "evil.xyz", evil + ".ply", evil):
            for command in (["info", name], ["orient", name, "out.ply", "-v"]):
                result = self.run_g3r(*command)
                self.assertNotIn("\x1b", result.err + result.out.decode("utf-8", "replace"))
        self.assertNotIn("\x1b", self.expect(USAGE, "--" + evil).err)

    @needs("localedef")
    def test_the_locale_changes_nothing(self):
        locales = self.path("locales")
        os.mkdir(locales)
        made = os.path.join(locales, "de_DE.UTF-8")
        if shutil.which("localedef"):
            subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", made], capture_output=True)
        if not os.path.isdir(made):
            self.skipTest("this system has no source of a German locale")
        german = {**os.environ, "LOCPATH": locales, "LC_ALL": "de_DE.UTF-8", "LANG": "de_DE.UTF-8"}
        self.expect(OK, "orient", "ball.ply", "plain.xyz", "--report", "-")
        result = self.expect(OK, "orient", "ball.ply", "german.xyz", "--report", "-", env=german)
        self.assertTrue(self.bytes_of("plain.xyz") == self.bytes_of("german.xyz"))
        self.assertNotIn(b",", self.bytes_of("german.xyz"))
        json.loads(result.out)
        self.expect(OK, "orient", "plain.xyz", "again.xyz", env=german)
        self.expect(OK, "orient", "ball.ply", "out.ply", "--epsilon", "0.4h", "--accuracy", "0.01", env=german)


    def test_the_noise_that_is_given_is_used(self):
        for given, spacings in (("0", 0), ("0.25h", 0.25)):
            scales = json.loads(self.expect(OK, "orient", "ball.ply", "out.ply", "--noise", given, "--report", "-").out)["scales"]
            self.assertAlmostEqual(scales["noise"], spacings * scales["spacing"], delta=1e-12)
        self.expect(USAGE, "orient", "ball.ply", "out.ply", "--noise", "-1")
        self.expect(OK, "orient", "ball.ply", "oriented.ply")
        for given, name in (("auto", "auto.ply"), ("0", "clean.ply"), ("0.5h", "noisy.ply")):
            self.expect(OK, "mesh", "oriented.ply", name, "--noise", given)
        self.assertTrue(self.bytes_of("auto.ply") == self.bytes_of("clean.ply") != self.bytes_of("noisy.ply"))
        self.expect(USAGE, "mesh", "oriented.ply", "out.ply", "--noise", "-1")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
