/* Builds irregular grids: cell by cell, or as a box cut into tetrahedra, wedges, pyramids or
 * hexahedra. */
#include "support/cells.h"

#include <stdlib.h>
#include <string.h>

static void *grow(void *array, size_t *room, size_t needed, size_t size)
{
    if (needed <= *room)
        return array;
    *room = 2 * needed + 64;
    array = realloc(array, *room * size);
    assert_non_null(array);
    return array;
}

static void renew(test_grid *g)
{
    g->cells.points = g->points;
    g->cells.shapes = g->shapes;
    g->cells.corners = g->corners;
    g->volume.type = CW_F64;
    g->volume.data = g->values;
    g->volume.cells = &g->cells;
    g->volume.dim[0] = g->samples;
    g->volume.dim[1] = g->volume.dim[2] = 1;
}

uint32_t test_grid_sample(test_grid *g, double x, double y, double z)
{
    size_t room = g->room[0];
    const double p[3] = {x, y, z};
    g->points = grow(g->points, &room, g->samples + 1, 3 * sizeof *g->points);
    g->values = grow(g->values, &g->room[0], g->samples + 1, sizeof *g->values);
    memcpy(g->points + 3 * g->samples, p, sizeof p);
    g->values[g->samples++] = 0;
    renew(g);
    return (uint32_t)g->samples - 1;
}

static const size_t corner_counts[CW_SHAPE_COUNT] = {4, 5, 6, 8};

void test_grid_cell(test_grid *g, cw_shape shape, const uint32_t *corners)
{
    const size_t count = corner_counts[shape];
    g->shapes = grow(g->shapes, &g->room[1], g->cells.count + 1, sizeof *g->shapes);
    g->corners = grow(g->corners, &g->room[2], g->corner_count + count, sizeof *g->corners);
    g->shapes[g->cells.count++] = (uint8_t)shape;
    memcpy(g->corners + g->corner_count, corners, count * sizeof *corners);
    g->corner_count += count;
    renew(g);
}

void test_grid_free(test_grid *g)
{
    free(g->points);
    free(g->values);
    free(g->shapes);
    free(g->corners);
    memset(g, 0, sizeof *g);
}

uint32_t *test_grid_corners(test_grid *g, size_t cell)
{
    uint32_t *corners = g->corners;
    for (size_t n = 0; n < cell; n++)
        corners += corner_counts[g->shapes[n]];
    return corners;
}

static void swap(uint32_t *corners, int a, int b)
{
    const uint32_t t = corners[a];
    corners[a] = corners[b];
    corners[b] = t;
}

void test_grid_mirror(test_grid *g, size_t cell)
{
    static const int pairs[CW_SHAPE_COUNT][2][2] = {
        {{1, 2}, {0, 0}}, {{1, 3}, {0, 0}}, {{1, 2}, {4, 5}}, {{1, 3}, {5, 7}}};
    uint32_t *corners = test_grid_corners(g, cell);
    for (int i = 0; i < 2; i++)
        swap(corners, pairs[g->shapes[cell]][i][0], pairs[g->shapes[cell]][i][1]);
}

/* --- a box ------------------------------------------------------------------------------- */

static double random_offset(double limit)
{
    return limit * (2.0 * rand() / RAND_MAX - 1);
}

/* Corner c of a box stands at x = c & 1, y = c >> 1 & 1, z = c >> 2. */
static const uint8_t around[8] = {0, 1, 3, 2, 4, 5, 7, 6}; /* as VTK has a hexahedron's */

/* Walked so that a pyramid's base on it sees the centre on the right side; the first corner and
 * the third are the ends of the diagonal by which it is halved. */
static const uint8_t box_faces[6][4] = {{0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1},
                                        {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}};

static void cut_tetrahedra(test_grid *g, const uint32_t box[8])
{
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            if (a != b) {
                uint32_t t[4] = {box[0], box[1 << a], box[1 << a | 1 << b], box[7]};
                if ((b - a + 3) % 3 == 2)
                    swap(t, 1, 2);
                test_grid_cell(g, CW_TETRAHEDRON, t);
            }
}

