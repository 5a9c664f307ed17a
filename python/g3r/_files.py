"""Clouds and meshes to files."""

from __future__ import annotations

import os
from typing import Any

from . import _g3r
from ._api import Result
from ._arrays import as_colors, as_faces, as_points, as_values, faces_in, opened, warn_of_file
from ._cloud import Cloud, Path
from ._errors import InputError
from ._kinds import truth


def write(path: Path, what: Any, faces: Any = None, *, normals: Any = None, confidence: Any = None, colors: Any = None,
          ascii: bool = False, cloud_compare_names: bool = False) -> None:
    """Writes points or a mesh, whole or not at all; the format follows the extension.

    what: a `Cloud` or a path (all properties of the file are kept), a `Result` (its mesh; its points and normals if it has none), points
    (n, 3) or an object with points. With `faces`, `what` are the vertices of a mesh. A pair (V, F), and an object with faces, is a mesh too.
    normals, confidence, colors: one per point or vertex. A mesh takes no normals: they follow from its faces.
    cloud_compare_names: name the confidence "scalar_confidence", which CloudCompare shows at once.

    Raises FileError, InputError (unknown extension, sizes that differ, a normal that is not finite). Points to
    LAS or LAZ: warns (UserWarning) of what these cannot hold as it is, and says what became of it; of a path also of what was odd about
    that file.
    """
    name = os.fsencode(path)
    ascii, cloud_compare_names = truth("ascii", ascii), truth("cloud_compare_names", cloud_compare_names)
    if faces is None and isinstance(what, (str, bytes, os.PathLike)):
        what = opened(what)
        warn_of_file(what)
    if isinstance(what, Result):
        if what.vertices is not None and what.faces is not None:
            colors = what.vertex_colors if colors is None else colors
            confidence = what.vertex_confidence if confidence is None else confidence
            what, faces = what.vertices, what.faces
        else:
            normals = what.normals if normals is None else normals
            confidence = what.confidence if confidence is None else confidence
            colors = what.colors if colors is None else colors
            what = what.points
    if faces is None and isinstance(what, tuple) and len(what) == 2 and getattr(what[1], "ndim", 0) == 2:
        what, faces = what
    if faces is None and not isinstance(what, Cloud):
        faces = faces_in(what)
    if faces is not None:
        if normals is not None:
            raise InputError("a mesh is written without normals: they follow from its faces")
        vertices = as_points(what, "vertices")
        count = len(vertices)
        _g3r.write_mesh(name, vertices, as_faces(faces, count), None if colors is None else as_colors(colors, count),
                        None if confidence is None else as_values(confidence, count, "confidence"), ascii)
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
                     None if confidence is None else as_values(confidence, count, "confidence"), ascii, cloud_compare_names)
