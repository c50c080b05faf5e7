"""Pieces for a printer: a solid cut by planes, with pegs or dowels, laid on plates."""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import POINTER, byref, c_size_t
from dataclasses import dataclass

from . import _declarations as c
from ._cut import describe_cut
from ._errors import call
from ._library import lib
from ._mesh import Mesh, take_mesh
from ._options import take_count, take_flag, take_length, take_numbers, take_threads
from ._progress import Progress, Reporter


@dataclass(frozen=True)
class Piece:
    """A piece, or a dowel. Lengths are in mm."""

    name: str  # piece-1, piece-2 and so on; then dowel-1 ...
    mesh: Mesh  # attributes["section"] of triangles: the number of the plane from 1, or 0
    is_dowel: bool
    volume: float  # mm3
    pegs: int
    holes: int
    placed: tuple[float, ...]  # 3 x 4, row by row: from its place in the whole to where it is
    plate: int  # on which it is laid, from 1; 0: it is not


@dataclass(frozen=True)
class Pieces:
    """All pieces of a solid, and facts on the pieces together."""

    pieces: tuple[Piece, ...]
    volume: float  # mm3 of the whole
    gaps: float  # mm3 of clearance around pegs
    peg_diameter: float
    peg_length: float
    pegs: int
    shortened: int  # pegs that are shorter than requested
    missing: int  # pegs that had no room
    plates: int
    overlap: float  # mm3 in which pieces overlap when they are put together
    farthest: float  # mm from the surface of the whole to that of the pieces together


def _list_planes(planes: Sequence[tuple[Sequence[float], Sequence[float]]]) -> list[c.cw_cut_desc]:
    return [describe_cut(point, normal) for point, normal in planes]


def cut_pieces(
    mesh: Mesh,
    planes: Sequence[tuple[Sequence[float], Sequence[float]]] = (),
    *,
    plate: Sequence[float] | None = None,
    pegs: int = 0,
    dowels: bool = False,
    peg_diameter: float = 0,
    peg_length: float = 0,
    clearance: float = 0.2,
    wall: float = 0,
    lay: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Pieces:
    """Cuts a closed mesh by planes and keeps all pieces, closed, below the first plane first.

    planes        pairs of a point and a normal, in the world, mm
    plate         width, depth and height: cuts more, to equal parts that fit
    pegs          for each connected region of each section
    dowels        holes on both sides, and dowels as pieces of their own
    peg_diameter  0: 8 mm, or less where there is no room
    peg_length    beyond the section, of a dowel as a whole; 0: 1.5 diameters, of a dowel 3
    clearance     between a peg and its hole
    wall          minimum of material around holes; 0: a quarter of the diameter
    lay           lay each piece flat on z = 0, beside the others on plates

    Raises Error: ARGUMENT (a plane misses the mesh), CHECK (the mesh is open, no peg has room, or a
    piece is larger than the plate), EMPTY, LIMIT, NO_MEMORY, CANCELLED.
    """
    source = take_mesh("mesh", mesh)
    reporter = Reporter(progress)
    desc = c.cw_pieces_desc(
        pegs=take_count("pegs", pegs),
        dowels=take_flag("dowels", dowels),
        peg_diameter_mm=take_length("peg_diameter", peg_diameter),
        peg_length_mm=take_length("peg_length", peg_length),
        clearance_mm=take_length("clearance", clearance),
        wall_mm=take_length("wall", wall),
        threads=take_threads(threads),
        progress=reporter.struct,
    )
    sides = tuple(take_numbers("plate", plate, 3)) if plate is not None else (0.0, 0.0, 0.0)
    listed = _list_planes(planes)
    if plate is not None:
        reserve = 0.0
        if pegs and not dowels:
            reserve = desc.peg_length_mm or 1.5 * desc.peg_diameter_mm or min(12.0, min(sides) / 10)
            desc.max_automatic_mm = reserve / 1.5
        plan = c.cw_plate_desc(plate_mm=sides, reserve_mm=reserve)
        more, count = POINTER(c.cw_cut_desc)(), c_size_t()
        call(lib.cw_plate_planes, byref(source), byref(plan), byref(more), byref(count))
        listed += [describe_cut(tuple(more[n].point), tuple(more[n].normal)) for n in range(count.value)]
        lib.cw_planes_free(more)
    array = (c.cw_cut_desc * max(len(listed), 1))(*listed)
    out = c.cw_pieces()
    try:
        reporter.call(lib.cw_pieces_cut, byref(source), array, len(listed), byref(desc), byref(out))
        together = c.cw_assembled()
        call(lib.cw_pieces_assemble, byref(out), byref(source), desc.threads, None, byref(together))
        plates = c_size_t()
        if take_flag("lay", lay):
            place = c.cw_lay_desc(plate_mm=sides)
            call(lib.cw_pieces_lay, byref(out), byref(place), byref(plates))
        return Pieces(
            pieces=tuple(_take_piece(out.pieces[n], mesh) for n in range(out.count)),
            volume=out.whole_mm3,
            gaps=out.gaps_mm3,
            peg_diameter=out.settings.peg_diameter_mm,
            peg_length=out.settings.peg_length_mm,
            pegs=out.peg_count,
            shortened=out.shortened,
            missing=out.missing,
            plates=plates.value,
            overlap=together.overlap_mm3,
            farthest=together.farthest_mm,
        )
    finally:
        lib.cw_pieces_free(byref(out))


def _take_piece(piece: c.cw_piece, owner: Mesh) -> Piece:
    return Piece(
        name=piece.name.decode(),
        mesh=Mesh._from_c(piece.mesh, owner=owner).copy(),
        is_dowel=piece.is_dowel,
        volume=piece.volume_mm3,
        pegs=piece.pegs,
        holes=piece.holes,
        placed=tuple(piece.placed),
        plate=piece.plate,
    )
