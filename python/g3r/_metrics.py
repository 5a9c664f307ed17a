"""Scores against a reference: those of `g3r eval`."""

from __future__ import annotations

from typing import Any, Dict, Iterable, Tuple

from . import _g3r
from ._arrays import as_faces, as_points
from ._kinds import number, whole

Pair = Tuple[Any, Any]
"""(V, F): vertices (v, 3) and faces (m, 3)."""


def score_normals(normals: Any, truth: Any) -> Dict[str, float]:
    """Normals (n, 3) against true ones, both of any length; a zero normal counts as wrong.

    ae_p: mean of (1 - n . n') / 2. pco: share on the right side. rmse, rmse_unoriented: root of the mean square of the angle to the true
    normal and to the true line, degrees. pgp5, pgp10: share within 5 and 10 degrees of the true line. O(n). Raises InputError.
    """
    return _g3r.score_normals(as_points(normals, "normals"), as_points(truth, "truth"))


def score_mesh(mesh: Pair, truth: Pair, *, samples: int = 200000, seed: int = 0, distances: Iterable[float] = ()) -> Dict[str, Any]:
    """A mesh (V, F) against a true one, both sampled uniformly by area.

    cd, hd: mean and largest distance, both directions. ae_m: mean of (1 - n . n') / 2 over closest pairs. normal_consistency: mean of
    |n . n'|. f_scores: for each of `distances` its precision, recall and f, their harmonic mean. Lengths in units of the meshes.
    samples: points on each mesh; the same seed gives the same ones. O((m + samples) log m). Raises InputError for a mesh without area, a face without its vertices, a distance that is not above 0.
    """
    vertices, true_vertices = as_points(mesh[0], "vertices"), as_points(truth[0], "vertices")
    return _g3r.score_mesh(vertices, as_faces(mesh[1], len(vertices)), true_vertices, as_faces(truth[1], len(true_vertices)),
                           whole("samples", samples), whole("seed", seed), [number("a distance", d) for d in distances])
