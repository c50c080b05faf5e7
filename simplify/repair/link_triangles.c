/* Joins triangles along their edges, two at each, and flips them so that neighbours agree. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/union_find.h"
#include "core/geometry/vec3.h"
#include "core/mesh/corner_table.h"
#include "simplify/repair/repair_state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Triangles around an edge that are paired one by one; of more the rest stays open. */
enum { MAX_AROUND = 32 };

/* A side at an edge of more than two triangles. */
typedef struct fin {
    uint32_t corner, patch;
    double angle;      /* around the edge, seen along it from the higher vertex */
    bool runs_forward; /* from the lower vertex to the higher */
    bool is_paired;
} fin;

typedef struct link_work {
    cwi_repair *r;
    cwi_side *sides;
    size_t count;
    uint32_t *patch; /* of triangles: union-find along edges of two triangles */
    uint32_t *queue; /* triangles in the order in which they were reached */
    uint8_t *state;  /* of triangles: 0, or REACHED, and TO_FLIP */
    size_t parted, flipped;
    bool is_full; /* memory is out */
} link_work;

enum { REACHED = 1, TO_FLIP = 2 };

/* --- edges of more than two triangles ----------------------------------------------------- */

/* Sets the angles of triangles around an edge, by two axes across it. */
static void measure_angles(const cw_mesh *m, uint64_t key, fin *fins, size_t count)
{
    const float *p = m->positions + 3 * (key >> 32), *q = m->positions + 3 * (key & UINT32_MAX);
    double along[3], x[3], y[3], pick[3] = {0};
    cwi_sub_points(q, p, along);
    cwi_normalise(along);
    const int axis = fabs(along[0]) < 0.6 ? 0 : 1;
    pick[axis] = 1;
    cwi_cross(along, pick, x);
    cwi_normalise(x);
    cwi_cross(along, x, y);
    for (size_t n = 0; n < count; n++) {
        const uint32_t third = cwi_corner_prev(fins[n].corner);
        const float *s = m->positions + 3 * (size_t)m->triangles[third];
        double from[3];
        cwi_sub_points(s, p, from);
        fins[n].angle = atan2(cwi_dot(from, y), cwi_dot(from, x));
    }
}

/* Sorts by angles. Of two in one place, as in a wall that solids share, the one comes first that has its inside
 * before it. Of those that agree, the same ones meet what is around at all edges. */
static int compare_fins(const void *a, const void *b)
{
    const fin *s = a, *t = b;
    if (s->angle != t->angle)
        return s->angle < t->angle ? -1 : 1;
    if (s->runs_forward != t->runs_forward)
        return s->runs_forward ? -1 : 1;
    const int order = s->corner < t->corner ? -1 : s->corner > t->corner;
    return s->runs_forward ? -order : order;
}

/* Rates a pair. Best are the only two triangles of one patch: then others are attached to it. Next
 * are two that have the inside between them. */
static int rate_pair(const fin *fins, size_t count, size_t i, size_t j)
{
    const bool is_coherent = fins[i].runs_forward != fins[j].runs_forward;
    size_t of_patch = 0;
    for (size_t n = 0; n < count; n++)
        of_patch += fins[n].patch == fins[i].patch;
    const bool is_alone = fins[i].patch == fins[j].patch && of_patch == 2;
    const bool has_inside =
        is_coherent && (fins[j].runs_forward ? (i + 1) % count == j : (j + 1) % count == i);
    return 8 * is_alone + 4 * has_inside + 2 * is_coherent;
}

static void pair_fins(link_work *w, size_t first, size_t count)
{
    fin fins[MAX_AROUND];
    const size_t size = count < MAX_AROUND ? count : MAX_AROUND;
    for (size_t n = 0; n < size; n++) {
        const cwi_side *side = &w->sides[first + n];
        fins[n] = (fin){.corner = side->corner,
                        .patch = cwi_sets_find(w->patch, side->corner / 3),
                        .runs_forward =
                            w->r->mesh.triangles[side->corner] == (uint32_t)(side->key >> 32)};
    }
    measure_angles(&w->r->mesh, w->sides[first].key, fins, size);
    qsort(fins, size, sizeof *fins, compare_fins);
    for (size_t pairs = 0; pairs < size / 2; pairs++) {
        int best = 0;
        size_t a = 0, b = 0;
        for (size_t i = 0; i < size; i++)
            for (size_t j = i + 1; j < size; j++) {
                const int rate =
                    fins[i].is_paired || fins[j].is_paired ? 0 : rate_pair(fins, size, i, j);
                if (rate > best) {
                    best = rate;
                    a = i;
                    b = j;
                }
            }
        if (best == 0)
            break;
        fins[a].is_paired = fins[b].is_paired = true;
        cwi_twins_join(w->r->twin, fins[a].corner, fins[b].corner);
    }
}

