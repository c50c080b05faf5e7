/* The cheap checks: everything that one pass over sorted edges can say of a mesh. */
#include <cubewright/quality.h>

#include "core/memory.h"
#include "core/status.h"
#include "core/weld.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One side of a triangle, filed under the lower of its two vertices. Corner 3t + c is the side
 * from corner c of triangle t to the next. */
typedef struct side {
    uint32_t higher; /* the other vertex */
    uint32_t corner;
} side;

typedef struct work {
    const cw_mesh *mesh;
    uint32_t *vertex; /* of each corner, after welding; 3 x triangle_count */
    uint32_t *begin;  /* first side of each vertex, vertex_count + 1 */
    side *sides;      /* sorted by lower, then higher vertex, then corner */
    uint32_t *fan;    /* union-find: corners around one vertex that share edges */
    uint32_t *part;   /* union-find: vertices that share triangles */
    uint32_t *fans;   /* fans around each vertex */
} work;

static uint32_t find(uint32_t *parent, uint32_t x)
{
    while (parent[x] != x)
        x = parent[x] = parent[parent[x]];
    return x;
}

static void join(uint32_t *parent, uint32_t x, uint32_t y)
{
    x = find(parent, x);
    y = find(parent, y);
    parent[x > y ? x : y] = x > y ? y : x;
}

static uint32_t *identity(size_t count)
{
    uint32_t *parent = cwi_alloc_array(count, sizeof *parent);
    for (size_t i = 0; i < count && parent; i++)
        parent[i] = (uint32_t)i;
    return parent;
}

