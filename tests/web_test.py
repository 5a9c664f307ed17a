"""The page g3r.html in a browser without a display, beside the g3r program. Run by tools/web.sh: G3R_PAGE names the page, G3R_PROGRAM the
program, G3R_SERIAL the program without threads, G3R_CHROMIUM the browser; G3R_PICTURE, where to put a picture of the page."""

import base64
import json
import math
import os
import subprocess
import time
import unittest

from cli_support import G3R, OK, ProgramTest, read_ply, write_ply, write_xyz
from web_browser import Browser

PAGE = os.environ["G3R_PAGE"]
LARGEST_PAGE = 6_000_000  # bytes: small enough for a mail

# Beside the program: both solve to the same tolerance, but vectors of other widths round and add up otherwise. What steps decide by a hair
# may differ; nearly all normals do not.
SAME_DIRECTION = math.cos(math.radians(1))
SHARE_THE_SAME = 0.995
SHARE_OF_SIDES = 0.9999


def torus(count):
    """Evenly strewn, wavy enough to be a task."""
    points = []
    for i in range(count):
        u, v = 2 * math.pi * (i + 0.5) / count, 2 * math.pi * (i * 0.6180339887498949 % 1)
        ring = 1 + (0.35 + 0.05 * math.cos(5 * u)) * math.cos(v)
        points.append((ring * math.cos(u), ring * math.sin(u), 0.35 * math.sin(v) + 0.1 * math.sin(3 * u)))
    return points


class NoThreads(ProgramTest):
    def test_the_same_bytes_as_with_threads(self):
        write_ply(self.path("torus.ply"), [("double", c) for c in "xyz"], torus(12_000))
        results = []
        for program, threads in [(G3R, "1"), (G3R, "2"), (os.environ["G3R_SERIAL"], "1")]:
            subprocess.run([program, "torus.ply", "mesh.ply", "--oriented", "oriented.ply", "--threads", threads], cwd=self.folder, check=True,
                           stderr=subprocess.DEVNULL)
            results.append((self.bytes_of("mesh.ply"), self.bytes_of("oriented.ply")))
        self.assertEqual(results[0], results[2])
        self.assertEqual(results[0], results[1])


