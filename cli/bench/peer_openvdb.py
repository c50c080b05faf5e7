# OpenVDB: volumeToMesh of a dense grid, without normals. Its threads are TBB's, as many as there
# are processors. Beyond the grid's end there is a background, towards which it closes the surface:
# that part is not ours to compare, and is taken off afterwards.
use_few_processors()
import pyopenvdb


def prepare_volume(kind, nx, ny, nz, dx, dy, dz, level, outside):
    voxels = volume_of(kind, nx, ny, nz).transpose()
    grid = pyopenvdb.FloatGrid(float(outside))
    grid.copyFromArray(numpy.ascontiguousarray(voxels, "f4"))
    last = numpy.array(voxels.shape) - 1.0
    spacing = numpy.array([float(dx), float(dy), float(dz)])
    return lambda: (grid.convertToQuads(float(level)), last, spacing)


def arrays(result):
    (points, quads), last, spacing = result
    within = ((points >= 0) & (points <= last)).all(axis=1)
    quads = quads[within[quads].all(axis=1)]
    triangles = numpy.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    used, corners = numpy.unique(triangles, return_inverse=True)
    return points[used] * spacing, None, corners.reshape(-1, 3)


serve(".".join(map(str, pyopenvdb.LIBRARY_VERSION)), {"extract": prepare_volume}, arrays)
