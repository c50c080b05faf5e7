"""Tests that meshes share memory with the library, and keep it."""

import gc
import sys
import tempfile
import types
import unittest.mock
import weakref
from pathlib import Path

import cubewright as cw
import numpy as np
from support import Case, main, make_ball

FIELDS = {"vertices": "positions", "normals": "normals", "triangles": "triangles", "scalars": "scalars",
          "colors": "colors", "labels": "labels"}  # fmt: skip


def pointer_of(mesh, name):
    return cw._memory.find_address(getattr(mesh._struct, FIELDS[name]))


def make_tetrahedron():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "f4")
    triangles = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], "u4")
    return vertices, triangles


class Sharing(Case):
    def test_arrays_are_the_memory_of_the_library(self):
        mesh = cw.extract(make_ball(), 0)
        for name in ("vertices", "normals", "triangles"):
            array = getattr(mesh, name)
            self.assertEqual(array.ctypes.data, pointer_of(mesh, name), name)
            self.assertIs(array.flags.owndata, False)
        self.assertEqual((mesh.scalars, mesh.colors, mesh.labels), (None, None, None))
        self.assertEqual((mesh.vertices.dtype, mesh.triangles.dtype), (np.float32, np.uint32))

    def test_given_arrays_are_used_as_they_are(self):
        vertices, triangles = make_tetrahedron()
        colors, labels = np.full((4, 4), 200, "u1"), np.arange(4, dtype="u4")
        scalars = np.arange(4, dtype="f4")
        mesh = cw.Mesh.from_arrays(vertices, triangles, scalars=scalars, colors=colors, labels=labels)
        given = {"vertices": vertices, "triangles": triangles, "scalars": scalars, "colors": colors, "labels": labels}
        for name, array in given.items():
            self.assertIs(getattr(mesh, name), array)
            self.assertEqual(pointer_of(mesh, name), array.ctypes.data, name)
        self.assertAlmostEqual(cw.check(mesh).quality["volume_mm3"], 1 / 6)

    def test_other_types_and_strides_are_converted(self):
        vertices, triangles = make_tetrahedron()
        for v, t in (
            (vertices.astype("f8"), triangles.astype("i8")),
            (vertices.tolist(), triangles.tolist()),
            (np.asfortranarray(vertices), triangles.astype(">u4")),
            (np.repeat(vertices, 2, axis=0)[::2], triangles[::-1]),
        ):
            self.assertAlmostEqual(cw.check(cw.Mesh.from_arrays(v, t)).quality["volume_mm3"], 1 / 6)

    def test_arrays_outlive_the_mesh_and_then_memory_is_freed(self):
        gc.collect()
        before = cw.memory_used()
        mesh = cw.extract(make_ball(), 0)
        vertices, alive = mesh.vertices, weakref.ref(mesh._owner)
        held = cw.memory_used()
        self.assertGreater(held, before)
        total = vertices.sum()
        del mesh
        gc.collect()
        self.assertEqual((cw.memory_used(), vertices.sum()), (held, total))
        part = vertices[3:7]
        del vertices
        gc.collect()
        self.assertIsNotNone(alive())
        del part
        gc.collect()
        self.assertIsNone(alive())
        self.assertEqual(cw.memory_used(), before)

    def test_a_thousand_meshes_leave_nothing_without_the_collector(self):
        ball = make_ball(8)
        cw.extract(ball, 0)
        gc.collect()
        before = cw.memory_used()
        gc.disable()
        try:
            for _ in range(1000):
                cw.extract(ball, 0, threads=1, progress=lambda step, done: True)
            self.assertEqual(cw.memory_used(), before)
            self.assertLess(gc.collect(), 100)
        finally:
            gc.enable()

    def test_writing_to_arrays_moves_the_mesh(self):
        mesh = cw.extract(make_ball(), 0)
        bounds = mesh.bounds
        mesh.vertices[:] += 10
        mesh.origin[:] += [1, 2, 3]
        self.assertTrue(np.allclose(mesh.bounds - bounds, [11, 12, 13]))

    def test_a_copy_has_its_own_memory(self):
        mesh = cw.extract(make_ball(), 0)
        other = mesh.copy()
        self.same_mesh(mesh, other)
        self.assertFalse(np.shares_memory(mesh.vertices, other.vertices))
        self.assertTrue(np.array_equal(mesh.affine, other.affine))


