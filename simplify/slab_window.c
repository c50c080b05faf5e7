/* Simplifies a surface across slabs in a sliding window: joins the rest with the next slab, and
 * hands out finished triangles. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "simplify/blocks/partition.h"
#include "simplify/slab_simplifier.h"

#include <math.h>
#include <string.h>

static const uint32_t NONE = UINT32_MAX;

void cwi_window_free(cwi_slab_window *w)
{
    cw_mesh_free(&w->input);
    cwi_block_free(&w->rest);
    cwi_free(w->above);
    cwi_free(w->placed);
    cwi_free(w->rank);
    cwi_free(w->finished);
    cwi_free(w->points);
    cwi_free(w->corners);
    *w = (cwi_slab_window){0};
}

static double height_along(const float along[3], const float x[3])
{
    return (double)(x[0] * along[0] + x[1] * along[1] + x[2] * along[2]);
}

static double vertex_height(const cwi_mesh_block *b, size_t vertex)
{
    return height_along(b->along, b->points + 3 * vertex);
}

/* --- the input near the window ------------------------------------------------------------ */

/* A slab's input and what is kept of the one before: the slab's vertices come first. */
typedef struct merger {
    const cwi_slab_block *slab;
    cw_mesh *old, mesh;
    uint32_t *number; /* of the old vertices among the new; NONE: they go */
    uint32_t *next;   /* the old lists */
    uint8_t *tighten_level;
    uint8_t *is_needed; /* old vertices */
} merger;

/* Points that the rest's triangles list, and all that may be near them. */
static void mark_needed_vertices(const cwi_slab_window *w, merger *m, double lowest)
{
    const cw_mesh *old = m->old;
    const float *along = m->slab->block.along;
    for (size_t t = 0; t < w->rest.triangles; t++)
        for (uint32_t v = w->rest.nearest_points[t]; v != NONE; v = m->next[v])
            m->is_needed[v] = 1;
    for (size_t v = 0; v < old->vertex_count; v++)
        if (height_along(along, old->positions + 3 * v) >= lowest)
            m->is_needed[v] = 1;
}

/* Triangles with a vertex that is wanted, and their vertices: none reaches farther down than by
 * the longest edge. */
static void number_old(merger *m, const cwi_slab_window *w)
{
    cw_mesh *old = m->old, *mesh = &m->mesh;
    memset(m->number, 0xff, old->vertex_count * sizeof *m->number);
    for (size_t r = 0; r < w->ranks && r < m->slab->ranks[1]; r++)
        if (w->above[r] != NONE)
            m->number[w->above[r]] = m->slab->below[r];
    mesh->vertex_count = m->slab->vertices;
    mesh->triangle_count = m->slab->block.triangles;
    for (size_t t = 0; t < old->triangle_count; t++) {
        const uint32_t *c = old->triangles + 3 * t;
        if (!m->is_needed[c[0]] && !m->is_needed[c[1]] && !m->is_needed[c[2]])
            continue;
        memmove(old->triangles + 3 * (mesh->triangle_count++ - m->slab->block.triangles), c,
                3 * sizeof *c);
        for (size_t k = 0; k < 3; k++) {
            uint32_t *n =
                m->number +
                old->triangles[3 * (mesh->triangle_count - 1 - m->slab->block.triangles) + k];
            if (*n == NONE)
                *n = (uint32_t)mesh->vertex_count++;
        }
    }
}

static cw_status fill_merged(merger *m, cw_error *err)
{
    const cwi_mesh_block *b = &m->slab->block;
    const size_t vertices = m->mesh.vertex_count, triangles = m->mesh.triangle_count;
    cw_status st = cwi_mesh_alloc(&m->mesh, vertices, triangles, false, err);
    if (st != CW_OK)
        return st;
    memcpy(m->mesh.positions, b->points, 3 * b->vertices * sizeof *b->points);
    memcpy(m->mesh.triangles, b->corners, 3 * b->triangles * sizeof *b->corners);
    for (size_t v = 0; v < m->old->vertex_count; v++)
        if (m->number[v] != NONE)
            memcpy(m->mesh.positions + 3 * (size_t)m->number[v], m->old->positions + 3 * v,
                   3 * sizeof(float));
    for (size_t c = 3 * b->triangles; c < 3 * triangles; c++)
        m->mesh.triangles[c] = m->number[m->old->triangles[c - 3 * b->triangles]];
    return CW_OK;
}

