/* How many closed curves the surface draws on the sides of the volume's box.
 *
 * The box's surface is a sphere of squares. The curves cut it into patches, inside and outside
 * by turns; patches and curves form a tree, so curves = patches - 1. Inside samples are joined
 * along the edges of squares only and outside ones across diagonals too, as the case table
 * keeps inside corners apart. */
#include "core/memory.h"
#include "core/status.h"
#include "extract/ambiguous.h"

typedef struct box {
    const cwi_grid *grid;
    size_t n[3];
    uint32_t *parent; /* union-find over the samples of the six sides */
    size_t patches;
} box;

/* Number of a sample on the box's surface: the bottom layer, a ring for every layer, the top.
 */
static size_t surface_index(const size_t n[3], const size_t p[3])
{
    const size_t layer = n[0] * n[1], ring = 2 * (n[0] + n[1]) - 4;
    if (p[2] == 0)
        return p[1] * n[0] + p[0];
    const size_t begin = layer + (p[2] - 1) * ring;
    if (p[2] == n[2] - 1)
        return begin + p[1] * n[0] + p[0];
    if (p[1] == 0)
        return begin + p[0];
    if (p[1] == n[1] - 1)
        return begin + n[0] + p[0];
    return begin + 2 * n[0] + 2 * (p[1] - 1) + (p[0] != 0);
}

static bool is_inside(const box *b, const size_t p[3])
{
    const uint64_t *row = cwi_grid_row(b->grid, (p[2] + 1) * b->grid->rows_y + p[1] + 1);
    return row[(p[0] + 1) / 64] >> (p[0] + 1) % 64 & 1;
}

static uint32_t find(uint32_t *parent, uint32_t x)
{
    while (parent[x] != x)
        x = parent[x] = parent[parent[x]];
    return x;
}

static void join(box *b, const size_t p[3], const size_t q[3])
{
    const uint32_t x = find(b->parent, (uint32_t)surface_index(b->n, p));
    const uint32_t y = find(b->parent, (uint32_t)surface_index(b->n, q));
    if (x != y) {
        b->parent[x > y ? x : y] = x > y ? y : x;
        b->patches--;
    }
}

/* Whether the inside corners of an alternating square are joined; c[in] is one of them. */
static bool joins_inside(const box *b, size_t c[4][3], int in)
{
    double v[2][2];
    if (b->grid->simple)
        return false;
    for (int n = 0; n < 4; n++)
        v[(n - in) & 1][n >> 1] = cwi_value_at(b->grid, c[n][0] + 1, c[n][1] + 1, c[n][2] + 1);
    return cwi_face_joins(v[0], v[1], cwi_zero_is_inside(b->grid));
}

/* Joins the corners of one square: neighbours of a kind, and one diagonal of an alternating
 * one. */
static void join_square(box *b, const size_t at[3], int u, int v)
{
    size_t c[4][3];
    int alike = 0;
    for (int n = 0; n < 4; n++)
        for (int a = 0; a < 3; a++)
            c[n][a] = at[a] + (a == u && (n == 1 || n == 2)) + (a == v && n >= 2);
    for (int n = 0; n < 4; n++)
        if (is_inside(b, c[n]) == is_inside(b, c[(n + 1) % 4])) {
            join(b, c[n], c[(n + 1) % 4]);
            alike++;
        }
    if (alike > 0)
        return;
    const int in = is_inside(b, c[0]) ? 0 : 1;
    const int n = joins_inside(b, c, in) ? in : 1 - in;
    join(b, c[n], c[n + 2]);
}

static void join_side(box *b, int axis, size_t side)
{
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    size_t at[3];
    at[axis] = side;
    for (at[v] = 0; at[v] + 1 < b->n[v]; at[v]++)
        for (at[u] = 0; at[u] + 1 < b->n[u]; at[u]++)
            join_square(b, at, u, v);
}

cw_status cwi_grid_border_loops(const cwi_grid *grid, size_t *loops, cw_error *err)
{
    const size_t *n = grid->volume.dim;
    const size_t count = 2 * n[0] * n[1] + (n[2] - 2) * (2 * (n[0] + n[1]) - 4);
    box b = {.grid = grid, .n = {n[0], n[1], n[2]}, .patches = count};
    if (count > UINT32_MAX)
        return cw_fail(err, CW_ERR_LIMIT, "the volume's border has %zu voxels, more than %u",
                       count, UINT32_MAX);
    b.parent = cwi_alloc_array(count, sizeof *b.parent);
    if (!b.parent)
        return cw_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu border voxels", count);
    for (size_t i = 0; i < count; i++)
        b.parent[i] = (uint32_t)i;
    for (int axis = 0; axis < 3; axis++) {
        join_side(&b, axis, 0);
        join_side(&b, axis, n[axis] - 1);
    }
    *loops = b.patches - 1;
    cwi_free(b.parent);
    return CW_OK;
}
