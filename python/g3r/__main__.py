"""python -m g3r view IN... [-o OUT]: the page to look at, for those who installed the package and not the program."""

from __future__ import annotations

import argparse
import os
import sys
from typing import Any, List, Optional

from . import Cloud, Error, InputError, View, __version__, _g3r, read
from ._errors import NoFaces
from ._view import DEFAULT_HEIGHT, DEFAULT_POINTS


def _warn(text: str) -> None:
    print(f"g3r: warning: {text}", file=sys.stderr)


def _mesh_if_any(path: str) -> Any:
    """Vertices, faces, colours and confidence; None for points."""
    if not os.path.isfile(path):  # a folder, a pattern
        return None
    try:
        return _g3r.read_mesh(os.fsencode(path))
    except NoFaces:
        return None
    except InputError as error:
        _warn(f"shown as points: {error}")
        return None


def _scene(paths: List[str]) -> _g3r.Scene:
    """Of a cloud, a mesh, or one of each."""
    cloud: Optional[Cloud] = None
    mesh: Any = None
    for path in paths:
        found = _mesh_if_any(path)
        if (cloud if found is None else mesh) is not None:
            raise InputError(f"{path}: view shows one cloud and one mesh")
        if found is not None:
            mesh = found
            continue
        cloud = read(path)
        for warning in cloud.warnings:
            _warn(f"{path}: {warning}")
    points, normals, confidence, colors = (None,) * 4 if cloud is None else (cloud.points, cloud.normals, cloud.confidence, cloud.colors)
    vertices, faces, vertex_colors, vertex_confidence = (None,) * 4 if mesh is None else mesh
    title = os.fsencode(", ".join(os.path.basename(path) for path in paths)).decode(errors="backslashreplace")
    return _g3r.scene(title, points, normals, confidence, colors, None, vertices, faces, vertex_colors, vertex_confidence, "")


def _check_output(out: str, inputs: List[str]) -> None:
    """Refuses what is no page and no picture, and what would replace an input."""
    if os.path.splitext(out)[1].lower() not in (".html", ".png"):
        raise InputError(f"{out}: view writes .html or .png")
    for path in inputs:
        if os.path.exists(path) and os.path.exists(out) and os.path.samefile(path, out):
            raise InputError(f"{out}: is an input too; choose another output")


def main(arguments: Optional[List[str]] = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m g3r", description="Normals and meshes of point clouds: see help(g3r).")
    parser.add_argument("--version", action="version", version=f"g3r {__version__}")
    view = parser.add_subparsers(dest="command", required=True).add_parser("view", help="look at a cloud, a mesh, or one of each")
    view.add_argument("inputs", nargs="+", metavar="IN", help="files, folders or patterns of points, or a file of a mesh")
    view.add_argument("-o", "--out", help="page .html or picture .png; the browser opens if left out")
    view.add_argument("--z-up", action="store_true", help="the z axis points up instead of the y axis")
    options = parser.parse_args(arguments)
    try:
        if options.out is not None:
            _check_output(options.out, options.inputs)
        page = View(_scene(options.inputs), options.z_up, DEFAULT_POINTS, DEFAULT_HEIGHT)
        if options.out is None:
            page.open()
        else:
            page.save(options.out)
    except Error as error:
        print(f"g3r: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
