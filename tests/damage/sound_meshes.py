"""Makes sound meshes with nothing but NumPy: closed, oriented, without crossings, of known volume."""

import numpy as np


def from_grid(points, wraps_u, wraps_v):
    """Joins a grid of points; rows and columns may wrap around."""
    rows, columns = points.shape[:2]
    faces = []
    for i in range(rows if wraps_u else rows - 1):
        for j in range(columns if wraps_v else columns - 1):
            a, b = i * columns + j, (i + 1) % rows * columns + j
            c, d = (i + 1) % rows * columns + (j + 1) % columns, i * columns + (j + 1) % columns
            faces += [(a, b, c), (a, c, d)]
    return points.reshape(-1, 3), np.array(faces)


def turned_outward(points, faces):
    return (points, faces) if volume(points[faces]) > 0 else (points, faces[:, ::-1])


def volume(corners):
    """Computes the volume that triangles enclose, by their corners: n x 3 x 3."""
    c = np.asarray(corners, float)
    c = c - c.reshape(-1, 3).mean(0)
    return float(np.einsum("ij,ij->i", c[:, 0], np.cross(c[:, 1], c[:, 2])).sum() / 6)


def box(size, cells=1):
    """Makes a box whose faces are grids of cells x cells."""
    points, faces, number = [], [], {}

    def vertex(p):
        key = tuple(p)
        if key not in number:
            number[key] = len(points)
            points.append(p)
        return number[key]

    for axis in range(3):
        for side in (0, cells):
            for i in range(cells):
                for j in range(cells):
                    quad = []
                    for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        p = [0, 0, 0]
                        p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3] = side, i + u, j + v
                        quad.append(vertex(p))
                    quad = quad if side else quad[::-1]
                    faces += [(quad[0], quad[1], quad[2]), (quad[0], quad[2], quad[3])]
    return np.array(points) * np.array(size) / cells, np.array(faces)


def swept(path, radius, around, closes=True):
    """Sweeps a circle along a path; an open one gets flat ends."""
    along = np.gradient(path, axis=0)
    if closes:
        along = np.roll(path, -1, 0) - np.roll(path, 1, 0)
    along /= np.linalg.norm(along, axis=1)[:, None]
    side = np.cross(along, [0.1, 0.2, 1.0])
    side /= np.linalg.norm(side, axis=1)[:, None]
    up = np.cross(along, side)
    t = 2 * np.pi * np.arange(around) / around
    ring = np.cos(t)[None, :, None] * side[:, None] + np.sin(t)[None, :, None] * up[:, None]
    points, faces = from_grid(path[:, None] + radius * ring, closes, True)
    if not closes:
        first, last = len(points), len(points) + 1
        points = np.vstack([points, path[0], path[-1]])
        base = (len(path) - 1) * around
        ends = [(first, k, (k + 1) % around) for k in range(around)]
        ends += [(last, base + (k + 1) % around, base + k) for k in range(around)]
        faces = np.vstack([faces, ends])
    return turned_outward(points, faces)


def torus(major, minor, n, m):
    t = 2 * np.pi * np.arange(n) / n
    return swept(np.stack([major * np.cos(t), major * np.sin(t), 0 * t], 1), minor, m)


def knot(n, m):
    t = 2 * np.pi * np.arange(n) / n
    path = np.stack([np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)], 1)
    return swept(8 * path, 2.0, m)


def spring(n, m):
    t = 4 * np.pi * np.arange(n) / (n - 1)
    return swept(np.stack([10 * np.cos(t), 10 * np.sin(t), 1.2 * t], 1), 1.5, m, False)


def ball(rings, around, radius=20.0):
    """Makes a ball of parallels and meridians."""
    t = np.pi * np.arange(1, rings) / rings
    u = 2 * np.pi * np.arange(around) / around
    grid = np.stack([np.sin(t)[:, None] * np.cos(u), np.sin(t)[:, None] * np.sin(u),
                     np.cos(t)[:, None] + 0 * u], 2)
    return closed_by_poles(radius * grid, [0, 0, radius], [0, 0, -radius])


def closed_by_poles(grid, first, last):
    rows, around = grid.shape[:2]
    points, faces = from_grid(grid, False, True)
    a, b, base = len(points), len(points) + 1, (rows - 1) * around
    ends = [(a, k, (k + 1) % around) for k in range(around)]
    ends += [(b, base + (k + 1) % around, base + k) for k in range(around)]
    return turned_outward(np.vstack([points, first, last]), np.vstack([faces, ends]))


