/* Measures the loss when a mesh in world coordinates is rounded to single precision. */
#include "formats/mesh/mesh_writer.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/triangle_intersect.h"
#include "core/mesh/weld.h"

#include <float.h>
#include <math.h>

/* Rounds points. Coordinates beyond single precision become its maximum. */
static void round_points(const cwi_part *part, float *rounded)
{
    for (size_t i = 0; i < 3 * part->mesh.vertex_count; i++) {
        const double world = cwi_file_coordinate(part, i / 3, (int)(i % 3));
        rounded[i] = (float)fmax(fmin(world, (double)FLT_MAX), -(double)FLT_MAX);
    }
}

static double step_of(const cwi_part *part)
{
    double low[3], high[3], farthest = 0;
    cwi_part_bounds(part, low, high);
    for (int a = 0; a < 3; a++)
        farthest = fmax(farthest, fmax(fabs(low[a]), fabs(high[a])));
    return farthest > 0 ? ldexp(1, ilogb(farthest) - 23) * part->turn.over / part->turn.times
                        : 0;
}

static size_t count_flat(const cw_mesh *mesh, const float *rounded)
{
    size_t flat = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *triangle = mesh->triangles + 3 * t;
        flat += !cwi_has_area(rounded, triangle) && cwi_has_area(mesh->positions, triangle);
    }
    return flat;
}

static bool same_point(const float *points, size_t v, size_t u)
{
    const float *p = points + 3 * v, *q = points + 3 * u;
    return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

/* Counts vertices whose rounded point is that of an earlier vertex at a different place. */
static size_t count_merged(const cw_mesh *mesh, const uint32_t *map)
{
    size_t merged = 0;
    for (size_t v = 0; v < mesh->vertex_count; v++)
        merged += !same_point(mesh->positions, v, map[v]);
    return merged;
}

cw_status cwi_measure_loss(const cwi_part *part, cw_write_loss *loss, cw_error *err)
{
    const cw_mesh *mesh = &part->mesh;
    const size_t count = mesh->vertex_count;
    if (part->spool ||
        cwi_memory_is_in_file(mesh->positions)) { /* its vertices are not compared */
        loss->step_mm = fmax(loss->step_mm, step_of(part));
        return CW_OK;
    }
    float *rounded = cwi_alloc_array(count, 3 * sizeof *rounded);
    uint32_t *map = cwi_alloc_array(count, sizeof *map);
    bool ok = rounded && map;
    if (ok) {
        round_points(part, rounded);
        ok = cwi_weld(rounded, count, map);
    }
    if (ok) {
        loss->step_mm = fmax(loss->step_mm, step_of(part));
        loss->merged_vertices += count_merged(mesh, map);
        loss->flat_triangles += count_flat(mesh, rounded);
    }
    cwi_free(rounded);
    cwi_free(map);
    return ok ? CW_OK : cwi_fail_memory(err);
}
