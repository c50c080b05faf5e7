// Simplifies a mesh with vtkQuadricDecimation.
#include "simplify_peers.h"

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkQuadricDecimation.h>

#include <algorithm>

const bool bench_has_vtk = true;

static void to_vtk(const cw_mesh &in, vtkPolyData *data)
{
    vtkNew<vtkFloatArray> coordinates;
    coordinates->SetNumberOfComponents(3);
    coordinates->SetNumberOfTuples(vtkIdType(in.vertex_count));
    std::copy_n(in.positions, 3 * in.vertex_count, coordinates->GetPointer(0));
    vtkNew<vtkPoints> points;
    points->SetData(coordinates);
    vtkNew<vtkIdTypeArray> corners;
    corners->SetNumberOfValues(vtkIdType(3 * in.triangle_count));
    std::copy_n(in.triangles, 3 * in.triangle_count, corners->GetPointer(0));
    vtkNew<vtkCellArray> cells;
    cells->SetData(3, corners);
    data->SetPoints(points);
    data->SetPolys(cells);
}

static bool from_vtk(vtkPolyData *data, cw_mesh *out)
{
    const vtkIdType vertices = data->GetNumberOfPoints(), triangles = data->GetNumberOfPolys();
    if (!bench_mesh_alloc(out, size_t(vertices), size_t(triangles)))
        return false;
    for (vtkIdType v = 0; v < vertices; v++) {
        double point[3];
        data->GetPoint(v, point);
        std::transform(point, point + 3, out->positions + 3 * v,
                       [](double x) { return float(x); });
    }
    for (vtkIdType t = 0; t < triangles; t++) {
        vtkIdType count;
        const vtkIdType *corners;
        data->GetPolys()->GetCellAtId(t, count, corners);
        if (count != 3)
            return false;
        std::transform(corners, corners + 3, out->triangles + 3 * t,
                       [](vtkIdType v) { return uint32_t(v); });
    }
    return true;
}

bool bench_vtk(const cw_mesh *in, size_t triangles, cw_mesh *out, double *build_s)
try {
    const double begin = bench_now_s();
    vtkNew<vtkPolyData> data;
    to_vtk(*in, data);
    *build_s = bench_now_s() - begin;
    vtkNew<vtkQuadricDecimation> filter;
    filter->SetInputData(data);
    filter->SetTargetReduction(1 - double(triangles) / double(in->triangle_count));
    filter->Update();
    return from_vtk(filter->GetOutput(), out);
} catch (...) {
    return false;
}
