"""Tests extraction, its progress and cancelling, threads, and the errors of calls."""

import gc
import os
import pathlib
import pickle
import signal
import sys
import threading
import time
import unittest.mock

import cubewright as cw
import numpy as np
from support import LIMIT_S, Case, main, make_ball, run_python


def make_slow_volume():
    """Returns a volume whose extraction takes about a second with snapping."""
    return cw.make("gyroid", dims=160, noise=0.02)


class Surfaces(Case):
    def test_a_ball_is_closed_round_and_full(self):
        size = 48
        ball = make_ball(size)
        found = cw.check(cw.extract(ball, 0), profile="print", source=ball, iso=0)
        self.assertTrue(found.holds, found.verdicts)
        self.assertLess(abs(found.quality["volume_mm3"] / (4 / 3 * np.pi * (0.35 * size) ** 3) - 1), 0.01)
        self.assertEqual((found.quality["euler"], found.intersections), (2, 0))
        self.assertLess(found.distances["to_source"]["max_mm"], 0.02)

    def test_options_change_the_mesh(self):
        ball = make_ball()
        cut = ball[8:]
        self.assertIsNone(cw.extract(ball, 0, normals="none").normals)
        self.assertEqual(cw.check(cw.extract(cut, 0, open=True)).quality["border_loops"], 1)
        self.assertEqual(cw.check(cw.extract(cut, 0)).quality["border_loops"], 0)
        self.assertLess(len(cw.extract(ball, 0, snap=0.3).vertices), len(cw.extract(ball, 0).vertices))
        speck = ball.copy()
        speck[1, 1, 1] = 5
        self.assertEqual(cw.check(cw.extract(speck, 0)).quality["components"], 2)
        self.same_mesh(cw.extract(speck, 0, min_volume=10), cw.extract(ball, 0))

    def test_voids_are_filled(self):
        ball = make_ball()
        z, y, x = ball.shape
        hollow = ball.copy()
        hollow[z // 2, y // 2, x // 2] = -1
        filled = cw.extract(hollow, 0, fill_voids=True)
        self.same_mesh(filled, cw.extract(ball, 0))
        self.assertEqual(filled.facts["ran"], ["extract", "fill_voids", "normals"])
        self.assertEqual(filled.facts["voids"]["dropped"], 1)
        self.assertEqual(filled.facts["voids"]["triangles"] + len(filled.triangles), filled.facts["extracted"]["triangles"])
        self.assertEqual(filled.copy().facts, {})
        for more in ({"topology": "simple"}, {"placement": "cubic"}, {"inside": "below"}):
            self.assertTrue(cw.check(cw.extract(ball, 0, **more)).holds, more)

    def test_stages_are_the_functions_of_the_package(self):
        head = cw.make("ct-head", dims=32, type="i16", noise=150)
        mesh = cw.extract(head, 300, min_volume=100, largest=20, fill_voids=True)
        smooth = {"method": "hc", "iterations": 4}
        smoothed = cw.extract(head, 300, min_volume=100, largest=20, fill_voids=True, smooth=smooth)
        self.same_mesh(smoothed, cw.smooth(mesh, **smooth).mesh)
        closed = cw.close_handles(mesh, "6mm")
        self.assertGreater(closed.cut + closed.filled, 5)
        self.same_mesh(cw.extract(head, 300, min_volume=100, largest=20, fill_voids=True, close_handles=6), closed.mesh)
        plane = ((0, 0, 10), (0, 0.5, 1))
        whole = cw.extract(head, 300)
        self.same_mesh(cw.extract(head, 300, cut_plane=plane), cw.cut(whole, *plane).mesh)
        paint = cw.make("sphere", dims=32)
        painted = cw.extract(head, 300, color_by=paint, colormap="inferno", color_range=(-60, 40))
        expected = cw.color_by(whole, paint, colormap="inferno", low=-60, high=40)
        np.testing.assert_array_equal(painted.colors, expected.colors)
        np.testing.assert_array_equal(painted.scalars, expected.scalars)
        parted = cw.crease_normals(whole, 40)
        corners = parted.attributes["corner_normals"]
        self.assertEqual(corners.shape, (3 * len(whole.triangles), 3))
        angled = cw.extract(head, 300, crease_angle=40)
        np.testing.assert_array_equal(angled.attributes["corner_normals"], corners)
        capped = cw.extract(head, 300, crease_angle="caps")
        self.assertGreater(capped.facts["creases"], 0)
        self.assertNotIn("corner_normals", whole.attributes)
        for wrong in (0, 181, float("nan")):
            with self.assertRaises(ValueError):
                cw.crease_normals(whole, wrong)
        self.same_mesh(cw.Extractor(head).extract(300, smooth="taubin"), cw.extract(head, 300, smooth="taubin"))

    def test_levels_come_from_a_volume_at_once(self):
        if not cw.features()["simplify"].available:
            self.skipTest("this build has no OpenMesh")
        head = cw.make("ct-head", dims=32, type="i16")
        levels = cw.extract_levels(head, 300, [4000, 1000], largest=1)
        self.assertEqual([len(each.triangles) for each in levels], [4000, 1000])
        self.assertEqual([each.facts["others"]["kept"] for each in levels], [1, 1])
        for wanted, level in zip(cw.simplify_levels(cw.extract(head, 300, largest=1), [4000, 1000]), levels):
            np.testing.assert_array_equal(wanted.vertices, level.vertices)
            np.testing.assert_array_equal(wanted.triangles, level.triangles)
        with self.assertRaises(cw.Error):
            cw.extract_levels(head, 300, [4000, 1000], simplify=500)
        with self.assertRaises(cw.Error):
            cw.extract_levels(head, 300, [4000, 1000], maps="normals")  # without uv
        with self.assertRaises(ValueError):
            cw.extract_levels(head, 300, [4000, 1000], uv=True, maps="shadows")
        levels = cw.extract_levels(
            head, 300, [4000, 1000], largest=1, close_handles="auto", uv={"size": 256}, maps="normals"
        )
        self.assertEqual(levels.maps["normals"].shape, (256, 256, 4))
        self.assertGreater(levels[0].facts["baked"]["texels"], 10000)
        self.assertEqual(levels[0].facts["atlas"]["size"], 256)
        for level in levels:
            self.assertEqual(level.attributes["texture_coordinates"].shape, (3 * len(level.triangles), 2))
        full = cw.extract(head, 300, largest=1)
        low = cw.atlas(levels[0], size=256).mesh
        maps, facts = cw.bake_maps(low, full, ["occlusion", "curvature"], size=256, threads=2)
        self.assertEqual(sorted(maps), ["curvature", "occlusion"])
        self.assertEqual(maps["occlusion"].shape, (64, 64, 4))
        self.assertGreater(facts["curvature_max"], 0)
        with self.assertRaises(cw.Error):
            cw.bake_maps(low, full, "colors")
        painted = cw.extract_levels(head, 300, [2000], uv={"size": 128}, maps="colors", color_by=head)
        self.assertIsNone(painted[0].colors)
        self.assertGreater(len(np.unique(painted.maps["colors"][..., 0])), 3)
        flat = cw.extract(head, 300, largest=1, uv=True)
        self.assertIn("texture_coordinates", flat.attributes)

    def test_an_extractor_gives_the_meshes_of_extract(self):
        ball = make_ball()
        gc.collect()
        before = cw.memory_used()
        extractor = cw.Extractor(ball)
        for iso in (-3, 0, 2.5):
            self.same_mesh(extractor.extract(iso), cw.extract(ball, iso))
        self.assertLess(len(extractor.extract(0, snap=0.3).vertices), len(extractor.extract(0).vertices))
        with self.assertRaises(TypeError):
            extractor.extract(0, step=1)
        with self.assertRaisesRegex(RuntimeError, "its own call"):
            extractor.extract(1, progress=lambda *_: extractor.extract(0))
        self.assertGreater(cw.memory_used(), before)
        del extractor
        gc.collect()
        self.assertEqual(cw.memory_used(), before)

    def test_an_extractor_follows_a_volume_that_changes(self):
        waves = cw.make("gyroid", dims=(50, 40, 60))
        values = np.array(waves.array, np.float32)
        extractor = cw.Extractor(values)
        kept = {}

        def follow(**options):
            changed = extractor.extract_changed(0, **options)
            for brick in changed:
                self.assertEqual(brick.index, brick.at[0] + 4 * (brick.at[1] + 3 * brick.at[2]))
                kept[brick.index] = brick.mesh
            whole = cw.extract(values, 0, **options)
            self.same_mesh(extractor.extract(0, **options), whole)
            corners = [mesh.world_vertices()[mesh.triangles] for mesh in kept.values()]
            together = np.sort(np.concatenate(corners).reshape(-1, 9).view("f8,f8,f8,f8,f8,f8,f8,f8,f8"), axis=0)
            expected = whole.world_vertices()[whole.triangles].reshape(-1, 9).view("f8,f8,f8,f8,f8,f8,f8,f8,f8")
            self.assertTrue((together == np.sort(expected, axis=0)).all())
            return len(changed)

        everything = follow()
        self.assertGreater(everything, 40)
        self.assertEqual(follow(), 0)
        values[4:9, 20:25, -8:] *= -1
        extractor.update(np.s_[4:9, 20:25, -8:])
        self.assertTrue(0 < follow() <= 4)
        values[:] = 1 - values
        extractor.update()
        self.assertGreater(follow(), 40)
        self.assertGreater(follow(open=True), 30)
        for box, error in ((3, TypeError), (np.s_[1:2, 1:2], TypeError), (np.s_[::2, :, :], ValueError)):
            with self.assertRaises(error):
                extractor.update(box)
        with self.assertRaises(cw.Error) as empty:
            extractor.update(np.s_[3:3, :, :])
        self.assertEqual(empty.exception.status, cw.Status.ARGUMENT)
        with self.assertRaises(TypeError):
            extractor.extract_changed(0, snap=0.3)
        with self.assertRaises(cw.Error) as stopped:
            extractor.extract_changed(0, progress=lambda *_: False)
        self.assertEqual(stopped.exception.status, cw.Status.CANCELLED)

    def test_an_extractor_writes_to_the_memory_of_a_mesh_it_took_back(self):
        extractor = cw.Extractor(make_ball())
        mesh = extractor.extract(0)
        vertices = mesh.vertices
        with self.assertRaises(BufferError):
            extractor.recycle(mesh)
        address = vertices.ctypes.data
        del vertices
        extractor.recycle(mesh)
        self.assertEqual((len(mesh.vertices), len(mesh.triangles)), (0, 0))
        again = extractor.extract(0)
        self.assertEqual(again.vertices.ctypes.data, address)
        self.same_mesh(again, cw.extract(make_ball(), 0))
        with self.assertRaises(ValueError):
            extractor.recycle(mesh.copy())

    def test_simplify_by_count_error_and_ratio(self):
        self.need("simplify")
        mesh = cw.extract(make_ball(), 0)
        self.assertLessEqual(len(cw.extract(make_ball(), 0, simplify=200).triangles), 200)
        self.assertLessEqual(len(cw.simplify(mesh, ratio=0.1).triangles), len(mesh.triangles) // 10)
        small = cw.simplify(mesh, error=0.1)
        found = cw.check(small, reference=mesh, tolerance=0.1, profile="print", deep=True)
        self.assertTrue(found.holds, found.verdicts)
        self.assertLess(len(small.triangles), len(mesh.triangles))
        with self.fails(cw.Status.ARGUMENT):
            cw.simplify(mesh)

    def test_levels_of_detail(self):
        self.need("simplify")
        mesh = cw.extract(make_ball(), 0)
        levels = cw.simplify_levels(mesh, np.array([400, 100]), threads=2)
        self.assertEqual([len(level.triangles) for level in levels], [400, 100])
        coarse = levels.pop()
        del levels
        gc.collect()
        self.assertTrue(cw.check(coarse, profile="print").holds)
        with self.fails(cw.Status.ARGUMENT):
            cw.simplify_levels(mesh, [100, 400])
        with self.fails(cw.Status.CANCELLED):
            cw.simplify_levels(mesh, [400], progress=lambda *_: False)
        for wrong, error in (([], ValueError), ([0], ValueError), (400, TypeError), ("9", TypeError)):
            self.assertRaises(error, cw.simplify_levels, mesh, wrong)

    def test_offset_and_hollow(self):
        self.need("level-set")
        mesh = cw.extract(make_ball(), 0)
        full = cw.check(mesh).quality["volume_mm3"]
        self.assertGreater(cw.check(cw.offset(mesh, 1)).quality["volume_mm3"], full)
        self.assertLess(cw.check(cw.hollow(mesh, 2)).quality["volume_mm3"], 0.8 * full)

    def test_lattices(self):
        self.need("level-set")
        ball = cw.extract(make_ball(), 0)
        low, high = ball.bounds
        size = float((high - low).max())
        lattice = ("gyroid", size / 2, size / 14)
        wall = size / 14
        filled = cw.hollow(ball, wall, infill=lattice)
        self.assertGreater(cw.check(filled).quality["volume_mm3"], cw.check(cw.hollow(ball, wall)).quality["volume_mm3"])
        ramp = cw.Volume(np.arange(27, dtype="f4").reshape(3, 3, 3), spacing=size / 2, origin=low)
        for by in (size / 8, ramp):
            graded = cw.hollow(ball, wall, infill=(*lattice, size / 8), infill_by=by)
            self.assertGreater(cw.check(graded).quality["volume_mm3"], cw.check(filled).quality["volume_mm3"])
        with self.fails(cw.Status.ARGUMENT):
            cw.hollow(ball, wall, infill=("diamond", size / 14, wall))
        for wrong, error in (("gyroid", TypeError), (("cube", 1, 1), ValueError), (("gyroid", 1), TypeError)):
            self.assertRaises(error, cw.hollow, ball, wall, infill=wrong)
        self.assertRaises(ValueError, cw.hollow, ball, wall, infill_by=1)

    def test_labels_share_their_interfaces(self):
        volume = cw.make("labels/cells", dims=40, labels=12, type="u8")
        found = cw.extract_labels(volume)
        counts = dict(zip(*np.unique(volume.array[volume.array > 0], return_counts=True)))
        self.assertEqual(found.voxels, counts)
        for label, mesh in found.meshes().items():
            self.assertAlmostEqual(cw.check(mesh).quality["volume_mm3"] / counts[label], 1, 2)
            self.assertAlmostEqual(found.volumes()[label] / counts[label], 1, 2)
        self.assertEqual(sum(p.count for p in found.patches), len(found.shared.triangles))
        meetings = cw.contacts(list(found.meshes().values()))
        self.assertEqual(meetings["shared"], sum(p.count for p in found.patches if 0 not in p.labels))
        self.assertEqual(meetings["neighbours"], sum(0 not in p.labels for p in found.patches))
        self.assertEqual(meetings["overlapping"], 0)
        self.assertEqual(cw.contacts([found.mesh(3), found.mesh(3)])["overlapping"], len(found.mesh(3).triangles))
        shared = found.shared
        less = found.simplify(ratio=0.3)
        self.assertLess(len(less.shared.triangles), 0.5 * len(shared.triangles))
        del found
        gc.collect()
        self.assertEqual(shared.triangles.max() + 1, len(shared.vertices))
        self.assertEqual(set(cw.extract_labels(volume, [3, 5]).voxels), {3, 5})
        self.assertEqual(len(cw.extract_labels(volume, smooth_labels=0).mesh(200).triangles), 0)
        with self.fails(cw.Status.ARGUMENT):
            cw.extract_labels(np.full((4, 4, 4), 0.5, "f4"))

    def test_labels_of_fields(self):
        z, y, x = np.mgrid[:20, :22, :24]
        balls = [6 - np.hypot(np.hypot(x - p, y - 10.3), z - 9.2) for p in (8.1, 15.2)]
        scores = np.stack([np.zeros_like(x, "f8"), *balls])
        fields = np.exp(scores) / np.exp(scores).sum(0)
        found = cw.extract_label_scores(fields, "first")
        self.assertEqual(set(found.voxels), {1, 2})
        for label, mesh in found.meshes().items():
            self.assertTrue(cw.check(mesh).holds)
            middle = np.array(((8.1, 15.2)[label - 1], 10.3, 9.2)) - mesh.origin
            far = np.abs(np.linalg.norm(mesh.vertices - middle, axis=1) - 6)
            self.assertLess(np.median(far), 0.05)
        rest = cw.extract_label_scores(list(fields[1:]), "rest", threads=1)
        self.assertEqual(rest.voxels, found.voxels)
        self.assertLess(np.abs(rest.shared.vertices - found.shared.vertices).max(), 1e-4)
        same = cw.extract_label_scores(cw.Volume(np.moveaxis(fields, 0, -1).copy(), components=True), "first")
        np.testing.assert_array_equal(same.shared.vertices, found.shared.vertices)
        half = cw.extract_label_scores(fields[1:].astype("f2"), 0.5, [9], numbers=[4, 9])
        self.assertEqual(set(half.voxels), {9})
        steps = cw.extract_label_scores(scores, "first", numbers=[7, 3, 5], max_move=0)
        self.assertEqual(set(steps.voxels), {3, 5})
        with self.fails(cw.Status.ARGUMENT, "one grid"):
            cw.extract_label_scores([fields[0], fields[1][1:]], 0.5)
        with self.fails(cw.Status.ARGUMENT, "both have label 4"):
            cw.extract_label_scores(fields[1:], 0.5, numbers=[4, 4])
        for wrong in ("last", "all"):
            self.assertRaises(ValueError, cw.extract_label_scores, fields, wrong)
        self.assertRaises(ValueError, cw.extract_label_scores, [], 0.5)
        self.assertRaises(ValueError, cw.extract_label_scores, fields, 0.5, numbers=[1])
        self.assertRaises(TypeError, cw.extract_label_scores, 3, 0.5)

    def test_labels_are_cleaned(self):
        cells = cw.make("labels/cells", dims=20, labels=4, type="u8").array.astype("i8") * -7
        dirty = cells.copy()
        dirty[10, 10, 10] = -100
        dirty[0, 0, 0] = dirty[0, 0, 1] = -7
        cleaned, changes = cw.clean_labels(dirty, min_voxels=3)
        np.testing.assert_array_equal(np.array(cleaned.ids)[cleaned.array], cells)
        self.assertEqual((changes[-100].voxels, changes[-100].components_removed), (0, 1))
        self.assertEqual((changes[-7].voxels_removed, changes[-7].voxels), (2, int((cells == -7).sum())))
        self.assertEqual(set(cw.extract_labels(cleaned).voxels), {-7, -14, -21, -28})
        hollow = np.zeros((9, 9, 9), "u1")
        hollow[1:8, 1:8, 1:8] = 5
        hollow[4, 4, 4] = 0
        self.assertEqual(cw.clean_labels(hollow, fill_voids=True)[0].array[4, 4, 4], 5)

    def test_labels_are_sampled_at_other_distances(self):
        cells = cw.make("labels/cells", dims=20, labels=4, type="u8").array
        numbers = np.array([0, -5, 2**40, 7, -(2**50)], "i8")[cells]
        for map, values in ((cells, cells), (numbers, numbers), (cells.astype("f4"), cells)):
            same = cw.resample_labels(map, 0, "nearest")
            found = np.array(same.ids)[same.array] if same.ids else same.array
            np.testing.assert_array_equal(found, values)
            finer = cw.resample_labels(map, "0.5mm")
            self.assertEqual(finer.array.shape, (39, 39, 39))
            self.assertEqual(finer.array.dtype, np.uint32)
            found = np.array(finer.ids)[finer.array] if finer.ids else finer.array
            self.assertEqual(set(np.unique(found)), set(np.unique(values)))
            one = cw.resample_labels(map, 0.5, threads=1)
            np.testing.assert_array_equal(one.array, finer.array)
        thick = cw.Volume(np.ascontiguousarray(cells[::3]), spacing=(1, 1, 3))
        self.assertEqual(cw.resample_labels(thick, (0, 0, 1)).array.shape, (19, 20, 20))
        self.assertEqual(set(cw.extract_labels(cw.resample_labels(numbers, 2)).voxels), {-5, 2**40, 7, -(2**50)})
        with self.assertRaises(ValueError):
            cw.resample_labels(cells, 1, "linear")
        with self.fails(cw.Status.ARGUMENT):
            cw.resample_labels(np.full((4, 4, 4), 0.5, "f4"), 0.5)

    def test_labels_have_numbers_of_64_bits(self):
        cells = cw.make("labels/cells", dims=24, labels=5, type="u8").array
        small = cw.extract_labels(cells)
        for kind, numbers in (
            ("u8", [0, 7, 2**32, 720575940600000091, 2**63 + 1, 2**64 - 1]),
            ("i8", [0, -(2**63), -5, 3, 2**40, 2**63 - 1]),
            ("i2", [0, -300, -1, 5, 6, 7]),
        ):
            array = np.array(numbers, kind)[cells]
            found = cw.extract_labels(array)
            self.assertEqual(found.voxels, {n: int((array == n).sum()) for n in sorted(numbers) if n})
            for place in (1, 3, 5):
                mesh, same = found.mesh(numbers[place]), small.mesh(place)
                np.testing.assert_array_equal(mesh.vertices, same.vertices)
                np.testing.assert_array_equal(mesh.triangles, same.triangles)
            self.assertEqual(set(cw.extract_labels(array, [numbers[1]]).voxels), {numbers[1]})
            self.assertEqual(len(found.mesh(12345).triangles), 0)
            self.assertEqual({n for p in found.patches for n in p.labels}, set(numbers))
        self.assertEqual(set(cw.extract_labels(cells.astype("i8")).voxels), {1, 2, 3, 4, 5})
        self.assertRaises(ValueError, found.mesh, 2**64)


class Progress(Case):
    def test_reports_name_steps_and_rise_to_one(self):
        reports = []
        cw.extract(make_slow_volume(), 0, progress=lambda step, done: reports.append((step, done)))
        self.assertTrue(reports)
        self.assertTrue(all(step and 0 <= done <= 1 for step, done in reports))

    def test_false_cancels(self):
        volume = make_slow_volume()
        gc.collect()
        before = cw.memory_used()
        with self.fails(cw.Status.CANCELLED):
            cw.extract(volume, 0, progress=lambda step, done: False)
        self.assertEqual(cw.memory_used(), before)

    def test_an_exception_of_the_callback_comes_out(self):
        class Oops(Exception):
            pass

        def fail(step, done):
            raise Oops(step)

        with self.assertRaises(Oops):
            cw.extract(make_slow_volume(), 0, progress=fail)
        with self.assertRaises(TypeError):
            cw.extract(make_ball(), 0, progress=1)

    def test_ctrl_c_stops_a_call_without_a_callback(self):
        volume, statuses, plain_call = make_slow_volume(), [], cw._progress.call
        gc.collect()
        before = cw.memory_used()

        def call_and_note(*arguments):
            try:
                plain_call(*arguments)
            except cw.Error as error:
                statuses.append(error.status)
                raise

        with unittest.mock.patch("cubewright._progress.call", call_and_note):
            for _ in range(20):  # the interrupt may come between two calls
                timer = threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGINT))
                try:
                    timer.start()
                    while True:
                        cw.extract(volume, 0, snap=0.3)
                except KeyboardInterrupt:
                    if statuses:
                        break
                finally:
                    timer.join()
        self.assertEqual(statuses, [cw.Status.CANCELLED])
        self.assertIs(signal.getsignal(signal.SIGINT), signal.default_int_handler)
        gc.collect()
        self.assertEqual(cw.memory_used(), before)

    def test_cameras(self):
        ball = make_ball()
        full = cw.extract(ball, 0)
        seen = cw.extract(ball, 0, camera="front", cull=True)
        self.assertLess(len(seen), 0.7 * len(full))
        self.assertGreater(seen.facts["culled"], 0.3 * len(full))
        both = cw.extract(ball, 0, camera=["front", "back"], cull=True, size=(640, 480))
        self.assertGreater(len(both), 1.5 * len(seen))
        self.assertLess(len(cw.extract(ball, 0, camera=(0, 20), cull=True)), len(both))
        for wrong in ({"cull": True}, {"pixel_error": 1}, {"camera": "front"}):
            with self.assertRaises(TypeError):
                cw.extract(ball, 0, **wrong)
        self.need("simplify")
        coarse = cw.extract(ball, 0, camera="front", pixel_error=4, shading=60, size=(320, 240))
        self.assertTrue(cw.check(coarse).holds)
        self.assertLess(len(coarse), 0.5 * len(full))
        bounded = cw.extract(ball, 0, camera="front", pixel_error=4, shading=60, simplify="0.02mm", size=(320, 240))
        self.assertGreater(len(bounded), len(coarse))

    def test_the_check_of_the_pipeline_is_that_of_check(self):
        mesh = cw.extract(make_ball(), 0, check=True)
        found = cw.check(mesh).quality
        self.assertEqual(mesh.facts["ran"][-1], "check")
        for name in ("area_mm2", "volume_mm3", "euler", "open_edges"):
            self.assertEqual(mesh.facts["quality"][name], found[name], name)

    def test_a_forked_process_may_call_while_its_parent_does(self):
        volume = cw.make("gyroid", dims=64)
        wanted = cw.extract(volume, 0, threads=4).vertices.tobytes()
        ended, differing = threading.Event(), []

        def extract_until_the_end():
            while not ended.is_set():
                if cw.extract(volume, 0, threads=4).vertices.tobytes() != wanted:
                    differing.append(True)

        busy = threading.Thread(target=extract_until_the_end)
        busy.start()
        try:
            for _ in range(10):
                child = os.fork()
                if child == 0:
                    signal.alarm(LIMIT_S)  # in place of hanging for ever
                    same = cw.extract(volume, 0, threads=4).vertices.tobytes() == wanted
                    os._exit(0 if same else 1)
                self.assertEqual(os.waitpid(child, 0)[1], 0)
        finally:
            ended.set()
            busy.join()
        self.assertFalse(differing)

    def test_a_handler_that_does_not_raise_lets_the_call_go_on(self):
        caught = []
        usual = signal.signal(signal.SIGINT, lambda number, frame: caught.append(number))
        try:
            mesh = cw.extract(make_slow_volume(), 0, progress=lambda *_: signal.raise_signal(signal.SIGINT))
        finally:
            signal.signal(signal.SIGINT, usual)
        self.assertGreater(len(mesh.triangles), 0)
        self.assertEqual(set(caught), {signal.SIGINT})

