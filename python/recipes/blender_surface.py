"""Adds the surface of a volume to a Blender scene.

In Blender's text editor: set VOLUME and ISO, then run the script. Without a window:

    blender --background --python blender_surface.py -- head.nrrd 300 head.blend

Blender's Python needs NumPy, which it comes with, and the package cubewright: set PYTHONPATH to its
folder and start Blender with --python-use-system-env. It may be another version of Python than
the system's, since the package is not compiled.
"""

import os
import sys

import bpy
import cubewright
import numpy as np

VOLUME, ISO = "head.nrrd", 300.0
METRES = 0.001  # Blender's unit, in millimetres of the mesh


def add_surface(mesh, name="surface"):
    """Adds a cubewright.Mesh as an object; its origin becomes the object's location."""
    triangles = mesh.triangles.astype(np.int32)
    data = bpy.data.meshes.new(name)
    data.vertices.add(len(mesh.vertices))
    data.vertices.foreach_set("co", (mesh.vertices * np.float32(METRES)).ravel())
    data.loops.add(triangles.size)
    data.loops.foreach_set("vertex_index", triangles.ravel())
    data.polygons.add(len(triangles))
    data.polygons.foreach_set("loop_start", np.arange(0, triangles.size, 3, dtype=np.int32))
    if bpy.app.version < (4, 0, 0):  # later ones find it by themselves
        data.polygons.foreach_set("loop_total", np.full(len(triangles), 3, np.int32))
    data.polygons.foreach_set("use_smooth", np.ones(len(triangles), bool))
    data.update(calc_edges=True)
    if mesh.normals is not None:
        if bpy.app.version < (4, 1, 0):
            data.use_auto_smooth = True
        data.normals_split_custom_set_from_vertices(mesh.normals)
    surface = bpy.data.objects.new(name, data)
    surface.location = mesh.origin * METRES
    bpy.context.collection.objects.link(surface)
    return surface


def main():
    given = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    path, iso = (given[0], float(given[1])) if len(given) > 1 else (VOLUME, ISO)
    surface = add_surface(cubewright.extract(cubewright.read_volume(path), iso))
    print(f"{len(surface.data.vertices)} vertices, {len(surface.data.polygons)} triangles in {surface.name}")
    if len(given) > 2:
        bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(given[2]))


main()
