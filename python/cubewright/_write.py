"""Writing of meshes, parts and volumes to files, and of pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from ctypes import POINTER, byref, c_char, c_uint8, cast, create_string_buffer, pointer
from dataclasses import dataclass
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from . import _declarations as c
from ._library import lib
from ._mesh import Levels, Mesh, take_mesh
from ._options import take_choice, take_count, take_flag, take_length, take_number, take_text
from ._progress import Progress, Reporter
from ._read import PICTURES, UNITS, Part
from ._render import make_png
from ._streams import Target, open_target
from ._volume import Label, Volume

COMPRESSIONS = ("none", "quantize", "draco", "meshopt")


@dataclass(frozen=True)
class Written:
    """The loss of compression, measured on the decoded file; zeros without compression.

    error_mm  the largest move of a vertex; normal_degrees the largest turn of a normal
    bits      of a coordinate; step_mm the step of their grid
    """

    bits: int
    step_mm: float
    error_mm: float
    normal_degrees: float
    merged: int
    flat: int
    dropped: int


def make_write_desc(options: dict[str, Any], reporter: Reporter) -> c.cw_write_desc:
    desc = c.cw_write_desc(
        format=take_text("format", options["format"]),
        name=take_text("name", options["name"]),
        no_clobber=take_flag("no_clobber", options["no_clobber"]),
        local=take_flag("local", options["local"]),
        text=take_flag("ascii", options["ascii"]),
        compression=take_choice("compress", options["compress"], COMPRESSIONS),
        tolerance_mm=take_length("tolerance", options["tolerance"]),
        bits=take_count("bits", options["bits"], 0, 30),
        level=take_count("effort", options["effort"], 0, 10),
        progress=reporter.struct,
    )
    desc.axes.unit = take_choice("unit", options["unit"], UNITS)
    desc.axes.ras = take_choice("frame", options["frame"], ("lps", "ras")) == 1
    desc.axes.y_up = take_choice("up", options["up"], ("z", "y")) == 1
    return desc


def write(
    path: Target,
    what: Union[Mesh, Volume, Mapping[str, Mesh], Sequence[Part]],
    *,
    format: str | None = None,
    name: str | None = None,
    no_clobber: bool = False,
    local: bool = False,
    ascii: bool = False,
    unit: str = "mm",
    frame: str = "lps",
    up: str = "z",
    compress: str = "none",
    tolerance: float | str = 0.0,
    bits: int = 0,
    effort: int = 0,
    progress: Progress = None,
) -> Written:
    """Writes a mesh, several named meshes, or a volume, in the format of the path's suffix.

    path        or a binary file object, which gets the bytes of the file once all are made. Its format is
                that of its name, if it has one; formats of several files are refused
    what        a Mesh; a dict of names and meshes, or a list of Part, which has labels too (parts
                of a file, kept by glTF, OBJ, 3MF); Levels of detail (glTF); or a Volume (.nrrd, .nii, .nii.gz,
                .mha). Parts with times are an animation of glTF
    format      a name of formats(), in place of the suffix
    no_clobber  fail if the path exists; default: replace it. A file appears only when complete
    local       coordinates relative to the mesh's origin; default: world coordinates. glTF and
                3MF keep the origin apart and lose nothing
    unit, frame, up  of the coordinates in the file; glTF is always in metres, +Y up
    compress    of glTF: 'none', 'quantize', 'draco' or 'meshopt'; tolerance is the largest move
                of a vertex, mm (default 1/20,000 of the diagonal), bits a number in its place
    effort      effort of Draco, 1 to 10; 0: 7

    Of mesh.attributes glTF and OBJ hold texture_coordinates, and some formats face_colors; others are left
    out. A Part may have a normal_map and pictures, for glTF and OBJ.

    Raises Error: ARGUMENT, OUTPUT, UNSUPPORTED, LIMIT, CHECK, NO_MEMORY, CANCELLED.
    """
    options = {key: value for key, value in locals().items() if key not in ("path", "what", "progress")}
    reporter = Reporter(progress)
    desc = make_write_desc(options, reporter)
    result = c.cw_compressed()
    with open_target(path, desc) as target:
        write_to(target, what, desc, result, reporter)
    return summarize(result)


def write_to(target: bytes | None, what: Any, desc: Any, result: Any, reporter: Reporter) -> None:
    """Writes what there is to write to a path, or to the sink of desc."""
    if isinstance(what, Volume):
        if what.labels:
            rows = (c.cw_label * len(what.labels))(*(make_label(label) for label in what.labels))
            desc.labels = pointer(c.cw_label_table(count=len(rows), labels=rows))
        reporter.call(lib.cw_volume_write, target, byref(what._struct), byref(desc))
        return
    if desc.compression:
        desc.compressed = pointer(result)
    if isinstance(what, Mapping):
        what = [Part(title, mesh) for title, mesh in what.items()]
    if isinstance(what, Levels):
        picture = what.maps.get("normals")
        what = [Part(None, mesh, normal_map=picture, level=n) for n, mesh in enumerate(what)]
    if isinstance(what, Sequence) and not isinstance(what, (str, bytes)):
        parts = (c.cw_part * max(len(what), 1))()
        for part, given in zip(parts, what):
            fill_part(part, given)
        desc.animated = any(part.time is not None for part in what)
        reporter.call(lib.cw_parts_write, target, parts, len(what), byref(desc))
    elif isinstance(what, Mesh):
        reporter.call(lib.cw_mesh_write, target, byref(what._struct), byref(desc))
    else:
        raise TypeError(f"a Mesh, a dict of them or a Volume can be written, not a {type(what).__name__}")


def fill_part(part: c.cw_part, given: Part) -> None:
    if not isinstance(given, Part):
        raise TypeError(f"a list of Part can be written, not of {type(given).__name__}")
    part.mesh = pointer(take_mesh(f"the mesh of part {given.name!r}", given.mesh))
    part.name = take_text("a part's name", given.name)
    part.level = take_count("a part's level", given.level)
    part.time_s = 0.0 if given.time is None else take_number("a part's time", given.time)
    files = {use: borrow_bytes(use, data) for use, data in (given.pictures or {}).items()}
    if given.normal_map is not None:
        files["normal"] = encode_picture(given.normal_map)
    if files:
        part.textures = pointer(c.cw_textures(**files))
    if given.label is None:
        return
    part.label = pointer(make_label(given.label))


def make_label(given: Label) -> c.cw_label:
    label = c.cw_label(layer=given.layer)
    if not lib.cw_label_parse(str(int(given.value)).encode(), byref(label)):
        raise ValueError(f"a label's value is {given.value}; a whole number of up to 64 bits was expected")
    if given.name is not None:
        name = create_string_buffer(take_text("a label's name", given.name) or b"")
        label.name = cast(name, POINTER(c_char))
    if given.color is not None:
        label.has_color = True
        label.color[:] = given.color
    return label


def borrow_bytes(use: str, data: bytes) -> c.cw_texture:
    """Lends the bytes of an image file."""
    if use not in PICTURES:
        raise ValueError(f"a picture of {use!r}: expected one of {', '.join(PICTURES)}")
    kept = create_string_buffer(bytes(data), len(data))
    return c.cw_texture(bytes=cast(kept, POINTER(c_uint8)), size=len(data))


def encode_picture(picture: npt.NDArray[np.uint8]) -> c.cw_texture:
    """Makes a PNG of numbers, which are no colours, in memory of Python's."""
    data = make_png(picture, is_color=False)
    kept = create_string_buffer(data, len(data))
    return c.cw_texture(bytes=cast(kept, POINTER(c_uint8)), size=len(data))


def summarize(r: c.cw_compressed) -> Written:
    return Written(r.bits, r.step_mm, r.error_mm, r.normal_degrees, r.merged, r.flat, r.dropped)


