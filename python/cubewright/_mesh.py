"""Meshes: vertices and triangles as arrays that share memory with the library."""

from __future__ import annotations

from ctypes import POINTER, byref, c_double, c_float, c_uint8, c_uint32
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _declarations as c
from ._attributes import Attributes
from ._errors import call
from ._library import lib
from ._memory import Owner, find_address, lend_array
from ._options import take_numbers

# The arrays of a mesh: field of the C struct, type, values of each vertex or triangle.
ARRAYS: dict[str, tuple[str, str, int, Any]] = {
    "vertices": ("positions", "f4", 3, c_float),
    "normals": ("normals", "f4", 3, c_float),
    "triangles": ("triangles", "u4", 3, c_uint32),
    "scalars": ("scalars", "f4", 1, c_float),
    "colors": ("colors", "u1", 4, c_uint8),
    "labels": ("labels", "u4", 1, c_uint32),
}


class Mesh:
    """Vertices, and triangles that share them.

    Arrays share memory with the library, without a copy, and keep it alive when the mesh is
    gone. Values may be written; shapes may not change.

    The world point of vertex v is origin + vertices[v], LPS millimetres. Vertices are relative to
    the origin, so that single precision keeps micrometres far from the scanner's zero: use
    world_vertices() where world coordinates matter. Triangles wind counter-clockwise seen from
    outside.

    The functions of this package make meshes; from_arrays() makes one of your own arrays.

    facts  of extract() and extract_levels(): a dict with the names of the stages that "ran", and
           the other fields of cw_pipeline_facts, such as "voids"; of read_mesh() and read_parts():
           the fields of cw_mesh_file, such as "left_out", "not_applied" and "invisible_names", which
           name the features of the file that the mesh lacks; {} for other meshes
    """

    facts: dict[str, Any]

    _struct: c.cw_mesh
    _owner: object
    _attributes: Attributes | None

    def __init__(self) -> None:
        raise TypeError("a mesh is made by extract(), read_mesh() or Mesh.from_arrays()")

    @classmethod
    def _from_c(cls, struct: c.cw_mesh, owner: object = None) -> Mesh:
        """Owns a mesh of the library, also one to be filled; with an owner, borrows from that."""
        mesh = cls.__new__(cls)
        mesh._struct = struct
        mesh._owner = Owner(struct, lib.cw_mesh_free) if owner is None else owner
        mesh._attributes = None
        mesh.facts = {}
        return mesh

    @classmethod
    def from_arrays(
        cls,
        vertices: npt.ArrayLike,
        triangles: npt.ArrayLike,
        *,
        normals: npt.ArrayLike | None = None,
        scalars: npt.ArrayLike | None = None,
        colors: npt.ArrayLike | None = None,
        labels: npt.ArrayLike | None = None,
        face_colors: npt.ArrayLike | None = None,
        origin: npt.ArrayLike = (0.0, 0.0, 0.0),
    ) -> Mesh:
        """Makes a mesh over arrays.

        Memory is shared with contiguous arrays of the types below. Others are converted: float64
        vertices are rounded to float32, so subtract an origin from large coordinates first.

        vertices   (n, 3) float32, relative to origin, millimetres
        triangles  (m, 3) uint32, each below n
        normals    (n, 3) float32, unit length, outward
        scalars    (n,) float32
        colors     (n, 4) uint8, sRGB and opacity
        labels     (n,) uint32
        face_colors  (m, 4) uint8, sRGB and opacity of triangles; copied
        Raises ValueError for a shape or an index out of range, Error (ARGUMENT) for a position
        that is not finite.
        """
        given: dict[str, npt.ArrayLike | None] = {"vertices": vertices, "triangles": triangles, "normals": normals}
        given.update(scalars=scalars, colors=colors, labels=labels)
        arrays = {name: take_array(name, value) for name, value in given.items() if value is not None}
        struct = c.cw_mesh(vertex_count=len(arrays["vertices"]), triangle_count=len(arrays["triangles"]))
        struct.origin[:] = take_numbers("origin", origin, 3)
        for name, array in arrays.items():
            field, _, _, kind = ARRAYS[name]
            if name != "triangles" and len(array) != struct.vertex_count:
                raise ValueError(f"{name} has {len(array)} rows for {struct.vertex_count} vertices")
            setattr(struct, field, array.ctypes.data_as(POINTER(kind)))
        call(lib.cw_mesh_check, byref(struct))
        mesh = cls._from_c(struct, arrays)
        mesh._color_faces(face_colors)
        return mesh

    def _array(self, name: str) -> npt.NDArray[Any] | None:
        if isinstance(self._owner, dict):  # of from_arrays()
            return self._owner.get(name)
        field, kind, width, _ = ARRAYS[name]
        address = find_address(getattr(self._struct, field))
        count = self._struct.triangle_count if name == "triangles" else self._struct.vertex_count
        if not address and (count or name not in ("vertices", "triangles")):
            return None
        return lend_array(self._owner, address, kind, (count, width) if width > 1 else (count,))

    @property
    def vertices(self) -> npt.NDArray[np.float32]:
        """(n, 3) positions relative to origin, millimetres."""
        array = self._array("vertices")
        return np.empty((0, 3), np.float32) if array is None else array

    @property
    def triangles(self) -> npt.NDArray[np.uint32]:
        """(m, 3) indices of vertices."""
        array = self._array("triangles")
        return np.empty((0, 3), np.uint32) if array is None else array

    @property
    def normals(self) -> npt.NDArray[np.float32] | None:
        """(n, 3) unit normals that point outward, or None."""
        return self._array("normals")

    @property
    def scalars(self) -> npt.NDArray[np.float32] | None:
        """(n,) values of vertices, or None."""
        return self._array("scalars")

    @property
    def colors(self) -> npt.NDArray[np.uint8] | None:
        """(n, 4) sRGB and opacity of vertices, or None."""
        return self._array("colors")

    @property
    def labels(self) -> npt.NDArray[np.uint32] | None:
        """(n,) labels of vertices, or None."""
        return self._array("labels")

    @property
    def face_colors(self) -> npt.NDArray[np.uint8] | None:
        """(m, 4) sRGB and opacity of triangles, or None.

        Setting them copies an array; None removes them. They are mesh.attributes["face_colors"].
        """
        return self.attributes.get("face_colors")

    @face_colors.setter
    def face_colors(self, values: npt.ArrayLike | None) -> None:
        self._color_faces(values)

    def _color_faces(self, values: npt.ArrayLike | None) -> None:
        array = None if values is None else take_array("face_colors", values)
        if array is not None and len(array) != self._struct.triangle_count:
            raise ValueError(f"face_colors has {len(array)} rows for {self._struct.triangle_count} triangles")
        if "face_colors" in self.attributes:
            del self.attributes["face_colors"]
        if array is not None:
            self.attributes.add("face_colors", array, on="triangles", interpolation="color")

    @property
    def attributes(self) -> Attributes:
        """Further attributes, name -> array of (rows, components); may be set."""
        if self._attributes is None:
            self._attributes = Attributes(self._struct, self._owner)
        return self._attributes

    @property
    def origin(self) -> npt.NDArray[np.float64]:
        """(3,) world point to which vertices are relative; writing to it moves the mesh."""
        return np.ctypeslib.as_array(self._struct.origin)

    @property
    def affine(self) -> npt.NDArray[np.float64] | None:
        """The 4 x 4 index-to-world matrix of the volume it came from, a copy; None: not known."""
        rows = np.array(self._struct.affine)
        return np.vstack([rows, [0.0, 0.0, 0.0, 1.0]]) if rows.any() else None

    @property
    def bounds(self) -> npt.NDArray[np.float64]:
        """(2, 3) lowest and highest world coordinates; zeros without vertices."""
        low, high = (c_double * 3)(), (c_double * 3)()
        lib.cw_mesh_bounds(byref(self._struct), low, high)
        return np.array([low, high])

    @property
    def area(self) -> float:
        """Area of all triangles in mm2, measured at each call; check() gives it too."""
        return self._measure().area_mm2

    @property
    def volume(self) -> float | None:
        """Volume in mm3, positive if triangles wind outward; None: the mesh is not closed. Measured at each call."""
        quality = self._measure()
        return quality.volume_mm3 if lib.cw_quality_is_closed_manifold(byref(quality)) else None

    def _measure(self) -> c.cw_quality:
        quality = c.cw_quality()
        desc = c.cw_quality_desc(weld=c.cw_weld.CW_WELD_LOCAL)
        call(lib.cw_quality_measure, byref(self._struct), byref(desc), byref(quality))
        return quality

    def world_vertices(self) -> npt.NDArray[np.float64]:
        """Returns (n, 3) world coordinates in double precision, LPS millimetres; a copy."""
        return self.vertices + self.origin

    def copy(self) -> Mesh:
        """Returns a mesh with arrays of its own."""
        arrays = {name: np.array(value) for name in ARRAYS if (value := self._array(name)) is not None}
        copied = Mesh.from_arrays(**arrays, origin=self.origin)
        copied._struct.affine = self._struct.affine
        copied.attributes.update_from(self.attributes)
        return copied

    def __len__(self) -> int:
        """Returns the number of triangles."""
        return int(self._struct.triangle_count)

    def __bool__(self) -> bool:
        return True  # also without triangles

    def __reduce__(self) -> Any:
        """Pickles, and deep-copies, the arrays, the attributes, and the facts."""
        arrays = {name: np.array(value) for name in ARRAYS if (value := self._array(name)) is not None}
        arrays["origin"] = np.array(self.origin)
        return restore_mesh, (arrays, np.array(self._struct.affine), self.attributes.pack(), self.facts)

    def _repr_png_(self) -> bytes | None:
        """Returns a picture for notebooks; None without triangles."""
        from ._notebook import draw_mesh

        return draw_mesh(self)

    def _repr_html_(self) -> str:
        """Returns the picture and the facts, for notebooks."""
        from ._notebook import describe_mesh

        return describe_mesh(self)

    def voxelize(self, *, like: Any = None, spacing: Any = None, **options: Any) -> Any:
        """Makes voxels of the mesh, which is closed: see voxelize(). Returns a Voxelized."""
        from ._voxelize import voxelize

        return voxelize(self, like=like, spacing=spacing, **options)

    def to_trimesh(self) -> Any:
        """Returns a trimesh.Trimesh in world coordinates (float64), not processed.

        Raises ImportError without the package trimesh.
        """
        try:
            import trimesh  # type: ignore
        except ImportError:
            raise ImportError("Mesh.to_trimesh() needs the package trimesh: pip install trimesh") from None
        # trimesh has signed indices; a copy of unsigned ones as int64 is what it makes itself.
        return trimesh.Trimesh(
            vertices=self.world_vertices(),
            faces=self.triangles.astype(np.int64),
            vertex_normals=self.normals,
            vertex_colors=self.colors,
            face_colors=self.face_colors if self.colors is None else None,
            process=False,
        )

    def to_pyvista(self) -> Any:
        """Returns a pyvista.PolyData in world coordinates (float64).

        Normals, scalars, colors and labels become point data of these names, and face_colors cell
        data. Raises ImportError without the package pyvista.
        """
        try:
            import pyvista  # type: ignore
        except ImportError:
            raise ImportError("Mesh.to_pyvista() needs the package pyvista: pip install pyvista") from None
        faces = np.empty((len(self.triangles), 4), np.int64)
        faces[:, 0] = 3
        faces[:, 1:] = self.triangles
        surface = pyvista.PolyData(self.world_vertices(), faces.ravel())
        for name in ("normals", "scalars", "colors", "labels"):
            values = self._array(name)
            if values is not None:
                surface.point_data["Normals" if name == "normals" else name] = values
        if self.face_colors is not None:
            surface.cell_data["face_colors"] = self.face_colors
        return surface

    def __repr__(self) -> str:
        has = [name for name in ("normals", "scalars", "colors", "labels") if self._array(name) is not None]
        has += ["face_colors"] if self.face_colors is not None else []
        with_text = f", {', '.join(has)}" if has else ""
        counts = f"{self._struct.vertex_count} vertices, {self._struct.triangle_count} triangles"
        return f"<cubewright.Mesh {counts}{with_text}>"


