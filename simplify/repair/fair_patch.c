/* Moves the points inside a patch to a smooth surface: least squares of umbrella vectors, solved by
 * conjugate gradients. */
#include "core/base/memory.h"
#include "core/geometry/vec3.h"
#include "simplify/repair/hole_patch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Steps of the solver, and the square of the residual at which it stops, relative to the first. */
enum { MAX_STEPS = 4000 };
static const double ENOUGH = 1e-14;

/* Rows of the system: for each, its neighbours. The mean of the neighbours less the point itself is to
 * be 0. Columns are the points of the patch, then those of the mesh around the rim, which stay. */
typedef struct umbrella_rows {
    const cwi_hole_patch *patch;
    uint32_t *first,
        *column; /* neighbours of row i: column[first[i]] .. column[first[i + 1] - 1] */
    size_t first_row, rows;
    double (*fixed)[3]; /* vertices of the mesh around the rim */
    size_t fixed_count;
} umbrella_rows;

typedef struct neighbour_pair {
    uint32_t row, column;
} neighbour_pair;

typedef struct pair_list {
    neighbour_pair *pairs;
    size_t count, capacity;
} pair_list;

static bool push_pair(pair_list *l, uint32_t row, uint32_t column)
{
    if (l->count == l->capacity) {
        const size_t capacity = 2 * l->capacity + 256;
        neighbour_pair *pairs = cwi_realloc_array(l->pairs, capacity, sizeof *pairs);
        if (!pairs)
            return false;
        l->pairs = pairs;
        l->capacity = capacity;
    }
    l->pairs[l->count++] = (neighbour_pair){row, column};
    return true;
}

static int compare_pairs(const void *a, const void *b)
{
    const neighbour_pair *s = a, *t = b;
    if (s->row != t->row)
        return s->row < t->row ? -1 : 1;
    return s->column < t->column ? -1 : s->column > t->column;
}

/* Adds the neighbours of a rim's vertex in the mesh, as columns after the points. */
static bool add_outside(umbrella_rows *u, const cwi_rim *rim, const cwi_hole_mesh *around,
                        uint32_t n, pair_list *list)
{
    const uint32_t v = rim->vertices[n];
    const size_t size = rim->size;
    for (uint32_t i = around->first[v]; i < around->first[v + 1]; i++) {
        const uint32_t *corners = around->mesh->triangles + 3 * (size_t)around->around[i];
        for (size_t k = 0; k < 3; k++) {
            const uint32_t w = corners[k];
            if (w == v || w == rim->vertices[(n + 1) % size] ||
                w == rim->vertices[(n + size - 1) % size])
                continue;
            for (size_t a = 0; a < 3; a++)
                u->fixed[u->fixed_count][a] =
                    (double)around->mesh->positions[3 * (size_t)w + a];
            if (!push_pair(list, n, (uint32_t)(u->patch->count + u->fixed_count++)))
                return false;
        }
    }
    return true;
}

/* Makes the rows: of inner points, and if fair, of the rim too. */
static bool make_rows(umbrella_rows *u, const cwi_rim *rim, const cwi_hole_mesh *around,
                      bool is_fair)
{
    const cwi_hole_patch *p = u->patch;
    pair_list list = {0};
    size_t outside = 0;
    bool ok = true;
    u->first_row = is_fair ? 0 : p->rim;
    u->rows = p->count - u->first_row;
    for (size_t n = 0; n < rim->size && is_fair; n++)
        outside +=
            2 * (size_t)(around->first[rim->vertices[n] + 1] - around->first[rim->vertices[n]]);
    u->fixed = cwi_alloc_array(outside, sizeof *u->fixed);
    u->first = cwi_alloc_zeroed(p->count + 1, sizeof *u->first);
    ok = u->fixed && u->first;
    for (size_t t = 0; t < p->triangle_count && ok; t++)
        for (int k = 0; k < 6 && ok; k++) {
            const uint32_t a = p->triangles[t][k % 3],
                           b = p->triangles[t][(k + (k < 3 ? 1 : 2)) % 3];
            if (a >= u->first_row)
                ok = push_pair(&list, a, b);
        }
    for (uint32_t n = 0; n < rim->size && is_fair && ok; n++)
        ok = add_outside(u, rim, around, n, &list);
    if (ok && list.count)
        qsort(list.pairs, list.count, sizeof *list.pairs, compare_pairs);
    u->column = cwi_alloc_array(list.count, sizeof *u->column);
    ok = ok && u->column;
    size_t kept = 0;
    for (size_t n = 0; n < list.count && ok; n++) {
        if (n > 0 && compare_pairs(&list.pairs[n], &list.pairs[n - 1]) == 0)
            continue;
        u->column[kept++] = list.pairs[n].column;
        u->first[list.pairs[n].row + 1] = (uint32_t)kept;
    }
    for (size_t n = 1; n <= p->count && ok; n++) /* rows without neighbours */
        u->first[n] = u->first[n] > u->first[n - 1] ? u->first[n] : u->first[n - 1];
    cwi_free(list.pairs);
    return ok;
}

