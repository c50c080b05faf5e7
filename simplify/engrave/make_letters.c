/* Makes the solid of letters: a region between two sheets that follow the surface. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "simplify/engrave/engrave_state.h"

#include <string.h>

/* Surfaces that lean more are steps. */
static const double STEEP_DEG = 65;

/* Finds the height of the surface at each point of the region. */
static cw_status find_heights(const cwi_ray_target *target, const cwi_text_place *place,
                              const cwi_stroke_region *region, double reach, double *heights,
                              cw_error *err)
{
    for (size_t n = 0; n < region->point_count; n++) {
        const double *p = region->points[n];
        double lean;
        if (!cwi_find_height(target, place, p[0], p[1], reach, &heights[n], &lean))
            return cwi_fail(err, CW_ERR_CHECK,
                            "the surface has a hole or an end under the text");
        if (lean < cos(STEEP_DEG * CWI_PI / 180))
            return cwi_fail(
                err, CW_ERR_CHECK,
                "the surface leans by %.0f degrees under the text; up to %.0f are followed",
                acos(lean) * 180 / CWI_PI, STEEP_DEG);
    }
    const double max_slope = tan(STEEP_DEG * CWI_PI / 180);
    for (size_t n = 0; n < 3 * region->triangle_count; n++) {
        const uint32_t *t = region->triangles[n / 3];
        const uint32_t a = t[n % 3], b = t[(n + 1) % 3];
        const double *p = region->points[a], *q = region->points[b];
        const double step = fabs(heights[a] - heights[b]);
        if (step > max_slope * cwi_greater(hypot(p[0] - q[0], p[1] - q[1]), region->cell))
            return cwi_fail(err, CW_ERR_CHECK,
                            "the surface has a step of %.3g mm under the text", step);
    }
    return CW_OK;
}

static void place_sheets(const cwi_text_place *place, const cwi_stroke_region *region,
                         const double *heights, double below, double above, cw_mesh *tool)
{
    for (size_t n = 0; n < 2 * region->point_count; n++) {
        const size_t from = n % region->point_count;
        const double *p = region->points[from];
        const double z = heights[from] + (n < region->point_count ? above : -below);
        for (size_t a = 0; a < 3; a++)
            tool->positions[3 * n + a] = (float)(place->center[a] + p[0] * place->right[a] +
                                                 p[1] * place->up[a] + z * place->normal[a]);
    }
}

static void join_sheets(const cwi_stroke_region *region, cw_mesh *tool)
{
    const uint32_t down = (uint32_t)region->point_count;
    uint32_t *out = tool->triangles;
    for (size_t n = 0; n < region->triangle_count; n++, out += 6) {
        const uint32_t *t = region->triangles[n];
        const uint32_t both[6] = {t[0], t[1], t[2], t[0] + down, t[2] + down, t[1] + down};
        memcpy(out, both, sizeof both);
    }
    for (size_t n = 0; n < region->border_count; n++, out += 6) {
        const uint32_t a = region->border[n][0], b = region->border[n][1];
        const uint32_t both[6] = {b, a, a + down, b, a + down, b + down};
        memcpy(out, both, sizeof both);
    }
}

cw_status cwi_make_letters(const cwi_ray_target *target, const cwi_text_place *place,
                           const cwi_stroke_region *region, double below, double above,
                           double reach, cw_mesh *tool, cw_error *err)
{
    *tool = (cw_mesh){0};
    double *heights = cwi_alloc_array(region->point_count, sizeof *heights);
    cw_status st = heights ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK)
        st = find_heights(target, place, region, reach, heights, err);
    if (st == CW_OK)
        st = cwi_mesh_alloc(tool, 2 * region->point_count,
                            2 * (region->triangle_count + region->border_count), false, err);
    if (st == CW_OK) {
        memcpy(tool->origin, target->mesh->origin, sizeof tool->origin);
        place_sheets(place, region, heights, below, above, tool);
        join_sheets(region, tool);
    }
    cwi_free(heights);
    return st;
}
