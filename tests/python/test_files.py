"""Tests reading and writing: what comes back, and what is refused."""

import base64
import gzip
import json
import pathlib

import cubewright as cw
import numpy as np
from support import ROOT, Case, main, make_ball


class Meshes(Case):
    def test_formats_that_keep_every_bit(self):
        mesh = cw.extract(make_ball(), 0)
        for suffix in (".ply", ".glb", ".obj", ".3mf", ".vtp"):
            with self.subTest(suffix):
                path = self.folder / f"ball{suffix}"
                try:
                    cw.write(path, mesh)
                except cw.Error as error:
                    self.assertEqual(error.status, cw.Status.UNSUPPORTED)
                    continue
                again = cw.read_mesh(path)
                self.assertTrue(np.array_equal(again.triangles, mesh.triangles))
                self.assertLess(np.abs(again.world_vertices() - mesh.world_vertices()).max(), 1e-5)

    def test_an_stl_that_breaks_off(self):
        mesh = cw.extract(make_ball(), 0)
        path = self.folder / "ball.stl"
        cw.write(path, mesh)
        path.write_bytes(path.read_bytes()[:-120])
        with self.fails(cw.Status.FORMAT):
            cw.read_mesh(path)
        self.assertEqual(len(cw.read_mesh(path, truncated=True).triangles), len(mesh.triangles) - 3)

    def test_options(self):
        mesh = cw.extract(make_ball(), 0)
        path = self.folder / "ball.ply"
        cw.write(path, mesh, ascii=True, unit="cm")
        self.assertIn(b"format ascii", path.read_bytes()[:40])
        self.assertTrue(np.allclose(cw.read_mesh(path).bounds, mesh.bounds))
        with self.fails(cw.Status.OUTPUT):
            cw.write(path, mesh, no_clobber=True)
        self.need("draco")
        loss = cw.write(self.folder / "ball.glb", mesh, compress="draco", tolerance=0.01)
        self.assertTrue(0 < loss.error_mm <= 0.01)

    def test_parts_keep_their_names(self):
        mesh = cw.extract(make_ball(), 0)
        path = self.folder / "parts.obj"
        cw.write(path, {"first": mesh, "second": mesh})
        text = path.read_text()
        self.assertIn("first", text)
        self.assertIn("second", text)
        self.assertEqual(len(cw.read_mesh(path).triangles), 2 * len(mesh.triangles))

    def test_colours_of_faces(self):
        mesh = cw.extract(make_ball(), 0)
        self.assertIsNone(mesh.face_colors)
        colors = np.full((len(mesh.triangles), 4), (255, 0, 0, 255), np.uint8)
        colors[: len(colors) // 2] = (0, 0, 255, 255)
        colors[-1] = (0, 255, 0, 255)
        for make in (
            lambda: cw.Mesh.from_arrays(mesh.vertices, mesh.triangles, face_colors=colors),
            lambda: cw.Mesh.from_arrays(mesh.vertices, mesh.triangles, face_colors=colors.tolist()).copy(),
        ):
            self.assertTrue(np.array_equal(make().face_colors, colors))
        mesh.face_colors = colors
        self.assertIn("face_colors", repr(mesh))
        for suffix in (".ply", ".stl", ".vtp", ".glb"):
            with self.subTest(suffix):
                path = self.folder / f"ball{suffix}"
                try:
                    cw.write(path, mesh)
                except cw.Error as error:
                    self.assertEqual(error.status, cw.Status.UNSUPPORTED)
                    continue
                again = cw.read_mesh(path).face_colors
                self.assertEqual(sorted(map(tuple, again)), sorted(map(tuple, colors)))
        solids = cw.split(mesh)
        self.assertEqual(len(solids), 1)
        self.assertEqual(sorted(map(tuple, solids[0].face_colors)), sorted(map(tuple, colors)))
        mesh.face_colors = colors[:, ::-1]
        self.assertEqual(tuple(mesh.face_colors[-1]), (255, 0, 255, 0))
        mesh.face_colors = None
        self.assertIsNone(mesh.face_colors)
        for wrong in (colors[1:], colors[:, :3], colors.astype("i4") + 1):
            with self.assertRaises(ValueError):
                mesh.face_colors = wrong
        with self.assertRaises(TypeError):
            mesh.face_colors = colors / 255

    def test_facts_of_files(self):
        (self.folder / "a.mtl").write_text("newmtl wood\nmap_Ks wood.png\n")
        text = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl wood\nf 1 2 3\n"
        (self.folder / "a.obj").write_text(text)
        facts = cw.read_mesh(self.folder / "a.obj").facts
        self.assertEqual((facts["format"], facts["left_out"], facts["not_applied"]), ("obj", "other pictures of materials", ""))
        self.assertEqual((facts["parts"], facts["truncated"]), (1, False))
        (self.folder / "b.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 4 3\nl 1 2\n")
        facts = cw.read_parts(self.folder / "b.obj")[0].mesh.facts
        self.assertEqual((facts["polygons"], facts["skipped"], facts["left_out"]), (1, 1, ""))
        self.need("gltf")
        hidden = {"extensions": {"KHR_node_visibility": {"visible": False}}, "mesh": 0, "name": "wheel"}
        buffer = base64.b64encode(np.float32([0, 0, 0, 1, 0, 0, 0, 1, 0]).tobytes()).decode()
        scene = {
            "asset": {"version": "2.0"},
            "buffers": [{"byteLength": 36, "uri": "data:;base64," + buffer}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "nodes": [{"mesh": 0}, hidden],
        }
        (self.folder / "a.gltf").write_text(json.dumps(scene))
        facts = cw.read_mesh(self.folder / "a.gltf").facts
        self.assertEqual((facts["invisible"], facts["invisible_names"], facts["parts"]), (1, "wheel", 1))
        json.dumps(facts)

    def test_parts_come_back_with_colours(self):
        self.need("gltf")
        mesh = cw.extract(make_ball(), 0)
        other = mesh.copy()
        other.face_colors = np.resize(np.uint8([[9, 8, 7, 255], [200, 0, 0, 255]]), (len(mesh.triangles), 4))
        given = [cw.Part("liver", mesh, cw.Label(3, 0, "liver", (1, 128, 254, 255))), cw.Part("tube", other)]
        path = self.folder / "parts.glb"
        for _ in range(2):
            cw.write(path, given)
            given = cw.read_parts(path)
            self.assertEqual([part.name for part in given], ["liver", "tube"])
            self.assertEqual(given[0].label, cw.Label(3, 0, "liver", (1, 128, 254, 255)))
            self.assertIsNone(given[1].label)
            self.assertEqual(len(np.unique(given[1].mesh.face_colors, axis=0)), 2)
            self.assertEqual(given[0].mesh.facts["parts"], 2)
        self.same_mesh(given[0].mesh, cw.read_parts(path)[0].mesh)
        with self.assertRaises(TypeError):
            cw.write(path, [mesh])
        with self.assertRaises(TypeError):
            cw.write(path, "parts")
        with self.fails(cw.Status.IO):
            cw.read_parts(self.folder / "missing.obj")

    def test_mistakes(self):
        mesh = cw.extract(make_ball(), 0)
        with self.fails(cw.Status.IO, "missing.ply"):
            cw.read_mesh(self.folder / "missing.ply")
        with self.fails(cw.Status.OUTPUT):
            cw.write(self.folder / "no folder" / "a.ply", mesh)
        with self.fails(cw.Status.ARGUMENT):
            cw.write(self.folder / "a.unknown", mesh)
        damaged = self.folder / "damaged.ply"
        damaged.write_bytes(b"ply\nformat ascii 1.0\nelement vertex many\nend_header\n")
        with self.fails(cw.Status.FORMAT):
            cw.read_mesh(damaged)
        with self.assertRaises(TypeError):
            cw.write(self.folder / "a.ply", np.zeros(3))
        with self.assertRaises(TypeError):
            cw.write(self.folder / "a.ply", {"first": np.zeros(3)})
        with self.assertRaises(ValueError):
            cw.write(self.folder / "a.glb", mesh, compress="zip")
        with self.assertRaises(TypeError):
            cw.write(self.folder / "a.glb", mesh, compression="draco")


class Volumes(Case):
    def test_every_type_and_frame_comes_back(self):
        ball = make_ball(8)
        for kind in ("u1", "i2", "u2", "i4", "f4", "f8"):
            path = self.folder / f"{kind}.nrrd"
            volume = cw.Volume(ball.clip(0).astype(kind)[::-1], spacing=(0.5, 1, 2), origin=(-3, 4, 5))
            cw.write(path, volume)
            again = cw.read_volume(path)
            self.assertTrue(np.array_equal(again.array, volume.array))
            self.assertEqual((again.dtype, again.format), (volume.dtype, "nrrd"))
            self.assertTrue(np.allclose(again.affine, volume.affine))

    def test_crop_coarsen_raw_and_notes(self):
        ball = make_ball(8)
        path = self.folder / "ball.raw"
        ball.astype("<f4").tofile(path)
        z, y, x = ball.shape
        raw = f"dims={x}x{y}x{z},type=f32le"
        volume = cw.read_volume(path, raw=raw, spacing=(1, 2, 3), note=lambda text: None)
        self.assertTrue(np.array_equal(volume.array, ball))
        self.assertEqual(volume.spacing, (1, 2, 3))
        part = cw.read_volume(path, raw=raw, crop=((1, 6), (2, 5), (3, 4)))
        self.assertTrue(np.array_equal(part.array, ball[3:5, 2:6, 1:7]))
        self.assertEqual(part.origin, (1, 2, 3))
        self.assertTrue(np.array_equal(cw.read_volume(path, raw=raw, coarsen=2).array, ball[::2, ::2, ::2]))

    def test_levels_of_detail_and_animations_of_gltf(self):
        self.need("gltf")
        ball = cw.extract(make_ball(), 0)
        coarse = cw.Mesh.from_arrays(ball.vertices, ball.triangles[::2])
        levels = cw.Levels()
        levels.extend([ball, coarse])
        cw.write(self.folder / "levels.glb", levels)
        self.assertIn(b"MSFT_lod", (self.folder / "levels.glb").read_bytes())
        self.assertEqual(len(cw.read_mesh(self.folder / "levels.glb")), len(ball))
        steps = [cw.Part(f"step {n}", mesh, time=0.5 * n) for n, mesh in enumerate((ball, coarse, ball))]
        cw.write(self.folder / "steps.glb", steps)
        self.assertIn(b'"animations"', (self.folder / "steps.glb").read_bytes())
        with self.fails(cw.Status.ARGUMENT):
            cw.write(self.folder / "steps.stl", steps)
        with self.fails(cw.Status.ARGUMENT):
            cw.write(self.folder / "back.glb", [steps[1], steps[0]])
        with self.fails(cw.Status.ARGUMENT):
            cw.write(self.folder / "gap.glb", [cw.Part("fine", ball), cw.Part("coarse", coarse, level=2)])

    def test_levels_of_n5_stores(self):
        store = self.folder / "image.n5"
        fine = np.arange(5 * 4 * 6, dtype=">u2").reshape(5, 4, 6)
        for number, voxels in enumerate((fine, fine[:, ::2, ::2])):
            level = store / f"s{number}"
            (level / "0/0").mkdir(parents=True)
            sizes = list(reversed(voxels.shape))
            attributes = {"dimensions": sizes, "blockSize": sizes, "dataType": "uint16"}
            attributes |= {"compression": {"type": "gzip"}, "downsamplingFactors": [1 + number, 1 + number, 1]}
            (level / "attributes.json").write_text(json.dumps(attributes))
            header = np.array([0, 3], ">u2").tobytes() + np.array(sizes, ">u4").tobytes()
            (level / "0/0/0").write_bytes(header + gzip.compress(voxels.tobytes()))
        (store / "attributes.json").write_text('{"resolution": [4, 4, 30], "units": ["um", "um", "um"]}')
        volume = cw.read_volume(store)
        self.assertTrue((volume.array == fine).all())
        self.assertTrue(np.allclose(volume.spacing, (0.004, 0.004, 0.03)))
        volume = cw.read_volume(store, level=1)
        self.assertTrue((volume.array == fine[:, ::2, ::2]).all())
        self.assertTrue(np.allclose(volume.affine[:3, 3], (0.002, 0.002, 0)))
        self.assertEqual(cw.read_volume(store, array="s1").array.shape, (5, 2, 3))

    def test_names_and_colours_of_labels_come_with_their_volume(self):
        path = self.folder / "organs.seg.nrrd"
        fields = ("NRRD0004", "type: uint8", "dimension: 3", "sizes: 4 4 4", "encoding: raw",
                  "space: left-posterior-superior", "space directions: (1,0,0) (0,1,0) (0,0,1)",
                  "space origin: (0,0,0)", "Segment0_LabelValue:=1", "Segment0_Layer:=0", "Segment0_ID:=a",
                  "Segment0_Name:=Leber \u00e4", "Segment0_Color:=1 0.5 0", "Segment0_Extent:=0 3 0 3 0 3")  # fmt: skip
        path.write_bytes("\n".join([*fields, "", ""]).encode() + bytes([0] * 32 + [1] * 32))
        volume = cw.read_volume(path)
        self.assertEqual(volume.labels, [cw.Label(1, 0, "Leber \u00e4", (255, 128, 0, 255))])
        self.assertEqual(cw.extract_labels(volume).voxels, {1: 32})

    def test_a_real_scan_if_it_is_there(self):
        scan = ROOT.parent / "shared" / "data" / "headsq-ct" / "headsq.mha"
        if not scan.exists():
            self.skipTest("no scan")
        volume = cw.read_volume(scan, coarsen=2)
        mesh = cw.extract(volume, 1150)
        self.assertTrue(cw.check(mesh, source=volume, iso=1150, tolerance=6.4).holds)

    def test_mistakes(self):
        with self.fails(cw.Status.IO, "missing.nrrd"):
            cw.read_volume("missing.nrrd")
        with self.fails(cw.Status.ARGUMENT):
            cw.read_volume(pathlib.Path(__file__), reader="unheard-of")
        with self.fails(cw.Status.FORMAT):
            cw.read_volume(pathlib.Path(__file__), reader="nrrd")
        with self.fails(cw.Status.ARGUMENT, "dims"):
            cw.read_volume(pathlib.Path(__file__), raw="dims=0x2")
        path = self.folder / "ball.nrrd"
        cw.write(path, cw.Volume(make_ball(8)))
        with self.fails(cw.Status.CANCELLED):
            cw.read_volume(path, progress=lambda step, done: False)
        with self.fails(cw.Status.LIMIT, "the limit is 10 (max_voxels=)"):
            cw.read_volume(path, max_voxels=10)
        path.write_bytes(path.read_bytes()[:-100])
        with self.fails(cw.Status.FORMAT):
            cw.read_volume(path)
        for wrong in ({"crop": 3}, {"spacing": b"1"}, {"sandbox": 1}, {"note": 1}, {"series": 1}, {"level": "0"}):
            with self.subTest(wrong), self.assertRaises(TypeError):
                cw.read_volume(path, **wrong)
        with self.assertRaises(TypeError):
            cw.read_volume(3)
        with self.assertRaises(ValueError):
            cw.read_volume(path, gaps="mind")
        with self.assertRaises(ValueError):
            cw.read_volume("a\0b")


class Facts(Case):
    def test_formats_and_features(self):
        formats = {f.name: f for f in cw.formats()}
        self.assertTrue(formats["nrrd"].reads_volume and ".nrrd" in formats["nrrd"].extensions)
        self.assertTrue(formats["ply"].writes_mesh)
        for feature in cw.features().values():
            self.assertEqual(feature.available, feature.reason == "")
        self.assertEqual(cw.__version__, cw._declarations.CW_VERSION)

    def test_fields(self):
        self.assertEqual(cw.make("gyroid", dims=(5, 6, 7), type="u8").shape, (7, 6, 5))
        with self.assertRaisesRegex(ValueError, "sphere"):
            cw.make("cube")


if __name__ == "__main__":
    main()
