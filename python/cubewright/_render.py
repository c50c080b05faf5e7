"""Pictures of meshes and volumes."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from ctypes import POINTER, byref, c_double, c_size_t, c_uint8, pointer, string_at
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from . import _declarations as c
from ._errors import Error, Status, call
from ._library import lib
from ._memory import Owner, find_address, lend_array
from ._mesh import Mesh, take_mesh
from ._options import (
    take_choice,
    take_count,
    take_flag,
    take_number,
    take_numbers,
    take_path,
    take_text,
    take_threads,
)
from ._progress import Progress, Reporter
from ._streams import Path
from ._volume import Volume, take_volume

MODES = tuple(lib.cw_mode_name(mode).decode() for mode in range(c.cw_mode.CW_MODE_COUNT))
BACKENDS = ("auto", "egl", "cpu")
MARGIN = 0.04  # of the picture on each side, as the command leaves
TRANSFER_BINS = 4096

Camera = Union[str, Mapping[str, Any], Sequence[float]]


def find_box(volume: Volume | None, mesh: Mesh | None) -> npt.NDArray[np.float64]:
    """Returns the lowest and highest world coordinates of what is drawn."""
    points = [mesh.bounds] if mesh is not None and len(mesh.vertices) else []
    if volume is not None:
        corners = (c_double * 3 * 8)()
        lib.cw_volume_corners(byref(volume._resolved), corners)
        points.append(np.array(corners))
    if not points:
        raise Error(Status.ARGUMENT, "the mesh has no vertices: nothing to draw")
    every = np.concatenate(points)
    return np.array([every.min(axis=0), every.max(axis=0)])


def make_camera(camera: Camera, box: npt.NDArray[np.float64], aspect: float, fov: float, zoom: float) -> c.cw_camera:
    """Returns the camera that a view, two angles or a dict stands for."""
    made = c.cw_camera()
    if isinstance(camera, Mapping):
        fields = {"schema": "cubewright-camera-1", **camera}
        call(lib.cw_camera_parse, json.dumps(fields, default=list).encode(), byref(made))
    else:
        fit = c.cw_fit_desc(aspect=aspect, fov_deg=fov, margin=MARGIN)
        fit.min[:], fit.max[:] = (list(map(float, corner)) for corner in box)
        if isinstance(camera, str):
            fit.view = take_text("camera", camera)
        else:
            fit.azimuth_deg, fit.elevation_deg = take_numbers("camera", camera, 2)
        call(lib.cw_camera_fit, byref(fit), byref(made))
    call(lib.cw_camera_zoom, byref(made), zoom)
    return made


def make_transfer(tf: Any, view: c.cw_volume, mode: str, threads: int) -> c.cw_transfer:
    """Returns the transfer function of a preset's name, a .json file or a dict."""
    made = c.cw_transfer()
    if isinstance(tf, Mapping):
        text = json.dumps({"schema": "cubewright-transfer-1", **tf}, default=list)
        call(lib.cw_transfer_parse, text.encode(), byref(made))
        return made
    if tf is None:
        presets = {"mip": "mip", "local-mip": "mip", "average": "xray", "minip": "xray", "slices": "window"}
        tf = presets.get(mode, "level-set" if view.known & c.cw_known.CW_KNOWN_LEVEL_SET else "auto")
    if isinstance(tf, os.PathLike) or (isinstance(tf, str) and tf.endswith(".json")):
        call(lib.cw_transfer_read, take_path("tf", tf), byref(made))
        return made
    statistics = c.cw_statistics()
    call(lib.cw_volume_statistics, byref(view), TRANSFER_BINS, threads, byref(statistics))
    try:
        call(lib.cw_transfer_preset, take_text("tf", tf), byref(statistics), byref(made))
    finally:
        lib.cw_statistics_free(byref(statistics))
    return made


