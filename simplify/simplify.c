/* Implements cw_simplify() and its levels: scales the mesh, runs the passes, and carries
 * attributes to the result. */
#include <cubewright/simplify.h>

#include "core/base/memory.h"
#include "core/base/module.h"
#include "core/base/status.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"
#include "core/mesh/attribute_transfer.h"
#include "core/mesh/mesh.h"
#include "core/texture/split_seams.h"
#include "simplify/attribute_weights.h"
#include "simplify/blocks/block_passes.h"
#include "simplify/blocks/partition.h"
#include "simplify/simplify_frame.h"

#include <math.h>
#include <string.h>

bool cw_simplify_available(void)
{
    return cwi_module_present("openmesh");
}

static cw_status check_desc(const cw_mesh *mesh, const cw_simplify_desc *d, cw_error *err)
{
    cw_status st = cwi_mesh_check_size(mesh, "simplified", err);
    return st == CW_OK ? cwi_attributes_check(mesh, d, err) : st;
}

double cwi_simplify_scale(const cw_mesh *m)
{
    double widest = 0;
    int exponent;
    for (size_t a = 0; a < 3 && m->vertex_count; a++) {
        float low = m->positions[a], high = low;
        for (size_t v = 1; v < m->vertex_count; v++) {
            const float x = m->positions[3 * v + a];
            low = x < low ? x : low;
            high = x > high ? x : high;
        }
        widest = fmax(widest, (double)high - (double)low);
    }
    frexp(widest, &exponent);
    return widest > 0 ? ldexp(1, -exponent) : 1;
}

void cwi_scale_points(const float *from, size_t vertices, double scale, float *to)
{
    for (size_t i = 0; i < 3 * vertices; i++)
        to[i] = (float)(scale * (double)from[i]);
}

/* Borrows all but the positions, which stand around no origin. */
static cw_status scale_mesh(const cw_mesh *mesh, double *scale, cw_mesh *scaled, cw_error *err)
{
    *scale = cwi_simplify_scale(mesh);
    *scaled = *mesh;
    memset(scaled->origin, 0, sizeof scaled->origin);
    scaled->positions = cwi_alloc_array(3 * mesh->vertex_count, sizeof(float));
    if (!scaled->positions)
        return cwi_fail_memory(err);
    cwi_scale_points(mesh->positions, mesh->vertex_count, *scale, scaled->positions);
    return CW_OK;
}

static cw_status weigh_attributes(const cw_mesh *m, const cw_simplify_desc *d,
                                  cwi_mesh_block *w, cw_error *err)
{
    const size_t count = cwi_attributes_count(d);
    w->attributes = count + (w->texture ? CWI_TEXTURE_ATTRIBUTES : 0);
    if (!count)
        return CW_OK;
    w->values = cwi_alloc_array(count * w->vertices, sizeof *w->values);
    if (!w->values)
        return cwi_fail_memory(err);
    cwi_attributes_weigh(m, d, w->values);
    return CW_OK;
}

/* Copies the texture coordinates of a triangle's corners. */
static void copy_texture(const cw_mesh *m, const cw_attribute *from, size_t t, float *to)
{
    const float *uv = from->data;
    for (size_t c = 3 * t; c < 3 * t + 3; c++, to += 2)
        memcpy(to, uv + 2 * (from->on == CW_ON_CORNERS ? c : m->triangles[c]), 2 * sizeof *uv);
}

/* Returns the length that the side of the texture has on the surface, in the mean; 0 without an area. */
static float find_texture_scale(const cwi_mesh_block *w)
{
    double area = 0, in_texture = 0;
    for (size_t t = 0; t < w->triangles && w->texture; t++) {
        const uint32_t *v = w->corners + 3 * t;
        const float *uv = w->texture + 6 * t;
        double normal[3];
        cwi_facet_normal(w->points + 3 * (size_t)v[0], w->points + 3 * (size_t)v[1],
                         w->points + 3 * (size_t)v[2], normal);
        area += cwi_length(normal);
        in_texture += fabs(((double)uv[2] - (double)uv[0]) * ((double)uv[5] - (double)uv[1]) -
                           ((double)uv[3] - (double)uv[1]) * ((double)uv[4] - (double)uv[0]));
    }
    return in_texture > 0 && isfinite(in_texture) ? (float)sqrt(area / in_texture) : 0;
}

