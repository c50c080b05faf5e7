/* Maps cells isoparametrically: weights and their derivatives, Newton's method for the inverse,
 * and the kinds of cells that need it. */
#include "viewer/rays/cell_map.h"

#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

/* Reference coordinates of the corners. */
static const double reference[CW_SHAPE_COUNT][8][3] = {
    [CW_TETRAHEDRON] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
    [CW_PYRAMID] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}},
    [CW_WEDGE] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}},
    [CW_HEXAHEDRON] = {{0, 0, 0},
                       {1, 0, 0},
                       {1, 1, 0},
                       {0, 1, 0},
                       {0, 0, 1},
                       {1, 0, 1},
                       {1, 1, 1},
                       {0, 1, 1}},
};

/* The corners that span u from corner 0 where the map is linear. */
static const uint8_t spanning[CW_SHAPE_COUNT][3] = {{1, 2, 3}, {1, 3, 4}, {1, 2, 3}, {1, 3, 4}};

/* The cell in u: all constraint[0..2] . u + constraint[3] >= 0. */
static const int constraint_counts[CW_SHAPE_COUNT] = {4, 5, 5, 6};
static const double constraints[CW_SHAPE_COUNT][6][4] = {
    [CW_TETRAHEDRON] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {-1, -1, -1, 1}},
    [CW_PYRAMID] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {-1, 0, -1, 1}, {0, -1, -1, 1}},
    [CW_WEDGE] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {-1, -1, 0, 1}, {0, 0, 1, 0}, {0, 0, -1, 1}},
    [CW_HEXAHEDRON] =
        {{1, 0, 0, 0}, {-1, 0, 0, 1}, {0, 1, 0, 0}, {0, -1, 0, 1}, {0, 0, 1, 0}, {0, 0, -1, 1}},
};

/* Corners and the ends of the three edges at each, positively oriented; a pyramid's tip has
 * four edges and is left out. */
static const int apex_counts[CW_SHAPE_COUNT] = {1, 4, 6, 8};
static const uint8_t apexes[CW_SHAPE_COUNT][8][4] = {
    [CW_TETRAHEDRON] = {{0, 1, 2, 3}},
    [CW_PYRAMID] = {{0, 1, 3, 4}, {1, 2, 0, 4}, {2, 3, 1, 4}, {3, 0, 2, 4}},
    [CW_WEDGE] =
        {{0, 1, 2, 3}, {1, 2, 0, 4}, {2, 0, 1, 5}, {3, 5, 4, 0}, {4, 3, 5, 1}, {5, 4, 3, 2}},
    [CW_HEXAHEDRON] = {{0, 1, 3, 4},
                       {1, 2, 0, 5},
                       {2, 3, 1, 6},
                       {3, 0, 2, 7},
                       {4, 7, 5, 0},
                       {5, 4, 6, 1},
                       {6, 5, 7, 2},
                       {7, 6, 4, 3}},
};

static const int part_counts[CW_SHAPE_COUNT] = {1, 2, 3, 6};
static const uint8_t parts[CW_SHAPE_COUNT][6][4] = {
    [CW_TETRAHEDRON] = {{0, 1, 2, 3}},
    [CW_PYRAMID] = {{0, 1, 2, 4}, {0, 2, 3, 4}},
    [CW_WEDGE] = {{0, 1, 2, 5}, {0, 1, 5, 4}, {0, 4, 5, 3}},
    [CW_HEXAHEDRON] =
        {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}},
};

void cwi_cell_load(const cw_cells *cells, uint8_t shape, const uint32_t *corners,
                   const double origin[3], cwi_mapped_cell *cell)
{
    cell->shape = shape;
    cell->count = cwi_cell_shapes[shape].corner_count;
    for (int c = 0; c < cell->count; c++) {
        const double *p = cells->points + 3 * (size_t)corners[c];
        cell->corners[c] = corners[c];
        cwi_sub(p, origin, cell->points[c]);
    }
}

int cwi_cell_part_count(uint8_t shape)
{
    return part_counts[shape];
}

void cwi_cell_part(const cwi_mapped_cell *cell, int number, cwi_mapped_cell *part)
{
    part->shape = CW_TETRAHEDRON;
    part->count = 4;
    for (int c = 0; c < 4; c++) {
        const int from = parts[cell->shape][number][c];
        part->corners[c] = cell->corners[from];
        memcpy(part->points[c], cell->points[from], sizeof part->points[c]);
    }
}

/* --- kinds ------------------------------------------------------------------------------- */

