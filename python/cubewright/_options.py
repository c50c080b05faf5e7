"""Options: keyword arguments checked by type and turned into what C takes."""

from __future__ import annotations

import math
import operator
import os
import re
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


def take_degrees(name: str, value: Any) -> float:
    """Returns an angle above 0, and up to 180 degrees."""
    degrees = take_number(name, value)
    if not 0 < degrees <= 180:
        raise ValueError(f"{name} is {degrees}; above 0, up to 180 degrees was expected")
    return degrees


MILLIMETRES = {"mm": 1.0, "um": 1e-3, "nm": 1e-6, "cm": 10.0, "m": 1000.0, "in": 25.4, "ft": 304.8}
CUBIC_MILLIMETRES = {"mm3": 1.0, "um3": 1e-9, "cm3": 1e3, "ml": 1e3, "m3": 1e9}
QUANTITY = re.compile(r"([-+]?[0-9.]+(?:e[-+]?[0-9]+)?)([a-z%]+3?)", re.IGNORECASE)


def take_quantity(name: str, value: Any, units: dict[str, float], kind: str = "a length") -> float:
    """Returns a number, or that of a text with a unit: "0.5mm". A text without one is a ValueError."""
    if not isinstance(value, str):
        return take_number(name, value)
    found = QUANTITY.fullmatch(value)
    try:
        number = float(found[1]) * units[found[2]] if found else math.nan
    except (KeyError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise ValueError(f"{name} is {value!r}; {kind} with one of the units {', '.join(units)} was expected")
    return number


def take_shift(name: str, value: Any, mesh: Any = None, volume: Any = None) -> float:
    """Returns a length that may be negative, otherwise as take_length()."""
    units = MILLIMETRES
    if isinstance(value, str) and mesh is not None:
        low, high = mesh.bounds
        units = {**units, "%": float(np.linalg.norm(high - low)) / 100}
    if isinstance(value, str) and volume is not None:
        units = {**units, "vox": float(np.prod(volume.spacing)) ** (1 / 3)}
    return take_quantity(name, value, units)


def take_length(name: str, value: Any, mesh: Any = None, volume: Any = None) -> float:
    """Returns a length, in millimetres: 0 or more. Texts name their unit: % is of the diagonal of a mesh's box,
    vox is of a volume."""
    number = take_shift(name, value, mesh, volume)
    if number < 0:
        raise ValueError(f"{name} is {number:g} mm; 0 or more was expected")
    return number


def take_lengths(name: str, values: Any) -> list[float]:
    """Returns three lengths, as take_length() each; one stands for all."""
    if isinstance(values, str) or np.ndim(values) == 0:
        return [take_length(name, values)] * 3
    if isinstance(values, Sequence) and any(isinstance(value, str) for value in values):
        if len(values) != 3:
            raise ValueError(f"{name} has {len(values)} lengths; 3 were expected")
        return [take_length(name, value) for value in values]
    return take_numbers(name, values, 3)


def take_space(name: str, value: Any) -> float:
    """Returns a volume, in cubic millimetres: 0 or more. Texts name their unit."""
    number = take_quantity(name, value, CUBIC_MILLIMETRES, "a volume")
    if number < 0:
        raise ValueError(f"{name} is {number:g} mm3; 0 or more was expected")
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
