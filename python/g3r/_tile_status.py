"""What a work folder of tiles holds."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, List, NamedTuple

from . import _g3r

if TYPE_CHECKING:
    from ._cloud import Path


class Status(NamedTuple):
    """What a work folder holds."""

    points: int
    """In the input."""
    non_finite: int
    """Of them, which take no part."""
    tiles: int
    done: int
    coarse_points: int
    """Of the thinned cloud."""
    largest_tile: int
    """Points of the largest solve: its own, those around it, and the thinned ones beyond."""
    work: float
    """Points of all solves over the points: what tiles cost, 1 for none."""
    worker_memory_bytes: int
    """Planned, of the largest tile."""
    disk_bytes: int
    """Planned, of the whole folder at its fullest."""
    converged: bool
    """Of the thinned cloud, as in `Result.stats`; the sides follow it. So do the next four."""
    consistent: bool
    doubtful: bool
    open_share: float
    undecided_share: float
    warnings: List[str]


def status(folder: Path) -> Status:
    """What is planned and done. Raises what `run` does."""
    return Status(*_g3r.tiles_status(os.fsencode(folder)))
