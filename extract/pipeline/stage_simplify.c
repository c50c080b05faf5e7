/* The stages that reduce the surface: simplification, and levels of detail. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "extract/pipeline/stages.h"

/* Weight of normals in surfaces that get maps: triangles go where the surface bends, as shading shows. Much
 * more costs shape. */
static const float NORMAL_WEIGHT = 0.1f;

cw_status cwi_simplify_surface(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    cw_simplify_desc desc = p->simplify;
    cw_mesh reduced;
    if (p->is_simplified)
        return CW_OK;
    if (p->desc->bake && mesh->normals && !(desc.normal_weight > 0))
        desc.normal_weight = NORMAL_WEIGHT;
    desc.progress = cwi_begin_stage(p, CW_STAGE_SIMPLIFY, mesh->triangle_count, "triangle");
    cw_status st = cw_simplify(mesh, &desc, &reduced, NULL, err);
    if (st != CW_OK)
        return st;
    if (p->desc->bake)
        p->full = *mesh;
    else
        cw_mesh_free(mesh);
    *mesh = reduced;
    return CW_OK;
}

cw_status cwi_make_levels(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    const cw_pipeline_desc *d = p->desc;
    const cw_simplify_desc desc = {
        .normal_weight = d->bake && mesh->normals ? NORMAL_WEIGHT : 0,
        .threads = d->extract.threads,
        .progress = cwi_begin_stage(p, CW_STAGE_LOD, mesh->triangle_count, "triangle")};
    p->levels = cwi_alloc_zeroed(d->lod_count, sizeof *p->levels);
    if (!p->levels)
        return cwi_fail_memory(err);
    return cw_simplify_levels(mesh, &desc, d->lod, d->lod_count, p->levels, NULL, err);
}
