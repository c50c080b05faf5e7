"""Texture coordinates: a surface laid flat in a square; and normal maps."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from ctypes import byref, c_uint8, pointer
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _declarations as c
from ._errors import call
from ._library import lib
from ._memory import Owner, unpack
from ._mesh import Mesh, take_mesh
from ._options import take_choice, take_count, take_length, take_number, take_threads
from ._progress import Progress, Reporter
from ._read import PICTURES, Part
from ._render import copy_image

MAPS = tuple(lib.cw_map_name(n).decode() for n in range(c.cw_map.CW_MAP_COUNT))


@dataclass(frozen=True)
class Atlas:
    """A mesh with texture coordinates, and facts on them.

    mesh.attributes["texture_coordinates"] is (3 m, 2) float32, a row for each corner of a triangle: (0, 0) is
    the upper left corner of the texture's image, (1, 1) the lower right one.
    """

    mesh: Mesh
    size: int  # texels along each side of the texture
    charts: int
    seams: int  # edges between two triangles that lie apart in the texture
    vertices: int  # of files that hold one texture coordinate for each vertex
    texels_per_mm: float
    stretch: float  # L2 of the whole surface: 1 is none
    coverage: float  # share of the texture that triangles cover
    flipped: int  # triangles turned over by the rounding to single precision


def describe_atlas(
    size: int = 2048, margin: int = 2, texels_per_mm: float = 0.0, max_stretch: float = 0.0
) -> c.cw_atlas_desc:
    return c.cw_atlas_desc(
        size=take_count("size", size, 64, 16384),
        margin=take_count("margin", margin, 1, 64),
        texels_per_mm=take_number("texels_per_mm", texels_per_mm),
        max_stretch=take_number("max_stretch", max_stretch),
    )


def take_maps(maps: Iterable[str]) -> int:
    """Returns names of maps as the bits of cw_bake_desc.maps."""
    names = (maps,) if isinstance(maps, str) else tuple(maps)
    return sum({1 << take_choice("maps", name, MAPS) for name in names})


def atlas(
    mesh: Mesh,
    *,
    size: int = 2048,
    margin: int = 2,
    texels_per_mm: float = 0.0,
    max_stretch: float = 0.0,
    threads: int = 0,
    progress: Progress = None,
) -> Atlas:
    """Returns a copy of a mesh with texture coordinates. Its surface is cut into charts, which are laid
    flat and packed into a square [Garland2001, Smith2015, Levy2002].

    size           texels along each side of the texture, 64 to 16384
    margin         texels that stay free around each chart, 1 to 64
    texels_per_mm  0: as many as fit
    max_stretch    more than 1: a chart that is stretched more is cut in two; 0: 1.25

    No triangle is turned over, and none lies on another. Write the mesh as GLB or OBJ.
    Raises Error: ARGUMENT (also for charts that do not fit), NO_MEMORY, CANCELLED.
    """
    take_mesh("mesh", mesh)
    reporter = Reporter(progress)
    desc = describe_atlas(size, margin, texels_per_mm, max_stretch)
    desc.threads, desc.progress = take_threads(threads), reporter.struct
    out, facts = mesh.copy(), c.cw_atlas_facts()
    reporter.call(lib.cw_mesh_atlas, byref(out._struct), byref(desc), byref(facts))
    return Atlas(
        mesh=out,
        size=facts.size,
        charts=facts.charts,
        seams=facts.seams,
        vertices=facts.vertices,
        texels_per_mm=facts.texels_per_mm,
        stretch=facts.stretch,
        coverage=facts.coverage,
        flipped=facts.flipped,
    )


@dataclass(frozen=True)
class TextureDistance:
    """How far a texture moved on a surface, in mm."""

    max_distance: float
    mean_distance: float  # over the area of the mesh
    side: float  # what the texture's side measures on the full mesh: n texels have n / side for a mm
    samples: int


def texture_distance(mesh: Mesh, full: Mesh, *, threads: int = 0) -> TextureDistance:
    """Measures how far the texture of a mesh moved from where it was on another one, such as before simplify():
    as distances of points in space and texture [Garland1998].

    Raises Error: ARGUMENT without texture coordinates, EMPTY if those of the full mesh cover no area, NO_MEMORY.
    """
    low, fine = take_mesh("mesh", mesh), take_mesh("full", full)
    facts = c.cw_texture_distance()
    call(lib.cw_mesh_texture_distance, byref(low), byref(fine), take_threads(threads), byref(facts))
    return TextureDistance(
        max_distance=facts.max_mm,
        mean_distance=facts.mean_mm,
        side=facts.side_mm,
        samples=facts.samples,
    )


@dataclass(frozen=True)
class Baked:
    """A normal map, and facts on it. image is (size, size, 4) uint8, top row first; alpha is 255."""

    image: npt.NDArray[np.uint8]
    texels: int  # whose middle lies in a triangle
    missed: int  # of them: those without a surface in reach that faces the same way; they are flat
    max_distance: float  # mm, that was bridged
    mean_distance: float
    mean_angle: float  # degrees between the normals of both surfaces


def bake_pictures(
    mesh: Mesh,
    parts: Sequence[Part],
    *,
    size: int = 2048,
    margin: int = 2,
    reach: float | str = 0.0,
    threads: int = 0,
    progress: Progress = None,
) -> dict[str, npt.NDArray[np.uint8]]:
    """Carries the pictures of textured parts, as read_parts() gives them, over to a mesh from atlas() that has
    normals. Returns (size, size, 4) uint8 for each use that some part has a picture of.

    Options are those of bake_normals(). Pictures are PNG or JPEG; colours are sRGB. Texels that miss are white.
    Raises Error: ARGUMENT, UNSUPPORTED for other pictures, FORMAT, NO_MEMORY, CANCELLED.
    """
    low, decoded = take_mesh("mesh", mesh), []
    reporter = Reporter(progress)
    desc = c.cw_bake_desc(
        size=take_count("size", size, 16, 16384),
        margin=take_count("margin", margin, 1, 64),
        reach_mm=take_length("reach", reach, mesh),
        threads=take_threads(threads),
        progress=reporter.struct,
    )
    sources = (c.cw_bake_source * max(len(parts), 1))()
    for source, part in zip(sources, parts):
        source.mesh = pointer(take_mesh("the mesh of a part", part.mesh))
        for use, data in (part.pictures or {}).items():
            image = Owner(c.cw_image(), lib.cw_image_free)
            bytes_ = (c_uint8 * len(data)).from_buffer_copy(data)
            call(lib.cw_image_decode, bytes_, len(data), byref(image.struct))
            source.pictures[PICTURES.index(use)] = pointer(image.struct)
            decoded.append(image)
    out = (c.cw_image * len(PICTURES))()
    reporter.call(lib.cw_bake_pictures, byref(low), sources, len(parts), byref(desc), out, None)
    baked = {use: copy_image(picture) for use, picture in zip(PICTURES, out) if picture.pixels}
    for picture in out:
        lib.cw_image_free(byref(picture))
    return baked


def bake_normals(
    mesh: Mesh,
    full: Mesh,
    *,
    size: int = 2048,
    margin: int = 2,
    reach: float | str = 0.0,
    threads: int = 0,
    progress: Progress = None,
) -> Baked:
    """Returns a normal map for a mesh from atlas() that has normals: with it the mesh looks as the full
    one does. Texels take the normal of the nearest point that faces the same way. Write it with
    write(path, [Part(name, mesh, normal_map=baked.image)]).

    size    texels along each side, 16 to 16384
    margin  texels around each chart that get the colour beside them, 1 to 64
    reach   a length: how far the full surface may be; 0: 4 % of the box's diagonal

    The map is in the tangent space of MikkTSpace, green upward, as glTF has it.
    Raises Error: ARGUMENT, NO_MEMORY, CANCELLED.
    """
    images, facts = bake_maps(
        mesh, full, "normals", size=size, margin=margin, reach=reach, threads=threads, progress=progress
    )
    return Baked(
        image=images["normals"],
        texels=facts["texels"],
        missed=facts["missed"],
        max_distance=facts["max_mm"],
        mean_distance=facts["mean_mm"],
        mean_angle=facts["mean_deg"],
    )


def bake_maps(
    mesh: Mesh,
    full: Mesh,
    maps: str | Iterable[str],
    *,
    size: int = 2048,
    margin: int = 2,
    reach: float | str = 0.0,
    occlusion: float | str = 0.0,
    thickness: float | str = 0.0,
    curvature: float = 0.0,
    threads: int = 0,
    progress: Progress = None,
) -> tuple[dict[str, npt.NDArray[Any]], dict[str, Any]]:
    """Returns maps of a full surface for a mesh from atlas() that has normals, by name, and facts on them.

    maps       names, of "normals", "occlusion", "curvature", "thickness", "colors". Each map is
               (size, size, 4) uint8, top row first; of occlusion and thickness size is a fourth
    occlusion  a length: what is farther away darkens nothing; 0: 10 % of the box's diagonal
    thickness  a length: that is white; 0: the same
    curvature  1 / mm: a mean curvature that is white, and black inward; 0: 95 % of the vertices have less
    others     as of bake_normals()

    Occlusion is the share of the sky that is open [Zhukov1998]; grey is no curvature [Meyer2003]; the
    thickness is a mean over 30 degrees [Shapira2008]; colours are those of the full mesh's vertices.
    Raises Error: ARGUMENT, NO_MEMORY, CANCELLED.
    """
    low, fine = take_mesh("mesh", mesh), take_mesh("full", full)
    reporter = Reporter(progress)
    desc = c.cw_bake_desc(
        size=take_count("size", size, 16, 16384),
        margin=take_count("margin", margin, 1, 64),
        reach_mm=take_length("reach", reach, mesh),
        maps=take_maps(maps),
        occlusion_mm=take_length("occlusion", occlusion, mesh),
        thickness_mm=take_length("thickness", thickness, mesh),
        curvature_max=take_number("curvature", curvature),
        threads=take_threads(threads),
        progress=reporter.struct,
    )
    images, facts = (c.cw_image * len(MAPS))(), c.cw_bake_facts()
    reporter.call(lib.cw_bake_maps, byref(low), byref(fine), byref(desc), images, byref(facts))
    baked: dict[str, npt.NDArray[Any]] = {}
    for name, image in zip(MAPS, images):
        if image.pixels:
            baked[name] = copy_image(image)
        lib.cw_image_free(byref(image))
    return baked, unpack(facts)
