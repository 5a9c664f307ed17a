"""Clouds of any size: normals tile by tile, out of core, in one process, in many, or on Dask.

    g3r.tiles.plan("scans/*.las", "work", max_memory=6 << 30)   # reads and sorts the points, solves a thinned cloud, cuts tiles
    g3r.tiles.run("work")                                       # the tiles that are not done; or dask_run("work", client)
    g3r.tiles.merge("work", "oriented.ply")                     # the points in the order of the input

The work folder holds all state. What is there is complete or absent: a process may be killed at any time, and the same call then goes on.
The result depends on the points and the plan alone, not on workers, threads or restarts.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, NamedTuple, Optional, Sequence, Union

from . import _g3r
from ._errors import InputError
from ._hints import HINTS, take_hints
from ._kinds import integer, text, whole
from ._tile_status import Status, status

if TYPE_CHECKING:
    from ._api import Progress
    from ._cloud import Path

__all__ = ["Merged", "Status", "dask_run", "merge", "plan", "run", "status"]


class Merged(NamedTuple):
    """Of all points that are finite."""

    confidence_mean: float
    confidence_below_half: float
    """Share, 0 to 1."""


def plan(inputs: Union[Path, Sequence[Path]], folder: Path, *, max_memory: int = 0, tiles: int = 0, threads: int = 0,
         device: str = "auto", progress: Optional[Progress] = None, **hints: Any) -> Status:
    """Reads the inputs twice, sorts their points in `folder`, solves a thinned cloud in core for the sides, and cuts tiles.

    inputs: files, folders or patterns ("scans/*.las"), one or a list; regular files that do not change.
    max_memory: bytes that a worker may take; 0: three quarters of what the machine has free.
    tiles: their number; 0: as few as the memory allows.
    threads: of the sort and the thinned cloud, 0 for all cores. device: see `g3r.run`.
    hints: those of `g3r.run`, but no sensors of single points.

    A folder that holds the plan of the same files and options is left as it is. Takes 75 bytes of disk a point. Raises InputError (fewer
    than 8000 points, a folder with another plan), UnavailableError (too little memory for any tiles), FileError, Cancelled.
    """
    unknown = set(hints) - HINTS
    if unknown:
        raise TypeError(f"unknown option {sorted(unknown)[0]!r}; there are also {', '.join(sorted(HINTS))}")
    if hints.get("sensor_of_point") is not None or isinstance(hints.get("sensor"), str):
        raise InputError("tiles take no sensors of single points: sensor must be places")
    _, options = take_hints(None, hints)
    options.update(max_memory=whole("max_memory", max_memory), tiles=whole("tiles", tiles), threads=integer("threads", threads),
                   device=device)
    paths = [inputs] if isinstance(inputs, (str, bytes, os.PathLike)) else inputs
    return Status(*_g3r.tiles_plan([os.fsencode(path) for path in paths], os.fsencode(folder), options, progress))


def run(folder: Path, *, worker: int = 1, workers: int = 1, threads: int = 0, device: str = "auto",
        progress: Optional[Progress] = None) -> Status:
    """Solves the tiles that are not done, in this process: of them number worker, worker + workers, ... where there are several workers.

    threads: 0 for all cores. The interpreter lock is released; Ctrl-C works. Two workers that do the same tile do no harm. Raises
    InputError (no plan, a damaged one, a worker that is not 1 to workers), FileError, Cancelled.
    """
    return Status(*_g3r.tiles_run(os.fsencode(folder), whole("worker", worker), whole("workers", workers), integer("threads", threads),
                                  text("device", device), progress))


def dask_run(folder: Path, client: Any = None, *, threads: int = 0, retries: int = 3, device: str = "auto",
             progress: Optional[Progress] = None) -> Status:
    """Solves the tiles that are not done on Dask, one task for each. Needs `pip install 'g3r[dask]'`, here and on the workers.

    folder: where workers see it under the same absolute path.
    client: a `distributed.Client`, the address of a scheduler ("tcp://host:8786"), or None: a LocalCluster for this call, with as many
        processes as there are cores and the plan's memory allows. A script that starts one needs `if __name__ == "__main__":`.
    threads: of a tile; 0: one for each thread of a worker, of a LocalCluster all cores together.
    retries: how often a tile is tried again after an error that may pass, such as a full disk.
    progress: called as progress("tiles", fraction) when a tile is done; returning False cancels, as Ctrl-C does; running tiles stop.

    Tiles of lost workers are done by others, and waiting tiles of slow ones too. The bytes of the result are those of `run`. A tile that
    fails does not keep the others from being done; its error is raised in the end. Raises what `run` does, and UnavailableError: no
    Dask, no scheduler there, a worker with less memory than the plan says, a tile whose workers died again and again.
    """
    from ._dask import run_tiles

    return run_tiles(os.path.abspath(os.fsdecode(folder)), client, integer("threads", threads), whole("retries", retries), device, progress)


def merge(folder: Path, output: Path, *, progress: Optional[Progress] = None) -> Merged:
    """Writes one .ply, .las or .laz with the points in the order of the input, their normals and confidence, whole or not at all; see
    docs/tiles.md.

    Reads the inputs once more. Warns (UserWarning) of what LAS or LAZ cannot hold as it is, as `g3r.write` does. Raises InputError (tiles that are not done, inputs that have changed, another extension, points that LAS
    cannot hold), FileError, Cancelled.
    """
    return Merged(*_g3r.tiles_merge(os.fsencode(folder), os.fsencode(output), progress))
