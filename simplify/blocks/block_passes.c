/* Simplifies a surface in passes over blocks, on threads, and repeats parts with higher tighten levels
 * where they did not keep the distance. */
#include "simplify/blocks/block_passes.h"

#include "core/base/memory.h"
#include "core/base/module.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_triangle.h"
#include "simplify/blocks/distance_proof.h"
#include "simplify/blocks/find_folds.h"
#include "simplify/blocks/partition.h"
#include "simplify/blocks/proof_record.h"

#include <math.h>
#include <string.h>

/* The share of the error that is kept: others may measure it by bounds that are wider. */
static const double TIGHTER = 0.95;

/* --- what passes share ------------------------------------------------------------------- */

static cw_status check_limits(const cw_simplify_desc *d, cw_error *err)
{
    if (!(d->error_mm >= 0) || !isfinite(d->error_mm))
        return cwi_fail(err, CW_ERR_ARGUMENT, "error_mm is %g; it must be 0 or more",
                        d->error_mm);
    if (!(d->normal_deg >= 0) || !(d->normal_deg <= 180))
        return cwi_fail(err, CW_ERR_ARGUMENT, "normal_deg is %g; it must be 0 to 180",
                        d->normal_deg);
    if (!(d->ratio >= 0) || !(d->ratio < 1))
        return cwi_fail(err, CW_ERR_ARGUMENT, "ratio is %g; it must be at least 0 and below 1",
                        d->ratio);
    return CW_OK;
}

cw_status cwi_passes_init(cwi_passes *p, const cw_simplify_desc *desc, cw_error *err)
{
    const void *module;
    *p = (cwi_passes){.desc = desc,
                      .error = desc->error_mm,
                      .block_desc = {.error = TIGHTER * desc->error_mm,
                                     .allow_crossings = desc->allow_crossings,
                                     .keep_border = desc->keep_border,
                                     .progress = &p->poll}};
    cwi_stop_init(&p->stop, &desc->progress);
    p->poll = cwi_stop_progress(&p->stop);
    cw_status st = check_limits(desc, err);
    if (st == CW_OK)
        st = cwi_module_load("openmesh", &module, err);
    if (st == CW_OK)
        p->openmesh = module;
    return st == CW_OK ? cwi_views_init(&p->views, desc, err) : st;
}

void cwi_passes_place(cwi_passes *p, const double origin[3], double scale)
{
    cwi_views_place(&p->views, origin, scale);
    p->error *= scale;
    p->block_desc.error *= scale;
}

static void free_input_lists(cwi_passes *p)
{
    cwi_free(p->first);
    cwi_free(p->around);
    cwi_free(p->across);
    cwi_free(p->next);
    cwi_free(p->tighten_level);
    cwi_free(p->folded);
    cwi_free(p->allowed);
    cwi_free(p->normals);
    cwi_free(p->saved_next);
    cwi_proof_record_free(&p->record);
    p->first = p->around = p->across = p->next = p->saved_next = NULL;
    p->tighten_level = p->folded = NULL;
    p->allowed = NULL;
    p->normals = NULL;
    p->original = (cwi_original){0};
}

void cwi_passes_free(cwi_passes *p)
{
    free_input_lists(p);
    cwi_views_free(&p->views);
}

/* Normals of what a view sees, from the triangles around; the others stay 0. */
static void add_normals(cwi_passes *p, const uint8_t *seen)
{
    const cw_mesh *m = &p->input;
    for (size_t t = 0; t < m->triangle_count; t++) {
        const uint32_t *c = m->triangles + 3 * t;
        const float *a = m->positions + 3 * (size_t)c[0], *b = m->positions + 3 * (size_t)c[1],
                    *d = m->positions + 3 * (size_t)c[2];
        const float u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]},
                    w[3] = {d[0] - a[0], d[1] - a[1], d[2] - a[2]},
                    n[3] = {u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2],
                            u[0] * w[1] - u[1] * w[0]};
        for (size_t k = 0; k < 3; k++)
            for (size_t i = 0; i < 3 && seen[c[k]]; i++)
                p->normals[3 * (size_t)c[k] + i] += n[i];
    }
    for (size_t v = 0; v < m->vertex_count; v++) {
        float *n = p->normals + 3 * v;
        const double length = sqrt((double)n[0] * (double)n[0] + (double)n[1] * (double)n[1] +
                                   (double)n[2] * (double)n[2]);
        for (size_t i = 0; i < 3 && length > 0; i++)
            n[i] = (float)((double)n[i] / length);
    }
}

