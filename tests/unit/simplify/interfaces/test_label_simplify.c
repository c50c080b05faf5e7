/* Tests the simplification of label surfaces: every label keeps its topology, patches stay
 * shared, nothing crosses, and the error is a promise. */
#include "support/support.h"

#include "core/base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Makes a volume of labels, with the first voxel at the world's zero. */
static uint32_t *make_map(cw_volume *v, size_t nx, size_t ny, size_t nz)
{
    cw_error err = {0};
    assert_ok(cw_volume_alloc(v, CW_U32, (size_t[]){nx, ny, nz}, 1, 1, &err), err);
    return cw_volume_voxels(v);
}

/* Fills a cube with Voronoi cells, numbered from 1, and makes its border background. */
static void fill_cells(uint32_t *to, size_t side, size_t cells)
{
    double centres[64][3];
    assert_true(cells <= 64);
    for (size_t n = 0; n < cells; n++)
        for (int a = 0; a < 3; a++)
            centres[n][a] = (double)side * (double)rand() / RAND_MAX;
    for (size_t i = 0; i < side * side * side; i++) {
        const double p[3] = {(double)(i % side), (double)(i / side % side),
                             (double)(i / side / side)};
        double least = INFINITY;
        for (size_t n = 0; n < cells; n++) {
            double square = 0;
            for (int a = 0; a < 3; a++)
                square += (p[a] - centres[n][a]) * (p[a] - centres[n][a]);
            if (square < least) {
                least = square;
                to[i] = (uint32_t)n + 1;
            }
        }
        for (int a = 0; a < 3; a++)
            if (p[a] < 2 || p[a] > (double)side - 3)
                to[i] = 0;
    }
}

/* Fills a cube with eight spheres, which all meet in the middle when their radius is large. */
static void fill_spheres(uint32_t *to, size_t side, double radius)
{
    const double middle = ((double)side - 1) / 2;
    for (size_t n = 0; n < side * side * side; n++) {
        const double p[3] = {(double)(n % side), (double)(n / side % side),
                             (double)(n / side / side)};
        double square = 0;
        uint32_t label = 1;
        for (int a = 0; a < 3; a++) {
            const double away = fabs(p[a] - middle) - (double)side * 9 / 32;
            square += away * away;
            label += (uint32_t)(p[a] > middle) << a;
        }
        to[n] = sqrt(square) < radius ? label : 0;
    }
}

/* Checks one label: a manifold with the topology that it had, also for readers who weld. */
static void check_label(const cw_label_surfaces *before, const cw_label_surfaces *after,
                        uint32_t label)
{
    cw_mesh mesh, old_mesh;
    cw_quality q, old;
    cw_error err = {0};
    const cw_quality_desc welded = {.weld = CW_WELD_WORLD, .shells = true, .threads = 1};
    assert_ok(cw_label_mesh(before, label, &old_mesh, &err), err);
    assert_ok(cw_label_mesh(after, label, &mesh, &err), err);
    assert_ok(cw_quality_measure(&old_mesh, &welded, &old, &err), err);
    assert_ok(cw_quality_measure(&mesh, &welded, &q, &err), err);
    if (q.nonmanifold_edges || q.nonmanifold_vertices || q.misoriented_edges || q.duplicates ||
        q.degenerate || q.merged_vertices || q.unused_vertices ||
        q.inside_out != old.inside_out)
        fail_msg("label %u: %zu non-manifold edges, %zu vertices, %zu misoriented, "
                 "%zu duplicates, %zu degenerate, %zu merged, %zu unused, %zu inside out (%zu "
                 "before)",
                 label, q.nonmanifold_edges, q.nonmanifold_vertices, q.misoriented_edges,
                 q.duplicates, q.degenerate, q.merged_vertices, q.unused_vertices, q.inside_out,
                 old.inside_out);
    assert_true(old.open_edges > 0 || q.open_edges == 0);
    assert_int_equal(q.border_loops, old.border_loops);
    assert_int_equal(q.components, old.components);
    assert_int_equal(q.euler, old.euler);
    assert_int_equal(q.cavities, old.cavities);
    assert_true(q.open_edges > 0 || q.volume_mm3 > 0);
    cw_mesh_free(&mesh);
    cw_mesh_free(&old_mesh);
}

