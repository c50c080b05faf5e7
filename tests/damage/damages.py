"""Damages sound meshes in 25 ways. Each returns corners, n x 3 x 3, and the volume of what was meant."""

import numpy as np
from sound_meshes import volume

F = np.float32


def corners_of(points, faces):
    return points[faces].astype(F)


def edge_of(corners):
    """Returns the mean length of edges."""
    return float(np.linalg.norm(corners - np.roll(corners, 1, 1), axis=2).mean())


def ulps(x, steps):
    """Moves numbers by a number of the smallest steps."""
    x = np.array(x, F)
    for _ in range(int(np.abs(steps).max())):
        x = np.where(steps > 0, np.nextafter(x, F(np.inf)), np.where(steps < 0, np.nextafter(x, F(-np.inf)), x))
        steps = steps - np.sign(steps)
    return x


def half_of(corners, rng):
    """Marks the triangles on one side of a plane through the middle."""
    middle = corners.mean(1)
    normal = rng.normal(size=3)
    height = (middle - np.median(middle, 0)) @ normal
    return height > np.median(height) if len(corners) > 4 else np.arange(len(corners)) < 2


def seam(corners, rng, most):
    side = half_of(corners, rng)
    out = corners.copy()
    keys, index = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    index = index.reshape(-1)
    other = ulps(keys, rng.integers(-most, most + 1, keys.shape))
    out[side] = other[index].reshape(corners.shape)[side]
    return out


def seam1(corners, rng):
    return seam(corners, rng, 1)


def seam8(corners, rng):
    return seam(corners, rng, 8)


def rounded(corners, rng):
    """Every corner is off by its own few steps."""
    return ulps(corners, rng.integers(-3, 4, corners.shape))


def apart(corners, rng, share):
    """Every triangle lies a little beside its place."""
    by = rng.uniform(-1, 1, (len(corners), 1, 3))
    by /= np.linalg.norm(by, axis=2, keepdims=True)
    return (corners + share * edge_of(corners) * by).astype(F)


def shrunk(corners, rng, share):
    """Every triangle is smaller than its place."""
    middle = corners.mean(1, keepdims=True)
    away = corners - middle
    lengths = np.linalg.norm(away, axis=2, keepdims=True)
    return (middle + away * (1 - share * edge_of(corners) / np.maximum(lengths, 10 * share * edge_of(corners)))).astype(F)


def gap6(corners, rng):
    return apart(corners, rng, 1e-6)


def gap5(corners, rng):
    return shrunk(corners, rng, 1e-5)


def gap4(corners, rng):
    return apart(corners, rng, 1e-4)


def gap3(corners, rng):
    return shrunk(corners, rng, 1e-3)


def gap2(corners, rng):
    """The widest gaps: a hundredth of the mean edge between neighbours."""
    return shrunk(corners, rng, 5e-3)


def tjunctions(corners, rng):
    """One side of the mesh is four times as fine; rounding leaves cracks."""
    side = half_of(corners, rng)
    fine = corners[side].astype(float)
    a, b, c = fine[:, 0], fine[:, 1], fine[:, 2]
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    parts = [np.stack(t, 1) for t in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))]
    return np.concatenate([corners[~side], *parts]).astype(F)


def split_edges(corners, rng):
    """Single triangles are cut at random points of their edges, their neighbours are not."""
    out = []
    for t in corners.astype(float):
        if rng.random() < 0.7:
            out.append(t)
            continue
        k = rng.integers(3)
        a, b, c = t[k], t[(k + 1) % 3], t[(k + 2) % 3]
        at = np.sort(rng.uniform(0.2, 0.8, rng.integers(1, 4)))
        chain = [a] + [a + s * (b - a) for s in at] + [b]
        out += [np.array([p, q, c]) for p, q in zip(chain, chain[1:])]
    return np.array(out).astype(F)


def doubled(corners, rng):
    some = rng.random(len(corners)) < 0.1
    some[0] = True
    return np.concatenate([corners, corners[some]])


def doubled_shell(corners, rng):
    return np.concatenate([corners, corners])


def tent_on(t, height):
    """Makes a tetrahedron that stands on a triangle."""
    middle = t.mean(0)
    normal = np.cross(t[1] - t[0], t[2] - t[0])
    normal /= np.linalg.norm(normal)
    top = middle + height * normal
    a, b, c = t
    return np.array([[a, c, b], [a, b, top], [b, c, top], [c, a, top]])


