/* Meshes put on one grid of integers, where equal places have one number. */
#include "simplify/boolean/boolean_state.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/box.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Places by their coordinates: a hash table of vertex numbers. */
typedef struct places {
    cwi_soup *soup;
    uint32_t *slots; /* 0: free; else 1 + a vertex */
    size_t mask;
} places;

static uint32_t number_place(places *p, const double x[3])
{
    const int64_t cell[3] = {(int64_t)x[0], (int64_t)x[1], (int64_t)x[2]};
    size_t slot = cwi_hash_cell(cell) & p->mask;
    for (; p->slots[slot]; slot = (slot + 1) & p->mask) {
        const double *y = p->soup->vertices[p->slots[slot] - 1];
        if (x[0] == y[0] && x[1] == y[1] && x[2] == y[2])
            return p->slots[slot] - 1;
    }
    for (int k = 0; k < 3; k++)
        p->soup->vertices[p->soup->vertex_count][k] = x[k];
    p->slots[slot] = (uint32_t)++p->soup->vertex_count;
    return p->slots[slot] - 1;
}

static bool alloc_places(places *p, cwi_soup *soup, size_t vertices)
{
    size_t capacity = 64;
    while (capacity < 2 * vertices)
        capacity *= 2;
    p->soup = soup;
    p->slots = cwi_alloc_zeroed(capacity, sizeof *p->slots);
    p->mask = capacity - 1;
    soup->vertices = cwi_alloc_array(vertices, sizeof *soup->vertices);
    return p->slots && soup->vertices;
}

static bool alloc_triangles(cwi_grid_solids *out, size_t count)
{
    out->soup.triangles = cwi_alloc_array(count, sizeof *out->soup.triangles);
    out->inputs = cwi_alloc_array(count, sizeof *out->inputs);
    out->sources = cwi_alloc_array(count, sizeof *out->sources);
    return out->soup.triangles && out->inputs && out->sources;
}

static void add_triangle(cwi_grid_solids *out, const uint32_t v[3], uint32_t input,
                         uint32_t source)
{
    const size_t t = out->soup.triangle_count++;
    memcpy(out->soup.triangles[t], v, sizeof out->soup.triangles[t]);
    out->inputs[t] = input;
    out->sources[t] = source;
}

static bool has_area(const cwi_soup *s, uint32_t t)
{
    cwi_wide n[3];
    if (cwi_triangle_is_collapsed(s->triangles[t]))
        return false;
    cwi_soup_normal(s, t, n);
    return n[0] || n[1] || n[2];
}

static void move_triangle(cwi_grid_solids *s, size_t from, size_t to)
{
    memmove(s->soup.triangles[to], s->soup.triangles[from], sizeof *s->soup.triangles);
    s->inputs[to] = s->inputs[from];
    s->sources[to] = s->sources[from];
    if (s->moved)
        s->moved[to] = s->moved[from];
}

cw_status cwi_solids_set_flat_aside(cwi_grid_solids *s, cw_error *err)
{
    const size_t all = s->soup.triangle_count + s->flat_count;
    uint32_t(*flat)[6] = cwi_alloc_array(all, sizeof *flat);
    size_t count = 0, flats = 0;
    if (!flat)
        return cwi_fail_memory(err);
    for (uint32_t t = 0; t < all; t++) {
        const uint32_t *v = s->soup.triangles[t];
        if (has_area(&s->soup, t))
            move_triangle(s, t, count++);
        else if (!cwi_triangle_is_collapsed(v)) {
            const uint32_t row[6] = {v[0],         v[1],          v[2],
                                     s->inputs[t], s->sources[t], s->moved && s->moved[t]};
            memcpy(flat[flats++], row, sizeof row);
        }
    }
    s->soup.triangle_count = count;
    s->flat_count = flats;
    s->dropped = all - count;
    for (size_t n = 0; n < flats; n++) {
        memcpy(s->soup.triangles[count + n], flat[n], sizeof *s->soup.triangles);
        s->inputs[count + n] = flat[n][3];
        s->sources[count + n] = flat[n][4];
        if (s->moved)
            s->moved[count + n] = flat[n][5];
    }
    cwi_free(flat);
    return CW_OK;
}

