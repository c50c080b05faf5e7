"""Tests bytes and file objects in the place of paths."""

import gc
import gzip
import io
import os
import tempfile
import threading
import zipfile

import cubewright as cw
import numpy as np
from support import Case, main, make_ball


def make_volume():
    return cw.Volume(make_ball(), spacing=(0.5, 0.5, 1))


class Counted(io.BytesIO):
    """Gives and takes a few bytes at a time, and can fail after some calls."""

    def __init__(self, data=b"", piece=1000, fails_after=None):
        super().__init__(data)
        self.piece, self.fails_after, self.calls = piece, fails_after, 0

    def count(self):
        self.calls += 1
        if self.fails_after is not None and self.calls > self.fails_after:
            raise OSError("the line is down")

    def read(self, size=-1):
        self.count()
        return super().read(min(size, self.piece))

    def write(self, data):
        self.count()
        return super().write(data[: self.piece])


class Streams(Case):
    def make_file(self, name):
        path = self.folder / name
        cw.write(path, make_volume())
        return path.read_bytes()

    def test_volumes_of_bytes(self):
        array = make_volume().array
        for name in ("ball.nrrd", "ball.nii", "ball.nii.gz", "ball.mha"):
            data = self.make_file(name)
            for source in (data, bytearray(data), memoryview(data), memoryview(data + data)[: len(data)]):
                with self.subTest(name, kind=type(source).__name__):
                    self.assertTrue(np.array_equal(cw.read_volume(source).array, array))
        twice = np.repeat(np.frombuffer(data, np.uint8), 2)
        self.assertTrue(np.array_equal(cw.read_volume(memoryview(twice)[::2]).array, array))

    def test_volumes_of_file_objects(self):
        array = make_volume().array
        data = self.make_file("ball.nrrd")
        (self.folder / "ball.nrrd.gz").write_bytes(gzip.compress(data))
        with zipfile.ZipFile(self.folder / "a.zip", "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("scans/ball.nrrd", data)
        reader, writer = os.pipe()
        feeder = threading.Thread(target=self.feed, args=(writer, data))
        feeder.start()
        with zipfile.ZipFile(self.folder / "a.zip") as archive, archive.open("scans/ball.nrrd") as member, open(
            self.folder / "ball.nrrd", "rb"
        ) as plain, open(self.folder / "ball.nrrd", "rb", buffering=0) as raw, gzip.open(
            self.folder / "ball.nrrd.gz"
        ) as packed, open(reader, "rb") as pipe:
            for source in (io.BytesIO(data), Counted(data, 7000), plain, raw, packed, member, pipe):
                with self.subTest(type(source).__name__):
                    self.assertTrue(np.array_equal(cw.read_volume(source).array, array))
        feeder.join()

    @staticmethod
    def feed(descriptor, data):
        with open(descriptor, "wb") as pipe:
            pipe.write(data)

    def test_a_file_object_is_read_from_where_it_stands(self):
        data = self.make_file("ball.nrrd")
        file = io.BytesIO(b"head" + data)
        file.seek(4)
        self.assertEqual(cw.read_volume(file).array.shape, make_volume().array.shape)
        with self.fails(cw.Status.IO, "(stream): the file is empty"):
            cw.read_volume(file)

    def test_names(self):
        array = np.arange(8 * 9 * 10, dtype=np.int16).reshape(8, 9, 10)
        with self.fails(cw.Status.FORMAT, "(memory): neither content nor extension"):
            cw.read_volume(b"nothing that is known")
        with self.fails(cw.Status.FORMAT, "scan.xyz: neither content nor extension"):
            cw.read_volume(io.BytesIO(b"nothing that is known"), name="scan.xyz")
        raw = cw.read_volume(array.tobytes(), raw="dims=10x9x8,type=i16le", name="scan.raw")
        self.assertTrue(np.array_equal(raw.array, array))
        path = self.folder / "mesh.obj"
        cw.write(path, cw.extract(make_ball(), 0))
        with open(path, "rb") as file:  # the content does not tell
            self.assertGreater(len(cw.read_mesh(file).triangles), 100)
        with self.fails(cw.Status.FORMAT):
            cw.read_mesh(path.read_bytes())
        self.assertGreater(len(cw.read_mesh(path.read_bytes(), name="a.obj").triangles), 100)
        with self.assertRaisesRegex(ValueError, "name is for bytes"):
            cw.read_mesh(path, name="a.obj")

    def test_meshes_are_the_bytes_of_files(self):
        mesh = cw.extract(make_ball(), 0)
        for suffix in ("stl", "ply", "glb", "gltf", "3mf", "vtp"):
            path = self.folder / f"mesh.{suffix}"
            with self.subTest(suffix):
                try:
                    cw.write(path, mesh)
                except cw.Error as error:
                    self.assertEqual(error.status, cw.Status.UNSUPPORTED)
                    continue
                plain, slow = io.BytesIO(), Counted(piece=30000)
                self.assertEqual(cw.write(plain, mesh, format=suffix).dropped, 0)
                cw.write(slow, mesh, format=suffix)
                with open(self.folder / f"again.{suffix}", "wb") as file:
                    cw.write(file, mesh, name="mesh")  # the format of the file's name
                data = path.read_bytes()
                self.assertEqual(plain.getvalue(), data)
                self.assertEqual(slow.getvalue(), data)
                self.assertEqual((self.folder / f"again.{suffix}").read_bytes(), data)
                self.assertEqual(len(cw.read_mesh(data).triangles), len(mesh.triangles))
        volume = io.BytesIO()
        cw.write(volume, make_volume(), format="nrrd")
        self.assertTrue(np.array_equal(cw.read_volume(volume.getvalue()).array, make_volume().array))

    def test_parts(self):
        mesh = cw.extract(make_ball(), 0)
        file = io.BytesIO()
        cw.write(file, {"first": mesh, "second": mesh}, format="3mf")
        parts = cw.read_parts(io.BytesIO(file.getvalue()))
        self.assertEqual([part.name for part in parts], ["first", "second"])
        red = cw.Part("red", mesh, cw.Label(1, 0, "red", (255, 0, 0, 255)))
        file = io.BytesIO()
        with self.fails(cw.Status.UNSUPPORTED, "OBJ keeps materials"):
            cw.write(file, [red], format="obj")
        self.assertEqual(file.getvalue(), b"")

    def test_what_is_refused(self):
        mesh = cw.extract(make_ball(), 0)
        with self.fails(cw.Status.ARGUMENT, "its extension is of no mesh format"):
            cw.write(io.BytesIO(), mesh)
        with self.assertRaisesRegex(ValueError, "no_clobber is for paths"):
            cw.write(io.BytesIO(), mesh, format="stl", no_clobber=True)
        with self.assertRaisesRegex(TypeError, "must return bytes, not"):
            cw.read_mesh(io.StringIO("solid"))
        with self.assertRaises(TypeError):
            cw.write(io.StringIO(), mesh, format="stl")
        for wrong in (None, 5, object()):
            with self.assertRaises(TypeError):
                cw.read_volume(wrong)
        nrrd = b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\ndata file: a.raw\n\n"
        with self.fails(cw.Status.UNSUPPORTED, "(memory): a.raw: this file is missing"):
            cw.read_volume(nrrd)

    def test_exceptions_come_out_as_they_are(self):
        data = self.make_file("ball.nrrd")
        mesh = cw.extract(make_ball(), 0)
        with self.assertRaisesRegex(OSError, "the line is down"):
            cw.read_volume(Counted(data, fails_after=2))
        with self.assertRaisesRegex(OSError, "the line is down"):
            cw.write(Counted(fails_after=1), mesh, format="stl")

        class Greedy(io.BytesIO):
            def read(self, size=-1):
                return b"x" * (size + 1)

        with self.assertRaisesRegex(ValueError, "returned"):
            cw.read_volume(Greedy())

        class Stopped(io.BytesIO):
            def read(self, size=-1):
                raise KeyboardInterrupt

        with self.assertRaises(KeyboardInterrupt):
            cw.read_volume(Stopped())

    def test_nothing_is_left(self):
        data = self.make_file("ball.nrrd")
        before, used = set(os.listdir(tempfile.gettempdir())), len(os.listdir("/proc/self/fd"))
        cw.read_volume(io.BytesIO(data))
        cw.read_volume(data)
        with self.assertRaises(OSError):
            cw.read_volume(Counted(data, fails_after=2))
        gc.collect()
        self.assertEqual(len(os.listdir("/proc/self/fd")), used)
        made = set(os.listdir(tempfile.gettempdir())) - before
        self.assertFalse([name for name in made if "cubewright-" in name and "test" not in name])


if __name__ == "__main__":
    main()
