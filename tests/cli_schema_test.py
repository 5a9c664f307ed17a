"""Truths about the report of the g3r program: every field is there, documented and true.

Run by ctest with G3R_PROGRAM set to the program.
"""

import math
import os
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
    "hints": {"given": list, "settled_share": float, "turned_share": float, "agreement": float, "contradicted_share": float, "hidden_share": float,
              "viewpoint": None},
    "seconds": {"read": float, "build": float, "solve": float, "refine": float, "mesh": float, "write": float, "total": float},
    "planned_memory_bytes": int, "peak_memory_bytes": int, "threads": int,
    "device": {"name": str, "driver": str, "seconds": dict},
    "confidence": {"mean": float, "below_half": float},
    "warnings": list,
}
MESH_SCHEMA = {"vertices": int, "faces": int, "components": int, "closed": bool, "manifold": bool, "boundary_edges": int,
               "nonmanifold_edges": int, "nonmanifold_vertices": int, "genus": None, "volume": float, "area": float,
               "dropped": {"points": int, "components": int, "area": float},
               "self_intersections": None, "min_angle": float, "median_min_angle": float, "max_aspect": float}


class Report(ProgramTest):
    def assert_schema(self, value, schema, where=""):
        if where != "seconds.":  # further stages may follow
            self.assertEqual(set(value), set(schema), where)
        for key, kind in schema.items():
            self.assertIn(key, value, where)
            if isinstance(kind, dict):
                self.assert_schema(value[key], kind, where + key + ".")
            elif kind is float:
                self.assertIsInstance(value[key], (int, float), where + key)
            elif kind is not None:
                self.assertIs(type(value[key]), kind, where + key)

    def assert_report(self, report, mesh):
        """Every field of the schema and no other, with a mesh or null."""
        self.assertEqual(report["mesh"] is not None, mesh)
        if mesh:
            self.assert_schema(report["mesh"], MESH_SCHEMA, "mesh.")
        self.assert_schema({key: value for key, value in report.items() if key != "mesh"}, REPORT_SCHEMA)
        self.assertEqual(len(report["scales"]["box_centre"]), 3)
        for step in report["iterations"]:
            self.assertEqual(set(step), {"kind", "residual"})
            self.assertIn(step["kind"], ("sd", "cg", "wnnc"))
            self.assertGreaterEqual(step["residual"], 0)

    def test_every_field_is_there_and_documented(self):
        write_points(self.path("ball.ply"), sphere(500))
        self.expect(OK, "orient", "ball.ply", "out.ply", "--report", "r.json")
        self.assert_report(self.json_of("r.json"), mesh=False)
        with open(DOCS) as file:
            text = file.read()
        for group, fields in list(REPORT_SCHEMA.items()) + [("mesh", MESH_SCHEMA)]:
            for name in [group] + list(fields if isinstance(fields, dict) else []):
                self.assertRegex(text, r"[`.]%s\b" % name)

    def test_every_command_and_method_has_every_field(self):
        write_points(self.path("ball.ply"), sphere(500))
        self.expect(OK, "orient", "ball.ply", "oriented.ply")
        self.expect(OK, "mesh", "oriented.ply", "mesh.ply", "--report", "mesh.json")
        self.assert_report(self.json_of("mesh.json"), mesh=True)
        self.expect(OK, "info", "ball.ply", "--report", "info.json")
        self.assert_report(self.json_of("info.json"), mesh=False)
        self.expect(OK, "info", "mesh.ply", "--report", "info.json")
        self.assert_report(self.json_of("info.json"), mesh=True)
        for options in (["--method", "wnnc"], ["--method", "agr"], ["--method", "pgr"], ["--method", "green"], ["--preset", "paper"],
                        ["--up", "+z"]):
            self.expect(OK, "orient", "ball.ply", "out.ply", "--report", "r.json", *options)
            report = self.json_of("r.json")
            self.assert_report(report, mesh=False)
            self.assertIn(report["method"]["preset" if "--preset" in options else "name"], options + ["energy"])

    def test_the_mesh_is_described(self):
        write_points(self.path("ball.ply"), sphere(2000))
        self.expect(OK, "ball.ply", "--report", "r.json")
        self.assertTrue(os.path.exists(self.path("ball.mesh.ply")))
        report = self.json_of("r.json")
        self.assert_report(report, mesh=True)
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
        self.assertEqual(report["device"], {"name": "cpu", "driver": "", "seconds": {}})
        self.assertAlmostEqual(report["scales"]["box_side"], 2, delta=0.05)
        seconds = dict(report["seconds"])
        total = seconds.pop("total")
        self.assertLessEqual(sum(seconds.values()), 1.02 * total + 0.01)
        self.assertGreater(report["peak_memory_bytes"], 1 << 20)
        self.assertTrue(report["warnings"])
        for warning in report["warnings"]:
            self.assertIn(warning, result.err)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
