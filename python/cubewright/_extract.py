"""Surfaces of volumes: at an isovalue, and of labels."""

from __future__ import annotations

import operator
import sys
import threading
import warnings
import weakref
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from ctypes import POINTER, byref, c_double, c_size_t, c_uint32, memmove, memset, pointer, sizeof
from dataclasses import dataclass
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from . import _declarations as c
from ._atlas import MAPS, describe_atlas, take_maps
from ._color import COLORMAPS
from ._cut import describe_cut
from ._engrave import describe_text
from ._errors import Error, Status, call
from ._handles import describe_handles
from ._library import lib
from ._memory import Owner, unpack
from ._mesh import Levels, Mesh
from ._options import (
    take_choice,
    take_count,
    take_degrees,
    take_flag,
    take_length,
    take_lengths,
    take_number,
    take_numbers,
    take_space,
    take_threads,
)
from ._progress import Progress, Reporter
from ._render import copy_image
from ._simplify import describe_smoothing, take_counts
from ._views import set_views
from ._volume import Volume, number_labels, take_volume

INSIDE = ("above", "below")

_TAKE: Any = dict(c.cw_pipeline_sink._fields_)["take"]  # type: ignore[arg-type]
_TAKE_BRICK: Any = dict(c.cw_brick_sink._fields_)["take"]  # type: ignore[arg-type]
_OPEN: Any = dict(c.cw_pipeline_color._fields_)["open"]  # type: ignore[arg-type]

AnyVolume = Union[Volume, "npt.NDArray[Any]"]


def take_inside(inside: str, volume: Volume) -> bool:
    """Returns whether low values are inside. 'auto' is above, in level sets below."""
    choice = take_choice("inside", inside, ("auto", *INSIDE))
    return volume.level_set if choice == 0 else choice == 2


def take_iso(iso: float | str, view: c.cw_volume, threads: int = 0) -> float:
    """Returns the number of an isovalue, or the one that a name stands for."""
    if not isinstance(iso, str):
        return take_number("iso", iso)
    level = c_double()
    call(lib.cw_volume_level, byref(view), iso.encode(), take_threads(threads), byref(level))
    return level.value


def warn_of_labels(view: c.cw_volume, iso: float, low: bool) -> None:
    """Warns if integers look like labels, several of which the surface at an isovalue joins."""
    if view.type in (c.cw_type.CW_F32, c.cw_type.CW_F64):
        return
    labels = c.cw_labels()
    call(lib.cw_volume_labels, byref(view), byref(labels))
    values = labels.value[: labels.count] if labels.found else []
    inside = sum(value != 0 and (value < iso if low else value >= iso) for value in values)
    if inside > 1:
        more = "more than " if labels.more else ""
        warnings.warn(
            f"these look like labels: the surface at {iso:g} joins {more}{inside} of them; extract_labels() takes each",
            stacklevel=4,
        )