static size_t count_crossings(const cw_mesh *mesh)
{
    cw_crossings crossings = {0};
    cw_error err = {0};
    assert_ok(cw_self_intersections(mesh, &(cw_crossings_desc){.threads = 1}, &crossings, &err),
              err);
    const size_t count = crossings.count;
    cw_crossings_free(&crossings);
    return count;
}

/* Checks the whole: the same patches and labels, and no crossings. */
static void check_whole(const cw_label_surfaces *before, const cw_label_surfaces *after)
{
    size_t next = 0;
    assert_int_equal(after->patch_count, before->patch_count);
    assert_int_equal(after->label_count, before->label_count);
    assert_int_equal(after->background, before->background);
    for (size_t n = 0; n < after->label_count; n++)
        assert_memory_equal(&after->labels[n], &before->labels[n], sizeof after->labels[n]);
    for (size_t p = 0; p < after->patch_count; p++) {
        const cw_label_patch *patch = &after->patches[p];
        assert_memory_equal(patch->labels, before->patches[p].labels, sizeof patch->labels);
        assert_true(patch->first == next && patch->count > 0);
        next += patch->count;
    }
    assert_true(next == after->mesh.triangle_count);
    const size_t crossings = count_crossings(&after->mesh);
    if (crossings > 0)
        fail_msg("patches cross each other %zu times", crossings);
}

/* Checks that no patch is farther from itself than an error, both ways. */
static void check_error(const cw_label_surfaces *before, const cw_label_surfaces *after,
                        double error_mm)
{
    for (size_t p = 0; p < after->patch_count; p++) {
        cw_mesh mesh, old;
        cw_mesh_comparison comparison = {0};
        cw_error err = {0};
        assert_ok(cw_label_patch_mesh(before, &before->patches[p], &old, &err), err);
        assert_ok(cw_label_patch_mesh(after, &after->patches[p], &mesh, &err), err);
        assert_ok(cw_mesh_compare(&mesh, &old, &(cw_mesh_distance_desc){.threads = 1},
                                  &comparison, &err),
                  err);
        assert_true(cw_mesh_comparison_max(&comparison) <= error_mm * (1 + 1e-6));
        cw_mesh_free(&mesh);
        cw_mesh_free(&old);
    }
}

/* Simplifies surfaces, and checks all of the result. Returns the part of the triangles that is
 * left. */
static double check_simplified(const cw_label_surfaces *before,
                               const cw_label_simplify_desc *desc)
{
    cw_label_surfaces after;
    cw_error err = {0};
    assert_ok(cw_label_simplify(before, desc, &after, &err), err);
    check_whole(before, &after);
    for (size_t n = 0; n < before->label_count; n++)
        check_label(before, &after, before->labels[n].label);
    if (desc->error_mm > 0)
        check_error(before, &after, desc->error_mm);
    const double left = (double)after.mesh.triangle_count / (double)before->mesh.triangle_count;
    cw_label_surfaces_free(&after);
    return left;
}

/* Extracts a map, and checks its simplification. */
static double check_map(const cw_volume *v, const cw_labels_desc *how,
                        const cw_label_simplify_desc *desc)
{
    cw_label_surfaces s;
    cw_error err = {0};
    assert_ok(cw_extract_labels(v, how, &s, &err), err);
    const double left = s.label_count > 0 ? check_simplified(&s, desc) : 0;
    cw_label_surfaces_free(&s);
    return left;
}

static void spheres_that_meet_are_simplified(void **state)
{
    (void)state;
    enum { SIDE = 32 };
    cw_volume v = {0};
    uint32_t *to = make_map(&v, SIDE, SIDE, SIDE);
    for (int step = 0; step < 6; step += test_is_short() ? 3 : 1) {
        fill_spheres(to, SIDE, 5 + 2.2 * step);
        for (int plain = 0; plain < 2; plain++) {
            const double left = check_map(&v, &(cw_labels_desc){.no_smoothing = plain},
                                          &(cw_label_simplify_desc){.ratio = 0.2});
            assert_true(left <= 0.2001);
            check_map(&v, &(cw_labels_desc){.no_smoothing = plain},
                      &(cw_label_simplify_desc){.triangles = 1});
        }
    }
    cw_volume_free(&v);
}

