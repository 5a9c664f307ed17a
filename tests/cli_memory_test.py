"""Truths about the g3r program when memory is short: it refuses what it plans to be too much before the solve, and when the system gives no
more it says so. It never ends with a signal and never leaves a file.

Run by ctest with G3R_PROGRAM set to the program.
"""

import json
import math
import random
import re
import resource
import sys
import unittest

from cli_support import *

LOADER_FAILED = 127  # not even the program's own code fits
LOADER_STEP = 4 << 20  # bytes of address space, in which the least that the program and its libraries need is looked for
COUNT = thinned(3000)
IN_CONTAINER = 20000  # points that take more than the program itself
BALLAST = 256 << 20  # bytes of the process that starts the program
PLANNED = (3000, 5000, 20000)  # points whose plan is held against the peak
HELD = 1.1  # peak over plan, at most
OVER = 1.3  # plan over peak, at most
OPEN = 40000  # points of an open surface
HELD_OPEN = 1.4  # peak over plan of such, at most: sides that neighbours agree on take more than those of the equations
GROUP_LIMITS = ("memory.limit_in_bytes", "memory.max")  # of the two versions of control groups


def group_of_limited_memory():
    """The folder of a new control group of Linux, inside that of this process, whose memory can be limited; None where that cannot be."""
    try:
        with open("/proc/self/cgroup") as lines:
            memberships = [line.rstrip("\n").split(":", 2) for line in lines]
        for _, controllers, group in memberships:
            first = "memory" in controllers.split(",")
            if not first and controllers != "":
                continue
            folder = "/sys/fs/cgroup" + ("/memory" if first else "") + group.rstrip("/") + "/g3r_test_%d" % os.getpid()
            os.mkdir(folder)
            if os.path.exists(os.path.join(folder, GROUP_LIMITS[0 if first else 1])):
                return folder
            os.rmdir(folder)
    except OSError:
        pass
    return None


