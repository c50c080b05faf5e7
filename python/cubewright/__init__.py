"""Cubewright: volumes to surfaces, on NumPy arrays.

    import cubewright
    volume = cubewright.Volume(array, spacing=(0.5, 0.5, 1.0))  # array[z, y, x], shared
    mesh = cubewright.extract(volume, 300)
    cubewright.write("bone.glb", mesh)

Arrays have the axes z, y, x. Lengths are millimetres, as floats; points, spacing and indices run
x, y, z; the world is LPS. Long calls run without the interpreter's lock, take progress=callable,
and stop at Ctrl-C. What fails raises Error; a wrong type of an argument raises TypeError, a wrong
value ValueError. Unknown keywords are TypeErrors. A mesh or a volume may be used by several
threads at once, as long as none writes to its arrays.
"""

from ._about import Feature, Format, features, formats, make
from ._appearance import Appearance, LookDifference, appearance, appearance_view
from ._atlas import Atlas, Baked, TextureDistance, atlas, bake_maps, bake_normals, bake_pictures, texture_distance
from ._boolean import Combined, boolean
from ._check import Check, Verdict, check, contacts, report
from ._color import color_by
from ._cut import Cut, cut
from ._engrave import Engraved, engrave
from ._errors import Error, Status
from ._extract import (
    Brick,
    Extractor,
    LabelChange,
    LabelSurfaces,
    Patch,
    Settings,
    clean_labels,
    extract,
    extract_labels,
    extract_levels,
    resample_labels,
)
from ._handles import Closed, close_handles
from ._label_scores import extract_label_scores
from ._library import lib as _lib
from ._memory import memory_limit, memory_overflow, memory_overflowed, memory_used
from ._mesh import Levels, Mesh
from ._orient import Oriented, Stand, orient_print
from ._pieces import Piece, Pieces, cut_pieces
from ._place import crease_normals, split, transform
from ._progress import Progress
from ._read import Part, read_mesh, read_parts, read_volume
from ._remesh import Remeshed, remesh
from ._render import render, write_png
from ._repair import Repaired, repair
from ._simplify import Smoothed, hollow, offset, simplify, simplify_levels, smooth, weld
from ._volume import Label, Statistics, Volume
from ._voxelize import Voxelized, VoxelizedPart, Within, measure_within, voxelize
from ._write import Written, write

__version__: str = _lib.cw_version().decode()

__all__ = [
    "Appearance",
    "Atlas",
    "Baked",
    "Brick",
    "Check",
    "Closed",
    "Combined",
    "Cut",
    "Engraved",
    "Error",
    "Extractor",
    "Feature",
    "Format",
    "Label",
    "LabelChange",
    "LabelSurfaces",
    "Levels",
    "LookDifference",
    "Mesh",
    "Oriented",
    "Part",
    "Patch",
    "Piece",
    "Pieces",
    "Progress",
    "Remeshed",
    "Repaired",
    "Settings",
    "Smoothed",
    "Stand",
    "Statistics",
    "Status",
    "TextureDistance",
    "Verdict",
    "Volume",
    "Voxelized",
    "VoxelizedPart",
    "Within",
    "Written",
    "appearance",
    "appearance_view",
    "atlas",
    "bake_maps",
    "bake_normals",
    "bake_pictures",
    "boolean",
    "check",
    "clean_labels",
    "close_handles",
    "color_by",
    "contacts",
    "crease_normals",
    "cut",
    "cut_pieces",
    "engrave",
    "extract",
    "extract_label_scores",
    "extract_labels",
    "extract_levels",
    "features",
    "formats",
    "hollow",
    "make",
    "measure_within",
    "memory_limit",
    "memory_overflow",
    "memory_overflowed",
    "memory_used",
    "offset",
    "orient_print",
    "read_mesh",
    "read_parts",
    "read_volume",
    "remesh",
    "render",
    "repair",
    "report",
    "resample_labels",
    "simplify",
    "simplify_levels",
    "smooth",
    "split",
    "texture_distance",
    "transform",
    "voxelize",
    "weld",
    "write",
    "write_png",
    "__version__",
]
