/* Distances from surfaces that are known on paper. */
#include "support/surface.h"

#include "core/base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef double distance_of(const double p[3]);

/* Distances that the call should find, by closed form, densely. */
typedef struct truth {
    double max, rms, mean;
} truth;

static double to_sphere(const double p[3])
{
    return fabs(hypot(hypot(p[0], p[1]), p[2]) - 30);
}

static double to_torus(const double p[3])
{
    return fabs(hypot(hypot(p[0], p[1]) - 26, p[2]) - 10);
}

/* By Newton's method on the formula, with differences for its gradient. */
static double to_gyroid(const double p[3])
{
    const double h = 1e-5;
    double x[3] = {p[0], p[1], p[2]};
    for (int n = 0; n < 6; n++) {
        double g[3], rest = cw_field_value(CW_FIELD_GYROID, x);
        for (int k = 0; k < 3; k++) {
            double up[3] = {x[0], x[1], x[2]}, down[3] = {x[0], x[1], x[2]};
            up[k] += h;
            down[k] -= h;
            g[k] =
                (cw_field_value(CW_FIELD_GYROID, up) - cw_field_value(CW_FIELD_GYROID, down)) /
                (2 * h);
        }
        for (int k = 0; k < 3; k++)
            rest += g[k] * (p[k] - x[k]);
        for (int k = 0; k < 3; k++)
            x[k] = p[k] - rest * g[k] / (g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    }
    return hypot(hypot(x[0] - p[0], x[1] - p[1]), x[2] - p[2]);
}

static double triangle_area(const double p[3][3])
{
    double n[3];
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] = (p[1][i] - p[0][i]) * (p[2][j] - p[0][j]) -
               (p[1][j] - p[0][j]) * (p[2][i] - p[0][i]);
    }
    return hypot(hypot(n[0], n[1]), n[2]) / 2;
}

static double measure_between(const double p[3][3], double a, double b, distance_of *distance)
{
    double x[3];
    for (int k = 0; k < 3; k++)
        x[k] = a * p[0][k] + b * p[1][k] + (1 - a - b) * p[2][k];
    return distance(x);
}

/* Means over the middles of small triangles, the largest over their corners too. */
static truth measure_slowly(const cw_mesh *mesh, distance_of *distance)
{
    enum { PARTS = 4 };
    truth all = {0};
    double area = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double p[3][3];
        for (size_t c = 0; c < 3; c++)
            for (size_t k = 0; k < 3; k++)
                p[c][k] = mesh->origin[k] +
                          (double)mesh->positions[3 * (size_t)mesh->triangles[3 * t + c] + k];
        const double(*q)[3] = (const double(*)[3])p;
        const double part = triangle_area(q) / PARTS / PARTS;
        for (int i = 0; i <= PARTS; i++)
            for (int j = 0; i + j <= PARTS; j++) {
                const double corner =
                    measure_between(q, (double)i / PARTS, (double)j / PARTS, distance);
                all.max = fmax(all.max, corner);
                for (int down = 0; down < (i + j < PARTS) + (i + j + 1 < PARTS); down++) {
                    for (int n = 0; n < 3; n++) { /* exact for squares */
                        const double u = down ? 5 / 6.0 : 1 / 6.0, w = down ? -0.5 : 0.5;
                        const double d =
                            measure_between(q, (i + u + (n == 1 ? w : 0)) / PARTS,
                                            (j + u + (n == 2 ? w : 0)) / PARTS, distance);
                        all.max = fmax(all.max, d);
                        all.mean += part / 3 * d;
                        all.rms += part / 3 * d * d;
                    }
                    area += part;
                }
            }
    }
    all.mean /= area;
    all.rms = sqrt(all.rms / area);
    return all;
}

/* A coarse mesh against a fine volume: the volume's own error is small beside the mesh's. */
static void coarse_meshes_are_as_far_as_formulas_say(void **state)
{
    (void)state;
    static const struct {
        cw_field field;
        size_t mesh, volume;
        distance_of *distance;
    } cases[] = {{CW_FIELD_SPHERE, 8, 128, to_sphere},
                 {CW_FIELD_TORUS, 12, 128, to_torus},
                 {CW_FIELD_GYROID, 14, 128, to_gyroid}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n += test_is_short() ? 2 : 1) {
        const size_t fine = cases[n].volume;
        cw_volume coarse = test_sample(cases[n].field, cases[n].mesh, CW_F32), inner,
                  volume = test_sample(cases[n].field, fine, CW_F32);
        const size_t edge = cases[n].mesh - 2; /* what is nearest should be in the volume */
        cw_error err = {0};
        const cw_box box = {{1, 1, 1}, {edge, edge, edge}};
        assert_ok(cw_volume_crop(&coarse, &box, &inner, &err), err);
        cw_mesh mesh = test_extract(&inner, &(cw_extract_desc){.leave_open = true}, NULL);
        const truth t = measure_slowly(&mesh, cases[n].distance);
        cw_distance d;
        const cw_field_distance_desc desc = {.leave_open = true, .step_voxels = 3};
        assert_ok(cw_distance_to_field(&mesh, &volume, &desc, &d, NULL, &err), err);
        assert_within(d.max_mm, t.max, 0.01);
        assert_within(d.rms_mm, t.rms, 0.01);
        assert_within(d.mean_mm, t.mean, 0.01);
        assert_near(cases[n].field == CW_FIELD_GYROID ? d.max_mm : cases[n].distance(d.where),
                    d.max_mm, 0.01 * d.max_mm);
        assert_int_equal(d.missed, 0);
        cw_mesh_free(&mesh);
        cw_volume_free(&volume);
        cw_volume_free(&coarse);
    }
}

