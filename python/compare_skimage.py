#!/usr/bin/python3
"""Extracts surfaces by scikit-image and by cubewright from the same arrays, in one run.

    compare_skimage.py [--rounds N] [--threads N] [VOLUME ISO]

Prints a table: times (median), triangles, and defects, counted by the same lines of NumPy for
both. Both leave surfaces open at the border of the data and make normals.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from typing import Any

import cubewright as cw
import numpy as np


def count_defects(vertices: Any, triangles: Any, shape: tuple[int, int, int]) -> dict[str, int]:
    """Counts flaws of a mesh as indexed; vertices are x, y, z indices of voxels."""
    corners = triangles.astype(np.int64)
    edges = np.sort(np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]), axis=1)
    proper = edges[edges[:, 0] != edges[:, 1]]
    pairs, counts = np.unique(proper, axis=0, return_counts=True)
    open_ends = vertices[pairs[counts == 1]].astype(float)
    last = np.array(shape[::-1]) - 1.0
    at_border = (np.abs(open_ends) < 1e-3).all(axis=1) | (np.abs(open_ends - last) < 1e-3).all(axis=1)
    a, b, c = (vertices[corners[:, n]].astype(float) for n in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return {
        "triangles": len(corners),
        "open": int((~at_border.any(axis=1)).sum()),
        "non-manifold": int((counts > 2).sum()),
        "no area": int((areas == 0).sum()),
    }


def extract_by_skimage(array: Any, iso: float) -> tuple[Any, Any]:
    from skimage.measure import marching_cubes

    vertices, triangles, _, _ = marching_cubes(array, iso)
    return vertices[:, ::-1], triangles


def extract_by_cubewright(array: Any, iso: float, threads: int) -> tuple[Any, Any]:
    mesh = cw.extract(array, iso, open=True, threads=threads)
    return mesh.world_vertices(), mesh.triangles


def measure(extract: Callable[[], tuple[Any, Any]], rounds: int) -> tuple[float, tuple[Any, Any]]:
    times = []
    for _ in range(rounds):
        start = time.perf_counter()
        result = extract()
        times.append(time.perf_counter() - start)
    return statistics.median(times), result


def make_cases() -> dict[str, tuple[Any, float]]:
    rng = np.random.default_rng(1)
    return {
        "gyroid, 256³ f32": (cw.make("gyroid", dims=256).array, 0.0),
        "CT head, 192³ i16, noise": (cw.make("ct-head", dims=192, type="i16", noise=20).array, 300.0),
        "random, 96³ f32": (rng.random((96, 96, 96), np.float32), 0.5),
        "whole numbers 0 to 4, 96³ u8": (rng.integers(0, 5, (96, 96, 96), np.uint8), 2.0),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("volume", nargs="?")
    parser.add_argument("iso", nargs="?", type=float)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--threads", type=int, default=1, help="of cubewright; scikit-image has one")
    given = parser.parse_args()
    if given.volume and given.iso is None:
        parser.error("a volume needs an isovalue")
    cases = {given.volume: (cw.read_volume(given.volume).array, given.iso)} if given.volume else make_cases()
    defects = "open edges inside | non-manifold edges | triangles without area"
    print(f"| volume | extractor | time | triangles | {defects} |")
    print("|" + " --- |" * 7)
    for name, (array, iso) in cases.items():
        ways: dict[str, Callable[[], tuple[Any, Any]]] = {
            "scikit-image": lambda: extract_by_skimage(array, iso),
            "cubewright": lambda: extract_by_cubewright(array, iso, given.threads),
        }
        for title, way in ways.items():
            seconds, (vertices, triangles) = measure(way, given.rounds)
            found = count_defects(vertices, triangles, array.shape)
            print(
                f"| {name} | {title} | {1e3 * seconds:.0f} ms | {found['triangles']:,} | "
                f"{found['open']:,} | {found['non-manifold']:,} | {found['no area']:,} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
