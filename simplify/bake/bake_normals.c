/* Bakes normals: every texel asks the full surface. */
#include <cubewright/bake.h>

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/closest_point.h"
#include "core/geometry/point_triangle.h"
#include "core/mesh/mesh.h"
#include "core/texture/split_seams.h"
#include "core/texture/tangents.h"
#include "simplify/bake/texels.h"

#include <math.h>
#include <string.h>

enum {
    DEFAULT_SIZE = 2048,
    MIN_SIZE = 16,
    MAX_SIZE = 16384,
    DEFAULT_MARGIN = 2,
    MAX_MARGIN = 64
};

static const double DEFAULT_REACH = 0.04;

/* Sums over a row of texels. */
typedef struct row_facts {
    size_t texels, missed;
    double max_mm, sum_mm, sum_deg;
} row_facts;

typedef struct baking {
    cw_mesh mesh;         /* a copy, with vertices split at seams */
    const cw_mesh *full;  /* with normals */
    cw_mesh own;          /* the copy that full is, where it had none; or empty */
    float (*tangents)[4]; /* vertices of mesh */
    cwi_boxes tree;       /* of full */
    uint32_t size;
    uint32_t *triangle; /* texels: the triangle that the middle lies in; CWI_NO_TEXEL: none */
    double reach, shift[3]; /* shift: from mesh's origin to that of full */
    uint8_t *pixels;
    row_facts *rows;
} baking;

/* The frame of a texel: place, normal, tangent and bitangent. */
typedef struct texel_frame {
    double point[3], normal[3], tangent[3], bitangent[3];
} texel_frame;

typedef struct facing_search {
    const baking *b;
    const double *point, *normal;
    uint32_t triangle;
} facing_search;

/* --- the full surface --------------------------------------------------------------------- */

static void measure_facing(void *context, size_t slot, double *distance_sq)
{
    facing_search *s = context;
    const cw_mesh *m = s->b->full;
    const uint32_t t = s->b->tree.order[slot], *v = m->triangles + 3 * (size_t)t;
    const cwi_facet_view f =
        cwi_facet_look(m->positions + 3 * (size_t)v[0], m->positions + 3 * (size_t)v[1],
                       m->positions + 3 * (size_t)v[2], s->point);
    if (!(cwi_dot(f.normal, s->normal) > 0))
        return;
    const double here = cwi_facet_view_distance_sq(&f);
    if (here < *distance_sq) {
        *distance_sq = here;
        s->triangle = t;
    }
}

/* Finds the nearest triangle that faces the same way, and the square of its distance. bound: where one is
 * thought to be; else all in reach are looked at. */
static uint32_t find_facing(const baking *b, const double point[3], const double normal[3],
                            double bound, double *distance_sq)
{
    facing_search s = {.b = b, .point = point, .normal = normal, .triangle = CWI_NO_TEXEL};
    *distance_sq = fmin(bound * bound, b->reach * b->reach);
    cwi_boxes_nearest(&b->tree, point, measure_facing, &s, distance_sq);
    if (s.triangle == CWI_NO_TEXEL && bound < b->reach) {
        *distance_sq = b->reach * b->reach;
        cwi_boxes_nearest(&b->tree, point, measure_facing, &s, distance_sq);
    }
    return s.triangle;
}

/* Interpolates the normal of the full surface at its point nearest to another one. */
static bool find_normal(const baking *b, uint32_t triangle, const double point[3],
                        double normal[3])
{
    const uint32_t *v = b->full->triangles + 3 * (size_t)triangle;
    const float *p = b->full->positions;
    double weights[3];
    cwi_facet_nearest(p + 3 * (size_t)v[0], p + 3 * (size_t)v[1], p + 3 * (size_t)v[2], point,
                      weights);
    for (int k = 0; k < 3; k++) {
        normal[k] = 0;
        for (int c = 0; c < 3; c++)
            normal[k] += weights[c] * (double)b->full->normals[3 * (size_t)v[c] + (size_t)k];
    }
    return cwi_normalise(normal);
}

/* --- texels ------------------------------------------------------------------------------- */