static void cut_wedges(test_grid *g, const uint32_t box[8])
{
    const uint8_t halves[2][3] = {{0, 1, 3}, {0, 3, 2}};
    for (int n = 0; n < 2; n++) {
        uint32_t w[6];
        for (int c = 0; c < 6; c++)
            w[c] = box[halves[n][c % 3] + c / 3 * 4];
        test_grid_cell(g, CW_WEDGE, w);
    }
}

/* A pyramid on each face, or two tetrahedra where it is halved. */
static void cut_around(test_grid *g, const uint32_t box[8], const bool halved[6])
{
    double p[3] = {0, 0, 0};
    for (int c = 0; c < 8; c++)
        for (int a = 0; a < 3; a++)
            p[a] += g->points[3 * box[c] + (size_t)a] / 8;
    const uint32_t tip = test_grid_sample(g, p[0], p[1], p[2]);
    for (int face = 0; face < 6; face++) {
        uint32_t base[4];
        for (int n = 0; n < 4; n++)
            base[n] = box[box_faces[face][n]];
        if (halved[face]) {
            test_grid_cell(g, CW_TETRAHEDRON, (uint32_t[4]){base[0], base[1], base[2], tip});
            test_grid_cell(g, CW_TETRAHEDRON, (uint32_t[4]){base[0], base[2], base[3], tip});
        } else {
            test_grid_cell(g, CW_PYRAMID,
                           (uint32_t[5]){base[0], base[1], base[2], base[3], tip});
        }
    }
}

static void cut_hexahedron(test_grid *g, const uint32_t box[8])
{
    uint32_t corners[8];
    for (int c = 0; c < 8; c++)
        corners[c] = box[around[c]];
    test_grid_cell(g, CW_HEXAHEDRON, corners);
}

static void cut_mixed(test_grid *g, const uint32_t box[8], size_t i, size_t n)
{
    const size_t fifth = 5 * i / n;
    const size_t last = 5 * (i + 1) / n, before = i ? 5 * (i - 1) / n : 0;
    if (fifth == 0) {
        cut_hexahedron(g, box);
    } else if (fifth == 4) {
        cut_wedges(g, box);
    } else {
        const bool all = fifth == 2;
        const bool halved[6] = {all || before == 2, all || last == 2, all, all, all, all};
        cut_around(g, box, halved);
    }
}

static void cut_box(test_grid *g, test_cut cut, const uint32_t box[8], size_t i, size_t n)
{
    switch (cut) {
    case TEST_TETRAHEDRA:
        cut_tetrahedra(g, box);
        break;
    case TEST_PYRAMIDS:
        cut_around(g, box, (bool[6]){false});
        break;
    case TEST_WEDGES:
        cut_wedges(g, box);
        break;
    case TEST_HEXAHEDRA:
        cut_hexahedron(g, box);
        break;
    default:
        cut_mixed(g, box, i, n);
    }
}

static void make_points(test_grid *g, size_t n, double jitter)
{
    for (size_t m = 0; m < (n + 1) * (n + 1) * (n + 1); m++) {
        const size_t at[3] = {m % (n + 1), m / (n + 1) % (n + 1), m / (n + 1) / (n + 1)};
        double p[3];
        bool inner = true;
        for (int a = 0; a < 3; a++)
            inner = inner && at[a] > 0 && at[a] < n;
        for (int a = 0; a < 3; a++)
            p[a] = 2 * ((double)at[a] + (inner ? random_offset(jitter) : 0)) / (double)n - 1;
        test_grid_sample(g, p[0], p[1], p[2]);
    }
}

void test_grid_make(test_grid *g, test_cut cut, size_t n, double jitter)
{
    memset(g, 0, sizeof *g);
    make_points(g, n, jitter);
    for (size_t m = 0; m < n * n * n; m++) {
        const size_t i = m % n, j = m / n % n, k = m / n / n;
        uint32_t box[8];
        for (size_t c = 0; c < 8; c++)
            box[c] = (uint32_t)(((k + (c >> 2)) * (n + 1) + j + (c >> 1 & 1)) * (n + 1) + i +
                                (c & 1));
        cut_box(g, cut, box, i, n);
    }
}

void test_grid_fill(test_grid *g, double (*field)(const double p[3]))
{
    for (size_t n = 0; n < g->samples; n++)
        g->values[n] = field(g->points + 3 * n);
}
