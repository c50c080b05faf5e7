// Extracts an isosurface of a volume with vtkFlyingEdges3D, and times it.
#include "vtk_wrap.h"

#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSMPTools.h>
#include <vtkSmartPointer.h>

#include <chrono>

static int vtk_type(cw_type type)
{
    switch (type) {
    case CW_U8:
        return VTK_UNSIGNED_CHAR;
    case CW_I8:
        return VTK_SIGNED_CHAR;
    case CW_U16:
        return VTK_UNSIGNED_SHORT;
    case CW_I16:
        return VTK_SHORT;
    case CW_U32:
        return VTK_UNSIGNED_INT;
    case CW_I32:
        return VTK_INT;
    case CW_F32:
        return VTK_FLOAT;
    case CW_F64:
        return VTK_DOUBLE;
    default:
        return VTK_VOID;
    }
}

double bench_vtk(const cw_volume *v, double isovalue, int threads, size_t *triangles)
try {
    vtkSMPTools::Initialize(threads);
    auto voxels =
        vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(vtk_type(v->type)));
    voxels->SetVoidArray(const_cast<void *>(v->data),
                         static_cast<vtkIdType>(v->dim[0] * v->dim[1] * v->dim[2]), 1);
    vtkNew<vtkImageData> image;
    image->SetDimensions(static_cast<int>(v->dim[0]), static_cast<int>(v->dim[1]),
                         static_cast<int>(v->dim[2]));
    image->GetPointData()->SetScalars(voxels);
    vtkNew<vtkFlyingEdges3D> filter;
    filter->SetInputData(image);
    filter->SetValue(0, isovalue);
    filter->ComputeNormalsOn();
    filter->ComputeGradientsOff();
    filter->ComputeScalarsOff();
    const auto begin = std::chrono::steady_clock::now();
    filter->Update();
    const auto end = std::chrono::steady_clock::now();
    *triangles = static_cast<size_t>(filter->GetOutput()->GetNumberOfCells());
    return std::chrono::duration<double, std::milli>(end - begin).count();
} catch (...) {
    *triangles = 0;
    return -1;
}
