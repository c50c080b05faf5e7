/* Self-intersections: against CGAL on triangles that touch in every way, and at the limits. */
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/geometry/triangle_intersect.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static uint32_t next(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return *seed >> 8;
}

static void alloc_mesh(cw_mesh *mesh, size_t vertices, size_t triangles)
{
    *mesh = (cw_mesh){.vertex_count = vertices, .triangle_count = triangles};
    mesh->positions = calloc(vertices, 3 * sizeof *mesh->positions);
    mesh->triangles = calloc(triangles, 3 * sizeof *mesh->triangles);
    assert_true(mesh->positions && mesh->triangles);
}

/* Triangles that share nothing but, often, places: small whole coordinates times a scale. */
static void scatter(cw_mesh *mesh, size_t count, uint32_t size, float scale, uint32_t seed)
{
    alloc_mesh(mesh, 3 * count, count);
    for (size_t i = 0; i < 9 * count; i++)
        mesh->positions[i] = scale * (float)(next(&seed) % size);
    for (uint32_t i = 0; i < 3 * count; i++)
        mesh->triangles[i] = i;
}

/* A sheet of n x n vertices at whole coordinates, crumpled. */
static void crumple(cw_mesh *mesh, uint32_t n, uint32_t size, uint32_t seed)
{
    alloc_mesh(mesh, n * n, 2 * (n - 1) * (n - 1));
    uint32_t *t = mesh->triangles;
    for (uint32_t v = 0; v < n * n; v++) {
        const uint32_t base[3] = {v % n, v / n, 0};
        for (int a = 0; a < 3; a++)
            mesh->positions[3 * v + (uint32_t)a] = (float)(base[a] + next(&seed) % size);
    }
    for (uint32_t j = 0; j + 1 < n; j++)
        for (uint32_t i = 0; i + 1 < n; i++, t += 6) {
            const uint32_t v = j * n + i;
            const uint32_t six[6] = {v, v + 1, v + n + 1, v, v + n + 1, v + n};
            memcpy(t, six, sizeof six);
        }
}

static cw_crossings find(const cw_mesh *mesh, int threads)
{
    cw_crossings x;
    cw_error err = {0};
    assert_ok(cw_self_intersections(mesh, &(cw_crossings_desc){.threads = threads}, &x, &err),
              err);
    return x;
}

/* Returns how many pairs there are. */
static size_t compare_with_cgal(cw_mesh *mesh, int round)
{
    cw_cgal_facts facts;
    cw_error err = {0};
    cw_crossings x = find(mesh, 0);
    assert_ok(cw_quality_ask_cgal(mesh, CW_WELD_NONE, &facts, &err), err);
    assert_true(facts.is_polygon_mesh);
    if (x.count != facts.self_intersections)
        fail_msg("round %d: %zu pairs, CGAL has %zu", round, x.count, facts.self_intersections);
    const size_t count = x.count;
    cw_crossings_free(&x);
    cw_mesh_free(mesh);
    return count;
}

static void cgal_counts_the_same_pairs(void **state)
{
    (void)state;
    size_t found = 0;
    if (!cw_quality_has_cgal())
        skip();
    for (int round = 0; round < 60; round++) {
        cw_mesh mesh;
        const float scales[4] = {1, 0.1f, 1e-20f, 1e15f};
        scatter(&mesh, 300, 3 + (uint32_t)round % 20, scales[round % 4], (uint32_t)round);
        found += compare_with_cgal(&mesh, round);
        crumple(&mesh, 24, 2 + (uint32_t)round % 4, (uint32_t)round);
        found += compare_with_cgal(&mesh, round);
    }
    assert_true(found > 100000);
}

/* Fans of 600 needles each around vertices of their own, some in one place, their rims crumpled; and
 * triangles that lie anywhere. Some triangles have two hubs. */
