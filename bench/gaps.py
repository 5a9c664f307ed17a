#!/usr/bin/env python3
"""Closed shapes whose walls or gaps are a given number of spacings thick, to measure how often their topology is right.

    gaps.py FOLDER                   # all of them, with gaps of 1, 1.5, 2 and 3 spacings of 5,000 points: 40 PLY meshes
    gaps.py FOLDER --points 20000 --gaps 1 2
    g3r_bench_table --data FOLDER --points 5000 --mesh --method default --method true --json table.json
    gaps.py FOLDER --score table.json

A shape is made of cells of a rectilinear grid, in spacings, and as large as it has to be for its area to be that of the points. Some are
bent afterwards. All are turned, as no scanner is aligned with what it sees. Needs NumPy.
"""

import argparse
import collections
import json
import pathlib

import numpy as np

from mesh_file import write_mesh

WALL = 3.5  # spacings, of what is not the wall or gap that is asked about
TURN = np.linalg.qr(np.random.default_rng(11).normal(size=(3, 3)))[0]


def boxes(add, cut=()):
    """Vertices and quadrilaterals of the union of boxes (low, high) less others: cells of the grid of all their planes."""
    every = np.array([b for b in [*add, *cut]], dtype=float)
    lines = [np.unique(np.round(every[:, :, a], 9)) for a in range(3)]
    middle = [(x[1:] + x[:-1]) / 2 for x in lines]
    full = np.zeros([len(m) for m in middle], dtype=bool)
    for group, value in ((add, True), (cut, False)):
        for low, high in group:
            within = [(m > low[a]) & (m < high[a]) for a, m in enumerate(middle)]
            full[np.ix_(*within)] = value
    return lines, full


def split(lines, full, axis, longest):
    """The same with no cell longer than this along the axis that is bent."""
    count = np.maximum(1, np.ceil(np.diff(lines[axis]) / longest).astype(int))
    pieces = [np.linspace(x, y, n, endpoint=False) for x, y, n in zip(lines[axis][:-1], lines[axis][1:], count)]
    lines = [np.append(np.concatenate(pieces), x[-1]) if a == axis else x for a, x in enumerate(lines)]
    return lines, np.repeat(full, count, axis=axis)


def surface(lines, full, bend=None, round_axis=None):
    """Triangles of the boundary. `round_axis`: the last plane along it is the first."""
    number, vertices, triangles = {}, [], []

    def vertex(key):
        if round_axis is not None:
            key = tuple(k % (len(lines[a]) - 1) if a == round_axis else k for a, k in enumerate(key))
        if key not in number:
            number[key] = len(vertices)
            vertices.append([lines[a][key[a]] for a in range(3)])
        return number[key]

    for cell in np.argwhere(full):
        for a in range(3):
            b, c = (a + 1) % 3, (a + 2) % 3
            for side in (0, 1):
                other = cell.copy()
                other[a] += 2 * side - 1
                if a == round_axis:
                    other[a] %= full.shape[a]
                if 0 <= other[a] < full.shape[a] and full[tuple(other)]:
                    continue
                corner = []
                for db, dc in ((0, 0), (1, 0), (1, 1), (0, 1)):
                    key = cell.copy()
                    key[a] += side
                    key[b] += db
                    key[c] += dc
                    corner.append(vertex(tuple(key)))
                if side == 0:
                    corner.reverse()
                triangles += [[corner[0], corner[1], corner[2]], [corner[0], corner[2], corner[3]]]
    vertices = np.array(vertices)
    return (vertices if bend is None else bend(vertices)), np.array(triangles)


def round_z(v):
    """(radius, angle, z) to (x, y, z)."""
    return np.stack([v[:, 0] * np.cos(v[:, 1]), v[:, 0] * np.sin(v[:, 1]), v[:, 2]], axis=1)


def fin_row(size, wall, gap, count=6):
    width = count * wall + (count - 1) * gap
    add = [((-WALL, -WALL, 0), (width + WALL, size, WALL))]
    return add + [((k * (wall + gap), 0, 0), (k * (wall + gap) + wall, size - WALL, 0.4 * size)) for k in range(count)]


def fins(size, gap):
    return surface(*boxes(fin_row(size, WALL, gap)))


def thin_fins(size, gap):
    return surface(*boxes(fin_row(size, gap, WALL)))


def bent_fins(size, gap):
    radius = 0.8 * size

    def bend(v):
        return round_z(np.stack([radius + v[:, 2], v[:, 1] / radius, v[:, 0]], axis=1))

    return surface(*split(*boxes(fin_row(size, WALL, gap)), 1, 1.0), bend)


def slots(size, gap):
    count = 8
    width = count * gap + (count + 1) * WALL
    cut = [((WALL + k * (WALL + gap), WALL, -1), (WALL + gap + k * (WALL + gap), size - WALL, 9)) for k in range(count)]
    return surface(*boxes([((0, 0, 0), (width, size, WALL))], cut))


def holes(size, gap):
    side, pitch, count = 2 * gap, 2 * gap + WALL, 5
    cut = []
    for i in range(count):
        for j in range(count):
            low = (WALL + i * pitch, WALL + j * pitch)
            cut.append(((low[0], low[1], -1), (low[0] + side, low[1] + side, 9)))
    return surface(*boxes([((0, 0, 0), (size, size, WALL))], cut))


def combs(size, gap):
    """Two combs whose teeth lie between each other."""
    teeth, step = 4, 2 * (WALL + gap)
    width = teeth * step
    add = [((0, -WALL, 0), (width, 0, size / 3)), ((0, size, 0), (width, size + WALL, size / 3))]
    for k in range(teeth):
        add.append(((k * step, 0, 0), (k * step + WALL, size - gap, size / 3)))
        add.append(((k * step + WALL + gap, gap, 0), (k * step + 2 * WALL + gap, size, size / 3)))
    return surface(*boxes(add))


