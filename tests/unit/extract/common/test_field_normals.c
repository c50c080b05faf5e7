/* Normals taken from a field at the vertices of any mesh: extraction's own where it made the
 * vertices, those of the true surface elsewhere. */
#include "support/surface.h"

#include "core/base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The largest difference of two sets of normals, as vectors. */
static double largest_difference(const float *a, const float *b, size_t count)
{
    double largest = 0;
    for (size_t v = 0; v < 3 * count; v += 3)
        largest =
            fmax(largest, hypot(hypot(a[v] - b[v], a[v + 1] - b[v + 1]), a[v + 2] - b[v + 2]));
    return largest;
}

static void shade(const cw_volume *v, const cw_normals_desc *desc, cw_mesh *mesh)
{
    cw_error err = {0};
    assert_ok(cw_extract_normals(v, desc, mesh, &err), err);
}

static void extracted_vertices_get_their_own_normals_again(void **state)
{
    (void)state;
    for (int round = 0; round < 24; round++) {
        const cw_field field = round % 2 ? CW_FIELD_TORUS : CW_FIELD_SPHERE;
        const cw_type type = (cw_type)(round % CW_TYPE_COUNT);
        cw_volume v = test_sample(field, 40, type);
        const bool low = round % 3 == 1;
        test_turn(&v, round);
        if (round % 4 == 3)
            v.slope = -1; /* high voxels are low values */
        /* open: where the solid is all around the sphere, the border has no caps */
        const double level = cw_field_stored(field, type, 0) * (v.slope < 0 ? -1 : 1);
        cw_mesh mesh = test_extract(
            &v, &(cw_extract_desc){.isovalue = level, .inside_is_low = low, .leave_open = true},
            NULL);
        float *own = mesh.normals;
        assert_true(mesh.vertex_count > 1000);
        mesh.normals = NULL;
        shade(&v, &(cw_normals_desc){.inside_is_low = low}, &mesh);
        assert_true(largest_difference(own, mesh.normals, mesh.vertex_count) < 1e-6);
        cwi_free(own);
        cw_mesh_free(&mesh);
        cw_volume_free(&v);
    }
}

/* Anywhere near a sphere, and of second order. */
static void points_off_the_grid_get_the_spheres_normals(void **state)
{
    (void)state;
    enum { COUNT = 2000 };
    double worst[2] = {0, 0};
    for (int n = 0; n < 2; n++) {
        cw_volume v = test_sample(CW_FIELD_SPHERE, (size_t)48 << n, CW_F64);
        cw_mesh mesh = {.vertex_count = COUNT};
        float truth[3 * COUNT];
        mesh.positions = cwi_alloc_array(COUNT, 3 * sizeof *mesh.positions);
        test_seed(7);
        for (size_t p = 0; p < COUNT; p++) {
            double d[3], length = 0;
            for (int a = 0; a < 3; a++) {
                d[a] = (double)rand() / RAND_MAX - 0.5;
                length += d[a] * d[a];
            }
            const double radius = 29 + 2 * (double)rand() / RAND_MAX;
            for (size_t a = 0; a < 3; a++) {
                truth[3 * p + a] = (float)(d[a] / sqrt(length));
                mesh.positions[3 * p + a] = (float)(radius * d[a] / sqrt(length));
            }
        }
        shade(&v, NULL, &mesh);
        worst[n] = largest_difference(truth, mesh.normals, COUNT);
        cw_mesh_free(&mesh);
        cw_volume_free(&v);
    }
    assert_true(worst[0] < 0.003);
    assert_true(log2(worst[0] / worst[1]) > 1.8);
}

/* A plane's solid is closed by caps, which have no field: theirs stay. */
static void caps_keep_their_normals(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_PLANE, 24, CW_F32);
    cw_mesh mesh = test_extract(&v, NULL, NULL);
    const size_t bytes = 3 * mesh.vertex_count * sizeof *mesh.normals;
    float *own = malloc(bytes);
    memcpy(own, mesh.normals, bytes);
    shade(&v, NULL, &mesh);
    assert_true(largest_difference(own, mesh.normals, mesh.vertex_count) < 2e-5);
    free(own);
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

