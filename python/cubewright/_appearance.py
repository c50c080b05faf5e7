"""Appearance: how alike two surfaces look."""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import byref, pointer
from dataclasses import dataclass
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from . import _declarations as c
from ._errors import call
from ._library import lib
from ._memory import Owner
from ._mesh import Mesh, take_mesh
from ._options import take_count, take_threads
from ._progress import Progress, Reporter
from ._read import Part
from ._render import borrow_image, lend_image

Surface = Union[Mesh, Part, Sequence[Part]]

MAX_VIEWS = 64


@dataclass(frozen=True)
class LookDifference:
    """The difference of two pictures, over the pixels that at least one shows a surface in. With `_both`:
    over those that both do, inside both outlines."""

    pixels: int
    shown_by_one: int  # of them: those that only one picture shows a surface in
    rmse: float  # of red, green and blue, 0 to 255
    psnr: float  # dB; infinite: equal
    delta_e: float  # mean CIEDE2000
    rmse_both: float
    psnr_both: float
    delta_e_both: float


@dataclass(frozen=True)
class Appearance:
    """How alike two surfaces look. worst is the number of the view with the largest rmse."""

    with_maps: LookDifference  # over all views
    without_maps: LookDifference  # the same without the maps of the second surface
    views: tuple[LookDifference, ...]
    views_without_maps: tuple[LookDifference, ...]
    places: tuple[tuple[float, float], ...]  # of each view: azimuth (0: the front; 90: the left), elevation
    worst: int
    size: int  # pixels along each side of a view


def appearance(
    reference: Surface,
    surface: Surface,
    *,
    views: int = 8,
    size: int = 1024,
    threads: int = 0,
    progress: Progress = None,
) -> Appearance:
    """Measures how alike two surfaces look. Both are drawn from the same places spread evenly over a sphere,
    in the same light, as matt grey times their colours, and compared by PSNR and CIEDE2000 [Sharma2005].

    reference, surface  a Mesh, a Part or a list of Part, which may have normal maps; in the same frame
    views               1 to 64
    size                pixels along each side of a view, 16 to 4096

    A mesh without normals is flat. Raises Error: ARGUMENT, LIMIT, NO_MEMORY, CANCELLED.
    """
    first, _held = take_surface("reference", reference)
    second, _also_held = take_surface("surface", surface)
    reporter = Reporter(progress)
    desc = c.cw_appearance_desc(
        views=take_count("views", views, 1, MAX_VIEWS),
        size=take_count("size", size, 16, 4096),
        threads=take_threads(threads),
        progress=reporter.struct,
    )
    with_maps, without_maps = c.cw_appearance(), c.cw_appearance()
    reporter.call(
        lib.cw_appearance_measure,
        first,
        len(first),
        second,
        len(second),
        byref(desc),
        byref(with_maps),
        byref(without_maps),
    )
    return Appearance(
        with_maps=read_difference(with_maps.all),
        without_maps=read_difference(without_maps.all),
        views=tuple(read_difference(d) for d in with_maps.view[: with_maps.views]),
        views_without_maps=tuple(read_difference(d) for d in without_maps.view[: without_maps.views]),
        places=tuple((p.azimuth_deg, p.elevation_deg) for p in with_maps.place[: with_maps.views]),
        worst=with_maps.worst,
        size=with_maps.size,
    )


def appearance_view(
    reference: Surface,
    surface: Surface,
    view: int = 0,
    *,
    views: int = 8,
    size: int = 1024,
    threads: int = 0,
    progress: Progress = None,
) -> npt.NDArray[np.uint8]:
    """Draws a surface as appearance() looks at it: from one of the views of a reference.

    Returns (size, size, 4) uint8, top row first: black and opacity 0 where no surface is, colours multiplied
    with the opacity at outlines. Raises Error as appearance().
    """
    first, _held = take_surface("reference", reference)
    second, _also_held = take_surface("surface", surface)
    reporter = Reporter(progress)
    place = c.cw_appearance_view()
    number, count = take_count("view", view, 0, MAX_VIEWS), take_count("views", views, 1, MAX_VIEWS)
    call(lib.cw_appearance_find_view, first, len(first), count, number, byref(place))
    desc = c.cw_appearance_desc(
        size=take_count("size", size, 16, 4096), threads=take_threads(threads), progress=reporter.struct
    )
    image = Owner(c.cw_image(), lib.cw_image_free)
    reporter.call(
        lib.cw_appearance_draw, second, len(second), byref(place.camera), byref(desc), byref(image.struct)
    )
    return lend_image(image)


def take_surface(name: str, surface: Surface) -> tuple[Any, list[Any]]:
    """Returns an array of cw_surface_look, and the arrays of pixels that it points to."""
    parts = [surface] if isinstance(surface, (Mesh, Part)) else surface
    if not isinstance(parts, Sequence) or isinstance(parts, (str, bytes)):
        raise TypeError(f"{name} is a Mesh, a Part or a list of Part, not a {type(surface).__name__}")
    looks = (c.cw_surface_look * len(parts))()
    held: list[Any] = []
    for look, part in zip(looks, parts):
        mesh = part.mesh if isinstance(part, Part) else part
        look.mesh = pointer(take_mesh(f"the mesh of {name}", mesh))
        if isinstance(part, Part) and part.normal_map is not None:
            image, pixels = borrow_image(part.normal_map)
            held.append(pixels)
            look.normal_map = pointer(image)
    return looks, held


def read_difference(d: c.cw_look_difference) -> LookDifference:
    return LookDifference(
        pixels=d.pixels,
        shown_by_one=d.shown_by_one,
        rmse=d.rmse,
        psnr=d.psnr_db,
        delta_e=d.delta_e,
        rmse_both=d.rmse_both,
        psnr_both=d.psnr_both_db,
        delta_e_both=d.delta_e_both,
    )