/* Restores lists and tighten levels of the rest in the new numbers. */
static void restore_window(cwi_slab_window *w, cwi_passes *p, const merger *m)
{
    for (size_t v = 0; v < m->old->vertex_count; v++)
        if (m->number[v] != NONE)
            p->tighten_level[m->number[v]] = m->tighten_level[v];
    for (size_t t = 0; t < w->rest.triangles; t++) {
        uint32_t v = w->rest.nearest_points[t], *link = w->rest.nearest_points + t;
        for (; v != NONE; v = m->next[v]) {
            *link = m->number[v];
            link = p->next + m->number[v];
        }
        *link = NONE;
    }
}

static cw_status merge_input(cwi_slab_window *w, cwi_passes *p, const cwi_slab_block *slab,
                             cw_error *err)
{
    merger m = {
        .slab = slab, .old = &w->input, .next = p->next, .tighten_level = p->tighten_level};
    p->next = NULL; /* ours now */
    p->tighten_level = NULL;
    m.number = cwi_alloc_array(w->input.vertex_count, sizeof *m.number);
    m.is_needed = cwi_alloc_zeroed(w->input.vertex_count, 1);
    cw_status st = m.number && m.is_needed ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK) {
        mark_needed_vertices(w, &m, w->end - 2 * p->error);
        number_old(&m, w);
        st = fill_merged(&m, err);
    }
    if (st == CW_OK)
        st = cwi_passes_remember(p, &m.mesh, err);
    if (st == CW_OK)
        restore_window(w, p, &m);
    if (st == CW_OK) {
        cw_mesh_free(&w->input);
        w->input = m.mesh;
    } else {
        cw_mesh_free(&m.mesh);
    }
    cwi_free(m.number);
    cwi_free(m.is_needed);
    cwi_free(m.next);
    cwi_free(m.tighten_level);
    return st;
}

/* --- the window --------------------------------------------------------------------------- */

/* Names under which the rest and the slab are joined: vertices of the slab have their numbers,
 * those of the rest the ones behind, but in the seam between them. */
typedef struct joiner {
    const cwi_slab_block *slab;
    size_t id_count;
    uint32_t *placed; /* names: where they are in the result, or NONE */
} joiner;

static bool is_above(const joiner *j, uint32_t id)
{
    return id < j->slab->vertices && j->slab->seam[id] == 2;
}

static void number_rest(cwi_slab_window *w, joiner *j)
{
    cwi_mesh_block *rest = &w->rest;
    for (size_t v = 0; v < rest->vertices; v++) {
        const uint32_t rank = w->rank[v],
                       seam = rank < j->slab->ranks[1] ? j->slab->below[rank] : NONE;
        rest->global_ids[v] = seam != NONE ? seam : (uint32_t)(j->slab->vertices + v);
        rest->locked[v] = seam != NONE || w->placed[v] != NONE;
        j->placed[rest->global_ids[v]] = w->placed[v];
    }
}

/* Held are now the seam above, and what the finished result begins at. */
static cw_status lock_vertices(const joiner *j, cwi_mesh_block *b, cw_error *err)
{
    b->locked = cwi_alloc_array(b->vertices, 1);
    if (!b->locked)
        return cwi_fail_memory(err);
    for (size_t v = 0; v < b->vertices; v++) {
        b->locked[v] = j->placed[b->global_ids[v]] != NONE || is_above(j, b->global_ids[v]);
    }
    return CW_OK;
}

static cw_status open_window(cwi_slab_window *w, cwi_slab_block *slab, joiner *j,
                             cwi_mesh_block *whole, cw_error *err)
{
    cwi_mesh_block both[2] = {w->rest, slab->block};
    j->slab = slab;
    j->id_count = slab->vertices + w->rest.vertices;
    j->placed = cwi_alloc_array(j->id_count, sizeof *j->placed);
    both[1].locked = cwi_alloc_array(both[1].vertices, 1);
    cw_status st = j->placed && both[1].locked ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK) {
        memset(j->placed, 0xff, j->id_count * sizeof *j->placed);
        number_rest(w, j);
        for (size_t v = 0; v < both[1].vertices; v++)
            both[1].locked[v] = slab->seam[both[1].global_ids[v]];
        st = cwi_blocks_join(w->rest.nearest_points ? both : both + 1,
                             w->rest.nearest_points ? 2 : 1, j->id_count, whole, err);
    }
    cwi_free(both[1].locked);
    if (st == CW_OK)
        st = lock_vertices(j, whole, err);
    if (st == CW_OK)
        st = cwi_block_obstruct(whole, w->finished, w->finished_count, err);
    return st;
}

/* --- what is finished --------------------------------------------------------------------- */

