"""Truths about options of the g3r program: each does what its line of docs/cli.md says.

Run by ctest with G3R_PROGRAM set to the program.
"""

import math
import struct
import sys
import unittest

from cli_support import *


class Options(ProgramTest):
    def setUp(self):
        super().setUp()
        write_points(self.path("ball.ply"), sphere(300))

    def report(self, *arguments):
        self.expect(OK, *arguments, "--report", "r.json")
        return self.json_of("r.json")

    def test_options_of_the_method_are_taken(self):
        for options, expected in ((["--degree", "1"], {"name": "green", "harmonics": "degree:0-1"}),
                                  (["--harmonics", "1,x,y,z"], {"name": "green", "harmonics": "1,x,y,z"}),
                                  (["--preset", "paper", "--solver", "cg"], {"name": "green", "preset": "paper", "solver": "cg"}),
                                  (["--method", "green", "--solver", "dense"], {"solver": "dense", "condition_number": None}),
                                  (["--tolerance", "0.01"], {"tolerance": 0.01})):
            method = self.report("orient", "ball.ply", "out.ply", *options)["method"]
            self.assertEqual({key: method[key] for key in expected}, expected)
        write_points(self.path("few.ply"), sphere(60))
        dense = ["orient", "few.ply", "out.ply", "--method", "green", "--solver", "dense", "--condition-number"]
        self.assertGreater(self.report(*dense)["method"]["condition_number"], 1)

    def test_widths_of_wnnc_are_taken(self):
        wnnc = ["orient", "ball.ply", "out.ply", "--method", "wnnc"]
        width = {name: self.report(*wnnc, "--wnnc-widths", name)["scales"]["epsilon"] for name in ("density", "clean", "noise-1")}
        self.assertEqual(len(set(width.values())), 3)
        self.assertEqual(self.report(*wnnc)["scales"]["epsilon"], width["density"])

    def test_options_of_the_mesh_are_taken(self):
        write_points(self.path("two.ply"), sphere(600) + sphere(200, 0.4, (3, 0, 0)))
        self.expect(OK, "two.ply", "mesh.ply", "--oriented", "oriented.ply")
        for command in (["two.ply", "out.ply"], ["mesh", "oriented.ply", "out.ply"]):
            for options, components in (([], 2), (["--keep-largest", "1"], 1), (["--keep-largest", "2"], 2), (["--min-component", "400"], 1),
                                        (["--min-component", "0"], 2)):
                self.assertEqual(self.report(*command, *options)["mesh"]["components"], components, options)
            self.assertAlmostEqual(self.report(*command, "--faces", "300")["mesh"]["faces"], 300, delta=10)
            deep = self.report(*command, "--depth", "6")
            self.assertEqual(deep["scales"]["depth"], 6)
            self.assertGreater(deep["mesh"]["faces"], 3 * self.report(*command, "--depth", "5")["mesh"]["faces"])

    def test_surface_farther_than_the_distance_is_trimmed(self):
        write_points(self.path("bowl.ply"), [p for p in sphere(1000) if p[2] < 0.5])
        area = [self.report("bowl.ply", "out.ply", "--trim", distance)["mesh"]["area"] for distance in ("0.2", "0.5", "5", "off")]
        self.assertLess(area[0], area[1])
        self.assertLess(area[1], area[2])
        self.assertEqual(area[2], area[3])

    def test_text_is_written_on_request(self):
        for name in ("mesh.ply", "mesh.stl"):
            self.expect(OK, "ball.ply", name, "--ascii")
        for name in ("points.ply", "points.pcd"):
            self.expect(OK, "orient", "ball.ply", name, "--ascii")
        for name, head in (("mesh.ply", b"ply\nformat ascii 1.0\n"), ("points.ply", b"ply\nformat ascii 1.0\n"), ("mesh.stl", b"solid")):
            self.assertTrue(self.bytes_of(name).startswith(head), name)
            self.bytes_of(name).decode("ascii")
        self.assertIn(b"DATA ascii\n", self.bytes_of("points.pcd"))
        self.expect(OK, "sample", "mesh.ply", "sampled.ply", "--count", "10", "--ascii")
        self.assertEqual(len(self.bytes_of("sampled.ply").partition(b"end_header\n")[2].splitlines()), 10)

    def test_the_confidence_has_the_name_of_cloud_compare_on_request(self):
        for options, name in (([], "confidence"), (["--cloud-compare-names"], "scalar_confidence")):
            self.expect(OK, "orient", "ball.ply", "out.ply", *options)
            self.assertEqual([p for p in read_ply(self.bytes_of("out.ply"))[0] if "confidence" in p], [name])

    def test_points_outside_the_box_are_left_out(self):
        self.expect(OK, "orient", "ball.ply", "out.ply", "--box", "-2,-2,-2,2,2,0")
        rows = read_ply(self.bytes_of("out.ply"))[1]
        self.assertEqual([(row["x"], row["y"], row["z"]) for row in rows], [p for p in sphere(300) if p[2] <= 0])

    def test_splats_below_the_opacity_are_left_out(self):
        names = "x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3".split()
        opacities = [0.05, 0.2, 0.4, 0.6]
        write_ply(self.path("splats.ply"), [("float", name) for name in names],
                  [(*p, 0, 0, 0, math.log(a / (1 - a)), -9, -9, -9, 1, 0, 0, 0) for p in sphere(200) for a in opacities])
        for options, kept in (([], 3), (["--min-opacity", "0.5"], 1), (["--min-opacity", "0.3"], 2), (["--min-opacity", "0"], 4)):
            self.assertEqual(self.report("info", "splats.ply", *options)["input"]["points"], 200 * kept, options)

    def test_more_is_said_on_request(self):
        few = self.expect(OK, "orient", "ball.ply", "out.ply").err.splitlines()
        for flag in ("-v", "--verbose"):
            many = self.expect(OK, "orient", "ball.ply", "out.ply", flag).err
            self.assertGreater(len(many.splitlines()), len(few))
            self.assertIn("residual", many)
            self.assertIn("method   energy", many)

    def test_info_warns_of_more_memory_than_there_may_be(self):
        self.assertIn("more than the 1 MiB of --max-memory", self.expect(OK, "info", "ball.ply", "--max-memory", "1M").err)
        self.assertNotIn("--max-memory", self.expect(OK, "info", "ball.ply", "--max-memory", "8G").err)

    def test_pictures_have_the_views_that_are_asked_for(self):
        for views, size in (("1", (64, 64)), ("2", (128, 64)), ("4", (128, 128))):
            self.expect(OK, "view", "ball.ply", "-o", "look.png", "--tile", "64", "--views", views)
            self.assertEqual(struct.unpack(">II", self.bytes_of("look.png")[16:24]), size, views)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