class Threads(Case):
    def test_other_threads_run_during_a_call(self):
        """Counts by a thread that gives way after each step. Nothing forces the main thread to."""
        volume = make_slow_volume()
        counts, ends = [0], threading.Event()

        def count():
            while not ends.is_set():
                counts[0] += 1
                time.sleep(0.0005)

        usual = sys.getswitchinterval()
        thread = threading.Thread(target=count)
        try:
            sys.setswitchinterval(1000)
            thread.start()
            until, during, calls = time.monotonic() + LIMIT_S, 0, 0
            while during <= 50 and time.monotonic() < until:
                before = counts[0]
                cw.extract(volume, 0, snap=0.3, threads=1)
                during += counts[0] - before
                calls += 1
        finally:
            ends.set()
            sys.setswitchinterval(usual)
            thread.join()
        print(f"another thread counted to {during} during {calls} extractions")
        self.assertGreater(during, 50)

    def test_several_threads_extract_at_once(self):
        volume = cw.make("gyroid", dims=48)
        expected, results = cw.extract(volume, 0), []
        threads = [
            threading.Thread(target=lambda: results.append(cw.extract(volume, 0, threads=2))) for _ in range(6)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(results), 6)
        for mesh in results:
            self.same_mesh(mesh, expected)

    def test_results_do_not_depend_on_threads(self):
        volume = cw.make("gyroid", dims=48)
        self.same_mesh(cw.extract(volume, 0, threads=1), cw.extract(volume, 0, threads=4))


