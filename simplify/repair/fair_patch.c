/* Moves the points inside a patch to a smooth surface: least squares of curvatures, solved by conjugate
 * gradients. */
#include "core/base/memory.h"
#include "core/geometry/vec3.h"
#include "simplify/repair/hole_patch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Steps of the solver, fewer where a coarser patch was solved before. It stops at this square of the
 * residual, relative to the first. */
enum { MAX_STEPS = 4000, MAX_LATER_STEPS = 1000 };
static const double ENOUGH = 1e-14;

/* Cotangents are cut off here: those of thin triangles are large. Areas count as no smaller than this
 * fraction of the mean. */
static const double MAX_COTANGENT = 20, LEAST_AREA = 1e-2;

/* Rows of the system: the curvature at each point by cotangents of the angles opposite to its edges,
 * times the root of the area around it. Columns are the points of the patch, then those of the mesh
 * around the rim, which stay. */
typedef struct curvature_rows {
    const cwi_hole_patch *patch;
    uint32_t *first,
        *column;    /* neighbours of row i: column[first[i]] .. column[first[i + 1] - 1] */
    double *weight; /* of each neighbour */
    size_t first_row;
    double (*fixed)[3]; /* points of the mesh around the rim */
    size_t fixed_count;
} curvature_rows;

typedef struct row_entry {
    uint32_t row, column;
    double weight;
} row_entry;

typedef struct entry_list {
    row_entry *entries;
    size_t count, capacity;
    double *area; /* of rows */
} entry_list;

static bool push_entry(entry_list *l, uint32_t row, uint32_t column, double weight)
{
    void *grown = cwi_grow_array(l->entries, l->count, &l->capacity, sizeof *l->entries);
    if (!grown)
        return false;
    l->entries = grown;
    l->entries[l->count++] = (row_entry){row, column, weight};
    return true;
}

static int compare_entries(const void *a, const void *b)
{
    const row_entry *s = a, *t = b;
    if (s->row != t->row)
        return s->row < t->row ? -1 : 1;
    if (s->column != t->column)
        return s->column < t->column ? -1 : 1;
    return s->weight < t->weight ? -1 : s->weight > t->weight;
}

/* Returns the cotangent of the angle at the first point. *area: of the triangle */
static double measure_cotangent(const double p[3], const double q[3], const double r[3],
                                double *area)
{
    double u[3], v[3], normal[3];
    cwi_sub(q, p, u);
    cwi_sub(r, p, v);
    cwi_cross(u, v, normal);
    const double twice = cwi_length(normal), along = cwi_dot(u, v);
    *area = twice / 2;
    if (!(fabs(along) < MAX_COTANGENT * twice))
        return along < 0 ? -MAX_COTANGENT : MAX_COTANGENT;
    return along / twice;
}

/* Adds the edges of a triangle from its first corner to a row. */
static bool add_corner(entry_list *l, uint32_t row, const double *p[3], uint32_t second,
                       uint32_t third)
{
    double area;
    const double at_third = measure_cotangent(p[2], p[0], p[1], &area);
    const double at_second = measure_cotangent(p[1], p[2], p[0], &area);
    l->area[row] += area / 3;
    return push_entry(l, row, second, at_third) && push_entry(l, row, third, at_second);
}

static bool add_patch(const curvature_rows *u, entry_list *list)
{
    const cwi_hole_patch *m = u->patch;
    bool ok = true;
    for (size_t t = 0; t < m->triangle_count && ok; t++)
        for (size_t k = 0; k < 3 && ok; k++) {
            const uint32_t a = m->triangles[t][k], b = m->triangles[t][(k + 1) % 3],
                           c = m->triangles[t][(k + 2) % 3];
            const double *p[3] = {m->points[a], m->points[b], m->points[c]};
            if (a >= u->first_row)
                ok = add_corner(list, a, p, b, c);
        }
    return ok;
}

