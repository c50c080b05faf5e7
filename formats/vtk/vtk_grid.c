/* Places rectilinear grids of VTK by their coordinates, and converts counts of points to those
 * of cells. */
#include "formats/vtk/vtk_grid.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <math.h>
#include <stdio.h>

cw_status cwi_vtk_grid_row(cwi_source *row, const char *size_field, cw_type type, size_t count,
                           cw_error *err)
{
    const cwi_axis axis = {CWI_AXIS_X, count};
    *row = (cwi_source){
        .size_field = size_field, .noun = "coordinates", .shape = {.slope = 1, .type = type}};
    return cwi_source_set_axes(row, &axis, 1, err);
}

/* Makes the coordinates of an axis rise. Grids may be written from their far end; then the axis
 * points the other way. */
static cw_status raise_axis(double *at, size_t count, int axis, cw_volume *shape, cw_error *err)
{
    const double sign = count > 1 && at[1] < at[0] ? -1 : 1;
    for (size_t i = 0; i < count; i++) {
        at[i] *= sign;
        if (!isfinite(at[i]) || (i && !(at[i] > at[i - 1])))
            return cwi_fail(
                err, CW_ERR_FORMAT,
                "Coordinates along %c: number %zu, %g, follows %g; all must rise, or "
                "all fall",
                "xyz"[axis], i, sign * at[i], i ? sign * at[i - 1] : 0);
    }
    shape->affine[axis][axis] = sign;
    return CW_OK;
}

static void to_middles(double *at, size_t count)
{
    for (size_t i = 0; i + 1 < count; i++)
        at[i] = 0.5 * at[i] + 0.5 * at[i + 1];
}

cw_status cwi_vtk_grid_give(const cw_volume numbers[3], bool of_cells, cw_volume *shape,
                            cw_error *err)
{
    double *to =
        cwi_alloc_array(numbers[0].dim[0] + numbers[1].dim[0] + numbers[2].dim[0], sizeof *to);
    if (!to)
        return cwi_fail_memory(err);
    cw_status st = CW_OK;
    shape->owned_grid = to;
    for (int a = 0; a < 3 && st == CW_OK; to += numbers[a++].dim[0]) {
        const size_t count = numbers[a].dim[0];
        for (size_t i = 0; i < count; i++)
            to[i] = cwi_voxel_at(numbers[a].type, cwi_voxel_address(&numbers[a], i, 0, 0));
        st = raise_axis(to, count, a, shape, err);
        if (st == CW_OK && of_cells)
            to_middles(to, count);
        shape->coordinates[a] = to;
    }
    return st;
}

cw_status cwi_vtk_grid_load(const cwi_source rows[3], const cwi_input *in, cw_volume numbers[3],
                            cw_error *err)
{
    cw_status st = CW_OK;
    for (int a = 0; a < 3 && st == CW_OK; a++)
        st = cwi_source_load(&rows[a], in, &(cw_read_desc){0}, &numbers[a], err);
    return st;
}

cw_status cwi_vtk_grid_place(const cwi_source rows[3], const cwi_input *in, bool of_cells,
                             cw_volume *shape, cw_error *err)
{
    cw_volume numbers[3] = {0};
    cw_status st = cwi_vtk_grid_load(rows, in, numbers, err);
    if (st == CW_OK)
        st = cwi_vtk_grid_give(numbers, of_cells, shape, err);
    for (int a = 0; a < 3; a++)
        cw_volume_free(&numbers[a]);
    return st;
}

cw_status cwi_vtk_grid_to_cells(cwi_source *src, const char *array, size_t dim[3],
                                cw_error *err)
{
    for (int a = 0; a < 3; a++)
        if (--dim[a] == 0)
            return cwi_fail(
                err, CW_ERR_FORMAT,
                "'%s' has one plane of points along %c: no cells, which have the values",
                src->size_field, "xyz"[a]);
    snprintf(src->note, sizeof src->note,
             "'%s' has a value for each cell: they are taken as samples in the cells' middles",
             array);
    return CW_OK;
}
