/* The edges and fans around a vertex, found from its triangles alone, on threads. */
#include "simplify/quality/vertex_stars.h"

#include "core/base/parallel.h"
#include "core/geometry/union_find.h"

#include <stdlib.h>
#include <string.h>

/* Vertices that one thread measures at a time, and triangles of a star without an allocation. */
enum { PART = 2048, SMALL_STAR = 24 };

/* An edge from the vertex at hand, as a side of one triangle around it. */
typedef struct spoke {
    uint64_t key;      /* the other vertex, then the third one of the triangle */
    uint32_t triangle; /* number in the star */
    bool leaves;       /* the triangle runs through it away from the vertex */
} spoke;

/* Arrays for one star: twice, once and once as long as its triangles. */
typedef struct scratch {
    spoke *spokes;
    uint32_t *fan;   /* union-find of triangles that share an edge at the vertex */
    uint32_t *label; /* number of the fan that a triangle names, if it has open edges */
} scratch;

typedef struct part {
    cw_quality counts;
    cwi_border border; /* ends as found, none joined */
    bool failed;
} part;

typedef struct work {
    const cwi_stars *stars;
    uint32_t *begin;  /* first of each vertex in `around`; range + 2 */
    uint32_t *around; /* triangles */
    part *parts;
} work;

static uint32_t other_of(const spoke *s)
{
    return (uint32_t)(s->key >> 32);
}

static uint32_t third_of(const spoke *s)
{
    return (uint32_t)s->key;
}

static int compare_spokes(const void *a, const void *b)
{
    const spoke *s = a, *t = b;
    return s->key < t->key ? -1 : s->key > t->key;
}

static void sort_spokes(spoke *s, size_t count)
{
    if (count > 2 * SMALL_STAR) { /* a hub: keep hostile meshes from quadratic time */
        qsort(s, count, sizeof *s, compare_spokes);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        const spoke x = s[i];
        size_t j = i;
        for (; j > 0 && s[j - 1].key > x.key; j--)
            s[j] = s[j - 1];
        s[j] = x;
    }
}

static bool is_collapsed(const uint32_t *c)
{
    return c[0] == c[1] || c[1] == c[2] || c[2] == c[0];
}

/* Returns the number of triangles of the star that have edges. */
static uint32_t gather_spokes(const work *w, uint32_t vertex, scratch *s)
{
    const uint32_t slot = vertex - w->stars->begin;
    uint32_t count = 0;
    for (uint32_t i = w->begin[slot]; i < w->begin[slot + 1]; i++) {
        const uint32_t *c = w->stars->triangles + 3 * (size_t)w->around[i];
        if (is_collapsed(c))
            continue;
        const int n = c[0] == vertex ? 0 : c[1] == vertex ? 1 : 2;
        const uint32_t next = c[(n + 1) % 3], last = c[(n + 2) % 3];
        s->spokes[2 * count] = (spoke){(uint64_t)next << 32 | last, count, true};
        s->spokes[2 * count + 1] = (spoke){(uint64_t)last << 32 | next, count, false};
        s->fan[count] = count;
        count++;
    }
    sort_spokes(s->spokes, 2 * (size_t)count);
    return count;
}

/* Counts an edge at its lower vertex, and triangles at the edge of their two lower vertices. */
static void count_edge(const spoke *s, size_t count, cw_quality *q)
{
    q->edges++;
    q->open_edges += count == 1;
    q->nonmanifold_edges += count > 2;
    q->misoriented_edges += count == 2 && s[0].leaves == s[1].leaves;
    for (size_t i = 1; i < count; i++)
        q->duplicates += s[i].key == s[i - 1].key && third_of(&s[i]) > other_of(&s[i]);
}

/* Returns the number of spokes along the same edge as the first. */
static size_t count_along(const spoke *s, size_t left)
{
    size_t count = 1;
    while (count < left && other_of(&s[count]) == other_of(s))
        count++;
    return count;
}

static bool keep_open_ends(part *p, uint32_t vertex, scratch *s, uint32_t triangles)
{
    memset(s->label, 0xff, triangles * sizeof *s->label);
    for (size_t i = 0, along; i < 2 * (size_t)triangles; i += along) {
        along = count_along(s->spokes + i, 2 * (size_t)triangles - i);
        if (along > 1)
            continue;
        const uint32_t root = cwi_sets_find(s->fan, s->spokes[i].triangle);
        const uint32_t other = other_of(&s->spokes[i]);
        if (s->label[root] == UINT32_MAX)
            s->label[root] = p->border.fans++;
        const cwi_open_end end = {.low = vertex < other ? vertex : other,
                                  .high = vertex < other ? other : vertex,
                                  .fan = s->label[root]};
        if (!cwi_border_push(&p->border, end))
            return false;
    }
    return true;
}

