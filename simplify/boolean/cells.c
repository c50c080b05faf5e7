/* Edges of facets, and the cells between them. Around an edge, each facet faces the next one: the sides that see
 * each other belong to one cell. */
#include "simplify/boolean/complex.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/triangle.h"
#include "core/geometry/union_find.h"

#include <math.h>
#include <stdlib.h>

/* A facet at an edge from a lower to a higher point. */
typedef struct spoke {
    cwi_wide normal[3]; /* of the facet if it runs along the edge, else of its other side */
    double n[3];        /* the same, rounded */
    uint32_t corner;
    bool rising; /* runs along the edge */
} spoke;

typedef struct builder {
    const cwi_soup *s;
    const cwi_triangle_parts *parts;
    const cwi_facets *f;
    cwi_space_cells *out;
    uint32_t *sets; /* of sides */
    uint64_t *half; /* of each edge of a facet: higher point, corner; grouped by lower point */
    size_t *start;
    spoke *spokes;
    size_t spoke_capacity, ring_capacity, corner_capacity, corner_count;
} builder;

static uint32_t point_at_corner(const builder *b, uint32_t corner)
{
    return b->f->corners[corner / 3][corner % 3];
}

static bool is_rising(const builder *b, uint32_t corner)
{
    return point_at_corner(b, corner) < point_at_corner(b, cwi_corner_next(corner));
}

/* Returns the side of a facet that is met first by what turns counter-clockwise away from it; or the other. */
static uint32_t side_of(uint32_t corner, bool rising, bool counter_clockwise)
{
    return 2 * (corner / 3) + (rising != counter_clockwise);
}

/* --- around an edge ----------------------------------------------------------------------- */

static int exact_cross(const spoke *a, const spoke *b, int k)
{
    cwi_big x[4], out;
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    cwi_big_set(&x[0], a->normal[i]);
    cwi_big_set(&x[1], b->normal[j]);
    cwi_big_set(&x[2], a->normal[j]);
    cwi_big_set(&x[3], b->normal[i]);
    cwi_big_cross(&x[0], &x[1], &x[2], &x[3], &out);
    return cwi_big_sign(&out);
}

/* Returns the sign of the sine of the angle from one facet to another about the edge from p to q. */
static int sine_sign(const builder *b, const spoke *from, const spoke *to,
                     const cwi_exact_point *p, const cwi_exact_point *q)
{
    int longest = 0;
    double cross[3], size[3];
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const double x = from->n[i] * to->n[j], y = from->n[j] * to->n[i];
        cross[k] = x - y;
        size[k] = fabs(x) + fabs(y);
        if (fabs(cross[k]) > fabs(cross[longest]))
            longest = k;
    }
    if (fabs(cross[longest]) > 0x1p-49 * size[longest])
        return (cross[longest] > 0 ? 1 : -1) * cwi_point_compare(b->s, q, p, longest);
    for (int k = 0; k < 3; k++) {
        const int sign = exact_cross(from, to, k);
        if (sign)
            return sign * cwi_point_compare(b->s, q, p, k);
    }
    return 0;
}

/* Returns the quarter of a facet's angle from the first one: 0 none, 1 up to a half turn, 2 half, 3 more. */
static int quarter_of(const builder *b, const spoke *first, const spoke *x,
                      const cwi_exact_point *p, const cwi_exact_point *q)
{
    const int sine = x == first ? 0 : sine_sign(b, first, x, p, q);
    if (sine)
        return sine > 0 ? 1 : 3;
    return cwi_wide_dot_sign(first->normal, x->normal) > 0 ? 0 : 2;
}

/* Sorts the facets at an edge by angle; false: two are at one. */
static bool sort_spokes(builder *b, size_t count, const cwi_exact_point *p,
                        const cwi_exact_point *q)
{
    const spoke first = b->spokes[0];
    for (size_t n = 1; n < count; n++) {
        const spoke x = b->spokes[n];
        const int quarter = quarter_of(b, &first, &x, p, q);
        size_t at = n;
        if (quarter == 0)
            return false;
        for (; at > 1; at--) {
            const spoke *before = &b->spokes[at - 1];
            const int other = quarter_of(b, &first, before, p, q);
            const int sine =
                other == quarter && quarter != 2 ? sine_sign(b, before, &x, p, q) : 0;
            if (other == quarter && sine == 0)
                return false;
            if (other < quarter || (other == quarter && sine > 0))
                break;
            b->spokes[at] = *before;
        }
        b->spokes[at] = x;
    }
    return true;
}

static void set_spoke(const builder *b, spoke *out, uint32_t corner)
{
    out->corner = corner;
    out->rising = is_rising(b, corner);
    cwi_soup_normal(b->s, b->f->sources[corner / 3], out->normal);
    for (int k = 0; k < 3; k++) {
        out->normal[k] = out->rising ? out->normal[k] : -out->normal[k];
        out->n[k] = (double)out->normal[k];
    }
}

