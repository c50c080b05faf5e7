#include "cli/surface.h"

#include "cli/console.h"
#include "core/status.h"

static cw_status explain_empty(const cli_volume *volume, const cw_extract_desc *desc,
                               cw_error *err)
{
    cw_statistics range;
    cw_status st = cw_volume_statistics(&volume->view, 0, desc->threads, &range, err);
    if (st != CW_OK)
        return st;
    if (!range.finite)
        return cw_fail(err, CW_ERR_EMPTY, "no voxel has a finite value");
    return cw_fail(
        err, CW_ERR_EMPTY,
        "isovalue %g crosses nothing: values%s are %g to %g, and it must be above the "
        "lowest and at most the highest",
        desc->isovalue, cli_is_preview(volume) ? " of the preview" : "", range.min, range.max);
}

cw_status cli_extract_surface(const cli_volume *volume, cw_extractor *extractor,
                              const cw_extract_desc *desc, cw_mesh *mesh,
                              cw_extract_counts *counts, cw_error *err)
{
    const cw_volume *v = &volume->view;
    const double voxels = (double)v->dim[0] * (double)v->dim[1] * (double)v->dim[2];
    cw_extract_desc d = *desc;
    d.max_bytes = volume->memory_left;
    d.progress = cli_progress(voxels / 1e6, "Mvoxel");
    cw_status st = extractor ? cw_extractor_extract(extractor, &d, mesh, counts, err)
                             : cw_extract(v, &d, mesh, counts, err);
    if (st == CW_OK && mesh->triangle_count == 0)
        st = explain_empty(volume, desc, err);
    return st == CW_OK ? st : cwi_fail_in(err, st, volume->path);
}
