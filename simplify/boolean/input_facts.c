/* Facts on the inputs of a boolean: empty ones, those that were turned, and shells that are inside out, whose
 * volume is lost. */
#include "simplify/boolean/boolean_state.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

/* Returns the squared distance of a vertex on the grid from one of a mesh. */
static double distance_sq(const cw_mesh *const *meshes, size_t n, const cwi_grid_solids *s,
                          uint32_t vertex, uint32_t own)
{
    double by[3];
    for (size_t k = 0; k < 3; k++)
        by[k] = (double)meshes[n]->positions[3 * (size_t)own + k] + meshes[n]->origin[k] -
                meshes[0]->origin[k] - s->soup.vertices[vertex][k] / s->scale;
    return cwi_dot(by, by);
}

/* Finds flags of each input by its first triangle on the grid: one that was turned has exchanged corners. Parts of
 * triangles that were split while snapping may follow in any order. */
static void find_flags(const cw_mesh *const *meshes, const cwi_grid_solids *s, uint8_t *inputs)
{
    memset(inputs, CW_BOOLEAN_EMPTY, s->input_count);
    for (size_t t = 0; t < s->soup.triangle_count; t++) {
        const uint32_t input = s->inputs[t];
        size_t first = 0;
        if (inputs[input] != CW_BOOLEAN_EMPTY)
            continue;
        for (uint32_t n = 0; n < input; n++)
            first += meshes[n]->triangle_count;
        const uint32_t *v = s->soup.triangles[t],
                       own = meshes[input]->triangles[3 * (s->sources[t] - first) + 1];
        inputs[input] =
            distance_sq(meshes, input, s, v[2], own) < distance_sq(meshes, input, s, v[1], own)
                ? CW_BOOLEAN_TURNED
                : 0;
    }
}

double cwi_cone_volume(const cwi_grid_solids *s, const cwi_triangle_parts *parts,
                       const uint32_t corners[3], const double origin[3])
{
    double p[3][3], cross[3];
    for (int k = 0; k < 3; k++)
        cwi_sub(cwi_point_at(&s->soup, parts, corners[k]).x, origin, p[k]);
    cwi_cross(p[1], p[2], cross);
    return cwi_dot(p[0], cross);
}

cw_status cwi_find_input_facts(const cw_mesh *const *meshes, const cwi_grid_solids *solids,
                               const cwi_triangle_parts *parts, const cwi_facets *facets,
                               const cwi_space_cells *cells, uint8_t *kept, uint8_t *inputs,
                               cw_boolean_facts *facts, cw_error *err)
{
    size_t negative = 0;
    if (inputs)
        find_flags(meshes, solids, inputs);
    for (size_t c = 0; c < cells->count; c++)
        negative += (kept[c] & CWI_NEGATIVE) != 0;
    if (!negative)
        return CW_OK;
    double *volume = cwi_alloc_zeroed(cells->count, sizeof *volume);
    const cwi_exact_point origin = cwi_point_at(&solids->soup, parts, facets->corners[0][0]);
    if (!volume)
        return cwi_fail_memory(err);
    for (size_t f = 0; f < facets->count; f++) {
        const uint32_t front = cells->sides[2 * f], back = cells->sides[2 * f + 1];
        const double by = cwi_cone_volume(solids, parts, facets->corners[f], origin.x);
        volume[back] += by;
        volume[front] -= by;
        if (inputs && kept[front] & ~kept[back] & CWI_NEGATIVE)
            inputs[solids->inputs[facets->sources[f]]] |= CW_BOOLEAN_NEGATIVE;
    }
    for (size_t c = 0; c < cells->count; c++)
        if (kept[c] &
            CWI_NEGATIVE) { /* around another set of facets, a cell has a negative volume */
            facts->negative_regions += volume[c] > 0;
            facts->negative_mm3 += volume[c] / 6 / pow(solids->scale, 3);
            kept[c] &= (uint8_t)~CWI_NEGATIVE;
        }
    cwi_free(volume);
    return CW_OK;
}