/* A plane's field is linear, so is its interpolant: levels are exactly so far apart. */
static void a_shifted_plane_is_off_by_its_shift_everywhere(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_PLANE, 20, CW_F64);
    cw_mesh mesh = test_extract(&v, &(cw_extract_desc){.leave_open = true}, NULL);
    float *found = calloc(mesh.vertex_count, sizeof *found);
    assert_non_null(found);
    for (int side = -1; side <= 1; side += 2) {
        cw_distance d;
        cw_error err = {0};
        const cw_field_distance_desc desc = {.isovalue = 0.1 * side, .leave_open = true};
        assert_ok(cw_distance_to_field(&mesh, &v, &desc, &d, found, &err), err);
        assert_near(d.mean_mm, 0.1, 1e-3); /* beside the border's edge farther than that */
        assert_near(d.p99_mm, 0.1, 5e-3);
        assert_near(d.bias_mm, 0.1 * side, 4e-3); /* beyond the data all is outside */
        size_t exact = 0;
        for (size_t n = 0; n < mesh.vertex_count; n++) { /* some stand beside samples */
            double p[3];
            for (size_t k = 0; k < 3; k++)
                p[k] = mesh.origin[k] + (double)mesh.positions[3 * n + k];
            const double shift = 0.1 * side - cw_field_value(CW_FIELD_PLANE, p);
            exact += fabs((double)found[n] - shift) < 1e-4;
        }
        assert_in_range(exact, mesh.vertex_count * 7 / 10, mesh.vertex_count);
    }
    free(found);
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

static void a_grown_sphere_is_outside_by_what_it_grew(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_SPHERE, 64, CW_F32);
    cw_mesh mesh = test_extract(&v, NULL, NULL);
    cw_distance d, plain;
    cw_error err = {0};
    assert_ok(cw_distance_to_field(&mesh, &v, NULL, &plain, NULL, &err), err);
    assert_true(plain.max_mm < 0.01 && plain.mean_mm > 1e-4);
    for (size_t n = 0; n < 3 * mesh.vertex_count; n++)
        mesh.positions[n] += 0.1f * mesh.normals[n];
    assert_ok(cw_distance_to_field(&mesh, &v, NULL, &d, NULL, &err), err);
    assert_near(d.max_mm, 0.1, 1e-3);
    assert_near(d.bias_mm - plain.bias_mm, 0.1, 1e-3);
    assert_near(d.rms_mm, d.mean_mm, 1e-4);
    for (size_t n = 0; n < 3 * mesh.vertex_count; n++)
        mesh.positions[n] -= 0.2f * mesh.normals[n];
    assert_ok(cw_distance_to_field(&mesh, &v, NULL, &d, NULL, &err), err);
    assert_near(d.bias_mm - plain.bias_mm, -0.1, 1e-3);
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

/* The same values in another type, scaled, falling, from strides, in a far frame. */
static void the_form_of_the_volume_does_not_matter(void **state)
{
    (void)state;
    cw_volume u8 = test_sample(CW_FIELD_GYROID, 24, CW_U8), f64, view;
    cw_error err = {0};
    cw_distance one, two;
    const size_t dim[3] = {48, 24, 24};
    assert_ok(cw_volume_alloc(&f64, CW_F64, dim, 0, 0, &err), err);
    double *x = cw_volume_voxels(&f64);
    for (size_t n = 0; n < 24 * 24 * 48; n++)
        x[n] = 5 - 2 * (double)((const uint8_t *)u8.data)[n / 48 * 24 + n % 48 / 2];
    f64.affine[0][0] = u8.affine[0][0] / 2;
    f64.affine[1][1] = u8.affine[1][1];
    f64.affine[2][2] = u8.affine[2][2];
    for (int r = 0; r < 3; r++)
        f64.affine[r][3] = u8.affine[r][3];
    const size_t step[3] = {2, 1, 1};
    assert_ok(cw_volume_coarsen(&f64, step, &view, &err), err);
    u8.slope = -2;
    u8.intercept = 5;
    cw_mesh mesh =
        test_extract(&u8, &(cw_extract_desc){.isovalue = -250, .inside_is_low = true}, NULL);
    const cw_field_distance_desc desc = {.isovalue = -249, .inside_is_low = true};
    assert_ok(cw_distance_to_field(&mesh, &u8, &desc, &one, NULL, &err), err);
    assert_ok(cw_distance_to_field(&mesh, &view, &desc, &two, NULL, &err), err);
    assert_near(one.max_mm, two.max_mm, 1e-9);
    assert_near(one.rms_mm, two.rms_mm, 1e-9);
    assert_near(one.bias_mm, two.bias_mm, 1e-9);
    assert_true(one.mean_mm > 1e-3);
    cw_mesh_free(&mesh);
    cw_volume_free(&f64);
    cw_volume_free(&u8);
}

