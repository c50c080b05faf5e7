"""Shows meshes and volumes in notebooks: a small picture, and facts beside it."""

from __future__ import annotations

import base64
import html
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ._render import make_png, render

if TYPE_CHECKING:
    from ._mesh import Mesh
    from ._volume import Volume

SIZE = (360, 270)  # pixels of a mesh
SLICE = 180  # of a slice's longer side
WINDOW = (0.5, 99.5)  # percentiles that become black and white


def draw_mesh(mesh: Mesh) -> bytes | None:
    if not len(mesh):
        return None
    return make_png(render(mesh, camera="iso", size=SIZE))


def draw_volume(volume: Volume) -> bytes | None:
    """Returns a picture of the middle slices along z, y and x; None where there is nothing to draw."""
    if volume.kind in ("sparse", "irregular"):
        return None
    voxels = volume.array
    if volume.steps > 1:
        voxels = voxels[0]
    if volume.components > 1:
        voxels = voxels[..., 0]
    z, y, x = (count // 2 for count in voxels.shape)
    width, depth, height = volume.spacing
    slices = [(voxels[z], depth, width), (voxels[::-1, y], height, width), (voxels[::-1, :, x], height, depth)]
    values = [each[np.isfinite(each) & (each != volume.nodata)].astype(float) for each, _, _ in slices]
    seen = np.concatenate(values)
    if not seen.size:
        return None
    low, high = np.percentile(seen, WINDOW)
    shades = [shade_slice(each, down, along, low, high) for each, down, along in slices]
    strip = np.concatenate(shades, axis=1)
    return make_png(np.repeat(strip[..., None], 3, axis=2))


def shade_slice(
    values: npt.NDArray[Any], down: float, along: float, low: float, high: float
) -> npt.NDArray[np.uint8]:
    """Returns a slice as grey levels, SLICE pixels on its longer side, in the middle of a square.

    down, along  millimetres from one row and one column to the next
    """
    tall, wide = values.shape[0] * down, values.shape[1] * along
    rows, columns = (max(1, round(SLICE * side / max(tall, wide))) for side in (tall, wide))
    picked = values[np.arange(rows) * values.shape[0] // rows][:, np.arange(columns) * values.shape[1] // columns]
    scaled = (np.nan_to_num(picked.astype(float), nan=low) - low) / (high - low if high > low else 1.0)
    square = np.zeros((SLICE, SLICE), np.uint8)
    top, left = (SLICE - rows) // 2, (SLICE - columns) // 2
    square[top : top + rows, left : left + columns] = np.clip(255 * scaled, 0, 255).astype(np.uint8)
    return square


def describe_mesh(mesh: Mesh) -> str:
    low, high = mesh.bounds
    enclosed = mesh.volume
    facts = {
        "triangles": f"{len(mesh):,}",
        "vertices": f"{len(mesh.vertices):,}",
        "box": " x ".join(f"{side:.6g}" for side in high - low) + " mm",
        "area": f"{mesh.area:.6g} mm\u00b2",
        "volume": "not closed" if enclosed is None else f"{enclosed:.6g} mm\u00b3",
    }
    return make_html("Mesh", facts, draw_mesh(mesh))


def describe_volume(volume: Volume) -> str:
    facts = {
        "voxels (x, y, z)": " x ".join(str(count) for count in reversed(volume.shape)),
        "type": str(volume.dtype),
        "spacing": " x ".join(f"{side:.6g}" for side in volume.spacing) + " mm",
        "grid": volume.kind,
    }
    if volume.components > 1:
        facts["components"] = str(volume.components)
    if volume.steps > 1:
        facts["steps"] = str(volume.steps)
    if volume.kind in ("even", "rectilinear"):
        found = volume.statistics(0)
        facts["values"] = f"{found.min:.6g} to {found.max:.6g}" if found.finite else "none is finite"
    return make_html("Volume", facts, draw_volume(volume))


def make_html(title: str, facts: dict[str, str], picture: bytes | None) -> str:
    rows = "".join(f"<tr><th>{html.escape(name)}</th><td>{html.escape(text)}</td></tr>" for name, text in facts.items())
    shown = f'<img alt="{title}" src="data:image/png;base64,{base64.b64encode(picture).decode()}">' if picture else ""
    return f'<div style="display:flex;gap:1em;align-items:center">{shown}<table><caption>{title}</caption>{rows}</table></div>'
