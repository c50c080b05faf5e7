/* Irregular grids: threads, slabs, errors, cancelling, and extremes. */
#include "support/irregular_cases.h"

/* --- calls ------------------------------------------------------------------------------- */

static void threads_do_not_change_a_byte(void **state)
{
    (void)state;
    test_seed(10);
    for (int round = 0; round < test_some(6); round++) {
        test_grid g;
        test_grid_make(&g, TEST_MIXED, 22, 0.2);
        fill_with_noise(&g, round);
        cw_mesh one = test_extract(&g.volume, &(cw_extract_desc){.threads = 1}, NULL),
                three = test_extract(&g.volume, &(cw_extract_desc){.threads = 3}, NULL);
        test_assert_same_mesh(&one, &three);
        cw_mesh_free(&one);
        cw_mesh_free(&three);
        test_grid_free(&g);
    }
}

static cw_status take_whole(void *user, const cw_slab *slab, cw_error *err)
{
    const cw_mesh *whole = user;
    (void)err;
    assert_true(slab->last && slab->low < -1e300 && slab->high > 1e300);
    assert_int_equal(slab->triangles, whole->triangle_count);
    assert_int_equal(slab->mesh->triangle_count, whole->triangle_count);
    assert_memory_equal(slab->mesh->triangles, whole->triangles, 12 * whole->triangle_count);
    for (size_t v = 0; v < slab->mesh->vertex_count; v++)
        assert_int_equal(slab->seam[v], 0);
    return CW_OK;
}

/* One slab holds the whole surface; an extractor makes it again. */
static void slabs_and_extractors_give_the_same(void **state)
{
    (void)state;
    test_grid g;
    cw_extractor *e;
    cw_error err = {0};
    cw_mesh again = {0};
    cw_extract_counts counts, predicted;
    test_grid_make(&g, TEST_MIXED, 10, 0.2);
    test_grid_fill(&g, slope);
    cw_mesh m = test_extract(&g.volume, NULL, &counts);
    assert_true(m.triangle_count > 0);
    assert_ok(cw_extract_slabs(&g.volume, NULL, 10, (cw_slab_sink){take_whole, &m}, NULL, &err),
              err);
    assert_ok(cw_extractor_new(&g.volume, &e, &err), err);
    for (int n = 0; n < 2; n++) {
        assert_ok(cw_extractor_predict(e, NULL, &predicted, &err), err);
        assert_memory_equal(&predicted, &counts, sizeof counts);
        assert_ok(cw_extractor_extract(e, NULL, &again, NULL, &err), err);
        test_assert_same_mesh(&m, &again);
        cw_mesh_free(&again);
    }
    cw_extractor_free(e);
    cw_mesh_free(&m);
    test_grid_free(&g);
}

static void what_is_wrong_is_named(void **state)
{
    (void)state;
    test_grid g;
    cw_error err = {0};
    cw_mesh m = {0};
    test_grid_make(&g, TEST_MIXED, 10, 0);
    test_grid_fill(&g, sphere);
#define FAILS(desc, status, words)                                                             \
    assert_fails(cw_extract(&g.volume, &(cw_extract_desc)desc, &m, NULL, &err), status, words, \
                 err)
    FAILS({.snap = 0.3}, CW_ERR_UNSUPPORTED, "snap on an irregular grid");
    FAILS({.cubic_placement = true}, CW_ERR_UNSUPPORTED, "cubic");
    FAILS({.isovalue = NAN}, CW_ERR_ARGUMENT, "isovalue");
    FAILS({.max_triangles = 5}, CW_ERR_LIMIT, "triangles; the limit is 5");
    FAILS({.max_bytes = 500}, CW_ERR_LIMIT, "500 bytes are left");
    uint32_t *corner = test_grid_corners(&g, 20) + 3;
    const uint32_t own = *corner;
    *corner = (uint32_t)g.samples;
    FAILS({0}, CW_ERR_ARGUMENT, "cell 20 has a corner at sample");
    *corner = own;
    const uint8_t shape = g.shapes[30];
    g.shapes[30] = 4;
    FAILS({0}, CW_ERR_ARGUMENT, "cell 30 has shape 4");
    g.shapes[30] = shape;
    const double x = g.points[3 * 17];
    g.points[3 * 17] = INFINITY;
    FAILS({0}, CW_ERR_ARGUMENT, "sample 17 is not finite");
    g.points[3 * 17] = 1e300;
    FAILS({0}, CW_ERR_ARGUMENT, "beyond what positions can hold");
    g.points[3 * 17] = x;
    g.volume.affine[0][0] = g.volume.affine[1][1] = g.volume.affine[2][2] = 1e-60;
    FAILS({0}, CW_ERR_ARGUMENT, "beyond what positions can hold");
    g.volume.affine[0][0] = g.volume.affine[1][1] = g.volume.affine[2][2] = 1;
    m = test_extract(&g.volume, NULL, NULL);
    assert_fails(cw_extract_normals(&g.volume, NULL, &m, &err), CW_ERR_UNSUPPORTED,
                 "irregular grid", err);
    cw_mesh_free(&m);
    g.cells.count = 0;
    m = test_extract(&g.volume, NULL, NULL);
    assert_int_equal(m.vertex_count, 0);
    test_grid_free(&g);
}

