/* Collapses the edges of a label complex in the order of their costs. */
#include "simplify/interfaces/label_collapse.h"

#include "simplify/interfaces/edge_queue.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <string.h>

/* Edges between two reports of progress. */
enum { REPORT_EDGES = 1024 };

/* Trees smaller than this are not built again. */
enum { MIN_REBUILT = 1024 };

typedef struct collapser {
    cwi_complex *c;
    cwi_label_samples *samples; /* or NULL */
    cwi_label_quadric *quadrics;
    cwi_edge_queue queue;
    cwi_moving_boxes boxes;
    uint32_t *marks, mark; /* of triangles of the ring that is looked at */
    cwi_ring keep_ring, drop_ring;
    cwi_collapse_ring ring;
} collapser;

/* Returns true if a neighbour of a ring is held, and so all triangles around it. */
static bool is_ring_held(const cwi_complex *c, const cwi_ring *ring)
{
    for (size_t n = 0; n < ring->neighbour_count; n++)
        if (c->orders[ring->neighbours[n].vertex] == CWI_ORDER_HELD)
            return true;
    return false;
}

/* Asks all rules, those first that cost the least time. */
static bool is_allowed(collapser *w, const cwi_label_move *move)
{
    return cwi_ring_gather(w->c, move->keep, &w->keep_ring) &&
           cwi_ring_gather(w->c, move->drop, &w->drop_ring) &&
           w->keep_ring.triangle_count + w->drop_ring.triangle_count <= CWI_RING_TRIANGLES &&
           cwi_complex_links_allow(w->c, move->edge, move->keep, move->drop, &w->keep_ring,
                                   &w->drop_ring) &&
           !is_ring_held(w->c, &w->keep_ring) && !is_ring_held(w->c, &w->drop_ring) &&
           cwi_collapse_ring_make(&w->ring, w->c, move, &w->keep_ring, &w->drop_ring) &&
           (!w->samples || cwi_label_samples_allow(w->samples, w->c, &w->ring)) &&
           !cwi_collapse_ring_collides(&w->ring, w->c, &w->boxes, w->marks, ++w->mark);
}

/* Queues the edges around a vertex that are not queued, as they may be allowed now. */
static void queue_around(collapser *w, uint32_t vertex)
{
    if (!cwi_ring_gather(w->c, vertex, &w->keep_ring))
        return;
    for (size_t n = 0; n < w->keep_ring.neighbour_count; n++) {
        const uint32_t edge = w->keep_ring.neighbours[n].edge;
        if (w->queue.is_queued[edge])
            continue;
        const cwi_label_move move = cwi_label_move_plan(w->c, w->quadrics, edge);
        if (move.cost < INFINITY)
            cwi_edge_queue_push(&w->queue, move.cost, edge);
    }
}

static cw_status apply_move(collapser *w, cw_error *err)
{
    const cwi_collapse_ring *ring = &w->ring;
    const cwi_label_move *move = &ring->move;
    memcpy(w->c->points + 3 * (size_t)move->keep, move->position, sizeof move->position);
    cwi_complex_collapse(w->c, move->edge, move->keep, move->drop, &w->keep_ring,
                         &w->drop_ring);
    cwi_label_quadrics_join(w->quadrics, move->keep, move->drop);
    if (w->samples)
        cwi_label_samples_move(w->samples, ring);
    for (size_t i = 0; i < ring->gone_count; i++)
        cwi_moving_boxes_remove(&w->boxes, ring->gone[i]);
    for (size_t i = 0; i < ring->triangle_count; i++)
        cwi_moving_boxes_update(&w->boxes, w->c, ring->triangles[i].triangle);
    queue_around(w, move->keep);
    return 2 * w->c->live < w->boxes.built && w->boxes.built > MIN_REBUILT
               ? cwi_moving_boxes_build(&w->boxes, w->c, err)
               : CW_OK;
}

/* Looks at the first edge of the queue. Quadrics only grow, so a cost from before is a lower
 * bound: if the cost has grown, the edge moves back in the queue. */
static cw_status visit_first(collapser *w, cw_error *err)
{
    const uint64_t entry = w->queue.entries[0];
    const uint32_t edge = (uint32_t)entry;
    if (w->c->ends[edge][0] == CWI_NO_INDEX) {
        cwi_edge_queue_pop(&w->queue);
        return CW_OK;
    }
    const cwi_label_move move = cwi_label_move_plan(w->c, w->quadrics, edge);
    if (move.cost < INFINITY) {
        const uint64_t now = cwi_edge_queue_entry(move.cost, edge);
        if (now > entry)
            cwi_edge_queue_sink(&w->queue, now);
        if ((uint32_t)w->queue.entries[0] != edge)
            return CW_OK;
    }
    cwi_edge_queue_pop(&w->queue);
    return move.cost < INFINITY && is_allowed(w, &move) ? apply_move(w, err) : CW_OK;
}

static cw_status prepare_collapses(collapser *w, cw_error *err)
{
    cwi_complex *c = w->c;
    w->quadrics = cwi_alloc_array(c->vertex_count, sizeof *w->quadrics);
    w->marks = cwi_alloc_zeroed(c->triangle_count, sizeof *w->marks);
    if (!w->quadrics || !w->marks || !cwi_edge_queue_init(&w->queue, c->edge_count))
        return cwi_fail_memory(err);
    cwi_label_quadrics_build(c, w->quadrics);
    for (size_t e = 0; e < c->edge_count; e++) {
        const cwi_label_move move = cwi_label_move_plan(c, w->quadrics, (uint32_t)e);
        if (move.cost < INFINITY)
            cwi_edge_queue_push(&w->queue, move.cost, (uint32_t)e);
    }
    return cwi_moving_boxes_build(&w->boxes, c, err);
}

static double measure_progress(const cwi_complex *c, size_t target)
{
    return (double)(c->triangle_count - c->live) / (double)(c->triangle_count - target);
}

cw_status cwi_label_collapse(cwi_complex *c, cwi_label_samples *samples, size_t target,
                             const cw_progress *progress, cw_error *err)
{
    collapser *w = cwi_alloc_zeroed(1, sizeof *w);
    if (!w)
        return cwi_fail_memory(err);
    w->c = c;
    w->samples = samples;
    cw_status st = prepare_collapses(w, err);
    for (size_t n = 0; st == CW_OK && w->queue.count > 0 && c->live > target; n++) {
        if (n % REPORT_EDGES == 0)
            st = cwi_progress(progress, "simplifying labels", measure_progress(c, target), err);
        if (st == CW_OK)
            st = visit_first(w, err);
    }
    cwi_moving_boxes_free(&w->boxes);
    cwi_edge_queue_free(&w->queue);
    cwi_free(w->quadrics);
    cwi_free(w->marks);
    cwi_free(w);
    return st;
}
