"""Text on solids: engraved, or raised."""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import byref
from dataclasses import dataclass

from . import _declarations as c
from ._library import lib
from ._mesh import Mesh, take_mesh
from ._options import take_flag, take_length, take_numbers, take_text, take_threads
from ._progress import Progress, Reporter


@dataclass(frozen=True)
class Engraved:
    """A mesh with a text, and the place of that. Lengths are in mm."""

    mesh: Mesh
    center: tuple[float, ...]  # of the text, on the surface
    normal: tuple[float, ...]  # toward the reader
    right: tuple[float, ...]  # direction of reading
    size: float  # height of capitals
    stroke: float  # width of strokes
    depth: float  # or height
    width: float  # of the whole text
    height: float  # of the whole text
    deviation: float  # largest distance of the surface from a plane, in the box of the text
    lean: float  # degrees: the largest angle between the surface and that plane
    thickness: float  # the thinnest wall behind the text, with the depth; infinite: none was met
    volume: float  # mm3 that were removed or added


def describe_text(
    text: str,
    *,
    size: float | str = 0,
    depth: float | str = 0,
    stroke: float | str = 0,
    wall: float | str = 0,
    emboss: bool = False,
    at: Sequence[float] | None = None,
    direction: Sequence[float] | None = None,
) -> c.cw_engrave_desc:
    return c.cw_engrave_desc(
        text=take_text("text", text),
        size_mm=take_length("size", size),
        depth_mm=take_length("depth", depth),
        stroke_mm=take_length("stroke", stroke),
        wall_mm=take_length("wall", wall),
        emboss=take_flag("emboss", emboss),
        has_at=at is not None,
        at=tuple(take_numbers("at", at, 3)) if at is not None else (0.0, 0.0, 0.0),
        direction=tuple(take_numbers("direction", direction, 3)) if direction is not None else (0.0, 0.0, 0.0),
    )


def engrave(
    mesh: Mesh,
    text: str,
    *,
    size: float | str = 0,
    depth: float | str = 0,
    stroke: float | str = 0,
    wall: float | str = 0,
    emboss: bool = False,
    at: Sequence[float] | None = None,
    direction: Sequence[float] | None = None,
    threads: int = 0,
    progress: Progress = None,
) -> Engraved:
    """Engraves a text into a closed mesh, or raises it. The floor of the letters follows the surface.

    text       one line of letters, digits and signs of ASCII, and some others such as the degree
    size       height of capitals; 0: as large as fits, up to a tenth of the diagonal
    depth      or height; 0: an eighth of the size
    stroke     width of strokes; 0: a seventh of the size
    wall       minimum of material behind the text; 0: 0.8 mm, or twice the depth if that is less
    emboss     raise the text
    at         the middle of the text is on the surface next to this point; None: on the flattest place that
               is large enough
    direction  out of the solid, toward the reader; without `at`, places within 30 degrees of it

    Raises Error: ARGUMENT (characters that the font has not), CHECK (nothing fits: the message has the size
    that does; or the mesh is open), EMPTY, LIMIT, NO_MEMORY, CANCELLED.
    """
    source = take_mesh("mesh", mesh)
    reporter = Reporter(progress)
    desc = describe_text(
        text, size=size, depth=depth, stroke=stroke, wall=wall, emboss=emboss, at=at, direction=direction
    )
    desc.threads = take_threads(threads)
    desc.progress = reporter.struct
    out = Mesh._from_c(c.cw_mesh())
    facts = c.cw_engrave_facts()
    reporter.call(lib.cw_mesh_engrave, byref(source), byref(desc), byref(out._struct), byref(facts))
    return Engraved(
        mesh=out,
        center=tuple(facts.center),
        normal=tuple(facts.normal),
        right=tuple(facts.right),
        size=facts.size_mm,
        stroke=facts.stroke_mm,
        depth=facts.depth_mm,
        width=facts.width_mm,
        height=facts.height_mm,
        deviation=facts.deviation_mm,
        lean=facts.lean_deg,
        thickness=facts.thickness_mm,
        volume=facts.volume_mm3,
    )
