/* Meshes edited in place: what is left is as it was. */
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/mesh/mesh.h"

#include <string.h>

/* A cube whose triangles share no vertices, with every array; vertex v of triangle t is the
 * cube's vertex in labels. */
static void make_soup(const cw_mesh *cube, cw_mesh *soup)
{
    cw_error err = {0};
    const size_t count = 3 * cube->triangle_count;
    assert_ok(cwi_mesh_alloc(soup, count, cube->triangle_count, true, &err), err);
    soup->colors = cwi_alloc_zeroed(count, 4);
    soup->scalars = cwi_alloc_array(count, sizeof *soup->scalars);
    soup->labels = cwi_alloc_array(count, sizeof *soup->labels);
    for (size_t c = 0; c < count; c++) {
        const size_t v = cube->triangles[c];
        memcpy(soup->positions + 3 * c, cube->positions + 3 * v, 3 * sizeof(float));
        memcpy(soup->normals + 3 * c, cube->normals + 3 * v, 3 * sizeof(float));
        soup->colors[4 * c] = (uint8_t)c;
        soup->scalars[c] = (float)c;
        soup->labels[c] = (uint32_t)v;
        soup->triangles[c] = (uint32_t)c;
    }
}

static void soup_becomes_a_closed_cube(void **state)
{
    (void)state;
    cw_mesh cube, soup;
    cw_error err = {0};
    cw_quality q;
    size_t merged;
    test_make_cube(&cube);
    make_soup(&cube, &soup);
    soup.positions[0] = -0.0f; /* at the same place as 0 */
    assert_ok(cw_mesh_weld(&soup, &merged, &err), err);
    assert_int_equal(merged, 28);
    assert_int_equal(soup.vertex_count, 8);
    assert_int_equal(soup.triangle_count, 12);
    assert_ok(cw_quality_measure(&soup, NULL, &q, &err), err);
    assert_true(cw_quality_is_closed_manifold(&q));
    for (size_t v = 0; v < 8; v++) {
        const size_t from = soup.labels[v];
        assert_memory_equal(soup.normals + 3 * v, cube.normals + 3 * from, 3 * sizeof(float));
        assert_int_equal(cube.triangles[(size_t)soup.scalars[v]], from); /* the first there */
        assert_int_equal(soup.colors[4 * v], (int)soup.scalars[v]);
    }
    assert_ok(cw_mesh_weld(&soup, &merged, &err), err);
    assert_int_equal(merged, 0);
    assert_int_equal(soup.vertex_count, 8);
    cw_mesh_free(&cube);
    cw_mesh_free(&soup);
}

/* A needle of two vertices at one place is no triangle any more; what was none before stays,
 * for others to count. */
static void triangles_that_collapse_are_left_out(void **state)
{
    (void)state;
    static const float points[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {7, 7, 7}};
    static const uint32_t triangles[4][3] = {{0, 1, 2}, {1, 3, 2}, {0, 3, 2}, {0, 0, 2}};
    cw_mesh mesh;
    cw_error err = {0};
    assert_ok(cwi_mesh_alloc(&mesh, 5, 4, false, &err), err);
    memcpy(mesh.positions, points, sizeof points);
    memcpy(mesh.triangles, triangles, sizeof triangles);
    assert_ok(cw_mesh_weld(&mesh, NULL, &err), err);
    assert_int_equal(mesh.vertex_count, 3);
    assert_int_equal(mesh.triangle_count, 2);
    static const uint32_t left[2][3] = {{0, 1, 2}, {0, 1, 2}};
    assert_memory_equal(mesh.triangles, left, sizeof left);
    cw_mesh_free(&mesh);
}

/* Two cubes of edge 1 and 3, far apart, and a triangle far from either. */
static void make_three(cw_mesh *mesh)
{
    cw_mesh cube;
    cw_error err = {0};
    test_make_cube(&cube);
    assert_ok(cwi_mesh_alloc(mesh, 20, 25, false, &err), err);
    mesh->labels = cwi_alloc_zeroed(20, sizeof *mesh->labels);
    for (size_t n = 0; n < 24; n++) {
        mesh->positions[n] = cube.positions[n];
        mesh->positions[24 + n] = 10 + 3 * cube.positions[n];
        mesh->labels[n / 3] = 1;
        mesh->labels[8 + n / 3] = 3;
    }
    for (size_t n = 0; n < 36; n++) {
        mesh->triangles[n] = 8 + cube.triangles[n];
        mesh->triangles[36 + n] = cube.triangles[n];
    }
    static const float triangle[4][3] = {{50, 0, 0}, {50, 4, 0}, {50, 0, 3}, {99, 99, 99}};
    static const uint32_t corners[3] = {16, 17, 18};
    memcpy(mesh->positions + 48, triangle, sizeof triangle);
    memcpy(mesh->triangles + 72, corners, sizeof corners);
    cw_mesh_free(&cube);
}