static cw_status reserve_output(cwi_slab_window *w, size_t vertices, size_t triangles,
                                cw_error *err)
{
    if (w->vertices + vertices > w->vertex_capacity) {
        const size_t capacity = (w->vertices + vertices) * 5 / 4;
        float *points = cwi_realloc_array(w->points, 3 * capacity, sizeof *points);
        if (!points)
            return cwi_fail_memory(err);
        w->points = points;
        w->vertex_capacity = capacity;
    }
    if (w->triangles + triangles > w->triangle_capacity) {
        const size_t capacity = (w->triangles + triangles) * 5 / 4;
        uint32_t *corners = cwi_realloc_array(w->corners, 3 * capacity, sizeof *corners);
        if (!corners)
            return cwi_fail_memory(err);
        w->corners = corners;
        w->triangle_capacity = capacity;
    }
    return CW_OK;
}

static void append_triangle(cwi_slab_window *w, const cwi_mesh_block *left, size_t t,
                            uint32_t *placed)
{
    for (size_t k = 0; k < 3; k++) {
        const size_t v = left->corners[3 * t + k];
        if (placed[v] == NONE) {
            placed[v] = (uint32_t)w->vertices;
            memcpy(w->points + 3 * w->vertices++, left->points + 3 * v, 3 * sizeof(float));
        }
        w->corners[3 * w->triangles + k] = placed[v];
    }
    w->triangles++;
}

static bool is_rest(const cwi_slab_window *w, const cwi_mesh_block *left, size_t t)
{
    const uint32_t *c = left->corners + 3 * t;
    return vertex_height(left, c[0]) >= w->end && vertex_height(left, c[1]) >= w->end &&
           vertex_height(left, c[2]) >= w->end;
}

/* Of finished triangles, those that a later window may come near. */
static cw_status keep_near_triangles(cwi_slab_window *w, const cwi_mesh_block *left,
                                     double lowest, cw_error *err)
{
    size_t kept = 0;
    float *near = cwi_alloc_array(9 * (w->finished_count + left->triangles), sizeof *near);
    if (!near)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < w->finished_count + left->triangles; n++) {
        float *to = near + 9 * kept;
        const size_t t = n - w->finished_count;
        if (n >= w->finished_count && is_rest(w, left, t))
            continue;
        if (n < w->finished_count)
            memcpy(to, w->finished + 9 * n, 9 * sizeof *to);
        for (size_t k = 0; k < 3 && n >= w->finished_count; k++)
            memcpy(to + 3 * k, left->points + 3 * (size_t)left->corners[3 * t + k],
                   3 * sizeof *to);
        kept += height_along(left->along, to) >= lowest ||
                height_along(left->along, to + 3) >= lowest ||
                height_along(left->along, to + 6) >= lowest;
    }
    cwi_free(w->finished);
    w->finished = near;
    w->finished_count = kept;
    return CW_OK;
}

/* The rest of what is left: vertices of its triangles, and all of the seam above. */
static cw_status store_rest(cwi_slab_window *w, const joiner *j, const cwi_mesh_block *left,
                            const uint32_t *placed, uint32_t *number, cw_error *err)
{
    cwi_mesh_block rest = {0};
    memset(number, 0xff, left->vertices * sizeof *number);
    for (size_t t = 0; t < left->triangles; t++)
        for (size_t k = 0; k < 3 && is_rest(w, left, t); k++) {
            uint32_t *n = number + left->corners[3 * t + k];
            *n = *n == NONE ? (uint32_t)rest.vertices++ : *n;
            rest.triangles += k == 0;
        }
    for (size_t v = 0; v < left->vertices; v++)
        if (number[v] == NONE && is_above(j, left->global_ids[v]))
            number[v] = (uint32_t)rest.vertices++;
    rest.interior_count = rest.triangles;
    rest.points = cwi_alloc_array(3 * rest.vertices, sizeof *rest.points);
    rest.corners = cwi_alloc_array(3 * rest.triangles, sizeof *rest.corners);
    rest.global_ids = cwi_alloc_array(rest.vertices, sizeof *rest.global_ids);
    rest.locked = cwi_alloc_array(rest.vertices, 1);
    rest.open = cwi_alloc_array(rest.vertices, 1);
    rest.quadrics = cwi_alloc_array(rest.vertices, sizeof *rest.quadrics);
    rest.nearest_points = cwi_alloc_array(rest.triangles, sizeof *rest.nearest_points);
    cwi_block_free(&w->rest);
    cwi_free(w->placed);
    cwi_free(w->rank);
    w->rest = rest;
    w->placed = cwi_alloc_array(rest.vertices, sizeof *w->placed);
    w->rank = cwi_alloc_array(rest.vertices, sizeof *w->rank);
    if (!rest.points || !rest.corners || !rest.global_ids || !rest.locked || !rest.open ||
        !rest.quadrics || !rest.nearest_points || !w->placed || !w->rank)
        return cwi_fail_memory(err);
    for (size_t v = 0; v < left->vertices; v++) {
        const size_t n = number[v];
        if (number[v] == NONE)
            continue;
        memcpy(rest.points + 3 * n, left->points + 3 * v, 3 * sizeof *rest.points);
        rest.open[n] = left->open[v];
        rest.quadrics[n] = left->quadrics[v];
        w->placed[n] = placed[v];
        w->rank[n] =
            is_above(j, left->global_ids[v]) ? j->slab->rank[left->global_ids[v]] : NONE;
    }
    for (size_t t = 0, to = 0; t < left->triangles; t++) {
        if (!is_rest(w, left, t))
            continue;
        for (size_t k = 0; k < 3; k++)
            rest.corners[3 * to + k] = number[left->corners[3 * t + k]];
        rest.nearest_points[to++] = left->nearest_points[t];
    }
    return CW_OK;
}

