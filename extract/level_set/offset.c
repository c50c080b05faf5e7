/* Offsets or remeshes a mesh by its level set, and refines voxels until the result holds. */
#include "core/geometry/box.h"
#include "extract/common/field_normals.h"
#include "extract/level_set/adaptive_field.h"
#include "extract/level_set/feature_warp.h"
#include "extract/level_set/level_set.h"
#include "extract/level_set/sharp_edges.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "simplify/quality/mesh_within.h"

#include <cubewright/extract.h>

#include <math.h>
#include <string.h>

/* Fractions of the box's diagonal. */
static const double USUAL_VOXEL = 1.0 / 256, FINEST_VOXEL = 1.0 / 512;

static double choose_voxel(const cw_offset_desc *d, const cw_quality *q)
{
    const double diagonal = cwi_box_diagonal(q->min, q->max);
    const double reach = fabs(d->offset_mm);
    double voxel = USUAL_VOXEL * diagonal;
    if (reach > 0)
        voxel = fmin(voxel, fmax(reach / 4, FINEST_VOXEL * diagonal));
    while (!cwi_level_set_fits(q, voxel, reach, d->max_bytes) && voxel < diagonal)
        voxel *= 1.05;
    return voxel;
}

/* State of a surface while it is made. */
typedef struct making {
    const cw_mesh *mesh;
    const cw_offset_desc *desc;
    cw_quality before;
    double requested,
        voxel; /* side of voxels as requested, and now; half of the requested side is
                            the guaranteed distance */
    cw_volume volume;
    bool is_known, overlaps; /* find_overlap() was called; the mesh overlaps */
} making;

static cw_status take_surface(const making *m, const cw_volume *volume, bool simple,
                              cw_mesh *out, cw_error *err)
{
    const cw_offset_desc *d = m->desc;
    const cw_extract_desc desc = {.isovalue = d->offset_mm,
                                  .inside_is_low = true,
                                  .leave_open = volume->cells, /* the volume continues beyond
                                                                  them */
                                  .simple_topology = simple,
                                  .threads = d->threads,
                                  .max_bytes = d->max_bytes,
                                  .progress = d->progress};
    *out = (cw_mesh){0};
    const cw_status st = cw_extract(volume, &desc, out, NULL, err);
    if (st == CW_OK)
        cwi_level_set_round(out, m->mesh->origin);
    return st;
}

static cw_status make_samples(making *m, cw_error *err)
{
    const cw_offset_desc *d = m->desc;
    const cw_level_set_desc desc = {.voxel_mm = m->voxel,
                                    .inside_mm = fmax(-d->offset_mm, 0),
                                    .outside_mm = fmax(d->offset_mm, 0),
                                    .threads = d->threads,
                                    .max_bytes = d->max_bytes,
                                    .progress = d->progress};
    cw_volume_free(&m->volume);
    return cwi_level_set_make(m->mesh, &m->before, &desc, &d->offset_mm, &m->volume, err);
}

static cw_status make_plain(making *m, cw_mesh *out, cw_error *err)
{
    cw_status st = make_samples(m, err);
    if (st == CW_OK)
        st = take_surface(m, &m->volume, false, out, err);
    if (st == CW_OK && out->triangle_count && !m->desc->no_sharpen)
        st = cwi_sharpen(m->mesh, m->desc, m->voxel, out, err);
    return st;
}

/* ---- guarantees for the mesh's own surface ----------------------------------------------- */

static int64_t count_handles(const cw_quality *q)
{
    return (int64_t)q->components - q->euler / 2;
}

/* Decides if a surface has neither more components nor more handles than the mesh. */
static cw_status compare_topology(const making *m, const cw_mesh *out, bool *holds,
                                  cw_error *err)
{
    cw_quality q;
    const cw_status st =
        cw_quality_measure(out, &(cw_quality_desc){.threads = m->desc->threads}, &q, err);
    *holds = st == CW_OK && out->triangle_count && q.components <= m->before.components &&
             count_handles(&q) <= count_handles(&m->before);
    return st;
}

