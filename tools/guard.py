#!/usr/bin/env python3
"""Holds g3r to what it has been: accuracy, size of the mesh and peak memory on three clouds from formulas.

    tools/guard.py                # the program of build/release against tests/guard.json (.ci/run does this)
    tools/guard.py --update       # after an intended change: writes tests/guard.json anew
    tools/guard.py --base COMMIT  # against that commit, which is built in build/guard: also instructions, which takes minutes

The values are those of one thread, and hold on any x86-64 machine: each has a tolerance that other vector instructions and another
compiler stay within. They fail in both directions, so that a gain is kept. Instructions depend on processor and compiler, so that they are
compared with a base only, both sides counted by callgrind (Debian's valgrind) on this machine; its files stay in build/guard.
"""

import argparse
import io
import json
import math
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
STORED = ROOT / "tests" / "guard.json"
FOLDER = ROOT / "build" / "guard"
POINTS = 10000  # memory of the points is most of the peak from here on; the three take 10 seconds
NOISE = 0.02  # standard deviation of each coordinate, where the spacing is 0.04
COUNTED_POINTS = 500  # callgrind takes 50 times as long
# Shares of the value. Without vector instructions the values are those with AVX2 to three digits, and memory within 4 %.
TOLERANCE = {"ae_p": 0.10, "pco": 0.001, "triangles": 0.02, "peak_mib": 0.05, "instructions": 0.05}
# Differences below are none: angles that are float rounding, and pages of libraries that another system maps otherwise.
FLOOR = {"ae_p": 1e-6, "peak_mib": 3.0}


def ring(draw):
    """A torus under noise of half a spacing: a handle, and errors that are none of rounding."""
    u, v = 2 * math.pi * draw(), 2 * math.pi * draw()
    normal = (math.cos(v) * math.cos(u), math.cos(v) * math.sin(u), math.sin(v))
    point = ((1 + 0.4 * math.cos(v)) * math.cos(u), (1 + 0.4 * math.cos(v)) * math.sin(u), 0.4 * math.sin(v))
    return tuple(x + 2 * NOISE * (draw() + draw() + draw() - 1.5) for x in point), normal


def plate(draw):
    """A box, thin in z: sharp edges and two facing sides."""
    half = (1.0, 0.7, 0.1)
    areas = [half[1] * half[2], half[2] * half[0], half[0] * half[1]]
    pick = draw() * sum(areas)
    axis = 0 if pick < areas[0] else 1 if pick < areas[0] + areas[1] else 2
    sign = 1.0 if draw() < 0.5 else -1.0
    point = [(2 * draw() - 1) * h for h in half]
    point[axis] = sign * half[axis]
    return tuple(point), tuple(sign if a == axis else 0.0 for a in range(3))


def balls(draw):
    """Two spheres beside each other: parts that have to agree on outside."""
    z, angle = 2 * draw() - 1, 2 * math.pi * draw()
    across = math.sqrt(1 - z * z)
    normal = (across * math.cos(angle), across * math.sin(angle), z)
    side = -0.55 if draw() < 0.5 else 0.55
    return (side + 0.5 * normal[0], 0.5 * normal[1], 0.5 * normal[2]), normal


MODELS = {"ring": ring, "plate": plate, "balls": balls}


def write_cloud(model, count, points, truth):
    """The cloud without its normals to `points`, with them to `truth`: the same bytes everywhere."""
    draw = random.Random(1).random
    with open(points, "w", encoding="ascii") as bare, open(truth, "w", encoding="ascii") as full:
        for _ in range(count):
            point, normal = MODELS[model](draw)
            position = " ".join("%.9f" % x for x in point)
            bare.write(position + "\n")
            full.write(position + " " + " ".join("%.9f" % x for x in normal) + "\n")


def command(program, folder, points):
    return [program, points, folder / "mesh.ply", "--oriented", folder / "oriented.ply", "--threads", "1", "--device", "cpu", "--quiet"]


def peak_of_run(program, folder, points):
    """MiB at most of one run."""
    child = subprocess.Popen(command(program, folder, points))
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode:
        sys.exit("guard: g3r ended with %d on %s" % (child.returncode, points))
    return usage.ru_maxrss / 1024


