"""Shows the surface of a volume in ParaView: the script of a Programmable Source.

Sources > Programmable Source; Output Data Set Type: vtkPolyData; paste this file into Script. Start
ParaView with PYTHONPATH set to the folder of the package cubewright. Coordinates are LPS mm.
"""

import cubewright
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray

VOLUME, ISO = "head.nrrd", 300.0

mesh = cubewright.extract(cubewright.read_volume(VOLUME), ISO)
points, cells = vtkPoints(), vtkCellArray()
points.SetData(numpy_to_vtk(mesh.world_vertices(), deep=True))
cells.SetData(3, numpy_to_vtkIdTypeArray(mesh.triangles.astype(np.int64).ravel(), deep=True))
surface = self.GetPolyDataOutput()  # noqa: F821 (self is the source)
surface.SetPoints(points)
surface.SetPolys(cells)
normals = numpy_to_vtk(mesh.normals, deep=True)
normals.SetName("Normals")
surface.GetPointData().SetNormals(normals)
