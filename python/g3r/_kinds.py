"""What kinds of values options take."""

from __future__ import annotations

import sys
from typing import Any, Optional

from ._errors import InputError


MOST = 2**31 - 1  # of an int of the library
MOST_WHOLE = 2 * sys.maxsize + 1  # of one of its counts


def integer(name: str, value: Any, least: Optional[int] = None, most: int = MOST) -> int:
    """An integer, of any type that holds one, `least` or more and `most` at most."""
    lowest = -MOST if least is None else least
    kind = "an integer" if least is None else f"an integer, {least} or more"
    try:
        number = int(value)
        if number == value:
            if lowest <= number <= most:
                return number
            kind = f"{most} at most" if number > most else f"an integer, {lowest} or more"
    except (TypeError, ValueError, OverflowError):
        pass
    raise InputError(f"{name} must be {kind}, not {value!r}")


def whole(name: str, value: Any) -> int:
    """An integer, 0 or more."""
    return integer(name, value, 0, MOST_WHOLE)


def text(name: str, value: Any) -> str:
    """A text."""
    if not isinstance(value, str):
        raise InputError(f"{name} must be a text, not {value!r}")
    return value


def truth(name: str, value: Any) -> bool:
    """True or False, of any type that equals one of them."""
    try:
        if value in (True, False):
            return bool(value)
    except ValueError:  # an array
        pass
    raise InputError(f"{name} must be True or False, not {value!r}")


def number(name: str, value: Any) -> float:
    """A number, of any type that holds one; no text."""
    try:
        if not isinstance(value, (str, bytes)):
            return float(value)
    except (TypeError, ValueError, OverflowError):
        pass
    raise InputError(f"{name} must be a number, not {value!r}")


def is_false(answer: Any) -> bool:
    """Whether a function that reports progress has returned False or NumPy's, which comparisons of its numbers give; 0 is none."""
    import numpy as np

    return isinstance(answer, (bool, np.bool_)) and not answer
