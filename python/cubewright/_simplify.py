"""Simplification, smoothing, offsets and hollowing of meshes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from ctypes import byref, c_size_t, pointer
from dataclasses import dataclass
from typing import Any

from . import _declarations as c
from ._errors import call
from ._library import lib
from ._mesh import ARRAYS, Levels, Mesh, take_mesh
from ._options import (
    name_type,
    take_choice,
    take_count,
    take_flag,
    take_length,
    take_number,
    take_numbers,
    take_shift,
    take_threads,
)
from ._progress import Progress, Reporter
from ._volume import Volume, take_volume

SMOOTH_METHODS = ("taubin", "hc", "fair")
INFILLS = ("gyroid", "schwarz-p", "diamond")


def _describe(
    normal_weight: float,
    color_weight: float,
    scalar_weight: float,
    allow_intersections: bool,
    keep_border: bool,
    threads: int,
    reporter: Reporter,
) -> c.cw_simplify_desc:
    return c.cw_simplify_desc(
        normal_weight=take_number("normal_weight", normal_weight),
        color_weight=take_number("color_weight", color_weight),
        scalar_weight=take_number("scalar_weight", scalar_weight),
        allow_crossings=take_flag("allow_intersections", allow_intersections),
        keep_border=take_flag("keep_border", keep_border),
        threads=take_threads(threads),
        progress=reporter.struct,
    )


def take_counts(triangles: Sequence[int]) -> list[int]:
    """Returns the triangle counts of levels of detail."""
    if isinstance(triangles, (str, bytes)) or not isinstance(triangles, Iterable):
        raise TypeError(f"triangles must be whole numbers, not {name_type(triangles)}")
    counts = [take_count("triangles", each, 1) for each in triangles]
    if not counts:
        raise ValueError("triangles is empty; a number for each level was expected")
    return counts


def simplify(
    mesh: Mesh,
    *,
    error: float | str = 0.0,
    triangles: int = 0,
    ratio: float = 0.0,
    normal_weight: float = 0.0,
    color_weight: float = 0.0,
    scalar_weight: float = 0.0,
    allow_intersections: bool = False,
    keep_border: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Mesh:
    """Returns a mesh with fewer triangles, by edge collapses.

    error      no point of the mesh or of the result is farther from the other. Lengths are in mm, or texts
               with a unit: "0.1mm", "12um", "0.05%" of the diagonal of the mesh's box
    triangles  number to stop at
    ratio      the same as a fraction, above 0 and below 1. At least one of the three is needed;
               the first one reached ends the work
    normal_weight, color_weight, scalar_weight  of attributes to keep, in percent of the diagonal
    allow_intersections  of triangles that did not meet before; keep_border: to the bit

    Components, handles and border loops stay the same. Raises Error: ARGUMENT, UNSUPPORTED (this
    build has no OpenMesh), LIMIT, NO_MEMORY, CANCELLED.
    """
    source = take_mesh("mesh", mesh)
    reporter = Reporter(progress)
    desc = _describe(
        normal_weight,
        color_weight,
        scalar_weight,
        allow_intersections,
        keep_border,
        threads,
        reporter,
    )
    desc.error_mm = take_length("error", error, mesh)
    desc.triangles = take_count("triangles", triangles)
    desc.ratio = take_number("ratio", ratio)
    out = Mesh._from_c(c.cw_mesh())
    reporter.call(lib.cw_simplify, byref(source), byref(desc), byref(out._struct), None)
    return out


def simplify_levels(
    mesh: Mesh,
    triangles: Sequence[int],
    *,
    normal_weight: float = 0.0,
    color_weight: float = 0.0,
    scalar_weight: float = 0.0,
    allow_intersections: bool = False,
    keep_border: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Levels:
    """Returns levels of detail of a mesh, each made from the one before.

    triangles  number of each level, fewer than of the one before. Other arguments, and what stays
               the same, are as of simplify()

    Raises Error: ARGUMENT (the numbers do not fall), UNSUPPORTED, LIMIT, NO_MEMORY, CANCELLED.
    """
    source = take_mesh("mesh", mesh)
    reporter = Reporter(progress)
    counts = take_counts(triangles)
    desc = _describe(
        normal_weight,
        color_weight,
        scalar_weight,
        allow_intersections,
        keep_border,
        threads,
        reporter,
    )
    out = (c.cw_mesh * len(counts))()
    levels = Levels()
    levels.extend(Mesh._from_c(each) for each in out)
    numbers = (c_size_t * len(counts))(*counts)
    reporter.call(
        lib.cw_simplify_levels, byref(source), byref(desc), numbers, len(counts), out, None
    )
    return levels


@dataclass(frozen=True)
class Smoothed:
    """A smoothed mesh, and what smoothing did to it. Lengths are in mm."""

    mesh: Mesh
    limit: float  # how far a vertex was allowed to move
    max_move: float
    mean_move: float
    volume_before: float  # mm3, of closed components
    volume_after: float
    flipped: int  # triangles that turned by 90 degrees or more
    border: int  # vertices at open edges
    junction: int  # other vertices at edges of three or more triangles
    put_back: int  # vertices that stay because their triangles would meet others or lose their area
    undecided: bool  # too many triangles are in one place to look for all that meet


def describe_smoothing(
    mesh: Mesh | None = None,
    volume: Any = None,
    *,
    method: str = "taubin",
    iterations: int | None = None,
    width: float | str = 0.0,
    max_move: float | str = 0.0,
    keep_border: bool = True,
    allow_intersections: bool = False,
) -> c.cw_smooth_desc:
    kind = take_choice("method", method, SMOOTH_METHODS)
    if width and method != "fair":
        raise ValueError(f"width is for method='fair', not for {method!r}")
    return c.cw_smooth_desc(
        method=kind,
        iterations=0 if iterations is None else take_count("iterations", iterations, 1, 1000),
        width_mm=take_length("width", width, mesh, volume),
        max_move_mm=take_length("max_move", max_move, mesh, volume),
        move_border=not take_flag("keep_border", keep_border),
        allow_crossings=take_flag("allow_intersections", allow_intersections),
    )


def smooth(
    mesh: Mesh,
    *,
    method: str = "taubin",
    iterations: int | None = None,
    width: float | str = 0.0,
    max_move: float | str = 0.0,
    keep_border: bool = True,
    allow_intersections: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Smoothed:
    """Returns a smoother mesh: noise goes, and so does fine detail. Smoothing moves the surface.

    method      "taubin": keeps large shapes; "hc": a little more detail; "fair": waves fade by
                their length, and vertices hardly move along the surface
    iterations  1 to 1000; more remove longer waves; default: 10, of "fair" 3
    width       a length, of "fair": waves of this length keep half of their height; 0: 6 mean edges
    max_move    a length: no vertex is farther from its first place; 0: half the mean edge
    keep_border keep open edges, and those of three or more triangles, as they are; else they
                move along themselves
    allow_intersections  of triangles that did not meet before

    Closed components keep their volume, as far as max_move allows. Normals are computed again if
    there are any; scalars, colors and labels stay with their vertices. Vertices at equal positions
    count as different ones: weld() them first.
    Raises Error: ARGUMENT, LIMIT, NO_MEMORY, CANCELLED.
    """
    take_mesh("mesh", mesh)
    reporter = Reporter(progress)
    desc = describe_smoothing(
        mesh,
        method=method,
        iterations=iterations,
        width=width,
        max_move=max_move,
        keep_border=keep_border,
        allow_intersections=allow_intersections,
    )
    desc.threads = take_threads(threads)
    desc.progress = reporter.struct
    out, facts = mesh.copy(), c.cw_smooth_facts()
    reporter.call(lib.cw_mesh_smooth, byref(out._struct), byref(desc), byref(facts))
    return Smoothed(
        mesh=out,
        limit=facts.limit_mm,
        max_move=facts.max_mm,
        mean_move=facts.mean_mm,
        volume_before=facts.volume_before_mm3,
        volume_after=facts.volume_after_mm3,
        flipped=facts.flipped,
        border=facts.border,
        junction=facts.junction,
        put_back=facts.put_back,
        undecided=facts.undecided,
    )


def offset(
    mesh: Mesh,
    by: float | str,
    *,
    voxel: float | str = 0.0,
    sharp: bool = True,
    refine: bool = True,
    max_bytes: int = 0,
    threads: int = 0,
    progress: Progress = None,
) -> Mesh:
    """Returns the surface at a distance from a closed mesh.

    by     a length outward; negative: inward; 0: the surface rebuilt, closed and without crossings
    voxel  a length, of the level set; 0: chosen by the offset and the size
    sharp  restore edges that voxels cut off; refine: use smaller voxels where they are needed

    Raises Error: ARGUMENT (the mesh is not closed), EMPTY, UNSUPPORTED (this build has no OpenVDB),
    LIMIT, NO_MEMORY, CANCELLED.
    """
    source = take_mesh("mesh", mesh)
    reporter = Reporter(progress)
    desc = c.cw_offset_desc(
        offset_mm=take_shift("by", by, mesh),
        voxel_mm=take_length("voxel", voxel, mesh),
        no_sharpen=not take_flag("sharp", sharp),
        no_refine=not take_flag("refine", refine),
        threads=take_threads(threads),
        max_bytes=take_count("max_bytes", max_bytes),
        progress=reporter.struct,
    )
    out = Mesh._from_c(c.cw_mesh())
    reporter.call(lib.cw_mesh_offset, byref(source), byref(desc), byref(out._struct), None)
    return out


def _take_infill(infill: Any, by: Any, mesh: Mesh) -> tuple[c.cw_infill_desc | None, Volume | None]:
    """Returns the options of a lattice, and the volume that must outlive them."""
    if infill is None:
        if by is not None:
            raise ValueError("infill_by needs infill")
        return None, None
    if isinstance(infill, str) or not isinstance(infill, Sequence) or len(infill) not in (3, 4):
        raise TypeError("infill must be a kind, a cell, and one or two walls, such as ('gyroid', '8mm', '0.8mm')")
    kind, cell, *walls = infill
    lengths = [take_length("infill's wall", wall, mesh) for wall in walls]
    desc = c.cw_infill_desc(
        kind=take_choice("infill", kind, INFILLS),
        cell_mm=take_length("infill's cell", cell, mesh),
        wall_mm=lengths[0],
        end_wall_mm=lengths[1] if len(lengths) == 2 else 0,
    )
    if by is None:
        return desc, None
    if isinstance(by, (str, int, float)):
        desc.depth_mm = take_length("infill_by", by, mesh)
        return desc, None
    volume = take_volume(by)
    desc.by = pointer(volume._struct)
    return desc, volume


def hollow(
    mesh: Mesh,
    wall: float | str,
    *,
    drains: Sequence[tuple[float | str, Sequence[float]]] = (),
    voxel: float | str = 0.0,
    infill: Sequence[Any] | None = None,
    infill_by: Any = None,
    max_bytes: int = 0,
    threads: int = 0,
    progress: Progress = None,
) -> Mesh:
    """Returns a solid with a cavity inside a wall, to save print material.

    wall       a length; drains: pairs of a diameter and a direction (x, y, z) of holes to the outside
    infill     a lattice in the cavity: 'gyroid', 'schwarz-p' or 'diamond', the edge of a cell, and the thickness of
               its walls, such as ("gyroid", "8mm", "0.8mm"); a second thickness needs infill_by
    infill_by  the walls change to the second thickness by it: a depth below the cavity's surface, a length; or a
               volume, from its least to its greatest value
    Raises Error as offset(); EMPTY where no point is deep enough.
    """
    source = take_mesh("mesh", mesh)
    reporter = Reporter(progress)
    lattice, graded = _take_infill(infill, infill_by, mesh)
    holes = (c.cw_drain * max(len(drains), 1))()
    for hole, (diameter, direction) in zip(holes, drains):
        hole.diameter_mm = take_length("a drain's diameter", diameter, mesh)
        hole.direction[:] = take_numbers("a drain's direction", direction, 3)
    desc = c.cw_hollow_desc(
        wall_mm=take_length("wall", wall, mesh),
        drains=holes,
        drain_count=len(drains),
        voxel_mm=take_length("voxel", voxel, mesh),
        no_measure=True,
        threads=take_threads(threads),
        max_bytes=take_count("max_bytes", max_bytes),
        progress=reporter.struct,
        infill=pointer(lattice) if lattice else None,
    )
    out = Mesh._from_c(c.cw_mesh())
    reporter.call(lib.cw_mesh_hollow, byref(source), byref(desc), byref(out._struct), None)
    return out


def weld(mesh: Mesh) -> Mesh:
    """Returns a mesh whose vertices at equal positions are merged, as simplify() needs them."""
    take_mesh("mesh", mesh)
    copied = mesh.copy()
    call(lib.cw_mesh_weld, byref(copied._struct), None)
    vertices, triangles = copied._struct.vertex_count, copied._struct.triangle_count
    arrays = {
        name: array[: triangles if name == "triangles" else vertices]
        for name in ARRAYS
        if (array := copied._array(name)) is not None
    }
    return Mesh.from_arrays(**arrays, origin=copied.origin)
