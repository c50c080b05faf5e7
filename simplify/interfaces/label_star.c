/* Makes the star of a collapse: triangles before and after, their turns and shapes. */
#include "simplify/interfaces/label_star.h"

#include "core/geometry/box.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"

#include <string.h>

/* The least cosine between the normals of a triangle before and after: 78 degrees. */
#define MIN_COSINE 0.2

/* The least ratio of height to longest side of a triangle, unless one of the star's triangles
 * had less before. */
#define MIN_SHAPE 0.03

static void get_point(const cwi_complex *c, uint32_t vertex, double p[3])
{
    for (size_t k = 0; k < 3; k++)
        p[k] = (double)c->points[3 * (size_t)vertex + k];
}

/* Computes the ratio of a triangle's height to its longest side. */
static double find_shape(const double normal[3], const double p[3], const double a[3],
                         const double b[3])
{
    const double longest = cwi_greater(
        cwi_distance_sq(a, b), cwi_greater(cwi_distance_sq(p, a), cwi_distance_sq(p, b)));
    return longest > 0 ? cwi_length(normal) / longest : 0;
}

static void put_box(cwi_star *star, cwi_boxes_node *nodes, size_t n,
                    const double *const *points, int count)
{
    double low[3], high[3];
    float box[6];
    if (n % CWI_WIDTH == 0)
        cwi_boxes_clear(&nodes[n / CWI_WIDTH]);
    cwi_box_clear(low, high);
    for (int i = 0; i < count; i++)
        cwi_box_add(low, high, points[i]);
    for (int k = 0; k < 3; k++) {
        box[k] = (float)low[k];
        box[k + 3] = (float)high[k];
        star->box[k] = box[k] < star->box[k] ? box[k] : star->box[k];
        star->box[k + 3] = box[k + 3] > star->box[k + 3] ? box[k + 3] : star->box[k + 3];
    }
    cwi_boxes_put(nodes, n, box);
}

static void add_swept(cwi_star *star, const double w[3], const double a[3], const double b[3],
                      const double position[3])
{
    const double *const points[4] = {w, a, b, position};
    cwi_swept *swept = &star->swept[star->swept_count];
    for (int i = 0; i < 4; i++)
        memcpy(swept->p[i], points[i], sizeof swept->p[i]);
    put_box(star, star->swept_boxes, star->swept_count++, points, 4);
}

/* The shapes of triangles of a star: the poorest before, and the poorest after. */
typedef struct star_shapes {
    double before, after;
} star_shapes;

/* Adds the triangles around one end of the edge. Returns false if one turns too far. */
static bool add_ring(cwi_star *star, const cwi_complex *c, const cwi_ring *ring,
                     uint32_t center, uint32_t other, star_shapes *shapes)
{
    double w[3], position[3];
    get_point(c, center, w);
    for (int k = 0; k < 3; k++)
        position[k] = (double)star->move.position[k];
    const bool is_moved = memcmp(w, position, sizeof w) != 0;
    for (size_t i = 0; i < ring->spoke_count; i++) {
        const cwi_spoke *s = &ring->spokes[i];
        double a[3], b[3], before[3];
        get_point(c, s->a, a);
        get_point(c, s->b, b);
        cwi_triangle_normal(w, a, b, before);
        shapes->before = cwi_lesser(shapes->before, find_shape(before, w, a, b));
        if (s->a == other || s->b == other) {
            if (center == star->move.keep)
                continue; /* it comes with the other end */
            star->gone[star->gone_count++] = s->triangle;
            add_swept(star, w, a, b, position);
            continue;
        }
        cwi_star_spoke *spoke = &star->spokes[star->spoke_count];
        *spoke = (cwi_star_spoke){s->triangle, s->a, s->b, c->patches[s->triangle], {0}, 0};
        cwi_triangle_normal(position, a, b, spoke->normal);
        const double now = cwi_dot(spoke->normal, spoke->normal), old = cwi_dot(before, before),
                     turn = cwi_dot(spoke->normal, before);
        if (old > 0 && !(turn > 0 && turn * turn >= MIN_COSINE * MIN_COSINE * now * old))
            return false;
        shapes->after = cwi_lesser(shapes->after, find_shape(spoke->normal, position, a, b));
        spoke->scale = sqrt(cwi_distance_sq(position, a) * cwi_distance_sq(position, b));
        put_box(star, star->spoke_boxes, star->spoke_count++,
                (const double *const[3]){position, a, b}, 3);
        if (is_moved)
            add_swept(star, w, a, b, position);
    }
    return true;
}

bool cwi_star_make(cwi_star *star, const cwi_complex *c, const cwi_label_move *move,
                   const cwi_ring *keep_ring, const cwi_ring *drop_ring)
{
    star_shapes shapes = {INFINITY, INFINITY};
    star->move = *move;
    star->spoke_count = star->gone_count = star->swept_count = 0;
    for (int k = 0; k < 3; k++) {
        star->box[k] = INFINITY;
        star->box[k + 3] = -INFINITY;
    }
    return add_ring(star, c, keep_ring, move->keep, move->drop, &shapes) &&
           add_ring(star, c, drop_ring, move->drop, move->keep, &shapes) &&
           shapes.after >= cwi_lesser(MIN_SHAPE, shapes.before) && shapes.after > 1e-6;
}