static cw_status find_beyond(const making *m, const cw_mesh *from, const cw_mesh *to,
                             double limit_mm, bool *any, cw_error *err)
{
    uint8_t *beyond = cwi_alloc_array(from->triangle_count, sizeof *beyond);
    cw_status st = beyond ? cwi_mesh_within(from, to, limit_mm, NULL, m->desc->threads,
                                            &m->desc->progress, beyond, err)
                          : cwi_fail_memory(err);
    *any = false;
    for (size_t t = 0; t < from->triangle_count && st == CW_OK; t++)
        *any |= beyond[t];
    cwi_free(beyond);
    return st;
}

/* Finds out, once, if parts of the mesh overlap: parts inside others are not of the surface,
 * and are lost. */
static cw_status find_overlap(making *m, cw_error *err)
{
    const cw_crossings_desc how = {.threads = m->desc->threads, .progress = m->desc->progress};
    cw_quality q;
    cw_crossings found = {0};
    if (m->is_known)
        return CW_OK;
    cw_status st = cw_quality_measure(
        m->mesh, &(cw_quality_desc){.shells = true, .threads = how.threads}, &q, err);
    if (st == CW_OK)
        st = cw_self_intersections(m->mesh, &how, &found, err);
    m->overlaps = st == CW_OK && (q.nested || found.count);
    m->is_known = true;
    cw_crossings_free(&found);
    return st;
}

/* Decides if a surface is within limit_mm of the mesh and, unless the mesh overlaps, the mesh
 * is within limit_mm of the surface. */
static cw_status compare_positions(const making *m, const cw_mesh *out, double limit_mm,
                                   bool *holds, cw_error *err)
{
    bool beyond = !out->triangle_count;
    cw_status st = CW_OK;
    if (!beyond && !m->overlaps)
        st = find_beyond(m, m->mesh, out, limit_mm, &beyond, err);
    if (st == CW_OK && !beyond)
        st = find_beyond(m, out, m->mesh, limit_mm, &beyond, err);
    *holds = st == CW_OK && !beyond;
    return st;
}

/* Decides if the guarantee holds and, if not, if the surface is so near that smaller voxels may
 * make it hold. */
static cw_status judge_remesh(making *m, const cw_mesh *out, bool *holds, bool *is_near,
                              cw_error *err)
{
    const double limit_mm = m->requested / 2;
    cw_status st = compare_topology(m, out, holds, err);
    if (st == CW_OK && *holds)
        st = compare_positions(m, out, limit_mm, holds, err);
    if (st == CW_OK && !*holds)
        st = find_overlap(m, err);
    if (st == CW_OK && !*holds && m->overlaps)
        st = compare_positions(m, out, limit_mm, holds, err);
    if (st == CW_OK && !*holds && !*is_near)
        st = compare_positions(m, out, 2 * limit_mm, is_near, err);
    return st;
}

/* Makes the surface from samples of the same level set, moved to the features that they miss.
 * Moving vertices does not change the topology: that is checked before. */
static cw_status make_warped(making *m, cw_mesh *out, bool *holds, bool *is_near, cw_error *err)
{
    const cw_offset_desc *d = m->desc;
    cwi_warp warp;
    cw_status st = cwi_warp_init(&warp, m->mesh, &m->volume, err);
    if (st == CW_OK)
        st = take_surface(m, &m->volume, true, out, err);
    if (st == CW_OK)
        st = compare_topology(m, out, holds, err);
    if (*holds && st == CW_OK)
        st = cwi_unwarp(&warp, m->mesh, d->threads, &d->progress, out, err);
    if (*holds && st == CW_OK)
        st = cwi_sharpen(m->mesh, d, m->voxel, out, err);
    if (*holds && st == CW_OK)
        st = judge_remesh(m, out, holds, is_near, err);
    cwi_warp_free(&warp);
    return st;
}

