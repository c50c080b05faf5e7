/* Nearest triangles of wide fans: the tree of parts finds what a search of all triangles does. */
#include "support/support.h"

#include "core/geometry/point_triangle.h"
#include "core/mesh/triangle_boxes.h"

#include <math.h>
#include <stdlib.h>

enum { QUERIES = 300 };

typedef struct fan {
    float *points;
    uint32_t *corners;
    size_t count;
    cwi_boxes tree;
    double at[3];
} fan;

static double distance_sq_to(const fan *f, size_t triangle)
{
    const uint32_t *v = f->corners + 3 * triangle;
    return cwi_facet_distance_sq(f->points + 3 * (size_t)v[0], f->points + 3 * (size_t)v[1],
                                 f->points + 3 * (size_t)v[2], f->at);
}

static void measure(void *context, size_t slot, double *distance_sq)
{
    const fan *f = context;
    *distance_sq = fmin(*distance_sq, distance_sq_to(f, f->tree.order[slot]));
}

static float between(double low, double high)
{
    return (float)(low + (high - low) * rand() / RAND_MAX);
}

/* Makes n triangles between a rim and its middle, with the corners of each in another order; some
 * are as wide as long. */
static void make_fan(fan *f, uint32_t n, double high, double offset)
{
    f->count = n;
    f->points = calloc(3 * ((size_t)n + 1), sizeof *f->points);
    f->corners = calloc(3 * (size_t)n, sizeof *f->corners);
    for (uint32_t i = 0; i < n; i++) {
        const double angle = i % 7 ? 6.2831853 * i / n : between(0, 6), radius = between(3, 10);
        f->points[3 * i] = (float)(offset + radius * cos(angle));
        f->points[3 * i + 1] = (float)(radius * sin(angle));
        f->points[3 * i + 2] = between(0, 0.1);
        f->corners[3 * i + i % 3] = i;
        f->corners[3 * i + (i + 1) % 3] = (i + 1) % n;
        f->corners[3 * i + (i + 2) % 3] = n;
    }
    f->points[3 * (size_t)n] = (float)offset;
    f->points[3 * (size_t)n + 2] = (float)high;
}

static void check_fan(uint32_t n, double high, double offset, bool is_cut)
{
    fan f;
    cw_error err = {0};
    make_fan(&f, n, high, offset);
    assert_ok(cwi_triangle_boxes_build(&f.tree, f.points, n + 1, f.corners, n, &err), err);
    assert_true(is_cut ? f.tree.count > n : f.tree.count == n);
    for (int q = 0; q < QUERIES; q++) {
        double nearest_sq = INFINITY, found_sq = INFINITY;
        f.at[0] = offset + (double)between(-12, 12);
        f.at[1] = (double)between(-12, 12);
        f.at[2] = (double)between(-1, high + 1);
        for (size_t t = 0; t < n; t++)
            nearest_sq = fmin(nearest_sq, distance_sq_to(&f, t));
        cwi_boxes_nearest(&f.tree, f.at, measure, &f, &found_sq);
        assert_true(found_sq == nearest_sq);
    }
    cwi_boxes_free(&f.tree);
    free(f.points);
    free(f.corners);
}

static void parts_find_the_nearest_triangle(void **state)
{
    (void)state;
    test_seed(7);
    check_fan(400, 5, 0, false);
    check_fan(600, 5, 0, true);
    check_fan(2000, 0, 100, true);
    check_fan(5000, 30, -7, true);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(parts_find_the_nearest_triangle)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
