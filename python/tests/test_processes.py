"""g3r in other people's processes: threads that call at once, forks, interrupts, many calls."""

import multiprocessing
import os
import signal
import sys
import threading

import numpy as np
import pytest

import g3r
from conftest import sphere_points

POINTS = sphere_points(300)
PATIENCE = 120  # seconds after which a child hangs
MANY = 260  # calls
WARM = 60  # calls, after which memory stays
GROWTH = 1 << 20  # bytes


def test_threads_call_at_once():
    expected = g3r.run(POINTS)
    results = [None] * 8

    def call(i):
        results[i] = g3r.run(POINTS)

    threads = [threading.Thread(target=call, args=(i,)) for i in range(len(results))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for result in results:
        assert result.normals.tobytes() == expected.normals.tobytes()
        assert result.vertices.tobytes() == expected.vertices.tobytes()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="fork")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # of forks in processes with threads
def test_children_of_a_fork_work():
    expected = g3r.orient(POINTS)
    child = os.fork()
    if child == 0:
        signal.alarm(PATIENCE)
        os._exit(0 if g3r.orient(POINTS).tobytes() == expected.tobytes() else 1)
    assert os.waitpid(child, 0)[1] == 0
    assert g3r.orient(POINTS).tobytes() == expected.tobytes()


@pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="fork")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_pool_of_forked_processes_works():
    expected = g3r.orient(POINTS)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        for result in pool.map_async(g3r.orient, [POINTS] * 4).get(PATIENCE):
            assert result.tobytes() == expected.tobytes()


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_interrupted_again_and_again():
    """At other moments of the run each time; the next run is as good as the first."""
    points = sphere_points(2000)
    expected = g3r.orient(points)
    interrupted = 0
    previous = signal.signal(signal.SIGINT, signal.default_int_handler)
    threads = threading.active_count()
    try:
        for i in range(15):
            seen = []

            def interrupt(stage, fraction, at=i, seen=seen):
                seen.append(stage)
                if len(seen) == 1 + at % 5:
                    os.kill(os.getpid(), signal.SIGINT)

            try:
                g3r.orient(points, progress=interrupt)
            except KeyboardInterrupt:
                interrupted += 1
    finally:
        signal.signal(signal.SIGINT, previous)
    assert interrupted >= 3  # the others were done before
    assert threading.active_count() == threads
    assert g3r.orient(points).tobytes() == expected.tobytes()


def resident():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE")


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="Linux")
def test_many_calls_take_no_more_memory():
    points = sphere_points(60)
    bad = np.zeros((3, 3))

    def call():
        g3r.run(points)
        with pytest.raises(g3r.InputError):  # errors leave nothing behind either
            g3r.orient(bad)

    for _ in range(WARM):
        call()
    before = resident()
    for _ in range(MANY - WARM):
        call()
    assert resident() - before < GROWTH


@pytest.mark.parametrize("name", ["torch", "open3d", "scipy.linalg"])
def test_beside_packages_with_threads_of_their_own(name):
    pytest.importorskip(name)  # their OpenMP and TBB are in the process now
    expected = g3r.orient(POINTS)
    big = np.random.default_rng(1).normal(size=(300, 300))
    if name == "torch":
        sys.modules[name].from_numpy(big).matmul(sys.modules[name].from_numpy(big))
    else:
        np.linalg.svd(big @ big)
    assert g3r.orient(POINTS).tobytes() == expected.tobytes()