def make_background(background: Any) -> Any:
    """Returns two colours, sRGB and alpha 0 to 255; one colour stands for both."""
    colors = np.asarray(background)
    if colors.ndim == 1:
        colors = np.stack([colors, colors])
    if colors.shape not in ((2, 3), (2, 4)) or colors.dtype.kind not in "iu":
        raise ValueError("background must be one or two colours of 3 or 4 whole numbers, 0 to 255")
    if colors.min() < 0 or colors.max() > 255:
        raise ValueError("background has a number that is not 0 to 255")
    if colors.shape[1] == 3:
        colors = np.column_stack([colors, [255, 255]])
    return (c_uint8 * 4 * 2)(*((c_uint8 * 4)(*map(int, row)) for row in colors))


def render(
    what: Union[Mesh, Volume, npt.NDArray[Any]],
    *,
    mode: str = "auto",
    mesh: Mesh | None = None,
    camera: Camera = "front",
    size: tuple[int, int] = (1280, 720),
    fov: float = 30.0,
    ortho: bool = False,
    zoom: float = 1.0,
    samples: int = 0,
    tf: str | Path | Mapping[str, Any] | None = None,
    lit: bool = True,
    step_length: float = 0.0,
    background: Any = ((51, 56, 66), (20, 22, 26)),
    backend: str = "auto",
    component: int = 0,
    step: int = 0,
    threads: int = 0,
    progress: Progress = None,
) -> npt.NDArray[np.uint8]:
    """Draws a mesh or a volume. Returns (height, width, 4) uint8, sRGB and alpha, top row first.

    what        a Mesh, a Volume, or an array of shape (z, y, x)
    mode        of a volume: 'composite' (auto), 'mip', 'minip', 'average', 'local-mip', 'slices',
                'vbuffer', 'reference' and others of `cubewright help render`; 'mesh' for meshes
    mesh        a mesh to draw in the volume
    camera      'front', 'back', 'left', 'right', 'top', 'bottom', 'iso'; azimuth and elevation
                in degrees; or a dict with eye, target, up, fov_deg and height_mm
    size        width and height in pixels
    fov         degrees from top to bottom; ortho: parallel projection in its place
    samples     1 to 4 squared for each pixel; 0: 2 for meshes, else 1
    tf          transfer function: a preset's name, a .json file, or a dict as in such a file
    lit         shade volumes by their gradient
    step_length of rays, in units of the smallest spacing; 0: 1
    background  one or two colours (top, bottom) of 0 to 255; with alpha 0: transparent
    backend     'auto', 'egl' (OpenGL without a display) or 'cpu'

    The memory of the picture is the library's, without a copy. Raises Error: ARGUMENT,
    UNSUPPORTED (no OpenGL for a mode that needs it), BACKEND, LIMIT, NO_MEMORY, CANCELLED.
    """
    width, height = (take_count("size", n, 1, 16384) for n in size)
    number = take_choice("mode", mode, ("auto", *MODES)) - 1
    where = take_choice("backend", backend, BACKENDS)
    angle = 0.0 if take_flag("ortho", ortho) else take_number("fov", fov)
    is_mesh = isinstance(what, Mesh)
    if is_mesh and (number > 0 or mesh is not None):
        raise TypeError("a mesh is drawn in mode 'mesh'; draw it in a volume by render(volume, mesh=...)")
    if not is_mesh and number == 0:
        raise TypeError("mode 'mesh' draws a Mesh; extract() makes one of a volume")
    volume = None if isinstance(what, Mesh) else take_volume(what)
    shown = what if isinstance(what, Mesh) else mesh
    if shown is not None:
        take_mesh("mesh", shown)
    box = find_box(volume, shown)
    eye = make_camera(camera, box, width / height, angle, take_number("zoom", zoom))
    colors = make_background(background)
    count = take_count("samples", samples, 0, 4)
    image = Owner(c.cw_image(), lib.cw_image_free)
    if volume is None:
        desc = c.cw_render_mesh_desc(camera=eye, width=width, height=height, samples=count)
        desc.background, desc.threads = colors, take_threads(threads)
        reporter = Reporter(progress)
        desc.progress = reporter.struct
        mesh_struct = take_mesh("mesh", shown)
        reporter.call(lib.cw_render_mesh, byref(mesh_struct), byref(desc), byref(image.struct))
        return lend_image(image)
    mode = "composite" if number < 0 else mode
    if number < 0 and volume.kind != "even":
        mode = "vbuffer"
    view = volume._select(component, step)
    transfer = make_transfer(tf, view, mode, take_threads(threads))
    scene = c.cw_scene(
        mode=MODES.index(mode),
        volume=pointer(view),
        transfer=pointer(transfer),
        camera=eye,
        width=width,
        height=height,
        samples=count,
        lit=take_flag("lit", lit) and not lib.cw_mode_is_intensity(MODES.index(mode)),
        sampling=c.cw_sampling(step_vox=take_number("step_length", step_length)),
        threads=take_threads(threads),
    )
    for row, color in zip(scene.background, colors):
        row[:] = [each / 255 for each in color[:3]]
    if shown is not None:
        scene.mesh = pointer(shown._struct)
    draw_scene(scene, where, colors, image.struct, progress)
    return lend_image(image)