static bool measure_spokes(part *p, uint32_t vertex, scratch *s, uint32_t triangles)
{
    uint32_t fans = triangles;
    bool is_open = false;
    for (size_t i = 0, along; i < 2 * (size_t)triangles; i += along) {
        const spoke *first = s->spokes + i;
        along = count_along(first, 2 * (size_t)triangles - i);
        is_open = is_open || along == 1;
        if (other_of(first) > vertex)
            count_edge(first, along, &p->counts);
        for (size_t n = 1; n < along; n++) {
            const uint32_t one = cwi_sets_find(s->fan, first->triangle),
                           other = cwi_sets_find(s->fan, first[n].triangle);
            fans -= one != other;
            cwi_sets_join(s->fan, one, other);
        }
    }
    p->counts.components += fans > 0;
    p->counts.nonmanifold_vertices += fans > 1;
    return !is_open || keep_open_ends(p, vertex, s, triangles);
}

static bool measure_star(const work *w, part *p, uint32_t vertex)
{
    spoke spokes[2 * SMALL_STAR];
    uint32_t fan[SMALL_STAR], label[SMALL_STAR];
    const uint32_t slot = vertex - w->stars->begin;
    const size_t count = w->begin[slot + 1] - w->begin[slot];
    scratch s = {spokes, fan, label};
    p->counts.unused_vertices += !count;
    if (count <= SMALL_STAR)
        return measure_spokes(p, vertex, &s, gather_spokes(w, vertex, &s));
    s.spokes = cwi_alloc_array(2 * count, sizeof *s.spokes);
    s.fan = cwi_alloc_array(count, sizeof *s.fan);
    s.label = cwi_alloc_array(count, sizeof *s.label);
    const bool ok = s.spokes && s.fan && s.label &&
                    measure_spokes(p, vertex, &s, gather_spokes(w, vertex, &s));
    cwi_free(s.spokes);
    cwi_free(s.fan);
    cwi_free(s.label);
    return ok;
}

static void measure_part(void *context, size_t k)
{
    const work *w = context;
    part *p = &w->parts[k];
    const size_t begin = w->stars->begin + k * PART, all = w->stars->end;
    const size_t end = begin + PART < all ? begin + PART : all;
    for (size_t v = begin; v < end && !p->failed; v++)
        p->failed = !measure_star(w, p, (uint32_t)v);
}

/* Files triangles under their vertices of the range: a counting sort. */
static bool file_triangles(work *w)
{
    const cwi_stars *s = w->stars;
    const size_t range = s->end - s->begin, corners = 3 * s->count;
    w->begin = cwi_alloc_zeroed(range + 2, sizeof *w->begin);
    if (!w->begin)
        return false;
    for (size_t i = 0; i < corners; i++) {
        const uint32_t slot = s->triangles[i] - s->begin; /* wraps round below the range */
        if (slot < range)
            w->begin[slot + 2]++;
    }
    for (size_t v = 2; v < range + 2; v++)
        w->begin[v] += w->begin[v - 1];
    w->around = cwi_alloc_array(w->begin[range + 1], sizeof *w->around);
    for (size_t i = 0; i < corners && w->around; i++) {
        const uint32_t slot = s->triangles[i] - s->begin;
        if (slot < range)
            w->around[w->begin[slot + 1]++] = (uint32_t)(i / 3);
    }
    return w->around;
}

static bool add_part(const part *p, cw_quality *q, cwi_border *border)
{
    const cw_quality *c = &p->counts;
    q->edges += c->edges;
    q->components += c->components;
    q->unused_vertices += c->unused_vertices;
    q->open_edges += c->open_edges;
    q->nonmanifold_edges += c->nonmanifold_edges;
    q->misoriented_edges += c->misoriented_edges;
    q->nonmanifold_vertices += c->nonmanifold_vertices;
    q->duplicates += c->duplicates;
    q->euler += (int64_t)c->components - (int64_t)c->edges;
    return !p->failed && cwi_border_append(border, &p->border);
}

bool cwi_measure_stars(const cwi_stars *stars, cw_quality *q, cwi_border *border)
{
    const size_t parts = (stars->end - stars->begin + PART - 1) / PART;
    const cw_progress silent = {0};
    work w = {.stars = stars, .parts = cwi_alloc_zeroed(parts, sizeof *w.parts)};
    bool ok = w.parts && file_triangles(&w) &&
              cwi_each_layer(parts, PART * 64, stars->threads, &silent, NULL, measure_part, &w,
                             NULL) == CW_OK;
    for (size_t k = 0; k < parts && w.parts; k++) {
        ok = ok && add_part(&w.parts[k], q, border);
        cwi_border_free(&w.parts[k].border);
    }
    cwi_free(w.parts);
    cwi_free(w.begin);
    cwi_free(w.around);
    return ok;
}
