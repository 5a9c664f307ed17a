"""Truths about the g3r program: exit codes, what goes to which stream, the report, what happens to points and files.

Run by ctest with G3R_PROGRAM set to the program.
"""

import json
import math
import os
import pty
import random
import resource
import shutil
import subprocess
import sys
import unittest

from cli_support import *

DOCS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "docs", "report.md")

REPORT_SCHEMA = {
    "schema": str, "schema_version": int, "g3r_version": str,
    "input": {"points": int, "used": int, "dropped_non_finite": int, "outliers": int, "merged_duplicates": int},
    "scales": {"box_centre": list, "box_side": float, "spacing": float, "noise": float, "epsilon": float, "depth": int},
    "method": {"name": str, "preset": str, "solver": str, "harmonics": str, "sums": str, "accuracy": float, "tolerance": float,
               "condition_number": None},
    "iterations": list, "converged": bool, "consistent": bool, "doubtful": bool, "open_share": float, "undecided_share": float,
    "hints": {"given": list, "settled_share": float, "turned_share": float, "agreement": float, "contradicted_share": float},
    "seconds": {"read": float, "build": float, "solve": float, "refine": float, "mesh": float, "write": float, "total": float},
    "planned_memory_bytes": int, "peak_memory_bytes": int, "threads": int,
    "device": {"name": str, "driver": str},
    "confidence": {"mean": float, "below_half": float},
    "warnings": list,
}
MESH_SCHEMA = {"vertices": int, "faces": int, "components": int, "closed": bool, "manifold": bool, "boundary_edges": int,
               "nonmanifold_edges": int, "nonmanifold_vertices": int, "genus": None, "volume": float, "area": float,
               "dropped": {"points": int, "components": int, "area": float},
               "self_intersections": None, "min_angle": float, "median_min_angle": float, "max_aspect": float}


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
                ["ball.ply", "--degree", "2", "--harmonics", "1,x"], ["ball.ply", "--max-memory", "8Q"], ["ball.ply", "--accuracy", "7"],
                ["ball.ply", "out.docx"], ["orient", "ball.ply", "out.stl"], ["-"], ["ball.ply", "-", "--report", "-"]):
            with self.subTest(arguments):
                self.assertEqual(self.expect(USAGE, *arguments).out, b"")
        self.assertEqual(os.listdir(self.folder), ["ball.ply"])

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
        self.expect(UNAVAILABLE, "orient", "ball.ply", "out.ply", "--max-memory", "1K")
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

    def test_a_cloud_without_an_inside_is_told(self):
        random_ = random.Random(3)
        write_points(self.path("dust.ply"), [[random_.random() for _ in range(3)] for _ in range(thinned(3000))])
        result = self.expect(OK, "orient", "dust.ply", "out.ply", "--report", "r.json")
        self.assertIn("warning", result.err)
        self.assertFalse(self.json_of("r.json")["consistent"])
        self.expect(BAD_DATA, "orient", "dust.ply", "out.ply", "--strict")