/* Far outside the volume nothing but the triangles is left to go by. */
static void vertices_outside_keep_theirs_or_get_their_triangles(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_SPHERE, 16, CW_F32);
    cw_mesh cube, bare;
    test_make_cube(&cube);
    test_make_cube(&bare);
    cube.origin[0] = bare.origin[0] = 1000;
    cwi_free(bare.normals);
    bare.normals = NULL;
    for (size_t n = 0; n < 3 * cube.vertex_count; n++)
        cube.normals[n] = n % 3 == 1;
    shade(&v, NULL, &cube);
    shade(&v, NULL, &bare);
    assert_true(test_normals_agree(&bare));
    for (size_t n = 0; n < 3 * cube.vertex_count; n++)
        assert_true(cube.normals[n] == (n % 3 == 1));
    cw_mesh_free(&cube);
    cw_mesh_free(&bare);
    cw_volume_free(&v);
}

/* Samples without value are no part of any gradient. */
static void missing_samples_are_passed_over(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_SPHERE, 32, CW_F32);
    float *voxels = cw_volume_voxels(&v);
    cw_mesh mesh = {.vertex_count = 2};
    mesh.positions = cwi_alloc_zeroed(2, 3 * sizeof *mesh.positions);
    const double spacing = v.affine[0][0];
    mesh.positions[0] = (float)(10 * spacing); /* half a voxel from samples on all axes */
    mesh.positions[3] = (float)(-10 * spacing);
    const size_t at = (16 * 32 + 16) * 32 + 26; /* a corner of the first one's cell */
    voxels[at] = NAN;
    shade(&v, NULL, &mesh);
    assert_true(mesh.normals[0] == 0 && mesh.normals[1] == 0 && mesh.normals[2] == 1);
    assert_true(mesh.normals[3] < -0.99f);
    voxels[at] = 0;
    voxels[at + 1] = NAN; /* beside that cell: the difference is one-sided */
    shade(&v, NULL, &mesh);
    assert_true(mesh.normals[0] > 0.99f);
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

static void threads_give_the_same_bytes(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_GYROID, 48, CW_I16);
    cw_mesh a = test_extract(&v, &(cw_extract_desc){.no_normals = true}, NULL);
    cw_mesh b = test_extract(&v, &(cw_extract_desc){.no_normals = true}, NULL);
    assert_true(a.vertex_count > 10000);
    shade(&v, &(cw_normals_desc){.threads = 1}, &a);
    shade(&v, &(cw_normals_desc){.threads = 5}, &b);
    test_assert_same_mesh(&a, &b);
    cw_mesh_free(&a);
    cw_mesh_free(&b);
    cw_volume_free(&v);
}

static void failures_leave_the_mesh_as_it_was(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_SPHERE, 16, CW_F32), thin = v;
    cw_mesh mesh = test_extract(&v, NULL, NULL);
    const float *normals = mesh.normals;
    cw_error err = {0};
    int polls = 0;
    const cw_normals_desc stop = {.progress = {test_stop_after, &polls}};
    thin.dim[2] = 1;
    assert_fails(cw_extract_normals(&thin, NULL, &mesh, &err), CW_ERR_ARGUMENT, "along z", err);
    assert_fails(cw_extract_normals(&v, &stop, &mesh, &err), CW_ERR_CANCELLED, "", err);
    cwi_alloc_fail_after(0);
    const cw_status st = cw_extract_normals(&v, NULL, &mesh, &err);
    cwi_alloc_fail_after(-1);
    assert_int_equal(st, CW_ERR_NO_MEMORY);
    mesh.triangles[5] = (uint32_t)mesh.vertex_count;
    assert_fails(cw_extract_normals(&v, NULL, &mesh, &err), CW_ERR_ARGUMENT, "vertex", err);
    assert_ptr_equal(mesh.normals, normals);
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(extracted_vertices_get_their_own_normals_again),
        cmocka_unit_test(points_off_the_grid_get_the_spheres_normals),
        cmocka_unit_test(caps_keep_their_normals),
        cmocka_unit_test(vertices_outside_keep_theirs_or_get_their_triangles),
        cmocka_unit_test(missing_samples_are_passed_over),
        cmocka_unit_test(threads_give_the_same_bytes),
        cmocka_unit_test(failures_leave_the_mesh_as_it_was),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
