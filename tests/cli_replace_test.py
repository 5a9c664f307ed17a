"""Truths about files and the end of the g3r program that hold on every system: names in any script, line ends, standard streams as bytes, and
outputs that are whole or not there. Run by ctest with G3R_PROGRAM set to the program, and G3R_RUNNER to what runs it, if anything does.
For measuring, G3R_KILLS raises the number of repetitions."""

import fcntl
import os
import pty
import random
import sys
import termios
import time
import unittest

from cli_support import *

KILLS = int(os.environ.get("G3R_KILLS", "12"))
LARGE_COUNT = 150_000  # points: seconds of solving
FOREIGN = "Pünktchen 点"


class Files(ProgramTest):
    def test_names_are_utf_8(self):
        write_points(self.path(FOREIGN + ".ply"), sphere(300))
        result = self.expect(OK, "orient", FOREIGN + ".ply", FOREIGN + ".out.ply", "--report", FOREIGN + ".json")
        self.assertIn(FOREIGN + ".out.ply", result.err)
        self.assertEqual(sorted(os.listdir(self.folder)), sorted([FOREIGN + ".ply", FOREIGN + ".out.ply", FOREIGN + ".json"]))
        self.assertIn("none " + FOREIGN, self.expect(NO_INPUT, "orient", "none " + FOREIGN + ".ply", "out.ply").err)

    def test_line_ends_of_windows_are_read(self):
        lines = ["%r %r %r" % point for point in sphere(300)]
        for name, end in (("unix.xyz", "\n"), ("windows.xyz", "\r\n")):
            with open(self.path(name), "wb") as file:
                file.write((end.join(lines) + end).encode())
            self.expect(OK, "orient", name, name + ".ply")
        self.assertEqual(self.bytes_of("unix.xyz.ply"), self.bytes_of("windows.xyz.ply"))

    def test_standard_streams_are_bytes(self):
        write_points(self.path("in.ply"), sphere(600))  # with bytes 10, 13 and 26 among its numbers
        self.assertTrue({10, 13, 26} <= set(self.bytes_of("in.ply")))
        self.expect(OK, "orient", "in.ply", "file.ply")
        result = self.expect(OK, "orient", "-", "-", data=self.bytes_of("in.ply"))
        self.assertEqual(result.out, self.bytes_of("file.ply"))
        self.assertNotIn(b"\r", self.expect(OK, "--help").out)

    def test_folders_may_be_patterns(self):
        for name in ("a1", "a2"):
            os.mkdir(self.path(name))
            write_points(self.path(name + "/part.ply"), sphere(300, centre=(3.0 * int(name[1]), 0.0, 0.0)))
        self.assertIn("600", self.expect(OK, "orient", "a?/*.ply", "out.ply").err)


class Ends(ProgramTest):
    @needs("terminal that this test can make")
    def test_ctrl_c_at_a_terminal_ends_a_solve(self):
        write_points(self.path("in.ply"), sphere(LARGE_COUNT))
        main, other = pty.openpty()
        process = self.start("orient", "in.ply", "out.ply", "-v", stdin=other, start_new_session=True,
                             preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0))
        os.close(other)
        for line in process.stderr:
            if line.startswith(b"g3r: ") and b"solve" in line:
                os.write(main, b"\x03")
                break
        self.assertIn(b"interrupted", process.communicate()[1])
        os.close(main)
        self.assertEqual(process.returncode, INTERRUPTED)
        self.assertEqual(os.listdir(self.folder), ["in.ply"])

    def test_a_kill_leaves_the_old_file_or_the_new_one(self):
        write_cube(self.path("cube.obj"))
        command = ["sample", "cube.obj", "out.ply", "--count", "200000", "--quiet"]
        self.expect(OK, *command, "--seed", "2")
        new = self.bytes_of("out.ply")
        self.expect(OK, *command, "--seed", "1")
        old = self.bytes_of("out.ply")
        pause = random.Random(1)
        for _ in range(KILLS):
            before = set(os.listdir(self.folder))
            process = self.start(*command, "--seed", "2")
            while process.poll() is None and set(os.listdir(self.folder)) == before:
                pass  # until the temporary file appears
            stop = time.monotonic() + pause.uniform(0, 0.02)
            while process.poll() is None and time.monotonic() < stop:
                pass
            process.kill()
            process.communicate()
            content = self.bytes_of("out.ply")
            self.assertTrue(content in (old, new), "%d bytes" % len(content))
            if content == new:
                self.expect(OK, *command, "--seed", "1")
        self.expect(OK, *command, "--seed", "2")
        self.assertTrue(self.bytes_of("out.ply") == new)
        self.assertEqual(sorted(os.listdir(self.folder)), ["cube.obj", "out.ply"])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
