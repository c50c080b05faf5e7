/* Finds the components of a mesh, their boxes, and the volumes that they enclose. */
#include "core/mesh/components.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/union_find.h"

#include <math.h>

void cwi_components_free(cwi_components *c)
{
    cwi_free(c->set);
    cwi_free(c->boxes);
    cwi_free(c->sums);
    cwi_free(c->cavity);
    cwi_free(c->dropped);
    cwi_free(c->met);
}

/* Joins vertices to sets and numbers them. Returns false when memory is out. */
static bool number_sets(const cw_mesh *m, const uint32_t *same, cwi_components *c)
{
    uint32_t *sets = c->set = cwi_sets_alloc(m->vertex_count), count = 0;
    if (!sets)
        return false;
    for (uint32_t v = 0; v < m->vertex_count && same; v++)
        cwi_sets_join(sets, v, same[v]);
    for (size_t t = 0; t < m->triangle_count; t++)
        for (size_t k = 1; k < 3; k++)
            cwi_sets_join(sets, m->triangles[3 * t], m->triangles[3 * t + k]);
    for (uint32_t v = 0; v < m->vertex_count; v++)
        sets[v] = cwi_sets_find(sets, v);
    for (uint32_t v = 0; v < m->vertex_count; v++) /* the first of a set is its root */
        sets[v] = sets[v] == v ? count++ : sets[sets[v]];
    c->count = count;
    return true;
}

cw_status cwi_components_find(const cw_mesh *m, const uint32_t *same, cwi_components *c,
                              cw_error *err)
{
    const bool numbered = number_sets(m, same, c);
    c->boxes = cwi_alloc_array(c->count, sizeof *c->boxes);
    c->dropped = cwi_alloc_zeroed(c->count, sizeof *c->dropped);
    c->met = cwi_alloc_zeroed(c->count, sizeof *c->met);
    if (!numbered || !c->boxes || !c->dropped || !c->met)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < c->count; n++)
        for (size_t a = 0; a < 3; a++) {
            c->boxes[n][a] = INFINITY;
            c->boxes[n][3 + a] = -INFINITY;
        }
    for (size_t v = 0; v < m->vertex_count; v++) {
        float *box = c->boxes[c->set[v]];
        for (size_t a = 0; a < 3; a++) {
            const float p = m->positions[3 * v + a];
            box[a] = p < box[a] ? p : box[a];
            box[3 + a] = p > box[3 + a] ? p : box[3 + a];
        }
    }
    return CW_OK;
}

static float find_largest(const cw_mesh *m)
{
    float largest = 0;
    for (size_t n = 0; n < 3 * m->vertex_count; n++) {
        const float size = fabsf(m->positions[n]);
        largest = size > largest ? size : largest;
    }
    return largest;
}

/* Sums the tetrahedra up to the middle of the box. Corners are taken twice from there, as the
 * middle may be half a unit. */
cw_status cwi_components_measure(const cw_mesh *m, cwi_components *c, cw_error *err)
{
    cwi_volume_sum(*areas)[3] = cwi_alloc_zeroed(c->count, sizeof *areas);
    c->sums = cwi_alloc_zeroed(c->count, sizeof *c->sums);
    c->cavity = cwi_alloc_zeroed(c->count, sizeof *c->cavity);
    if (!areas || !c->sums || !c->cavity) {
        cwi_free(areas);
        return cwi_fail_memory(err);
    }
    c->unit = cwi_volume_unit_for(find_largest(m));
    for (size_t t = 0; t < m->triangle_count; t++) {
        const uint32_t set = c->set[m->triangles[3 * t]];
        const float *box = c->boxes[set];
        int64_t corner[3][3], area[3], twice[3];
        for (size_t n = 0; n < 9; n++)
            corner[n / 3][n % 3] = cwi_volume_coordinate(
                c->unit.scale, m->positions[3 * (size_t)m->triangles[3 * t + n / 3] + n % 3]);
        for (size_t a = 0; a < 3; a++)
            twice[a] = 2 * corner[0][a] - cwi_volume_coordinate(c->unit.scale, box[a]) -
                       cwi_volume_coordinate(c->unit.scale, box[3 + a]);
        cwi_volume_area(corner[0], corner[1], corner[2], area);
        c->sums[set] += cwi_volume_dot(twice, area);
        for (size_t a = 0; a < 3; a++)
            areas[set][a] += area[a];
    }
    for (size_t n = 0; n < c->count; n++) {
        c->cavity[n] = cwi_volume_is_cavity(c->sums[n], areas[n]);
        c->sums[n] = cwi_volume_abs(c->sums[n]);
    }
    cwi_free(areas);
    return CW_OK;
}
