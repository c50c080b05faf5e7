/* Fills a section without crossings. Vertices of the section are rounded, so that edges of loops that
 * nearly touch may cross, and a surface that leans on the section may dip into it. Such vertices move
 * by some steps of the last digit until exact signs find no crossing. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "simplify/cut/cut_state.h"

#include <math.h>
#include <string.h>

/* Rounds without fewer crossings than before, after which the search ends: the mesh itself crosses
 * there. */
enum { MAX_IDLE_ROUNDS = 24, MAX_ROUNDS = 100 };

/* Steps by which a vertex moves within the plane at most: in the first round, and in any. */
static const double FIRST_STEPS = 1, MAX_STEPS = 4;

/* Places that a vertex tries in a round; rounds before vertices move away from what is kept, and steps by
 * which they do so at most. */
enum { PLACES = 16, FLAT_ROUNDS = 6, MAX_LOWERED = 2 };

typedef struct apart_work {
    cwi_cut *cut;
    uint8_t *marks;   /* vertex_count */
    uint8_t *lowered; /* vertex_count: steps away from what is kept */
    uint32_t round;
    size_t first_cap;
    cw_cut_facts facts; /* before the section is filled */
    bool is_askew;      /* the plane is normal to no axis */
} apart_work;

/* Returns a number from -1 to 1 that looks random, the same in every run. */
static double hash_to_offset(uint32_t vertex, uint32_t round, uint32_t k)
{
    uint64_t x = ((uint64_t)vertex << 32 | round << 8 | k) + 0x9e3779b97f4a7c15u;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    x ^= x >> 31;
    return (double)(x >> 11) * 0x1p-52 - 1;
}

static double measure_height(const cwi_cut *c, uint32_t v)
{
    const float *p = c->positions + 3 * (size_t)v;
    return fabs(c->normal[0] * (double)p[0] + c->normal[1] * (double)p[1] +
                c->normal[2] * (double)p[2] - c->offset);
}

/* Moves a vertex within the plane. Of several places it takes the one nearest to the plane, so that the
 * section gets flatter than rounding alone leaves it. */
static void move_vertex(apart_work *w, uint32_t v, double steps)
{
    double best[2] = {0, 0}, smallest = INFINITY;
    for (uint32_t k = 0; k < PLACES; k++) {
        const double shift[2] = {steps * hash_to_offset(v, w->round, 2 * k),
                                 steps * hash_to_offset(v, w->round, 2 * k + 1)};
        cwi_cut_place_apart(w->cut, v, shift, 0);
        const double height = measure_height(w->cut, v);
        if (height < smallest) {
            smallest = height;
            memcpy(best, shift, sizeof best);
        }
    }
    cwi_cut_place_apart(w->cut, v, best, w->lowered[v]);
}

/* Moves the marked vertices, farther in later rounds. */
static void move_marked(apart_work *w)
{
    const double grown = FIRST_STEPS + w->round / 4.0,
                 steps = grown < MAX_STEPS ? grown : MAX_STEPS;
    w->round++;
    for (uint32_t v = 0; v < w->cut->vertex_count; v++) {
        if (!w->marks[v])
            continue;
        if (w->marks[v] & CWI_CUT_LOWER && w->is_askew && w->round > FLAT_ROUNDS &&
            w->lowered[v] < MAX_LOWERED)
            w->lowered[v]++;
        move_vertex(w, v, steps);
    }
}

static void clear_marks(apart_work *w)
{
    memset(w->marks, 0, w->cut->vertex_count * sizeof *w->marks);
}

/* Moves vertices until the loops are simple. Sets whether they are. */
static cw_status part_edges(apart_work *w, bool *are_simple, cw_error *err)
{
    size_t fewest = SIZE_MAX, count;
    for (int idle = 0;; idle++) {
        cw_status st = cwi_progress(&w->cut->desc.progress, "fill", w->round ? 1 : 0.5, err);
        if (st != CW_OK)
            return st;
        clear_marks(w);
        st = cwi_cut_find_edge_crossings(w->cut, w->marks, &count, err);
        *are_simple = count == 0;
        if (st != CW_OK || *are_simple || idle >= MAX_IDLE_ROUNDS || w->round >= MAX_ROUNDS)
            return st;
        if (count < fewest) {
            fewest = count;
            idle = 0;
        }
        move_marked(w);
    }
}

static cw_status fill_again(apart_work *w, cw_error *err)
{
    w->cut->triangle_count = w->first_cap;
    w->cut->facts = w->facts;
    return cwi_cut_fill(w->cut, err);
}

/* Fills the section, and moves vertices until triangles there do not cross. */
static cw_status part_triangles(apart_work *w, cw_error *err)
{
    size_t fewest = SIZE_MAX, count;
    for (int idle = 0;; idle++) {
        bool are_simple;
        cw_status st = part_edges(w, &are_simple, err);
        w->cut->crossings = !are_simple;
        if (st == CW_OK)
            st = fill_again(w, err);
        if (st != CW_OK || !are_simple)
            return st;
        clear_marks(w);
        st = cwi_cut_find_triangle_crossings(w->cut, w->first_cap, w->marks, &count, err);
        w->cut->crossings = count;
        if (st != CW_OK || !count || idle >= MAX_IDLE_ROUNDS || w->round >= MAX_ROUNDS)
            return st;
        if (count < fewest) {
            fewest = count;
            idle = 0;
        }
        move_marked(w);
    }
}

cw_status cwi_cut_fill_apart(cwi_cut *c, cw_error *err)
{
    const double *n = c->normal;
    apart_work w = {.cut = c,
                    .first_cap = c->triangle_count,
                    .facts = c->facts,
                    .is_askew = (n[0] != 0) + (n[1] != 0) + (n[2] != 0) > 1};
    w.marks = cwi_alloc_array(c->vertex_count, sizeof *w.marks);
    w.lowered = cwi_alloc_zeroed(c->vertex_count, sizeof *w.lowered);
    cw_status st = w.marks && w.lowered ? part_triangles(&w, err) : cwi_fail_memory(err);
    if (w.round)
        cwi_cut_measure_moves(c);
    cwi_free(w.marks);
    cwi_free(w.lowered);
    return st;
}
