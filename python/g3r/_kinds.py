"""What kinds of values options take."""

from __future__ import annotations

from typing import Any, Optional

from ._errors import InputError


def integer(name: str, value: Any, least: Optional[int] = None) -> int:
    """An integer, of any type that holds one, `least` or more."""
    try:
        number = int(value)
        if number == value and (least is None or number >= least):
            return number
    except (TypeError, ValueError, OverflowError):
        pass
    raise InputError(f"{name} must be an integer{'' if least is None else f', {least} or more'}, not {value!r}")


def whole(name: str, value: Any) -> int:
    """An integer, 0 or more."""
    return integer(name, value, 0)


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