/* --- closed or not ------------------------------------------------------------------------ */

/* An edge of a triangle: by its points and its input. */
typedef struct half_edge {
    uint32_t high, input;
    int32_t direction;
} half_edge;

static int compare_halves(const void *x, const void *y)
{
    const half_edge *a = x, *b = y;
    if (a->high != b->high)
        return a->high < b->high ? -1 : 1;
    return a->input < b->input ? -1 : a->input > b->input;
}

/* Edges at which more triangles run one way than the other, by what is wrong there. */
enum { ONE_TRIANGLE, ODD_TRIANGLES, NOT_ALIKE, EDGE_FAULTS };

typedef struct edge_faults {
    size_t count[EDGE_FAULTS];
    uint32_t first[EDGE_FAULTS][3]; /* the points and the input of one */
} edge_faults;

/* Looks for such edges. */
static void find_faults(const cwi_grid_solids *s, half_edge *half, size_t *start,
                        edge_faults *out)
{
    const cwi_soup *soup = &s->soup;
    for (int pass = 0; pass < 2; pass++) { /* count, then place */
        for (size_t t = 0; t < soup->triangle_count; t++)
            for (int k = 0; k < 3; k++) {
                const uint32_t a = soup->triangles[t][k], b = soup->triangles[t][(k + 1) % 3];
                const uint32_t low = a < b ? a : b, high = a < b ? b : a;
                if (pass == 0)
                    start[low + 1]++;
                else if (a != b)
                    half[start[low]++] = (half_edge){high, s->inputs[t], a < b ? 1 : -1};
                else
                    half[start[low]++] = (half_edge){high, s->inputs[t], 0};
            }
        for (size_t v = 0; v < soup->vertex_count && pass == 0; v++)
            start[v + 1] += start[v];
    }
    size_t n = 0;
    for (size_t v = 0; v < soup->vertex_count; v++) {
        half_edge *run = half + n;
        const size_t count = start[v] - n;
        n = start[v];
        qsort(run, count, sizeof *run, compare_halves);
        for (size_t i = 0, j; i < count; i = j) {
            int32_t sum = 0;
            for (j = i; j < count && compare_halves(&run[i], &run[j]) == 0; j++)
                sum += run[j].direction;
            const int fault = j - i == 1 ? ONE_TRIANGLE : sum % 2 ? ODD_TRIANGLES : NOT_ALIKE;
            if (sum && out->count[fault]++ == 0) {
                out->first[fault][0] = (uint32_t)v;
                out->first[fault][1] = run[i].high;
                out->first[fault][2] = run[i].input;
            }
        }
    }
}

/* A triangle by its points, the lowest first, and its input. */
typedef struct named_triangle {
    uint32_t input, v[3];
} named_triangle;

static int compare_triangles(const void *x, const void *y)
{
    const named_triangle *a = x, *b = y;
    int order = (a->input > b->input) - (a->input < b->input);
    for (int k = 0; k < 3 && !order; k++)
        order = (a->v[k] > b->v[k]) - (a->v[k] < b->v[k]);
    return order;
}

/* Counts the triangles of an input that are there again. */
static size_t count_repeated(const cwi_grid_solids *s, uint32_t input)
{
    size_t count = 0, repeated = 0;
    named_triangle *list = cwi_alloc_array(s->soup.triangle_count, sizeof *list);
    for (size_t t = 0; t < s->soup.triangle_count && list; t++) {
        const uint32_t *v = s->soup.triangles[t];
        int low = v[0] < v[1] ? 0 : 1;
        low = v[low] < v[2] ? low : 2;
        if (s->inputs[t] == input && !cwi_triangle_is_collapsed(v))
            list[count++] =
                (named_triangle){input, {v[low], v[(low + 1) % 3], v[(low + 2) % 3]}};
    }
    if (count)
        qsort(list, count, sizeof *list, compare_triangles);
    for (size_t n = 1; n < count; n++)
        repeated += compare_triangles(&list[n - 1], &list[n]) == 0;
    cwi_free(list);
    return repeated;
}

