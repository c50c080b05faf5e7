/* Measures the volumes of components and their gradients, triangle by triangle in a fixed order, so
 * that sums do not depend on threads. */
#include "simplify/smoothing/kept_volumes.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/union_find.h"
#include "core/geometry/vec3.h"

/* Joins vertices to components and numbers these by their first vertices. */
static void number_components(const cw_mesh *mesh, cwi_kept_volumes *v)
{
    uint32_t *sets = v->component, count = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++)
        for (size_t c = 1; c < 3; c++)
            cwi_sets_join(sets, mesh->triangles[3 * t], mesh->triangles[3 * t + c]);
    for (uint32_t n = 0; n < mesh->vertex_count; n++)
        sets[n] = cwi_sets_find(sets, n);
    for (uint32_t n = 0; n < mesh->vertex_count; n++) /* the first of a set is its root */
        sets[n] = sets[n] == n ? count++ : sets[sets[n]];
    v->count = count;
}

/* Returns six times the volume of the tetrahedron between a triangle and a point. */
static double measure_sixfold(const double *positions, const uint32_t *corners,
                              const double reference[3])
{
    double from[3][3], area[3];
    for (int c = 0; c < 3; c++)
        for (size_t a = 0; a < 3; a++)
            from[c][a] = positions[3 * (size_t)corners[c] + a] - reference[a];
    cwi_cross(from[1], from[2], area);
    return cwi_dot(from[0], area);
}

void cwi_volumes_measure(cwi_kept_volumes *volumes, const double *positions)
{
    const cw_mesh *mesh = volumes->mesh;
    for (size_t n = 0; n < volumes->count; n++)
        volumes->items[n].now = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *corners = mesh->triangles + 3 * t;
        cwi_kept_volume *item = &volumes->items[volumes->component[corners[0]]];
        const float *first = mesh->positions + 3 * (size_t)item->reference;
        const double reference[3] = {(double)first[0], (double)first[1], (double)first[2]};
        item->now += measure_sixfold(positions, corners, reference) / 6;
    }
}

void cwi_volumes_gradients(cwi_kept_volumes *volumes, const double *positions,
                           const uint8_t *borders, double *gradients)
{
    const cw_mesh *mesh = volumes->mesh;
    for (size_t n = 0; n < volumes->count; n++)
        volumes->items[n].area = volumes->items[n].now = 0;
    for (size_t n = 0; n < 3 * mesh->vertex_count; n++)
        gradients[n] = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *corners = mesh->triangles + 3 * t;
        const double *p = positions + 3 * (size_t)corners[0],
                     *q = positions + 3 * (size_t)corners[1],
                     *r = positions + 3 * (size_t)corners[2];
        const double pq[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]},
                     pr[3] = {r[0] - p[0], r[1] - p[1], r[2] - p[2]};
        cwi_kept_volume *item = &volumes->items[volumes->component[corners[0]]];
        const float *first = mesh->positions + 3 * (size_t)item->reference;
        const double from[3] = {p[0] - (double)first[0], p[1] - (double)first[1],
                                p[2] - (double)first[2]};
        double area[3];
        cwi_cross(pq, pr, area);
        item->now += cwi_dot(from, area) / 6;
        for (int c = 0; c < 3; c++)
            for (size_t a = 0; a < 3; a++)
                gradients[3 * (size_t)corners[c] + a] += area[a] / 6;
    }
    for (size_t n = 0; n < mesh->vertex_count; n++) {
        const double *gradient = gradients + 3 * n;
        if (borders[n] == CWI_BORDER_NONE)
            volumes->items[volumes->component[n]].area += cwi_length(gradient);
    }
}

double cwi_volumes_sum(const cwi_kept_volumes *volumes, bool before)
{
    double sum = 0;
    for (size_t n = 0; n < volumes->count; n++)
        if (!volumes->items[n].is_branched)
            sum += before ? volumes->items[n].before : volumes->items[n].now;
    return sum;
}

cw_status cwi_volumes_find(const cw_mesh *mesh, const uint8_t *borders, const double *positions,
                           cwi_kept_volumes *volumes, cw_error *err)
{
    *volumes = (cwi_kept_volumes){.mesh = mesh};
    volumes->component = cwi_sets_alloc(mesh->vertex_count);
    if (volumes->component)
        number_components(mesh, volumes);
    volumes->items = cwi_alloc_zeroed(volumes->count, sizeof *volumes->items);
    if (!volumes->component || !volumes->items)
        return cwi_fail_memory(err);
    for (size_t n = mesh->vertex_count; n-- > 0;) {
        cwi_kept_volume *item = &volumes->items[volumes->component[n]];
        item->reference = (uint32_t)n;
        item->is_open = item->is_open || borders[n] == CWI_BORDER_OPEN;
        item->is_branched = item->is_branched || borders[n] == CWI_BORDER_JUNCTION;
    }
    cwi_volumes_measure(volumes, positions);
    for (size_t n = 0; n < volumes->count; n++)
        volumes->items[n].before = volumes->items[n].now;
    return CW_OK;
}

void cwi_volumes_free(cwi_kept_volumes *volumes)
{
    cwi_free(volumes->component);
    cwi_free(volumes->items);
    *volumes = (cwi_kept_volumes){0};
}
