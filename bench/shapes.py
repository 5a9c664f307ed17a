#!/usr/bin/env python3
"""Closed shapes from formulas, as ground truth that nobody tuned on: thin walls, narrow gaps, handles, many parts, creases.

    shapes.py FOLDER                 # all of them, a PLY mesh each, for g3r_bench_table --data FOLDER
    shapes.py FOLDER pages room      # these

A shape is where a function is negative, contoured by marching cubes on a grid. Most functions are distances, or nearly; lengths are in
units of a box of side 2. Needs NumPy, SciPy and scikit-image.
"""

import argparse
import functools
import pathlib

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree
from skimage.measure import marching_cubes

from mesh_file import write_mesh

CELLS = 280  # along the longest side of the box: what is thinner than a few cells is not what the formula says
MARGIN = 1.08  # half side of the box
SPURIOUS = 1e-3  # of the triangles


def ball(p, centre, radius):
    return np.sqrt(sum((p[a] - centre[a]) ** 2 for a in range(3))) - radius


def box(p, low, high):
    return intersection(*[np.maximum(low[a] - p[a], p[a] - high[a]) for a in range(3)])


def union(*parts):
    return functools.reduce(np.minimum, parts)


def intersection(*parts):
    return functools.reduce(np.maximum, parts)


def minus(a, b):
    return np.maximum(a, -b)


def tube(p, line, radius):
    """Distance to a polygon line (n, 3), minus the radius."""
    steps = np.concatenate([np.linspace(line[i], line[i + 1], 24, endpoint=False) for i in range(len(line) - 1)])
    grid = np.stack([np.broadcast_to(x, np.broadcast_shapes(*(q.shape for q in p))) for x in p], axis=-1)
    distance, _ = cKDTree(steps).query(grid.reshape(-1, 3), distance_upper_bound=radius + 0.1)
    return np.minimum(distance.reshape(grid.shape[:3]), radius + 0.1) - radius


def knot(p, radius):
    t = np.linspace(0, 2 * np.pi, 200)
    r = 0.62 + 0.25 * np.cos(3 * t)
    return tube(p, np.stack([r * np.cos(2 * t), r * np.sin(2 * t), 0.3 * np.sin(3 * t)], axis=1), radius)


def spring(p):
    t = np.linspace(0, 12 * np.pi, 300)
    return tube(p, np.stack([0.7 * np.cos(t), 0.7 * np.sin(t), t / (6 * np.pi) - 1], axis=1) * 0.9, 0.07)


def bowl(p, thickness):
    shell = minus(ball(p, (0, 0, 0.2), 0.95), ball(p, (0, 0, 0.2), 0.95 - thickness))
    return np.maximum(shell, p[2] - 0.2)


def gyroid(p, cells, thickness):
    x, y, z = (np.pi * cells * q for q in p)
    field = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)
    return np.abs(field) / (1.5 * np.pi * cells) - thickness / 2


def schwarz(p):
    x, y, z = (2 * np.pi * q for q in p)
    return intersection((np.cos(x) + np.cos(y) + np.cos(z)) / (2 * np.pi), box(p, [-0.9] * 3, [0.9] * 3))


def lattice(p):
    bars = []
    for a in range(3):
        b, c = (a + 1) % 3, (a + 2) % 3
        u, v = ((q + 0.9) % 0.45 for q in (p[b], p[c]))
        bars.append(np.hypot(np.minimum(u, 0.45 - u), np.minimum(v, 0.45 - v)) - 0.06)
    return intersection(union(*bars), box(p, [-0.96] * 3, [0.96] * 3))


def heat_sink(p):
    parts = [box(p, (-0.9, -0.9, -0.6), (0.9, 0.9, -0.45))]
    parts += [box(p, (x - 0.035, -0.9, -0.5), (x + 0.035, 0.9, 0.6)) for x in np.linspace(-0.85, 0.85, 11)]
    return union(*parts)


def menger(p):
    shape = box(p, [-0.95] * 3, [0.95] * 3)
    for level in range(2):
        side = 1.9 / 3**level
        q = [np.abs((x + 0.95) % side - side / 2) - side / 6 for x in p]
        holes = union(*[np.maximum(q[a], q[(a + 1) % 3]) for a in range(3)])
        shape = np.maximum(shape, -holes)
    return shape