static cw_status find_normals(cwi_passes *p, cw_error *err)
{
    const cw_mesh *m = &p->input;
    if (!p->views.count || p->desc->normal_deg == 0)
        return CW_OK;
    uint8_t *seen = cwi_alloc_zeroed(m->vertex_count, 1);
    p->normals = cwi_alloc_zeroed(3 * m->vertex_count, sizeof *p->normals);
    const bool ok = seen && p->normals;
    for (size_t t = 0; t < m->triangle_count && ok; t++)
        if (isfinite(cwi_views_limit(&p->views, m, t, p->error, p->error)))
            for (size_t k = 0; k < 3; k++)
                seen[m->triangles[3 * t + k]] = 1;
    if (ok)
        add_normals(p, seen);
    cwi_free(seen);
    return ok ? CW_OK : cwi_fail_memory(err);
}

/* At a point, what is allowed on all triangles around it. What is simplified may come into view
 * on its way: so views are wider here by as much as that is. */
static cw_status allow_distances(cwi_passes *p, cw_error *err)
{
    const cw_mesh *m = &p->input;
    if (!p->views.count)
        return CW_OK;
    p->allowed = cwi_alloc_array(m->vertex_count, sizeof *p->allowed);
    if (!p->allowed)
        return cwi_fail_memory(err);
    for (size_t v = 0; v < m->vertex_count; v++)
        p->allowed[v] = (float)p->block_desc.error;
    for (size_t t = 0; t < m->triangle_count; t++) {
        const float here =
            (float)(TIGHTER * cwi_views_limit(&p->views, m, t, p->error, p->error));
        for (size_t k = 0; k < 3; k++) {
            float *at = p->allowed + m->triangles[3 * t + k];
            *at = fminf(*at, here);
        }
    }
    return CW_OK;
}

static void find_opposite_corners(cwi_passes *p)
{
    for (size_t v = 0; v < p->input.vertex_count; v++)
        for (size_t n = p->first[v]; n < p->first[v + 1]; n++) {
            const uint32_t *c = p->input.triangles + 3 * (size_t)p->around[n];
            const size_t at = c[0] == v ? 0 : c[1] == v ? 1 : 2;
            p->across[2 * n] = c[(at + 1) % 3];
            p->across[2 * n + 1] = c[(at + 2) % 3];
        }
}

cw_status cwi_passes_remember(cwi_passes *p, const cw_mesh *input, cw_error *err)
{
    const size_t vertices = input->vertex_count;
    free_input_lists(p);
    p->input = *input;
    p->first = cwi_alloc_array(vertices + 2, sizeof *p->first);
    p->around = cwi_alloc_array(3 * input->triangle_count, sizeof *p->around);
    p->across = cwi_alloc_array(6 * input->triangle_count, sizeof *p->across);
    p->next = cwi_alloc_array(vertices, sizeof *p->next);
    p->tighten_level = cwi_alloc_zeroed(vertices, sizeof *p->tighten_level);
    p->folded = cwi_alloc_zeroed(vertices, sizeof *p->folded);
    p->saved_next = cwi_alloc_array(vertices, sizeof *p->saved_next);
    if (!p->first || !p->around || !p->across || !p->next || !p->tighten_level || !p->folded ||
        !p->saved_next)
        return cwi_fail_memory(err);
    cwi_fans_sort(input->triangles, input->triangle_count, vertices, p->first, p->around);
    find_opposite_corners(p);
    for (size_t v = 0; v < vertices; v++)
        p->next[v] = (uint32_t)v; /* in no list */
    cwi_passes_find_folds(p);
    p->original =
        (cwi_original){.vertices = vertices,
                       .fans = {input->positions, input->triangles, p->first, p->around},
                       .across = p->across,
                       .next = p->next,
                       .tighten_level = p->tighten_level,
                       .folded = p->folded};
    cw_status st = allow_distances(p, err);
    if (st == CW_OK)
        st = find_normals(p, err);
    p->original.allowed = p->allowed;
    p->original.normals = p->normals;
    p->original.min_normal_cosine = (float)cos(p->desc->normal_deg * CWI_PI / 180);
    return st;
}

