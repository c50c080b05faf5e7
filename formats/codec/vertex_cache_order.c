/* Reorders triangles and vertices of a mesh for the vertex cache, by meshoptimizer. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/codec/meshopt_wrap.h"

#include <cubewright/formats.h>

#include <string.h>

static void permute_array(void *array, void *copy, const uint32_t *remap, size_t count,
                          size_t size)
{
    if (!array)
        return;
    memcpy(copy, array, count * size);
    for (size_t v = 0; v < count; v++)
        memcpy((char *)array + remap[v] * size, (char *)copy + v * size, size);
}

cw_status cwi_mesh_reorder(cw_mesh *mesh, const cwi_meshopt_functions *meshopt, bool draw,
                           cw_error *err)
{
    const size_t count = mesh->vertex_count;
    uint32_t *remap = cwi_alloc_array(count, sizeof *remap);
    void *copy = cwi_alloc_array(count, 3 * sizeof *mesh->positions);
    cw_status st = remap && copy ? CW_OK
                                 : cwi_fail(err, CW_ERR_NO_MEMORY,
                                            "no memory to order %zu vertices", count);
    if (st == CW_OK)
        st = meshopt->reorder(mesh->triangles, mesh->triangle_count, count, draw, remap, err);
    if (st == CW_OK) {
        permute_array(mesh->positions, copy, remap, count, 3 * sizeof *mesh->positions);
        permute_array(mesh->normals, copy, remap, count, 3 * sizeof *mesh->normals);
        permute_array(mesh->colors, copy, remap, count, 4 * sizeof *mesh->colors);
        permute_array(mesh->scalars, copy, remap, count, sizeof *mesh->scalars);
        permute_array(mesh->labels, copy, remap, count, sizeof *mesh->labels);
    }
    cwi_free(remap);
    cwi_free(copy);
    return st;
}

cw_status cw_mesh_optimize(cw_mesh *mesh, cw_error *err)
{
    CWI_REQUIRE(err, mesh);
    const cwi_meshopt_functions *meshopt;
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK)
        st = cwi_meshopt_functions_load(&meshopt, err);
    return st == CW_OK ? cwi_mesh_reorder(mesh, meshopt, true, err) : st;
}
