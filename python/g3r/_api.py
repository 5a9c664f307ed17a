"""Normals, meshes and the winding field."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Callable, Dict, List, NamedTuple, Optional, Set, Tuple, Union, overload

from . import _g3r
from ._arrays import as_areas, as_colors, as_points, member, opened, points_and_owner, warn_of_file
from ._cloud import Cloud
from ._errors import InputError
from ._hints import HINTS, checked_numbers, take_hints
from ._kinds import integer, number, text, truth, whole
from ._view import DEFAULT_HEIGHT, DEFAULT_POINTS, View

if TYPE_CHECKING:
    from ._types import Bytes, Floats, Indices, Points, Singles

Progress = Callable[[str, float], Optional[bool]]
"""Called as progress(stage, fraction in [0, 1]); returning False cancels, anything else goes on."""

_MESH_OPTIONS = {"mesher", "keep_largest", "min_component", "faces", "keep_all"}
_METHOD_OPTIONS = {"noise", "method", "wnnc_widths", "harmonics", "solver", "schedule", "tolerance", "accuracy", "condition_number",
                   "max_memory", "device"}
_KINDS: Dict[str, Callable[[str, Any], Any]] = {"keep_largest": whole, "faces": whole, "max_memory": whole, "keep_all": truth,
                                                "condition_number": truth}


def _options(epsilon: Union[str, float], degree: Optional[int], preset: str, threads: int, known: Set[str],
             more: Dict[str, Any]) -> Dict[str, Any]:
    unknown = set(more) - known
    if unknown:
        raise TypeError(f"unknown option {sorted(unknown)[0]!r}; there are also {', '.join(sorted(known | HINTS))}")
    options = {"epsilon": epsilon, "preset": preset, "threads": integer("threads", threads), **_checked(more)}
    if degree is not None:
        options["degree"] = integer("degree", degree)
    return options


def _checked(options: Dict[str, Any]) -> Dict[str, Any]:
    """The options with counts and switches as the extension module takes them."""
    return {name: _KINDS[name](name, value) if name in _KINDS else value for name, value in options.items()}


def _depth(depth: Union[str, int]) -> Dict[str, Any]:
    if depth == "auto":
        return {}
    if isinstance(depth, str):
        raise InputError(f"depth must be 'auto' or an integer, not {depth!r}")
    return {"depth": integer("depth", depth, 0)}


def _trim(trim: Union[None, bool, str, float]) -> Dict[str, Any]:
    import numpy as np

    if isinstance(trim, (bool, np.bool_)):
        trim = "auto" if trim else "off"
    if trim is None or isinstance(trim, str) and trim == "off":
        return {}
    if isinstance(trim, str) and trim == "auto":
        return {"trim": "auto"}
    try:
        if not isinstance(trim, str):
            return {"trim": "distance", "trim_distance": float(trim)}
    except (TypeError, ValueError):
        pass
    raise InputError(f"trim must be None, 'auto' or a distance above 0 in input units, not {trim!r}")


class Field:
    """The winding field of oriented points: about 1 inside, 0 outside, 1/2 on the surface. Call it with query points."""

    def __init__(self, points: Any, normals: Any, areas: Any, *, width: float = 0.0, device: str = "auto") -> None:
        """`points`, `normals` (unit, outward): (n, 3); `areas`: (n,) in squared input units. Points of which any of these is not finite
        are left out. `width` of the smoothing in input units, 0: 0.55 spacings. `device`: as in `run`, held as long as the field.
        O(n log n). Raises InputError, UnavailableError."""
        import numpy as np

        array = as_points(points)
        self._field = _g3r.field(array, np.ascontiguousarray(as_points(normals, "normals"), dtype=np.float64),
                                 as_areas(areas, len(array)), number("width", width), text("device", device))

    def __call__(self, queries: Any) -> Floats:
        """The field at (q, 3) query points: (q,) float64. O(n + q log n). Ctrl-C works. Raises InputError."""
        return self._field.value(as_points(queries, "queries"))

    def gradient(self, queries: Any) -> Floats:
        """The gradient at (q, 3) query points, in 1 / input units: (q, 3) float64; near the surface it points inward. As a call of the field."""
        return self._field.gradient(as_points(queries, "queries"))


class Result:
    """What `run` returns.

    normals: (n, 3) float64, unit and outward, in the order of the points; (0, 0, 0) only for points that are not finite.
    confidence: (n,) float32 in [0, 1]; 1 = sure of the side, 0.5 = a choice, 0 = most likely wrong.
    areas: (n,) float64, squared input units.
    vertices, faces: (v, 3) float64 and (m, 3) uint32, counter-clockwise seen from outside; None when run with mesh=False.
    vertex_colors, vertex_confidence: (v, 3) uint8 and (v,) float32, or None.
    points, colors: those that `run` was given, (n, 3), colors uint8 or None; copies, unless they are of a `Cloud`.
    stats: the report as a dict, see docs/report.md.
    """

    def __init__(self, points: Points, normals: Floats, areas: Floats, confidence: Singles, report: str,
                 mesh: Optional[Tuple[Floats, Indices, Optional[Bytes], Optional[Singles]]], device: str = "auto",
                 colors: Optional[Bytes] = None) -> None:
        self.points = points
        self.colors = colors
        self.normals = normals
        self.areas = areas
        self.confidence = confidence
        self.report = report
        self.stats: Dict[str, Any] = json.loads(report)
        self.vertices: Optional[Floats] = None
        self.faces: Optional[Indices] = None
        self.vertex_colors: Optional[Bytes] = None
        self.vertex_confidence: Optional[Singles] = None
        if mesh is not None:
            self.vertices, self.faces, self.vertex_colors, self.vertex_confidence = mesh
        self._device = device
        self._field: Optional[Field] = None

    @property
    def field(self) -> Field:
        """The winding field: r.field(Q), r.field.gradient(Q). Built on first use, for the device that `run` was asked for."""
        if self._field is None:
            self._field = Field(self.points, self.normals, self.areas, device=self._device)
        return self._field

    def __getstate__(self) -> Dict[str, Any]:
        """For pickle and copy: without the field, which is built again where it is used."""
        return {**self.__dict__, "_field": None}

    def __repr__(self) -> str:
        mesh = "no mesh" if self.faces is None else f"{len(self.faces)} faces"
        return f"<g3r.Result: {len(self.normals)} normals, mean confidence {float(self.confidence.mean()):.3f}, {mesh}>"

    def _repr_html_(self) -> str:
        scene = _g3r.scene("g3r", self.points, self.normals, self.confidence, self.colors, None, self.vertices, self.faces,
                           self.vertex_colors, self.vertex_confidence, self.report)
        return View(scene, False, DEFAULT_POINTS, DEFAULT_HEIGHT)._repr_html_()


class Device(NamedTuple):
    """A device that `device="gpu:N"` can name."""

    name: str
    driver: str
    software: bool
    """An OpenCL that runs on the processor: never taken unless it is asked for."""
    memory: int
    """Bytes."""


def devices() -> List[Device]:
    """What drivers of OpenCL and CUDA know of, GPUs first: "gpu:0", "gpu:1", ... Empty without any driver. Takes a fraction of a second."""
    return [Device(*row) for row in _g3r.devices()]


class BuildInfo(NamedTuple):
    """How the package was built and what it runs on."""

    laz: bool
    """LAZ is read and written."""
    e57: bool
    """E57 is read."""
    poisson: bool
    """There is screened Poisson reconstruction, through Open3D."""
    instruction_set: str
    """Vector instructions of the sums on this processor: "AVX3", "AVX2", "SSE2", "NEON"."""
    opencl: bool
    """OpenCL is installed on this machine."""
    cuda: bool
    """A driver of CUDA is."""


def build_info() -> BuildInfo:
    """Takes a few milliseconds: no driver is started. `devices()` tells what drivers have."""
    return BuildInfo(*_g3r.build_info())


def orient(points: Any, *, epsilon: Union[str, float] = "auto", degree: Optional[int] = None, preset: str = "default", threads: int = 0,
           progress: Optional[Progress] = None, **more: Any) -> Floats:
    """Consistent outward normals of an unoriented cloud of a closed surface.

    points: (n, 3) float32 or float64 of any strides, a path, or an object with points (Open3D, trimesh, PyVista, torch, g3r.Cloud).
    The options are those of `run`. Returns (n, 3) unit normals in the order of the points. Warns (UserWarning) of what was odd about the
    file that the points come from.

    Raises InputError (fewer than 4 distinct finite points, all on a line, an option out of range), Cancelled, MemoryError.
    """
    points, hints = take_hints(opened(points), more)
    options = _options(epsilon, degree, preset, threads, _METHOD_OPTIONS, more)
    array = as_points(points)
    options.update(checked_numbers(hints, len(array)))
    warn_of_file(points)
    return _g3r.orient(array, options, [], progress)[0]


@overload
def reconstruct(points: Any, *, colors: None = None, **options: Any) -> Tuple[Floats, Indices]: ...
@overload
def reconstruct(points: Any, *, colors: Any, **options: Any) -> Tuple[Floats, Indices, Bytes]: ...
def reconstruct(points: Any, *, colors: Any = None, **options: Any) -> Any:
    """A watertight mesh of an unoriented cloud: V (v, 3) and F (m, 3); with `colors` (n, 3) also C (v, 3) as bytes.

    Takes and raises what `run` does, and UnavailableError when this build has no mesher. Warns as `orient` does.
    """
    points = opened(points)
    warn_of_file(points)
    result = run(points, colors=colors, **options)
    if colors is None:
        return result.vertices, result.faces
    return result.vertices, result.faces, result.vertex_colors


def run(points: Any, *, colors: Any = None, epsilon: Union[str, float] = "auto", degree: Optional[int] = None, preset: str = "default",
        depth: Union[str, int] = "auto", trim: Union[None, bool, str, float] = None, mesh: bool = True, threads: int = 0,
        progress: Optional[Progress] = None, **more: Any) -> Result:
    """Normals, confidence, areas, mesh, field and report of an unoriented cloud.

    epsilon: width of the mollifier: "auto", a number in input units, "0.5%" of the diagonal, "0.8h" point spacings.
    degree: of method "green", which giving one selects: highest degree of the harmonic polynomials, 0..8; None: 2.
    preset: "default", or "paper": the published method to the letter.
    depth: octree depth of the mesh, "auto" or 4..12.
    trim: None, or for open scans "auto" (or True: 4 spacings) or a distance in input units: surface farther from every point is cut away.
    mesh: False leaves the mesh out.
    colors: (n, 3), bytes or shares of 1, carried to the vertices.
    threads: 0 for all cores; the result does not depend on it.
    progress: called as progress(stage, fraction) on this thread; returning False cancels.
    faces: simplify the mesh to about this many triangles. keep_largest: keep only so many components. keep_all: True keeps surface that too
        few points hold; stats["mesh"]["dropped"] says what was left out.
    noise: standard deviation of the points from their surface, in the units of epsilon; 0: clean. Estimated unless given.
    Hints, what you know and the points cannot say; they decide the sides of open surfaces, and stats["hints"] says what they did:
    up: the direction that open surfaces face, three numbers or an axis such as "+z" or "-y".
    sensor: where the scanner stood, (3,) or (k, 3), or "file": where the file that the points come from says it. sensor_of_point: (n,) the
        number of the sensor of each point, negative for none; without it a point faces the nearest.
    inside: a point inside the solid, (3,), or more of them, (k, 3).
    seen_from_inside: True for rooms, tunnels, streets: normals face the side the scanner was on.
    flip: True turns every normal, after all other hints.
    device: where the sums run: "auto", "cpu", "gpu", or "gpu:N", number N of `devices()`. "auto" takes a GPU for many points.
    Further options: mesher, min_component, method, wnnc_widths, harmonics, solver, schedule, tolerance, accuracy, condition_number,
        max_memory, as in C++.

    stats["warnings"] begins with what was odd about the file that the points come from.

    O(n log n) time, O(n) memory. The interpreter lock is released; Ctrl-C works. Raises InputError, UnavailableError, Cancelled,
    MemoryError.
    """
    points, hints = take_hints(opened(points), more)
    options = _options(epsilon, degree, preset, threads, _METHOD_OPTIONS | _MESH_OPTIONS, more)
    options.update(_depth(depth))
    options.update(_trim(trim))
    array, shared = points_and_owner(points)
    options.update(checked_numbers(hints, len(array)))
    if colors is not None:
        colors = as_colors(colors, len(array)).copy()
    device = options.get("device", "auto")
    warnings = points.warnings if isinstance(points, Cloud) else []
    surface = None
    if truth("mesh", mesh):
        normals, areas, confidence, report, surface = _g3r.reconstruct(array, colors, options, warnings, progress)
    else:
        normals, areas, confidence, report = _g3r.orient(array, options, warnings, progress)
    return Result(array.copy() if shared else array, normals, areas, confidence, report, surface, device, colors)


def mesh_oriented(points: Any, normals: Any = None, *, depth: Union[str, int] = "auto", trim: Union[None, bool, str, float] = None,
                  mesher: str = "auto", noise: Union[str, float] = "auto", keep_largest: int = 0, min_component: Optional[float] = None,
                  keep_all: bool = False, faces: int = 0, max_memory: int = 0, threads: int = 0, device: str = "auto",
                  progress: Optional[Progress] = None) -> Tuple[Floats, Indices]:
    """A mesh of points that already have outward normals: V (v, 3) and F (m, 3). `normals` may be left out if `points` has them.

    noise: standard deviation of the points from their surface, a number in input units, "X%" of the box diagonal or "Xh" point spacings;
    0: clean. Estimated unless given.
    depth, trim, mesher, keep_largest, min_component, keep_all, faces, max_memory, threads, device, progress: see `run`.

    Warns (UserWarning) of what was odd about the file that the points come from, and of what is doubtful about the mesh.
    O(n log n) time. Points that are not finite or whose normal is 0 are left out. Raises InputError (fewer than 4 points left, no surface),
    UnavailableError, Cancelled, MemoryError."""
    points = opened(points)
    if normals is None:
        normals = member(points, "normals", "point_normals", "vertex_normals")
        if normals is None:
            raise InputError("there are no normals; g3r.reconstruct() takes points without them")
    options = _checked({"mesher": mesher, "threads": integer("threads", threads), "device": device, "noise": noise,
                        "keep_largest": keep_largest, "keep_all": keep_all, "faces": faces, "max_memory": max_memory})
    if min_component is not None:
        options["min_component"] = min_component
    options.update({**_depth(depth), **_trim(trim)})
    warn_of_file(points)
    vertices, triangles, _, _ = _g3r.mesh(as_points(points), as_points(normals, "normals"), options, progress)
    return vertices, triangles
