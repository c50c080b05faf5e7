#include "cli/inputs/missing_components.h"

#include "core/base/status.h"
#include "core/geometry/union_find.h"

#include <math.h>
#include <stdlib.h>

/* Arrays of a value a vertex; of a component at its root. */
typedef struct work {
    uint32_t *part;
    float *least, *most; /* distances */
    double *volume;
} work;

static bool prepare_work(work *w, const cw_mesh *m)
{
    const size_t count = m->vertex_count + 1;
    w->part = cwi_sets_alloc(count);
    w->least = calloc(count, sizeof *w->least);
    w->most = calloc(count, sizeof *w->most);
    w->volume = calloc(count, sizeof *w->volume);
    return w->part && w->least && w->most && w->volume;
}

/* Six times what a triangle and the mesh's origin enclose. */
static double volume_of(const cw_mesh *m, size_t t)
{
    const uint32_t *c = m->triangles + 3 * t;
    const float *a = m->positions + 3 * (size_t)c[0], *b = m->positions + 3 * (size_t)c[1],
                *d = m->positions + 3 * (size_t)c[2];
    const double x[3] = {(double)a[0], (double)a[1], (double)a[2]};
    const double y[3] = {(double)b[0], (double)b[1], (double)b[2]};
    const double z[3] = {(double)d[0], (double)d[1], (double)d[2]};
    return x[0] * (y[1] * z[2] - y[2] * z[1]) + x[1] * (y[2] * z[0] - y[0] * z[2]) +
           x[2] * (y[0] * z[1] - y[1] * z[0]);
}

static void measure_components(work *w, const cw_mesh *m, const float *distance)
{
    for (size_t t = 0; t < m->triangle_count; t++) {
        cwi_sets_join(w->part, m->triangles[3 * t], m->triangles[3 * t + 1]);
        cwi_sets_join(w->part, m->triangles[3 * t], m->triangles[3 * t + 2]);
    }
    for (uint32_t v = 0; v < m->vertex_count; v++) {
        const uint32_t root = cwi_sets_find(w->part, v); /* the least of its set: comes first */
        w->least[root] = root == v ? distance[v] : fminf(w->least[root], distance[v]);
        w->most[root] = fmaxf(w->most[root], distance[v]);
    }
    for (size_t t = 0; t < m->triangle_count; t++)
        w->volume[cwi_sets_find(w->part, m->triangles[3 * t])] += volume_of(m, t) / 6;
}

/* A vertex that is kept gets its new number, in the place of its root; the rest goes. */
static void keep_near(work *w, cw_mesh *m, double near)
{
    uint32_t *number = w->part;
    size_t vertices = 0, triangles = 0;
    for (uint32_t v = 0; v < m->vertex_count; v++)
        number[v] = cwi_sets_find(w->part, v);
    for (size_t v = 0; v < m->vertex_count; v++)
        number[v] = (double)w->least[number[v]] <= near ? 1 : 0;
    for (size_t v = 0; v < m->vertex_count; v++) {
        const bool kept = number[v];
        number[v] = kept ? (uint32_t)vertices : UINT32_MAX;
        for (size_t a = 0; a < 3 && kept; a++)
            m->positions[3 * vertices + a] = m->positions[3 * v + a];
        vertices += kept;
    }
    for (size_t t = 0; t < m->triangle_count; t++) {
        if (number[m->triangles[3 * t]] == UINT32_MAX)
            continue;
        for (size_t c = 0; c < 3; c++)
            m->triangles[3 * triangles + c] = number[m->triangles[3 * t + c]];
        triangles++;
    }
    m->vertex_count = vertices;
    m->triangle_count = triangles;
}

cw_status cli_drop_missing(cw_mesh *surface, const float *distance_mm, double near_mm,
                           cli_missing *missing, cw_error *err)
{
    work w = {0};
    *missing = (cli_missing){0};
    const bool ready = prepare_work(&w, surface);
    if (ready)
        measure_components(&w, surface, distance_mm);
    for (uint32_t v = 0; ready && v < surface->vertex_count; v++)
        if (w.part[v] == v && (double)w.least[v] > near_mm) {
            missing->count++;
            missing->largest_mm3 = fmax(missing->largest_mm3, fabs(w.volume[v]));
            missing->max_mm = fmax(missing->max_mm, (double)w.most[v]);
        }
    if (missing->count)
        keep_near(&w, surface, near_mm);
    cwi_free(w.part);
    free(w.least);
    free(w.most);
    free(w.volume);
    return ready ? CW_OK
                 : cw_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu vertices",
                           surface->vertex_count);
}
