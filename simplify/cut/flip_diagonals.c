/* Flips edges between the triangles of a filled section until they are Delaunay [Lawson1977]. Ears are
 * thin, and a triangle as thin as the rounding of its corners has no direction of its own: it could
 * cross the surface above. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"
#include "core/mesh/corner_table.h"
#include "simplify/cut/section.h"

#include <string.h>

enum { MAX_FLIPS_EACH = 64, STEPS_A_REPORT = 4096 };

/* Opposite angles must exceed 180 degrees by more than rounding, so that no edge flips twice. */
static const double FLIP_MARGIN = 1e-9;

/* Sides are numbered 3 t + k: from corner k of triangle t to the next. */
typedef struct flip_work {
    const cwi_section *section;
    uint32_t *corners; /* 3 for each triangle of the section */
    size_t side_count;
    uint32_t *twins; /* the same side of the other triangle; CWI_NO_CORNER: an edge of a loop */
    uint32_t *stack; /* sides to look at */
    bool *is_stacked;
    size_t stack_count;
} flip_work;

static bool link_sides(flip_work *w)
{
    cwi_side *sides = cwi_alloc_array(w->side_count, sizeof *sides);
    if (!sides)
        return false;
    cwi_sides_list(w->corners, w->side_count, sides);
    memset(w->twins, 0xff, w->side_count * sizeof *w->twins);
    for (size_t n = 0, along; n < w->side_count; n += along) {
        const uint32_t a = sides[n].corner;
        along = cwi_sides_along(sides, w->side_count, n);
        if (along == 2 && w->corners[a] != w->corners[sides[n + 1].corner])
            cwi_twins_join(w->twins, a, sides[n + 1].corner);
    }
    cwi_free(sides);
    return true;
}

static void push_side(flip_work *w, uint32_t side)
{
    const uint32_t twin = w->twins[side];
    if (twin == CWI_NO_CORNER)
        return;
    side = side < twin ? side : twin;
    if (!w->is_stacked[side])
        w->stack[w->stack_count++] = side;
    w->is_stacked[side] = true;
}

/* An angle between two edges: their dot product, and the length of their cross product. */
typedef struct corner_angle {
    double dot, cross;
} corner_angle;

static corner_angle measure_angle(const flip_work *w, uint32_t at, uint32_t a, uint32_t b)
{
    const float *p = w->section->cut->positions;
    double u[3], v[3], cross[3];
    cwi_sub_points(p + 3 * (size_t)a, p + 3 * (size_t)at, u);
    cwi_sub_points(p + 3 * (size_t)b, p + 3 * (size_t)at, v);
    cwi_cross(u, v, cross);
    return (corner_angle){cwi_dot(u, v), cwi_length(cross)};
}

static double measure_width(const flip_work *w, uint32_t a, uint32_t b, uint32_t c)
{
    const float *p = w->section->cut->positions;
    const uint32_t corners[3] = {a, b, c};
    double longest = 0;
    for (size_t k = 0; k < 3; k++)
        longest =
            cwi_greater(longest, cwi_point_distance_sq(p + 3 * (size_t)corners[k],
                                                       p + 3 * (size_t)corners[(k + 1) % 3]));
    return longest > 0 ? measure_angle(w, a, b, c).cross / sqrt(longest) : 0;
}

/* Returns true if the diagonal of a, d, b, c from d to c is better than that from a to b: because a
 * triangle was as thin as the rounding, or because the sum of the angles at c and d is larger. */
static bool is_better(const flip_work *w, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    const double thin = w->section->cut->tolerance;
    const double before = cwi_lesser(measure_width(w, a, b, c), measure_width(w, b, a, d));
    const double after = cwi_lesser(measure_width(w, a, d, c), measure_width(w, d, b, c));
    if (before < thin || after < thin)
        return after > before * (1 + FLIP_MARGIN);
    const corner_angle one = measure_angle(w, c, a, b), two = measure_angle(w, d, a, b);
    const double sum = one.dot * two.cross + two.dot * one.cross;
    const double size = sqrt(one.dot * one.dot + one.cross * one.cross) *
                        sqrt(two.dot * two.dot + two.cross * two.cross);
    return sum < -FLIP_MARGIN * size;
}

