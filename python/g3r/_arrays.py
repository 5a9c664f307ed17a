"""Objects of other libraries as NumPy arrays, by what they offer and not by what they are: none of those libraries is imported.

NumPy is imported where it is first needed, so that `import g3r` does not wait for it.
"""

from __future__ import annotations

import os
import warnings
from typing import TYPE_CHECKING, Any, Tuple

from ._cloud import Cloud, read
from ._errors import InputError

if TYPE_CHECKING:
    from ._types import Bytes, Floats, Indices, Points, Singles

_SHARE_SLACK = 0.01  # of colours that are shares: what rounding and resampling leave beyond 0 and 1


def _plain(value: Any) -> Points:
    """A tensor, a device array, a list: as an array, without a copy where there is one in memory already. Masked numbers are NaN."""
    import numpy as np

    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value) and value.dtype.kind in "fiub":
        filled: Points = np.ma.filled(value.astype(value.dtype if value.dtype.kind == "f" else np.float64), np.nan)
        return filled
    if hasattr(value, "detach"):  # torch: drop the graph, come to the CPU
        value = value.detach()
    if hasattr(value, "cpu") and callable(value.cpu):
        value = value.cpu()
    if hasattr(value, "numpy") and callable(value.numpy):  # torch, tensorflow, open3d.core
        value = value.numpy()
    if not hasattr(value, "__array__") and hasattr(value, "__dlpack__"):
        value = np.from_dlpack(value)
    try:
        return np.asarray(value)
    except (TypeError, ValueError) as error:
        raise InputError(f"cannot make an array of {type(value).__name__}: {error}") from None


def _complete(value: Any, what: str) -> Points:
    """As `_plain`, of what has no word for a number that is not there."""
    import numpy as np

    if np.ma.is_masked(value):
        raise InputError(f"{what} must not be masked")
    return _plain(value)


def _is_array(value: Any) -> bool:
    return isinstance(value, (list, tuple)) or hasattr(value, "__array__") or hasattr(value, "__dlpack__")


def member(value: Any, *names: str) -> Any:
    """The first of these attributes (or, for open3d.t, of these keys of `.point`) that is there and not empty; None if there is none."""
    keyed = getattr(value, "point", None)
    for name in names:
        found = getattr(value, name, None)
        if found is None and keyed is not None and hasattr(keyed, "__getitem__"):
            try:
                found = keyed[name]
            except (KeyError, RuntimeError):
                found = None
        if found is None or callable(found):
            continue
        if not hasattr(found, "__len__") or len(found) > 0:
            return found
    return None


def _rows(value: Any, what: str) -> Points:
    array = _plain(value)
    if array.ndim != 2 or array.shape[1] != 3:
        raise InputError(f"{what} must be an array of shape (n, 3), not {array.shape}")
    return array


def opened(value: Any) -> Any:
    """A path as the `Cloud` that it names; anything else as it is."""
    return read(value) if isinstance(value, (str, bytes, os.PathLike)) else value


def warn_of_file(value: Any) -> None:
    """Warns the caller of a public function of what was odd about the file that a `Cloud` comes from."""
    for warning in value.warnings if isinstance(value, Cloud) else []:
        warnings.warn(warning, UserWarning, stacklevel=3)


def faces_in(value: Any) -> Any:
    """The faces that an object has; None if there are none. Of trimesh these are `faces`: its `triangles` are corners."""
    for name in ("faces", "triangles"):
        found = member(value, name)
        if found is not None and _plain(found).dtype.kind in "iu":
            return found
    return None


def as_points(value: Any, what: str = "points") -> Points:
    """(n, 3) float32 or float64 with adjacent coordinates; a view of the caller's memory where that is one already."""
    return points_and_owner(value, what)[0]