static void small_components_go_and_others_stay(void **state)
{
    (void)state;
    static const struct {
        double diagonal;
        size_t dropped, kept, vertices;
    } rows[] = {{0, 0, 3, 19}, {1.7, 0, 3, 19}, {1.8, 1, 2, 11},
                {5, 1, 2, 11}, {5.01, 2, 1, 8}, {6, 3, 0, 0}};
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        cw_mesh mesh;
        cw_error err = {0};
        cw_quality q;
        size_t dropped, kept;
        make_three(&mesh);
        assert_ok(cw_mesh_drop_components(&mesh, rows[r].diagonal, &dropped, &kept, &err), err);
        assert_int_equal(dropped, rows[r].dropped);
        assert_int_equal(kept, rows[r].kept);
        assert_int_equal(mesh.vertex_count, rows[r].vertices);
        assert_ok(cw_quality_measure(&mesh, NULL, &q, &err), err);
        assert_int_equal(q.components, kept);
        if (kept == 1)
            assert_true(cw_quality_is_closed_manifold(&q) && q.min[0] == 10);
        for (size_t v = 0; v < mesh.vertex_count; v++)
            assert_int_equal(mesh.labels[v], mesh.positions[3 * v] >= 50   ? 0
                                             : mesh.positions[3 * v] >= 10 ? 3
                                                                           : 1);
        cw_mesh_free(&mesh);
    }
}

/* Cubes of 1 and 27 mm3, and a flat triangle. */
static void components_that_enclose_little_go(void **state)
{
    (void)state;
    static const struct {
        double least;
        cw_drop_counts counts;
    } rows[] = {{0, {0, 3, 0, 0, 0, 0, 0}},    {1e-9, {1, 2, 1, 0, 0, 1, 0}},
                {1, {1, 2, 1, 0, 0, 1, 0}},    {1.001, {2, 1, 13, 1, 1, 27, 0}},
                {27, {2, 1, 13, 1, 1, 27, 0}}, {27.001, {3, 0, 25, 28, 27, 0, 0}}};
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        cw_mesh mesh;
        cw_error err = {0};
        cw_drop_counts counts;
        make_three(&mesh);
        assert_ok(cw_mesh_drop_volumes(&mesh, rows[r].least, &counts, &err), err);
        assert_int_equal(counts.dropped, rows[r].counts.dropped);
        assert_int_equal(counts.kept, rows[r].counts.kept);
        assert_int_equal(counts.triangles, rows[r].counts.triangles);
        assert_int_equal(mesh.triangle_count, 25 - counts.triangles);
        assert_within(counts.dropped_mm3, rows[r].counts.dropped_mm3, 1e-5);
        assert_within(counts.largest_mm3, rows[r].counts.largest_mm3, 1e-5);
        assert_within(counts.least_kept_mm3, rows[r].counts.least_kept_mm3, 1e-5);
        cw_mesh_free(&mesh);
    }
}

/* A cavity goes by what it encloses itself, and never stays without its solid. */
static void small_cavities_are_filled(void **state)
{
    (void)state;
    static const struct {
        double least;
        size_t triangles, cavities;
        bool is_open; /* then it is no cavity */
    } rows[] = {{1, 24, 0, false}, {1.5, 12, 1, false}, {28, 0, 1, false}, {28, 0, 0, true}};
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        cw_mesh mesh;
        cw_error err = {0};
        cw_drop_counts counts;
        make_three(&mesh);
        mesh.triangle_count = 24;
        for (size_t n = 0; n < 24; n++) /* the small cube into the large one, inside out */
            mesh.positions[n] += 11;
        for (size_t t = 12; t < 24; t++) {
            const uint32_t first = mesh.triangles[3 * t];
            mesh.triangles[3 * t] = mesh.triangles[3 * t + 1];
            mesh.triangles[3 * t + 1] = first;
        }
        mesh.triangle_count -= rows[r].is_open;
        assert_ok(cw_mesh_drop_volumes(&mesh, rows[r].least, &counts, &err), err);
        assert_int_equal(mesh.triangle_count, rows[r].triangles);
        assert_int_equal(counts.cavities, rows[r].cavities);
        cw_mesh_free(&mesh);
    }
}

/* A cube without one of its faces: the tetrahedra to its middle are 5/6 of it. */
static void open_components_count_up_to_their_middle(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_error err = {0};
    cw_drop_counts counts;
    test_make_cube(&mesh);
    mesh.triangle_count = 10;
    assert_ok(cw_mesh_drop_volumes(&mesh, 0.8, &counts, &err), err);
    assert_int_equal(counts.kept, 1);
    assert_within(counts.least_kept_mm3, 5.0 / 6, 1e-6);
    assert_ok(cw_mesh_drop_volumes(&mesh, 0.84, &counts, &err), err);
    assert_int_equal(mesh.triangle_count, 0);
    assert_int_equal(mesh.vertex_count, 0);
    cw_mesh_free(&mesh);
}

