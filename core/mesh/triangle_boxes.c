/* Builds the tree of a mesh's triangles. Triangles at vertices of very many triangles are cut into
 * parts, each with a box of its own. */
#include "core/mesh/triangle_boxes.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/surface_walk.h"

/* Parts of each triangle at a wide fan, and of all of them together, unless that leaves fewer than
 * the minimum. */
enum { MIN_PARTS = 4, MAX_PARTS = 64 };
static const size_t MAX_TOTAL_PARTS = (size_t)1 << 21;

/* Rounding of places between corners, as a fraction of the largest coordinate. */
static const float PART_MARGIN = 1e-6f;

typedef struct part_boxes {
    const float *points;
    const uint32_t *corners;
    size_t triangles, parts; /* parts of each triangle at a wide fan */
    uint32_t *around;        /* vertices: their triangles */
    float (*boxes)[6];
    uint32_t *triangle_of; /* boxes */
    size_t count;
} part_boxes;

static bool is_cut(const part_boxes *p, size_t triangle)
{
    const uint32_t *v = p->corners + 3 * triangle;
    return p->around[v[0]] > CWI_WIDE_FAN || p->around[v[1]] > CWI_WIDE_FAN ||
           p->around[v[2]] > CWI_WIDE_FAN;
}

/* Puts the end of the longest side first that comes before it, and then the other end. */
static void find_longest_side(const part_boxes *p, size_t triangle, const float *c[3])
{
    const uint32_t *v = p->corners + 3 * triangle;
    double longest = -1;
    size_t first = 0;
    for (size_t k = 0; k < 3; k++) {
        const double length_sq = cwi_point_distance_sq(p->points + 3 * (size_t)v[k],
                                                       p->points + 3 * (size_t)v[(k + 1) % 3]);
        if (length_sq > longest)
            first = k;
        longest = fmax(longest, length_sq);
    }
    for (size_t k = 0; k < 3; k++)
        c[k] = p->points + 3 * (size_t)v[(first + k) % 3];
}

static void add_between(float box[6], const float *from, const float *to, double fraction)
{
    for (int a = 0; a < 3; a++) {
        const float x = (float)((double)from[a] + fraction * ((double)to[a] - (double)from[a]));
        box[a] = x < box[a] ? x : box[a];
        box[a + 3] = x > box[a + 3] ? x : box[a + 3];
    }
}

/* Computes the box around the part of a triangle between two planes across its side from c[0] to
 * c[1], at fractions of it; c[2] is at the fraction `third`. */
static void set_part_box(const float *const c[3], double low, double high, double third,
                         float box[6])
{
    const double ends[2] = {low, high};
    for (int a = 0; a < 3; a++) {
        box[a] = INFINITY;
        box[a + 3] = -INFINITY;
    }
    for (int n = 0; n < 2; n++) {
        add_between(box, c[0], c[1], ends[n]);
        if (ends[n] < third)
            add_between(box, c[0], c[2], ends[n] / third);
        else
            add_between(box, c[2], c[1], third < 1 ? (ends[n] - third) / (1 - third) : 0);
    }
    if (third >= low && third <= high)
        add_between(box, c[2], c[2], 0);
}

static void add_parts(part_boxes *p, size_t triangle)
{
    const float *c[3];
    float whole[6], reach = 0;
    double side[3], to_third[3];
    cwi_boxes_triangle(p->points, p->corners + 3 * triangle, whole);
    for (int a = 0; a < 6; a++)
        reach = fmaxf(reach, fabsf(whole[a]));
    find_longest_side(p, triangle, c);
    cwi_sub_points(c[1], c[0], side);
    cwi_sub_points(c[2], c[0], to_third);
    const double length_sq = cwi_dot(side, side),
                 third =
                     length_sq > 0 ? fmin(fmax(cwi_dot(to_third, side) / length_sq, 0), 1) : 0;
    for (size_t n = 0; n < p->parts; n++) {
        float *box = p->boxes[p->count];
        set_part_box(c, (double)n / (double)p->parts, (double)(n + 1) / (double)p->parts, third,
                     box);
        for (int a = 0; a < 3; a++) {
            box[a] = fmaxf(box[a] - PART_MARGIN * reach, whole[a]);
            box[a + 3] = fminf(box[a + 3] + PART_MARGIN * reach, whole[a + 3]);
        }
        p->triangle_of[p->count++] = (uint32_t)triangle;
    }
}

static size_t count_parts(part_boxes *p)
{
    size_t cut = 0;
    for (size_t c = 0; c < 3 * p->triangles; c++)
        p->around[p->corners[c]]++;
    for (size_t t = 0; t < p->triangles; t++)
        cut += is_cut(p, t);
    p->parts = cut ? MAX_TOTAL_PARTS / cut : 1;
    p->parts = p->parts < MIN_PARTS ? MIN_PARTS : p->parts > MAX_PARTS ? MAX_PARTS : p->parts;
    return p->triangles + (p->parts - 1) * cut;
}

cw_status cwi_triangle_boxes_build(cwi_boxes *tree, const float *points, size_t vertices,
                                   const uint32_t *corners, size_t triangles, cw_error *err)
{
    part_boxes p = {.points = points, .corners = corners, .triangles = triangles};
    p.around = cwi_alloc_zeroed(vertices, sizeof *p.around);
    const size_t total = p.around ? count_parts(&p) : 0;
    p.boxes = cwi_alloc_array(total, sizeof *p.boxes);
    p.triangle_of = cwi_alloc_array(total, sizeof *p.triangle_of);
    const bool ok = p.around && p.boxes && p.triangle_of;
    for (size_t t = 0; t < triangles && ok; t++)
        if (is_cut(&p, t)) {
            add_parts(&p, t);
        } else {
            cwi_boxes_triangle(points, corners + 3 * t, p.boxes[p.count]);
            p.triangle_of[p.count++] = (uint32_t)t;
        }
    cw_status st = ok ? cwi_boxes_build(tree, (const float(*)[6])p.boxes, p.count, err)
                      : cwi_fail_memory(err);
    for (size_t s = 0; s < p.count && st == CW_OK; s++)
        tree->order[s] = p.triangle_of[tree->order[s]];
    cwi_free(p.around);
    cwi_free(p.boxes);
    cwi_free(p.triangle_of);
    return st;
}
