/* The cheap checks: everything that one pass over sorted edges can say of a mesh. */
#include <cubewright/quality.h>

#include "core/base/status.h"
#include "core/base/stop.h"
#include "core/geometry/union_find.h"
#include "simplify/quality/shell_orientation.h"
#include "simplify/quality/triangle_shapes.h"
#include "simplify/quality/welded_mesh.h"

#include <stdlib.h>
#include <string.h>

/* One side of a triangle, filed under the lower of its two vertices. Corner 3t + c is the side
 * from corner c of triangle t to the next. */
typedef struct side {
    uint32_t higher; /* the other vertex */
    uint32_t third;  /* the vertex across from it */
    uint32_t corner;
} side;

typedef struct work {
    cwi_welded welded;
    const uint32_t *vertex; /* of each corner */
    size_t vertices, corners;
    uint8_t *defects; /* or NULL */
    uint32_t *begin;  /* first side of each vertex, vertices + 1 */
    side *sides;      /* sorted by lower, higher, third vertex, then corner */
    uint32_t *fan;    /* union-find: corners around one vertex that share edges */
    uint32_t *part;   /* union-find: vertices that share triangles */
    uint32_t *fans;   /* fans around each vertex */
    double *volume;   /* of the component whose root a vertex is, seen from that vertex */
    double *area;     /* of that component */
    cwi_stop stop;
    cw_progress progress; /* asks stop */
    uint8_t *unbounded;   /* whether that component bounds no volume: 1 open, else 2 or 3 */
} work;

/* The sides of the triangles around one edge. */
typedef struct edge {
    uint32_t low; /* its lower vertex */
    uint32_t begin, count;
} edge;

/* Asks in every 65536th turn of a loop whether to go on. */
static bool goes_on(const work *w, size_t turn)
{
    return turn % 65536 || cwi_progress(&w->progress, "checking", -1, NULL) == CW_OK;
}

static void mark_defect(const work *w, size_t triangle, cw_defect defect)
{
    if (w->defects)
        w->defects[triangle] |= (uint8_t)defect;
}

static int compare_sides(const void *a, const void *b)
{
    const side *s = a, *t = b;
    if (s->higher != t->higher)
        return s->higher < t->higher ? -1 : 1;
    if (s->third != t->third)
        return s->third < t->third ? -1 : 1;
    return s->corner < t->corner ? -1 : s->corner > t->corner;
}

static void sort_bucket(side *s, size_t count)
{
    for (size_t i = 1; i < count; i++) {
        const side x = s[i];
        size_t j = i;
        for (; j > 0 && compare_sides(&s[j - 1], &x) > 0; j--)
            s[j] = s[j - 1];
        s[j] = x;
    }
}

static uint32_t lower_of(const work *w, uint32_t corner)
{
    const uint32_t v = w->vertex[corner], u = w->vertex[cwi_next_corner(corner)];
    return v < u ? v : u;
}

static bool file_sides(work *w)
{
    for (uint32_t c = 0; c < w->corners && goes_on(w, c); c++)
        if (!cwi_is_collapsed(&w->welded, c / 3))
            w->begin[lower_of(w, c) + 2]++;
    for (size_t v = 2; v < w->vertices + 2; v++)
        w->begin[v] += w->begin[v - 1];
    if (w->stop.stopped)
        return false;
    for (uint32_t c = 0; c < w->corners && goes_on(w, c); c++)
        if (!cwi_is_collapsed(&w->welded, c / 3)) {
            const uint32_t d = cwi_next_corner(c), low = lower_of(w, c);
            w->sides[w->begin[low + 1]++] =
                (side){w->vertex[c] ^ w->vertex[d] ^ low, w->vertex[cwi_next_corner(d)], c};
        }
    return !w->stop.stopped;
}