def tray_in_tray(size, gap):
    high = 0.4 * size
    add = [((0, 0, 0), (size, size, high))]
    cut = [((WALL, WALL, WALL), (size - WALL, size - WALL, 2 * high))]
    outer = boxes(add, cut)
    low, top = WALL + gap, size - WALL - gap
    inner = boxes([((low, low, low), (top, top, high + WALL))], [((low + WALL, low + WALL, low + WALL), (top - WALL, top - WALL, 2 * high))])
    return both(surface(*outer), surface(*inner))


def pockets(size, gap):
    """Square pockets with walls as thick as the gap between them."""
    side, count = 8.0, 4
    width = count * side + (count + 1) * gap
    cut = []
    for i in range(count):
        for j in range(count):
            low = (gap + i * (side + gap), gap + j * (side + gap))
            cut.append(((low[0], low[1], WALL), (low[0] + side, low[1] + side, 2 * size)))
    return surface(*boxes([((0, 0, 0), (width, width, WALL + size / 10))], cut))


def hinge(size, gap):
    """A tube in a ring."""
    turn, radius = 2 * np.pi, 0.2 * size
    pin = boxes([((radius - WALL, 0, -0.1 * size), (radius, turn, size))])
    ring = boxes([((radius + gap, 0, 0), (radius + gap + WALL, turn, 0.9 * size))])
    return both(*[surface(*split(*part, 1, 0.1), round_z, 1) for part in (pin, ring)])


def roll(size, gap):
    """A plate rolled up, with this gap between its turns."""
    pitch, inner, turns = WALL + gap, 8.0, 3

    def bend(v):
        return round_z(np.stack([v[:, 0] + inner + pitch * v[:, 1] / (2 * np.pi), v[:, 1], v[:, 2]], axis=1))

    plate = boxes([((0, 0, 0), (WALL, 2 * np.pi * turns, size))])
    return surface(*split(*plate, 1, 0.1), bend)


def both(a, b):
    return np.concatenate([a[0], b[0]]), np.concatenate([a[1], b[1] + len(a[0])])


SHAPES = {f.__name__: f for f in (fins, thin_fins, bent_fins, slots, holes, combs, tray_in_tray, pockets, hinge, roll)}


def area(mesh):
    a, b, c = (mesh[0][mesh[1][:, k]] for k in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


def fitted(shape, gap, points):
    """As large as gives each of the points an area of 1."""
    low, high = 20.0, 2000.0
    for _ in range(12):
        middle = np.sqrt(low * high)
        low, high = (middle, high) if area(SHAPES[shape](middle, gap)) < points else (low, middle)
    return SHAPES[shape](high, gap)


def outward(mesh):
    """Bending may turn a solid inside out."""
    a, b, c = (mesh[0][mesh[1][:, k]] for k in range(3))
    return mesh[0], mesh[1] if np.einsum("ij,ij->", a, np.cross(b, c)) > 0 else mesh[1][:, ::-1]


def topology(mesh):
    """Components and genus."""
    parent = list(range(len(mesh[0])))

    def find(i):
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    edges = collections.Counter()
    for t in mesh[1]:
        for k in range(3):
            edges[tuple(sorted((int(t[k]), int(t[(k + 1) % 3]))))] += 1
            parent[find(int(t[k]))] = find(int(t[(k + 1) % 3]))
    assert set(edges.values()) == {2}, "not a manifold"
    parts = len({find(i) for i in range(len(parent))})
    return parts, parts - (len(mesh[0]) - len(edges) + len(mesh[1])) // 2


def score(folder, table):
    """By method and gap: how many of the meshes have the right number of components and the right genus, and the sum of what is wrong."""
    truth = json.loads((folder / "truth.json").read_text())
    right, wrong = collections.Counter(), collections.Counter()
    for row in json.loads(table.read_text())["rows"]:
        parts, genus = truth[row["model"]]
        mesh = row["mesh"]
        gap = row["model"].rsplit("_", 1)[1]
        ok = mesh["components"] == parts and mesh["genus"] == genus
        for key in ((row["method"], gap), (row["method"], "all")):
            right[key] += ok
            wrong[key] += abs(mesh["genus"] - genus) + abs(mesh["components"] - parts)
        if not ok:
            print(f"{row['method']:10} {row['model']:20} components {mesh['components']} of {parts}, genus {mesh['genus']} of {genus}")
    for key in sorted(right):
        print(f"{key[0]:10} {key[1]:5} {right[key]} right, {wrong[key]} handles and components wrong")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--points", type=int, default=5000)
    parser.add_argument("--gaps", type=float, nargs="+", default=[1, 1.5, 2, 3])
    parser.add_argument("--score", type=pathlib.Path, metavar="TABLE")
    arguments = parser.parse_args()
    if arguments.score:
        score(arguments.folder, arguments.score)
        return
    arguments.folder.mkdir(parents=True, exist_ok=True)
    truth = {}
    for shape in SHAPES:
        for gap in arguments.gaps:
            mesh = fitted(shape, gap, arguments.points)
            name = f"{shape}_{gap:g}"
            truth[name] = topology(mesh)
            write_mesh(arguments.folder / f"{name}.ply", *outward((mesh[0] @ TURN.T, mesh[1])))
            print(f"{name}: {len(mesh[1])} triangles, {truth[name][0]} components, genus {truth[name][1]}")
    (arguments.folder / "truth.json").write_text(json.dumps(truth))


if __name__ == "__main__":
    main()
