"""Volumes: voxels with a place in the world, over the memory of an array or of a file's reader."""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import POINTER, byref, c_double, c_int64, c_uint32, c_void_p
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _declarations as c
from ._errors import call
from ._library import lib
from ._memory import Owner, lend_array
from ._options import take_choice, take_count, take_flag, take_lengths, take_number, take_numbers, take_text, take_threads

TYPES: dict[str, int] = {
    "u1": c.cw_type.CW_U8,
    "i1": c.cw_type.CW_I8,
    "u2": c.cw_type.CW_U16,
    "i2": c.cw_type.CW_I16,
    "u4": c.cw_type.CW_U32,
    "i4": c.cw_type.CW_I32,
    "f4": c.cw_type.CW_F32,
    "f8": c.cw_type.CW_F64,
}
KINDS = {number: kind for kind, number in TYPES.items()}
AFFINE = c_double * 4 * 3


KERNELS = ("linear", "cubic", "lanczos")


@dataclass(frozen=True)
class Statistics:
    """Range and frequencies of the values of one component and step, after slope and intercept.

    counts  of bins of one width from min to max; edges has one more
    otsu    the level that separates the values best into two classes [Otsu1979], or None
    """

    min: float
    max: float
    finite: int
    not_finite: int
    nodata: int
    counts: npt.NDArray[np.uint64] = field(repr=False)
    edges: npt.NDArray[np.float64] = field(repr=False)
    otsu: float | None


@dataclass(frozen=True)
class Label:
    """A label that a file names. value is its number, of up to 64 bits. color is sRGB and opacity, 0 to 255, or None."""

    value: int
    layer: int
    name: str | None
    color: tuple[int, int, int, int] | None


