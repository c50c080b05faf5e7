/* Voxels of meshes: exact on ties, against winding numbers, there and back, and facts on the meshes. */
#include "support/solids.h"

#include "core/base/memory.h"

#include <cubewright/distance.h>
#include <cubewright/voxelize.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

static cw_volume voxelize(const cw_mesh *mesh, const cw_voxelize_desc *desc,
                          cw_voxelize_part *part)
{
    cw_volume volume;
    cw_error err = {0};
    cw_voxelize_desc d = *desc;
    d.parts = part;
    assert_ok(cw_voxelize(&mesh, 1, &d, &volume, &err), err);
    return volume;
}

static double sum_of(const cw_volume *v)
{
    double sum = 0;
    for (size_t k = 0; k < v->dim[2]; k++)
        for (size_t j = 0; j < v->dim[1]; j++)
            for (size_t i = 0; i < v->dim[0]; i++)
                sum += cw_volume_value(v, i, j, k);
    return sum;
}

/* A grid of n x n x n voxels whose middle is at the world's zero. */
static cw_volume make_grid(size_t n, double spacing)
{
    cw_volume grid = {.dim = {n, n, n}};
    for (int a = 0; a < 3; a++) {
        grid.affine[a][a] = spacing;
        grid.affine[a][3] = -0.5 * spacing * (double)(n - 1);
    }
    return grid;
}

static cw_mesh make_box(double low, double high)
{
    cw_mesh box = test_make_boxes(1);
    test_add_box(&box, (const double[3]){low, low, low}, (const double[3]){high, high, high},
                 false);
    return box;
}

/* --- exact cases -------------------------------------------------------------------------- */

/* Faces through centres, between them, and elsewhere: as many voxels as the volume tells, and fractions that
 * add up to it. */
static void cubes_on_the_grid_have_their_volume(void **state)
{
    (void)state;
    static const double places[][2] = {{2, 6}, {1.5, 7.5}, {0, 9}, {-0.5, 9.5}, {3, 4}};
    cw_volume grid = {.dim = {12, 12, 12}};
    for (int a = 0; a < 3; a++)
        grid.affine[a][a] = 1;
    grid.dim[2] = 13;
    for (size_t n = 0; n < sizeof places / sizeof *places; n++) {
        cw_mesh box = make_box(places[n][0], places[n][1]);
        const double side = places[n][1] - places[n][0];
        cw_voxelize_part part;
        cw_volume labels = voxelize(&box, &(cw_voxelize_desc){.like = &grid}, &part);
        cw_volume fractions =
            voxelize(&box, &(cw_voxelize_desc){.like = &grid, .partial = true}, NULL);
        assert_int_equal(labels.type, CW_U8);
        assert_true(labels.known & CW_KNOWN_LABELS);
        assert_near(sum_of(&labels), side * side * side, 1e-9);
        assert_int_equal(part.voxels, (size_t)llrint(side * side * side));
        assert_near(sum_of(&fractions), side * side * side, 1e-3);
        assert_near(part.volume_mm3, side * side * side, 1e-9);
        cw_volume_free(&labels);
        cw_volume_free(&fractions);
        cw_mesh_free(&box);
    }
}

/* Boxes that share faces at centres of voxels: each voxel has one of them, and none is left out. */
static void meshes_that_touch_share_no_voxel(void **state)
{
    (void)state;
    cw_volume grid = {.dim = {14, 14, 14}}, volume;
    cw_error err = {0};
    cw_mesh boxes[8];
    const cw_mesh *meshes[8];
    cw_voxelize_part parts[8];
    for (int a = 0; a < 3; a++)
        grid.affine[a][a] = 1;
    for (int n = 0; n < 8; n++) {
        double low[3], high[3];
        for (int a = 0; a < 3; a++) {
            low[a] = n >> a & 1 ? 6 : 2;
            high[a] = n >> a & 1 ? 11 : 6;
        }
        boxes[n] = test_make_boxes(1);
        test_add_box(&boxes[n], low, high, false);
        meshes[n] = &boxes[n];
    }
    const cw_voxelize_desc desc = {.like = &grid, .parts = parts};
    assert_ok(cw_voxelize(meshes, 8, &desc, &volume, &err), err);
    size_t filled = 0;
    for (int n = 0; n < 8; n++) {
        filled += parts[n].voxels;
        assert_int_equal(parts[n].overlapped, 0);
        cw_mesh_free(&boxes[n]);
    }
    assert_int_equal(filled, 9 * 9 * 9);
    cw_volume_free(&volume);
}

