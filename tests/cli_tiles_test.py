"""Truths about g3r tiles, and g3r orient beyond --max-memory: killed at any time it goes on, with the same bytes in the end.

Run by ctest with G3R_PROGRAM set to the program. For measuring, G3R_TILE_KILLS raises the number of kills.
"""

import os
import random
import signal
import sys
import threading
import unittest

from cli_support import *

COUNT = 8200  # few more than tiles take
LARGE_COUNT = 200_000  # of a cloud that fits a limit in tiles and does not in core
FEWER = 100_000, "84M"  # points and a limit of which the same is true, but not of their mesh
KILLS = int(os.environ.get("G3R_TILE_KILLS", "2"))


class Tiles(ProgramTest):
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
        guard = threading.Timer(120, process.kill)
        guard.start()
        stages = []
        for line in process.stderr:
            stages.append(line)
            if b"coarse" in line:
                break
        process.send_signal(signal.SIGINT)
        process.communicate()
        guard.cancel()
        self.assertEqual(process.returncode, INTERRUPTED, stages)
        self.assertIn(b"g3r: sort\n", stages)
        self.assertFalse(os.path.exists(self.path("out.PLY")))
        self.assertTrue(os.path.exists(self.path("out.PLY.tiles/points-1.bin")))

    @unittest.skipUnless(sys.platform.startswith("linux") and not ON_WINDOWS, "names of files are text here")
    def test_names_that_are_no_utf8_are_refused_by_tiles_alone(self):
        name = os.fsdecode(b"in\xff.ply")
        os.rename(self.path("in.ply"), self.path(name))
        self.expect(OK, "orient", name, "out.ply", "--max-memory", "8G")
        self.assertIn("UTF-8", self.expect(BAD_DATA, "orient", name, "out.ply", "--max-memory", "8M").err)

    def test_what_is_refused_before_a_tile_is_solved_leaves_no_plan(self):
        """Another limit would not go on with it."""
        count, limit = FEWER
        write_points(self.path("fewer.ply"), sphere(count))
        self.assertIn("tiles of this mesh need", self.expect(UNAVAILABLE, "fewer.ply", "mesh.ply", "--max-memory", limit).err)
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


if __name__ == "__main__":
    sys.exit(unittest.main())
