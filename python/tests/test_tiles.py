"""Clouds in tiles: the four steps, and that they give the same bytes on Dask, whoever dies meanwhile."""

import os
import signal
import threading
import time

import numpy as np
import pytest

import g3r
from conftest import sphere_points

COUNT = 8200  # few more than tiles take
TILES = 2
PATIENCE = 120  # seconds after which something hangs


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """(the input, the bytes of the result of `run`)"""
    folder = tmp_path_factory.mktemp("whole")
    g3r.write(folder / "in.ply", sphere_points(COUNT))
    g3r.tiles.plan(folder / "in.ply", folder / "work", tiles=TILES)
    g3r.tiles.run(folder / "work", worker=2, workers=2)
    g3r.tiles.run(folder / "work")
    g3r.tiles.merge(folder / "work", folder / "out.ply")
    return folder / "in.ply", (folder / "out.ply").read_bytes()


def planned(whole, tmp_path):
    work = tmp_path / "work"
    g3r.tiles.plan([whole[0]], work, tiles=TILES)
    return work


def merged(work):
    out = work.parent / "out.ply"
    g3r.tiles.merge(work, out)
    return out.read_bytes()


def test_the_four_steps(whole, tmp_path):
    seen = []
    status = g3r.tiles.plan(whole[0], tmp_path / "work", tiles=TILES, progress=lambda stage, f: seen.append((stage, f)))
    assert status.points == COUNT and status.non_finite == 0 and status.tiles == TILES and status.done == 0
    assert status.coarse_points < COUNT < status.largest_tile + status.coarse_points
    assert status.worker_memory_bytes > 0 and status.disk_bytes > 32 * COUNT and status.work > 1
    assert status.converged and status.consistent and not status.doubtful and status.warnings == []
    assert seen and all(0 <= f <= 1 for _, f in seen)
    with pytest.raises(g3r.InputError, match="2 of 2 tiles are not done"):
        g3r.tiles.merge(tmp_path / "work", tmp_path / "out.ply")
    assert g3r.tiles.run(tmp_path / "work", worker=1, workers=2, threads=1).done == 1
    assert g3r.tiles.status(tmp_path / "work").done == 1
    assert g3r.tiles.run(tmp_path / "work").done == TILES
    result = g3r.tiles.merge(tmp_path / "work", tmp_path / "out.ply")
    assert 0.9 < result.confidence_mean <= 1 and result.confidence_below_half < 0.01
    assert (tmp_path / "out.ply").read_bytes() == whole[1]
    cloud = g3r.read(tmp_path / "out.ply")
    assert np.allclose(cloud.points, sphere_points(COUNT), atol=1e-6)
    assert (cloud.points * cloud.normals).sum(axis=1).min() > 0.99 * np.linalg.norm(cloud.points, axis=1).min()


def test_las_has_the_same_points(whole, tmp_path):
    work = planned(whole, tmp_path)
    g3r.tiles.run(work)
    merged(work)
    ply = g3r.read(tmp_path / "out.ply")
    for name in "out.las", "out.laz":
        try:
            g3r.tiles.merge(work, tmp_path / name)
        except g3r.UnavailableError:  # a build without LASzip
            continue
        las = g3r.read(tmp_path / name)
        assert np.allclose(las.points, ply.points, rtol=0, atol=1e-8)
        assert np.array_equal(las.normals, ply.normals) and np.array_equal(las.confidence, ply.confidence)
    with pytest.raises(g3r.InputError, match="ends in .ply, .las or .laz"):
        g3r.tiles.merge(work, tmp_path / "out.xyz")


def test_what_las_cannot_hold_is_a_warning(tmp_path):
    path = tmp_path / "in.csv"
    path.write_text("x,y,z,intensity\n" + "".join("%.4f,%.4f,%.4f,0.5\n" % tuple(p) for p in sphere_points(COUNT)))
    g3r.tiles.plan(path, tmp_path / "work", tiles=1)
    g3r.tiles.run(tmp_path / "work")
    with pytest.warns(UserWarning, match="intensity") as warned:
        g3r.tiles.merge(tmp_path / "work", tmp_path / "out.las")
    assert warned[0].filename == __file__ and (tmp_path / "out.las").exists()


def test_hints_are_part_of_the_plan(whole, tmp_path):
    g3r.tiles.plan(whole[0], tmp_path / "work", tiles=1, flip=True, up="+z", threads=1)
    with pytest.raises(g3r.InputError, match="plan of other files or options"):
        g3r.tiles.plan(whole[0], tmp_path / "work", tiles=1)


def test_bad_arguments_and_cancelling(whole, tmp_path):
    with pytest.raises(TypeError, match="unknown option 'depth'"):
        g3r.tiles.plan(whole[0], tmp_path / "work", depth=4)
    for options in ({"tiles": -1}, {"max_memory": 0.5}, {"sensor": "file"}, {"sensor": (0, 0, 9), "sensor_of_point": [0] * COUNT}):
        with pytest.raises(g3r.InputError):
            g3r.tiles.plan(whole[0], tmp_path / "work", **options)
    with pytest.raises(g3r.FileMissingError, match="none.ply"):
        g3r.tiles.plan(tmp_path / "none.ply", tmp_path / "work")
    with pytest.raises(g3r.InputError, match="no plan of tiles"):
        g3r.tiles.status(tmp_path)
    with pytest.raises(g3r.InputError, match="worker"):
        g3r.tiles.run(planned(whole, tmp_path), worker=3, workers=2)
    with pytest.raises(g3r.Cancelled):
        g3r.tiles.run(tmp_path / "work", progress=lambda stage, fraction: False)