static double determinant_of(const double a[3], const double b[3], const double c[3])
{
    double across[3];
    cwi_cross(a, b, across);
    return cwi_dot(across, c);
}

/* Returns the longest distance of a corner from corner 0 along an axis; NaN if a point is not
 * finite. */
static double size_of(const cwi_mapped_cell *cell)
{
    double size = 0, gaps = 0;
    for (int c = 0; c < cell->count; c++)
        for (int a = 0; a < 3; a++) {
            const double d = fabs(cell->points[c][a] - cell->points[0][a]);
            gaps += d - d;
            size = d > size ? d : size;
        }
    return size + gaps;
}

/* Returns the farthest that a corner is from its place if the map were linear. */
static double deviation_of(const cwi_mapped_cell *cell)
{
    double max = 0;
    const double(*p)[3] = cell->points;
    const uint8_t *span = spanning[cell->shape];
    for (int c = 0; c < cell->count; c++)
        for (int a = 0; a < 3; a++) {
            double x = p[0][a];
            for (int k = 0; k < 3; k++)
                x += reference[cell->shape][c][k] * (p[span[k]][a] - p[0][a]);
            max = fmax(max, fabs(x - p[c][a]));
        }
    return max;
}

cwi_map_kind cwi_cell_map_of(const cwi_mapped_cell *cell)
{
    static const double FLAT_VOLUME = 1e-13; /* of the cube of the size */
    const double size = size_of(cell), min_volume = FLAT_VOLUME * size * size * size;
    bool is_left = false, is_right = false;
    if (!(size > 0))
        return CWI_MAP_EMPTY;
    for (int n = 0; n < apex_counts[cell->shape]; n++) {
        const uint8_t *apex = apexes[cell->shape][n];
        double edges[3][3];
        for (int k = 0; k < 3; k++)
            cwi_sub(cell->points[apex[k + 1]], cell->points[apex[0]], edges[k]);
        const double d = determinant_of(edges[0], edges[1], edges[2]);
        is_right = is_right || d > min_volume;
        is_left = is_left || d < -min_volume;
    }
    if (is_left && is_right)
        return CWI_MAP_FOLDED;
    if (!is_left && !is_right)
        return CWI_MAP_EMPTY;
    const double deviation = deviation_of(cell);
    return deviation <= 1e-9 * size   ? CWI_MAP_LINEAR
           : deviation <= 1e-4 * size ? CWI_MAP_NEARLY
                                      : CWI_MAP_CURVED;
}

/* --- weights ----------------------------------------------------------------------------- */

static void pyramid_weights(const double u[3], double w[8])
{
    const double left = 1 - u[2], cross = left > 1e-12 ? u[0] * u[1] / left : 0;
    w[0] = left - u[0] - u[1] + cross;
    w[1] = u[0] - cross;
    w[2] = cross;
    w[3] = u[1] - cross;
    w[4] = u[2];
}

void cwi_cell_weights(uint8_t shape, const double u[3], double w[8])
{
    const double x = u[0], y = u[1], z = u[2];
    if (shape == CW_TETRAHEDRON) {
        w[0] = 1 - x - y - z;
        memcpy(w + 1, u, 3 * sizeof *w);
    } else if (shape == CW_PYRAMID) {
        pyramid_weights(u, w);
    } else if (shape == CW_WEDGE) {
        const double triangle[3] = {1 - x - y, x, y};
        for (int c = 0; c < 6; c++)
            w[c] = triangle[c % 3] * (c < 3 ? 1 - z : z);
    } else {
        for (int c = 0; c < 8; c++) {
            const double *at = reference[CW_HEXAHEDRON][c];
            w[c] = (at[0] > 0 ? x : 1 - x) * (at[1] > 0 ? y : 1 - y) * (at[2] > 0 ? z : 1 - z);
        }
    }
}

