/* Samples an analytic field as a command's input volume, lists all that 'make' makes, and
 * finds the field with the nearest name. */
#include "cli/inputs/synthetic_input.h"

#include "cli/framework/console.h"

#include <cubewright/hard.h>

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

static const cli_made_field label_maps[] = {
    {"labels/cells", "label map: cells that touch each other, in a ball", 0, false, true,
     CW_LABEL_CELLS},
    {"labels/spheres", "label map: spheres, some of which touch", 0, false, true,
     CW_LABEL_SPHERES},
};
enum { LABEL_MAPS = sizeof label_maps / sizeof *label_maps };

bool cli_made_field_at(size_t n, cli_made_field *s)
{
    if (n < CW_FIELD_COUNT) {
        const cw_field f = (cw_field)n;
        *s = (cli_made_field){cw_field_name(f), cw_field_about(f), cw_field_isovalue(f),
                              .number = n};
        return true;
    }
    n -= CW_FIELD_COUNT;
    if (n < LABEL_MAPS) {
        *s = label_maps[n];
        return true;
    }
    n -= LABEL_MAPS;
    const cw_hard *hard = cw_hard_at(n);
    if (hard)
        *s = (cli_made_field){hard->name, hard->about, hard->isovalue, .hard = true,
                              .number = n};
    return hard != NULL;
}

const char *cli_nearest_field(const char *word)
{
    const char *names[CW_FIELD_COUNT + 1] = {0};
    for (int f = 0; f < CW_FIELD_COUNT; f++)
        names[f] = cw_field_name((cw_field)f);
    return cli_nearest(word, names);
}
