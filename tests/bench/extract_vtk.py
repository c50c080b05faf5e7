"""Extracts a surface with normals from headerless voxels by VTK's flying edges.

python3 extract_vtk.py FILE EDGE ISOVALUE THREADS [OUTPUT.ply]
"""
import sys

import numpy
from vtkmodules.vtkCommonCore import vtkSMPTools
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D
from vtkmodules.vtkIOPLY import vtkPLYWriter
from vtkmodules.util.numpy_support import numpy_to_vtk

path, edge, isovalue, threads = sys.argv[1], int(sys.argv[2]), float(sys.argv[3]), int(sys.argv[4])
vtkSMPTools.Initialize(threads)
image = vtkImageData()
image.SetDimensions(edge, edge, edge)
image.GetPointData().SetScalars(numpy_to_vtk(numpy.fromfile(path, "<u2")))
surface = vtkFlyingEdges3D()
surface.SetInputData(image)
surface.SetValue(0, isovalue)
surface.ComputeNormalsOn()
surface.ComputeGradientsOff()
surface.ComputeScalarsOff()
surface.Update()
if len(sys.argv) > 5:
    writer = vtkPLYWriter()
    writer.SetInputData(surface.GetOutput())
    writer.SetFileName(sys.argv[5])
    writer.SetFileTypeToBinary()
    writer.Write()
