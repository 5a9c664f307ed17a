"""g3r.score_normals, g3r.score_mesh."""

import numpy as np
import pytest

import g3r

CUBE = (np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float),
        np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]))


def test_angles_are_in_degrees():
    angle = np.radians([0, 4, 8, 172])
    normals = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    score = g3r.score_normals(normals, [[1, 0, 0]] * 4)
    assert score["pco"] == 0.75 and score["pgp5"] == 0.5 and score["pgp10"] == 1
    assert score["rmse"] == pytest.approx(np.sqrt((16 + 64 + 172**2) / 4)) and score["rmse_unoriented"] == pytest.approx(np.sqrt(144 / 4))
    with pytest.raises(g3r.InputError):
        g3r.score_normals(normals, normals[:3])


def test_meshes_are_scored_at_distances():
    moved = (CUBE[0] + [0, 0, 0.1], CUBE[1])
    score = g3r.score_mesh(moved, CUBE, samples=3000, distances=[0.2, 0.01])
    assert [f["distance"] for f in score["f_scores"]] == [0.2, 0.01]
    assert score["f_scores"][0]["f"] == 1 and 0.4 < score["f_scores"][1]["f"] < 0.7  # all sides but two still fit, but for their ends
    assert score["hd"] == pytest.approx(0.1, abs=1e-3) and score["normal_consistency"] > 0.9
    same = g3r.score_mesh(CUBE, CUBE, samples=500)
    assert same["cd"] == pytest.approx(0, abs=1e-12) and same["f_scores"] == []
    for wrong in ({"distances": [0]}, {"distances": ["near"]}, {"samples": 0}, {"samples": -1}, {"samples": 10.5}, {"seed": -1}, {"seed": 0.5}, {"seed": 2**64}, {"samples": 2**64}):
        with pytest.raises(g3r.InputError):
            g3r.score_mesh(CUBE, CUBE, **wrong)