static void make_fans(cw_mesh *mesh, uint32_t fans, uint32_t others, uint32_t size,
                      uint32_t seed)
{
    const uint32_t rim = 600, loose = fans * (rim + 1);
    alloc_mesh(mesh, loose + 3 * others, fans * rim + others);
    for (uint32_t i = 0; i < 3 * mesh->vertex_count; i++)
        mesh->positions[i] = (float)(next(&seed) % size);
    uint32_t *t = mesh->triangles;
    for (uint32_t f = 0; f < fans; f++) {
        const uint32_t hub = f * (rim + 1);
        for (uint32_t n = 0; n < rim; n++, t += 3) {
            const float angle = 0.0104719755f * (float)n;
            float *p = mesh->positions + 3 * (size_t)(hub + 1 + n);
            p[0] += (float)size * (2 + cosf(angle));
            p[1] += (float)size * (2 + sinf(angle));
            t[0] = hub;
            t[1] = hub + 1 + n;
            t[2] = n % 50 ? hub + 1 + (n + 1) % rim : (hub + rim + 1) % loose;
        }
    }
    for (uint32_t n = 0; n < 3 * others; n++)
        *t++ = n % 7 ? loose + n : n % loose;
}

/* Finds all pairs by looking at each, without boxes or doubts. Returns their number. */
static size_t list_all_pairs(const cw_mesh *mesh, uint32_t *pairs, size_t capacity)
{
    size_t count = 0;
    for (uint32_t a = 0; a < mesh->triangle_count; a++)
        for (uint32_t b = a + 1; b < mesh->triangle_count; b++) {
            const uint32_t *x = mesh->triangles + 3 * (size_t)a,
                           *y = mesh->triangles + 3 * (size_t)b;
            if (!cwi_has_area(mesh->positions, x) || !cwi_has_area(mesh->positions, y) ||
                !cwi_triangles_meet(mesh->positions, x, y))
                continue;
            if (count < capacity) {
                pairs[2 * count] = a;
                pairs[2 * count + 1] = b;
            }
            count++;
        }
    return count;
}

static size_t count_all_pairs(const cw_mesh *mesh)
{
    return list_all_pairs(mesh, NULL, 0);
}

static void wide_fans_are_searched_in_full(void **state)
{
    (void)state;
    const uint32_t sizes[4] = {2, 5, 40, 1000};
    for (uint32_t round = 0; round < 4; round++) {
        cw_mesh mesh;
        make_fans(&mesh, 1 + round, 200, sizes[round], round);
        cw_crossings x = find(&mesh, 2);
        assert_false(x.undecided);
        assert_true(x.count > 1000);
        assert_int_equal(x.count, count_all_pairs(&mesh));
        cw_crossings_free(&x);
        cw_mesh_free(&mesh);
    }
}

/* Returns how many pairs there are, and makes sure that they are those found one by one. */
static size_t compare_with_all_pairs(const cw_mesh *mesh, const char *what, uint32_t round)
{
    cw_crossings x = find(mesh, 1 + (int)round % 3);
    const size_t count = x.count;
    uint32_t *pairs = calloc(count + 1, 2 * sizeof *pairs);
    assert_non_null(pairs);
    assert_false(x.undecided);
    const size_t all = list_all_pairs(mesh, pairs, count);
    if (all != count || memcmp(pairs, x.pairs, 2 * count * sizeof *pairs) != 0)
        fail_msg("%s, round %u: %zu pairs, %zu one by one", what, round, count, all);
    free(pairs);
    cw_crossings_free(&x);
    return count;
}

/* Triangles over few vertices, so that many share one, two or three of them. */
static void share_vertices(cw_mesh *mesh, uint32_t vertices, size_t count, uint32_t size,
                           uint32_t seed)
{
    alloc_mesh(mesh, vertices, count);
    for (size_t i = 0; i < 3 * (size_t)vertices; i++)
        mesh->positions[i] = (float)(next(&seed) % size);
    for (size_t t = 0; t < count; t++) {
        uint32_t *v = mesh->triangles + 3 * t;
        v[0] = next(&seed) % vertices;
        v[1] = (v[0] + 1 + next(&seed) % 5) % vertices;
        v[2] = (v[1] + 1 + next(&seed) % 5) % vertices;
    }
}

