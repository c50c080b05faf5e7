/* Finds triangles that a ring would cross, or pass. Planes with margins of error clear nearly
 * all pairs, exact signs decide the rest. */
#include "core/geometry/triangle.h"
#include "simplify/interfaces/label_ring.h"

#include "core/geometry/triangle_intersect.h"
#include "core/geometry/vec3.h"

#include <string.h>

/* A bound of the relative error of a height above a plane in double precision. */
#define DOUBT 1e-14

/* A triangle with its corners as doubles. */
typedef struct corner_triple {
    uint32_t id[3];
    double p[3][3];
} corner_triple;

static void get_corners(const cwi_complex *c, const uint32_t id[3], corner_triple *t)
{
    for (int i = 0; i < 3; i++) {
        t->id[i] = id[i];
        for (size_t k = 0; k < 3; k++)
            t->p[i][k] = (double)c->points[3 * (size_t)id[i] + k];
    }
}

static bool has_corner(const corner_triple *t, uint32_t id)
{
    return t->id[0] == id || t->id[1] == id || t->id[2] == id;
}

/* Returns true if all corners of t but those that it shares with `other` are certainly on one
 * side of a plane: of the plane of `other`, through its corner 0. */
static bool is_beside(const corner_triple *t, const corner_triple *other,
                      const double normal[3], double scale)
{
    int above = 0, below = 0, all = 0;
    for (int i = 0; i < 3; i++) {
        if (has_corner(other, t->id[i]))
            continue;
        const double d[3] = {t->p[i][0] - other->p[0][0], t->p[i][1] - other->p[0][1],
                             t->p[i][2] - other->p[0][2]};
        const double height = cwi_dot(normal, d),
                     doubt = DOUBT * scale * (fabs(d[0]) + fabs(d[1]) + fabs(d[2]));
        above += height > doubt;
        below += height < -doubt;
        all++;
    }
    return above == all || below == all;
}

/* Returns true if two triangles share points beyond their common vertices and edges. The first
 * has an area; the second one counts as meeting if it has none. */
static bool triples_meet(const cwi_complex *c, const corner_triple *mine,
                         const cwi_moved_triangle *moved, const corner_triple *other)
{
    double u[3], v[3], normal[3];
    if (is_beside(other, mine, moved->normal, moved->scale))
        return false;
    cwi_sub(other->p[1], other->p[0], u);
    cwi_sub(other->p[2], other->p[0], v);
    cwi_cross(u, v, normal);
    if (is_beside(mine, other, normal, sqrt(cwi_dot(u, u) * cwi_dot(v, v))))
        return false;
    return !cwi_has_area(c->points, other->id) ||
           cwi_triangles_meet(c->points, mine->id, other->id);
}

/* ---- a ring and itself ------------------------------------------------------------------ */

/* Seen along the sum of its normals a ring opens like a fan if all triangles face that way and
 * go round once: then no two of them meet. */
static bool opens_like_a_fan(const cwi_collapse_ring *ring, const cwi_complex *c)
{
    double axis[3] = {0, 0, 0}, across[3];
    int rounds = 0;
    for (size_t i = 0; i < ring->triangle_count; i++)
        for (int k = 0; k < 3; k++)
            axis[k] += ring->triangles[i].normal[k];
    cwi_cross(axis, fabs(axis[0]) < fabs(axis[1]) ? (double[]){1, 0, 0} : (double[]){0, 1, 0},
              across);
    for (size_t i = 0; i < ring->triangle_count; i++) {
        const cwi_moved_triangle *s = &ring->triangles[i];
        double a = 0, b = 0;
        for (size_t k = 0; k < 3; k++) {
            const double position = (double)ring->move.position[k];
            a += across[k] * ((double)c->points[3 * (size_t)s->a + k] - position);
            b += across[k] * ((double)c->points[3 * (size_t)s->b + k] - position);
        }
        const double height = cwi_dot(s->normal, axis);
        if (!(height > DOUBT * s->scale * (fabs(axis[0]) + fabs(axis[1]) + fabs(axis[2]))))
            return false;
        rounds += a < 0 && b >= 0;
    }
    return rounds == 1;
}

