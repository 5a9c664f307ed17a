#!/usr/bin/env python3
"""Scenes of Gaussian splats with truth: splats on the surface of a closed mesh, splats inside of it, and floaters.

    g3r sample MODEL.ply dense.ply --count 400000
    splats.py make dense.ply scene.ply --count 50000            # what 3DGS writes, and the truth beside it
    g3r orient scene.ply oriented.ply && splats.py score oriented.ply

dense.ply has points and normals; its points are those of the surface, at least four of them for a splat, as the inside is where the
nearest one says. In the scene, all lengths in spacings h of the splats on the surface:
  80 %  lie on the surface, but for noise of 0.1 along the normal; discs of about 0.8 by 0.8 by 0.08, tilted by about 10 degrees, half of
        them of an opacity above 0.82;
  15 %  inside (--inside): half of them anywhere, half 3 below the surface on the average, where training splits splats; of the same sizes
        and opacities, turned anyhow, as no picture shows them;
   5 %  float outside (--floating), in the box enlarged by half: blobs of 2 to 6, of an opacity of 0.02 to 0.4.
scene.ply has the properties of 3DGS (logarithms of scales, logits of opacities, quaternions) and true_nx, true_ny, true_nz, kind
(0 surface, 1 inside, 2 floating), which g3r hands through; `score` prints, as JSON, how many of each kind are left, and the share of those
on the surface whose normals are on the right side. --spz FILE writes the splats as SPZ too. Needs NumPy and SciPy.
"""

import argparse
import gzip
import json
import struct

import numpy as np
from scipy.spatial import cKDTree

TYPES = {"float": "<f4", "double": "<f8", "uchar": "u1", "int": "<i4", "float32": "<f4", "float64": "<f8"}
HARMONIC = 0.28209479177387814  # Y_0
SPLAT = ["x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2",
         "rot_0", "rot_1", "rot_2", "rot_3", "true_nx", "true_ny", "true_nz", "kind"]


def read_ply(path):
    """The points of a binary PLY, as a structured array."""
    with open(path, "rb") as file:
        names, count = [], 0
        while (words := file.readline().split()) != [b"end_header"]:
            if not words:
                raise SystemExit(f"{path}: expected a binary PLY")
            if words[0] == b"element":
                count = int(words[2]) if words[1] == b"vertex" else count
            if words[0] == b"property":
                names.append((words[2].decode(), TYPES[words[1].decode()]))
        return np.frombuffer(file.read(count * np.dtype(names).itemsize), dtype=names)


def read_surface(path, least):
    """Positions and normals (n, 3) of the `least` points or more of a surface in a binary PLY."""
    table = read_ply(path)
    if len(table) < least:
        raise SystemExit(f"{path}: expected at least {least} points, found {len(table)}")
    return (np.stack([table[prefix + axis] for axis in "xyz"], 1).astype(float) for prefix in ("", "n"))


def write_ply(path, table, names):
    """A float property for every column."""
    with open(path, "wb") as file:
        file.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(table))
        file.write("".join(f"property float {name}\n" for name in names).encode() + b"end_header\n" + table.astype("<f4").tobytes())


def turned_to(direction, rng):
    """Quaternions w x y z that turn the z axis to unit directions (n, 3), after a random turn around it."""
    half = np.pi * rng.random(len(direction))
    around = np.stack([np.cos(half), np.zeros_like(half), np.zeros_like(half), np.sin(half)], 1)
    w = 1 + direction[:, 2]
    to = np.stack([w, -direction[:, 1], direction[:, 0], np.zeros_like(w)], 1)
    to[w < 1e-9] = [0, 1, 0, 0]
    to /= np.linalg.norm(to, axis=1, keepdims=True)
    a, b = to.T, around.T
    return np.stack([a[0] * b[0] - a[3] * b[3], a[1] * b[0] + a[2] * b[3], a[2] * b[0] - a[1] * b[3], a[3] * b[0] + a[0] * b[3]], 1)


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


class Solid:
    """What the points of a closed surface, with normals, surround."""

    def __init__(self, points, normals):
        self.points, self.normals, self.tree = points, normals, cKDTree(points)
        self.low, self.high = points.min(0), points.max(0)

    def depth(self, places):
        """Above 0 inside."""
        nearest = self.tree.query(places)[1]
        return -((places - self.points[nearest]) * self.normals[nearest]).sum(1)

    def draw(self, count, rng, inside, larger=1.0):
        """Uniform inside, or outside but in the box enlarged so many times."""
        found = np.zeros((0, 3))
        while len(found) < count:
            places = (self.low + self.high) / 2 + (rng.random((count, 3)) - 0.5) * larger * (self.high - self.low)
            found = np.concatenate([found, places[(self.depth(places) > 0) == inside]])
        return found[:count]


