/* The shortest loops that separate nothing, through single vertices: fronts of equal distance run along edges
 * from a vertex, and a loop is closed where two parts of a front meet whose ways back differ in sign
 * [Guskov2001]. */
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/base/thread_pool.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"
#include "core/mesh/corner_table.h"
#include "simplify/handles/handle_state.h"

#include <math.h>
#include <string.h>

/* Each thread takes 32 bytes for each vertex, so more threads than this do not take part. */
enum { CHUNK_SEEDS = 256, MAX_SEARCH_THREADS = 8 };

/* Searches for long loops begin at vertices that are this fraction of the longest one apart. So they find
 * loops that are too long by twice that, and the next searches begin on these: at most TIGHTEN_STEPS. */
enum { SPACING_PARTS = 8, TIGHTEN_STEPS = 8 };

/* A vertex that a front has reached. */
typedef struct reached_vertex {
    double distance;
    uint64_t sign;   /* of the way from the seed */
    uint32_t side;   /* the last one of the way; CWI_NO_CORNER at the seed */
    uint32_t search; /* the number of the search of this thread that reached it; 0: none */
    bool is_done;    /* the distance is final */
} reached_vertex;

typedef struct heap_item {
    double distance;
    uint32_t vertex;
} heap_item;

/* The memory of one thread for its searches. */
typedef struct front {
    reached_vertex *vertices; /* of the surface */
    heap_item *heap;
    size_t count, capacity;
    uint32_t *path; /* sides */
    size_t path_capacity;
    uint32_t searches; /* so far */
} front;

typedef struct loop_search {
    const cwi_handles *h;
    double most;    /* length of the longest loop */
    double spacing; /* of seeds; 0: each vertex with a sign is near one along a side */
    uint32_t *seeds;
    size_t seed_count, seed_capacity;
    front *fronts;    /* of the threads */
    cwi_loops *found; /* of the chunks */
    bool is_memory_out;
} loop_search;

void cwi_loops_free(cwi_loops *loops)
{
    cwi_free(loops->items);
    cwi_free(loops->sides);
    *loops = (cwi_loops){0};
}

/* --- the heap ----------------------------------------------------------------------------- */

static bool is_nearer(const heap_item *a, const heap_item *b)
{
    return a->distance < b->distance || (a->distance == b->distance && a->vertex < b->vertex);
}

static bool push_vertex(front *f, double distance, uint32_t vertex)
{
    heap_item *grown = cwi_grow_array(f->heap, f->count, &f->capacity, sizeof *f->heap);
    if (!grown)
        return false;
    f->heap = grown;
    const heap_item item = {distance, vertex};
    size_t n = f->count++;
    for (; n > 0 && is_nearer(&item, &f->heap[(n - 1) / 2]); n = (n - 1) / 2)
        f->heap[n] = f->heap[(n - 1) / 2];
    f->heap[n] = item;
    return true;
}

static heap_item pop_vertex(front *f)
{
    const heap_item top = f->heap[0], last = f->heap[--f->count];
    size_t n = 0, child;
    while ((child = 2 * n + 1) < f->count) {
        child += child + 1 < f->count && is_nearer(&f->heap[child + 1], &f->heap[child]);
        if (!is_nearer(&f->heap[child], &last))
            break;
        f->heap[n] = f->heap[child];
        n = child;
    }
    f->heap[n] = last;
    return top;
}

/* --- one search --------------------------------------------------------------------------- */

/* The shortest loop so far: it goes to the start of a side, along it, and back from its end. */
typedef struct best_loop {
    double length;
    uint32_t side;
} best_loop;

static double measure_side(const cwi_handles *h, uint32_t side)
{
    return sqrt(
        cwi_point_distance_sq(h->positions + 3 * (size_t)h->triangles[side],
                              h->positions + 3 * (size_t)h->triangles[cwi_corner_next(side)]));
}

/* Goes on from a vertex along all sides from it. Returns false when memory is out. */
static bool pass_vertex(const cwi_handles *h, front *f, uint32_t v, best_loop *best)
{
    const reached_vertex from = f->vertices[v];
    uint32_t side = h->first[v];
    do {
        const uint32_t to = h->triangles[cwi_corner_next(side)];
        const double way = from.distance + measure_side(h, side);
        const uint64_t sign = from.sign ^ h->signs[side];
        reached_vertex *r = &f->vertices[to];
        const bool is_known = r->search == f->searches;
        if (h->fixed[to] || h->avoided[side]) {
            /* No loop passes. */
        } else if (is_known && r->is_done) {
            if (sign != r->sign && way + r->distance < best->length)
                *best = (best_loop){way + r->distance, side};
        } else if ((!is_known || way < r->distance) && 2 * way <= best->length) {
            *r = (reached_vertex){way, sign, side, f->searches, false};
            if (!push_vertex(f, way, to))
                return false;
        }
        side = h->twin[cwi_corner_prev(side)];
    } while (side != h->first[v]);
    return true;
}

