"""Facts on the library: version, formats, features; and synthetic volumes to try it with."""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import byref, c_int, c_size_t
from dataclasses import dataclass

from . import _declarations as c
from ._library import lib
from ._memory import Owner
from ._options import take_choice, take_count, take_number, take_text, take_threads
from ._progress import Progress, Reporter
from ._volume import Volume

TYPE_NAMES = tuple(lib.cw_type_name(kind).decode() for kind in range(c.cw_type.CW_TYPE_COUNT))


@dataclass(frozen=True)
class Format:
    """A file format. available: in this build; else reason says why not."""

    name: str
    extensions: tuple[str, ...]
    about: str
    reads_volume: bool
    writes_volume: bool
    reads_mesh: bool
    writes_mesh: bool
    available: bool
    reason: str
    lost: str


@dataclass(frozen=True)
class Feature:
    """An optional part of the library. Without it, calls that need it raise Error (UNSUPPORTED)."""

    name: str
    about: str
    available: bool
    reason: str


def formats() -> list[Format]:
    """Returns all formats, also those that this build lacks."""
    count = c_size_t()
    rows = lib.cw_formats(byref(count))
    return [
        Format(
            r.name.decode(),
            tuple(r.extensions.decode().split()),
            r.about.decode(),
            r.reads_volume,
            r.writes_volume,
            r.reads_mesh,
            r.writes_mesh,
            r.in_this_build,
            r.reason.decode(),
            r.lost.decode(),
        )
        for r in rows[: count.value]
    ]


def features() -> dict[str, Feature]:
    """Returns the optional parts by their names, also those that this build lacks."""
    count = c_size_t()
    rows = lib.cw_features(byref(count))
    found = [Feature(r.name.decode(), r.about.decode(), r.available, r.reason.decode()) for r in rows[: count.value]]
    return {feature.name: feature for feature in found}


def make(
    field: str,
    *,
    dims: int | Sequence[int] = 64,
    type: str = "f32",
    noise: float = 0.0,
    seed: int = 0,
    labels: int = 100,
    threads: int = 0,
    progress: Progress = None,
) -> Volume:
    """Samples a field with a known surface into a new volume, centred on the world's zero.

    field   'sphere' (radius 30 mm), 'torus', 'plane', 'gyroid', 'marschner-lobb', 'ct-head'; or a
            label map, 'labels/cells' or 'labels/spheres', with a type that holds the labels
    dims    voxels along x, y, z, or one number for all
    type    'u8', 'i8', 'u16', 'i16', 'u32', 'i32', 'f32' or 'f64'
    noise   standard deviation of Gaussian noise, in the field's unit
    """
    sizes = [dims] * 3 if isinstance(dims, int) else list(dims)
    if len(sizes) != 3:
        raise ValueError(f"dims has {len(sizes)} numbers; 3 were expected")
    sizes = [take_count("dims", n, 1, 2**20) for n in sizes]
    kind = take_choice("type", type, TYPE_NAMES)
    reporter = Reporter(progress)
    out, number = Owner(c.cw_volume(), lib.cw_volume_free), c_int()
    if take_text("field", field) in (b"labels/cells", b"labels/spheres"):
        cells = c.cw_label_field_desc(field=int(field == "labels/spheres"), labels=take_count("labels", labels, 1))
        cells.dim[:], cells.type, cells.seed = sizes, kind, take_count("seed", seed)
        cells.threads, cells.progress = take_threads(threads), reporter.struct
        reporter.call(lib.cw_label_field_sample, byref(cells), byref(out.struct))
        return Volume._from_c(out)
    if not lib.cw_field_find(take_text("field", field), byref(number)):
        names = [lib.cw_field_name(n).decode() for n in range(c.cw_field.CW_FIELD_COUNT)]
        raise ValueError(f"field is {field!r}; expected one of {', '.join(names)}, labels/cells, labels/spheres")
    desc = c.cw_field_desc(field=number.value, type=kind, noise=take_number("noise", noise))
    desc.dim[:], desc.seed = sizes, take_count("seed", seed)
    desc.threads, desc.progress = take_threads(threads), reporter.struct
    reporter.call(lib.cw_field_sample, byref(desc), byref(out.struct))
    return Volume._from_c(out)
