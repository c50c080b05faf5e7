"""Makes a mesh file from a volume file by VTK: reader, flying edges, decimation, writer.

python3 whole_vtk.py THREADS                                only starts Python and VTK
python3 whole_vtk.py THREADS VOLUME ISOVALUE OUTPUT [quadric|pro FRACTION]

VOLUME is NIfTI or MetaImage; OUTPUT is .stl, or .ply. FRACTION is of the triangles to
keep.
"""
import sys

from vtkmodules.vtkCommonCore import vtkSMPTools
from vtkmodules.vtkFiltersCore import (
    vtkCleanPolyData,
    vtkDecimatePro,
    vtkFlyingEdges3D,
    vtkQuadricDecimation,
)
from vtkmodules.vtkIOGeometry import vtkSTLWriter
from vtkmodules.vtkIOImage import vtkMetaImageReader, vtkNIFTIImageReader
from vtkmodules.vtkIOPLY import vtkPLYWriter


def extract(path, isovalue, with_normals):
    """Returns the filter that makes the surface."""
    is_meta = path.endswith((".mha", ".mhd"))
    reader = vtkMetaImageReader() if is_meta else vtkNIFTIImageReader()
    reader.SetFileName(path)
    surface = vtkFlyingEdges3D()
    surface.SetInputConnection(reader.GetOutputPort())
    surface.SetValue(0, isovalue)
    surface.SetComputeNormals(with_normals)
    surface.ComputeGradientsOff()
    surface.ComputeScalarsOff()
    return surface


def decimate(surface, method, fraction):
    """Returns the filter that keeps a fraction of the triangles.

    Triangles without area are left out first: quadric decimation may stop early at them.
    """
    clean = vtkCleanPolyData()
    clean.SetTolerance(0)
    clean.ConvertPolysToLinesOff()
    clean.ConvertLinesToPointsOff()
    clean.SetInputConnection(surface.GetOutputPort())
    decimation = vtkDecimatePro() if method == "pro" else vtkQuadricDecimation()
    if method == "pro":
        decimation.PreserveTopologyOn()
    decimation.SetInputConnection(clean.GetOutputPort())
    decimation.SetTargetReduction(1 - fraction)
    return decimation


def write(surface, path):
    """Writes a binary file."""
    writer = vtkPLYWriter() if path.endswith(".ply") else vtkSTLWriter()
    writer.SetFileTypeToBinary()
    writer.SetInputConnection(surface.GetOutputPort())
    writer.SetFileName(path)
    if not writer.Write():
        sys.exit(f"{path}: not written")


vtkSMPTools.Initialize(int(sys.argv[1]))
if len(sys.argv) > 2:
    volume, level, output = sys.argv[2], float(sys.argv[3]), sys.argv[4]
    result = extract(volume, level, output.endswith(".ply"))
    if len(sys.argv) > 5:
        result = decimate(result, sys.argv[5], float(sys.argv[6]))
    write(result, output)