/* Returns true if the other diagonal of the two triangles at a side is better, and inside of them. */
static bool is_flip_better(const flip_work *w, uint32_t side)
{
    const uint32_t twin = w->twins[side];
    const uint32_t a = w->corners[side], b = w->corners[cwi_corner_next(side)],
                   c = w->corners[cwi_corner_prev(side)], d = w->corners[cwi_corner_prev(twin)];
    const cwi_section *s = w->section;
    if (c == d || !is_better(w, a, b, c, d))
        return false;
    const int first = cwi_section_turn_vertices(s, a, b, c),
              second = cwi_section_turn_vertices(s, b, a, d);
    const int sign = first ? first : second;
    return sign != 0 && first * second >= 0 && cwi_section_turn_vertices(s, a, d, c) == sign &&
           cwi_section_turn_vertices(s, d, b, c) == sign;
}

static void set_twins(flip_work *w, uint32_t a, uint32_t b)
{
    w->twins[a] = b;
    if (b != CWI_NO_CORNER)
        w->twins[b] = a;
}

/* Turns a, b, c and b, a, d into a, d, c and d, b, c. */
static void flip_side(flip_work *w, uint32_t side)
{
    const uint32_t twin = w->twins[side], bc = cwi_corner_next(side), ca = cwi_corner_next(bc),
                   ad = cwi_corner_next(twin), db = cwi_corner_next(ad);
    const uint32_t c = w->corners[ca], d = w->corners[db];
    const uint32_t beyond_ad = w->twins[ad], beyond_bc = w->twins[bc];
    w->corners[bc] = d; /* side: a to d; bc: d to c; ca stays */
    w->corners[ad] = c; /* twin: b to c; ad: c to d; db stays */
    set_twins(w, side, beyond_ad);
    set_twins(w, twin, beyond_bc);
    set_twins(w, bc, ad);
    push_side(w, side);
    push_side(w, ca);
    push_side(w, twin);
    push_side(w, db);
}

static cw_status flip_sides(flip_work *w, cw_error *err)
{
    size_t flips = MAX_FLIPS_EACH * w->side_count;
    for (uint32_t n = 0; n < w->side_count; n++)
        push_side(w, n);
    for (size_t step = 0; w->stack_count && flips; step++) {
        const uint32_t side = w->stack[--w->stack_count];
        if (step % STEPS_A_REPORT == 0) {
            cw_status st = cwi_progress(&w->section->cut->desc.progress, "fill", 1, err);
            if (st != CW_OK)
                return st;
        }
        w->is_stacked[side] = false;
        if (w->twins[side] == CWI_NO_CORNER || !is_flip_better(w, side))
            continue;
        flip_side(w, side);
        flips--;
    }
    return CW_OK;
}

cw_status cwi_section_flip(const cwi_section *s, size_t first, cw_error *err)
{
    flip_work w = {.section = s,
                   .corners = s->cut->triangles + 3 * first,
                   .side_count = 3 * (s->cut->triangle_count - first)};
    if (!w.side_count)
        return CW_OK;
    w.twins = cwi_alloc_array(w.side_count, sizeof *w.twins);
    w.stack = cwi_alloc_array(w.side_count, sizeof *w.stack);
    w.is_stacked = cwi_alloc_zeroed(w.side_count, sizeof *w.is_stacked);
    const bool ok = w.twins && w.stack && w.is_stacked && link_sides(&w);
    cw_status st = ok ? flip_sides(&w, err) : cwi_fail_memory(err);
    cwi_free(w.twins);
    cwi_free(w.stack);
    cwi_free(w.is_stacked);
    return st;
}
