/* Runs the stages of the recipe, and gives the finished surfaces away. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"
#include "extract/pipeline/stages.h"

#include <string.h>

static size_t count_triangles(const cwi_pipeline *p, const cw_mesh *mesh)
{
    return p->spool ? cw_mesh_spool_frame(p->spool)->triangle_count : mesh->triangle_count;
}

/* Runs the wanted stages on a surface. finishes: those for finished surfaces; else the others */
static cw_status run_stages(cwi_pipeline *p, cw_mesh *mesh, bool finishes, cw_error *err)
{
    const unsigned stages = cw_pipeline_stages(p->desc);
    const cw_pipeline_watch *w = &p->desc->watch;
    cw_status st = CW_OK;
    for (const cwi_stage *s = cwi_recipe; s < cwi_recipe + CW_STAGE_COUNT && st == CW_OK; s++) {
        if (!(stages >> s->stage & 1) || s->finishes != finishes)
            continue;
        const size_t before = count_triangles(p, mesh);
        st = s->run(p, mesh, err);
        p->facts.ran |= 1u << s->stage;
        if (st == CW_OK && w->end)
            w->end(w->user, s->stage, before, count_triangles(p, mesh));
    }
    return st;
}

cw_status cwi_finish_surface(cwi_pipeline *p, cw_pipeline_surface *surface,
                             cw_pipeline_sink sink, cw_error *err)
{
    cw_status st = run_stages(p, surface->mesh ? surface->mesh : &p->mesh, true, err);
    return st == CW_OK ? sink.take(sink.user, surface, &p->facts, err) : st;
}

static cw_status finish_surface(cwi_pipeline *p, cw_mesh *mesh, size_t level,
                                cw_pipeline_sink sink, cw_error *err)
{
    cw_pipeline_surface surface = {.mesh = p->spool ? NULL : mesh,
                                   .spool = p->spool,
                                   .level = level,
                                   .full = p->levels       ? &p->mesh
                                           : p->desc->bake ? &p->full
                                                           : NULL,
                                   .maps = p->desc->bake ? p->maps : NULL};
    cw_status st = cwi_finish_surface(p, &surface, sink, err);
    p->spool = surface.spool;
    return st;
}

/* Makes the surface or its levels of detail, finishes each, and gives it away. */
static cw_status run_pipeline(cwi_pipeline *p, cw_pipeline_sink sink, cw_error *err)
{
    const size_t levels = p->desc->lod_count;
    cw_status st = run_stages(p, &p->mesh, false, err);
    for (size_t n = 0; n < levels && st == CW_OK; n++)
        st = finish_surface(p, &p->levels[n], n, sink, err);
    return st == CW_OK && !levels ? finish_surface(p, &p->mesh, 0, sink, err) : st;
}

static void free_pipeline(cwi_pipeline *p)
{
    for (size_t n = 0; p->levels && n < p->desc->lod_count; n++)
        cw_mesh_free(&p->levels[n]);
    cwi_free(p->levels);
    cw_mesh_free(&p->mesh);
    cw_mesh_free(&p->full);
    for (size_t n = 0; n < CW_MAP_COUNT; n++)
        cw_image_free(&p->maps[n]);
    cw_mesh_spool_free(p->spool);
}

/* Runs the stages of the surface itself: those that reduce it are left out, and those that finish it. */
static cw_status make_full(const cwi_pipeline *p, const cw_volume *volume, bool no_normals,
                           cw_mesh *mesh, cw_error *err)
{
    cw_pipeline_desc desc = *p->desc;
    desc.simplify = NULL;
    desc.view_count = desc.lod_count = 0;
    desc.cull = false;
    desc.atlas = NULL;
    desc.bake = NULL;
    desc.crease_degrees = 0;
    desc.crease_caps = false;
    desc.extract.no_normals = desc.extract.no_normals || no_normals;
    desc.watch.end = NULL;
    cwi_pipeline full = {.desc = &desc, .volume = volume, .part = *volume};
    cw_status st = run_stages(&full, &full.mesh, false, err);
    if (st == CW_OK)
        *mesh = full.mesh;
    else
        free_pipeline(&full);
    return st;
}

/* Returns true if finished surfaces get normals of the field. */
static bool adds_normals(const cwi_pipeline *p)
{
    const cw_pipeline_desc *d = p->desc;
    return (d->simplify || d->lod_count) && !d->extract.no_normals && !p->labels && !p->given &&
           !(cwi_spoils(d) & CWI_FIELD_NORMALS) &&
           (p->slices || cwi_volume_expect_dense(p->volume, "normals", NULL) == CW_OK);
}

