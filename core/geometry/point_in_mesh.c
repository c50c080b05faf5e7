/* Counts the crossings of a ray along x with a closed mesh, to find if a point is inside. */
#include "core/geometry/point_in_mesh.h"

#include "core/geometry/vec3.h"

typedef struct ray {
    const cw_mesh *mesh;
    const cwi_boxes *tree;
    const double (*normals)[3];
    const double *from;
    int around;
} ray;

static const float *vertex_position(const ray *r, uint32_t v)
{
    return r->mesh->positions + 3 * (size_t)v;
}

/* Finds if a side from u to v passes the ray, seen along it, and in which direction: 1, 0 or
 * -1. The two triangles at a side compute the same numbers, so no ray slips through between
 * them. */
static int pass_edge(const ray *r, uint32_t u, uint32_t v)
{
    const float *a = vertex_position(r, u < v ? u : v), *b = vertex_position(r, u < v ? v : u);
    const bool from = (double)a[1] > r->from[1], to = (double)b[1] > r->from[1];
    if (from == to)
        return 0;
    const double fraction = (r->from[1] - (double)a[1]) / ((double)b[1] - (double)a[1]);
    if ((double)a[2] + fraction * ((double)b[2] - (double)a[2]) <= r->from[2])
        return 0;
    return to == (u < v) ? 1 : -1;
}

static void meet_triangle(ray *r, uint32_t triangle)
{
    const uint32_t *v = r->mesh->triangles + 3 * (size_t)triangle;
    if (!(pass_edge(r, v[0], v[1]) + pass_edge(r, v[1], v[2]) + pass_edge(r, v[2], v[0])))
        return;
    const double *n = r->normals[triangle];
    double to[3];
    for (int a = 0; a < 3; a++)
        to[a] = (double)vertex_position(r, v[0])[a] - r->from[a];
    if (n[0] != 0 && cwi_dot(n, to) / n[0] > 0)
        r->around += n[0] > 0 ? 1 : -1;
}

static bool visit_node(void *context, size_t node)
{
    ray *r = context;
    for (size_t s = CWI_WIDTH * node; s < CWI_WIDTH * (node + 1) && s < r->tree->count; s++)
        meet_triangle(r, r->tree->order[s]);
    return true;
}

bool cwi_is_inside(const cw_mesh *mesh, const cwi_boxes *tree, const double (*normals)[3],
                   const double point[3])
{
    ray r = {.mesh = mesh, .tree = tree, .normals = normals, .from = point};
    float box[6];
    for (int a = 0; a < 3; a++) {
        box[a] = nextafterf((float)point[a], -INFINITY);
        box[a + 3] = a ? nextafterf((float)point[a], INFINITY) : INFINITY;
    }
    cwi_boxes_visit(tree, box, 0, visit_node, &r);
    return r.around > 0;
}