cw_status cwi_passes_list(cwi_passes *p, cwi_mesh_block *b, cw_error *err)
{
    b->nearest_points = cwi_alloc_array(b->triangles, sizeof *b->nearest_points);
    if (!b->nearest_points)
        return cwi_fail_memory(err);
    memset(b->nearest_points, 0xff, b->triangles * sizeof *b->nearest_points);
    for (size_t c = 0; c < 3 * b->triangles; c++) {
        const uint32_t point = b->corners[c];
        if (p->next[point] != point)
            continue;
        p->next[point] = b->nearest_points[c / 3];
        b->nearest_points[c / 3] = point;
    }
    return CW_OK;
}

static const cwi_original *original_of(const cwi_passes *p)
{
    return p->next ? &p->original : NULL;
}

/* --- keeping the error -------------------------------------------------------------------- */

/* Runs down to each of the targets in turn, while costs are at most so large. */
static cw_status collapse_to_targets(const cwi_passes *p, const cwi_mesh_block *whole,
                                     float cost, const size_t *targets, size_t levels,
                                     cwi_mesh_block *left, cw_error *err)
{
    cwi_decimater *d;
    cw_status st = p->openmesh->open(whole, &p->block_desc, original_of(p), &d, err);
    if (st != CW_OK)
        return st;
    for (size_t n = 0; n < levels && st == CW_OK; n++) {
        st = p->openmesh->run(d, cost, targets[n], err);
        if (st == CW_OK)
            st = p->openmesh->take(d, left + n, err);
    }
    p->openmesh->close(d);
    return st;
}

static cw_status collapse_within_cost(const cwi_passes *p, const cwi_block_part *x, float cost,
                                      cw_error *err)
{
    return collapse_to_targets(p, x->from, cost, &x->target, 1, x->left, err);
}

/* Lists of the pass become what they were before. */
static void restore_point_lists(const cwi_passes *p, const cwi_mesh_block *left)
{
    for (size_t t = 0; t < left->interior_count; t++)
        for (uint32_t v = left->nearest_points[t], next; v != UINT32_MAX; v = next) {
            next = p->next[v];
            p->next[v] = p->saved_next[v];
        }
}

enum { MARK = 0x80 };

/* Marks the vertices of the part of the input that is too far from the result. Those held for
 * other parts are these parts' business. */
static size_t mark_input(const cwi_passes *p, const cwi_block_part *x, const uint8_t *beyond)
{
    const uint8_t *locked = x->global_ids ? x->from->locked : NULL;
    size_t broken = 0;
    for (size_t t = 0; t < x->input.triangle_count; t++) {
        const uint32_t *c = x->input.triangles + 3 * t;
        broken += beyond[t];
        for (size_t k = 0; k < 3 && beyond[t]; k++)
            if (!locked || !locked[c[k]])
                p->tighten_level[x->global_ids ? x->global_ids[c[k]] : c[k]] |= MARK;
    }
    return broken;
}

/* Marks the points listed around the triangles of the result that are too far from
 * the input. */
static size_t mark_result(const cwi_passes *p, const cwi_block_part *x, const uint8_t *beyond,
                          uint8_t *near)
{
    const cwi_mesh_block *left = x->left;
    size_t broken = 0;
    for (size_t t = 0; t < left->interior_count; t++) {
        broken += beyond[t];
        for (size_t k = 0; k < 3 && beyond[t]; k++)
            near[left->corners[3 * t + k]] = 1;
    }
    for (size_t t = 0; t < left->interior_count && broken; t++) {
        const uint32_t *c = left->corners + 3 * t;
        if (near[c[0]] || near[c[1]] || near[c[2]])
            for (uint32_t v = left->nearest_points[t]; v != UINT32_MAX; v = p->next[v])
                p->tighten_level[v] |= MARK;
    }
    return broken;
}