/* A counting sort by the lower vertex, then each vertex's few sides by the others. */
static bool sort_sides(work *w)
{
    if (!file_sides(w))
        return false;
    for (size_t v = 0; v < w->vertices && goes_on(w, v); v++) {
        side *bucket = w->sides + w->begin[v];
        const size_t count = w->begin[v + 1] - w->begin[v];
        if (count > 64) /* a hub: keep hostile meshes from quadratic time */
            qsort(bucket, count, sizeof *bucket, compare_sides);
        else
            sort_bucket(bucket, count);
    }
    return !w->stop.stopped;
}

/* Moves on to the next edge; false behind the last. Start with a zeroed edge. */
static bool next_edge(const work *w, edge *e)
{
    e->begin += e->count;
    e->count = 1;
    while (e->low < w->vertices && e->begin == w->begin[e->low + 1])
        e->low++;
    if (e->low == w->vertices)
        return false;
    const uint32_t end = w->begin[e->low + 1], higher = w->sides[e->begin].higher;
    while (e->begin + e->count < end && w->sides[e->begin + e->count].higher == higher)
        e->count++;
    return true;
}

static bool runs_up(const work *w, const edge *e, const side *s)
{
    return w->vertex[s->corner] == e->low;
}

static void mark_edge(const work *w, const edge *e, cw_defect defect)
{
    for (uint32_t i = 0; i < e->count && w->defects; i++)
        mark_defect(w, w->sides[e->begin + i].corner / 3, defect);
}

/* A triangle is met at three edges: it counts at that of its two lower vertices. */
static void count_duplicates(const work *w, const edge *e, cw_quality *q)
{
    const side *s = w->sides + e->begin;
    for (uint32_t i = 1; i < e->count; i++)
        if (s[i].third == s[i - 1].third && s[i].third > s[i].higher) {
            q->duplicates++;
            mark_defect(w, s[i].corner / 3, CW_DEFECT_DUPLICATE);
            mark_defect(w, s[i - 1].corner / 3, CW_DEFECT_DUPLICATE);
        }
}

/* Corners at the same vertex of triangles around one edge belong to one fan. */
static void join_around(work *w, const edge *e)
{
    const side *s = w->sides + e->begin;
    const uint32_t first = s->corner, second = cwi_next_corner(first);
    cwi_sets_join(w->part, w->vertex[first], w->vertex[second]);
    for (uint32_t i = 1; i < e->count; i++) {
        const uint32_t c = s[i].corner, d = cwi_next_corner(c);
        const bool same = w->vertex[c] == w->vertex[first];
        cwi_sets_join(w->fan, same ? first : second, c);
        cwi_sets_join(w->fan, same ? second : first, d);
    }
}

static void measure_edges(work *w, cw_quality *q)
{
    for (edge e = {0}; goes_on(w, q->edges) && next_edge(w, &e);) {
        const side *s = w->sides + e.begin;
        q->edges++;
        join_around(w, &e);
        if (e.count == 1) {
            q->open_edges++;
            mark_edge(w, &e, CW_DEFECT_OPEN);
        } else if (e.count > 2) {
            q->nonmanifold_edges++;
            mark_edge(w, &e, CW_DEFECT_NONMANIFOLD);
        } else if (runs_up(w, &e, &s[0]) == runs_up(w, &e, &s[1])) {
            q->misoriented_edges++;
            mark_edge(w, &e, CW_DEFECT_MISORIENTED);
        }
        if (e.count > 1)
            count_duplicates(w, &e, q);
    }
}

/* Whether a component bounds a volume: two triangles at each edge, run through in opposite
 * ways. */
static void find_unbounded(work *w)
{
    for (edge e = {0}; next_edge(w, &e);) {
        const side *s = w->sides + e.begin;
        if (e.count != 2 || runs_up(w, &e, &s[0]) == runs_up(w, &e, &s[1]))
            w->unbounded[cwi_sets_find(w->part, e.low)] |= e.count == 1 ? 1 : 2;
    }
}