/* Says what keeps an input from being a solid, and where. */
static cw_status refuse_faults(cwi_grid_solids *s, const edge_faults *faults,
                               const double origin[3], cw_error *err)
{
    const int fault = faults->count[ONE_TRIANGLE]    ? ONE_TRIANGLE
                      : faults->count[ODD_TRIANGLES] ? ODD_TRIANGLES
                                                     : NOT_ALIKE;
    const uint32_t *first = faults->first[fault];
    const size_t repeated = fault == ODD_TRIANGLES ? count_repeated(s, first[2]) : 0;
    double p[2][3];
    char what[128];
    s->open_mesh = first[2] + 1;
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++)
            p[i][k] = origin[k] + s->soup.vertices[first[i]][k] / s->scale;
    if (repeated)
        snprintf(what, sizeof what, "has %zu triangle%s twice, with an edge", repeated,
                 repeated == 1 ? "" : "s");
    else
        snprintf(what, sizeof what,
                 fault == ONE_TRIANGLE ? "is open at %zu edge%s, one"
                 : fault == ODD_TRIANGLES
                     ? "has an odd number of triangles at %zu edge%s, one"
                     : "has triangles that do not face the same way at %zu "
                       "edge%s, one",
                 faults->count[fault], faults->count[fault] == 1 ? "" : "s");
    return cwi_fail(err, CW_ERR_CHECK,
                    "mesh %u of %zu %s from (%.6g %.6g %.6g) to (%.6g %.6g %.6g): a boolean "
                    "needs closed meshes, see 'repair'",
                    first[2] + 1, s->input_count, what, p[0][0], p[0][1], p[0][2], p[1][0],
                    p[1][1], p[1][2]);
}

static cw_status require_closed(cwi_grid_solids *s, const double origin[3], cw_error *err)
{
    half_edge *half = cwi_alloc_array(3 * s->soup.triangle_count, sizeof *half);
    size_t *start = cwi_alloc_zeroed(s->soup.vertex_count + 1, sizeof *start);
    edge_faults faults = {0};
    cw_status st = half && start ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK)
        find_faults(s, half, start, &faults);
    for (int n = 0; n < EDGE_FAULTS && st == CW_OK; n++)
        if (faults.count[n])
            st = refuse_faults(s, &faults, origin, err);
    cwi_free(half);
    cwi_free(start);
    return st;
}

/* --- meshes ------------------------------------------------------------------------------- */

/* Returns the power of two by which coordinates become integers below 2^CWI_GRID_BITS. */
static double find_scale(double max)
{
    int exponent;
    frexp(max, &exponent);
    return max > 0 ? ldexp(1, CWI_GRID_BITS - exponent) : 1;
}

/* Computes a vertex in the frame of the first mesh. */
static void to_frame(const cw_mesh *const *meshes, size_t n, size_t v, double x[3])
{
    for (int k = 0; k < 3; k++) {
        const double shift = meshes[n]->origin[k] - meshes[0]->origin[k];
        const double p = (double)meshes[n]->positions[3 * v + (size_t)k];
        x[k] = shift == 0 ? p : (double)(float)(p + shift);
    }
}

static double find_extent(const cw_mesh *const *meshes, size_t count)
{
    double max = 0, x[3];
    for (size_t n = 0; n < count; n++)
        for (size_t v = 0; v < meshes[n]->vertex_count; v++) {
            to_frame(meshes, n, v, x);
            for (int k = 0; k < 3; k++)
                max = fabs(x[k]) > max ? fabs(x[k]) : max;
        }
    return max;
}