class Coordinates(Case):
    def test_world_vertices_keep_what_single_precision_loses(self):
        far = (1e7, -2e7, 3e7)
        near, moved = cw.extract(make_ball(), 0), cw.extract(cw.Volume(make_ball(), origin=far), 0)
        world = moved.world_vertices()
        self.assertEqual(world.dtype, np.float64)
        self.assertLess(np.abs(world - far - near.world_vertices()).max(), 1e-5)
        self.assertLess(np.abs(moved.vertices).max(), 100)

    def test_smooth_removes_noise_within_its_limit(self):
        ball = cw.extract(make_ball(), 0)
        rng = np.random.default_rng(3)
        noisy = ball.copy()
        noisy.vertices[:] += rng.normal(0, 0.15, noisy.vertices.shape)
        first = noisy.vertices.copy()
        found = cw.smooth(noisy, max_move=0.4, threads=2)
        self.assertIsInstance(found, cw.Smoothed)
        np.testing.assert_array_equal(noisy.vertices, first)
        moves = np.linalg.norm(found.mesh.vertices.astype("f8") - first, axis=1)
        self.assertLessEqual(moves.max(), 0.4)
        self.assertEqual((found.limit, found.border, found.undecided), (0.4, 0, False))
        self.assertAlmostEqual(found.max_move, moves.max(), 9)
        self.assertAlmostEqual(found.mean_move, moves.mean(), 9)
        self.assertAlmostEqual(found.volume_after / found.volume_before, 1, 5)

        def find_noise(mesh):
            radii = np.linalg.norm(mesh.world_vertices() - 11.5, axis=1)
            return radii.std()

        self.assertLess(find_noise(found.mesh), 0.6 * find_noise(noisy))
        np.testing.assert_array_equal(found.mesh.triangles, noisy.triangles)
        normals = found.mesh.normals
        self.assertFalse(np.array_equal(normals, noisy.normals))
        np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-6)
        fair = cw.smooth(noisy, method="fair", width=8, max_move=0.4)
        self.assertLess(fair.mean_move, found.mean_move)
        self.assertEqual((fair.junction, fair.border), (0, 0))
        self.assertEqual(cw.smooth(noisy, iterations=1).mesh.vertices.shape, first.shape)
        for wrong in (
            lambda: cw.smooth(noisy, iterations=0),
            lambda: cw.smooth(noisy, method="loop"),
            lambda: cw.smooth(noisy, width=2),
            lambda: cw.smooth(noisy, method="fair", width=-2),
            lambda: cw.smooth(noisy, max_move=-1),
            lambda: cw.smooth(noisy, max_move=float("nan")),
        ):
            self.assertRaises(ValueError, wrong)
        self.assertRaises(TypeError, lambda: cw.smooth(first))
        with self.fails(cw.Status.CANCELLED):
            cw.smooth(noisy, progress=lambda *_: False)

    def test_an_atlas_lies_flat(self):
        ball = cw.extract(make_ball(), 0)
        found = cw.atlas(ball, size=512, margin=4, threads=2)
        self.assertIsInstance(found, cw.Atlas)
        self.assertNotIn("texture_coordinates", ball.attributes)
        uv = found.mesh.attributes["texture_coordinates"].astype("f8").reshape(-1, 3, 2)
        self.assertEqual(len(uv), len(ball.triangles))
        self.assertTrue((uv >= 0).all() and (uv <= 1).all())
        first, second = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
        area = -(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]) / 2  # the image's rows go down
        self.assertGreaterEqual(area.min(), 0)
        self.assertAlmostEqual(area.sum(), found.coverage, 5)
        self.assertEqual((found.size, found.flipped), (512, 0))
        self.assertLess(found.stretch, 1.3)
        self.assertGreater(found.vertices, len(ball.vertices))
        for wrong in (
            lambda: cw.atlas(ball, size=63),
            lambda: cw.atlas(ball, margin=65),
            lambda: cw.atlas(ball, max_stretch=float("nan")),
        ):
            self.assertRaises(ValueError, wrong)
        for wrong in ({"max_stretch": 0.5}, {"texels_per_mm": 1e6}, {"texels_per_mm": -1}):
            with self.fails(cw.Status.ARGUMENT):
                cw.atlas(ball, **wrong)
        with self.fails(cw.Status.CANCELLED):
            cw.atlas(ball, progress=lambda *_: False)

    def test_simplified_meshes_keep_their_texture(self):
        full = cw.atlas(cw.extract(make_ball(), 0), size=256).mesh
        try:
            low = cw.simplify(full, ratio=0.5)
        except cw.Error as error:
            self.assertEqual(error.status, cw.Status.UNSUPPORTED)
            return
        moved = cw.texture_distance(low, full, threads=2)
        self.assertTrue(0 < moved.mean_distance < moved.max_distance < 2)
        self.assertGreater(moved.side, 1)
        self.assertGreater(moved.samples, 3 * len(low.triangles))
        with self.fails(cw.Status.ARGUMENT):
            cw.texture_distance(low, cw.extract(make_ball(), 0))

    def test_normal_maps_are_baked_and_written(self):
        low = cw.atlas(cw.extract(make_ball(), 0), size=256).mesh
        self.assertIsNotNone(low.normals)
        baked = cw.bake_normals(low, low, size=256, threads=2)
        self.assertEqual((baked.image.shape, baked.missed), ((256, 256, 4), 0))
        self.assertLess(np.abs(baked.image.astype(int) - (128, 128, 255, 255)).max(), 2)
        self.assertGreater(baked.texels, 0.3 * 256**2)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "a.glb"
            try:
                cw.write(path, [cw.Part("low", low, normal_map=baked.image)])
            except cw.Error as error:
                self.assertEqual(error.status, cw.Status.UNSUPPORTED)
            else:
                data = path.read_bytes()
                self.assertIn(b'"normalTexture"', data)
                self.assertIn(b"\x89PNG", data)
                cw.write(path, [cw.Part("low", low, pictures={"color": b"\xff\xd8 jpeg"})])
                part = cw.read_parts(path)[0]
                self.assertEqual(part.pictures, {"color": b"\xff\xd8 jpeg"})
                self.assertEqual(len(part.mesh.attributes["texture_coordinates"]), 3 * len(low.triangles))
                with self.assertRaises(ValueError):
                    cw.write(path, [cw.Part("low", low, pictures={"colour": b""})])
        self.assertRaises(ValueError, lambda: cw.bake_normals(low, low, size=8))
        with tempfile.TemporaryDirectory() as folder:
            png = Path(folder) / "red.png"
            cw.write_png(png, np.full((8, 8, 4), (255, 0, 0, 255), np.uint8))
            old = cw.Part("old", low, pictures={"color": png.read_bytes()})
            try:
                found = cw.bake_pictures(low, [old], size=64)
            except cw.Error as error:
                self.assertEqual(error.status, cw.Status.UNSUPPORTED)
            else:
                self.assertEqual(list(found), ["color"])
                self.assertTrue((found["color"] == (255, 0, 0, 255)).all(axis=2).mean() > 0.3)
        with self.fails(cw.Status.ARGUMENT):
            cw.bake_normals(cw.extract(make_ball(), 0), low)
        with self.fails(cw.Status.CANCELLED):
            cw.bake_normals(low, low, size=64, progress=lambda *_: False)

    def test_looks_are_compared(self):
        ball = cw.extract(make_ball(), 0)
        same = cw.appearance(ball, ball, size=64, threads=2)
        self.assertEqual((same.with_maps.rmse, same.with_maps.psnr, same.with_maps.delta_e), (0, np.inf, 0))
        self.assertEqual((same.size, len(same.views), same.with_maps), (64, 8, same.without_maps))
        low = cw.atlas(ball, size=128).mesh
        bent = np.full((128, 128, 4), (200, 128, 235, 255), np.uint8)
        mapped = cw.Part("low", low, normal_map=bent)
        found = cw.appearance(ball, [mapped], views=3, size=64)
        self.assertGreater(found.with_maps.delta_e, 5)
        self.assertEqual(found.without_maps.rmse, 0)
        self.assertEqual(found.views[found.worst].rmse, max(v.rmse for v in found.views))
        self.assertEqual(sum(v.pixels for v in found.views), found.with_maps.pixels)
        self.assertEqual(len(found.places), 3)
        self.assertAlmostEqual(found.places[1][0], 137.508, 2)
        self.assertAlmostEqual(found.places[1][1], 0)
        picture = cw.appearance_view(ball, mapped, 2, views=3, size=64)
        self.assertEqual((picture.shape, picture[0, 0].tolist()), ((64, 64, 4), [0, 0, 0, 0]))
        self.assertEqual(picture[32, 32, 3], 255)
        for wrong in (lambda: cw.appearance(ball, ball, views=65), lambda: cw.appearance(ball, ball, size=8)):
            self.assertRaises(ValueError, wrong)
        self.assertRaises(TypeError, lambda: cw.appearance("ball", ball))
        with self.fails(cw.Status.ARGUMENT):
            cw.appearance(ball, cw.Part("bare", ball, normal_map=bent))
        with self.fails(cw.Status.CANCELLED):
            cw.appearance(ball, ball, size=64, progress=lambda *_: False)

    def test_small_handles_are_closed(self):
        noise = cw.make("sphere", dims=32, noise=6)
        mesh = cw.extract(noise, 0, largest=1, fill_voids=True)
        first = mesh.vertices.copy()
        found = cw.close_handles(mesh, "20mm", threads=2)
        self.assertIsInstance(found, cw.Closed)
        np.testing.assert_array_equal(mesh.vertices, first)
        self.assertGreater(found.handles_before, 50)
        self.assertEqual((found.handles_after, found.left_long, found.left_crossing), (0, 0, 0))
        self.assertEqual(found.cut + found.filled, found.handles_before)
        self.assertTrue(0 < found.change < 3)
        checked = cw.check(found.mesh).quality
        self.assertEqual((checked["genus"], checked["open_edges"]), (0, 0))
        short = cw.close_handles(mesh)
        self.assertGreater(short.handles_after, 0)
        self.assertAlmostEqual(short.length, cw.close_handles(mesh, "3%").length)
        same = cw.close_handles(found.mesh, 5.0)
        self.same_mesh(same.mesh, found.mesh)
        for wrong in (-1, 0, "4", "4vox", float("nan")):
            self.assertRaises(ValueError, lambda: cw.close_handles(mesh, wrong))
        self.assertRaises(TypeError, lambda: cw.close_handles(first))
        with self.fails(cw.Status.CANCELLED):
            cw.close_handles(mesh, progress=lambda *_: False)

    def test_volumes_color_meshes(self):
        ball = make_ball()
        mesh = cw.extract(ball, 0)
        found = cw.color_by(mesh, ball, colormap="gray", low=-1, high=1)
        self.assertIsNone(mesh.colors)
        self.assertLess(np.abs(found.scalars).max(), 0.2)
        self.assertTrue((np.abs(found.colors[:, :3].astype(int) - 128) < 32).all())
        self.assertTrue((found.colors[:, 3] == 255).all())
        self.assertRaises(ValueError, lambda: cw.color_by(mesh, ball, colormap="jet"))
        with self.fails(cw.Status.ARGUMENT):
            cw.color_by(mesh, ball, low=2, high=1)

    def test_cut_closes_flat(self):
        ball = cw.extract(make_ball(), 0)
        point = ball.vertices.mean(axis=0) + ball.origin
        found = cw.cut(ball, point, (0, 0, 2))
        self.assertIsInstance(found, cw.Cut)
        self.assertEqual((found.loops_closed, found.loops_open), (1, 0))
        self.assertGreater(found.area, 0)
        self.assertTrue(cw.check(found.mesh, profile="print").holds)
        self.assertEqual(cw.cut(ball, point, (1, 2, 3), leave_open=True).cap_triangles, 0)
        with self.fails(cw.Status.ARGUMENT):
            cw.cut(ball, point, (0, 0, 0))
        with self.fails(cw.Status.EMPTY):
            cw.cut(ball, (0, 0, 1e6), (0, 0, 1))
        self.assertRaises(ValueError, lambda: cw.cut(ball, (0, 0), (0, 0, 1)))

    def test_repair_fills_drops_and_counts(self):
        ball = cw.extract(make_ball(), 0)
        triangles = np.concatenate([ball.triangles[5:], ball.triangles[50:60], ball.triangles[:1, ::-1]])
        scalars = ball.vertices[:, 2].copy()
        broken = cw.Mesh.from_arrays(ball.vertices, triangles, scalars=scalars, origin=ball.origin)
        first = broken.triangles.copy()
        found = cw.repair(broken, threads=2)
        self.assertIsInstance(found, cw.Repaired)
        self.assertTrue(found.sound and found.needed and not found.wrapped)
        self.assertEqual((found.duplicates, found.flipped_triangles, found.holes_left), (10, 1, 0))
        self.assertGreaterEqual(found.holes_filled, 1)
        np.testing.assert_array_equal(broken.triangles, first)
        self.assertTrue(cw.check(found.mesh, profile="print").holds)
        self.assertEqual(len(found.mesh.scalars), len(found.mesh.vertices))
        self.assertTrue(cw.check(cw.repair(ball).mesh, profile="print").holds)
        self.assertFalse(cw.repair(ball).needed)
        told = cw.repair(broken, report_only=True)
        self.assertIsNone(told.mesh)
        self.assertEqual(told.holes_filled, found.holes_filled)
        self.assertFalse(told.refused)
        self.assertEqual(cw.repair(broken, fill=0.01).holes_filled, 0)
        hollow = cw.hollow(ball, wall=2)
        full = cw.repair(hollow, outer=True)
        self.assertEqual((full.inner_shells, cw.repair(hollow).inner_shells), (1, 0))
        self.assertAlmostEqual(full.inner, full.volume_after - cw.repair(hollow).volume_after, delta=1e-3)
        for wrong in (lambda: cw.repair(broken, weld=-1), lambda: cw.repair(broken, wrap=float("inf"))):
            self.assertRaises(ValueError, wrong)
        self.assertRaises(TypeError, lambda: cw.repair(first))
        sheet = cw.Mesh.from_arrays(ball.vertices, ball.triangles[:1])
        with self.fails(cw.Status.EMPTY):
            cw.repair(sheet)
        with self.fails(cw.Status.CANCELLED):
            cw.repair(broken, progress=lambda *_: False)

    def test_remesh_makes_even_triangles(self):
        ball = cw.extract(make_ball(), 0)
        first = ball.triangles.copy()
        size = float(np.ptp(ball.vertices, axis=0).max())
        found = cw.remesh(ball, size / 15, min_angle=25, threads=2)
        self.assertIsInstance(found, cw.Remeshed)
        self.assertGreater(found.fitting_edges, 0.8)
        self.assertEqual((found.beyond, found.below, found.border), (0, 0, 0))
        self.assertTrue(cw.check(found.mesh, profile="print").holds)
        np.testing.assert_array_equal(ball.triangles, first)
        self.assertLess(cw.remesh(ball, size / 5, adaptive=True, error=size / 500).max_edge, size / 3)
        for wrong in (lambda: cw.remesh(ball, -1), lambda: cw.remesh(ball, 1, error=float("inf"))):
            self.assertRaises(ValueError, wrong)
        with self.fails(cw.Status.ARGUMENT):
            cw.remesh(ball, size, min_angle=50)
        with self.fails(cw.Status.CANCELLED):
            cw.remesh(ball, size / 15, progress=lambda *_: False)

    def test_pieces_go_together(self):
        ball = cw.extract(make_ball(), 0)
        low, high = ball.vertices.min(axis=0) + ball.origin, ball.vertices.max(axis=0) + ball.origin
        size = float((high - low).max())
        middle = tuple((low + high) / 2)
        planes = [(middle, (0, 0, 1)), (middle, (1, 0.5, 0))]
        cut = cw.cut_pieces(ball, planes, pegs=1, clearance=size / 200, threads=2)
        self.assertIsInstance(cut, cw.Pieces)
        self.assertEqual([piece.name for piece in cut.pieces], ["piece-1", "piece-2", "piece-3", "piece-4"])
        self.assertEqual((cut.pegs, cut.missing, cut.plates), (4, 0, 0))
        self.assertAlmostEqual(sum(p.volume for p in cut.pieces) / (cut.volume - cut.gaps), 1, places=9)
        self.assertLess(cut.farthest, 1e-5 * size)
        self.assertLess(cut.overlap, 1e-5 * cut.volume)
        for piece in cut.pieces:
            self.assertTrue(cw.check(piece.mesh, profile="print").holds)
            self.assertIn("section", piece.mesh.attributes)
        laid = cw.cut_pieces(ball, plate=(0.7 * size,) * 3, pegs=1, dowels=True, clearance=size / 200, lay=True)
        self.assertEqual(len(laid.pieces), 8 + laid.pegs)
        self.assertTrue(all(p.plate >= 1 and abs(p.mesh.vertices[:, 2].min() + p.mesh.origin[2]) < 1e-4 * size for p in laid.pieces))
        with self.fails(cw.Status.ARGUMENT):
            cw.cut_pieces(ball, [((0, 0, 9 * size), (0, 0, 1))])
        with self.fails(cw.Status.CHECK):
            cw.cut_pieces(ball, planes, pegs=1, peg_diameter=size)
        with self.fails(cw.Status.CANCELLED):
            cw.cut_pieces(ball, planes, progress=lambda *_: False)
        self.assertRaises(TypeError, lambda: cw.cut_pieces(ball, planes, pegs=1.5))

    def test_text_is_engraved(self):
        ball = cw.extract(make_ball(), 0)
        size = float(np.ptp(ball.vertices, axis=0).max())
        cut = cw.engrave(ball, "No. 1")
        self.assertIsInstance(cut, cw.Engraved)
        self.assertTrue(cw.check(cut.mesh, profile="basic").holds)
        self.assertGreater(cut.volume, 0)
        self.assertLess(abs(cut.right[2]), 1e-9)
        low, high = ball.vertices.min(axis=0) + ball.origin, ball.vertices.max(axis=0) + ball.origin
        top = tuple((low + high) / 2 + (0, 0, size))
        raised = cw.engrave(ball, "+", size=size / 8, at=top, emboss=True, threads=2)
        self.assertGreater(raised.normal[2], 0.99)
        self.assertAlmostEqual(raised.depth, size / 64)
        self.assertGreater(raised.mesh.vertices[:, 2].max(), ball.vertices[:, 2].max())
        while_made = cw.extract(make_ball(), 0, engrave={"text": "No. 1"})
        self.assertEqual(len(while_made.triangles), len(cut.mesh.triangles))
        self.assertIn("engrave", while_made.facts["ran"])
        with self.fails(cw.Status.ARGUMENT):
            cw.engrave(ball, "\u4711")
        with self.fails(cw.Status.CHECK):
            cw.engrave(ball, "far too large", size=size)
        with self.fails(cw.Status.CANCELLED):
            cw.engrave(ball, "1", progress=lambda *_: False)
        self.assertRaises(TypeError, lambda: cw.engrave(ball, 5))

    def test_boolean_adds_up(self):
        ball = cw.extract(make_ball(), 0)
        size = float(np.ptp(ball.vertices, axis=0).max())
        other = cw.Mesh.from_arrays(ball.vertices, ball.triangles, origin=np.array(ball.origin) + (size / 3, 0, 0))
        first = ball.triangles.copy()
        one = cw.boolean([ball, other])
        both = cw.boolean([ball, other], "intersection", threads=2)
        parts = cw.boolean([ball, other], "split")
        self.assertIsInstance(one, cw.Combined)
        volume = cw.check(ball).quality["volume_mm3"]
        self.assertAlmostEqual((one.volumes[0] + both.volumes[0]) / (2 * volume), 1, places=5)
        self.assertAlmostEqual(sum(parts.volumes) / volume, 1, places=5)
        self.assertEqual(len(parts.meshes), 2)
        for mesh in (one.mesh, both.mesh, *parts.meshes):
            self.assertTrue(cw.check(mesh, profile="print").holds)
        self.assertEqual(set(one.mesh.attributes["input"].ravel()), {0, 1})
        np.testing.assert_array_equal(ball.triangles, first)
        far = cw.Mesh.from_arrays(ball.vertices, ball.triangles, origin=np.array(ball.origin) + (9 * size, 0, 0))
        back = np.concatenate((ball.triangles, ball.triangles[:, ::-1] + len(ball.vertices)))
        beside = np.concatenate((ball.vertices, ball.vertices / 2 + (9 * size, 0, 0)))
        lost = cw.boolean([cw.Mesh.from_arrays(ball.vertices, ball.triangles[:, ::-1]), cw.Mesh.from_arrays(beside, back)])
        self.assertEqual((lost.turned, lost.empty, lost.inside_out), ((0,), (), (1,)))
        self.assertAlmostEqual(lost.inside_out_volume / volume, 1 / 8, places=5)
        self.assertEqual(len(cw.boolean([ball, far], "intersection").mesh.triangles), 0)
        self.assertRaises(ValueError, lambda: cw.boolean([ball, other], "minus"))
        self.assertRaises(TypeError, lambda: cw.boolean([ball, 1]))
        with self.fails(cw.Status.ARGUMENT):
            cw.boolean([])
        with self.fails(cw.Status.CHECK):
            cw.boolean([cw.Mesh.from_arrays(ball.vertices, ball.triangles[:-1])])
        with self.fails(cw.Status.CANCELLED):
            cw.boolean([ball, other], progress=lambda *_: False)

    def test_transform_moves_and_keeps_the_outside(self):
        mesh = cw.extract(cw.Volume(make_ball(), origin=(5, 6, 7)), 0)
        volume = cw.check(mesh).quality["volume_mm3"]
        for matrix, factor in (
            ([[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]], 2),
            (np.diag([-1.0, 1, 1, 1]), 1),
            ([[0, -1, 0, 5], [1, 0, 0, 0], [0, 0, 3, 0]], 3),
        ):
            moved = cw.transform(mesh, matrix)
            self.assertAlmostEqual(cw.check(moved).quality["volume_mm3"] / volume, factor, 4)
            full = np.asarray(matrix)[:3]
            points = mesh.world_vertices() @ full[:, :3].T + full[:, 3]
            self.assertTrue(np.allclose(moved.world_vertices(), points, atol=1e-4))
        with self.fails(cw.Status.ARGUMENT):
            cw.transform(mesh, np.zeros((3, 4)))
        for wrong in (np.eye(3), np.ones((4, 4)), [1, 2]):
            with self.assertRaises(ValueError):
                cw.transform(mesh, wrong)

    def test_split_parts_solids_with_their_cavities(self):
        field = make_ball()
        small = cw.extract(cw.Volume(field, spacing=(0.1, 0.1, 0.1)), 0)
        large = cw.extract(field, 0)
        (low, high), (a, b) = small.bounds, large.bounds
        inner = cw.transform(small, np.c_[np.eye(3), (a + b - low - high) / 2])
        n = len(large.vertices)
        vertices = np.r_[inner.world_vertices(), large.world_vertices(), small.world_vertices() + 500].astype("f4")
        m = len(inner.vertices)
        triangles = np.r_[inner.triangles[:, ::-1], large.triangles + m, small.triangles + m + n]
        solids = cw.split(cw.Mesh.from_arrays(vertices, triangles))
        self.assertEqual([len(s.triangles) for s in solids], [len(triangles) - len(small.triangles), len(small.triangles)])
        self.assertEqual(cw.check(solids[0]).quality["cavities"], 1)
        self.assertEqual(cw.split(cw.Mesh.from_arrays(np.zeros((0, 3)), [])), [])

    def test_weld_merges_corners(self):
        mesh = cw.extract(make_ball(), 0)
        corners = mesh.vertices[mesh.triangles.ravel()]
        loose = cw.Mesh.from_arrays(corners, np.arange(len(corners), dtype="u4").reshape(-1, 3), origin=(1, 2, 3))
        joined = cw.weld(loose)
        self.assertEqual(len(joined.vertices), len(mesh.vertices))
        self.assertEqual(len(joined.triangles), len(mesh.triangles))
        self.assertTrue(np.array_equal(joined.origin, [1, 2, 3]))
        self.assertEqual(len(loose.vertices), len(corners))