/* Appends the sides of the way to a vertex to the path, the last side first. */
static bool follow_way(const cwi_handles *h, front *f, uint32_t v, size_t *count)
{
    for (uint32_t side; (side = f->vertices[v].side) != CWI_NO_CORNER; v = h->triangles[side]) {
        uint32_t *grown = cwi_grow_array(f->path, *count, &f->path_capacity, sizeof *grown);
        if (!grown)
            return false;
        f->path = grown;
        f->path[(*count)++] = side;
    }
    return true;
}

/* Replaces pairs of sides of one triangle by its third side, until there are none. Returns the number of sides
 * that are left. */
static uint32_t cut_corners(const cwi_handles *h, uint32_t *sides, uint32_t count)
{
    for (uint32_t n = 0, same = 0; count > 3 && same < count; same++) {
        const uint32_t next = n + 1 < count ? n + 1 : 0, a = sides[n], b = sides[next];
        uint32_t third = CWI_NO_CORNER;
        if (b == cwi_corner_next(a))
            third = h->twin[cwi_corner_prev(a)];
        else if (h->twin[a] == cwi_corner_next(h->twin[b]))
            third = cwi_corner_next(h->twin[a]);
        if (third == CWI_NO_CORNER || h->avoided[third]) {
            n = next;
            continue;
        }
        sides[n] = third;
        memmove(sides + next, sides + next + 1, (--count - next) * sizeof *sides);
        n = next ? n : n - 1;
        n = n ? n - 1 : count - 1; /* the side before may now go with the new one */
        same = 0;
    }
    return count;
}

/* Adds the loop along a side, and the ways to both of its ends as far as they are not the same. */
static bool add_loop(const cwi_handles *h, front *f, uint32_t side, uint32_t seed,
                     cwi_loops *out)
{
    size_t there = 0, both;
    if (!follow_way(h, f, h->triangles[side], &there))
        return false;
    both = there;
    if (!follow_way(h, f, h->triangles[cwi_corner_next(side)], &both))
        return false;
    size_t forth = there, end = both;
    for (; forth > 0 && end > there && f->path[forth - 1] == f->path[end - 1]; end--)
        forth--;
    const size_t needed = out->side_count + forth + 1 + (end - there);
    if (needed > out->side_capacity) {
        uint32_t *grown = cwi_realloc_array(out->sides, 2 * needed + 256, sizeof *grown);
        if (!grown)
            return false;
        out->sides = grown;
        out->side_capacity = 2 * needed + 256;
    }
    cwi_loop *items = cwi_grow_array(out->items, out->count, &out->capacity, sizeof *items);
    if (!items)
        return false;
    out->items = items;
    uint32_t *sides = out->sides + out->side_count, count = 0;
    while (forth > 0)
        sides[count++] = f->path[--forth];
    sides[count++] = side;
    for (size_t n = there; n < end; n++)
        sides[count++] = h->twin[f->path[n]];
    cwi_loop loop = {0, seed, cut_corners(h, sides, count), out->side_count};
    for (uint32_t n = 0; n < loop.count; n++)
        loop.length += measure_side(h, sides[n]);
    items[out->count++] = loop;
    out->side_count += loop.count;
    return true;
}

/* Spreads a front from a vertex until it can find no loop that is shorter than the best one.
 * is_near  of vertices: set for those that were passed; or NULL
 * Returns false when memory is out */
static bool spread_front(const cwi_handles *h, front *f, uint32_t from, best_loop *best,
                         uint8_t *is_near)
{
    f->count = 0;
    f->searches++;
    f->vertices[from] = (reached_vertex){0, 0, CWI_NO_CORNER, f->searches, false};
    bool ok = push_vertex(f, 0, from);
    while (ok && f->count) {
        const heap_item item = pop_vertex(f);
        if (2 * item.distance > best->length)
            break;
        if (f->vertices[item.vertex].is_done)
            continue;
        f->vertices[item.vertex].is_done = true;
        if (is_near)
            is_near[item.vertex] = 1;
        ok = pass_vertex(h, f, item.vertex, best);
    }
    return ok;
}

/* Replaces the last loop by the shortest one through the vertex that is farthest from its first one, and so
 * on, until none is shorter. Takes the loop out that is too long in the end. Returns false when memory is
 * out. */
static bool tighten_loop(const loop_search *s, front *f, uint32_t seed, cwi_loops *out)
{
    const cwi_handles *h = s->h;
    bool ok = true;
    for (int n = 0; n < TIGHTEN_STEPS && ok && s->spacing > 0; n++) {
        const cwi_loop loop = out->items[out->count - 1];
        best_loop best = {loop.length * (1 - 1e-6), CWI_NO_CORNER};
        const uint32_t *sides = out->sides + loop.first;
        ok = spread_front(h, f, h->triangles[sides[loop.count / (n % 2 ? 4 : 2)]], &best, NULL);
        if (!ok || best.side == CWI_NO_CORNER)
            break;
        out->side_count = loop.first;
        out->count--;
        ok = add_loop(h, f, best.side, seed, out);
    }
    if (ok && out->items[out->count - 1].length > s->most)
        out->side_count = out->items[--out->count].first;
    return ok;
}

