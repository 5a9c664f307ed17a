"""Hints: what people know of a cloud and its points cannot say. See g3r.run()."""

from __future__ import annotations

from typing import Any, Dict, Tuple

from ._arrays import _plain, opened
from ._cloud import Cloud
from ._errors import InputError
from ._kinds import truth

HINTS = {"up", "sensor", "sensor_of_point", "inside", "seen_from_inside", "flip"}
_NO_SENSOR = 0xFFFFFFFF


def _places(value: Any, name: str) -> Any:
    import numpy as np

    array = _plain(value)
    if array.dtype.kind not in "fiu" or array.shape[-1:] != (3,) or array.ndim > 2:
        raise InputError(f"{name} must be three numbers or an array of shape (k, 3), not {value!r}")
    return np.ascontiguousarray(array.reshape(-1, 3), dtype=np.float64)


def _direction(value: Any) -> Any:
    """A text, which the library reads, or one row."""
    if isinstance(value, str):
        return value
    rows = _places(value, "up")
    if len(rows) != 1 or not rows.any():
        raise InputError(f"up must be one direction, not {value!r}")
    return rows


def _numbers(value: Any, count: int) -> Any:
    import numpy as np

    array = _plain(value)
    if array.shape != (count,) or array.dtype.kind not in "iu":
        raise InputError(f"sensor_of_point must be integers of shape ({count},), not {array.dtype} of shape {array.shape}")
    if array.size and array.max() > _NO_SENSOR:
        raise InputError(f"sensor_of_point names a sensor {array.max()}")
    return np.ascontiguousarray(np.where(array < 0, _NO_SENSOR, array), dtype=np.uint32)


def take_hints(points: Any, more: Dict[str, Any]) -> Tuple[Any, Dict[str, Any]]:
    """The points, read if they are a file that the hints are in, and the hints among `more` for the extension module."""
    given = {name: more.pop(name) for name in HINTS & set(more)}
    hints: Dict[str, Any] = {name: truth(name, given[name]) for name in ("seen_from_inside", "flip") if given.get(name) is not None}
    sensor, numbers = given.get("sensor"), given.get("sensor_of_point")
    if isinstance(sensor, str):
        if sensor != "file":
            raise InputError(f"sensor must be places or 'file', not {sensor!r}")
        if numbers is not None:
            raise InputError("sensor_of_point belongs to sensors that are given: with sensor='file' the file says which saw each point")
        points = opened(points)
        sensor = points.sensor_positions if isinstance(points, Cloud) else None
        if sensor is None:
            raise InputError("sensor='file': these points do not come from a file that says where the scanner stood")
        numbers = points.scan_of_point
    if given.get("up") is not None:
        hints["up"] = _direction(given["up"])
    if sensor is not None:
        hints["sensors"] = _places(sensor, "sensor")
    if given.get("inside") is not None:
        hints["inside"] = _places(given["inside"], "inside")
    if numbers is not None:
        hints["sensor_of_point"] = numbers
    return points, hints


def checked_numbers(hints: Dict[str, Any], count: int) -> Dict[str, Any]:
    """The hints with `sensor_of_point` as the extension module takes it, for `count` points."""
    if "sensor_of_point" in hints:
        hints["sensor_of_point"] = _numbers(hints["sensor_of_point"], count)
    return hints
