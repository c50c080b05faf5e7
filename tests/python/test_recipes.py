"""Tests the recipes: those for Blender and ParaView in these programs, without a window, and those for
packages that read scans against our own readers.

Programs are looked for in PATH, or named by BLENDER and PVPYTHON.
"""

import importlib.util
import os
import shutil
import subprocess

import cubewright as cw
import numpy as np
from support import LIMIT_S, ROOT, Case, main, make_ball

RECIPES = ROOT / "python" / "recipes"

BLENDER_CHECK = """
import bpy, numpy as np
surface = bpy.data.objects["surface"]
points = np.empty(3 * len(surface.data.vertices), "f4")
surface.data.vertices.foreach_get("co", points)
low, high = points.reshape(-1, 3).min(axis=0), points.reshape(-1, 3).max(axis=0)
print("bounds", *(1000 * (low + surface.location)), *(1000 * (high + surface.location)))
print("custom normals", surface.data.has_custom_normals)
print("valid", not surface.data.validate(verbose=True))
"""

PARAVIEW_CHECK = """
import sys
from paraview import servermanager, simple
shown = simple.ProgrammableSource(OutputDataSetType="vtkPolyData", Script=open(sys.argv[1]).read())
shown.UpdatePipeline()
data = servermanager.Fetch(shown)
print("cells", data.GetNumberOfPolys(), "points", data.GetNumberOfPoints())
print("bounds", *data.GetBounds())
edges = simple.FeatureEdges(Input=shown, FeatureEdges=0)
print("edges", servermanager.Fetch(edges).GetNumberOfCells())
print("normals", data.GetPointData().GetNormals().GetNumberOfTuples())
"""


def find_program(variable, name):
    return os.environ.get(variable) or shutil.which(name)


class Recipes(Case):
    def setUp(self):
        super().setUp()
        volume = cw.Volume(make_ball(), spacing=(1, 1, 2), origin=(100, 200, 300))
        cw.write(self.folder / "ball.nrrd", volume)
        self.mesh = cw.extract(volume, 0)

    def run_program(self, *command):
        ran = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, timeout=LIMIT_S)
        self.assertEqual(ran.returncode, 0, ran.stdout + ran.stderr)
        lines = [line.split() for line in ran.stdout.splitlines() if line]
        return {words[0]: words[1:] for words in lines}, ran.stdout

    def test_blender_shows_the_surface(self):
        blender = find_program("BLENDER", "blender")
        if not blender:
            self.skipTest("no Blender")
        start = (blender, "--background", "--factory-startup", "--python-use-system-env", "--python-exit-code", "1")
        recipe = RECIPES / "blender_surface.py"
        _, printed = self.run_program(*start, "--python", recipe, "--", "ball.nrrd", "0", "ball.blend")
        counts = f"{len(self.mesh.vertices)} vertices, {len(self.mesh.triangles)} triangles"
        self.assertIn(counts, printed)
        check = self.folder / "check.py"
        check.write_text(BLENDER_CHECK)
        saved = self.folder / "ball.blend"
        found, _ = self.run_program(blender, "--background", saved, *start[2:], "--python", check)
        self.assertTrue(np.allclose([float(x) for x in found["bounds"]], self.mesh.bounds.ravel(), atol=1e-3))
        self.assertEqual((found["custom"], found["valid"]), (["normals", "True"], ["True"]))

    def test_paraview_shows_the_surface(self):
        pvpython = find_program("PVPYTHON", "pvpython")
        if not pvpython:
            self.skipTest("no ParaView")
        text = (RECIPES / "paraview_source.py").read_text()
        usual = 'VOLUME, ISO = "head.nrrd", 300.0'
        self.assertIn(usual, text)
        script, check = self.folder / "source.py", self.folder / "check.py"
        script.write_text(text.replace(usual, 'VOLUME, ISO = "ball.nrrd", 0.0'))
        check.write_text(PARAVIEW_CHECK)
        found, printed = self.run_program(pvpython, "--force-offscreen-rendering", check, script)
        counts = [str(len(self.mesh.triangles)), "points", str(len(self.mesh.vertices))]
        self.assertEqual(found["cells"], counts, printed)
        x0, x1, y0, y1, z0, z1 = (float(x) for x in found["bounds"])
        self.assertTrue(np.allclose([[x0, y0, z0], [x1, y1, z1]], self.mesh.bounds))
        self.assertEqual((found["edges"], found["normals"]), (["0"], [str(len(self.mesh.vertices))]))


