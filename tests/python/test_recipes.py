"""Tests the recipes for Blender and ParaView in these programs, without a window.

Programs are looked for in PATH, or named by BLENDER and PVPYTHON.
"""

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


if __name__ == "__main__":
    main()
