/* How surfaces are computed: the same by any engine, in any number of threads and through any
 * strides; within limits, and stopped cleanly. */
#include "support/hostile.h"
#include "support/surface.h"

#include "core/base/memory.h"
#include "extract/dense/isa_dispatch.h"
#include "extract/extract_internal.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void any_number_of_threads_gives_the_same_bytes(void **state)
{
    (void)state;
    static const int threads[] = {2, 3, 8};
    const cw_field_desc desc = {
        .field = CW_FIELD_GYROID, .dim = {70, 41, 57}, .type = CW_I16, .noise = 1};
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_field_sample(&desc, &v, &err), err);
    for (int open = 0; open < 2; open++) {
        cw_extract_desc d = {.isovalue = 3, .threads = 1, .leave_open = open};
        cw_mesh one = test_extract(&v, &d, NULL);
        for (int n = 0; n < 3; n++) {
            d.threads = threads[n];
            cw_mesh many = test_extract(&v, &d, NULL);
            test_assert_same_mesh(&one, &many);
            cw_mesh_free(&many);
        }
        cw_mesh_free(&one);
    }
    cw_volume_free(&v);
}

/* Noise of both signs where there are two, with NaN and infinities in float types. */
static void fill(void *voxels, cw_type type, size_t count)
{
    for (size_t n = 0; n < count; n++) {
        const int r = rand() % 97, kind = rand() % 20;
        const double special = kind == 0   ? NAN
                               : kind == 1 ? INFINITY
                               : kind == 2 ? -(double)FLT_MAX
                                           : r - 48.25;
        const bool is_float = type == CW_F32 || type == CW_F64;
        const bool is_signed = type == CW_I8 || type == CW_I16 || type == CW_I32;
        test_store(type, voxels, n, is_float ? special : is_signed ? r - 48 : 2 * r);
    }
}

/* Every engine this machine can use against the plain one: rows of any length, that start
 * anywhere, of every type; no two with the same way to compare. */
static void every_engine_gives_the_same_bytes(void **state)
{
    (void)state;
    const size_t edge = test_is_short() ? 3 : 6;
    double *memory = malloc(sizeof *memory * (edge * edge * 200 + 8));
    test_seed(23);
    for (size_t width = 2; width <= 200; width++)
        for (int type = 0; type < CW_TYPE_COUNT; type++) {
            const size_t bytes = cw_type_size((cw_type)type), shift = (size_t)rand() % 8;
            char *voxels = (char *)memory + shift * bytes;
            fill(voxels, (cw_type)type, width * edge * edge);
            cw_volume v = {.data = voxels,
                           .type = (cw_type)type,
                           .dim = {width, edge, edge},
                           .affine = {{0.7}, {0, -1.3}, {0, 0, 2}},
                           .slope = rand() % 4 ? 1 : -1,
                           .has_nodata = rand() % 8 == 0,
                           .nodata = 7};
            if (rand() % 2)
                test_turn(&v, rand());
            const cw_extract_desc d = {.isovalue = rand() % 60 * v.slope,
                                       .inside_is_low = rand() % 2,
                                       .leave_open = rand() % 4 == 0,
                                       .cubic_placement = rand() % 4 == 0,
                                       .threads = 1};
            cw_mesh plain = {0}, other = {0};
            cw_error err = {0};
            assert_ok(cwi_extract_with(cwi_engine_at(0), &v, &d, &plain, NULL, &err), err);
            for (size_t e = 1; cwi_engine_at(e); e++) {
                assert_ok(cwi_extract_with(cwi_engine_at(e), &v, &d, &other, NULL, &err), err);
                test_assert_same_mesh(&plain, &other);
                cw_mesh_free(&other);
            }
            cw_mesh_free(&plain);
        }
    free(memory);
}

/* No-data, nobody knows where, sends every vertex through the code for one at a time. */
static void write_one_at_a_time(const cwi_bit_grid *grid, const cwi_row_span *span,
                                const cwi_row *rows, const cwi_emission *emission,
                                cwi_vertex_sink *sink, uint32_t *triangles)
{
    cwi_bit_grid g = *grid;
    g.volume.has_nodata = true;
    g.volume.nodata = 0.123; /* no voxel has it */
    cwi_engine_at(0)->write_span(&g, span, rows, emission, sink, triangles);
}

/* Positions are the same to the bit, normals to rounding. */
static void assert_as_good(const cw_mesh *a, const cw_mesh *b)
{
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->triangle_count, b->triangle_count);
    assert_memory_equal(a->positions, b->positions, 12 * b->vertex_count);
    assert_memory_equal(a->triangles, b->triangles, 12 * b->triangle_count);
    for (size_t n = 0; n < 3 * b->vertex_count; n++)
        assert_near(a->normals[n], b->normals[n], 1e-5);
}

