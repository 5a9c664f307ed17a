#!/usr/bin/env python3
"""Clouds as DiWR corrupts them (arXiv 2602.13801, appendix A): a density that varies in space, moved points, outliers.

    g3r sample MODEL.ply dense.ply --count 400000
    corrupt.py dense.ply cloud.ply --count 60000 --uneven 1 --noise 0.003 --outliers 0.2
    g3r cloud.ply mesh.ply && g3r eval mesh.ply --truth MODEL.ply

dense.ply has points and normals, at least six of them for a point of the cloud. --uneven: strength of the density field (0 uniform; 1 about
b_u 0.3; 2 about 0.5). --noise: standard deviation of the moves, in longest sides of the box. --outliers: share of all points; --where they
are: in the box enlarged by a tenth, within some 0.03 sides of the surface, or inside. cloud.ply has x, y, z and true_nx, true_ny, true_nz
(0 for outliers), which g3r hands through. Prints DiWR's measures: the number of points, unevenness b_u, noise b_sigma, outliers b_o. Needs
NumPy and SciPy.
"""

import argparse

import numpy as np
from scipy.spatial import cKDTree
from splats import Solid, read_surface, write_ply

NEIGHBOURS = 20
WAVES = 6  # of the density field


def measures(points):
    """Unevenness, noise and outliers of a cloud, in longest sides of its box."""
    unit = (points - points.min(0)) / np.ptp(points, axis=0).max()
    distance, index = cKDTree(unit).query(unit, NEIGHBOURS + 1)
    spacing = distance[:, 1:].mean(1)
    near = unit[index[:, 1:]]
    centred = near - near.mean(1, keepdims=True)
    spread = np.linalg.eigvalsh(np.einsum("nki,nkj->nij", centred, centred) / NEIGHBOURS)
    most = np.sort(spacing)[len(spacing) // 10 : len(spacing) - len(spacing) // 10]
    noise = float(np.median(np.sqrt(np.maximum(spread[:, 0], 0))))
    return most.std() / most.mean(), noise, float((spacing > spacing.mean() + 2 * spacing.std()).mean())


def density(places, uneven, rng):
    """Weights whose logarithm is a sum of waves."""
    field = np.zeros(len(places))
    for _ in range(WAVES):
        field += rng.normal() * np.cos(2 * np.pi * (places @ (rng.normal(size=3) * 1.2) + rng.random()))
    return np.exp(uneven * 0.7 * (field - field.mean()) / field.std())


def corrupt(points, normals, count, uneven, noise, outliers, where, seed):
    """Points and true normals, 0 of outliers, in random order."""
    rng = np.random.default_rng(seed)
    low, size = points.min(0), np.ptp(points, axis=0)
    side = size.max()
    weights = density((points - low) / side, uneven, rng)
    good = int(round(count * (1 - outliers)))
    chosen = rng.choice(len(points), good, replace=False, p=weights / weights.sum())
    moved = points[chosen] + rng.normal(size=(good, 3)) * noise * side
    if where == "box":
        others = low - 0.05 * size + rng.random((count - good, 3)) * 1.1 * size
    elif where == "near":
        others = points[rng.choice(len(points), count - good)] + rng.normal(size=(count - good, 3)) * 0.03 * side
    else:
        others = Solid(points, normals).draw(count - good, rng, inside=True)
    order = rng.permutation(count)
    return np.concatenate([moved, others])[order], np.concatenate([normals[chosen], np.zeros_like(others)])[order]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("surface")
    parser.add_argument("out")
    parser.add_argument("--count", type=int, default=60000)
    parser.add_argument("--uneven", type=float, default=1)
    parser.add_argument("--noise", type=float, default=0)
    parser.add_argument("--outliers", type=float, default=0.2)
    parser.add_argument("--where", default="box", choices=["box", "near", "inside"])
    parser.add_argument("--seed", type=int, default=1)
    a = parser.parse_args()
    points, normals = read_surface(a.surface, 6 * a.count)
    cloud, truth = corrupt(points, normals, a.count, a.uneven, a.noise, a.outliers, a.where, a.seed)
    write_ply(a.out, np.concatenate([cloud, truth], 1), ["x", "y", "z", "true_nx", "true_ny", "true_nz"])
    print(f"n {a.count} b_u {{:.2f}} b_sigma {{:.5f}} b_o {{:.3f}}".format(*measures(cloud)))


if __name__ == "__main__":
    main()
