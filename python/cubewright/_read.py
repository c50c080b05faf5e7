"""Reading of volumes and meshes from files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from ctypes import POINTER, byref, c_char_p, c_size_t, pointer, string_at
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _declarations as c
from ._errors import call, name_keywords
from ._library import lib
from ._memory import Owner, unpack
from ._mesh import Mesh
from ._options import (
    take_choice,
    take_count,
    take_flag,
    take_number,
    take_path,
    take_text,
)
from ._progress import Progress, Reporter
from ._streams import Path, Source, open_source
from ._volume import Label, Volume, take_ids, take_spacing

UNITS = ("mm", "um", "cm", "m", "in", "ft")

_NOTE: Any = dict(c.cw_read_desc._fields_)["note"]  # type: ignore[arg-type]


def make_claim(unit: str | None, frame: str | None, up: str | None, override: bool) -> c.cw_claim:
    """Returns the caller's statement on the coordinates of a file."""
    claim = c.cw_claim(rule=c.cw_claim_rule.CW_CLAIM_AGREE)
    if unit is not None:
        claim.has_unit, claim.axes.unit = True, take_choice("input_unit", unit, UNITS)
    if frame is not None:
        claim.has_frame = True
        claim.axes.ras = take_choice("input_frame", frame, ("lps", "ras")) == 1
    if up is not None:
        claim.has_up, claim.axes.y_up = True, take_choice("input_up", up, ("z", "y")) == 1
    if take_flag("input_override", override):
        claim.rule = c.cw_claim_rule.CW_CLAIM_OVERRIDE
    return claim


def make_box(crop: Any) -> c.cw_box:
    """Returns the box of the first and last voxels along x, y and z."""
    try:
        ends = [(take_count("crop", a), take_count("crop", b)) for a, b in crop]
    except (TypeError, ValueError) as error:
        raise type(error)(f"crop must be ((x, x), (y, y), (z, z)): {error}") from None
    if len(ends) != 3 or any(b < a for a, b in ends):
        raise ValueError(f"crop is {ends}; three pairs of first and last voxel were expected")
    box = c.cw_box()
    box.first[:] = [a for a, _ in ends]
    box.count[:] = [b - a + 1 for a, b in ends]
    return box


def take_label(row: c.cw_label) -> Label:
    """Copies a label."""
    name = string_at(row.name).decode("utf-8", "replace") if row.name else None
    red, green, blue, opacity = row.color
    number = (-row.id if row.is_negative else row.id) or row.value
    return Label(number, row.layer, name, (red, green, blue, opacity) if row.has_color else None)


def take_labels(table: c.cw_label_table) -> list[Label]:
    """Copies and frees a table of labels."""
    labels = [take_label(row) for row in (table.labels[: table.count] if table.count else [])]
    lib.cw_label_table_free(byref(table))
    return labels


