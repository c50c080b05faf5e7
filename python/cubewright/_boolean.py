"""Booleans of solids: union, difference, intersection, exact until the result is rounded."""

from __future__ import annotations

from ctypes import POINTER, byref, c_uint8, pointer
from dataclasses import dataclass
from typing import Sequence

from . import _declarations as c
from ._library import lib
from ._mesh import Mesh, take_mesh
from ._options import take_choice, take_threads
from ._progress import Progress, Reporter

_OPERATIONS = ("union", "difference", "intersection", "xor", "split")


@dataclass(frozen=True)
class Combined:
    """The results of a boolean, and facts on it. Lengths are in mm."""

    meshes: tuple[Mesh, ...]  # one; of a split two: outside of the other meshes, and inside
    volumes: tuple[float, ...]  # mm3, of each before rounding
    split_triangles: int  # triangles of the inputs that others cross or overlap
    new_points: int
    contact_edges: int  # in which the result touches itself
    contact_vertices: int  # that were doubled, so that it is a manifold there
    turned: tuple[int, ...]  # meshes that were inside out, by number from 0
    empty: tuple[int, ...]  # meshes without a triangle that has an area
    inside_out: tuple[int, ...]  # meshes with shells that are inside out, and count as outside
    inside_out_volume: float  # mm3 of such shells
    rounds: int  # how often the result was rounded
    moved: float  # the largest movement of a point by rounding

    @property
    def mesh(self) -> Mesh:
        """The only result, or the first one of a split."""
        return self.meshes[0]


def boolean(
    meshes: Sequence[Mesh],
    op: str = "union",
    *,
    threads: int = 0,
    progress: Progress = None,
) -> Combined:
    """Unites, subtracts or intersects closed meshes.

    meshes  one or more; of one, union unites the shells that overlap
    op      "union", what is inside of any; "difference", of the first and no other; "intersection", of
            all; "xor", of an odd number; "split", both parts of the first one

    Inside means that a mesh winds around a point, so shells may touch, overlap, cross and be nested.
    Results are closed manifolds that do not cross themselves; nothing left is a mesh without triangles.
    Attributes go through; attributes["input"] of triangles is the number of the mesh of each.
    Raises Error: ARGUMENT, CHECK (a mesh is open), LIMIT, NO_MEMORY, CANCELLED.
    """
    sources = [take_mesh(f"meshes[{n}]", mesh) for n, mesh in enumerate(meshes)]
    number = take_choice("op", op, _OPERATIONS)
    pointers = (POINTER(c.cw_mesh) * max(len(sources), 1))(*(pointer(s) for s in sources))
    results = (c.cw_mesh * 2)()
    out = tuple(Mesh._from_c(results[n]) for n in range(2 if op == "split" else 1))
    facts = c.cw_boolean_facts()
    reporter = Reporter(progress)
    flags = (c_uint8 * max(len(sources), 1))()
    desc = c.cw_boolean_desc(
        op=number, threads=take_threads(threads), progress=reporter.struct, inputs=flags
    )
    reporter.call(lib.cw_mesh_boolean, pointers, len(sources), byref(desc), results, byref(facts))

    def having(flag: int) -> tuple[int, ...]:
        return tuple(n for n in range(len(sources)) if flags[n] & flag)

    return Combined(
        meshes=out,
        volumes=tuple(facts.volume_mm3[n] for n in range(len(out))),
        split_triangles=facts.split_triangles,
        new_points=facts.new_points,
        contact_edges=facts.contact_edges,
        contact_vertices=facts.contact_vertices,
        turned=having(c.cw_boolean_input.CW_BOOLEAN_TURNED),
        empty=having(c.cw_boolean_input.CW_BOOLEAN_EMPTY),
        inside_out=having(c.cw_boolean_input.CW_BOOLEAN_NEGATIVE),
        inside_out_volume=facts.negative_mm3,
        rounds=facts.rounds,
        moved=facts.moved_mm,
    )