class Volume:
    """A volume over the memory of an array.

    Axes of arrays run z, y, x: the last index is x. Everything else (spacing, origin, affine,
    points) runs x, y, z. Lengths are millimetres. The world is LPS: +x to the patient's left,
    +y to the back, +z to the head.

    array        of shape (z, y, x); with components=True (z, y, x, component), with steps=True
                 (step, z, y, x), or both. Anything that numpy.asarray() takes without a copy.
                 Types: bool, signed and unsigned integers of 8, 16 and 32 bits, float32,
                 float64. Copies are made of float16, and of int64 and uint64 whose values fit 32 bits.
                 Others are TypeErrors, which name a conversion.
    copy         None: share the array's memory, with any strides. A copy is made only of other types, and
                 of arrays in another byte order, not aligned, or that repeat memory (broadcast arrays).
                 False: such arrays are ValueErrors. True: always copy
    spacing      distance between voxels in mm, or as a text with a unit ("12um"): one, or x, y, z; default 1
    origin       world point of the first voxel; default 0, 0, 0
    affine       3 x 4 or 4 x 4, (x, y, z, 1) of an index to the world; in place of both
    coordinates  three rising sequences of the places of planes along x, y, z, in place of
                 spacing: a rectilinear grid
    slope, intercept  value = slope * voxel + intercept; isovalues are in this unit
    nodata       voxels equal to this, before scaling, are outside the domain, as NaN is
    level_set    values are distances, negative inside: functions then take low values as inside

    ids are the numbers of labels for which voxels are places, as read_volume(of_labels=True) found
    them; empty: voxels are their own numbers.
    Values may change while no function uses the volume; shape and type may not.
    Raises Error (ARGUMENT) for an affine that cannot be inverted, and an empty array.
    """

    def __init__(
        self,
        array: Any,
        *,
        spacing: float | str | Sequence[float | str] | None = None,
        origin: Sequence[float] | None = None,
        affine: npt.ArrayLike | None = None,
        coordinates: Sequence[npt.ArrayLike] | None = None,
        slope: float = 1.0,
        intercept: float = 0.0,
        nodata: float | None = None,
        components: bool = False,
        steps: bool = False,
        level_set: bool = False,
        copy: bool | None = None,
    ) -> None:
        components, steps = take_flag("components", components), take_flag("steps", steps)
        voxels = take_voxels(array, 3 + components + steps, copy)
        struct = c.cw_volume(type=TYPES[voxels.dtype.str[1:]])
        place_voxels(struct, voxels, components, steps)
        place_frame(struct, spacing, origin, affine)
        self._coordinates = place_coordinates(struct, coordinates)
        struct.slope = take_number("slope", slope)
        struct.intercept = take_number("intercept", intercept)
        if struct.slope == 0:
            raise ValueError("slope is 0; another number was expected")
        if nodata is not None:
            struct.has_nodata, struct.nodata = True, take_number("nodata", nodata)
        if take_flag("level_set", level_set):
            struct.known = c.cw_known.CW_KNOWN_LEVEL_SET
        self._set(struct, voxels, voxels)
        self.labels: list[Label] = []
        self.format: str | None = None
        self.ids: list[int] = []

    @classmethod
    def _from_c(cls, owner: Owner[c.cw_volume]) -> Volume:
        """Returns a volume of what the library made."""
        volume = cls.__new__(cls)
        volume._coordinates = None
        volume._set(owner.struct, owner, None)
        volume.labels, volume.format, volume.ids = [], None, []
        return volume

    def _set(self, struct: c.cw_volume, owner: object, array: npt.NDArray[Any] | None) -> None:
        self._struct, self._owner, self._array = struct, owner, array
        self._resolved = c.cw_volume()
        call(lib.cw_volume_resolve, byref(struct), byref(self._resolved))

    @property
    def array(self) -> npt.NDArray[Any]:
        """The voxels, shared without a copy: the array given, or the memory of the reader.

        The shape is (z, y, x), with further axes for several components (last) and steps
        (first). An irregular grid has the shape (1, 1, samples). Raises TypeError for a sparse
        grid: dense() has its voxels.
        """
        if self.kind == "sparse":
            raise TypeError("a sparse grid has no array; dense() makes one")
        if self._array is None:
            v = self._resolved
            shape, strides = tuple(v.dim)[::-1], tuple(v.stride)[::-1]
            if v.components > 1:
                shape, strides = (*shape, v.components), (*strides, v.component_stride)
            if v.steps > 1:
                shape, strides = (v.steps, *shape), (v.step_stride, *strides)
            return lend_array(self._owner, v.data, KINDS[v.type], shape, strides)
        return self._array

    @property
    def shape(self) -> tuple[int, int, int]:
        """Voxels along z, y, x."""
        x, y, z = self._resolved.dim
        return z, y, x

    @property
    def components(self) -> int:
        """Values of each voxel."""
        return self._resolved.components

    @property
    def steps(self) -> int:
        """Number of time steps."""
        return self._resolved.steps

    @property
    def dtype(self) -> np.dtype[Any]:
        return np.dtype(KINDS[self._resolved.type])

    @property
    def kind(self) -> str:
        """'even', 'rectilinear', 'irregular' or 'sparse'."""
        v = self._struct
        return (
            "sparse" if v.sparse else "irregular" if v.cells else "rectilinear" if v.coordinates[0] else "even"
        )

    @property
    def spacing(self) -> tuple[float, float, float]:
        """Millimetres between voxels along x, y, z; on a rectilinear grid the mean."""
        out = (c_double * 3)()
        lib.cw_volume_spacing(byref(self._resolved), out)
        x, y, z = out
        return x, y, z

    @property
    def affine(self) -> npt.NDArray[np.float64]:
        """The 4 x 4 matrix from (x, y, z, 1) of an index to the world, a copy."""
        return np.vstack([np.array(self._resolved.affine), [0.0, 0.0, 0.0, 1.0]])

    @property
    def origin(self) -> tuple[float, float, float]:
        """World point at which the affine puts the index 0, 0, 0."""
        x, y, z = (row[3] for row in self._resolved.affine)
        return x, y, z

    @property
    def slope(self) -> float:
        return self._resolved.slope

    @property
    def intercept(self) -> float:
        return self._resolved.intercept

    @property
    def nodata(self) -> float | None:
        """The voxel that stands for no value, before scaling; None: there is none."""
        return self._resolved.nodata if self._resolved.has_nodata else None

    @property
    def level_set(self) -> bool:
        """True if values are distances from a surface, negative inside."""
        return bool(self._struct.known & c.cw_known.CW_KNOWN_LEVEL_SET)

    def world(self, index: Sequence[float]) -> tuple[float, float, float]:
        """Returns the world point of an index (x, y, z), which may have fractions."""
        out = (c_double * 3)()
        lib.cw_volume_to_world(byref(self._resolved), (c_double * 3)(*take_numbers("index", index, 3)), out)
        x, y, z = out
        return x, y, z

    def index(self, world: Sequence[float]) -> tuple[float, float, float]:
        """Returns the index (x, y, z) of a world point, with fractions."""
        out = (c_double * 3)()
        point = (c_double * 3)(*take_numbers("world", world, 3))
        call(lib.cw_volume_to_index, byref(self._resolved), point, out)
        x, y, z = out
        return x, y, z

    def sample(self, world: Sequence[float]) -> float:
        """Returns the value at a world point, trilinear; NaN outside of the domain."""
        point = (c_double * 3)(*take_numbers("world", world, 3))
        return float(lib.cw_volume_sample(byref(self._resolved), point))

    def statistics(
        self, bins: int = 256, *, component: int = 0, step: int = 0, threads: int = 0
    ) -> Statistics:
        """Computes range, histogram and Otsu's level of one component and step."""
        view = self._select(component, step)
        out = c.cw_statistics()
        count = take_count("bins", bins, 0, 2**24)
        call(lib.cw_volume_statistics, byref(view), count, take_threads(threads), byref(out))
        try:
            counts = np.array(out.bins[: out.bin_count] if out.bin_count else [], np.uint64)
            level = c_double()
            has_level = bool(out.bin_count) and lib.cw_statistics_otsu(byref(out), 1, byref(level))
            edges = out.min + out.bin_width * np.arange(len(counts) + 1, dtype=float)
            return Statistics(
                out.min, out.max, out.finite, out.not_finite, out.nodata, counts, edges,
                level.value if has_level else None,
            )  # fmt: skip
        finally:
            lib.cw_statistics_free(byref(out))

    def level(self, name: str, *, component: int = 0, step: int = 0, threads: int = 0) -> float:
        """Returns the isovalue that a name stands for; extract(volume, name) takes it, too.

        name  "otsu", between two classes of values [Otsu1979]; "dark", "medium" or "bright", between four
              [Liao2001]; "50%" or another share of the range; "bone", "skin", "soft", "lung" or "metal" of a CT in
              Hounsfield units
        Raises Error: ARGUMENT for another name, and for a tissue where values are not in Hounsfield units; EMPTY
        where no level parts the values.
        """
        level = c_double()
        view = self._select(component, step)
        call(lib.cw_volume_level, byref(view), take_text("name", name), take_threads(threads), byref(level))
        return level.value

    def dense(self, max_voxels: int = 2**32) -> Volume:
        """Copies the leaves and tiles of a sparse grid into a volume with an array.

        Raises Error: ARGUMENT for other grids, LIMIT for more voxels than that.
        """
        out = Owner(c.cw_volume(), lib.cw_volume_free)
        limit = take_count("max_voxels", max_voxels)
        call(lib.cw_volume_densify, byref(self._struct), limit, byref(out.struct))
        return Volume._from_c(out)

    def smooth(self, sigma: float | Sequence[float], *, threads: int = 0) -> Volume:
        """Smooths the first component and step with a Gaussian, into a new volume.

        The result is of floats: of 64 bits if the voxels have 32 or more, and are no f4.

        sigma   standard deviation in voxels: of all axes, or of x, y and z
        Raises  Error: UNSUPPORTED for grids that are not even
        """
        widths = (c_double * 3)(*take_axes("sigma", sigma))
        return self._filter(lib.cw_volume_gauss, widths, threads=threads)

    def median(self, radius: int = 1, *, threads: int = 0) -> Volume:
        """Replaces each value of the first component and step by the median of a cube of voxels.

        radius  1 to 3: cubes of 3, 5 or 7 voxels
        Raises  Error: UNSUPPORTED for grids that are not even
        """
        return self._filter(lib.cw_volume_median, take_count("radius", radius, 1, 3), threads=threads)

    def bilateral(
        self, sigma: float | Sequence[float] = 1, sigma_value: float = 0, *, threads: int = 0
    ) -> Volume:
        """Smooths the first component and step, and keeps edges: similar values weigh more.

        The result is of floats: of 64 bits if the voxels have 32 or more, and are no f4.

        sigma        standard deviation in voxels: of all axes, or of x, y and z; up to 4
        sigma_value  standard deviation of values; 0: 2.5 times the noise
        Raises       Error: UNSUPPORTED for grids that are not even
        """
        widths = (c_double * 3)(*take_axes("sigma", sigma))
        value = take_number("sigma_value", sigma_value)
        return self._filter(lib.cw_volume_bilateral, widths, value, threads=threads)

    def anisotropic(self, steps: int = 10, contrast: float = 0, *, threads: int = 0) -> Volume:
        """Smooths the first component and step by diffusion along edges and not across.

        The result is of floats: of 64 bits if the voxels have 32 or more, and are no f4.

        steps     1 to 100
        contrast  edges are steeper, in values a voxel; 0: half of the noise
        Raises    Error: UNSUPPORTED for grids that are not even
        """
        count, value = take_count("steps", steps, 1, 100), take_number("contrast", contrast)
        return self._filter(lib.cw_volume_aniso, count, value, threads=threads)

    def nlm(self, noise: float = 0, radius: int = 3, *, threads: int = 0) -> Volume:
        """Smooths the first component and step by non-local means: of voxels with similar surroundings.

        The result is of floats: of 64 bits if the voxels have 32 or more, and are no f4.

        noise   standard deviation of the noise; 0: as noise() estimates it
        radius  of the cube of voxels that are compared, 1 to 5
        Raises  Error: UNSUPPORTED for grids that are not even
        """
        value, count = take_number("noise", noise), take_count("radius", radius, 1, 5)
        return self._filter(lib.cw_volume_nlm, value, count, threads=threads)

    def noise(self, *, threads: int = 0) -> float:
        """Returns the estimated standard deviation of the noise of the first component and step.

        Raises  Error: UNSUPPORTED for grids that are not even
        """
        out = c_double()
        call(lib.cw_volume_noise, byref(self._struct), take_threads(threads), byref(out))
        return out.value

    def remove_table(self, *, threads: int = 0) -> Volume:
        """Removes the table of a CT in Hounsfield units, and what else lies beside the body.

        Raises  Error: EMPTY if nothing above -300 HU is thicker than 10 mm, UNSUPPORTED for grids
                that are not even
        """
        out, removed = Owner(c.cw_volume(), lib.cw_volume_free), c_double()
        desc = c.cw_filter_desc(threads=take_threads(threads))
        call(lib.cw_volume_remove_table, byref(self._struct), byref(desc), byref(out.struct), byref(removed))
        return Volume._from_c(out)

    def mask(self, mask: Any, level: float, inside: str = "above", *, threads: int = 0) -> Volume:
        """Makes voxels outside where a mask is 0; they become their mirror image at the level.

        mask    a Volume in any grid, or an array of shape (z, y, x) with voxels of 1 mm
        inside  'above' or 'below' the level
        Raises  Error: UNSUPPORTED for grids that are not even
        """
        other = take_volume(mask)
        return self._filter(
            lib.cw_volume_mask, byref(other._struct), byref(place_inside(level, inside)), threads=threads
        )

    def open(
        self, radius: float | Sequence[float], level: float, inside: str = "above", *, threads: int = 0
    ) -> Volume:
        """Removes from the inside what a ball does not fit into, such as thin bridges.

        radius  in voxels: of all axes, or of x, y and z; 0 to 250
        inside  'above' or 'below' the level
        Raises  Error: UNSUPPORTED for grids that are not even
        """
        radii = (c_double * 3)(*take_axes("radius", radius))
        return self._filter(lib.cw_volume_open, radii, byref(place_inside(level, inside)), threads=threads)

    def close(
        self, radius: float | Sequence[float], level: float, inside: str = "above", *, threads: int = 0
    ) -> Volume:
        """Fills of the outside what a ball does not fit into, such as cracks and pores.

        radius  in voxels: of all axes, or of x, y and z; 0 to 250
        inside  'above' or 'below' the level
        Raises  Error: UNSUPPORTED for grids that are not even
        """
        radii = (c_double * 3)(*take_axes("radius", radius))
        return self._filter(lib.cw_volume_close, radii, byref(place_inside(level, inside)), threads=threads)

    def crop_to(
        self, level: float, inside: str = "above", margin: int = 2, *, threads: int = 0
    ) -> Volume:
        """Returns a view of the box around what is inside, in the same place of the world.

        inside  'above' or 'below' the level
        margin  voxels to add at each side, as far as there are any
        Raises  Error: EMPTY if nothing is inside, UNSUPPORTED for irregular and sparse grids
        """
        box, count = c.cw_box(), take_count("margin", margin)
        out = Owner(c.cw_volume(), lib.cw_volume_free)
        values = place_inside(level, inside)
        call(lib.cw_volume_inside_box, byref(self._resolved), byref(values), count, take_threads(threads), byref(box))
        call(lib.cw_volume_crop, byref(self._resolved), byref(box), byref(out.struct))
        view = Volume._from_c(out)
        view._owner = (out, self)  # whose memory it shows
        return view

    def resample(
        self, spacing: float | str | Sequence[float | str], kernel: str = "linear", *, threads: int = 0
    ) -> Volume:
        """Samples the first component and step at other distances, into a new volume.

        The result is of floats: of 64 bits if the voxels have 32 or more, and are no f4.

        spacing  between voxels, in mm or as a text with a unit ("0.5mm"): of all axes, or of x, y and z; 0 leaves an axis
        kernel   linear, cubic or lanczos
        Raises   Error: UNSUPPORTED for irregular and sparse grids, and rectilinear ones if the
                 kernel is not linear
        """
        if kernel not in KERNELS:
            raise ValueError(f"kernel is {kernel!r}; one of {', '.join(KERNELS)} was expected")
        distances = (c_double * 3)(*take_lengths("spacing", spacing))
        return self._filter(
            lib.cw_volume_resample, distances, KERNELS.index(kernel), threads=threads
        )

    def __len__(self) -> int:
        """Returns the number of slices, as of the array of one component and step."""
        return self.shape[0]

    def _planes(self) -> list[npt.NDArray[np.float64]] | None:
        """Returns copies of the coordinates of a rectilinear grid, which its affine takes to the world."""
        if self.kind != "rectilinear":
            return None
        return [np.array(planes[:count]) for planes, count in zip(self._struct.coordinates, self._resolved.dim)]

    def __reduce__(self) -> Any:
        """Pickles, and deep-copies, the voxels and their place."""
        if self.kind not in ("even", "rectilinear"):
            raise TypeError(f"a volume of the kind {self.kind} cannot be pickled; dense() of a sparse grid can")
        v = self._resolved
        state = {
            "array": np.ascontiguousarray(self.array),
            "affine": self.affine,
            "coordinates": self._planes(),
            "slope": self.slope,
            "intercept": self.intercept,
            "nodata": self.nodata,
            "components": v.components > 1,
            "steps": v.steps > 1,
        }
        kept = {"known": self._struct.known, "labels": self.labels, "format": self.format, "ids": self.ids}
        return restore_volume, (state, kept)

    def _repr_png_(self) -> bytes | None:
        """Returns a picture for notebooks: the middle slices."""
        from ._notebook import draw_volume

        return draw_volume(self)

    def _repr_html_(self) -> str:
        """Returns the picture and the facts, for notebooks."""
        from ._notebook import describe_volume

        return describe_volume(self)

    def _filter(self, function: Any, *arguments: Any, threads: int) -> Volume:
        out = Owner(c.cw_volume(), lib.cw_volume_free)
        desc = c.cw_filter_desc(threads=take_threads(threads))
        call(function, byref(self._struct), *arguments, byref(desc), byref(out.struct))
        return Volume._from_c(out)

    def _select(self, component: int, step: int) -> c.cw_volume:
        """Returns a view of one component and step; valid as long as self."""
        out = c.cw_volume()
        component = take_count("component", component, 0, 2**62)
        call(lib.cw_volume_select, byref(self._struct), component, take_count("step", step, 0, 2**62), byref(out))
        return out

    def __array__(self, dtype: npt.DTypeLike = None, copy: bool | None = None) -> npt.NDArray[Any]:
        if copy:
            return np.array(self.array, dtype)
        return self.array if dtype is None else self.array.astype(dtype, copy=False)

    def __repr__(self) -> str:
        spacing = " x ".join(f"{s:g}" for s in self.spacing)
        more = f", {self.components} components" if self.components > 1 else ""
        more += f", {self.steps} steps" if self.steps > 1 else ""
        return f"<cubewright.Volume (z, y, x) {self.shape} {self.dtype}{more}, {spacing} mm, {self.kind}>"


