/* The stages that move or cut the surface: closed handles, smoothing, the cut by a plane, and
 * text. */
#include "core/base/status.h"
#include "extract/pipeline/stages.h"

cw_status cwi_close_handles(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    cw_close_handles_desc desc = *p->desc->close_handles;
    desc.threads = p->desc->extract.threads;
    desc.progress = cwi_begin_stage(p, CW_STAGE_HANDLES, mesh->triangle_count, "triangle");
    cw_mesh closed;
    cw_status st = cw_mesh_close_handles(mesh, &desc, &closed, &p->facts.handles, err);
    if (st != CW_OK)
        return st;
    cw_mesh_free(mesh);
    *mesh = closed;
    return CW_OK;
}

cw_status cwi_smooth(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    cw_smooth_desc desc = *p->desc->smooth;
    desc.threads = p->desc->extract.threads;
    desc.progress = cwi_begin_stage(p, CW_STAGE_SMOOTH, mesh->triangle_count, "triangle");
    return cw_mesh_smooth(mesh, &desc, &p->facts.smoothed, err);
}

cw_status cwi_cut_surface(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    cw_cut_desc desc = *p->desc->cut;
    cw_mesh cut;
    desc.progress = cwi_begin_stage(p, CW_STAGE_CUT, mesh->triangle_count, "triangle");
    cw_status st = cw_mesh_cut(mesh, &desc, &cut, &p->facts.cut, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, "cut_plane");
    cw_mesh_free(mesh);
    *mesh = cut;
    return CW_OK;
}

cw_status cwi_engrave_surface(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    cw_engrave_desc desc = *p->desc->engrave;
    cw_mesh engraved;
    desc.threads = p->desc->extract.threads;
    desc.progress = cwi_begin_stage(p, CW_STAGE_ENGRAVE, mesh->triangle_count, "triangle");
    cw_status st = cw_mesh_engrave(mesh, &desc, &engraved, &p->facts.engraved, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, "engrave");
    cw_mesh_free(mesh);
    *mesh = engraved;
    return CW_OK;
}
