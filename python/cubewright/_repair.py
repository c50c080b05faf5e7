"""Repair of broken meshes."""

from __future__ import annotations

from ctypes import byref
from dataclasses import dataclass

from . import _declarations as c
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
    duplicates: int  # triangles with the vertices of another one
    degenerate: int  # triangles without area
    flipped_triangles: int  # that disagreed with their neighbours
    flipped_shells: int  # that faced the wrong way
    nonmanifold_edges: int
    twisted_edges: int  # at which a one-sided surface was cut open
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
    united_shells: int  # became one with others that they intersected
    removed_triangles: int  # replaced around intersections
    lacks_cgal: bool  # shells were not united, as this build has no CGAL
    undecided: bool  # too many triangles are in one place to look for all that meet


def repair(
    mesh: Mesh,
    *,
    weld: float = 0.0,
    fill: float = 0.0,
    flat: bool = False,
    keep_intersections: bool = False,
    wrap: float = 0.0,
    report_only: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Repaired:
    """Returns a closed manifold without intersections, as far as the mesh can be made one.

    weld         mm: vertices this near to each other become one; 0: those at equal positions
    fill         mm across: the largest hole to fill; 0: all
    flat         fill holes by the least area; else smoothly
    keep_intersections  leave triangles that intersect each other
    wrap         mm: wrap the mesh if defects are left; closes gaps narrower than this; needs CGAL,
                 which is under the GPL; 0: never
    report_only  return no mesh; the counts say what would be done

    New vertices take scalars and colors from the closest point of the mesh, and labels from the
    nearest corner there. Normals are computed again if there are any.
    Raises Error: ARGUMENT, EMPTY (the mesh encloses no volume), UNSUPPORTED (wrap without CGAL),
    LIMIT, NO_MEMORY, CANCELLED, BACKEND.
    """
    source = take_mesh("mesh", mesh)
    out = None if take_flag("report_only", report_only) else Mesh._from_c(c.cw_mesh())
    facts = c.cw_repair_facts()
    reporter = Reporter(progress)
    desc = c.cw_repair_desc(
        weld_mm=take_length("weld", weld),
        max_hole_mm=take_length("fill", fill),
        wrap_mm=take_length("wrap", wrap),
        flat_holes=take_flag("flat", flat),
        keep_crossings=take_flag("keep_intersections", keep_intersections),
        threads=take_threads(threads),
        progress=reporter.struct,
    )
    made = None if out is None else byref(out._struct)
    reporter.call(lib.cw_mesh_repair, byref(source), byref(desc), made, byref(facts))
    return Repaired(
        mesh=out,
        sound=facts.is_sound,
        needed=facts.is_needed,
        wrapped=facts.is_wrapped,
        welded=facts.welded,
        duplicates=facts.duplicates,
        degenerate=facts.degenerate,
        flipped_triangles=facts.flipped_triangles,
        flipped_shells=facts.flipped_shells,
        nonmanifold_edges=facts.nonmanifold_edges,
        twisted_edges=facts.twisted_edges,
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
        lacks_cgal=facts.lacks_cgal,
        undecided=facts.is_undecided,
    )
