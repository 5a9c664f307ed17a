#!/usr/bin/env python3
"""Measures g3r tiles on a cloud of many millions of points from a formula: time, memory, disk and accuracy of every step.

    tools/measure_tiles.py FOLDER --millions 100 --workers 8 --threads 2 --max-memory 6G

FOLDER gets cloud.npy, the work folder, oriented.ply and state.json. What is done stays done: after a limit, a signal or a kill the same
command goes on (a plan that was cut starts again, tiles go on where they were). Steps: the cloud; plan; run, by --workers processes of
--threads threads each; merge; score; with --mesh, mesh and merge --mesh; with --in-core, g3r orient of the same cloud by as many threads,
which needs 400 bytes a point of memory. CPU-s are those of all processes, with what was lost where a step was cut; the peak is that of the
largest process; disk is the work folder at its fullest, looked at every second. Accuracy is that of up to 16 blocks of 250,000 points,
beside the formula (bench/scenes.py). Needs NumPy and Linux.
"""

import argparse
import json
import multiprocessing
import os
import pathlib
import re
import signal
import struct
import subprocess
import sys
import time

os.environ["OPENBLAS_NUM_THREADS"] = "1"  # processes are the threads

import numpy as np  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "bench"))
import scenes  # noqa: E402

SCORED = 16  # blocks: 4 million points, which put the shares at +- 0.001 % where one in 10,000 is wrong
LIMIT_REACHED = 75  # exit code: call again
TICK = os.sysconf("SC_CLK_TCK")
TYPES = {"float": "<f4", "double": "<f8", "uchar": "u1", "ushort": "<u2", "uint": "<u4", "int": "<i4"}


class Cut(Exception):
    """The limit, or a signal."""


def cut(*_):
    raise Cut


def in_pool():
    """A process of a pool ends when the pool does."""
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--binary", default=str(ROOT / "build/release/cli/g3r"))
    parser.add_argument("--millions", type=float, default=1, help="points")
    parser.add_argument("--scene", choices=sorted(scenes.SCENES), default="ridges")
    parser.add_argument("--noise", type=float, default=0.0, help="in radii (ridges) or metres (city)")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--threads", type=int, default=1, help="of a worker; plan, merge and in core have those of all workers")
    parser.add_argument("--max-memory", default="3G", help="of a worker")
    parser.add_argument("--tiles", type=int, help="their number, instead of --max-memory")
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--mesh", action="store_true")
    parser.add_argument("--in-core", action="store_true")
    parser.add_argument("--limit", type=float, default=1e9, help="seconds after which this call stops, and says what is done")
    return parser.parse_args()


class State:
    """What was measured, on disk at all times."""

    def __init__(self, folder, asked):
        self.path = folder / "state.json"
        self.all = json.loads(self.path.read_text()) if self.path.exists() else {"asked": asked, "steps": {}}
        if self.all["asked"] != asked:
            sys.exit(f"{folder} has another cloud or other options: {self.all['asked']}")

    def save(self):
        temporary = self.path.with_suffix(".tmp")
        temporary.write_text(json.dumps(self.all, indent=1))
        temporary.replace(self.path)

    def step(self, name):
        return self.all["steps"].setdefault(name, {"done": False, "cpu": 0, "wall": 0, "peak": 0, "disk": 0, "starts": 0})


def living(process):
    """CPU seconds and peak in bytes of a process that runs."""
    try:
        fields = pathlib.Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()
        peak = re.search(r"VmHWM:\s+(\d+)", pathlib.Path(f"/proc/{process}/status").read_text())
    except OSError:
        return 0, 0
    return (int(fields[11]) + int(fields[12])) / TICK, int(peak[1]) << 10 if peak else 0


def bytes_in(folder):
    total = 0
    for entry in os.scandir(folder) if folder.exists() else ():
        try:
            total += entry.stat().st_size
        except FileNotFoundError:
            pass  # renamed meanwhile
    return total


