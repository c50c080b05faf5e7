"""Tests that volumes are views of arrays, whatever their strides and types."""

import array as buffers
import gc
import tempfile
import warnings
import weakref
from pathlib import Path

import cubewright as cw
import numpy as np
from support import Case, main, make_ball

TYPES = ("u1", "i1", "u2", "i2", "u4", "i4", "f4", "f8")


def address_of(volume):
    return volume._resolved.data


class Filters(Case):
    def test_values_of_single_voxels_go(self):
        voxels = np.zeros((9, 8, 7), "i2")
        voxels[4, 4, 3] = 1000
        self.assertEqual(cw.Volume(voxels).median().array.max(), 0)
        self.assertEqual(cw.Volume(voxels).median(2, threads=1).array.max(), 0)
        smooth = cw.Volume(voxels.astype("f4")).smooth((0, 0, 1)).array
        self.assertEqual(np.count_nonzero(smooth), 9)
        self.assertAlmostEqual(float(smooth.sum()), 1000, places=2)

    def test_filters_that_keep_edges_take_noise(self):
        noise = np.random.default_rng(1).standard_normal((24, 26, 28)).astype("f4") * 10
        wall = np.where(np.arange(28) >= 14, 1000, 0).astype("f4")
        volume = cw.Volume(noise + wall)
        self.assertAlmostEqual(volume.noise(), 10, delta=1.5)
        for made in (volume.bilateral(), volume.anisotropic(), volume.nlm(), volume.nlm(10, 2, threads=1)):
            self.assertLess(float(np.std(made.array - wall)), 6)
            self.assertGreater(float(made.array[:, :, 14].min()), 900)

    def test_tables_go(self):
        z, y, x = np.mgrid[:20, :40, :60]
        scan = np.where(np.hypot((x - 30) / 20, (y - 18) / 12) < 1, 40, -1000).astype("i2")
        body = scan.copy()
        scan[:, 36:38] = 100
        made = cw.Volume(scan, spacing=(3, 3, 3)).remove_table()
        self.assertTrue((made.array == body).all())
        with self.assertRaisesRegex(cw.Error, "nothing above -300 HU"):
            cw.Volume(scan - 2000).remove_table()

    def test_what_is_inside_is_changed(self):
        ball = make_ball()
        volume = cw.Volume(ball)
        half = np.zeros(ball.shape, "u1")
        half[: ball.shape[0] // 2] = 1
        cut = volume.mask(half, 0).array
        self.assertFalse((cut[ball.shape[0] // 2 :] >= 0).any())
        self.assertTrue((cut[: ball.shape[0] // 2] == ball[: ball.shape[0] // 2]).all())
        self.assertFalse((volume.open(100, 0).array >= 0).any())
        self.assertGreaterEqual((volume.close(3, 0).array >= 0).sum(), (ball >= 0).sum())
        part = volume.crop_to(0, margin=1)
        self.assertLess(part.array.size, ball.size)
        whole, mesh = cw.extract(volume, 0), cw.extract(part, 0, largest=1)
        self.assertEqual(len(mesh.triangles), len(whole.triangles))
        with self.assertRaisesRegex(cw.Error, r"^radius.0. is 999; 0 to 250"):
            volume.open(999, 0)
        with self.assertRaisesRegex(cw.Error, "no voxel is at or above 1e"):
            volume.crop_to(1e9)

    def test_means_are_floats(self):
        for dtype, means in (("u1", "f4"), ("i2", "f4"), ("i4", "f8"), ("f4", "f4"), ("f8", "f8")):
            volume = cw.Volume(np.random.default_rng(5).integers(0, 99, (8, 8, 8)).astype(dtype))
            for made in (volume.smooth(1), volume.bilateral(), volume.anisotropic(), volume.nlm(),
                         volume.resample(0.5)):  # fmt: skip
                self.assertEqual((made.dtype, (made.array % 1 != 0).any()), (np.dtype(means), True))
            for kept in (volume.median(), volume.open(1, 3), volume.mask(volume, 3)):
                self.assertEqual(kept.dtype, np.dtype(dtype))

    def test_slopes_stay_when_voxels_become_smaller(self):
        voxels = np.arange(20, dtype="f8") + np.zeros((4, 5, 1))
        for kernel in ("linear", "cubic"):
            fine = cw.Volume(voxels, spacing=(2, 1, 1)).resample((0.5, 0, 0), kernel)
            self.assertEqual((fine.shape, fine.spacing), ((4, 5, 77), (0.5, 1, 1)))
            self.assertTrue(np.allclose(fine.array[0, 0, 8:69], np.arange(8, 69) / 4))

    def test_arguments_are_named(self):
        volume = cw.Volume(np.zeros((3, 3, 3), "f4"))
        with self.assertRaisesRegex(ValueError, "kernel is 'spline'; one of linear, cubic"):
            volume.resample(1, "spline")
        with self.assertRaisesRegex(ValueError, "radius"):
            volume.median(4)
        with self.assertRaisesRegex(cw.Error, r"^sigma.0. is -1; 0 to 64"):
            volume.smooth(-1)


class Sharing(Case):
    def test_no_voxel_is_copied(self):
        for kind in TYPES:
            ball = make_ball().clip(-100, 100).astype(kind)
            volume = cw.Volume(ball)
            self.assertEqual(address_of(volume), ball.ctypes.data, kind)
            self.assertIs(volume.array, ball)

    def test_bool_arrays_are_bytes_in_the_same_memory(self):
        mask = make_ball() > 0
        volume = cw.Volume(mask)
        self.assertEqual((address_of(volume), volume.dtype), (mask.ctypes.data, np.uint8))
        self.assertTrue(cw.check(cw.extract(volume, 0.5)).holds)

    def test_any_strides_give_the_mesh_of_a_copy(self):
        ball = make_ball()
        z, y, x = ball.shape
        larger = np.full((2 * z, 3 * y, 2 * x + 1), 7.0, "f4")
        larger[::2, 1::3, 1::2] = ball
        reversed_ball = ball[::-1, ::-1, ::-1].copy()
        record = np.zeros(ball.shape, [("other", "f4"), ("value", "f4")])
        record["value"] = ball
        views = {
            "reversed": reversed_ball[::-1, ::-1, ::-1],
            "some reversed": ball[::-1, :, ::-1].copy()[::-1, :, ::-1],
            "Fortran": np.asfortranarray(ball),
            "transposed": ball.transpose(1, 2, 0).copy().transpose(2, 0, 1),
            "every second": larger[::2, 1::3, 1::2],
            "a field of records": record["value"],
        }
        expected = cw.extract(ball, 0)
        for name, view in views.items():
            with self.subTest(name):
                self.assertTrue(np.array_equal(view, ball))
                volume = cw.Volume(view)
                self.assertEqual(address_of(volume), view.ctypes.data)
                self.same_mesh(cw.extract(volume, 0), expected)

    def test_values_written_later_are_seen(self):
        ball = make_ball()
        volume = cw.Volume(ball)
        before = cw.extract(volume, 0)
        ball -= 2
        self.assertLess(cw.check(cw.extract(volume, 0)).quality["volume_mm3"], cw.check(before).quality["volume_mm3"])

    def test_read_only_arrays_and_buffers_are_shared(self):
        ball = make_ball()
        ball.flags.writeable = False
        self.assertEqual(address_of(cw.Volume(ball)), ball.ctypes.data)
        numbers = buffers.array("f", make_ball().ravel())
        view = memoryview(numbers).cast("B").cast("f", make_ball().shape)
        self.assertEqual(address_of(cw.Volume(view)), np.asarray(view).ctypes.data)
        self.same_mesh(cw.extract(cw.Volume(view), 0), cw.extract(ball, 0))

    def test_a_volume_keeps_its_array_alive_and_lets_it_go(self):
        ball = make_ball()
        alive = weakref.ref(ball)
        volume = cw.Volume(ball)
        del ball
        gc.collect()
        self.assertIsNotNone(alive())
        del volume
        gc.collect()
        self.assertIsNone(alive())

    def test_the_array_of_a_read_volume_keeps_its_memory(self):
        gc.collect()
        before = cw.memory_used()
        voxels = cw.make("sphere", dims=32).array
        gc.collect()
        self.assertGreaterEqual(cw.memory_used(), before + voxels.nbytes)
        self.assertGreater(voxels.max(), 20)
        del voxels
        gc.collect()
        self.assertEqual(cw.memory_used(), before)

    def test_strides_beyond_2_GB_are_followed(self):
        big = np.zeros((1100, 1400, 1500), np.uint8)  # pages of zeros take no memory
        self.assertGreater(big.nbytes, 2**31)
        big[-8:-4, -8:-4, -8:-4] = 1
        mesh = cw.extract(cw.Volume(big[-16:]), 0.5)
        self.assertTrue(np.allclose(mesh.bounds.mean(axis=0), [1493.5, 1393.5, 9.5]))
        apart = big[4::543]  # 0, 0 and then the block, 1.1 GB from slice to slice
        apart[-1, 5:9, 5:9] = 1
        self.assertEqual(cw.check(cw.extract(apart, 0.5)).quality["components"], 1)


class Copies(Case):
    def test_only_what_c_cannot_address_is_copied(self):
        ball = make_ball()
        room = np.zeros(ball.nbytes + 1, np.uint8)
        unaligned = room[1:].view("f4").reshape(ball.shape)
        unaligned[...] = ball
        for name, odd in {
            "swapped": ball.astype(ball.dtype.newbyteorder()),
            "not aligned": unaligned,
            "repeated": np.broadcast_to(ball[:, :, :1], ball.shape),
        }.items():
            with self.subTest(name):
                volume = cw.Volume(odd)
                self.assertNotEqual(address_of(volume), odd.ctypes.data)
                self.same_mesh(cw.extract(volume, 0), cw.extract(np.ascontiguousarray(odd, "f4"), 0))
                with self.assertRaisesRegex(ValueError, "byte-swapped, not aligned"):
                    cw.Volume(odd, copy=False)

    def test_a_constant_of_one_repeated_voxel_is_read_within_its_memory(self):
        self.assertEqual(len(cw.extract(np.broadcast_to(np.float32(1), (9, 9, 9)), 5).triangles), 0)

    def test_copy_true_copies(self):
        ball = make_ball()
        volume = cw.Volume(ball, copy=True)
        self.assertFalse(np.shares_memory(volume.array, ball))


class Frames(Case):
    def test_the_axes_of_spacing_and_origin_are_x_y_z(self):
        volume = cw.Volume(make_ball(), spacing=(0.5, 1, 2), origin=(-5, 6, 7))
        self.assertEqual(volume.spacing, (0.5, 1, 2))
        self.assertEqual(volume.origin, (-5, 6, 7))
        self.assertEqual(volume.world((2, 3, 4)), (-4, 9, 15))
        self.assertEqual(volume.index((-4, 9, 15)), (2, 3, 4))
        self.assertEqual(volume.sample((-4, 9, 15)), volume.array[4, 3, 2])

    def test_an_affine_moves_the_mesh(self):
        turn = np.array([[0, -1, 0, 3.0], [1, 0, 0, 4], [0, 0, 1, 5], [0, 0, 0, 1]])
        plain, turned = cw.extract(make_ball(), 0), cw.extract(cw.Volume(make_ball(), affine=turn), 0)
        moved = plain.world_vertices() @ turn[:3, :3].T + turn[:3, 3]
        self.assertTrue(np.allclose(moved, turned.world_vertices(), atol=1e-5))
        self.assertTrue(np.array_equal(turned.affine, turn))

    def test_units_of_a_ten_thousandth_and_of_ten_thousand_scale_the_mesh(self):
        plain = cw.extract(make_ball(), 0)
        for unit in (1e-4, 1e4):
            mesh = cw.extract(cw.Volume(make_ball(), spacing=unit), 0)
            self.assertTrue(np.array_equal(mesh.triangles, plain.triangles))
            self.assertTrue(np.allclose(mesh.world_vertices() / unit, plain.world_vertices(), rtol=1e-5))
            self.assertTrue(cw.check(mesh).holds)

    def test_slope_and_intercept_are_of_the_isovalue(self):
        ball = make_ball()
        scaled = cw.Volume((ball * 100).astype("i2"), slope=0.01, intercept=5)
        self.assertEqual(scaled.sample((3, 4, 5)), 0.01 * scaled.array[5, 4, 3] + 5)
        self.assertEqual(cw.check(cw.extract(scaled, 5)).quality["components"], 1)

    def test_nodata_and_nan_are_outside(self):
        ball = make_ball()
        missing = ball.copy()
        missing[:6] = np.nan
        numbers = np.where(np.isnan(missing), -999, missing).astype("f4")
        with_nan, with_number = cw.extract(missing, 0), cw.extract(cw.Volume(numbers, nodata=-999), 0)
        self.same_mesh(with_nan, with_number)
        self.assertTrue(cw.check(with_nan).holds)

    def test_rectilinear_planes(self):
        ball = make_ball()
        planes = [np.arange(n) ** 1.1 for n in ball.shape[::-1]]
        volume = cw.Volume(ball, coordinates=planes)
        self.assertEqual(volume.kind, "rectilinear")
        self.assertTrue(cw.check(cw.extract(volume, 0)).holds)

    def test_components_and_steps(self):
        ball = make_ball()
        several = np.stack([np.stack([ball, ball - 1], axis=-1), np.stack([ball - 2, ball - 3], axis=-1)])
        volume = cw.Volume(several, components=True, steps=True)
        self.assertEqual((volume.components, volume.steps, volume.shape), (2, 2, ball.shape))
        for step in (0, 1):
            for component in (0, 1):
                mesh = cw.extract(volume, 0, component=component, step=step)
                self.same_mesh(mesh, cw.extract(ball - np.float32(2 * step + component), 0))
        planar = np.stack([ball, ball - 1])
        self.same_mesh(
            cw.extract(cw.Volume(np.moveaxis(planar, 0, -1), components=True), 0, component=1),
            cw.extract(ball - np.float32(1), 0),
        )
        with self.fails(cw.Status.ARGUMENT):
            cw.extract(volume, 0, step=2)

    def test_level_sets_are_low_inside(self):
        ball = make_ball()
        self.same_mesh(cw.extract(cw.Volume(-ball, level_set=True), 0), cw.extract(-ball, 0, inside="below"))

    def test_types_that_are_copied_to_one_that_holds_them(self):
        ball = make_ball(scale=8)
        half = ball.astype("f2")
        self.assertEqual(cw.Volume(half).dtype, np.float32)
        self.same_mesh(cw.extract(half, 0), cw.extract(half.astype("f4"), 0))
        for dtype, offset, wanted in (("i8", 0, "i4"), ("i8", 2**31, "u4"), ("u8", 2**20, "i4"), ("u8", 2**31, "u4")):
            voxels = np.maximum(ball, 0).astype(dtype) + np.array(offset, dtype)
            self.assertEqual(cw.Volume(voxels).dtype, np.dtype(wanted), (dtype, offset))
            self.assertTrue(np.array_equal(cw.Volume(voxels).array, voxels))
            with self.assertRaisesRegex(ValueError, wanted):
                cw.Volume(voxels, copy=False)

    def test_levels_have_names(self):
        volume = cw.make("ct-head", dims=48)
        found = volume.statistics(bins=512)
        self.assertEqual(volume.level("otsu"), float(f"{found.otsu:.6g}"))
        self.assertTrue(volume.level("dark") < volume.level("medium") < volume.level("bright"))
        self.assertAlmostEqual(volume.level("25%"), found.min + (found.max - found.min) / 4, 2)
        self.assertEqual(volume.level("bone"), 226)
        self.same_mesh(cw.extract(volume, "bone"), cw.extract(volume, 226))
        self.same_mesh(cw.Extractor(volume).extract("otsu"), cw.extract(volume, volume.level("otsu")))
        self.assertTrue(cw.check(cw.extract(volume, "bone"), source=volume, iso="bone").holds)
        with self.fails(cw.Status.ARGUMENT, "isovalue bone", "Hounsfield"):
            cw.extract(make_ball(), "bone")
        with self.fails(cw.Status.ARGUMENT, "isovalue bones", "otsu", "metal"):
            cw.extract(volume, "bones")
        for wrong in ("101%", "-1%", "%", "12"):
            with self.fails(cw.Status.ARGUMENT, f"isovalue {wrong}"):
                volume.level(wrong)
        with self.fails(cw.Status.EMPTY, "finite"):
            cw.Volume(np.full((4, 4, 4), np.nan, "f4")).level("otsu")

    def test_an_isovalue_that_joins_labels_is_warned_of(self):
        cells = cw.make("labels/cells", labels=5, type="u8")
        with self.assertWarnsRegex(UserWarning, "joins 5 of them; extract_labels"):
            cw.extract(cells, 0.5)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            cw.extract(cells, 4.5)  # one label alone
            cw.extract(cw.make("ct-head", dims=32, type="i16"), 226)
            cw.extract_labels(cells)

    def test_statistics(self):
        volume = cw.make("ct-head", dims=32, type="i16")
        found = volume.statistics(bins=64)
        self.assertEqual(found.min, volume.array.min())
        self.assertEqual(found.counts.sum(), volume.array.size)
        self.assertTrue(found.min < found.otsu < found.max)


class Mistakes(Case):
    def test_wrong_types(self):
        for dtype in ("c8", "U3", "O", "M8[s]"):
            with self.subTest(dtype), self.assertRaisesRegex(TypeError, "bool, integers, or floats of up to 64 bits"):
                cw.Volume(np.zeros((4, 4, 4), dtype))
        with self.assertRaisesRegex(TypeError, "filled"):
            cw.Volume(np.ma.masked_less(make_ball(), 0))
        with self.assertRaises(TypeError):
            cw.Volume(make_ball(), spacings=1)
        with self.assertRaises(TypeError):
            cw.Volume(make_ball(), spacing=b"1mm")
        with self.assertRaises(TypeError):
            cw.Volume(make_ball(), spacing=1, affine=np.eye(4))

    def test_values_beyond_32_bits(self):
        for dtype, value in (("i8", -(2**31) - 1), ("i8", 2**32), ("u8", 2**40)):
            with self.subTest(dtype), self.assertRaisesRegex(TypeError, f"{value}.*32 bits do not hold.*astype"):
                cw.Volume(np.full((2, 2, 2), value, dtype))

    def test_wrong_shapes(self):
        for shape in ((4,), (4, 4), (4, 4, 4, 3)):
            with self.subTest(shape), self.assertRaisesRegex(ValueError, "axes"):
                cw.Volume(np.zeros(shape, "f4"))
        with self.assertRaisesRegex(ValueError, "empty"):
            cw.Volume(np.zeros((4, 0, 4), "f4"))
        with self.fails(cw.Status.ARGUMENT):
            cw.extract(np.zeros((1, 4, 4), "f4"), 0)

    def test_wrong_frames(self):
        for spacing in (0, -1, (1, 1), (1, 1, np.nan), np.inf):
            with self.subTest(spacing), self.assertRaises(ValueError):
                cw.Volume(make_ball(), spacing=spacing)
        with self.fails(cw.Status.ARGUMENT, "affine"):
            cw.Volume(make_ball(), affine=np.zeros((3, 4)) + 1)
        with self.assertRaisesRegex(ValueError, "shape"):
            cw.Volume(make_ball(), affine=np.eye(3))
        with self.assertRaises(ValueError):
            cw.Volume(make_ball(), slope=0)
        with self.assertRaises(ValueError):
            cw.Volume(make_ball(), coordinates=[np.arange(3.0)] * 3)


class Voxelizing(Case):
    def test_labels_of_an_extracted_surface_are_the_voxels_above_the_level(self):
        volume = cw.Volume(make_ball(), spacing=(1, 2, 0.5), origin=(5, 6, 7))
        back = cw.extract(volume, 0).voxelize(like=volume)
        level = np.asarray(volume.array) >= 0
        inside = back.volume.array > 0
        self.assertTrue(np.array_equal(inside, level) or np.array_equal(inside, ~level))
        self.assertEqual(back.volume.array.dtype, np.uint8)
        self.assertEqual(back.parts[0].voxels, int(inside.sum()))
        np.testing.assert_array_equal(back.volume.affine, volume.affine)

    def test_fractions_add_up_to_the_volume(self):
        mesh = cw.extract(make_ball(), 0)
        made = cw.voxelize(mesh, spacing=(1.7, 2, 2.3), partial=True)
        self.assertEqual(made.volume.array.dtype, np.float32)
        sum = float(made.volume.array.sum(dtype="f8")) * 1.7 * 2 * 2.3
        self.assertAlmostEqual(sum / made.parts[0].volume, 1, 5)
        self.assertAlmostEqual(made.parts[0].filled / made.parts[0].volume, 1, 6)

    def test_several_meshes_get_their_labels_and_names(self):
        ball = cw.extract(make_ball(), 0)
        other = cw.transform(ball, [[1, 0, 0, 100], [0, 1, 0, 0], [0, 0, 1, 0]])
        made = cw.voxelize([ball, other], spacing=2, labels=[7, 300])
        self.assertEqual(set(np.unique(made.volume.array)), {0, 7, 300})
        self.assertEqual([p.label for p in made.parts], [7, 300])
        made.volume.labels = [cw.Label(7, 0, "left", (255, 0, 0, 255)), cw.Label(300, 0, "right", None)]
        with tempfile.TemporaryDirectory() as folder:
            for name in ("a.nii.gz", "a.nrrd"):
                cw.write(Path(folder) / name, made.volume)
                back = cw.read_volume(Path(folder) / name)
                self.assertEqual([label.name for label in back.labels], ["left", "right"])
                np.testing.assert_array_equal(back.array, made.volume.array)

    def test_values_inside_of_a_mesh(self):
        array = np.zeros((20, 20, 20), "f4")
        array[:, :, 10:] = 5
        volume = cw.Volume(array, spacing=2)
        corners = np.array([[x, y, z] for x in (9, 29) for y in (9, 29) for z in (9, 29)], "f4")
        faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6],
                 [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]  # fmt: skip
        box = cw.Mesh.from_arrays(corners, np.array(faces, "u4"))
        found = cw.measure_within(volume, box)
        self.assertAlmostEqual(found.volume, 8000, 1)
        self.assertAlmostEqual(found.mean, 2.5, 5)
        self.assertAlmostEqual(found.sd, 2.5, 5)
        self.assertEqual((found.min, found.max, found.mesh.outside_area), (0, 5, 0))
        with self.assertRaisesRegex(cw.Error, "outside"):
            cw.measure_within(cw.Volume(array, origin=(500, 0, 0)), box)

    def test_what_makes_no_sense_is_refused(self):
        ball = cw.extract(make_ball(), 0)
        for arguments, words in (({}, "grid is required"), ({"spacing": 1, "like": cw.Volume(make_ball())}, "not both")):
            with self.assertRaisesRegex(cw.Error, words):
                ball.voxelize(**arguments)
        with self.assertRaisesRegex(ValueError, "labels has 2"):
            ball.voxelize(spacing=1, labels=[1, 2])
        open_mesh = cw.Mesh.from_arrays(ball.vertices, ball.triangles[1:])
        with self.assertRaises(cw.Error) as caught:
            open_mesh.voxelize(spacing=1)
        self.assertEqual(caught.exception.status, cw.Status.CHECK)


if __name__ == "__main__":
    main()
