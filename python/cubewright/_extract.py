"""Surfaces of volumes: at an isovalue, and of labels."""

from __future__ import annotations

import threading
import weakref
from collections.abc import Callable, Iterable
from ctypes import POINTER, byref, c_uint32
from dataclasses import dataclass
from typing import Any, Union

import numpy.typing as npt

from . import _declarations as c
from ._errors import call
from ._library import lib
from ._memory import Owner
from ._mesh import Mesh
from ._options import take_choice, take_count, take_flag, take_length, take_number, take_threads
from ._progress import Progress, Reporter
from ._simplify import simplify as simplify_mesh
from ._volume import Volume, take_volume

INSIDE = ("above", "below")

AnyVolume = Union[Volume, "npt.NDArray[Any]"]


def take_inside(inside: str, volume: Volume) -> bool:
    """Returns whether low values are inside. 'auto' is above, in level sets below."""
    choice = take_choice("inside", inside, ("auto", *INSIDE))
    return volume.level_set if choice == 0 else choice == 2


def extract(
    volume: AnyVolume,
    iso: float,
    *,
    inside: str = "auto",
    open: bool = False,
    topology: str = "field",
    placement: str = "linear",
    snap: float = 0.0,
    normals: str = "field",
    min_volume: float = 0.0,
    largest: int = 0,
    fill_voids: bool = False,
    simplify: int | float | None = None,
    component: int = 0,
    step: int = 0,
    max_triangles: int = 0,
    max_bytes: int = 0,
    threads: int = 0,
    progress: Progress = None,
) -> Mesh:
    """Extracts the surface where the trilinear field of a volume equals an isovalue.

    The mesh is a closed manifold, unless open, with vertices in the volume's world (LPS mm). It
    is the same to the bit for any number of threads, and for any strides of the array.

    volume      a Volume, or an array of shape (z, y, x) with voxels of 1 mm
    iso         in the unit of the values, after slope and intercept
    inside      'above' or 'below' the isovalue; 'auto': above, in level sets below
    open        leave the surface open where it meets the border; default: capped
    topology    'field', or 'simple' for one table of cases
    placement   'linear' or 'cubic' along edges
    snap        up to 0.5: merge vertices closer to a sample than this fraction of an edge
    normals     'field' for the gradient's, or 'none'
    min_volume  leave out components that enclose less, in cubic millimetres
    largest     number of components to keep, those that enclose the most; 0: all
    fill_voids  leave out the cavities of solids, and all inside them
    simplify    a float: error limit in mm; an int: triangle count. See simplify()
    component, step  of volumes with several, from 0
    max_triangles, max_bytes  fail beyond, before more memory is taken; 0: no limit
    threads     0: all; progress: see Progress

    A volume without a crossing gives a mesh without triangles. Raises Error: ARGUMENT, UNSUPPORTED,
    LIMIT, NO_MEMORY, CANCELLED.
    """
    options = {name: value for name, value in locals().items() if name not in ("volume", "component", "step")}
    source = take_volume(volume)
    view = source._select(component, step)
    return extract_by(lib.cw_extract, byref(view), source, **options)


def extract_by(function: Callable[..., int], place: Any, source: Volume, **options: Any) -> Mesh:
    """Extracts by a function of the library; place is what it takes first, a volume or extractor."""
    reporter = Reporter(options["progress"])
    desc = c.cw_extract_desc(
        isovalue=take_number("iso", options["iso"]),
        inside_is_low=take_inside(options["inside"], source),
        leave_open=take_flag("open", options["open"]),
        simple_topology=take_choice("topology", options["topology"], ("field", "simple")) == 1,
        cubic_placement=take_choice("placement", options["placement"], ("linear", "cubic")) == 1,
        no_normals=take_choice("normals", options["normals"], ("field", "none")) == 1,
        snap=take_number("snap", options["snap"]),
        threads=take_threads(options["threads"]),
        max_triangles=take_count("max_triangles", options["max_triangles"]),
        max_bytes=take_count("max_bytes", options["max_bytes"]),
        progress=reporter.struct,
    )
    least = take_length("min_volume", options["min_volume"])
    largest = take_count("largest", options["largest"])
    fills = take_flag("fill_voids", options["fill_voids"])
    mesh = Mesh._from_c(c.cw_mesh())
    reporter.call(function, place, byref(desc), byref(mesh._struct), None)
    if least > 0:
        call(lib.cw_mesh_drop_volumes, byref(mesh._struct), least, None)
    if largest > 0:
        call(lib.cw_mesh_keep_largest, byref(mesh._struct), largest, None)
    if fills:
        call(lib.cw_mesh_fill_voids, byref(mesh._struct), take_threads(options["threads"]), None)
    target = options["simplify"]
    return mesh if target is None else reduce_surface(mesh, target, options["threads"], options["progress"])


