"""Truths about g3r tiles, and g3r orient beyond --max-memory: killed at any time it goes on, with the same bytes in the end.

Run by ctest with G3R_PROGRAM set to the program. For measuring, G3R_TILE_KILLS raises the number of kills.
"""

import os
import json
import random
import signal
import sys
import threading
import unittest

from cli_support import *

COUNT = 8200  # few more than tiles take
LARGE_COUNT = 200_000  # of a cloud that fits a limit in tiles and does not in core
FEWER = 100_000, "84M"  # points and a limit of which the same is true, but not of their mesh
SHIM = os.environ.get("G3R_FAULT_SHIM", "")
MEBIBYTE = 1 << 20
KILLS = int(os.environ.get("G3R_TILE_KILLS", "2"))

SAYS_WHAT_IS_FREE = unittest.skipIf(not SHIM or is_sanitized() or not os.path.exists("/proc/meminfo"), "what is free cannot be told to it")


def signal_at(process, words, number):
    """Sends a signal when a line of standard error has these words, and waits for the end; at most five minutes. The lines up to there."""
    guard = threading.Timer(300, process.kill)
    guard.start()
    lines = []
    for line in process.stderr:
        lines.append(line)
        if words in line:
            break
    process.send_signal(number)
    process.communicate()
    guard.cancel()
    return lines


