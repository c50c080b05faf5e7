/* Normals of vertices from the triangles around them. */
#include <cubewright/mesh.h>

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_triangle.h"

/* The weight at a corner is the sine of its angle by the lengths of the edges beside it [Max1999]: the normals
 * of vertices on a sphere are then exact. */
void cwi_add_corner_normals(const cw_mesh *mesh, size_t t, const uint32_t at[3],
                            double (*sums)[3])
{
    double edges[3][3], lengths_sq[3], normal[3];
    for (size_t c = 0; c < 3; c++) {
        cwi_sub_points(cwi_mesh_point(mesh, t, (c + 1) % 3), cwi_mesh_point(mesh, t, c),
                       edges[c]);
        lengths_sq[c] = cwi_dot(edges[c], edges[c]);
    }
    cwi_cross(edges[0], edges[1], normal);
    for (int c = 0; c < 3; c++) {
        const double weight = lengths_sq[c] * lengths_sq[(c + 2) % 3];
        for (int a = 0; a < 3 && weight > 0; a++)
            sums[at[c]][a] += normal[a] / weight;
    }
}

cw_status cw_mesh_normals(cw_mesh *mesh, cw_error *err)
{
    CWI_REQUIRE(err, mesh);
    cw_status st = cw_mesh_check(mesh, err);
    if (st != CW_OK)
        return st;
    double(*sums)[3] = cwi_alloc_zeroed(mesh->vertex_count, sizeof *sums);
    float *normals = mesh->normals ? mesh->normals
                                   : cwi_alloc_array(mesh->vertex_count, 3 * sizeof *normals);
    if (!sums || !normals) {
        cwi_free(sums);
        if (!mesh->normals)
            cwi_free(normals);
        return cwi_fail_memory(err);
    }
    for (size_t t = 0; t < mesh->triangle_count; t++)
        cwi_add_corner_normals(mesh, t, mesh->triangles + 3 * t, sums);
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const bool has_normal = cwi_normalise(sums[v]);
        for (size_t a = 0; a < 3; a++)
            normals[3 * v + a] = has_normal ? (float)sums[v][a] : a == 2 ? 1.0f : 0.0f;
    }
    mesh->normals = normals;
    cwi_free(sums);
    return CW_OK;
}