@dataclass(frozen=True)
class Settings:
    """The settings of a surface: the keywords of extract()."""

    inside: str = "auto"
    open: bool = False
    topology: str = "field"
    placement: str = "linear"
    snap: float = 0.0
    normals: str = "field"
    min_volume: float | str = 0.0
    largest: int = 0
    fill_voids: bool = False
    close_handles: float | str | None = None
    smooth: str | dict[str, Any] | None = None
    cut_plane: tuple[Sequence[float], Sequence[float]] | None = None
    engrave: str | dict[str, Any] | None = None
    simplify: int | float | str | None = None
    camera: Any = None
    pixel_error: float = 0.0
    shading: float = 1.5
    cull: bool = False
    size: Sequence[int] = (1280, 720)
    uv: bool | dict[str, Any] = False
    crease_angle: float | str | None = None
    color_by: AnyVolume | None = None
    colormap: str = "viridis"
    color_range: tuple[float, float] | None = None
    check: bool = False
    max_triangles: int = 0
    max_bytes: int = 0
    threads: int = 0
    progress: Progress = None

    def describe(self, iso: float, source: Volume, reporter: Reporter) -> c.cw_pipeline_desc:
        """Returns the descriptor of the pipeline. It keeps alive what it points to, but for the reporter."""
        threads = take_threads(self.threads)
        desc = c.cw_pipeline_desc(
            extract=c.cw_extract_desc(
                isovalue=take_number("iso", iso),
                inside_is_low=take_inside(self.inside, source),
                leave_open=take_flag("open", self.open),
                simple_topology=take_choice("topology", self.topology, ("field", "simple")) == 1,
                cubic_placement=take_choice("placement", self.placement, ("linear", "cubic")) == 1,
                no_normals=take_choice("normals", self.normals, ("field", "none")) == 1,
                snap=take_number("snap", self.snap),
                threads=threads,
                max_triangles=take_count("max_triangles", self.max_triangles),
                max_bytes=take_count("max_bytes", self.max_bytes),
                progress=reporter.struct,
            ),
            min_volume_mm3=take_space("min_volume", self.min_volume),
            largest=take_count("largest", self.largest),
            fill_voids=take_flag("fill_voids", self.fill_voids),
            check=take_flag("check", self.check),
        )
        if self.close_handles is not None:
            desc.close_handles = pointer(describe_handles(self.close_handles, volume=source))
        if self.smooth is not None:
            how = {"method": self.smooth} if isinstance(self.smooth, str) else self.smooth
            desc.smooth = pointer(describe_smoothing(volume=source, **how))
        if self.cut_plane is not None:
            point, normal = self.cut_plane
            desc.cut = pointer(describe_cut(point, normal))
        if self.engrave is not None:
            engraved = {"text": self.engrave} if isinstance(self.engrave, str) else self.engrave
            desc.engrave = pointer(describe_text(**engraved))
        if self.camera is not None:
            set_views(
                desc,
                source,
                camera=self.camera,
                size=self.size,
                pixel_error=self.pixel_error,
                shading=self.shading,
                cull=self.cull,
                simplify=self.simplify,
            )
        elif self.pixel_error or self.cull:
            raise TypeError("pixel_error and cull need a camera")
        elif isinstance(self.simplify, (float, str)):
            error = take_length("simplify", self.simplify, volume=source)
            desc.simplify = pointer(c.cw_simplify_desc(error_mm=error))
        elif self.simplify is not None:
            desc.simplify = pointer(c.cw_simplify_desc(triangles=take_count("simplify", self.simplify, 1)))
        if self.uv:
            desc.atlas = pointer(describe_atlas(**({} if self.uv is True else self.uv)))
        if self.crease_angle == "caps":
            desc.crease_caps = True
        elif self.crease_angle is not None:
            desc.crease_degrees = take_degrees("crease_angle", self.crease_angle)
        if self.color_by is not None:
            desc.color = pointer(describe_coloring(self.color_by, self.colormap, self.color_range))
        return desc


