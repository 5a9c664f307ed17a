"""python -m g3r view IN... [-o OUT]: the page to look at, for those who installed the package and not the program."""

from __future__ import annotations

import argparse
import os
import sys
from typing import Any, Dict, List, Optional

from . import Error, InputError, __version__, read, read_mesh, show


def _scene(paths: List[str]) -> Dict[str, Any]:
    """Arguments of `show` for a cloud, a mesh, or one of each."""
    scene: Dict[str, Any] = {}
    for path in paths:
        thing: Any
        try:
            kind, thing = "mesh", read_mesh(path)
        except InputError:  # no faces: points
            kind, thing = "what", read(path)
        if kind in scene:
            raise InputError(f"{path}: view shows one cloud and one mesh")
        scene[kind] = thing
    if "what" not in scene:
        scene["what"], scene["faces"] = scene.pop("mesh")
    return scene


def main(arguments: Optional[List[str]] = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m g3r", description="Normals and meshes of point clouds: see help(g3r).")
    parser.add_argument("--version", action="version", version=f"g3r {__version__}")
    view = parser.add_subparsers(dest="command", required=True).add_parser("view", help="look at a cloud, a mesh, or one of each")
    view.add_argument("inputs", nargs="+", metavar="IN", help="files of points or of a mesh")
    view.add_argument("-o", "--out", help="page .html or picture .png; the browser opens if left out")
    view.add_argument("--z-up", action="store_true", help="the z axis points up instead of the y axis")
    options = parser.parse_args(arguments)
    try:
        title = ", ".join(os.path.basename(path) for path in options.inputs)
        page = show(**_scene(options.inputs), title=title, up="z" if options.z_up else "y", open=options.out is None)
        if options.out is not None:
            page.save(options.out)
    except Error as error:
        print(f"g3r: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