/* Computes the derivatives of the weights of a wedge, pyramid or hexahedron: d[c][axis]. */
static void weight_derivatives(uint8_t shape, const double u[3], double d[8][3])
{
    if (shape == CW_PYRAMID) {
        const double left = 1 - u[2], scale = left > 1e-12 ? 1 / left : 0;
        const double x = u[0] * scale, y = u[1] * scale, both = x * y;
        const double rows[5][3] = {{y - 1, x - 1, both - 1},
                                   {1 - y, -x, -both},
                                   {y, x, both},
                                   {-y, 1 - x, -both},
                                   {0, 0, 1}};
        memcpy(d, rows, sizeof rows);
    } else if (shape == CW_WEDGE) {
        const double triangle[3] = {1 - u[0] - u[1], u[0], u[1]};
        for (int c = 0; c < 6; c++) {
            const double level = c < 3 ? 1 - u[2] : u[2];
            d[c][0] = (c % 3 == 0 ? -1 : c % 3 == 1) * level;
            d[c][1] = (c % 3 == 0 ? -1 : c % 3 == 2) * level;
            d[c][2] = (c < 3 ? -1 : 1) * triangle[c % 3];
        }
    } else {
        for (int c = 0; c < 8; c++) {
            double w[3], sign[3];
            for (int a = 0; a < 3; a++) {
                const bool is_high = reference[CW_HEXAHEDRON][c][a] > 0;
                w[a] = is_high ? u[a] : 1 - u[a];
                sign[a] = is_high ? 1 : -1;
            }
            d[c][0] = sign[0] * w[1] * w[2];
            d[c][1] = sign[1] * w[0] * w[2];
            d[c][2] = sign[2] * w[0] * w[1];
        }
    }
}

/* --- the inverse ------------------------------------------------------------------------- */

/* Solves columns x = right by Cramer's rule. Returns false where the columns lie in a plane. */
static bool solve_columns(const double columns[3][3], const double right[3], double x[3])
{
    double across[3][3];
    for (int a = 0; a < 3; a++)
        cwi_cross(columns[(a + 1) % 3], columns[(a + 2) % 3], across[a]);
    const double inverse = 1 / cwi_dot(columns[0], across[0]);
    for (int a = 0; a < 3; a++)
        x[a] = cwi_dot(right, across[a]) * inverse;
    return isfinite(x[0] + x[1] + x[2]);
}

bool cwi_cell_invert(const cwi_mapped_cell *cell, const double point[3], double last_step,
                     double u[3])
{
    enum { MAX_STEPS = 40 };
    for (int n = 0; n < MAX_STEPS; n++) {
        double w[8], d[8][3], columns[3][3] = {{0}}, rest[3], step[3], longest = 0;
        cwi_cell_weights(cell->shape, u, w);
        weight_derivatives(cell->shape, u, d);
        memcpy(rest, point, sizeof rest);
        for (int c = 0; c < cell->count; c++)
            for (int a = 0; a < 3; a++) {
                rest[a] -= w[c] * cell->points[c][a];
                for (int k = 0; k < 3; k++)
                    columns[k][a] += d[c][k] * cell->points[c][a];
            }
        if (!solve_columns((const double(*)[3])columns, rest, step))
            return false;
        for (int a = 0; a < 3; a++)
            longest = cwi_greater(longest, fabs(step[a]));
        const double scale = longest > 0.5 ? 0.5 / longest : 1; /* far off, go carefully */
        for (int a = 0; a < 3; a++)
            u[a] += scale * step[a];
        if (longest < last_step)
            return true;
    }
    return false;
}

bool cwi_cell_contains(uint8_t shape, const double u[3])
{
    for (int n = 0; n < constraint_counts[shape]; n++) {
        const double *c = constraints[shape][n];
        if (!(cwi_dot(c, u) + c[3] >= 0))
            return false;
    }
    return true;
}

void cwi_cell_clip(uint8_t shape, const double start[3], const double direction[3], double t[2])
{
    for (int n = 0; n < constraint_counts[shape]; n++) {
        const double *c = constraints[shape][n];
        const double at = cwi_dot(c, start) + c[3], slope = cwi_dot(c, direction);
        if (slope > 0)
            t[0] = cwi_greater(t[0], -at / slope);
        else if (slope < 0)
            t[1] = cwi_lesser(t[1], -at / slope);
        else if (at < 0)
            t[1] = -INFINITY;
    }
}

bool cwi_cell_line(const cwi_mapped_cell *cell, const double origin[3],
                   const double direction[3], double start[3], double slope[3])
{
    double columns[3][3], from[3];
    for (int k = 0; k < 3; k++)
        cwi_sub(cell->points[spanning[cell->shape][k]], cell->points[0], columns[k]);
    cwi_sub(origin, cell->points[0], from);
    return solve_columns((const double(*)[3])columns, from, start) &&
           solve_columns((const double(*)[3])columns, direction, slope);
}

/* --- faces ------------------------------------------------------------------------------- */

/* How far beside a face, in parts of it, a crossing may be and still be listed. */
static const double BORDER_TOLERANCE = 1e-3;

