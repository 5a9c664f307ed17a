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
    "iterations": list, "converged": bool, "consistent": bool, "open_share": float, "undecided_share": float,
    "seconds": {"read": float, "build": float, "solve": float, "refine": float, "mesh": float, "write": float, "total": float},
    "planned_memory_bytes": int, "peak_memory_bytes": int, "threads": int,
    "device": {"name": str, "driver": str},
    "confidence": {"mean": float, "below_half": float},
    "warnings": list,
}
MESH_SCHEMA = {"vertices": int, "faces": int, "components": int, "closed": bool, "manifold": bool, "boundary_edges": int,
               "nonmanifold_edges": int, "nonmanifold_vertices": int, "genus": None, "volume": float, "area": float,
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
                (NO_INPUT, ["no.ply"], "cannot read no.ply: No such file"), (NO_INPUT, ["folder"], "folder: a folder, not a file"),
                (BAD_DATA, ["empty.ply"], "empty.ply: empty file"), (BAD_DATA, ["none.obj"], "none.obj: no points"),
                (BAD_DATA, ["flat.xyz"], "flat.xyz: line 1: expected at least three columns (x y z), found 2"),
                (BAD_DATA, ["nan.xyz"], "nan.xyz: too few points: 0 of 9 are finite"), (BAD_DATA, ["three.xyz"], "too few points: 3 of 3"),
                (BAD_DATA, ["comma.csv"], "a decimal comma?"), (CANNOT_CREATE, ["ball.ply", "no/a.ply"], "no/a.ply: cannot create: there is no such folder"),
                (USAGE, ["ball.ply", "--epsilon", "wide"], "--epsilon: expected auto, X, X%, Xh or Xn with X > 0, found 'wide'"),
                (USAGE, ["ball.ply", "a.docx"], 'unknown extension ".docx": expected .ply, .obj'),
                (USAGE, ["ball.ply", "a.xyz"], "a.xyz: .xyz is for points"), (USAGE, ["orient", "ball.ply", "a.stl"], "a.stl: .stl is for meshes"),
                (USAGE, ["oriend", "ball.ply"], "no file and no command named oriend"), (USAGE, ["ball.ply", "--treads", "2"], "unknown option --treads; did you mean --threads?"),
                (USAGE, ["ball.ply", "--bogus"], "unknown option --bogus (see"), (USAGE, ["ball.ply", "-o", "a.ply"], "the output stands after the input"),
                (USAGE, ["oreint", "ball.ply", "a.ply"], "did you mean orient?"), (USAGE, ["ball.ply", "--open", "--trim", "3"], "excludes --open"),
                (USAGE, ["ball.ply", "--faces", "-5"], "--faces: expected a whole number, 0 or more, found '-5'"),
                (USAGE, ["ball.ply", "--seed", "9" * 30], "--seed: expected a whole number, 0 or more"),
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
    def test_out_of_memory_is_71(self):
        write_cube(self.path("cube.obj"))
        limit = 1 << 30
        self.expect(OUT_OF_MEMORY, "sample", "cube.obj", "out.ply", "--count", "500000000",
                    preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
        self.assertFalse(os.path.exists(self.path("out.ply")))

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

    def test_a_full_device_is_74(self):
        for arguments in (["orient", "ball.ply", "-"], ["info", "ball.ply"], ["orient", "ball.ply", "out.ply", "--report", "-"],
                          ["--help"], ["orient", "--help"], ["--version"]):
            with self.subTest(arguments), open("/dev/full", "wb") as full:
                self.expect(INPUT_OUTPUT, *arguments, stdout=full)

    def test_a_file_size_limit_is_74_and_no_signal(self):
        self.expect(INPUT_OUTPUT, "orient", "ball.ply", "out.ply", preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096)))
        self.assertEqual(os.listdir(self.folder), ["ball.ply"])

    def test_closed_streams_do_not_end_up_in_the_output(self):
        self.expect(OK, "orient", "ball.ply", "open.ply")
        self.expect(OK, "orient", "ball.ply", "closed.ply", "-v", preexec_fn=lambda: os.closerange(0, 3))
        self.assertTrue(self.bytes_of("open.ply") == self.bytes_of("closed.ply"))

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
        write_points(self.path("dust.ply"), [[random_.random() for _ in range(3)] for _ in range(3000)])
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
        text = b""
        try:
            while chunk := os.read(main, 4096):
                text += chunk
        except OSError:  # Linux ends a closed terminal with EIO
            pass
        os.close(main)
        self.assertEqual(process.wait(), OK)
        return text

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
        write_points(self.path("in.ply"), [p for p in sphere(3000) if p[2] > 0])
        self.expect(OK, "in.ply", "closed.ply", "--report", "r.json")
        self.assertTrue(self.json_of("r.json")["mesh"]["closed"])
        self.expect(OK, "in.ply", "open.ply", "--open", "--report", "r.json")
        self.assertFalse(self.json_of("r.json")["mesh"]["closed"])
        self.expect(USAGE, "in.ply", "out.ply", "--trim", "-1")

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
        score = json.loads(self.expect(OK, "eval", "cube.obj", "--truth", "cube.obj", "--samples", "2000").out)
        self.assertEqual((score["kind"], score["samples"]), ("mesh", 2000))
        for name in ("cd", "ae_m", "hd"):
            self.assertAlmostEqual(score[name], 0, delta=1e-6)
        self.expect(BAD_DATA, "eval", "cube.obj", "--truth", "a.ply")

    def test_info_says_what_is_in_a_file(self):
        text = self.expect(OK, "info", "cube.obj").out.decode()
        for words in ("cube.obj", "8", "12 triangles", "closed", "genus 0", "no triangles intersect", "smallest 45 degrees", "x 0 to 2"):
            self.assertIn(words, text)
        write_xyz(self.path("two.xyz"), [(0, 0, 0), (1, 1, 1)])
        result = self.expect(OK, "info", "two.xyz")
        self.assertIn("warning", result.err)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
