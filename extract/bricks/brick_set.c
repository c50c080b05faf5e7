/* Keeps track of bricks that have changed, and extracts them, some at a time, in parallel. */
#include "extract/bricks/brick_set.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/base/thread_pool.h"
#include "extract/bricks/brick_grid.h"
#include "extract/common/extract_limits.h"

#include <string.h>

/* Samples from the ends of an edge whose values a vertex on it may depend on: those of the cubics
 * around it, or the cells of triangles that give it a normal. */
enum { REACH = 2 };

static size_t count_bricks(const cwi_brick_set *s)
{
    return s->dim[0] * s->dim[1] * s->dim[2];
}

void cwi_bricks_free(cwi_brick_set *s)
{
    cwi_free(s->state);
    for (int n = 0; n < CWI_BRICKS_AT_ONCE; n++)
        cw_mesh_free(&s->mesh[n]);
    *s = (cwi_brick_set){0};
}

static void touch_all(cwi_brick_set *s)
{
    for (size_t n = 0; n < count_bricks(s); n++)
        s->state[n] |= CWI_BRICK_CHANGED;
}

/* A brick along an axis is over padded samples edge * b to edge * (b + 1); voxel i is sample i + 1. */
void cwi_bricks_touch(cwi_brick_set *s, const cw_box *box)
{
    enum { EDGE = CW_EXTRACT_BRICK };
    size_t first[3], last[3];
    if (!s->state)
        return;
    if (!box) {
        touch_all(s);
        return;
    }
    for (int a = 0; a < 3; a++) {
        const size_t low = box->first[a] + 1, high = box->first[a] + box->count[a];
        first[a] = low > EDGE + REACH ? (low - REACH - 1) / EDGE : 0;
        last[a] = (high + REACH) / EDGE;
        last[a] = last[a] < s->dim[a] ? last[a] : s->dim[a] - 1;
    }
    for (size_t z = first[2]; z <= last[2]; z++)
        for (size_t y = first[1]; y <= last[1]; y++)
            for (size_t x = first[0]; x <= last[0]; x++)
                s->state[(z * s->dim[1] + y) * s->dim[0] + x] |= CWI_BRICK_CHANGED;
}

static bool any_changed(const cwi_brick_set *s)
{
    unsigned any = 0;
    for (size_t n = 0; n < count_bricks(s); n++)
        any |= s->state[n];
    return any & CWI_BRICK_CHANGED;
}

/* Returns true if two extractions of the same voxels give the same surface. */
static bool are_alike(const cw_extract_desc *a, const cw_extract_desc *b)
{
    return a->isovalue == b->isovalue && a->inside_is_low == b->inside_is_low &&
           a->leave_open == b->leave_open && a->simple_topology == b->simple_topology &&
           a->cubic_placement == b->cubic_placement && a->no_normals == b->no_normals;
}

cw_status cwi_bricks_begin(cwi_brick_set *s, const cwi_plan *plan, const cw_extract_desc *d,
                           cw_error *err)
{
    const cwi_bit_grid *g = &plan->grid;
    const bool has_gaps = g->has_gaps && (d->leave_open || g->volume.has_nodata);
    for (int a = 0; a < 3; a++)
        s->dim[a] = g->volume.dim[a] / CW_EXTRACT_BRICK + 1;
    const bool first = !s->state;
    if (first)
        s->state = cwi_alloc_zeroed(count_bricks(s), 1);
    if (!s->state)
        return cwi_fail_memory(err);
    /* which cells an open surface lacks beside gaps may depend on cells anywhere; and vertices at
     * the border are computed otherwise while there is no-data */
    const bool far = d->leave_open ? has_gaps || s->had_gaps : has_gaps != s->had_gaps;
    if (first || !are_alike(&s->desc, d) || (far && any_changed(s)))
        touch_all(s);
    s->desc = *d;
    s->had_gaps = has_gaps;
    return CW_OK;
}

