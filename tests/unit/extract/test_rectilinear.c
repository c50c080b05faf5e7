/* Rectilinear grids: samples where their coordinates say, and what is not made for them. */
#include "support/surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAXIMUM = 200 };

static double coordinates[3][MAXIMUM];

/* Steps that differ by up to three times, from -1 to 1; smooth, as grids of finer n
 * refine it. */
static void bend(cw_volume *v)
{
    for (int a = 0; a < 3; a++) {
        for (size_t i = 0; i < v->dim[a]; i++) {
            const double x = 2 * (double)i / (double)(v->dim[a] - 1) - 1;
            coordinates[a][i] = x + (a == 1 ? -0.15 : 0.15) * sin(PI * x);
        }
        v->coordinates[a] = coordinates[a];
    }
}

static cw_volume make_sphere(size_t n, double radius)
{
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, CW_F64, (size_t[3]){n, n + 3, n + 5}, 1, 1, &err), err);
    bend(&v);
    double *x = cw_volume_voxels(&v);
    for (size_t k = 0; k < v.dim[2]; k++)
        for (size_t j = 0; j < v.dim[1]; j++)
            for (size_t i = 0; i < v.dim[0]; i++)
                *x++ = radius * radius - coordinates[0][i] * coordinates[0][i] -
                       coordinates[1][j] * coordinates[1][j] -
                       coordinates[2][k] * coordinates[2][k];
    return v;
}

static void place_in_world(cw_volume *v)
{
    const double affine[3][4] = {{0, 3, 0, 100}, {-3, 0, 0, -50}, {0, 0, 3, 7}};
    memcpy(v->affine, affine, sizeof affine);
}

/* The farthest vertex from a sphere of 0.7, and the normal that is farthest off. */
static void measure(size_t n, double *distance, double *off)
{
    cw_volume v = make_sphere(n, 0.7);
    place_in_world(&v);
    cw_mesh m = test_extract(&v, NULL, NULL);
    test_check_promise(&m, false);
    *distance = *off = 0;
    for (size_t i = 0; i < m.vertex_count; i++) {
        double p[3], length = 0;
        for (size_t a = 0; a < 3; a++) {
            p[a] = m.origin[a] + (double)m.positions[3 * i + a] - v.affine[a][3];
            length += p[a] * p[a];
        }
        length = sqrt(length);
        for (size_t a = 0; a < 3; a++)
            *off = fmax(*off, fabs(p[a] / length - (double)m.normals[3 * i + a]));
        *distance = fmax(*distance, fabs(length - 3 * 0.7));
    }
    cw_mesh_free(&m);
    cw_volume_free(&v);
}

static void vertices_are_of_second_order(void **state)
{
    (void)state;
    double distance[2], off[2];
    measure(30, distance, off);
    measure(60, distance + 1, off + 1);
    assert_true(distance[0] < 0.01);
    assert_true(distance[1] < 0.3 * distance[0]);
    /* parabolas have exact differences, and linear derivatives */
    assert_true(off[0] < 1e-6 && off[1] < 1e-6);
}

/* Even coordinates are an even grid. */
static void even_coordinates_change_nothing(void **state)
{
    (void)state;
    for (int open = 0; open < 2; open++) {
        cw_volume v = make_sphere(24, 1.3), even = v;
        const cw_extract_desc desc = {.leave_open = open};
        for (int a = 0; a < 3; a++)
            for (size_t i = 0; i < v.dim[a]; i++)
                coordinates[a][i] = 4 + 0.5 * (double)i;
        for (int a = 0; a < 3; a++) {
            even.coordinates[a] = NULL;
            even.affine[a][a] = 0.5;
            even.affine[a][3] = 4;
        }
        cw_mesh m = test_extract(&v, &desc, NULL), expected = test_extract(&even, &desc, NULL);
        assert_int_equal(m.triangle_count, expected.triangle_count);
        assert_memory_equal(m.triangles, expected.triangles, 12 * m.triangle_count);
        for (size_t i = 0; i < 3 * m.vertex_count; i++)
            assert_near(m.origin[i % 3] + (double)m.positions[i],
                        expected.origin[i % 3] + (double)expected.positions[i], 1e-5);
        if (open) /* caps have normals of triangles */
            for (size_t i = 0; i < 3 * m.vertex_count; i++)
                assert_near((double)m.normals[i], (double)expected.normals[i], 1e-5);
        cw_mesh_free(&m);
        cw_mesh_free(&expected);
        cw_volume_free(&v);
    }
}