static void it_can_be_stopped_anywhere(void **state)
{
    (void)state;
    test_grid g;
    cw_error err = {0};
    cw_mesh m = {0};
    cw_status st = CW_ERR_CANCELLED;
    test_grid_make(&g, TEST_MIXED, 10, 0);
    test_grid_fill(&g, slope);
    int polls = 0;
    for (int n = 0; st == CW_ERR_CANCELLED; n++) {
        polls = n;
        const cw_extract_desc desc = {.progress = {test_stop_after, &polls}};
        st = cw_extract(&g.volume, &desc, &m, NULL, &err);
        assert_true(n < 200 && (st == CW_OK) == (m.triangles != NULL));
    }
    assert_ok(st, err);
    cw_mesh_free(&m);
    st = CW_ERR_NO_MEMORY;
    for (long n = 0; st == CW_ERR_NO_MEMORY; n++) {
        cwi_alloc_fail_after(n);
        st = cw_extract(&g.volume, &(cw_extract_desc){.threads = 1}, &m, NULL, &err);
        cwi_alloc_fail_after(-1);
        assert_true(n < 200 && (st == CW_OK) == (m.triangles != NULL));
    }
    assert_ok(st, err);
    cw_mesh_free(&m);
    test_grid_free(&g);
}

/* Values of any size, and infinite ones, make no bad number; so do cells of no volume. */
static void extremes_stay_finite(void **state)
{
    (void)state;
    test_seed(11);
    const double scales[] = {1e-320, 1e-160, 1, 1e160, 1.7e308};
    for (size_t s = 0; s < sizeof scales / sizeof *scales; s++)
        for (int round = 0; round < 4; round++) {
            test_grid g;
            test_grid_make(&g, TEST_MIXED, 6, 0.1);
            for (size_t n = 0; n < g.samples; n++)
                g.values[n] = round & 1 && rand() % 4 == 0 ? (rand() % 2 ? INFINITY : -INFINITY)
                                                           : random_number(-1, 1) * scales[s];
            if (round & 2)
                for (size_t n = 0; n < g.samples; n++)
                    g.points[3 * n + 2] = 0;
            cw_quality q;
            cw_mesh m = test_extract(&g.volume, NULL, NULL);
            cw_error err = {0};
            assert_ok(cw_mesh_check(&m, &err), err);
            assert_ok(cw_quality_measure(&m, NULL, &q, &err), err);
            assert_true(cw_quality_is_closed_manifold(&q));
            for (size_t v = 0; v < m.vertex_count; v++) {
                const float *n = m.normals + 3 * v;
                assert_near((double)(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), 1, 1e-5);
            }
            cw_mesh_free(&m);
            test_grid_free(&g);
        }
}

/* Cells between samples at random overlap in every way: no promise holds, but nothing breaks,
 * and all is made that was counted. */
static void any_cells_give_a_mesh(void **state)
{
    (void)state;
    test_seed(13);
    for (int round = 0; round < 400; round++) {
        test_grid g = {0};
        const size_t samples = 4 + (size_t)rand() % 20;
        for (size_t n = 0; n < samples; n++)
            test_grid_sample(&g, rand() % 4, rand() % 4, rand() % 4);
        for (int n = rand() % 60; n >= 0; n--) {
            uint32_t corners[8];
            for (int c = 0; c < 8; c++)
                corners[c] = (uint32_t)((size_t)rand() % samples);
            test_grid_cell(&g, (cw_shape)(rand() % CW_SHAPE_COUNT), corners);
        }
        fill_with_noise(&g, round % 2);
        for (int open = 0; open < 2; open++) {
            cw_quality q;
            cw_error err = {0};
            cw_extract_counts counts;
            cw_mesh m =
                test_extract(&g.volume, &(cw_extract_desc){.leave_open = open}, &counts);
            assert_ok(cw_mesh_check(&m, &err), err);
            assert_ok(cw_quality_measure(&m, NULL, &q, &err), err);
            assert_int_equal(m.triangle_count, counts.triangles);
            assert_int_equal(q.unused_vertices, 0);
            if (!open)
                assert_int_equal(q.open_edges, 0);
            cw_mesh_free(&m);
        }
        test_grid_free(&g);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(threads_do_not_change_a_byte),
        cmocka_unit_test(slabs_and_extractors_give_the_same),
        cmocka_unit_test(what_is_wrong_is_named),
        cmocka_unit_test(it_can_be_stopped_anywhere),
        cmocka_unit_test(extremes_stay_finite),
        cmocka_unit_test(any_cells_give_a_mesh),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