class Overhead(Case):
    def test_a_small_call_copies_no_array(self):
        """Prints the time of a call; what is held to account is that no array is copied."""
        cube = np.random.default_rng(1).random((4, 4, 4), np.float32)
        rounds = 500
        start = time.perf_counter()
        for _ in range(rounds):
            volume = cw.Volume(cube)
            mesh = cw.extract(volume, 0.5, threads=1)
            arrays = mesh.vertices, mesh.triangles
        each = (time.perf_counter() - start) / rounds
        print(f"4 x 4 x 4: {1e3 * each:.3f} ms for Volume(), extract() and two arrays")
        self.assertEqual(volume._resolved.data, cube.ctypes.data)
        self.assertFalse(any(array.flags.owndata for array in arrays))


class Mistakes(Case):
    def test_unknown_and_wrong_arguments(self):
        ball = make_ball()
        for wrong in (
            lambda: cw.extract(ball, 0, isovalue=3),
            lambda: cw.extract(ball, b"otsu"),
            lambda: cw.extract(ball, True),
            lambda: cw.extract(ball, 0, open=1),
            lambda: cw.extract(ball, 0, threads=1.5),
            lambda: cw.extract(ball, 0, inside=None),
            lambda: cw.simplify(ball),
            lambda: cw.extract_labels(ball, ["liver"]),
        ):
            self.assertRaises(TypeError, wrong)
        for wrong in (
            lambda: cw.extract(ball, float("nan")),
            lambda: cw.extract(ball, float("inf")),
            lambda: cw.extract(ball, 0, inside="within"),
            lambda: cw.extract(ball, 0, threads=-1),
            lambda: cw.extract(ball, 0, min_volume=-1),
            lambda: cw.extract_labels(ball, []),
        ):
            self.assertRaises(ValueError, wrong)

    def test_statuses_of_the_library(self):
        ball = make_ball()
        with self.fails(cw.Status.ARGUMENT, "snap"):
            cw.extract(ball, 0, snap=0.7)
        with self.fails(cw.Status.LIMIT):
            cw.extract(ball, 0, max_triangles=10)
        cw.memory_limit(max(cw.memory_used(), 1) + 1000)
        try:
            with self.fails(cw.Status.NO_MEMORY):
                cw.extract(cw.Volume(make_ball(64)), 0)
        finally:
            cw.memory_limit(0)

    def test_arrays_beyond_the_limit_overflow_into_files(self):
        cells = cw.make("labels/cells", dims=80, labels=300, type="u16")
        whole = cw.extract_labels(cells)
        cw.memory_limit(cw.memory_used() + (6 << 20))
        cw.memory_overflow(self.folder / "x.ply")
        try:
            surfaces = cw.extract_labels(cells)
            self.assertGreater(cw.memory_overflowed(), 0)
        finally:
            cw.memory_overflow(None)
            cw.memory_limit(0)
        np.testing.assert_array_equal(surfaces.shared.triangles, whole.shared.triangles)
        np.testing.assert_array_equal(surfaces.shared.vertices, whole.shared.vertices)
        del surfaces
        gc.collect()
        self.assertEqual(cw.memory_overflowed(), 0)
        with self.fails(cw.Status.OUTPUT, "no/such"):
            cw.memory_overflow("no/such/x")

    def test_no_surface_is_a_mesh_without_triangles(self):
        mesh = cw.extract(np.zeros((4, 4, 4), "f4"), 1)
        self.assertEqual((len(mesh.vertices), len(mesh.triangles)), (0, 0))
        self.assertEqual(len(cw.extract(np.full((4, 4, 4), np.nan, "f4"), 0).triangles), 0)

    def test_errors_have_a_status_a_text_and_survive_pickling(self):
        with self.assertRaises(cw.Error) as caught:
            cw.extract(make_ball(), 0, snap=0.7)
        error = caught.exception
        self.assertEqual(str(error), error.message)
        again = pickle.loads(pickle.dumps(error))
        self.assertEqual((again.status, again.message), (error.status, error.message))
        self.assertEqual(cw.Status.NO_MEMORY.text, "memory ran out")


