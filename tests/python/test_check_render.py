"""Tests checks, reports and pictures."""

import gc
import json

import cubewright as cw
import numpy as np
from support import Case, main, make_ball


class Checks(Case):
    def test_defects_are_counted_and_marked(self):
        mesh = cw.extract(make_ball(), 0)
        holed = cw.Mesh.from_arrays(mesh.vertices, mesh.triangles[1:])
        found = cw.check(holed, profile="print")
        self.assertFalse(found.holds)
        self.assertEqual((found.quality["open_edges"], found.quality["border_loops"]), (3, 1))
        self.assertEqual((found.defects & 1).sum(), 3)
        self.assertEqual(found.verdicts[0].grade, "fail")
        flipped = cw.Mesh.from_arrays(mesh.vertices, mesh.triangles[:, ::-1].copy())
        self.assertEqual(cw.check(flipped).quality["inside_out"], 1)

    def test_prints_are_turned(self):
        corners = np.array([[x, y, z] for x in (0, 10) for y in (0, 20) for z in (0, 40)], "f4")
        faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6],
                 [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]  # fmt: skip
        found = cw.orient_print(cw.Mesh.from_arrays(corners, np.array(faces, "u4")))
        self.assertTrue(found.stable and not found.kept)
        self.assertAlmostEqual(found.before.height, 40, 4)
        self.assertAlmostEqual(found.after.height, 10, 4)
        self.assertAlmostEqual(found.after.hull_area, 800, 2)
        low, high = found.mesh.bounds
        self.assertAlmostEqual(high[2] - low[2], 10, 4)
        again = cw.orient_print(found.mesh, overhang=30)
        self.assertTrue(again.kept and again.mesh is found.mesh)

    def test_prints_are_measured(self):
        mesh = cw.extract(make_ball(), 0)
        found = cw.check(mesh, profile="print", wall=100, plate=(5, 50, 50))
        names = {verdict.name: verdict.grade for verdict in found.verdicts}
        self.assertEqual((names["walls"], names["plate"], names["islands"]), ("warn", "fail", "ok"))
        size = np.ptp(mesh.vertices[:, 2])
        self.assertLess(abs(found.print["wall_mm"] / size - 1), 0.02)
        self.assertIsNone(found.print["gap_mm"])
        self.assertEqual((found.print["min_wall_mm"], found.print["plate_mm"]), (100, [5, 50, 50]))
        self.assertFalse(found.print["fits"])
        json.dumps(cw.report(mesh, profile="print"), allow_nan=False)
        self.assertIsNone(cw.check(mesh).print)
        self.assertRaises(ValueError, lambda: cw.check(mesh, profile="print", wall=-1))
        self.assertRaises(ValueError, lambda: cw.check(mesh, profile="print", plate=(1, 2)))
        with self.fails(cw.Status.ARGUMENT):
            cw.check(mesh, profile="print", plate=(1, 2, 0))

    def test_distances_to_a_source_name_missing_components(self):
        ball = make_ball()
        speck = ball.copy()
        speck[1, 1, 1] = 5
        found = cw.check(cw.extract(ball, 0), source=speck, iso=0)
        self.assertEqual(found.missing, 1)
        self.assertLess(found.distances["from_source"]["max_mm"], 0.01)

    def test_distances_to_a_reference(self):
        mesh = cw.extract(make_ball(), 0)
        moved = cw.Mesh.from_arrays(mesh.vertices, mesh.triangles, origin=mesh.origin + [1, 0, 0])
        found = cw.check(mesh, reference=moved, tolerance=0.5)
        self.assertFalse(found.holds)
        self.assertAlmostEqual(found.distances["to_reference"]["max_mm"], 1, 1)

    def test_a_report_is_json(self):
        report = cw.report(cw.extract(make_ball(), 0), profile="fem", source=make_ball(), iso=0)
        self.assertEqual(json.loads(json.dumps(report))["profile"], "fem")
        self.assertEqual(len(report["quality"]["shapes"]["angles"]), 18)

    def test_mistakes(self):
        mesh = cw.extract(make_ball(), 0)
        for wrong in ({"source": make_ball()}, {"iso": 1.0}, {"tolerance": 1.0}, {"reference": 1}, {"strict": 1}):
            with self.subTest(wrong), self.assertRaises(TypeError):
                cw.check(mesh, **wrong)
        with self.assertRaises(ValueError):
            cw.check(mesh, profile="fine")
        with self.fails(cw.Status.CANCELLED):
            cw.check(cw.extract(cw.make("gyroid", dims=128), 0), deep=True, progress=lambda *_: False)