def run(state, name, commands, work):
    """Runs the commands side by side as step `name`, unless it is done."""
    step = state.step(name)
    if step["done"]:
        return
    before, start = dict(step), time.monotonic()
    step["starts"] += 1
    log = open(state.path.parent / f"{name}.log", "a")
    running = {subprocess.Popen(c, stdout=log, stderr=log, start_new_session=True).pid: (0, 0) for c in commands}
    ended, failed = [], False

    def note():
        seen = ended + list(running.values())
        step["cpu"] = before["cpu"] + sum(cpu for cpu, _ in seen)
        step["peak"] = max([before["peak"]] + [peak for _, peak in seen])
        step["wall"] = before["wall"] + time.monotonic() - start
        step["disk"] = max(step["disk"], bytes_in(work))
        state.save()

    def collect(block):
        nonlocal failed
        for process in list(running):
            done, status, usage = os.wait4(process, 0 if block else os.WNOHANG)
            if done:
                ended.append((usage.ru_utime + usage.ru_stime, usage.ru_maxrss << 10))
                failed |= status != 0
                del running[process]
            else:
                running[process] = living(process)

    try:
        while running:
            collect(False)
            note()
            time.sleep(1 if time.monotonic() - start > 10 else 0.1)
    except Cut:
        for process in running:
            os.kill(process, signal.SIGINT)
        collect(True)
        note()
        raise
    if failed:
        sys.exit(f"{name} failed: {(state.path.parent / f'{name}.log')}\n" + log_end(state.path.parent / f"{name}.log"))
    step["done"] = True
    note()


def log_end(path):
    return path.read_text(errors="replace").replace("\r", "\n")[-1000:]


def write_block(job):
    path, offset, scene, noise, index, count, points = job
    rows = scenes.block(scene, noise, index, count)[0][:points].astype("<f4").tobytes()
    with open(path, "r+b") as file:
        file.seek(offset)
        file.write(rows)
    return index


def make_cloud(state, options, path, points, processes):
    step = state.step("cloud")
    if step["done"]:
        return
    start = time.monotonic()
    header = f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({points}, 3), }}".encode()
    header += b" " * (63 - (10 + len(header)) % 64) + b"\n"
    with open(path, "wb") as file:
        file.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header)
        file.truncate(10 + len(header) + 12 * points)
    count = -(-points // scenes.POINTS)
    sizes = [min(scenes.POINTS, points - b * scenes.POINTS) for b in range(count)]
    jobs = [
        (path, 10 + len(header) + 12 * scenes.POINTS * b, options.scene, options.noise, b, count, n) for b, n in enumerate(sizes)
    ]
    with multiprocessing.Pool(processes, in_pool) as pool:
        for _ in pool.imap_unordered(write_block, jobs):
            pass
    step.update(done=True, wall=time.monotonic() - start)
    state.save()


def read_oriented(path):
    """A PLY of vertices, as a map of records."""
    with open(path, "rb") as file:
        header = file.read(4096)
    end = header.index(b"end_header\n") + 11
    lines = header[:end].decode().split("\n")
    count = next(int(line.split()[2]) for line in lines if line.startswith("element vertex"))
    fields = [(line.split()[2], TYPES[line.split()[1]]) for line in lines if line.startswith("property")]
    return np.memmap(path, np.dtype(fields), "r", end, (count,))


def score_block(job):
    path, scene, noise, index, count, points = job
    position, truth = (a[:points] for a in scenes.block(scene, noise, index, count))
    found = read_oriented(path)[scenes.POINTS * index : scenes.POINTS * index + points]
    at = np.c_[found["x"], found["y"], found["z"]]
    assert np.array_equal(at.astype("<f4"), position.astype("<f4")), "the output is not in the order of the input"
    known = np.any(truth != 0, axis=1)
    normal = np.c_[found["nx"], found["ny"], found["nz"]].astype(float)[known]
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-30)[:, None]
    cosine = np.clip((normal * truth[known]).sum(1), -1, 1)
    wrong = cosine <= 0
    sure = found["confidence"][known] > 0.9
    return np.array([len(wrong), (~wrong).sum(), ((1 - cosine) / 2).sum(), np.arccos(np.abs(cosine)).sum(), (wrong & sure).sum()])


