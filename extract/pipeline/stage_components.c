/* The stages that leave components out: small ones, all but the largest, and cavities. */
#include "core/base/status.h"
#include "extract/pipeline/stages.h"

cw_status cwi_expect_kept(const cwi_pipeline *p, cw_error *err)
{
    const cw_drop_counts *small = &p->facts.small;
    return small->kept ? CW_OK
                       : cwi_fail(err, CW_ERR_EMPTY,
                                  "no component encloses %.6g mm3: the largest of %zu encloses "
                                  "%.6g",
                                  p->desc->min_volume_mm3, small->dropped, small->largest_mm3);
}

cw_status cwi_drop_small(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    if (p->spool) /* they were left out when the surface went into it */
        return CW_OK;
    cw_status st = cw_mesh_drop_volumes(mesh, p->desc->min_volume_mm3, &p->facts.small, err);
    return st == CW_OK ? cwi_expect_kept(p, err) : st;
}

cw_status cwi_keep_largest(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    return cw_mesh_keep_largest(mesh, p->desc->largest, &p->facts.others, err);
}

cw_status cwi_fill_voids(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    return cw_mesh_fill_voids(mesh, p->desc->extract.threads, &p->facts.voids, err);
}
