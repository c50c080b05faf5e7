"""Surfaces of labels whose fields are given: probabilities or scores."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from ctypes import byref, c_uint32
from typing import Any, Union

import numpy as np

from . import _declarations as c
from ._extract import AnyVolume, LabelSurfaces, set_labels, set_max_move
from ._library import lib
from ._memory import Owner
from ._options import take_count, take_flag, take_number, take_threads
from ._progress import Progress, Reporter
from ._volume import Volume, take_volume

RULES = ("first", "rest")


def take_fields(fields: Any) -> list[tuple[Volume, int, int]]:
    """Returns the fields as volumes, each with a component and a step."""
    if isinstance(fields, Volume):
        return [(fields, n, t) for t in range(fields.steps) for n in range(fields.components)]
    if isinstance(fields, (str, bytes)) or not hasattr(fields, "__len__"):
        raise TypeError(f"fields is {type(fields).__name__}; an array (label, z, y, x) or a list of volumes was expected")
    rows: list[tuple[Volume, int, int]] = []
    for field in fields:
        if getattr(field, "dtype", None) == np.float16:
            field = np.asarray(field, np.float32)
        rows.append((take_volume(field), 0, 0))
    if not rows:
        raise ValueError("fields is empty: one or more are needed")
    return rows


def take_rule(background: Any) -> tuple[int, float]:
    """Returns the rule for the background, and its value."""
    if not isinstance(background, str):
        return c.cw_background_rule.CW_BACKGROUND_VALUE, take_number("background", background)
    if background not in RULES:
        raise ValueError(f"background is {background!r}; 'first', 'rest' or a number was expected")
    first = background == "first"
    return (c.cw_background_rule.CW_BACKGROUND_FIELD if first else c.cw_background_rule.CW_BACKGROUND_REST), 0.0


def extract_label_scores(
    fields: Union[AnyVolume, Sequence[AnyVolume]],
    background: str | float,
    labels: Iterable[int] | None = None,
    *,
    numbers: Iterable[int] | None = None,
    max_move: float | None = None,
    open: bool = False,
    max_triangles: int = 0,
    threads: int = 0,
    progress: Progress = None,
) -> LabelSurfaces:
    """Extracts the surfaces of labels by the largest of their fields, where neighbouring labels' fields are equal.

    fields      of probabilities or any scores, one a label: an array (label, z, y, x), a list of arrays or volumes
                in one grid, or a Volume of several components or steps
    background  "first": the first field is its; "rest": 1 minus the sum of all; or a value that labels exceed, such
                as 0.5 for sigmoids
    labels      those wanted; default: all
    numbers     of the fields' labels; default: from 0 with "first", which is the background, else from 1
    max_move    of a vertex from the middle of its voxels' cube along each axis, in voxels: up to 0.5, the default;
                0: it stays there

    voxels of the result are those of the largest field. Volumes are those of the fields, and nothing is smoothed.

    Raises Error: ARGUMENT (grids differ), UNSUPPORTED, LIMIT, NO_MEMORY, CANCELLED.
    """
    rows = take_fields(fields)
    rule, value = take_rule(background)
    views = (c.cw_volume * len(rows))(*(volume._select(n, t) for volume, n, t in rows))
    scores = c.cw_label_scores(fields=views, count=len(rows), rule=rule, value=value, has_value=True)
    if numbers is not None:
        named = [take_count("a number", n, 0, 2**32 - 1) for n in numbers]
        if len(named) != len(rows):
            raise ValueError(f"there are {len(named)} numbers and {len(rows)} fields")
        scores.labels = (c_uint32 * len(named))(*named)
    reporter = Reporter(progress)
    desc = c.cw_labels_desc(
        background=scores.labels[0] if rule == c.cw_background_rule.CW_BACKGROUND_FIELD and numbers is not None else 0,
        leave_open=take_flag("open", open),
        threads=take_threads(threads),
        max_triangles=take_count("max_triangles", max_triangles),
        progress=reporter.struct,
    )
    if labels is not None:
        set_labels(desc, [take_count("a label", label, 0, 2**32 - 1) for label in labels])
    if max_move is not None:
        set_max_move(desc, "max_move", max_move)
    out = Owner(c.cw_label_surfaces(), lib.cw_label_surfaces_free)
    reporter.call(lib.cw_extract_label_scores, byref(scores), byref(desc), byref(out.struct))
    return LabelSurfaces(out, [])
