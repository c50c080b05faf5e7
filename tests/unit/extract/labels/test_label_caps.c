/* Tests the surfaces that close labels at the volume's border: flat, with straight edges and sharp
 * corners, and in one plane with those of the crop beside. */
#include "support/support.h"

#include <cubewright/field.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 24 };

/* How far vertices may be from the border's planes, in voxels. */
static const double TOLERANCE = 1e-6;

/* Fills a map with two labels on the sides of a gyroid, with one label, or with noise. */
static void fill_map(uint32_t *to, const size_t dim[3], int kind)
{
    for (size_t n = 0; n < dim[0] * dim[1] * dim[2]; n++) {
        const double x = 0.7 * (double)(n % dim[0]), y = 0.7 * (double)(n / dim[0] % dim[1]),
                     z = 0.7 * (double)(n / dim[0] / dim[1]);
        const double gyroid = sin(x) * cos(y) + sin(y) * cos(z) + sin(z) * cos(x);
        to[n] = kind == 0 ? 1 + (gyroid > 0.2) : kind == 1 ? 7 : (uint32_t)rand() % 4;
    }
}

/* Makes a map of cells that reach the volume's border: the middle of a larger one. */
static void cut_cells(uint32_t *to, const size_t dim[3])
{
    enum { WHOLE = 56, FROM = 12 };
    cw_volume cells;
    cw_error err = {0};
    const cw_label_field_desc desc = {
        .field = CW_LABEL_CELLS, .dim = {WHOLE, WHOLE, WHOLE}, .type = CW_U32, .labels = 120};
    assert_ok(cw_label_field_sample(&desc, &cells, &err), err);
    const uint32_t *from = cells.data;
    for (size_t n = 0; n < dim[0] * dim[1] * dim[2]; n++) {
        const size_t x = n % dim[0], y = n / dim[0] % dim[1], z = n / dim[0] / dim[1];
        to[n] = from[((z + FROM) * WHOLE + y + FROM) * WHOLE + x + FROM];
    }
    cw_volume_free(&cells);
}

/* Checks vertices of a map whose first voxel is at the world's zero, with 1 mm a voxel: those in the
 * layers of the border are in its planes. Counts those in one plane, two and three. */
static void check_planes(const cw_label_surfaces *s, const size_t dim[3], size_t counts[4])
{
    memset(counts, 0, 4 * sizeof *counts);
    for (size_t v = 0; v < s->mesh.vertex_count; v++) {
        int planes = 0;
        for (int a = 0; a < 3; a++) {
            const double x = (double)s->mesh.positions[3 * v + (size_t)a] + s->mesh.origin[a],
                         high = (double)dim[a] - 1;
            const double plane = x < 0 ? -0.5 : x > high ? high + 0.5 : x;
            if (fabs(x - plane) > TOLERANCE)
                fail_msg("vertex %zu is at %.9g along axis %d", v, x, a);
            planes += plane != x || x < 0 || x > high;
        }
        counts[planes]++;
    }
}

static void caps_are_flat_with_straight_edges_and_corners(void **state)
{
    (void)state;
    static const size_t dims[][3] = {{SIDE, SIDE, SIDE}, {19, 1, 12}, {9, 30, 2}};
    test_seed(5);
    for (int n = 0; n < 24; n++) {
        const size_t *dim = dims[n % 3];
        const int kind = n / 3 % 4;
        cw_volume v = {0};
        cw_label_surfaces s;
        cw_error err = {0};
        size_t counts[4];
        assert_ok(cw_volume_alloc(&v, CW_U32, dim, 1, 1, &err), err);
        if (kind == 3)
            cut_cells(cw_volume_voxels(&v), dim);
        else
            fill_map(cw_volume_voxels(&v), dim, kind);
        const cw_labels_desc desc = {.no_smoothing = n >= 12, .threads = 1 + n % 2};
        assert_ok(cw_extract_labels(&v, &desc, &s, &err), err);
        check_planes(&s, dim, counts);
        if (kind == 1) {
            assert_int_equal(counts[0], 0);
            assert_int_equal(counts[3], 8);
            assert_int_equal(counts[2], 4 * (dim[0] + dim[1] + dim[2] - 3));
        } else
            assert_true(counts[1] > 0 && counts[2] > 0);
        cw_label_surfaces_free(&s);
        cw_volume_free(&v);
    }
}

/* Sums up the area of the triangles in a plane across the first axis. */
static double measure_cap(const cw_label_surfaces *s, double plane)
{
    double area = 0;
    for (size_t t = 0; t < s->mesh.triangle_count; t++) {
        double p[3][3];
        bool is_in = true;
        for (int c = 0; c < 3; c++)
            for (int a = 0; a < 3; a++) {
                const size_t v = s->mesh.triangles[3 * t + (size_t)c];
                p[c][a] = (double)s->mesh.positions[3 * v + (size_t)a] + s->mesh.origin[a];
                is_in = is_in && (a > 0 || fabs(p[c][0] - plane) < TOLERANCE);
            }
        area += is_in ? 0.5 * fabs((p[1][1] - p[0][1]) * (p[2][2] - p[0][2]) -
                                   (p[1][2] - p[0][2]) * (p[2][1] - p[0][1]))
                      : 0;
    }
    return area;
}

/* Two crops without background share the whole of a side: both close it in the same plane. */
static void crops_of_one_map_meet_in_a_plane(void **state)
{
    (void)state;
    test_seed(6);
    for (int kind = 0; kind < 3; kind++) {
        const size_t dim[3] = {SIDE, SIDE, SIDE}, half[3] = {SIDE / 2, SIDE, SIDE};
        cw_volume whole = {0};
        cw_error err = {0};
        assert_ok(cw_volume_alloc(&whole, CW_U32, dim, 1, 1, &err), err);
        uint32_t *from = cw_volume_voxels(&whole);
        fill_map(from, dim, kind);
        for (size_t n = 0; n < (size_t)SIDE * SIDE * SIDE; n++)
            from[n]++; /* no background */
        for (int side = 0; side < 2; side++) {
            cw_volume crop = {0};
            cw_label_surfaces s;
            assert_ok(cw_volume_alloc(&crop, CW_U32, half, 1, 1, &err), err);
            uint32_t *to = cw_volume_voxels(&crop);
            const size_t first = side ? half[0] : 0;
            for (size_t row = 0; row < (size_t)SIDE * SIDE; row++)
                memcpy(to + row * half[0], from + row * SIDE + first, half[0] * sizeof *to);
            crop.affine[0][3] = (double)first;
            assert_ok(cw_extract_labels(&crop, NULL, &s, &err), err);
            assert_near(measure_cap(&s, (double)half[0] - 0.5), SIDE * SIDE, 1e-3);
            cw_label_surfaces_free(&s);
            cw_volume_free(&crop);
        }
        cw_volume_free(&whole);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(caps_are_flat_with_straight_edges_and_corners),
        cmocka_unit_test(crops_of_one_map_meet_in_a_plane)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