def extract(
    volume: AnyVolume,
    iso: float | str,
    *,
    inside: str = "auto",
    open: bool = False,
    topology: str = "field",
    placement: str = "linear",
    snap: float = 0.0,
    normals: str = "field",
    min_volume: float | str = 0.0,
    largest: int = 0,
    fill_voids: bool = False,
    close_handles: float | str | None = None,
    smooth: str | dict[str, Any] | None = None,
    cut_plane: tuple[Sequence[float], Sequence[float]] | None = None,
    engrave: str | dict[str, Any] | None = None,
    simplify: int | float | str | None = None,
    camera: Any = None,
    pixel_error: float = 0.0,
    shading: float = 1.5,
    cull: bool = False,
    size: Sequence[int] = (1280, 720),
    uv: bool | dict[str, Any] = False,
    crease_angle: float | str | None = None,
    color_by: AnyVolume | None = None,
    colormap: str = "viridis",
    color_range: tuple[float, float] | None = None,
    check: bool = False,
    component: int = 0,
    step: int = 0,
    max_triangles: int = 0,
    max_bytes: int = 0,
    threads: int = 0,
    progress: Progress = None,
) -> Mesh:
    """Extracts the surface where the trilinear field of a volume equals an isovalue.

    The mesh is a closed manifold, unless open, with vertices in the volume's world (LPS mm). It
    is the same to the bit for any number of threads, and for any strides of the array. The stages
    run in the order in which they stand here.

    volume      a Volume, or an array of shape (z, y, x) with voxels of 1 mm
    iso         in the unit of the values, after slope and intercept; or a name of Volume.level(), such as
                "otsu". Integers that look like labels, of which the surface joins several, are warned of
    inside      'above' or 'below' the isovalue; 'auto': above, in level sets below
    open        leave the surface open where it meets the border; default: capped
    topology    'field', or 'simple' for one table of cases
    placement   'linear' or 'cubic' along edges
    snap        up to 0.5: merge vertices closer to a sample than this fraction of an edge
    normals     'field' for the gradient's, or 'none'
    min_volume  leave out components that enclose less, in mm3, or as a text with a unit: "2ml"
    largest     number of components to keep, those that enclose the most; 0: all
    fill_voids  leave out the cavities of solids, and all inside them
    close_handles  a length: close handles with loops up to it; "auto": 3 % of the surface's diagonal. See
                close_handles()
    smooth      a method, or a dict of the keywords of smooth(): {"method": "hc", "iterations": 5}
    cut_plane   (point, normal) as of cut(): what is above stays, and is closed flat
    engrave     a text, or a dict of the keywords of engrave(): {"text": "L", "size": "5mm", "at": (0, 0, 10)}
    simplify    a float: error limit in mm; a text: the same with its unit, "0.1mm" or "0.5vox"; an int:
                triangle count. See simplify()
    camera      one of render(), or a list of them: keep the detail that their pictures of `size` pixels need.
                Visible surface moves by at most pixel_error pixels, and its normals by `shading` degrees; simplify
                is then the error out of sight, as a length. cull: leave out what no camera sees, and with it alone
                keep the rest as it is
    uv          make texture coordinates: True, or a dict of the keywords of atlas(): {"size": 1024}
    crease_angle  degrees: let normals part at edges with a larger angle, as of crease_normals(); "caps": where
                caps close the surface at the end of the volume
    color_by    another volume, whose values become scalars and colours. See color_by()
    colormap, color_range  the map, and the values of its ends; None: those of the vertices
    check       measure it: mesh.facts["quality"], by the names of check().quality
    component, step  of volumes with several, from 0
    max_triangles, max_bytes  fail beyond, before more memory is taken; 0: no limit
    threads     0: all; progress: see Progress

    What the stages did is in the facts of the mesh: mesh.facts["voids"]["dropped"].

    A volume without a crossing gives a mesh without triangles. Raises Error: ARGUMENT, UNSUPPORTED,
    LIMIT, NO_MEMORY, CANCELLED.
    """
    options = {name: value for name, value in locals().items() if name in Settings.__dataclass_fields__}
    return run_pipeline(volume, iso, Settings(**options), component, step)


def extract_levels(
    volume: AnyVolume,
    iso: float | str,
    triangles: Sequence[int],
    *,
    maps: str | Iterable[str] = (),
    reach: float | str = 0.0,
    component: int = 0,
    step: int = 0,
    **options: Any,
) -> Levels:
    """Extracts a surface, and returns levels of detail of it, each made from the one before.

    triangles  number of each level, fewer than of the one before
    maps       maps of the full surface to bake, as of bake_maps(). They need uv, and all levels share them and the
               texture coordinates. write() takes the levels, with this map of normals
    reach      a length: how far the full surface may be from the first level; 0: 4 % of the box's diagonal
    options    as of extract(), but simplify. Normals are those of the field

    Raises Error as extract(), and EMPTY for a volume without a crossing.
    """
    levels = Levels()
    counts = take_counts(triangles)
    source = take_volume(volume)
    view = source._select(component, step)
    settings = Settings(**options)
    reporter = Reporter(settings.progress)
    desc = settings.describe(take_iso(iso, view, settings.threads), source, reporter)
    desc.lod, desc.lod_count = (c_size_t * len(counts))(*counts), len(counts)
    wanted = take_maps(maps)
    if wanted:
        desc.bake = pointer(c.cw_bake_desc(maps=wanted, reach_mm=take_length("reach", reach, volume=source)))

    def take_level(_user: int | None, surface: Any, facts: Any, _err: Any) -> int:
        mesh = Mesh._from_c(c.cw_mesh())
        mesh.facts = unpack_facts(facts.contents)
        memmove(byref(mesh._struct), surface.contents.mesh, sizeof(c.cw_mesh))
        memset(surface.contents.mesh, 0, sizeof(c.cw_mesh))
        levels.append(mesh)
        for n, name in enumerate(MAPS if wanted and surface.contents.level == 0 else ()):
            if surface.contents.maps[n].pixels:
                levels.maps[name] = copy_image(surface.contents.maps[n])
        return 0

    sink = c.cw_pipeline_sink(take=_TAKE(take_level))
    reporter.call(lib.cw_pipeline_run, byref(view), None, byref(desc), sink, None)
    return levels