/* Interpolates the frame that a viewer has at a texel. */
static void find_frame(const baking *b, uint32_t triangle, uint32_t x, uint32_t y,
                       texel_frame *f)
{
    const cw_mesh *m = &b->mesh;
    const uint32_t *v = m->triangles + 3 * (size_t)triangle;
    double weights[3];
    *f = (texel_frame){0};
    cwi_texel_weights(cwi_texture_of(m)->data, v, b->size, x, y, weights);
    for (int c = 0; c < 3; c++) {
        const float *p = m->positions + 3 * (size_t)v[c], *n = m->normals + 3 * (size_t)v[c],
                    *t = b->tangents[v[c]];
        const double normal[3] = {(double)n[0], (double)n[1], (double)n[2]},
                     tangent[3] = {(double)t[0], (double)t[1], (double)t[2]};
        double across[3];
        cwi_cross(normal, tangent, across);
        for (int k = 0; k < 3; k++) {
            f->point[k] += weights[c] * (double)p[k];
            f->normal[k] += weights[c] * normal[k];
            f->tangent[k] += weights[c] * tangent[k];
            f->bitangent[k] += weights[c] * (double)t[3] * across[k];
        }
    }
    cwi_normalise(f->normal);
    cwi_normalise(f->tangent);
    cwi_normalise(f->bitangent);
}

/* Writes a direction as a texel: its shares of the frame's three directions. */
static void put_normal(const texel_frame *f, const double normal[3], uint8_t *pixel)
{
    double across[3], shares[3];
    cwi_cross(f->bitangent, f->normal, across);
    const double volume = cwi_dot(f->tangent, across);
    shares[0] = cwi_dot(normal, across) / volume;
    cwi_cross(f->normal, f->tangent, across);
    shares[1] = cwi_dot(normal, across) / volume;
    cwi_cross(f->tangent, f->bitangent, across);
    shares[2] = cwi_dot(normal, across) / volume;
    if (!(fabs(volume) > 1e-3) || !cwi_normalise(shares)) {
        shares[0] = shares[1] = 0;
        shares[2] = 1;
    }
    for (int k = 0; k < 3; k++)
        pixel[k] = (uint8_t)floor(127.5 * (shares[k] + 1) + 0.5);
    pixel[3] = 255;
}

static void bake_row(void *context, size_t y)
{
    baking *b = context;
    row_facts *facts = &b->rows[y];
    double last[3] = {0, 0, 0}, last_mm = INFINITY;
    for (uint32_t x = 0; x < b->size; x++) {
        const uint32_t triangle = b->triangle[y * b->size + x];
        uint8_t *pixel = b->pixels + 4 * (y * b->size + x);
        texel_frame f;
        double point[3], normal[3], distance_sq;
        if (triangle == CWI_NO_TEXEL) {
            last_mm = INFINITY;
            continue;
        }
        find_frame(b, triangle, x, (uint32_t)y, &f);
        for (int k = 0; k < 3; k++)
            point[k] = f.point[k] + b->shift[k];
        const double bound = (last_mm + cwi_distance(point, last)) * (1 + 1e-9);
        const uint32_t found = find_facing(b, point, f.normal, bound, &distance_sq);
        facts->texels++;
        if (found == CWI_NO_TEXEL || !find_normal(b, found, point, normal)) {
            facts->missed++;
            last_mm = INFINITY;
            put_normal(&f, f.normal, pixel);
            continue;
        }
        last_mm = sqrt(distance_sq);
        memcpy(last, point, sizeof last);
        put_normal(&f, normal, pixel);
        facts->max_mm = fmax(facts->max_mm, last_mm);
        facts->sum_mm += last_mm;
        facts->sum_deg += acos(fmax(-1, fmin(1, cwi_dot(normal, f.normal)))) * 180 / CWI_PI;
    }
}

/* --- the whole ---------------------------------------------------------------------------- */

static void sum_facts(const baking *b, cw_bake_facts *facts)
{
    double mm = 0, deg = 0;
    *facts = (cw_bake_facts){.reach_mm = b->reach};
    for (uint32_t y = 0; y < b->size; y++) {
        facts->texels += b->rows[y].texels;
        facts->missed += b->rows[y].missed;
        facts->max_mm = fmax(facts->max_mm, b->rows[y].max_mm);
        mm += b->rows[y].sum_mm;
        deg += b->rows[y].sum_deg;
    }
    const size_t hit = facts->texels - facts->missed;
    facts->mean_mm = hit ? mm / (double)hit : 0;
    facts->mean_deg = hit ? deg / (double)hit : 0;
}

static double find_diagonal(const cw_mesh *mesh)
{
    double low[3], high[3];
    return cw_mesh_bounds(mesh, low, high) ? cwi_distance(low, high) : 0;
}