/* Of a cube of 1 mm3, one of 27 mm3 and a flat triangle those go that no vertex keeps. */
static void components_that_are_far_away_go(void **state)
{
    (void)state;
    for (int stays = 0; stays < 8; stays++) {
        cw_mesh mesh;
        cw_error err = {0};
        cw_drop_counts counts;
        float distance[20]; /* the last one is of a vertex in no triangle */
        double farthest, expected = 0, largest = 0;
        size_t dropped = 0;
        make_three(&mesh);
        distance[19] = 99;
        for (size_t v = 0; v < 19; v++) {
            const float x = mesh.positions[3 * v];
            const int part = x >= 50 ? 2 : x >= 10 ? 1 : 0;
            distance[v] = 5 + (float)v;
            if (stays >> part & 1 && v % 8 == 2)
                distance[v] = 4; /* one vertex is enough */
            if (!(stays >> part & 1))
                expected = distance[v] > expected ? distance[v] : expected;
        }
        for (int part = 0; part < 3; part++) {
            const double volume = part == 0 ? 1 : part == 1 ? 27 : 0;
            dropped += !(stays >> part & 1);
            if (!(stays >> part & 1))
                largest = volume > largest ? volume : largest;
        }
        assert_ok(cw_mesh_drop_distant(&mesh, distance, 4, &counts, &farthest, &err), err);
        assert_int_equal(counts.dropped, dropped);
        assert_int_equal(counts.kept, 3 - dropped);
        assert_within(counts.largest_mm3, largest, 1e-5);
        assert_true(farthest == expected);
        assert_int_equal(mesh.triangle_count,
                         12 * (stays & 1) + 12 * (stays >> 1 & 1) + (stays >> 2 & 1));
        assert_ok(cw_mesh_check(&mesh, &err), err);
        cw_mesh_free(&mesh);
    }
}

static void the_largest_components_stay(void **state)
{
    (void)state;
    for (size_t count = 1; count < 5; count++) {
        cw_mesh mesh;
        cw_drop_counts counts;
        cw_error err = {0};
        make_three(&mesh);
        assert_ok(cw_mesh_keep_largest(&mesh, count, count % 2 ? &counts : NULL, &err), err);
        assert_int_equal(mesh.triangle_count, count == 1 ? 12 : count == 2 ? 24 : 25);
        assert_int_equal(mesh.vertex_count, count == 1 ? 8 : count == 2 ? 16 : 19);
        assert_true(mesh.positions[0] >= 10 || count > 1);
        if (count == 1) {
            assert_int_equal(counts.kept, 1);
            assert_int_equal(counts.dropped, 2);
            assert_within(counts.least_kept_mm3, 27, 1e-5);
            assert_within(counts.largest_mm3, 1, 1e-5);
        }
        cw_mesh_free(&mesh);
    }
    cw_mesh mesh;
    cw_error err = {0};
    make_three(&mesh);
    assert_fails(cw_mesh_keep_largest(&mesh, 0, NULL, &err), CW_ERR_ARGUMENT, "count is 0",
                 err);
    for (long n = 0; n < 6; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st = cw_mesh_keep_largest(&mesh, 2, NULL, &err);
        cwi_alloc_fail_after(-1);
        assert_int_equal(st, CW_ERR_NO_MEMORY);
        assert_int_equal(mesh.triangle_count, 25);
    }
    cw_mesh_free(&mesh);
}

/* Turns the triangles of a mesh into any order. */
static void shuffle_triangles(cw_mesh *mesh, unsigned *seed)
{
    for (size_t t = mesh->triangle_count; t > 1; t--) {
        uint32_t swap[3];
        *seed = *seed * 1664525u + 1013904223u;
        const size_t other = (*seed >> 8) % t;
        memcpy(swap, mesh->triangles + 3 * other, sizeof swap);
        memcpy(mesh->triangles + 3 * other, mesh->triangles + 3 * (t - 1), sizeof swap);
        memcpy(mesh->triangles + 3 * (t - 1), swap, sizeof swap);
    }
}

