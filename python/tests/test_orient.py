"""g3r.orient, g3r.run, g3r.reconstruct, g3r.mesh_oriented, g3r.Field."""

import copy
import os
import pickle
import signal
import sys
import threading
import time

import numpy as np
import pytest
from conftest import is_outward, sphere_points

import g3r


def test_orient_gives_unit_outward_normals_in_order(sphere):
    normals = g3r.orient(sphere)
    assert normals.dtype == np.float64 and is_outward(normals, sphere)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, rtol=1e-12)


def test_result_does_not_depend_on_the_memory_layout(sphere):
    reference = g3r.orient(sphere)
    wide = np.zeros((len(sphere), 5))
    wide[:, 1:4] = sphere
    for same in (np.asfortranarray(sphere), wide[:, 1:4], sphere[::-1].copy()[::-1], sphere.tolist(), sphere.astype(">f8"),
                 np.repeat(sphere, 2, axis=0)[::2]):
        np.testing.assert_array_equal(g3r.orient(same), reference)


def test_float32_is_taken_as_it_is(sphere):
    single = sphere.astype(np.float32)
    np.testing.assert_array_equal(g3r.orient(single), g3r.orient(single.astype(np.float64)))


def test_points_that_are_not_finite_get_zero_normals(sphere):
    points = sphere.copy()
    points[7] = np.nan
    normals = g3r.orient(points)
    assert (normals[7] == 0).all() and np.isfinite(normals).all()


def test_run_gives_everything(result, sphere):
    assert is_outward(result.normals, sphere)
    assert result.confidence.shape == (len(sphere),) and result.confidence.min() >= 0 and result.confidence.max() <= 1
    assert result.areas.sum() == pytest.approx(4 * np.pi, rel=0.2)
    assert result.vertices.shape[1] == 3 and result.vertices.dtype == np.float64
    assert result.faces.dtype == np.uint32 and result.faces.max() < len(result.vertices)
    assert result.vertex_colors.shape == result.vertices.shape and result.vertex_confidence.shape == (len(result.vertices),)
    assert result.stats["schema"] == "g3r.report" and result.stats["input"]["points"] == len(sphere)
    assert result.stats["mesh"]["faces"] == len(result.faces)
    assert "faces" in repr(result)


def test_run_without_mesh(sphere):
    result = g3r.run(sphere, mesh=False)
    assert result.vertices is None and result.faces is None and result.stats["mesh"] is None
    assert "no mesh" in repr(result)


def test_arrays_outlive_the_result(sphere):
    normals = g3r.run(sphere, mesh=False).normals
    copy = normals.copy()
    sphere_points(5000)  # memory that was freed would be used again
    np.testing.assert_array_equal(normals, copy)
    normals[0] = 0  # owned and writable


@pytest.mark.parametrize("given", [np.array, lambda p: p.astype(np.float32), lambda p: p.astype(np.float16), np.ndarray.tolist])
def test_a_result_has_its_own_points_and_colors(sphere, given):
    points, colors = given(sphere), np.full(sphere.shape, 9, np.uint8)
    kept = np.array(points, np.float64)
    result = g3r.run(points, colors=colors, mesh=False)
    points[:], colors[:] = points[::-1], 0
    np.testing.assert_array_equal(result.points, kept)
    assert (result.colors == 9).all()


def test_points_of_a_cloud_are_not_copied(tmp_path, sphere):
    g3r.write(tmp_path / "a.ply", sphere)
    cloud = g3r.read(tmp_path / "a.ply")
    assert np.shares_memory(g3r.run(cloud, mesh=False).points, cloud.points)


def test_reconstruct_gives_a_mesh_and_colors(sphere):
    vertices, faces = g3r.reconstruct(sphere)
    corner = vertices[faces]
    volume = np.einsum("ij,ij->i", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])).sum() / 6
    assert volume > 0, "faces are counter-clockwise seen from outside"
    colors = np.zeros_like(sphere)
    colors[:, 1] = 1.0  # shares of 1 are bytes after
    _, _, carried = g3r.reconstruct(sphere, colors=colors)
    assert carried.dtype == np.uint8 and (carried == [0, 255, 0]).all()


@pytest.mark.parametrize("options, components", [
    ({}, 2), ({"keep_largest": 1}, 1), ({"keep_largest": 1.0}, 1), ({"keep_largest": 2}, 2), ({"min_component": 0}, 2), ({"min_component": 400}, 1),
    ({"mesher": "field"}, 2), ({"max_memory": 8e9}, 2),
])
def test_mesh_options_are_taken(sphere, options, components):
    points = np.concatenate([sphere, [3, 0, 0] + 0.4 * sphere_points(200)])
    normals = np.concatenate([sphere, sphere_points(200)])
    result = g3r.run(points, **options)
    assert result.stats["mesh"]["components"] == components
    vertices, _ = g3r.mesh_oriented(points, normals, **options)
    assert (vertices[:, 0].max() > 2) == (components == 2)