/* Triangles that name a vertex twice are no part of any surface. */
static cw_status begin_block(const cw_mesh *m, cwi_mesh_block *w, cw_error *err)
{
    const cw_attribute *uv = cwi_texture_of(m);
    w->vertices = m->vertex_count;
    w->points = cwi_alloc_array(3 * w->vertices, sizeof *w->points);
    w->global_ids = cwi_alloc_array(w->vertices, sizeof *w->global_ids);
    w->corners = cwi_alloc_array(3 * m->triangle_count, sizeof *w->corners);
    if (uv)
        w->texture = cwi_alloc_array(6 * m->triangle_count, sizeof *w->texture);
    if (!w->points || !w->global_ids || !w->corners || !w->texture != !uv)
        return cwi_fail_memory(err);
    if (w->vertices)
        memcpy(w->points, m->positions, 3 * w->vertices * sizeof *w->points);
    for (size_t v = 0; v < w->vertices; v++)
        w->global_ids[v] = (uint32_t)v;
    for (size_t t = 0; t < m->triangle_count; t++) {
        const uint32_t *c = m->triangles + 3 * t;
        if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0])
            continue;
        if (uv)
            copy_texture(m, uv, t, w->texture + 6 * w->triangles);
        memcpy(w->corners + 3 * w->triangles++, c, 3 * sizeof *c);
    }
    cwi_block_span(w);
    w->texture_scale = find_texture_scale(w);
    return CW_OK;
}

cw_status cwi_finish_mesh(const cw_mesh *mesh, const cwi_mesh_block *from, cw_mesh *out,
                          cw_error *err)
{
    cw_status st = cwi_mesh_alloc(out, from->vertices, from->triangles, false, err);
    if (st != CW_OK)
        return st;
    memcpy(out->origin, mesh->origin, sizeof out->origin);
    memcpy(out->affine, mesh->affine, sizeof out->affine);
    memcpy(out->positions, from->points, 3 * from->vertices * sizeof *from->points);
    memcpy(out->triangles, from->corners, 3 * from->triangles * sizeof *from->corners);
    return CW_OK;
}

/* Gives a result the texture coordinates of its block: of corners, or of vertices as the input has them,
 * where all corners at a vertex have the same. */
static cw_status put_texture(const cw_mesh *mesh, const float *texture, cw_mesh *out,
                             cw_error *err)
{
    const cw_attribute *from = cwi_texture_of(mesh);
    float(*uv)[2];
    if (!from)
        return CW_OK;
    cw_status st = cwi_texture_add(out, from->on, &uv, err);
    for (size_t c = 0; c < 3 * out->triangle_count && st == CW_OK; c++)
        memcpy(uv[from->on == CW_ON_CORNERS ? c : out->triangles[c]], texture + 2 * c,
               sizeof *uv);
    return st;
}

/* Gives a result the attributes of the input. texture: of the result's corners, NULL: none */
static cw_status carry_attributes(const cw_mesh *mesh, const float *texture, int threads,
                                  const cw_progress *progress, cw_mesh *out, cw_error *err)
{
    cw_mesh bare;
    cw_status st = cwi_texture_hide(mesh, &bare, err);
    if (st == CW_OK)
        st = cwi_carry(&bare, NULL, threads, progress, out, err);
    if (st == CW_OK)
        st = put_texture(mesh, texture, out, err);
    cwi_free(bare.attributes);
    return st;
}

static cw_status run_passes(cwi_passes *p, const cw_mesh *mesh, const size_t *targets,
                            size_t levels, cwi_mesh_block *left, cw_error *err)
{
    cwi_mesh_block whole = {0};
    cw_status st = begin_block(mesh, &whole, err);
    if (st == CW_OK)
        st = weigh_attributes(mesh, p->desc, &whole, err);
    if (st == CW_OK && p->desc->error_mm > 0)
        st = cwi_passes_remember(p, mesh, err);
    p->keeps_record = true;
    if (st == CW_OK && p->next)
        st = cwi_passes_list(p, &whole, err);
    if (st == CW_OK && whole.triangles > CWI_BLOCK)
        st = cwi_passes_blocks(p, &whole, targets[0], err);
    if (st == CW_OK)
        st = cwi_passes_seams(p, &whole, targets[0], err);
    if (st == CW_OK)
        st = cwi_passes_whole(p, &whole, targets, levels, left, err);
    cwi_block_free(&whole);
    return st;
}

