"""Meshes moved by affine maps, parted into solids, and with normals that part at creases."""

from __future__ import annotations

from ctypes import POINTER, byref, c_double, c_size_t

import numpy as np
import numpy.typing as npt

from . import _declarations as c
from ._errors import call
from ._library import lib
from ._mesh import Mesh, take_mesh
from ._options import take_degrees


def transform(mesh: Mesh, matrix: npt.ArrayLike) -> Mesh:
    """Returns a mesh moved by an affine map of the world: scaled, turned, mirrored, shifted.

    matrix  3 x 4 or 4 x 4, for columns: y = A x + t, LPS mm. Normals stay upright on the surface,
            and the outside stays outside where the map mirrors

    Raises Error: ARGUMENT (a determinant of 0, a number that is not finite).
    """
    take_mesh("mesh", mesh)
    rows = np.asarray(matrix, np.float64)
    if rows.shape == (4, 4) and np.array_equal(rows[3], (0, 0, 0, 1)):
        rows = rows[:3]
    if rows.shape != (3, 4):
        raise ValueError(f"matrix has the shape {rows.shape}; (3, 4) was expected, or (4, 4) that ends in 0, 0, 0, 1")
    moved = mesh.copy()
    call(lib.cw_mesh_transform, byref(moved._struct), (c_double * 12)(*rows.ravel()))
    return moved


def split(mesh: Mesh) -> list[Mesh]:
    """Returns the solids of a mesh, the largest first: components, cavities with what is around them.

    Vertices at equal positions count as one.

    Raises Error: ARGUMENT (the arrays make no mesh), LIMIT (2**32 / 3 triangles), NO_MEMORY.
    """
    solids, count = POINTER(c.cw_mesh)(), c_size_t()
    call(lib.cw_mesh_split, byref(take_mesh("mesh", mesh)), byref(solids), byref(count))
    try:
        return [Mesh._from_c(solids[n], owner=mesh).copy() for n in range(count.value)]
    finally:
        lib.cw_meshes_free(solids, count)


def crease_normals(mesh: Mesh, degrees: float) -> Mesh:
    """Returns a copy whose corners have normals of their own where creases part the triangles around a vertex.

    degrees  an edge between triangles whose directions differ by more is a crease

    They are mesh.attributes["corner_normals"], (3 m, 3) float32 [Max1999]; a mesh without creases has none.
    GLB, glTF and OBJ hold them. Vertices at equal positions count as different ones: weld() them first.
    Raises Error: ARGUMENT (the arrays make no mesh), LIMIT (2**32 / 3 triangles), NO_MEMORY.
    """
    take_mesh("mesh", mesh)
    parted = mesh.copy()
    call(lib.cw_mesh_crease_normals, byref(parted._struct), take_degrees("degrees", degrees), None, None)
    return parted


__all__ = ["crease_normals", "split", "transform"]
