/* The edges and fans around a vertex, found from its triangles alone, on threads. */
#include "simplify/quality/vertex_one_rings.h"

#include "core/base/parallel.h"
#include "core/geometry/triangle.h"
#include "core/geometry/union_find.h"
#include "simplify/quality/vertex_ranges.h"

#include <stdlib.h>
#include <string.h>

/* Triangles of a one-ring without an allocation, and of one whose triangles are ordered by search. */
enum { SMALL_RING = 24 };

/* A triangle around the vertex at hand. */
typedef struct ring_triangle {
    uint32_t next, last; /* its other vertices, in its direction */
    uint32_t triangle;
} ring_triangle;

/* An edge from the vertex at hand, as a side of one triangle around it. */
typedef struct ring_edge {
    uint64_t key;      /* the other vertex, then the third one of the triangle */
    uint32_t triangle; /* number in the ring */
    bool is_outgoing;  /* the triangle runs through it away from the vertex */
} ring_edge;

/* The triangles around a vertex. Not a corner table: a ring is found from the triangles of one range, so
 * that ranges run on threads and a surface may pass by in chunks. */
typedef struct one_ring {
    uint32_t vertex;
    size_t count;
    ring_triangle *triangles;
    ring_edge *edges; /* 2 x count, in the order of edges */
    uint32_t *fan;    /* union-find of triangles that share an edge at the vertex */
    uint32_t *label;  /* number of the fan that a triangle names, if it has open edges */
} one_ring;

/* Counts of the vertices of one range. */
typedef struct part {
    cw_quality counts;
    size_t joined;     /* sets of vertices; or sides of open edges */
    cwi_border border; /* ends as found, none joined */
    bool failed;
} part;

typedef struct work {
    const cwi_one_rings *rings;
    part *parts;
    uint32_t *loops; /* of sides: union-find, when loops are counted and nothing else */
    bool keeps_border;
} work;

/* The vertices of a range, and the triangles around them. */
typedef struct range {
    uint32_t first, size;
    const uint32_t *triangle;
    size_t triangle_count;
    uint32_t begin[CWI_RANGE_VERTICES + 2]; /* first of each vertex in triangles */
    bool is_named[CWI_RANGE_VERTICES];      /* by any triangle */
    bool is_bad[CWI_RANGE_VERTICES];        /* several fans */
    ring_triangle *triangles;
} range;

/* --- one ring ----------------------------------------------------------------------------- */

static uint32_t other_of(const ring_edge *s)
{
    return (uint32_t)(s->key >> 32);
}

static uint32_t third_of(const ring_edge *s)
{
    return (uint32_t)s->key;
}

static int compare_edges(const void *a, const void *b)
{
    const ring_edge *s = a, *t = b;
    if (s->key != t->key)
        return s->key < t->key ? -1 : 1;
    return s->triangle < t->triangle ? -1 : s->triangle > t->triangle;
}

static void sort_edges(ring_edge *s, size_t count)
{
    if (count > 2 * SMALL_RING) { /* a hub: keep hostile meshes from quadratic time */
        qsort(s, count, sizeof *s, compare_edges);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        const ring_edge x = s[i];
        size_t j = i;
        for (; j > 0 && s[j - 1].key > x.key; j--)
            s[j] = s[j - 1];
        s[j] = x;
    }
}

static void make_edges(one_ring *s)
{
    for (uint32_t n = 0; n < s->count; n++) {
        const uint64_t next = s->triangles[n].next, last = s->triangles[n].last;
        s->edges[2 * n] = (ring_edge){next << 32 | last, n, true};
        s->edges[2 * n + 1] = (ring_edge){last << 32 | next, n, false};
        s->fan[n] = n;
    }
    sort_edges(s->edges, 2 * s->count);
}

/* Puts the triangles of a usual ring in order: a closed fan, in which each one begins at the
 * edge where the one before it ends. Returns false for any other ring. A closed fan has at least
 * three triangles, and no edge twice: two would be duplicates. */
static bool order_closed_fan(one_ring *s)
{
    ring_triangle *l = s->triangles;
    if (s->count < 3 || s->count > SMALL_RING)
        return false;
    for (size_t k = 1; k < s->count; k++) {
        const uint32_t at = l[k - 1].last;
        size_t found = 0, matches = 0;
        for (size_t j = k; j < s->count; j++) {
            matches += l[j].next == at;
            found = l[j].next == at ? j : found;
        }
        if (matches != 1 || at == l[0].next)
            return false;
        const ring_triangle swap = l[k];
        l[k] = l[found];
        l[found] = swap;
    }
    return l[s->count - 1].last == l[0].next;
}

