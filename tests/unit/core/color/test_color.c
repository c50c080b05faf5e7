/* Colours of meshes: values of volumes in any frame, and maps. */
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/mesh/mesh.h"

#include <cubewright/color.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* x + 2 y - 3 z of the world. */
static double linear_at(const double p[3])
{
    return p[0] + 2 * p[1] - 3 * p[2];
}

/* A volume of that function in a turned, sheared frame. */
static cw_volume make_linear(int round)
{
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, CW_F32, (const size_t[3]){30, 28, 26}, 1, 1, &err), err);
    for (int a = 0; a < 3; a++)
        v.affine[a][a] = 3;
    test_turn(&v, round);
    float *voxels = cw_volume_voxels(&v);
    for (size_t n = 0; n < 30 * 28 * 26; n++) {
        const double index[3] = {(double)(n % 30), (double)(n / 30 % 28),
                                 (double)(n / 30 / 28)};
        double world[3];
        cw_volume_to_world(&v, index, world);
        voxels[n] = (float)linear_at(world);
    }
    return v;
}

/* Points of the volume by index, as vertices of a mesh without triangles. */
static cw_mesh make_points(const cw_volume *v, const double (*indices)[3], size_t count)
{
    cw_mesh m;
    cw_error err = {0};
    assert_ok(cwi_mesh_alloc(&m, count, 0, false, &err), err);
    cw_volume_to_world(v, indices[0], m.origin);
    for (size_t n = 0; n < count; n++) {
        double world[3];
        cw_volume_to_world(v, indices[n], world);
        for (size_t a = 0; a < 3; a++)
            m.positions[3 * n + a] = (float)(world[a] - m.origin[a]);
    }
    return m;
}

static void values_are_those_of_the_world(void **state)
{
    (void)state;
    static const double at[][3] = {{3, 4, 5},      {0.5, 20.25, 7.75}, {29, 27, 25},
                                   {0, 0, 0},      {29.4, 10, 10},     {10, -0.4, 10},
                                   {29.6, 10, 10}, {10, 10, -2},       {12.5, 13.5, 14.5}};
    enum { COUNT = sizeof at / sizeof *at };
    for (int round = 0; round < 6; round++) {
        cw_volume v = make_linear(round);
        cw_mesh m = make_points(&v, at, COUNT);
        cw_sample_facts facts;
        cw_error err = {0};
        assert_ok(cw_mesh_sample(&m, &v, NULL, &facts, &err), err);
        double low = INFINITY, high = -INFINITY;
        for (size_t n = 0; n < COUNT; n++) {
            double index[3], world[3];
            for (int a = 0; a < 3; a++)
                index[a] = fmax(0, fmin(at[n][a], (double)v.dim[a] - 1));
            cw_volume_to_world(&v, index, world);
            if (n == 6 || n == 7)
                continue;
            assert_near((double)m.scalars[n], linear_at(world),
                        2e-4 * fabs(linear_at(world)) + 2e-3);
            low = fmin(low, (double)m.scalars[n]);
            high = fmax(high, (double)m.scalars[n]);
        }
        assert_int_equal(facts.missing, 2);
        assert_true(facts.low == low && facts.high == high);
        assert_true((double)m.scalars[6] == low && (double)m.scalars[7] == low);
        cw_mesh_free(&m);
        cw_volume_free(&v);
    }
}

static void samples_without_a_value_count_as_missing(void **state)
{
    (void)state;
    static const double at[][3] = {{3, 4, 5}, {10.5, 10, 10}, {11, 10, 10}};
    cw_volume v = make_linear(0);
    float *voxels = cw_volume_voxels(&v);
    voxels[10 + 30 * (10 + 28 * 10)] = NAN;
    cw_mesh m = make_points(&v, at, 3);
    cw_sample_facts facts;
    cw_error err = {0};
    assert_ok(cw_mesh_sample(&m, &v, NULL, &facts, &err), err);
    assert_int_equal(facts.missing, 1);
    assert_true(isfinite(m.scalars[1]));
    cw_mesh_free(&m);
    cw_volume_free(&v);
}