def balls(p, apart):
    random = np.random.default_rng(5)
    if not apart:
        return union(*[ball(p, random.uniform(-0.65, 0.65, 3), random.uniform(0.15, 0.35)) for _ in range(30)])
    kept = []
    while len(kept) < 40:
        centre, radius = random.uniform(-0.8, 0.8, 3), random.uniform(0.07, 0.25)
        if all(np.linalg.norm(centre - c) > radius + r + 0.03 for c, r in kept):
            kept.append((centre, radius))
    return union(*[ball(p, c, r) for c, r in kept])


def spiky(p):
    random = np.random.default_rng(7)
    shape = ball(p, (0, 0, 0), 0.5)
    for _ in range(60):
        axis = random.normal(size=3)
        axis /= np.linalg.norm(axis)
        along = sum(p[a] * axis[a] for a in range(3))
        off = np.sqrt(np.maximum(sum(q * q for q in p) - along**2, 0))
        shape = np.minimum(shape, intersection(off - 0.13 * (1 - along), -along, along - 0.9))
    return shape


def roll(p):
    """A plate rolled up: walls of 0.07, gaps of 0.09."""
    radius, angle = np.hypot(p[0], p[1]), np.arctan2(p[1], p[0])
    turn = (radius - 0.16 * angle / (2 * np.pi)) % 0.16
    wall = np.abs(turn - 0.08) - 0.035
    return intersection(wall, radius - 0.9, 0.2 - radius, np.abs(p[2]) - 0.6)


def cups(p):
    parts = []
    for k in range(4):
        z = -0.8 + 0.16 * k
        radius = np.hypot(p[0], p[1]) - 0.25 * (p[2] - z)
        outer = intersection(radius - 0.5, z - p[2], p[2] - z - 1.0)
        parts.append(minus(outer, intersection(radius - 0.46, z + 0.04 - p[2])))
    return union(*parts)


def pages(p):
    """Leaves side by side, joined at a back: walls of 0.06, gaps of 0.1."""
    parts = [box(p, (-0.9, -0.9, -0.7), (-0.8, 0.9, 0.7))]
    for k in range(9):
        slope = (k - 4) * 0.02
        middle = (k - 4) * 0.16 + slope * (p[0] + 0.9)
        parts.append(intersection(np.abs(p[2] - middle) - 0.03, box(p, (-0.9, -0.85, -1.05), (0.85, 0.85, 1.05))))
    return union(*parts)


def moebius(p):
    angle = np.arctan2(p[1], p[0])
    u, v = np.hypot(p[0], p[1]) - 0.65, p[2]
    along = u * np.cos(angle / 2) + v * np.sin(angle / 2)
    across = -u * np.sin(angle / 2) + v * np.cos(angle / 2)
    return np.maximum(np.abs(along) - 0.3, np.abs(across) - 0.04)


def nested_shells(p):
    shells = [minus(ball(p, (0, 0, 0), r), ball(p, (0, 0, 0), r - 0.08)) for r in (0.95, 0.75, 0.55)]
    return union(ball(p, (0, 0, 0), 0.3), *shells)


def tree(p):
    random = np.random.default_rng(3)
    shape = tube(p, np.array([(0, 0, -0.95), (0, 0, -0.1)]), 0.09)
    tips = [(np.array([0, 0, -0.1]), np.array([0.0, 0, 1]), 0.08)]
    for _ in range(4):
        grown = []
        for start, direction, radius in tips:
            for _ in range(2):
                turned = direction + random.normal(size=3) * 0.55
                turned /= np.linalg.norm(turned)
                end = start + turned * radius * 3.6
                shape = np.minimum(shape, tube(p, np.stack([start, end]), radius))
                grown.append((end, turned, radius * 0.75))
        tips = grown
    return shape


