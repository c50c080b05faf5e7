/* The stages for cameras: draws the depths that they see, and leaves out what they do not see. */
#include "core/base/status.h"
#include "core/volume/volume.h"
#include "extract/pipeline/stages.h"

/* Margin around a picture, in pixels, so that rounding loses no triangle of it. */
static const double MARGIN_PIXELS = 1;

static size_t count_voxels(const cw_volume *v)
{
    return v->dim[0] * v->dim[1] * v->dim[2];
}

/* Finds the part of the volume that the views may see. To be culled, the surface is extracted there
 * only, unless all of a component counts. */
static cw_status choose_part(cwi_pipeline *p, cw_error *err)
{
    const cw_pipeline_desc *d = p->desc;
    cw_box box;
    if (!d->cull || p->needs_whole ||
        cwi_volume_expect_dense(p->volume, "bricks", NULL) != CW_OK)
        return CW_OK;
    cw_status st = cw_simplify_views_box(p->volume, d->views, d->view_count, &box, err);
    return st == CW_OK ? cw_volume_crop(p->volume, &box, &p->part, err) : st;
}

static cw_status draw_slab(void *user, const cw_slab *slab, cw_error *err)
{
    const cw_pipeline_desc *d = user;
    cw_status st = CW_OK;
    for (size_t n = 0; n < d->view_count && st == CW_OK; n++)
        st = cw_simplify_view_draw(d->views + n, slab->mesh, err);
    return st;
}

/* Which components are large enough is known when all is there. */
static cw_status draw_whole(const cwi_pipeline *p, cw_error *err)
{
    cw_mesh mesh;
    cw_status st = p->make_full(p, &p->part, true, &mesh, err);
    if (st == CW_OK)
        st = draw_slab((void *)(uintptr_t)p->desc, &(cw_slab){.mesh = &mesh}, err);
    cw_mesh_free(&mesh);
    return st;
}

cw_status cwi_draw_views(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    const cw_pipeline_desc *d = p->desc;
    cw_extract_desc extract = d->extract;
    (void)mesh;
    for (size_t n = 0; n < d->view_count; n++)
        cw_simplify_view_free(d->views + n);
    cw_status st = choose_part(p, err);
    p->facts.voxels = count_voxels(p->volume);
    p->facts.seen_voxels = count_voxels(&p->part);
    if (st != CW_OK || p->needs_whole)
        return st == CW_OK ? draw_whole(p, err) : st;
    extract.no_normals = true;
    return cw_extract_slabs(&p->part, &extract, CW_SIMPLIFIER_SLAB,
                            (cw_slab_sink){draw_slab, (void *)(uintptr_t)d}, NULL, err);
}

cw_status cwi_cull_surface(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    const cw_pipeline_desc *d = p->desc;
    const cw_simplify_desc *s = &p->simplify;
    cw_status st =
        cw_simplify_cull(mesh, d->views, d->view_count, MARGIN_PIXELS + s->pixel_error,
                         s->error_mm, &p->facts.culled, err);
    return st == CW_OK && !mesh->triangle_count
               ? cwi_fail(err, CW_ERR_EMPTY, "no camera sees anything of the surface")
               : st;
}