/* One cell of each shape, far from 0: linear inside and on its edges, the nearest value just outside. */
static void cells_are_sampled(void **state)
{
    (void)state;
    static const double cube[8][3] = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0},
                                      {0, 0, 4}, {4, 0, 4}, {4, 4, 4}, {0, 4, 4}};
    static const uint8_t corners[CW_SHAPE_COUNT][8] = {
        [CW_TETRAHEDRON] = {0, 1, 3, 4},
        [CW_PYRAMID] = {0, 1, 2, 3, 4},
        [CW_WEDGE] = {0, 3, 1, 4, 7, 5},
        [CW_HEXAHEDRON] = {0, 1, 2, 3, 4, 5, 6, 7}};
    static const size_t counts[CW_SHAPE_COUNT] = {4, 5, 6, 8};
    static const double at[][3] = {{1, 1, 0.5}, {0, 0, 2.5},      {1.25, 0, 0},
                                   {0.5, 2, 1}, {0.5, 0.5, -0.1}, {2, 2, 9}};
    enum { COUNT = sizeof at / sizeof *at };
    for (int shape = 0; shape < CW_SHAPE_COUNT; shape++) {
        double points[24], values[8];
        uint32_t numbers[8];
        const uint8_t shapes[1] = {(uint8_t)shape};
        for (size_t c = 0; c < counts[shape]; c++) {
            numbers[c] = (uint32_t)c;
            for (size_t a = 0; a < 3; a++)
                points[3 * c + a] = 1e4 + cube[corners[shape][c]][a];
            values[c] = linear_at(points + 3 * c);
        }
        const cw_cells cells = {
            .points = points, .count = 1, .shapes = shapes, .corners = numbers};
        cw_volume v = {
            .data = values, .type = CW_F64, .dim = {counts[shape], 1, 1}, .cells = &cells};
        cw_mesh m;
        cw_sample_facts facts;
        cw_error err = {0};
        assert_ok(cwi_mesh_alloc(&m, COUNT, 0, false, &err), err);
        for (size_t n = 0; n < 3 * COUNT; n++)
            m.positions[n] = (float)at[n / 3][n % 3];
        for (int a = 0; a < 3; a++)
            m.origin[a] = 1e4;
        assert_ok(cw_mesh_sample(&m, &v, NULL, &facts, &err), err);
        for (size_t n = 0; n < 4; n++) {
            const double world[3] = {1e4 + at[n][0], 1e4 + at[n][1], 1e4 + at[n][2]};
            assert_near((double)m.scalars[n], linear_at(world), 0.01);
        }
        assert_near((double)m.scalars[4], linear_at((const double[]){1e4, 1e4, 1e4}) + 1.5,
                    0.3);
        assert_int_equal(facts.missing, 1);
        for (long n = 0;; n++) {
            cwi_alloc_fail_after(n);
            const cw_status st = cw_mesh_sample(&m, &v, NULL, NULL, &err);
            if (!cwi_alloc_fail_after(-1))
                break;
            assert_fails(st, CW_ERR_NO_MEMORY, "no memory", err);
        }
        values[0] = NAN; /* a corner of every tetrahedron */
        assert_int_equal(cw_mesh_sample(&m, &v, NULL, NULL, &err), CW_ERR_EMPTY);
        cw_mesh_free(&m);
    }
}

static void threads_do_not_matter(void **state)
{
    (void)state;
    cw_volume ball = test_sample(CW_FIELD_SPHERE, 72, CW_F32),
              other = test_sample(CW_FIELD_GYROID, 40, CW_U8);
    cw_mesh one = test_extract(&ball, NULL, NULL), many = test_extract(&ball, NULL, NULL);
    cw_error err = {0};
    assert_ok(cw_mesh_sample(&one, &other, &(cw_sample_desc){.threads = 1}, NULL, &err), err);
    assert_ok(cw_mesh_sample(&many, &other, &(cw_sample_desc){.threads = 5}, NULL, &err), err);
    assert_true(one.vertex_count > 1 << 13);
    assert_memory_equal(one.scalars, many.scalars, one.vertex_count * sizeof *one.scalars);
    cw_mesh_free(&one);
    cw_mesh_free(&many);
    cw_volume_free(&ball);
    cw_volume_free(&other);
}

