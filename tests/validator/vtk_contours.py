"""Contours of irregular grids by VTK: vtk_contours.py FOLDER [FILE.vtu ARRAY ISOVALUE]...
Writes grids with smooth fields, and prints of each, and of the files: name, array, isovalue,
triangles, area, box."""

import math
import os
import sys

import vtk


def field(x, y, z):
    return math.sin(3 * x) * math.cos(2 * y) + z * z + 0.5 * x * y


def bent():
    """A curvilinear grid: a quarter of a ring, twisted."""
    grid, points, values = vtk.vtkStructuredGrid(), vtk.vtkPoints(), vtk.vtkDoubleArray()
    grid.SetDimensions(25, 19, 15)
    values.SetName("f")
    for k in range(15):
        for j in range(19):
            for i in range(25):
                angle, radius = math.pi / 2 * i / 24 + 0.02 * k, 1 + j / 18
                p = (radius * math.cos(angle), radius * math.sin(angle), k / 14 + 0.1 * angle)
                points.InsertNextPoint(p)
                values.InsertNextValue(field(*p))
    grid.SetPoints(points)
    grid.GetPointData().SetScalars(values)
    return grid


def unstructured(grid, tetrahedra):
    to = vtk.vtkDataSetTriangleFilter() if tetrahedra else vtk.vtkAppendFilter()
    to.AddInputData(grid)
    to.Update()
    return to.GetOutput()


def write(folder, name, writer, grid):
    writer.SetInputData(grid)
    writer.SetFileName(os.path.join(folder, name))
    writer.Write()
    return name


def describe(name, grid, array, isovalue):
    contour, flat, mass = vtk.vtkContourFilter(), vtk.vtkTriangleFilter(), vtk.vtkMassProperties()
    contour.SetInputData(grid)
    contour.SetInputArrayToProcess(0, 0, 0, 0, array)
    contour.SetValue(0, isovalue)
    flat.SetInputConnection(contour.GetOutputPort())
    mass.SetInputConnection(flat.GetOutputPort())
    mass.Update()
    box = flat.GetOutput().GetBounds()
    sides = [box[2 * a + 1] - box[2 * a] for a in range(3)]
    print(name, array, isovalue, flat.GetOutput().GetNumberOfPolys(),
          "%.9g" % mass.GetSurfaceArea(), *("%.9g" % s for s in sides))


folder = sys.argv[1]
ring = bent()
for name, writer, grid in (
    ("bent.vts", vtk.vtkXMLStructuredGridWriter(), ring),
    ("hexahedra.vtu", vtk.vtkXMLUnstructuredGridWriter(), unstructured(ring, False)),
    ("tetrahedra.vtu", vtk.vtkXMLUnstructuredGridWriter(), unstructured(ring, True)),
):
    write(folder, name, writer, grid)
    for isovalue in (0.2, 0.6, 1.1):
        describe(name, grid, "f", isovalue)
for n in range(2, len(sys.argv), 3):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(sys.argv[n])
    reader.Update()
    describe(os.path.basename(sys.argv[n]), reader.GetOutput(), sys.argv[n + 1], float(sys.argv[n + 2]))
