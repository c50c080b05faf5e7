/* Links the edges of a section to closed loops. In a closed manifold each vertex of the section has
 * one edge to it and one from it. In other meshes chains may end, or several pass a vertex. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "simplify/cut/cut_state.h"

#include <string.h>

#define NONE UINT32_MAX

typedef struct link_work {
    cwi_cut *cut;
    uint32_t *first;  /* vertex_count: the first edge from a vertex that is not yet used */
    uint32_t *after;  /* edge_count: the next edge from the same vertex */
    int32_t *balance; /* vertex_count: edges from it, less those to it */
    uint32_t *chain;  /* edge_count: vertices of a chain */
} link_work;

/* Follows edges from a vertex until it is met again, or none goes on. Returns the number of edges. */
static size_t follow_chain(link_work *w, uint32_t start, bool *is_closed)
{
    size_t count = 0;
    uint32_t at = start;
    while (w->first[at] != NONE && (count == 0 || at != start)) {
        const uint32_t e = w->first[at];
        w->first[at] = w->after[e];
        w->chain[count++] = at;
        at = w->cut->edges[e].end;
    }
    *is_closed = count > 0 && at == start;
    return count;
}

/* Adds a loop to those to fill, backwards: its triangles are on the other side of its edges. A loop
 * of two edges is closed by itself. */
static void add_loop(link_work *w, size_t count)
{
    cwi_cut *c = w->cut;
    if (count < 3)
        return;
    const size_t begin = c->loop_count ? c->loop_ends[c->loop_count - 1] : 0;
    for (size_t n = 0; n < count; n++)
        c->loop_vertices[begin + n] = w->chain[count - 1 - n];
    c->loop_ends[c->loop_count++] = begin + count;
}

static void link_edges(link_work *w)
{
    cwi_cut *c = w->cut;
    bool is_closed;
    memset(w->first, 0xff, c->vertex_count * sizeof *w->first);
    for (size_t e = c->edge_count; e-- > 0;) { /* so that lists begin with the first edge */
        const cwi_cut_edge *edge = c->edges + e;
        w->after[e] = w->first[edge->start];
        w->first[edge->start] = (uint32_t)e;
        w->balance[edge->start]++;
        w->balance[edge->end]--;
    }
    for (size_t e = 0; e < c->edge_count; e++) {
        const uint32_t start = c->edges[e].start;
        for (; w->balance[start] > 0; w->balance[start]--) {
            follow_chain(w, start, &is_closed);
            c->facts.loops_open++;
        }
    }
    for (size_t e = 0; e < c->edge_count; e++) {
        const uint32_t start = c->edges[e].start;
        while (w->first[start] != NONE) {
            const size_t count = follow_chain(w, start, &is_closed);
            if (is_closed)
                add_loop(w, count);
            else
                c->facts.loops_open++;
        }
    }
}

cw_status cwi_cut_link(cwi_cut *c, cw_error *err)
{
    link_work w = {.cut = c};
    w.first = cwi_alloc_array(c->vertex_count, sizeof *w.first);
    w.balance = cwi_alloc_zeroed(c->vertex_count, sizeof *w.balance);
    w.after = cwi_alloc_array(c->edge_count, sizeof *w.after);
    w.chain = cwi_alloc_array(c->edge_count, sizeof *w.chain);
    c->loop_vertices = cwi_alloc_array(c->edge_count, sizeof *c->loop_vertices);
    c->loop_ends = cwi_alloc_array(c->edge_count, sizeof *c->loop_ends);
    const bool ok =
        w.first && w.balance && w.after && w.chain && c->loop_vertices && c->loop_ends;
    if (ok)
        link_edges(&w);
    cwi_free(w.first);
    cwi_free(w.balance);
    cwi_free(w.after);
    cwi_free(w.chain);
    return ok ? CW_OK : cwi_fail_memory(err);
}
