"""Clouds of any number of points from formulas, block by block, so that many processes write one file and a few blocks tell the truth.

    block(SCENE, NOISE, b) -> points (n, 3), true normals (n, 3), which are 0 where no direction is right

ridges: a closed surface with ridges, of one size whatever the number of points; every block is spread over all of it. NOISE is a standard
deviation in radii of the surface.
city: ground, gabled roofs, some of the walls, crowns of trees, as an airborne scanner sees them, 16 points per square metre: a block is a
square of 125 m, and more points are a larger city. NOISE is in metres. Needs NumPy.
"""

import numpy as np

POINTS = 250000  # of a block
SIDE = 125.0  # metres of a block of the city
PLOTS = 2  # houses of a block along a side
TREES = 6  # of a block


def ridges(noise, index, _):
    waves = np.random.default_rng(5)
    length = np.repeat([2.0, 4.0, 8.0, 16.0], 3)
    k = waves.normal(size=(12, 3)) * length[:, None]
    height = 0.12 / length
    phase = waves.uniform(0, 2 * np.pi, 12)
    rng = np.random.default_rng([5, index])
    points, normals, have = [], [], 0
    while have < POINTS:
        u = rng.normal(size=(POINTS, 3))
        u /= np.linalg.norm(u, axis=1)[:, None]
        angle = u @ k.T + phase
        r = 1 + np.sin(angle) @ height
        slope = (np.cos(angle) * height) @ k
        slope -= (slope * u).sum(1)[:, None] * u
        area = r * np.hypot(r, np.linalg.norm(slope, axis=1))
        kept = rng.uniform(0, 4.5, POINTS) < area  # the largest area of a unit of directions is 4.3
        normal = (r[:, None] * u - slope)[kept]
        points.append((r[:, None] * u)[kept])
        normals.append(normal / np.linalg.norm(normal, axis=1)[:, None])
        have += len(normal)
    points, normals = np.vstack(points)[:POINTS], np.vstack(normals)[:POINTS]
    return points + rng.normal(0, noise, points.shape) if noise else points, normals


def ground(x, y):
    """Height of the ground, and its slopes."""
    waves = ((9.0, 310.0, 0.3), (4.0, 127.0, 1.4), (1.0, 41.0, 2.3), (0.3, 13.0, 0.9))
    z, dx, dy = np.zeros(len(x)), np.zeros(len(x)), np.zeros(len(x))
    for height, length, direction in waves:
        c, s = np.cos(direction) / length, np.sin(direction) / length
        z += height * np.sin(c * x + s * y)
        slope = height * np.cos(c * x + s * y)
        dx += c * slope
        dy += s * slope
    return z, dx, dy


def house(rng, corner):
    """Centre, half width and length, height of the eaves, pitch."""
    centre = corner + SIDE / PLOTS * rng.uniform(0.4, 0.6, 2)
    base = ground(centre[:1], centre[1:])[0][0]
    return centre, rng.uniform(4, 9), rng.uniform(6, 18), base + rng.uniform(4, 15), rng.choice([0, 0.3, 0.5, 0.8])


def wall_points(rng, density, centre, width, length, eaves, pitch):
    """Points of the four walls, a quarter as dense as the roof, and their normals."""
    p, n = [], []
    for axis, sign in ((0, -1), (0, 1), (1, -1), (1, 1)):
        along = (length, width)[axis]
        count = int(density / 4 * 2 * along * 8)
        t = rng.uniform(-along, along, count)
        at = np.zeros((count, 3))
        at[:, axis] = sign * (width, length)[axis]
        at[:, 1 - axis] = t
        top = eaves + pitch * (width - np.abs(at[:, 0]))
        at[:, :2] += centre
        low = ground(at[:, 0], at[:, 1])[0]
        at[:, 2] = rng.uniform(low, np.maximum(top, low))
        normal = np.zeros((count, 3))
        normal[:, axis] = sign
        p.append(at)
        n.append(normal)
    return np.vstack(p), np.vstack(n)


def city(noise, index, columns):
    rng = np.random.default_rng([6, index])
    density = POINTS / SIDE**2
    low = SIDE * np.array([index % columns, index // columns])
    houses = [house(rng, low + SIDE / PLOTS * np.array([i, j])) for i in range(PLOTS) for j in range(PLOTS)]
    walls = [wall_points(rng, density, *h) for h in houses]
    x, y = (low + rng.uniform(0, SIDE, (POINTS - sum(len(p) for p, _ in walls), 2))).T
    z, dx, dy = ground(x, y)
    normals = np.c_[-dx, -dy, np.ones(len(x))]
    for centre, width, length, eaves, pitch in houses:
        off = x - centre[0]
        roof = (np.abs(off) < width) & (np.abs(y - centre[1]) < length)
        z[roof] = eaves + pitch * (width - np.abs(off[roof]))
        normals[roof] = np.c_[np.sign(off) * pitch, np.zeros(len(x)), np.ones(len(x))][roof]
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    for centre in low + rng.uniform(5, SIDE - 5, (TREES, 2)):
        radius = rng.uniform(2, 5)
        off = np.hypot(x - centre[0], y - centre[1])
        crown = (off < radius) & (rng.uniform(0, 1, len(x)) < 0.7)  # the other returns are from below
        z[crown] = (ground(*centre[:, None])[0] + 5 + np.sqrt(radius**2 - off[crown] ** 2)) * 1.0
        z[crown] += rng.uniform(-0.4, 0, crown.sum()) * radius
        normals[crown] = 0
    points = np.vstack([np.c_[x, y, z]] + [p for p, _ in walls])
    return points + rng.normal(0, noise, points.shape), np.vstack([normals] + [n for _, n in walls])


SCENES = {"ridges": ridges, "city": city}


def block(scene, noise, index, count):
    """Block `index` of `count`."""
    return SCENES[scene](noise, index, int(np.ceil(np.sqrt(count))))