def restore_volume(state: dict[str, Any], kept: dict[str, Any]) -> Volume:
    """Makes a volume of what was pickled."""
    volume = Volume(**state)
    volume._struct.known = kept["known"]
    volume._set(volume._struct, volume._owner, volume._array)
    volume.labels, volume.format, volume.ids = kept["labels"], kept["format"], kept["ids"]
    return volume


def place_inside(level: float, inside: str) -> c.cw_inside:
    low = take_choice("inside", inside, ("above", "below")) == 1
    return c.cw_inside(level=take_number("level", level), inside_is_low=low)


def take_axes(name: str, value: Any) -> list[float]:
    """Returns three numbers: those of a sequence, or one for all axes."""
    return take_numbers(name, [value] * 3 if np.ndim(value) == 0 else value, 3)


def convert_voxels(voxels: npt.NDArray[Any], copy: bool | None) -> npt.NDArray[Any]:
    """Returns a copy of another type that holds each value: of float16, and of integers that fit 32 bits."""
    kind = None
    advice = "array.astype('f4')"
    if voxels.dtype == np.float16:
        kind = "f4"
    elif voxels.dtype.kind in "iu":
        low, high = (int(voxels.min()), int(voxels.max())) if voxels.size else (0, 0)
        kind = next((k for k in ("i4", "u4") if np.iinfo(k).min <= low and high <= np.iinfo(k).max), None)
        advice = "array.astype('f8'), exact up to 2**53, or extract_labels() where they are labels"
        if kind is None:
            raise TypeError(f"voxels are {low} to {high}, which 32 bits do not hold; {advice}")
    elif voxels.dtype.kind == "c":
        advice = "abs(array), array.real or array.imag"
    if kind is None:
        raise TypeError(
            f"voxels of type {voxels.dtype} are not taken; expected bool, integers, or floats of up to 64 bits: {advice}"
        )
    if copy is False:
        raise ValueError(f"voxels of type {voxels.dtype} need a copy: array.astype('{kind}')")
    return voxels.astype(kind)


