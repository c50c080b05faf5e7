"""Checks: defects of a mesh, distances to a volume or another mesh, and verdicts on them."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from ctypes import POINTER, byref, c_float, c_uint8, c_uint32, pointer
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _declarations as c
from ._errors import call, name_keywords
from ._extract import AnyVolume, extract, take_inside, take_iso
from ._library import lib
from ._memory import unpack
from ._mesh import Mesh, take_mesh
from ._options import take_choice, take_flag, take_length, take_lengths, take_number, take_threads
from ._progress import Progress, Reporter
from ._volume import Volume, take_volume

PROFILES = ("basic", "print", "web", "fem", "game", "mobile")


@dataclass(frozen=True)
class Verdict:
    """A judgement: grade is 'fail', 'unknown', 'warn', 'ok' or 'note'; number is behind it."""

    name: str
    grade: str
    number: float
    text: str
    advice: str | None


@dataclass(frozen=True)
class Check:
    """The measurements of a mesh, and what a profile makes of them.

    holds      True if no verdict is 'fail' or 'unknown'
    verdicts   the worst first
    quality    counts of defects, size and shapes of triangles, by the names of cw_quality
    distances  of 'to_source', 'from_source', 'to_reference' and 'from_reference' those that were
               measured, each a dict with max_mm, rms_mm, mean_mm, p99_mm, bias_mm and more
    missing    components of the source's surface that the mesh lacks
    intersections  pairs of triangles that meet; None: not looked for
    print      of a closed mesh and 'print', walls, gaps, overhangs and more by the names of
               cw_print_facts; a wall_mm or gap_mm of None: there is none. Else None
    defects    (m,) uint8, for each triangle bits of 1 open, 2 non-manifold, 4 misoriented,
               8 duplicate, 16 no area, 32 sliver, 64 inside out, 128 intersecting
    """

    holds: bool
    profile: str
    verdicts: list[Verdict]
    quality: dict[str, Any]
    distances: dict[str, dict[str, Any]]
    missing: int
    intersections: int | None
    print: dict[str, Any] | None
    defects: npt.NDArray[np.uint8]

    def __repr__(self) -> str:
        bad = [v.text for v in self.verdicts if v.grade in ("fail", "unknown")]
        return f"<cubewright.Check {self.profile}: {'holds' if self.holds else '; '.join(bad)}>"


def unpack_print(facts: c.cw_print_facts) -> dict[str, Any]:
    """Returns the measurements of a print, and its limits beside them, as JSON can hold them."""
    limits = ("min_wall_mm", "min_gap_mm", "overhang_deg", "layer_mm", "plate_mm")
    values: dict[str, Any] = {}
    for field in facts._fields_:
        value = getattr(facts, field[0])
        if field[0] == "limits":
            values.update((name, getattr(value, name)) for name in limits)
            values["plate_mm"] = list(values["plate_mm"])
        else:
            values[field[0]] = list(value) if isinstance(value, ctypes.Array) else value
    return {name: None if value == np.inf else value for name, value in values.items()}


class Measurer:
    """Measures one mesh, and holds what the findings point to."""

    def __init__(self, mesh: c.cw_mesh, threads: int, progress: Progress) -> None:
        self.mesh, self.threads, self.progress = mesh, threads, progress
        self.findings = c.cw_findings(has_normals=bool(mesh.normals))
        self.defects = np.zeros(mesh.triangle_count, np.uint8)
        self.quality = c.cw_quality()
        self.crossings = c.cw_crossings()
        self.print = c.cw_print_facts()
        self.orient = c.cw_orient_facts()
        self.distances: dict[str, c.cw_distance] = {}

    def call(self, function: Callable[..., int], desc: Any, before: tuple[Any, ...], after: tuple[Any, ...]) -> None:
        """Calls with a desc, to which threads and progress are added."""
        reporter = Reporter(self.progress)
        desc.threads, desc.progress = self.threads, reporter.struct
        reporter.call(function, *before, byref(desc), *after)

    def measure_defects(self, intersections: bool) -> None:
        marks = self.defects.ctypes.data_as(POINTER(c_uint8)) if len(self.defects) else None
        local = c.cw_weld.CW_WELD_LOCAL
        desc = c.cw_quality_desc(weld=local, shells=True, defects=marks)
        self.call(lib.cw_quality_measure, desc, (byref(self.mesh),), (byref(self.quality),))
        self.findings.quality = pointer(self.quality)
        if intersections:
            wanted = c.cw_crossings_desc(weld=local, defects=marks)
            self.call(lib.cw_self_intersections, wanted, (byref(self.mesh),), (byref(self.crossings),))
            self.findings.crossings = pointer(self.crossings)

    def measure_print(self, desc: c.cw_print_desc) -> None:
        """Measures walls, gaps and the rest; an open mesh has none, and does not meet the profile."""
        if self.mesh.triangle_count and lib.cw_quality_is_closed_manifold(byref(self.quality)):
            self.call(lib.cw_print_measure, desc, (byref(self.mesh),), (byref(self.print),))
            self.findings.print = pointer(self.print)
            self.call(lib.cw_orient_print, desc, (byref(self.mesh),), (byref(self.orient),))
            self.findings.orient = pointer(self.orient)

    def measure_mesh_distance(
        self, name: str, mesh: c.cw_mesh, other: c.cw_mesh, desc: Any, each: Any = None
    ) -> None:
        out = self.distances[name] = c.cw_distance()
        self.call(lib.cw_distance_to_mesh, desc, (byref(mesh), byref(other)), (byref(out), each))

    def compare_with_source(self, source: Volume, iso: float, low: bool, open: bool) -> None:
        """Measures to the field itself, and back from its surface as it is extracted."""
        view = source._select(0, 0)
        out = self.distances["to_source"] = c.cw_distance()
        desc = c.cw_field_distance_desc(isovalue=iso, inside_is_low=low, leave_open=open)
        self.call(lib.cw_distance_to_field, desc, (byref(self.mesh), byref(view)), (byref(out), None))
        self.findings.to_field = pointer(out)
        inside = "below" if low else "above"
        surface = extract(
            source, iso, inside=inside, open=open, normals="none", threads=self.threads, progress=self.progress
        )
        self.field = c.cw_quality()
        self.call(lib.cw_quality_measure, c.cw_quality_desc(), (byref(surface._struct),), (byref(self.field),))
        self.findings.field = pointer(self.field)
        if len(surface.triangles) and self.mesh.triangle_count:
            self.measure_from_surface(surface, source)

    def measure_from_surface(self, surface: Mesh, source: Volume) -> None:
        """Measures the components that the mesh has; the others are counted.

        A component is missing when the mesh is nowhere within a quarter of a voxel, or the
        tolerance if that is larger, as in the command `check`.
        """
        struct = surface._struct
        distance = np.zeros(struct.vertex_count, np.float32)
        address = distance.ctypes.data_as(POINTER(c_float))
        desc = c.cw_mesh_distance_desc(vertices_only=True)
        self.measure_mesh_distance("from_source", struct, self.mesh, desc, address)
        np.abs(distance, out=distance)
        near = max(0.25 * float(np.prod(source.spacing)) ** (1 / 3), self.findings.tolerance_mm)
        counts, farthest = c.cw_drop_counts(), ctypes.c_double()
        call(lib.cw_mesh_drop_distant, byref(struct), address, near, byref(counts), byref(farthest))
        self.findings.missing = counts.dropped
        self.findings.missing_mm3, self.findings.missing_mm = counts.largest_mm3, farthest.value
        if counts.dropped and struct.triangle_count:
            self.measure_mesh_distance("from_source", struct, self.mesh, desc)
        if struct.triangle_count:
            self.findings.from_field = pointer(self.distances["from_source"])
        else:
            del self.distances["from_source"]

    def compare_with_reference(self, reference: c.cw_mesh) -> None:
        desc = c.cw_mesh_distance_desc(tolerance_mm=self.findings.tolerance_mm / 100)
        self.measure_mesh_distance("to_reference", self.mesh, reference, desc)
        self.measure_mesh_distance("from_reference", reference, self.mesh, desc)
        self.findings.to_reference = pointer(self.distances["to_reference"])
        self.findings.from_reference = pointer(self.distances["from_reference"])

    def judge(self, profile: int) -> Check:
        rows = (c.cw_verdict * c.CW_MAX_VERDICTS)()
        count = lib.cw_check_judge(byref(self.findings), profile, rows)
        verdicts = [
            Verdict(
                (row.name or b"").decode(),
                lib.cw_grade_name(row.grade).decode(),
                row.number,
                row.text.decode("utf-8", "replace"),
                name_keywords(row.advice) if row.advice else None,
            )
            for row in rows[:count]
        ]
        return Check(
            holds=bool(lib.cw_check_holds(rows, count)),
            profile=PROFILES[profile],
            verdicts=verdicts,
            quality=unpack(self.quality),
            distances={name: unpack(d) for name, d in self.distances.items()},
            missing=self.findings.missing,
            intersections=self.crossings.count if self.findings.crossings else None,
            print=unpack_print(self.print) if self.findings.print else None,
            defects=self.defects,
        )


def take_printer(
    wall: float | str,
    gap: float | str,
    overhang: float,
    layer: float | str,
    plate: Sequence[float | str] | None,
) -> c.cw_print_desc:
    desc = c.cw_print_desc(
        min_wall_mm=take_length("wall", wall),
        min_gap_mm=take_length("gap", gap),
        overhang_deg=take_number("overhang", overhang),
        layer_mm=take_length("layer", layer),
    )
    if plate is not None:
        desc.plate_mm[:] = take_lengths("plate", plate)
    return desc


def check(
    mesh: Mesh,
    *,
    profile: str = "basic",
    deep: bool = False,
    source: AnyVolume | None = None,
    iso: float | str | None = None,
    inside: str = "auto",
    open: bool = False,
    reference: Mesh | None = None,
    tolerance: float | str = 0.0,
    wall: float | str = 0.0,
    gap: float | str = 0.0,
    overhang: float = 0.0,
    layer: float | str = 0.0,
    plate: Sequence[float | str] | None = None,
    threads: int = 0,
    progress: Progress = None,
) -> Check:
    """Measures a mesh and holds it against a profile.

    profile    what the mesh must be fit for: 'basic', 'print', 'web', 'fem', 'game' or 'mobile'
    deep       look for self-intersections in every profile. CGAL is not asked; the command does
    source     a volume to measure the distance to; needs iso, as for extract()
    reference  a mesh to measure the distance to, both ways
    tolerance  largest distance allowed; 0: distances are reported only. Lengths are in mm, or texts with a
               unit: "0.1mm", and here "0.05%" of the diagonal of the mesh's box
    wall       of 'print': walls below are thin; 0: 0.8
    gap        the same of gaps; 0: 0.4
    overhang   degrees from the vertical that need no support; 0: 45
    layer      height of a layer; 0: 0.2
    plate      width, depth and height that can be printed; None: not looked at

    A mesh that is bad is no error: see Check.holds. Vertices at equal positions count as one.
    Raises Error: ARGUMENT, UNSUPPORTED, LIMIT, NO_MEMORY, CANCELLED.
    """
    struct = take_mesh("mesh", mesh)
    wanted = take_choice("profile", profile, PROFILES)
    if (source is None) != (iso is None):
        raise TypeError("source and iso go together: give both or neither")
    m = Measurer(struct, take_threads(threads), progress)
    m.findings.tolerance_mm = take_length("tolerance", tolerance, mesh)
    if tolerance and source is None and reference is None:
        raise TypeError("tolerance needs something to measure from: source or reference")
    printer = take_printer(wall, gap, overhang, layer, plate)
    other = None if reference is None else take_mesh("reference", reference)
    try:
        m.measure_defects(take_flag("deep", deep) or bool(lib.cw_check_wants_crossings(wanted)))
        if PROFILES[wanted] == "print":
            m.measure_print(printer)
        if source is not None and iso is not None:
            volume = take_volume(source)
            low = take_inside(inside, volume)
            m.compare_with_source(volume, take_iso(iso, volume._struct, threads), low, take_flag("open", open))
        if other is not None:
            m.compare_with_reference(other)
        return m.judge(wanted)
    finally:
        lib.cw_crossings_free(byref(m.crossings))


def contacts(meshes: Sequence[Mesh]) -> dict[str, int]:
    """Finds the triangles that solids share, such as the labels of LabelSurfaces.meshes().

    Counts triangles, those shared by two solids that see them from opposite sides, places where solids overlap, since
    two see a triangle from the same side, and neighbours, the pairs of solids with an interface.
    Raises Error: ARGUMENT, LIMIT, NO_MEMORY.
    """
    solids = [take_mesh(f"meshes[{n}]", mesh) for n, mesh in enumerate(meshes)]
    if not solids:
        return unpack(c.cw_contacts())
    starts = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    origins = [np.array(solid.origin[:]) for solid in solids]
    shifted = [mesh.vertices + (o - origins[0]).astype("f4") for mesh, o in zip(meshes, origins)]
    triangles = [mesh.triangles + np.uint32(start) for mesh, start in zip(meshes, starts)]
    part = np.concatenate([np.full(len(t), n, "u4") for n, t in enumerate(triangles)])
    merged = Mesh.from_arrays(np.concatenate(shifted), np.concatenate(triangles))
    out = c.cw_contacts()
    call(lib.cw_contacts_find, byref(merged._struct), part.ctypes.data_as(POINTER(c_uint32)), byref(out), None)
    return unpack(out)


def report(mesh: Mesh, **options: Any) -> dict[str, Any]:
    """Returns the numbers of check() as a dict that json.dumps() takes. Options are check()'s.

    Keys: version, mesh (vertices, triangles, bounds_mm), profile, holds, verdicts, quality,
    distances, missing, intersections, print.

    This is not the page of `cubewright report`. That page, with its study of extraction,
    simplification and rendering, is made by the command alone; the library has no function for it.
    """
    result = check(mesh, **options)
    return {
        "version": lib.cw_version().decode(),
        "mesh": {
            "vertices": len(mesh.vertices),
            "triangles": len(mesh.triangles),
            "bounds_mm": mesh.bounds.tolist(),
        },
        "profile": result.profile,
        "holds": result.holds,
        "verdicts": [dict(vars(verdict)) for verdict in result.verdicts],
        "quality": result.quality,
        "distances": result.distances,
        "missing": result.missing,
        "intersections": result.intersections,
        "print": result.print,
    }