def read_volume(
    path: Source,
    *,
    name: str | None = None,
    reader: str | None = None,
    raw: str | None = None,
    spacing: float | str | Sequence[float | str] | None = None,
    input_unit: str | None = None,
    input_frame: str | None = None,
    input_up: str | None = None,
    input_override: bool = False,
    series: str | None = None,
    array: str | None = None,
    level: int = 0,
    points: Path | None = None,
    gaps: str = "stop",
    tilt: str = "correct",
    skip_damaged: bool = False,
    nodata: float | str | None = None,
    of_labels: bool = False,
    round_labels: bool = False,
    crop: Sequence[Sequence[int]] | None = None,
    coarsen: int = 1,
    allow_external: bool = False,
    sandbox: bool = True,
    timeout: float = 60.0,
    max_voxels: int = 0,
    max_bytes: int = 0,
    note: Callable[[str], Any] | None = None,
    progress: Progress = None,
) -> Volume:
    """Reads a volume: every component and time step of a file, folder or pattern of slices.

    path may also be the bytes of a file, or a binary file object, which is read to its end. There are no
    files beside those: formats of several files are refused. A file object goes to a temporary file.

    name        file name of bytes or of a file object, such as 'scan.nrrd': its extension counts where
                content does not tell the format, and messages begin with it (file.name, '(memory)')

    Options are those of the command: `cubewright help extract` explains them.

    raw         layout of headerless voxels: 'dims=64x64x93,type=u16le,offset=0,spacing=1x1x2mm'
    spacing     between voxels, in mm or as texts with a unit, one or x, y, z, in place of the file's
    input_unit, input_frame, input_up  'mm' and others; 'lps' or 'ras'; 'z' or 'y': what the file
                does not say. An error if it says otherwise, unless input_override
    crop        ((x, x), (y, y), (z, z)): first and last voxels to read, ends included
    coarsen     every n-th voxel along each axis
    gaps, tilt  'stop', 'interpolate' or 'allow'; 'correct' or 'keep'
    skip_damaged  leave out slices whose files are damaged; what they leave are gaps
    nodata      value of voxels that have none; 'none': each has one, but NaN (as the file says)
    of_labels   values are numbers of labels: where some are below 0 or beyond 32 bits, voxels become
                places in the volume's ids. Else integers of 64 bits that do not fit are errors
    round_labels  with of_labels: the nearest whole numbers are taken
    max_voxels, max_bytes  limits; 0: 2**40 voxels, any bytes
    note        called with one line for each finding and decision of the reader
    progress    see Progress

    The array keeps the file's type; frame and scaling are in affine, slope and intercept. Names
    and colours of labels are in labels, the reader's name in format.
    Raises Error: IO, FORMAT, UNSAFE, UNSUPPORTED, BACKEND, LIMIT, NO_MEMORY, ARGUMENT, CANCELLED.
    """
    reporter = Reporter(progress)
    table = c.cw_label_table()
    desc = c.cw_read_desc(
        reader=take_text("reader", reader),
        series=take_text("series", series),
        array=take_text("array", array),
        level=take_count("level", level),
        points=None if points is None else take_path("points", points),
        gaps=take_choice("gaps", gaps, ("stop", "interpolate", "allow")),
        tilt=take_choice("tilt", tilt, ("correct", "keep")),
        skip_damaged=take_flag("skip_damaged", skip_damaged),
        allow_external=take_flag("allow_external", allow_external),
        no_sandbox=not take_flag("sandbox", sandbox),
        timeout_s=take_number("timeout", timeout),
        max_voxels=take_count("max_voxels", max_voxels),
        max_bytes=take_count("max_bytes", max_bytes),
        claim=make_claim(input_unit, input_frame, input_up, input_override),
        labels=pointer(table),
        progress=reporter.struct,
    )
    ids = c.cw_label_ids()
    if take_flag("of_labels", of_labels):
        desc.ids, desc.round_labels = pointer(ids), take_flag("round_labels", round_labels)
    if nodata is not None and nodata != "none":
        desc.nodata, desc.nodata_value = c.cw_nodata.CW_NODATA_VALUE, take_number("nodata", nodata)
    elif nodata is not None:
        desc.nodata = c.cw_nodata.CW_NODATA_NONE
    if raw is not None:
        layout = c.cw_raw_layout()
        call(lib.cw_raw_layout_parse, take_text("raw", raw), byref(layout))
        desc.raw = pointer(layout)
    if spacing is not None:
        desc.spacing_mm[:] = take_spacing(spacing)
    if crop is not None:
        desc.region = pointer(make_box(crop))
    desc.every[:] = [take_count("coarsen", coarsen, 1)] * 3
    if note is not None:
        if not callable(note):
            raise TypeError(f"note must be callable, not {type(note).__name__}")
        desc.note = _NOTE(lambda _user, text: note(name_keywords(text or b"")))
    out, form = Owner(c.cw_volume(), lib.cw_volume_free), c_char_p()
    try:
        with open_source(path, name, desc) as file:
            reporter.call(lib.cw_volume_read, file, byref(desc), byref(out.struct), byref(form))
        volume = Volume._from_c(out)
        volume.ids = take_ids(ids)
    finally:
        labels = take_labels(table)
        lib.cw_label_ids_free(byref(ids))
    volume.labels, volume.format = labels, form.value.decode() if form.value else None
    return volume


@dataclass(frozen=True)
class Part:
    """A mesh of a file with several, under its name. label has the colour that the file states for it.

    Other colours are those of mesh.colors and mesh.face_colors. normal_map is (height, width, 4) uint8, as
    bake_normals() makes it, in place of pictures["normal"]; glTF and OBJ hold it for a mesh with texture
    coordinates. pictures has the bytes of image files by their use: color, normal, metallic_roughness,
    occlusion, emissive. They are read and written as they are.

    level is the level of detail: level n + 1 is a coarser form of the part right before it, at level n; for glTF
    and Neuroglancer. time is that at which the part appears in place of the one before, in seconds: with times,
    glTF is animated.
    """

    name: str | None
    mesh: Mesh
    label: Label | None = None
    normal_map: npt.NDArray[np.uint8] | None = None
    pictures: dict[str, bytes] | None = None
    level: int = 0
    time: float | None = None


