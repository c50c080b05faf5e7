"""Closing of small handles and tunnels, which noise makes."""

from __future__ import annotations

from ctypes import byref
from dataclasses import dataclass
from typing import Any

from . import _declarations as c
from ._library import lib
from ._mesh import Mesh, take_mesh
from ._options import take_length, take_threads
from ._progress import Progress, Reporter


@dataclass(frozen=True)
class Closed:
    """A mesh whose small handles were closed, and facts on it. Lengths are in mm."""

    mesh: Mesh
    length: float  # of the longest loop that was closed
    handles_before: int
    handles_after: int
    cut: int  # thin handles
    filled: int  # narrow tunnels
    left_long: int  # handles without a short loop
    left_crossing: int  # handles whose caps would cross the surface
    change: float  # the largest distance from the surface before


def describe_handles(length: float | str, mesh: Mesh | None = None, volume: Any = None) -> c.cw_close_handles_desc:
    if length == "auto":
        return c.cw_close_handles_desc()
    found = take_length("length", length, mesh, volume)
    if not found > 0:
        raise ValueError(f"length is {length!r}; 'auto' or a length above 0 was expected")
    return c.cw_close_handles_desc(length_mm=found)


def close_handles(
    mesh: Mesh, length: float | str = "auto", *, threads: int = 0, progress: Progress = None
) -> Closed:
    """Returns a mesh without small handles and tunnels, which simplify() would keep.

    length  of the longest loop around a handle, or through a tunnel: in mm, or a text with a unit: "4mm",
            "2%" of the diagonal of the mesh's box; "auto": 3 % of it

    Thin handles are cut and narrow tunnels are filled by smooth caps. Nothing falls apart, and no
    triangles meet that did not meet before. A mesh without a short loop stays the same. Vertices at
    equal positions count as different ones: weld() them first.
    Raises Error: ARGUMENT, LIMIT, NO_MEMORY, CANCELLED.
    """
    source = take_mesh("mesh", mesh)
    reporter = Reporter(progress)
    desc = describe_handles(length, mesh)
    desc.threads = take_threads(threads)
    desc.progress = reporter.struct
    out, facts = Mesh._from_c(c.cw_mesh()), c.cw_close_handles_facts()
    reporter.call(lib.cw_mesh_close_handles, byref(source), byref(desc), byref(out._struct), byref(facts))
    return Closed(
        mesh=out,
        length=facts.length_mm,
        handles_before=facts.genus_before,
        handles_after=facts.genus_after,
        cut=facts.cut,
        filled=facts.filled,
        left_long=facts.left_long,
        left_crossing=facts.left_crossing,
        change=facts.change_mm,
    )