def icosphere(levels, radius=15.0):
    g = (1 + 5**0.5) / 2
    points = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g),
              (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
             (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11),
             (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    points = [np.array(p) / np.linalg.norm(p) for p in points]
    for _ in range(levels):
        middle, finer = {}, []
        for f in faces:
            mids = []
            for a, b in ((f[0], f[1]), (f[1], f[2]), (f[2], f[0])):
                key = (min(a, b), max(a, b))
                if key not in middle:
                    p = points[a] + points[b]
                    middle[key] = len(points)
                    points.append(p / np.linalg.norm(p))
                mids.append(middle[key])
            finer += [(f[0], mids[0], mids[2]), (f[1], mids[1], mids[0]), (f[2], mids[2], mids[1]), tuple(mids)]
        faces = finer
    return radius * np.array(points), np.array(faces)


def turned(profile, around):
    """Turns a profile of (radius, z) around z, and closes it at the axis."""
    u = 2 * np.pi * np.arange(around) / around
    p = np.array(profile, float)
    grid = np.stack([p[:, :1] * np.cos(u), p[:, :1] * np.sin(u), p[:, 1:] + 0 * u], 2)
    return closed_by_poles(grid, [0, 0, p[0, 1]], [0, 0, p[-1, 1]])


def tube(around):
    """Makes a pipe: a profile that closes on itself."""
    u = 2 * np.pi * np.arange(around) / around
    p = np.array([(8, 0), (12, 0), (12, 10), (12, 20), (8, 20), (8, 10)], float)
    grid = np.stack([p[:, :1] * np.cos(u), p[:, :1] * np.sin(u), p[:, 1:] + 0 * u], 2)
    return turned_outward(*from_grid(grid, True, True))


def extruded(outline, quads, height):
    """Extrudes an outline whose inside is cut into quads."""
    n = len(outline)
    low = np.column_stack([outline, np.zeros(n)])
    faces = [(k, (k + 1) % n, n + (k + 1) % n) for k in range(n)]
    faces += [(k, n + (k + 1) % n, n + k) for k in range(n)]
    for a, b, c, d in quads:
        faces += [(a, c, b), (a, d, c), (n + a, n + b, n + c), (n + a, n + c, n + d)]
    return turned_outward(np.vstack([low, low + [0, 0, height]]), np.array(faces))


def bracket():
    outline = np.array([(0, 0), (10, 0), (30, 0), (30, 10), (10, 10), (10, 40), (0, 40), (0, 10)], float)
    return extruded(outline, [(0, 1, 4, 7), (1, 2, 3, 4), (7, 4, 5, 6)], 15)


def star():
    t = 2 * np.pi * np.arange(10) / 10
    r = np.where(np.arange(10) % 2, 8.0, 20.0)
    outline = np.stack([r * np.cos(t), r * np.sin(t)], 1)
    low = np.column_stack([outline, 0 * t])
    points = np.vstack([low, low + [0, 0, 12], [0, 0, 0], [0, 0, 12]])
    faces = []
    for k in range(10):
        m = (k + 1) % 10
        faces += [(k, m, 10 + m), (k, 10 + m, 10 + k), (20, m, k), (21, 10 + k, 10 + m)]
    return turned_outward(points, np.array(faces))


def relief(n):
    """Makes a block whose lid is a relief."""
    points, faces = box((30, 30, 8), n)
    x, y, z = points.T
    lift = 2 * np.sin(0.3 * x + 1) * np.cos(0.4 * y) + 0.5 * np.sin(x * y * 0.05)
    return np.stack([x, y, z + z / 8 * lift], 1), faces


def bumpy(n, m):
    """Makes a ball with bumps, far from round."""
    points, faces = ball(n, m, 1.0)
    x, y, z = points.T
    r = 14 + 3 * np.sin(4 * x + 1) * np.cos(5 * y) + 2 * np.sin(6 * z)
    return points * r[:, None], faces


def joined(*meshes):
    points, faces, count = [], [], 0
    for p, f in meshes:
        points.append(p)
        faces.append(f + count)
        count += len(p)
    return np.vstack(points), np.vstack(faces)


def moved(mesh, by, scale=1.0):
    return scale * mesh[0] + np.array(by), mesh[1]


def inverted(mesh):
    return mesh[0], mesh[1][:, ::-1]


def tilted(mesh):
    """Turns a mesh, so that coordinates are no round numbers."""
    a, b = 0.7, 0.4
    x = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    z = np.array([[np.cos(b), -np.sin(b), 0], [np.sin(b), np.cos(b), 0], [0, 0, 1]])
    return mesh[0] @ (z @ x).T, mesh[1]


SOUND = {
    "cube": lambda: box((20, 20, 20)),
    "cells": lambda: box((20, 20, 20), 8),
    "tilted": lambda: tilted(box((30, 20, 10), 5)),
    "tetrahedron": lambda: (np.array([(0, 0, 0), (20, 0, 0), (0, 20, 0), (0, 0, 20.0)]),
                            np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)])),
    "torus": lambda: torus(20, 7, 60, 24),
    "ring": lambda: tilted(torus(30, 1, 90, 10)),
    "ball": lambda: ball(24, 36),
    "icosphere": lambda: icosphere(3),
    "cylinder": lambda: turned([(10, 0), (10, 10), (10, 30)], 48),
    "cone": lambda: turned([(12, 0), (6, 12), (1, 22)], 40),
    "star": star,
    "bracket": bracket,
    "tube": lambda: tube(40),
    "spring": lambda: spring(120, 12),
    "knot": lambda: knot(160, 12),
    "hollow": lambda: joined(ball(16, 24), inverted(ball(12, 18, 12.0))),
    "two": lambda: joined(ball(12, 20, 10.0), moved(box((15, 15, 15), 4), (14, 0, 0))),
    "plate": lambda: (box((60, 60, 60), 12)[0] * [1, 1, 0.01], box((60, 60, 60), 12)[1]),
    "relief": lambda: relief(14),
    "bumpy": lambda: bumpy(30, 40),
}

# Sizes other than millimetres: the same mesh many times smaller or larger.
SCALES = {"icosphere": 1e-4, "bracket": 1e4, "ring": 1e-2}


def make(name):
    """Returns vertices of single precision, and faces."""
    points, faces = SOUND[name]()
    return (points * SCALES.get(name, 1)).astype(np.float32), np.asarray(faces, np.int64)
