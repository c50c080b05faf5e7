/* Measures the printability of a mesh: walls, gaps, islands, overhangs, cavities, and how it stands. */
#include "core/geometry/box.h"
#include "core/mesh/mesh_triangle.h"
#include "simplify/printing/islands.h"
#include "simplify/printing/outline.h"
#include "simplify/printing/print_limits.h"
#include "simplify/printing/wall_rays.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "core/mesh/weld.h"

#include <cubewright/quality.h>

#include <stdlib.h>
#include <string.h>

static const double DEFAULT_WALL = 0.8, DEFAULT_GAP = 0.4, DEFAULT_OVERHANG = 45,
                    DEFAULT_LAYER = 0.2;

/* --- options ------------------------------------------------------------------------------ */

static cw_status take_limit(const char *name, double value, double otherwise, double *out,
                            cw_error *err)
{
    if (!(value >= 0) || !isfinite(value))
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s is %g; it must be finite, and 0 or more",
                        name, value);
    *out = value > 0 ? value : otherwise;
    return CW_OK;
}

cw_status cwi_print_limits(const cw_print_desc *desc, cw_print_desc *out, cw_error *err)
{
    const cw_print_desc given = desc ? *desc : (cw_print_desc){0};
    *out = given;
    cw_status st =
        take_limit("min_wall_mm", given.min_wall_mm, DEFAULT_WALL, &out->min_wall_mm, err);
    if (st == CW_OK)
        st = take_limit("min_gap_mm", given.min_gap_mm, DEFAULT_GAP, &out->min_gap_mm, err);
    if (st == CW_OK)
        st = take_limit("overhang_deg", given.overhang_deg, DEFAULT_OVERHANG,
                        &out->overhang_deg, err);
    if (st == CW_OK)
        st = take_limit("layer_mm", given.layer_mm, DEFAULT_LAYER, &out->layer_mm, err);
    for (int a = 0; a < 3 && st == CW_OK; a++)
        st = take_limit("plate_mm", given.plate_mm[a], 0, &out->plate_mm[a], err);
    if (st != CW_OK)
        return st;
    if (out->overhang_deg >= 90)
        return cwi_fail(err, CW_ERR_ARGUMENT, "overhang_deg is %g; it must be below 90",
                        out->overhang_deg);
    const double *plate = out->plate_mm;
    if ((plate[0] > 0) != (plate[1] > 0) || (plate[1] > 0) != (plate[2] > 0))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "plate_mm is %g x %g x %g; all three must be above 0, or none",
                        plate[0], plate[1], plate[2]);
    return CW_OK;
}

/* --- what one pass over the triangles tells ----------------------------------------------- */

typedef struct triangle_look {
    double corner[3][3]; /* relative to the mesh's origin */
    double area[3];      /* along the normal, as long as the area */
    double length;       /* of it */
} triangle_look;

static triangle_look look_at(const cw_mesh *mesh, size_t t)
{
    triangle_look look;
    cwi_mesh_corners(mesh, t, look.corner);
    cwi_mesh_normal(mesh, t, look.area);
    for (int a = 0; a < 3; a++)
        look.area[a] /= 2;
    look.length = cwi_length(look.area);
    return look;
}

static bool is_on_plate(const triangle_look *look, double bottom, double layer)
{
    for (int c = 0; c < 3; c++)
        if (look->corner[c][2] - bottom >= layer)
            return false;
    return true;
}

/* Adds up area, overhangs, the foot, the volume and its centre. Volumes are measured from the middle
 * of the foot, so that digits are not lost. */
static void sum_triangles(const cw_mesh *mesh, const cw_print_desc *limits, const double low[3],
                          const double high[3], cw_print_facts *facts)
{
    const double from[3] = {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]};
    const double steep = sin(limits->overhang_deg * CWI_PI / 180);
    double moment[3] = {0};
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const triangle_look look = look_at(mesh, t);
        double p[3][3];
        for (int n = 0; n < 9; n++)
            p[n / 3][n % 3] = look.corner[n / 3][n % 3] - from[n % 3];
        const double volume = cwi_dot(p[0], look.area) / 3;
        facts->area_mm2 += look.length;
        facts->volume_mm3 += volume;
        for (int a = 0; a < 3; a++)
            moment[a] += volume * (p[0][a] + p[1][a] + p[2][a]) / 4;
        if (look.area[2] < 0 && is_on_plate(&look, low[2], limits->layer_mm))
            facts->foot_mm2 -= look.area[2];
        else if (-look.area[2] > steep * look.length)
            facts->overhang_mm2 += look.length;
    }
    for (int a = 0; a < 3; a++)
        facts->center[a] =
            from[a] + (facts->volume_mm3 != 0 ? moment[a] / facts->volume_mm3 : 0);
}

/* --- how it stands ------------------------------------------------------------------------ */

