#include "extract/level_set.h"
#include "extract/sharpen.h"

#include "core/status.h"

#include <cubewright/extract.h>

#include <math.h>
#include <string.h>

/* Shares of the box's diagonal. */
static const double usual = 1.0 / 256, finest = 1.0 / 512;

static double choose_voxel(const cw_offset_desc *d, const cw_quality *q)
{
    const double diagonal =
        hypot(hypot(q->max[0] - q->min[0], q->max[1] - q->min[1]), q->max[2] - q->min[2]);
    const double reach = fabs(d->offset_mm);
    double voxel = usual * diagonal;
    if (reach > 0)
        voxel = fmin(voxel, fmax(reach / 4, finest * diagonal));
    while (!cwi_level_set_fits(q, voxel, reach, d->max_bytes) && voxel < diagonal)
        voxel *= 1.05;
    return voxel;
}

cw_status cw_mesh_offset(const cw_mesh *mesh, const cw_offset_desc *desc, cw_mesh *out,
                         double *voxel_mm, cw_error *err)
{
    cw_quality q;
    cw_volume volume = {0};
    *out = (cw_mesh){0};
    if (!isfinite(desc->offset_mm) || !isfinite(desc->voxel_mm) || desc->voxel_mm < 0)
        return cw_fail(err, CW_ERR_ARGUMENT,
                       "an offset of %g mm with voxels of %g mm: both are finite, and voxels "
                       "not below 0",
                       desc->offset_mm, desc->voxel_mm);
    cw_status st = cwi_level_set_check(mesh, desc->threads, &q, err);
    if (st != CW_OK)
        return st;
    const double voxel = desc->voxel_mm > 0 ? desc->voxel_mm : choose_voxel(desc, &q);
    const cw_level_set_desc level_set = {.voxel_mm = voxel,
                                         .inside_mm = fmax(-desc->offset_mm, 0),
                                         .outside_mm = fmax(desc->offset_mm, 0),
                                         .threads = desc->threads,
                                         .max_bytes = desc->max_bytes,
                                         .progress = desc->progress};
    const cw_extract_desc extract = {.isovalue = desc->offset_mm,
                                     .inside_is_low = true,
                                     .threads = desc->threads,
                                     .max_bytes = desc->max_bytes,
                                     .progress = desc->progress};
    st = cwi_level_set_make(mesh, &q, &level_set, &desc->offset_mm, &volume, err);
    if (st == CW_OK)
        st = cw_extract(&volume, &extract, out, NULL, err);
    cw_volume_free(&volume);
    if (st == CW_OK && !out->triangle_count)
        st = cw_fail(err, CW_ERR_EMPTY, "nothing is left: no point is %g mm inside",
                     -desc->offset_mm);
    if (st == CW_OK && !desc->no_sharpen)
        st = cwi_sharpen(mesh, desc, voxel, out, err);
    if (st == CW_OK) /* not of the grid in between */
        memcpy(out->affine, mesh->affine, sizeof out->affine);
    if (voxel_mm)
        *voxel_mm = voxel;
    if (st != CW_OK)
        cw_mesh_free(out);
    return st;
}