static void random_maps_are_simplified(void **state)
{
    (void)state;
    test_seed(11);
    for (int n = 0; n < test_some(80); n++) {
        static const uint32_t counts[] = {2, 3, 5, 50};
        cw_volume v = {0};
        size_t dim[3];
        for (int a = 0; a < 3; a++)
            dim[a] = 4 + (size_t)(rand() % 9);
        uint32_t *to = make_map(&v, dim[0], dim[1], dim[2]);
        const uint32_t labels = counts[rand() % 4];
        const int likeness = rand() % 3 * 3; /* how often a voxel repeats the one before */
        for (size_t i = 0; i < dim[0] * dim[1] * dim[2]; i++)
            to[i] = i > 0 && rand() % 10 < likeness ? to[i - 1] : (uint32_t)rand() % labels;
        const cw_labels_desc how = {.no_smoothing = n % 2, .leave_open = n % 4 > 1};
        const cw_label_simplify_desc descs[] = {
            {.ratio = 0.2}, {.triangles = 1}, {.error_mm = 0.3}};
        check_map(&v, &how, &descs[n % 3]);
        cw_volume_free(&v);
    }
}

static void cells_are_simplified_to_a_fifth(void **state)
{
    (void)state;
    const size_t side = test_is_short() ? 40 : 64;
    cw_volume v = {0};
    test_seed(5);
    fill_cells(make_map(&v, side, side, side), side, test_is_short() ? 8 : 30);
    assert_true(check_map(&v, NULL, &(cw_label_simplify_desc){.ratio = 0.2}) <= 0.2001);
    assert_true(check_map(&v, NULL, &(cw_label_simplify_desc){.error_mm = 0.25}) < 0.2);
    cw_volume_free(&v);
}

/* The error is a promise in each patch, and a larger one leaves fewer triangles. */
static void errors_are_promises(void **state)
{
    (void)state;
    const size_t side = test_is_short() ? 20 : 32;
    cw_volume v = {0};
    test_seed(9);
    uint32_t *to = make_map(&v, side, side, side);
    for (int n = 0; n < 2; n++) {
        double before = 1;
        if (n == 0)
            fill_cells(to, side, test_is_short() ? 5 : 12);
        else
            fill_spheres(to, side, 0.4 * (double)side);
        for (double error = 0.02; error < 3; error *= test_is_short() ? 64 : 4) {
            const double left =
                check_map(&v, NULL, &(cw_label_simplify_desc){.error_mm = error});
            assert_true(left < before);
            before = left;
        }
        assert_true(before < 0.1);
    }
    cw_volume_free(&v);
}

/* Tiny and large voxels, and flat ones that are mirrored and far from zero, give what ordinary
 * ones do. */
static void units_change_nothing(void **state)
{
    (void)state;
    enum { SIDE = 24 };
    static const double scales[][3] = {
        {1, 1, 1}, {1e-4, 1e-4, 1e-4}, {1e4, 1e4, 1e4}, {-0.5, 0.5, 2}};
    double lefts[4];
    cw_volume v = {0};
    test_seed(10);
    fill_cells(make_map(&v, SIDE, SIDE, SIDE), SIDE, 8);
    for (int n = 0; n < 4; n++) {
        const double size = fabs(scales[n][0]);
        for (int a = 0; a < 3; a++) {
            v.affine[a][a] = scales[n][a];
            v.affine[a][3] = n == 3 ? -1000 : 0;
        }
        assert_true(check_map(&v, NULL, &(cw_label_simplify_desc){.ratio = 0.2}) <= 0.201);
        lefts[n] = check_map(&v, NULL, &(cw_label_simplify_desc){.error_mm = 0.2 * size});
    }
    assert_near(lefts[1], lefts[0], 0.01);
    assert_near(lefts[2], lefts[0], 0.01);
    cw_volume_free(&v);
}

/* Borders of open surfaces stay where they are: the sides of a box cut in two. */
static void borders_stay_borders(void **state)
{
    (void)state;
    cw_volume v = {0};
    cw_label_surfaces s, after;
    cw_quality q;
    cw_error err = {0};
    uint32_t *to = make_map(&v, 10, 10, 10);
    for (size_t n = 0; n < 1000; n++)
        to[n] = n / 100 < 5 ? 1 : 2;
    assert_ok(cw_extract_labels(&v, &(cw_labels_desc){.leave_open = true}, &s, &err), err);
    assert_ok(cw_label_simplify(&s, &(cw_label_simplify_desc){.error_mm = 0.01}, &after, &err),
              err);
    assert_ok(cw_quality_measure(&after.mesh, NULL, &q, &err), err);
    assert_int_equal(q.border_loops, 1);
    assert_near(q.area_mm2, 100, 0.1);
    assert_near(q.min[2], 4.5, 1e-3);
    assert_true(q.triangles < 20);
    cw_label_surfaces_free(&after);
    cw_label_surfaces_free(&s);
    cw_volume_free(&v);
}