/* Solves a x^2 + b x + c = 0; returns the number of roots. */
static int solve_quadratic(double a, double b, double c, double x[2])
{
    const double discriminant = b * b - 4 * a * c;
    const double q = -0.5 * (b + copysign(sqrt(fmax(discriminant, 0)), b));
    int count = 0;
    if (discriminant < 0)
        return 0;
    if (fabs(a) > 1e-14 * fabs(q))
        x[count++] = q / a;
    if (q != 0)
        x[count++] = c / q;
    return count;
}

/* Two directions across the ray, of about unit length. */
typedef struct across {
    double first[3], second[3];
} across;

static double cross_2d(const double a[2], const double b[2])
{
    return a[0] * b[1] - a[1] * b[0];
}

static bool is_beside(double x)
{
    return !(x >= -BORDER_TOLERANCE && x <= 1 + BORDER_TOLERANCE);
}

/* Finds where the ray meets the bilinear patch p0 + x (p1 - p0) + y (p3 - p0) + x y (...), all
 * relative to the ray's origin: seen along the ray, that is two equations in x and y. */
static int cross_patch(const double *const p[4], const across *view, const double direction[3],
                       double *t)
{
    double v[4][2], f[4][2]; /* the corners, then the patch's four terms */
    int count = 0;
    for (int n = 0; n < 4; n++) {
        v[n][0] = cwi_dot(view->first, p[n]);
        v[n][1] = cwi_dot(view->second, p[n]);
    }
    for (int a = 0; a < 2; a++) {
        f[0][a] = v[0][a];
        f[1][a] = v[1][a] - v[0][a];
        f[2][a] = v[3][a] - v[0][a];
        f[3][a] = v[0][a] - v[1][a] + v[2][a] - v[3][a];
    }
    for (int swap = 0; swap < 2; swap++) { /* eliminate x, then y */
        const double *b = f[swap ? 2 : 1], *c = f[swap ? 1 : 2];
        double roots[2];
        const int root_count = solve_quadratic(
            cross_2d(c, f[3]), cross_2d(f[0], f[3]) + cross_2d(c, b), cross_2d(f[0], b), roots);
        for (int n = 0; n < root_count; n++) {
            const double y = roots[n];
            const double from[2] = {f[0][0] + y * c[0], f[0][1] + y * c[1]};
            const double along[2] = {b[0] + y * f[3][0], b[1] + y * f[3][1]};
            const double length_sq = along[0] * along[0] + along[1] * along[1];
            const double x = -(from[0] * along[0] + from[1] * along[1]) / length_sq;
            if (is_beside(x) || is_beside(y))
                continue;
            const double s = swap ? y : x, r = swap ? x : y;
            double at[3];
            for (int a = 0; a < 3; a++)
                at[a] = (1 - s) * ((1 - r) * p[0][a] + r * p[3][a]) +
                        s * ((1 - r) * p[1][a] + r * p[2][a]);
            t[count++] = cwi_dot(at, direction) / cwi_dot(direction, direction);
        }
    }
    return count;
}

/* Finds where the ray meets the plane of a triangle, beside which it may lie. */
static int cross_triangle(const double *const p[3], const double direction[3], double *t)
{
    double u[3], v[3], normal[3];
    cwi_sub(p[1], p[0], u);
    cwi_sub(p[2], p[0], v);
    cwi_cross(u, v, normal);
    *t = cwi_dot(normal, p[0]) / cwi_dot(normal, direction);
    return isfinite(*t);
}

static void look_along(const double direction[3], across *view)
{
    const double size[3] = {fabs(direction[0]), fabs(direction[1]), fabs(direction[2])};
    const int shortest = size[0] < size[1]   ? (size[0] < size[2] ? 0 : 2)
                         : size[1] < size[2] ? 1
                                             : 2;
    double axis[3] = {0};
    axis[shortest] = 1;
    cwi_cross(direction, axis, view->first);
    cwi_normalise(view->first);
    cwi_cross(direction, view->first, view->second);
    cwi_normalise(view->second);
}

int cwi_cell_crossings(const cwi_mapped_cell *cell, const double origin[3],
                       const double direction[3], double t[CWI_CELL_CROSSINGS])
{
    const cwi_cell_shape *s = &cwi_cell_shapes[cell->shape];
    double points[8][3];
    across view;
    int count = 0;
    look_along(direction, &view);
    for (int c = 0; c < cell->count; c++)
        cwi_sub(cell->points[c], origin, points[c]);
    for (int f = 0; f < s->face_count; f++) {
        const double *p[4];
        for (int n = 0; n < 4; n++)
            p[n] = points[s->faces[f][n]];
        count += s->face_size[f] == 4 ? cross_patch(p, &view, direction, t + count)
                                      : cross_triangle(p, direction, t + count);
    }
    return count;
}
