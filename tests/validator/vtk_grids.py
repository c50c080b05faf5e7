"""Writes irregular grids in every dialect of VTK's writers, and prints what VTK makes of each:
vtk_grids.py FOLDER, or vtk_grids.py --read FILE... Lines are those of grid.c: the last component
of each array of points, and of cells averaged around their points; samples are those that differ
in place or value."""

import sys

import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

CORNERS = {10: 4, 11: 8, 12: 8, 13: 6, 14: 5, 24: 4, 25: 8, 26: 6, 27: 5}


def last_component(array):
    values = vtk_to_numpy(array)
    return values[:, -1] if values.ndim > 1 else values


def cells_of(grid):
    """Numbers of cells that have volume and are not blanked, and their corners."""
    ghosts = grid.GetCellGhostArray()
    for n in range(grid.GetNumberOfCells()):
        if isinstance(grid, vtk.vtkStructuredGrid) and not grid.IsCellVisible(n):
            continue
        if ghosts and ghosts.GetValue(n) & (1 | 8 | 32):
            continue
        kind = grid.GetCellType(n)
        if kind in CORNERS:
            ids = vtk.vtkIdList()
            grid.GetCellPoints(n, ids)
            yield n, [ids.GetId(i) for i in range(CORNERS[kind])]


def describe(name, grid):
    at = vtk_to_numpy(grid.GetPoints().GetData()).astype(float) + 0.0
    cells = list(cells_of(grid))
    corners = numpy.concatenate([c for _, c in cells])
    places = (at[corners] @ [1, 2, 3]).sum()
    for data, of_cells in ((grid.GetPointData(), False), (grid.GetCellData(), True)):
        for i in range(data.GetNumberOfArrays()):
            array = data.GetArray(i)
            if not array or array.GetName() == "vtkGhostType":
                continue
            values = last_component(array)
            rows = at
            if of_cells:
                _, same = numpy.unique(at, axis=0, return_inverse=True)
                same = same.ravel()
                sums, around = numpy.zeros(same.max() + 1), numpy.zeros(same.max() + 1)
                for n, c in cells:
                    for p in set(same[c]):
                        sums[p] += float(values[n])
                        around[p] += 1
                with numpy.errstate(invalid="ignore"):
                    values = (sums / around)[same]
            else:
                whole = vtk_to_numpy(array).reshape(len(at), -1)
                rows = numpy.column_stack([at, whole.astype(float)])
            _, first = numpy.unique(rows, axis=0, return_index=True)
            values = values.astype(float)
            print("%s:%s %d %d %.17g %.17g %.17g" % (
                name, array.GetName(), len(first), len(cells), values[first].sum(),
                values[corners].sum(), places))


def add_arrays(grid):
    def add(data, name, values):
        array = numpy_to_vtk(values, deep=True)
        array.SetName(name)
        data.AddArray(array)
    at = vtk_to_numpy(grid.GetPoints().GetData()).astype(float)
    n = grid.GetNumberOfCells()
    add(grid.GetPointData(), "f", numpy.sin(3 * at).sum(axis=1).astype(numpy.float32))
    add(grid.GetPointData(), "double", (at ** 2).sum(axis=1))
    add(grid.GetPointData(), "flow", numpy.cos(at).astype(numpy.float32))
    add(grid.GetPointData(), "short", (100 * at[:, 0]).astype(numpy.int16))
    add(grid.GetCellData(), "cell", (numpy.arange(n) % 7).astype(numpy.uint8))


def mixed():
    """A block of voxels, hexahedra, wedges, pyramids and tetrahedra; a quadratic cell beside it,
    and some that are flat. A few points are there twice."""
    grid, points = vtk.vtkUnstructuredGrid(), vtk.vtkPoints()
    points.SetDataTypeToDouble()
    size = 4

    def at(i, j, k):
        return i + (size + 1) * (j + (size + 1) * k)

    for k in range(size + 1):
        for j in range(size + 1):
            for i in range(size + 1):
                points.InsertNextPoint(i + 0.1 * j, j + 0.05 * k * k, k / 3)
    tips = {}
    for k in range(size):
        for j in range(size):
            for i in range(size):
                c = [at(i + a, j + b, k + d) for d in (0, 1) for b in (0, 1) for a in (0, 1)]
                h = [c[n] for n in (0, 1, 3, 2, 4, 5, 7, 6)]
                kind = (i + j + k) % 4
                if kind == 0:
                    grid.InsertNextCell(11, 8, c)
                elif kind == 1:
                    grid.InsertNextCell(12, 8, h)
                elif kind == 2:
                    grid.InsertNextCell(13, 6, [h[0], h[1], h[3], h[4], h[5], h[7]])
                    grid.InsertNextCell(13, 6, [h[1], h[2], h[3], h[5], h[6], h[7]])
                else:
                    middle = numpy.mean([points.GetPoint(n) for n in h], axis=0)
                    tip = points.InsertNextPoint(middle)
                    for f in ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3)):
                        grid.InsertNextCell(14, 5, [h[n] for n in f] + [tip])
                    grid.InsertNextCell(10, 4, [h[3], h[7], h[4], tip])
                    twice = points.InsertNextPoint(points.GetPoint(h[3]))
                    grid.InsertNextCell(10, 4, [twice, h[4], h[0], tip])
    corners = numpy.array([[9, 0, 0], [10, 0, 0], [9, 1, 0], [9, 0, 1]], float)
    pairs = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
    ids = [points.InsertNextPoint(p) for p in corners]
    ids += [points.InsertNextPoint((corners[a] + corners[b]) / 2) for a, b in pairs]
    grid.InsertNextCell(24, 10, ids)
    grid.InsertNextCell(5, 3, ids[:3])
    grid.InsertNextCell(3, 2, ids[:2])
    grid.InsertNextCell(1, 1, ids[:1])
    grid.SetPoints(points)
    add_arrays(grid)
    return grid


