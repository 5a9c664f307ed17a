#!/usr/bin/env python3
"""Clouds as sensors and programs deliver them, from formulas: one kind, one file.

    scans.py KIND OUT.ply [--points N]

    house     photogrammetry of a house on its ground, with 800 points in the sky and four fuzzy clouds of 250
    plate     a plate of 300 x 200 mm hit from above and below on a grid of 2 mm, no points on its rim (--thickness, in mm)
    frame     a depth camera at the origin: a ball on a table before a wall, depth in steps
    arch      a dental arch as a scanner in the mouth gives it: one open surface with grooves between the teeth
    airborne  LiDAR from above: rolling ground, gable roofs without walls, crowns of trees
    lines     a sea bed in scan lines: eight times as dense along a line as across
    wires     a ring of which only curves are drawn
    slices    the same ring, as contours of computed tomography
    room      a room and its table, scanned from inside
    table     a pear of revolution and the table that it stands on

What is true of each: house and ground only; genus 0; everything faces the camera; one surface that faces up, for arch, airborne, lines
and table; genus 1 for wires and slices; normals that face the middle of the room. N is about how many points there are. Needs NumPy.
"""

import argparse

import numpy as np


def house(n, rng, _):
    low, high = np.array([-5.0, -4, 0]), np.array([5.0, 4, 6])
    parts = []
    for axis, side in ((0, low), (0, high), (1, low), (1, high), (2, high)):
        wall = low + (high - low) * rng.random((int(n * 0.45 * np.prod(np.delete(high - low, axis)) / 296), 3))
        wall[:, axis] = side[axis]
        parts.append(wall)
    ground = rng.uniform(-15, 15, (int(n * 0.55), 2))
    ground = ground[(abs(ground[:, 0]) > 5) | (abs(ground[:, 1]) > 4)]
    parts.append(np.c_[ground, np.zeros(len(ground))])
    scene = np.concatenate(parts)
    sky = [rng.uniform(-60, 60, (800, 3)) * [1, 1, 0.5] + [0, 0, 30]]
    sky += [rng.normal(centre, 2.0, (250, 3)) for centre in ((30, 20, 25), (-35, 10, 30), (10, -40, 22), (0, 35, 40))]
    return np.concatenate([scene + rng.normal(0, 0.01, scene.shape), *sky])


def plate(n, _, thickness):
    step = np.sqrt(300 * 200 * 2 / n)
    x, y = (a.ravel() for a in np.meshgrid(np.arange(0, 300, step), np.arange(0, 200, step)))
    return np.concatenate([np.c_[x, y, np.full_like(x, thickness)], np.c_[x, y, np.zeros_like(x)]])


def frame(n, *_):
    """A structured-light camera: depth in steps of 1/16 pixel of disparity."""
    focal, base, steps = 525.0, 0.075, 16
    stride = np.sqrt(640 * 480 / n)
    u, v = np.meshgrid(np.arange(0, 640, stride) - 319.5, np.arange(0, 480, stride) - 239.5)
    ray = np.stack([u / focal, v / focal, np.ones_like(u)], -1)
    centre, radius = np.array([0.1, 0.2, 2.0]), 0.3
    table = np.where(v > 0, 0.5 * focal / np.where(v > 0, v, 1), np.inf)
    along, squared = ray @ centre, (ray * ray).sum(-1)
    inside = along**2 - squared * (centre @ centre - radius**2)
    ball = np.where(inside > 0, (along - np.sqrt(np.maximum(inside, 0))) / squared, np.inf)
    disparity = focal * base / np.minimum(np.minimum(table, ball), 3.0)
    seen = (ray * (focal * base * steps / np.round(steps * disparity))[..., None]).reshape(-1, 3)
    return seen * [1, -1, -1]  # y up


def arch(n, rng, _):
    def place(angle, across):
        tooth = np.abs(np.sin(angle * 10.5))
        height = 9 * np.sqrt(np.clip(1 - np.abs(across) ** 2.5, 0, 1)) * (0.65 + 0.35 * np.sqrt(tooth))
        wide = 1 + across * 5 * (0.8 + 0.2 * tooth) / 24
        return np.stack([24 * np.cos(angle) * wide, 30 * np.sin(angle) * wide, height], -1)

    a, s, e = rng.uniform(np.deg2rad(-10), np.deg2rad(190), 12 * n), rng.uniform(-0.995, 0.995, 12 * n), 1e-4
    area = np.linalg.norm(np.cross(place(a, s + e) - place(a, s - e), place(a + e, s) - place(a - e, s)), axis=1)
    kept = np.flatnonzero(rng.random(len(a)) * np.quantile(area, 0.99) < area)[:n]
    return place(a[kept], s[kept]) + rng.normal(0, 0.01, (len(kept), 3))