/* Adds the triangles of the mesh around a point of the rim. Their corners stay. */
static bool add_outside(curvature_rows *u, const cwi_boundary_loop *loop,
                        const cwi_hole_mesh *around, uint32_t n, entry_list *list)
{
    const uint32_t v = loop->vertices[n];
    bool ok = true;
    for (uint32_t i = around->first[v]; i < around->first[v + 1] && ok; i++) {
        const uint32_t *corners = around->mesh->triangles + 3 * (size_t)around->around[i];
        const size_t at = corners[0] == v ? 0 : corners[1] == v ? 1 : 2;
        const uint32_t second = (uint32_t)(u->patch->count + u->fixed_count);
        const double *p[3] = {u->patch->points[n], u->fixed[u->fixed_count],
                              u->fixed[u->fixed_count + 1]};
        for (size_t k = 0; k < 6; k++)
            u->fixed[u->fixed_count + k / 3][k % 3] =
                (double)
                    around->mesh->positions[3 * (size_t)corners[(at + 1 + k / 3) % 3] + k % 3];
        u->fixed_count += 2;
        ok = add_corner(list, n, p, second, second + 1);
    }
    return ok;
}

/* Sums entries of one row and column, and divides rows by the root of their area. */
static bool sum_entries(curvature_rows *u, entry_list *list)
{
    const size_t count = u->patch->count;
    size_t kept = 0;
    double mean = 0;
    u->column = cwi_alloc_array(list->count, sizeof *u->column);
    u->weight = cwi_alloc_array(list->count, sizeof *u->weight);
    if (!u->column || !u->weight)
        return false;
    for (size_t row = u->first_row; row < count; row++)
        mean += list->area[row] / (double)(count - u->first_row);
    if (list->count)
        qsort(list->entries, list->count, sizeof *list->entries, compare_entries);
    for (size_t n = 0; n < list->count; n++) {
        const row_entry *e = &list->entries[n];
        const double area = cwi_greater(list->area[e->row], LEAST_AREA * mean);
        const double weight = area > 0 ? e->weight * sqrt(mean / area) : e->weight;
        if (n > 0 && e->row == e[-1].row && e->column == e[-1].column) {
            u->weight[kept - 1] += weight;
            continue;
        }
        u->column[kept] = e->column;
        u->weight[kept++] = weight;
        u->first[e->row + 1] = (uint32_t)kept;
    }
    for (size_t n = 1; n <= count; n++) /* rows without neighbours */
        u->first[n] = u->first[n] > u->first[n - 1] ? u->first[n] : u->first[n - 1];
    return true;
}

/* Makes the rows: of inner points, and if fair, of the rim too. */
static bool make_rows(curvature_rows *u, const cwi_boundary_loop *loop,
                      const cwi_hole_mesh *around, bool is_fair)
{
    const cwi_hole_patch *p = u->patch;
    entry_list list = {0};
    size_t outside = 0;
    u->first_row = is_fair ? 0 : p->loop;
    for (size_t n = 0; n < loop->size && is_fair; n++)
        outside += 2 * (size_t)(around->first[loop->vertices[n] + 1] -
                                around->first[loop->vertices[n]]);
    list.area = cwi_alloc_zeroed(p->count, sizeof *list.area);
    u->fixed = cwi_alloc_array(outside, sizeof *u->fixed);
    u->first = cwi_alloc_zeroed(p->count + 1, sizeof *u->first);
    bool ok = list.area && u->fixed && u->first && add_patch(u, &list);
    for (uint32_t n = 0; n < loop->size && is_fair && ok; n++)
        ok = add_outside(u, loop, around, n, &list);
    ok = ok && sum_entries(u, &list);
    cwi_free(list.entries);
    cwi_free(list.area);
    return ok;
}

static void free_rows(curvature_rows *u)
{
    cwi_free(u->first);
    cwi_free(u->column);
    cwi_free(u->weight);
    cwi_free(u->fixed);
}

/* Computes curvatures of all rows. x holds all points; fixed columns count as 0 unless with_fixed. */
static void apply_rows(const curvature_rows *u, const double (*x)[3], bool with_fixed,
                       double (*out)[3])
{
    const size_t count = u->patch->count;
    for (size_t row = u->first_row; row < count; row++) {
        double sum[3] = {0}, all = 0;
        for (uint32_t i = u->first[row]; i < u->first[row + 1]; i++) {
            const uint32_t c = u->column[i];
            all += u->weight[i];
            if (c >= count && !with_fixed)
                continue;
            const double *p = c < count ? x[c] : u->fixed[c - count];
            for (int a = 0; a < 3; a++)
                sum[a] += u->weight[i] * p[a];
        }
        for (int a = 0; a < 3; a++)
            out[row][a] = sum[a] - all * x[row][a];
    }
}

