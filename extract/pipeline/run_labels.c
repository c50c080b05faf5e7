/* Finishes the surfaces of labels: interfaces are simplified together, then each label gets its mesh. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "extract/pipeline/label_copier.h"
#include "extract/pipeline/stages.h"

/* Counts the triangles of all interfaces. */
static size_t count_interfaces(const cw_pipeline_labels *l)
{
    size_t count = 0;
    for (size_t n = 0; n < l->layer_count; n++)
        count += l->layers[n]->mesh.triangle_count;
    return count;
}

/* Counts the triangles of the surfaces of all labels: an interface of two counts twice. */
static size_t count_surfaces(const cw_pipeline_labels *l)
{
    size_t count = 0;
    for (size_t n = 0; n < l->layer_count; n++) {
        const cw_label_surfaces *s = l->layers[n];
        for (size_t k = 0; k < s->patch_count; k++)
            count += s->patches[k].count *
                     (s->patches[k].labels[1] == s->background ? 1 : (size_t)2);
    }
    return count;
}

/* Returns the fraction of its triangles that a part of all may keep; 0: no limit. */
static double find_ratio(size_t target, size_t all)
{
    return target > 0 && target < all ? (double)target / (double)all : 0;
}

static cw_status simplify_layer(const cwi_pipeline *p, cw_stage stage, double ratio, size_t n,
                                cw_error *err)
{
    cw_label_surfaces *surfaces = p->labels->layers[n];
    const size_t count = surfaces->mesh.triangle_count;
    cw_label_surfaces simplified;
    if (!count)
        return CW_OK;
    const cw_label_simplify_desc desc = {.error_mm = p->simplify.error_mm,
                                         .ratio = ratio,
                                         .threads = p->simplify.threads,
                                         .progress =
                                             cwi_begin_stage(p, stage, count, "triangle")};
    cw_status st = cw_label_simplify(surfaces, &desc, &simplified, err);
    if (st != CW_OK)
        return st;
    if (p->full_labels && !p->full_labels[n].mesh.triangle_count)
        p->full_labels[n] = *surfaces;
    else
        cw_label_surfaces_free(surfaces);
    *surfaces = simplified;
    return CW_OK;
}

/* Simplifies the interfaces of all layers, so that neighbours still share them. */
static cw_status simplify_together(cwi_pipeline *p, cw_stage stage, size_t target,
                                   cw_error *err)
{
    const cw_pipeline_labels *l = p->labels;
    const cw_pipeline_watch *w = &p->desc->watch;
    const size_t before = count_interfaces(l);
    const double ratio = find_ratio(target, before);
    cw_status st = CW_OK;
    if (l->apart || (p->simplify.error_mm == 0 && ratio == 0))
        return CW_OK;
    for (size_t n = 0; n < l->layer_count && st == CW_OK; n++)
        st = simplify_layer(p, stage, ratio, n, err);
    p->facts.ran |= 1u << stage;
    if (st == CW_OK && w->end)
        w->end(w->user, stage, before, count_interfaces(l));
    return st;
}

/* Simplifies the mesh of a label by itself. all: triangles of the surfaces of all labels */
static cw_status simplify_apart(cwi_pipeline *p, size_t all, cw_mesh *mesh, cw_mesh *full,
                                cw_error *err)
{
    const cw_simplify_desc desc = {.error_mm = p->simplify.error_mm,
                                   .ratio = find_ratio(p->simplify.triangles, all),
                                   .threads = p->simplify.threads};
    cw_mesh simplified;
    if (desc.error_mm == 0 && desc.ratio == 0)
        return CW_OK;
    cw_status st = cw_simplify(mesh, &desc, &simplified, NULL, err);
    if (st != CW_OK)
        return st;
    *full = *mesh;
    *mesh = simplified;
    p->facts.ran |= 1u << CW_STAGE_SIMPLIFY;
    return CW_OK;
}

