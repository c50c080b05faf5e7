/* Extracts the surface of slices into a spool, measured on its way, or simplified slab by slab. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/missing_values.h"
#include "extract/pipeline/stages.h"

/* Memory beside the slices that writers, threads and buffers take; half of it is for the check. */
enum { BESIDE_SLICES = 10 << 20 };

/* A surface on its way. */
typedef struct streaming {
    cw_mesh_spool *spool;
    cw_quality_stream *check; /* NULL: it is not measured, or not yet */
} streaming;

/* Passes a chunk on to the spool, and to the measurement. */
static cw_status take_chunk(void *user, const cw_mesh_chunk *chunk, cw_error *err)
{
    const streaming *s = user;
    const cw_chunk_sink spool = cw_mesh_spool_sink(s->spool);
    cw_status st = spool.take(spool.user, chunk, err);
    if (st != CW_OK || !s->check)
        return st;
    const cw_chunk_sink check = cw_quality_stream_sink(s->check);
    st = check.take(check.user, chunk, err);
    return st == CW_ERR_LIMIT ? cwi_fail_in(err, st, "check") : st;
}

/* Begins the measurement. A quarter of its bytes is for the work on the front. */
static cw_status begin_check(const cwi_pipeline *p, streaming *s, size_t bytes, cw_error *err)
{
    const cw_quality_stream_desc check = {.threads = p->desc->extract.threads,
                                          .max_bytes = bytes / 4 * 3};
    return cw_quality_stream_new(&check, &s->check, err);
}

/* Returns the settings of the extraction. The slices take a third of the limit at most, or what a
 * single layer needs. The front of the measured surface may have the rest, and half of that beside:
 * the file is written later. */
static cw_status share_memory(const cwi_pipeline *p, streaming *s, cw_stream_desc *d,
                              cw_error *err)
{
    const cw_volume *shape = &p->slices->shape;
    const size_t left = d->extract.max_bytes, min = cw_extract_stream_bytes(shape, d, true);
    if (!p->desc->check || p->desc->min_volume_mm3 > 0)
        return CW_OK;
    if (!left)
        return cw_quality_stream_new(NULL, &s->check, err);
    d->extract.max_bytes = left / 3 > min ? left / 3 : min;
    const size_t slices = cw_extract_stream_bytes(shape, d, false);
    return begin_check(p, s, (left > slices ? left - slices : 0) + BESIDE_SLICES / 2, err);
}

/* Moves what is kept into another spool, and measures it on the way. The slices have gone: a
 * third of the memory is for the components, and the rest for the measurement. */
static cw_status drop_small(cwi_pipeline *p, streaming *s, size_t left, cw_error *err)
{
    cw_mesh_spool *whole = s->spool;
    const bool check = p->desc->check;
    const size_t bytes = check ? left / 3 : left,
                 triangles = cw_mesh_spool_frame(whole)->triangle_count;
    const cw_spool_drop_desc drop = {
        .least_mm3 = p->desc->min_volume_mm3,
        .max_bytes = bytes,
        .progress = cwi_begin_stage(p, CW_STAGE_MIN_VOLUME, triangles, "triangle")};
    cw_status st = CW_OK;
    s->spool = NULL;
    if (check && left)
        st = begin_check(p, s, left - bytes + BESIDE_SLICES / 2, err);
    else if (check)
        st = cw_quality_stream_new(NULL, &s->check, err);
    if (st == CW_OK)
        st = cw_mesh_spool_new(p->desc->spool_path, &s->spool, err);
    if (st == CW_OK)
        st = cw_mesh_spool_drop_volumes(whole, &drop, (cw_chunk_sink){take_chunk, s},
                                        &p->facts.small, err);
    cw_mesh_spool_free(whole);
    return st == CW_OK ? cwi_expect_kept(p, err) : st;
}

static cw_status expect_surface(const cwi_pipeline *p, size_t triangles, cw_error *err)
{
    char missing[CWI_MISSING_TEXT];
    cwi_tell_missing(&p->slices->shape, NULL, missing);
    return triangles
               ? CW_OK
               : cwi_fail(err, CW_ERR_EMPTY,
                          "no surface at isovalue %g%s: it must be above the lowest value "
                          "and at most the highest",
                          p->desc->extract.isovalue, missing);
}

static cw_status fill_spool(cwi_pipeline *p, streaming *s, cw_stream_desc *d, cw_error *err)
{
    const size_t left = d->extract.max_bytes;
    cw_status st = cw_mesh_spool_new(p->desc->spool_path, &s->spool, err);
    if (st == CW_OK)
        st = share_memory(p, s, d, err);
    if (st == CW_OK)
        st = cw_extract_stream(p->slices, d, (cw_chunk_sink){take_chunk, s},
                               &p->facts.extracted, err);
    if (st == CW_OK)
        st = expect_surface(p, p->facts.extracted.triangles, err);
    if (st == CW_OK && p->desc->min_volume_mm3 > 0)
        st = drop_small(p, s, left, err);
    if (st == CW_OK && s->check)
        st = cw_quality_stream_finish(s->check, &p->facts.quality, err);
    return st;
}

static cw_status simplify_slabs(cwi_pipeline *p, const cw_stream_desc *d, cw_mesh *mesh,
                                cw_error *err)
{
    cw_simplify_desc simplify = p->simplify;
    cw_simplifier *simplifier;
    simplify.progress = d->extract.progress;
    p->is_simplified = true;
    cw_status st = cw_simplifier_new(&simplify, &simplifier, err);
    if (st == CW_OK)
        st = cw_extract_stream_slabs(p->slices, d, CW_SIMPLIFIER_SLAB,
                                     (cw_slab_sink){cw_simplifier_take, simplifier},
                                     &p->facts.extracted, err);
    if (st == CW_OK)
        st = cw_simplifier_finish(simplifier, mesh, NULL, err);
    cw_simplifier_free(simplifier);
    return st == CW_OK ? expect_surface(p, mesh->triangle_count, err) : st;
}

cw_status cwi_extract_slices(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    const size_t *dim = p->slices->shape.dim;
    cw_stream_desc d = {.extract = p->desc->extract, .layers = p->desc->layers};
    streaming s = {0};
    d.extract.extra_bytes = 0;
    d.extract.progress =
        cwi_begin_stage(p, CW_STAGE_EXTRACT, dim[0] * dim[1] * dim[2], "voxel");
    if (p->desc->simplify)
        return simplify_slabs(p, &d, mesh, err);
    cw_status st = fill_spool(p, &s, &d, err);
    p->is_checked = s.check != NULL;
    cw_quality_stream_free(s.check);
    p->spool = s.spool;
    return st;
}