def instructions_of_run(program, folder, points, profile):
    counter = ["valgrind", "--tool=callgrind", "--callgrind-out-file=%s" % profile]
    result = subprocess.run(counter + command(program, folder, points), capture_output=True, text=True, check=True)
    return int(re.search(r"Collected : (\d+)", result.stderr).group(1))


def measure(program, model, folder, profile=None):
    """What is compared of one model; instructions where there is a file for callgrind's profile."""
    points, truth = folder / (model + ".xyz"), folder / (model + ".truth.xyz")
    write_cloud(model, POINTS, points, truth)
    peak = peak_of_run(program, folder, points)
    evaluation = subprocess.run([program, "eval", folder / "oriented.ply", "--truth", truth], capture_output=True, check=True)
    scores = json.loads(evaluation.stdout)
    with open(folder / "mesh.ply", "rb") as mesh:
        triangles = int(re.search(rb"element face (\d+)", mesh.read(4096)).group(1))
    values = {"ae_p": float("%.3g" % scores["ae_p"]), "pco": scores["pco"], "triangles": triangles, "peak_mib": round(peak, 1)}
    if profile:
        write_cloud(model, COUNTED_POINTS, points, truth)
        values["instructions"] = instructions_of_run(program, folder, points, profile)
    return values


def measure_all(program, name, counted):
    with tempfile.TemporaryDirectory() as folder:
        return {model: measure(program, model, pathlib.Path(folder), FOLDER / ("%s.%s.callgrind" % (name, model)) if counted else None)
                for model in MODELS}


def built(commit):
    """The program of a commit, built as build/release is."""
    git = ["git", "-C", str(ROOT)]
    answer = subprocess.run(git + ["rev-parse", "--verify", commit + "^{commit}"], stdout=subprocess.PIPE, text=True, check=False)
    if answer.returncode:
        sys.exit("guard: --base: expected a commit, found %s" % commit)
    identity = answer.stdout.strip()
    folder = FOLDER / identity
    if not (folder / "source").exists():
        archive = subprocess.run(git + ["archive", identity], capture_output=True, check=True).stdout
        with tarfile.open(fileobj=io.BytesIO(archive)) as files:
            files.extractall(folder / "source")
    options = {"CMAKE_BUILD_TYPE": "Release", "G3R_SOURCES": ROOT / "build" / "sources"}
    options.update({"G3R_BUILD_" + part: "OFF" for part in ("TESTS", "BENCH", "EXAMPLES")})
    configure = ["cmake", "-S", folder / "source", "-B", folder / "release", "-G", "Ninja", "--log-level=WARNING"]
    subprocess.run(configure + ["-D%s=%s" % option for option in options.items()], check=True)
    subprocess.run(["cmake", "--build", folder / "release", "--target", "g3r_cli"], check=True)
    return folder / "release" / "cli" / "g3r"


def differences(base, head):
    """One line for each value that is further from the base's than its tolerance."""
    lines = []
    for model, values in base.items():
        for name, was in values.items():
            now = head[model][name]
            if abs(now - was) > max(TOLERANCE[name] * abs(was), FLOOR.get(name, 0)):
                lines.append("guard: %s: %s is %g, and was %g" % (model, name, now, was))
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build" / "release" / "cli" / "g3r")
    choice = parser.add_mutually_exclusive_group()
    choice.add_argument("--base", metavar="COMMIT")
    choice.add_argument("--update", action="store_true")
    arguments = parser.parse_args()
    if arguments.base and not shutil.which("valgrind"):
        sys.exit("guard: --base counts instructions, for which there is no valgrind: apt-get install valgrind")
    base_program = built(arguments.base) if arguments.base else None
    head = measure_all(arguments.program, "head", arguments.base)
    for model, values in head.items():
        print("guard: %s: %s" % (model, ", ".join("%s %.10g" % item for item in values.items())))
    if arguments.update:
        STORED.write_text(json.dumps(head, indent=2) + "\n", encoding="ascii")
    base = measure_all(base_program, "base", True) if base_program else json.loads(STORED.read_text(encoding="ascii"))
    found = differences(base, head)
    if found:
        remedy = "" if base_program else "\nguard: if that is meant: tools/guard.py --update, and say why in the commit"
        sys.exit("\n".join(found) + remedy)
    print("guard: %d values of %d models are what they were" % (sum(len(values) for values in base.values()), len(base)))


if __name__ == "__main__":
    main()