def load_recipe(name):
    spec = importlib.util.spec_from_file_location(name, RECIPES / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class ScansOfOthers(Case):
    """Volumes of other packages lie where our readers place the same files."""

    def need_module(self, name):
        if importlib.util.find_spec(name) is None:
            self.skipTest(f"no {name}")
        return importlib.import_module(name)

    def same_volume(self, made, read):
        self.assertEqual(made.shape, read.shape)
        corner = [count - 1 for count in read.shape[::-1]]
        for index in ([0, 0, 0], corner, [corner[0], 0, 1]):
            self.assertTrue(np.allclose(made.world(index), read.world(index), atol=1e-4), index)
        values = [v.array * v.slope + v.intercept for v in (made, read)]
        self.assertTrue(np.allclose(*values, rtol=1e-6))
        iso = float(np.median(values[0])) + 0.25
        a, b = cw.extract(made, iso), cw.extract(read, iso)
        self.assertGreater(len(a), 0)
        self.assertTrue(np.array_equal(a.triangles, b.triangles))
        self.assertTrue(np.allclose(a.world_vertices(), b.world_vertices(), atol=1e-3))

    def test_nibabel(self):
        nibabel = self.need_module("nibabel")
        recipe = load_recipe("volume_of_nibabel")
        cos, sin = np.cos(0.3), np.sin(0.3)
        affine = np.array([[2 * cos, -sin, 0, -20], [2 * sin, cos, 0, 30], [0, 0, 3, 5], [0, 0, 0, 1.0]])
        voxels = make_ball(scale=10).T.astype("i2")
        for unit, slope, kind in (("mm", 0.5, nibabel.Nifti1Image), ("micron", 1, nibabel.Nifti1Image), ("mm", 2, nibabel.Nifti2Image)):
            image = kind(voxels, affine)
            image.header.set_xyzt_units(unit)
            image.header.set_slope_inter(slope, -3)
            path = self.folder / f"scan-{unit}-{slope}.nii.gz"
            nibabel.save(image, path)
            loaded = nibabel.load(path)
            made = recipe.volume_of(loaded)
            self.assertEqual(made.dtype, np.int16)
            self.same_volume(made, cw.read_volume(path))
        series = nibabel.Nifti1Image(np.stack([voxels, voxels[::-1]], axis=3), affine)
        nibabel.save(series, self.folder / "series.nii")
        second = recipe.volume_of(nibabel.load(self.folder / "series.nii"), step=1)
        self.assertTrue(np.array_equal(second.array, voxels[::-1].T))
        self.assertTrue(np.array_equal(recipe.volume_of(series, step=1).array, voxels[::-1].T))

    def test_pydicom(self):
        pydicom = self.need_module("pydicom")
        recipe = load_recipe("volume_of_pydicom")
        datasets = self.write_slices(pydicom)
        made = recipe.volume_of(datasets)
        self.assertEqual(made.dtype, np.int16)
        if cw.features()["dicom"].available:
            self.same_volume(made, cw.read_volume(self.folder))
        with self.assertRaisesRegex(ValueError, "missing"):
            recipe.volume_of(datasets[:2] + datasets[3:])
        datasets[4].RescaleSlope = 2  # as of PET
        varied = recipe.volume_of(datasets)
        self.assertEqual(varied.dtype, np.float32)

    def write_slices(self, pydicom):
        """Writes a CT of oblique slices, and returns its datasets in an order of no meaning."""
        ball = make_ball(size=12, dtype="i2", scale=10)
        row, column = np.array([0.6, 0.8, 0]), np.array([0, 0, -1.0])
        normal = np.cross(row, column)
        series, frame = pydicom.uid.generate_uid(), pydicom.uid.generate_uid()
        datasets = []
        for n, pixels in enumerate(ball):
            each = pydicom.dataset.FileDataset(None, {}, preamble=b"\0" * 128)
            each.file_meta = pydicom.dataset.FileMetaDataset()
            each.file_meta.MediaStorageSOPClassUID = each.SOPClassUID = "1.2.840.10008.5.1.4.1.1.2"
            each.file_meta.MediaStorageSOPInstanceUID = each.SOPInstanceUID = pydicom.uid.generate_uid()
            each.file_meta.TransferSyntaxUID = pydicom.uid.ExplicitVRLittleEndian
            each.is_little_endian, each.is_implicit_VR = True, False
            each.Modality, each.PatientID, each.InstanceNumber = "CT", "ball", n + 1
            each.SeriesInstanceUID = each.StudyInstanceUID = series
            each.FrameOfReferenceUID = frame
            each.ImagePositionPatient = [float(f"{x:.6f}") for x in np.array([10, -20, 30]) + 2.5 * n * normal]
            each.ImageOrientationPatient = [*row, *column]
            each.PixelSpacing = [0.5, 0.75]
            each.Rows, each.Columns = pixels.shape
            each.SamplesPerPixel, each.PhotometricInterpretation = 1, "MONOCHROME2"
            each.BitsAllocated = each.BitsStored = 16
            each.HighBit, each.PixelRepresentation = 15, 1
            each.RescaleSlope, each.RescaleIntercept = 1, -1024
            each.PixelData = pixels.tobytes()
            each.save_as(self.folder / f"{97 * n % 101:03d}.dcm")
            datasets.append(each)
        return [datasets[n] for n in np.random.default_rng(5).permutation(len(datasets))]


if __name__ == "__main__":
    main()