static void add_mesh(cwi_grid_solids *out, places *p, const cw_mesh *const *meshes, size_t n,
                     uint32_t *number, uint32_t *source)
{
    const cw_mesh *mesh = meshes[n];
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        double x[3], from[3];
        to_frame(meshes, n, v, x);
        for (int k = 0; k < 3; k++) {
            const double shift = mesh->origin[k] - meshes[0]->origin[k];
            from[k] = (double)mesh->positions[3 * v + (size_t)k] + shift;
            x[k] = nearbyint(x[k] * out->scale) + 0.0; /* no -0 */
            from[k] -= x[k] / out->scale;
        }
        out->moved_mm = fmax(out->moved_mm, cwi_length(from));
        number[v] = number_place(p, x);
    }
    double volume = 0;
    const size_t first = out->soup.triangle_count;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *c = mesh->triangles + 3 * t;
        const uint32_t v[3] = {number[c[0]], number[c[1]], number[c[2]]};
        const double *a = out->soup.vertices[v[0]], *b = out->soup.vertices[v[1]],
                     *d = out->soup.vertices[v[2]];
        double cross[3];
        cwi_cross(b, d, cross);
        volume += cwi_dot(a, cross);
        add_triangle(out, v, (uint32_t)n, (*source)++);
    }
    out->turned += volume < 0;
    for (size_t t = first; t < out->soup.triangle_count && volume < 0; t++) {
        const uint32_t corner = out->soup.triangles[t][1];
        out->soup.triangles[t][1] = out->soup.triangles[t][2];
        out->soup.triangles[t][2] = corner;
    }
}

cw_status cwi_solids_gather(const cw_mesh *const *meshes, size_t count, cwi_grid_solids *out,
                            cw_error *err)
{
    size_t vertices = 0, triangles = 0, largest = 0;
    for (size_t n = 0; n < count; n++) {
        vertices += meshes[n]->vertex_count;
        triangles += meshes[n]->triangle_count;
        largest = meshes[n]->vertex_count > largest ? meshes[n]->vertex_count : largest;
    }
    if (triangles >= INT32_MAX / 3 || vertices >= INT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT, "the meshes have more than 2^31 / 3 triangles");
    places p = {0};
    uint32_t source = 0, *number = cwi_alloc_array(largest, sizeof *number);
    cw_status st = CW_OK;
    out->input_count = count;
    out->scale = find_scale(find_extent(meshes, count));
    if (number && alloc_places(&p, &out->soup, vertices) && alloc_triangles(out, triangles)) {
        for (size_t n = 0; n < count; n++)
            add_mesh(out, &p, meshes, n, number, &source);
        st = require_closed(out, meshes[0]->origin, err);
        if (st == CW_OK)
            st = cwi_solids_set_flat_aside(out, err);
    } else
        st = cwi_fail_memory(err);
    cwi_free(number);
    cwi_free(p.slots);
    return st;
}

cw_status cwi_solids_again(const float *positions, const cwi_sheets *sheets, size_t first_new,
                           double scale, cwi_grid_solids *out, cw_error *err)
{
    places p = {0};
    uint32_t *number = cwi_alloc_array(sheets->vertex_count, sizeof *number);
    out->moved = cwi_alloc_array(sheets->triangle_count, sizeof *out->moved);
    const bool done = number && out->moved &&
                      alloc_places(&p, &out->soup, sheets->vertex_count) &&
                      alloc_triangles(out, sheets->triangle_count);
    out->input_count = 1;
    out->scale = scale;
    for (size_t v = 0; v < sheets->vertex_count && done; v++) {
        double x[3];
        for (size_t k = 0; k < 3; k++)
            x[k] = nearbyint((double)positions[3 * v + k] * scale) + 0.0;
        number[v] = number_place(&p, x);
    }
    for (size_t t = 0; t < sheets->triangle_count && done; t++) {
        const uint32_t *c = sheets->triangles + 3 * t;
        out->moved[t] = sheets->points[c[0]] >= first_new ||
                        sheets->points[c[1]] >= first_new || sheets->points[c[2]] >= first_new;
        add_triangle(out, (uint32_t[3]){number[c[0]], number[c[1]], number[c[2]]}, 0,
                     sheets->sources[t]);
    }
    cwi_free(number);
    cwi_free(p.slots);
    return done ? cwi_solids_set_flat_aside(out, err) : cwi_fail_memory(err);
}

void cwi_solids_free(cwi_grid_solids *s)
{
    cwi_free(s->soup.vertices);
    cwi_free(s->soup.triangles);
    cwi_free(s->inputs);
    cwi_free(s->sources);
    cwi_free(s->moved);
    *s = (cwi_grid_solids){0};
}