class Extractor:
    """Extracts several surfaces of one volume, at different isovalues.

    The first extraction builds an octree of values. Later ones read only the parts that their
    isovalue passes through. Meshes are the same to the bit as those of extract(). The volume's
    values must not change meanwhile. Calls of several threads wait for each other.
    """

    def __init__(self, volume: AnyVolume, *, component: int = 0, step: int = 0) -> None:
        self.volume = take_volume(volume)
        self._view = self.volume._select(component, step)  # borrowed by the extractor
        self._extractor = POINTER(c.cw_extractor)()
        self._lock = threading.Lock()
        self._user = 0  # the thread that extracts
        call(lib.cw_extractor_new, byref(self._view), byref(self._extractor))
        weakref.finalize(self, lib.cw_extractor_free, self._extractor).atexit = False

    def extract(
        self,
        iso: float,
        *,
        inside: str = "auto",
        open: bool = False,
        topology: str = "field",
        placement: str = "linear",
        snap: float = 0.0,
        normals: str = "field",
        min_volume: float = 0.0,
        largest: int = 0,
        fill_voids: bool = False,
        simplify: int | float | None = None,
        max_triangles: int = 0,
        max_bytes: int = 0,
        threads: int = 0,
        progress: Progress = None,
    ) -> Mesh:
        """Extracts the surface at an isovalue; options and errors as of extract()."""
        options = {name: value for name, value in locals().items() if name != "self"}
        if self._user == threading.get_ident():
            raise RuntimeError("an extractor cannot be used by the progress callback of its own call")
        with self._lock:
            self._user = threading.get_ident()
            try:
                return extract_by(lib.cw_extractor_extract, self._extractor, self.volume, **options)
            finally:
                self._user = 0


def reduce_surface(mesh: Mesh, target: int | float, threads: int, progress: Progress) -> Mesh:
    if len(mesh.triangles) == 0:
        return mesh
    if isinstance(target, float):
        return simplify_mesh(mesh, error=target, threads=threads, progress=progress)
    return simplify_mesh(mesh, triangles=target, threads=threads, progress=progress)


@dataclass(frozen=True)
class Patch:
    """The interface of two labels: triangles first to first + count of LabelSurfaces.shared."""

    labels: tuple[int, int]
    first: int
    count: int


class LabelSurfaces:
    """The surfaces of all labels of a label map, which share their vertices.

    voxels   number of voxels of each label
    patches  interfaces, in rising order of their labels
    shared   one mesh with each interface once; its arrays share memory with the library
    """

    def __init__(self, owner: Owner[c.cw_label_surfaces]) -> None:
        self._owner = owner
        self._struct = struct = owner.struct
        rows = struct.labels[: struct.label_count] if struct.label_count else []
        self.voxels: dict[int, int] = {row.label: row.voxels for row in rows}
        pieces = struct.patches[: struct.patch_count] if struct.patch_count else []
        self.patches = [Patch((p.labels[0], p.labels[1]), p.first, p.count) for p in pieces]
        self.shared = Mesh._from_c(struct.mesh, self._owner)

    def mesh(self, label: int) -> Mesh:
        """Returns the closed mesh of one label. A label without voxels has no triangles."""
        out = c.cw_mesh()
        call(lib.cw_label_mesh, byref(self._struct), take_count("label", label, 0, 2**32 - 1), byref(out))
        return Mesh._from_c(out)

    def meshes(self) -> dict[int, Mesh]:
        """Returns the closed mesh of each label."""
        return {label: self.mesh(label) for label in self.voxels}

    def simplify(
        self,
        *,
        error: float = 0.0,
        triangles: int = 0,
        ratio: float = 0.0,
        threads: int = 0,
        progress: Progress = None,
    ) -> LabelSurfaces:
        """Simplifies all interfaces together; neighbours stay without a gap.

        error in mm, a number of triangles, or a ratio of them: the first reached ends the work.
        """
        reporter = Reporter(progress)
        desc = c.cw_label_simplify_desc(
            error_mm=take_length("error", error),
            triangles=take_count("triangles", triangles),
            ratio=take_number("ratio", ratio),
            threads=take_threads(threads),
            progress=reporter.struct,
        )
        out = Owner(c.cw_label_surfaces(), lib.cw_label_surfaces_free)
        reporter.call(lib.cw_label_simplify, byref(self._struct), byref(desc), byref(out.struct))
        return LabelSurfaces(out)

    def __repr__(self) -> str:
        return f"<cubewright.LabelSurfaces {len(self.voxels)} labels, {len(self.patches)} interfaces>"


def extract_labels(
    volume: AnyVolume,
    labels: Iterable[int] | None = None,
    *,
    background: int = 0,
    smooth_labels: float | None = None,
    open: bool = False,
    component: int = 0,
    step: int = 0,
    max_triangles: int = 0,
    threads: int = 0,
    progress: Progress = None,
) -> LabelSurfaces:
    """Extracts a closed, smoothed surface of each label of a label map, in one pass.

    volume         whole numbers from 0 to 2**32 - 1, of any type; a Volume or an array (z, y, x)
    labels         those wanted; default: all but the background
    smooth_labels  limit of a vertex' move by smoothing along each axis, in voxels: up to 0.5,
                   the default; 0: no smoothing. Every label keeps the volume of its voxels

    Raises Error: ARGUMENT (a value is no label), UNSUPPORTED, LIMIT, NO_MEMORY, CANCELLED.
    """
    source = take_volume(volume)
    view = source._select(component, step)
    reporter = Reporter(progress)
    desc = c.cw_labels_desc(
        background=take_count("background", background, 0, 2**32 - 1),
        leave_open=take_flag("open", open),
        threads=take_threads(threads),
        max_triangles=take_count("max_triangles", max_triangles),
        progress=reporter.struct,
    )
    if labels is not None:
        wanted = [take_count("a label", label, 0, 2**32 - 1) for label in labels]
        if not wanted:
            raise ValueError("labels is empty; None stands for all")
        desc.labels, desc.label_count = (c_uint32 * len(wanted))(*wanted), len(wanted)
    if smooth_labels is not None:
        desc.max_move = take_length("smooth_labels", smooth_labels)
        desc.no_smoothing = desc.max_move == 0
    out = Owner(c.cw_label_surfaces(), lib.cw_label_surfaces_free)
    reporter.call(lib.cw_extract_labels, byref(view), byref(desc), byref(out.struct))
    return LabelSurfaces(out)