def draw_scene(scene: c.cw_scene, backend: int, colors: Any, image: c.cw_image, progress: Progress) -> None:
    renderer, picture = POINTER(c.cw_renderer)(), c.cw_picture()
    reporter = Reporter(progress)
    scene.progress = reporter.struct
    call(lib.cw_renderer_new, backend, byref(renderer))
    try:
        reporter.call(lib.cw_render, renderer, byref(scene), byref(picture))
        call(lib.cw_picture_show, byref(picture), colors, byref(image))
    finally:
        lib.cw_picture_free(byref(picture))
        lib.cw_renderer_free(renderer)


def lend_image(owner: Owner[c.cw_image]) -> npt.NDArray[np.uint8]:
    image = owner.struct
    return lend_array(owner, find_address(image.pixels), "u1", (image.height, image.width, 4))


def copy_image(image: c.cw_image) -> npt.NDArray[np.uint8]:
    """Returns the pixels of a picture that the library keeps."""
    shape = (image.height, image.width, 4)
    return np.ctypeslib.as_array(image.pixels, shape).copy()


def write_png(path: Path, picture: npt.NDArray[np.uint8]) -> None:
    """Writes a picture of (height, width, 4) or (height, width, 3) uint8 as a PNG."""
    image, _pixels = borrow_image(picture)
    call(lib.cw_image_write, take_path("path", path), byref(image))


def make_png(picture: npt.NDArray[np.uint8], is_color: bool = True) -> bytes:
    """Returns the bytes of a PNG file. is_color: it is tagged as sRGB."""
    image, _pixels = borrow_image(picture)
    data, size = POINTER(c_uint8)(), c_size_t()
    call(lib.cw_image_encode, byref(image), is_color, byref(data), byref(size))
    try:
        return string_at(data, size.value)
    finally:
        lib.cw_bytes_free(data)


def borrow_image(picture: npt.NDArray[np.uint8]) -> tuple[c.cw_image, npt.NDArray[np.uint8]]:
    """Returns a struct of a picture, and the array whose memory it has."""
    pixels = np.asarray(picture)
    if pixels.dtype != np.uint8 or pixels.ndim != 3 or pixels.shape[2] not in (3, 4):
        raise ValueError(
            f"a picture of (height, width, 4) uint8 was expected, not {pixels.shape} {pixels.dtype}"
        )
    if pixels.shape[2] == 3:
        pixels = np.concatenate([pixels, np.full((*pixels.shape[:2], 1), 255, np.uint8)], axis=2)
    pixels = np.ascontiguousarray(pixels)
    image = c.cw_image(width=pixels.shape[1], height=pixels.shape[0])
    image.pixels = pixels.ctypes.data_as(POINTER(c_uint8))
    return image, pixels