/* Moves coordinates by none to three units in their last place, which makes and breaks ties. */
static void nudge(cw_mesh *mesh, uint32_t seed)
{
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        for (uint32_t n = next(&seed) % 4; n > 0; n--)
            mesh->positions[i] =
                nextafterf(mesh->positions[i], next(&seed) % 2 ? INFINITY : -INFINITY);
}

/* Puts the mesh at other places and scales: the pairs there are found one by one again, as its
 * coordinates are rounded. */
static size_t compare_in_frames(cw_mesh *mesh, const char *what, uint32_t round)
{
    static const float frames[][2] = {/* scale, offset */
                                      {1, 0},       {1e-4f, 0},  {1e4f, 0},   {0.37f, 5e6f},
                                      {1e-3f, -90}, {1e-14f, 0}, {1e-30f, 0}, {1e30f, 1e33f}};
    const size_t size = 3 * mesh->vertex_count;
    float *kept = malloc(size * sizeof *kept);
    size_t found = 0;
    assert_non_null(kept);
    memcpy(kept, mesh->positions, size * sizeof *kept);
    for (size_t f = 0; f < sizeof frames / sizeof *frames; f++) {
        for (size_t i = 0; i < size; i++)
            mesh->positions[i] = frames[f][0] * kept[i] + frames[f][1];
        found += compare_with_all_pairs(mesh, what, round);
        nudge(mesh, round);
        found += compare_with_all_pairs(mesh, what, round);
    }
    free(kept);
    cw_mesh_free(mesh);
    return found;
}

static void all_pairs_are_found_and_no_others(void **state)
{
    (void)state;
    size_t found = 0;
    const uint32_t rounds = test_is_short() ? 4 : 20;
    for (uint32_t round = 0; round < rounds; round++) {
        cw_mesh mesh;
        scatter(&mesh, 150, 2 + 3 * (round % 7), 1, round);
        found += compare_in_frames(&mesh, "scattered", round);
        share_vertices(&mesh, 60 + 20 * round, 200, 2 + 2 * (round % 6), round);
        found += compare_in_frames(&mesh, "shared vertices", round);
        crumple(&mesh, 11, 1 + round % 4, round);
        found += compare_in_frames(&mesh, "crumpled", round);
        crumple(&mesh, 11, 1 + round % 4, round);
        for (size_t v = 0; v < mesh.vertex_count; v++) /* in a plane that no axis lies in */
            mesh.positions[3 * v + 2] = mesh.positions[3 * v] + 2 * mesh.positions[3 * v + 1];
        found += compare_in_frames(&mesh, "flat", round);
    }
    assert_true(found > 10000);
}

/* Two cones of one rim: boxes of their needles overlap nearly all, and none of them meet. */
static void a_cone_of_needles_has_none(void **state)
{
    (void)state;
    const uint32_t rim = 6000;
    cw_mesh mesh;
    alloc_mesh(&mesh, rim + 2, 2 * rim);
    mesh.positions[3 * rim + 2] = 1;
    for (uint32_t n = 0; n < rim; n++) {
        const double angle = 6.283185307179586 * n / rim;
        mesh.positions[3 * n] = (float)cos(angle);
        mesh.positions[3 * n + 1] = (float)sin(angle);
        const uint32_t next_one = (n + 1) % rim,
                       two[6] = {rim, n, next_one, rim + 1, next_one, n};
        memcpy(mesh.triangles + 6 * (size_t)n, two, sizeof two);
    }
    cw_crossings x = find(&mesh, 0);
    assert_false(x.undecided);
    assert_int_equal(x.count, 0);
    cw_crossings_free(&x);
    cw_mesh_free(&mesh);
}

