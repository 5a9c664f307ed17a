"""g3r: from an unoriented point cloud to consistent outward normals and a watertight mesh.

    N = g3r.orient(P)                 # (n, 3) unit outward normals, same order
    V, F = g3r.reconstruct(P)         # mesh
    r = g3r.run(P)                    # all of it: r.normals, r.confidence, r.areas, r.vertices, r.faces, r.field, r.stats
    g3r.show(r)                       # look at it
    g3r.tiles                         # clouds that do not fit into memory
"""

from . import tiles
from ._api import BuildInfo, Device, Field, Result, build_info, devices, mesh_oriented, orient, reconstruct, run
from ._cloud import Cloud, read, read_mesh
from ._errors import Cancelled, Error, FileError, FileMissingError, InputError, UnavailableError
from ._files import write
from ._g3r import __version__
from ._metrics import score_mesh, score_normals
from ._show import show
from ._view import View

__all__ = [
    "BuildInfo", "Cancelled", "Cloud", "Device", "Error", "Field", "FileError", "FileMissingError", "InputError", "Result", "UnavailableError", "View",
    "__version__", "build_info", "devices", "mesh_oriented", "orient", "read", "read_mesh", "reconstruct", "run",
    "score_mesh", "score_normals", "show", "tiles", "write",
]