/* Returns the winding number of a mesh around a point, by solid angles [VanOosterom1983]. */
static double winding_at(const cw_mesh *mesh, const double at[3])
{
    double sum = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double r[3][3], l[3];
        for (int k = 0; k < 3; k++) {
            const float *p = mesh->positions + 3 * (size_t)mesh->triangles[3 * t + (size_t)k];
            for (int a = 0; a < 3; a++)
                r[k][a] = (double)p[a] + mesh->origin[a] - at[a];
            l[k] = sqrt(r[k][0] * r[k][0] + r[k][1] * r[k][1] + r[k][2] * r[k][2]);
        }
        double dot[3];
        for (int k = 0; k < 3; k++) {
            const double *a = r[k], *b = r[(k + 1) % 3];
            dot[k] = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        }
        const double det = r[0][0] * (r[1][1] * r[2][2] - r[1][2] * r[2][1]) -
                           r[0][1] * (r[1][0] * r[2][2] - r[1][2] * r[2][0]) +
                           r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]);
        sum += atan2(det, l[0] * l[1] * l[2] + dot[0] * l[2] + dot[1] * l[0] + dot[2] * l[1]);
    }
    return sum / 6.283185307179586;
}

/* Random solids in turned, sheared and mirrored grids: fields, boxes, needles, nested shells, spheres that
 * overlap, spikes. Centres on a surface, or within a ten-thousandth of a voxel, are left out. */
static void labels_are_where_the_mesh_winds(void **state)
{
    (void)state;
    static const test_pair_kind kinds[] = {PAIR_BOXES,   PAIR_NEEDLES, PAIR_SHELLS,
                                           PAIR_SPHERES, PAIR_STARS,   PAIR_FACES};
    for (unsigned n = 0; n < (unsigned)test_some(24); n++) {
        cw_mesh pair[2];
        double low[3], high[3];
        cw_volume grid = make_grid(9, 1), volume;
        cw_error err = {0};
        test_make_pair(kinds[n % 6], test_seed(400 + n), pair);
        cw_mesh_bounds(&pair[0], low, high);
        test_turn(&grid, (int)n);
        double middle[3], size = 0, at[3] = {4, 4, 4};
        for (int a = 0; a < 3; a++)
            size = fmax(size, high[a] - low[a]);
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 3; c++)
                grid.affine[r][c] *= size / 9;
        cw_volume_to_world(&grid, at, middle);
        for (int r = 0; r < 3; r++)
            grid.affine[r][3] += (low[r] + high[r]) / 2 - middle[r];
        const cw_mesh *mesh = &pair[0];
        cw_voxelize_part part;
        const cw_status st = cw_voxelize(
            &mesh, 1, &(cw_voxelize_desc){.like = &grid, .parts = &part}, &volume, &err);
        size_t wrong = 0, known = 0;
        for (size_t v = 0; st == CW_OK && v < 9 * 9 * 9; v++) {
            const size_t i = v % 9, j = v / 9 % 9, k = v / 81;
            cw_volume_to_world(&volume, (const double[3]){(double)i, (double)j, (double)k}, at);
            const double winding = winding_at(mesh, at) * (part.turned ? -1 : 1);
            double moved[2];
            for (int side = 0; side < 2; side++) {
                const double by = (side ? -5e-5 : 5e-5) * size / 9;
                moved[side] = winding_at(
                    mesh, (const double[3]){at[0] + by, at[1] + 0.7 * by, at[2] - 0.9 * by});
            }
            if (fabs(winding - rint(winding)) > 0.02 || fabs(moved[0] - moved[1]) > 0.02)
                continue;
            known++;
            wrong += (winding > 0.5) != (cw_volume_value(&volume, i, j, k) > 0);
        }
        assert_ok(st, err);
        assert_true(known > 300);
        assert_int_equal(wrong, 0);
        cw_volume_free(&volume);
        cw_mesh_free(&pair[0]);
        cw_mesh_free(&pair[1]);
    }
}

/* --- there and back ----------------------------------------------------------------------- */

static double farthest(const cw_mesh *a, const cw_mesh *b)
{
    cw_distance d;
    cw_error err = {0};
    assert_ok(cw_distance_to_mesh(a, b, NULL, &d, NULL, &err), err);
    return d.max_mm;
}

/* The surface of the voxels is as near to the mesh as is said, in any frame and unit; and the fractions add up
 * to the mesh's volume. */