static cw_status simplify_levels(const cw_mesh *mesh, const cw_simplify_desc *desc,
                                 const size_t *targets, size_t levels, cw_mesh *out,
                                 cw_simplify_facts *facts, cw_error *err)
{
    cwi_passes p = {0};
    cw_mesh scaled = {0};
    double scale = 1;
    cwi_mesh_block *left = cwi_alloc_zeroed(levels, sizeof *left);
    cw_status st = left ? check_desc(mesh, desc, err) : cwi_fail_memory(err);
    if (st == CW_OK)
        st = cwi_passes_init(&p, desc, err);
    if (st == CW_OK)
        st = scale_mesh(mesh, &scale, &scaled, err);
    if (st == CW_OK)
        cwi_passes_place(&p, mesh->origin, scale);
    if (st == CW_OK)
        st = run_passes(&p, &scaled, targets, levels, left, err);
    cwi_free(scaled.positions);
    for (size_t n = 0; n < levels && st == CW_OK; n++) {
        cwi_scale_points(left[n].points, left[n].vertices, 1 / scale, left[n].points);
        const size_t cut = left[n].nonmanifold_count;
        st = cwi_finish_mesh(mesh, left + n, out + n, err);
        if (st == CW_OK)
            st = carry_attributes(mesh, left[n].texture, desc->threads, &p.poll, out + n, err);
        cwi_block_free(left + n);
        if (st == CW_OK && facts)
            facts[n] = (cw_simplify_facts){.vertices = out[n].vertex_count,
                                           .triangles = out[n].triangle_count,
                                           .cut = cut,
                                           .passes = 1 + p.repeats};
    }
    for (size_t n = 0; n < levels && left; n++) {
        cwi_block_free(left + n);
        if (st != CW_OK)
            cw_mesh_free(out + n);
    }
    cwi_free(left);
    cwi_passes_free(&p);
    return st;
}

size_t cwi_simplify_target(const cw_simplify_desc *d, size_t triangles)
{
    const bool is_ratio = d->ratio > 0 && d->ratio < 1;
    const size_t from_ratio = is_ratio ? (size_t)(d->ratio * (double)triangles) : 0;
    return from_ratio > d->triangles ? from_ratio : d->triangles;
}

cw_status cw_simplify(const cw_mesh *mesh, const cw_simplify_desc *desc, cw_mesh *out,
                      cw_simplify_facts *facts, cw_error *err)
{
    CWI_REQUIRE(err, mesh, desc, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const size_t target = cwi_simplify_target(desc, mesh->triangle_count);
    *out = (cw_mesh){0};
    if (desc->error_mm == 0 && desc->ratio == 0 && desc->triangles == 0)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "simplification needs an error, a number of triangles or a ratio");
    return simplify_levels(mesh, desc, &target, 1, out, facts, err);
}

cw_status cw_simplify_levels(const cw_mesh *mesh, const cw_simplify_desc *desc,
                             const size_t *triangles, size_t levels, cw_mesh *out,
                             cw_simplify_facts *facts, cw_error *err)
{
    CWI_REQUIRE(err, mesh, desc);
    CWI_REQUIRE_VERSION(err, desc, 0);
    CWI_REQUIRE_ARRAY(err, triangles, levels);
    CWI_REQUIRE_ARRAY(err, out, levels);
    for (size_t n = 0; n < levels; n++)
        out[n] = (cw_mesh){0};
    for (size_t n = 0; n < levels; n++)
        if (triangles[n] == 0 || (n && triangles[n] >= triangles[n - 1]))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "level %zu has %zu triangles; each must have some, and fewer than "
                            "the one before",
                            n, triangles[n]);
    if (levels == 0 || desc->triangles || desc->ratio > 0 || desc->error_mm > 0)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "levels need their own numbers of triangles, and nothing else");
    return simplify_levels(mesh, desc, triangles, levels, out, facts, err);
}