/* --- extraction --------------------------------------------------------------------------- */

/* Bricks that are extracted together. */
typedef struct batch {
    cwi_brick_set *set;
    cwi_brick_job job;
    cwi_brick_grid *grids; /* of each thread */
    int threads;
    size_t brick[CWI_BRICKS_AT_ONCE], count;
    bool found[CWI_BRICKS_AT_ONCE];
    uint8_t sides[CWI_BRICKS_AT_ONCE];
    size_t triangles; /* given until now */
} batch;

static void find_place(const cwi_brick_set *s, size_t brick, size_t at[3])
{
    at[0] = brick % s->dim[0];
    at[1] = brick / s->dim[0] % s->dim[1];
    at[2] = brick / s->dim[0] / s->dim[1];
}

/* Finds the sides of a brick's samples by the octree. Returns false if it may be crossed. */
static bool is_ruled_out(const cwi_plan *p, const size_t at[3], unsigned *sides)
{
    enum { LEAVES = CW_EXTRACT_BRICK / CWI_BRICK };
    cwi_leaf_box box;
    bool straddles;
    if (!p->tree.grown)
        return false;
    for (int a = 0; a < 3; a++) {
        const size_t end = LEAVES * (at[a] + 1), leaves = p->tree.dim[0][a];
        box.first[a] = LEAVES * at[a];
        box.end[a] = end < leaves ? end : leaves;
    }
    *sides = cwi_octree_sides(&p->tree, &p->grid, &box, &straddles);
    return !straddles;
}

static void extract_one(void *context, size_t n)
{
    batch *b = context;
    cwi_brick_grid *grid = &b->grids[cwi_thread_number()];
    unsigned sides = 0;
    size_t at[3];
    find_place(b->set, b->brick[n], at);
    b->found[n] = false;
    if (grid->status != CW_OK)
        return;
    if (!is_ruled_out(b->job.whole, at, &sides)) {
        grid->status = cwi_brick_classify(grid, &b->job, at, &sides, &grid->error);
        if (grid->status == CW_OK && b->set->was_crossed && (sides & CWI_INSIDE))
            grid->status =
                cwi_brick_extract(grid, &b->job, &b->set->mesh[n], &b->found[n], &grid->error);
    }
    b->sides[n] = (uint8_t)sides;
}

static cw_status extract_batch(batch *b, cw_error *err)
{
    enum { SAMPLES = CW_EXTRACT_BRICK * CW_EXTRACT_BRICK * CW_EXTRACT_BRICK };
    cwi_parallel_for_all(b->count, SAMPLES, b->job.desc->threads, extract_one, b);
    for (int n = 0; n < b->threads; n++)
        if (b->grids[n].status != CW_OK)
            return cwi_fail(err, b->grids[n].status, "%s", b->grids[n].error.message);
    return CW_OK;
}

static cw_status check_batch(batch *b, cw_error *err)
{
    cw_extract_counts made = {0}, all = {0};
    for (size_t n = 0; n < b->count; n++)
        if (b->found[n]) {
            made.vertices += b->set->mesh[n].vertex_count;
            made.triangles += b->set->mesh[n].triangle_count;
        }
    b->triangles += made.triangles;
    all.triangles = b->triangles;
    all.bytes = cwi_extract_mesh_bytes(&made, !b->job.desc->no_normals) +
                cwi_grid_bytes(&b->job.whole->grid) + cwi_octree_bytes(&b->job.whole->tree);
    return cwi_extract_check_limits(b->job.desc, &all, err);
}