static cw_status prepare(baking *b, const cw_mesh *mesh, const cw_mesh *full,
                         const cw_bake_desc *d, cw_error *err)
{
    const bool at_corners = cwi_texture_of(mesh)->on == CW_ON_CORNERS;
    cw_status st =
        at_corners ? cwi_split_seams(mesh, &b->mesh, err) : cwi_mesh_copy(mesh, &b->mesh, err);
    b->full = full->normals ? full : &b->own;
    if (st == CW_OK && !full->normals)
        st = cwi_mesh_copy(full, &b->own, err);
    if (st == CW_OK && !full->normals)
        st = cw_mesh_normals(&b->own, err);
    if (st == CW_OK)
        st = cwi_closest_build(b->full, &b->tree, err);
    if (st != CW_OK)
        return st;
    b->size = d->size;
    b->reach = d->reach_mm > 0 ? d->reach_mm : DEFAULT_REACH * find_diagonal(mesh);
    for (int k = 0; k < 3; k++)
        b->shift[k] = mesh->origin[k] - full->origin[k];
    b->tangents = cwi_alloc_array(b->mesh.vertex_count, sizeof *b->tangents);
    b->triangle = cwi_alloc_array((size_t)d->size * d->size, sizeof *b->triangle);
    b->rows = cwi_alloc_zeroed(d->size, sizeof *b->rows);
    if (!b->tangents || !b->triangle || !b->rows)
        return cwi_fail_memory(err);
    return cwi_tangents(&b->mesh, b->tangents, err);
}

static cw_status bake(baking *b, const cw_bake_desc *d, cw_image *image, cw_error *err)
{
    const size_t texels = (size_t)d->size * d->size;
    cwi_texels_find(&b->mesh, d->size, b->triangle);
    cw_status st = cw_image_alloc(image, d->size, d->size, err);
    if (st != CW_OK)
        return st;
    b->pixels = image->pixels;
    for (size_t n = 0; n < texels; n++)
        memcpy(b->pixels + 4 * n, (uint8_t[4]){128, 128, 255, 255}, 4);
    st = cwi_parallel_for(d->size, d->size * (size_t)64, d->threads, &d->progress,
                          "baking normals", bake_row, b, err);
    if (st == CW_OK)
        st = cwi_texels_spread(b->triangle, d->size, d->margin, b->pixels, err);
    if (st != CW_OK)
        cw_image_free(image);
    return st;
}

const char *cw_map_name(cw_map map)
{
    static const char *const names[CW_MAP_COUNT] = {
#define CW_X(name, text) text,
        CW_MAP_TABLE(CW_X)
#undef CW_X
    };
    return (unsigned)map < CW_MAP_COUNT ? names[map] : NULL;
}

static cw_status check_inputs(const cw_mesh *mesh, const cw_mesh *full, const cw_bake_desc *d,
                              cw_error *err)
{
    if (d->size < MIN_SIZE || d->size > MAX_SIZE)
        return cwi_fail(err, CW_ERR_ARGUMENT, "desc->size %u: expected %d to %d", d->size,
                        MIN_SIZE, MAX_SIZE);
    if (d->margin > MAX_MARGIN)
        return cwi_fail(err, CW_ERR_ARGUMENT, "desc->margin %u: expected 1 to %d", d->margin,
                        MAX_MARGIN);
    if (!(d->reach_mm >= 0) || isinf(d->reach_mm))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "desc->reach_mm %g: expected a positive, finite number", d->reach_mm);
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK)
        st = cw_mesh_check(full, err);
    if (st != CW_OK)
        return st;
    if (!cwi_texture_of(mesh))
        return cwi_fail(err, CW_ERR_ARGUMENT, "the mesh has no texture coordinates");
    if (!mesh->normals)
        return cwi_fail(err, CW_ERR_ARGUMENT, "the mesh has no normals");
    return full->triangle_count ? CW_OK
                                : cwi_fail(err, CW_ERR_ARGUMENT, "the full mesh is empty");
}

cw_status cw_bake_normals(const cw_mesh *mesh, const cw_mesh *full, const cw_bake_desc *desc,
                          cw_image *image, cw_bake_facts *facts, cw_error *err)
{
    CWI_REQUIRE(err, mesh, full, image);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_bake_desc d = desc ? *desc : (cw_bake_desc){0};
    d.size = d.size ? d.size : DEFAULT_SIZE;
    d.margin = d.margin ? d.margin : DEFAULT_MARGIN;
    *image = (cw_image){0};
    baking b = {0};
    cw_status st = check_inputs(mesh, full, &d, err);
    if (st == CW_OK)
        st = prepare(&b, mesh, full, &d, err);
    if (st == CW_OK)
        st = bake(&b, &d, image, err);
    if (st == CW_OK && facts)
        sum_facts(&b, facts);
    cw_mesh_free(&b.mesh);
    cw_mesh_free(&b.own);
    cwi_boxes_free(&b.tree);
    cwi_free(b.tangents);
    cwi_free(b.triangle);
    cwi_free(b.rows);
    return st;
}