/* Makes the mesh of label n of a layer. */
static cw_status finish_label(cwi_pipeline *p, cwi_label_copier *copier, size_t n,
                              cw_pipeline_surface *surface, size_t all, cw_pipeline_sink sink,
                              cw_error *err)
{
    const cw_label_surfaces *of_full = p->full_labels ? &p->full_labels[surface->layer] : NULL;
    cw_mesh full = {0};
    cw_status st = cwi_label_copier_copy(copier, n, surface->mesh, err);
    if (st == CW_OK && p->labels->apart)
        st = simplify_apart(p, all, surface->mesh, &full, err);
    else if (st == CW_OK && of_full && of_full->mesh.triangle_count)
        st = cw_label_mesh(of_full, surface->label, &full, err);
    surface->full = full.triangle_count ? &full : NULL;
    if (st == CW_OK)
        st = cwi_finish_surface(p, surface, sink, err);
    cw_mesh_free(&full);
    return st;
}

/* Makes the mesh of each label of a layer, and gives it away. */
static cw_status finish_layer(cwi_pipeline *p, size_t level, size_t layer, size_t all,
                              cw_pipeline_sink sink, cw_error *err)
{
    const cw_pipeline_labels *l = p->labels;
    const cw_label_surfaces *s = l->layers[layer];
    cwi_label_copier copier;
    cw_status st = cwi_label_copier_init(&copier, s) ? CW_OK : cwi_fail_memory(err);
    for (size_t n = 0; n < s->label_count && st == CW_OK; n++) {
        cw_mesh mesh = {0};
        cw_pipeline_surface surface = {
            .mesh = &mesh, .level = level, .layer = layer, .label = s->labels[n].label};
        if (l->wants && !l->wants(l->user, layer, surface.label))
            continue;
        st = finish_label(p, &copier, n, &surface, all, sink, err);
        cw_mesh_free(&mesh);
    }
    cwi_label_copier_free(&copier);
    return st;
}

/* Makes the mesh of each label, and gives it away. */
static cw_status finish_labels(cwi_pipeline *p, size_t level, cw_pipeline_sink sink,
                               cw_error *err)
{
    const cw_pipeline_labels *l = p->labels;
    const size_t all = l->apart ? count_surfaces(l) : 0;
    cw_status st = CW_OK;
    for (size_t n = 0; n < l->layer_count && st == CW_OK; n++)
        st = finish_layer(p, level, n, all, sink, err);
    return st;
}

/* Makes the levels of detail, each from the one before; or the only one. */
static cw_status run_levels(cwi_pipeline *p, cw_pipeline_sink sink, cw_error *err)
{
    const cw_pipeline_desc *d = p->desc;
    const size_t levels = d->lod_count ? d->lod_count : 1;
    const cw_stage stage = d->lod_count ? CW_STAGE_LOD : CW_STAGE_SIMPLIFY;
    cw_status st = CW_OK;
    for (size_t n = 0; n < levels && st == CW_OK; n++) {
        st = simplify_together(p, stage, d->lod_count ? d->lod[n] : p->simplify.triangles, err);
        if (st == CW_OK && !p->labels->interfaces_only)
            st = finish_labels(p, n, sink, err);
    }
    return st;
}

cw_status cw_pipeline_run_labels(const cw_pipeline_labels *labels, const cw_pipeline_desc *desc,
                                 cw_pipeline_sink sink, cw_pipeline_facts *facts, cw_error *err)
{
    CWI_REQUIRE(err, labels, desc);
    CWI_REQUIRE_VERSION(err, desc, 0);
    CWI_REQUIRE_VERSION(err, facts, 0);
    cwi_pipeline p = {.desc = desc, .labels = labels};
    cw_status st = cwi_begin_pipeline(&p, CW_SOURCE_LABELS, sink, err);
    if (st == CW_OK && ((desc->simplify && desc->simplify->triangles) || desc->lod_count) &&
        !labels->apart && !labels->interfaces_only) {
        p.full_labels = cwi_alloc_zeroed(labels->layer_count + 1, sizeof *p.full_labels);
        st = p.full_labels ? CW_OK : cwi_fail_memory(err);
    }
    p.facts.extracted.triangles =
        labels->apart ? count_surfaces(labels) : count_interfaces(labels);
    if (st == CW_OK)
        st = run_levels(&p, sink, err);
    for (size_t n = 0; n < labels->layer_count && p.full_labels; n++)
        cw_label_surfaces_free(&p.full_labels[n]);
    cwi_free(p.full_labels);
    cwi_give_facts(&p, facts);
    return st;
}