def test_dask_says_what_is_missing(whole, tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "distributed", None)
    with pytest.raises(g3r.UnavailableError, match=r"pip install 'g3r\[dask\]'"):
        g3r.tiles.dask_run(planned(whole, tmp_path))


@pytest.fixture(scope="module")
def cluster():
    distributed = pytest.importorskip("distributed", reason="needs Dask: pip install distributed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address="127.0.0.1:0") as local:
        yield local


def test_dask_gives_the_same_bytes(whole, tmp_path, cluster):
    work = planned(whole, tmp_path)
    seen = []
    status = g3r.tiles.dask_run(work, cluster.scheduler_address, progress=lambda stage, fraction: seen.append((stage, fraction)))
    assert status.done == TILES
    assert seen == [("tiles", (k + 1) / TILES) for k in range(TILES)]
    assert merged(work) == whole[1]
    assert g3r.tiles.dask_run(work, "tcp://nobody:1") == status  # nothing is left to do


def start_killing(client, work):
    """Kills a worker that is at a tile, as soon as there is one."""
    killed = []

    def kill():
        end = time.monotonic() + PATIENCE
        pids = client.run(os.getpid)
        while not killed and time.monotonic() < end:
            for address, keys in client.processing().items():
                if keys and address in pids and not list(work.glob("tile-*.bin")):
                    os.kill(pids[address], signal.SIGKILL)
                    killed.append(address)
                    return
            time.sleep(0.002)

    thread = threading.Thread(target=kill)
    thread.start()
    return thread, killed


def test_a_killed_worker_costs_nothing_but_time(whole, tmp_path, cluster):
    import distributed

    work = planned(whole, tmp_path)
    with distributed.Client(cluster) as client:
        client.wait_for_workers(2)
        thread, killed = start_killing(client, work)
        status = g3r.tiles.dask_run(work, client)
        thread.join()
    assert killed
    assert status.done == TILES
    assert merged(work) == whole[1]


def test_cancelling_takes_the_tasks_back(whole, tmp_path, cluster):
    import distributed

    work = planned(whole, tmp_path)
    with distributed.Client(cluster) as client:
        with pytest.raises(g3r.Cancelled, match="cancelled"):
            g3r.tiles.dask_run(work, client, progress=lambda stage, fraction: np.False_)
        assert not client.futures  # both may have been done by then
        assert g3r.tiles.dask_run(work, client).done == TILES


@pytest.mark.parametrize("state, done", [("executing", 1), ("cancelled", 0), (None, 0)])
def test_a_tile_whose_task_was_taken_back_stops(whole, tmp_path, monkeypatch, state, done):
    from types import SimpleNamespace

    from g3r import _dask

    tasks = {} if state is None else {"task": SimpleNamespace(state=state)}
    worker = SimpleNamespace(address="here", get_current_task=lambda: "task", memory_manager=SimpleNamespace(memory_limit=None),
                             state=SimpleNamespace(nthreads=1, tasks=tasks))
    monkeypatch.setattr(_dask, "_library", lambda: SimpleNamespace(get_worker=lambda: worker))
    work = planned(whole, tmp_path)
    if done:
        assert _dask.solve(str(work), 1, TILES, 1, "cpu") is None
    else:
        with pytest.raises(g3r.Cancelled):
            _dask.solve(str(work), 1, TILES, 1, "cpu")
    assert g3r.tiles.status(work).done == done


def test_one_bad_tile_leaves_the_others(whole, tmp_path, cluster):
    work = planned(whole, tmp_path)
    (work / "tile-1.bin").mkdir()  # where nothing can be renamed to
    with pytest.raises(g3r.FileError, match="tile-1.bin"):
        g3r.tiles.dask_run(work, cluster.scheduler_address, retries=1)
    assert g3r.tiles.status(work).done == TILES - 1
    (work / "tile-1.bin").rmdir()
    assert g3r.tiles.dask_run(work, cluster.scheduler_address).done == TILES
    assert merged(work) == whole[1]


def test_too_small_workers_are_told_beforehand(whole, tmp_path):
    distributed = pytest.importorskip("distributed", reason="needs Dask: pip install distributed")
    work = planned(whole, tmp_path)
    with distributed.LocalCluster(n_workers=1, threads_per_worker=32, processes=False, memory_limit="1GiB",
                                  dashboard_address="127.0.0.1:0") as small:
        with pytest.raises(g3r.UnavailableError, match="may take 1024 MiB for 32 tiles at once"):
            g3r.tiles.dask_run(work, small.scheduler_address)
    with pytest.raises(g3r.UnavailableError, match="no Dask scheduler answers at tcp://127.0.0.1:1"):
        with __import__("dask").config.set({"distributed.comm.timeouts.connect": "100ms"}):
            g3r.tiles.dask_run(work, "tcp://127.0.0.1:1")
