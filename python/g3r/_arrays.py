"""Objects of other libraries as NumPy arrays, by what they offer and not by what they are: none of those libraries is imported.

NumPy is imported where it is first needed, so that `import g3r` does not wait for it.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from ._cloud import read
from ._errors import InputError

if TYPE_CHECKING:
    from ._types import Bytes, Indices, Points, Singles


def _plain(value: Any) -> Points:
    """A tensor, a device array, a list: as an array, without a copy where there is one in memory already."""
    import numpy as np

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


def whole(name: str, value: Any) -> int:
    """An integer, 0 or more."""
    if int(value) != value or value < 0:
        raise InputError(f"{name} must be an integer, 0 or more, not {value!r}")
    return int(value)


def as_points(value: Any, what: str = "points") -> Points:
    """(n, 3) float32 or float64 with adjacent coordinates; a view of the caller's memory where that is one already."""
    import numpy as np

    if isinstance(value, (str, bytes, os.PathLike)):
        value = read(value)
    if not _is_array(value):
        inner = member(value, "points", "vertices", "positions")
        if inner is None:
            raise InputError(f"{what}: cannot find points in an object of type {type(value).__name__}; pass an array of shape (n, 3)")
        value = inner
    array = _rows(value, what)
    if array.dtype.kind not in "fiub":
        raise InputError(f"{what} must be numbers, not {array.dtype}")
    if array.dtype not in (np.float32, np.float64) or not array.dtype.isnative:
        array = array.astype(np.float32 if array.dtype == np.float16 or array.dtype.newbyteorder("=") == np.float32 else np.float64)
    itemsize = array.dtype.itemsize
    aligned = array.flags.aligned and array.strides[0] % itemsize == 0
    if array.size and (array.strides[1] != itemsize or not aligned):
        array = array.copy(order="C")
    return array


def as_colors(value: Any, count: int, what: str = "colors") -> Bytes:
    """(n, 3) bytes; numbers with a fraction are shares of 1, a fourth channel is dropped."""
    import numpy as np

    array = _plain(value)
    if array.ndim != 2 or array.shape[1] not in (3, 4) or array.shape[0] != count:
        raise InputError(f"{what} must be an array of shape ({count}, 3), not {array.shape}")
    array = array[:, :3]
    if array.dtype.kind == "f":
        array = np.rint(255 * np.clip(np.nan_to_num(array), 0, 1))
    elif array.dtype.kind not in "iu":
        raise InputError(f"{what} must be numbers, not {array.dtype}")
    if array.size and (array.min() < 0 or array.max() > 255):
        raise InputError(f"{what} must be bytes (0..255) or shares (0..1)")
    return np.ascontiguousarray(array, dtype=np.uint8)


def as_values(value: Any, count: int, what: str) -> Singles:
    """(n,) float32."""
    import numpy as np

    array = _plain(value)
    if array.shape != (count,):
        raise InputError(f"{what} must be an array of shape ({count},), not {array.shape}")
    return np.ascontiguousarray(array, dtype=np.float32)


def as_faces(value: Any, vertices: int) -> Indices:
    """(m, 3) uint32 that name existing vertices. PyVista's padded list (3, a, b, c, 3, ...) is understood."""
    import numpy as np

    array = _plain(value)
    if array.ndim == 1 and array.size % 4 == 0 and np.all(array[::4] == 3):
        array = array.reshape(-1, 4)[:, 1:]
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "iu":
        raise InputError(f"faces must be integers of shape (m, 3), not {array.dtype} of shape {array.shape}")
    if array.size and (array.min() < 0 or array.max() >= vertices):
        raise InputError(f"a face names a vertex outside 0..{vertices - 1}")
    return np.ascontiguousarray(array, dtype=np.uint32)
