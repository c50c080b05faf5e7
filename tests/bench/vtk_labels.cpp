// Extracts all labels of a volume with VTK's discrete filters, and times it.
#include "vtk_labels.h"

#include <vtkDiscreteFlyingEdges3D.h>
#include <vtkDiscreteMarchingCubes.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSMPTools.h>
#include <vtkSmartPointer.h>

#include <chrono>

template <class Filter> static double run(vtkImageData *image, size_t labels, size_t *triangles)
{
    vtkNew<Filter> filter;
    filter->SetInputData(image);
    filter->GenerateValues(static_cast<int>(labels), 1, static_cast<double>(labels));
    filter->ComputeNormalsOff();
    filter->ComputeGradientsOff();
    const auto begin = std::chrono::steady_clock::now();
    filter->Update();
    const auto end = std::chrono::steady_clock::now();
    *triangles = static_cast<size_t>(filter->GetOutput()->GetNumberOfCells());
    return std::chrono::duration<double, std::milli>(end - begin).count();
}

double bench_vtk_labels(const cw_volume *v, size_t labels, bool marching_cubes, int threads,
                        size_t *triangles)
try {
    vtkSMPTools::Initialize(threads);
    const int type = v->type == CW_U8 ? VTK_UNSIGNED_CHAR : VTK_UNSIGNED_SHORT;
    auto voxels = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(type));
    voxels->SetVoidArray(const_cast<void *>(v->data),
                         static_cast<vtkIdType>(v->dim[0] * v->dim[1] * v->dim[2]), 1);
    vtkNew<vtkImageData> image;
    image->SetDimensions(static_cast<int>(v->dim[0]), static_cast<int>(v->dim[1]),
                         static_cast<int>(v->dim[2]));
    image->GetPointData()->SetScalars(voxels);
    return marching_cubes ? run<vtkDiscreteMarchingCubes>(image, labels, triangles)
                          : run<vtkDiscreteFlyingEdges3D>(image, labels, triangles);
} catch (...) {
    *triangles = 0;
    return -1;
}
