"""Clouds and meshes from files."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, List, Optional, Sequence, Tuple, Union

from . import _g3r
from ._errors import InputError
from ._kinds import integer, number, truth

if TYPE_CHECKING:
    from ._types import Bytes, Floats, Indices, Singles

Path = Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]


class Cloud:
    """A cloud as read from a file. Arrays are read-only views; each but the points is None if the file does not have it."""

    def __init__(self, native: _g3r.Cloud) -> None:
        self._native = native

    @property
    def points(self) -> Floats:
        """(n, 3) float64, in the order of the file; points that are not finite are kept."""
        points = self._native.points
        if points is not None:
            return points
        import numpy as np

        return np.zeros((0, 3))

    @property
    def normals(self) -> Optional[Floats]:
        """(n, 3) float64 as in the file, not normalised."""
        return self._native.normals

    @property
    def colors(self) -> Optional[Bytes]:
        """(n, 3) uint8."""
        return self._native.colors

    @property
    def confidence(self) -> Optional[Singles]:
        """(n,) float32."""
        return self._native.confidence

    @property
    def sensor_positions(self) -> Optional[Floats]:
        """(s, 3) float64: where the scanner stood, one row per scan, if the file says so (PCD VIEWPOINT, poses of E57 and PTX)."""
        return self._native.sensor_positions

    @property
    def scan_of_point(self) -> Optional[Indices]:
        """(n,) uint32: row of `sensor_positions`; None if there is one scan, or none is known."""
        return self._native.scan_of_point

    @property
    def format(self) -> str:
        """For example "ply binary_little_endian"."""
        return self._native.format

    @property
    def property_names(self) -> List[str]:
        """As in the file, in its order; bytes that are no UTF-8 as surrogates, as `os.fsdecode` has them."""
        return self._native.property_names

    @property
    def warnings(self) -> List[str]:
        """What was odd about the file and what was done about it, one line each."""
        return self._native.warnings

    def __len__(self) -> int:
        return len(self.points)

    def __repr__(self) -> str:
        return f"<g3r.Cloud: {len(self)} points, {self.format}>"


def read(
    path: Path,
    *,
    min_opacity: float = 0.1,
    all_splats: bool = False,
    box: Optional[Sequence[Sequence[float]]] = None,
    levels: Optional[int] = None,
    threads: int = 0,
) -> Cloud:
    """Reads a cloud; the format is recognised by content. A folder, or a pattern with * or ?, is read as one cloud of all its files of points;
    an EPT folder, or its ept.json, as one of all its cells.

    min_opacity: Gaussian splats below it are left out.
    all_splats: keeps all Gaussian splats, also floaters and those inside, which no light from outside reaches.
    box: two corners, ((x0, y0, z0), (x1, y1, z1)): points outside are left out; of COPC and EPT only the cells that it meets are read.
    levels: of the octree of COPC or EPT, from the coarsest; None for all.
    threads: of the search for those Gaussian splats, 0 for all cores; the result does not depend on it. Ctrl-C stops it.

    O(file) time and memory. Raises FileMissingError, FileError, InputError (damaged or unknown; says where and what to do).
    """
    sides = None
    if box is not None:
        if len(box) != 2 or len(box[0]) != 3 or len(box[1]) != 3:
            raise InputError("box: expected two corners of three coordinates")
        low, high = ([number("a coordinate of box", value) for value in corner] for corner in box)
        sides = (low[0], low[1], low[2], high[0], high[1], high[2])
    depth = 0 if levels is None else integer("levels", levels, 1)
    return Cloud(_g3r.read_cloud(os.fsencode(path), number("min_opacity", min_opacity), truth("all_splats", all_splats), sides, depth,
                                 integer("threads", threads, 0)))


def read_mesh(path: Path) -> Tuple[Floats, Indices]:
    """Reads a triangle mesh (PLY, OBJ, OFF, STL, glTF): V (v, 3) and F (m, 3). Raises like `read`, and InputError if it has no face."""
    vertices, faces, _, _ = _g3r.read_mesh(os.fsencode(path))
    return vertices, faces
