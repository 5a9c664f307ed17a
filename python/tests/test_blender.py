"""The add-on for Blender, in Blender as a Python module: pip install bpy, 800 MB on disk, for one version of Python; it needs Debian's libgl1,
libsm6, libxi6, libxfixes3, libxkbcommon0 and libxrender1."""

import importlib.util
import pathlib
import sys

import numpy as np
import pytest

bpy = pytest.importorskip("bpy", reason="the add-on is tested where Blender is installed as a module: pip install bpy")
Matrix = pytest.importorskip("mathutils").Matrix  # comes with bpy

FILE = pathlib.Path(__file__).resolve().parents[2] / "addons" / "blender" / "g3r_point_cloud_to_mesh.py"
# A turn, three scales and a shift, as an object may have: the unit sphere is an ellipsoid in the scene.
PLACED = Matrix.Translation((10, -20, 30)) @ Matrix.Rotation(0.7, 4, (1, 2, 3)) @ Matrix.Diagonal((2, 1, 0.5, 1))
ON_SURFACE = 0.05  # of 600 points on the sphere, about 0.14 apart, the mesh is that near


@pytest.fixture(scope="module")
def add_on():
    spec = importlib.util.spec_from_file_location(FILE.stem, FILE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(autouse=True)
def registered(add_on):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    add_on.register()
    yield
    add_on.unregister()


def add_points(points, transform=PLACED, name="scan"):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, [], [])
    thing = bpy.data.objects.new(name, mesh)
    thing.matrix_world = transform
    bpy.context.collection.objects.link(thing)
    bpy.context.view_layer.objects.active = thing
    thing.select_set(True)
    bpy.context.view_layer.update()
    return thing


def made():
    """The new object: its vertices in the scene and its triangles."""
    bpy.context.view_layer.update()
    thing = bpy.context.object
    to_scene = np.array(thing.matrix_world)
    vertices = np.array([v.co for v in thing.data.vertices]) @ to_scene[:3, :3].T + to_scene[:3, 3]
    return thing, vertices, np.array([p.vertices[:] for p in thing.data.polygons])


def volume(vertices, faces):
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


def is_closed(faces):
    edges = {(a, b) for face in faces.tolist() for a, b in zip(face, face[1:] + face[:1])}
    return len(edges) == 3 * len(faces) and all((b, a) in edges for a, b in edges)


def assert_on_ellipsoid(vertices, transform=PLACED):
    back = np.linalg.inv(np.array(transform))
    np.testing.assert_allclose(np.linalg.norm(vertices @ back[:3, :3].T + back[:3, 3], axis=1), 1, atol=ON_SURFACE)


def test_vertices_become_a_closed_mesh_in_their_place(sphere):
    source = add_points(sphere)
    assert bpy.ops.object.g3r_point_cloud_to_mesh() == {"FINISHED"}
    thing, vertices, faces = made()
    assert thing.name == "scan.mesh" and thing.data.name == "scan.mesh" and thing.select_get() and not source.select_get()
    assert is_closed(faces)
    assert_on_ellipsoid(vertices)
    assert volume(vertices, faces) == pytest.approx(4 / 3 * np.pi, rel=0.1)  # of the ellipsoid; above 0: triangles face outward
    np.testing.assert_allclose(np.array(thing.matrix_world), np.array(source.matrix_world), atol=1e-5)
    assert len(source.data.vertices) == len(sphere), "the points stay"


def test_a_point_cloud_does_as_well(sphere):
    if "POINTCLOUD" not in bpy.ops.object.convert.get_rna_type().properties["target"].enum_items:
        pytest.skip("this Blender makes no point clouds; 4.5 does")
    add_points(sphere)
    bpy.ops.object.convert(target="POINTCLOUD")
    assert bpy.context.object.type == "POINTCLOUD"
    bpy.ops.object.g3r_point_cloud_to_mesh()
    thing, vertices, faces = made()
    assert thing.type == "MESH" and is_closed(faces)
    assert_on_ellipsoid(vertices)


def test_modifiers_are_applied(sphere):
    add_points(sphere, Matrix())
    array = bpy.context.object.modifiers.new("twice", "ARRAY")
    array.use_relative_offset, array.use_constant_offset, array.constant_offset_displace = False, True, (4, 0, 0)
    bpy.ops.object.g3r_point_cloud_to_mesh()
    _, vertices, faces = made()
    assert volume(vertices, faces) == pytest.approx(2 * 4 / 3 * np.pi, rel=0.1) and vertices[:, 0].max() == pytest.approx(5, abs=ON_SURFACE)


def test_a_mirror_and_a_shear_are_kept(sphere):
    """The world matrix of a child has the shear that follows from its parent; an object alone cannot have it."""
    parent = add_points(sphere[:0], Matrix.Diagonal((1, 3, 1, 1)))
    child = add_points(sphere)
    child.parent = parent
    child.matrix_basis = Matrix.Rotation(0.5, 4, "Z") @ Matrix.Diagonal((-1, 1, 1, 1))
    bpy.context.view_layer.update()
    bpy.ops.object.g3r_point_cloud_to_mesh()
    thing, vertices, faces = made()
    assert_on_ellipsoid(vertices, child.matrix_world)
    assert thing.matrix_world.is_negative
    local = np.array([v.co for v in thing.data.vertices])
    assert volume(local, faces) > 0, "Blender draws a mirrored object by its local sides"


