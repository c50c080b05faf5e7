"""The orientation of a print with the least support."""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import byref
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from . import _declarations as c
from ._check import take_printer
from ._errors import call
from ._library import lib
from ._mesh import Mesh, take_mesh
from ._options import take_threads
from ._place import transform


@dataclass(frozen=True)
class Stand:
    """A way to stand on the plate. Lengths are in mm."""

    up: tuple[float, float, float]  # direction of the mesh that points up
    overhang_area: float
    height: float
    hull_area: float  # of the convex hull of what is on the plate
    tip_angle: float  # degrees at which it tips over; 0: it does so by itself


@dataclass(frozen=True)
class Oriented:
    """A mesh turned for printing, and both ways to stand."""

    mesh: Mesh  # the same one if it is kept
    matrix: npt.NDArray[np.float64]  # 3 x 4, for transform()
    before: Stand
    after: Stand
    kept: bool  # no other pose is better
    stable: bool  # it tips over at 5 degrees or more


def describe_stand(s: c.cw_print_stand) -> Stand:
    x, y, z = s.up
    return Stand((x, y, z), s.overhang_mm2, s.height_mm, s.hull_mm2, s.tip_deg)


def orient_print(
    mesh: Mesh,
    *,
    overhang: float = 0.0,
    layer: float | str = 0.0,
    plate: Sequence[float | str] | None = None,
    threads: int = 0,
) -> Oriented:
    """Turns a closed mesh to the pose that prints with the least support, then height, then with the widest base.

    overhang  degrees from the vertical that need no support; 0: 45
    layer     height of a layer; 0: 0.2 mm. What is lower lies on the plate
    plate     width, depth and height that can be printed; None: not looked at

    Poses that tip over below 5 degrees are left out if others stand.
    Raises Error: ARGUMENT, EMPTY (no triangles), LIMIT, NO_MEMORY.
    """
    source = take_mesh("mesh", mesh)
    desc = take_printer(0.0, 0.0, overhang, layer, plate)
    desc.threads = take_threads(threads)
    facts = c.cw_orient_facts()
    call(lib.cw_orient_print, byref(source), byref(desc), byref(facts))
    matrix = np.array(facts.matrix[:]).reshape(3, 4)
    return Oriented(
        mesh=mesh if facts.is_kept else transform(mesh, matrix),
        matrix=matrix,
        before=describe_stand(facts.before),
        after=describe_stand(facts.after),
        kept=facts.is_kept,
        stable=facts.is_stable,
    )