class Streams(ProgramTest):
    def setUp(self):
        super().setUp()
        write_points(self.path("ball.ply"), sphere(300))

    def test_standard_output_carries_only_data(self):
        result = self.expect(OK, "orient", "ball.ply", "out.ply")
        self.assertEqual(result.out, b"")
        self.assertIn("300 points", result.err)
        self.assertIn("out.ply", result.err)
        result = self.expect(OK, "orient", "ball.ply", "-")
        self.assertEqual(len(read_ply(result.out)[1]), 300)
        self.assertTrue(result.out == self.bytes_of("out.ply"))
        json.loads(self.expect(OK, "orient", "ball.ply", "out.ply", "--report", "-").out)
        json.loads(self.expect(OK, "info", "ball.ply", "--report", "-").out)
        json.loads(self.expect(OK, "eval", "out.ply", "--truth", "out.ply").out)

    def test_standard_input_is_a_file_like_any(self):
        self.expect(OK, "orient", "ball.ply", "file.ply")
        self.expect(OK, "orient", "-", "stdin.ply", data=self.bytes_of("ball.ply"))
        self.assertTrue(self.bytes_of("file.ply") == self.bytes_of("stdin.ply"))

    def test_quiet_is_silent(self):
        result = self.expect(OK, "orient", "ball.ply", "out.ply", "--quiet")
        self.assertEqual((result.out, result.err), (b"", ""))

    def test_without_a_terminal_there_is_no_bar(self):
        for flags in ([], ["-v"]):
            result = self.expect(OK, "orient", "ball.ply", "out.ply", *flags)
            self.assertNotIn("\r", result.err)
            self.assertNotIn("\x1b", result.err)

    def terminal_output(self, *flags):
        main, other = pty.openpty()
        process = self.start("orient", "ball.ply", "out.ply", *flags, stdout=subprocess.DEVNULL, stderr=other,
                             env={**os.environ, "TERM": "xterm"})
        os.close(other)
        text = all_of_terminal(main)
        self.assertEqual(process.wait(), OK)
        return text

    @needs("pseudo-terminals")
    def test_a_terminal_shows_a_bar_unless_told_otherwise(self):
        self.assertIn(b"\r\x1b[K", self.terminal_output())
        self.assertNotIn(b"\x1b", self.terminal_output("--no-progress"))
        self.assertEqual(self.terminal_output("--quiet"), b"")

    def test_text_from_files_cannot_control_the_terminal(self):
        evil = "\x1b]0;owned\x07\x1b[2J"
        write_ply(self.path("evil.ply"), [("double", "x"), ("double", "y"), ("double", "z"), ("float", evil)],
                  [(*p, 0.0) for p in sphere(50)])
        with open(self.path("evil.xyz"), "w") as file:
            file.write("0 0 " + evil + "\n")
        write_points(self.path(evil.replace("/", "") + ".ply"), sphere(50))
        for name in ("evil.ply", "evil.xyz", evil + ".ply", evil):
            for command in (["info", name], ["orient", name, "out.ply", "-v"]):
                result = self.run_g3r(*command)
                self.assertNotIn("\x1b", result.err + result.out.decode("utf-8", "replace"))
        self.assertNotIn("\x1b", self.expect(USAGE, "--" + evil).err)

    @needs("localedef")
    def test_the_locale_changes_nothing(self):
        locales = self.path("locales")
        os.mkdir(locales)
        if shutil.which("localedef"):
            subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", os.path.join(locales, "de_DE.UTF-8")], capture_output=True)
        german = {**os.environ, "LOCPATH": locales, "LC_ALL": "de_DE.UTF-8", "LANG": "de_DE.UTF-8"}
        self.expect(OK, "orient", "ball.ply", "plain.xyz", "--report", "-")
        result = self.expect(OK, "orient", "ball.ply", "german.xyz", "--report", "-", env=german)
        self.assertTrue(self.bytes_of("plain.xyz") == self.bytes_of("german.xyz"))
        self.assertNotIn(b",", self.bytes_of("german.xyz"))
        json.loads(result.out)
        self.expect(OK, "orient", "plain.xyz", "again.xyz", env=german)
        self.expect(OK, "orient", "ball.ply", "out.ply", "--epsilon", "0.4h", "--accuracy", "0.01", env=german)


    def test_the_noise_that_is_given_is_used(self):
        for given, spacings in (("0", 0), ("0.25h", 0.25)):
            scales = json.loads(self.expect(OK, "orient", "ball.ply", "out.ply", "--noise", given, "--report", "-").out)["scales"]
            self.assertAlmostEqual(scales["noise"], spacings * scales["spacing"], delta=1e-12)
        self.expect(USAGE, "orient", "ball.ply", "out.ply", "--noise", "-1")
        self.expect(OK, "orient", "ball.ply", "oriented.ply")
        for given, name in (("auto", "auto.ply"), ("0", "clean.ply"), ("0.5h", "noisy.ply")):
            self.expect(OK, "mesh", "oriented.ply", name, "--noise", given)
        self.assertTrue(self.bytes_of("auto.ply") == self.bytes_of("clean.ply") != self.bytes_of("noisy.ply"))
        self.expect(USAGE, "mesh", "oriented.ply", "out.ply", "--noise", "-1")


