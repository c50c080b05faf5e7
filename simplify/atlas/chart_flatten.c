/* Lays charts into the plane: they are seen along the mean of their normals, and folds are
 * smoothed out. */
#include "simplify/atlas/chart_plane.h"

#include "core/base/memory.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"

#include <string.h>

/* Rounds of averaging that may take away folds, and those between two looks. */
enum { MAX_ROUNDS = 64, LOOK_EVERY = 4 };

/* Directions in which the box around a chart is measured. */
enum { ANGLES = 64 };

/* The smallest area in the plane that is none turned over, as a share of that in space. */
static const double MIN_AREA = 1e-3;

static void find_plane(const cwi_chart *chart, const cwi_sheet *sheet, double axes[2][3])
{
    double normal[3] = {0, 0, 0};
    for (size_t t = 0; t < chart->triangles; t++)
        for (int k = 0; k < 3; k++)
            normal[k] += sheet->normal[chart->triangle[t]][k];
    if (!cwi_normalise(normal)) {
        normal[0] = normal[1] = 0;
        normal[2] = 1;
    }
    const int a = fabs(normal[0]) < 0.6 ? 0 : 1;
    const double side[3] = {a == 0, a == 1, 0};
    cwi_cross(side, normal, axes[0]);
    cwi_normalise(axes[0]);
    cwi_cross(normal, axes[0], axes[1]);
}

static void project(cwi_chart *chart, const cwi_sheet *sheet)
{
    double axes[2][3];
    const cw_mesh *mesh = sheet->mesh;
    find_plane(chart, sheet, axes);
    const float *first = mesh->positions + 3 * (size_t)mesh->triangles[3 * chart->triangle[0]];
    for (size_t c = 0; c < 3 * chart->triangles; c++) {
        const uint32_t v = mesh->triangles[3 * (size_t)chart->triangle[c / 3] + c % 3];
        double d[3];
        cwi_sub_points(mesh->positions + 3 * (size_t)v, first, d);
        for (int k = 0; k < 2; k++)
            chart->uv[chart->corners[c]][k] = cwi_dot(d, axes[k]);
    }
}

static bool is_turned_over(const cwi_chart *chart, size_t t)
{
    double j[4];
    if (!(chart->area[t] > 0))
        return false;
    cwi_chart_jacobian(chart, (const double(*)[2])chart->uv, t, j);
    return !(cwi_chart_det(j) > MIN_AREA);
}

bool cwi_chart_is_folded(const cwi_chart *chart)
{
    for (size_t t = 0; t < chart->triangles; t++)
        if (is_turned_over(chart, t))
            return true;
    return false;
}

/* Moves each vertex to the mean of its neighbours; those of the outline half the way, and along the
 * outline.
 * sum  vertices x 3: coordinates and count of the neighbours */
static void average(cwi_chart *chart, double (*sum)[3], const bool *is_outer)
{
    memset(sum, 0, chart->vertices * sizeof *sum);
    for (size_t c = 0; c < 3 * chart->triangles; c++) {
        const uint32_t from = chart->corners[c],
                       to = chart->corners[cwi_corner_next((uint32_t)c)];
        for (int k = 0; k < 2 && !is_outer[from]; k++)
            sum[from][k] += chart->uv[to][k];
        sum[from][2] += !is_outer[from];
    }
    for (size_t n = 0; n < 2 * chart->border_count; n++) {
        const uint32_t from = chart->border[n], to = chart->border[n ^ 1];
        for (int k = 0; k < 2; k++)
            sum[from][k] += chart->uv[to][k];
        sum[from][2] += 1;
    }
    for (size_t v = 0; v < chart->vertices; v++)
        for (int k = 0; k < 2; k++) {
            const double mean = sum[v][2] > 0 ? sum[v][k] / sum[v][2] : chart->uv[v][k];
            chart->uv[v][k] = is_outer[v] ? 0.5 * (mean + chart->uv[v][k]) : mean;
        }
}

/* Returns false where folds stay, or memory is out. */
static bool smooth_folds(cwi_chart *chart, bool *no_memory)
{
    double(*sum)[3] = cwi_alloc_array(chart->vertices, sizeof *sum);
    bool *is_outer = cwi_alloc_zeroed(chart->vertices, sizeof *is_outer);
    bool flat = false;
    *no_memory = !sum || !is_outer;
    for (size_t n = 0; n < 2 * chart->border_count && !*no_memory; n++)
        is_outer[chart->border[n]] = true;
    for (int round = 1; round <= MAX_ROUNDS && !flat && !*no_memory; round++) {
        average(chart, sum, is_outer);
        flat = round % LOOK_EVERY == 0 && !cwi_chart_is_folded(chart);
    }
    cwi_free(sum);
    cwi_free(is_outer);
    return flat;
}

/* --- measures ----------------------------------------------------------------------------- */

/* Scales a chart to the area that it has in space. */
static void scale_to_surface(cwi_chart *chart)
{
    double flat = 0;
    for (size_t t = 0; t < chart->triangles; t++) {
        double j[4];
        if (!(chart->area[t] > 0))
            continue;
        cwi_chart_jacobian(chart, (const double(*)[2])chart->uv, t, j);
        flat += chart->area[t] * cwi_chart_det(j);
    }
    const double by = flat > 0 ? sqrt(chart->surface / flat) : 1;
    for (size_t v = 0; v < chart->vertices; v++)
        for (int k = 0; k < 2; k++)
            chart->uv[v][k] *= by;
}

void cwi_chart_measure(cwi_chart *chart)
{
    double sum = 0;
    scale_to_surface(chart);
    for (size_t t = 0; t < chart->triangles; t++) {
        double j[4];
        if (!(chart->area[t] > 0))
            continue;
        cwi_chart_jacobian(chart, (const double(*)[2])chart->uv, t, j);
        const double det = cwi_chart_det(j);
        sum += chart->area[t] * cwi_chart_norm_sq(j) / (2 * det * det);
    }
    chart->stretch = chart->surface > 0 ? sqrt(sum / chart->surface) : 1;
}

bool cwi_chart_flatten(cwi_chart *chart, const cwi_sheet *sheet, bool *no_memory)
{
    project(chart, sheet);
    if (cwi_chart_is_folded(chart) && !smooth_folds(chart, no_memory))
        return false;
    cwi_chart_measure(chart);
    return true;
}

void cwi_chart_find_box(cwi_chart *chart)
{
    double least = INFINITY;
    chart->turn[0] = 1;
    for (int n = 0; n < ANGLES; n++) {
        double turn[2];
        cwi_chart_turn((double)n / ANGLES, turn);
        const double c = turn[0], s = turn[1];
        double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        for (size_t e = 0; e < 2 * chart->border_count; e += 2) {
            const double *uv = chart->uv[chart->border[e]];
            const double p[2] = {c * uv[0] - s * uv[1], s * uv[0] + c * uv[1]};
            for (int k = 0; k < 2; k++) {
                low[k] = fmin(low[k], p[k]);
                high[k] = fmax(high[k], p[k]);
            }
        }
        const double width = high[0] - low[0], height = high[1] - low[1];
        if (width * height < least * (1 - 1e-9)) {
            least = width * height;
            chart->turn[0] = c;
            chart->turn[1] = s;
            chart->box[0] = width;
            chart->box[1] = height;
        }
    }
}