cw_status cwi_begin_pipeline(cwi_pipeline *p, cw_surface_source source, cw_pipeline_sink sink,
                             cw_error *err)
{
    const cw_pipeline_desc *d = p->desc;
    if (!sink.take)
        return cwi_fail(err, CW_ERR_ARGUMENT, "sink.take is NULL");
    CWI_REQUIRE_ARRAY(err, d->views, d->view_count);
    CWI_REQUIRE_ARRAY(err, d->lod, d->lod_count);
    if (d->cull && !d->view_count)
        return cwi_fail(err, CW_ERR_ARGUMENT, "cull needs views; view_count is 0");
    if (!(d->crease_degrees >= 0 && d->crease_degrees <= 180))
        return cwi_fail(err, CW_ERR_ARGUMENT, "crease_degrees %g: expected 0 to 180",
                        d->crease_degrees);
    if (d->color && !d->color->open)
        return cwi_fail(err, CW_ERR_ARGUMENT, "color->open is NULL");
    if (d->bake && !(d->atlas && (d->simplify || d->lod_count)))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "maps are those of a surface before simplify or lod, and need uv");
    p->needs_whole = cwi_needs_whole(d) || d->bake;
    p->adds_normals = adds_normals(p);
    p->make_full = make_full;
    p->simplify = d->simplify ? *d->simplify : (cw_simplify_desc){0};
    p->simplify.views = d->views;
    p->simplify.view_count = d->view_count;
    p->simplify.threads = d->extract.threads;
    return cw_pipeline_check(source, cw_pipeline_stages(d), NULL, NULL, err);
}

void cwi_give_facts(const cwi_pipeline *p, cw_pipeline_facts *facts)
{
    static const size_t BYTES[] = {sizeof *facts}; /* of each version */
    if (!facts)
        return;
    const uint32_t version = facts->version;
    memcpy(facts, &p->facts, BYTES[version]);
    facts->version = version;
}

cw_status cwi_start_pipeline(cwi_pipeline *p, cw_surface_source source, cw_pipeline_sink sink,
                             cw_pipeline_facts *facts, cw_error *err)
{
    cw_status st = cwi_begin_pipeline(p, source, sink, err);
    if (st == CW_OK)
        st = run_pipeline(p, sink, err);
    cwi_give_facts(p, facts);
    free_pipeline(p);
    return st;
}

cw_status cw_pipeline_run(const cw_volume *volume, cw_extractor *extractor,
                          const cw_pipeline_desc *desc, cw_pipeline_sink sink,
                          cw_pipeline_facts *facts, cw_error *err)
{
    CWI_REQUIRE(err, volume, desc);
    CWI_REQUIRE_VERSION(err, desc, 0);
    CWI_REQUIRE_VERSION(err, facts, 0);
    cwi_pipeline p = {.desc = desc, .volume = volume, .part = *volume, .extractor = extractor};
    return cwi_start_pipeline(&p, CW_SOURCE_MEMORY, sink, facts, err);
}

cw_status cw_pipeline_run_slices(const cw_slice_source *source, const cw_pipeline_desc *desc,
                                 cw_pipeline_sink sink, cw_pipeline_facts *facts, cw_error *err)
{
    CWI_REQUIRE(err, source, desc);
    CWI_REQUIRE_VERSION(err, desc, 0);
    CWI_REQUIRE_VERSION(err, facts, 0);
    cwi_pipeline p = {.desc = desc, .slices = source};
    return cwi_start_pipeline(&p, CW_SOURCE_SLICES, sink, facts, err);
}

static cw_status take_mesh(void *user, cw_pipeline_surface *surface,
                           const cw_pipeline_facts *facts, cw_error *err)
{
    (void)facts;
    (void)err;
    *(cw_mesh *)user = *surface->mesh;
    *surface->mesh = (cw_mesh){0};
    return CW_OK;
}

cw_status cw_pipeline_mesh(const cw_volume *volume, cw_extractor *extractor,
                           const cw_pipeline_desc *desc, cw_mesh *mesh,
                           cw_pipeline_facts *facts, cw_error *err)
{
    CWI_REQUIRE(err, volume, desc, mesh);
    CWI_REQUIRE_VERSION(err, desc, 0);
    CWI_REQUIRE_VERSION(err, facts, 0);
    *mesh = (cw_mesh){0};
    if (desc->bake)
        return cwi_fail(err, CW_ERR_ARGUMENT, "maps need the sink of cw_pipeline_run()");
    if (desc->lod_count)
        return cwi_fail(err, CW_ERR_ARGUMENT, "lod_count is %zu; one surface has no levels",
                        desc->lod_count);
    return cw_pipeline_run(volume, extractor, desc, (cw_pipeline_sink){take_mesh, mesh}, facts,
                           err);
}