def test_keep_all_keeps_what_few_points_hold(sphere):
    few = sphere_points(7)
    points, normals = np.concatenate([sphere, [-2, 0, 0] + 0.15 * few]), np.concatenate([sphere, few])
    for keep_all in (False, True, np.True_):
        assert (g3r.mesh_oriented(points, normals, keep_all=keep_all)[0][:, 0].min() < -1.5) == keep_all


def test_the_size_of_a_mesh_is_taken(sphere):
    for run in (lambda **options: g3r.run(sphere, **options).faces, lambda **options: g3r.mesh_oriented(sphere, sphere, **options)[1]):
        for faces in (200, 500.0):
            assert len(run(faces=faces)) == pytest.approx(faces, abs=10)
        assert len(run(depth=5)) < len(run(depth=6)) / 3
    assert g3r.run(sphere, depth=5).stats["scales"]["depth"] == 5


def test_trim_is_taken(sphere):
    part = sphere[sphere[:, 2] > -0.5]
    for trim in ("auto", True, 0.5):
        assert not g3r.run(part, trim=trim).stats["mesh"]["closed"]
    assert g3r.run(part).stats["mesh"]["closed"]


def test_trim_is_a_switch_too(sphere):
    part = sphere[sphere[:, 2] > -0.5]
    faces = {repr(trim): len(g3r.mesh_oriented(part, part, trim=trim, keep_all=True)[1]) for trim in (True, False, np.True_, "auto")}
    assert faces["True"] == faces["'auto'"] == faces[repr(np.True_)] < faces["False"]


def test_mesh_oriented_warns_of_what_is_doubtful(sphere):
    part = sphere[sphere[:, 2] > 0]
    with pytest.warns(UserWarning, match="trim") as warned:
        g3r.mesh_oriented(part, part)
    assert {w.filename for w in warned} == {__file__}
    assert len(g3r.mesh_oriented(sphere, sphere, faces=200)[1]) <= 210
    with pytest.raises(g3r.UnavailableError):
        g3r.mesh_oriented(sphere, sphere, max_memory=1000)


def test_the_condition_number_can_be_asked_for(sphere):
    stats = g3r.run(sphere, mesh=False, method="green", solver="dense", condition_number=True).stats
    assert stats["method"]["condition_number"] > 1
    with pytest.raises(g3r.InputError, match="condition number"):
        g3r.run(sphere, mesh=False, condition_number=True)


def test_mesh_oriented(sphere):
    vertices, faces = g3r.mesh_oriented(sphere, sphere)
    assert vertices.shape[1] == faces.shape[1] == 3
    assert len(g3r.mesh_oriented(sphere, sphere, noise="0.5h")[0]) > 0
    with pytest.raises(g3r.InputError, match="noise"):
        g3r.mesh_oriented(sphere, sphere, noise=-1)

    class Oriented:
        points = sphere
        normals = sphere

    np.testing.assert_array_equal(g3r.mesh_oriented(Oriented())[0], vertices)
    with pytest.raises(g3r.InputError, match="no normals"):
        g3r.mesh_oriented(sphere)


def test_field_tells_inside_from_outside(result, sphere):
    queries = [[0, 0, 0], [0.5, 0, 0], [3, 0, 0], [0, 0, -9]]
    np.testing.assert_allclose(result.field(queries), [1, 1, 0, 0], atol=0.15)
    gradient = result.field.gradient([[0, 0, 1.05], [1.05, 0, 0]])
    assert gradient[0, 2] < 0 and gradient[1, 0] < 0, "the gradient points inward"
    assert result.field is result.field, "built once"
    same = g3r.Field(sphere, result.normals, result.areas)
    np.testing.assert_array_equal(same(queries), result.field(queries))
    there = g3r.Field(sphere, result.normals, result.areas, device="cpu")
    np.testing.assert_array_equal(there(queries), same(queries))
    with pytest.raises(g3r.UnavailableError, match="there is no device gpu:999"):
        g3r.Field(sphere, result.normals, result.areas, device="gpu:999")


def test_a_result_can_be_pickled_and_copied_after_its_field_was_used(sphere):
    result = g3r.run(sphere)
    query = [[0.1, 0.2, 0.3]]
    value = result.field(query)
    for again in (pickle.loads(pickle.dumps(result)), copy.deepcopy(result)):
        np.testing.assert_array_equal(again.normals, result.normals)
        np.testing.assert_array_equal(again.field(query), value)


