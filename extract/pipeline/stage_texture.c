/* The stages of textures: coordinates, which levels of detail share, and the maps that are baked. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "extract/pipeline/stages.h"

#include <math.h>

/* Lists the finished surface, or its levels. NULL without memory */
static cw_mesh **list_surfaces(cwi_pipeline *p, cw_mesh *mesh, size_t *count)
{
    *count = p->levels ? p->desc->lod_count : 1;
    cw_mesh **list = cwi_alloc_array(*count, sizeof *list);
    for (size_t n = 0; n < *count && list; n++)
        list[n] = p->levels ? &p->levels[n] : mesh;
    return list;
}

/* Levels have charts of their own, since seams that they shared would keep the coarser ones from their shape.
 * Each gets half of the texels for a mm of the one before. */
cw_status cwi_lay_flat(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    cw_atlas_desc desc = *p->desc->atlas;
    size_t count;
    cw_mesh **list = list_surfaces(p, mesh, &count);
    double *scales = cwi_alloc_array(count, sizeof *scales);
    desc.threads = p->desc->extract.threads;
    desc.progress =
        cwi_begin_stage(p, CW_STAGE_ATLAS, list ? list[0]->triangle_count : 0, "triangle");
    for (size_t n = 0; n < count && scales; n++)
        scales[n] = ldexp(1, -(int)n);
    cw_status st = list && scales
                       ? cw_meshes_atlas(list, scales, count, &desc, &p->facts.atlas, err)
                       : cwi_fail_memory(err);
    cwi_free(list);
    cwi_free(scales);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, "uv");
}

/* Colours the full surface as its levels are. Theirs go, since viewers would multiply both. */
static cw_status move_colors(cwi_pipeline *p, cw_mesh *mesh, cw_mesh *full, cw_error *err)
{
    const unsigned maps = p->desc->bake->maps;
    cw_status st = CW_OK;
    if (!(maps >> CW_MAP_COLORS & 1))
        return CW_OK;
    if (p->desc->color && !p->facts.baked.texels)
        st = cwi_color_surface(p, full, err);
    cwi_free(mesh->colors);
    mesh->colors = NULL;
    return st;
}

/* Gives a surface the normals that are written with it. is_early: those of its stage do not yet stand */
static cw_status finish_normals(cwi_pipeline *p, cw_mesh *mesh, bool is_early, cw_error *err)
{
    cw_status st =
        is_early && !p->desc->extract.no_normals ? cwi_add_normals(p, mesh, err) : CW_OK;
    if (st == CW_OK && !mesh->normals)
        st = cw_mesh_normals(mesh, err);
    return st == CW_OK && is_early && cw_pipeline_stages(p->desc) >> CW_STAGE_CREASES & 1
               ? cwi_part_normals(p, mesh, err)
               : st;
}

cw_status cwi_bake_maps(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    const cw_pipeline_desc *d = p->desc;
    cw_mesh *full = p->levels ? &p->mesh : &p->full;
    cw_bake_desc desc = *d->bake;
    size_t count;
    cw_status st = move_colors(p, mesh, full, err);
    if (st != CW_OK || p->facts.baked.texels) /* those of level 0 are there */
        return st;
    cw_mesh **list = list_surfaces(p, mesh, &count);
    if (!list)
        return cwi_fail_memory(err);
    desc.size = p->facts.atlas.size;
    desc.margin = p->facts.atlas.margin;
    desc.threads = d->extract.threads;
    desc.progress = cwi_begin_stage(p, CW_STAGE_MAPS, (size_t)desc.size * desc.size, "texel");
    for (size_t n = 0; n < count && st == CW_OK; n++)
        st = finish_normals(p, list[n], n > 0, err);
    if (st == CW_OK)
        st = cw_bake_meshes((const cw_mesh *const *)list, count, full, &desc, p->maps,
                            &p->facts.baked, err);
    cwi_free(list);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, "maps");
}
