/* The stages on finished surfaces: normals of the field, colours, and the check. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "extract/pipeline/stages.h"

cw_status cwi_add_normals(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    const cw_pipeline_desc *d = p->desc;
    if (p->labels || (p->given && !mesh->normals))
        return cw_mesh_normals(mesh, err);
    if (!p->adds_normals || !mesh->triangle_count)
        return CW_OK;
    const cw_normals_desc desc = {
        .inside_is_low = d->extract.inside_is_low,
        .threads = d->extract.threads,
        .progress = cwi_begin_stage(p, CW_STAGE_NORMALS, mesh->vertex_count, "vertex")};
    const size_t left = cwi_memory_left();
    return p->slices ? cw_extract_stream_normals(p->slices, &desc, left ? left : 1, mesh, err)
                     : cw_extract_normals(&p->part, &desc, mesh, err);
}

cw_status cwi_color_surface(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    const cw_pipeline_color *c = p->desc->color;
    cw_pipeline_facts *f = &p->facts;
    const bool is_first = !(f->ran & 1u << CW_STAGE_COLOR);
    const cw_volume *volume = NULL;
    const cw_sample_desc sample = {
        .threads = p->desc->extract.threads,
        .progress = cwi_begin_stage(p, CW_STAGE_COLOR, mesh->vertex_count, "vertex")};
    cw_status st = c->open(c->user, &volume, err);
    if (st != CW_OK)
        return st;
    st = cw_mesh_sample(mesh, volume, &sample, &f->color, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, "color_by");
    if (is_first) {
        f->color_low = c->has_range ? c->low : f->color.low;
        f->color_high = c->has_range ? c->high : f->color.high;
    }
    return cw_mesh_color(mesh, c->map, f->color_low, f->color_high, err);
}

cw_status cwi_check_surface(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    const cw_quality_desc desc = {
        .threads = p->desc->extract.threads,
        .progress = p->is_checked
                        ? (cw_progress){0}
                        : cwi_begin_stage(p, CW_STAGE_CHECK, mesh->triangle_count, "triangle")};
    return p->is_checked ? CW_OK : cw_quality_measure(mesh, &desc, &p->facts.quality, err);
}
