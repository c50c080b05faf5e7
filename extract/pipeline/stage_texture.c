/* The stages of textures: coordinates, which levels of detail share, and the maps that are baked. */
#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "extract/pipeline/stages.h"

/* Makes the levels after the first of it, along its seams. */
static cw_status make_lower_levels(cwi_pipeline *p, cw_error *err)
{
    const cw_pipeline_desc *d = p->desc;
    const cw_simplify_desc desc = {
        .threads = d->extract.threads,
        .progress = cwi_begin_stage(p, CW_STAGE_LOD, p->levels->triangle_count, "triangle")};
    return d->lod_count < 2 ? CW_OK
                            : cw_simplify_levels(p->levels, &desc, d->lod + 1, d->lod_count - 1,
                                                 p->levels + 1, NULL, err);
}

cw_status cwi_lay_flat(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    cw_mesh *flat = p->levels ? p->levels : mesh;
    cw_atlas_desc desc = *p->desc->atlas;
    desc.threads = p->desc->extract.threads;
    desc.progress = cwi_begin_stage(p, CW_STAGE_ATLAS, flat->triangle_count, "triangle");
    cw_status st = cw_mesh_atlas(flat, &desc, &p->facts.atlas, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, "uv");
    return p->levels ? make_lower_levels(p, err) : CW_OK;
}

cw_status cwi_bake_maps(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    const cw_pipeline_desc *d = p->desc;
    cw_bake_desc desc = *d->bake;
    if (p->maps[CW_MAP_NORMALS].pixels) /* level 0's */
        return CW_OK;
    desc.size = p->facts.atlas.size;
    desc.margin = p->facts.atlas.margin;
    desc.threads = d->extract.threads;
    desc.progress = cwi_begin_stage(p, CW_STAGE_MAPS, (size_t)desc.size * desc.size, "texel");
    cw_status st = mesh->normals ? CW_OK : cw_mesh_normals(mesh, err);
    if (st == CW_OK)
        st = cw_bake_normals(mesh, p->levels ? &p->mesh : &p->full, &desc,
                             &p->maps[CW_MAP_NORMALS], &p->facts.baked, err);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, "maps");
}
