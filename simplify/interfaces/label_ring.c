/* Makes the ring of a collapse: triangles before and after, their turns and shapes. */
#include "simplify/interfaces/label_ring.h"

#include "core/geometry/box.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"

#include <string.h>

/* The least cosine between the normals of a triangle before and after: 78 degrees. */
#define MIN_COSINE 0.2

/* The least ratio of height to longest side of a triangle, unless one of the ring's triangles
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

static void put_box(cwi_collapse_ring *ring, cwi_boxes_node *nodes, size_t n,
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
        ring->box[k] = box[k] < ring->box[k] ? box[k] : ring->box[k];
        ring->box[k + 3] = box[k + 3] > ring->box[k + 3] ? box[k + 3] : ring->box[k + 3];
    }
    cwi_boxes_put(nodes, n, box);
}

static void add_swept(cwi_collapse_ring *ring, const double w[3], const double a[3],
                      const double b[3], const double position[3])
{
    const double *const points[4] = {w, a, b, position};
    cwi_swept *swept = &ring->swept[ring->swept_count];
    for (int i = 0; i < 4; i++)
        memcpy(swept->p[i], points[i], sizeof swept->p[i]);
    put_box(ring, ring->swept_boxes, ring->swept_count++, points, 4);
}

/* The shapes of triangles of a ring: the poorest before, and the poorest after. */
typedef struct ring_shapes {
    double before, after;
} ring_shapes;

/* Adds the triangles `around` one end of the edge. Returns false if one turns too far. */
static bool add_ring(cwi_collapse_ring *ring, const cwi_complex *c, const cwi_ring *around,
                     uint32_t center, uint32_t other, ring_shapes *shapes)
{
    double w[3], position[3];
    get_point(c, center, w);
    for (int k = 0; k < 3; k++)
        position[k] = (double)ring->move.position[k];
    const bool is_moved = memcmp(w, position, sizeof w) != 0;
    for (size_t i = 0; i < around->triangle_count; i++) {
        const cwi_ring_triangle *s = &around->triangles[i];
        double a[3], b[3], before[3];
        get_point(c, s->a, a);
        get_point(c, s->b, b);
        cwi_triangle_normal(w, a, b, before);
        shapes->before = cwi_lesser(shapes->before, find_shape(before, w, a, b));
        if (s->a == other || s->b == other) {
            if (center == ring->move.keep)
                continue; /* it comes with the other end */
            ring->gone[ring->gone_count++] = s->triangle;
            add_swept(ring, w, a, b, position);
            continue;
        }
        cwi_moved_triangle *moved = &ring->triangles[ring->triangle_count];
        *moved = (cwi_moved_triangle){s->triangle, s->a, s->b, c->patches[s->triangle], {0}, 0};
        cwi_triangle_normal(position, a, b, moved->normal);
        const double now = cwi_dot(moved->normal, moved->normal), old = cwi_dot(before, before),
                     turn = cwi_dot(moved->normal, before);
        if (old > 0 && !(turn > 0 && turn * turn >= MIN_COSINE * MIN_COSINE * now * old))
            return false;
        shapes->after = cwi_lesser(shapes->after, find_shape(moved->normal, position, a, b));
        moved->scale = sqrt(cwi_distance_sq(position, a) * cwi_distance_sq(position, b));
        put_box(ring, ring->triangle_boxes, ring->triangle_count++,
                (const double *const[3]){position, a, b}, 3);
        if (is_moved)
            add_swept(ring, w, a, b, position);
    }
    return true;
}

bool cwi_collapse_ring_make(cwi_collapse_ring *ring, const cwi_complex *c,
                            const cwi_label_move *move, const cwi_ring *keep_ring,
                            const cwi_ring *drop_ring)
{
    ring_shapes shapes = {INFINITY, INFINITY};
    ring->move = *move;
    ring->triangle_count = ring->gone_count = ring->swept_count = 0;
    for (int k = 0; k < 3; k++) {
        ring->box[k] = INFINITY;
        ring->box[k + 3] = -INFINITY;
    }
    return add_ring(ring, c, keep_ring, move->keep, move->drop, &shapes) &&
           add_ring(ring, c, drop_ring, move->drop, move->keep, &shapes) &&
           shapes.after >= cwi_lesser(MIN_SHAPE, shapes.before) && shapes.after > 1e-6;
}