/* Chains of open edges run on within a fan of triangles, from one end of it to the other. */
static bool count_loops(work *w, cw_quality *q)
{
    if (!q->open_edges)
        return true;
    uint32_t *loop = cwi_sets_alloc(w->corners);
    uint8_t *seen = cwi_alloc_zeroed(w->corners, 1);
    const bool ok = loop && seen;
    for (edge e = {0}; ok && next_edge(w, &e);) {
        const uint32_t c = w->sides[e.begin].corner;
        if (e.count == 1)
            cwi_sets_join(loop, cwi_sets_find(w->fan, c),
                          cwi_sets_find(w->fan, cwi_next_corner(c)));
    }
    for (edge e = {0}; ok && next_edge(w, &e);) {
        const uint32_t root =
            cwi_sets_find(loop, cwi_sets_find(w->fan, w->sides[e.begin].corner));
        if (e.count == 1 && !seen[root]) {
            seen[root] = 1;
            q->border_loops++;
        }
    }
    cwi_free(loop);
    cwi_free(seen);
    return ok;
}

static void count_fans(work *w)
{
    for (uint32_t c = 0; c < w->corners; c++)
        if (!cwi_is_collapsed(&w->welded, c / 3) && w->fan[c] == c)
            w->fans[w->vertex[c]]++;
    for (uint32_t c = 0; c < w->corners && w->defects; c++)
        if (w->fans[w->vertex[c]] > 1)
            mark_defect(w, c / 3, CW_DEFECT_NONMANIFOLD);
}

/* Of the vertices as indexed: in no triangle, or at the place of another one. */
static bool count_used(const work *w, cw_quality *q)
{
    uint8_t *seen = cwi_alloc_zeroed(w->vertices, 1); /* 1: named, 2: named once welded */
    for (size_t c = 0; c < w->corners && seen; c++) {
        seen[w->welded.mesh->triangles[c]] |= 1;
        seen[w->vertex[c]] |= 2;
    }
    for (size_t v = 0; v < w->vertices && seen; v++) {
        q->unused_vertices += !(seen[v] & 1);
        q->merged_vertices += seen[v] == 1;
    }
    const bool ok = seen;
    cwi_free(seen);
    return ok;
}

/* A vertex stands for its component when it is the root of its set. */
static void measure_vertices(work *w, cw_quality *q)
{
    size_t used = 0;
    for (uint32_t v = 0; v < w->vertices; v++) {
        used += w->fans[v] > 0;
        q->nonmanifold_vertices += w->fans[v] > 1;
        q->components += w->fans[v] > 0 && w->part[v] == v;
    }
    q->euler += (int64_t)used - (int64_t)q->edges;
}

static void measure_components(work *w, cw_quality *q)
{
    for (size_t t = 0; t < w->corners / 3 && goes_on(w, t); t++)
        if (!cwi_is_collapsed(&w->welded, t)) {
            const uint32_t root = cwi_sets_find(w->part, w->vertex[3 * t]);
            q->euler++;
            cwi_add_triangle(w->welded.mesh, t, root, &w->volume[root], &w->area[root]);
        }
}

static bool prepare_arrays(work *w)
{
    w->vertex = w->welded.vertex;
    w->vertices = w->welded.mesh->vertex_count;
    w->corners = 3 * w->welded.mesh->triangle_count;
    w->begin = cwi_alloc_zeroed(w->vertices + 2, sizeof *w->begin);
    w->sides = cwi_alloc_array(w->corners, sizeof *w->sides);
    w->fan = cwi_sets_alloc(w->corners);
    w->part = cwi_sets_alloc(w->vertices);
    w->fans = cwi_alloc_zeroed(w->vertices, sizeof *w->fans);
    w->volume = cwi_alloc_zeroed(w->vertices, sizeof *w->volume);
    w->area = cwi_alloc_zeroed(w->vertices, sizeof *w->area);
    w->unbounded = cwi_alloc_zeroed(w->vertices, 1);
    return w->begin && w->sides && w->fan && w->part && w->fans && w->volume && w->area &&
           w->unbounded;
}