class Tiles(ProgramTest):
    def with_free(self, mebibytes):
        """Options of start() for a system that says so much memory is free."""
        folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, folder)
        with open(os.path.join(folder, "meminfo"), "w") as file:
            file.write("MemAvailable: %d kB\n" % (mebibytes * 1024))
        return {"env": {**os.environ, "LD_PRELOAD": SHIM, "G3R_FAULT_MEMORY": file.name}}

    def setUp(self):
        super().setUp()
        write_points(self.path("in.ply"), sphere(COUNT))

    @unittest.skipIf(is_sanitized(), "tiles_test and tiles_mesh_test begin anew after the same steps, in one process")
    def test_killed_runs_go_on_and_end_with_the_same_bytes(self):
        plan = ["tiles", "plan", "in.ply", "work", "--tiles", "2"]
        self.expect(OK, *plan)
        for worker in "2/2", "1/2":
            self.expect(OK, "tiles", "run", "work", "--worker", worker)
        self.expect(OK, "tiles", "merge", "work", "whole.ply")
        for worker in "2/2", "1/2":
            self.expect(OK, "tiles", "mesh", "work", "--worker", worker)
        self.expect(OK, "tiles", "merge", "work", "whole.mesh.ply", "--mesh")
        shutil.rmtree(self.path("work"))
        chance = random.Random(1)
        steps = [plan, ["tiles", "run", "work"], ["tiles", "merge", "work", "out.ply"], ["tiles", "mesh", "work"],
                 ["tiles", "merge", "work", "mesh.ply", "--mesh"]]
        for _ in range(KILLS):
            for step in steps:
                process = self.start(*step, "-v")
                wanted = chance.randrange(12)
                for number, _ in enumerate(process.stderr):
                    if number == wanted:
                        break
                process.kill()
                process.communicate()
        for step in steps:
            self.expect(OK, *step)
        self.assertEqual(self.bytes_of("out.ply"), self.bytes_of("whole.ply"))
        self.expect(OK, "tiles", "merge", "work", "out.las")
        self.assertIn("las 1.4, point format 0", self.expect(OK, "info", "out.las").out.decode())
        self.assertEqual(self.bytes_of("mesh.ply"), self.bytes_of("whole.mesh.ply"))
        self.assertIn("closed, manifold", self.expect(OK, "info", "mesh.ply").out.decode())
        self.assertEqual([name for name in os.listdir(self.path("work")) if name.endswith(".tmp")], [])
        names, rows = read_ply(self.bytes_of("out.ply"))
        self.assertEqual(names, ["x", "y", "z", "nx", "ny", "nz", "confidence"])
        for row, point in zip(rows, sphere(COUNT)):
            self.assertGreater(sum(row["n" + axis] * c for axis, c in zip("xyz", point)), 0.99)

    def test_status_says_what_is_missing_and_merge_refuses(self):
        self.expect(OK, "tiles", "plan", "in.ply", "work", "--tiles", "2")
        status = self.expect(OK, "tiles", "status", "work").out.decode()
        self.assertIn("8,200 points, 0 of 2 tiles done", status)
        result = self.expect(BAD_DATA, "tiles", "merge", "work", "out.ply")
        self.assertIn("2 of 2 tiles are not done (1, 2); g3r tiles run", result.err)
        self.assertIn("2 of 2 tiles have no normals yet", self.expect(BAD_DATA, "tiles", "mesh", "work").err)
        self.assertIn("not meshed", self.expect(BAD_DATA, "tiles", "merge", "work", "out.ply", "--mesh").err)
        self.assertIn("ends in .ply, .las or .laz", self.expect(BAD_DATA, "tiles", "merge", "work", "out.xyz").err)
        for option in (["--keep-largest", "1"], ["--min-component", "5"], ["--keep-all"]):  # of meshes
            self.assertIn("--mesh", self.expect(USAGE, "tiles", "merge", "work", "out.ply", *option).err)
        self.assertFalse(os.path.exists(self.path("out.ply")))

    def test_an_input_is_no_output(self):
        before = self.bytes_of("in.ply")
        self.expect(OK, "tiles", "plan", "in.ply", "work", "--tiles", "1")
        self.expect(OK, "tiles", "run", "work")
        result = self.expect(CANNOT_CREATE, "tiles", "merge", "work", "work/../in.ply")
        self.assertIn("input of the plan", result.err)
        self.assertEqual(self.bytes_of("in.ply"), before)

    def test_damage_in_a_text_names_the_line(self):
        lines = ["%r,%r,%r" % point for point in sphere(COUNT)]
        lines[4000] = "1,2,north"
        with open(self.path("in.csv"), "w") as file:
            file.write("x,y,z\n" + "\n".join(lines) + "\n")
        result = self.expect(BAD_DATA, "tiles", "plan", "in.csv", "work", "--tiles", "2")
        self.assertIn('in.csv: line 4002: expected a number, found "north"', result.err)
        self.assertFalse(os.path.exists(self.path("work/manifest.json")))

    def test_wrong_command_lines_are_told(self):
        for arguments in (["tiles"], ["tiles", "plan", "in.ply"], ["tiles", "run"], ["tiles", "mesh"], ["tiles", "run", "work", "--worker", "0/2"],
                          ["tiles", "run", "work", "--worker", "3/2"], ["tiles", "plan", "in.ply", "work", "--sensor", "file"]):
            with self.subTest(arguments=arguments):
                self.expect(USAGE, *arguments)
        self.expect(BAD_DATA, "tiles", "run", "nowhere")
        self.expect(NO_INPUT, "tiles", "plan", "none.ply", "work")
        self.expect(UNAVAILABLE, "tiles", "plan", "in.ply", "work", "--max-memory", "1M")
        self.assertFalse(os.path.exists(self.path("work/manifest.json")))

    def test_orient_works_in_tiles_where_it_would_refuse(self):
        """Until the sort: the tiles themselves are those of the other tests."""
        write_points(self.path("large.ply"), sphere(LARGE_COUNT))
        arguments = ["orient", "large.ply", "out.PLY", "--max-memory", "130M"]
        refused = self.expect(UNAVAILABLE, *arguments, "--ascii")  # which tiles do not write
        self.assertIn("tiles take any size, but need a .ply, .las or .laz for OUT", refused.err)
        self.assertNotIn("depth", refused.err)
        refused = self.expect(UNAVAILABLE, *arguments[1:], "--open")  # of a mesh neither
        self.assertIn("tiles take any size, but need a .ply for OUT", refused.err)
        self.assertIn("g3r works in tiles where it can", self.expect(OK, "info", "large.ply", "--max-memory", "130M").err)
        process = self.start(*arguments, "-v", preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
        stages = signal_at(process, b"coarse", signal.SIGINT)
        self.assertEqual(process.returncode, INTERRUPTED, stages)
        self.assertIn(b"g3r: sort\n", stages)
        self.assertFalse(os.path.exists(self.path("out.PLY")))
        self.assertTrue(os.path.exists(self.path("out.PLY.tiles/points-1.bin")))

    @unittest.skipUnless(sys.platform.startswith("linux") and not ON_WINDOWS, "names of files are text here")
    def test_names_that_are_no_utf8_are_refused_by_tiles_alone(self):
        name = os.fsdecode(b"in\xff.ply")
        os.rename(self.path("in.ply"), self.path(name))
        self.expect(OK, "orient", name, "out.ply", "--max-memory", "8G")
        write_points(self.path(name), sphere(FEWER[0]))
        self.assertIn("UTF-8", self.expect(BAD_DATA, "orient", name, "out.ply", "--max-memory", FEWER[1]).err)

    def test_what_is_refused_before_a_tile_is_solved_leaves_no_plan(self):
        """Another limit would not go on with it."""
        count, limit = FEWER
        write_points(self.path("fewer.ply"), sphere(count))
        refused = self.expect(UNAVAILABLE, "fewer.ply", "mesh.ply", "--max-memory", limit).err
        self.assertRegex(refused, "tiles of this mesh need [0-9]+ MiB, the limit is [0-9]+ MiB; raise the limit")
        self.assertIn("tiles of this cloud need", self.expect(UNAVAILABLE, "orient", "fewer.ply", "out.ply", "--max-memory", "70M").err)
        self.assertEqual(sorted(os.listdir(self.folder)), ["fewer.ply", "in.ply"])

    @unittest.skipIf(is_sanitized(), "the tiles are those of the other tests")
    def test_the_report_says_what_tiles_know(self):
        count, limit = FEWER
        write_points(self.path("fewer.ply"), sphere(count, 2.0, (5, 6, 7)))
        self.expect(OK, "orient", "fewer.ply", "out.ply", "--max-memory", limit, "--up", "+z", "--threads", "1", "--report", "r.json")
        report = self.json_of("r.json")
        self.assertEqual(report["input"]["points"], count)
        self.assertEqual(report["hints"]["given"], ["up"])
        self.assertEqual(report["threads"], 1)
        self.assertAlmostEqual(report["scales"]["box_side"], 4, delta=1e-3)
        for axis, centre in enumerate((5, 6, 7)):
            self.assertAlmostEqual(report["scales"]["box_centre"][axis], centre, delta=1e-3)
        self.assertTrue(report["converged"] and report["consistent"])
        self.assertGreater(report["confidence"]["mean"], 0.9)
        self.assertEqual(sorted(os.listdir(self.folder)), ["fewer.ply", "in.ply", "out.ply", "r.json"])

    @SAYS_WHAT_IS_FREE
    def test_without_max_memory_what_was_free_decides_and_killed_runs_go_on(self):
        count, limit = FEWER
        in_bytes = int(limit[:-1]) * MEBIBYTE
        free = int(limit[:-1]) * 4 / 3
        write_points(self.path("fewer.ply"), sphere(count))
        self.expect(OK, "orient", "fewer.ply", "whole.ply", "--max-memory", str(in_bytes))
        arguments = ["orient", "fewer.ply", "out.ply"]
        process = self.start(*arguments, "-v", **self.with_free(free))
        said = signal_at(process, b"tile 2 of", signal.SIGKILL)
        self.assertIn(b"more than three quarters of the free memory in one piece: tiles, in out.ply.tiles; where this ends early, the same "
                      b"command goes on\n", said)
        done = self.bytes_of("out.ply.tiles/tile-0.bin")
        refused = self.expect(UNAVAILABLE, *arguments, **self.with_free(free / 4))
        self.assertIn("was made when more memory was free", refused.err)
        self.assertIn("%d MiB are free" % (free / 4), refused.err)
        self.assertEqual(self.bytes_of("out.ply.tiles/tile-0.bin"), done)
        result = self.expect(OK, *arguments, "-v", "--report", "r.json", **self.with_free(100 * free))
        self.assertIn("goes on with the tiles in out.ply.tiles", result.err)
        self.assertNotIn("tile 1 of", result.err)
        [warning] = self.json_of("r.json")["warnings"]
        self.assertIn("beyond three quarters of the free memory, %s, in one piece" % limit.replace("M", " MiB"), warning)
        self.assertIn("--max-memory %d makes the same tiles anywhere" % in_bytes, warning)
        self.assertEqual(self.bytes_of("out.ply"), self.bytes_of("whole.ply"))
        self.assertFalse(os.path.exists(self.path("out.ply.tiles")))

    @SAYS_WHAT_IS_FREE
    def test_what_cannot_be_tiled_is_refused_beyond_what_is_free(self):
        count, limit = FEWER
        write_points(self.path("fewer.ply"), sphere(count))
        little = self.with_free(int(limit[:-1]))
        for arguments in (["orient", "fewer.ply", "out.xyz"], ["orient", "fewer.ply", "out.ply", "--also", "out.las"],
                          ["orient", "fewer.ply", "out.ply", "--tolerance", "1e-3"], ["fewer.ply", "out.obj"], ["fewer.ply", "out.ply", "--open"]):
            with self.subTest(arguments=arguments):
                refused = self.expect(UNAVAILABLE, *arguments, **little)
                self.assertIn("the plan needs", refused.err)
                self.assertIn("tiles take any size, but need a .ply", refused.err)
        refused = self.expect(UNAVAILABLE, "fewer.ply", "out.ply", **little)
        self.assertIn("three quarters of the free memory", refused.err)
        self.assertIn("tiles of this cloud need", refused.err)
        self.assertIn("%d MiB, three quarters of what is free; raise the limit" % (int(limit[:-1]) * 3 / 4), refused.err)
        self.assertEqual(sorted(os.listdir(self.folder)), ["fewer.ply", "in.ply"])

    @SAYS_WHAT_IS_FREE
    def test_what_fits_what_is_free_and_no_tiles_is_done_in_one_piece(self):
        self.expect(OK, "orient", "in.ply", "out.ply", "--report", "r.json")
        plan = self.json_of("r.json")["planned_memory_bytes"] / MEBIBYTE
        arguments = ["orient", "in.ply", "out.ply"]
        for share in 1.2, 1.4:
            self.assertNotIn("tiles", self.expect(OK, *arguments, **self.with_free(share * plan)).err)
        refused = self.expect(UNAVAILABLE, *arguments, **self.with_free(0.9 * plan)).err
        self.assertIn("the plan needs", refused)
        self.assertNotIn("tiles", refused)
        count, limit = FEWER
        write_points(self.path("fewer.ply"), sphere(count))
        said = self.expect(OK, "orient", "fewer.ply", "out.ply", **self.with_free(1.1 * int(limit[:-1]))).err
        self.assertIn("no tiles (tiles of this cloud need", said)
        self.assertIn("in one piece it fits what is free", said)
        self.assertEqual(sorted(os.listdir(self.folder)), ["fewer.ply", "in.ply", "out.ply", "r.json"])

    def test_what_was_begun_when_less_was_free_is_removed(self):
        os.mkdir(self.path("out.ply.tiles"))
        for name in "points-1.bin", "run-3.bin":
            shutil.copy(self.path("in.ply"), self.path("out.ply.tiles/" + name))
        self.expect(OK, "orient", "in.ply", "out.ply")
        self.assertEqual(sorted(os.listdir(self.folder)), ["in.ply", "out.ply"])

    @SAYS_WHAT_IS_FREE
    def test_the_limit_of_what_is_free_is_told(self):
        plan = json.loads(self.expect(OK, "info", "in.ply", "--report", "-").out)["planned_memory_bytes"] / MEBIBYTE
        self.assertNotIn("free", self.expect(OK, "info", "in.ply", **self.with_free(1.4 * plan)).err)
        for share, end in (1.2, "in one piece where it cannot"), (0.9, "refuses where it cannot"):
            said = self.expect(OK, "info", "in.ply", **self.with_free(share * plan)).err
            self.assertIn("three quarters of what is free: g3r works in tiles where it can", said)
            self.assertIn(end, said)
        said = self.expect(OK, "tiles", "plan", "in.ply", "work", "--tiles", "2", **self.with_free(400)).err
        self.assertIn("the limit is three quarters of the free memory, 300 MiB, when it was planned; --max-memory %d" % (300 * MEBIBYTE), said)


if __name__ == "__main__":
    sys.exit(unittest.main())