/* Raises the tighten level of the marked points of the part; returns false when all had the maximum. */
static bool raise_tighten_levels(const cwi_passes *p, const cwi_block_part *x)
{
    bool more = false;
    for (size_t t = 0; t < x->left->interior_count; t++)
        for (uint32_t v = x->left->nearest_points[t]; v != UINT32_MAX; v = p->next[v])
            if (p->tighten_level[v] & MARK) {
                p->tighten_level[v] &= (uint8_t)~MARK;
                if (p->tighten_level[v] < CWI_MAX_TIGHTEN_LEVEL) {
                    p->tighten_level[v]++;
                    more = true;
                }
            }
    for (size_t v = 0; v < p->input.vertex_count && !x->global_ids; v++)
        p->tighten_level[v] &= (uint8_t)~MARK; /* listed elsewhere */
    return more;
}

/* Checks whether the result keeps the distance; where it does not, raises tighten levels for the
 * next time. */
static cw_status check_part_distance(const cwi_passes *p, const cwi_block_part *x,
                                     cwi_near_facets *near_facets, bool *kept,
                                     bool *can_tighten, cw_error *err)
{
    uint8_t *input_beyond = cwi_alloc_array(x->input.triangle_count, 1);
    uint8_t *beyond = cwi_alloc_array(x->left->interior_count, 1);
    uint8_t *near = cwi_alloc_zeroed(x->left->vertices, 1);
    cw_status st = input_beyond && beyond && near
                       ? cwi_block_part_prove(p, x, input_beyond, beyond, near_facets, err)
                       : cwi_fail_memory(err);
    if (st == CW_OK) {
        const size_t broken = mark_input(p, x, input_beyond) + mark_result(p, x, beyond, near);
        *kept = broken == 0;
        *can_tighten = *kept || raise_tighten_levels(p, x);
    }
    cwi_free(input_beyond);
    cwi_free(beyond);
    cwi_free(near);
    return st;
}

static cw_status collapse_part(const cwi_passes *p, const cwi_block_part *x, cw_error *err)
{
    return collapse_within_cost(p, x, x->cost, err);
}

/* Makes what is left of a part from where it began. */
typedef cw_status collapse_function(const cwi_passes *p, const cwi_block_part *x,
                                    cw_error *err);

/* Collapses look at what is near them only. Where that was not enough the part is done again
 * with higher tighten levels; when that does not help, it stays as it was. */
static cw_status enforce_part_distance(const cwi_passes *p, const cwi_block_part *x,
                                       collapse_function *collapse,
                                       cwi_near_facets *near_facets, size_t *repeats,
                                       cw_error *err)
{
    cw_status st = CW_OK;
    for (bool kept = x->left->interior_count == 0, can_tighten = true; st == CW_OK && !kept;) {
        st = check_part_distance(p, x, near_facets, &kept, &can_tighten, err);
        if (st != CW_OK || kept)
            break;
        restore_point_lists(p, x->left);
        cwi_block_free(x->left);
        st = can_tighten ? collapse(p, x, err) : collapse_within_cost(p, x, -1, err);
        if (near_facets)
            cwi_near_facets_clear(near_facets, x->input.triangle_count);
        kept = !can_tighten;
        ++*repeats;
    }
    return st;
}

/* --- passes over blocks ------------------------------------------------------------------- */

typedef struct block_batch {
    const cwi_passes *passes;
    cwi_proof_record *record; /* NULL: none is kept */
    bool proves;              /* whether each block is held against its part of the input */
    cwi_mesh_block *blocks, *left;
    cwi_decimater **decimaters;
    cw_status *statuses;
    cw_error *errors;
    size_t *repeats;
    size_t count, target;
    float cost;
} block_batch;

static void open_block(void *context, size_t n)
{
    block_batch *c = context;
    const cwi_passes *p = c->passes;
    c->statuses[n] = p->openmesh->open(c->blocks + n, &p->block_desc, original_of(p),
                                       c->decimaters + n, c->errors + n);
    if (!p->next)
        cwi_block_free(c->blocks + n);
}

static void collapse_block(void *context, size_t n)
{
    block_batch *c = context;
    c->statuses[n] = c->passes->openmesh->run(c->decimaters[n], c->cost, 0, c->errors + n);
}

