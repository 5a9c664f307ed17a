"""Hints: up, sensor, inside, seen_from_inside, flip."""

import numpy as np
import pytest
from conftest import is_outward

import g3r


@pytest.fixture(scope="module")
def terrain():
    x, y = np.random.default_rng(5).uniform(-1, 1, (2, 2000))
    return np.stack([x, y, 0.1 * np.sin(4 * x) * np.cos(3 * y)], axis=1)


@pytest.mark.parametrize("up", ["+z", "z", [0, 0.1, 2], np.array([0, 0, 1])])
def test_terrain_faces_up(terrain, up):
    result = g3r.run(terrain, mesh=False, up=up)
    assert (result.normals[:, 2] > 0).all()
    assert result.stats["hints"]["given"] == ["up"] and result.stats["undecided_share"] == 0
    assert (result.confidence > 0.9).mean() > 0.99 and (result.confidence > 0.99).mean() > 0.98  # less at the rim
    assert (g3r.orient(terrain, up="-z")[:, 2] < 0).all()


def test_terrain_faces_its_sensor(terrain):
    assert (g3r.orient(terrain, sensor=[0, 0, -3])[:, 2] < 0).all()
    below_then_above = [[0, 0, -3], [0, 0, 3]]
    assert (g3r.orient(terrain, sensor=below_then_above, sensor_of_point=np.ones(len(terrain), int))[:, 2] > 0).all()
    mostly_unknown = np.where(np.arange(len(terrain)) % 9, -1, 0)
    assert (g3r.orient(terrain, sensor=below_then_above, sensor_of_point=mostly_unknown)[:, 2] < 0).all()


def test_a_file_may_say_where_the_scanner_stood(terrain, tmp_path):
    path = tmp_path / "terrain.pcd"
    header = f"VERSION 0.7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {len(terrain)}\nHEIGHT 1\nVIEWPOINT 0 0 -3 1 0 0 0\n"
    path.write_text(header + f"POINTS {len(terrain)}\nDATA ascii\n" + "".join(f"{x!r} {y!r} {z!r}\n" for x, y, z in terrain.tolist()))
    cloud = g3r.read(path)
    np.testing.assert_array_equal(cloud.sensor_positions, [[0, 0, -3]])
    assert cloud.scan_of_point is None
    for points in (path, cloud):
        assert (g3r.orient(points, sensor="file")[:, 2] < 0).all()
    with pytest.raises(g3r.InputError, match="do not come from a file"):
        g3r.orient(terrain, sensor="file")
    with pytest.raises(g3r.InputError, match="sensor_of_point"):
        g3r.orient(cloud, sensor="file", sensor_of_point=np.zeros(len(terrain), int))


def test_closed_parts_are_turned_by_order(sphere):
    for hint in ({"flip": True}, {"seen_from_inside": True}, {"sensor": [0.1, 0, 0]}):
        assert is_outward(-g3r.orient(sphere, **hint), sphere), hint
    result = g3r.run(sphere, flip=True)
    corner = result.vertices[result.faces]
    assert np.einsum("ij,ij->i", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])).sum() < 0, "faces follow the normals"


def test_a_contradiction_is_a_warning(sphere):
    result = g3r.run(sphere, mesh=False, inside=[0, 0, 4])
    assert is_outward(result.normals, sphere) and any("not inside" in w for w in result.stats["warnings"])
    assert g3r.run(sphere, mesh=False, inside=[[0, 0, 0], [0, 0, 0.5]]).stats["warnings"] == []


@pytest.mark.parametrize("hint", [
    {"up": "w"}, {"up": [0, 0, 0]}, {"up": [1, 2]}, {"up": [[0, 0, 1], [0, 1, 0]]}, {"sensor": "here"}, {"sensor": [0, 0, np.nan]}, {"sensor": "file"},
    {"inside": [[1, 2]]}, {"sensor": [0, 0, 1], "sensor_of_point": [0, 0]}, {"sensor": [0, 0, 1], "sensor_of_point": np.ones(600, int)},
    {"sensor": [0, 0, 1], "sensor_of_point": np.zeros(600)},
    {"sensor": [0, 0, 1], "sensor_of_point": np.full(600, 2**32)}, {"flip": "no"}, {"seen_from_inside": [True, False]},
])
def test_hints_that_cannot_be_meant_are_refused(sphere, hint):
    with pytest.raises(g3r.InputError):
        g3r.orient(sphere, **hint)
