"""Arguments, checked before the program is called."""

from __future__ import annotations

import difflib
import math
import numbers
from collections.abc import Sequence
from typing import Any

# pytest shows the line that called volref, not the lines of volref.
__tracebackhide__ = True


def whole(argument: str, value: Any, least: int, most: int) -> int:
    """``value`` as a whole number from ``least`` to ``most``. Raises TypeError for what is no number, and
    ValueError for another number."""
    allowed = f"give a whole number from {least} to {most}"
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise TypeError(f"{argument} is {value!r}, of type {type(value).__name__}: {allowed}")
    if not least <= value <= most or value != int(value):
        raise ValueError(f"{argument} is {shown(value)}: {allowed}")
    return int(value)


def number(argument: str, value: Any, allowed: str, least: float = -math.inf, most: float = math.inf) -> float:
    """``value`` as a finite number from ``least`` to ``most``, which ``allowed`` says in words. Raises TypeError
    for what is no number, and ValueError for another number."""
    if not isinstance(value, numbers.Real):
        raise TypeError(f"{argument} is {value!r}, of type {type(value).__name__}: give {allowed}")
    try:
        real = float(value)
    except OverflowError:
        # A whole number, or a fraction, beyond all floats.
        real = math.inf
    if not math.isfinite(real) or not least <= real <= most:
        raise ValueError(f"{argument} is {shown(value)}: give {allowed}")
    return real


def shown(value: Any) -> str:
    """``value`` for a message: of a number with more digits than anyone reads, the first."""
    try:
        text = str(value)
    except ValueError:
        return "a number of thousands of digits"
    return text if len(text) <= 40 else f"{text[:20]}… ({len(text)} characters)"


def one_of(argument: str, value: Any, names: Sequence[str]) -> str:
    """``value``, one of ``names``. Raises ValueError for another, with the nearest name."""
    if value in names:
        return value
    near = difflib.get_close_matches(str(value), names, n=1)
    hint = f" (did you mean {near[0]!r}?)" if near else ""
    raise ValueError(f"{argument} is {value!r}: give one of {', '.join(names)}{hint}")
