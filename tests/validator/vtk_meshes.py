"""VTK's word on meshes: one line a file, "NAME POINTS TRIANGLES AREA VOLUME ARRAYS".

vtk_meshes.py FILE...            reads them; of a .pvd every file that it lists, with its time
vtk_meshes.py --write STL FOLDER  writes a mesh in the dialects that VTK has
Exit 77: no VTK."""
import os
import sys
import xml.etree.ElementTree

try:
    import vtk
except ImportError:
    print("skip: python3-vtk9 is not installed", file=sys.stderr)
    sys.exit(77)

READERS = {".ply": vtk.vtkPLYReader, ".obj": vtk.vtkOBJReader, ".stl": vtk.vtkSTLReader,
           ".vtp": vtk.vtkXMLPolyDataReader}


def read(path):
    reader = READERS[os.path.splitext(path)[1]]()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def describe(name, mesh):
    mass = vtk.vtkMassProperties()
    mass.SetInputData(mesh)
    mass.Update()
    data = mesh.GetPointData()
    arrays = ",".join(data.GetArrayName(i) or "-" for i in range(data.GetNumberOfArrays()))
    print(name, mesh.GetNumberOfPoints(), mesh.GetNumberOfPolys(),
          "%.6g" % mass.GetSurfaceArea(), "%.6g" % mass.GetVolume(), arrays or "-")


def describe_series(path):
    for entry in xml.etree.ElementTree.parse(path).iter("DataSet"):
        name = entry.get("file")
        describe("%s@%s" % (name, entry.get("timestep")),
                 read(os.path.join(os.path.dirname(path), name)))


def write_dialects(mesh, folder):
    strips = vtk.vtkStripper()
    strips.SetInputData(mesh)
    strips.Update()
    for kind, data in (("triangles", mesh), ("strips", strips.GetOutput())):
        for n in range(3 * 3 * 2 * 2 * 2):
            writer = vtk.vtkXMLPolyDataWriter()
            writer.SetInputData(data)
            writer.SetDataMode(n % 3)
            (writer.SetCompressorTypeToNone, writer.SetCompressorTypeToZLib,
             writer.SetCompressorTypeToLZ4)[n // 3 % 3]()
            writer.SetByteOrder(n // 9 % 2)
            (writer.SetHeaderTypeToUInt32, writer.SetHeaderTypeToUInt64)[n // 18 % 2]()
            writer.SetEncodeAppendedData(n // 36 % 2)
            writer.SetFileName("%s/%s%02d.vtp" % (folder, kind, n))
            writer.Write()
    for ghosts in range(2):
        pieces = vtk.vtkExtractPolyDataPiece()
        pieces.SetInputData(mesh)
        pieces.SetCreateGhostCells(ghosts)
        writer = vtk.vtkXMLPPolyDataWriter()
        writer.SetInputConnection(pieces.GetOutputPort())
        writer.SetNumberOfPieces(3)
        writer.SetEndPiece(2)
        writer.SetGhostLevel(ghosts)
        writer.SetFileName("%s/pieces%d.pvtp" % (folder, ghosts))
        writer.Write()
    blocks = vtk.vtkMultiBlockDataSet()
    blocks.SetBlock(1, mesh)
    writer = vtk.vtkXMLMultiBlockDataWriter()
    writer.SetInputData(blocks)
    writer.SetFileName(folder + "/blocks.vtm")
    writer.Write()
    for name, writer, binary in (("text.ply", vtk.vtkPLYWriter(), False),
                                 ("binary.ply", vtk.vtkPLYWriter(), True),
                                 ("text.stl", vtk.vtkSTLWriter(), False),
                                 ("binary.stl", vtk.vtkSTLWriter(), True)):
        writer.SetInputData(mesh)
        (writer.SetFileTypeToBinary if binary else writer.SetFileTypeToASCII)()
        writer.SetFileName(folder + "/" + name)
        writer.Write()


if sys.argv[1] == "--write":
    write_dialects(read(sys.argv[2]), sys.argv[3])
else:
    for path in sys.argv[1:]:
        if path.endswith(".pvd"):
            describe_series(path)
        else:
            describe(os.path.basename(path), read(path))