class Units(Case):
    def same(self, a, b):
        self.assertTrue(np.array_equal(a.vertices, b.vertices))

    def test_texts_name_their_unit_and_numbers_are_millimetres(self):
        volume = cw.Volume(make_ball(), spacing=["2mm", "0.2cm", "2000um"])
        self.assertEqual(volume.spacing, (2.0, 2.0, 2.0))
        mesh = cw.extract(volume, 0)
        low, high = mesh.bounds
        diagonal = float(np.linalg.norm(high - low))
        self.same(cw.simplify(mesh, error="0.25mm"), cw.simplify(mesh, error=0.25))
        self.same(cw.simplify(mesh, error="1%"), cw.simplify(mesh, error=diagonal / 100))
        self.same(cw.extract(volume, 0, simplify="0.5vox"), cw.extract(volume, 0, simplify=1.0))
        self.same(cw.smooth(mesh, max_move="0.1mm").mesh, cw.smooth(mesh, max_move=0.1).mesh)
        self.same(cw.extract(volume, 0, min_volume="1ml"), cw.extract(volume, 0, min_volume=1000))
        self.assertEqual(volume.resample("1mm").spacing, (1.0, 1.0, 1.0))
        print_facts = cw.check(mesh, profile="print", wall="100mm", plate=["20cm"] * 3).print
        self.assertEqual(print_facts, cw.check(mesh, profile="print", wall=100, plate=[200] * 3).print)

    def test_texts_without_a_unit_or_with_a_wrong_one_are_refused(self):
        volume = cw.Volume(make_ball())
        mesh = cw.extract(volume, 0)
        for text in ("1", "", "1kg", "1vox", "mm", "nanmm", "1 mm", "1mm2"):
            with self.assertRaisesRegex(ValueError, "error is .*a length with one of the units mm"):
                cw.simplify(mesh, error=text)
        for text in ("1", "1mm", "1%"):
            with self.assertRaisesRegex(ValueError, "min_volume is .*a volume with one of the units mm3"):
                cw.extract(volume, 0, min_volume=text)
        with self.assertRaisesRegex(ValueError, "0 or more was expected"):
            cw.repair(mesh, fill="-1mm")