def take_voxels(array: Any, axes: int, copy: bool | None) -> npt.NDArray[Any]:
    """Returns an array that the library can address; a copy only where it has to be one."""
    if isinstance(array, np.ma.MaskedArray):
        raise TypeError("a masked array is not a volume; use array.filled(value) with nodata=value")
    voxels = np.asarray(array)
    if voxels.dtype == np.bool_:
        voxels = voxels.view(np.uint8)
    if voxels.dtype.str[1:] not in TYPES:
        voxels = convert_voxels(voxels, copy)
    if voxels.ndim != axes:
        shape = "z, y, x" if axes == 3 else "z, y, x with components, steps or both"
        raise ValueError(f"the array has {voxels.ndim} axes; {axes} were expected ({shape})")
    if copy is not None and not isinstance(copy, bool):
        raise TypeError(f"copy must be True, False or None, not {type(copy).__name__}")
    repeats = any(s == 0 and n > 1 for s, n in zip(voxels.strides, voxels.shape))
    usable = voxels.dtype.isnative and voxels.flags.aligned and not repeats
    if not usable and copy is False:
        raise ValueError("the array is byte-swapped, not aligned, or repeats memory: it needs a copy")
    if copy or not usable:
        return np.array(voxels, voxels.dtype.newbyteorder("="), order="C")
    return voxels