static bool meets_itself(const cwi_collapse_ring *ring, const cwi_complex *c)
{
    if (c->orders[ring->move.keep] == CWI_ORDER_INNER && opens_like_a_fan(ring, c))
        return false;
    for (size_t i = 0; i < ring->triangle_count; i++) {
        const cwi_moved_triangle *s = &ring->triangles[i];
        corner_triple mine, other;
        get_corners(c, (const uint32_t[3]){ring->move.keep, s->a, s->b}, &mine);
        for (size_t j = 0; j < i; j++) {
            const cwi_moved_triangle *t = &ring->triangles[j];
            get_corners(c, (const uint32_t[3]){ring->move.keep, t->a, t->b}, &other);
            if (triples_meet(c, &mine, s, &other))
                return true;
        }
    }
    return false;
}

/* ---- a ring and others ------------------------------------------------------------------ */

/* Returns true if a point is in a closed tetrahedron. A flat one holds nothing. */
static bool is_swept(const cwi_swept *s, const double p[3])
{
    const double volume = cwi_tetrahedron_sixfold(s->p[0], s->p[1], s->p[2], s->p[3]);
    const double sign = volume < 0 ? -1 : 1, doubt = 1e-9 * fabs(volume);
    return volume != 0 &&
           sign * cwi_tetrahedron_sixfold(p, s->p[1], s->p[2], s->p[3]) >= -doubt &&
           sign * cwi_tetrahedron_sixfold(s->p[0], p, s->p[2], s->p[3]) >= -doubt &&
           sign * cwi_tetrahedron_sixfold(s->p[0], s->p[1], p, s->p[3]) >= -doubt &&
           sign * cwi_tetrahedron_sixfold(s->p[0], s->p[1], s->p[2], p) >= -doubt;
}

/* A search for triangles near a ring. */
typedef struct ring_search {
    const cwi_collapse_ring *ring;
    const cwi_complex *c;
    const uint32_t *marks;
    uint32_t mark;
} ring_search;

/* Returns true if the middle of a triangle is in the space that the ring passes through. A part
 * of the complex that changes sides has a triangle all in there, as nothing crosses the ring
 * before or after. */
static bool passes_triangle(const cwi_collapse_ring *ring, const corner_triple *other)
{
    double middle[3];
    float box[6];
    cwi_triangle_centroid(other->p[0], other->p[1], other->p[2], middle);
    for (int k = 0; k < 3; k++)
        box[k] = box[k + 3] = (float)middle[k];
    for (size_t n = 0; CWI_WIDTH * n < ring->swept_count; n++)
        for (unsigned near = cwi_boxes_meeting(&ring->swept_boxes[n], box); near;
             near &= near - 1) {
            const size_t i = CWI_WIDTH * n + (size_t)__builtin_ctz(near);
            if (is_swept(&ring->swept[i], middle))
                return true;
        }
    return false;
}

/* Returns true if the ring collides with a triangle. The vertex that stays is at its new position
 * already. */
static bool meets_triangle(void *context, uint32_t triangle, const float box[6])
{
    const ring_search *search = context;
    const cwi_collapse_ring *ring = search->ring;
    corner_triple other, mine;
    if (search->marks[triangle] == search->mark)
        return false;
    get_corners(search->c, search->c->corners + 3 * (size_t)triangle, &other);
    if (passes_triangle(ring, &other))
        return true;
    for (size_t n = 0; CWI_WIDTH * n < ring->triangle_count; n++)
        for (unsigned near = cwi_boxes_meeting(&ring->triangle_boxes[n], box); near;
             near &= near - 1) {
            const cwi_moved_triangle *s =
                &ring->triangles[CWI_WIDTH * n + (size_t)__builtin_ctz(near)];
            get_corners(search->c, (const uint32_t[3]){ring->move.keep, s->a, s->b}, &mine);
            if (triples_meet(search->c, &mine, s, &other))
                return true;
        }
    return false;
}

bool cwi_collapse_ring_collides(const cwi_collapse_ring *ring, cwi_complex *c,
                                const cwi_moving_boxes *boxes, uint32_t *marks, uint32_t mark)
{
    float *point = c->points + 3 * (size_t)ring->move.keep, before[3];
    const ring_search search = {ring, c, marks, mark};
    for (size_t i = 0; i < ring->triangle_count; i++)
        marks[ring->triangles[i].triangle] = mark;
    for (size_t i = 0; i < ring->gone_count; i++)
        marks[ring->gone[i]] = mark;
    memcpy(before, point, sizeof before);
    memcpy(point, ring->move.position, sizeof before);
    const bool is_found =
        meets_itself(ring, c) ||
        cwi_moving_boxes_any(boxes, ring->box, meets_triangle, (void *)&search);
    memcpy(point, before, sizeof before);
    return is_found;
}
