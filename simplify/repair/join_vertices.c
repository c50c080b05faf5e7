/* Joins vertices that become one, where the planes of their triangles meet. */
#include "core/base/memory.h"
#include "core/geometry/triangle.h"
#include "core/geometry/union_find.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh_triangle.h"
#include "simplify/repair/border_list.h"

#include <math.h>

/* Weight of the middle beside the planes: it decides where they are nearly one plane. */
static const double MIDDLE_WEIGHT = 0.003;

/* Vertices that become one, and the planes around them. */
typedef struct joined_vertex {
    double middle[3];
    double rows[3][3], right[3]; /* sums over the planes: rows * x = right, from the middle */
    size_t vertices, planes;
} joined_vertex;

/* Numbers the sets of several vertices. number: of a root; UINT32_MAX of others. Returns how many there are */
static size_t number_sets(const cw_mesh *m, uint32_t *root, uint32_t *number)
{
    size_t count = 0;
    for (uint32_t v = 0; v < m->vertex_count; v++)
        number[v] = UINT32_MAX;
    for (uint32_t v = 0; v < m->vertex_count; v++) {
        const uint32_t top = cwi_sets_find(root, v);
        if (top != v && number[top] == UINT32_MAX)
            number[top] = (uint32_t)count++;
    }
    return count;
}

static void find_middles(const cw_mesh *m, const uint32_t *root, const uint32_t *number,
                         size_t count, joined_vertex *joined)
{
    for (uint32_t v = 0; v < m->vertex_count; v++) {
        joined_vertex *j = number[root[v]] == UINT32_MAX ? NULL : &joined[number[root[v]]];
        for (size_t a = 0; a < 3 && j; a++)
            j->middle[a] += (double)m->positions[3 * (size_t)v + a];
        if (j)
            j->vertices++;
    }
    for (size_t n = 0; n < count; n++)
        for (int a = 0; a < 3; a++)
            joined[n].middle[a] /= (double)joined[n].vertices;
}

static void add_plane(joined_vertex *j, const float *point, const double normal[3])
{
    double from[3];
    for (int a = 0; a < 3; a++)
        from[a] = (double)point[a] - j->middle[a];
    const double height = cwi_dot(normal, from);
    for (int a = 0; a < 3; a++) {
        j->right[a] += height * normal[a];
        for (int b = 0; b < 3; b++)
            j->rows[a][b] += normal[a] * normal[b];
    }
    j->planes++;
}

static void add_planes(const cw_mesh *m, const uint32_t *root, const uint32_t *number,
                       joined_vertex *joined)
{
    for (size_t t = 0; t < m->triangle_count; t++) {
        double p[3][3], normal[3];
        bool has_normal = false;
        for (size_t k = 0; k < 3; k++) {
            const uint32_t v = m->triangles[3 * t + k], n = number[root[v]];
            if (n == UINT32_MAX)
                continue;
            if (!has_normal) {
                cwi_mesh_corners(m, t, p);
                cwi_triangle_normal(p[0], p[1], p[2], normal);
                if (!cwi_normalise(normal))
                    break;
                has_normal = true;
            }
            add_plane(&joined[n], m->positions + 3 * (size_t)v, normal);
        }
    }
}

/* Finds the point nearest to the planes and, weakly, to the middle; not farther from that than most_mm. */
static void solve_vertex(const joined_vertex *j, double most_mm, float *position)
{
    double columns[3][3], cross[3][3], move[3];
    const double weight = MIDDLE_WEIGHT * (double)j->planes;
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b < 3; b++)
            columns[a][b] = j->rows[a][b];
        columns[a][a] += weight;
    }
    for (int a = 0; a < 3; a++)
        cwi_cross(columns[(a + 1) % 3], columns[(a + 2) % 3], cross[a]);
    const double determinant = cwi_dot(columns[0], cross[0]);
    for (int a = 0; a < 3; a++)
        move[a] = determinant > 0 ? cwi_dot(cross[a], j->right) / determinant : 0;
    const double length = cwi_length(move), share = length > most_mm ? most_mm / length : 1;
    for (int a = 0; a < 3; a++)
        position[a] = (float)(j->middle[a] + share * move[a]);
}

bool cwi_join_vertices(cw_mesh *m, uint32_t *root, double most_mm, size_t *welded)
{
    uint32_t *number = cwi_alloc_array(m->vertex_count, sizeof *number);
    const size_t count = number ? number_sets(m, root, number) : 0;
    joined_vertex *joined = cwi_alloc_zeroed(count, sizeof *joined);
    const bool ok = number && joined;
    for (uint32_t v = 0; v < m->vertex_count && ok; v++) {
        root[v] = cwi_sets_find(root, v);
        *welded += root[v] != v;
    }
    if (ok && count) {
        find_middles(m, root, number, count, joined);
        add_planes(m, root, number, joined);
    }
    for (size_t v = 0; v < m->vertex_count && ok; v++)
        if (number[v] != UINT32_MAX)
            solve_vertex(&joined[number[v]], most_mm, m->positions + 3 * v);
    for (size_t c = 0; c < 3 * m->triangle_count && ok; c++)
        m->triangles[c] = root[m->triangles[c]];
    cwi_free(number);
    cwi_free(joined);
    return ok;
}