/* On the border as inside. */
static void many_vertices_at_a_time_are_as_good_as_one(void **state)
{
    (void)state;
    for (int type = 0; type < CW_TYPE_COUNT; type++) {
        const cw_field_desc desc = {
            .field = CW_FIELD_GYROID, .dim = {37, 30, 41}, .type = (cw_type)type, .noise = 0.1};
        cw_volume v;
        cw_error err = {0};
        assert_ok(cw_field_sample(&desc, &v, &err), err);
        const cw_extract_desc d = {.isovalue =
                                       cw_field_stored(CW_FIELD_GYROID, (cw_type)type, 0.1)};
        test_turn(&v, type);
        cw_mesh many = test_extract(&v, &d, NULL);
        cwi_engine engine = *cwi_engine_at(0);
        engine.write_span = write_one_at_a_time;
        cw_mesh one = {0};
        assert_ok(cwi_extract_with(&engine, &v, &d, &one, NULL, &err), err);
        assert_as_good(&many, &one);
        cw_mesh_free(&many);
        cw_mesh_free(&one);
        cw_volume_free(&v);
    }
}

/* One at a time they have normals of the linear kind. */
static void so_they_are_on_cubics(void **state)
{
    (void)state;
    for (int type = 0; type < CW_TYPE_COUNT; type++) {
        const cw_field_desc desc = {
            .field = CW_FIELD_GYROID, .dim = {37, 30, 41}, .type = (cw_type)type, .noise = 0.3};
        cw_volume v;
        cw_error err = {0};
        assert_ok(cw_field_sample(&desc, &v, &err), err);
        const cw_extract_desc d = {.isovalue =
                                       cw_field_stored(CW_FIELD_GYROID, (cw_type)type, 0.1),
                                   .cubic_placement = true};
        test_turn(&v, type);
        cw_mesh many = test_extract(&v, &d, NULL), one = {0};
        cwi_engine engine = *cwi_engine_at(0);
        engine.write_span = write_one_at_a_time;
        assert_ok(cwi_extract_with(&engine, &v, &d, &one, NULL, &err), err);
        assert_int_equal(many.vertex_count, one.vertex_count);
        assert_memory_equal(many.positions, one.positions, 12 * one.vertex_count);
        cw_mesh_free(&many);
        cw_mesh_free(&one);
        cw_volume_free(&v);
    }
}

/* Integers with no-data, and the same numbers with NaN: all samples of a level, or those of the
 * leaves around it. */
static void no_data_is_as_nan(void **state)
{
    (void)state;
    static const size_t sizes[][3] = {{70, 9, 12}, {64, 20, 7}, {130, 8, 9}, {5, 40, 40}};
    test_seed(41);
    for (int round = 0; round < (test_is_short() ? 12 : 96); round++) {
        cw_volume v[2];
        cw_extractor *x;
        cw_error err = {0};
        size_t engines = 0;
        while (cwi_engine_at(engines))
            engines++;
        const cwi_engine *engine = cwi_engine_at((size_t)round % engines);
        const size_t *n = sizes[rand() % 4];
        const int few = 1 + rand() % 400, range = 3 + rand() % 60;
        for (int nan = 0; nan < 2; nan++)
            assert_ok(cw_volume_alloc(&v[nan], nan ? CW_F32 : CW_I16, n, 1, 1, &err), err);
        v[0].has_nodata = true;
        v[0].nodata = -9;
        for (size_t at = 0; at < n[0] * n[1] * n[2]; at++) {
            const bool none = rand() % few == 0;
            const int number = (int)(at % 9 * 7) + rand() % range;
            test_store(CW_I16, cw_volume_voxels(&v[0]), at, none ? -9 : number);
            test_store(CW_F32, cw_volume_voxels(&v[1]), at, none ? NAN : number);
        }
        assert_ok(cwi_extractor_new_with(engine, 0, &v[0], &x, &err), err);
        for (int again = 0; again < 4; again++) {
            const cw_extract_desc d = {.isovalue = 30.25 + again % 3,
                                       .inside_is_low = round & 8,
                                       .cubic_placement = round & 16,
                                       .leave_open = (round + again) % 3 == 0};
            cw_mesh a = {0}, b = {0};
            assert_ok(cw_extractor_extract(x, &d, &a, NULL, &err), err);
            assert_ok(cwi_extract_with(engine, &v[1], &d, &b, NULL, &err), err);
            assert_true(b.triangle_count > 0);
            assert_as_good(&a, &b);
            cw_mesh_free(&a);
            cw_mesh_free(&b);
        }
        cw_extractor_free(x);
        cw_volume_free(&v[0]);
        cw_volume_free(&v[1]);
    }
}