def run_pipeline(
    volume: AnyVolume, iso: float | str, settings: Settings, component: int = 0, step: int = 0, extractor: Any = None
) -> Mesh:
    """Runs the pipeline for one surface."""
    source = take_volume(volume)
    view = source._select(component, step)
    reporter = Reporter(settings.progress)
    desc = settings.describe(take_iso(iso, view, settings.threads), source, reporter)
    if extractor is None:
        warn_of_labels(view, desc.extract.isovalue, desc.extract.inside_is_low)
    mesh = Mesh._from_c(c.cw_mesh())
    facts = c.cw_pipeline_facts()
    try:
        reporter.call(lib.cw_pipeline_mesh, byref(view), extractor, byref(desc), byref(mesh._struct), byref(facts))
    except Error as error:
        if error.status != Status.EMPTY or settings.color_by is not None:
            raise
    mesh.facts = unpack_facts(facts)
    return mesh


def unpack_facts(facts: c.cw_pipeline_facts) -> dict[str, Any]:
    """Returns what the stages found, with the names of those that ran."""
    values = unpack(facts)
    del values["version"]
    ran = values["ran"]
    values["ran"] = [lib.cw_stage_name(s).decode() for s in range(c.cw_stage.CW_STAGE_COUNT) if ran >> s & 1]
    return values


def describe_coloring(volume: AnyVolume, colormap: str, ends: tuple[float, float] | None) -> c.cw_pipeline_color:
    source = take_volume(volume)
    view = source._select(0, 0)

    def open_volume(_user: int | None, out: Any, _err: Any) -> int:
        out[0] = pointer(view)
        return 0

    color = c.cw_pipeline_color(
        open=_OPEN(open_volume),
        map=take_choice("colormap", colormap, COLORMAPS),
    )
    if ends is not None:
        color.low, color.high = take_numbers("color_range", ends, 2)
        color.has_range = True
    color.kept = (source, view)
    return color


@dataclass(frozen=True)
class Brick:
    """The part of a surface in one brick of 16 x 16 x 16 cells.

    index  number among all bricks, of which those along x follow each other
    at     (x, y, z) its place among them: along x it has the cells from voxel 16 x - 1 to voxel 16 x + 15
    mesh   without triangles, if the surface no longer passes through the brick
    """

    index: int
    at: tuple[int, int, int]
    mesh: Mesh