def points_and_owner(value: Any, what: str = "points") -> Tuple[Points, bool]:
    """What `as_points` returns, and whether the caller may write to its memory."""
    import numpy as np

    value = opened(value)
    read_only = isinstance(value, Cloud)
    if isinstance(value, Cloud):
        value = value.points
    if not _is_array(value):
        inner = member(value, "points", "vertices", "positions")
        if inner is None:
            raise InputError(f"{what}: cannot find points in an object of type {type(value).__name__}; pass an array of shape (n, 3)")
        value = inner
    given = array = _rows(value, what)
    if array.dtype.kind not in "fiub":
        raise InputError(f"{what} must be numbers, not {array.dtype}")
    if array.dtype not in (np.float32, np.float64) or not array.dtype.isnative:
        array = array.astype(np.float32 if array.dtype == np.float16 or array.dtype.newbyteorder("=") == np.float32 else np.float64)
    itemsize = array.dtype.itemsize
    aligned = array.flags.aligned and array.strides[0] % itemsize == 0
    if array.size and (array.strides[1] != itemsize or not aligned):
        array = array.copy(order="C")
    return array, not read_only and np.may_share_memory(array, given)


def as_colors(value: Any, count: int, what: str = "colors") -> Bytes:
    """(n, 3) bytes; a fourth channel is dropped.

    Integers are bytes. Floats are shares of 1, or, where they go beyond that and all are whole numbers of 0..255, bytes; NaN is 0.
    """
    import numpy as np

    array = _complete(value, what)
    if array.ndim != 2 or array.shape[1] not in (3, 4) or array.shape[0] != count:
        raise InputError(f"{what} must be an array of shape ({count}, 3), not {array.shape}")
    array = array[:, :3]
    if array.dtype.kind == "f":
        finite = array[np.isfinite(array)]
        if not ((finite < -_SHARE_SLACK) | (finite > 1 + _SHARE_SLACK)).any():
            array = np.rint(255 * np.clip(np.nan_to_num(array), 0, 1))
        elif (finite == np.rint(finite)).all() and ((finite >= 0) & (finite <= 255)).all():
            array = np.clip(np.nan_to_num(array), 0, 255)
        else:
            raise InputError(f"{what} must be bytes (0..255) or shares (0..1)")
    elif array.dtype.kind not in "iu":
        raise InputError(f"{what} must be numbers, not {array.dtype}")
    if array.size and (array.min() < 0 or array.max() > 255):
        raise InputError(f"{what} must be bytes (0..255) or shares (0..1)")
    return np.ascontiguousarray(array, dtype=np.uint8)


def _values(value: Any, count: int, what: str) -> Points:
    array = _complete(value, what)
    if array.shape != (count,):
        raise InputError(f"{what} must be an array of shape ({count},), not {array.shape}")
    if array.dtype.kind not in "fiub":
        raise InputError(f"{what} must be numbers, not {array.dtype}")
    return array


def as_values(value: Any, count: int, what: str) -> Singles:
    """(n,) float32."""
    import numpy as np

    return np.ascontiguousarray(_values(value, count, what), dtype=np.float32)


def as_areas(value: Any, count: int) -> Floats:
    """(n,) float64."""
    import numpy as np

    return np.ascontiguousarray(_values(value, count, "areas"), dtype=np.float64)


def as_faces(value: Any, vertices: int) -> Indices:
    """(m, 3) uint32 that name existing vertices. PyVista's padded list (3, a, b, c, 3, ...) is understood."""
    import numpy as np

    array = _complete(value, "faces")
    if array.ndim == 1 and array.size % 4 == 0 and np.all(array[::4] == 3):
        array = array.reshape(-1, 4)[:, 1:]
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "iu":
        raise InputError(f"faces must be integers of shape (m, 3), not {array.dtype} of shape {array.shape}")
    if array.size and (array.min() < 0 or array.max() >= vertices):
        raise InputError(f"a face names a vertex outside 0..{vertices - 1}")
    return np.ascontiguousarray(array, dtype=np.uint32)
