"""Repair of broken meshes."""

from __future__ import annotations

from ctypes import byref
from dataclasses import dataclass

from . import _declarations as c
from ._errors import Error
from ._library import lib
from ._mesh import Mesh, take_mesh
from ._options import take_flag, take_length, take_threads
from ._progress import Progress, Reporter


@dataclass(frozen=True)
class Repaired:
    """A repaired mesh, and counts of what was wrong with it. Lengths are in mm."""

    mesh: Mesh | None  # None with report_only
    sound: bool  # the mesh is closed, oriented, manifold, and free of intersections
    needed: bool  # the input was not
    wrapped: bool  # the mesh is a wrap
    welded: int  # vertices that became one with another
    split_edges: int  # open edges that were split at vertices of others
    weld: float  # the distance within which vertices became one; 0: at equal positions alone
    duplicates: int  # triangles with the vertices of another one
    degenerate: int  # triangles without area
    flipped_triangles: int  # that disagreed with their neighbours
    flipped_shells: int  # that faced the wrong way
    nonmanifold_edges: int
    twisted_edges: int  # at which a one-sided surface was cut open
    one_sided: int  # components like a Moebius strip, dropped
    nonmanifold_vertices: int
    parted: float  # the farthest that a vertex moved from another at its place
    sheets: int  # open components without volume, dropped
    sheet_triangles: int
    holes_filled: int
    holes_left: int  # larger than fill
    largest_hole: float  # across
    largest_rim: float  # around
    largest_fill: float  # mm2
    added_triangles: int
    intersections_before: int
    intersections_after: int
    touching_vertices: int  # moved apart where surfaces only touched
    united_shells: int  # that intersected or touched others, or intersected themselves
    removed_triangles: int  # replaced around intersections
    inner_shells: int  # inside of others, dropped with outer
    inner: float  # mm3 that the solid gains by that
    union_lacking: bool  # shells were not united, as rounding found no union
    undecided: bool  # too many triangles are in one place to look for all that meet
    moved: float  # the largest movement of a vertex of the input
    volume_before: float  # mm3, about 1 % exact; 0: nothing was to repair, or nothing tells it
    volume_after: float  # mm3
    refused: bool  # with report_only: the result would move, or have another volume


def repair(
    mesh: Mesh,
    *,
    weld: float | str = 0.0,
    fill: float | str = 0.0,
    flat: bool = False,
    keep_intersections: bool = False,
    keep_cracks: bool = False,
    outer: bool = False,
    wrap: float | str = 0.0,
    max_move: float | str = 0.0,
    report_only: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Repaired:
    """Returns a closed manifold without intersections, as far as the mesh can be made one.

    Lengths (weld, fill, wrap, max_move) are in mm, or texts with a unit: "0.1mm", "1%" of the diagonal.

    weld         vertices this near to each other become one; 0: those at equal positions, and open
                 edges that lie along each other within a distance that is found
    fill         across, the largest hole to fill; 0: all
    flat         fill all holes by the least area; else smoothly, but where a large rim is cut off
    keep_intersections  leave triangles that intersect each other
    keep_cracks  leave open edges that lie along each other as they are
    outer        keep the outer boundary of the solid alone: inner walls, closed cavities and parts inside
                 of others go
    wrap         wrap the mesh after its repair; closes gaps narrower than this; needs CGAL,
                 which is under the GPL; 0: never
    max_move     a result that lies farther from the mesh, patches of holes left out, is refused,
                 and so is one that changes the volume by twice that share of the box's diagonal;
                 0: 1 % of the diagonal
    report_only  return no mesh; the counts say what would be done

    New vertices take scalars and colors from the closest point of the mesh, and labels from the
    nearest corner there. Normals are computed again if there are any.
    Raises Error: ARGUMENT, EMPTY (the mesh encloses no volume), CHECK (the repair is refused),
    UNSUPPORTED (wrap without CGAL), LIMIT, NO_MEMORY, CANCELLED, BACKEND.
    """
    source = take_mesh("mesh", mesh)
    out = None if take_flag("report_only", report_only) else Mesh._from_c(c.cw_mesh())
    facts = c.cw_repair_facts()
    reporter = Reporter(progress)
    desc = c.cw_repair_desc(
        weld_mm=take_length("weld", weld, mesh),
        max_hole_mm=take_length("fill", fill, mesh),
        wrap_mm=take_length("wrap", wrap, mesh),
        max_move_mm=take_length("max_move", max_move, mesh),
        flat_holes=take_flag("flat", flat),
        keep_crossings=take_flag("keep_intersections", keep_intersections),
        keep_cracks=take_flag("keep_cracks", keep_cracks),
        outer_only=take_flag("outer", outer),
        threads=take_threads(threads),
        progress=reporter.struct,
    )
    made = None if out is None else byref(out._struct)
    try:
        reporter.call(lib.cw_mesh_repair, byref(source), byref(desc), made, byref(facts))
    except Error:
        if not (report_only and facts.is_refused):
            raise
    return Repaired(
        mesh=out,
        sound=facts.is_sound,
        needed=facts.is_needed,
        wrapped=facts.is_wrapped,
        welded=facts.welded,
        split_edges=facts.split_edges,
        weld=facts.weld_mm,
        duplicates=facts.duplicates,
        degenerate=facts.degenerate,
        flipped_triangles=facts.flipped_triangles,
        flipped_shells=facts.flipped_shells,
        nonmanifold_edges=facts.nonmanifold_edges,
        twisted_edges=facts.twisted_edges,
        one_sided=facts.one_sided,
        nonmanifold_vertices=facts.nonmanifold_vertices,
        parted=facts.parted_mm,
        sheets=facts.sheets,
        sheet_triangles=facts.sheet_triangles,
        holes_filled=facts.holes_filled,
        holes_left=facts.holes_left,
        largest_hole=facts.largest_hole_mm,
        largest_rim=facts.largest_rim_mm,
        largest_fill=facts.largest_fill_mm2,
        added_triangles=facts.added_triangles,
        intersections_before=facts.crossings_before,
        intersections_after=facts.crossings_after,
        touching_vertices=facts.touching_vertices,
        united_shells=facts.united_shells,
        removed_triangles=facts.removed_triangles,
        inner_shells=facts.inner_shells,
        inner=facts.inner_mm3,
        union_lacking=facts.is_union_lacking,
        undecided=facts.is_undecided,
        moved=facts.moved_mm,
        volume_before=facts.volume_before_mm3,
        volume_after=facts.volume_after_mm3,
        refused=facts.is_refused,
    )
