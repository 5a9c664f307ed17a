"""Tiles as tasks of Dask, which schedules them: where and when is its business, what a tile gives depends on the plan alone."""

from __future__ import annotations

import os
from contextlib import ExitStack
from importlib import import_module
from typing import TYPE_CHECKING, Any, Optional

from . import _g3r
from ._errors import Cancelled, InputError, UnavailableError
from ._kinds import is_false
from ._tile_status import Status, status

if TYPE_CHECKING:
    from ._api import Progress

_FREE_SHARE = 0.75  # of the free memory, for all workers of a local cluster together; as that of a plan without a limit


def _library() -> Any:
    try:
        return import_module("distributed")
    except ImportError as error:
        raise UnavailableError("Dask is not installed: pip install 'g3r[dask]'") from error


def _require_memory(worker: Any, needed: int) -> None:
    """A worker that Dask ends for its memory would be lost again and again."""
    limit = worker.memory_manager.memory_limit
    slots = worker.state.nthreads
    if limit and needed * slots > limit:
        raise UnavailableError(f"worker {worker.address} may take {limit >> 20} MiB for {slots} tiles at once, and a tile takes up to "
                               f"{needed >> 20} MiB: start workers with fewer threads or more memory, or plan with a lower max_memory")


def solve(folder: str, number: int, tiles: int, threads: int, device: str) -> Optional[Exception]:
    """On a worker: does tile `number` (from 1) if it is not done. Errors that would come again are handed back, others are raised."""
    worker = _library().get_worker()
    key = worker.get_current_task()

    def wanted(stage: str, fraction: float) -> bool:
        task = worker.state.tasks.get(key)
        return task is not None and task.state != "cancelled"

    try:
        _require_memory(worker, status(folder).worker_memory_bytes)
        _g3r.tiles_run(os.fsencode(folder), number, tiles, threads, device, wanted)
    except (InputError, UnavailableError) as error:
        return error
    return None


def _local_workers(status: Status, cores: int) -> int:
    free = import_module("psutil").virtual_memory().available * _FREE_SHARE
    return max(1, min(cores, status.tiles, int(free // max(1, status.worker_memory_bytes))))


def _connect(client: Any, status: Status, threads: int, close: ExitStack) -> Any:
    """(client, threads of a tile). What is started here is closed by `close`."""
    dask = _library()
    if client is None:
        cores = import_module("dask.system").CPU_COUNT
        workers = _local_workers(status, cores)
        # The plan knows what a tile takes. Nobody else on the network has a say.
        cluster = close.enter_context(dask.LocalCluster(n_workers=workers, threads_per_worker=1, processes=True, memory_limit=None,
                                                        dashboard_address="127.0.0.1:0"))
        return close.enter_context(dask.Client(cluster)), threads or max(1, cores // workers)
    if isinstance(client, str):
        try:
            return close.enter_context(dask.Client(client)), threads or 1
        except OSError as error:
            raise UnavailableError(f"no Dask scheduler answers at {client}: {error}") from error
    return client, threads or 1


def _error_of(future: Any, number: int, folder: str) -> Optional[BaseException]:
    dask = _library()
    if future.status == "cancelled":
        return UnavailableError(f"tile {number} was cancelled by somebody else; run again: tiles that are done stay")
    error: Optional[BaseException] = future.exception() if future.status == "error" else future.result()
    if isinstance(error, dask.KilledWorker):
        return UnavailableError(f"tile {number}: every worker that worked on it died ({error}); run again: tiles that are done stay")
    return error


def run_tiles(folder: str, client: Any, threads: int, retries: int, device: str, progress: Optional[Progress]) -> Status:
    """See `g3r.tiles.dask_run`."""
    dask = _library()
    before = status(folder)
    if before.done == before.tiles:
        return before
    with ExitStack() as close:
        client, threads = _connect(client, before, threads, close)
        numbers = range(1, before.tiles + 1)
        keys = [f"g3r-tile-{n}-{os.urandom(4).hex()}" for n in numbers]  # of this call alone, whatever the scheduler remembers
        futures = client.map(solve, [folder] * len(keys), numbers, key=keys, retries=retries, tiles=before.tiles, threads=threads,
                             device=device)
        number_of = {future.key: n for n, future in zip(numbers, futures)}
        errors = {}
        try:
            for done, future in enumerate(dask.as_completed(futures), 1):
                number = number_of[future.key]
                error = _error_of(future, number, folder)
                if error is not None:
                    errors[number] = error
                if progress is not None and is_false(progress("tiles", done / before.tiles)):
                    raise Cancelled("cancelled")
        except BaseException:
            client.cancel(futures)
            raise
    if errors:
        raise errors[min(errors)]
    return status(folder)
