#include "simplify/carry.h"

#include "core/layers.h"
#include "core/memory.h"
#include "core/status.h"
#include "simplify/quality/boxes.h"
#include "simplify/quality/facet.h"

#include <math.h>

enum { CHUNK = 1024 };

typedef struct carrier {
    const cw_mesh *from;
    cw_mesh *to;
    cwi_boxes tree;
} carrier;

typedef struct search {
    const carrier *c;
    double point[3];
    size_t triangle;
} search;

static void corners(const cw_mesh *m, size_t triangle, const float *p[3])
{
    for (size_t k = 0; k < 3; k++)
        p[k] = m->positions + 3 * (size_t)m->triangles[3 * triangle + k];
}

static void measure(void *context, size_t slot, double *square)
{
    search *s = context;
    const float *p[3];
    corners(s->c->from, s->c->tree.order[slot], p);
    const double here = cwi_facet_square(p[0], p[1], p[2], s->point);
    if (here < *square) {
        *square = here;
        s->triangle = s->c->tree.order[slot];
    }
}

static void blend(const carrier *c, const uint32_t corner[3], const double share[3], size_t v)
{
    const cw_mesh *m = c->from;
    cw_mesh *to = c->to;
    double normal[3] = {0}, color[4] = {0}, scalar = 0;
    size_t nearest = 0;
    for (size_t k = 0; k < 3; k++) {
        const size_t from = corner[k];
        nearest = share[k] > share[nearest] ? k : nearest;
        for (size_t a = 0; a < 3 && m->normals; a++)
            normal[a] += share[k] * (double)m->normals[3 * from + a];
        for (size_t a = 0; a < 4 && m->colors; a++)
            color[a] += share[k] * (double)m->colors[4 * from + a];
        if (m->scalars)
            scalar += share[k] * (double)m->scalars[from];
    }
    const double length = sqrt(cwi_dot(normal, normal));
    for (size_t a = 0; a < 3 && m->normals; a++)
        to->normals[3 * v + a] = length > 0 ? (float)(normal[a] / length)
                                            : m->normals[3 * (size_t)corner[nearest] + a];
    for (size_t a = 0; a < 4 && m->colors; a++)
        to->colors[4 * v + a] = (uint8_t)(color[a] + 0.5);
    if (m->scalars)
        to->scalars[v] = (float)scalar;
    if (m->labels)
        to->labels[v] = m->labels[corner[nearest]];
}

static void carry_chunk(void *context, size_t chunk)
{
    const carrier *c = context;
    for (size_t v = chunk * CHUNK; v < (chunk + 1) * CHUNK && v < c->to->vertex_count; v++) {
        search s = {.c = c};
        double square = INFINITY, share[3];
        const float *p[3];
        for (size_t a = 0; a < 3; a++)
            s.point[a] = (double)c->to->positions[3 * v + a];
        cwi_boxes_nearest(&c->tree, s.point, measure, &s, &square);
        corners(c->from, s.triangle, p);
        cwi_facet_nearest(p[0], p[1], p[2], s.point, share);
        blend(c, c->from->triangles + 3 * s.triangle, share, v);
    }
}

static cw_status build_tree(carrier *c, cw_error *err)
{
    const cw_mesh *m = c->from;
    float(*boxes)[6] = cwi_alloc_array(m->triangle_count, sizeof *boxes);
    if (!boxes)
        return cw_fail(err, CW_ERR_NO_MEMORY, "no memory to find closest points");
    for (size_t t = 0; t < m->triangle_count; t++) {
        const float *p[3];
        corners(m, t, p);
        for (int a = 0; a < 3; a++) {
            boxes[t][a] = fminf(p[0][a], fminf(p[1][a], p[2][a]));
            boxes[t][a + 3] = fmaxf(p[0][a], fmaxf(p[1][a], p[2][a]));
        }
    }
    cw_status st = cwi_boxes_build(&c->tree, (const float(*)[6])boxes, m->triangle_count, err);
    cwi_free(boxes);
    return st;
}

static bool alloc_carried(const cw_mesh *from, cw_mesh *to)
{
    const size_t n = to->vertex_count;
    if (from->normals)
        to->normals = cwi_alloc_array(3 * n, sizeof *to->normals);
    if (from->scalars)
        to->scalars = cwi_alloc_array(n, sizeof *to->scalars);
    if (from->colors)
        to->colors = cwi_alloc_array(4 * n, sizeof *to->colors);
    if (from->labels)
        to->labels = cwi_alloc_array(n, sizeof *to->labels);
    return !from->normals == !to->normals && !from->scalars == !to->scalars &&
           !from->colors == !to->colors && !from->labels == !to->labels;
}

cw_status cwi_carry(const cw_mesh *from, int threads, cw_mesh *to, cw_error *err)
{
    carrier c = {.from = from, .to = to};
    const cw_progress silent = {0};
    if (!from->normals && !from->scalars && !from->colors && !from->labels)
        return CW_OK;
    if (!alloc_carried(from, to))
        return cw_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu vertices", to->vertex_count);
    cw_status st = build_tree(&c, err);
    if (st == CW_OK)
        st = cwi_each_layer((to->vertex_count + CHUNK - 1) / CHUNK, CHUNK * 64, threads,
                            &silent, "carrying", carry_chunk, &c, err);
    cwi_boxes_free(&c.tree);
    return st;
}