/* Where some voxel has no value vertices are numbered in another way. */
static void a_gap_elsewhere_changes_nothing_of_an_open_surface(void **state)
{
    (void)state;
    for (int round = 0; round < (test_is_short() ? 8 : 64); round++) {
        const cw_extract_desc d = {.isovalue = 0, .leave_open = true, .threads = 1 + round % 3};
        const cw_field_desc desc = {.field = CW_FIELD_GYROID,
                                    .dim = {60 + (size_t)round % 32 * 9, 13, 11},
                                    .type = round % 2 ? CW_F64 : CW_F32,
                                    .noise = round % 8};
        cw_volume v;
        cw_error err = {0};
        assert_ok(cw_field_sample(&desc, &v, &err), err);
        const size_t *n = v.dim, count = n[0] * n[1] * n[2];
        const size_t plane = n[0] * n[1];
        for (size_t at = 0; at < count; at++) /* nothing inside beside the last voxel */
            if (at % n[0] + 3 >= n[0] && at % plane + 3 * n[0] >= plane &&
                at + 3 * plane >= count)
                test_store(v.type, cw_volume_voxels(&v), at, -1);
        for (size_t e = 0; cwi_engine_at(e); e++) {
            cw_mesh whole = {0}, gap = {0};
            test_store(v.type, cw_volume_voxels(&v), count - 1, -1);
            assert_ok(cwi_extract_with(cwi_engine_at(e), &v, &d, &whole, NULL, &err), err);
            test_store(v.type, cw_volume_voxels(&v), count - 1, NAN);
            assert_ok(cwi_extract_with(cwi_engine_at(e), &v, &d, &gap, NULL, &err), err);
            assert_true(whole.triangle_count > 0);
            test_assert_same_mesh(&whole, &gap);
            cw_mesh_free(&whole);
            cw_mesh_free(&gap);
        }
        cw_volume_free(&v);
    }
}

/* The same voxels through other strides: transposed, then flipped. */
static void strides_are_honoured(void **state)
{
    (void)state;
    const cw_field_desc desc = {
        .field = CW_FIELD_CT_HEAD, .dim = {30, 24, 36}, .type = CW_I16, .noise = 30};
    cw_volume v, copy;
    cw_error err = {0};
    assert_ok(cw_field_sample(&desc, &v, &err), err);
    assert_ok(cw_volume_alloc(&copy, CW_I16, (size_t[3]){36, 30, 24}, 1, 1, &err), err);
    memcpy(copy.affine, v.affine, sizeof v.affine);
    int16_t *to = cw_volume_voxels(&copy);
    for (size_t k = 0; k < 36; k++) /* z fastest and backwards, then x, then y */
        for (size_t j = 0; j < 24; j++)
            for (size_t i = 0; i < 30; i++)
                to[(35 - k) + 36 * (i + 30 * j)] = (int16_t)cw_volume_value(&v, i, j, k);
    cw_volume view = copy;
    memcpy(view.dim, v.dim, sizeof v.dim);
    view.stride[0] = 72;
    view.stride[1] = 72 * 30;
    view.stride[2] = -2;
    view.data = to + 35;
    const cw_extract_desc d = {.isovalue = 300};
    cw_mesh a = test_extract(&v, &d, NULL), b = test_extract(&view, &d, NULL);
    test_assert_same_mesh(&a, &b);
    cw_mesh_free(&a);
    cw_mesh_free(&b);
    cw_volume_free(&v);
    cw_volume_free(&copy);
}

static void unusable_arguments_are_refused_by_name(void **state)
{
    (void)state;
    static const uint8_t voxels[8];
    cw_volume v = {.data = voxels, .dim = {2, 2, 2}};
    cw_mesh mesh = {0};
    cw_error err = {0};
    assert_fails(cw_extract(&v, &(cw_extract_desc){.isovalue = NAN}, &mesh, NULL, &err),
                 CW_ERR_ARGUMENT, "isovalue", err);
    v.dim[2] = 1;
    assert_fails(cw_extract(&v, NULL, &mesh, NULL, &err), CW_ERR_ARGUMENT, "along z", err);
    v.data = NULL;
    assert_fails(cw_extract(&v, NULL, &mesh, NULL, &err), CW_ERR_ARGUMENT, "no voxels", err);
    static const double spacings[] = {1e-39, 1e-90, 1e38, 1e90};
    for (size_t n = 0; n < sizeof spacings / sizeof *spacings; n++) {
        v = (cw_volume){.data = voxels, .dim = {2, 2, 2}, .affine = {{1}, {0, 1}, {0, 0, 1}}};
        v.affine[1][1] = spacings[n];
        assert_fails(cw_extract(&v, NULL, &mesh, NULL, &err), CW_ERR_ARGUMENT, "along y", err);
    }
}

