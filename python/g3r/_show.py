"""The page to look at."""

from __future__ import annotations

from typing import Any, Optional

from . import _g3r
from ._api import Result
from ._arrays import as_colors, as_faces, as_points, as_values, faces_in, opened, warn_of_file
from ._cloud import Cloud
from ._kinds import text, whole
from ._view import DEFAULT_HEIGHT, DEFAULT_POINTS, View


def _in_notebook() -> bool:
    try:
        shell = get_ipython()  # type: ignore[name-defined]
    except NameError:
        return False
    return type(shell).__name__ != "TerminalInteractiveShell"


def show(what: Any, *, normals: Any = None, confidence: Any = None, colors: Any = None, true_normals: Any = None, faces: Any = None,
         mesh: Any = None, title: str = "g3r", up: str = "y", max_points: int = DEFAULT_POINTS, height: int = DEFAULT_HEIGHT,
         open: Optional[bool] = None) -> View:
    """A page with the points, their normals and the mesh, to turn and to look into.

    what: a `Result`, a `Cloud`, a path, points, or an object with points; with `faces`, the vertices of a mesh.
    mesh: a pair (V, F) to show with the points. true_normals: of a reference; adds a map of the errors. up: "y" or "z".
    normals, true_normals, colors: (n, 3); confidence: (n,), 0 to 1. max_points: of more an evenly strided part is shown, and the page says
    so. height: of the frame in a notebook, pixels.
    open: True opens the browser; None does so outside notebooks. Returns the `View`, which a notebook displays. Raises InputError (nothing
    to show, sizes that differ), ValueError for another `up`. Warns (UserWarning) of what was odd about the file that the points come from.
    """
    if up not in ("y", "z"):
        raise ValueError(f"up must be 'y' or 'z', not {up!r}")
    vertices = vertex_colors = vertex_confidence = None
    report = ""
    if isinstance(what, Result):
        report = what.report
        normals = what.normals if normals is None else normals
        confidence = what.confidence if confidence is None else confidence
        colors = what.colors if colors is None else colors
        vertices, faces = what.vertices, what.faces
        vertex_colors, vertex_confidence = what.vertex_colors, what.vertex_confidence
        points: Any = what.points
    else:
        what = opened(what)
        warn_of_file(what)
        if isinstance(what, Cloud):
            normals = what.normals if normals is None else normals
            confidence = what.confidence if confidence is None else confidence
            colors = what.colors if colors is None else colors
        elif faces is None:
            faces = faces_in(what)
        points = as_points(what)
        if faces is not None:
            vertices = points
            if colors is not None:
                vertex_colors = as_colors(colors, len(points))
            if confidence is not None:
                vertex_confidence = as_values(confidence, len(points), "confidence")
            if normals is None and true_normals is None:
                points = None
    if mesh is not None:
        vertices, faces = as_points(mesh[0], "vertices"), mesh[1]
        vertex_colors = vertex_confidence = None
    count = 0 if points is None else len(points)
    triangles = None if faces is None or vertices is None else as_faces(faces, len(vertices))

    def rows(value: Any, name: str) -> Any:
        return None if value is None else as_points(value, name)

    scene = _g3r.scene(text("title", title), rows(points, "points"), rows(normals, "normals"),
                       None if confidence is None or count == 0 else as_values(confidence, count, "confidence"),
                       None if colors is None or count == 0 else as_colors(colors, count), rows(true_normals, "true_normals"),
                       vertices, triangles, vertex_colors, vertex_confidence, report)
    view = View(scene, up == "z", whole("max_points", max_points), whole("height", height))
    if open or (open is None and not _in_notebook()):
        view.open()
    return view