class Mistakes(Case):
    def test_wrong_arrays(self):
        vertices, triangles = make_tetrahedron()
        for v, t, words in (
            (vertices[:, :2], triangles, "shape"),
            (vertices, triangles.ravel(), "shape"),
            (vertices, triangles.astype("i8") - 1, "0 to 4294967295"),
        ):
            with self.assertRaisesRegex(ValueError, words):
                cw.Mesh.from_arrays(v, t)
        with self.assertRaises(TypeError):
            cw.Mesh.from_arrays(vertices, triangles.astype("f4"))
        with self.assertRaises(TypeError):
            cw.Mesh.from_arrays(vertices, triangles, colours=None)
        with self.assertRaisesRegex(ValueError, "3 rows for 4"):
            cw.Mesh.from_arrays(vertices, triangles, scalars=np.zeros(3, "f4"))
        with self.assertRaises(TypeError):
            cw.Mesh()

    def test_what_the_library_refuses(self):
        vertices, triangles = make_tetrahedron()
        with self.fails(cw.Status.ARGUMENT):
            cw.Mesh.from_arrays(vertices, triangles + np.uint32(1))
        vertices[1, 1] = np.nan
        with self.fails(cw.Status.ARGUMENT):
            cw.Mesh.from_arrays(vertices, triangles)

    def test_a_mesh_without_anything(self):
        mesh = cw.Mesh.from_arrays([], [])
        self.assertEqual((mesh.vertices.shape, mesh.triangles.shape), ((0, 3), (0, 3)))
        self.assertEqual(mesh.world_vertices().shape, (0, 3))
        with self.fails(cw.Status.ARGUMENT):
            cw.write(self.folder / "nothing.ply", mesh)