static void a_mesh_comes_back(void **state)
{
    (void)state;
    static const cw_field fields[] = {CW_FIELD_SPHERE, CW_FIELD_TORUS, CW_FIELD_GYROID};
    static const double units[] = {1, 1e-4, 1e4};
    for (size_t n = 0; n < (size_t)test_some(9); n++) {
        const double unit = units[n / 3];
        cw_mesh mesh = test_extract_field(fields[n % 3], 40);
        const double zero[3] = {0, 0, 0};
        cw_volume grid = make_grid(64, 90.0 / 48 * unit);
        test_move_mesh(&mesh, 0.3 * (double)n, unit, zero);
        const double side = 90.0 / 48 * unit;
        for (int partial = 0; partial < 2; partial++) {
            cw_voxelize_part part;
            const cw_voxelize_desc desc = {.like = &grid, .partial = partial};
            cw_volume volume = voxelize(&mesh, &desc, &part);
            cw_mesh back = test_extract(&volume, &(cw_extract_desc){.isovalue = 0.5}, NULL);
            assert_true(farthest(&back, &mesh) <= (partial ? 0.8 : 0.87) * side);
            assert_within(part.filled_mm3, part.volume_mm3, partial ? 1e-6 : 0.02);
            assert_within(sum_of(&volume) * side * side * side, part.filled_mm3, 1e-6);
            assert_int_equal(part.lost, 0);
            assert_true(part.outside_mm2 == 0);
            cw_volume_free(&volume);
            cw_mesh_free(&back);
        }
        cw_mesh_free(&mesh);
    }
}

static void a_smooth_surface_comes_back_within_half_a_voxel(void **state)
{
    (void)state;
    cw_mesh mesh = test_extract_field(CW_FIELD_SPHERE, 40);
    cw_volume volume =
        voxelize(&mesh, &(cw_voxelize_desc){.spacing_mm = {2.3, 0, 0}, .partial = true}, NULL);
    cw_mesh back = test_extract(&volume, &(cw_extract_desc){.isovalue = 0.5}, NULL);
    assert_true(farthest(&back, &mesh) <= 0.5 * 2.3 && farthest(&mesh, &back) <= 0.5 * 2.3);
    cw_volume_free(&volume);
    cw_mesh_free(&back);
    cw_mesh_free(&mesh);
}

/* --- facts -------------------------------------------------------------------------------- */

static void plates_thinner_than_a_voxel_are_counted(void **state)
{
    (void)state;
    static const double boxes[3][2][3] = {{{0.1, 0, 0}, {0.4, 20, 20}},  /* between centres */
                                          {{5, 3.2, 3.3}, {15, 12, 14}}, /* a solid */
                                          {{18.2, 18.2, 3}, {18.6, 18.4, 9}}}; /* a needle */
    cw_mesh mesh = test_make_boxes(3);
    for (int n = 0; n < 3; n++)
        test_add_box(&mesh, boxes[n][0], boxes[n][1], false);
    const cw_voxelize_desc desc = {
        .spacing_mm = {1, 1, 1}, .low = {-3.5, -3.5, -3.5}, .high = {24.5, 24.5, 24.5}};
    cw_voxelize_part part;
    cw_volume volume = voxelize(&mesh, &desc, &part);
    assert_int_equal(part.solids, 3);
    assert_int_equal(part.lost, 2);
    assert_int_equal(part.thin_places, 2);
    assert_within(part.thin_mm2, 2 * (0.3 * 20 * 2 + 400) + 2 * (0.4 * 0.2 + 0.6 * 6), 1e-4);
    assert_int_equal(part.voxels, 10 * 8 * 10);
    cw_volume_free(&volume);
    cw_mesh_free(&mesh);
}

