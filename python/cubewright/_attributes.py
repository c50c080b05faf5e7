"""Attributes of meshes by name: arrays on vertices, corners, triangles or the whole mesh."""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping
from ctypes import POINTER, byref, c_uint32, c_void_p, cast
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _declarations as c
from ._errors import call
from ._library import lib
from ._memory import Owner, lend_array
from ._options import take_choice
from ._volume import KINDS, TYPES

# In the order of cw_on and cw_interpolation.
ON = ("vertices", "corners", "triangles", "parts")
INTERPOLATION = ("linear", "direction", "color", "nearest")


def free_attributes(struct: Any) -> None:
    """Frees the attributes of a struct whose other arrays are not the library's."""
    kept = c.cw_mesh(attributes=struct._obj.attributes, attribute_count=struct._obj.attribute_count)
    lib.cw_mesh_free(byref(kept))


class Attributes(MutableMapping[str, npt.NDArray[Any]]):
    """The attributes of a mesh beside normals, scalars, colors and labels.

    mesh.attributes["quality"] is an array of n x components that shares memory with the library.
    Setting one copies an array. Its number of rows tells whether it is on vertices, triangles,
    corners (three for each triangle) or the part, which is the mesh; where two are the same, use
    add(). Functions that cut, repair, weld or simplify the mesh carry its attributes.
    """

    def __init__(self, struct: c.cw_mesh, owner: object) -> None:
        self._struct = struct
        # Arrays of a dict are the caller's; other owners free the attributes with the mesh.
        self._owner = Owner(struct, free_attributes) if isinstance(owner, dict) else owner
        self._removed: list[object] = []  # memory that arrays may still use

    def _row(self, name: object) -> c.cw_attribute:
        rows: list[c.cw_attribute] = self._struct.attributes[: self._struct.attribute_count]
        for row in rows:
            if isinstance(name, str) and row.name == name.encode():
                return row
        raise KeyError(name)

    def _count(self, on: int) -> int:
        s = self._struct
        return int((s.vertex_count, 3 * s.triangle_count, s.triangle_count, 1)[on])

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        row = self._row(name)
        shape = (self._count(row.on), row.components)
        return lend_array(self, row.data or 0, KINDS[row.type], shape)

    def __iter__(self) -> Iterator[str]:
        rows = self._struct.attributes[: self._struct.attribute_count]
        return iter([row.name.decode() for row in rows])

    def __len__(self) -> int:
        return int(self._struct.attribute_count)

    def __setitem__(self, name: str, values: npt.ArrayLike) -> None:
        """Copies an array of (rows,) or (rows, components); replaces one of the same name."""
        if name not in self:
            self.add(name, values)
            return
        row = self._row(name)
        array, on = self._take(name, values, ON[row.on])
        if array.shape[1] == row.components and TYPES[array.dtype.str[1:]] == row.type:
            self[name][...] = array
            return
        way = row.interpolation
        del self[name]
        self.add(name, array, on=ON[on], interpolation=INTERPOLATION[way])

    def __delitem__(self, name: str) -> None:
        row = self._row(name)
        # A struct that frees the values once no array uses them.
        kept = c.cw_mesh(labels=cast(row.data, POINTER(c_uint32)))
        row.data = c_void_p()
        lib.cw_mesh_attribute_remove(byref(self._struct), name.encode())
        self._removed.append(Owner(kept, lib.cw_mesh_free))

    def add(self, name: str, values: npt.ArrayLike, *, on: str | None = None, interpolation: str | None = None) -> None:
        """Adds an attribute; its values are copied.

        values         (rows,) or (rows, components), 1 to 4 or 16 components; integers of 64 bits
                       become 32
        on             "vertices", "corners", "triangles" or "parts"; None: by the number of rows
        interpolation  between elements: "linear", "direction", "color" or "nearest"; None: linear,
                       and nearest for integers
        Raises ValueError if no element has this number of rows, or several have; Error (ARGUMENT)
        for a name in use.
        """
        array, chosen = self._take(name, values, on)
        default = "linear" if array.dtype.kind == "f" else "nearest"
        like = c.cw_attribute(
            name=name.encode(),
            on=chosen,
            type=TYPES[array.dtype.str[1:]],
            components=array.shape[1],
            interpolation=take_choice("interpolation", interpolation or default, INTERPOLATION),
        )
        call(lib.cw_mesh_attribute_add, byref(self._struct), byref(like), None)
        self[name][...] = array

    def pack(self) -> list[dict[str, Any]]:
        """Returns copies of all: what add() takes."""
        rows = [(name, self._row(name)) for name in self]
        return [
            {"name": name, "values": np.array(self[name]), "on": ON[r.on], "interpolation": INTERPOLATION[r.interpolation]}
            for name, r in rows
        ]

    def update_from(self, other: Attributes) -> None:
        """Adds copies of the attributes of a mesh that has the same elements."""
        for attribute in other.pack():
            self.add(**attribute)

    def _take(self, name: str, values: npt.ArrayLike, on: str | None) -> tuple[npt.NDArray[Any], int]:
        array = np.asarray(values)
        if array.dtype.kind == "b":
            array = array.astype("u1")
        if array.dtype.kind in "iu" and array.dtype.itemsize == 8:
            kind = "u4" if not array.size or array.min() >= 0 else "i4"
            limits = np.iinfo(kind)
            if array.size and (array.min() < limits.min or array.max() > limits.max):
                raise ValueError(f"attribute {name} has a value beyond 32 bits")
            array = array.astype(kind)
        if array.dtype.str[1:] not in TYPES:
            raise TypeError(f"attribute {name} has the type {array.dtype}; one of {', '.join(TYPES)} was expected")
        if array.ndim == 1:
            array = array[:, None]
        if array.ndim != 2:
            raise ValueError(f"attribute {name} has the shape {array.shape}; (rows, components) was expected")
        allowed = range(len(ON)) if on is None else [take_choice("on", on, ON)]
        fits = [number for number in allowed if self._count(number) == len(array)]
        if len(fits) != 1:
            found = " and ".join(ON[number] for number in fits) or f"no {on or 'elements'} of the mesh"
            raise ValueError(f"attribute {name} has {len(array)} rows, which fits {found}; on= names one of {', '.join(ON)}")
        return array, fits[0]


__all__ = ["Attributes"]