class Report(ProgramTest):
    def assert_schema(self, value, schema, where=""):
        for key, kind in schema.items():
            self.assertIn(key, value, where)
            if isinstance(kind, dict):
                self.assert_schema(value[key], kind, where + key + ".")
            elif kind is float:
                self.assertIsInstance(value[key], (int, float), where + key)
            elif kind is not None:
                self.assertIs(type(value[key]), kind, where + key)

    def test_every_field_is_there_and_documented(self):
        write_points(self.path("ball.ply"), sphere(500))
        self.expect(OK, "orient", "ball.ply", "out.ply", "--report", "r.json")
        report = self.json_of("r.json")
        self.assert_schema(report, REPORT_SCHEMA)
        self.assertEqual(set(report), set(REPORT_SCHEMA) | {"mesh"})
        self.assertIsNone(report["mesh"])
        self.assertEqual(len(report["scales"]["box_centre"]), 3)
        for step in report["iterations"]:
            self.assertIn(step["kind"], ("sd", "cg"))
            self.assertGreaterEqual(step["residual"], 0)
        with open(DOCS) as file:
            text = file.read()
        for group, fields in list(REPORT_SCHEMA.items()) + [("mesh", MESH_SCHEMA)]:
            for name in [group] + list(fields if isinstance(fields, dict) else []):
                self.assertRegex(text, r"[`.]%s\b" % name)

    def test_the_mesh_is_described(self):
        write_points(self.path("ball.ply"), sphere(2000))
        self.expect(OK, "ball.ply", "--report", "r.json")
        self.assertTrue(os.path.exists(self.path("ball.mesh.ply")))
        report = self.json_of("r.json")
        self.assert_schema(report, REPORT_SCHEMA)
        self.assert_schema(report["mesh"], MESH_SCHEMA)
        self.assertEqual(set(report["mesh"]), set(MESH_SCHEMA))
        self.assertTrue(report["mesh"]["closed"] and report["mesh"]["manifold"])
        self.assertEqual((report["mesh"]["components"], report["mesh"]["genus"]), (1, 0))
        self.assertAlmostEqual(report["mesh"]["volume"], 4 / 3 * math.pi, delta=0.15)
        self.assertGreater(report["seconds"]["mesh"], 0)

    def test_counts_and_times_are_true(self):
        points = sphere(300)
        write_points(self.path("odd.ply"), points + [(math.nan, 0, 0), (0, math.inf, 0)] + points[:7])
        result = self.expect(OK, "orient", "odd.ply", "out.ply", "--report", "r.json", "--threads", "1")
        report = self.json_of("r.json")
        self.assertEqual(report["input"], {"points": 309, "used": 300, "dropped_non_finite": 2, "outliers": 0, "merged_duplicates": 7})
        self.assertEqual(report["threads"], 1)
        self.assertEqual(report["device"], {"name": "cpu", "driver": ""})
        self.assertAlmostEqual(report["scales"]["box_side"], 2, delta=0.05)
        seconds = dict(report["seconds"])
        total = seconds.pop("total")
        self.assertLessEqual(sum(seconds.values()), 1.02 * total + 0.01)
        self.assertGreater(report["peak_memory_bytes"], 1 << 20)
        self.assertTrue(report["warnings"])
        for warning in report["warnings"]:
            self.assertIn(warning, result.err)


