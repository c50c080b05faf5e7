/* Finds charts that lie on themselves. */
#include "simplify/atlas/atlas_state.h"

#include "core/base/memory.h"
#include "core/geometry/bvh.h"
#include "core/geometry/exact_predicates.h"
#include "core/geometry/vec3.h"

#include <string.h>

typedef struct crossing_search {
    const float (*ends)[2][3]; /* sides */
    const cwi_boxes *tree;
    size_t side;
    bool crosses;
} crossing_search;

/* Returns true if each of two segments has points on both sides of the other. */
static bool segments_cross(const float a[2][3], const float b[2][3])
{
    const int from = cwi_orient2d(a[0], a[1], b[0], 2), to = cwi_orient2d(a[0], a[1], b[1], 2);
    return from * to < 0 &&
           cwi_orient2d(b[0], b[1], a[0], 2) * cwi_orient2d(b[0], b[1], a[1], 2) < 0;
}

static bool visit_node(void *context, size_t node)
{
    crossing_search *s = context;
    const size_t begin = node * CWI_WIDTH,
                 end = begin + CWI_WIDTH < s->tree->count ? begin + CWI_WIDTH : s->tree->count;
    for (size_t slot = begin; slot < end && !s->crosses; slot++) {
        const size_t other = s->tree->order[slot];
        s->crosses = other > s->side && segments_cross(s->ends[s->side], s->ends[other]);
    }
    return !s->crosses;
}

/* Copies the ends of sides, and sets their boxes. */
static void list_sides(const cwi_chart *chart, float (*ends)[2][3], float (*boxes)[6])
{
    for (size_t n = 0; n < chart->border_count; n++)
        for (size_t k = 0; k < 3; k++) {
            for (size_t end = 0; end < 2; end++)
                ends[n][end][k] =
                    k < 2 ? (float)chart->uv[chart->border[2 * n + end]][k] : 0.0F;
            boxes[n][k] = fminf(ends[n][0][k], ends[n][1][k]);
            boxes[n][k + 3] = fmaxf(ends[n][0][k], ends[n][1][k]);
        }
}

/* Counts the loops of the outline that go around counter-clockwise. A vertex begins one side of the
 * outline: each fan of triangles has a vertex of its own. */
static size_t count_outer_loops(const cwi_chart *chart, uint32_t *next)
{
    const uint32_t none = UINT32_MAX;
    size_t outer = 0;
    for (size_t v = 0; v < chart->vertices; v++)
        next[v] = none;
    for (size_t n = 0; n < chart->border_count; n++)
        next[chart->border[2 * n]] = chart->border[2 * n + 1];
    for (size_t n = 0; n < chart->border_count; n++) {
        const double *first = chart->uv[chart->border[2 * n]];
        double area = 0;
        uint32_t v = chart->border[2 * n];
        while (next[v] != none) {
            const uint32_t to = next[v];
            const double *a = chart->uv[v], *b = chart->uv[to];
            area +=
                (a[0] - first[0]) * (b[1] - first[1]) - (a[1] - first[1]) * (b[0] - first[0]);
            next[v] = none;
            v = to;
        }
        outer += area > 0;
    }
    return outer;
}

/* Returns true if the triangles around a vertex go around it more than once. */
static bool has_wide_vertex(const cwi_chart *chart, double *angle)
{
    bool found = false;
    memset(angle, 0, chart->vertices * sizeof *angle);
    for (size_t t = 0; t < chart->triangles; t++)
        for (size_t k = 0; k < 3; k++) {
            const uint32_t *c = chart->corners + 3 * t;
            const double *p = chart->uv[c[k]], *q = chart->uv[c[(k + 1) % 3]],
                         *r = chart->uv[c[(k + 2) % 3]];
            const double a[2] = {q[0] - p[0], q[1] - p[1]}, b[2] = {r[0] - p[0], r[1] - p[1]};
            angle[c[k]] += atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
        }
    for (size_t v = 0; v < chart->vertices && !found; v++)
        found = angle[v] > 2 * CWI_PI * (1 + 1e-6);
    return found;
}

/* Returns true if the triangles around a vertex, or a hole of the outline, lie on others. */
static bool has_turned_hole(const cwi_chart *chart, bool *no_memory)
{
    uint32_t *next = cwi_alloc_array(chart->vertices, sizeof *next);
    double *angle = cwi_alloc_array(chart->vertices, sizeof *angle);
    const bool ok = next && angle;
    const bool found =
        ok && (count_outer_loops(chart, next) > 1 || has_wide_vertex(chart, angle));
    *no_memory = *no_memory || !ok;
    cwi_free(next);
    cwi_free(angle);
    return found;
}

bool cwi_chart_overlaps(const cwi_chart *chart, bool *no_memory)
{
    if (has_turned_hole(chart, no_memory))
        return true;
    float(*boxes)[6] = cwi_alloc_array(chart->border_count, sizeof *boxes);
    float(*ends)[2][3] = cwi_alloc_array(chart->border_count, sizeof *ends);
    cwi_boxes tree = {0};
    bool ok = boxes && ends && !*no_memory;
    if (ok) {
        list_sides(chart, ends, boxes);
        ok = cwi_boxes_build(&tree, (const float(*)[6])boxes, chart->border_count, NULL) ==
             CW_OK;
    }
    crossing_search search = {.ends = (const float(*)[2][3])ends, .tree = &tree};
    for (size_t n = 0; n < chart->border_count && ok && !search.crosses; n++) {
        search.side = n;
        cwi_boxes_visit(&tree, boxes[n], 0, visit_node, &search);
    }
    *no_memory = *no_memory || !ok;
    cwi_free(boxes);
    cwi_free(ends);
    cwi_boxes_free(&tree);
    return search.crosses;
}