/* Volumes are the same to the bit, whatever the order of triangles that enclose them. */
static void volumes_do_not_depend_on_the_order(void **state)
{
    (void)state;
    cw_drop_counts first, other;
    cw_error err = {0};
    unsigned seed = 1;
    for (int n = 0; n < 8; n++) {
        cw_mesh mesh;
        make_three(&mesh);
        for (size_t i = 0; i < 3 * mesh.vertex_count; i++)
            mesh.positions[i] = mesh.positions[i] * 0.1f + 1 / 3.0f + (float)(i % 7) / 77;
        if (n)
            shuffle_triangles(&mesh, &seed);
        assert_ok(cw_mesh_drop_volumes(&mesh, 0.01, n ? &other : &first, &err), err);
        assert_true(!n || memcmp(&first, &other, sizeof first) == 0);
        assert_int_equal(first.kept, 1);
        cw_mesh_free(&mesh);
    }
}

static void failures_leave_the_mesh_as_it_was(void **state)
{
    (void)state;
    cw_mesh cube, soup, empty = {0};
    cw_error err = {0};
    size_t merged = 9;
    test_make_cube(&cube);
    make_soup(&cube, &soup);
    for (long n = 0; n < 2; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st = cw_mesh_weld(&soup, NULL, &err);
        cwi_alloc_fail_after(-1);
        assert_int_equal(st, CW_ERR_NO_MEMORY);
        assert_int_equal(soup.vertex_count, 36);
    }
    const float near[36] = {0};
    for (long n = 0; n < 5; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st = cw_mesh_drop_distant(&soup, near, 1, NULL, NULL, &err);
        cwi_alloc_fail_after(-1);
        assert_int_equal(st, CW_ERR_NO_MEMORY);
        assert_int_equal(soup.vertex_count, 36);
    }
    assert_fails(cw_mesh_drop_distant(&soup, near, -1, NULL, NULL, &err), CW_ERR_ARGUMENT,
                 "limit_mm is -1", err);
    for (long n = 0; n < 4; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st = cw_mesh_drop_components(&soup, 9, NULL, NULL, &err);
        cwi_alloc_fail_after(-1);
        assert_int_equal(st, CW_ERR_NO_MEMORY);
        assert_int_equal(soup.vertex_count, 36);
    }
    assert_fails(cw_mesh_drop_components(&soup, -1, NULL, NULL, &err), CW_ERR_ARGUMENT, "-1",
                 err);
    assert_fails(cw_mesh_drop_volumes(&soup, -1, NULL, &err), CW_ERR_ARGUMENT,
                 "least_mm3 is -1", err);
    soup.triangles[4] = 36;
    assert_fails(cw_mesh_drop_components(&soup, 1, NULL, NULL, &err), CW_ERR_ARGUMENT,
                 "names vertex 36", err);
    assert_fails(cw_mesh_weld(&soup, NULL, &err), CW_ERR_ARGUMENT, "names vertex 36", err);
    assert_ok(cw_mesh_weld(&empty, &merged, &err), err);
    assert_int_equal(merged, 0);
    cw_mesh_free(&cube);
    cw_mesh_free(&soup);
}

static void copies_have_arrays_of_their_own(void **state)
{
    (void)state;
    cw_mesh cube, soup, copy, lone = {.vertex_count = 0};
    cw_error err = {0};
    test_make_cube(&cube);
    make_soup(&cube, &soup);
    soup.origin[1] = 4;
    for (long n = 0;; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st = cwi_mesh_copy(&soup, &copy, &err);
        const bool failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        assert_int_equal(copy.vertex_count, failed ? 0 : soup.vertex_count);
        if (!failed)
            break;
        assert_true(!copy.positions && !copy.labels && n < 6);
    }
    test_assert_same_mesh(&soup, &copy);
    assert_true(copy.positions != soup.positions && copy.origin[1] == 4);
    assert_memory_equal(copy.colors, soup.colors, 4 * soup.vertex_count);
    assert_memory_equal(copy.scalars, soup.scalars, sizeof(float) * soup.vertex_count);
    assert_memory_equal(copy.labels, soup.labels, sizeof(uint32_t) * soup.vertex_count);
    cw_mesh_free(&copy);
    assert_ok(cwi_mesh_copy(&lone, &copy, &err), err);
    cw_mesh_free(&copy);
    cw_mesh_free(&cube);
    cw_mesh_free(&soup);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(soup_becomes_a_closed_cube),
        cmocka_unit_test(triangles_that_collapse_are_left_out),
        cmocka_unit_test(small_components_go_and_others_stay),
        cmocka_unit_test(components_that_enclose_little_go),
        cmocka_unit_test(small_cavities_are_filled),
        cmocka_unit_test(open_components_count_up_to_their_middle),
        cmocka_unit_test(components_that_are_far_away_go),
        cmocka_unit_test(the_largest_components_stay),
        cmocka_unit_test(volumes_do_not_depend_on_the_order),
        cmocka_unit_test(failures_leave_the_mesh_as_it_was),
        cmocka_unit_test(copies_have_arrays_of_their_own),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