def place_voxels(struct: c.cw_volume, voxels: npt.NDArray[Any], components: bool, steps: bool) -> None:
    """Describes the memory of an array: address, numbers of voxels, strides."""
    shape, strides = list(voxels.shape), list(voxels.strides)
    if 0 in shape:
        raise ValueError(f"the array is empty: its shape is {voxels.shape}")
    # NumPy's stride along an axis of one voxel means nothing, and 0 means a default to C.
    strides = [s if n > 1 else voxels.itemsize for s, n in zip(strides, shape)]
    if steps:
        struct.steps, struct.step_stride = shape.pop(0), strides.pop(0)
    if components:
        struct.components, struct.component_stride = shape.pop(), strides.pop()
    struct.data = c_void_p(voxels.ctypes.data)
    struct.dim[:], struct.stride[:] = shape[::-1], strides[::-1]


def place_frame(struct: c.cw_volume, spacing: Any, origin: Any, affine: Any) -> None:
    if affine is not None:
        if spacing is not None or origin is not None:
            raise TypeError("affine is in place of spacing and origin: give one or the other")
        matrix = np.asarray(affine, float)
        if matrix.shape not in ((3, 4), (4, 4)):
            raise ValueError(f"affine has the shape {matrix.shape}; (3, 4) or (4, 4) was expected")
        if matrix.shape == (4, 4) and not np.array_equal(matrix[3], [0, 0, 0, 1]):
            raise ValueError("the last row of affine is not 0, 0, 0, 1")
    else:
        widths = [1.0] * 3 if spacing is None else take_spacing(spacing)
        start = [0.0] * 3 if origin is None else take_numbers("origin", origin, 3)
        matrix = np.column_stack([np.diag(widths), start])
    struct.affine = AFFINE()
    for row, numbers in zip(struct.affine, matrix.tolist()):
        row[:] = numbers


