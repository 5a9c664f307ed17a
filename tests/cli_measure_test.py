"""Truths about the commands that measure and tell: sample, eval, info.

Run by ctest with G3R_PROGRAM set to the program.
"""

import json
import math
import os
import random
import sys
import unittest

from cli_support import *


class Measuring(ProgramTest):
    def setUp(self):
        super().setUp()
        write_cube(self.path("cube.obj"), 2.0)

    def test_samples_lie_on_the_mesh_and_follow_the_seed(self):
        self.expect(OK, "sample", "cube.obj", "a.ply", "--count", "1000", "--seed", "7")
        self.expect(OK, "sample", "cube.obj", "b.ply", "--count", "1000", "--seed", "7")
        self.expect(OK, "sample", "cube.obj", "c.ply", "--count", "1000", "--seed", "8")
        self.assertTrue(self.bytes_of("a.ply") == self.bytes_of("b.ply"))
        self.assertTrue(self.bytes_of("a.ply") != self.bytes_of("c.ply"))
        _, rows = read_ply(self.bytes_of("a.ply"))
        self.assertEqual(len(rows), 1000)
        for row in rows:
            self.assertLess(min(min(abs(row[a]), abs(row[a] - 2)) for a in "xyz"), 1e-6)
            self.assertAlmostEqual(abs(row["nx"]) + abs(row["ny"]) + abs(row["nz"]), 1, delta=1e-6)

    def test_noise_is_a_length_or_a_share_of_the_diagonal(self):
        self.expect(OK, "sample", "cube.obj", "a.xyz", "--count", "100", "--noise", "1%")
        self.expect(OK, "sample", "cube.obj", "b.xyz", "--count", "100", "--noise", repr(0.01 * math.sqrt(12)))
        a, b = ([float(word) for line in self.bytes_of(name).splitlines() if not line.startswith(b"//") for word in line.split()]
                for name in ("a.xyz", "b.xyz"))
        self.assertLess(max(abs(x - y) for x, y in zip(a, b)), 1e-9)
        with open(self.path("cube.obj")) as file:
            cube = file.read().replace("f 1 2", "v 1000 0 0\nf 1 2", 1)
        with open(self.path("unused.obj"), "w") as file:
            file.write(cube)
        self.expect(OK, "sample", "unused.obj", "c.xyz", "--count", "100", "--noise", "1%")
        self.assertEqual(self.bytes_of("c.xyz"), self.bytes_of("a.xyz"))
        for wrong in ("-1%", "2h", "auto"):
            self.expect(USAGE, "sample", "cube.obj", "c.xyz", "--count", "100", "--noise", wrong)

    def test_the_truth_scores_perfectly(self):
        self.expect(OK, "sample", "cube.obj", "a.ply", "--count", "500")
        score = json.loads(self.expect(OK, "eval", "a.ply", "--truth", "a.ply").out)
        self.assertEqual((score["kind"], score["points"], score["pco"]), ("points", 500, 1))
        self.assertAlmostEqual(score["ae_p"], 0, delta=1e-12)
        self.assertEqual((score["pgp5"], score["pgp10"]), (1, 1))
        self.assertLess(max(score["rmse"], score["rmse_unoriented"]), 1e-5)
        score = json.loads(self.expect(OK, "eval", "cube.obj", "--truth", "cube.obj", "--samples", "2000").out)
        self.assertEqual((score["kind"], score["samples"]), ("mesh", 2000))
        for name in ("cd", "ae_m", "hd"):
            self.assertAlmostEqual(score[name], 0, delta=1e-6)
        self.assertAlmostEqual(score["normal_consistency"], 1, delta=1e-3)  # samples on edges may find either side
        self.assertEqual(score["f_scores"], [])
        score = json.loads(self.expect(OK, "eval", "cube.obj", "--truth", "cube.obj", "--distances", "0.01,1e-3", "--samples", "2000").out)
        self.assertEqual(score["f_scores"], [{"distance": d, "precision": 1, "recall": 1, "f": 1} for d in (0.01, 0.001)])
        self.expect(USAGE, "eval", "cube.obj", "--truth", "cube.obj", "--distances", "0")
        for pair in (["cube.obj", "--truth", "a.ply"], ["a.ply", "--truth", "cube.obj"]):
            self.assertIn("g3r: cube.obj is a mesh, and no faces were read from a.ply", self.expect(BAD_DATA, "eval", *pair).err)

    def test_standard_input_is_read_like_a_file(self):
        cube = self.bytes_of("cube.obj")
        of_file = self.expect(OK, "info", "cube.obj").out.decode().splitlines()
        of_input = self.expect(OK, "info", "-", data=cube).out.decode().splitlines()
        self.assertEqual(of_input[0], "standard input")
        self.assertEqual(of_input[1:], of_file[1:])
        self.assertTrue(any(line.startswith("  mesh ") for line in of_file))
        score = json.loads(self.expect(OK, "eval", "-", "--truth", "cube.obj", "--samples", "100", data=cube).out)
        self.assertEqual(score["kind"], "mesh")
        self.expect(OK, "sample", "cube.obj", "a.ply", "--count", "500")
        score = json.loads(self.expect(OK, "eval", "a.ply", "--truth", "-", data=self.bytes_of("a.ply")).out)
        self.assertEqual((score["kind"], score["pco"]), ("points", 1))
        self.assertEqual(self.expect(OK, "view", "-", "-o", "-", data=cube).out.replace(b"standard input", b"cube.obj"),
                         self.expect(OK, "view", "cube.obj", "-o", "-").out)

    def test_why_a_mesh_is_refused_is_told(self):
        with open(self.path("bad.off"), "w") as file:
            file.write("OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 7\n")
        for pair in (["bad.off", "--truth", "cube.obj"], ["cube.obj", "--truth", "bad.off"]):
            self.assertIn("bad.off: face 1: face index out of range", self.expect(BAD_DATA, "eval", *pair).err)
        self.assertIn("face index out of range", self.expect(OK, "info", "bad.off").err)
        self.assertIn("neither faces", self.expect(BAD_DATA, "eval", "bad.off", "--truth", "bad.off").err)

    def test_another_order_is_told_also_far_from_the_origin(self):
        def write(name, rows, offset):
            with open(self.path(name), "w") as file:
                file.writelines(" ".join(repr(x + o) for x, o in zip(p, offset)) + " 0 0 1\n" for p in rows)

        rows = [(20.0 * (i % 3), 20.0 * (i // 3 % 3), 10.0 * (i // 9)) for i in range(27)]
        for offset in ((0, 0, 0), (500000, 5200000, 300)):
            write("truth.xyz", rows, offset)
            write("turned.xyz", rows[::-1], offset)
            write("rounded.xyz", [[x + 0.04 * (offset[1] > 0) for x in p] for p in rows], offset)  # as float rounds 5,200,000
            said = "is not where the truth has it"
            self.assertIn(said, self.expect(OK, "eval", "turned.xyz", "--truth", "truth.xyz").err)
            self.assertNotIn(said, self.expect(OK, "eval", "rounded.xyz", "--truth", "truth.xyz").err)

    def test_folders_patterns_and_boxes(self):
        os.mkdir(self.path("tiles"))
        write_xyz(self.path("tiles/a.xyz"), [(x, y, 0) for x in range(3) for y in range(3)])
        write_xyz(self.path("tiles/b.xyz"), [(x, y, 1) for x in range(3) for y in range(3)])
        for name in ("tiles", "tiles/", "tiles/*.xyz"):
            text = self.expect(OK, "info", name).out.decode()
            self.assertIn("2 files of xyz", text)
            self.assertIn("18", text)
        with open(self.path("both.list"), "w") as file:
            file.write("tiles/a.xyz\ntiles/b.xyz\n")
        result = self.expect(OK, "info", "both.list")
        self.assertIn("2 files of xyz", result.out.decode())
        self.assertNotIn("no mesh", result.err)
        text = self.expect(OK, "info", "tiles", "--box", "-1,-1,-1,1,9,0.5").out.decode()
        self.assertIn("x 0 to 1, y 0 to 2, z 0 to 0", text)
        self.expect(BAD_DATA, "info", "tiles", "--box", "5,5,5,6,6,6")
        self.assertIn("all of its points are read", self.expect(OK, "info", "tiles/a.xyz", "--levels", "2").err)
        self.expect(USAGE, "info", "tiles", "--box", "1,2,3")
        self.expect(USAGE, "tiles/*.xyz")
        self.expect(NO_INPUT, "info", "tiles/*.ply")

    def test_splats_that_are_no_surface_are_left_out_unless_all_are_wanted(self):
        names = "x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3".split()
        corners = [(i % 2 * 9, i // 2 % 2 * 9, i // 4 * 9, 4 if i < 7 else -1) for i in range(8)]  # opacities 0.98, and 0.27 of the last
        with open(self.path("splats.ply"), "w", encoding="ascii") as file:
            file.write("ply\nformat ascii 1.0\nelement vertex 8\n" + "".join(f"property float {name}\n" for name in names) + "end_header\n")
            file.writelines(f"{x} {y} {z} 0 0 0 {opacity} 0 0 0 1 0 0 0\n" for x, y, z, opacity in corners)
        some = self.expect(OK, "info", "splats.ply")
        self.assertRegex(some.out.decode(), "points +7\n")
        self.assertIn("1 of 8 splats are left out: 1 where most of the light passes (floaters); --all-splats keeps them", some.err)
        everything = self.expect(OK, "info", "splats.ply", "--all-splats")
        self.assertRegex(everything.out.decode(), "points +8\n")
        self.assertNotIn("left out", everything.err)

    def test_info_says_what_is_in_a_file(self):
        text = self.expect(OK, "info", "cube.obj").out.decode()
        for words in ("cube.obj", "8", "12 triangles", "closed", "genus 0", "no triangles intersect", "smallest 45 degrees", "x 0 to 2"):
            self.assertIn(words, text)
        chance = random.Random(1)
        write_xyz(self.path("noisy.xyz"), [[c * chance.gauss(1, 0.02) for c in p] for p in sphere(2000)])
        self.assertRegex(self.expect(OK, "info", "noisy.xyz").out.decode(), r"noise +0\.0\d+ \(0\.\d+ spacings\)")
        write_xyz(self.path("two.xyz"), [(0, 0, 0), (1, 1, 1)])
        result = self.expect(OK, "info", "two.xyz")
        self.assertIn("warning", result.err)
        pose = "5 6 7.5\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n5 6 7.5 1\n"
        scan = "1\n4\n" + pose + "".join(f"{x} {y} 0 0.5\n" for x, y in ((1, 0), (2, 0), (1, 1), (2, 1)))
        with open(self.path("scan.ptx"), "w") as file:
            file.write(scan)
        self.assertIn("scanner    at 5, 6, 7.5, as the file says", self.expect(OK, "info", "scan.ptx").out.decode())
        with open(self.path("scan.ptx"), "w") as file:
            file.write(scan + scan)
        self.assertIn("scanner    2 positions in the file", self.expect(OK, "info", "scan.ptx").out.decode())


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