class Points(ProgramTest):
    PROPERTIES = [("int", "id"), ("double", "x"), ("uchar", "red"), ("double", "y"), ("uchar", "green"), ("double", "z"),
                  ("uchar", "blue"), ("float", "intensity"), ("ushort", "label")]

    def row(self, i, p):
        return (1000 - i, p[0], i % 256, p[1], 7, p[2], 255 - i % 256, 0.1 * i, 65535 - i)

    def test_order_and_properties_are_kept(self):
        points = sphere(400)
        write_ply(self.path("in.ply"), self.PROPERTIES, [self.row(i, p) for i, p in enumerate(points)])
        self.expect(OK, "orient", "in.ply", "out.ply")
        names, rows = read_ply(self.bytes_of("out.ply"))
        _, before = read_ply(self.bytes_of("in.ply"))
        given = [name for _, name in self.PROPERTIES]
        self.assertEqual([name for name in names if name in given], given)
        self.assertEqual(len(rows), len(before))
        for old, new, p in zip(before, rows, points):
            self.assertEqual({name: new[name] for name in given}, old)
            self.assertAlmostEqual(math.hypot(new["nx"], new["ny"], new["nz"]), 1, delta=1e-5)
            self.assertGreater(new["nx"] * p[0] + new["ny"] * p[1] + new["nz"] * p[2], 0.9)
            self.assertTrue(0 <= new["confidence"] <= 1)

    def test_duplicates_share_a_normal_and_bad_points_have_none(self):
        points = sphere(300)
        rows = points + [(math.nan, 1.0, 2.0)] + points[:10]
        write_points(self.path("in.ply"), rows)
        self.expect(OK, "orient", "in.ply", "out.ply")
        _, out = read_ply(self.bytes_of("out.ply"))
        self.assertEqual(len(out), len(rows))
        normals = [(row["nx"], row["ny"], row["nz"]) for row in out]
        self.assertEqual(normals[301:], normals[:10])
        self.assertEqual(normals[300], (0, 0, 0))
        self.assertTrue(math.isnan(out[300]["x"]) and out[300]["y"] == 1.0)

    def test_the_number_of_threads_changes_no_byte(self):
        write_points(self.path("in.ply"), sphere(1500))
        self.expect(OK, "orient", "in.ply", "one.ply", "--threads", "1")
        for threads in ("2", "3", "8", "0"):
            self.expect(OK, "orient", "in.ply", "many.ply", "--threads", threads)
            self.assertTrue(self.bytes_of("one.ply") == self.bytes_of("many.ply"), threads)

    def test_oriented_points_are_enough_for_a_mesh(self):
        write_points(self.path("in.ply"), sphere(2000))
        self.expect(OK, "orient", "in.ply", "oriented.ply")
        for mesher in ("auto", "field", "poisson"):
            with self.subTest(mesher):
                result = self.run_g3r("mesh", "oriented.ply", "out.obj", "--report", "r.json", "--mesher", mesher)
                if mesher == "poisson" and result.code == UNAVAILABLE:
                    self.skipTest("built without Poisson reconstruction")
                self.assertEqual(result.code, OK, result.err)
                mesh = self.json_of("r.json")["mesh"]
                self.assertTrue(mesh["closed"])
                self.assertAlmostEqual(mesh["volume"], 4 / 3 * math.pi, delta=0.15)

    def test_colours_and_confidence_reach_the_mesh(self):
        write_ply(self.path("in.ply"), [("double", "x"), ("double", "y"), ("double", "z"), ("uchar", "red"), ("uchar", "green"), ("uchar", "blue")],
                  [(*p, 200 if p[2] > 0 else 10, 7, 9) for p in sphere(1000)])
        self.expect(OK, "in.ply", "out.ply")
        for vertex in read_ply(self.bytes_of("out.ply"))[1]:
            self.assertEqual((vertex["green"], vertex["blue"]), (7, 9))
            self.assertTrue(0 <= vertex["confidence"] <= 1)
            if abs(vertex["z"]) > 0.2:
                self.assertEqual(vertex["red"], 200 if vertex["z"] > 0 else 10)

    def test_an_open_scan_can_stay_open(self):
        write_points(self.path("in.ply"), [p for p in sphere(thinned(3000)) if p[2] > 0])
        self.expect(OK, "in.ply", "closed.ply", "--report", "r.json")
        self.assertTrue(self.json_of("r.json")["mesh"]["closed"])
        self.expect(OK, "in.ply", "open.ply", "--open", "--report", "r.json")
        self.assertFalse(self.json_of("r.json")["mesh"]["closed"])
        self.expect(USAGE, "in.ply", "out.ply", "--trim", "-1")

    def test_outliers_leave_no_surface_unless_asked(self):
        random_ = random.Random(4)
        outliers = [[3 * random_.random() - 1.5 for _ in range(3)] for _ in range(thinned(500))]
        write_points(self.path("in.ply"), sphere(thinned(3000)) + outliers)
        self.expect(OK, "in.ply", "out.ply", "--report", "r.json")
        report = self.json_of("r.json")
        self.assertEqual((report["mesh"]["components"], report["mesh"]["closed"]), (1, True))
        self.assertGreaterEqual(report["mesh"]["dropped"]["points"], max(0.8 * len(outliers), report["input"]["outliers"]))
        self.expect(OK, "in.ply", "all.ply", "--keep-all", "--report", "r.json")
        kept = self.json_of("r.json")
        self.assertEqual((kept["mesh"]["dropped"]["components"], kept["mesh"]["dropped"]["points"]), (0, kept["input"]["outliers"]))

    def test_one_run_writes_several_files(self):
        write_points(self.path("in.ply"), sphere(500))
        self.expect(OK, "in.ply", "out.ply", "--also", "out.obj", "--also", "out.stl", "--oriented", "points.xyz")
        self.expect(OK, "in.ply", "alone.obj")
        self.expect(OK, "orient", "in.ply", "alone.xyz", "--also", "points.las")
        self.assertTrue(self.bytes_of("out.obj") == self.bytes_of("alone.obj"))
        self.assertTrue(self.bytes_of("points.xyz") == self.bytes_of("alone.xyz"))
        self.assertEqual(sorted(os.listdir(self.folder)),
                         ["alone.obj", "alone.xyz", "in.ply", "out.obj", "out.ply", "out.stl", "points.las", "points.xyz"])
        self.expect(CANNOT_CREATE, "in.ply", "new.ply", "--also", "./new.ply")
        self.expect(CANNOT_CREATE, "in.ply", "new.ply", "--oriented", "in.ply")
        self.expect(USAGE, "in.ply", "new.ply", "--also", "new.las")
        self.expect(USAGE, "in.ply", "-", "--also", "-")

    def test_an_existing_output_is_replaced(self):
        write_points(self.path("in.ply"), sphere(300))
        with open(self.path("out.ply"), "w") as file:
            file.write("old")
        self.expect(OK, "orient", "in.ply", "out.ply")
        self.assertEqual(len(read_ply(self.bytes_of("out.ply"))[1]), 300)


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

    def depth_frame(self):
        """A ball before a wall as a camera at the origin sees them: one open surface on the other, with a gap in depth between them."""
        points = []
        step = 2 if is_sanitized() else 1
        for u in range(-40, 41, step):
            for v in range(-30, 31, step):
                ray = (u / 66, v / 66, 1.0)
                a, b = sum(c * c for c in ray), 2 * ray[2]
                discriminant = b * b - a * (4 - 0.16)
                depth = (b - math.sqrt(discriminant)) / a if discriminant > 0 else 3.0
                points.append([depth * c for c in ray])
        return points

    def test_a_depth_frame_faces_its_camera(self):
        write_points(self.path("frame.ply"), self.depth_frame())
        self.expect(OK, "orient", "frame.ply", "out.ply", "--sensor", "0,0,0", "--report", "r.json")
        self.assertGreaterEqual(self.facing("out.ply", (0, 0, 0)), 0.995)
        self.assertEqual(self.json_of("r.json")["hints"]["given"], ["sensor"])
        self.expect(OK, "orient", "frame.ply", "out.ply", "--sensor", "0,0,0", "--flip")
        self.assertLessEqual(self.facing("out.ply", (0, 0, 0)), 0.005)

    def test_terrain_faces_up_whatever_up_is(self):
        random_ = random.Random(5)
        plan = [(2 * random_.random() - 1, 2 * random_.random() - 1) for _ in range(thinned(2000))]
        write_points(self.path("terrain.ply"), [(x, y, 0.1 * math.sin(4 * x) * math.cos(3 * y)) for x, y in plan])
        self.assertIn("is a choice", self.expect(OK, "orient", "terrain.ply", "out.ply").err)
        for up, place in (("+z", (0, 0, 9)), ("-z", (0, 0, -9)), ("0.1,0,-3", (0, 0, -9))):
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
        for hint in (["--seen-from-inside"], ["--sensor", "1,1,1.5"], ["--sensor", "1,1,1", "--sensor", "3,2,1"], ["--flip"]):
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
        result = self.expect(OK, "orient", "ball.ply", "out.ply", "--inside", "0,0,5", "--up", "x")
        self.assertIn("0,0,5 is not inside", result.err)
        self.assertIn("hint up: it decides nothing", result.err)
        self.assertEqual(self.facing("out.ply", (0, 0, 0)), 0)
        self.assertNotIn("hint", self.expect(OK, "orient", "ball.ply", "out.ply", "--inside", "0,0,0.5", "--sensor", "0,0,5").err)

    def test_the_file_may_say_where_the_scanner_stood(self):
        points = self.depth_frame()
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
        for hint, words in ((["--up", "w"], "--up: expected X,Y,Z, or an axis"), (["--up", "0,0,0"], "--up"), (["--up", "1,2"], "--up"),
                            (["--sensor", "here"], "--sensor: expected X,Y,Z, or file"), (["--sensor", "1,2,nan"], "--sensor"),
                            (["--inside", "1,2,3,4"], "--inside: expected X,Y,Z"), (["--sensor", "file", "--sensor", "1,2,3"], "exclude each other")):
            self.assertIn(words, self.expect(USAGE, "orient", "ball.ply", "out.ply", *hint).err)


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
        self.expect(BAD_DATA, "eval", "cube.obj", "--truth", "a.ply")

    def test_folders_patterns_and_boxes(self):
        os.mkdir(self.path("tiles"))
        write_xyz(self.path("tiles/a.xyz"), [(x, y, 0) for x in range(3) for y in range(3)])
        write_xyz(self.path("tiles/b.xyz"), [(x, y, 1) for x in range(3) for y in range(3)])
        for name in ("tiles", "tiles/", "tiles/*.xyz"):
            text = self.expect(OK, "info", name).out.decode()
            self.assertIn("2 files of xyz", text)
            self.assertIn("18", text)
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