/* Measures the foot's outline: points lower than a layer. */
static cw_status measure_stand(const cw_mesh *mesh, const cw_print_desc *limits, double bottom,
                               cw_print_facts *facts, cw_error *err)
{
    size_t count = 0, corners;
    cwi_plan_point *points = cwi_alloc_array(mesh->vertex_count, sizeof *points),
                   *hull = cwi_alloc_array(2 * mesh->vertex_count + 2, sizeof *hull);
    uint8_t *taken = cwi_alloc_zeroed(mesh->vertex_count, 1);
    cw_status st = points && hull && taken ? CW_OK : cwi_fail_memory(err);
    for (size_t c = 0; c < 3 * mesh->triangle_count && st == CW_OK; c++) {
        const uint32_t v = mesh->triangles[c];
        const float *p = mesh->positions + 3 * (size_t)v;
        if (taken[v] || (double)p[2] - bottom >= limits->layer_mm)
            continue;
        taken[v] = 1;
        points[count++] = (cwi_plan_point){(double)p[0], (double)p[1]};
    }
    if (count) {
        corners = cwi_find_outline(points, count, hull);
        facts->margin_mm = cwi_outline_margin(
            hull, corners, &(cwi_plan_point){facts->center[0], facts->center[1]});
        const double high = facts->center[2] - bottom;
        facts->tip_deg =
            facts->margin_mm > 0 && high > 0 ? atan2(facts->margin_mm, high) * 180 / CWI_PI : 0;
    }
    cwi_free(points);
    cwi_free(hull);
    cwi_free(taken);
    return st;
}

static bool fits_plate(const double size[3], const double plate[3])
{
    const bool as_it_is = size[0] <= plate[0] && size[1] <= plate[1],
               turned = size[0] <= plate[1] && size[1] <= plate[0];
    return plate[0] == 0 || ((as_it_is || turned) && size[2] <= plate[2]);
}

/* --- walls, islands, cavities ------------------------------------------------------------- */

/* Hands the least of the triangles around to their vertices; all that were welded get the same. */
static void spread_to_vertices(const cw_mesh *mesh, const uint32_t *map, const float *min_mm,
                               float *out)
{
    for (size_t v = 0; v < mesh->vertex_count; v++)
        out[v] = INFINITY;
    for (size_t c = 0; c < 3 * mesh->triangle_count; c++)
        out[mesh->triangles[c]] = fminf(out[mesh->triangles[c]], min_mm[c / 3]);
    for (size_t v = 0; v < mesh->vertex_count; v++)
        out[v] = out[map[v]];
}

static cw_status measure_walls(cwi_wall_field *field, const cw_mesh *mesh, const uint32_t *map,
                               const cw_print_desc *limits, cw_print_facts *facts,
                               cw_error *err)
{
    cwi_wall_sum walls, gaps;
    float *wall = limits->wall ? cwi_alloc_array(mesh->triangle_count, sizeof *wall) : NULL,
          *gap = limits->gap ? cwi_alloc_array(mesh->triangle_count, sizeof *gap) : NULL;
    const bool ok = (wall || !limits->wall) && (gap || !limits->gap);
    cw_status st = ok ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK)
        st = cwi_measure_walls(field, wall, gap, &walls, &gaps, err);
    if (st == CW_OK) {
        facts->wall_mm = walls.min_mm;
        facts->thin_mm2 = walls.below;
        facts->gap_mm = gaps.min_mm;
        facts->narrow_mm2 = gaps.below;
        memcpy(facts->wall_at, walls.at, sizeof facts->wall_at);
        memcpy(facts->gap_at, gaps.at, sizeof facts->gap_at);
        if (limits->wall)
            spread_to_vertices(mesh, map, wall, limits->wall);
        if (limits->gap)
            spread_to_vertices(mesh, map, gap, limits->gap);
    }
    cwi_free(wall);
    cwi_free(gap);
    return st;
}

/* Independent measurements before rays are cast; threads take one each. */
enum { WALL_FIELD, ISLANDS, STAND, PREPARATIONS };

typedef struct preparation {
    const cw_mesh *mesh;
    const cw_print_desc *limits;
    double low[3], high[3];
    cw_print_facts *facts;
    cwi_wall_field *field;
    cwi_islands islands;
    cw_status status[PREPARATIONS];
    cw_error errors[PREPARATIONS];
} preparation;

static void prepare_one(void *context, size_t k)
{
    preparation *p = context;
    cw_error *err = &p->errors[k];
    if (k == WALL_FIELD)
        p->status[k] = cwi_wall_field_new(p->mesh, p->limits, &p->field, err);
    else if (k == ISLANDS)
        p->status[k] =
            cwi_find_islands(p->mesh, p->low[2], p->limits->layer_mm, &p->islands, err);
    else {
        sum_triangles(p->mesh, p->limits, p->low, p->high, p->facts);
        p->status[k] = measure_stand(p->mesh, p->limits, p->low[2], p->facts, err);
    }
}