def scene(points, normals, count, inside, floating, seed):
    rng = np.random.default_rng(seed)
    solid = Solid(points, normals)
    few_inside, few_floating = int(round(count * inside)), int(round(count * floating))
    surface = count - few_inside - few_floating
    chosen = rng.choice(len(points), surface, replace=False)
    near = cKDTree(points[chosen]).query(points[chosen], 7)[0][:, 6]
    h = float(np.median(near) * np.sqrt(np.pi / 6))  # six points in a disc of this radius
    normal = normals[chosen]
    on = points[chosen] + 0.1 * h * rng.normal(size=(surface, 1)) * normal
    below = points[rng.choice(len(points), 4 * few_inside)]
    below = below - rng.exponential(3 * h, (len(below), 1)) * normals[solid.tree.query(below)[1]]
    below = below[solid.depth(below) > 0.5 * h][:few_inside // 2]
    within = np.concatenate([below, solid.draw(few_inside - len(below), rng, True)])
    outside = solid.draw(few_floating, rng, False, 1.5)

    kind = np.repeat([0, 1, 2], [surface, few_inside, few_floating])
    place = np.concatenate([on, within, outside])
    size = h * np.exp(0.3 * rng.normal(size=(count, 3))) * [0.8, 0.8, 0.08]
    size[kind == 2] = h * rng.uniform(2, 6, (few_floating, 3))
    opacity = 1 / (1 + np.exp(-1.5 - 1.5 * rng.normal(size=count)))
    opacity[kind == 2] = rng.uniform(0.02, 0.4, few_floating)
    axis = unit(rng.normal(size=(count, 3)))
    axis[kind == 0] = unit(normal + np.tan(np.radians(10)) / np.sqrt(2) * rng.normal(size=normal.shape))
    truth = np.zeros((count, 3))
    truth[kind == 0] = normal
    color = 0.5 * (place - solid.low) / (solid.high - solid.low).max() / HARMONIC
    logit = np.log(opacity / (1 - opacity))[:, None]
    table = np.concatenate([place, np.zeros((count, 3)), color, logit, np.log(size), turned_to(axis, rng), truth, kind[:, None]], 1)
    return table[rng.permutation(count)]


def write_spz(path, table):
    """Version 2: 24 bits of position, 12 of them after the point; 8 bits of all else."""
    value = dict(zip(SPLAT, table.T))
    stack = lambda *names: np.stack([value[name] for name in names], 1)
    fixed = np.round(stack("x", "y", "z") * 4096).astype("<i4")
    quaternion = unit(stack("rot_0", "rot_1", "rot_2", "rot_3"))
    quaternion *= np.where(quaternion[:, :1] < 0, -1, 1)
    to_bytes = lambda values: np.clip(np.round(values), 0, 255).astype(np.uint8).tobytes()
    blocks = b"".join([fixed[:, :, None].view(np.uint8).reshape(len(table), 3, 4)[:, :, :3].tobytes(),
                       to_bytes(255 / (1 + np.exp(-value["opacity"]))),
                       to_bytes((stack("f_dc_0", "f_dc_1", "f_dc_2") * 0.15 + 0.5) * 255),
                       to_bytes((stack("scale_0", "scale_1", "scale_2") + 10) * 16), to_bytes((quaternion[:, 1:] + 1) * 127.5)])
    with gzip.open(path, "wb") as file:
        file.write(struct.pack("<4sIIBBBB", b"NGSP", 2, len(table), 0, 12, 0, 0) + blocks)


def score(table):
    kind = table["kind"]
    dot = sum(table["n" + a].astype(float) * table["true_n" + a] for a in "xyz")[kind == 0]
    left = {name: int((kind == k).sum()) for k, name in enumerate(["surface", "inside", "floating"])}
    return {"left": left, "right": float((dot > 0).mean())}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(dest="command", required=True)
    make = commands.add_parser("make", help="a scene from points with normals")
    make.add_argument("surface")
    make.add_argument("out")
    make.add_argument("--count", type=int, default=50000)
    make.add_argument("--inside", type=float, default=0.15)
    make.add_argument("--floating", type=float, default=0.05)
    make.add_argument("--seed", type=int, default=1)
    make.add_argument("--spz")
    judge = commands.add_parser("score", help="of a scene that g3r has oriented")
    judge.add_argument("oriented")
    arguments = parser.parse_args()
    if arguments.command == "score":
        print(json.dumps(score(read_ply(arguments.oriented))))
        return
    points, normals = read_surface(arguments.surface, 4 * arguments.count)
    table = scene(points, normals, arguments.count, arguments.inside, arguments.floating, arguments.seed)
    write_ply(arguments.out, table, SPLAT)
    if arguments.spz:
        write_spz(arguments.spz, table)


if __name__ == "__main__":
    main()