static void join_edges(link_work *w)
{
    size_t along;
    for (size_t i = 0; i < w->count; i += along) {
        along = cwi_sides_along(w->sides, w->count, i);
        if (along != 2)
            continue;
        const uint32_t a = w->sides[i].corner, b = w->sides[i + 1].corner;
        cwi_twins_join(w->r->twin, a, b);
        cwi_sets_join(w->patch, a / 3, b / 3);
    }
    for (size_t i = 0; i < w->count; i += along) {
        along = cwi_sides_along(w->sides, w->count, i);
        if (along <= 2)
            continue;
        w->parted++;
        pair_fins(w, i, along);
    }
}

/* --- orientation -------------------------------------------------------------------------- */

/* Cuts an edge open, and keeps it as a seam. */
static void cut_edge(link_work *w, uint32_t corner)
{
    cwi_repair *r = w->r;
    const uint32_t other = r->twin[corner];
    r->twin[corner] = r->twin[other] = CWI_NO_CORNER;
    cwi_twist *seam = cwi_grow_array(r->seam, r->seam_count, &r->seam_capacity, sizeof *seam);
    w->is_full = w->is_full || !seam;
    if (!seam)
        return;
    r->seam = seam;
    seam[r->seam_count++] = (cwi_twist){corner / 3, r->mesh.triangles[corner]};
}

/* Reaches the neighbours of a triangle that agree with it, or those that disagree; cuts edges at which one side would
 * have to be both. */
static size_t reach_neighbours(link_work *w, uint32_t t, size_t end, bool disagreeing)
{
    const cwi_repair *r = w->r;
    for (uint32_t c = 3 * t; c < 3 * t + 3; c++) {
        const uint32_t other = r->twin[c];
        if (other == CWI_NO_CORNER)
            continue;
        const uint32_t u = other / 3;
        const bool disagrees = r->mesh.triangles[c] == r->mesh.triangles[other];
        if (disagrees != disagreeing)
            continue;
        const uint8_t state = (w->state[t] ^ (disagrees ? TO_FLIP : 0)) | REACHED;
        if (!w->state[u]) {
            w->state[u] = state;
            w->queue[end++] = u;
        } else if (w->state[u] != state)
            cut_edge(w, c);
    }
    return end;
}

static void flip_triangle(cwi_repair *r, uint32_t t)
{
    uint32_t *v = r->mesh.triangles + 3 * (size_t)t, *twin = r->twin + 3 * (size_t)t;
    const uint32_t vertex = v[1], corner = twin[0];
    v[1] = v[2];
    v[2] = vertex;
    twin[0] = twin[2];
    twin[2] = corner;
    for (uint32_t c = 0; c < 3; c++)
        if (twin[c] != CWI_NO_CORNER)
            r->twin[twin[c]] = 3 * t + c;
}

/* Makes the triangles of each component agree with most of them. Those that agree are reached first: so a one-sided
 * surface is cut where its triangles disagree, and not all across it. */
static void agree_triangles(link_work *w)
{
    const size_t count = w->count / 3;
    for (uint32_t seed = 0; seed < count; seed++) {
        if (w->state[seed])
            continue;
        size_t end = 1, agreeing = 0, disagreeing = 0, against = 0;
        w->state[seed] = REACHED;
        w->queue[0] = seed;
        while (disagreeing < end) {
            const bool is_late = agreeing == end;
            size_t *next = is_late ? &disagreeing : &agreeing;
            end = reach_neighbours(w, w->queue[(*next)++], end, is_late);
        }
        for (size_t n = 0; n < end; n++)
            against += (w->state[w->queue[n]] & TO_FLIP) != 0;
        const uint8_t to_flip = 2 * against > end ? 0 : TO_FLIP;
        for (size_t n = 0; n < end; n++)
            if ((w->state[w->queue[n]] & TO_FLIP) == to_flip) {
                flip_triangle(w->r, w->queue[n]);
                w->flipped++;
            }
    }
}

cw_status cwi_repair_link(cwi_repair *r, bool is_first, cw_error *err)
{
    const size_t triangles = r->mesh.triangle_count, corners = 3 * triangles;
    link_work w = {.r = r, .count = corners};
    r->seam_count = 0;
    cwi_free(r->twin);
    r->twin = cwi_alloc_array(corners, sizeof *r->twin);
    w.sides = cwi_alloc_array(corners, sizeof *w.sides);
    w.patch = cwi_sets_alloc(triangles);
    w.queue = cwi_alloc_array(triangles, sizeof *w.queue);
    w.state = cwi_alloc_zeroed(triangles, 1);
    cw_status st = CW_OK;
    if (!r->twin || !w.sides || !w.patch || !w.queue || !w.state)
        st = cwi_fail_memory(err);
    if (st == CW_OK) {
        memset(r->twin, 0xff, corners * sizeof *r->twin);
        cwi_sides_list(r->mesh.triangles, corners, w.sides);
        join_edges(&w);
        agree_triangles(&w);
        st = w.is_full ? cwi_fail_memory(err) : CW_OK;
    }
    if (st == CW_OK && is_first) {
        r->facts.nonmanifold_edges += w.parted;
        r->facts.twisted_edges += r->seam_count;
        r->facts.flipped_triangles += w.flipped;
    }
    cwi_free(w.sides);
    cwi_free(w.patch);
    cwi_free(w.queue);
    cwi_free(w.state);
    return st;
}
