"""Times extraction by VTK, scikit-image and OpenVDB for Python beside ours, in turn, with the error of each.

PYTHONPATH=python CUBEWRIGHT_LIBRARY=build/release/lib/libcubewright.so python3 peers.py [--field sphere|gyroid] [--size N] [--runs N] [--threads N]

Prints a row for each program: the median time of the call alone, that time divided by ours, triangles, triangles
without area, and mean and maximum distance of the vertices from the surface that is known on paper. VTK,
scikit-image and ours compute normals; OpenVDB computes none. scikit-image uses one thread.
"""
import argparse
import statistics
import time

import numpy

import cubewright


def field_at(name, size, x, y, z):
    """Returns the field and its gradient's length at places in voxels; the surface is at 0."""
    if name == "sphere":
        middle = (size - 1) / 2
        distance = numpy.sqrt((x - middle) ** 2 + (y - middle) ** 2 + (z - middle) ** 2)
        return 0.3 * size - distance, numpy.ones_like(distance)
    scale = 6 * numpy.pi / size  # three periods
    x, y, z = scale * x, scale * y, scale * z
    sx, sy, sz, cx, cy, cz = *map(numpy.sin, (x, y, z)), *map(numpy.cos, (x, y, z))
    slopes = cx * cy - sz * sx, cy * cz - sx * sy, cz * cx - sy * sz
    return sx * cy + sy * cz + sz * cx, scale * numpy.sqrt(sum(s * s for s in slopes))


def ours(voxels, threads, **options):
    volume = cubewright.Volume(voxels)

    def arrays(mesh):
        return mesh.world_vertices(), mesh.triangles

    return lambda: cubewright.extract(volume, 0, open=True, threads=threads, **options), arrays


def vtk(voxels, threads):
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkSMPTools
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D

    vtkSMPTools.Initialize(threads)
    image = vtkImageData()
    image.SetDimensions(voxels.shape[::-1])
    image.GetPointData().SetScalars(numpy_to_vtk(voxels.ravel()))

    def run():
        surface = vtkFlyingEdges3D()
        surface.SetInputData(image)
        surface.SetValue(0, 0)
        surface.ComputeNormalsOn()
        surface.ComputeGradientsOff()
        surface.ComputeScalarsOff()
        surface.Update()
        return surface.GetOutput()

    def arrays(mesh):
        triangles = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray())
        return vtk_to_numpy(mesh.GetPoints().GetData()), triangles.reshape(-1, 3)

    return run, arrays


def scikit_image(voxels, threads):
    from skimage.measure import marching_cubes

    return lambda: marching_cubes(voxels, 0), lambda mesh: (mesh[0][:, ::-1], mesh[1])


def openvdb(voxels, threads):
    import pyopenvdb

    grid = pyopenvdb.FloatGrid(float(voxels.min()))
    grid.copyFromArray(numpy.ascontiguousarray(voxels.T))
    last = numpy.array(voxels.shape[::-1]) - 1

    def arrays(mesh):
        """Leaves out the caps: beyond the grid's end is the background."""
        points, quads = mesh
        quads = quads[((points >= 0) & (points <= last)).all(axis=1)[quads].all(axis=1)]
        used, corners = numpy.unique(
            numpy.concatenate([quads[:, :3], quads[:, [0, 2, 3]]]), return_inverse=True
        )
        return points[used], corners.reshape(-1, 3)

    return lambda: grid.convertToQuads(0.0), arrays


def count_flat(points, triangles):
    """Counts the triangles without area."""
    a, b, c = (points[triangles[:, k]].astype("f8") for k in range(3))
    return int((numpy.cross(b - a, c - a) == 0).all(axis=1).sum())


def print_row(name, seconds, reference, points, triangles, options):
    values, slopes = field_at(options.field, options.size, *points.astype("f8").T)
    off = numpy.abs(values) / slopes
    print(
        f"{name:24} {1000 * seconds:9.1f} ms  {seconds / reference:6.2f} x  {len(triangles):9} triangles"
        f"  {count_flat(points, triangles):6} flat  off by {off.mean():.2g}, {off.max():.2g} voxels"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--field", choices=("sphere", "gyroid"), default="gyroid")
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--threads", type=int, default=1)
    options = parser.parse_args()
    axis = numpy.arange(options.size, dtype="f8")
    z, y, x = numpy.meshgrid(axis, axis, axis, indexing="ij")
    voxels = field_at(options.field, options.size, x, y, z)[0].astype("f4")
    work = {}
    for name, make, settings in (
        ("cubewright", ours, {}),
        ("cubewright, cubic", ours, {"placement": "cubic"}),
        ("cubewright, no normals", ours, {"normals": "none"}),
        ("VTK", vtk, {}),
        ("scikit-image", scikit_image, {}),
        ("OpenVDB", openvdb, {}),
    ):
        try:
            work[name] = make(voxels, options.threads, **settings)
        except ImportError as missing:
            print(f"{name:24} missing: {missing.name}")
    times = {name: [] for name in work}
    results = {}
    for n in range(options.runs + 1):
        for name, (run, arrays) in work.items():
            start = time.perf_counter()
            mesh = run()
            if n > 0:  # a first run is not counted
                times[name].append(time.perf_counter() - start)
                results[name] = arrays(mesh)
    for name, seconds in times.items():
        reference = times["cubewright, no normals" if name == "OpenVDB" else "cubewright"]
        print_row(name, statistics.median(seconds), statistics.median(reference), *results[name], options)


main()