/* Joins the sides around an edge of more than two facets. */
static cw_status add_ring(builder *b, const uint64_t *half, size_t count, uint32_t low,
                          cw_error *err)
{
    cwi_space_cells *out = b->out;
    if (!cwi_make_room(&b->spokes, &b->spoke_capacity, count, sizeof *b->spokes) ||
        !cwi_make_room(&out->rings, &b->ring_capacity, out->ring_count + 1,
                       sizeof *out->rings) ||
        !cwi_make_room(&out->ring_corners, &b->corner_capacity, b->corner_count + count,
                       sizeof *out->ring_corners))
        return cwi_fail_memory(err);
    const cwi_exact_point p = cwi_point_at(b->s, b->parts, low);
    const cwi_exact_point q = cwi_point_at(b->s, b->parts, (uint32_t)(half[0] >> 32));
    for (size_t n = 0; n < count; n++)
        set_spoke(b, &b->spokes[n], (uint32_t)half[n]);
    if (!sort_spokes(b, count, &p, &q))
        return cwi_fail(err, CW_ERR_CHECK, "two facets at an edge are one");
    out->rings[out->ring_count++] = (cwi_edge_ring){b->corner_count, count};
    for (size_t n = 0; n < count; n++) {
        const spoke *x = &b->spokes[n], *next = &b->spokes[(n + 1) % count];
        cwi_sets_join(b->sets, side_of(x->corner, x->rising, true),
                      side_of(next->corner, next->rising, false));
        out->ring_corners[b->corner_count++] = x->corner;
        out->twins[x->corner] = CWI_NOTHING;
    }
    return CW_OK;
}

/* --- all edges ---------------------------------------------------------------------------- */

static int compare_halves(const void *x, const void *y)
{
    const uint64_t a = *(const uint64_t *)x, b = *(const uint64_t *)y;
    return a < b ? -1 : a > b;
}

static void sort_halves(uint64_t *half, size_t count)
{
    if (count > 64) {
        qsort(half, count, sizeof *half, compare_halves);
        return;
    }
    for (size_t n = 1; n < count; n++) {
        const uint64_t x = half[n];
        size_t at = n;
        for (; at && half[at - 1] > x; at--)
            half[at] = half[at - 1];
        half[at] = x;
    }
}

static void group_halves(builder *b, size_t points)
{
    const uint32_t count = (uint32_t)(3 * b->f->count);
    for (uint32_t c = 0; c < count; c++) {
        const uint32_t p = point_at_corner(b, c), q = point_at_corner(b, cwi_corner_next(c));
        b->start[(p < q ? p : q) + 1]++;
    }
    for (size_t p = 0; p < points; p++)
        b->start[p + 1] += b->start[p];
    for (uint32_t c = 0; c < count; c++) {
        const uint32_t p = point_at_corner(b, c), q = point_at_corner(b, cwi_corner_next(c));
        b->half[b->start[p < q ? p : q]++] = (uint64_t)(p < q ? q : p) << 32 | c;
    }
    for (size_t p = points; p > 0; p--)
        b->start[p] = b->start[p - 1];
    b->start[0] = 0;
}

static cw_status join_sides(builder *b, size_t points, cw_error *err)
{
    for (size_t p = 0; p < points; p++) {
        const size_t end = b->start[p + 1];
        sort_halves(b->half + b->start[p], end - b->start[p]);
        for (size_t first = b->start[p], n; first < end; first = n) {
            for (n = first + 1; n < end && b->half[n] >> 32 == b->half[first] >> 32; n++) {
            }
            if (n - first == 1)
                return cwi_fail(err, CW_ERR_CHECK, "an edge has one facet");
            if (n - first > 2) {
                const cw_status st = add_ring(b, b->half + first, n - first, (uint32_t)p, err);
                if (st != CW_OK)
                    return st;
                continue;
            }
            const uint32_t c = (uint32_t)b->half[first], d = (uint32_t)b->half[first + 1];
            const uint32_t crossed = is_rising(b, c) == is_rising(b, d);
            b->out->twins[c] = d;
            b->out->twins[d] = c;
            cwi_sets_join(b->sets, 2 * (c / 3), 2 * (d / 3) + crossed);
            cwi_sets_join(b->sets, 2 * (c / 3) + 1, 2 * (d / 3) + 1 - crossed);
        }
    }
    return CW_OK;
}

static void number_cells(builder *b)
{
    for (uint32_t n = 0; n < 2 * b->f->count;
         n++) { /* the lowest of a set names it, and comes first */
        const uint32_t root = cwi_sets_find(b->sets, n);
        b->out->sides[n] = root == n ? (uint32_t)b->out->count++ : b->out->sides[root];
    }
}

cw_status cwi_find_cells(const cwi_soup *s, const cwi_triangle_parts *parts,
                         const cwi_facets *facets, cwi_space_cells *out, cw_error *err)
{
    const size_t points = s->vertex_count + parts->point_count;
    builder b = {.s = s, .parts = parts, .f = facets, .out = out};
    b.sets = cwi_sets_alloc(2 * facets->count);
    b.half = cwi_alloc_array(3 * facets->count, sizeof *b.half);
    b.start = cwi_alloc_zeroed(points + 1, sizeof *b.start);
    out->sides = cwi_alloc_array(2 * facets->count, sizeof *out->sides);
    out->twins = cwi_alloc_array(3 * facets->count, sizeof *out->twins);
    cw_status st = CW_OK;
    if (b.sets && b.half && b.start && out->sides && out->twins) {
        group_halves(&b, points);
        st = join_sides(&b, points, err);
        if (st == CW_OK)
            number_cells(&b);
    } else
        st = cwi_fail_memory(err);
    cwi_free(b.sets);
    cwi_free(b.half);
    cwi_free(b.start);
    cwi_free(b.spokes);
    return st;
}

void cwi_space_cells_free(cwi_space_cells *cells)
{
    cwi_free(cells->sides);
    cwi_free(cells->twins);
    cwi_free(cells->rings);
    cwi_free(cells->ring_corners);
    *cells = (cwi_space_cells){0};
}
