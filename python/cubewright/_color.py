"""Colours of meshes by the values of a volume."""

from __future__ import annotations

from ctypes import byref

import numpy as np

from . import _declarations as c
from ._errors import call
from ._library import lib
from ._mesh import Mesh, take_mesh
from ._options import take_choice, take_number, take_threads
from ._progress import Progress, Reporter
from ._volume import Volume, take_volume

COLORMAPS = ("viridis", "inferno", "cool-warm", "gray")


def color_by(
    mesh: Mesh,
    volume: Volume,
    *,
    colormap: str = "viridis",
    low: float | None = None,
    high: float | None = None,
    threads: int = 0,
    progress: Progress = None,
) -> Mesh:
    """Returns the mesh with the values of a volume as scalars, and colours of these.

    volume     any volume on a grid, in any frame; its first component and step
    colormap   'viridis', 'inferno', 'cool-warm' or 'gray'
    low, high  values of the ends of the map; None: those of the vertices

    Values are trilinear at the vertices' world points. Vertices outside of the volume get the
    lowest value of the others.
    Raises Error: ARGUMENT, UNSUPPORTED, EMPTY (no vertex is inside), NO_MEMORY, CANCELLED.
    """
    take_mesh("mesh", mesh)
    view = take_volume(volume)._select(0, 0)
    reporter = Reporter(progress)
    kind = take_choice("colormap", colormap, COLORMAPS)
    desc = c.cw_sample_desc(threads=take_threads(threads), progress=reporter.struct)
    scalars = np.empty(len(mesh.vertices), np.float32)
    colors = np.empty((len(mesh.vertices), 4), np.uint8)
    out = Mesh.from_arrays(
        mesh.vertices.copy(),
        mesh.triangles.copy(),
        normals=None if mesh.normals is None else mesh.normals.copy(),
        labels=None if mesh.labels is None else mesh.labels.copy(),
        scalars=scalars,
        colors=colors,
        origin=mesh.origin,
    )
    out._struct.affine = mesh._struct.affine
    facts = c.cw_sample_facts()
    reporter.call(lib.cw_mesh_sample, byref(out._struct), byref(view), byref(desc), byref(facts))
    ends = (
        facts.low if low is None else take_number("low", low),
        facts.high if high is None else take_number("high", high),
    )
    call(lib.cw_mesh_color, byref(out._struct), kind, *ends)
    return out