static void overlaps_and_shells_inside_out_are_counted(void **state)
{
    (void)state;
    cw_mesh mesh = test_make_boxes(3);
    test_add_box(&mesh, (const double[3]){0, 0, 0}, (const double[3]){10, 10, 10}, false);
    test_add_box(&mesh, (const double[3]){5, 5, 5}, (const double[3]){15, 15, 15}, false);
    test_add_box(&mesh, (const double[3]){20, 0, 0}, (const double[3]){24, 4, 4}, true);
    cw_voxelize_part part;
    cw_volume volume = voxelize(&mesh, &(cw_voxelize_desc){.spacing_mm = {1, 1, 1}}, &part);
    assert_int_equal(part.voxels, 1875);
    assert_int_equal(part.repeated, 125);
    assert_int_equal(part.negative, 64);
    assert_false(part.turned);
    cw_volume_free(&volume);
    for (size_t n = 0; n < mesh.triangle_count; n++) { /* inside out as a whole */
        const uint32_t corner = mesh.triangles[3 * n];
        mesh.triangles[3 * n] = mesh.triangles[3 * n + 1];
        mesh.triangles[3 * n + 1] = corner;
    }
    volume = voxelize(&mesh, &(cw_voxelize_desc){.spacing_mm = {1, 1, 1}}, &part);
    assert_true(part.turned);
    assert_int_equal(part.voxels, 1875);
    cw_volume_free(&volume);
    cw_mesh_free(&mesh);
}

static void a_part_outside_of_the_grid_is_cut_off(void **state)
{
    (void)state;
    cw_mesh box = make_box(0, 10);
    for (int partial = 0; partial < 2; partial++) {
        cw_voxelize_part part;
        cw_voxelize_desc desc = {
            .spacing_mm = {1, 1, 1}, .low = {5, 2, -3}, .high = {30, 8, 5}, .partial = partial};
        cw_volume volume = voxelize(&box, &desc, &part);
        assert_near(sum_of(&volume), 5 * 6 * 5, 1e-3);
        assert_near(part.filled_mm3, 5 * 6 * 5, 1e-9);
        assert_within(part.outside_mm2, 600 - (5 * 6 + 6 * 5), 0.05);
        cw_volume_free(&volume);
    }
    cw_mesh_free(&box);
}

static void labels_are_those_asked_for(void **state)
{
    (void)state;
    static const uint32_t tables[3][2] = {{7, 255}, {300, 9}, {70000, 2}};
    static const cw_type types[3] = {CW_U8, CW_U16, CW_U32};
    cw_mesh boxes[2] = {make_box(0, 4), make_box(2, 6)};
    const cw_mesh *meshes[2] = {&boxes[0], &boxes[1]};
    for (int n = 0; n < 3; n++) {
        cw_volume volume;
        cw_error err = {0};
        cw_voxelize_part parts[2];
        const cw_voxelize_desc desc = {
            .spacing_mm = {1, 1, 1}, .labels = tables[n], .parts = parts};
        assert_ok(cw_voxelize(meshes, 2, &desc, &volume, &err), err);
        assert_int_equal(volume.type, types[n]);
        assert_int_equal((uint32_t)cw_volume_value(&volume, 2, 2, 2), tables[n][0]);
        assert_int_equal((uint32_t)cw_volume_value(&volume, 4, 4, 4), tables[n][1]);
        assert_int_equal(parts[1].overlapped, 8);
        cw_volume_free(&volume);
    }
    cw_mesh_free(&boxes[0]);
    cw_mesh_free(&boxes[1]);
}

/* --- threads and refusals ----------------------------------------------------------------- */

static void threads_change_nothing(void **state)
{
    (void)state;
    cw_mesh mesh = test_extract_field(CW_FIELD_GYROID, 40);
    for (int partial = 0; partial < 2; partial++) {
        cw_voxelize_part one, many;
        cw_voxelize_desc desc = {
            .spacing_mm = {0.9, 1.1, 1.3}, .partial = partial, .threads = 1};
        cw_volume a = voxelize(&mesh, &desc, &one);
        desc.threads = 7;
        cw_volume b = voxelize(&mesh, &desc, &many);
        assert_memory_equal(a.data, b.data,
                            a.dim[0] * a.dim[1] * a.dim[2] * cw_type_size(a.type));
        assert_memory_equal(&one, &many, sizeof one);
        cw_volume_free(&a);
        cw_volume_free(&b);
    }
    cw_mesh_free(&mesh);
}