class Extractor:
    """Extracts several surfaces of one volume, at different isovalues or while the volume changes.

    The first extraction builds an octree of values. Later ones read only the parts that their
    isovalue passes through. Meshes are the same to the bit as those of extract(). Changes of the
    volume's values have to be told by update(). Calls of several threads wait for each other.
    """

    def __init__(self, volume: AnyVolume, *, component: int = 0, step: int = 0) -> None:
        self.volume = take_volume(volume)
        self._component, self._step = component, step
        self._view = self.volume._select(component, step)  # borrowed by the extractor
        self._extractor = POINTER(c.cw_extractor)()
        self._lock = threading.Lock()
        self._user = 0  # the thread that extracts
        call(lib.cw_extractor_new, byref(self._view), byref(self._extractor))
        weakref.finalize(self, lib.cw_extractor_free, self._extractor).atexit = False

    @contextmanager
    def _in_use(self) -> Iterator[None]:
        """Lets one call at a time use the extractor."""
        if self._user == threading.get_ident():
            raise RuntimeError("an extractor cannot be used by the progress callback of its own call")
        with self._lock:
            self._user = threading.get_ident()
            try:
                yield
            finally:
                self._user = 0

    def update(self, box: tuple[slice, slice, slice] | None = None) -> None:
        """Tells that values of volume.array have changed, after they were written.

        That is the array that the volume was made of, unless it had to be copied.

        box  the slices along z, y, x that were written to, such as np.s_[8:16, 0:4, :]; None: all

        Raises ValueError for slices with steps, Error: ARGUMENT for an empty box, UNSUPPORTED for a box of
        an irregular grid.
        """
        part = None if box is None else byref(describe_box(box, self.volume.shape))
        with self._in_use():
            call(lib.cw_extractor_update, self._extractor, part)

    def extract(self, iso: float | str, **options: Any) -> Mesh:
        """Extracts the surface at an isovalue; options and errors as of extract()."""
        settings = Settings(**options)
        with self._in_use():
            return run_pipeline(self.volume, iso, settings, self._component, self._step, self._extractor)

    def extract_changed(
        self,
        iso: float | str,
        *,
        inside: str = "auto",
        open: bool = False,
        topology: str = "field",
        placement: str = "linear",
        normals: str = "field",
        max_triangles: int = 0,
        max_bytes: int = 0,
        threads: int = 0,
        progress: Progress = None,
    ) -> list[Brick]:
        """Extracts the bricks of the surface that may differ from what was given before.

        The first time, and with another isovalue or other options, these are all that have a surface; then
        those around what update() told of. Whoever replaces its bricks by them has the surface of extract():
        the same triangles, positions and normals. Vertices on the faces between bricks are in each of them.

        Options and errors as of extract(); max_triangles is for all bricks of one call. UNSUPPORTED for sparse
        and irregular grids. After an error all bricks that were not given are given next time.
        """
        options = {name: value for name, value in locals().items() if name in Settings.__dataclass_fields__}
        settings = Settings(**options)
        reporter = Reporter(progress)
        desc = settings.describe(take_iso(iso, self._view, settings.threads), self.volume, reporter)
        bricks: list[Brick] = []

        def take_brick(_user: int | None, given: Any, _err: Any) -> int:
            try:
                brick = given.contents
                mesh = Mesh._from_c(brick.mesh.contents, given).copy()
                x, y, z = brick.at
                bricks.append(Brick(brick.index, (x, y, z), mesh))
            except BaseException as exception:  # it would be lost in C
                reporter.exception = exception
                return int(Status.CANCELLED)
            return 0

        sink = c.cw_brick_sink(take=_TAKE_BRICK(take_brick))
        with self._in_use():
            reporter.call(lib.cw_extractor_extract_changed, self._extractor, byref(desc.extract), sink)
        return bricks

    def recycle(self, mesh: Mesh) -> None:
        """Takes back a mesh that is no longer needed: the next surface is written to its memory.

        The mesh is empty then. Raises BufferError while one of its arrays is in use, ValueError for a mesh
        of NumPy's arrays.
        """
        if not isinstance(mesh._owner, Owner):
            raise ValueError("the mesh is made of arrays that are not the library's")
        mesh._attributes = None
        if sys.getrefcount(mesh._owner) > 2:
            raise BufferError("arrays of the mesh are in use")
        with self._in_use():
            lib.cw_extractor_recycle(self._extractor, byref(mesh._struct))


def describe_box(box: tuple[slice, slice, slice], shape: tuple[int, int, int]) -> c.cw_box:
    """Returns the box of voxels that slices along z, y, x stand for."""
    if not isinstance(box, tuple) or len(box) != 3 or not all(isinstance(part, slice) for part in box):
        raise TypeError("box must be three slices, along z, y and x")
    out = c.cw_box()
    for axis, (part, size) in enumerate(zip(reversed(box), reversed(shape))):
        first, end, step = part.indices(size)
        if step != 1:
            raise ValueError("slices of a box have no steps")
        out.first[axis], out.count[axis] = first, max(end - first, 0)
    return out


@dataclass(frozen=True)
class Patch:
    """The interface of two labels: triangles first to first + count of LabelSurfaces.shared."""

    labels: tuple[int, int]
    first: int
    count: int