/* Multiplies by the transposed rows; columns that stay get 0. */
static void apply_transposed(const curvature_rows *u, const double (*y)[3], double (*out)[3])
{
    const size_t count = u->patch->count;
    memset(out, 0, count * sizeof *out);
    for (size_t row = u->first_row; row < count; row++) {
        double all = 0;
        for (uint32_t i = u->first[row]; i < u->first[row + 1]; i++) {
            all += u->weight[i];
            for (int a = 0; a < 3 && u->column[i] < count; a++)
                out[u->column[i]][a] += u->weight[i] * y[row][a];
        }
        for (int a = 0; a < 3; a++)
            out[row][a] -= all * y[row][a];
    }
    memset(out, 0, u->patch->loop * sizeof *out);
}

static double dot_all(const double (*x)[3], const double (*y)[3], size_t count)
{
    double sum = 0;
    for (size_t n = 0; n < count; n++)
        sum += cwi_dot(x[n], y[n]);
    return sum;
}

/* Solves the normal equations by conjugate gradients, from where the points are. */
static bool solve_rows(const curvature_rows *u, double (*x)[3], int max_steps)
{
    const size_t count = u->patch->count;
    double(*residual)[3] = cwi_alloc_zeroed(count, sizeof *residual);
    double(*direction)[3] = cwi_alloc_zeroed(count, sizeof *direction);
    double(*curvature)[3] = cwi_alloc_zeroed(count, sizeof *curvature);
    double(*product)[3] = cwi_alloc_zeroed(count, sizeof *product);
    const bool ok = residual && direction && curvature && product;
    double residual_sq = 0, enough = 0;
    if (ok) {
        apply_rows(u, (const double(*)[3])x, true, curvature);
        apply_transposed(u, (const double(*)[3])curvature, residual);
        for (size_t n = 0; n < count; n++)
            for (int a = 0; a < 3; a++)
                direction[n][a] = residual[n][a] = -residual[n][a];
        residual_sq =
            dot_all((const double(*)[3])residual, (const double(*)[3])residual, count);
        enough = ENOUGH * residual_sq;
    }
    for (int step = 0; step < max_steps && ok && residual_sq > enough; step++) {
        apply_rows(u, (const double(*)[3])direction, false, curvature);
        apply_transposed(u, (const double(*)[3])curvature, product);
        const double along =
            dot_all((const double(*)[3])direction, (const double(*)[3])product, count);
        if (!(along > 0))
            break;
        const double length = residual_sq / along, before = residual_sq;
        for (size_t n = u->patch->loop; n < count; n++)
            for (int a = 0; a < 3; a++) {
                x[n][a] += length * direction[n][a];
                residual[n][a] -= length * product[n][a];
            }
        residual_sq =
            dot_all((const double(*)[3])residual, (const double(*)[3])residual, count);
        for (size_t n = u->patch->loop; n < count; n++)
            for (int a = 0; a < 3; a++)
                direction[n][a] = residual[n][a] + residual_sq / before * direction[n][a];
    }
    cwi_free(residual);
    cwi_free(direction);
    cwi_free(curvature);
    cwi_free(product);
    return ok;
}

static bool fair_once(cwi_hole_patch *patch, const cwi_boundary_loop *loop,
                      const cwi_hole_mesh *around, bool is_fair, int max_steps)
{
    curvature_rows u = {.patch = patch};
    const bool ok =
        make_rows(&u, loop, around, is_fair) && solve_rows(&u, patch->points, max_steps);
    free_rows(&u);
    return ok;
}

bool cwi_patch_fair(cwi_hole_patch *patch, const cwi_boundary_loop *loop,
                    const cwi_hole_mesh *around, bool is_fair, bool is_later)
{
    const int steps = is_later ? MAX_LATER_STEPS : MAX_STEPS;
    if (patch->count == patch->loop)
        return true;
    if ((!is_fair || !is_later) && !fair_once(patch, loop, around, false, steps))
        return false;
    return !is_fair || fair_once(patch, loop, around, true, steps);
}