static void threads_change_nothing(void **state)
{
    (void)state;
    enum { SIDE = 28 };
    cw_volume v = {0};
    cw_label_surfaces s, one, many;
    cw_error err = {0};
    test_seed(12);
    fill_cells(make_map(&v, SIDE, SIDE, SIDE), SIDE, 5);
    assert_ok(cw_extract_labels(&v, NULL, &s, &err), err);
    cw_label_simplify_desc desc = {.error_mm = 0.1, .threads = 1};
    assert_ok(cw_label_simplify(&s, &desc, &one, &err), err);
    desc.threads = 3;
    assert_ok(cw_label_simplify(&s, &desc, &many, &err), err);
    assert_int_equal(many.mesh.triangle_count, one.mesh.triangle_count);
    assert_int_equal(many.mesh.vertex_count, one.mesh.vertex_count);
    assert_memory_equal(many.mesh.triangles, one.mesh.triangles, 12 * one.mesh.triangle_count);
    assert_memory_equal(many.mesh.positions, one.mesh.positions, 12 * one.mesh.vertex_count);
    cw_label_surfaces_free(&one);
    cw_label_surfaces_free(&many);
    cw_label_surfaces_free(&s);
    cw_volume_free(&v);
}

/* Makes a double cone around z by hand, with a vertex of very many triangles at each end. */
static void make_double_cone(cw_label_surfaces *s, uint32_t sides)
{
    static cw_label_patch patch;
    static cw_label_count label;
    patch = (cw_label_patch){{1, 0}, 0, 2 * (size_t)sides};
    label = (cw_label_count){1, 1};
    *s = (cw_label_surfaces){
        .patch_count = 1, .patches = &patch, .label_count = 1, .labels = &label};
    s->mesh.vertex_count = sides + 2;
    s->mesh.triangle_count = 2 * sides;
    s->mesh.positions = calloc(3 * (sides + 2), sizeof(float));
    s->mesh.triangles = calloc(6 * sides, sizeof(uint32_t));
    s->mesh.positions[3 * sides + 2] = 1;
    s->mesh.positions[3 * sides + 5] = -1;
    for (uint32_t n = 0; n < sides; n++) {
        const uint32_t next = (n + 1) % sides;
        const uint32_t both[6] = {sides, n, next, sides + 1, next, n};
        s->mesh.positions[3 * n] = (float)cos(2 * PI * n / sides);
        s->mesh.positions[3 * n + 1] = (float)sin(2 * PI * n / sides);
        memcpy(s->mesh.triangles + 6 * n, both, sizeof both);
    }
}

static void vertices_with_many_triangles_are_usable(void **state)
{
    (void)state;
    for (uint32_t sides = 3; sides < 300; sides += 9) {
        cw_label_surfaces s;
        make_double_cone(&s, sides);
        check_simplified(&s, &(cw_label_simplify_desc){.triangles = 1});
        check_simplified(&s, &(cw_label_simplify_desc){.error_mm = 0.1});
        free(s.mesh.positions);
        free(s.mesh.triangles);
    }
}

/* Surfaces without a triangle are simplified to themselves. */
static void empty_surfaces_stay_empty(void **state)
{
    (void)state;
    cw_label_surfaces s = {.background = 3}, after;
    cw_error err = {0};
    assert_ok(cw_label_simplify(&s, &(cw_label_simplify_desc){.ratio = 0.5}, &after, &err),
              err);
    assert_true(after.mesh.triangle_count == 0 && after.background == 3);
    cw_label_surfaces_free(&after);
    assert_ok(cw_label_simplify(&s, &(cw_label_simplify_desc){.error_mm = 1}, &after, &err),
              err);
    cw_label_surfaces_free(&after);
}

