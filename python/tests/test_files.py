"""g3r.read, g3r.write, g3r.read_mesh, g3r.Cloud."""

import os
import sys

import numpy as np
import pytest
from conftest import is_outward

import g3r

TETRAHEDRON = (np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]), np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]))


def test_points_come_back(tmp_path, sphere):
    path = tmp_path / "a.ply"
    confidence = np.linspace(0, 1, len(sphere), dtype=np.float32)
    colors = np.full(sphere.shape, 77, np.uint8)
    g3r.write(path, sphere, normals=sphere, confidence=confidence, colors=colors)
    cloud = g3r.read(path)
    np.testing.assert_array_equal(cloud.points, sphere)
    np.testing.assert_allclose(cloud.normals, sphere, atol=1e-6)
    np.testing.assert_allclose(cloud.confidence, confidence, atol=1e-6)
    np.testing.assert_array_equal(cloud.colors, colors)
    assert len(cloud) == len(sphere) and cloud.format.startswith("ply") and "x" in cloud.property_names and cloud.warnings == []
    assert str(len(sphere)) in repr(cloud)


def test_numpy_reads_the_text(tmp_path, sphere):
    confidence = np.linspace(0, 1, len(sphere), dtype=np.float32)
    for name in ("a.xyz", "a.txt"):
        g3r.write(tmp_path / name, sphere, normals=sphere, confidence=confidence)
        columns = np.loadtxt(tmp_path / name, comments="//")
        np.testing.assert_array_equal(columns[:, :3], sphere)
        np.testing.assert_array_equal(columns[:, 3:].astype(np.float32), np.column_stack([sphere, confidence]).astype(np.float32))


def test_views_of_a_cloud_are_read_only_and_keep_it_alive(tmp_path, sphere):
    path = tmp_path / "a.ply"
    g3r.write(path, sphere)
    points = g3r.read(path).points
    np.testing.assert_array_equal(points, sphere)
    with pytest.raises(ValueError):
        points[0] = 0


def test_other_properties_of_a_file_are_kept(tmp_path, sphere):
    path, out = tmp_path / "in.ply", tmp_path / "out.ply"
    lines = ["ply", "format ascii 1.0", "element vertex 5", "property float x", "property float y", "property float z",
             "property ushort intensity", "end_header"] + [f"{x} {y} {z} {i}" for i, (x, y, z) in enumerate(sphere[:5])]
    path.write_text("\n".join(lines) + "\n")
    cloud = g3r.read(path)
    g3r.write(out, cloud, normals=cloud.points)
    back = g3r.read(out)
    assert "intensity" in back.property_names and "nx" in back.property_names


def test_what_a_format_cannot_hold_is_a_warning(tmp_path, sphere):
    path = tmp_path / "in.csv"
    path.write_text("x,y,z,intensity\n" + "".join("%.3f,%.3f,%.3f,0.5\n" % tuple(p) for p in sphere[:50]))
    with pytest.warns(UserWarning, match="intensity") as warned:
        g3r.write(tmp_path / "out.las", g3r.read(path))
    assert warned[0].filename == __file__


@pytest.fixture
def odd(tmp_path, sphere):
    """A file that the reader warns of: its coordinates are rounded to steps of its numbers."""
    path = tmp_path / "odd.ply"
    g3r.write(path, (0.5 * sphere + 4e6).astype(np.float32))
    assert g3r.read(path).warnings
    return path


@pytest.mark.parametrize("how", [str, g3r.read])
def test_what_the_reader_warns_of_is_told(odd, how, tmp_path):
    given, told = how(str(odd)), g3r.read(odd).warnings
    calls = [lambda: g3r.orient(given), lambda: g3r.show(given, open=False), lambda: g3r.reconstruct(given)]
    if how is str:
        calls.append(lambda: g3r.write(tmp_path / "copy.ply", given))
    for call in calls:
        with pytest.warns(UserWarning) as warned:
            call()
        assert [str(w.message) for w in warned] == told and {w.filename for w in warned} == {__file__}
    for mesh in (False, True):
        result = g3r.run(given, mesh=mesh)
        assert result.stats["warnings"][:len(told)] == told and told[0] in result.report


