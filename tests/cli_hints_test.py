"""Truths about hints on the command line: --up, --sensor, --inside.

Run by ctest with G3R_PROGRAM set to the program.
"""

import math
import random
import sys
import unittest

from cli_support import *


class Hints(ProgramTest):
    def facing(self, name, place):
        """Share of the points of a file that face a place."""
        rows = read_ply(self.bytes_of(name))[1]
        return sum(sum(r["n" + a] * (c - r[a]) for a, c in zip("xyz", place)) > 0 for r in rows) / len(rows)

    def room(self):
        """Walls, floor and ceiling of 4 x 3 x 2 at the origin, as a scanner inside sees them."""
        random_ = random.Random(7)
        points = []
        for axis, area in ((0, 6), (1, 8), (2, 12)):
            for side in (0, 1):
                for _ in range(thinned(60) * area):
                    p = [4 * random_.random(), 3 * random_.random(), 2 * random_.random()]
                    p[axis] = side * (4, 3, 2)[axis]
                    points.append(p)
        return points

    def depth_frame(self, jitter=0):
        """A ball before a wall as a camera at the origin sees them: one open surface on the other, with a gap in depth between them. With
        a jitter, of pixels, no rows and columns show where it stood."""
        random_ = random.Random(3)
        points = []
        step = 2 if is_sanitized() else 1
        for u in range(-40, 41, step):
            for v in range(-30, 31, step):
                ray = ((u + jitter * random_.uniform(-1, 1)) / 66, (v + jitter * random_.uniform(-1, 1)) / 66, 1.0)
                a, b = sum(c * c for c in ray), 2 * ray[2]
                discriminant = b * b - a * (4 - 0.16)
                depth = (b - math.sqrt(discriminant)) / a if discriminant > 0 else 3.0
                points.append([depth * c for c in ray])
        return points

    def test_a_depth_frame_faces_its_camera(self):
        write_points(self.path("frame.ply"), self.depth_frame())
        self.expect(OK, "orient", "frame.ply", "out.ply", "--sensor", "0,0,0", "--report", "r.json")
        self.assertGreaterEqual(self.facing("out.ply", (0, 0, 0)), 0.995)
        hints = self.json_of("r.json")["hints"]
        self.assertEqual((hints["given"], hints["viewpoint"]), (["sensor"], [0, 0, 0]))
        self.assertGreater(hints["turned_share"], 0.5)
        self.assertIn("as the rows of pixels show", self.expect(OK, "orient", "frame.ply", "out.ply", "--strict").err)
        self.assertNotIn("rows of pixels", self.expect(OK, "orient", "frame.ply", "out.ply", "--sensor", "0,0,0").err)
        self.expect(OK, "orient", "frame.ply", "out.ply", "--sensor", "0,0,0", "--flip")
        self.assertLessEqual(self.facing("out.ply", (0, 0, 0)), 0.005)

    def test_half_of_a_ball_is_a_choice_until_a_hint_decides(self):
        random_ = random.Random(7)
        ball = []
        for _ in range(thinned(2000)):
            z, turn = -random_.random(), 2 * math.pi * random_.random()
            ball.append((math.sqrt(1 - z * z) * math.cos(turn), math.sqrt(1 - z * z) * math.sin(turn), z))
        write_points(self.path("half.ply"), ball)
        said = self.expect(BAD_DATA, "orient", "half.ply", "out.ply", "--strict").err
        self.assertIn("is a choice: the one that bends outward where one does, else faces up", said)
        self.assertGreater(self.facing("out.ply", (0, 0, -9)), 0.5)
        for place, hint in (((0, 0, -99), ("--sensor", "0,0,-99")), ((0, 0, 0), ("--seen-from-inside",))):
            self.expect(OK, "orient", "half.ply", "out.ply", "--strict", *hint)
            self.assertGreater(self.facing("out.ply", place), 0.97)

    def test_terrain_faces_up_whatever_up_is(self):
        random_ = random.Random(5)
        plan = [(2 * random_.random() - 1, 2 * random_.random() - 1) for _ in range(thinned(2000))]
        write_points(self.path("terrain.ply"), [(x, y, 0.1 * math.sin(4 * x) * math.cos(3 * y)) for x, y in plan])
        self.assertIn("is a choice: the one that faces up", self.expect(OK, "orient", "terrain.ply", "out.ply").err)
        self.assertIn("is a choice: the one that faces down", self.expect(OK, "orient", "terrain.ply", "out.ply", "--flip").err)
        said = self.expect(OK, "orient", "terrain.ply", "out.ply", "--schedule", "1 cg", "--report", "r.json").err
        self.assertGreater(self.json_of("r.json")["iterations"][-1]["residual"], 0.1)
        self.assertIn("which open surfaces do not depend on", said)
        self.assertNotIn("converged", said)
        ups = (("0.1,0,-3", (0, 0, -9)), ("+z", (0, 0, 9)), ("-z", (0, 0, -9)))
        for up, place in ups[:1] if is_sanitized() else ups:
            result = self.expect(OK, "orient", "terrain.ply", "out.ply", "--up", up, "--report", "r.json", "--strict")
            self.assertEqual(self.facing("out.ply", place), 1)
            self.assertNotIn("is a choice", result.err)
            report = self.json_of("r.json")
            self.assertEqual((report["undecided_share"], report["hints"]["settled_share"], report["consistent"]), (0, 1, True))
            self.assertGreater(report["confidence"]["mean"], 0.99)

    def test_a_room_faces_its_scanner(self):
        write_points(self.path("room.ply"), self.room())
        self.expect(OK, "orient", "room.ply", "out.ply")
        self.assertLess(self.facing("out.ply", (2, 1.5, 1)), 0.01)
        hints = (["--sensor", "1,1,1", "--sensor", "3,2,1"], ["--flip"], ["--seen-from-inside"], ["--sensor", "1,1,1.5"])
        for hint in hints[:1] if is_sanitized() else hints:
            result = self.expect(OK, "room.ply", "mesh.ply", "--oriented", "out.ply", "--report", "r.json", *hint)
            self.assertGreaterEqual(self.facing("out.ply", (2, 1.5, 1)), 0.995, hint)
            report = self.json_of("r.json")
            self.assertEqual(report["hints"]["turned_share"], 1)
            self.assertTrue(report["mesh"]["closed"])
            self.assertAlmostEqual(report["mesh"]["volume"], -24, delta=1)
            self.assertEqual("faced away" in result.err, "--sensor" in hint)
            self.expect(OK, "mesh", "out.ply", "mesh.ply", "--report", "r.json")
            self.assertAlmostEqual(self.json_of("r.json")["mesh"]["volume"], -24, delta=1)

    def test_a_contradiction_is_told_and_turns_nothing(self):
        write_points(self.path("ball.ply"), sphere(1000))
        result = self.expect(OK, "orient", "ball.ply", "out.ply", "--inside", "0,0,-3", "--up", "x")
        self.assertIn("hint inside: 0,0,-3 is not inside", result.err)
        self.assertIn("hint up: it decides nothing", result.err)
        self.assertEqual(self.facing("out.ply", (0, 0, 0)), 0)
        self.assertNotIn("hint", self.expect(OK, "orient", "ball.ply", "out.ply", "--inside", "0,0,0.5", "--sensor", "0,0,5").err)

    def test_the_file_may_say_where_the_scanner_stood(self):
        points = self.depth_frame(jitter=0.05)
        header = ("VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH %d\nHEIGHT 1\nVIEWPOINT 1 2 3 1 0 0 0\n"
                  "POINTS %d\nDATA ascii\n" % (len(points), len(points)))
        with open(self.path("frame.pcd"), "w") as file:
            file.write(header + "".join("%r %r %r\n" % (x + 1, y + 2, z + 3) for x, y, z in points))
        self.assertIn("1 scanner position: with --sensor file", self.expect(OK, "orient", "frame.pcd", "out.ply").err)
        self.assertNotIn("--sensor file", self.expect(OK, "orient", "frame.pcd", "out.ply", "--sensor", "file").err)
        self.assertGreaterEqual(self.facing("out.ply", (1, 2, 3)), 0.995)
        self.assertNotIn("--sensor file", self.expect(OK, "orient", "frame.pcd", "out.ply", "--up", "0,0,-1").err)
        header = header.replace("%d" % len(points), "%d" % len(self.room())).replace("1 2 3 1", "2 1.5 1 1")
        with open(self.path("room.pcd"), "w") as file:
            file.write(header + "".join("%r %r %r\n" % tuple(p) for p in self.room()))
        self.assertIn("100 % of the points face away", self.expect(OK, "orient", "room.pcd", "out.ply").err)
        self.assertNotIn("face away,", self.expect(OK, "orient", "room.pcd", "out.ply", "--sensor", "file").err)
        self.assertGreaterEqual(self.facing("out.ply", (2, 1.5, 1)), 0.995)
        write_points(self.path("frame.ply"), points)
        self.assertIn("frame.ply does not say where the scanner stood",
                      self.expect(BAD_DATA, "orient", "frame.ply", "out.ply", "--sensor", "file").err)

    def test_hints_that_cannot_be_meant_are_usage_errors(self):
        write_points(self.path("ball.ply"), sphere(100))
        for hint, words in ((["--up", "w"], "--up: expected X,Y,Z, not all 0, or an axis"), (["--up", "0,0,0"], "not all 0"),
                            (["--up", "1,2"], "--up"),
                            (["--sensor", "here"], "--sensor: expected X,Y,Z, or file"), (["--sensor", "1,2,nan"], "--sensor"),
                            (["--inside", "1,2,3,4"], "--inside: expected X,Y,Z"), (["--sensor", "file", "--sensor", "1,2,3"], "exclude each other")):
            self.assertIn(words, self.expect(USAGE, "orient", "ball.ply", "out.ply", *hint).err)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
