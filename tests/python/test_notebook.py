"""Tests what notebooks and processes do with meshes and volumes: show them, copy them, send them on."""

import ast
import copy
import json
import multiprocessing
import os
import pickle
import re
import signal
import xml.etree.ElementTree as ElementTree

import cubewright as cw
import numpy as np
from support import LIMIT_S, ROOT, Case, main, make_ball


def make_full_mesh():
    """Returns a mesh with all that a mesh may have, far from its origin."""
    volume = cw.Volume(make_ball(), spacing=(1, 2, 3), origin=(1e5, 0, -7))
    mesh = cw.extract(volume, 0, color_by=volume)
    mesh.face_colors = np.arange(4 * len(mesh)).reshape(-1, 4) % 256
    mesh.attributes.add("place", mesh.vertices[:, 0], interpolation="nearest")
    return mesh


def count_triangles(volume):
    return len(cw.extract(volume, 0, threads=2))


class Copies(Case):
    def same_in_all(self, a, b):
        self.same_mesh(a, b)
        for name in ("normals", "scalars", "colors", "face_colors", "origin", "affine"):
            self.assertTrue(np.array_equal(getattr(a, name), getattr(b, name)), name)
        self.assertEqual(a.facts, b.facts)
        self.assertEqual([repr(each) for each in a.attributes.pack()], [repr(each) for each in b.attributes.pack()])

    def test_meshes(self):
        mesh = make_full_mesh()
        for again in (pickle.loads(pickle.dumps(mesh)), copy.deepcopy(mesh)):
            self.same_in_all(mesh, again)
            again.vertices[0] = 7
            self.assertFalse(np.array_equal(mesh.vertices, again.vertices))
        self.same_in_all(mesh, mesh)
        empty = pickle.loads(pickle.dumps(cw.extract(make_ball(), 100)))
        self.assertEqual((len(empty), empty.vertices.shape), (0, (0, 3)))
        self.assertTrue(empty)

    def test_volumes(self):
        array = np.arange(120, dtype="i2").reshape(2, 3, 4, 5)
        planes = ([0, 1, 3, 4, 5], [0, 1, 2, 3], [0, 2, 3])
        given = (
            cw.Volume(array, steps=True, affine=np.diag([1, 2, 3, 1.0]), slope=2, intercept=-1, nodata=5),
            cw.Volume(array[0][:, ::-1, ::2], level_set=True),
            cw.Volume(array[0], coordinates=planes),
            cw.make("gyroid", dims=16),
        )
        for volume in given:
            for again in (pickle.loads(pickle.dumps(volume)), copy.deepcopy(volume)):
                self.assertTrue(np.array_equal(volume.array, again.array))
                for name in ("affine", "slope", "intercept", "nodata", "level_set", "kind", "steps", "spacing"):
                    self.assertTrue(np.array_equal(getattr(volume, name), getattr(again, name)), name)
                self.assertEqual(volume.world((1, 2, 1)), again.world((1, 2, 1)))

    def test_processes_that_are_forked_or_spawned(self):
        volume = cw.make("gyroid", dims=48)
        count = count_triangles(volume)  # the parent has threads now
        for method in ("fork", "spawn"):
            with multiprocessing.get_context(method).Pool(2) as pool:
                self.assertEqual(pool.map_async(count_triangles, [volume] * 4).get(LIMIT_S), [count] * 4)

    def test_a_process_forked_from_a_forked_one(self):
        volume = cw.make("gyroid", dims=48)
        count = count_triangles(volume)
        child = os.fork()
        if child == 0:
            signal.alarm(LIMIT_S)  # in place of hanging for ever
            same = count_triangles(volume) == count
            grandchild = os.fork()
            if grandchild == 0:
                signal.alarm(LIMIT_S)
                os._exit(0 if count_triangles(volume) == count else 1)
            os._exit(0 if same and os.waitpid(grandchild, 0)[1] == 0 else 1)
        self.assertEqual(os.waitpid(child, 0)[1], 0)


class Shown(Case):
    def test_numbers_of_a_mesh(self):
        ball = cw.extract(make_ball(), 0)
        found = cw.check(ball).quality
        self.assertEqual((ball.area, ball.volume), (found["area_mm2"], found["volume_mm3"]))
        self.assertEqual(len(ball), len(ball.triangles))
        self.assertIsNone(cw.Mesh.from_arrays(ball.vertices, ball.triangles[1:]).volume)

    def read_table(self, text):
        """Returns the rows of a table, of markup that has to be well-formed but for the image."""
        root = ElementTree.fromstring(re.sub("(<img[^>]*)>", r"\1/>", text))
        return {row[0].text: row[1].text for row in root.iter("tr")}

    def test_meshes(self):
        ball = cw.extract(make_ball(), 0)
        self.assertTrue(ball._repr_png_().startswith(b"\x89PNG"))
        facts = self.read_table(ball._repr_html_())
        self.assertEqual(facts["triangles"], f"{len(ball):,}")
        self.assertEqual(facts["area"], f"{ball.area:.6g} mm\u00b2")
        empty = cw.extract(make_ball(), 100)
        self.assertIsNone(empty._repr_png_())
        self.assertNotIn("<img", empty._repr_html_())

    def test_volumes(self):
        volume = cw.Volume(make_ball(), spacing=(1, 2, 3))
        self.assertTrue(volume._repr_png_().startswith(b"\x89PNG"))
        facts = self.read_table(volume._repr_html_())
        self.assertEqual((facts["voxels (x, y, z)"], facts["spacing"]), ("29 x 26 x 24", "1 x 2 x 3 mm"))
        self.assertEqual(len(volume), 24)
        for odd in (np.full((3, 4, 5), np.nan, "f4"), np.zeros((1, 1, 1), "u1")):
            cw.Volume(odd)._repr_html_()
        many = cw.Volume(np.zeros((2, 3, 4, 5, 3), "u1"), steps=True, components=True)
        self.assertEqual(self.read_table(many._repr_html_())["components"], "3")


class Notebook(Case):
    def test_the_cells_run_and_end_with_something_to_show(self):
        text = (ROOT / "python" / "recipes" / "first_steps.ipynb").read_text()
        cells = ["".join(cell["source"]) for cell in json.loads(text)["cells"] if cell["cell_type"] == "code"]
        names, pictures = {}, []
        for cell in cells:
            tree = ast.parse(cell)
            last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
            exec(compile(tree, "cell", "exec"), names)
            value = eval(compile(ast.Expression(last.value), "cell", "eval"), names) if last else None
            if hasattr(value, "_repr_html_"):
                pictures.append(value._repr_html_())
        self.assertEqual(len(pictures), 3)
        self.assertTrue(all('src="data:image/png;base64,' in each for each in pictures))


if __name__ == "__main__":
    main()