static void copy_out_block(void *context, size_t n)
{
    block_batch *c = context;
    const cwi_openmesh_functions *openmesh = c->passes->openmesh;
    c->statuses[n] = openmesh->take(c->decimaters[n], c->left + n, c->errors + n);
    openmesh->close(c->decimaters[n]);
    c->decimaters[n] = NULL;
}

/* Without a number of triangles to meet a block knows by itself how far to go. */
static void enforce_block_distance(void *context, size_t n)
{
    block_batch *c = context;
    const cwi_passes *p = c->passes;
    cw_error *err = c->errors + n;
    const cwi_block_part x = {.from = c->blocks + n,
                              .input = cwi_block_view(c->blocks + n),
                              .global_ids = c->blocks[n].global_ids,
                              .left = c->left + n,
                              .cost = c->cost,
                              .threads = 1};
    cw_status st = c->target ? CW_OK : collapse_part(p, &x, err);
    cwi_near_facets *near = NULL;
    if (st == CW_OK && c->record) {
        near = cwi_alloc_zeroed(x.input.triangle_count, sizeof *near);
        st = near ? CW_OK : cwi_fail_memory(err);
    }
    if (st == CW_OK && c->proves)
        st = enforce_part_distance(p, &x, collapse_part, near, c->repeats + n, err);
    if (st == CW_OK && c->record)
        cwi_proof_record_take(c->record, p, &x, near, n);
    cwi_free(near);
    c->statuses[n] = st;
    cwi_block_free(c->blocks + n);
}

/* Runs work for all blocks on threads, and reports the error of the first block that failed. */
static cw_status for_each_block(block_batch *c, void (*work)(void *context, size_t n),
                                cw_error *err)
{
    const cwi_passes *p = c->passes;
    cw_status st = cwi_parallel_for(c->count, CWI_BLOCK, p->desc->threads, &p->poll,
                                    "simplifying", work, c, err);
    for (size_t n = 0; n < c->count && st == CW_OK; n++)
        if (c->statuses[n] != CW_OK)
            return cwi_fail(err, c->statuses[n], "%s", c->errors[n].message);
    return st;
}

static size_t count_left(const block_batch *c, float *next)
{
    const cwi_openmesh_functions *openmesh = c->passes->openmesh;
    size_t left = 0;
    *next = INFINITY;
    for (size_t n = 0; n < c->count; n++) {
        left += openmesh->triangles(c->decimaters[n]);
        *next = fminf(*next, openmesh->next(c->decimaters[n]));
    }
    return left;
}

/* Runs all blocks to the same cost: the limit rises step by step until few enough triangles are
 * left. Errors of size^4 on areas of size^2 make it rise by the cube of what the number falls
 * by; a step takes half of that way. */
static cw_status collapse_to_target(block_batch *c, cw_error *err)
{
    cw_status st = for_each_block(c, open_block, err);
    float next;
    c->cost = 0;
    for (size_t left;
         st == CW_OK && (left = count_left(c, &next)) > c->target && next < INFINITY;) {
        const float more = (float)left / (float)c->target, step = more * sqrtf(more);
        c->cost = fmaxf(c->cost, next) * fminf(fmaxf(step, 1.1f), 8);
        st = for_each_block(c, collapse_block, err);
    }
    return st == CW_OK ? for_each_block(c, copy_out_block, err) : st;
}

/* Counts the vertices of a block that are not held, but whose corners differ in the texture. */
static cw_status count_textured_seams(const cwi_mesh_block *b, size_t *count, cw_error *err)
{
    const float **first = b->texture ? cwi_alloc_zeroed(b->vertices, sizeof *first) : NULL;
    uint8_t *differs = b->texture ? cwi_alloc_zeroed(b->vertices, 1) : NULL;
    cw_status st = !b->texture || (first && differs) ? CW_OK : cwi_fail_memory(err);
    for (size_t c = 0; c < 3 * b->interior_count && b->texture && st == CW_OK; c++) {
        const size_t v = b->corners[c];
        const float *uv = b->texture + 2 * c;
        if (!first[v])
            first[v] = uv;
        if (!differs[v] && !b->locked[v] && (uv[0] != first[v][0] || uv[1] != first[v][1]))
            ++*count, differs[v] = 1;
    }
    cwi_free(first);
    cwi_free(differs);
    return st;
}

