/* Meshes measured against what they were made of, with progress. */
#include "cli/results/mesh_comparison.h"

#include "cli/framework/console.h"
#include "core/base/status.h"
#include "core/geometry/box.h"

#include <math.h>

cw_status cli_compare(const cw_mesh *mesh, const cw_mesh *input, double tolerance_mm,
                      int threads, cli_comparison *sum, cw_error *err)
{
    const cw_mesh_distance_desc desc = {
        .tolerance_mm = tolerance_mm,
        .threads = threads,
        .progress = cli_progress((double)input->triangle_count / 1e6, "Mtriangle")};
    cw_status st = cw_mesh_compare(mesh, input, &desc, &sum->with_input, err);
    sum->made = st == CW_OK;
    return st;
}

cw_status cli_compare_with_field(const cw_mesh *mesh, const cli_volume *volume, double iso,
                                 bool inside_is_low, int threads, cli_comparison *c,
                                 cw_error *err)
{
    const cw_field_distance_desc desc = {
        .isovalue = iso,
        .inside_is_low = inside_is_low,
        .threads = threads,
        .progress = cli_progress((double)mesh->triangle_count / 1e6, "Mtriangle")};
    cw_distance d;
    cw_status st = cw_distance_to_field(mesh, &volume->view, &desc, &d, NULL, err);
    if (st == CW_OK && (!c->has_field || d.max_mm > c->to_field.max_mm))
        c->to_field = d;
    c->has_field = st == CW_OK;
    return st;
}

cw_status cli_check_overlap(const cli_volume *volume, const cw_mesh *mesh, cw_error *err)
{
    double corners[8][3], low[3], high[3], from[3], to[3];
    cw_volume_corners(&volume->view, corners);
    cw_mesh_bounds(mesh, low, high);
    cwi_box_clear(from, to);
    for (int n = 0; n < 8; n++)
        cwi_box_add(from, to, corners[n]);
    for (int a = 0; a < 3; a++)
        if (low[a] > to[a] || high[a] < from[a])
            return cwi_fail(
                err, CW_ERR_ARGUMENT,
                "%s: the mesh is not in this volume: along %c it is at %g to %g mm, "
                "the volume at %g to %g",
                volume->path, "xyz"[a], low[a], high[a], from[a], to[a]);
    return CW_OK;
}