/* Returns the number of edges along the same edge as the first. */
static size_t count_along(const ring_edge *s, size_t left)
{
    size_t count = 1;
    while (count < left && other_of(&s[count]) == other_of(s))
        count++;
    return count;
}

static void mark_triangle(const work *w, uint32_t triangle, cw_defect defect)
{
    __atomic_fetch_or(&w->rings->defects[triangle], (uint8_t)defect, __ATOMIC_RELAXED);
}

static void mark_edge(const work *w, const one_ring *s, const ring_edge *first, size_t along,
                      cw_defect defect)
{
    for (size_t n = 0; n < along && w->rings->defects; n++)
        mark_triangle(w, s->triangles[first[n].triangle].triangle, defect);
}

/* A triangle counts at the edge of its two lower vertices. */
static void count_duplicates(const work *w, const one_ring *s, const ring_edge *first,
                             size_t along, cw_quality *q)
{
    for (size_t n = 1; n < along; n++)
        if (first[n].key == first[n - 1].key && third_of(&first[n]) > other_of(&first[n])) {
            q->duplicates++;
            mark_edge(w, s, first + n - 1, 2, CW_DEFECT_DUPLICATE);
        }
}

/* Returns true if as many triangles run through an edge one way as the other. */
static bool is_paired(const ring_edge *first, size_t along)
{
    size_t outgoing = 0;
    for (size_t n = 0; n < along; n++)
        outgoing += first[n].is_outgoing;
    return 2 * outgoing == along;
}

/* Counts an edge at its lower vertex. */
static void count_edge(const work *w, const one_ring *s, const ring_edge *first, size_t along,
                       cw_quality *q)
{
    const bool paired = is_paired(first, along), is_misoriented = along == 2 && !paired;
    q->edges++;
    if (along == 1) {
        q->open_edges++;
        mark_edge(w, s, first, along, CW_DEFECT_OPEN);
    } else if (along > 2) {
        q->nonmanifold_edges++;
        q->contact_edges += paired;
        mark_edge(w, s, first, along, CW_DEFECT_NONMANIFOLD);
    } else if (is_misoriented) {
        q->misoriented_edges++;
        mark_edge(w, s, first, along, CW_DEFECT_MISORIENTED);
    }
    if (w->rings->unbounded && !paired)
        w->rings->unbounded[s->vertex] |= along == 1 ? CWI_OPEN : CWI_UNORIENTED;
    count_duplicates(w, s, first, along, q);
}

/* Goes through the open edges of a ring, and labels the fans that have some. */
static bool keep_open_ends(part *p, one_ring *s)
{
    const size_t edges = 2 * s->count;
    memset(s->label, 0xff, s->count * sizeof *s->label);
    for (size_t i = 0, along; i < edges; i += along) {
        along = count_along(s->edges + i, edges - i);
        if (along > 1)
            continue;
        const uint32_t root = cwi_sets_find(s->fan, s->edges[i].triangle);
        const uint32_t other = other_of(&s->edges[i]);
        if (s->label[root] == UINT32_MAX)
            s->label[root] = p->border.fans++;
        const cwi_open_end end = {.low = s->vertex < other ? s->vertex : other,
                                  .high = s->vertex < other ? other : s->vertex,
                                  .fan = s->label[root]};
        if (!cwi_border_push(&p->border, end))
            return false;
    }
    return true;
}

/* The number of a side: that of its triangle's corner where it begins. */
static uint32_t side_of(const work *w, const one_ring *s, const ring_edge *open)
{
    const uint32_t triangle = s->triangles[open->triangle].triangle;
    const uint32_t from = open->is_outgoing ? s->vertex : other_of(open);
    const uint32_t *corner = w->rings->triangles + 3 * (size_t)triangle;
    return 3 * triangle + (corner[0] == from ? 0 : corner[1] == from ? 1 : 2);
}

/* Joins the open edges of each fan: they belong to one loop. */
static void join_open_sides(const work *w, part *p, one_ring *s)
{
    const size_t edges = 2 * s->count;
    memset(s->label, 0xff, s->count * sizeof *s->label);
    for (size_t i = 0, along; i < edges; i += along) {
        along = count_along(s->edges + i, edges - i);
        if (along > 1)
            continue;
        const uint32_t root = cwi_sets_find(s->fan, s->edges[i].triangle);
        const uint32_t side = side_of(w, s, &s->edges[i]);
        if (s->label[root] == UINT32_MAX)
            s->label[root] = side;
        p->joined += cwi_sets_join_shared(w->loops, s->label[root], side);
    }
}

