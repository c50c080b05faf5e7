"""Cuts of meshes by a plane."""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import byref
from dataclasses import dataclass

from . import _declarations as c
from ._library import lib
from ._mesh import Mesh, take_mesh
from ._options import take_flag, take_numbers
from ._progress import Progress, Reporter


@dataclass(frozen=True)
class Cut:
    """A mesh that was cut, and facts on the cut."""

    mesh: Mesh
    cut_triangles: int  # that the plane parted
    dropped_triangles: int  # on the other side, or in the plane
    cap_triangles: int  # that close the section
    loops_closed: int  # closed loops of the section that were filled
    loops_open: int  # lines of the section that end at open edges, or loops with leave_open
    area: float  # of the section, mm2
    moved: float  # mm: the farthest that a vertex moved into the plane


def describe_cut(point: Sequence[float], normal: Sequence[float], *, leave_open: bool = False) -> c.cw_cut_desc:
    return c.cw_cut_desc(
        point=tuple(take_numbers("point", point, 3)),
        normal=tuple(take_numbers("normal", normal, 3)),
        leave_open=take_flag("leave_open", leave_open),
    )


def cut(
    mesh: Mesh,
    point: Sequence[float],
    normal: Sequence[float],
    *,
    leave_open: bool = False,
    progress: Progress = None,
) -> Cut:
    """Cuts a mesh by a plane, keeps the side that the normal points to, and closes it flat.

    point       of the plane, in the world, mm
    normal      of any length above 0
    leave_open  do not close the section

    Raises Error: ARGUMENT (the normal is 0), EMPTY (nothing is on that side), LIMIT, NO_MEMORY,
    CANCELLED.
    """
    source = take_mesh("mesh", mesh)
    reporter = Reporter(progress)
    desc = describe_cut(point, normal, leave_open=leave_open)
    desc.progress = reporter.struct
    out = Mesh._from_c(c.cw_mesh())
    facts = c.cw_cut_facts()
    reporter.call(lib.cw_mesh_cut, byref(source), byref(desc), byref(out._struct), byref(facts))
    return Cut(
        mesh=out,
        cut_triangles=facts.cut_triangles,
        dropped_triangles=facts.dropped_triangles,
        cap_triangles=facts.cap_triangles,
        loops_closed=facts.loops_closed,
        loops_open=facts.loops_open,
        area=facts.area_mm2,
        moved=facts.moved_mm,
    )
