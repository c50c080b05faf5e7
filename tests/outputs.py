"""Prints a hash of each mesh that the Python package makes of a volume and a label map: outputs.py VOLUME LABELS"""

import hashlib
import sys

import cubewright as cw


def hash_arrays(*arrays):
    total = hashlib.sha256()
    for array in arrays:
        if array is not None:
            total.update(array.tobytes())
    return total.hexdigest()[:16]


def show(name, mesh):
    arrays = (mesh.vertices, mesh.normals, mesh.triangles, mesh.scalars, mesh.colors, mesh.labels)
    print(name, len(mesh.triangles), hash_arrays(*arrays))


volume, labels = cw.read_volume(sys.argv[1]), cw.read_volume(sys.argv[2])
RUNS = {
    "plain": {},
    "open": {"open": True},
    "simple": {"topology": "simple"},
    "cubic": {"placement": "cubic"},
    "flat": {"normals": "none"},
    "snap": {"snap": 0.3},
    "volume": {"min_volume": 20.0},
    "largest": {"largest": 40},
    "voids": {"largest": 60, "fill_voids": True},
    "error": {"simplify": 0.3},
    "count": {"simplify": 800},
    "all": {"min_volume": 5.0, "largest": 30, "fill_voids": True, "simplify": 0.3},
}
extractor = cw.Extractor(volume)
for name, options in RUNS.items():
    show(name, cw.extract(volume, 300, **options))
    show(name + " again", extractor.extract(300, **options))
mesh = cw.extract(volume, 300)
show("smooth", cw.smooth(mesh, method="hc", iterations=5, max_move=0.5).mesh)
show("simplify", cw.simplify(mesh, ratio=0.3))
for n, level in enumerate(cw.simplify_levels(mesh, [2000, 500])):
    show(f"level {n}", level)
surfaces = cw.extract_labels(labels)
show("labels", surfaces.shared)
show("labels simplified", surfaces.simplify(error=0.3).shared)
for label, piece in surfaces.meshes().items():
    show(f"label {label}", piece)