static uint32_t next_corner(uint32_t corner)
{
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

/* A triangle that names a vertex twice has no edges to speak of. */
static bool collapsed(const work *w, size_t t)
{
    const uint32_t *v = w->vertex + 3 * t;
    return v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
}

/* The points by which vertices are told apart. */
static bool weld(const cw_mesh *mesh, cw_weld how, uint32_t *map)
{
    const size_t count = mesh->vertex_count;
    if (how == CW_WELD_LOCAL)
        return cwi_weld(mesh->positions, count, map);
    float *points = cwi_alloc_array(count, 3 * sizeof *points);
    for (size_t i = 0; i < 3 * count && points; i++)
        points[i] = (float)(mesh->origin[i % 3] + (double)mesh->positions[i]);
    const bool ok = points && cwi_weld(points, count, map);
    cwi_free(points);
    return ok;
}

static bool load_corners(work *w, cw_weld how)
{
    const size_t corners = 3 * w->mesh->triangle_count;
    uint32_t *map = how ? cwi_alloc_array(w->mesh->vertex_count, sizeof *map) : NULL;
    w->vertex = cwi_alloc_array(corners, sizeof *w->vertex);
    bool ok = w->vertex && (!how || (map && weld(w->mesh, how, map)));
    for (size_t c = 0; c < corners && ok; c++) {
        const uint32_t v = w->mesh->triangles[c];
        w->vertex[c] = how ? map[v] : v;
    }
    cwi_free(map);
    return ok;
}

static void sort_bucket(side *s, size_t count)
{
    for (size_t i = 1; i < count; i++) {
        const side x = s[i];
        size_t j = i;
        for (; j > 0 && s[j - 1].higher > x.higher; j--)
            s[j] = s[j - 1];
        s[j] = x;
    }
}

static int compare_sides(const void *a, const void *b)
{
    const side *s = a, *t = b;
    if (s->higher != t->higher)
        return s->higher < t->higher ? -1 : 1;
    return s->corner < t->corner ? -1 : s->corner > t->corner;
}

static uint32_t lower_of(const work *w, uint32_t corner)
{
    const uint32_t v = w->vertex[corner], u = w->vertex[next_corner(corner)];
    return v < u ? v : u;
}

/* A counting sort by the lower vertex, then each vertex's few sides by the higher one. */
static bool sort_sides(work *w)
{
    const size_t vertices = w->mesh->vertex_count, corners = 3 * w->mesh->triangle_count;
    w->begin = cwi_alloc_zeroed(vertices + 2, sizeof *w->begin);
    w->sides = cwi_alloc_array(corners, sizeof *w->sides);
    if (!w->begin || !w->sides)
        return false;
    for (uint32_t c = 0; c < corners; c++)
        if (!collapsed(w, c / 3))
            w->begin[lower_of(w, c) + 2]++;
    for (size_t v = 2; v < vertices + 2; v++)
        w->begin[v] += w->begin[v - 1];
    for (uint32_t c = 0; c < corners; c++)
        if (!collapsed(w, c / 3)) {
            const uint32_t low = lower_of(w, c);
            const uint32_t high = w->vertex[c] ^ w->vertex[next_corner(c)] ^ low;
            w->sides[w->begin[low + 1]++] = (side){high, c};
        }
    for (size_t v = 0; v < vertices; v++) {
        side *bucket = w->sides + w->begin[v];
        const size_t count = w->begin[v + 1] - w->begin[v];
        if (count > 64) /* a hub: keep hostile meshes from quadratic time */
            qsort(bucket, count, sizeof *bucket, compare_sides);
        else
            sort_bucket(bucket, count);
    }
    return true;
}

/* One edge: the sides run[0..count) of the triangles around it. */
static void measure_edge(work *w, uint32_t low, const side *run, size_t count, cw_quality *q)
{
    q->edges++;
    q->open_edges += count == 1;
    q->nonmanifold_edges += count > 2;
    if (count == 2) {
        const bool same =
            (w->vertex[run[0].corner] == low) == (w->vertex[run[1].corner] == low);
        q->misoriented_edges += same;
    }
    for (size_t i = 0; i < count; i++) {
        const uint32_t c = run[i].corner, d = next_corner(c), first = run[0].corner;
        const uint32_t c0 = w->vertex[first] == w->vertex[c] ? first : next_corner(first);
        const uint32_t d0 = w->vertex[first] == w->vertex[c] ? next_corner(first) : first;
        join(w->fan, c0, c);
        join(w->fan, d0, d);
        join(w->part, w->vertex[c], w->vertex[d]);
    }
}

static void measure_edges(work *w, cw_quality *q)
{
    for (size_t v = 0; v < w->mesh->vertex_count; v++)
        for (uint32_t i = w->begin[v], end = w->begin[v + 1], n; i < end; i += n) {
            for (n = 1; i + n < end && w->sides[i + n].higher == w->sides[i].higher;)
                n++;
            measure_edge(w, (uint32_t)v, w->sides + i, n, q);
        }
}

/* A vertex is a component's or fan's own when it is the root of its set. */
static void measure_vertices(work *w, cw_quality *q)
{
    size_t used = 0;
    for (uint32_t c = 0; c < 3 * w->mesh->triangle_count; c++)
        if (!collapsed(w, c / 3) && w->fan[c] == c)
            w->fans[w->vertex[c]]++;
    for (uint32_t v = 0; v < w->mesh->vertex_count; v++) {
        used += w->fans[v] > 0;
        q->nonmanifold_vertices += w->fans[v] > 1;
        q->components += w->fans[v] > 0 && w->part[v] == v;
    }
    q->unused_vertices = q->vertices - used;
    q->euler += (int64_t)used - (int64_t)q->edges;
}

static void measure_triangles(const work *w, cw_quality *q)
{
    const float *p = w->mesh->positions;
    for (size_t t = 0; t < w->mesh->triangle_count; t++) {
        const uint32_t *v = w->mesh->triangles + 3 * t;
        double a[3], b[3], c[3], n[3];
        for (size_t k = 0; k < 3; k++) {
            a[k] = (double)p[3 * (size_t)v[0] + k];
            b[k] = (double)p[3 * (size_t)v[1] + k] - a[k];
            c[k] = (double)p[3 * (size_t)v[2] + k] - a[k];
        }
        for (int k = 0; k < 3; k++)
            n[k] = b[(k + 1) % 3] * c[(k + 2) % 3] - b[(k + 2) % 3] * c[(k + 1) % 3];
        const double area = 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        q->area_mm2 += area;
        q->volume_mm3 += (n[0] * a[0] + n[1] * a[1] + n[2] * a[2]) / 6;
        q->degenerate += !(area > 0) || collapsed(w, t);
        q->euler += !collapsed(w, t);
    }
}

static bool prepare(work *w, cw_weld how)
{
    if (!load_corners(w, how) || !sort_sides(w))
        return false;
    w->fan = identity(3 * w->mesh->triangle_count);
    w->part = identity(w->mesh->vertex_count);
    w->fans = cwi_alloc_zeroed(w->mesh->vertex_count, sizeof *w->fans);
    return w->fan && w->part && w->fans;
}

cw_status cw_quality_measure(const cw_mesh *mesh, const cw_quality_desc *desc, cw_quality *out,
                             cw_error *err)
{
    work w = {.mesh = mesh};
    cw_quality q = {.vertices = mesh->vertex_count, .triangles = mesh->triangle_count};
    memset(out, 0, sizeof *out);
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK && mesh->triangle_count > UINT32_MAX / 3)
        st = cw_fail(err, CW_ERR_LIMIT, "%zu triangles are more than the checks can number",
                     mesh->triangle_count);
    if (st == CW_OK && !prepare(&w, desc ? desc->weld : CW_WELD_NONE))
        st = cw_fail(err, CW_ERR_NO_MEMORY, "no memory to check %zu triangles",
                     mesh->triangle_count);
    if (st == CW_OK) {
        measure_edges(&w, &q);
        measure_vertices(&w, &q);
        measure_triangles(&w, &q);
        cw_mesh_bounds(mesh, q.min, q.max);
        *out = q;
    }
    cwi_free(w.vertex);
    cwi_free(w.begin);
    cwi_free(w.sides);
    cwi_free(w.fan);
    cwi_free(w.part);
    cwi_free(w.fans);
    return st;
}

bool cw_quality_is_closed_manifold(const cw_quality *q)
{
    return !q->open_edges && !q->nonmanifold_edges && !q->misoriented_edges &&
           !q->nonmanifold_vertices;
}