def choose_large(corners, rng):
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return int(rng.choice(np.argsort(area)[-max(1, len(area) // 4):]))


def shared_wall(corners, rng):
    """A small solid stands on a triangle: the wall is there twice, or in a random half of cases once."""
    t = corners[choose_large(corners, rng)].astype(float)
    tent = tent_on(t, 0.05 * np.linalg.norm(t[1] - t[0]))
    return np.concatenate([corners, tent.astype(F)]), volume(corners) + volume(tent)


def touching(corners, rng):
    """The mirror image touches the mesh, in walls, edges or points."""
    axis = int(rng.integers(3))
    other = corners[:, ::-1].copy()
    other[:, :, axis] = 2 * corners[:, :, axis].max() - other[:, :, axis]
    return np.concatenate([corners, other]), 2 * volume(corners)


def spike(corners, rng):
    """A small solid goes through the surface: a tetrahedron that stands on its tip, inside."""
    t = corners[choose_large(corners, rng)].astype(float)
    height = 0.02 * np.linalg.norm(t[1] - t[0])
    normal = np.cross(t[1] - t[0], t[2] - t[0])
    normal /= np.linalg.norm(normal)
    middle = t.mean(0)
    top = middle + 0.4 * (t - middle) + height * normal
    tip = middle - height * normal
    a, b, c = top
    solid = np.array([[a, b, c], [a, tip, b], [b, tip, c], [c, tip, a]])
    return np.concatenate([corners, solid.astype(F)]), volume(corners) + volume(solid) * 7 / 8


def flipped(corners, rng):
    some = rng.random(len(corners)) < 0.1
    some[0] = True
    return np.where(some[:, None, None], corners[:, ::-1], corners)


def inside_out(corners, rng):
    return corners[:, ::-1].copy()


def half_flipped(corners, rng):
    side = half_of(corners, rng)
    return np.where(side[:, None, None], corners[:, ::-1], corners)


def hole(corners, rng):
    """One triangle is missing: one that is not large, since nobody knows what was there."""
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return np.delete(corners, int(np.argsort(area)[len(area) // 3]), 0)


def holes(corners, rng):
    """Triangles that are not neighbours are missing."""
    out, taken = [], set()
    limit = max(1, len(corners) // 50)
    gone = 0
    order = rng.permutation(len(corners))
    keep = np.ones(len(corners), bool)
    for t in order:
        points = {tuple(p) for p in corners[t]}
        if gone < limit and not points & taken:
            keep[t] = False
            taken |= points
            gone += 1
    return corners[keep]


def debris(corners, rng):
    """Single triangles fly around, and lie inside."""
    low, high = corners.reshape(-1, 3).min(0), corners.reshape(-1, 3).max(0)
    at = rng.uniform(high + 0.1 * (high - low), high + 0.5 * (high - low), (12, 1, 3))
    return np.concatenate([corners, (at + 0.02 * (high - low).max() * rng.normal(size=(12, 3, 3))).astype(F)])


def slivers(corners, rng):
    """Triangles without area lie in edges, and some without length."""
    out = list(corners)
    for k in rng.permutation(len(corners))[: max(2, len(corners) // 20)]:
        t = corners[k]
        out.append(np.array([t[0], t[1], t[1]]))
        out.append(np.array([t[1], t[0], t[0]]))
        out.append(np.array([t[2], t[2], t[2]]))
    return np.array(out, F)


def sliver_joints(corners, rng):
    """Neighbours meet through a triangle without area: the vertex on the edge is in one of them alone."""
    out = []
    for n, t in enumerate(corners.astype(float)):
        if n % 7:
            out.append(t)
            continue
        a, b, c = t
        m = ((a + b) / 2).astype(F)
        out += [np.array([a, m, c]), np.array([m, b, c]), np.array([a, b, m])]
    return np.array(out).astype(F)


def shuffled(corners, rng):
    """The order is random, and each triangle begins anywhere."""
    out = corners[rng.permutation(len(corners))]
    return np.array([np.roll(t, int(rng.integers(3)), 0) for t in out])


def slit(corners, rng):
    """One side has moved away by a few ten-thousandths of an edge."""
    side = half_of(corners, rng)
    by = rng.normal(size=3)
    by *= 3e-4 * edge_of(corners) / np.linalg.norm(by)
    return np.where(side[:, None, None], corners + by, corners).astype(F)


def everything(corners, rng):
    """Flipped, doubled, missing and apart at once."""
    return apart(flipped(doubled(holes(corners, rng), rng), rng), rng, 1e-4)


DAMAGES = {f.__name__: f for f in (
    seam1, seam8, rounded, gap6, gap5, gap4, gap3, gap2, slit, tjunctions, split_edges, doubled, doubled_shell,
    shared_wall, touching, spike, flipped, inside_out, half_flipped, hole, holes, debris, slivers, sliver_joints,
    everything)}


def damage(kind, points, faces, rng):
    """Returns the corners of a damaged mesh in any order, and the volume that a repair should give."""
    corners = corners_of(points, faces)
    made = DAMAGES[kind](corners, rng)
    made, meant = made if isinstance(made, tuple) else (made, volume(corners))
    return shuffled(made.astype(F), rng), meant