def bent(blank):
    """A quarter of a pipe, whole or with some cells blanked."""
    grid, points = vtk.vtkStructuredGrid(), vtk.vtkPoints()
    grid.SetDimensions(5, 7, 4)
    for k in range(4):
        for j in range(7):
            for i in range(5):
                r, a = 1 + 0.25 * i, j / 6 * numpy.pi / 2
                points.InsertNextPoint(r * numpy.cos(a), r * numpy.sin(a), 0.5 * k * k)
    grid.SetPoints(points)
    add_arrays(grid)
    if blank:
        for n in (3, 4, 20):
            grid.BlankCell(n)
        grid.BlankPoint(0)
    return grid


def write(writer, path, grid):
    writer.SetInputData(grid)
    writer.SetFileName(path)
    if not writer.Write():
        sys.exit("%s was not written" % path)


def xml(kind, folder, name, extension, grid):
    makers = {"ascii": lambda w: w.SetDataModeToAscii(),
              "binary": lambda w: w.SetDataModeToBinary(),
              "text": lambda w: (w.SetDataModeToAppended(), w.EncodeAppendedDataOn()),
              "raw": lambda w: (w.SetDataModeToAppended(), w.EncodeAppendedDataOff())}
    count = 0
    for mode, make in makers.items():
        for compressor in ("None", "ZLib", "LZ4"):
            writer = kind()
            make(writer)
            getattr(writer, "SetCompressorTypeTo" + compressor)()
            (writer.SetHeaderTypeToUInt32, writer.SetHeaderTypeToUInt64)[count % 2]()
            (writer.SetByteOrderToLittleEndian, writer.SetByteOrderToBigEndian)[count // 2 % 2]()
            (writer.SetIdTypeToInt64, writer.SetIdTypeToInt32)[count // 4 % 2]()
            writer.SetBlockSize(4096)
            file = "%s_%s_%s.%s" % (name, mode, compressor, extension)
            write(writer, folder + "/" + file, grid)
            read(folder + "/" + file)
            count += 1


def legacy(kind, folder, name, grid):
    for version in (42, 51):
        for binary in (False, True):
            writer = kind()
            writer.SetFileVersion(version)
            (writer.SetFileTypeToASCII, writer.SetFileTypeToBinary)[binary]()
            file = "%s_%d_%s.vtk" % (name, version, ("ascii", "binary")[binary])
            write(writer, folder + "/" + file, grid)
            read(folder + "/" + file)


def read(path):
    readers = {"vtu": vtk.vtkXMLUnstructuredGridReader, "vts": vtk.vtkXMLStructuredGridReader,
               "vtk": vtk.vtkDataSetReader}
    reader = readers[path.rsplit(".", 1)[1]]()
    reader.SetFileName(path)
    if isinstance(reader, vtk.vtkDataSetReader):
        reader.ReadAllScalarsOn(), reader.ReadAllVectorsOn(), reader.ReadAllFieldsOn()
    reader.Update()
    describe(path.rsplit("/", 1)[-1], reader.GetOutput())


if sys.argv[1] == "--read":
    for file in sys.argv[2:]:
        read(file)
else:
    to = sys.argv[1]
    xml(vtk.vtkXMLUnstructuredGridWriter, to, "mixed", "vtu", mixed())
    xml(vtk.vtkXMLStructuredGridWriter, to, "bent", "vts", bent(False))
    xml(vtk.vtkXMLStructuredGridWriter, to, "blank", "vts", bent(True))
    legacy(vtk.vtkUnstructuredGridWriter, to, "mixed", mixed())
    legacy(vtk.vtkStructuredGridWriter, to, "bent", bent(False))
    legacy(vtk.vtkStructuredGridWriter, to, "blank", bent(True))