@pytest.mark.parametrize("kind", ["FLOAT_COLOR", "BYTE_COLOR"])
def test_colors_are_kept(sphere, kind):
    source = add_points(sphere)
    colors = source.data.color_attributes.new("paint", kind, "POINT")
    shares = np.ones((len(sphere), 4))
    shares[:, :3] = np.where(sphere[:, :1] > 0, (1, 0.2, 0), (0, 0.2, 1))
    colors.data.foreach_set("color_srgb", shares.ravel())
    bpy.ops.object.g3r_point_cloud_to_mesh()
    thing, _, _ = made()
    rgba = np.empty((len(thing.data.vertices), 4), np.float32)
    thing.data.color_attributes["paint"].data.foreach_get("color_srgb", rgba.ravel())
    x = np.array([v.co.x for v in thing.data.vertices])
    np.testing.assert_allclose(rgba[x > 0.2], np.tile((1, 0.2, 0, 1), ((x > 0.2).sum(), 1)), atol=0.01)
    np.testing.assert_allclose(rgba[x < -0.2], np.tile((0, 0.2, 1, 1), ((x < -0.2).sum(), 1)), atol=0.01)


@pytest.mark.parametrize("brightest", [1.5, 200])
def test_colors_that_shine_are_white(sphere, brightest):
    source = add_points(sphere)
    colors = source.data.color_attributes.new("paint", "FLOAT_COLOR", "POINT")
    shares = np.full((len(sphere), 4), brightest, np.float32)
    shares[sphere[:, 0] < 0, :3] = -0.5
    colors.data.foreach_set("color_srgb", shares.ravel())
    assert bpy.ops.object.g3r_point_cloud_to_mesh() == {"FINISHED"}
    thing, _, _ = made()
    rgba = np.empty((len(thing.data.vertices), 4), np.float32)
    thing.data.color_attributes["paint"].data.foreach_get("color_srgb", rgba.ravel())
    x = np.array([v.co.x for v in thing.data.vertices])
    np.testing.assert_allclose(rgba[x > 0.2, :3], 1, atol=0.01)
    np.testing.assert_allclose(rgba[x < -0.2, :3], 0, atol=0.01)


def test_options_are_obeyed(sphere):
    source = add_points(sphere)

    def count(**options):
        bpy.context.view_layer.objects.active = source
        bpy.ops.object.g3r_point_cloud_to_mesh(**options)
        return len(bpy.context.object.data.polygons)

    plain = count()
    assert count(faces=200) == pytest.approx(200, abs=20)
    assert count(depth=4) < plain < count(depth=7)


def test_an_open_scan_is_closed_with_a_warning_or_left_open(sphere, capfd):
    source = add_points(sphere[sphere[:, 2] > 0])
    bpy.ops.object.g3r_point_cloud_to_mesh()
    assert is_closed(made()[2]) and "Warning: " in capfd.readouterr().out
    bpy.context.view_layer.objects.active = source
    bpy.ops.object.g3r_point_cloud_to_mesh(open=True)
    assert not is_closed(made()[2])


@pytest.mark.parametrize("count, options, said", [(3, {}, "points"), (600, {"noise": "much"}, "noise"), (600, {"depth": 2}, "depth")])
def test_what_g3r_refuses_is_said_and_nothing_is_left(sphere, count, options, said):
    add_points(sphere[:count])
    with pytest.raises(RuntimeError, match=f"Error: .*{said}"):  # how Blender hands an error of an operator to Python
        bpy.ops.object.g3r_point_cloud_to_mesh(**options)
    assert len(bpy.data.objects) == len(bpy.data.meshes) == 1


def test_a_missing_package_is_said(sphere, monkeypatch):
    add_points(sphere)
    monkeypatch.setitem(sys.modules, "g3r", None)
    with pytest.raises(RuntimeError, match="g3r cannot be loaded.*-m pip install"):
        bpy.ops.object.g3r_point_cloud_to_mesh()


def test_the_menu_has_the_entry_until_the_add_on_goes(add_on):
    def entries():
        return [entry for entry in bpy.types.VIEW3D_MT_object.draw._draw_funcs if entry.__module__ == add_on.__name__]

    assert len(entries()) == 1
    add_on.unregister()
    assert entries() == [] and not hasattr(bpy.types, "OBJECT_OT_g3r_point_cloud_to_mesh")
    add_on.register()


def test_it_is_for_points_in_object_mode():
    assert not bpy.ops.object.g3r_point_cloud_to_mesh.poll()
    bpy.ops.object.camera_add()
    assert not bpy.ops.object.g3r_point_cloud_to_mesh.poll()