def score(state, name, options, path, points, processes):
    step = state.step(name)
    if step["done"]:
        return
    count = -(-points // scenes.POINTS)
    chosen = sorted({int(b) for b in np.linspace(0, count - 1, min(count, SCORED))})
    jobs = [
        (path, options.scene, options.noise, b, count, min(scenes.POINTS, points - b * scenes.POINTS)) for b in chosen
    ]
    with multiprocessing.Pool(min(processes, len(jobs)), in_pool) as pool:
        n, right, ae_p, angle, sure = sum(pool.imap_unordered(score_block, jobs))
    step.update(
        done=True, points=int(n), pco=100 * right / n, ae_p=100 * ae_p / n, angle=float(np.degrees(angle / n)), wrong_and_sure=100 * sure / n
    )
    state.save()


def solved_points(work):
    """Points of the tiles that are done, points, tiles done, tiles, share of the work of one solve."""
    manifest = work / "manifest.json"
    if not manifest.exists():
        return 0, 0, 0, 0, 0
    plan = json.loads(manifest.read_text())
    done = [t for i, t in enumerate(plan["tiles"]) if (work / f"tile-{i}.bin").exists()]
    solved = sum(t[3] for t in plan["tiles"]) + plan["coarse_points"]
    return sum(t[2] for t in done), plan["points"], len(done), len(plan["tiles"]), solved / max(plan["points"], 1)


def report(state, work, points):
    own, _, done, tiles, solved = solved_points(work)
    print(f"{points:,} points, {done} of {tiles} tiles solved, points of all solves over points of the cloud {solved:.2f}")
    print("| step | | wall s | CPU-s | CPU-us a point | peak MiB | disk bytes a point |")
    print("|---|---|---|---|---|---|---|")
    for name, step in state.all["steps"].items():
        if "pco" in step or not (step["done"] or step["starts"]):
            continue
        how = "done" if step["done"] else "cut"
        if step["starts"] > 1:
            how += f", {step['starts']} starts"
        of = own if name == "run" else points
        each = f"{step['cpu'] / of * 1e6:.2f}" if of else ""
        disk = f"{step['disk'] / points:.1f}" if step["disk"] else ""
        print(f"| {name} | {how} | {step['wall']:.1f} | {step['cpu']:.1f} | {each} | {step['peak'] / 2**20:.0f} | {disk} |")
    for name, step in state.all["steps"].items():
        if "pco" in step:
            print(
                f"{name}: {step['points']:,} points, AE_p {step['ae_p']:.4f}e-2, PCO {step['pco']:.4f} %, mean angle of the line"
                f" {step['angle']:.3f} degrees, wrong and sure {step['wrong_and_sure']:.4f} %"
            )


def measure(options, state, points):
    folder, work = options.folder, options.folder / "work"
    cloud, oriented, in_core = folder / "cloud.npy", folder / "oriented.ply", folder / "in_core.ply"
    processes = min(os.cpu_count(), options.workers * options.threads)
    quiet = ["--no-progress", "--device", options.device, "--threads"]
    everyone = [*quiet, str(options.workers * options.threads)]
    g3r = [options.binary]
    up = ["--up", "+z"] if options.scene == "city" else []
    size = ["--tiles", str(options.tiles)] if options.tiles else ["--max-memory", options.max_memory]
    workers = [[*quiet, str(options.threads), "--worker", f"{i + 1}/{options.workers}"] for i in range(options.workers)]

    make_cloud(state, options, str(cloud), points, processes)
    run(state, "plan", [[*g3r, "tiles", "plan", str(cloud), str(work), *size, *up, *everyone]], work)
    run(state, "run", [[*g3r, "tiles", "run", str(work), *w] for w in workers], work)
    run(state, "merge", [[*g3r, "tiles", "merge", str(work), str(oriented), "--no-progress"]], work)
    score(state, "score", options, str(oriented), points, processes)
    if options.mesh:
        run(state, "mesh", [[*g3r, "tiles", "mesh", str(work), *w] for w in workers], work)
        run(state, "merge-mesh", [[*g3r, "tiles", "merge", str(work), str(folder / "mesh.ply"), "--mesh", "--no-progress"]], work)
    if options.in_core:
        run(state, "in-core", [[*g3r, "orient", str(cloud), str(in_core), *up, *everyone]], folder / "none")
        score(state, "score-in-core", options, str(in_core), points, processes)


def main():
    options = arguments()
    points = round(options.millions * 1e6)
    options.folder.mkdir(parents=True, exist_ok=True)
    asked = [points, options.scene, options.noise, options.max_memory if not options.tiles else options.tiles]
    state = State(options.folder, asked)
    signal.signal(signal.SIGTERM, cut)
    signal.signal(signal.SIGINT, cut)
    signal.signal(signal.SIGALRM, cut)
    signal.setitimer(signal.ITIMER_REAL, options.limit)
    try:
        measure(options, state, points)
        code = 0
    except Cut:
        code = LIMIT_REACHED
    report(state, options.folder / "work", points)
    sys.exit(code)


if __name__ == "__main__":
    main()