/* Where the seam above has its vertices among the input's. */
static cw_status store_seam(cwi_slab_window *w, const cwi_slab_block *slab, cw_error *err)
{
    cwi_free(w->above);
    w->ranks = slab->ranks[2];
    w->above = cwi_alloc_array(w->ranks, sizeof *w->above);
    if (!w->above)
        return cwi_fail_memory(err);
    memset(w->above, 0xff, w->ranks * sizeof *w->above);
    for (size_t v = 0; v < slab->vertices; v++)
        if (slab->seam[v] == 2)
            w->above[slab->rank[v]] = (uint32_t)v;
    return CW_OK;
}

/* Gives the lower part to the result, and leaves the rest. */
static cw_status finish_lower_part(cwi_slab_window *w, const cwi_passes *p, const joiner *j,
                                   const cwi_mesh_block *left, cw_error *err)
{
    uint32_t *placed = cwi_alloc_array(left->vertices, sizeof *placed);
    uint32_t *number = cwi_alloc_array(left->vertices, sizeof *number);
    cw_status st = placed && number ? reserve_output(w, left->vertices, left->triangles, err)
                                    : cwi_fail_memory(err);
    for (size_t v = 0; v < left->vertices && st == CW_OK; v++)
        placed[v] = j->placed[left->global_ids[v]];
    for (size_t t = 0; t < left->triangles && st == CW_OK; t++)
        if (!is_rest(w, left, t))
            append_triangle(w, left, t, placed);
    if (st == CW_OK)
        st = keep_near_triangles(w, left, w->end - 3 * p->error - 2 * w->reach, err);
    if (st == CW_OK)
        st = store_rest(w, j, left, placed, number, err);
    cwi_free(placed);
    cwi_free(number);
    return st == CW_OK ? store_seam(w, j->slab, err) : st;
}

/* Halfway between the slab's lowest vertex and its upper plane. */
static double middle_of(const cwi_slab_block *slab)
{
    const cwi_mesh_block *b = &slab->block;
    double lowest = (double)b->to;
    for (size_t v = 0; v < b->vertices; v++)
        lowest = fmin(lowest, vertex_height(b, v));
    return slab->last ? INFINITY : 0.5 * (lowest + (double)b->to);
}

cw_status cwi_window_take(cwi_slab_window *w, cwi_passes *p, cwi_slab_block *slab,
                          cw_error *err)
{
    cwi_mesh_block *b = &slab->block, whole = {0}, left = {0};
    const double begin = w->rest.nearest_points ? w->end : -INFINITY, end = middle_of(slab);
    const float along[3] = {b->along[0], b->along[1], b->along[2]}, to = b->to;
    const size_t to_end = 0;
    joiner j = {0};
    cw_status st = merge_input(w, p, slab, err);
    if (st == CW_OK)
        st = cwi_passes_list(p, b, err);
    if (st == CW_OK)
        st = cwi_passes_blocks(p, b, 0, err);
    if (st == CW_OK)
        st = open_window(w, slab, &j, &whole, err);
    memcpy(whole.along, along, sizeof along);
    whole.from = (float)begin;
    whole.to = to;
    if (st == CW_OK)
        st = cwi_passes_whole(p, &whole, &to_end, 1, &left, err);
    memcpy(left.along, along, sizeof along);
    w->end = end;
    w->nonmanifold_count += left.nonmanifold_count;
    w->reach = fmax(w->reach, slab->longest);
    if (st == CW_OK)
        st = finish_lower_part(w, p, &j, &left, err);
    cwi_free(j.placed);
    cwi_block_free(&whole);
    cwi_block_free(&left);
    return st;
}