/* Measures a ring edge by edge; returns false when memory is out. */
static bool measure_edges(const work *w, part *p, one_ring *s, size_t *fans)
{
    const size_t edges = 2 * s->count;
    bool is_open = false, paired = true;
    make_edges(s);
    *fans = s->count;
    for (size_t i = 0, along; i < edges; i += along) {
        const ring_edge *first = s->edges + i;
        along = count_along(first, edges - i);
        is_open = is_open || along == 1;
        paired = paired && is_paired(first, along);
        if (other_of(first) > s->vertex && !w->loops)
            count_edge(w, s, first, along, &p->counts);
        for (size_t n = 1; n < along; n++) {
            const uint32_t one = cwi_sets_find(s->fan, first->triangle),
                           other = cwi_sets_find(s->fan, first[n].triangle);
            *fans -= one != other;
            cwi_sets_join(s->fan, one, other);
        }
    }
    p->counts.contact_vertices += *fans > 1 && paired;
    if (is_open && w->loops)
        join_open_sides(w, p, s);
    return !is_open || !w->keeps_border || keep_open_ends(p, s);
}

static bool measure_any_ring(const work *w, part *p, one_ring *s, size_t *fans)
{
    ring_edge edges[2 * SMALL_RING];
    uint32_t fan[SMALL_RING], label[SMALL_RING];
    s->edges = edges;
    s->fan = fan;
    s->label = label;
    if (s->count <= SMALL_RING)
        return measure_edges(w, p, s, fans);
    s->edges = cwi_alloc_array(2 * s->count, sizeof *s->edges);
    s->fan = cwi_alloc_array(s->count, sizeof *s->fan);
    s->label = cwi_alloc_array(s->count, sizeof *s->label);
    const bool ok = s->edges && s->fan && s->label && measure_edges(w, p, s, fans);
    cwi_free(s->edges);
    cwi_free(s->fan);
    cwi_free(s->label);
    return ok;
}

/* Returns the number of fans around a vertex; sets *failed when memory is out. */
static size_t measure_ring(const work *w, part *p, one_ring *s)
{
    size_t fans = 0;
    if (order_closed_fan(s)) {
        for (size_t n = 0; n < s->count && !w->loops; n++)
            p->counts.edges += s->triangles[n].next > s->vertex;
        return 1;
    }
    p->failed = !measure_any_ring(w, p, s, &fans);
    return fans;
}

/* --- a range of vertices ------------------------------------------------------------------ */

/* Joins the corners of a triangle, and counts it, in the range of its first one. */
static void join_corners(const work *w, part *p, const uint32_t *c)
{
    p->joined += cwi_sets_join_shared(w->rings->sets, c[0], c[1]);
    p->joined += cwi_sets_join_shared(w->rings->sets, c[0], c[2]);
    p->counts.euler++;
}

/* Counts the triangles around each vertex, and sums the counts. */
static void count_leaves(const work *w, part *p, range *r)
{
    memset(r->begin, 0, sizeof r->begin);
    memset(r->is_named, 0, sizeof r->is_named);
    memset(r->is_bad, 0, sizeof r->is_bad);
    for (size_t i = 0; i < r->triangle_count; i++) {
        const uint32_t *c = w->rings->triangles + 3 * (size_t)r->triangle[i];
        const bool counts = !cwi_triangle_is_collapsed(c);
        for (int n = 0; n < 3; n++) {
            const uint32_t slot = c[n] - r->first; /* wraps round below the range */
            if (slot < r->size) {
                r->begin[slot + 2] += counts;
                r->is_named[slot] = true;
            }
        }
        if (counts && w->rings->sets && !w->loops && c[0] - r->first < r->size)
            join_corners(w, p, c);
    }
    for (size_t v = 2; v < (size_t)r->size + 2; v++)
        r->begin[v] += r->begin[v - 1];
}

/* Files the triangles under their vertices of the range: a counting sort. */
static bool file_leaves(const work *w, part *p, range *r)
{
    count_leaves(w, p, r);
    r->triangles = cwi_alloc_array(r->begin[r->size + 1], sizeof *r->triangles);
    for (size_t i = 0; i < r->triangle_count && r->triangles; i++) {
        const uint32_t *c = w->rings->triangles + 3 * (size_t)r->triangle[i];
        if (cwi_triangle_is_collapsed(c))
            continue;
        for (int n = 0; n < 3; n++) {
            const uint32_t slot = c[n] - r->first;
            if (slot < r->size)
                r->triangles[r->begin[slot + 1]++] =
                    (ring_triangle){c[(n + 1) % 3], c[(n + 2) % 3], r->triangle[i]};
        }
    }
    return r->triangles;
}