static void maps_run_from_low_to_high(void **state)
{
    (void)state;
    static const uint8_t ends[CW_COLORMAP_COUNT][2][3] = {
        {{0x44, 0x01, 0x54}, {0xfd, 0xe7, 0x25}},
        {{0x00, 0x00, 0x04}, {0xfc, 0xff, 0xa4}},
        {{0x3b, 0x4c, 0xc0}, {0xb4, 0x04, 0x26}},
        {{0, 0, 0}, {255, 255, 255}}};
    for (int map = 0; map < CW_COLORMAP_COUNT; map++) {
        uint8_t rgb[3], before[3];
        cw_colormap_color((cw_colormap)map, -3, rgb);
        assert_memory_equal(rgb, ends[map][0], 3);
        cw_colormap_color((cw_colormap)map, NAN, rgb);
        assert_memory_equal(rgb, ends[map][0], 3);
        cw_colormap_color((cw_colormap)map, 7, rgb);
        assert_memory_equal(rgb, ends[map][1], 3);
        cw_colormap_color((cw_colormap)map, 0, before);
        for (int n = 1; n <= 1000; n++) { /* no jumps */
            cw_colormap_color((cw_colormap)map, n / 1000.0, rgb);
            for (int a = 0; a < 3; a++)
                assert_true(abs(rgb[a] - before[a]) <= 2);
            memcpy(before, rgb, 3);
        }
        assert_non_null(cw_colormap_name((cw_colormap)map));
    }
    assert_null(cw_colormap_name((cw_colormap)CW_COLORMAP_COUNT));
    uint8_t half[3];
    cw_colormap_color(CW_COLORMAP_GRAY, 0.5, half);
    assert_int_equal(half[0], 128);
}

static void scalars_become_colours(void **state)
{
    (void)state;
    static const double at[][3] = {{1, 1, 1}, {2, 2, 2}, {3, 3, 3}};
    cw_volume v = make_linear(0);
    cw_mesh m = make_points(&v, at, 3);
    cw_error err = {0};
    m.scalars = cwi_alloc_array(3, sizeof *m.scalars);
    memcpy(m.scalars, (const float[3]){-10, 5, 30}, 12);
    assert_ok(cw_mesh_color(&m, CW_COLORMAP_GRAY, 0, 10, &err), err);
    static const uint8_t expected[12] = {0, 0, 0, 255, 128, 128, 128, 255, 255, 255, 255, 255};
    assert_memory_equal(m.colors, expected, 12);
    assert_ok(cw_mesh_color(&m, CW_COLORMAP_GRAY, 5, 5, &err), err);
    static const uint8_t step[12] = {0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255, 255};
    assert_memory_equal(m.colors, step, 12);
    cw_mesh_free(&m);
    cw_volume_free(&v);
}

static void what_cannot_be_coloured_is_named(void **state)
{
    (void)state;
    static const double inside[][3] = {{1, 1, 1}};
    cw_volume v = make_linear(0);
    cw_mesh m = make_points(&v, inside, 1);
    cw_error err;
    assert_fails(cw_mesh_color(&m, CW_COLORMAP_GRAY, 0, 1, &err), CW_ERR_ARGUMENT, "no scalars",
                 err);
    for (int far = 0; far < 2; far++) {
        m.origin[0] += far ? 1e6 : 0;
        assert_int_equal(cw_mesh_sample(&m, &v, NULL, NULL, &err), far ? CW_ERR_EMPTY : CW_OK);
    }
    assert_non_null(m.scalars); /* those of before */
    assert_fails(cw_mesh_color(&m, (cw_colormap)9, 0, 1, &err), CW_ERR_ARGUMENT, "map is 9",
                 err);
    assert_fails(cw_mesh_color(&m, CW_COLORMAP_GRAY, 2, 1, &err), CW_ERR_ARGUMENT, "low is 2",
                 err);
    assert_fails(cw_mesh_color(&m, CW_COLORMAP_GRAY, NAN, 1, &err), CW_ERR_ARGUMENT, "low is",
                 err);
    m.origin[0] -= 1e6;
    for (int n = 0; n < 2; n++) {
        cwi_alloc_fail_after(0);
        const cw_status st = n ? cw_mesh_color(&m, CW_COLORMAP_GRAY, 0, 1, &err)
                               : cw_mesh_sample(&m, &v, NULL, NULL, &err);
        assert_true(cwi_alloc_fail_after(-1));
        assert_fails(st, CW_ERR_NO_MEMORY, "no memory", err);
    }
    v.dim[0] = 0;
    assert_fails(cw_mesh_sample(&m, &v, NULL, NULL, &err), CW_ERR_ARGUMENT, "empty", err);
    v.dim[0] = 30;
    cw_mesh_free(&m);
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_are_those_of_the_world),
        cmocka_unit_test(samples_without_a_value_count_as_missing),
        cmocka_unit_test(cells_are_sampled),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(maps_run_from_low_to_high),
        cmocka_unit_test(scalars_become_colours),
        cmocka_unit_test(what_cannot_be_coloured_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