/* Makes the surface with the voxels as they are; if the guarantee does not hold, with samples
 * moved. */
static cw_status make_either(making *m, cw_mesh *out, bool *holds, bool *is_near, cw_error *err)
{
    cw_status st = make_plain(m, out, err);
    if (st == CW_OK)
        st = judge_remesh(m, out, holds, is_near, err);
    if (st != CW_OK || *holds)
        return st;
    cw_mesh_free(out);
    return make_warped(m, out, holds, is_near, err);
}

enum {
    MAX_HALVINGS = 2,
    MAX_ROUNDS = 16,
    FEW = 1 << 18 /* number of triangles that takes only a moment */
};

/* Returns true if voxels of half the size are worth a try, where the surface now has
 * `triangles` triangles. */
static bool should_halve(const making *m, size_t triangles, bool is_near)
{
    return !m->desc->no_refine && (is_near || 4 * triangles <= FEW) &&
           cwi_level_set_fits(&m->before, m->voxel / 2, 0, m->desc->max_bytes);
}

/* Makes the surface with samples moved, and then with smaller voxels, until it is within half a
 * voxel and has neither more components nor more handles. If the memory limit is reached,
 * *holds is false.
 * triangles  of the surface that the voxels give as they are */
static cw_status make_whole(making *m, size_t triangles, bool is_near, cw_mesh *out,
                            bool *holds, cw_error *err)
{
    cw_status st = make_warped(m, out, holds, &is_near, err);
    for (int n = 0; n < MAX_HALVINGS && st == CW_OK && !*holds; n++, triangles *= 4) {
        if (!should_halve(m, triangles, is_near))
            break;
        cw_mesh_free(out);
        m->voxel /= 2;
        is_near = false;
        st = make_either(m, out, holds, &is_near, err);
    }
    if (st == CW_ERR_LIMIT && m->voxel < m->requested) {
        *holds = false;
        st = CW_OK;
    }
    return st;
}

/* Repairs normals. Gradients across edges and through thin walls may point anywhere. Where they
 * deviate from the normal of the triangles around by more than 60 degrees, that normal is
 * taken. */
static cw_status mend_normals(cw_mesh *mesh, cw_error *err)
{
    float *gradients = mesh->normals;
    mesh->normals = cwi_alloc_zeroed(3 * mesh->vertex_count, sizeof *mesh->normals);
    cw_status st = mesh->normals ? cwi_repair_normals(mesh, 1, err) : cwi_fail_memory(err);
    for (size_t v = 0; v < mesh->vertex_count && st == CW_OK; v++) {
        const float *g = gradients + 3 * v;
        float *n = mesh->normals + 3 * v;
        if (g[0] * n[0] + g[1] * n[1] + g[2] * n[2] >= 0.5F)
            memcpy(n, g, 3 * sizeof *n);
    }
    cwi_free(gradients);
    return st;
}

static cw_status make_divided(const making *m, cwi_adaptive *a, cw_mesh *out, cw_error *err)
{
    cw_volume grid;
    cw_status st = cwi_adaptive_grid(a, &grid, err);
    if (st == CW_OK)
        st = take_surface(m, &grid, false, out, err);
    if (st == CW_OK)
        st = mend_normals(out, err);
    if (st != CW_OK)
        cw_mesh_free(out);
    cw_volume_free(&grid);
    return st;
}

/* Divides cells and makes the surface again, until all of it is within half a voxel, nothing is
 * left to divide, or the memory limit is reached.
 * out  replaced by the new surface */
static cw_status make_adaptive(making *m, cw_mesh *out, cw_offset_facts *facts, cw_error *err)
{
    cwi_adaptive a = {0};
    cwi_beyond beyond = {0};
    cw_status st = make_samples(m, err);
    if (st == CW_OK)
        st = cwi_adaptive_init(&a, m->mesh, &m->volume, m->desc, err);
    for (int n = 0; n < MAX_ROUNDS && st == CW_OK; n++) {
        cw_mesh next = {0};
        st = cwi_adaptive_divide(&a, out, m->requested / 2, !m->overlaps, &beyond, err);
        if (st != CW_OK || !beyond.divided)
            break;
        st = make_divided(m, &a, &next, err);
        if (st != CW_OK)
            break;
        cw_mesh_free(out);
        *out = next;
        facts->least_mm = cwi_adaptive_min(&a);
    }
    cwi_adaptive_free(&a);
    facts->is_astray = beyond.any;
    return st == CW_ERR_LIMIT ? CW_OK : st;
}