class Web(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.browser = Browser(os.environ.get("G3R_CHROMIUM", "chromium"))
        cls.addClassCleanup(cls.browser.close)
        cls.browser.on("page", "Page.navigate", url="file://" + os.path.abspath(PAGE))
        cls.browser.wait("document.body && document.body.dataset.state === 'start'")

    def tearDown(self):
        self.assertEqual(self.browser.errors, [])

    def state(self):
        return self.browser.value("document.body.dataset.state")

    def finish(self, seconds=600):
        """Waits for the end of a run: 'result', or 'start' after a failure."""
        return self.browser.wait("['start', 'result'].includes(document.body.dataset.state) && document.body.dataset.state", seconds)

    def drop(self, path):
        """Returns when the work has begun."""
        self.browser.value("state.name = ''")
        self.browser.drop(path)
        self.browser.wait("state.name")

    def again(self):
        if self.state() == "result":
            self.browser.value("at('again').click()")
        self.assertEqual(self.state(), "start")

    def failure(self):
        return self.browser.value("at('failure').textContent")

    def report(self):
        return json.loads(self.browser.value("state.report"))

    def solve_sample(self):
        """That the page still works."""
        self.browser.value("at('sample').click()")
        self.assertEqual(self.finish(), "result", self.failure())
        self.assertTrue(self.report()["mesh"]["closed"])

    def test_one_small_file(self):
        self.assertLess(os.path.getsize(PAGE), LARGEST_PAGE)
        self.assertEqual(self.browser.value("performance.getEntriesByType('resource').filter(e => !/^(blob|data):/.test(e.name)).length"), 0)

    def test_the_same_normals_and_mesh_as_the_program(self):
        self.again()
        count = 50_000
        write_ply(self.path("torus.ply"), [("double", c) for c in "xyz"], torus(count))
        self.expect(OK, "torus.ply", "mesh.ply", "--oriented", "native.ply", "--report", "native.json", "--threads", "1")
        begin, begin_processor = time.monotonic(), self.browser.processor_seconds()
        self.drop(self.path("torus.ply"))
        self.assertEqual(self.finish(), "result", self.failure())
        seconds, processor = time.monotonic() - begin, self.browser.processor_seconds() - begin_processor
        native, report = self.json_of("native.json"), self.report()
        print("%d points: %.1f s in the browser, %.1f s of processor time; %s; the program, one thread: %s" %
              (count, seconds, processor, report["seconds"], native["seconds"]))

        _, expected = read_ply(self.bytes_of("native.ply"))
        _, found = read_ply(self.browser.download("at('save-cloud').click()", "torus_normals.ply"))
        self.assertEqual(len(found), count)
        dots = []
        for a, b in zip(expected, found):
            self.assertEqual([a[c] for c in "xyz"], [b[c] for c in "xyz"])
            dots.append(sum(a[c] * b[c] for c in ("nx", "ny", "nz")))
        self.assertGreaterEqual(sum(d > 0 for d in dots), SHARE_OF_SIDES * count)
        self.assertGreaterEqual(sum(d > SAME_DIRECTION for d in dots), SHARE_THE_SAME * count)

        for fact in ["closed", "manifold", "components", "genus"]:
            self.assertEqual(report["mesh"][fact], native["mesh"][fact], fact)
        for size in ["faces", "area", "volume"]:
            self.assertAlmostEqual(report["mesh"][size] / native["mesh"][size], 1, delta=0.01, msg=size)
        mesh = self.browser.download("at('mesh-format').value = 'obj'; at('save-mesh').click()", "torus_mesh.obj")
        self.assertEqual(mesh.count(b"\nf "), report["mesh"]["faces"])
        self.assertEqual(json.loads(self.browser.download("at('save-report').click()", "torus.json")), report)
        self.assertIn(b"scene-data", self.browser.download("at('save-page').click()", "torus.html"))

        figures = self.browser.wait("document.getElementById('figures') && document.getElementById('figures').textContent", place="iframe")
        self.assertIn("manifoldyes", figures)
        self.assertEqual(self.browser.value("g3rViewer.renderer.gl.getError()", "iframe"), 0)
        if "G3R_PICTURE" in os.environ:
            self.browser.wait("!g3rViewer.pending", place="iframe")
            time.sleep(1)  # until the browser has drawn what it was told to
            picture = self.browser.on("page", "Page.captureScreenshot", format="png")["data"]
            with open(os.environ["G3R_PICTURE"], "wb") as file:
                file.write(base64.b64decode(picture))

    def test_numbers_of_text_files_are_those_of_the_program(self):
        self.again()
        # A fourth column may be any number.
        extremes = [1e300, 1e-300, 0.1 + 0.2, 1e22, 123456789012345680.0, 5e-324, -0.0, 1e15, 1e16, 1.5e-7]
        rows = [[*p, extremes[i % len(extremes)]] for i, p in enumerate(torus(2000))]
        write_xyz(self.path("text.xyz"), rows)
        self.expect(OK, "orient", "text.xyz", "native.xyz")
        self.browser.value("at('mesh').checked = false")
        self.drop(self.path("text.xyz"))
        self.browser.value("at('mesh').checked = true")
        self.assertEqual(self.finish(), "result", self.failure())
        text = self.browser.download("at('cloud-format').value = 'xyz'; at('save-cloud').click()", "text_normals.xyz")
        self.browser.value("at('cloud-format').value = 'ply'")
        self.assertEqual([line.split()[:4] for line in text.splitlines()], [line.split()[:4] for line in self.bytes_of("native.xyz").splitlines()])

    def test_what_readers_and_writers_warn_of_is_shown(self):
        self.again()
        # Far from the origin for its numbers, with intensities that LAS has no field for.
        write_ply(self.path("far.ply"), [("float", c) for c in ("x", "y", "z", "intensity")], [[*(4e4 + x for x in p), 0.5] for p in torus(2000)])
        self.expect(OK, "orient", "far.ply", "native.ply", "--report", "native.json")
        self.drop(self.path("far.ply"))
        self.assertEqual(self.finish(), "result", self.failure())
        self.assertIn("coordinates in float32", self.report()["warnings"][0])
        self.assertEqual(self.report()["warnings"][0], self.json_of("native.json")["warnings"][0])
        self.assertIn("coordinates in float32",
                      self.browser.wait("document.getElementById('figures') && document.getElementById('figures').textContent", place="iframe"))
        self.browser.download("at('cloud-format').value = 'las'; at('save-cloud').click()", "far_normals.las")
        self.assertIn("intensity", self.browser.value("at('note').textContent"))
        self.browser.download("at('cloud-format').value = 'ply'; at('save-cloud').click()", "far_normals.ply")
        self.assertEqual(self.browser.value("at('note').textContent"), "")

    def test_cancelling_is_immediate_and_leaves_the_page_as_it_was(self):
        self.again()
        write_ply(self.path("large.ply"), [("double", c) for c in "xyz"], torus(100_000))
        self.drop(self.path("large.ply"))
        self.browser.wait("at('step').textContent.startsWith('Solving') && at('progress').value > 0")
        begin = time.monotonic()
        self.browser.value("at('cancel').click()")
        self.assertEqual(self.state(), "start")
        self.assertLess(time.monotonic() - begin, 30)  # the whole run takes longer by far
        self.assertEqual(self.failure(), "")
        self.solve_sample()

    def test_damaged_files_are_refused_by_name(self):
        header = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
        files = {"empty.ply": b"", "lies.ply": header.encode() + b"1234", "noise.bin": bytes(i * 7919 % 251 for i in range(5000)),
                 "few.xyz": b"0 0 0\n1 0 0\n", "<img src=x onerror=alert(1)>.xyz": b"0 0\n"}
        for name, data in files.items():
            with self.subTest(name):
                self.again()
                with open(self.path(name), "wb") as file:
                    file.write(data)
                self.drop(self.path(name))
                self.assertEqual(self.finish(), "start")
                self.assertIn("4 distinct" if name == "few.xyz" else name, self.failure())
        self.assertEqual(self.browser.value("document.images.length"), 0)
        self.again()
        self.browser.value("at('failure').textContent = ''")
        self.browser.drop(self.folder)  # which is no file
        self.browser.wait("at('failure').textContent.includes('folders')")
        self.solve_sample()

    def test_what_has_no_room_is_refused_before_the_work_and_survived_within(self):
        self.again()
        write_ply(self.path("torus.ply"), [("double", c) for c in "xyz"], torus(100_000))
        # All memory but 64 MB to twice as much, in blocks; 100,000 points need 128 MiB.
        self.browser.value("""var ballast = [];
            for (let at; (at = library._malloc(2 ** 26)) !== 0; ) ballast.push(at);
            library._free(ballast.pop());""", "worker")
        self.assertGreater(self.browser.value("ballast.length", "worker"), 50)
        self.drop(self.path("torus.ply"))
        self.assertEqual(self.finish(), "start")
        self.assertIn("MiB", self.failure())
        # All but a few MB, and no look beforehand.
        self.browser.value("for (let at; (at = library._malloc(2 ** 22)) !== 0; ) ballast.push(at); library._free(ballast.pop())", "worker")
        self.browser.value("state.worker.postMessage({kind: 'run', name: 'a.xyz', bytes: sample(), mesh: true, limited: false}); show('busy')")
        self.assertEqual(self.finish(), "start")
        self.assertIn("out of memory", self.failure())
        self.browser.value("for (const at of ballast) library._free(at)", "worker")
        self.solve_sample()


if __name__ == "__main__":
    unittest.main(verbosity=2)
