/* Places the points between the corners of the smallest cells: on the side of the surface that
 * fewer of the corners around are on, if that side comes near enough, else in the middle. So
 * they follow each other through walls and gaps thinner than the cells. */
#include "core/geometry/polygon_clip.h"
#include "extract/level_set/adaptive_field.h"

#include <math.h>
#include <string.h>

/* Distances from a triangle, in voxels, tried one after the other. A point on the triangle may
 * be called inside or outside: the wall or gap it is in becomes as thick as CWI_THIN anyway. */
static const double DEPTHS[] = {0.02, 0.005, 0.001, 0};

/* Maximum distance that a point moves, as a fraction of the way from the middle to the end. */
static const double MAX_REACH = 0.97;

/* The inside of an edge, a face or a cell, in which a point may be placed. */
typedef struct ring_box {
    const cwi_adaptive *a;
    double middle[3], reach[3]; /* voxels; a reach of 0: it stays on that plane */
    bool inside;                /* the side on which the point has to be */
    double distance_sq;         /* of the least way from the middle so far */
    double position[3];
} ring_box;

/* Returns how many of a room's corners are inside; `of`: the number of corners. */
static int count_inside(const ring_box *r, int *of)
{
    int count = 0;
    *of = 0;
    for (int n = 0; n < 8; n++) {
        double p[3];
        bool twice = false;
        for (int a = 0; a < 3; a++) {
            twice |= r->reach[a] == 0 && n >> a & 1;
            p[a] = r->middle[a] + (n >> a & 1 ? 1 : -1) * r->reach[a];
        }
        *of += !twice;
        count += !twice && cwi_adaptive_is_inside(r->a, p);
    }
    return count;
}

/* Finds the place in the room nearest to x, and the squares of its distances from x and from
 * the middle. */
static void keep_in(const ring_box *r, const double x[3], double position[3],
                    double distances_sq[2])
{
    distances_sq[0] = distances_sq[1] = 0;
    for (int a = 0; a < 3; a++) {
        const double reach = MAX_REACH * r->reach[a];
        const double offset = fmax(-reach, fmin(reach, x[a] - r->middle[a]));
        position[a] = r->middle[a] + offset;
        distances_sq[0] += (position[a] - x[a]) * (position[a] - x[a]);
        distances_sq[1] += offset * offset;
    }
}

/* Tries a place beside x, a point of the mesh, along a triangle's normal. */
static void step_in(ring_box *r, const double x[3], const double normal[3])
{
    double n[3], length = 0;
    for (int a = 0; a < 3; a++) {
        n[a] = r->reach[a] > 0 ? normal[a] : 0;
        length = hypot(length, n[a]);
    }
    for (size_t k = 0; k < sizeof DEPTHS / sizeof *DEPTHS && length > 0; k++) {
        double beside[3], p[3], distances_sq[2];
        for (int a = 0; a < 3; a++)
            beside[a] = x[a] + DEPTHS[k] * (r->inside ? -1 : 1) * n[a] / length;
        keep_in(r, beside, p, distances_sq);
        if (distances_sq[1] >= r->distance_sq)
            return;
        if (DEPTHS[k] > 0 ? cwi_adaptive_is_inside(r->a, p) != r->inside
                          : distances_sq[0] > CWI_THIN * CWI_THIN)
            continue;
        r->distance_sq = distances_sq[1];
        memcpy(r->position, p, sizeof p);
        return;
    }
}

static void try_triangle(ring_box *r, uint32_t t)
{
    const cwi_adaptive *a = r->a;
    cwi_polygon p[2] = {{.count = 3}};
    double x[3] = {0};
    for (size_t c = 0; c < 3; c++)
        cwi_adaptive_from_mesh(a, a->mesh, a->mesh->triangles[3 * (size_t)t + c], p[0].p[c]);
    for (int k = 0; k < 3; k++) {
        cwi_polygon_clip(&p[0], k, r->middle[k] - r->reach[k], -1, &p[1]);
        cwi_polygon_clip(&p[1], k, r->middle[k] + r->reach[k], 1, &p[0]);
    }
    for (int n = 0; n < p[0].count; n++)
        for (int k = 0; k < 3; k++)
            x[k] += p[0].p[n][k] / p[0].count;
    if (p[0].count)
        step_in(r, x, a->normals[t]);
}

static bool visit_node(void *context, size_t node)
{
    ring_box *r = context;
    const cwi_boxes *tree = &r->a->tree;
    for (size_t s = CWI_WIDTH * node; s < CWI_WIDTH * (node + 1) && s < tree->count; s++)
        try_triangle(r, tree->order[s]);
    return true;
}

/* Tries the triangles around the room, which is a little widened for rounding. */
static void try_triangles(ring_box *r)
{
    float box[6];
    double low[3], high[3];
    for (int k = 0; k < 3; k++) {
        low[k] = r->middle[k] - r->reach[k];
        high[k] = r->middle[k] + r->reach[k];
    }
    cwi_adaptive_to_mesh(r->a, low, low);
    cwi_adaptive_to_mesh(r->a, high, high);
    for (int k = 0; k < 3; k++) {
        box[k] = nextafterf((float)low[k], -INFINITY);
        box[k + 3] = nextafterf((float)high[k], INFINITY);
    }
    cwi_boxes_visit(&r->a->tree, box, 0, visit_node, r);
}

bool cwi_adaptive_position(const cwi_adaptive *a, const uint32_t at[3], double position[3],
                           bool *inside)
{
    ring_box r = {.a = a, .distance_sq = INFINITY};
    bool stays = true;
    int of = 0;
    for (int k = 0; k < 3; k++) {
        r.position[k] = r.middle[k] = (double)at[k] / CWI_PARTS;
        r.reach[k] = at[k] % 2 ? 1.0 / CWI_PARTS : 0;
        stays &= at[k] % 2 == 0;
    }
    const int count = stays ? 0 : count_inside(&r, &of);
    *inside = r.inside = 2 * count < of;
    if (!stays && 2 * count != of)
        try_triangles(&r);
    memcpy(position, r.position, sizeof r.position);
    return r.distance_sq < INFINITY;
}
