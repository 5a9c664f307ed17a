"""Truths about writing when the system fails: whatever call fails, the old file is intact or the new one complete, the program says
what happened, and nothing is left behind. Every call of every kind is made to fail once.

Run by ctest with G3R_PROGRAM set to the program and G3R_FAULT_SHIM to the library that makes calls fail.
"""

import collections
import errno
import os
import sys
import unittest

from cli_support import *

SHIM = os.environ["G3R_FAULT_SHIM"]
MORE_CALLS_THAN_ANY_WRITE_MAKES = 1000


@unittest.skipIf(is_sanitized(), "a sanitizer must be the first library to be loaded")
class Faults(ProgramTest):
    COMMAND = ["sample", "cube.obj", "out.ply", "--count", "30000", "--quiet"]

    def setUp(self):
        super().setUp()
        write_cube(self.path("cube.obj"))
        self.expect(OK, *self.COMMAND, "--seed", "2")
        self.new = self.bytes_of("out.ply")
        self.expect(OK, *self.COMMAND, "--seed", "1")
        self.old = self.bytes_of("out.ply")
        self.marks = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.marks)

    hits = collections.Counter()

    @classmethod
    def tearDownClass(cls):
        print("calls that failed:", *("%d %s," % (cls.hits[kind], kind) for kind in sorted(cls.hits)), file=sys.stderr)

    def runs_with_fault(self, call, what):
        """Runs the command with the 1st, 2nd, ... call failing, until a run has no such call left; yields each run that was hit."""
        mark = os.path.join(self.marks, "mark")
        for at in range(1, MORE_CALLS_THAN_ANY_WRITE_MAKES):
            with open(self.path("out.ply"), "wb") as file:
                file.write(self.old)
            result = self.run_g3r(*self.COMMAND, "--seed", "2", env={
                **os.environ, "LD_PRELOAD": SHIM, "G3R_FAULT_FOLDER": self.folder, "G3R_FAULT_CALL": call, "G3R_FAULT_AT": str(at),
                "G3R_FAULT_DO": str(what), "G3R_FAULT_MARK": mark})
            if not os.path.exists(mark):
                self.assertEqual(result.code, OK, result.err)
                self.assertGreater(at, 1, "the program makes no such call")
                return
            os.remove(mark)
            self.hits["killed" if what == "kill" else "short or interrupted" if what in (errno.EINTR, "short") else "with an error"] += 1
            content = self.bytes_of("out.ply")
            self.assertTrue(content in (self.old, self.new), "%s %d: %d bytes" % (call, at, len(content)))
            yield at, result, content

    def assert_nothing_left(self):
        self.assertEqual(sorted(os.listdir(self.folder)), ["cube.obj", "out.ply"])

    def test_every_failing_call_is_told(self):
        for call, code in (("open", CANNOT_CREATE), ("write", INPUT_OUTPUT), ("fsync", INPUT_OUTPUT), ("close", INPUT_OUTPUT),
                           ("rename", INPUT_OUTPUT)):
            for number in (errno.ENOSPC, errno.EIO, errno.EDQUOT):
                for at, result, content in self.runs_with_fault(call, number):
                    with self.subTest(call=call, error=errno.errorcode[number], at=at):
                        if call == "close" and result.code == OK:  # of the folder, or of the probe before the work: nothing is lost
                            self.assertTrue(content == self.new)
                            continue
                        self.assertIn(result.code, (code, CANNOT_CREATE, INPUT_OUTPUT))
                        self.assertIn(os.strerror(number), result.err)
                        self.assertIn("out.ply", result.err)
                        self.assert_nothing_left()
                        if call in ("open", "write", "rename"):
                            self.assertTrue(content == self.old)

    def test_an_interrupted_or_short_write_goes_on(self):
        for what in (errno.EINTR, "short"):
            for at, result, content in self.runs_with_fault("write", what):
                with self.subTest(what=what, at=at):
                    self.assertEqual(result.code, OK, result.err)
                    self.assertTrue(content == self.new)

    def test_a_kill_in_place_of_any_call_leaves_one_whole_file(self):
        for call in ("open", "write", "fsync", "close", "rename"):
            for at, result, _ in self.runs_with_fault(call, "kill"):
                with self.subTest(call=call, at=at):
                    self.assertEqual(result.code, -9)
                    self.expect(OK, *self.COMMAND, "--seed", "2")
                    self.assertTrue(self.bytes_of("out.ply") == self.new)
                    self.assert_nothing_left()


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
