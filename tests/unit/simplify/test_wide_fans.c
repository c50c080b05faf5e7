/* Vertices with thousands of triangles: simplified to few triangles, within the error. */
#include "support/surface.h"

#include "core/mesh/mesh.h"

#include <math.h>

static const double TAU = 6.28318530717958647692;

/* Makes a closed solid of two fans of n triangles each around a rim, with tips at both heights.
 * Every second vertex of the rim is farther out by `wave`. */
static cw_mesh make_fans(uint32_t n, double wave, double high, double low)
{
    cw_mesh mesh = {0};
    cw_error err = {0};
    assert_ok(cwi_mesh_alloc(&mesh, n + 2, 2 * (size_t)n, false, &err), err);
    for (uint32_t i = 0; i < n; i++) {
        const double radius = 10 + wave * (i % 2), angle = TAU * i / n;
        float *p = mesh.positions + 3 * (size_t)i;
        uint32_t *t = mesh.triangles + 6 * (size_t)i;
        p[0] = (float)(radius * cos(angle));
        p[1] = (float)(radius * sin(angle));
        p[2] = 0;
        t[0] = t[4] = i;
        t[1] = t[3] = (i + 1) % n;
        t[2] = n;
        t[5] = n + 1;
    }
    for (uint32_t tip = 0; tip < 2; tip++) {
        float *p = mesh.positions + 3 * (size_t)(n + tip);
        p[0] = p[1] = 0;
        p[2] = (float)(tip ? low : high);
    }
    return mesh;
}

static void check_fans(uint32_t n, double wave, double high, double low, size_t max_triangles)
{
    const cw_simplify_desc desc = {.error_mm = 0.1};
    cw_mesh mesh = make_fans(n, wave, high, low), out = {0};
    cw_error err = {0};
    assert_ok(cw_simplify(&mesh, &desc, &out, NULL, &err), err);
    assert_true(out.triangle_count <= max_triangles);
    test_assert_sound(&mesh, &out);
    test_bound_is_measured(&out, &mesh, desc.error_mm);
    test_bound_is_measured(&mesh, &out, desc.error_mm);
    cw_mesh_free(&mesh);
    cw_mesh_free(&out);
}

/* 24 sides of a cone are within 0.1 mm of a circle of 10 mm. */
static void a_wide_fan_becomes_narrow(void **state)
{
    (void)state;
    check_fans(1500, 0, 20, 0, 100);
    check_fans(2500, 0, 5, -5, 100);
    check_fans(3000, 0.02, 12, 2, 100);
}

/* Waves of the rim deeper than the error stay. */
static void a_waved_rim_stays_wide(void **state)
{
    (void)state;
    check_fans(600, 1, 20, 0, 1200);
    check_fans(1000, 1, 20, -3, 2000);
    check_fans(1400, 0.5, 5, 0, 2800);
}

/* Needles may stay as thin as they are, and get wider. */
static void needles_are_collapsed_to_wider_ones(void **state)
{
    (void)state;
    check_fans(800, 0, 4e3, 0, 100);
    check_fans(900, 0, 2e3, -3e3, 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_wide_fan_becomes_narrow),
        cmocka_unit_test(a_waved_rim_stays_wide),
        cmocka_unit_test(needles_are_collapsed_to_wider_ones),
    };
    if (!cw_simplify_available())
        return 0;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
