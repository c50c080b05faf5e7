/* The cheap checks: everything that one pass over the triangles around each vertex can say of a
 * mesh. */
#include "simplify/quality/topology.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/stop.h"
#include "core/geometry/union_find.h"
#include "core/mesh/corner_table.h"
#include "simplify/quality/shell_orientation.h"
#include "simplify/quality/triangle_shapes.h"
#include "simplify/quality/vertex_one_rings.h"
#include "simplify/quality/vertex_ranges.h"
#include "simplify/quality/welded_mesh.h"

#include <string.h>

typedef struct work {
    cwi_welded welded;
    const uint32_t *vertex; /* of each corner */
    size_t vertices, triangles;
    cwi_vertex_ranges ranges;
    uint32_t *part;     /* union-find: vertices that share triangles */
    uint8_t *used;      /* whether a vertex is in a triangle that names three */
    uint8_t *unbounded; /* why the edges from a vertex to higher ones bound no volume */
    cwi_stop stop;
} work;

/* Of the vertices as indexed: in no triangle, or at the place of another one. */
static bool count_used(const work *w, cw_quality *q)
{
    if (w->vertex == w->welded.mesh->triangles)
        return true;
    uint8_t *seen = cwi_alloc_zeroed(w->vertices, 1); /* 1: named, 2: named once welded */
    for (size_t c = 0; c < 3 * w->triangles && seen; c++) {
        seen[w->welded.mesh->triangles[c]] |= 1;
        seen[w->vertex[c]] |= 2;
    }
    q->unused_vertices = 0;
    for (size_t v = 0; v < w->vertices && seen; v++) {
        q->unused_vertices += !(seen[v] & 1);
        q->merged_vertices += seen[v] == 1;
    }
    const bool ok = seen;
    cwi_free(seen);
    return ok;
}

static bool prepare_arrays(work *w, const cw_quality_desc *d)
{
    w->vertex = w->welded.vertex;
    w->vertices = w->welded.mesh->vertex_count;
    w->triangles = w->welded.mesh->triangle_count;
    w->part = cwi_sets_alloc(w->vertices);
    w->used = cwi_alloc_zeroed(w->vertices, 1);
    w->unbounded = d->shells ? cwi_alloc_zeroed(w->vertices, 1) : NULL;
    return w->part && w->used && (w->unbounded || !d->shells) &&
           cwi_vertex_ranges_init(&w->ranges, w->vertex, w->triangles, 0, (uint32_t)w->vertices,
                                  d->threads);
}

/* --- one-sided components, such as Moebius strips ------------------------------------------ */

/* Triangles joined along edges of two, by union-find that knows who faces as its parent does. */
typedef struct sheet_sets {
    uint32_t *parent;
    bool *is_turned;    /* against its parent */
    bool *is_one_sided; /* of a root */
} sheet_sets;

/* Returns the root, and sets whether the triangle faces against it. */
static uint32_t find_root(const sheet_sets *s, uint32_t t, bool *is_turned)
{
    *is_turned = false;
    while (s->parent[t] != t) {
        const uint32_t up = s->parent[t];
        s->is_turned[t] ^= s->is_turned[up];
        s->parent[t] = s->parent[up]; /* is_turned of a root is false */
        *is_turned ^= s->is_turned[t];
        t = s->parent[t];
    }
    return t;
}

static void join_triangles(sheet_sets *s, uint32_t a, uint32_t b, bool disagrees)
{
    bool turned_a, turned_b;
    const uint32_t x = find_root(s, a, &turned_a), y = find_root(s, b, &turned_b);
    const uint32_t root = x < y ? x : y, child = x < y ? y : x;
    const bool is_turned = turned_a ^ turned_b ^ disagrees;
    if (x == y) {
        s->is_one_sided[x] |= is_turned;
        return;
    }
    s->parent[child] = root;
    s->is_turned[child] = is_turned;
    s->is_one_sided[root] |= s->is_one_sided[child];
}

static void join_sides(sheet_sets *s, const cwi_welded *welded, cwi_side *sides)
{
    const uint32_t *v = welded->vertex;
    const size_t triangles = welded->mesh->triangle_count;
    size_t count = 0;
    for (uint32_t c = 0; c < 3 * triangles; c++)
        if (!cwi_is_collapsed(welded, c / 3))
            sides[count++] = (cwi_side){cwi_edge_key(v[c], v[c - c % 3 + (c + 1) % 3]), c};
    cwi_sides_sort(sides, count);
    for (size_t n = 0, along; n < count; n += along) {
        along = cwi_sides_along(sides, count, n);
        if (along == 2) {
            const uint32_t a = sides[n].corner, b = sides[n + 1].corner;
            join_triangles(s, a / 3, b / 3, v[a] == v[b]);
        }
    }
}