/* All inside but a corner: caps stand 1/1024 of a voxel beyond the box of the samples. */
static void caps_lie_on_the_end_of_the_data(void **state)
{
    (void)state;
    const size_t dim[3] = {6, 5, 4};
    cw_volume v;
    cw_error err = {0};
    cw_distance d;
    assert_ok(cw_volume_alloc(&v, CW_F32, dim, 0, 0, &err), err);
    float *x = cw_volume_voxels(&v);
    for (int gaps = 0; gaps < 2; gaps++) {
        for (int n = 0; n < 6 * 5 * 4; n++)
            x[n] = n == 0 ? -7 : gaps && n % 6 > 3 ? (float)NAN : 7;
        cw_mesh mesh = test_extract(&v, NULL, NULL);
        assert_ok(cw_distance_to_field(&mesh, &v, NULL, &d, NULL, &err), err);
        assert_true(d.p99_mm < 2e-3 && d.max_mm < 0.1 && d.missed == 0 && d.bias_mm > 5e-4);
        x[0] = 7;
        const cw_field_distance_desc open = {.leave_open = true};
        assert_ok(cw_distance_to_field(&mesh, &v, &open, &d, NULL, &err), err);
        assert_int_equal(d.missed, d.samples);
        assert_near(d.mean_mm, 4, 1e-6); /* what is out of reach counts as reach */
        cw_mesh_free(&mesh);
    }
    cw_volume_free(&v);
}

static void threads_do_not_change_a_byte(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_GYROID, 24, CW_F32);
    cw_mesh mesh = test_extract(&v, NULL, NULL);
    float *found[2] = {calloc(mesh.vertex_count, 4), calloc(mesh.vertex_count, 4)};
    cw_distance d[2];
    cw_error err = {0};
    assert_true(found[0] && found[1]);
    for (int n = 0; n < 2; n++) {
        const cw_field_distance_desc desc = {.isovalue = 0.1, .threads = n ? 7 : 1};
        assert_ok(cw_distance_to_field(&mesh, &v, &desc, d + n, found[n], &err), err);
    }
    assert_memory_equal(d, d + 1, sizeof *d);
    assert_memory_equal(found[0], found[1], 4 * mesh.vertex_count);
    free(found[0]);
    free(found[1]);
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

static void what_cannot_be_measured_is_refused_by_name(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_SPHERE, 8, CW_F32), thin = v;
    cw_mesh cube;
    cw_distance d;
    cw_error err = {0};
    test_make_cube(&cube);
    thin.dim[1] = 1;
    assert_fails(cw_distance_to_field(&cube, &thin, NULL, &d, NULL, &err), CW_ERR_ARGUMENT,
                 "one voxel along axis 1", err);
    assert_fails(cw_distance_to_field(&cube, &v, &(cw_field_distance_desc){.isovalue = NAN}, &d,
                                      NULL, &err),
                 CW_ERR_ARGUMENT, "isovalue", err);
    assert_fails(cw_distance_to_field(&cube, &v, &(cw_field_distance_desc){.reach_mm = -1}, &d,
                                      NULL, &err),
                 CW_ERR_ARGUMENT, "reach_mm is -1", err);
    assert_fails(cw_distance_to_field(&cube, &v,
                                      &(cw_field_distance_desc){.step_voxels = INFINITY}, &d,
                                      NULL, &err),
                 CW_ERR_ARGUMENT, "step_voxels", err);
    int polls = 1;
    const cw_field_distance_desc stop = {.threads = 1, .progress = {test_stop_after, &polls}};
    assert_fails(cw_distance_to_field(&cube, &v, &stop, &d, NULL, &err), CW_ERR_CANCELLED, "",
                 err);
    assert_true(d.max_mm == 0 && d.samples == 0);
    for (long n = 0;; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st = cw_distance_to_field(&cube, &v, NULL, &d, NULL, &err);
        if (!cwi_alloc_fail_after(-1)) {
            assert_int_equal(st, CW_OK);
            break;
        }
        assert_int_equal(st, CW_ERR_NO_MEMORY);
    }
    cw_mesh_free(&cube);
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(coarse_meshes_are_as_far_as_formulas_say),
        cmocka_unit_test(a_shifted_plane_is_off_by_its_shift_everywhere),
        cmocka_unit_test(a_grown_sphere_is_outside_by_what_it_grew),
        cmocka_unit_test(the_form_of_the_volume_does_not_matter),
        cmocka_unit_test(caps_lie_on_the_end_of_the_data),
        cmocka_unit_test(threads_do_not_change_a_byte),
        cmocka_unit_test(what_cannot_be_measured_is_refused_by_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