def take_spacing(spacing: Any) -> list[float]:
    """Returns three lengths above 0; one number stands for all."""
    widths = take_lengths("spacing", spacing)
    if min(widths) <= 0:
        raise ValueError(f"spacing is {widths}; lengths above 0 mm were expected")
    return widths


def place_coordinates(struct: c.cw_volume, coordinates: Any) -> Any:
    """Sets the planes of a rectilinear grid; returns what holds their memory."""
    if coordinates is None:
        return None
    planes = [np.ascontiguousarray(each, float) for each in coordinates]
    if [each.shape for each in planes] != [(n,) for n in struct.dim]:
        raise ValueError(
            f"coordinates have the shapes {[each.shape for each in planes]}; x, y and z with "
            f"{', '.join(str(n) for n in struct.dim)} numbers were expected"
        )
    for axis, each in enumerate(planes):
        struct.coordinates[axis] = each.ctypes.data_as(type(struct.coordinates[axis]))
    return planes


def take_ids(ids: c.cw_label_ids) -> list[int]:
    """Copies the numbers of labels."""
    kept: list[int] = list(ids.ids[: ids.count]) if ids.count else []
    return [number % 2**64 for number in kept] if ids.is_unsigned else kept


def number_labels(volume: Any) -> Volume:
    """Returns a volume of labels: integers of 64 bits, and those below 0, become places in its ids."""
    if isinstance(volume, Volume):
        return volume
    array = np.asarray(volume)
    wide = array.dtype.kind in "iu" and array.dtype.itemsize == 8
    if not wide and not (array.dtype.kind == "i" and array.size and array.min() < 0):
        return take_volume(volume)
    values = np.ascontiguousarray(array, "u8" if array.dtype.kind == "u" else "i8")
    numbers, ids = np.empty(array.shape, "u4"), c.cw_label_ids()
    call(
        lib.cw_labels_renumber,
        values.ctypes.data_as(POINTER(c_int64)),
        array.dtype.kind == "u",
        values.size,
        numbers.ctypes.data_as(POINTER(c_uint32)),
        byref(ids),
    )
    made = Volume(numbers)
    made.ids = take_ids(ids)
    lib.cw_label_ids_free(byref(ids))
    return made


def take_volume(volume: Any) -> Volume:
    """Returns a volume; an array is one of voxels of 1 mm."""
    return volume if isinstance(volume, Volume) else Volume(volume)


__all__ = ["Label", "Statistics", "Volume"]
