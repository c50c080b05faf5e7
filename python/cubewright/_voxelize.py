"""Voxels of closed meshes: label maps and partial volumes."""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import POINTER, byref, c_uint32, pointer
from dataclasses import dataclass
from typing import Any

from . import _declarations as c
from ._errors import call
from ._library import lib
from ._memory import Owner
from ._mesh import Mesh, take_mesh
from ._options import take_count, take_flag, take_numbers, take_threads
from ._progress import Progress, Reporter
from ._volume import Volume, take_spacing, take_volume


@dataclass(frozen=True)
class VoxelizedPart:
    """Facts on one of the meshes that were voxelized. Volumes are in mm3, areas in mm2."""

    label: int
    volume: float  # that the whole mesh encloses
    filled: float  # volume of its voxels in the grid, or of what partial volumes cover
    voxels: int  # with its label, before later meshes replace some; partial: 0
    overlapped: int  # of them, voxels of an earlier mesh
    repeated: int  # around which the mesh winds more than once
    negative: int  # around which it winds a negative number of times: they are outside
    solids: int  # sets of triangles joined by vertices
    lost: int  # solids that no voxel shows
    thin_places: int  # connected parts of the surface that are too thin for the voxels
    thin_area: float
    area: float  # of the whole mesh
    outside_area: float  # of the surface outside of the grid
    turned: bool  # it was inside out


@dataclass(frozen=True)
class Voxelized:
    """A volume made of meshes, and facts on each."""

    volume: Volume
    parts: tuple[VoxelizedPart, ...]


def voxelize(
    meshes: Mesh | Sequence[Mesh],
    *,
    like: Any = None,
    spacing: Any = None,
    box: Any = None,
    labels: Sequence[int] | None = None,
    partial: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Voxelized:
    """Makes voxels of closed meshes: labels, or with partial the fractions that are inside.

    like     a volume (or array) whose grid and frame are used; or:
    spacing  of a new grid along the world's axes, mm: a number, or x, y and z
    box      (low, high) world points that the new grid covers; default: the meshes and a voxel more
    labels   of each mesh, not 0; default: 1, 2, 3 ...
    partial  one volume of floats from 0 to 1, of all meshes together

    A voxel has the label of the last mesh that winds around its centre. Centres are tested exactly;
    fractions are exact. A surface at 0.5 of one label is within half the diagonal of a voxel from the mesh.
    Raises Error: ARGUMENT, CHECK (a mesh is open), EMPTY (outside of the grid), UNSUPPORTED (an uneven grid),
    LIMIT, NO_MEMORY, CANCELLED.
    """
    given = [meshes] if isinstance(meshes, Mesh) else list(meshes)
    sources = [take_mesh(f"meshes[{n}]", mesh) for n, mesh in enumerate(given)]
    pointers = (POINTER(c.cw_mesh) * max(len(sources), 1))(*(pointer(s) for s in sources))
    numbers = list(range(1, len(sources) + 1)) if labels is None else list(labels)
    if len(numbers) != len(sources):
        raise ValueError(f"labels has {len(numbers)} numbers; there are {len(sources)} meshes")
    values = (c_uint32 * max(len(numbers), 1))(*(take_count("a label", n, 0, 2**32 - 1) for n in numbers))
    parts = (c.cw_voxelize_part * max(len(sources), 1))()
    reporter = Reporter(progress)
    desc = c.cw_voxelize_desc(
        labels=values,
        partial=take_flag("partial", partial),
        parts=parts,
        threads=take_threads(threads),
        progress=reporter.struct,
    )
    grid = None if like is None else take_volume(like)
    if grid is not None:
        desc.like = pointer(grid._struct)
    if spacing is not None:
        desc.spacing_mm[:] = take_spacing(spacing)
    if box is not None:
        low, high = box
        desc.low[:] = take_numbers("box[0]", low, 3)
        desc.high[:] = take_numbers("box[1]", high, 3)
    out = Owner(c.cw_volume(), lib.cw_volume_free)
    reporter.call(lib.cw_voxelize, pointers, len(sources), byref(desc), byref(out.struct))
    return Voxelized(
        volume=Volume._from_c(out),
        parts=tuple(describe_part(value, p) for value, p in zip(numbers, parts)),
    )


def describe_part(label: int, p: c.cw_voxelize_part) -> VoxelizedPart:
    return VoxelizedPart(
        label=label,
        volume=p.volume_mm3,
        filled=p.filled_mm3,
        voxels=p.voxels,
        overlapped=p.overlapped,
        repeated=p.repeated,
        negative=p.negative,
        solids=p.solids,
        lost=p.lost,
        thin_places=p.thin_places,
        thin_area=p.thin_mm2,
        area=p.area_mm2,
        outside_area=p.outside_mm2,
        turned=p.turned,
    )


@dataclass(frozen=True)
class Within:
    """Values of a volume inside of a mesh."""

    volume: float  # mm3 that are inside and have values
    mean: float  # weighted by the fraction of each voxel that is inside
    sd: float
    min: float  # of voxels at least half inside; if there are none, of all that are partly
    max: float
    voxels: int  # partly inside
    half_inside: int  # of them, at least half inside
    mesh: VoxelizedPart  # facts on the mesh


def measure_within(volume: Any, mesh: Mesh, *, component: int = 0, step: int = 0, threads: int = 0) -> Within:
    """Measures the values of a volume inside of a closed mesh, weighted by partial volumes.

    Raises Error: CHECK (the mesh is open), EMPTY (it is outside), UNSUPPORTED (an uneven grid), NO_MEMORY.
    """
    view = take_volume(volume)._select(component, step)
    source = take_mesh("mesh", mesh)
    out = c.cw_within()
    call(lib.cw_volume_within, byref(view), byref(source), take_threads(threads), byref(out))
    return Within(
        volume=out.volume_mm3,
        mean=out.mean,
        sd=out.sd,
        min=out.min,
        max=out.max,
        voxels=out.voxels,
        half_inside=out.halves,
        mesh=describe_part(1, out.mesh),
    )