class Pictures(Case):
    def test_a_mesh_is_in_the_middle_of_its_picture(self):
        mesh = cw.extract(make_ball(), 0)
        picture = cw.render(mesh, size=(80, 60), background=(255, 0, 0, 0))
        self.assertEqual((picture.shape, picture.dtype), ((60, 80, 4), np.uint8))
        self.assertEqual((picture[30, 40, 3], picture[0, 0, 3]), (255, 0))
        self.assertTrue(np.array_equal(picture, cw.render(mesh, size=(80, 60), background=(255, 0, 0, 0), threads=1)))

    def test_a_picture_shares_memory_with_the_library(self):
        mesh = cw.extract(make_ball(), 0)
        gc.collect()
        before = cw.memory_used()
        picture = cw.render(mesh, size=(640, 480))
        self.assertFalse(picture.flags.owndata)
        del picture
        gc.collect()
        self.assertEqual(cw.memory_used(), before)

    def test_volume_modes_of_the_processor(self):
        ball = make_ball()
        for mode in ("vbuffer", "projection", "mip", "minip", "average", "local-mip"):
            picture = cw.render(ball, mode=mode, backend="cpu", size=(64, 48), samples=1)
            self.assertFalse(np.array_equal(picture[24, 32], picture[0, 0]), mode)
        both = cw.render(ball, mode="vbuffer", backend="cpu", size=(64, 48), mesh=cw.extract(ball, 5))
        self.assertEqual(both.shape, (48, 64, 4))

    def test_volume_modes_of_opengl(self):
        ball = make_ball()
        for mode in ("auto", "slices", "texture", "splat"):
            try:
                picture = cw.render(ball, mode=mode, size=(64, 48))
            except cw.Error as error:
                self.assertEqual(error.status, cw.Status.UNSUPPORTED)
                self.skipTest("no OpenGL")
            self.assertFalse(np.array_equal(picture[24, 32], picture[0, 0]), mode)

    def test_cameras_and_transfer_functions(self):
        mesh = cw.extract(make_ball()[6:], 0)
        pictures = [
            cw.render(mesh, size=(64, 48), camera=camera).tobytes()
            for camera in ("front", "top", "iso", (30, 20), {"eye": [12, -90, 9], "target": [12, 12, 9],
                           "up": [0, 0, 1], "fov_deg": 20})
        ]  # fmt: skip
        self.assertEqual(len(set(pictures)), 5)
        self.assertNotEqual(pictures[0], cw.render(mesh, size=(64, 48), ortho=True, zoom=2).tobytes())
        curves = {"colors": [[0, "#ff0000"]], "opacities": [[0, 0], [1, 1]]}
        red = cw.render(make_ball(), mode="vbuffer", backend="cpu", size=(64, 48), tf=curves)
        self.assertTrue(red[24, 32, 0] > 100 > red[24, 32, 1])

    def test_a_png_is_written(self):
        path = self.folder / "ball.png"
        cw.write_png(path, cw.render(cw.extract(make_ball(), 0), size=(64, 48)))
        cw.write_png(path, np.zeros((4, 4, 3), "u1"))
        self.assertEqual(path.read_bytes()[1:4], b"PNG")
        with self.assertRaises(ValueError):
            cw.write_png(path, np.zeros((4, 4), "u1"))

    def test_mistakes(self):
        mesh, ball = cw.extract(make_ball(), 0), make_ball()
        for wrong in (
            lambda: cw.render(mesh, mode="mip"),
            lambda: cw.render(ball, mode="mesh"),
            lambda: cw.render(mesh, mesh=mesh),
            lambda: cw.render(mesh, width=10),
            lambda: cw.render(ball, tf=3),
        ):
            self.assertRaises(TypeError, wrong)
        for wrong in (
            lambda: cw.render(mesh, mode="xray"),
            lambda: cw.render(mesh, size=(0, 10)),
            lambda: cw.render(mesh, size=(10, 20000)),
            lambda: cw.render(mesh, background=(1, 2)),
            lambda: cw.render(mesh, background=(1, 2, 256)),
            lambda: cw.render(mesh, backend="metal"),
        ):
            self.assertRaises(ValueError, wrong)
        for wrong in (
            lambda: cw.render(mesh, camera="above"),
            lambda: cw.render(ball, tf="gold"),
            lambda: cw.render(mesh, zoom=0),
            lambda: cw.render(cw.Mesh.from_arrays([], [])),
        ):
            with self.fails(cw.Status.ARGUMENT):
                wrong()
        with self.fails(cw.Status.CANCELLED):
            cw.render(mesh, progress=lambda *_: False)


if __name__ == "__main__":
    main()