static void what_makes_no_sense_is_refused(void **state)
{
    (void)state;
    cw_mesh box = make_box(0, 4), open = make_box(0, 4), empty = {0};
    const cw_mesh *mesh = &box;
    const cw_volume grid = make_grid(8, 1);
    const uint32_t zero = 0;
    const cw_voxelize_desc good = {.spacing_mm = {1, 0, 0}};
    cw_volume volume;
    cw_voxelize_part part;
    cw_error err = {0};
#define REFUSES(status, words, ...)                                                            \
    assert_fails(cw_voxelize(&mesh, 1, &(cw_voxelize_desc){__VA_ARGS__}, &volume, &err),       \
                 status, words, err)
    REFUSES(CW_ERR_ARGUMENT, "a grid is required", .labels = NULL);
    REFUSES(CW_ERR_ARGUMENT, "not both", .like = &grid, .spacing_mm = {1, 1, 1});
    REFUSES(CW_ERR_ARGUMENT, "spacing_mm is -1", .spacing_mm = {-1, 0, 0});
    REFUSES(CW_ERR_ARGUMENT, "along y", .spacing_mm = {1, 1, 1}, .low = {0, 3, 0},
            .high = {4, 3, 4});
    REFUSES(CW_ERR_ARGUMENT, "is 0", .spacing_mm = {1, 1, 1}, .labels = &zero);
    REFUSES(CW_ERR_ARGUMENT, "version", .version = 1);
    REFUSES(CW_ERR_EMPTY, "outside of the grid", .spacing_mm = {1, 1, 1}, .low = {50, 50, 50},
            .high = {60, 60, 60});
    REFUSES(CW_ERR_LIMIT, "along an axis", .spacing_mm = {1e-8, 1, 1});
    REFUSES(CW_ERR_LIMIT, "max_bytes", .spacing_mm = {0.01, 0, 0}, .max_bytes = 1000000);
    REFUSES(CW_ERR_LIMIT, "check the unit", .spacing_mm = {1e-9, 1e-9, 1e-9}, .low = {3, 3, 3},
            .high = {3 + 1e-8, 3 + 1e-8, 3 + 1e-8});
    open.triangle_count--;
    mesh = &open;
    assert_fails(cw_voxelize(&mesh, 1,
                             &(cw_voxelize_desc){.spacing_mm = {1, 0, 0}, .parts = &part},
                             &volume, &err),
                 CW_ERR_CHECK, "3 open edges", err);
    assert_true(part.open);
    mesh = &empty;
    assert_fails(cw_voxelize(&mesh, 1, &good, &volume, &err), CW_ERR_EMPTY, "no triangles",
                 err);
    mesh = &box;
    assert_fails(cw_voxelize(&mesh, 0, &good, &volume, &err), CW_ERR_ARGUMENT, "count is 0",
                 err);
    cw_mesh_free(&box);
    cw_mesh_free(&open);
}

static void running_out_of_memory_is_told(void **state)
{
    (void)state;
    cw_mesh box = make_box(0, 4);
    const cw_mesh *mesh = &box;
    for (int partial = 0; partial < 2; partial++) {
        long n = 0;
        for (;; n++) {
            cw_volume volume;
            cw_voxelize_part part;
            const cw_voxelize_desc desc = {
                .spacing_mm = {1, 0, 0}, .partial = partial, .threads = 1, .parts = &part};
            cwi_alloc_fail_after(n);
            const cw_status st = cw_voxelize(&mesh, 1, &desc, &volume, NULL);
            const bool failed = cwi_alloc_fail_after(-1);
            assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
            cw_volume_free(&volume);
            if (!failed)
                break;
        }
        assert_true(n > 8);
    }
    cw_mesh_free(&box);
}

static void it_can_be_stopped(void **state)
{
    (void)state;
    cw_mesh mesh = test_extract_field(CW_FIELD_SPHERE, 30);
    const cw_mesh *meshes = &mesh;
    cw_volume volume;
    cw_error err = {0};
    int polls = 1;
    const cw_voxelize_desc desc = {.spacing_mm = {1, 0, 0},
                                   .threads = 1,
                                   .progress = {.report = test_stop_after, .user = &polls}};
    assert_int_equal(cw_voxelize(&meshes, 1, &desc, &volume, &err), CW_ERR_CANCELLED);
    assert_null(volume.data);
    cw_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cubes_on_the_grid_have_their_volume),
        cmocka_unit_test(meshes_that_touch_share_no_voxel),
        cmocka_unit_test(labels_are_where_the_mesh_winds),
        cmocka_unit_test(a_mesh_comes_back),
        cmocka_unit_test(a_smooth_surface_comes_back_within_half_a_voxel),
        cmocka_unit_test(plates_thinner_than_a_voxel_are_counted),
        cmocka_unit_test(overlaps_and_shells_inside_out_are_counted),
        cmocka_unit_test(a_part_outside_of_the_grid_is_cut_off),
        cmocka_unit_test(labels_are_those_asked_for),
        cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(what_makes_no_sense_is_refused),
        cmocka_unit_test(running_out_of_memory_is_told),
        cmocka_unit_test(it_can_be_stopped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
