/* Makes charts: triangles of a surface with vertices of their own. */
#include "simplify/atlas/atlas_state.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/union_find.h"
#include "core/geometry/vec3.h"
#include "core/mesh/corner_table.h"
#include "core/mesh/mesh_triangle.h"

/* Triangles that are lower than this share of their longest side are stretched in any way. */
static const double THINNEST = 1e-7;

/* --- sheets ------------------------------------------------------------------------------- */

/* Joins the sides of edges that exactly two triangles pass, in opposite directions. */
static bool join_sides(cwi_sheet *sheet)
{
    const size_t count = 3 * sheet->mesh->triangle_count;
    const uint32_t *vertex = sheet->mesh->triangles;
    cwi_side *sides = cwi_alloc_large(count, sizeof *sides);
    if (!sides)
        return false;
    cwi_sides_list(vertex, count, sides);
    for (size_t c = 0; c < count; c++)
        sheet->twin[c] = CWI_NO_CORNER;
    for (size_t n = 0, along; n < count; n += along) {
        along = cwi_sides_along(sides, count, n);
        const uint32_t a = sides[n].corner, b = sides[n + (along == 2)].corner;
        if (along == 2 && a / 3 != b / 3 && vertex[a] == vertex[cwi_corner_next(b)] &&
            vertex[b] == vertex[cwi_corner_next(a)])
            cwi_twins_join(sheet->twin, a, b);
    }
    cwi_free(sides);
    return true;
}

cw_status cwi_sheet_init(cwi_sheet *sheet, const cw_mesh *mesh, cw_error *err)
{
    *sheet = (cwi_sheet){.mesh = mesh};
    sheet->twin = cwi_alloc_array(mesh->triangle_count, 3 * sizeof *sheet->twin);
    sheet->normal = cwi_alloc_array(mesh->triangle_count, sizeof *sheet->normal);
    if (!sheet->twin || !sheet->normal || !join_sides(sheet))
        return cwi_fail_memory(err);
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double p[3][3], side[3], other[3];
        cwi_mesh_corners(mesh, t, p);
        cwi_sub(p[1], p[0], side);
        cwi_sub(p[2], p[0], other);
        cwi_cross(side, other, sheet->normal[t]);
        for (int k = 0; k < 3; k++)
            sheet->normal[t][k] *= 0.5;
        sheet->area += cwi_length(sheet->normal[t]);
    }
    return CW_OK;
}

void cwi_sheet_free(cwi_sheet *sheet)
{
    cwi_free(sheet->twin);
    cwi_free(sheet->normal);
    *sheet = (cwi_sheet){0};
}

/* --- charts ------------------------------------------------------------------------------- */

/* Joins the corners of common edges, and numbers what they become. */
static bool number_vertices(cwi_chart *chart, const cwi_sheet *sheet, const uint32_t *index)
{
    uint32_t *sets = cwi_sets_alloc(3 * chart->triangles);
    if (!sets)
        return false;
    for (size_t t = 0; t < chart->triangles; t++)
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t c = 3 * chart->triangle[t] + k, twin = sheet->twin[c];
            const uint32_t mine = (uint32_t)(3 * t) + k;
            const uint32_t at = twin == CWI_NO_CORNER
                                    ? UINT32_MAX
                                    : __atomic_load_n(&index[twin / 3], __ATOMIC_RELAXED);
            if (!(at < chart->triangles && chart->triangle[at] == twin / 3)) {
                chart->border[chart->border_count++] = mine;
                continue;
            }
            const uint32_t other = 3 * at + twin % 3;
            cwi_sets_join(sets, mine, cwi_corner_next(other));
            cwi_sets_join(sets, cwi_corner_next(mine), other);
        }
    for (uint32_t c = 0; c < 3 * chart->triangles; c++) {
        const uint32_t set = cwi_sets_find(sets, c);
        chart->corners[c] = set == c ? (uint32_t)chart->vertices++ : chart->corners[set];
    }
    cwi_free(sets);
    return true;
}

/* Sets what a triangle is in its own plane, with its first side along x. */
static void set_rest(cwi_chart *chart, const cw_mesh *mesh, size_t t)
{
    double p[3][3], side[3], other[3], across[3];
    cwi_mesh_corners(mesh, chart->triangle[t], p);
    cwi_sub(p[1], p[0], side);
    cwi_sub(p[2], p[0], other);
    cwi_cross(side, other, across);
    const double length = cwi_length(side), area_twice = cwi_length(across);
    const double longest_sq =
        fmax(fmax(cwi_distance_sq(p[1], p[2]), cwi_dot(other, other)), length * length);
    if (!(area_twice > THINNEST * longest_sq)) { /* a needle: it follows its neighbours */
        chart->area[t] = 0;
        return;
    }
    const double x = cwi_dot(side, other) / length, y = area_twice / length;
    chart->area[t] = area_twice / 2;
    chart->rest[t][0] = 1 / length;
    chart->rest[t][1] = -x / (length * y);
    chart->rest[t][2] = 0;
    chart->rest[t][3] = 1 / y;
}

bool cwi_chart_init(cwi_chart *chart, const cwi_sheet *sheet, const uint32_t *triangles,
                    size_t count, uint32_t *index)
{
    *chart = (cwi_chart){.triangles = count};
    chart->triangle = cwi_alloc_array(count, sizeof *chart->triangle);
    chart->corners = cwi_alloc_array(count, 3 * sizeof *chart->corners);
    chart->rest = cwi_alloc_array(count, sizeof *chart->rest);
    chart->area = cwi_alloc_array(count, sizeof *chart->area);
    chart->border = cwi_alloc_array(count, 6 * sizeof *chart->border);
    if (!chart->triangle || !chart->corners || !chart->rest || !chart->area || !chart->border)
        return false;
    for (size_t t = 0; t < count; t++) {
        chart->triangle[t] = triangles[t];
        __atomic_store_n(&index[triangles[t]], (uint32_t)t, __ATOMIC_RELAXED);
        set_rest(chart, sheet->mesh, t);
        chart->surface += chart->area[t];
    }
    if (!number_vertices(chart, sheet, index))
        return false;
    for (size_t n = chart->border_count; n-- > 0;) { /* corners become pairs of vertices */
        const uint32_t c = chart->border[n];
        chart->border[2 * n] = chart->corners[c];
        chart->border[2 * n + 1] = chart->corners[cwi_corner_next(c)];
    }
    chart->uv = cwi_alloc_array(chart->vertices, sizeof *chart->uv);
    return chart->uv;
}

void cwi_chart_free(cwi_chart *chart)
{
    cwi_free(chart->triangle);
    cwi_free(chart->corners);
    cwi_free(chart->rest);
    cwi_free(chart->area);
    cwi_free(chart->border);
    cwi_free(chart->uv);
    *chart = (cwi_chart){0};
}