class LabelSurfaces:
    """The surfaces of all labels of a label map, which share their vertices.

    voxels   number of voxels of each label
    patches  interfaces, in rising order of their labels; the background's is 0
    shared   one mesh with each interface once; its arrays share memory with the library
    """

    def __init__(self, owner: Owner[c.cw_label_surfaces], ids: list[int]) -> None:
        self._owner = owner
        self._struct = struct = owner.struct
        self._ids = ids
        self._values = {number: value for value, number in enumerate(ids)}
        rows = struct.labels[: struct.label_count] if struct.label_count else []
        self.voxels: dict[int, int] = {self._number(row.label): row.voxels for row in rows}
        pieces = struct.patches[: struct.patch_count] if struct.patch_count else []
        self.patches = [
            Patch((self._number(p.labels[0]), self._number(p.labels[1])), p.first, p.count) for p in pieces
        ]
        self.shared = Mesh._from_c(struct.mesh, self._owner)

    def _number(self, value: int) -> int:
        """Returns the number of the label that voxels of a value have."""
        return self._ids[value] if self._ids else value

    def mesh(self, label: int) -> Mesh:
        """Returns the closed mesh of one label. A label without voxels has no triangles."""
        out = c.cw_mesh()
        value = find_value("label", label, self._ids, self._values)
        call(lib.cw_label_mesh, byref(self._struct), value, byref(out))
        return Mesh._from_c(out)

    def volumes(self) -> dict[int, float]:
        """Returns the volume that the surface of each label encloses, in cubic millimetres."""
        out = (c_double * len(self.voxels))()
        lib.cw_label_volumes(byref(self._struct), out)
        return dict(zip(self.voxels, out))

    def meshes(self) -> dict[int, Mesh]:
        """Returns the closed mesh of each label."""
        return {label: self.mesh(label) for label in self.voxels}

    def simplify(
        self,
        *,
        error: float | str = 0.0,
        triangles: int = 0,
        ratio: float = 0.0,
        threads: int = 0,
        progress: Progress = None,
    ) -> LabelSurfaces:
        """Simplifies all interfaces together; neighbours stay without a gap.

        error in mm or as a text with a unit, a number of triangles, or a ratio of them: the first reached ends the work.
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
        return LabelSurfaces(out, self._ids)

    def __repr__(self) -> str:
        return f"<cubewright.LabelSurfaces {len(self.voxels)} labels, {len(self.patches)} interfaces>"


def find_value(name: str, label: Any, ids: list[int], values: dict[int, int]) -> int:
    """Returns the value that voxels of a label have; one that none has for a label without voxels."""
    if not ids:
        return take_count(name, label, 0, 2**32 - 1)
    number = operator.index(label)
    if not -(2**63) <= number < 2**64:
        raise ValueError(f"{name} is {number}; a whole number of up to 64 bits was expected")
    return values.get(number, 2**32 - 1)


@dataclass(frozen=True)
class LabelChange:
    """A label before and after cleaning: voxels and components."""

    voxels_before: int
    voxels: int
    components_removed: int
    voxels_removed: int
    voxels_added: int


def clean_labels(
    volume: AnyVolume,
    *,
    min_voxels: int = 0,
    largest: int = 0,
    fill_voids: bool = False,
    background: int = 0,
    component: int = 0,
    step: int = 0,
) -> tuple[Volume, dict[int, LabelChange]]:
    """Removes small components of labels, and fills voids: returns the map and what changed of each label.

    volume      as for extract_labels()
    min_voxels  components with fewer voxels go to the label, or the background, with the most common faces
    largest     components of each label that stay; 0: all
    fill_voids  background within one label goes to it

    Raises Error: ARGUMENT (a value is no label), UNSUPPORTED, LIMIT, NO_MEMORY.
    """
    source = number_labels(volume)
    view = source._select(component, step)
    values = {number: value for value, number in enumerate(source.ids)}
    desc = c.cw_label_clean_desc(
        min_voxels=take_count("min_voxels", min_voxels),
        largest=take_count("largest", largest),
        fill_voids=take_flag("fill_voids", fill_voids),
        background=find_value("background", background, source.ids, values),
    )
    out, rows, count = Owner(c.cw_volume(), lib.cw_volume_free), POINTER(c.cw_label_change)(), c_size_t()
    call(lib.cw_labels_clean, byref(view), byref(desc), byref(out.struct), byref(rows), byref(count))
    changes = {
        source.ids[row.label] if source.ids else row.label: LabelChange(
            row.voxels_before, row.voxels, row.components_removed, row.voxels_removed, row.voxels_added
        )
        for row in rows[: count.value]
    }
    lib.cw_label_changes_free(rows)
    cleaned = Volume._from_c(out)
    cleaned.ids = source.ids
    return cleaned, changes


LABEL_KERNELS = ("majority", "nearest")


def resample_labels(
    volume: AnyVolume,
    spacing: float | str | Sequence[float | str],
    kernel: str = "majority",
    *,
    background: int = 0,
    component: int = 0,
    step: int = 0,
    threads: int = 0,
    progress: Progress = None,
) -> Volume:
    """Samples a label map at other distances: returns a new map, with the same ids.

    volume   as for extract_labels()
    spacing  between voxels, in mm or as a text with a unit ("0.5mm"): of all axes, or of x, y and z; 0 leaves an axis
    kernel   majority: the label with the largest share of a Gaussian, whose standard deviation is half of the
             old or the new distance, whichever is larger; or nearest

    Raises Error: ARGUMENT (a value is no label), UNSUPPORTED, LIMIT, NO_MEMORY, CANCELLED.
    """
    source = number_labels(volume)
    view = source._select(component, step)
    values = {number: value for value, number in enumerate(source.ids)}
    reporter = Reporter(progress)
    desc = c.cw_label_resample_desc(
        spacing_mm=(c_double * 3)(*take_lengths("spacing", spacing)),
        kernel=take_choice("kernel", kernel, LABEL_KERNELS),
        background=find_value("background", background, source.ids, values),
        threads=take_threads(threads),
        progress=reporter.struct,
    )
    out = Owner(c.cw_volume(), lib.cw_volume_free)
    reporter.call(lib.cw_labels_resample, byref(view), byref(desc), byref(out.struct))
    sampled = Volume._from_c(out)
    sampled.ids = source.ids
    return sampled


def set_labels(desc: c.cw_labels_desc, values: list[int]) -> None:
    """Sets the labels that are wanted."""
    if not values:
        raise ValueError("labels is empty; None stands for all")
    desc.labels, desc.label_count = (c_uint32 * len(values))(*values), len(values)


def set_max_move(desc: c.cw_labels_desc, name: str, value: float) -> None:
    """Sets how far vertices may move, from the parameter of a name; 0: not at all."""
    desc.max_move = take_length(name, value)
    desc.no_smoothing = desc.max_move == 0


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

    volume         whole numbers; a Volume, of 0 to 2**32 - 1 in any type or with ids, or an array
                   (z, y, x) of up to 64 bits with or without a sign
    labels         those wanted; default: all but the background
    smooth_labels  limit of a vertex' move by smoothing along each axis, in voxels: up to 0.5,
                   the default; 0: no smoothing. Every label keeps the volume of its voxels

    Raises Error: ARGUMENT (a value is no label), UNSUPPORTED, LIMIT, NO_MEMORY, CANCELLED.
    """
    source = number_labels(volume)
    view = source._select(component, step)
    values = {number: value for value, number in enumerate(source.ids)}
    reporter = Reporter(progress)
    desc = c.cw_labels_desc(
        background=find_value("background", background, source.ids, values),
        leave_open=take_flag("open", open),
        threads=take_threads(threads),
        max_triangles=take_count("max_triangles", max_triangles),
        progress=reporter.struct,
    )
    if labels is not None:
        set_labels(desc, [find_value("a label", label, source.ids, values) for label in labels])
    if smooth_labels is not None:
        set_max_move(desc, "smooth_labels", smooth_labels)
    out = Owner(c.cw_label_surfaces(), lib.cw_label_surfaces_free)
    reporter.call(lib.cw_extract_labels, byref(view), byref(desc), byref(out.struct))
    return LabelSurfaces(out, source.ids)