static void limits_stop_before_the_mesh_is_made(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_SPHERE, 32, CW_F32);
    cw_mesh mesh = {0};
    cw_error err = {0};
    cw_extract_counts counts, made, bare;
    assert_ok(cw_extract_predict(&v, NULL, &counts, &err), err);
    assert_ok(cw_extract_predict(&v, &(cw_extract_desc){.no_normals = true}, &bare, &err), err);
    assert_int_equal(counts.bytes - bare.bytes, counts.vertices * 3 * sizeof(float));
    mesh = test_extract(&v, NULL, &made);
    assert_int_equal(counts.triangles, mesh.triangle_count);
    assert_int_equal(counts.vertices, mesh.vertex_count);
    assert_int_equal(counts.bytes, made.bytes);
    cw_mesh_free(&mesh);
    cw_extract_desc d = {.max_triangles = counts.triangles};
    mesh = test_extract(&v, &d, NULL);
    cw_mesh_free(&mesh);
    d.max_triangles--;
    assert_fails(cw_extract(&v, &d, &mesh, NULL, &err), CW_ERR_LIMIT, "triangles", err);
    assert_null(mesh.positions);
    d = (cw_extract_desc){.max_bytes = counts.bytes - 1};
    assert_fails(cw_extract(&v, &d, &mesh, NULL, &err), CW_ERR_LIMIT,
                 "are left (desc->max_bytes)", err);
    d = (cw_extract_desc){.max_bytes = counts.bytes + 60 * counts.triangles, .extra_bytes = 60};
    mesh = test_extract(&v, &d, NULL);
    cw_mesh_free(&mesh);
    d.extra_bytes++;
    assert_fails(cw_extract(&v, &d, &mesh, NULL, &err), CW_ERR_LIMIT, "checks included", err);
    cw_volume_free(&v);
}

static void it_can_be_cancelled_at_any_poll(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_SPHERE, 40, CW_F32);
    cw_mesh mesh = {0};
    cw_error err = {0};
    for (int polls = 0;; polls++) {
        int left = polls;
        const cw_extract_desc d = {.progress = {test_stop_after, &left}};
        const cw_status st = cw_extract(&v, &d, &mesh, NULL, &err);
        if (st == CW_OK)
            break;
        assert_int_equal(st, CW_ERR_CANCELLED);
        assert_null(mesh.positions);
        assert_true(polls < 100);
    }
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

static void run_out_of_memory(float corner)
{
    const float voxels[27] = {[0] = corner, [13] = 1};
    const cw_volume v = {.data = voxels, .type = CW_F32, .dim = {3, 3, 3}};
    const cw_extract_desc d = {.isovalue = 0.5f, .leave_open = true};
    cw_mesh mesh = {0};
    cw_error err = {0};
    for (long n = 0;; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st = cw_extract(&v, &d, &mesh, NULL, &err);
        if (!cwi_alloc_fail_after(-1)) {
            assert_int_equal(st, CW_OK);
            assert_true(n >= 6);
            break;
        }
        assert_int_equal(st, CW_ERR_NO_MEMORY);
        assert_null(mesh.positions);
    }
    cw_mesh_free(&mesh);
}

static void memory_running_out_is_an_error_at_every_allocation(void **state)
{
    (void)state;
    run_out_of_memory(0);
    run_out_of_memory(NAN); /* where there are values has to be found out */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_number_of_threads_gives_the_same_bytes),
        cmocka_unit_test(every_engine_gives_the_same_bytes),
        cmocka_unit_test(many_vertices_at_a_time_are_as_good_as_one),
        cmocka_unit_test(so_they_are_on_cubics),
        cmocka_unit_test(no_data_is_as_nan),
        cmocka_unit_test(a_gap_elsewhere_changes_nothing_of_an_open_surface),
        cmocka_unit_test(strides_are_honoured),
        cmocka_unit_test(unusable_arguments_are_refused_by_name),
        cmocka_unit_test(limits_stop_before_the_mesh_is_made),
        cmocka_unit_test(it_can_be_cancelled_at_any_poll),
        cmocka_unit_test(memory_running_out_is_an_error_at_every_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