static void free_rows(umbrella_rows *u)
{
    cwi_free(u->first);
    cwi_free(u->column);
    cwi_free(u->fixed);
}

/* Computes umbrellas of all rows. x holds all points; fixed columns count as 0 unless with_fixed. */
static void apply_rows(const umbrella_rows *u, const double (*x)[3], bool with_fixed,
                       double (*out)[3])
{
    const size_t count = u->patch->count;
    for (size_t row = u->first_row; row < count; row++) {
        const uint32_t begin = u->first[row], end = u->first[row + 1];
        double sum[3] = {0};
        for (uint32_t i = begin; i < end; i++) {
            const uint32_t c = u->column[i];
            if (c >= count && !with_fixed)
                continue;
            const double *p = c < count ? x[c] : u->fixed[c - count];
            for (int a = 0; a < 3; a++)
                sum[a] += p[a];
        }
        for (int a = 0; a < 3; a++)
            out[row][a] = end > begin ? sum[a] / (end - begin) - x[row][a] : 0;
    }
}

/* Multiplies by the transposed rows; columns that stay get 0. */
static void apply_transposed(const umbrella_rows *u, const double (*y)[3], double (*out)[3])
{
    const size_t count = u->patch->count;
    memset(out, 0, count * sizeof *out);
    for (size_t row = u->first_row; row < count; row++) {
        const uint32_t begin = u->first[row], end = u->first[row + 1];
        if (end == begin)
            continue;
        for (int a = 0; a < 3; a++)
            out[row][a] -= y[row][a];
        for (uint32_t i = begin; i < end; i++)
            for (int a = 0; a < 3 && u->column[i] < count; a++)
                out[u->column[i]][a] += y[row][a] / (end - begin);
    }
    memset(out, 0, u->patch->rim * sizeof *out);
}

static double dot_all(const double (*x)[3], const double (*y)[3], size_t count)
{
    double sum = 0;
    for (size_t n = 0; n < count; n++)
        sum += cwi_dot(x[n], y[n]);
    return sum;
}

/* Solves the normal equations by conjugate gradients, from where the points are. */
static bool solve_rows(const umbrella_rows *u, double (*x)[3])
{
    const size_t count = u->patch->count;
    double(*residual)[3] = cwi_alloc_zeroed(count, sizeof *residual);
    double(*direction)[3] = cwi_alloc_zeroed(count, sizeof *direction);
    double(*umbrella)[3] = cwi_alloc_zeroed(count, sizeof *umbrella);
    double(*product)[3] = cwi_alloc_zeroed(count, sizeof *product);
    const bool ok = residual && direction && umbrella && product;
    double square = 0, enough = 0;
    if (ok) {
        apply_rows(u, (const double(*)[3])x, true, umbrella);
        apply_transposed(u, (const double(*)[3])umbrella, residual);
        for (size_t n = 0; n < count; n++)
            for (int a = 0; a < 3; a++)
                direction[n][a] = residual[n][a] = -residual[n][a];
        square = dot_all((const double(*)[3])residual, (const double(*)[3])residual, count);
        enough = ENOUGH * square;
    }
    for (int step = 0; step < MAX_STEPS && ok && square > enough; step++) {
        apply_rows(u, (const double(*)[3])direction, false, umbrella);
        apply_transposed(u, (const double(*)[3])umbrella, product);
        const double along =
            dot_all((const double(*)[3])direction, (const double(*)[3])product, count);
        if (!(along > 0))
            break;
        const double length = square / along, before = square;
        for (size_t n = u->patch->rim; n < count; n++)
            for (int a = 0; a < 3; a++) {
                x[n][a] += length * direction[n][a];
                residual[n][a] -= length * product[n][a];
            }
        square = dot_all((const double(*)[3])residual, (const double(*)[3])residual, count);
        for (size_t n = u->patch->rim; n < count; n++)
            for (int a = 0; a < 3; a++)
                direction[n][a] = residual[n][a] + square / before * direction[n][a];
    }
    cwi_free(residual);
    cwi_free(direction);
    cwi_free(umbrella);
    cwi_free(product);
    return ok;
}

static bool fair_once(cwi_hole_patch *patch, const cwi_rim *rim, const cwi_hole_mesh *around,
                      bool is_fair)
{
    umbrella_rows u = {.patch = patch};
    const bool ok = make_rows(&u, rim, around, is_fair) && solve_rows(&u, patch->points);
    free_rows(&u);
    return ok;
}

bool cwi_patch_fair(cwi_hole_patch *patch, const cwi_rim *rim, const cwi_hole_mesh *around,
                    bool is_fair)
{
    if (patch->count == patch->rim)
        return true;
    return fair_once(patch, rim, around, false) &&
           (!is_fair || fair_once(patch, rim, around, true));
}