static cw_status give_brick(const batch *b, size_t n, cw_brick_sink sink, cw_error *err)
{
    cwi_brick_set *s = b->set;
    uint8_t *state = &s->state[b->brick[n]];
    cw_mesh empty = {0};
    cw_brick brick = {.mesh = b->found[n] ? &s->mesh[n] : &empty, .index = b->brick[n]};
    memcpy(empty.origin, b->job.origin, sizeof empty.origin);
    memcpy(empty.affine, b->job.volume.affine, sizeof empty.affine);
    memcpy(brick.count, s->dim, sizeof brick.count);
    find_place(s, b->brick[n], brick.at);
    const bool differs = b->found[n] || (*state & CWI_BRICK_FILLED);
    const cw_status st = differs ? sink.take(sink.user, &brick, err) : CW_OK;
    if (st == CW_OK)
        *state =
            (uint8_t)((b->found[n] ? CWI_BRICK_FILLED : 0) | b->sides[n] << CWI_BRICK_SIDES);
    return st;
}

/* Lists the next bricks that have changed, from *next on. */
static void list_batch(batch *b, size_t *next)
{
    const size_t bricks = count_bricks(b->set);
    b->count = 0;
    for (; *next < bricks && b->count < CWI_BRICKS_AT_ONCE; ++*next)
        if (b->set->state[*next] & CWI_BRICK_CHANGED)
            b->brick[b->count++] = *next;
}

static cw_status give_all(batch *b, cw_brick_sink sink, cw_error *err)
{
    const double bricks = (double)count_bricks(b->set);
    cw_status st = CW_OK;
    size_t next = 0;
    do {
        st = cwi_progress(&b->job.desc->progress, "marching", (double)next / bricks, err);
        list_batch(b, &next);
        if (st == CW_OK)
            st = extract_batch(b, err);
        if (st == CW_OK)
            st = check_batch(b, err);
        for (size_t n = 0; n < b->count && st == CW_OK; n++)
            st = give_brick(b, n, sink, err);
    } while (b->count && st == CW_OK);
    return st;
}

/* Finds out if samples are on both sides. Few bricks are looked at, unless all are alike. */
static cw_status find_crossed(batch *b, bool *crossed, cw_error *err)
{
    const cwi_brick_set *s = b->set;
    const cwi_plan *p = b->job.whole;
    unsigned sides = 0;
    cw_status st = CW_OK;
    if (p->tree.grown) {
        *crossed = cwi_octree_crossed(&p->tree, &p->grid);
        return CW_OK;
    }
    for (size_t n = 0; n < count_bricks(s); n++)
        if (!(s->state[n] & CWI_BRICK_CHANGED))
            sides |= s->state[n] >> CWI_BRICK_SIDES;
    for (size_t n = 0; n < count_bricks(s) && sides != CWI_BOTH && st == CW_OK; n++) {
        unsigned here = 0;
        size_t at[3];
        find_place(s, n, at);
        if (s->state[n] & CWI_BRICK_CHANGED)
            st = cwi_brick_classify(&b->grids[0], &b->job, at, &here, err);
        sides |= here;
    }
    *crossed = sides == CWI_BOTH;
    return st;
}

/* Gives all bricks again where a surface with its caps appears or vanishes. */
static cw_status follow_crossed(batch *b, cw_error *err)
{
    cwi_brick_set *s = b->set;
    bool crossed = s->was_crossed;
    const cw_status st = any_changed(s) ? find_crossed(b, &crossed, err) : CW_OK;
    if (crossed != s->was_crossed)
        touch_all(s);
    s->was_crossed = crossed;
    return st;
}

cw_status cwi_bricks_extract(cwi_brick_set *s, const cwi_plan *plan, cw_brick_sink sink,
                             cw_error *err)
{
    batch b = {.set = s, .threads = cwi_threads(s->desc.threads)};
    cwi_brick_job_init(&b.job, plan, &s->desc);
    b.grids = cwi_alloc_zeroed((size_t)b.threads, sizeof *b.grids);
    if (!b.grids)
        return cwi_fail_memory(err);
    cw_status st = follow_crossed(&b, err);
    if (st == CW_OK)
        st = give_all(&b, sink, err);
    for (int n = 0; n < b.threads; n++)
        cwi_brick_grid_free(&b.grids[n]);
    cwi_free(b.grids);
    return st;
}