class OtherPackages(Case):
    def test_without_the_package_the_error_says_what_to_install(self):
        mesh = cw.extract(make_ball(), 0)
        with unittest.mock.patch.dict(sys.modules, {"trimesh": None, "pyvista": None}):
            with self.assertRaisesRegex(ImportError, "pip install trimesh"):
                mesh.to_trimesh()
            with self.assertRaisesRegex(ImportError, "pip install pyvista"):
                mesh.to_pyvista()

    def test_trimesh_gets_world_coordinates(self):
        """Calls a stand-in of trimesh.Trimesh, unless the package is there."""
        mesh = cw.extract(cw.Volume(make_ball(), origin=(1000, 0, 0)), 0)
        try:
            made = mesh.to_trimesh()
            self.assertTrue(made.is_watertight)
            self.assertTrue(np.allclose(made.bounds, mesh.bounds))
        except ImportError:
            stub = types.SimpleNamespace(Trimesh=lambda **given: types.SimpleNamespace(**given))
            with unittest.mock.patch.dict(sys.modules, {"trimesh": stub}):
                made = mesh.to_trimesh()
            self.assertTrue(np.array_equal(made.vertices, mesh.world_vertices()))
            self.assertTrue(np.array_equal(made.faces, mesh.triangles))
            self.assertIs(made.process, False)

    def test_pyvista_gets_a_surface_of_vtk(self):
        """Builds a vtkPolyData by a stand-in of pyvista.PolyData, unless the package is there."""
        mesh = cw.extract(make_ball(), 0)
        try:
            surface = mesh.to_pyvista()
        except ImportError:
            try:
                stub = make_polydata_stub()
            except ImportError:
                self.skipTest("neither pyvista nor VTK")
            with unittest.mock.patch.dict(sys.modules, {"pyvista": stub}):
                surface = mesh.to_pyvista()
            self.assertEqual(surface.GetNumberOfPolys(), len(mesh.triangles))
            self.assertEqual(surface.find_open_edges(), 0)
            self.assertEqual(surface.point_data["Normals"].shape, (len(mesh.vertices), 3))
            return
        self.assertEqual((surface.n_points, surface.n_open_edges), (len(mesh.vertices), 0))


