"""Truths about the g3r program on a machine that is short of something: disk, files, threads, processors, stack, folders, columns. Or
clocks jump. The result is right, or there is an error with its reason and its exit code, and nothing half written.

Run by ctest with G3R_PROGRAM set to the program and G3R_FAULT_SHIM to the library that makes calls fail.
"""

import ctypes
import errno
import fcntl
import os
import pty
import re
import resource
import struct
import subprocess
import sys
import tempfile
import termios
import time
import unittest

from cli_support import *

SHIM = os.path.abspath(os.environ["G3R_FAULT_SHIM"])
MORE_WRITES_THAN_A_RUN_MAKES = 100
KIB = 1 << 10
SOMEBODY = 61234  # a user without any other process
NO_HUGE_PAGES = 41  # PR_SET_THP_DISABLE of Linux' prctl


def limited(what, to):
    return lambda: resource.setrlimit(what, (to, to))


class HardMachine(ProgramTest):
    def setUp(self):
        super().setUp()
        write_points(self.path("ball.ply"), sphere(300))
        self.expect(OK, "orient", "ball.ply", "right.ply")
        self.right = self.bytes_of("right.ply")
        os.remove(self.path("right.ply"))

    def files(self):
        return sorted(os.listdir(self.folder))

    def assert_right(self, **options):
        """Runs the program; it must succeed with the same bytes as on an easy machine."""
        result = self.expect(OK, "orient", "ball.ply", "out.ply", *options.pop("flags", []), **options)
        self.assertTrue(self.bytes_of("out.ply") == self.right)
        os.remove(self.path("out.ply"))
        return result

    def assert_right_or_told(self, codes, **options):
        result = self.run_g3r("orient", "ball.ply", "out.ply", **options)
        self.assertIn(result.code, (OK, *codes), result.err)
        if result.code == OK:
            self.assertTrue(self.bytes_of("out.ply") == self.right)
            os.remove(self.path("out.ply"))
        else:
            self.assertTrue(result.err.startswith("g3r: "), result.err)
        self.assertEqual(self.files(), ["ball.ply"])
        return result.code

    def test_one_core(self):
        cores = sorted(os.sched_getaffinity(0))
        self.assert_right(preexec_fn=lambda: os.sched_setaffinity(0, cores[:1]))
        self.assert_right(flags=["--threads", "4"], preexec_fn=lambda: os.sched_setaffinity(0, cores[:1]))

    def test_more_threads_than_any_machine_has(self):
        self.assert_right(flags=["--threads", "128"])
        self.assert_right(flags=["--threads", "4096"])

    def test_no_folder_for_temporary_files_and_no_home(self):
        nowhere = self.path("nowhere")
        bare = {"TMPDIR": nowhere, "HOME": nowhere, "XDG_CACHE_HOME": nowhere}
        self.assert_right(env={**os.environ, **bare})
        self.assert_right(env={})
        self.assertEqual(self.files(), ["ball.ply"])

    def test_a_home_that_cannot_be_written(self):
        home = tempfile.mkdtemp()
        self.addCleanup(os.rmdir, home)  # fails if anything was left in it
        os.chmod(home, 0o555)
        self.assert_right(env={**os.environ, "HOME": home, "XDG_CACHE_HOME": ""}, **dropped_to_nobody())

    @unittest.skipIf(is_sanitized(), "the undefined behaviour sanitizer opens a pipe to look at memory, and takes its failure for an error")
    def test_few_open_files(self):
        told = (NO_INPUT, OUT_OF_MEMORY, CANNOT_CREATE, INPUT_OUTPUT)
        codes = {self.assert_right_or_told(told, preexec_fn=limited(resource.RLIMIT_NOFILE, n)) for n in (6, 7, 8, 16)}
        self.assertIn(OK, codes)

    @unittest.skipIf(is_sanitized(), "a sanitizer needs threads of its own")
    @unittest.skipUnless(os.geteuid() == 0, "the limit counts all processes of a user: of one that has none")
    def test_no_further_thread(self):
        alone = {**dropped_to_nobody(), "user": SOMEBODY}
        for most in (1, 2, 3):
            self.assert_right_or_told((OUT_OF_MEMORY,), preexec_fn=limited(resource.RLIMIT_NPROC, most), **alone)

    @unittest.skipIf(is_sanitized(), "sanitizers make frames larger")
    def test_a_small_stack(self):
        self.assert_right(preexec_fn=limited(resource.RLIMIT_STACK, 256 * KIB))

    def test_data_limits(self):
        if is_sanitized():
            self.skipTest("a sanitizer needs the memory")
        limits = [limited(resource.RLIMIT_DATA, n * 1024 * KIB) for n in (4, 8, 16, 4096)]
        codes = {self.assert_right_or_told((OUT_OF_MEMORY,), preexec_fn=each) for each in limits}
        self.assertIn(OK, codes)

    def everything(self):
        return ["ball.ply", "mesh.ply", "--also", "mesh.obj", "--also", "mesh.stl", "--oriented", "points.ply", "--report", "report.json"]

    @unittest.skipIf(is_sanitized(), "a sanitizer must be the first library to be loaded")
    def test_a_disk_that_fills_at_any_write_of_a_run_with_many_results(self):
        self.expect(OK, *self.everything(), "--quiet")
        names = self.files()
        whole = {name: self.bytes_of(name) for name in names}
        told = 0
        with tempfile.TemporaryDirectory() as marks:
            mark = os.path.join(marks, "mark")
            for at in range(1, MORE_WRITES_THAN_A_RUN_MAKES):
                for name in names[1:]:
                    with open(self.path(name), "wb") as file:
                        file.write(b"old")
                result = self.run_g3r(*self.everything(), "--quiet", env={
                    **os.environ, "LD_PRELOAD": SHIM, "G3R_FAULT_FOLDER": self.folder, "G3R_FAULT_CALL": "write", "G3R_FAULT_AT": str(at),
                    "G3R_FAULT_DO": str(errno.ENOSPC), "G3R_FAULT_MARK": mark})
                self.assertEqual(self.files(), names)
                for name in names[1:]:
                    if self.bytes_of(name) != b"old" and name != "report.json":  # times differ in reports
                        self.assertTrue(self.bytes_of(name) == whole[name], name)
                if self.bytes_of("report.json") != b"old":
                    self.json_of("report.json")
                if not os.path.exists(mark):
                    break
                os.remove(mark)
                told += 1
                self.assertEqual(result.code, INPUT_OUTPUT, result.err)
                self.assertIn("No space left on device", result.err)
        self.assertEqual(result.code, OK)
        self.assertGreaterEqual(told, 5)  # one for each result at least

    def test_a_small_disk(self):
        disk = self.path("disk")
        os.mkdir(disk)
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=32k", "none", disk], capture_output=True).returncode == 0
        if not mounted:
            self.skipTest("nothing can be mounted here")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        result = self.expect(INPUT_OUTPUT, "ball.ply", "disk/mesh.ply")
        self.assertIn("No space left on device", result.err)
        self.assertEqual(os.listdir(disk), [])

    def test_without_huge_pages(self):
        libc = ctypes.CDLL(None)
        if libc.prctl(NO_HUGE_PAGES, 0, 0, 0, 0) != 0:
            self.skipTest("this system has no such switch")
        self.assert_right(preexec_fn=lambda: libc.prctl(NO_HUGE_PAGES, 1, 0, 0, 0))

    @unittest.skipIf(is_sanitized(), "a sanitizer must be the first library to be loaded")
    def test_clocks_that_jump_at_every_look(self):
        for how in ("set", "asleep"):
            jumping = {**os.environ, "LD_PRELOAD": SHIM, "G3R_FAULT_CLOCK": how}
            begin = time.monotonic()
            self.assert_right(flags=["--report", "r.json"], env=jumping)
            passed = time.monotonic() - begin
            seconds = self.json_of("r.json")["seconds"]
            os.remove(self.path("r.json"))
            self.assertTrue(all(value >= 0 for value in seconds.values()), seconds)
            # Durations are those of a clock that nobody can set, but that goes on while a machine sleeps.
            self.assertEqual(seconds["total"] <= passed, how == "set", seconds)
            drawn = self.terminal_of(80, jumping)
            self.assertIn("\x1b[K", drawn)
            self.assertNotIn("-", "".join(re.findall(r"% *, (.*?) left", drawn)))

    def terminal_of(self, columns, environment=os.environ):
        main, other = pty.openpty()
        fcntl.ioctl(other, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        process = self.start("ball.ply", "mesh.ply", stdout=subprocess.DEVNULL, stderr=other, env={**environment, "TERM": "xterm"})
        os.close(other)
        text = all_of_terminal(main)
        self.assertEqual(process.wait(), OK)
        return text.decode("utf-8")

    def test_the_bar_stays_on_one_line_of_any_terminal(self):
        for columns in (1, 8, 20, 40, 80):
            drawn = self.terminal_of(columns).split("\r\x1b[K")[1:]
            bars = [bar for bar in drawn if bar.startswith("  ") and "\r\n" not in bar]  # what is said ends its line
            self.assertTrue(bars or columns < 8, columns)
            for bar in bars:
                self.assertLess(len(bar), columns, repr(bar))
            self.assertFalse(columns <= 20 and any("[" in bar for bar in bars), "no room for a bar, only for the share")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
