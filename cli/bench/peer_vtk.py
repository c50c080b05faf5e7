# VTK: vtkFlyingEdges3D, vtkQuadricDecimation.
from vtkmodules.vtkCommonCore import vtkPoints, vtkSMPTools, vtkVersion
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D, vtkQuadricDecimation
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy

vtkSMPTools.Initialize(threads)


def prepare_volume(kind, nx, ny, nz, dx, dy, dz, level, outside):
    voxels = volume_of(kind, nx, ny, nz)
    image = vtkImageData()
    image.SetDimensions(int(nx), int(ny), int(nz))
    image.SetSpacing(float(dx), float(dy), float(dz))
    image.GetPointData().SetScalars(numpy_to_vtk(voxels.ravel()))

    def work():
        filter = vtkFlyingEdges3D()
        filter.SetInputData(image)
        filter.SetValue(0, float(level))
        filter.ComputeNormalsOn()
        filter.ComputeGradientsOff()
        filter.ComputeScalarsOff()
        filter.Update()
        return filter.GetOutput()

    return work


def prepare_mesh(vertices, triangles, target):
    corners = mesh_of(vertices, triangles)
    places, cells, mesh = vtkPoints(), vtkCellArray(), vtkPolyData()
    places.SetData(numpy_to_vtk(corners[0], deep=True))
    cells.SetData(3, numpy_to_vtkIdTypeArray(corners[1].astype("i8").ravel(), deep=True))
    mesh.SetPoints(places)
    mesh.SetPolys(cells)

    def work():
        filter = vtkQuadricDecimation()
        filter.SetInputData(mesh)
        filter.SetTargetReduction(1 - int(target) / int(triangles))
        filter.Update()
        return filter.GetOutput()

    return work


def arrays(mesh):
    normals = mesh.GetPointData().GetNormals()
    return (
        vtk_to_numpy(mesh.GetPoints().GetData()),
        vtk_to_numpy(normals) if normals else None,
        vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3),
    )


serve(
    vtkVersion.GetVTKVersion(), {"extract": prepare_volume, "simplify": prepare_mesh}, arrays
)
