// Extracts an isosurface or labels of a volume with VTK, and times it.
#include "vtk_wrap.h"

#include <vtkDiscreteFlyingEdges3D.h>
#include <vtkDiscreteMarchingCubes.h>
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

// Makes an image that borrows the voxels.
static vtkSmartPointer<vtkImageData> wrap_volume(const cw_volume *v)
{
    auto voxels =
        vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(vtk_type(v->type)));
    voxels->SetVoidArray(const_cast<void *>(v->data),
                         static_cast<vtkIdType>(v->dim[0] * v->dim[1] * v->dim[2]), 1);
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->SetDimensions(static_cast<int>(v->dim[0]), static_cast<int>(v->dim[1]),
                         static_cast<int>(v->dim[2]));
    image->GetPointData()->SetScalars(voxels);
    return image;
}

// Runs a filter, and returns the milliseconds it took.
template <class Filter> static double time_filter(Filter *filter, size_t *triangles)
{
    const auto begin = std::chrono::steady_clock::now();
    filter->Update();
    const auto end = std::chrono::steady_clock::now();
    *triangles = static_cast<size_t>(filter->GetOutput()->GetNumberOfCells());
    return std::chrono::duration<double, std::milli>(end - begin).count();
}

template <class Filter>
static double time_labels(vtkImageData *image, size_t labels, size_t *triangles)
{
    vtkNew<Filter> filter;
    filter->SetInputData(image);
    filter->GenerateValues(static_cast<int>(labels), 1, static_cast<double>(labels));
    filter->ComputeNormalsOff();
    filter->ComputeGradientsOff();
    return time_filter(filter.Get(), triangles);
}

double bench_vtk(const cw_volume *v, double isovalue, int threads, size_t *triangles)
try {
    vtkSMPTools::Initialize(threads);
    auto image = wrap_volume(v);
    vtkNew<vtkFlyingEdges3D> filter;
    filter->SetInputData(image);
    filter->SetValue(0, isovalue);
    filter->ComputeNormalsOn();
    filter->ComputeGradientsOff();
    filter->ComputeScalarsOff();
    return time_filter(filter.Get(), triangles);
} catch (...) {
    *triangles = 0;
    return -1;
}

double bench_vtk_labels(const cw_volume *v, size_t labels, bool marching_cubes, int threads,
                        size_t *triangles)
try {
    vtkSMPTools::Initialize(threads);
    auto image = wrap_volume(v);
    return marching_cubes ? time_labels<vtkDiscreteMarchingCubes>(image, labels, triangles)
                          : time_labels<vtkDiscreteFlyingEdges3D>(image, labels, triangles);
} catch (...) {
    *triangles = 0;
    return -1;
}
