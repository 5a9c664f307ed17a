"""Objects of other libraries are understood by what they offer."""

import pathlib

import numpy as np
import pytest

import g3r
from g3r._arrays import as_colors, as_faces, as_points, as_values, faces_in


def same(value, sphere):
    points = as_points(value)
    assert points.dtype in (np.float32, np.float64)
    np.testing.assert_allclose(points, sphere, atol=1e-6)
    return points


def test_arrays_are_not_copied(sphere):
    assert np.shares_memory(as_points(sphere), sphere)
    view = np.zeros((len(sphere), 6), np.float32)[:, :3]
    assert np.shares_memory(as_points(view), view)


@pytest.mark.parametrize("dtype", [np.float16, np.longdouble, ">f4", ">f8"])
def test_other_floats_are_converted(sphere, dtype):
    np.testing.assert_allclose(as_points(sphere.astype(dtype)), sphere, atol=1e-3)


def test_integers_are_points():
    assert as_points([[1, 2, 3], [4, 5, 6]]).dtype == np.float64


def test_unaligned_arrays_are_copied(sphere):
    raw = bytearray(b"x" + sphere.tobytes())
    unaligned = np.frombuffer(raw, offset=1, count=sphere.size).reshape(sphere.shape)
    assert as_points(unaligned).flags.aligned
    same(unaligned, sphere)


def test_an_object_with_points(sphere):
    class Open3DLike:  # open3d.geometry.PointCloud: a vector class behind .points, empty ones for what is missing
        points = [list(p) for p in sphere]
        normals = []

    same(Open3DLike(), sphere)


def test_a_tensor_cloud(sphere):
    class Tensor:
        def __init__(self, data):
            self.data = data

        def cpu(self):
            return self

        def numpy(self):
            return self.data

        def __len__(self):
            return len(self.data)

        def __array__(self, *args, **kwargs):
            return self.data

    class TensorCloud:  # open3d.t.geometry.PointCloud
        point = {"positions": Tensor(sphere)}

    assert np.shares_memory(same(TensorCloud(), sphere), sphere)


def test_an_object_with_an_array(sphere):
    class Array:  # JAX: no NumPy array, but __array__
        def __array__(self, dtype=None, copy=None):
            return sphere

    assert np.shares_memory(same(Array(), sphere), sphere)


def test_a_cloud(tmp_path, sphere):
    g3r.write(tmp_path / "a.ply", sphere)
    cloud = g3r.read(tmp_path / "a.ply")
    assert np.shares_memory(same(cloud, sphere), cloud.points)


def test_dlpack(sphere):
    class OnlyDlpack:
        def __dlpack__(self, **kwargs):
            return sphere.__dlpack__(**kwargs)

        def __dlpack_device__(self):
            return sphere.__dlpack_device__()

    assert np.shares_memory(same(OnlyDlpack(), sphere), sphere)


def test_trimesh(sphere):
    trimesh = pytest.importorskip("trimesh")
    for own in (trimesh.PointCloud(sphere), trimesh.creation.box()):
        assert np.shares_memory(same(own, own.vertices), own.vertices)


class TorchLike:
    """torch.Tensor: no array of a tensor with a gradient or on another device before detach() and cpu()."""

    def __init__(self, data, requires_grad, device):
        self.data, self.requires_grad, self.device = data, requires_grad, device
        self.shape, self.dtype = data.shape, "torch.float32"

    def __len__(self):
        return len(self.data)

    def detach(self):
        return TorchLike(self.data, False, self.device)

    def cpu(self):
        return TorchLike(self.data, self.requires_grad, "cpu")

    def numpy(self):
        if self.requires_grad:
            raise RuntimeError("Can't call numpy() on Tensor that requires grad.")
        if self.device != "cpu":
            raise TypeError("can't convert cuda:0 device type tensor to numpy.")
        return self.data

    def __array__(self, dtype=None, copy=None):
        return self.numpy()

    def __dlpack__(self, **kwargs):
        if self.requires_grad:
            raise BufferError("Can't export tensors that require gradient")
        return self.data.__dlpack__(**kwargs)


@pytest.mark.parametrize("requires_grad", [False, True])
@pytest.mark.parametrize("device", ["cpu", "cuda:0"])
def test_an_object_like_a_torch_tensor(sphere, requires_grad, device):
    assert np.shares_memory(same(TorchLike(sphere, requires_grad, device), sphere), sphere)


def test_torch(sphere):
    torch = pytest.importorskip("torch")
    assert np.shares_memory(same(torch.from_numpy(sphere).requires_grad_(), sphere), sphere)


def test_pyvista(sphere):
    pyvista = pytest.importorskip("pyvista")
    own = pyvista.PolyData(sphere)
    assert np.shares_memory(same(own, sphere), own.points)
    assert as_faces(pyvista.Sphere().faces, 10**6).shape[1] == 3