class Levels(list[Mesh]):
    """Levels of detail, from the finest to the coarsest.

    maps  of all levels, by name: {"normals": image}, image (size, size, 4) uint8, top row first
    """

    maps: dict[str, npt.NDArray[np.uint8]]

    def __init__(self) -> None:
        super().__init__()
        self.maps = {}


def restore_mesh(
    arrays: dict[str, Any], affine: npt.NDArray[Any], attributes: list[dict[str, Any]], facts: dict[str, Any]
) -> Mesh:
    """Makes a mesh of what was pickled."""
    mesh = Mesh.from_arrays(**arrays)
    for row, numbers in zip(mesh._struct.affine, affine.tolist()):
        row[:] = numbers
    for attribute in attributes:
        mesh.attributes.add(**attribute)
    mesh.facts = facts
    return mesh


def take_array(name: str, value: npt.ArrayLike) -> npt.NDArray[Any]:
    """Returns a contiguous array of the right type and shape; the same one if it is so already."""
    _, kind, width, _ = ARRAYS["colors" if name == "face_colors" else name]
    array = np.asarray(value)
    shape = f"(n, {width})" if width > 1 else "(n,)"
    if array.shape == (0,):  # an empty list has neither columns nor a type of its own
        array = np.empty((0, width) if width > 1 else 0, kind)
    if array.ndim != (2 if width > 1 else 1) or (width > 1 and array.shape[1] != width):
        raise ValueError(f"{name} has the shape {array.shape}; {shape} was expected")
    if array.dtype.kind not in ("f" if kind[0] == "f" else "") + "iu":
        raise TypeError(f"{name} has the type {array.dtype}; {np.dtype(kind)} was expected")
    if kind[0] == "u" and array.size and array.dtype != kind:
        limit = np.iinfo(kind).max
        if array.min() < 0 or array.max() > limit:
            raise ValueError(f"{name} has a value that is not 0 to {limit}")
    return np.require(array, np.dtype(kind), ["C", "A"])


def take_mesh(name: str, mesh: Any) -> c.cw_mesh:
    if not isinstance(mesh, Mesh):
        raise TypeError(f"{name} must be a Mesh, not {type(mesh).__name__}; see Mesh.from_arrays()")
    return mesh._struct


__all__ = ["Levels", "Mesh"]