def test_mesh_oriented_takes_the_normals_of_a_file(odd, tmp_path, sphere):
    path = tmp_path / "oriented.ply"
    g3r.write(path, sphere, normals=sphere)
    assert len(g3r.mesh_oriented(path)[1]) == len(g3r.mesh_oriented(g3r.read(path))[1]) > 0
    g3r.write(path, g3r.read(odd), normals=sphere)
    with pytest.warns(UserWarning) as warned:
        g3r.mesh_oriented(path)
    assert [str(w.message) for w in warned[:1]] == g3r.read(odd).warnings[:1] and warned[0].filename == __file__


def test_a_path_is_written_with_all_it_has(tmp_path, sphere):
    confidence = np.linspace(0, 1, len(sphere))
    g3r.write(tmp_path / "src.ply", sphere, normals=sphere, confidence=confidence, colors=np.full(sphere.shape, 9))
    g3r.write(tmp_path / "dst.ply", tmp_path / "src.ply")
    assert g3r.read(tmp_path / "dst.ply").property_names == g3r.read(tmp_path / "src.ply").property_names


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="names of files are UTF-8")
def test_names_that_are_no_utf8(tmp_path, sphere):
    folder = os.fsencode(tmp_path)
    name = os.path.join(folder, b"scan\xe9.ply")
    for path in (name, os.fsdecode(name)):
        g3r.write(path, sphere)
        assert os.listdir(folder) == [b"scan\xe9.ply"] and len(g3r.read(path)) == len(sphere)
        assert g3r.orient(path).shape == sphere.shape
        os.remove(name)
        with pytest.raises(g3r.FileMissingError, match=r"scan\\xe9"):
            g3r.read(path)
        with pytest.raises(g3r.InputError, match="no plan of tiles"):
            g3r.tiles.status(folder)
    g3r.write(name, TETRAHEDRON)
    assert len(g3r.read_mesh(name)[1]) == 4
    g3r.show(TETRAHEDRON[0], faces=TETRAHEDRON[1], open=False).save(os.path.join(folder, b"\xe9.html"))
    assert sorted(os.listdir(folder)) == [b"scan\xe9.ply", b"\xe9.html"]


def test_properties_whose_names_are_no_utf8(tmp_path):
    path = tmp_path / "a.csv"
    path.write_bytes(b"x,y,z,H\xf6he\n1,2,3,4\n5,6,7,8\n")
    assert g3r.read(path).property_names[3] == b"H\xf6he".decode(errors="surrogateescape")


def test_a_file_without_points(tmp_path):
    path = tmp_path / "a.ply"
    path.write_text("ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n")
    cloud = g3r.read(path)
    assert cloud.points.shape == (0, 3) and cloud.points.dtype == np.float64 and len(cloud) == 0 and "0 points" in repr(cloud)
    for given in (path, cloud):
        with pytest.raises(g3r.InputError, match="at least 4"):
            g3r.orient(given)


def test_scanner_positions_are_kept(tmp_path):
    scan = "1\n2\n5 6 {z}\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n5 6 {z} 1\n1 2 3 0.5\n4 5 6 0.5\n"
    path = tmp_path / "a.ptx"
    path.write_text(scan.format(z=7))
    one = g3r.read(path)
    np.testing.assert_array_equal(one.points, [[6, 8, 10], [9, 11, 13]])
    np.testing.assert_array_equal(one.sensor_positions, [[5, 6, 7]])
    assert one.scan_of_point is None
    path.write_text(scan.format(z=7) + scan.format(z=8))
    two = g3r.read(path)
    np.testing.assert_array_equal(two.sensor_positions, [[5, 6, 7], [5, 6, 8]])
    np.testing.assert_array_equal(two.scan_of_point, [0, 0, 1, 1])
    path.write_text("1 2 3\n")
    assert g3r.read(path).sensor_positions is None


def test_switches_of_writing_are_switches(tmp_path, sphere):
    for name in ("ascii", "cloud_compare_names"):
        with pytest.raises(g3r.InputError, match=f"{name} must be True or False"):
            g3r.write(tmp_path / "a.ply", sphere, **{name: "no"})
    assert not (tmp_path / "a.ply").exists()


