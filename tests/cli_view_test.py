"""Truths about g3r view. Run by ctest with G3R_PROGRAM set to the program."""

import json
import re
import struct
import unittest

from cli_support import *

TETRAHEDRON = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"


class View(ProgramTest):
    def setUp(self):
        super().setUp()
        write_points(self.path("ball.ply"), sphere(300))
        with open(self.path("solid.off"), "w") as file:
            file.write(TETRAHEDRON)

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def data(self, page):
        return json.loads(re.search(rb'id="scene-data">(.*?)</script>', page, re.S).group(1))

    def test_a_cloud_and_a_mesh_make_one_page(self):
        self.expect(OK, "view", "ball.ply", "solid.off", "-o", "look.html", "--z-up")
        data = self.data(self.read("look.html"))
        self.assertEqual((data["points"]["given"], data["mesh"]["given"], data["up"]), (300, 4, "z"))
        self.assertEqual(data["title"], "ball.ply, solid.off")

    def test_a_mesh_comes_back_from_every_format_that_is_written(self):
        self.expect(OK, "ball.ply", "ball.stl", *[word for name in ("ply", "obj", "off", "glb") for word in ("--also", f"mesh.{name}")])
        pages = [self.expect(OK, "view", name, "-o", "-").out for name in ("ball.stl", "mesh.ply", "mesh.obj", "mesh.off", "mesh.glb")]
        self.assertEqual(len({self.data(page)["mesh"]["given"] for page in pages}), 1)
        self.assertEqual({self.data(page)["points"]["given"] for page in pages}, {0})
        self.assertIn(b"closed, manifold", self.expect(OK, "info", "mesh.glb").out)
        self.assertEqual(json.loads(self.expect(OK, "eval", "mesh.glb", "--truth", "mesh.ply", "--samples", "100").out)["kind"], "mesh")

    def test_oriented_points_and_the_report_are_shown(self):
        self.expect(OK, "orient", "ball.ply", "oriented.ply", "--report", "run.json")
        page = self.expect(OK, "view", "oriented.ply", "--truth", "oriented.ply", "--figures", "run.json", "-o", "-").out
        data = self.data(page)
        self.assertIn("normal", data["points"])
        self.assertIn("confidence", data["points"])
        self.assertEqual(data["truth"]["wrong_side"], 0)
        self.assertEqual(data["report"]["input"]["points"], 300)

    def test_a_picture_has_the_size_asked_for(self):
        self.expect(OK, "view", "solid.off", "-o", "look.png", "--tile", "64", "--dark")
        self.assertEqual(struct.unpack(">II", self.read("look.png")[16:24]), (128, 128))
        self.expect(OK, "view", "ball.ply", "solid.off", "-o", "rows.png", "--tile", "32", "--layers", "points,mesh")
        self.assertEqual(struct.unpack(">II", self.read("rows.png")[16:24]), (128, 64))

    def test_what_is_odd_in_a_file_is_told(self):
        with open(self.path("bad.off"), "w") as file:
            file.write(TETRAHEDRON.replace("3 1 2 3", "3 1 2 7"))
        self.assertIn("out of range", self.expect(OK, "view", "bad.off", "-o", "look.html").err)
        self.assertIn("levels", self.expect(OK, "view", "ball.ply", "--levels", "2", "-o", "look.html").err)
        self.assertEqual(self.expect(OK, "view", "ball.ply", "-o", "look.html").err.count("warning"), 0)

    def test_figures_are_a_file(self):
        os.mkdir(self.path("folder"))
        self.assertIn("--figures", self.expect(NO_INPUT, "view", "ball.ply", "--figures", "folder", "-o", "look.html").err)
        self.assertFalse(os.path.exists(self.path("look.html")))

    def test_figures_are_a_report_of_g3r(self):
        for text in ('{"warnings": []}', "[]", "[" * 1_000_000, '{"schema": "g3r.report", "a": ' + "[" * 1_000_000 + "]" * 1_000_000 + "}"):
            with open(self.path("other.json"), "w") as file:
                file.write(text)
            self.assertIn("report", self.expect(BAD_DATA, "view", "ball.ply", "--figures", "other.json", "-o", "look.html").err)
            self.assertFalse(os.path.exists(self.path("look.html")))

    def test_a_mesh_too_large_for_a_page_is_told(self):
        count = 3_000_001
        header = f"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" \
                 f"element face {count}\nproperty list uchar int vertex_indices\nend_header\n"
        with open(self.path("large.ply"), "wb") as file:
            file.write(header.encode() + struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0) + struct.pack("<B3i", 3, 0, 1, 2) * count)
        self.assertIn("3,000,001 triangles", self.expect(OK, "view", "large.ply", "-o", "look.html").err)
        mesh = self.data(self.read("look.html"))["mesh"]
        self.assertEqual((mesh["given"], mesh["shown"]), (count, 0))

    def test_wrong_requests_are_refused_before_any_work(self):
        self.expect(USAGE, "view", "ball.ply")
        self.expect(USAGE, "view", "ball.ply", "-o", "look.gif")
        self.expect(USAGE, "view", "ball.ply", "-o", "look.png", "--layers", "magic")
        self.expect(USAGE, "view", "ball.ply", "ball.ply", "-o", "look.html")
        self.expect(NO_INPUT, "view", "nosuch.ply", "-o", "look.html")
        self.expect(CANNOT_CREATE, "view", "ball.ply", "-o", "no/folder/look.html")
        self.expect(BAD_DATA, "view", "ball.ply", "-o", "look.png", "--layers", "mesh")
        self.expect(BAD_DATA, "view", "ball.ply", "--truth", "ball.ply", "-o", "look.html")


if __name__ == "__main__":
    unittest.main()
