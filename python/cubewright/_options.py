"""Options: keyword arguments checked by type and turned into what C takes."""

from __future__ import annotations

import math
import operator
import os
from collections.abc import Iterable, Sequence
from typing import Any, TypeVar

import numpy as np

T = TypeVar("T")


def name_type(value: object) -> str:
    return type(value).__name__


def take_number(name: str, value: Any) -> float:
    """Returns a finite number as a float. Strings and booleans are TypeErrors."""
    if isinstance(value, (bool, np.bool_, str, bytes)):
        raise TypeError(f"{name} must be a number, not {name_type(value)}")
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{name} must be a number, not {name_type(value)}") from None
    if not math.isfinite(number):
        raise ValueError(f"{name} is {number}; a finite number was expected")
    return number


def take_length(name: str, value: Any) -> float:
    """Returns a length, in millimetres: 0 or more."""
    number = take_number(name, value)
    if number < 0:
        raise ValueError(f"{name} is {number:g} mm; 0 or more was expected")
    return number


def take_count(name: str, value: Any, low: int = 0, high: int = 2**63 - 1) -> int:
    """Returns a whole number of a range. Floats and booleans are TypeErrors."""
    if isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name} must be a whole number, not {name_type(value)}")
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} must be a whole number, not {name_type(value)}") from None
    if not low <= number <= high:
        raise ValueError(f"{name} is {number}; {low} to {high} was expected")
    return number


def take_threads(value: Any) -> int:
    return take_count("threads", value, 0, 4096)


def take_flag(name: str, value: Any) -> bool:
    if not isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name} must be True or False, not {name_type(value)}")
    return bool(value)


def take_choice(name: str, value: Any, choices: Sequence[str]) -> int:
    """Returns the position of a word among the choices."""
    if not isinstance(value, str):
        raise TypeError(f"{name} must be a string, not {name_type(value)}")
    if value not in choices:
        raise ValueError(f"{name} is {value!r}; expected one of {', '.join(choices)}")
    return choices.index(value)


def take_text(name: str, value: Any) -> bytes | None:
    if value is None:
        return None
    if not isinstance(value, str):
        raise TypeError(f"{name} must be a string, not {name_type(value)}")
    if "\0" in value:
        raise ValueError(f"{name} has a zero character in it")
    return value.encode()


def take_path(name: str, value: Any) -> bytes:
    if not isinstance(value, (str, bytes, os.PathLike)):
        raise TypeError(f"{name} must be a path, not {name_type(value)}")
    path = os.fsencode(value)
    if b"\0" in path:
        raise ValueError(f"{name} has a zero character in it")
    return path


def take_numbers(name: str, value: Any, count: int) -> list[float]:
    """Returns `count` finite numbers as floats."""
    if isinstance(value, (str, bytes)) or not isinstance(value, (Iterable, np.ndarray)):
        raise TypeError(f"{name} must be {count} numbers, not {name_type(value)}")
    numbers = [take_number(name, each) for each in value]
    if len(numbers) != count:
        raise ValueError(f"{name} has {len(numbers)} numbers; {count} were expected")
    return numbers


def take_instance(name: str, value: Any, kind: type[T]) -> T:
    if not isinstance(value, kind):
        raise TypeError(f"{name} must be a {kind.__name__}, not {name_type(value)}")
    return value
