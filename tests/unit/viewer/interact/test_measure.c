/* Tests lengths, angles and areas of picked points against what is known on paper. */
#include "support/support.h"

#include "viewer/interact/measure.h"

#include <math.h>
#include <string.h>

enum { CORNERS = 12 };

/* Rotates about (1, 2, 3) by 40 degrees and moves far away: nothing measured may change. */
static void move_point(const double in[3], double out[3])
{
    const double length = sqrt(14), u[3] = {1 / length, 2 / length, 3 / length};
    const double c = cos(40 * PI / 180), s = sin(40 * PI / 180);
    const double along = u[0] * in[0] + u[1] * in[1] + u[2] * in[2];
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, d = (a + 2) % 3;
        out[a] = c * in[a] + s * (u[b] * in[d] - u[d] * in[b]) + (1 - c) * along * u[a] + 5000;
    }
}

static void lengths_and_angles_are_those_of_triangles(void **state)
{
    (void)state;
    static const double points[4][3] = {{1, 2, 3}, {4, 6, 3}, {1, 2, 15}, {-2, -2, 3}};
    assert_near(cwi_measure_distance(points[0], points[1]), 5, 1e-12);
    assert_near(cwi_measure_distance(points[1], points[2]), 13, 1e-12);
    assert_near(cwi_measure_angle(points[1], points[0], points[2]), 90, 1e-12);
    assert_near(cwi_measure_angle(points[1], points[0], points[3]), 180, 1e-12);
    assert_near(cwi_measure_angle(points[1], points[0], points[1]), 0, 1e-12);
    assert_near(cwi_measure_angle(points[0], points[2], points[1]), atan2(5, 12) * 180 / PI,
                1e-12);
    assert_true(isnan(cwi_measure_angle(points[0], points[0], points[1])));
    /* an angle of a ten-thousandth of a degree has its digits */
    const double tiny[3] = {1, 1e-4 * PI / 180, 0}, zero[3] = {0}, one[3] = {1, 0, 0};
    assert_near(cwi_measure_angle(one, zero, tiny), 1e-4, 1e-12);
}

/* A regular polygon of n corners and radius r has the area n r^2 sin(2 pi / n) / 2. */
static void areas_are_those_of_polygons_anywhere(void **state)
{
    (void)state;
    double flat[CORNERS][3], moved[CORNERS][3];
    for (size_t n = 0; n < CORNERS; n++) {
        const double turn = 2 * PI * (double)n / CORNERS;
        flat[n][0] = 10 * cos(turn);
        flat[n][1] = 10 * sin(turn);
        flat[n][2] = 4;
        move_point(flat[n], moved[n]);
    }
    const double expected = CORNERS * 100 * sin(2 * PI / CORNERS) / 2;
    const double(*const all[2])[3] = {(const double(*)[3])flat, (const double(*)[3])moved};
    for (int n = 0; n < 2; n++) {
        assert_near(cwi_measure_area(all[n], CORNERS), expected, 1e-9);
        assert_near(cwi_measure_bend(all[n], CORNERS), 0, 1e-9);
        assert_false(cwi_measure_crosses(all[n], CORNERS));
    }
    /* an L is not convex: 3 x 3 less 2 x 2 */
    static const double ell[6][3] = {{0, 0, 0}, {3, 0, 0}, {3, 1, 0},
                                     {1, 1, 0}, {1, 3, 0}, {0, 3, 0}};
    assert_near(cwi_measure_area(ell, 6), 5, 1e-12);
    assert_false(cwi_measure_crosses(ell, 6));
    assert_near(cwi_measure_area(ell, 3), 1.5, 1e-12);
}

static void polygons_that_are_not_flat_or_cross_are_found(void **state)
{
    (void)state;
    /* a square of side 2 whose corners lie 0.25 above and below its plane in turn */
    static const double bent[4][3] = {{0, 0, 0.25}, {2, 0, -0.25}, {2, 2, 0.25}, {0, 2, -0.25}};
    assert_near(cwi_measure_area(bent, 4), 4, 1e-12);
    assert_near(cwi_measure_bend(bent, 4), 0.25, 1e-12);
    assert_false(cwi_measure_crosses(bent, 4));
    /* the same corners as a bow tie: both halves count against each other */
    static const double bow[4][3] = {{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2, 0}};
    assert_near(cwi_measure_area(bow, 4), 0, 1e-12);
    assert_true(cwi_measure_crosses(bow, 4));
    static const double line[4][3] = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}};
    assert_near(cwi_measure_area(line, 4), 0, 1e-12);
    assert_near(cwi_measure_bend(line, 4), 0, 1e-12);
    assert_false(cwi_measure_crosses(line, 4));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lengths_and_angles_are_those_of_triangles),
        cmocka_unit_test(areas_are_those_of_polygons_anywhere),
        cmocka_unit_test(polygons_that_are_not_flat_or_cross_are_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
