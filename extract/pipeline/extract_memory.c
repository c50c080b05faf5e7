/* Extracts the surface of a volume in memory: as a whole, or simplified slab by slab. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/missing_values.h"
#include "core/volume/volume.h"
#include "extract/pipeline/stages.h"

static cw_status explain_empty(const cwi_pipeline *p, cw_error *err)
{
    const cw_extract_desc *d = &p->desc->extract;
    cw_statistics range;
    char missing[CWI_MISSING_TEXT];
    cw_status st = cw_volume_statistics(&p->part, 0, d->threads, &range, err);
    if (st != CW_OK)
        return st;
    cwi_tell_missing(&p->part, &range, missing);
    if (!range.finite)
        return cwi_fail(err, CW_ERR_EMPTY, "no voxel has a finite value%s", missing);
    return cwi_fail(err, CW_ERR_EMPTY,
                    "no surface at isovalue %g: values are %g to %g, and it must be above the "
                    "lowest and at most the highest%s",
                    d->isovalue, range.min, range.max, missing);
}

/* Returns the settings of the extraction: its limit is also that of the process. */
static cw_extract_desc describe_extraction(const cwi_pipeline *p)
{
    cw_extract_desc d = p->desc->extract;
    const size_t *dim = p->part.dim, left = cwi_memory_left();
    if (left != SIZE_MAX && (!d.max_bytes || left < d.max_bytes))
        d.max_bytes = left < 1 ? 1 : left;
    d.progress = cwi_begin_stage(p, CW_STAGE_EXTRACT, dim[0] * dim[1] * dim[2], "voxel");
    return d;
}

/* Simplifies slabs as they come, so that all of the surface is never in memory. */
static cw_status simplify_slabs(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    cw_extract_desc d = describe_extraction(p);
    cw_simplify_desc simplify = p->simplify;
    cw_simplifier *simplifier;
    simplify.progress = d.progress;
    d.extra_bytes = 0; /* what is checked is what is left */
    cw_status st = cw_simplifier_new(&simplify, &simplifier, err);
    if (st == CW_OK)
        st = cw_extract_slabs(&p->part, &d, CW_SIMPLIFIER_SLAB,
                              (cw_slab_sink){cw_simplifier_take, simplifier},
                              &p->facts.extracted, err);
    if (st == CW_OK)
        st = cw_simplifier_finish(simplifier, mesh, NULL, err);
    cw_simplifier_free(simplifier);
    p->is_simplified = true;
    return st;
}

static cw_status extract_whole(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    cw_extract_desc d = describe_extraction(p);
    d.no_normals = d.no_normals || (p->desc->lod_count && p->adds_normals && !p->desc->bake);
    return p->extractor ? cw_extractor_extract(p->extractor, &d, mesh, &p->facts.extracted, err)
                        : cw_extract(&p->part, &d, mesh, &p->facts.extracted, err);
}

cw_status cwi_extract_surface(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    if (p->given)
        return cwi_copy_surface(p, mesh, err);
    if (p->slices)
        return cwi_extract_slices(p, mesh, err);
    const bool by_slabs = p->desc->simplify && !p->needs_whole &&
                          cwi_volume_expect_dense(&p->part, "slabs", NULL) == CW_OK;
    cw_status st = by_slabs ? simplify_slabs(p, mesh, err) : extract_whole(p, mesh, err);
    return st == CW_OK && !mesh->triangle_count ? explain_empty(p, err) : st;
}
