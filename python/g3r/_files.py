"""Clouds and meshes from files and to files."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, List, Optional, Tuple, Union

from . import _g3r
from ._api import Result
from ._arrays import as_colors, as_faces, as_points, as_values, member
from ._errors import InputError

if TYPE_CHECKING:
    from ._types import Bytes, Floats, Indices, Singles

Path = Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]


class Cloud:
    """A cloud as read from a file. Arrays are read-only views; each is None if the file does not have it."""

    def __init__(self, native: _g3r.Cloud) -> None:
        self._native = native

    @property
    def points(self) -> Floats:
        """(n, 3) float64, in the order of the file; points that are not finite are kept."""
        return self._native.points

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
        """(k, 3) float64: where the scanner stood, one place per scan."""
        return self._native.sensor_positions

    @property
    def scan_of_point(self) -> Optional[Indices]:
        """(n,) uint32: the scan of each point, a row of `sensor_positions`; None if there is one scan or none is known."""
        return self._native.scan_of_point

    @property
    def format(self) -> str:
        """For example "ply binary_little_endian"."""
        return self._native.format

    @property
    def property_names(self) -> List[str]:
        """As in the file, in its order."""
        return self._native.property_names

    @property
    def warnings(self) -> List[str]:
        """What was odd about the file and what was done about it, one line each."""
        return self._native.warnings

    def __len__(self) -> int:
        return len(self.points)

    def __repr__(self) -> str:
        return f"<g3r.Cloud: {len(self)} points, {self.format}>"


def read(path: Path, *, min_opacity: float = 0.1) -> Cloud:
    """Reads a cloud; the format is recognised by content. `min_opacity`: Gaussian splats below it are left out.

    Raises FileMissingError, FileError, InputError (damaged or unknown; says where and what to do).
    """
    return Cloud(_g3r.read_cloud(os.fsdecode(path), float(min_opacity)))


def read_mesh(path: Path) -> Tuple[Floats, Indices]:
    """Reads a triangle mesh (PLY, OBJ, OFF, STL): V (v, 3) and F (m, 3). Raises like `read`, and InputError if it has no face."""
    vertices, faces, _, _ = _g3r.read_mesh(os.fsdecode(path))
    return vertices, faces


def write(path: Path, what: Any, faces: Any = None, *, normals: Any = None, confidence: Any = None, colors: Any = None,
          ascii: bool = False, cloud_compare_names: bool = False) -> None:
    """Writes points or a mesh, whole or not at all; the format follows the extension.

    what: a `Cloud` (all properties of its file are kept), a `Result` (its mesh; its points and normals if it has none), points (n, 3) or an
    object with points. With `faces`, `what` are the vertices of a mesh. A pair (V, F) is a mesh too.
    normals, confidence, colors: one per point or vertex. A mesh takes no normals: they follow from its faces.
    cloud_compare_names: name the confidence "scalar_confidence", which CloudCompare shows at once.

    Raises FileError, InputError (unknown extension, sizes that differ, a normal that is not finite).
    """
    name = os.fsdecode(path)
    if isinstance(what, Result):
        if what.vertices is not None and what.faces is not None:
            colors = what.vertex_colors if colors is None else colors
            confidence = what.vertex_confidence if confidence is None else confidence
            what, faces = what.vertices, what.faces
        else:
            normals = what.normals if normals is None else normals
            confidence = what.confidence if confidence is None else confidence
            what = what.points
    if faces is None and isinstance(what, tuple) and len(what) == 2 and getattr(what[1], "ndim", 0) == 2:
        what, faces = what
    if faces is None and not isinstance(what, Cloud):
        faces = member(what, "triangles", "faces")
    if faces is not None:
        if normals is not None:
            raise InputError("a mesh is written without normals: they follow from its faces")
        vertices = as_points(what, "vertices")
        count = len(vertices)
        _g3r.write_mesh(name, vertices, as_faces(faces, count), None if colors is None else as_colors(colors, count),
                        None if confidence is None else as_values(confidence, count, "confidence"), bool(ascii))
        return
    source = what._native if isinstance(what, Cloud) else None
    if source is not None and colors is not None:
        raise InputError("the colours of a file are kept as they are; pass its points instead: write(path, cloud.points, colors=...)")
    points = as_points(what)
    count = len(points)
    if normals is not None:
        normals = as_points(normals, "normals")
        if len(normals) != count:
            raise InputError(f"{len(normals)} normals for {count} points")
    _g3r.write_cloud(name, source, points, normals, None if colors is None else as_colors(colors, count),
                     None if confidence is None else as_values(confidence, count, "confidence"), bool(ascii), bool(cloud_compare_names))