/* Finds the shortest loop through a vertex. Returns false when memory is out. */
static bool search_vertex(const loop_search *s, front *f, uint32_t seed, cwi_loops *out)
{
    best_loop best = {s->most + 2 * s->spacing, CWI_NO_CORNER};
    if (!spread_front(s->h, f, seed, &best, NULL))
        return false;
    return best.side == CWI_NO_CORNER ||
           (add_loop(s->h, f, best.side, seed, out) && tighten_loop(s, f, seed, out));
}

/* --- all searches ------------------------------------------------------------------------- */

/* Finds vertices such that each side with a sign begins or ends near one: any loop that separates nothing
 * has such a side. Returns false when memory is out. */
static bool find_seeds(loop_search *s)
{
    const cwi_handles *h = s->h;
    uint8_t *is_near = cwi_alloc_zeroed(h->vertex_count, 1);
    bool ok = is_near;
    for (uint32_t side = 0; side < 3 * h->triangle_count && ok; side++) {
        const uint32_t a = h->triangles[side], b = h->triangles[cwi_corner_next(side)];
        if (!h->signs[side] || h->twin[side] < side || h->fixed[a] || h->fixed[b] ||
            is_near[a] || is_near[b])
            continue;
        uint32_t *seeds =
            cwi_grow_array(s->seeds, s->seed_count, &s->seed_capacity, sizeof *seeds);
        ok = seeds;
        if (!ok)
            break;
        s->seeds = seeds;
        seeds[s->seed_count++] = a;
        is_near[a] = 1;
        best_loop none = {2 * s->spacing, CWI_NO_CORNER};
        ok = !(s->spacing > 0) || spread_front(h, &s->fronts[0], a, &none, is_near);
    }
    cwi_free(is_near);
    return ok;
}

static void search_chunk(void *context, size_t chunk)
{
    loop_search *s = context;
    front *f = &s->fronts[cwi_thread_number()];
    const size_t from = chunk * CHUNK_SEEDS, end = from + CHUNK_SEEDS;
    for (size_t n = from; n < end && n < s->seed_count; n++)
        if (!search_vertex(s, f, s->seeds[n], &s->found[chunk]))
            cwi_set_flag(&s->is_memory_out);
}

/* Appends the loops of all chunks. Returns false when memory is out. */
static bool join_loops(const loop_search *s, size_t chunks, cwi_loops *out)
{
    size_t sides = 0;
    for (size_t n = 0; n < chunks; n++) {
        out->count += s->found[n].count;
        sides += s->found[n].side_count;
    }
    out->items = cwi_alloc_array(out->count, sizeof *out->items);
    out->sides = cwi_alloc_array(sides, sizeof *out->sides);
    if (!out->items || !out->sides)
        return false;
    cwi_loop *to = out->items;
    for (size_t n = 0; n < chunks; n++) {
        const cwi_loops *l = &s->found[n];
        if (l->side_count)
            memcpy(out->sides + out->side_count, l->sides, l->side_count * sizeof *l->sides);
        for (size_t i = 0; i < l->count; i++, to++) {
            *to = l->items[i];
            to->first += out->side_count;
        }
        out->side_count += l->side_count;
    }
    return true;
}

/* Finds the seeds, and what threads search with. Returns false when memory is out. */
static bool prepare_search(loop_search *s, size_t threads, size_t *chunks)
{
    s->fronts = cwi_alloc_zeroed(threads, sizeof *s->fronts);
    bool ok = s->fronts;
    for (size_t n = 0; n < threads && ok; n++) {
        s->fronts[n].vertices = cwi_alloc_zeroed(s->h->vertex_count, sizeof(reached_vertex));
        ok = s->fronts[n].vertices;
    }
    ok = ok && find_seeds(s);
    *chunks = ok ? (s->seed_count + CHUNK_SEEDS - 1) / CHUNK_SEEDS : 0;
    s->found = cwi_alloc_zeroed(*chunks, sizeof *s->found);
    return ok && s->found;
}

cw_status cwi_handles_search(const cwi_handles *h, double most, const cw_progress *progress,
                             cwi_loops *out, cw_error *err)
{
    const int all = cwi_threads(h->desc.threads),
              threads = all < MAX_SEARCH_THREADS ? all : MAX_SEARCH_THREADS;
    const double spacing = most / SPACING_PARTS;
    loop_search s = {.h = h, .most = most, .spacing = spacing > h->mean_edge ? spacing : 0};
    size_t chunks = 0;
    cw_status st = CW_OK;
    if (!prepare_search(&s, (size_t)threads, &chunks))
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        st = cwi_parallel_for(chunks, CHUNK_SEEDS * 64, threads, progress, "handles",
                              search_chunk, &s, err);
    if (st == CW_OK && (s.is_memory_out || !join_loops(&s, chunks, out)))
        st = cwi_fail_memory(err);
    for (int n = 0; n < threads && s.fronts; n++) {
        cwi_free(s.fronts[n].vertices);
        cwi_free(s.fronts[n].heap);
        cwi_free(s.fronts[n].path);
    }
    for (size_t n = 0; n < chunks && s.found; n++)
        cwi_loops_free(&s.found[n]);
    cwi_free(s.fronts);
    cwi_free(s.found);
    cwi_free(s.seeds);
    return st;
}