def test_folders_and_boxes(tmp_path):
    (tmp_path / "a.xyz").write_text("1 2 3\n")
    (tmp_path / "b.xyz").write_text("4 5 6\n")
    np.testing.assert_array_equal(g3r.read(tmp_path).points, [[1, 2, 3], [4, 5, 6]])
    np.testing.assert_array_equal(g3r.read(tmp_path / "*.xyz", box=((2, 2, 2), (9, 9, 9))).points, [[4, 5, 6]])
    assert "no COPC" in g3r.read(tmp_path / "a.xyz", levels=2).warnings[0]
    for options in ({"box": ((7, 7, 7), (9, 9, 9))}, {"box": ((0, 0, 0),)}, {"box": ((1, 1, 1), (0, 0, 0))}, {"box": ((0, 0, "low"), (1, 1, 1))}, {"levels": 0},
                    {"levels": 1.5}, {"levels": 2**40}, {"threads": -1}, {"threads": 10**12}, {"threads": 2.5}, {"min_opacity": 7}, {"min_opacity": np.nan}, {"min_opacity": "none"}, {"all_splats": "no"}):
        with pytest.raises(g3r.InputError):
            g3r.read(tmp_path, **options)


def test_the_issue_in_four_lines(tmp_path, sphere):
    g3r.write(tmp_path / "scan.ply", sphere)
    cloud = g3r.read(tmp_path / "scan.ply")
    g3r.write(tmp_path / "out.ply", cloud, normals=g3r.orient(cloud))
    assert is_outward(g3r.read(tmp_path / "out.ply").normals, sphere)


@pytest.mark.parametrize("extension", ["ply", "obj", "stl"])
def test_meshes_come_back(tmp_path, extension):
    path = tmp_path / f"a.{extension}"
    g3r.write(path, TETRAHEDRON)
    vertices, faces = g3r.read_mesh(path)
    corners = {tuple(sorted(map(tuple, vertices[f].tolist()))) for f in faces}
    assert corners == {tuple(sorted(map(tuple, TETRAHEDRON[0][f].tolist()))) for f in TETRAHEDRON[1]}


def test_vertices_and_faces_can_be_given_apart(tmp_path):
    g3r.write(tmp_path / "a.ply", TETRAHEDRON[0], TETRAHEDRON[1], colors=np.full((4, 3), 9), confidence=np.ones(4))
    assert len(g3r.read_mesh(tmp_path / "a.ply")[1]) == 4


def test_a_result_is_written_as_its_mesh(tmp_path, result):
    g3r.write(tmp_path / "a.ply", result)
    assert len(g3r.read_mesh(tmp_path / "a.ply")[1]) == len(result.faces)


def test_a_result_without_mesh_is_written_as_points(tmp_path, sphere):
    g3r.write(tmp_path / "a.ply", g3r.run(sphere, mesh=False))
    cloud = g3r.read(tmp_path / "a.ply")
    assert is_outward(cloud.normals, sphere) and cloud.confidence is not None and cloud.colors is None
    g3r.write(tmp_path / "a.ply", g3r.run(sphere, colors=np.full(sphere.shape, 9), mesh=False))
    assert (g3r.read(tmp_path / "a.ply").colors == 9).all()


def test_errors_name_the_file(tmp_path, sphere):
    with pytest.raises(g3r.FileMissingError, match="nowhere.ply"):
        g3r.read(tmp_path / "nowhere.ply")
    (tmp_path / "bad.ply").write_bytes(b"ply\nformat ascii 1.0\nelement vertex 5\n")
    with pytest.raises(g3r.InputError, match="bad.ply"):
        g3r.read(tmp_path / "bad.ply")
    with pytest.raises(g3r.FileError):
        g3r.write(tmp_path / "no" / "folder.ply", sphere)
    with pytest.raises(g3r.InputError):
        g3r.write(tmp_path / "a.unknown", sphere)
    with pytest.raises(g3r.InputError):
        g3r.write(tmp_path / "a.ply", sphere, normals=sphere[:5])
    with pytest.raises(g3r.InputError, match="without normals"):
        g3r.write(tmp_path / "a.ply", TETRAHEDRON, normals=TETRAHEDRON[0])
    assert sorted(p.name for p in tmp_path.iterdir()) == ["bad.ply"], "nothing half written is left"


def test_splats_that_are_no_surface_are_left_out(tmp_path):
    names = "x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3".split()
    lines = ["ply", "format ascii 1.0", "element vertex 2", *(f"property float {name}" for name in names), "end_header"]
    path = tmp_path / "a.ply"
    path.write_text("\n".join([*lines, "1 2 3 0 0 0 4 0 0 0 1 0 0 0", "9 2 3 0 0 0 -1 0 0 0 1 0 0 0"]) + "\n")  # opacities 0.98 and 0.27
    cloud = g3r.read(path)
    np.testing.assert_array_equal(cloud.points, [[1, 2, 3]])
    assert "floaters" in cloud.warnings[0]
    assert len(g3r.read(path, all_splats=True)) == 2