def airborne(n, rng, _):
    x, y = rng.uniform(0, 120, (2, n))

    def ground(u, v):
        return 1.5 * np.sin(u / 17) * np.cos(v / 23) + 0.2 * u

    z, kept, crowns = ground(x, y), np.ones(n, bool), []
    for i, j in ((0, 2), (1, 0), (2, 3), (3, 1)):
        u, v = 30 * i + 15, 30 * j + 15
        roof = (abs(x - u) < 5) & (abs(y - v) < 7)
        z[roof] = ground(u, v) + 7 - 0.5 * abs(x[roof] - u)
    for _ in range(20):
        u, v = rng.uniform(5, 115, 2)
        radius = rng.uniform(2, 4)
        count = int(3 * np.pi * radius**2 * n / 120**2)
        angle, off = rng.uniform(0, 2 * np.pi, count), np.sqrt(rng.random(count)) * radius
        height = ground(u, v) + 6 + np.sqrt(radius**2 - off**2) * rng.uniform(0.6, 1, count)
        crowns.append(np.c_[u + off * np.cos(angle), v + off * np.sin(angle), height])
        kept &= (np.hypot(x - u, y - v) > radius) | (rng.random(n) < 0.5)  # half of the ground below is hidden
    cloud = np.concatenate([np.c_[x, y, z][kept], *crowns])
    cloud[:, 2] += rng.normal(0, 0.03, len(cloud))
    return cloud


def lines(n, rng, _):
    step = np.sqrt(80 * 120 / 8 / n)
    x, y = (a.ravel() for a in np.meshgrid(np.arange(-40, 40, step), np.arange(0, 120, 8 * step)))
    x, y = x + rng.normal(0, 0.1 * step, x.size), y + rng.normal(0, 0.1 * step, x.size)
    z = 0.8 * np.sin(x / 8) * np.cos(y / 11) - 4 * np.exp(-((x - 10) ** 2 + (y - 60) ** 2) / 200)
    return np.c_[x, y, z + rng.normal(0, 0.2 * step, x.size)]


def ring(around, along):
    wide = 1 + 0.35 * np.cos(along) * (1 + 0.15 * np.cos(3 * around))
    return np.stack([wide * np.cos(around), wide * np.sin(around), 0.35 * np.sin(along) + 0.1 * np.sin(2 * around)], -1)


def wires(n, *_):
    turn = np.linspace(0, 2 * np.pi, n // 14, endpoint=False)
    rings = [ring(np.full_like(turn, a), turn) for a in np.linspace(0, 2 * np.pi, 10, endpoint=False)]
    long = np.linspace(0, 2 * np.pi, n // 14, endpoint=False)
    return np.concatenate(rings + [ring(long, np.full_like(long, b)) for b in np.linspace(0, 2 * np.pi, 4, endpoint=False)])


def slices(n, *_):
    """Where planes z = const meet the ring: 0.35 sin b + 0.1 sin 2a = z for two b."""
    around = np.linspace(0, 2 * np.pi, n // 16, endpoint=False)
    parts = []
    for level in np.linspace(-0.4, 0.4, 9):
        sine = (level - 0.1 * np.sin(2 * around)) / 0.35
        a, b = around[abs(sine) <= 1], np.arcsin(sine[abs(sine) <= 1])
        parts += [ring(a, b), ring(a, np.pi - b)]
    return np.concatenate(parts)


def room(n, rng, _):
    def box(low, high, skipped=()):
        low, high = np.array(low), np.array(high)
        for axis in range(3):
            for side in (low, high):
                if (axis, side is high) in skipped:
                    continue
                area = np.prod(np.delete(high - low, axis))
                face = low + (high - low) * rng.random((int(n * area / 140), 3))
                face[:, axis] = side[axis]
                yield face

    parts = [*box((0.0, 0, 0), (6.0, 5, 2.8)), *box((2.0, 1.5, 0.7), (4.0, 3.0, 0.8))]
    for x in (2.1, 3.8):
        for y in (1.6, 2.8):
            parts += box((x, y, 0), (x + 0.12, y + 0.12, 0.7), skipped=((2, False), (2, True)))
    points = np.concatenate(parts)
    return points + rng.normal(0, 0.003, points.shape)


def table(n, rng, _):
    def radius(t):
        return 0.7 * np.sqrt(t * (1 - t)) * (1.4 - t)

    foot = 0.05  # where the pear meets the table, as a share of its height
    t = rng.uniform(foot, 1, 20 * n)
    slope = (radius(np.minimum(t + 1e-4, 1)) - radius(t - 1e-4)) / 2e-4
    area = radius(t) * np.hypot(1, slope)
    t = t[rng.random(len(t)) < area / area.max()][: int(0.7 * n)]
    turn = rng.uniform(0, 2 * np.pi, len(t))
    pear = np.c_[radius(t) * np.cos(turn), radius(t) * np.sin(turn), t]
    far = np.sqrt(rng.uniform(radius(foot) ** 2, 0.7**2, int(0.3 * n)))
    turn = rng.uniform(0, 2 * np.pi, len(far))
    return np.concatenate([pear, np.c_[far * np.cos(turn), far * np.sin(turn), np.full_like(far, foot)]])


KINDS = {kind.__name__: kind for kind in (house, plate, frame, arch, airborne, lines, wires, slices, room, table)}
USUAL = {"house": 10000, "plate": 30000, "frame": 34240, "arch": 20000, "airborne": 6000, "lines": 19200, "wires": 1000, "slices": 3000,
         "table": 20000}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("out")
    parser.add_argument("--points", type=int)
    parser.add_argument("--thickness", type=float, default=1)
    a = parser.parse_args()
    points = KINDS[a.kind](a.points or USUAL.get(a.kind, 30000), np.random.default_rng(5), a.thickness)
    with open(a.out, "wb") as file:
        file.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(points))
        file.write(b"property float x\nproperty float y\nproperty float z\nend_header\n" + points.astype("<f4").tobytes())


if __name__ == "__main__":
    main()
