/* Repairs normals of a brick's vertices from triangles, some of which lie in other bricks. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "core/volume/volume.h"
#include "extract/bricks/brick_grid.h"
#include "extract/dense/crossed_edges.h"

#include <string.h>

static bool is_missing(const float normal[3])
{
    return normal[0] == 0 && normal[1] == 0 && normal[2] == 0;
}

static bool any_missing(const cw_mesh *mesh)
{
    for (size_t v = 0; v < mesh->vertex_count; v++)
        if (is_missing(mesh->normals + 3 * v))
            return true;
    return false;
}

/* Extracts the brick with a ring of cells around it, and gives each vertex the normal of its
 * triangles. */
static cw_status make_surroundings(cwi_brick_grid *b, const cwi_brick_job *job, cw_error *err)
{
    cw_mesh *around = &b->around;
    cw_status st = cwi_brick_count(b, CWI_CELLS_AROUND, err);
    if (st == CW_OK)
        st = cwi_mesh_renew(around, b->plan.counts.vertices, b->plan.counts.triangles, true,
                            err);
    if (st != CW_OK)
        return st;
    cwi_brick_write(b, job, false, around);
    memset(around->normals, 0, 3 * around->vertex_count * sizeof *around->normals);
    return cwi_repair_normals(around, cwi_voxel_scale(&job->volume), err);
}

/* Takes the missing normals on a row's edges along an axis from the surroundings, where the same
 * edges have other numbers. */
static void take_row(const cwi_brick_grid *b, size_t row, int axis, cw_mesh *mesh)
{
    const cwi_bit_grid *g = &b->plan.grid;
    const size_t plane = ((size_t)axis + 1) * g->rows + row;
    const uint64_t crossed = cwi_grid_crossed(g, axis, row % g->rows_y, row / g->rows_y, 0);
    const uint64_t around = crossed & b->window[CWI_CELLS_AROUND][plane];
    size_t to = b->own_rows[row].first[axis];
    for (uint64_t left = crossed & b->window[CWI_OWN_CELLS][plane]; left; left &= left - 1) {
        const uint64_t before = around & ((left & -left) - 1);
        const size_t from =
            b->plan.rows[row].first[axis] + (size_t)__builtin_popcountll(before);
        float *normal = mesh->normals + 3 * to++;
        if (is_missing(normal))
            memcpy(normal, b->around.normals + 3 * from, 3 * sizeof *normal);
    }
}

cw_status cwi_brick_repair_normals(cwi_brick_grid *b, const cwi_brick_job *job, cw_mesh *mesh,
                                   cw_error *err)
{
    const cwi_bit_grid *g = &b->plan.grid;
    if (!any_missing(mesh))
        return CW_OK;
    memcpy(b->own_rows, b->plan.rows, g->rows * sizeof *b->own_rows);
    cw_status st = make_surroundings(b, job, err);
    if (st != CW_OK)
        return st;
    for (size_t row = 0; row < g->rows; row++)
        for (int axis = 0; axis < 3; axis++)
            take_row(b, row, axis, mesh);
    /* what is left: vertices inside cells, whose triangles are all in the brick */
    return cwi_repair_normals(mesh, cwi_voxel_scale(&job->volume), err);
}