static void measure_vertex(const work *w, part *p, range *r, uint32_t slot)
{
    one_ring s = {.vertex = r->first + slot,
                  .count = r->begin[slot + 1] - r->begin[slot],
                  .triangles = r->triangles + r->begin[slot]};
    if (!s.count) {
        p->counts.unused_vertices += !r->is_named[slot];
        return;
    }
    const size_t fans = measure_ring(w, p, &s);
    p->counts.components++;
    p->counts.nonmanifold_vertices += fans > 1;
    r->is_bad[slot] = fans > 1;
    if (w->rings->used)
        w->rings->used[s.vertex] = 1;
}

/* Marks all triangles at vertices with several fans. */
static void mark_bad_vertices(const work *w, const range *r)
{
    for (size_t i = 0; i < r->triangle_count; i++)
        for (int n = 0; n < 3; n++) {
            const uint32_t slot =
                w->rings->triangles[3 * (size_t)r->triangle[i] + (size_t)n] - r->first;
            if (slot < r->size && r->is_bad[slot])
                mark_triangle(w, r->triangle[i], CW_DEFECT_NONMANIFOLD);
        }
}

static void measure_range(void *context, size_t k)
{
    const work *w = context;
    const cwi_one_rings *s = w->rings;
    part *p = &w->parts[k];
    const size_t first = s->begin + k * CWI_RANGE_VERTICES, left = s->end - first;
    range r = {.first = (uint32_t)first,
               .size = (uint32_t)(left < CWI_RANGE_VERTICES ? left : CWI_RANGE_VERTICES),
               .triangle = s->ranges->triangle + s->ranges->begin[k],
               .triangle_count = s->ranges->begin[k + 1] - s->ranges->begin[k]};
    p->failed = !file_leaves(w, p, &r);
    for (uint32_t slot = 0; slot < r.size && !p->failed; slot++)
        measure_vertex(w, p, &r, slot);
    if (p->counts.nonmanifold_vertices && s->defects && !p->failed)
        mark_bad_vertices(w, &r);
    cwi_free(r.triangles);
}

/* --- all of them -------------------------------------------------------------------------- */

static bool add_part(const part *p, cw_quality *q, cwi_border *border)
{
    const cw_quality *c = &p->counts;
    q->edges += c->edges;
    q->components += c->components - p->joined;
    q->unused_vertices += c->unused_vertices;
    q->open_edges += c->open_edges;
    q->nonmanifold_edges += c->nonmanifold_edges;
    q->contact_edges += c->contact_edges;
    q->misoriented_edges += c->misoriented_edges;
    q->nonmanifold_vertices += c->nonmanifold_vertices;
    q->contact_vertices += c->contact_vertices;
    q->duplicates += c->duplicates;
    q->euler += c->euler + (int64_t)c->components - (int64_t)c->edges;
    return !p->failed && (!border || cwi_border_append(border, &p->border));
}

static bool measure_ranges(work *w)
{
    const cwi_one_rings *s = w->rings;
    const cw_progress silent = {0};
    w->parts = cwi_alloc_zeroed(s->ranges->count, sizeof *w->parts);
    return w->parts && cwi_parallel_for(s->ranges->count, CWI_RANGE_VERTICES * 64, s->threads,
                                        s->progress ? s->progress : &silent, "checking",
                                        measure_range, w, NULL) == CW_OK;
}

bool cwi_measure_one_rings(const cwi_one_rings *rings, cw_quality *q, cwi_border *border)
{
    work w = {.rings = rings, .keeps_border = border};
    bool ok = measure_ranges(&w);
    for (size_t k = 0; k < rings->ranges->count && w.parts; k++) {
        ok = ok && add_part(&w.parts[k], q, border);
        cwi_border_free(&w.parts[k].border);
    }
    cwi_free(w.parts);
    return ok;
}

bool cwi_count_loops(const cwi_one_rings *rings, size_t open_edges, size_t *loops)
{
    work w = {.rings = rings, .loops = cwi_sets_alloc(3 * rings->count)};
    bool ok = w.loops && measure_ranges(&w);
    *loops = open_edges;
    for (size_t k = 0; k < rings->ranges->count && w.parts; k++) {
        ok = ok && !w.parts[k].failed;
        *loops -= w.parts[k].joined;
    }
    cwi_free(w.parts);
    cwi_free(w.loops);
    return ok;
}