/* Counts components, joined along edges of two triangles, whose triangles cannot all agree with their neighbours. False
 * when memory is out. */
static bool count_one_sided(const cwi_welded *welded, size_t *count)
{
    const size_t triangles = welded->mesh->triangle_count;
    sheet_sets s = {cwi_sets_alloc(triangles), cwi_alloc_zeroed(triangles, 1),
                    cwi_alloc_zeroed(triangles, 1)};
    cwi_side *sides = cwi_alloc_array(3 * triangles, sizeof *sides);
    const bool ok = s.parent && s.is_turned && s.is_one_sided && sides;
    if (ok)
        join_sides(&s, welded, sides);
    for (uint32_t t = 0; t < triangles && ok; t++)
        *count += s.parent[t] == t && s.is_one_sided[t];
    cwi_free(s.parent);
    cwi_free(s.is_turned);
    cwi_free(s.is_one_sided);
    cwi_free(sides);
    return ok;
}

/* --- the measurement ---------------------------------------------------------------------- */

static bool measure_topology(work *w, const cw_quality_desc *d, cw_quality *q)
{
    if (!prepare_arrays(w, d))
        return false;
    const cwi_one_rings rings = {.triangles = w->vertex,
                                 .count = w->triangles,
                                 .ranges = &w->ranges,
                                 .end = (uint32_t)w->vertices,
                                 .threads = d->threads,
                                 .progress = &d->progress,
                                 .defects = d->defects,
                                 .sets = w->part,
                                 .used = w->used,
                                 .unbounded = w->unbounded};
    if (!cwi_measure_one_rings(&rings, q, NULL) || !count_used(w, q))
        return false;
    if (q->open_edges && !cwi_count_loops(&rings, q->open_edges, &q->border_loops))
        return false;
    const bool oriented =
        !q->nonmanifold_edges && !q->misoriented_edges && !q->nonmanifold_vertices;
    q->genus =
        oriented ? (int64_t)q->components - (q->euler + (int64_t)q->border_loops) / 2 : -1;
    cwi_vertex_ranges_free(&w->ranges);
    if (d->shells && q->misoriented_edges && !count_one_sided(&w->welded, &q->one_sided))
        return false;
    const cwi_shells shells = {w->part, w->used, w->unbounded};
    return !d->shells || cwi_measure_shells(&w->welded, &shells, d, q);
}

static void free_work(work *w)
{
    cwi_welded_free(&w->welded);
    cwi_vertex_ranges_free(&w->ranges);
    cwi_free(w->part);
    cwi_free(w->used);
    cwi_free(w->unbounded);
}

static cw_status measure(const cw_mesh *mesh, const cw_quality_desc *desc, bool with_shapes,
                         cw_quality *out, cw_error *err)
{
    cw_quality_desc d = desc ? *desc : (cw_quality_desc){0};
    const cw_progress progress = d.progress;
    work w = {0};
    cwi_stop_init(&w.stop, &progress);
    d.progress = cwi_stop_progress(&w.stop);
    cw_quality q = {.vertices = mesh->vertex_count, .triangles = mesh->triangle_count};
    memset(out, 0, sizeof *out);
    cw_status st = cwi_welded_init(&w.welded, mesh, d.weld, err);
    const bool measured = st == CW_OK && measure_topology(&w, &d, &q) &&
                          (!with_shapes || cwi_measure_shapes(&w.welded, &d, &q));
    if (st == CW_OK && w.stop.stopped)
        st = cwi_fail(err, CW_ERR_CANCELLED, "interrupted while checking");
    else if (st == CW_OK && !measured)
        st = cwi_fail_memory(err);
    if (st == CW_OK) {
        cw_mesh_bounds(mesh, q.min, q.max);
        *out = q;
    }
    free_work(&w);
    return st;
}

cw_status cwi_measure_topology(const cw_mesh *mesh, const cw_quality_desc *desc,
                               cw_quality *out, cw_error *err)
{
    return measure(mesh, desc, false, out, err);
}

cw_status cw_quality_measure(const cw_mesh *mesh, const cw_quality_desc *desc, cw_quality *out,
                             cw_error *err)
{
    CWI_REQUIRE(err, mesh, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    return measure(mesh, desc, true, out, err);
}

size_t cw_quality_bytes(size_t vertices, size_t triangles)
{
    const work *w = NULL;
    const size_t triangle = 3 * sizeof *w->ranges.triangle;
    const size_t vertex = sizeof *w->part + sizeof *w->used + sizeof *w->unbounded +
                          2 * sizeof(double); /* of its component */
    return triangle * triangles + vertex * vertices;
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