/* Noise has every case; mirrored too. */
static void any_field_gives_a_sound_surface(void **state)
{
    (void)state;
    test_seed(3);
    for (int round = 0; round < 6; round++) {
        cw_volume v = make_sphere(12, 0.7);
        double *x = cw_volume_voxels(&v);
        for (size_t n = 0; n < v.dim[0] * v.dim[1] * v.dim[2]; n++)
            x[n] = rand() % 20 ? (double)rand() / RAND_MAX - 0.5 : round & 1 ? NAN : 0;
        test_turn(&v, round);
        cw_mesh m = test_extract(&v, &(cw_extract_desc){.leave_open = round & 2}, NULL);
        test_check_promise(&m, round & 2);
        cw_mesh_free(&m);
        cw_volume_free(&v);
    }
}

static void places_and_indices_agree(void **state)
{
    (void)state;
    cw_volume v = make_sphere(20, 0.7), part;
    cw_error err = {0};
    double world[3], index[3], spacing[3];
    place_in_world(&v);
    for (double t = -0.5; t < 20; t += 0.37) {
        const double expected[3] = {t, t / 2, t + 3};
        cw_volume_to_world(&v, expected, world);
        assert_ok(cw_volume_to_index(&v, world, index, &err), err);
        for (int a = 0; a < 3; a++)
            assert_near(index[a], expected[a], 1e-9);
    }
    cw_volume_to_world(&v, (double[3]){4, 5, 6}, world);
    assert_near(world[0], 100 + 3 * coordinates[1][5], 1e-12);
    assert_near(world[1], -50 - 3 * coordinates[0][4], 1e-12);
    cw_volume_spacing(&v, spacing);
    assert_near(spacing[0], 3 * 2 / 19.0, 1e-12);
    const cw_box box = {{4, 5, 6}, {8, 7, 6}};
    double first[3];
    assert_ok(cw_volume_crop(&v, &box, &part, &err), err);
    cw_volume_to_world(&part, (double[3]){0, 0, 0}, first);
    assert_memory_equal(first, world, sizeof world);
    cw_volume_free(&v);
}

static void what_is_made_for_even_grids_is_refused(void **state)
{
    (void)state;
    cw_volume v = make_sphere(20, 0.7), out;
    cw_error err = {0};
    cw_mesh m = {0};
    cw_distance d;
    assert_fails(cw_volume_coarsen(&v, (size_t[3]){2, 2, 2}, &out, &err), CW_ERR_UNSUPPORTED,
                 "rectilinear", err);
    assert_fails(cw_extract(&v, &(cw_extract_desc){.snap = 0.3}, &m, NULL, &err),
                 CW_ERR_UNSUPPORTED, "snap", err);
    assert_fails(cw_extract(&v, &(cw_extract_desc){.cubic_placement = true}, &m, NULL, &err),
                 CW_ERR_UNSUPPORTED, "cubic", err);
    test_make_cube(&m);
    assert_fails(cw_distance_to_field(&m, &v, NULL, &d, NULL, &err), CW_ERR_UNSUPPORTED,
                 "distance", err);
    cw_mesh_free(&m);
    assert_fails(cw_volume_write("no.nrrd", &v, NULL, &err), CW_ERR_UNSUPPORTED, "writing",
                 err);
    coordinates[1][3] = coordinates[1][2];
    assert_fails(cw_volume_resolve(&v, &out, &err), CW_ERR_ARGUMENT, "coordinate 3 along y",
                 err);
    coordinates[1][3] = NAN;
    assert_fails(cw_volume_resolve(&v, &out, &err), CW_ERR_ARGUMENT, "coordinate 3 along y",
                 err);
    v.coordinates[2] = NULL;
    bend(&v);
    v.coordinates[2] = NULL;
    assert_fails(cw_volume_resolve(&v, &out, &err), CW_ERR_ARGUMENT, "along z are missing",
                 err);
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vertices_are_of_second_order),
        cmocka_unit_test(even_coordinates_change_nothing),
        cmocka_unit_test(any_field_gives_a_sound_surface),
        cmocka_unit_test(places_and_indices_agree),
        cmocka_unit_test(what_is_made_for_even_grids_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