static cw_status prepare_all(preparation *p, cw_error *err)
{
    const cw_mesh *mesh = p->mesh;
    cwi_box_clear(p->low, p->high);
    for (size_t c = 0; c < 3 * mesh->triangle_count; c++)
        cwi_box_add_points(p->low, p->high, mesh->positions + 3 * (size_t)mesh->triangles[c],
                           1);
    cwi_parallel_for_all(PREPARATIONS, mesh->triangle_count, p->limits->threads, prepare_one,
                         p);
    for (int k = 0; k < PREPARATIONS; k++)
        if (p->status[k] != CW_OK) {
            if (err)
                *err = p->errors[k];
            return p->status[k];
        }
    return CW_OK;
}

static void take_islands(const cw_mesh *mesh, const cwi_islands *islands, cw_print_facts *facts)
{
    facts->islands = islands->count;
    for (size_t a = 0; a < 3 && islands->count; a++)
        facts->island_at[a] = (double)mesh->positions[3 * (size_t)islands->vertex + a];
}

/* Measures what a welded mesh tells. It loses its cavities at last. */
static cw_status measure_welded(cw_mesh *mesh, const uint32_t *map, const cw_print_desc *limits,
                                cw_print_facts *facts, cw_error *err)
{
    preparation p = {.mesh = mesh, .limits = limits, .facts = facts};
    cw_drop_counts voids = {0};
    cw_status st = prepare_all(&p, err);
    if (st == CW_OK)
        st = measure_walls(p.field, mesh, map, limits, facts, err);
    cwi_wall_field_free(p.field);
    if (st != CW_OK)
        return st;
    take_islands(mesh, &p.islands, facts);
    const double size[3] = {p.high[0] - p.low[0], p.high[1] - p.low[1], p.high[2] - p.low[2]};
    facts->fits = fits_plate(size, limits->plate_mm);
    st = cw_mesh_fill_voids(mesh, limits->threads, &voids, err);
    facts->trapped = voids.dropped;
    facts->trapped_mm3 = voids.dropped_mm3;
    return st;
}

/* Makes a copy of positions and triangles, whose vertices at equal places are one. */
static cw_status weld_copy(const cw_mesh *mesh, cw_mesh *copy, uint32_t **map, cw_error *err)
{
    cw_status st = cwi_mesh_alloc(copy, mesh->vertex_count, mesh->triangle_count, false, err);
    if (st != CW_OK)
        return st;
    memcpy(copy->positions, mesh->positions, 3 * mesh->vertex_count * sizeof *copy->positions);
    *map = cwi_alloc_array(mesh->vertex_count, sizeof **map);
    if (!*map || !cwi_weld(copy->positions, mesh->vertex_count, *map))
        return cwi_fail_memory(err);
    for (size_t c = 0; c < 3 * mesh->triangle_count; c++)
        copy->triangles[c] = (*map)[mesh->triangles[c]];
    return CW_OK;
}

static void move_to_world(const cw_mesh *mesh, cw_print_facts *facts)
{
    double *const points[] = {facts->wall_at, facts->gap_at, facts->island_at, facts->center};
    const bool made[] = {isfinite(facts->wall_mm), isfinite(facts->gap_mm), facts->islands > 0,
                         true};
    for (size_t n = 0; n < sizeof points / sizeof *points; n++)
        for (int a = 0; a < 3 && made[n]; a++)
            points[n][a] += mesh->origin[a];
}

cw_status cw_print_measure(const cw_mesh *mesh, const cw_print_desc *desc,
                           cw_print_facts *facts, cw_error *err)
{
    CWI_REQUIRE(err, mesh, facts);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_print_desc limits;
    cw_mesh copy = {0};
    uint32_t *map = NULL;
    *facts = (cw_print_facts){.wall_mm = INFINITY, .gap_mm = INFINITY, .fits = true};
    cw_status st = cwi_print_limits(desc, &limits, err);
    if (st == CW_OK)
        st = cwi_mesh_check_size(mesh, "measured", err);
    if (st != CW_OK)
        return st;
    if (mesh->triangle_count) {
        st = weld_copy(mesh, &copy, &map, err);
        if (st == CW_OK)
            st = measure_welded(&copy, map, &limits, facts, err);
        if (st == CW_OK)
            move_to_world(mesh, facts);
    } else {
        for (size_t v = 0; v < mesh->vertex_count && limits.wall; v++)
            limits.wall[v] = INFINITY;
        for (size_t v = 0; v < mesh->vertex_count && limits.gap; v++)
            limits.gap[v] = INFINITY;
    }
    facts->limits = limits;
    facts->limits.wall = facts->limits.gap = NULL;
    facts->limits.progress = (cw_progress){0};
    cw_mesh_free(&copy);
    cwi_free(map);
    return st;
}