static bool measure_topology(work *w, const cw_quality_desc *d, cw_quality *q)
{
    if (!prepare_arrays(w) || !sort_sides(w))
        return false;
    measure_edges(w, q);
    if (w->stop.stopped || !count_loops(w, q))
        return false;
    count_fans(w);
    measure_vertices(w, q);
    if (!count_used(w, q))
        return false;
    find_unbounded(w);
    measure_components(w, q);
    const bool oriented =
        !q->nonmanifold_edges && !q->misoriented_edges && !q->nonmanifold_vertices;
    q->genus =
        oriented ? (int64_t)q->components - (q->euler + (int64_t)q->border_loops) / 2 : -1;
    const cwi_shells shells = {w->part, w->fans, w->volume, w->area, w->unbounded};
    return !d->shells || cwi_measure_shells(&w->welded, &shells, d, q);
}

static void free_work(work *w)
{
    cwi_welded_free(&w->welded);
    cwi_free(w->begin);
    cwi_free(w->sides);
    cwi_free(w->fan);
    cwi_free(w->part);
    cwi_free(w->fans);
    cwi_free(w->volume);
    cwi_free(w->area);
    cwi_free(w->unbounded);
}

cw_status cw_quality_measure(const cw_mesh *mesh, const cw_quality_desc *desc, cw_quality *out,
                             cw_error *err)
{
    CWI_REQUIRE(err, mesh, out);
    cw_quality_desc d = desc ? *desc : (cw_quality_desc){0};
    const cw_progress progress = d.progress;
    work w = {.defects = d.defects};
    cwi_stop_init(&w.stop, &progress);
    d.progress = w.progress = cwi_stop_progress(&w.stop);
    cw_quality q = {.vertices = mesh->vertex_count, .triangles = mesh->triangle_count};
    memset(out, 0, sizeof *out);
    cw_status st = cwi_welded_init(&w.welded, mesh, d.weld, err);
    const bool measured =
        st == CW_OK && measure_topology(&w, &d, &q) && cwi_measure_shapes(&w.welded, &d, &q);
    if (st == CW_OK && w.stop.stopped)
        st = cwi_fail(err, CW_ERR_CANCELLED, "interrupted while checking");
    else if (st == CW_OK && !measured)
        st = cwi_fail(err, CW_ERR_NO_MEMORY, "no memory to check %zu triangles",
                      mesh->triangle_count);
    if (st == CW_OK) {
        cw_mesh_bounds(mesh, q.min, q.max);
        *out = q;
    }
    free_work(&w);
    return st;
}

size_t cw_quality_bytes(size_t vertices, size_t triangles)
{
    const work *w = NULL;
    const size_t corner = sizeof *w->sides + sizeof *w->fan;
    const size_t vertex = sizeof *w->begin + sizeof *w->part + sizeof *w->fans +
                          sizeof *w->volume + sizeof *w->area + sizeof *w->unbounded + 1;
    return 3 * corner * triangles + vertex * vertices;
}

bool cw_quality_is_closed_manifold(const cw_quality *q)
{
    if (!q)
        return false;
    return !q->open_edges && !q->nonmanifold_edges && !q->misoriented_edges &&
           !q->nonmanifold_vertices;
}

cw_status cw_quality_compare(const cw_quality *before, const cw_quality *after, cw_error *err)
{
    CWI_REQUIRE(err, before, after);
    const struct {
        const char *what;
        long long before, after;
        bool fewer; /* is as good */
    } facts[] = {
        {"components", (long long)before->components, (long long)after->components, false},
        {"Euler number", before->euler, after->euler, false},
        {"border loops", (long long)before->border_loops, (long long)after->border_loops,
         false},
        {"non-manifold edges", (long long)before->nonmanifold_edges,
         (long long)after->nonmanifold_edges, true},
        {"non-manifold vertices", (long long)before->nonmanifold_vertices,
         (long long)after->nonmanifold_vertices, true},
        {"triangles without area", (long long)before->degenerate, (long long)after->degenerate,
         true},
    };
    for (size_t n = 0; n < sizeof facts / sizeof *facts; n++)
        if (facts[n].after != facts[n].before &&
            !(facts[n].fewer && facts[n].after < facts[n].before))
            return cwi_fail(err, CW_ERR_CHECK, "%s: %lld before, %lld after", facts[n].what,
                            facts[n].before, facts[n].after);
    return CW_OK;
}
