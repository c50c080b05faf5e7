/* Distances of meshes from the exact surface of an analytic field. */
#include "support/surface.h"

#include "core/base/memory.h"

#include <math.h>
#include <string.h>

static cw_mesh make_mesh(cw_field field, size_t n)
{
    cw_volume v = test_sample(field, n, CW_F32);
    const cw_extract_desc desc = {.isovalue = cw_field_isovalue(field),
                                  .leave_open = true}; /* caps are not on the surface */
    const cw_mesh mesh = test_extract(&v, &desc, NULL);
    cw_volume_free(&v);
    return mesh;
}

/* Vertices on a sphere of another radius are that much off, all of them. */
static void a_larger_sphere_is_off_by_the_difference(void **state)
{
    (void)state;
    for (double off = -0.8; off < 0.9; off += 0.4) {
        cw_mesh m = make_mesh(CW_FIELD_SPHERE, 33);
        cw_field_vertex_error e;
        cw_error err = {0};
        for (size_t v = 0; v < m.vertex_count; v++) {
            double p[3], length = 0;
            for (size_t a = 0; a < 3; a++) {
                p[a] = m.origin[a] + (double)m.positions[3 * v + a];
                length += p[a] * p[a];
            }
            for (size_t a = 0; a < 3; a++) {
                m.positions[3 * v + a] =
                    (float)(p[a] * (30 + off) / sqrt(length) - m.origin[a]);
                m.normals[3 * v + a] = (float)(p[a] / sqrt(length));
            }
        }
        assert_ok(cw_field_measure_vertices(CW_FIELD_SPHERE, 0, 2.5, &m, 1, &e, &err), err);
        assert_int_equal(e.count, m.vertex_count);
        assert_int_equal(e.missed, 0);
        assert_near(e.mean_mm, fabs(off), 1e-5);
        assert_near(e.max_mm, fabs(off), 1e-5);
        assert_true(e.has_normals && e.max_deg < 0.01);
        cw_mesh_free(&m);
    }
}

static void errors_fall_with_the_square_of_the_voxels(void **state)
{
    (void)state;
    static const cw_field fields[] = {CW_FIELD_SPHERE, CW_FIELD_TORUS, CW_FIELD_GYROID};
    for (size_t f = 0; f < 3; f++) {
        cw_field_error e[2];
        for (size_t n = 0; n < 2; n++) {
            cw_mesh m = make_mesh(fields[f], n ? 65 : 33);
            cw_error err = {0};
            assert_ok(cw_field_measure(fields[f], 0, n ? 1.25 : 2.5, &m, &e[n], &err), err);
            assert_int_equal(e[n].samples, 4 * m.triangle_count);
            assert_int_equal(e[n].missed, 0);
            assert_true(0 < e[n].rms_mm && e[n].rms_mm < e[n].p99_mm);
            assert_true(e[n].p99_mm <= e[n].max_mm);
            cw_mesh_free(&m);
        }
        const double order = log2(e[0].rms_mm / e[1].rms_mm);
        if (!(order > 1.8 && order < 2.3))
            fail_msg("%s: order %g", cw_field_name(fields[f]), order);
    }
}

/* A mean by area, not by triangle: one large triangle that is off outweighs a far tiny one. */
static void errors_are_weighted_by_area(void **state)
{
    (void)state;
    float positions[] = {30, -9, 0, 30, 9, 0, 30, 0, 9, 33, 0, 0, 33, 1e-3f, 0, 33, 0, 1e-3f};
    uint32_t triangles[] = {0, 1, 2, 3, 4, 5};
    const cw_mesh m = {
        .vertex_count = 6, .triangle_count = 2, .positions = positions, .triangles = triangles};
    cw_field_error e;
    cw_error err = {0};
    assert_ok(cw_field_measure(CW_FIELD_SPHERE, 0, 10, &m, &e, &err), err);
    assert_near(e.max_mm, 3, 1e-4);
    assert_true(e.p99_mm < 1.4 && e.rms_mm < 1.4);
    const double side = sqrt(30 * 30 + 81) - 30, top = side, middle = sqrt(30 * 30 + 9) - 30;
    const double square = (2 * side * side + top * top) / 12 + 0.75 * middle * middle;
    assert_near(e.rms_mm, sqrt(square), 1e-4);
}

static void every_nth_vertex_is_measured(void **state)
{
    (void)state;
    cw_mesh m = make_mesh(CW_FIELD_TORUS, 17);
    cw_field_vertex_error e;
    cw_error err = {0};
    assert_ok(cw_field_measure_vertices(CW_FIELD_TORUS, 0, 5, &m, 7, &e, &err), err);
    assert_int_equal(e.count + e.missed, (m.vertex_count + 6) / 7);
    cw_mesh_free(&m);
}

static void what_cannot_be_measured_is_refused(void **state)
{
    (void)state;
    cw_mesh m = make_mesh(CW_FIELD_SPHERE, 9);
    cw_field_error e;
    cw_field_vertex_error at;
    cw_error err = {0};
    assert_fails(cw_field_measure(CW_FIELD_COUNT, 0, 1, &m, &e, &err), CW_ERR_ARGUMENT,
                 "not a field", err);
    assert_fails(cw_field_measure(CW_FIELD_SPHERE, NAN, 1, &m, &e, &err), CW_ERR_ARGUMENT,
                 "isovalue", err);
    assert_fails(cw_field_measure(CW_FIELD_SPHERE, 0, 0, &m, &e, &err), CW_ERR_ARGUMENT,
                 "voxel_mm is 0", err);
    assert_fails(cw_field_measure_vertices(CW_FIELD_SPHERE, 0, 1, &m, 0, &at, &err),
                 CW_ERR_ARGUMENT, "every", err);
    cwi_alloc_fail_after(0);
    const cw_status st = cw_field_measure(CW_FIELD_SPHERE, 0, 1, &m, &e, &err);
    cwi_alloc_fail_after(-1);
    assert_int_equal(st, CW_ERR_NO_MEMORY);
    const cw_mesh none = {0};
    assert_ok(cw_field_measure(CW_FIELD_SPHERE, 0, 1, &none, &e, &err), err);
    assert_true(e.samples == 0 && e.max_mm == 0);
    /* the middle of the sphere has no gradient: nothing is reached from there */
    float far[] = {0, 0, 0};
    const cw_mesh middle = {.vertex_count = 1, .positions = far};
    assert_ok(cw_field_measure_vertices(CW_FIELD_SPHERE, 0, 1, &middle, 1, &at, &err), err);
    assert_int_equal(at.missed, 1);
    cw_mesh_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_larger_sphere_is_off_by_the_difference),
        cmocka_unit_test(errors_fall_with_the_square_of_the_voxels),
        cmocka_unit_test(errors_are_weighted_by_area),
        cmocka_unit_test(every_nth_vertex_is_measured),
        cmocka_unit_test(what_cannot_be_measured_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