class Library(Case):
    def test_features_without_their_module_are_not_in_this_build(self):
        """Loads a copy of the library that has no modules beside it."""
        alone = self.folder / "libcubewright.so.0"
        alone.write_bytes(pathlib.Path(os.environ["CUBEWRIGHT_LIBRARY"]).read_bytes())
        code = "import cubewright as cw; m = cw.extract(cw.make('sphere'), 0)\ntry: cw.simplify(m, ratio=.5)\n"
        code += "except cw.Error as e: print(e.status.name, e, cw.features()['simplify'].reason)"
        ran = run_python(code, CUBEWRIGHT_LIBRARY=str(alone))
        self.assertIn("UNSUPPORTED", ran.stdout, ran.stderr)

    def test_what_is_not_the_library_is_refused(self):
        ran = run_python("import cubewright", CUBEWRIGHT_LIBRARY="/nowhere/libcubewright.so.0")
        self.assertIn("ImportError: the cubewright library was not found", ran.stderr)
        self.assertIn("/nowhere/libcubewright.so.0", ran.stderr)
        ran = run_python("import cubewright", CUBEWRIGHT_LIBRARY="libc.so.6")
        self.assertIn("is not the cubewright library", ran.stderr)

    def test_another_version_is_refused(self):
        source, other = self.folder / "other.c", self.folder / "other.so"
        source.write_text('const char *cw_version(void) { return "9.1.0"; }\n')
        os.system(f"{os.environ.get('CC', 'cc')} -shared -fPIC -o {other} {source}")
        ran = run_python("import cubewright", CUBEWRIGHT_LIBRARY=str(other))
        self.assertIn(f"is cubewright 9.1.0; this package is for {cw.__version__}", ran.stderr)


if __name__ == "__main__":
    main()
