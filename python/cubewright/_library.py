"""Finds, checks and loads the C library; gives its functions their types."""

from __future__ import annotations

import ctypes
import ctypes.util
import os
import pathlib

from . import _declarations as c

SONAME = "libcubewright.so.0"


def list_places() -> list[str]:
    """Returns the names to try, in order: the environment's, that of an install, the system's."""
    named = os.environ.get("CUBEWRIGHT_LIBRARY")
    if named:
        return [named]
    # An install has PREFIX/lib/python3/dist-packages/cubewright, and the library in PREFIX/lib,
    # PREFIX/lib64, or a folder of PREFIX/lib for the machine's architecture.
    lib = pathlib.Path(__file__).resolve().parents[3]
    beside = [lib / SONAME, lib.parent / "lib64" / SONAME, *sorted(lib.glob(f"*/{SONAME}"))]
    return [str(path) for path in beside if path.exists()] + [SONAME]


def load_library() -> ctypes.CDLL:
    """Loads the first library that can be loaded.

    Raises ImportError, naming each place that was tried and what is wrong there.
    """
    failures = []
    for place in list_places():
        try:
            return prepare_library(ctypes.CDLL(place), place)
        except OSError as error:
            failures.append(f"{place}: {error}")
    raise ImportError(
        "the cubewright library was not found; install it, or set CUBEWRIGHT_LIBRARY to the "
        f"path of {SONAME}. Tried: " + "; ".join(failures)
    )


def prepare_library(library: ctypes.CDLL, place: str) -> ctypes.CDLL:
    """Checks the version, and sets argument and result types of all functions."""
    try:
        library.cw_version.restype = ctypes.c_char_p
        version = library.cw_version().decode()
    except AttributeError:
        raise ImportError(f"{place} is not the cubewright library: it has no cw_version()") from None
    if version.split(".")[:2] != c.CW_VERSION.split(".")[:2]:
        raise ImportError(
            f"{place} is cubewright {version}; this package is for {c.CW_VERSION} "
            "(major and minor version must agree)"
        )
    for name, (result, arguments) in c.FUNCTIONS.items():
        try:
            function = getattr(library, name)
        except AttributeError:
            raise ImportError(
                f"{place}: cubewright {version} has no function {name}(), which this package "
                f"({c.CW_VERSION}) expects: install package and library from one source"
            ) from None
        function.restype = result
        function.argtypes = arguments
    return library


lib = load_library()