def test_the_field_leaves_out_what_is_not_finite(result, sphere):
    queries = [[0, 0, 0], [3, 0, 0]]
    for values in ("normals", "areas"):
        given = {"normals": result.normals.copy(), "areas": result.areas.copy()}
        given[values][3] = np.nan
        np.testing.assert_allclose(g3r.Field(sphere, **given)(queries), [1, 0], atol=0.15)
    with pytest.raises(g3r.InputError, match="no point an area"):
        g3r.Field(sphere, result.normals, np.full(len(sphere), np.inf))
    for areas in (result.areas[:5], result.areas[:, None], 1.0, ["a"] * len(sphere)):
        with pytest.raises(g3r.InputError, match="areas must be"):
            g3r.Field(sphere, result.normals, areas)
    with pytest.raises(g3r.InputError, match="5 normals"):
        g3r.Field(sphere, result.normals[:5], result.areas)


def value_in(stats, path):
    """What stats say at "a.b"; as "a.b/c.d" the ratio of two numbers."""
    if "/" in path:
        above, below = path.split("/")
        return value_in(stats, above) / value_in(stats, below)
    for name in path.split("."):
        stats = stats[name]
    return len(stats) if isinstance(stats, list) else stats


DIAGONAL = 2 * 3**0.5  # of the box of the unit sphere


@pytest.mark.parametrize("options, expected", [
    ({"epsilon": 0.05}, {"scales.epsilon": 0.05}),
    ({"epsilon": "0.5%"}, {"scales.epsilon": 0.005 * DIAGONAL}),
    ({"epsilon": "0.8h"}, {"scales.epsilon/scales.spacing": 0.8}),
    ({"epsilon": "0.03n"}, {"scales.epsilon/scales.box_side": 0.03 * 0.55}),
    ({"noise": 0}, {"scales.noise": 0}),
    ({"noise": "0.2h"}, {"scales.noise/scales.spacing": 0.2}),
    ({"noise": "auto"}, {"scales.noise": 0}),
    ({"degree": 1}, {"method.name": "green", "method.harmonics": "degree:0-1"}),
    ({"harmonics": "1,x,y,z"}, {"method.name": "green", "method.harmonics": "1,x,y,z"}),
    ({"preset": "paper"}, {"method.name": "green", "method.preset": "paper", "iterations": 80}),
    ({"solver": "cg"}, {"method.solver": "cg"}),
    ({"schedule": "3 cg", "tolerance": 0}, {"iterations": 3}),
    ({"method": "energy"}, {"method.name": "energy"}),
    ({"method": "wnnc", "wnnc_widths": "sparse"}, {"method.name": "wnnc", "method.solver": "wnnc", "iterations": 40}),
    ({"method": "agr"}, {"method.name": "agr"}),
    ({"method": "pgr"}, {"method.name": "pgr"}),
    ({"threads": 1}, {"threads": 1}),
    ({"device": "cpu"}, {"device.name": "cpu"}),
    ({"tolerance": 1e-2}, {"method.tolerance": 1e-2}),
])
def test_every_option_is_taken(sphere, options, expected):
    result = g3r.run(sphere, mesh=False, **options)
    assert is_outward(result.normals, sphere)
    for path, value in expected.items():
        assert value_in(result.stats, path) == (value if isinstance(value, str) else pytest.approx(value, rel=2e-3)), path


def test_the_accuracy_of_sums_is_taken():
    assert g3r.run(sphere_points(6000), mesh=False, accuracy=1e-2).stats["method"]["accuracy"] == 1e-2


def test_build_info():
    info = g3r.build_info()
    assert info.instruction_set and info.laz in (True, False)
    assert info.opencl or info.cuda or not g3r.devices()


def test_devices(sphere):
    for device in g3r.devices():
        assert device.name and device.memory > 0 and isinstance(device.software, bool)
    for device in ("tpu", "gpu:"):
        with pytest.raises(g3r.InputError, match="device must be"):
            g3r.orient(sphere, device=device)
    with pytest.raises(g3r.UnavailableError, match="there is no device gpu:999"):
        g3r.orient(sphere, device="gpu:999")
    assert g3r.run(sphere, device="cpu", mesh=False).stats["device"] == {"name": "cpu", "driver": "", "seconds": {}}


def test_threads_do_not_change_the_result(sphere):
    np.testing.assert_array_equal(g3r.orient(sphere, threads=1), g3r.orient(sphere, threads=3))


