"""What the tests of the g3r program share: running it, and writing and reading small files. Standard library only."""

import functools
import json
import math
import os
import shutil
import struct
import subprocess
import tempfile
import unittest

G3R = os.environ["G3R_PROGRAM"]
RUNNER = os.environ.get("G3R_RUNNER", "").split()  # what runs a program of another system: Wine
ON_WINDOWS = G3R.endswith(".exe")
NOBODY = 65534

OK, USAGE, BAD_DATA, NO_INPUT, UNAVAILABLE, OUT_OF_MEMORY = 0, 64, 65, 66, 69, 71
CANNOT_CREATE, INPUT_OUTPUT, INTERRUPTED, TERMINATED = 73, 74, 130, 143

STRUCT = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d",
          "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I", "float32": "f", "float64": "d"}

# What LeakSanitizer says when its own tracer crashes, as it sometimes does while threads end: nothing about the program, which runs again.
LEAK_SANITIZER_FAILED = b"LeakSanitizer has encountered a fatal error"
ATTEMPTS = 3


@functools.cache
def is_sanitized():
    """Sanitizers reserve terabytes of addresses, so limits on memory mean nothing to them."""
    with open(G3R, "rb") as program:
        return b"__asan_init" in program.read()


def thinned(count):
    """Half as many points under sanitizers, where a solve takes 20 times as long; what is asserted holds for both."""
    return count // 2 if is_sanitized() else count


def needs(what):
    """Leaves a test out where the program is one of Windows, which has no `what`."""
    return unittest.skipIf(ON_WINDOWS, "Windows has no " + what)


def sphere(count, radius=1.0, centre=(0.0, 0.0, 0.0)):
    """Points spread evenly over a sphere; the true normal of a point is its direction from the centre."""
    golden = math.pi * (3 - math.sqrt(5))
    points = []
    for i in range(count):
        z = 1 - (2 * i + 1) / count
        ring = math.sqrt(1 - z * z)
        points.append((centre[0] + radius * ring * math.cos(i * golden), centre[1] + radius * ring * math.sin(i * golden), centre[2] + radius * z))
    return points


def write_xyz(path, rows):
    with open(path, "w") as file:
        for row in rows:
            file.write(" ".join(repr(float(value)) for value in row) + "\n")


def write_ply(path, properties, rows):
    """properties: [(type, name)]; a binary little endian PLY with one vertex element."""
    header = "ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(rows)
    header += "".join("property %s %s\n" % p for p in properties) + "end_header\n"
    layout = struct.Struct("<" + "".join(STRUCT[kind] for kind, _ in properties))
    with open(path, "wb") as file:
        file.write(header.encode("latin-1"))
        for row in rows:
            file.write(layout.pack(*row))


def write_points(path, points):
    write_ply(path, [("double", "x"), ("double", "y"), ("double", "z")], points)


def read_ply(data):
    """The vertices of a binary little endian PLY without lists: (property names in order, [{name: value}])."""
    end = data.index(b"end_header\n") + len(b"end_header\n")
    properties, count, in_vertex = [], 0, False
    for line in data[:end].decode("latin-1").splitlines():
        words = line.split()
        if words[:1] == ["format"]:
            assert words[1] == "binary_little_endian", line
        if words[:1] == ["element"]:
            in_vertex = words[1] == "vertex"
            count = int(words[2]) if in_vertex else count
        if words[:1] == ["property"] and in_vertex:
            properties.append((words[1], words[2]))
    names = [name for _, name in properties]
    layout = struct.Struct("<" + "".join(STRUCT[kind] for kind, _ in properties))
    return names, [dict(zip(names, layout.unpack_from(data, end + i * layout.size))) for i in range(count)]


def write_cube(path, side=1.0):
    corners = [(x, y, z) for x in (0, side) for y in (0, side) for z in (0, side)]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    with open(path, "w") as file:
        for corner in corners:
            file.write("v %g %g %g\n" % corner)
        for a, b, c, d in quads:
            file.write("f %d %d %d\nf %d %d %d\n" % (a + 1, b + 1, c + 1, a + 1, c + 1, d + 1))


class Result:
    def __init__(self, code, out, err):
        self.code, self.out, self.err = code, out, err.decode("utf-8", "replace")


class ProgramTest(unittest.TestCase):
    """A test with a folder of its own, which is also the working directory of the program."""

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="g3r-cli-")
        os.chmod(self.folder, 0o777)
        self.addCleanup(shutil.rmtree, self.folder, True)

    def path(self, name):
        return os.path.join(self.folder, name)

    def bytes_of(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def json_of(self, name):
        return json.loads(self.bytes_of(name))

    def start(self, *arguments, **options):
        options.setdefault("stdin", subprocess.DEVNULL)
        options.setdefault("stdout", subprocess.PIPE)
        options.setdefault("stderr", subprocess.PIPE)
        return subprocess.Popen([*RUNNER, G3R, *arguments], cwd=self.folder, **options)

    def run_g3r(self, *arguments, data=None, **options):
        if data is not None:
            options["stdin"] = subprocess.PIPE
        for _ in range(ATTEMPTS):
            process = self.start(*arguments, **options)
            out, err = process.communicate(data)
            if LEAK_SANITIZER_FAILED not in err:
                break
        return Result(process.returncode, out, err)

    def expect(self, code, *arguments, **options):
        """Runs the program and checks its exit code. A failure must say why, and any end must leave no temporary file."""
        before = set(os.listdir(self.folder))
        result = self.run_g3r(*arguments, **options)
        self.assertEqual([name for name in os.listdir(self.folder) if name.endswith(".g3r.tmp") and name not in before], [])
        self.assertEqual(result.code, code, "g3r %s\n%s" % (" ".join(arguments), result.err))
        if code not in (OK, BAD_DATA) or "--strict" not in arguments and code != OK:
            self.assertTrue(result.err.startswith("g3r: ") or "\ng3r: " in result.err, result.err)
        return result


def all_of_terminal(main):
    """What was written to a pseudo-terminal until its other end was closed, by its main end, which is closed too."""
    text = b""
    try:
        while chunk := os.read(main, 4096):
            text += chunk
    except OSError:  # Linux ends a closed terminal with EIO
        pass
    os.close(main)
    return text


def dropped_to_nobody():
    """Options of start() under which file permissions count: root may do anything."""
    return {"user": NOBODY, "group": NOBODY, "extra_groups": []} if os.geteuid() == 0 else {}