static void an_extracted_surface_has_none(void **state)
{
    (void)state;
    cw_volume volume = test_sample(CW_FIELD_GYROID, 40, CW_F32);
    cw_mesh mesh = test_extract(&volume, &(cw_extract_desc){.isovalue = 0}, NULL);
    cw_crossings x = find(&mesh, 0);
    assert_int_equal(x.count, 0);
    assert_false(x.undecided);
    cw_crossings_free(&x);
    cw_volume_free(&volume);
    cw_mesh_free(&mesh);
}

static void threads_change_nothing(void **state)
{
    (void)state;
    cw_mesh mesh;
    scatter(&mesh, test_is_short() ? 500 : 3000, test_is_short() ? 30 : 60, 1, 7);
    cw_crossings one = find(&mesh, 1), three = find(&mesh, 3);
    assert_true(one.count > 100);
    assert_int_equal(one.count, three.count);
    assert_memory_equal(one.pairs, three.pairs, 2 * one.count * sizeof *one.pairs);
    for (size_t n = 0; n < one.count; n++) {
        const uint32_t *p = one.pairs + 2 * n;
        assert_true(p[0] < p[1] && p[1] < mesh.triangle_count);
        assert_true(n == 0 || p[-2] < p[0] || (p[-2] == p[0] && p[-1] < p[1]));
    }
    cw_crossings_free(&one);
    cw_crossings_free(&three);
    cw_mesh_free(&mesh);
}

/* Long slivers side by side along a diagonal: every box meets every other one. */
static void a_heap_of_slivers_is_given_up_in_time(void **state)
{
    (void)state;
    cw_mesh mesh;
    const uint32_t count = 10000;
    alloc_mesh(&mesh, 3 * count, count);
    for (uint32_t t = 0; t < count; t++) {
        const float at = (float)t * 1e-6f;
        const float corners[9] = {at, 0, 0, at + 1, 1, 1, at + 1, 1.001f, 1};
        memcpy(mesh.positions + 9 * t, corners, sizeof corners);
        for (uint32_t c = 0; c < 3; c++)
            mesh.triangles[3 * t + c] = 3 * t + c;
    }
    cw_crossings x = find(&mesh, 0);
    assert_true(x.undecided);
    cw_crossings_free(&x);
    cw_mesh_free(&mesh);
}

static void triangles_without_area_and_empty_meshes_have_none(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_crossings x = find(&mesh, 0);
    assert_int_equal(x.count, 0);
    cw_crossings_free(&x);
    alloc_mesh(&mesh, 3, 1000); /* all in one point */
    x = find(&mesh, 0);
    assert_int_equal(x.count, 0);
    cw_crossings_free(&x);
    cw_mesh_free(&mesh);
}

static void memory_running_out_and_cancelling_are_errors(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_crossings x;
    cw_error err = {0};
    int polls = 0;
    scatter(&mesh, 100, 4, 1, 3);
    for (long n = 0;; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st = cw_self_intersections(
            &mesh, &(cw_crossings_desc){.weld = CW_WELD_WORLD, .threads = 1}, &x, &err);
        const bool failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        cw_crossings_free(&x);
        if (!failed)
            break;
    }
    const cw_crossings_desc stop = {.progress = {test_stop_after, &polls}};
    assert_fails(cw_self_intersections(&mesh, &stop, &x, &err), CW_ERR_CANCELLED, "", err);
    mesh.triangles[4] = 300;
    assert_fails(cw_self_intersections(&mesh, NULL, &x, &err), CW_ERR_ARGUMENT,
                 "triangle 1 names vertex 300 of 300", err);
    cw_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cgal_counts_the_same_pairs),
        cmocka_unit_test(all_pairs_are_found_and_no_others),
        cmocka_unit_test(wide_fans_are_searched_in_full),
        cmocka_unit_test(a_cone_of_needles_has_none),
        cmocka_unit_test(an_extracted_surface_has_none),
        cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(a_heap_of_slivers_is_given_up_in_time),
        cmocka_unit_test(triangles_without_area_and_empty_meshes_have_none),
        cmocka_unit_test(memory_running_out_and_cancelling_are_errors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