def make_polydata_stub():
    """Returns a module with PolyData(points, faces) as pyvista has it, on VTK itself."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
    from vtkmodules.vtkFiltersCore import vtkFeatureEdges

    class PolyData(vtkPolyData):
        def __init__(self, points, faces):
            places, cells = vtkPoints(), vtkCellArray()
            places.SetData(numpy_to_vtk(points, deep=True))
            cells.ImportLegacyFormat(numpy_to_vtkIdTypeArray(faces, deep=True))
            self.SetPoints(places)
            self.SetPolys(cells)
            self.point_data = {}

        def find_open_edges(self):
            edges = vtkFeatureEdges()
            edges.SetInputData(self)
            edges.FeatureEdgesOff()
            edges.ManifoldEdgesOff()
            edges.Update()
            return edges.GetOutput().GetNumberOfCells()

    return types.SimpleNamespace(PolyData=PolyData)


class Attributes(Case):
    def test_rows_tell_the_elements(self):
        mesh = cw.extract(make_ball(), 0)
        vertices, triangles = len(mesh.vertices), len(mesh.triangles)
        mesh.attributes["heights"] = mesh.vertices[:, 2]
        mesh.attributes["ids"] = np.arange(triangles)
        mesh.attributes["uv"] = np.random.default_rng(1).random((3 * triangles, 2), dtype="f4")
        mesh.attributes["frame"] = np.eye(4).reshape(1, 16)
        self.assertEqual(list(mesh.attributes), ["heights", "ids", "uv", "frame"])
        shapes = {name: array.shape for name, array in mesh.attributes.items()}
        self.assertEqual(
            shapes, {"heights": (vertices, 1), "ids": (triangles, 1), "uv": (3 * triangles, 2), "frame": (1, 16)}
        )
        self.assertEqual(mesh.attributes["ids"].dtype, np.uint32)
        self.assertTrue((mesh.attributes["ids"][:, 0] == np.arange(triangles)).all())
        copied = mesh.copy()
        mesh.attributes["ids"][0] = 99
        self.assertEqual((mesh.attributes["ids"][0], copied.attributes["ids"][0]), (99, 0))
        self.assertTrue((copied.attributes["uv"] == mesh.attributes["uv"]).all())

    def test_a_cut_carries_them(self):
        mesh = cw.extract(make_ball(), 0)
        mesh.attributes["place"] = mesh.vertices
        mesh.attributes.add("ids", np.arange(1, len(mesh.triangles) + 1), on="triangles")
        half = cw.cut(mesh, point=(0.1, 0.2, 0.3), normal=(1, 2, 3)).mesh
        self.assertLess(np.abs(half.attributes["place"] - half.vertices).max(), 1e-4)
        ids = half.attributes["ids"][:, 0]
        old = mesh.vertices[mesh.triangles].mean(1)
        new = half.vertices[half.triangles].mean(1)
        self.assertLess(np.linalg.norm(new[ids > 0] - old[ids[ids > 0] - 1], axis=1).max(), 1)

    def test_arrays_outlive_removal_and_mesh_and_then_memory_is_freed(self):
        gc.collect()
        before = cw.memory_used()
        for mesh in (cw.extract(make_ball(), 0), cw.Mesh.from_arrays(*make_tetrahedron())):
            mesh.attributes.add("x", np.full(len(mesh.vertices), 5.0), on="vertices")
            removed = mesh.attributes["x"]
            mesh.attributes["x"] = mesh.vertices
            self.assertEqual(mesh.attributes["x"].shape[1], 3)
            del mesh.attributes["x"]
            self.assertEqual(len(mesh.attributes), 0)
            mesh.attributes.add("y", np.ones(len(mesh.vertices)), on="vertices")
            kept = mesh.attributes["y"]
            del mesh
            gc.collect()
            self.assertTrue((removed == 5).all() and (kept == 1).all())
            del removed, kept
        gc.collect()
        self.assertEqual(cw.memory_used(), before)

    def test_what_does_not_fit_is_refused(self):
        mesh = cw.Mesh.from_arrays(*make_tetrahedron())  # 4 vertices and 4 triangles
        for values, words in ((np.ones(4), "vertices and triangles"), (np.ones(5), "no elements")):
            with self.assertRaisesRegex(ValueError, words):
                mesh.attributes["x"] = values
        with self.assertRaisesRegex(ValueError, "no corners"):
            mesh.attributes.add("x", np.ones(4), on="corners")
        with self.assertRaisesRegex(ValueError, "32 bits"):
            mesh.attributes.add("x", np.full(4, 2**40), on="vertices")
        with self.assertRaises(TypeError):
            mesh.attributes.add("x", np.array(list("abcd")), on="vertices")
        with self.assertRaises(ValueError):
            mesh.attributes.add("x", np.ones(4), on="vertices", interpolation="cubic")
        with self.assertRaisesRegex(cw.Error, "5 components"):
            mesh.attributes.add("x", np.ones((4, 5)), on="vertices")
        with self.assertRaisesRegex(cw.Error, "in use"):
            mesh.attributes.add("normals", np.ones((4, 3)), on="vertices")
        with self.assertRaises(KeyError):
            mesh.attributes["x"]


if __name__ == "__main__":
    main()