class Memory(ProgramTest):
    def setUp(self):
        super().setUp()
        write_points(self.path("ball.ply"), sphere(COUNT))
        self.expect(OK, "orient", "ball.ply", "oriented.ply", "--report", "r.json")
        self.plan = self.json_of("r.json")["planned_memory_bytes"]
        os.remove(self.path("oriented.ply"))
        os.remove(self.path("r.json"))

    def report(self, cloud):
        return json.loads(self.expect(OK, "orient", cloud, "out.ply", "--threads", "1", "--report", "-").out)

    def test_the_peak_is_that_of_the_program_whoever_starts_it(self):
        alone = self.report("ball.ply")["peak_memory_bytes"]
        ballast = b"x" * BALLAST
        self.assertLess(self.report("ball.ply")["peak_memory_bytes"], alone + len(ballast) // 2)

    @unittest.skipIf(is_sanitized(), "a sanitizer takes memory")
    def test_the_plan_is_the_peak_of_clouds_as_wide_as_they_are_long(self):
        for count in PLANNED:
            with self.subTest(count=count):
                write_points(self.path("wide.ply"), sphere(count))
                report = self.report("wide.ply")
                share = report["peak_memory_bytes"] / report["planned_memory_bytes"]
                self.assertLess(share, HELD)
                self.assertGreater(share, 1 / OVER)

    @unittest.skipIf(is_sanitized(), "a sanitizer takes memory")
    def test_open_surfaces_take_little_more_than_the_plan(self):
        rng = random.Random(3)
        places = [(rng.uniform(-1, 1), rng.uniform(-1, 1)) for _ in range(OPEN)]
        write_points(self.path("hills.ply"), [(x, y, 0.15 * math.sin(5 * x) * math.cos(4 * y)) for x, y in places])
        report = self.report("hills.ply")
        self.assertEqual(report["open_share"], 1)
        self.assertLess(report["peak_memory_bytes"] / report["planned_memory_bytes"], HELD_OPEN)

    def test_a_plan_beyond_the_limit_is_refused_before_the_solve(self):
        self.expect(OK, "ball.ply", "mesh.ply", "--report", "r.json")
        mesh_plan = self.json_of("r.json")["planned_memory_bytes"]
        info_plan = json.loads(self.expect(OK, "info", "ball.ply", "--report", "-").out)["planned_memory_bytes"]
        self.assertEqual(info_plan, mesh_plan)
        for plan, arguments in (self.plan, ["orient", "ball.ply", "out.ply"]), (mesh_plan, ["ball.ply", "out.ply"]):
            result = self.expect(UNAVAILABLE, *arguments, "-v", "--max-memory", str(plan - 1))
            self.assertEqual(int(re.search(r"plan needs (\d+) MiB", result.err).group(1)), -(-plan >> 20))
            self.assertNotIn("g3r: solve", result.err)
            self.assertFalse(os.path.exists(self.path("out.ply")))
            self.expect(OK, *arguments, "--max-memory", str(plan))
            os.remove(self.path("out.ply"))

    @unittest.skipIf(is_sanitized(), "a sanitizer takes memory")
    def test_a_mesh_of_oriented_points_beyond_the_limit_is_refused(self):
        names = [("double", name) for name in ("x", "y", "z", "nx", "ny", "nz")]
        write_ply(self.path("few.ply"), names, [(*p, *p) for p in sphere(20)])
        result = self.expect(UNAVAILABLE, "mesh", "few.ply", "out.ply", "--depth", "12", "--max-memory", "1G")
        self.assertIn("plan needs", result.err)
        self.expect(OK, "mesh", "few.ply", "out.ply", "--depth", "6", "--max-memory", "1G", "--report", "r.json")
        self.assertLess(self.json_of("r.json")["peak_memory_bytes"], self.json_of("r.json")["planned_memory_bytes"])

    @unittest.skipUnless(os.path.exists("/proc/meminfo"), "nothing says how much memory there is")
    def test_a_plan_beyond_the_memory_that_is_free_is_refused(self):
        names = [("double", name) for name in ("x", "y", "z", "nx", "ny", "nz")]
        write_ply(self.path("square.ply"), names, [(i / 7, j / 7, 0, 0, 0, 1) for i in range(7) for j in range(7)])
        with open("/proc/meminfo", encoding="ascii") as lines:
            free = next(int(line.split()[1]) / 1024 for line in lines if line.startswith("MemAvailable"))
        limited = self.expect(UNAVAILABLE, "mesh", "square.ply", "out.ply", "--depth", "12", "--max-memory", "1M")
        if int(re.search(r"plan needs (\d+) MiB", limited.err)[1]) < 2 * free:
            self.skipTest("this machine has room for it")
        result = self.expect(UNAVAILABLE, "mesh", "square.ply", "out.ply", "--depth", "12")
        self.assertLess(int(re.search(r"the limit is (\d+) MiB", result.err)[1]), 1.5 * free)

    def test_a_mesh_that_turns_out_larger_than_its_plan_is_refused(self):
        n = 40  # two layers, half a spacing apart
        layers = [(i / n, j / n, z) for i in range(n) for j in range(n) for z in (0, 0.5 / n)]
        write_points(self.path("layers.ply"), layers)
        plan = json.loads(self.expect(OK, "info", "layers.ply", "--report", "-").out)["planned_memory_bytes"]
        result = self.expect(UNAVAILABLE, "layers.ply", "out.ply", "--max-memory", str(plan))
        self.assertIn("the mesh needs", result.err)
        self.assertEqual(sorted(os.listdir(self.folder)), ["ball.ply", "layers.ply"])

    @unittest.skipIf(is_sanitized(), "a sanitizer needs the addresses")
    def test_the_plan_bounds_what_a_mesh_takes(self):
        write_points(self.path("few.ply"), sphere(12))
        for arguments in (["ball.ply"], ["ball.ply", "--depth", "7"], ["few.ply", "--depth", "8"]):
            with self.subTest(arguments=arguments):
                self.expect(OK, *arguments, "mesh.ply", "--report", "r.json")
                report = self.json_of("r.json")
                self.assertLess(report["peak_memory_bytes"], report["planned_memory_bytes"])

    def address_space_of_the_program(self):
        limit = LOADER_STEP
        while self.run_g3r("--version", preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit))).code != OK:
            limit += LOADER_STEP
        return limit

    @unittest.skipIf(is_sanitized(), "a sanitizer needs the addresses")
    def test_a_limit_of_the_system_is_success_or_out_of_memory(self):
        codes = []
        base = self.address_space_of_the_program()
        for percent in [*range(0, 61, 5), 1000]:
            limit = base + self.plan * percent // 100
            for arguments in (["orient", "ball.ply", "out.ply", "--threads", "1"], ["orient", "ball.ply", "out.ply", "--threads", "3"],
                              ["ball.ply", "out.ply", "--threads", "2"]):
                with self.subTest(percent=percent, arguments=arguments):
                    result = self.run_g3r(*arguments, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
                    if result.code == LOADER_FAILED:
                        continue
                    self.assertIn(result.code, (OK, OUT_OF_MEMORY), result.err)
                    codes.append(result.code)
                    left = ["ball.ply"]
                    if result.code == OK:
                        left.append("out.ply")
                    else:
                        self.assertIn("g3r: out of memory", result.err)
                    self.assertEqual(sorted(os.listdir(self.folder)), left)
                    if result.code == OK:
                        os.remove(self.path("out.ply"))
        self.assertEqual(set(codes), {OK, OUT_OF_MEMORY})

    @unittest.skipIf(is_sanitized(), "a sanitizer needs the memory")
    def test_in_a_container_what_does_not_fit_is_refused_and_nothing_is_killed(self):
        group = group_of_limited_memory()
        if group is None:
            self.skipTest("no control group can be made here")
        self.addCleanup(os.rmdir, group)
        [limit_file] = [name for name in GROUP_LIMITS if os.path.exists(os.path.join(group, name))]

        def enter():
            with open(os.path.join(group, "cgroup.procs"), "w") as processes:
                processes.write(str(os.getpid()))

        write_points(self.path("ball.ply"), sphere(IN_CONTAINER))
        plans = [json.loads(self.expect(OK, *arguments, "--report", "-").out)["planned_memory_bytes"]
                 for arguments in (["orient", "ball.ply", "out.ply"], ["info", "ball.ply"])]
        os.remove(self.path("out.ply"))
        codes = set()
        for percent in (50, 70, 90, 100, 110, 130):
            for plan, command in zip(plans, (["orient"], [])):
                with self.subTest(percent=percent, command=command):
                    with open(os.path.join(group, limit_file), "w") as limit:
                        limit.write(str(plan * percent // 100))
                    result = self.run_g3r(*command, "ball.ply", "out.ply", "--threads", "1", "--device", "cpu", preexec_fn=enter)
                    codes.add(result.code)
                    self.assertIn(result.code, (OK, UNAVAILABLE), result.err)
                    if result.code == OK:
                        os.remove(self.path("out.ply"))
                    else:
                        self.assertIn("the plan needs", result.err)
                    self.assertEqual(os.listdir(self.folder), ["ball.ply"])
        self.assertEqual(codes, {OK, UNAVAILABLE})


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
