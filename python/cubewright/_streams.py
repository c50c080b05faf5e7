"""Bytes and file objects in the place of paths."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from ctypes import POINTER, byref, memmove, pointer, string_at
from typing import Any, Protocol, Union

import numpy as np

from . import _declarations as c
from ._errors import Error, Status, call
from ._library import lib
from ._options import name_type, take_path, take_text


class Readable(Protocol):
    """A binary file object that is read: open(..., "rb"), io.BytesIO, a pipe, a member of an archive."""

    def read(self, size: int, /) -> bytes: ...


class Writable(Protocol):
    """A binary file object that is written."""

    def write(self, data: bytes, /) -> Any: ...


Path = Union[str, "os.PathLike[str]"]
Source = Union[Path, bytes, bytearray, memoryview, Readable]
Target = Union[Path, Writable]

_READ: Any = dict(c.cw_byte_source._fields_)["read"]  # type: ignore[arg-type]
_BEGIN: Any = dict(c.cw_byte_sink._fields_)["begin"]  # type: ignore[arg-type]
_WRITE: Any = dict(c.cw_byte_sink._fields_)["write"]  # type: ignore[arg-type]


def is_file(what: Any, method: str) -> bool:
    return not isinstance(what, (str, os.PathLike)) and callable(getattr(what, method, None))


def name_file(file: Any, name: str | None) -> bytes | None:
    """Returns the name that is given, else that of a file object, which may have none."""
    if name is None:
        known = getattr(file, "name", None)
        name = os.path.basename(known) if isinstance(known, str) else None
    return take_text("name", name) if name else None


class Bridge:
    """Carries pieces of bytes between Python and C, and an exception of Python back."""

    def __init__(self, file: Any) -> None:
        self.file = file
        self.exception: BaseException | None = None
        self.left: int | None = None  # of the bytes to write
        self.ended = False  # all bytes went through

    def guard(self, work: Callable[[], None]) -> int:
        try:
            work()
        except BaseException as exception:
            self.exception = exception
            return Status.CANCELLED
        return Status.OK

    def read(self, _user: Any, to: int, capacity: int, got: Any, _error: Any) -> int:
        def work() -> None:
            piece = self.file.read(capacity)
            if not isinstance(piece, (bytes, bytearray, memoryview)):
                raise TypeError(f"read() of a binary file must return bytes, not {name_type(piece)}")
            if len(piece) > capacity:
                raise ValueError(f"read({capacity}) returned {len(piece)} bytes")
            memmove(to, bytes(piece), len(piece))
            got[0] = len(piece)
            self.ended = not piece

        return self.guard(work)

    def begin(self, _user: Any, size: int, _error: Any) -> int:
        self.left = size
        return Status.OK

    def write(self, _user: Any, data: int, size: int, _error: Any) -> int:
        def work() -> None:
            left = string_at(data, size)
            while left:
                taken = self.file.write(left)
                if taken == 0:
                    raise BlockingIOError("write() took no byte")
                left = b"" if taken is None else left[taken:]  # some objects do not count
            self.left = (self.left or 0) - size
            self.ended = self.left == 0

        return self.guard(work)

    @contextmanager
    def carry(self) -> Iterator[None]:
        """Raises the exception of the file object in place of the error that it caused."""
        try:
            yield
        except Error:
            if self.exception is not None:
                raise self.exception from None
            raise
        if not self.ended:  # Ctrl-C between C and the guard of a callback, which C does not see
            raise KeyboardInterrupt


def keep_file(file: Readable, name: bytes | None) -> Any:
    """Reads a file object to its end, into a temporary file."""
    bridge, stored = Bridge(file), POINTER(c.cw_stored_file)()
    source = c.cw_byte_source(
        name=name, read=_READ(bridge.read), folder=os.fsencode(tempfile.gettempdir())
    )
    with bridge.carry():
        call(lib.cw_stored_file_open, byref(source), byref(stored))
    return stored


def keep_bytes(data: Any, name: bytes | None) -> Any:
    """Keeps bytes in memory."""
    view = memoryview(data)
    array = np.frombuffer(view if view.contiguous else bytes(view), np.uint8)
    stored = POINTER(c.cw_stored_file)()
    source = c.cw_byte_source(name=name, bytes=array.ctypes.data, size=array.size)
    call(lib.cw_stored_file_open, byref(source), byref(stored))
    return stored


@contextmanager
def open_source(source: Source, name: str | None, desc: Any) -> Iterator[bytes | None]:
    """Yields the path to read, or keeps bytes and file objects in desc.stored and yields None."""
    if isinstance(source, (bytes, bytearray, memoryview)):
        stored = keep_bytes(source, name_file(None, name))
    elif is_file(source, "read"):
        stored = keep_file(source, name_file(source, name))  # type: ignore[arg-type]
    elif name is not None:
        raise ValueError("name is for bytes and file objects; a path has its own")
    else:
        yield take_path("path", source)
        return
    desc.stored = stored
    try:
        yield None
    finally:
        lib.cw_stored_file_close(stored)


@contextmanager
def open_target(target: Target, desc: Any) -> Iterator[bytes | None]:
    """Yields the path to write, or lets desc.sink pass the bytes to a file object and yields its name or None."""
    if not is_file(target, "write"):
        yield take_path("path", target)
        return
    if desc.no_clobber:
        raise ValueError("no_clobber is for paths; a file object is open already")
    bridge = Bridge(target)
    sink = c.cw_byte_sink(
        begin=_BEGIN(bridge.begin), write=_WRITE(bridge.write), folder=os.fsencode(tempfile.gettempdir())
    )
    desc.sink = pointer(sink)
    with bridge.carry():
        yield name_file(target, None)
