/* Measures the values of a volume inside of meshes for the command info, and tells them. */
#include "cli/info/info_within.h"

#include "cli/framework/quantity.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <stdlib.h>

cw_status cli_find_within(const char *path, const cli_input *input, const cli_volume *volume,
                          cli_within *w, cw_error *err)
{
    cli_input mesh = *input;
    mesh.claim = (cli_claim){0}; /* that of the volume */
    cw_status st = cli_read_solids(&path, 1, NULL, &mesh, &w->solids, err);
    if (st != CW_OK)
        return st;
    w->values = calloc(w->solids.count, sizeof *w->values);
    if (!w->values)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < w->solids.count && st == CW_OK; n++) {
        st = cw_volume_within(&volume->view, w->solids.meshes[n], (int)input->threads,
                              &w->values[n], err);
        w->solids.parts[n] = w->values[n].mesh;
    }
    return st == CW_OK ? st : cli_fail_solids(&w->solids, st, err);
}

void cli_free_within(cli_within *w)
{
    cli_free_solids(&w->solids);
    free(w->values);
    *w = (cli_within){0};
}

void cli_print_within(const cli_within *w)
{
    for (size_t n = 0; n < w->solids.count; n++) {
        const cw_within *v = &w->values[n];
        printf("  within   %s: ", w->solids.solid[n].name);
        if (v->volume_mm3 > 0)
            printf("%.6g mm3 in %s voxels, mean %.6g, SD %.6g, %.10g to %.10g", v->volume_mm3,
                   cli_count(v->voxels), v->mean, v->sd, v->min, v->max);
        else
            printf("no voxel with a value");
        if (v->mesh.outside_mm2 > 0)
            printf("; %.3g %% of the surface is outside of the volume",
                   100 * v->mesh.outside_mm2 / v->mesh.area_mm2);
        puts("");
    }
}

void cli_json_within(cli_json *j, const cli_within *w)
{
    if (!w->solids.count)
        return;
    cli_json_open(j, "within", '[');
    for (size_t n = 0; n < w->solids.count; n++) {
        const cw_within *v = &w->values[n];
        cli_json_open(j, NULL, '{');
        cli_json_text(j, "path", cli_shown_path(w->solids.solid[n].path));
        cli_json_text(j, "name", w->solids.solid[n].name);
        cli_json_count(j, "label", w->solids.labels[n]);
        cli_json_number(j, "volume_mm3", v->volume_mm3);
        cli_json_number(j, "mesh_mm3", v->mesh.volume_mm3);
        cli_json_count(j, "voxels", v->voxels);
        cli_json_count(j, "half_inside", v->halves);
        if (v->voxels) {
            cli_json_number(j, "mean", v->mean);
            cli_json_number(j, "sd", v->sd);
            cli_json_number(j, "min", v->min);
            cli_json_number(j, "max", v->max);
        }
        cli_json_number(j, "area_mm2", v->mesh.area_mm2);
        cli_json_number(j, "outside_mm2", v->mesh.outside_mm2);
        cli_json_close(j, '}');
    }
    cli_json_close(j, ']');
}