static void unusable_requests_are_named(void **state)
{
    (void)state;
    static const struct {
        cw_label_simplify_desc desc;
        const char *words;
    } cases[] = {{{0}, "no target"},
                 {{.error_mm = -1}, "error_mm is -1"},
                 {{.error_mm = NAN}, "error_mm is nan"},
                 {{.error_mm = INFINITY}, "error_mm is inf"},
                 {{.ratio = 1}, "ratio is 1"},
                 {{.ratio = -0.5}, "ratio is -0.5"},
                 {{.ratio = NAN}, "ratio is nan"}};
    cw_label_surfaces s, after;
    cw_error err = {0};
    const cw_label_simplify_desc half = {.ratio = 0.5};
    make_double_cone(&s, 8);
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++)
        assert_fails(cw_label_simplify(&s, &cases[n].desc, &after, &err), CW_ERR_ARGUMENT,
                     cases[n].words, err);
    assert_fails(cw_label_simplify(&s, NULL, &after, &err), CW_ERR_ARGUMENT, "no target", err);
    s.patches[0].count--;
    assert_fails(cw_label_simplify(&s, &half, &after, &err), CW_ERR_ARGUMENT, "patches have 15",
                 err);
    s.patches[0].count += 2;
    assert_fails(cw_label_simplify(&s, &half, &after, &err), CW_ERR_ARGUMENT,
                 "patch 0 has triangles 0 to 17", err);
    s.patches[0].count--;
    s.mesh.triangles[3] = s.mesh.triangles[4];
    assert_fails(cw_label_simplify(&s, &half, &after, &err), CW_ERR_ARGUMENT,
                 "triangle 1 names a vertex twice", err);
    s.mesh.triangles[3] = 100;
    assert_fails(cw_label_simplify(&s, &half, &after, &err), CW_ERR_ARGUMENT, "100", err);
    free(s.mesh.positions);
    free(s.mesh.triangles);
}

/* Each allocation fails in turn: an error, and nothing left behind. */
static void memory_that_is_out_is_an_error(void **state)
{
    (void)state;
    cw_volume v = {0};
    cw_label_surfaces s, after;
    cw_error err = {0};
    const cw_label_simplify_desc descs[] = {{.ratio = 0.3}, {.error_mm = 0.3}};
    test_seed(13);
    fill_cells(make_map(&v, 14, 14, 14), 14, 4);
    assert_ok(cw_extract_labels(&v, NULL, &s, &err), err);
    for (int k = 0; k < 2; k++) {
        bool failed = true;
        for (long n = 0; failed; n += 1 + n / (test_is_short() ? 8 : 64)) {
            cw_label_simplify_desc desc = descs[k];
            desc.threads = 1;
            cwi_alloc_fail_after(n);
            const cw_status st = cw_label_simplify(&s, &desc, &after, &err);
            failed = cwi_alloc_fail_after(-1);
            assert_true(st == (failed ? CW_ERR_NO_MEMORY : CW_OK));
            assert_true(!failed || (after.mesh.triangles == NULL && after.patches == NULL));
            cw_label_surfaces_free(&after);
        }
    }
    cw_label_surfaces_free(&s);
    cw_volume_free(&v);
}

static void calls_can_be_cancelled(void **state)
{
    (void)state;
    cw_volume v = {0};
    cw_label_surfaces s, after;
    cw_error err = {0};
    test_seed(14);
    fill_cells(make_map(&v, 20, 20, 20), 20, 6);
    assert_ok(cw_extract_labels(&v, NULL, &s, &err), err);
    cw_status st = CW_ERR_CANCELLED;
    int polls = 0;
    for (; st != CW_OK; polls += 1 + polls / (test_is_short() ? 4 : 32)) {
        int left = polls;
        st = cw_label_simplify(&s,
                               &(cw_label_simplify_desc){.error_mm = 0.2,
                                                         .threads = 1,
                                                         .progress = {test_stop_after, &left}},
                               &after, &err);
        assert_true(st == CW_OK || (st == CW_ERR_CANCELLED && after.mesh.triangles == NULL));
        cw_label_surfaces_free(&after);
    }
    assert_true(polls > 5);
    cw_label_surfaces_free(&s);
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spheres_that_meet_are_simplified),
        cmocka_unit_test(random_maps_are_simplified),
        cmocka_unit_test(cells_are_simplified_to_a_fifth),
        cmocka_unit_test(errors_are_promises),
        cmocka_unit_test(units_change_nothing),
        cmocka_unit_test(borders_stay_borders),
        cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(vertices_with_many_triangles_are_usable),
        cmocka_unit_test(empty_surfaces_stay_empty),
        cmocka_unit_test(unusable_requests_are_named),
        cmocka_unit_test(memory_that_is_out_is_an_error),
        cmocka_unit_test(calls_can_be_cancelled)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
