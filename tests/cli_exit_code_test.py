"""Truths about the exit codes of the g3r program, and what it says with them.

Run by ctest with G3R_PROGRAM set to the program.
"""

import os
import random
import resource
import shutil
import subprocess
import sys
import unittest

from cli_support import *


class ExitCodes(ProgramTest):
    def setUp(self):
        super().setUp()
        write_points(self.path("ball.ply"), sphere(300))

    def test_help_and_version_are_data(self):
        for flag in ("--help", "-h", "--version"):
            result = self.expect(OK, flag)
            self.assertIn(b"g3r", result.out)
            self.assertEqual(result.err, "")
        for command in ("orient", "mesh", "eval", "sample", "info"):
            self.assertIn(command.encode(), self.expect(OK, command, "--help").out)

    def test_version_tells_what_the_build_has(self):
        lines = self.expect(OK, "--version").out.decode().splitlines()
        self.assertRegex(lines[0], r"^g3r \d+\.\d+\.\d+$")
        self.assertEqual([line.split(":")[0] for line in lines[1:]], ["optional parts", "instruction set", "interfaces to GPUs"])
        self.assertRegex(lines[2], r"^instruction set: [A-Z]\w+$")
        if not self.expect(OK, "--device", "list").out.startswith(b"no device"):
            self.assertRegex(lines[3], "OpenCL|CUDA")

    def test_help_lists_every_exit_code(self):
        text = self.expect(OK, "--help").out.decode()
        for code in (64, 65, 66, 69, 70, 71, 73, 74, 130, 143):
            self.assertIn(str(code), text)

    def test_help_fits_a_terminal(self):
        for command in ([], ["orient"], ["mesh"], ["eval"], ["sample"], ["info"], ["view"]):
            with self.subTest(command):
                text = self.expect(OK, *command, "--help").out.decode()
                self.assertLessEqual(max(map(len, text.splitlines())), 80)
                self.assertNotIn("\n\n\n", text)
        self.assertIn("Usage: g3r view IN... --out OUT [options]\n", self.expect(OK, "view", "--help").out.decode())
        self.assertIn("Usage: g3r [IN] [OUT] [options]\n", self.expect(OK, "--help").out.decode())

    def test_common_mistakes_are_named(self):
        os.mkdir(self.path("folder"))
        for name, text in (("empty.ply", ""), ("flat.xyz", "0 1\n" * 9), ("nan.xyz", "nan nan nan\n" * 9), ("three.xyz", "0 0 0\n1 0 0\n0 1 0\n"),
                           ("none.obj", "f 1 2 3\n"), ("comma.csv", "0,5;1,5;2,5\n" * 9)):
            with open(self.path(name), "w", encoding="ascii") as file:
                file.write(text)
        for code, arguments, words in (
                (NO_INPUT, ["no.ply"], "cannot read no.ply: No such file"), (NO_INPUT, ["folder"], "folder: a folder without files of points"),
                (BAD_DATA, ["empty.ply"], "empty.ply: empty file"), (BAD_DATA, ["none.obj"], "none.obj: no points"),
                (BAD_DATA, ["flat.xyz"], "flat.xyz: line 1: expected at least three columns (x y z), found 2"),
                (BAD_DATA, ["nan.xyz"], "nan.xyz: too few points: 0 of 9 are finite"), (BAD_DATA, ["three.xyz"], "too few points: 3 of 3"),
                (BAD_DATA, ["comma.csv"], "a decimal comma?"), (CANNOT_CREATE, ["ball.ply", "no/a.ply"], "no/a.ply: cannot create: there is no such folder"),
                (USAGE, ["ball.ply", "--epsilon", "wide"], "--epsilon: expected auto, X, X%, Xh or Xn with X > 0, found 'wide'"),
                (USAGE, ["ball.ply", "folder"], "folder: a folder, not a file: expected .ply"),
                (USAGE, ["."], "'.' has no name to derive OUT from: give OUT"), (USAGE, ["../"], "'../' has no name"), (USAGE, ["folder/."], "has no name"),
                (USAGE, ["ball.ply", "--box", "1,0,0,0,1,1"], "--box: expected the low corner first"),
                (USAGE, ["tiles", "plan", "ball.ply"], "1 file: expected g3r tiles plan IN... DIR [options]"),
                (USAGE, ["ball.ply", "a.docx"], 'unknown extension ".docx": expected .ply, .obj'),
                (USAGE, ["ball.ply", "a.xyz"], "a.xyz: .xyz is for points"), (USAGE, ["orient", "ball.ply", "a.stl"], "a.stl: .stl is for meshes"),
                (USAGE, ["oriend", "ball.ply"], "no file and no command named oriend"), (USAGE, ["ball.ply", "--treads", "2"], "unknown option --treads; did you mean --threads?"),
                (USAGE, ["ball.ply", "--seed", "1"], "unknown option --seed"), (USAGE, ["ball.ply", "--bogus"], "unknown option --bogus (see"), (USAGE, ["ball.ply", "-o", "a.ply"], "the output stands after the input"),
                (USAGE, ["oreint", "ball.ply", "a.ply"], "did you mean orient?"), (USAGE, ["ball.ply", "--open", "--trim", "3"], "excludes --open"),
                (USAGE, ["ball.ply", "--faces", "-5"], "--faces: expected a whole number, 0 or more, found '-5'"),
                (USAGE, ["sample", "a.obj", "b.ply", "--count", "9", "--seed", "9" * 30], "--seed: expected a whole number, 0 or more"),
                (USAGE, ["ball.ply", "--depth", "3"], "--depth: expected a whole number, from 4 to 12, found '3'"),
                (USAGE, ["view", "ball.ply", "-o", "a.html", "--tile", "40"], "--tile is for pictures"),
                (USAGE, ["ball.ply", "a.ply", "b.ply"], "one file too many: b.ply"),
                (BAD_DATA, ["mesh", "ball.ply", "a.ply"], "ball.ply has no normals")):
            with self.subTest(arguments):
                self.assertIn(words, self.expect(code, *arguments).err)

    def test_devices_are_listed_and_missing_ones_are_69(self):
        listed = self.expect(OK, "--device", "list").out.decode()
        self.assertTrue(listed.startswith("gpu:0  ") or listed.startswith("no device: "), listed)
        self.assertIn("there is no device gpu:999", self.expect(UNAVAILABLE, "orient", "ball.ply", "a.ply", "--device", "gpu:999").err)
        self.assertFalse(os.path.exists(self.path("a.ply")))

    def test_wrong_command_lines_are_64(self):
        for arguments in (
                [], ["--bogus", "ball.ply"], ["ball.ply", "a.ply", "b.ply"], ["orient", "ball.ply"], ["eval", "ball.ply"],
                ["sample", "ball.ply", "out.ply"], ["ball.ply", "--threads", "-1"], ["ball.ply", "--threads", "two"],
                ["ball.ply", "--device", "tpu"], ["ball.ply", "--device", "gpu:"], ["ball.ply", "--device", "gpu:-1"],
                ["ball.ply", "--epsilon", "0"], ["ball.ply", "--epsilon", "0.5x"], ["ball.ply", "--epsilon", "nan"],
                ["ball.ply", "--degree", "99"], ["ball.ply", "--depth", "1"], ["ball.ply", "--preset", "best"],
                ["ball.ply", "--solver", "magic"], ["ball.ply", "--schedule", "many"], ["ball.ply", "--harmonics", "x,q"],
                ["ball.ply", "--degree", "2", "--harmonics", "1,x"], ["ball.ply", "--max-memory", "8Q"], ["ball.ply", "--max-memory", "8"], ["ball.ply", "--accuracy", "7"],
                ["ball.ply", "out.docx"], ["orient", "ball.ply", "out.stl"], ["-"], ["ball.ply", "-", "--report", "-"]):
            with self.subTest(arguments):
                self.assertEqual(self.expect(USAGE, *arguments).out, b"")
        self.assertEqual(os.listdir(self.folder), ["ball.ply"])

    def test_what_the_parser_refuses_is_said_with_the_remedy(self):
        for arguments, words in (
                (["orient"], "IN is missing: expected g3r orient IN OUT [options] (see g3r orient --help)"),
                (["eval", "ball.ply"], "--truth is missing: expected g3r eval RESULT --truth GT"),
                (["ball.ply", "--threads"], "--threads: expected a value, N, after it"),
                (["ball.ply", "--threads", "1", "--threads", "2"], "--threads is given 2 times: expected once"),
                (["ball.ply", "--box", "1,2"], "--box: expected X0,Y0,Z0,X1,Y1,Z1, found 2 values"),
                (["ball.ply", "--box", "1,2,3,4,5,x"], "--box: expected X0,Y0,Z0,X1,Y1,Z1, found '1,2,3,4,5,x'"),
                (["ball.ply", "--strict=no"], "--strict takes no value"), (["ball.ply", "--quiet=3"], "--quiet takes no value"),
                (["ball.ply", "--open=3"], "--open takes no value"),
                (["ball.ply", "--open", "--trim", "3"], "--trim excludes --open: give one of the two"),
                (["tiles", "merge", "d", "o.ply", "--keep-all"], "--keep-all is of use only with --mesh: give it too"),
                (["tiles"], "expected one of the commands plan, run, mesh, status, merge, found none"),
                (["tiles", "plam", "a", "b"], "found 'plam'; did you mean plan?"),
                (["tiles", "run", "d", "--worke", "1/2"], "did you mean --worker? (see g3r tiles run --help)"),
                (["view", "a", "b", "c", "-o", "x.html"], "3 files: expected g3r view IN... --out OUT"),
                (["ball.ply", "orient"], "expected the command 'orient' before its files"), (["ball.ply", "--h"], "did you mean --help?"),
                (["orient", "--version"], "unknown option --version of g3r orient"), (["help"], "did you mean --help?")):
            with self.subTest(arguments):
                self.assertIn(words, self.expect(USAGE, *arguments).err)

    def test_clouds_that_say_nothing_are_told(self):
        corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
        for points in (corners, corners[:5], corners[:4] * 50, sphere(12), sphere(20)):
            write_points(self.path("few.ply"), points)
            for arguments in (["orient", "few.ply", "a.ply"], ["few.ply", "a.ply"]):
                self.assertIn("--strict", self.expect(BAD_DATA, *arguments, "--strict").err)
        self.assertIn("20 points are too few to show which side is outside", self.expect(OK, "orient", "few.ply", "a.ply").err)
        for points, words in (([(i, 2 * i, 3 * i) for i in range(50)], "all points lie on one line"), ([(1, 2, 3)] * 50, "all points lie at the same place"),
                              ([(1, 2, 3), (2, 2, 3)] * 50, "too few distinct points: 2"), (corners[:1], "too few points: 1 of 1"),
                              (corners[:3], "too few points: 3 of 3")):
            write_points(self.path("none.ply"), points)
            self.assertIn(words, self.expect(BAD_DATA, "orient", "none.ply", "a.ply").err)

    def test_what_las_cannot_hold_is_told(self):
        with open(self.path("a.csv"), "w") as points:
            points.write("x,y,z,intensity\n" + "".join("%.3f,%.3f,%.3f,0.5\n" % point for point in sphere(200)))
        self.assertIn('warning: "intensity" becomes extra bytes "intensity_2"', self.expect(OK, "orient", "a.csv", "a.las").err)

    def test_an_option_of_another_command_names_its_owner(self):
        self.assertIn("it belongs to g3r IN OUT, g3r mesh", self.expect(USAGE, "orient", "ball.ply", "a.ply", "--open").err)
        self.assertIn("of g3r mesh: it belongs to", self.expect(USAGE, "mesh", "ball.ply", "a.ply", "--up", "+z").err)

    def test_strict_says_why_also_when_quiet(self):
        write_points(self.path("slope.ply"), [(x / 40, y / 40, 0.1 * (x / 40) ** 2) for x in range(40) for y in range(40)])
        result = self.expect(BAD_DATA, "orient", "slope.ply", "a.ply", "--strict", "--quiet")
        self.assertIn("g3r: --strict: the sides of many points are unsure or a choice", result.err)
        self.assertTrue(os.path.exists(self.path("a.ply")))
        self.assertEqual(self.expect(OK, "orient", "slope.ply", "a.ply", "--strict", "--quiet", "--up", "+z").err, "")

    def test_what_an_output_cannot_hold_is_refused_before_the_work(self):
        with open(self.path("nan.xyz"), "w") as points:
            points.write("nan 0 0\n" + "".join("%r %r %r\n" % point for point in sphere(60)))
        for arguments in (["orient", "nan.xyz", "a.las"], ["nan.xyz", "a.ply", "--oriented", "b.las"]):
            self.assertIn("not finite, of which there are 1; write PLY", self.expect(BAD_DATA, *arguments).err)
        self.assertEqual(sorted(os.listdir(self.folder)), ["ball.ply", "nan.xyz"])

    def test_decimal_commas_between_commas_are_told(self):
        with open(self.path("comma.csv"), "w") as points:
            points.write("x,y,z\n" + "".join("1,%d,2,%d,3,%d\n" % (k, k * k % 10, k % 7) for k in range(30)))
        self.assertIn("line 1: names 3 columns", self.expect(BAD_DATA, "orient", "comma.csv", "a.ply").err)

    def test_unusable_data_is_65(self):
        files = {"empty.ply": b"", "words.xyz": b"once upon a time\n", "cut.ply": b"ply\nformat ascii 1.0\nelement vertex 9\n",
                 "three.xyz": b"0 0 0\n1 0 0\n0 1 0\n", "same.xyz": b"1 2 3\n" * 50, "nan.xyz": b"nan nan nan\n" * 50,
                 "line.xyz": b"".join(b"%d %d %d\n" % (i, 2 * i, -i) for i in range(50))}
        for name, data in files.items():
            with open(self.path(name), "wb") as file:
                file.write(data)
            with self.subTest(name):
                self.expect(BAD_DATA, "orient", name, "out.ply")
                self.assertFalse(os.path.exists(self.path("out.ply")))
        self.expect(BAD_DATA, "mesh", "ball.ply", "out.ply")
        write_points(self.path("fewer.ply"), sphere(200))
        self.expect(OK, "orient", "ball.ply", "a.ply", "--quiet")
        self.expect(OK, "orient", "fewer.ply", "b.ply", "--quiet")
        self.expect(BAD_DATA, "eval", "a.ply", "--truth", "b.ply")
        self.expect(BAD_DATA, "eval", "ball.ply", "--truth", "a.ply")

    def test_missing_input_is_66(self):
        for arguments in (["nosuch.ply"], ["nofolder/a.ply"], ["orient", "nosuch.ply", "out.ply"], ["mesh", "nosuch.ply", "out.ply"],
                          ["eval", "ball.ply", "--truth", "nosuch.ply"], ["sample", "nosuch.obj", "out.ply", "--count", "5"],
                          ["info", "nosuch.ply"]):
            with self.subTest(arguments):
                self.assertIn("nosuch" if "nosuch" in str(arguments) else "nofolder", self.expect(NO_INPUT, *arguments).err)

    def test_too_little_memory_allowed_is_69(self):
        self.expect(UNAVAILABLE, "orient", "ball.ply", "out.ply", "--max-memory", "1M")
        self.assertFalse(os.path.exists(self.path("out.ply")))

    @unittest.skipIf(is_sanitized(), "a sanitizer needs the addresses")
    @needs("limit on addresses")
    def test_out_of_memory_is_71(self):
        write_cube(self.path("cube.obj"))
        limit = 1 << 30
        self.expect(OUT_OF_MEMORY, "sample", "cube.obj", "out.ply", "--count", "500000000",
                    preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
        self.assertFalse(os.path.exists(self.path("out.ply")))

    @needs("symbolic links that every user may make")
    def test_output_that_cannot_be_created_is_73_before_the_solve(self):
        before = self.bytes_of("ball.ply")
        os.symlink("ball.ply", self.path("link.ply"))
        os.link(self.path("ball.ply"), self.path("hard.ply"))
        os.mkdir(self.path("folder.ply"))
        for out in ("nofolder/out.ply", "ball.ply", "./ball.ply", "link.ply", "hard.ply", "folder.ply", "/proc/out.ply"):
            with self.subTest(out):
                self.assertNotIn("g3r: solve", self.expect(CANNOT_CREATE, "orient", "ball.ply", out, "-v").err)
        for report in ("nofolder/r.json", "ball.ply", "folder.ply", "out.ply"):
            with self.subTest(report=report):
                self.expect(CANNOT_CREATE, "orient", "ball.ply", "out.ply", "--report", report)
        self.assertTrue(self.bytes_of("ball.ply") == before)
        self.assertEqual(sorted(os.listdir(self.folder)), ["ball.ply", "folder.ply", "hard.ply", "link.ply"])

    def test_a_result_among_the_files_that_are_read_is_73(self):
        os.mkdir(self.path("scans"))
        os.mkdir(self.path("scans/results"))
        write_points(self.path("scans/ball.ply"), sphere(300))
        self.expect(OK, "orient", "scans", "scans/out.ply")
        for arguments in (["orient", "scans", "scans/out.ply"], ["orient", "scans/*.ply", "scans/out.ply"], ["scans", "scans/out.ply"],
                          ["orient", "scans", "elsewhere.ply", "--also", "scans/out.ply"],
                          ["scans", "elsewhere.ply", "--oriented", "scans/results/../out.ply"]):
            with self.subTest(arguments):
                self.assertIn("write it elsewhere", self.expect(CANNOT_CREATE, *arguments).err)
        self.expect(OK, "orient", "scans/b*.ply", "scans/out.ply")
        self.assertFalse(os.path.exists(self.path("elsewhere.ply")))

    @needs("users to drop to")
    def test_permissions_count(self):
        options = dropped_to_nobody()
        program = self.path("g3r")
        shutil.copy(G3R, program)
        os.chmod(program, 0o755)
        os.mkdir(self.path("readonly"))
        os.chmod(self.path("readonly"), 0o555)
        write_points(self.path("secret.ply"), sphere(300))
        os.chmod(self.path("secret.ply"), 0)

        def code(*arguments):
            return subprocess.run([program, *arguments], cwd=self.folder, capture_output=True, **options).returncode

        self.assertEqual(code("orient", "ball.ply", "readonly/out.ply"), CANNOT_CREATE)
        self.assertEqual(code("orient", "ball.ply", "out.ply", "--report", "readonly/r.json"), CANNOT_CREATE)
        self.assertEqual(code("orient", "secret.ply", "out.ply"), NO_INPUT)
        self.assertEqual(os.listdir(self.path("readonly")), [])

    @needs("/dev/full")
    def test_a_full_device_is_74(self):
        for arguments in (["orient", "ball.ply", "-"], ["info", "ball.ply"], ["orient", "ball.ply", "out.ply", "--report", "-"],
                          ["--help"], ["orient", "--help"], ["--version"]):
            with self.subTest(arguments), open("/dev/full", "wb") as full:
                self.expect(INPUT_OUTPUT, *arguments, stdout=full)

    @needs("limit on the size of files")
    def test_a_file_size_limit_is_74_and_no_signal(self):
        self.expect(INPUT_OUTPUT, "orient", "ball.ply", "out.ply", preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096)))
        self.assertEqual(os.listdir(self.folder), ["ball.ply"])

    @needs("streams that a parent of another system can close")
    def test_closed_streams_do_not_end_up_in_the_output(self):
        self.expect(OK, "orient", "ball.ply", "open.ply")
        self.expect(OK, "orient", "ball.ply", "closed.ply", "-v", preexec_fn=lambda: os.closerange(0, 3))
        self.assertTrue(self.bytes_of("open.ply") == self.bytes_of("closed.ply"))

    @needs("pipes of another system")
    def test_a_closed_pipe_is_74_and_no_signal(self):
        reading, writing = os.pipe()
        os.close(reading)
        self.expect(INPUT_OUTPUT, "orient", "ball.ply", "-", stdout=writing)
        os.close(writing)

    def test_strict_turns_doubt_into_65_and_still_writes(self):
        doubtful = ["orient", "ball.ply", "out.ply", "--schedule", "1 cg", "--tolerance", "1e-12", "--report", "r.json"]
        self.assertIn("warning", self.expect(OK, *doubtful).err)
        self.assertFalse(self.json_of("r.json")["converged"])
        self.assertTrue(self.json_of("r.json")["warnings"])
        os.remove(self.path("out.ply"))
        self.expect(BAD_DATA, *doubtful, "--strict")
        self.assertTrue(os.path.exists(self.path("out.ply")))
        self.expect(OK, "orient", "ball.ply", "out.ply", "--strict")
        result = self.expect(BAD_DATA, "orient", "ball.ply", "out.ply", "--epsilon", "1", "--strict")
        self.assertIn("epsilon is 1, too wide for a cloud of 2 x 2 x 2", result.err)

    def test_a_cloud_without_an_inside_is_told(self):
        random_ = random.Random(3)
        write_points(self.path("dust.ply"), [[random_.random() for _ in range(3)] for _ in range(thinned(3000))])
        result = self.expect(OK, "orient", "dust.ply", "out.ply", "--report", "r.json")
        self.assertIn("warning", result.err)
        self.assertFalse(self.json_of("r.json")["consistent"])
        self.expect(BAD_DATA, "orient", "dust.ply", "out.ply", "--strict")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
