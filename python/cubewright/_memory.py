"""Memory of the C library as NumPy arrays: shared, and kept alive by the arrays."""

from __future__ import annotations

import ctypes
import os
import weakref
from collections.abc import Callable
from typing import Any, Generic, TypeVar

import numpy as np
import numpy.typing as npt

from . import _declarations as c
from ._errors import call
from ._library import lib
from ._options import take_count, take_path


S = TypeVar("S", bound=ctypes.Structure)


class Owner(Generic[S]):
    """Owns a C struct with arrays: frees them when the last array and object that use it go."""

    def __init__(self, struct: S, free: Callable[[Any], Any]) -> None:
        self.struct = struct
        # At exit nothing is freed: arrays may still be in use then.
        weakref.finalize(self, free, ctypes.byref(struct)).atexit = False


class _Lent:
    """Describes memory to NumPy; the array that NumPy makes of it holds the owner."""

    def __init__(self, owner: object, interface: dict[str, Any]) -> None:
        self.owner = owner
        self.__array_interface__ = interface


def lend_array(
    owner: object,
    address: int,
    kind: str,
    shape: tuple[int, ...],
    strides: tuple[int, ...] | None = None,
    writable: bool = True,
) -> npt.NDArray[Any]:
    """Returns an array over memory at an address. The array keeps the owner alive."""
    if 0 in shape:
        return np.empty(shape, kind)
    interface = {
        "version": 3,
        "shape": shape,
        "typestr": np.dtype(kind).str,
        "data": (address, not writable),
        "strides": strides,
    }
    return np.asarray(_Lent(owner, interface))


def find_address(pointer: Any) -> int:
    """Returns where a ctypes pointer points; 0 for NULL."""
    return ctypes.cast(pointer, ctypes.c_void_p).value or 0


def memory_used() -> int:
    """Returns the bytes that arrays of the library take now. Arrays of NumPy do not count."""
    return int(lib.cw_memory_used())


def memory_limit(bytes: int) -> None:
    """Limits the bytes of the library's arrays; calls that need more raise Error (NO_MEMORY).

    0 means no limit. Only Linux counts.
    """
    lib.cw_memory_limit(take_count("bytes", bytes))


def memory_overflow(path: str | os.PathLike[str] | None) -> None:
    """Lets large arrays beyond memory_limit() go to temporary files in the folder of a path; None: no longer.

    The files have no names, and end with their arrays or the process. Results have the same bytes.
    """
    desc = c.cw_overflow_desc()
    if path is not None:
        desc.path = take_path("path", path)
    call(lib.cw_memory_overflow, ctypes.byref(desc))


def memory_overflowed() -> int:
    """Returns the bytes of arrays that are in temporary files now."""
    return int(lib.cw_memory_overflowed())


def unpack(struct: ctypes.Structure) -> dict[str, Any]:
    """Returns the fields of a struct of numbers and texts as a dict that JSON can hold."""
    values: dict[str, Any] = {}
    for field in struct._fields_:
        value = getattr(struct, field[0])
        if isinstance(value, ctypes.Structure):
            value = unpack(value)
        elif isinstance(value, ctypes.Array):
            value = list(value)
        elif isinstance(value, bytes):
            value = value.decode("utf-8", "replace")
        values[field[0]] = value
    return values