/* Seams between blocks, and those of a texture, stay as fine as they were: that many triangles more than
 * the target are left to the second pass. */
static cw_status find_first_target(block_batch *c, size_t target, cw_error *err)
{
    size_t held = 0;
    cw_status st = CW_OK;
    for (size_t n = 0; n < c->count && target && st == CW_OK; n++) {
        for (size_t v = 0; v < c->blocks[n].vertices; v++)
            held += c->blocks[n].locked[v];
        st = count_textured_seams(c->blocks + n, &held, err);
    }
    c->target = target ? target + 3 * held / 2 : 0;
    return st;
}

static cw_status simplify_batch(block_batch *c, cw_error *err)
{
    c->left = cwi_alloc_zeroed(c->count, sizeof *c->left);
    c->decimaters = cwi_alloc_zeroed(c->count, sizeof(cwi_decimater *));
    c->statuses = cwi_alloc_zeroed(c->count, sizeof *c->statuses);
    c->errors = cwi_alloc_zeroed(c->count, sizeof *c->errors);
    c->repeats = cwi_alloc_zeroed(c->count, sizeof *c->repeats);
    if (!c->left || !c->decimaters || !c->statuses || !c->errors || !c->repeats)
        return cwi_fail_memory(err);
    c->cost = INFINITY;
    cw_status st = c->target ? collapse_to_target(c, err) : CW_OK;
    return st == CW_OK && c->passes->next ? for_each_block(c, enforce_block_distance, err) : st;
}

static void free_batch(block_batch *c)
{
    for (size_t n = 0; n < c->count; n++) {
        cwi_block_free(c->blocks + n);
        if (c->left)
            cwi_block_free(c->left + n);
        if (c->decimaters && c->decimaters[n])
            c->passes->openmesh->close(c->decimaters[n]);
    }
    cwi_free(c->blocks);
    cwi_free(c->left);
    cwi_free(c->decimaters);
    cwi_free(c->statuses);
    cwi_free(c->errors);
    cwi_free(c->repeats);
}

static void save_point_lists(const cwi_passes *p)
{
    if (p->next)
        memcpy(p->saved_next, p->next, p->input.vertex_count * sizeof *p->saved_next);
}

/* Borders that were known before the pass are so still. */
static void keep_known_borders(const uint8_t *seam, cwi_mesh_block *left)
{
    for (size_t v = 0; v < left->vertices && seam; v++)
        left->seam[v] &= seam[left->global_ids[v]];
}

/* Cuts, runs and joins. If *out is *whole, that is freed once it is cut. */
static cw_status simplify_in_blocks(const cwi_passes *p, cwi_mesh_block *whole, size_t target,
                                    double cut_fraction, bool proves, cwi_proof_record *record,
                                    cwi_mesh_block *out, size_t *repeats, cw_error *err)
{
    const size_t id_count = whole->vertices;
    block_batch c = {.passes = p, .record = record, .proves = proves};
    size_t max_repeats = 0;
    cw_status st = cwi_blocks_cut(whole, CWI_BLOCK, cut_fraction, &c.blocks, &c.count, err);
    if (st != CW_OK)
        return st;
    st = find_first_target(&c, target, err);
    if (st == CW_OK && record)
        st = cwi_proof_record_init(record, p, c.count, err);
    uint8_t *seam = whole->seam;
    if (out == whole) {
        whole->seam = NULL;
        cwi_block_free(whole);
    }
    if (st == CW_OK)
        st = simplify_batch(&c, err);
    for (size_t n = 0; n < c.count && st == CW_OK; n++)
        max_repeats = c.repeats[n] > max_repeats ? c.repeats[n] : max_repeats;
    for (size_t n = 0; n < c.count && st == CW_OK && record; n++)
        record->first_facet[n + 1] = record->first_facet[n] + c.left[n].triangles;
    *repeats += max_repeats;
    if (st == CW_OK)
        st = cwi_blocks_join(c.left, c.count, id_count, out, err);
    if (st == CW_OK)
        keep_known_borders(seam, out);
    if (st == CW_OK && target) { /* costs ended it: all edges are to be tried again */
        cwi_free(out->open);
        out->open = NULL;
    }
    if (out == whole)
        cwi_free(seam);
    free_batch(&c);
    return st;
}

