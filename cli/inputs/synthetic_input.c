/* Samples an analytic field as a command's input volume, and finds the field with the
 * nearest name. */
#include "cli/inputs/synthetic_input.h"

#include "cli/framework/console.h"

cw_status cli_make_field(cw_field field, const size_t dim[3], const cli_input *input,
                         cli_volume *v, cw_error *err)
{
    const cw_field_desc desc = {
        .field = field,
        .dim = {dim[0], dim[1], dim[2]},
        .type = CW_F32,
        .threads = (int)input->threads,
        .progress =
            cli_progress(1e-6 * (double)dim[0] * (double)dim[1] * (double)dim[2], "Mvoxel")};
    cw_status st = cw_field_sample(&desc, &v->voxels, err);
    if (st != CW_OK)
        return st;
    v->format = "nrrd";
    v->whole = v->view = v->voxels;
    v->whole.owned = v->view.owned = NULL;
    v->memory_left = cli_memory_limit(input);
    v->coarsen[0] = v->coarsen[1] = v->coarsen[2] = 1;
    cw_volume_spacing(&v->view, v->spacing);
    return CW_OK;
}

const char *cli_nearest_field(const char *word)
{
    const char *names[CW_FIELD_COUNT + 1] = {0};
    for (int f = 0; f < CW_FIELD_COUNT; f++)
        names[f] = cw_field_name((cw_field)f);
    return cli_nearest(word, names);
}
