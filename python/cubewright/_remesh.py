"""Remeshing: triangles of a wanted size and shape, on the same surface."""

from __future__ import annotations

from ctypes import byref
from dataclasses import dataclass

from . import _declarations as c
from ._library import lib
from ._mesh import Mesh, take_mesh
from ._options import take_count, take_flag, take_length, take_number, take_threads
from ._progress import Progress, Reporter


@dataclass(frozen=True)
class Remeshed:
    """A remeshed surface, and facts on it. Lengths are in mm, angles in degrees."""

    mesh: Mesh
    error: float  # how far the surfaces may be apart; proven where beyond is 0
    min_edge: float
    mean_edge: float
    max_edge: float
    fitting_edges: float  # fraction of edges of 0.8 to 1.33 times the wanted length
    smallest_angle: float
    where: tuple[float, float, float]  # the corner with that angle, in the world
    below: int  # triangles with an angle below min_angle
    features: int  # edges that are kept
    border: int  # edges at borders
    intersections_before: int
    intersections_after: int
    beyond: int  # triangles that may be farther than error from the other mesh
    undecided: bool  # too many triangles are in one place to look for all that meet


def remesh(
    mesh: Mesh,
    edge: float | str,
    *,
    adaptive: bool = False,
    shortest: float | str = 0.0,
    error: float | str = 0.0,
    features: float = 0.0,
    min_angle: float = 0.0,
    iterations: int = 0,
    threads: int = 0,
    progress: Progress = None,
) -> Remeshed:
    """Returns a mesh of the same surface whose edges are about as long as wanted.

    edge        length of edges; with adaptive the longest one. Lengths are in mm, or texts with a unit:
                "1mm", "0.5%" of the diagonal of the mesh's box
    adaptive    shorter edges where the surface is curved
    shortest    of adaptive: the shortest wanted length; 0: edge / 10
    error       how far the surfaces may be apart, both ways; 0: edge / 10
    features    degrees: edges that turn by more are kept; 0: 40
    min_angle   degrees, up to 40: extra passes for triangles below it, such as 25 for finite
                elements; 0: none
    iterations  0: 5

    The mesh must be a manifold, open or closed: weld and repair make one. Scalars and colors are
    interpolated, labels are those of the nearest vertex.
    Raises Error: ARGUMENT, FORMAT (no manifold), EMPTY, LIMIT, NO_MEMORY, CANCELLED.
    """
    source = take_mesh("mesh", mesh)
    out = Mesh._from_c(c.cw_mesh())
    facts = c.cw_remesh_facts()
    reporter = Reporter(progress)
    desc = c.cw_remesh_desc(
        edge_mm=take_length("edge", edge, mesh),
        shortest_mm=take_length("shortest", shortest, mesh),
        error_mm=take_length("error", error, mesh),
        feature_deg=take_number("features", features),
        min_angle_deg=take_number("min_angle", min_angle),
        iterations=take_count("iterations", iterations),
        is_adaptive=take_flag("adaptive", adaptive),
        threads=take_threads(threads),
        progress=reporter.struct,
    )
    reporter.call(lib.cw_mesh_remesh, byref(source), byref(desc), byref(out._struct), byref(facts))
    return Remeshed(
        mesh=out,
        error=facts.error_mm,
        min_edge=facts.min_edge_mm,
        mean_edge=facts.mean_edge_mm,
        max_edge=facts.max_edge_mm,
        fitting_edges=facts.fitting_edges,
        smallest_angle=facts.smallest_deg,
        where=(facts.where[0], facts.where[1], facts.where[2]),
        below=facts.below,
        features=facts.features_after,
        border=facts.border_after,
        intersections_before=facts.crossings_before,
        intersections_after=facts.crossings_after,
        beyond=facts.beyond,
        undecided=facts.is_undecided,
    )