static cw_status count_more(const making *m, const cw_mesh *out, cw_offset_facts *facts,
                            cw_error *err)
{
    cw_quality q;
    const cw_status st =
        cw_quality_measure(out, &(cw_quality_desc){.threads = m->desc->threads}, &q, err);
    if (st == CW_OK && q.components > m->before.components)
        facts->more_components = q.components - m->before.components;
    if (st == CW_OK && count_handles(&q) > count_handles(&m->before))
        facts->more_handles = (size_t)(count_handles(&q) - count_handles(&m->before));
    return st;
}

/* Makes the first surface for which the whole guarantee holds; else one that is as near. */
static cw_status make_true(making *m, cw_mesh *out, cw_offset_facts *facts, cw_error *err)
{
    cw_mesh whole = {0};
    bool holds = false, is_near = false;
    cw_status st = make_plain(m, out, err);
    if (st == CW_OK)
        st = judge_remesh(m, out, &holds, &is_near, err);
    if (st == CW_OK && !holds)
        st = make_whole(m, out->triangle_count, is_near, &whole, &holds, err);
    if (st == CW_OK && holds && whole.triangle_count) {
        cw_mesh_free(out);
        *out = whole;
        return CW_OK;
    }
    cw_mesh_free(&whole);
    if (st != CW_OK || holds)
        return st;
    m->voxel = m->requested;
    if (m->desc->no_refine) {
        st = compare_positions(m, out, m->requested / 2, &holds, err);
        facts->is_astray = !holds;
    } else {
        st = make_adaptive(m, out, facts, err);
    }
    return st == CW_OK ? count_more(m, out, facts, err) : st;
}

cw_status cw_mesh_offset(const cw_mesh *mesh, const cw_offset_desc *desc, cw_mesh *out,
                         cw_offset_facts *facts, cw_error *err)
{
    CWI_REQUIRE(err, mesh, desc, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    making m = {.mesh = mesh, .desc = desc};
    cw_offset_facts found = {0};
    *out = (cw_mesh){0};
    if (!isfinite(desc->offset_mm) || !isfinite(desc->voxel_mm) || desc->voxel_mm < 0)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "an offset of %g mm with voxels of %g mm: both are finite, and voxels "
                        "not below 0",
                        desc->offset_mm, desc->voxel_mm);
    cw_status st = cwi_level_set_check(mesh, desc->threads, &m.before, err);
    if (st != CW_OK)
        return st;
    m.voxel = m.requested = desc->voxel_mm > 0 ? desc->voxel_mm : choose_voxel(desc, &m.before);
    st = desc->offset_mm == 0 && !desc->no_sharpen ? make_true(&m, out, &found, err)
                                                   : make_plain(&m, out, err);
    cw_volume_free(&m.volume);
    if (st == CW_OK && !out->triangle_count)
        st = cwi_fail(err, CW_ERR_EMPTY, "nothing is left: no point is %g mm inside",
                      desc->offset_mm < 0 ? -desc->offset_mm : sqrt(0.75) * m.voxel);
    if (st == CW_OK)
        st = cwi_level_set_prove(out, desc->threads, &desc->progress, err);
    if (st == CW_OK) /* not of the grid in between */
        memcpy(out->affine, mesh->affine, sizeof out->affine);
    found.voxel_mm = m.voxel;
    found.asked_mm = m.requested;
    if (facts)
        *facts = found;
    if (st != CW_OK)
        cw_mesh_free(out);
    return st;
}