# In the order of cw_picture_use.
PICTURES = ("color", "normal", "metallic_roughness", "occlusion", "emissive")


def take_pictures(textures: c.cw_textures) -> dict[str, bytes]:
    found = {use: getattr(textures, use) for use in PICTURES}
    return {use: string_at(file.bytes, file.size) for use, file in found.items() if file.bytes}


def make_mesh_desc(options: dict[str, Any], reporter: Reporter) -> c.cw_mesh_read_desc:
    return c.cw_mesh_read_desc(
        reader=take_text("mesh_reader", options["mesh_reader"]),
        allow_external=take_flag("allow_external", options["allow_external"]),
        truncated=take_flag("truncated", options["truncated"]),
        max_triangles=take_count("max_triangles", options["max_triangles"]),
        max_bytes=take_count("max_bytes", options["max_bytes"]),
        no_sandbox=not take_flag("sandbox", options["sandbox"]),
        timeout_s=take_number("timeout", options["timeout"]),
        claim=make_claim(
            options["input_unit"], options["input_frame"], options["input_up"], options["input_override"]
        ),
        progress=reporter.struct,
    )


def read_mesh(
    path: Source,
    *,
    name: str | None = None,
    mesh_reader: str | None = None,
    input_unit: str | None = None,
    input_frame: str | None = None,
    input_up: str | None = None,
    input_override: bool = False,
    allow_external: bool = False,
    truncated: bool = False,
    sandbox: bool = True,
    timeout: float = 60.0,
    max_triangles: int = 0,
    max_bytes: int = 0,
    progress: Progress = None,
) -> Mesh:
    """Reads a mesh: all parts of a file, merged, in LPS millimetres.

    mesh_reader  a name of formats(); default: by content
    truncated    take the whole facets of an STL file that breaks off; else it is refused
    path may be bytes or a binary file object, as for read_volume(), with their name.
    Other options are those of read_volume(). Raises the same errors.

    mesh.facts tells the findings of the reader, such as "left_out": "material groups" and "not_applied".
    """
    options = dict(locals())
    reporter = Reporter(progress)
    desc, file = make_mesh_desc(options, reporter), c.cw_mesh_file()
    mesh = Mesh._from_c(c.cw_mesh())
    with open_source(path, name, desc) as target:
        reporter.call(lib.cw_mesh_read, target, byref(desc), byref(mesh._struct), byref(file))
    mesh.facts = unpack(file)
    return mesh


def read_parts(
    path: Source,
    *,
    name: str | None = None,
    mesh_reader: str | None = None,
    input_unit: str | None = None,
    input_frame: str | None = None,
    input_up: str | None = None,
    input_override: bool = False,
    allow_external: bool = False,
    truncated: bool = False,
    sandbox: bool = True,
    timeout: float = 60.0,
    max_triangles: int = 0,
    max_bytes: int = 0,
    progress: Progress = None,
) -> list[Part]:
    """Reads the parts of a file: objects of OBJ, solids of STL, items of 3MF, nodes of glTF.

    Other files have one part. Options and errors are those of read_mesh(); the facts of each mesh are
    those of the whole file. write() takes the list.
    """
    options = dict(locals())
    reporter = Reporter(progress)
    desc, file = make_mesh_desc(options, reporter), c.cw_mesh_file()
    rows, count = POINTER(c.cw_part)(), c_size_t()
    with open_source(path, name, desc) as target:
        reporter.call(lib.cw_parts_read, target, byref(desc), byref(rows), byref(count), byref(file))
    try:
        return [take_part(row, unpack(file)) for row in rows[: count.value]]
    finally:
        lib.cw_parts_free(rows, count)


def take_part(row: c.cw_part, facts: dict[str, Any]) -> Part:
    """Copies a part of the library."""
    mesh = Mesh._from_c(row.mesh[0], owner=row).copy()
    mesh.facts = facts
    name = string_at(row.name).decode("utf-8", "replace") if row.name else None
    pictures = take_pictures(row.textures[0]) if row.textures else None
    return Part(name, mesh, take_label(row.label[0]) if row.label else None, pictures=pictures)
