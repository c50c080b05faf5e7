"""Views: cameras for which a surface is simplified, and what none of them sees is left out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from ctypes import byref, c_double, pointer
from typing import Any

from . import _declarations as c
from ._errors import call
from ._library import lib
from ._memory import Owner
from ._options import take_count, take_degrees, take_flag, take_length, take_number
from ._render import find_box, make_camera
from ._volume import Volume

FOV = 30.0  # degrees, as of render()


def take_cameras(camera: Any) -> list[Any]:
    """Returns a list of cameras: of one, or of several."""
    one = isinstance(camera, (str, Mapping)) or (len(camera) == 2 and all(isinstance(x, (int, float)) for x in camera))
    return [camera] if one else list(camera)


def set_views(
    desc: c.cw_pipeline_desc,
    source: Volume,
    *,
    camera: Any,
    size: Sequence[int],
    pixel_error: float,
    shading: float,
    cull: bool,
    simplify: Any,
) -> None:
    """Sets the views of a pipeline. They are kept alive, and freed, by the descriptor."""
    width, height = (take_count("size", n, 1, 16384) for n in size)
    box = find_box(source, None)
    cameras = [make_camera(each, box, width / height, FOV, 1.0) for each in take_cameras(camera)]
    views = (c.cw_simplify_view * len(cameras))(*(c.cw_simplify_view(each, width, height) for each in cameras))
    desc.kept_views = [Owner(each, lib.cw_simplify_view_free) for each in views]
    desc.views, desc.view_count, desc.cull = views, len(views), take_flag("cull", cull)
    pixels = take_number("pixel_error", pixel_error)
    if not pixels:
        if not cull:
            raise TypeError("camera is for pixel_error, cull, or both: neither is given")
        return
    error = c_double()
    if simplify is None:  # as far as any view allows
        corners = (c_double * 3 * 8)()
        lib.cw_volume_corners(byref(source._resolved), corners)
        call(lib.cw_simplify_views_error, views, len(views), pixels, corners[0], 8, byref(error))
    else:
        error.value = take_length("simplify", simplify, volume=source)
    made = c.cw_simplify_desc(error_mm=error.value, view_count=len(views), pixel_error=pixels)
    made.views, made.normal_deg = views, take_degrees("shading", shading)
    desc.simplify = pointer(made)