/* Puts the cuts of a second pass where the first had none. */
static const double SECOND_CUT_FRACTION = 7.0 / 16;

cw_status cwi_passes_blocks(cwi_passes *p, cwi_mesh_block *whole, size_t target, cw_error *err)
{
    save_point_lists(p);
    return simplify_in_blocks(p, whole, target, 0.5, true,
                              p->next && p->keeps_record ? &p->record : NULL, whole,
                              &p->repeats, err);
}

cw_status cwi_passes_seams(cwi_passes *p, cwi_mesh_block *whole, size_t target, cw_error *err)
{
    if (p->next || whole->triangles <= CWI_BLOCK || whole->triangles <= target + target / 4)
        return CW_OK;
    cwi_block_number(whole);
    return simplify_in_blocks(p, whole, target, SECOND_CUT_FRACTION, false, NULL, whole,
                              &p->repeats, err);
}

/* --- the last pass ------------------------------------------------------------------------ */

/* Whether blocks that are cut elsewhere pay. */
static bool has_seams(const cwi_mesh_block *whole)
{
    return whole->open && whole->interior_count > CWI_BLOCK;
}

/* Holds vertices of a block that was joined of its parts, and puts what was in their way there. */
static cw_status restore_limits(const cwi_mesh_block *whole, cwi_mesh_block *joined,
                                cw_error *err)
{
    const size_t more = whole->triangles - whole->interior_count;
    float *points = cwi_alloc_array(9 * more, sizeof *points);
    joined->locked = cwi_alloc_zeroed(joined->vertices, sizeof *joined->locked);
    cw_status st = points && joined->locked ? CW_OK : cwi_fail_memory(err);
    for (size_t c = 0; c < 3 * more && st == CW_OK; c++)
        memcpy(points + 3 * c,
               whole->points + 3 * (size_t)whole->corners[3 * whole->interior_count + c],
               3 * sizeof *points);
    for (size_t v = 0; v < joined->vertices && st == CW_OK; v++) {
        const size_t id = joined->global_ids[v];
        joined->locked[v] = whole->locked && whole->locked[id];
        joined->global_ids[v] = whole->global_ids[id];
    }
    memcpy(joined->along, whole->along, sizeof joined->along);
    joined->from = whole->from;
    joined->to = whole->to;
    if (st == CW_OK)
        st = cwi_block_obstruct(joined, points, more, err);
    cwi_free(points);
    return st;
}

/* Tries edges in seams again: those inside of blocks that are cut elsewhere, and then the rest. */
static cw_status collapse_seams(const cwi_passes *p, const cwi_block_part *x, cw_error *err)
{
    cwi_mesh_block from = *x->from, joined = {0};
    size_t none = 0;
    cw_status st =
        simplify_in_blocks(p, &from, 0, SECOND_CUT_FRACTION, false, NULL, &joined, &none, err);
    if (st == CW_OK)
        st = restore_limits(x->from, &joined, err);
    const cwi_block_part rest = {.from = &joined, .left = x->left, .cost = x->cost};
    if (st == CW_OK)
        st = collapse_part(p, &rest, err);
    cwi_block_free(&joined);
    return st;
}

/* As far as the error allows. */
static cw_status collapse_to_error(cwi_passes *p, const cwi_mesh_block *whole, size_t target,
                                   cwi_mesh_block *left, cw_error *err)
{
    const cwi_block_part x = {.from = whole,
                              .input = p->input,
                              .left = left,
                              .cost = INFINITY,
                              .target = target,
                              .threads = p->desc->threads};
    collapse_function *const run = has_seams(whole) ? collapse_seams : collapse_part;
    const cw_status st = run(p, &x, err);
    return st == CW_OK ? enforce_part_distance(p, &x, run, NULL, &p->repeats, err) : st;
}

cw_status cwi_passes_whole(cwi_passes *p, const cwi_mesh_block *whole, const size_t *targets,
                           size_t levels, cwi_mesh_block *left, cw_error *err)
{
    save_point_lists(p);
    return p->next ? collapse_to_error(p, whole, targets[0], left, err)
                   : collapse_to_targets(p, whole, INFINITY, targets, levels, left, err);
}
