/* Decides which cells to divide: those with parts of a surface that are too far from the
 * other. */
#include "core/geometry/polygon_clip.h"
#include "extract/level_set/adaptive_field.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "simplify/quality/mesh_within.h"

#include <math.h>
#include <string.h>

/* Parts of a mesh's triangles that are in one cell each: a mesh of triangles that share
 * nothing, and their cells. */
typedef struct pieces {
    cwi_adaptive *a;
    float *positions; /* from the origin of the mesh that cells are of */
    struct cell {
        uint32_t at[3];
        int size;
    } * cells;
    size_t count, capacity;
    bool out_of_memory;
} pieces;

/* ---- pieces ------------------------------------------------------------------------------ */

static bool ensure_capacity(pieces *p)
{
    if (p->count < p->capacity)
        return true;
    const size_t capacity = 2 * p->capacity + 1024;
    float *positions = cwi_realloc_array(p->positions, 9 * capacity, sizeof *positions);
    p->positions = positions ? positions : p->positions;
    struct cell *cells = cwi_realloc_array(p->cells, capacity, sizeof *cells);
    p->cells = cells ? cells : p->cells;
    if (!positions || !cells)
        return false;
    p->capacity = capacity;
    return true;
}

static void add_triangle(pieces *p, const cwi_polygon *g, int n, const struct cell *cell)
{
    const double *corners[3] = {g->p[0], g->p[n], g->p[n + 1]};
    if (!ensure_capacity(p)) {
        p->out_of_memory = true;
        return;
    }
    for (size_t c = 0; c < 3; c++) {
        double x[3];
        cwi_adaptive_to_mesh(p->a, corners[c], x);
        for (size_t k = 0; k < 3; k++)
            p->positions[9 * p->count + 3 * c + k] = (float)x[k];
    }
    p->cells[p->count++] = *cell;
}

/* Cuts the part of a polygon in a cell by the cells that it is divided into. In the smallest
 * cells, which are divided once more, nothing is left to do. */
static void cut_by_cell(pieces *p, const cwi_polygon *g, const struct cell *cell)
{
    if (g->count < 3)
        return;
    if (!cwi_adaptive_is_divided(p->a, cell->size, cell->at)) {
        for (int n = 1; n + 1 < g->count; n++)
            add_triangle(p, g, n, cell);
        return;
    }
    if (cell->size == CWI_DIVISIONS)
        return;
    const double side = ldexp(1, -cell->size - 1);
    for (uint32_t n = 0; n < 8; n++) {
        struct cell part = {.size = cell->size + 1};
        cwi_polygon parts[4];
        parts[0] = *g;
        for (int a = 0; a < 3; a++) {
            part.at[a] = 2 * cell->at[a] + (n >> a & 1);
            cwi_polygon_clip(&parts[a], a, (2 * cell->at[a] + 1) * side, n >> a & 1 ? -1 : 1,
                             &parts[a + 1]);
        }
        cut_by_cell(p, &parts[3], &part);
    }
}

/* Cuts a polygon along axis a, and then those before it, into parts between planes of
 * samples. */
static void cut_along(pieces *p, const cwi_polygon *g, int a, struct cell *cell)
{
    double low = INFINITY, high = -INFINITY;
    for (int n = 0; n < g->count; n++) {
        low = fmin(low, g->p[n][a]);
        high = fmax(high, g->p[n][a]);
    }
    for (double at = floor(low); at <= high; at++) {
        cwi_polygon above, slice;
        cwi_polygon_clip(g, a, at, -1, &above);
        cwi_polygon_clip(&above, a, at + 1, 1, &slice);
        cell->at[a] = (uint32_t)at;
        if (slice.count >= 3 && a > 0)
            cut_along(p, &slice, a - 1, cell);
        else
            cut_by_cell(p, &slice, cell);
    }
}

static void cut_triangle(pieces *p, const cw_mesh *m, size_t t)
{
    struct cell cell = {.size = 0};
    cwi_polygon g = {.count = 3};
    for (size_t c = 0; c < 3; c++)
        cwi_adaptive_from_mesh(p->a, m, m->triangles[3 * t + c], g.p[c]);
    cut_along(p, &g, 2, &cell);
}

