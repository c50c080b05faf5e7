"""Errors: the status codes of the library, and the exception that carries one."""

from __future__ import annotations

import enum
import re
from collections.abc import Callable
from ctypes import byref
from typing import Any

from . import _declarations as c
from ._library import lib


class Status(enum.IntEnum):
    """The outcome of a call. `cubewright help exit` explains each."""

    OK = c.cw_status.CW_OK
    CHECK = c.cw_status.CW_ERR_CHECK
    ARGUMENT = c.cw_status.CW_ERR_ARGUMENT
    IO = c.cw_status.CW_ERR_IO
    FORMAT = c.cw_status.CW_ERR_FORMAT
    BACKEND = c.cw_status.CW_ERR_BACKEND
    UNSAFE = c.cw_status.CW_ERR_UNSAFE
    UNSUPPORTED = c.cw_status.CW_ERR_UNSUPPORTED
    OUTPUT = c.cw_status.CW_ERR_OUTPUT
    BATCH = c.cw_status.CW_ERR_BATCH
    LIMIT = c.cw_status.CW_ERR_LIMIT
    NO_MEMORY = c.cw_status.CW_ERR_NO_MEMORY
    EMPTY = c.cw_status.CW_ERR_EMPTY
    CANCELLED = c.cw_status.CW_ERR_CANCELLED

    @property
    def text(self) -> str:
        """The meaning of the status, for people."""
        return str(lib.cw_status_text(self).decode())


class Error(Exception):
    """A call of the library that failed.

    status   a Status, for code to branch on
    message  the library's own words: subject, problem, expected and actual value
    """

    def __init__(self, status: Status, message: str) -> None:
        super().__init__(message or status.text)
        self.status = status
        self.message = message or status.text

    def __reduce__(self) -> tuple[type[Error], tuple[Status, str]]:
        return Error, (self.status, self.message)


# What messages of the library name, and the keyword that stands for it.
KEYWORDS = {
    "desc->gaps = CW_GAPS_INTERPOLATE": "gaps='interpolate'",
    "desc->gaps = CW_GAPS_ALLOW": "gaps='allow'",
    "desc->tilt = CW_TILT_KEEP": "tilt='keep'",
    "desc->nodata = CW_NODATA_NONE": "nodata='none'",
    "desc->nodata": "nodata",
    "desc->skip_damaged": "skip_damaged=True",
    "desc->claim.rule = CW_CLAIM_OVERRIDE": "input_override=True",
    "desc->claim.unit": "input_unit=",
    "desc->spacing_mm": "spacing=",
    "desc->max_bytes": "memory_limit()",
    "desc->no_sandbox": "sandbox=False",
    "desc->snap = 0.5": "snap=0.5",
    "cw_self_intersections()": "deep=True",
    "cw_mesh_offset()": "offset()",
    "cw_mesh_fill_voids()": "extract(..., fill_voids=True)",
    "min_wall_mm": "wall",
    "min_gap_mm": "gap",
    "overhang_deg": "overhang",
    "layer_mm": "layer",
    "plate_mm": "plate",
    "edge_mm is": "edge is",
    "shortest_mm is": "shortest is",
    "error_mm is": "error is",
    "feature_deg is": "features is",
    "min_angle_deg is": "min_angle is",
    "weld_mm is": "weld is",
    "max_hole_mm is": "fill is",
    "wrap_mm is": "wrap is",
    "sigma_voxels[": "sigma[",
    "spacing_mm[": "spacing[",
    "radius_voxels[": "radius[",
    "inside->level": "level",
}


def name_keywords(message: bytes) -> str:
    """Returns a message of the library with keywords in place of C's fields: series= for desc->series."""
    text = message.decode("utf-8", "replace")
    for field, keyword in KEYWORDS.items():
        text = text.replace(field, keyword)
    return re.sub(r"desc->(\w+)", r"\1=", text)


def call(function: Callable[..., int], *arguments: Any) -> None:
    """Calls a function whose last argument is a cw_error. Raises Error unless it returns CW_OK."""
    error = c.cw_error()
    status = function(*arguments, byref(error))
    if status != Status.OK:
        raise Error(Status(status), name_keywords(error.message))