def test_open3d(sphere):
    open3d = pytest.importorskip("open3d")
    same(open3d.geometry.PointCloud(open3d.utility.Vector3dVector(sphere)), sphere)
    own = open3d.t.geometry.PointCloud(sphere)
    assert np.shares_memory(same(own, sphere), own.point["positions"].numpy())


def test_pandas(sphere):
    pandas = pytest.importorskip("pandas")
    same(pandas.DataFrame(sphere, columns=list("xyz")), sphere)


def test_colors():
    np.testing.assert_array_equal(as_colors([[0, 128, 255]], 1), [[0, 128, 255]])
    np.testing.assert_array_equal(as_colors([[0.0, 0.5, 1.0, 0.3]], 1), [[0, 128, 255]])
    for wrong in ([[0, 0, 256]], [[-1, 0, 0]], [[0, 0]], [["r", "g", "b"]], [[0, 0, 0]] * 2):
        with pytest.raises(g3r.InputError):
            as_colors(wrong, 1)


def test_whole_numbers_beyond_one_are_bytes():
    np.testing.assert_array_equal(as_colors([[10.0, 200.0, 0.0], [255.0, np.nan, 1.0]], 2), [[10, 200, 0], [255, 0, 1]])
    np.testing.assert_array_equal(as_colors([[-0.004, 1.004, np.nan]], 1), [[0, 255, 0]])
    for wrong in ([[0.0, 0.5, 1.5]], [[0.0, 256.0, 1.0]], [[-1.0, 0.0, 0.0]], [[-0.5, 0.5, 0.5]]):
        with pytest.raises(g3r.InputError, match="bytes .* or shares"):
            as_colors(wrong, 1)


def test_masked_numbers_are_no_points(sphere):
    for dtype, expected in (("f4", "f4"), ("f8", "f8"), ("i4", "f8")):
        masked = np.ma.array(np.full((3, 3), 7, dtype), mask=np.eye(3, dtype=bool))
        points = as_points(masked)
        assert points.dtype == expected and np.isnan(points.diagonal()).all() and (points[~np.eye(3, dtype=bool)] == 7).all()
    assert np.shares_memory(as_points(np.ma.array(sphere)), sphere), "nothing is masked"


def test_masked_attributes_are_refused():
    mask = [[True, False, False]]
    for refuse in (lambda: as_colors(np.ma.array([[1, 2, 3]], mask=mask), 1), lambda: as_faces(np.ma.array([[0, 1, 2]], mask=mask), 3),
                   lambda: as_values(np.ma.array([1.0], mask=[True]), 1, "confidence")):
        with pytest.raises(g3r.InputError, match="must not be masked"):
            refuse()
    np.testing.assert_array_equal(as_colors(np.ma.array([[1, 2, 3]]), 1), [[1, 2, 3]])


def test_faces():
    np.testing.assert_array_equal(as_faces([[0, 1, 2]], 3), [[0, 1, 2]])
    np.testing.assert_array_equal(as_faces(np.array([3, 0, 1, 2, 3, 2, 1, 0]), 3), [[0, 1, 2], [2, 1, 0]])
    for wrong in ([[0, 1, 3]], [[-1, 0, 1]], [[0.0, 1.0, 2.0]], [[0, 1]]):
        with pytest.raises(g3r.InputError):
            as_faces(wrong, 3)


def test_faces_of_an_object():
    class Trimesh:  # trimesh.Trimesh: `triangles` are the corners of the faces
        triangles = np.zeros((1, 3, 3))
        faces = np.array([[0, 1, 2]])

    class Open3D:  # open3d.geometry.TriangleMesh
        triangles = [[0, 1, 2]]

    class Points:
        triangles = np.zeros((1, 3, 3))

    assert faces_in(Trimesh()) is Trimesh.faces and faces_in(Open3D()) is Open3D.triangles and faces_in(Points()) is None


def test_trimesh_is_a_mesh(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    ball = trimesh.creation.icosphere()
    g3r.write(tmp_path / "a.ply", ball)
    assert len(g3r.read_mesh(tmp_path / "a.ply")[1]) == len(ball.faces)
    assert '"mesh"' in g3r.show(ball, open=False).html


def test_values():
    assert as_values([1, 0.5], 2, "confidence").dtype == np.float32
    with pytest.raises(g3r.InputError):
        as_values(["a", "b"], 2, "confidence")
    with pytest.raises(g3r.InputError):
        as_values([1, 0.5], 3, "confidence")


def test_a_path_is_read(tmp_path, sphere):
    path = pathlib.Path(tmp_path) / "sphere.ply"
    g3r.write(path, sphere)
    np.testing.assert_array_equal(as_points(path), sphere)
    assert g3r.orient(str(path)).shape == sphere.shape