/* ---- parts beyond the limit -------------------------------------------------------------- */

/* Finds the triangles that are beyond the limit; all are if the other mesh is empty.
 * beyond  1 for each triangle that is beyond; free it with cwi_free() */
static cw_status find_beyond(const cwi_adaptive *a, const cw_mesh *from, const cw_mesh *to,
                             double limit_mm, uint8_t **beyond, cw_error *err)
{
    *beyond = cwi_alloc_array(from->triangle_count, sizeof **beyond);
    if (!*beyond)
        return cwi_fail_memory(err);
    memset(*beyond, 1, from->triangle_count);
    if (!from->triangle_count || !to->triangle_count)
        return CW_OK;
    return cwi_mesh_within(from, to, limit_mm, NULL, a->desc->threads, &a->desc->progress,
                           *beyond, err);
}

/* Cuts the triangles of a mesh that are beyond into pieces. */
static cw_status find_pieces(pieces *p, const cw_mesh *from, const cw_mesh *to, double limit_mm,
                             cwi_beyond *found, cw_error *err)
{
    uint8_t *beyond = NULL;
    cw_status st = find_beyond(p->a, from, to, limit_mm, &beyond, err);
    for (size_t t = 0; t < from->triangle_count && st == CW_OK; t++) {
        found->any |= beyond[t];
        if (beyond[t])
            cut_triangle(p, from, t);
    }
    cwi_free(beyond);
    return st == CW_OK && p->out_of_memory ? cwi_fail_memory(err) : st;
}

/* Divides the cells of the pieces that are beyond. */
static cw_status divide_cells(const pieces *p, const uint8_t *beyond, cwi_beyond *found,
                              cw_error *err)
{
    for (size_t n = 0; n < p->count; n++) {
        const struct cell *c = &p->cells[n];
        if (!beyond[n] || cwi_adaptive_is_divided(p->a, c->size, c->at))
            continue;
        if (!cwi_adaptive_put(p->a, c->size, c->at))
            return cwi_fail_memory(err);
        found->divided++;
    }
    return CW_OK;
}

static cw_status divide_far_cells(pieces *p, const cw_mesh *to, double limit_mm,
                                  cwi_beyond *found, cw_error *err)
{
    uint8_t *beyond = NULL;
    uint32_t *triangles = cwi_alloc_array(3 * p->count, sizeof *triangles);
    cw_mesh m = {.vertex_count = 3 * p->count,
                 .triangle_count = p->count,
                 .positions = p->positions,
                 .triangles = triangles};
    memcpy(m.origin, p->a->mesh->origin, sizeof m.origin);
    for (size_t n = 0; n < m.vertex_count && triangles; n++)
        triangles[n] = (uint32_t)n;
    cw_status st = triangles ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK)
        st = find_beyond(p->a, &m, to, limit_mm, &beyond, err);
    if (st == CW_OK)
        st = divide_cells(p, beyond, found, err);
    cwi_free(triangles);
    cwi_free(beyond);
    return st;
}

static void free_pieces(pieces *p)
{
    cwi_free(p->positions);
    cwi_free(p->cells);
}

/* Divides cells at both meshes. All pieces are cut before cells are divided for any. */
cw_status cwi_adaptive_divide(cwi_adaptive *a, const cw_mesh *surface, double limit_mm,
                              bool both_ways, cwi_beyond *beyond, cw_error *err)
{
    pieces lost = {.a = a}, astray = {.a = a};
    *beyond = (cwi_beyond){0};
    cw_status st =
        both_ways ? find_pieces(&lost, a->mesh, surface, limit_mm, beyond, err) : CW_OK;
    if (st == CW_OK)
        st = find_pieces(&astray, surface, a->mesh, limit_mm, beyond, err);
    if (st == CW_OK)
        st = divide_far_cells(&lost, surface, limit_mm, beyond, err);
    if (st == CW_OK)
        st = divide_far_cells(&astray, a->mesh, limit_mm, beyond, err);
    free_pieces(&lost);
    free_pieces(&astray);
    return st;
}