@pytest.mark.parametrize("points", [
    [[0, 0, 0]], np.zeros((0, 3)), np.zeros((10, 3)), np.zeros((5, 2)), np.zeros(9), [["a", "b", "c"]], np.zeros((4, 3), complex), object(), None,
    np.full((10, 3), np.nan), np.outer(np.arange(10.0), [1, 1, 1]),
])
def test_unusable_points_are_refused(points):
    with pytest.raises(g3r.InputError):
        g3r.orient(points)


@pytest.mark.parametrize("options", [
    {"epsilon": "big"}, {"epsilon": -1}, {"epsilon": "0%"}, {"epsilon": float("nan")}, {"noise": -1}, {"noise": "much"}, {"noise": 0.1, "preset": "paper"}, {"degree": 99}, {"preset": "best"}, {"solver": "magic"}, {"mesher": "magic"}, {"method": "magic"},
    {"harmonics": "w"}, {"schedule": "20 xx"}, {"depth": 99}, {"depth": "deep"}, {"depth": 7.5}, {"trim": -1}, {"trim": "much"}, {"faces": -1}, {"faces": 1.5},
    {"colors": [[1, 2, 3]]},
])
def test_unusable_options_are_refused(sphere, options):
    with pytest.raises(g3r.InputError):
        g3r.run(sphere, **options)


@pytest.mark.parametrize("option, value", [
    ("degree", -3), ("degree", 2.9), ("threads", 2.7), ("threads", None), ("threads", 10**12), ("trim", [1]), ("trim", float("nan")), ("faces", "500"),
    ("faces", None),
    ("faces", float("nan")), ("faces", 1e30), ("faces", 10**30), ("max_memory", "8G"), ("keep_all", "no"), ("keep_all", None),
    ("min_component", "a"), ("tolerance", "1e-3"), ("tolerance", None), ("accuracy", "x"), ("device", None), ("method", None),
    ("harmonics", None),
    ("schedule", 3), ("preset", None), ("flip", "no"), ("condition_number", 2), ("mesh", "no"),
])
def test_a_value_of_another_kind_is_refused_by_name(sphere, option, value):
    with pytest.raises(g3r.InputError, match=option):
        g3r.run(sphere, **{option: value})


def test_unknown_options_are_a_type_error(sphere):
    with pytest.raises(TypeError, match="unknown option 'epsilom'"):
        g3r.orient(sphere, epsilom=1)


def test_errors_are_also_the_usual_python_errors():
    assert issubclass(g3r.InputError, ValueError) and issubclass(g3r.FileError, OSError)
    assert issubclass(g3r.FileMissingError, FileNotFoundError)
    for name in ("InputError", "FileError", "FileMissingError", "UnavailableError", "Cancelled"):
        assert issubclass(getattr(g3r, name), g3r.Error)


def test_progress_is_called_on_this_thread_with_growing_fractions():
    seen = []
    g3r.orient(sphere_points(6000), progress=lambda stage, fraction: seen.append((stage, fraction, threading.get_ident())))
    assert seen and all(isinstance(stage, str) and 0 <= fraction <= 1 for stage, fraction, _ in seen)
    assert {ident for _, _, ident in seen} == {threading.get_ident()}


@pytest.mark.parametrize("answer", [False, np.False_])
def test_returning_false_cancels(answer):
    with pytest.raises(g3r.Cancelled):
        g3r.orient(sphere_points(6000), progress=lambda stage, fraction: answer)


@pytest.mark.parametrize("answer", [None, 0, 0.0, "", np.int64(0), np.True_])
def test_returning_anything_else_goes_on(sphere, answer):
    assert is_outward(g3r.orient(sphere, progress=lambda stage, fraction: answer), sphere)


def test_an_exception_in_the_callback_comes_back():
    def fail(stage, fraction):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        g3r.orient(sphere_points(6000), progress=fail)


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_ctrl_c_stops_the_work():
    def interrupt(stage, fraction):
        os.kill(os.getpid(), signal.SIGINT)

    previous = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            g3r.orient(sphere_points(20000), progress=interrupt)
    finally:
        signal.signal(signal.SIGINT, previous)


def test_other_threads_run_meanwhile():
    done = threading.Event()
    ticks = []

    def tick():
        while not done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    begin = time.monotonic()
    g3r.orient(sphere_points(6000))
    end = time.monotonic()
    done.set()
    thread.join()
    assert sum(begin < t < end for t in ticks) > 3, "the interpreter lock was held"


def test_two_calls_at_once_give_the_same(sphere):
    reference = g3r.orient(sphere)
    results = [None, None]

    def work(i):
        results[i] = g3r.orient(sphere)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for normals in results:
        np.testing.assert_array_equal(normals, reference)