def nut(p):
    sides = [p[0] * np.cos(k * np.pi / 3) + p[1] * np.sin(k * np.pi / 3) - 0.8 for k in range(6)]
    thread = 0.04 * np.abs(((p[2] / 0.1 - np.arctan2(p[1], p[0]) / (2 * np.pi)) % 1) - 0.5)
    hole = np.hypot(p[0], p[1]) - 0.45 - thread
    return intersection(*sides, np.abs(p[2]) - 0.35, -hole)


def room(p):
    """A box of thin walls with a door, a table, a shelf, a lamp."""
    walls = minus(box(p, (-0.95, -0.95, -0.7), (0.95, 0.95, 0.7)), box(p, (-0.9, -0.9, -0.65), (0.9, 0.9, 0.65)))
    walls = minus(walls, box(p, (-0.3, -1.1, -0.65), (0.1, -0.8, 0.2)))
    table = [box(p, (-0.5, 0.0, -0.25), (0.4, 0.6, -0.2))]
    table += [box(p, (x, y, -0.68), (x + 0.05, y + 0.05, -0.22)) for x in (-0.45, 0.3) for y in (0.05, 0.5)]
    shelf = [box(p, (0.6, -0.6, z), (0.92, 0.3, z + 0.035)) for z in (-0.4, -0.1, 0.2)]
    lamp = [tube(p, np.array([(0, 0.3, 0.68), (0, 0.3, 0.4)]), 0.02), ball(p, (0, 0.3, 0.32), 0.12)]
    return union(walls, *table, *shelf, *lamp)


def in_ball(shape, p):
    return np.maximum(shape, ball(p, (0, 0, 0), 0.95))


SHAPES = {
    "balls_apart": lambda p: balls(p, True),
    "balls_union": lambda p: balls(p, False),
    "bowl_thick": lambda p: bowl(p, 0.1),
    "bowl_thin": lambda p: bowl(p, 0.04),
    "cups": cups,
    "gyroid": lambda p: in_ball(gyroid(p, 2, 0.08), p),
    "gyroid_thin": lambda p: in_ball(gyroid(p, 3, 0.05), p),
    "heat_sink": heat_sink,
    "hollow_ball": lambda p: minus(ball(p, (0, 0, 0), 0.95), ball(p, (0, 0, 0), 0.88)),
    "knot_thick": lambda p: knot(p, 0.14),
    "knot_thin": lambda p: knot(p, 0.05),
    "lattice": lattice,
    "menger": menger,
    "moebius": moebius,
    "nested_shells": nested_shells,
    "nut": nut,
    "pages": pages,
    "roll": roll,
    "room": room,
    "schwarz": schwarz,
    "spiky": spiky,
    "spring": spring,
    "tree": tree,
}


def mesh(shape):
    line = np.linspace(-MARGIN, MARGIN, CELLS + 1)
    p = line[:, None, None], line[None, :, None], line[None, None, :]
    field = np.broadcast_to(SHAPES[shape](p), (len(line),) * 3)
    vertices, faces, _, _ = marching_cubes(field, 0, gradient_direction="ascent")
    return without_spurious(vertices * (2 * MARGIN / CELLS) - MARGIN, faces)


def without_spurious(vertices, faces):
    """Only the components of at least SPURIOUS of the triangles: smaller ones are corners that the grid cut off."""
    links = coo_matrix((np.ones(2 * len(faces)), (faces[:, [0, 1]].ravel(), faces[:, [1, 2]].ravel())), shape=(len(vertices),) * 2)
    _, part = connected_components(links, directed=False)
    large = np.bincount(part[faces[:, 0]], minlength=part.max() + 1) >= SPURIOUS * len(faces)
    faces = faces[large[part[faces[:, 0]]]]
    used, faces = np.unique(faces, return_inverse=True)
    return vertices[used], faces.reshape(-1, 3)


def volume(vertices, faces):
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("shapes", nargs="*", metavar="SHAPE", help=f"of {', '.join(SHAPES)}")
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    for shape in arguments.shapes or SHAPES:
        vertices, faces = mesh(shape)
        if volume(vertices, faces) < 0:
            faces = faces[:, ::-1]
        write_mesh(arguments.folder / f"{shape}.ply", vertices, faces)
        print(f"{shape}: {len(faces)} triangles, volume {abs(volume(vertices, faces)):.3f}")


if __name__ == "__main__":
    main()
