/* Verdicts and painted defects. */
#include "support/planted.h"

#include "core/base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Everything the judge may be told of a planted mesh. */
typedef struct known {
    cw_mesh mesh;
    cw_quality quality;
    cw_crossings crossings;
    uint8_t *defects;
    cw_findings findings;
    cw_verdict verdicts[CW_MAX_VERDICTS];
    size_t count;
} known;

static const test_planted *row_of(const char *name)
{
    for (size_t n = 0; n < test_planted_count; n++)
        if (strcmp(test_planted_meshes[n].name, name) == 0)
            return &test_planted_meshes[n];
    fail_msg("no planted mesh is called %s", name);
    return NULL;
}

static void learn(known *k, const char *name)
{
    cw_error err = {0};
    *k = (known){.mesh = test_plant(row_of(name))};
    k->defects = calloc(k->mesh.triangle_count, 1);
    const cw_quality_desc desc = {.weld = CW_WELD_LOCAL, .shells = true, .defects = k->defects};
    const cw_crossings_desc crossings = {.weld = CW_WELD_LOCAL, .defects = k->defects};
    assert_ok(cw_quality_measure(&k->mesh, &desc, &k->quality, &err), err);
    assert_ok(cw_self_intersections(&k->mesh, &crossings, &k->crossings, &err), err);
    k->findings = (cw_findings){.quality = &k->quality, .crossings = &k->crossings};
}

static void forget(known *k)
{
    cw_mesh_free(&k->mesh);
    cw_crossings_free(&k->crossings);
    free(k->defects);
}

static const cw_verdict *judge(known *k, cw_profile profile, const char *name)
{
    k->count = cw_check_judge(&k->findings, profile, k->verdicts);
    for (size_t n = 1; n < k->count; n++)
        assert_true(k->verdicts[n - 1].grade <= k->verdicts[n].grade);
    for (size_t n = 0; n < k->count; n++)
        if (strcmp(k->verdicts[n].name, name) == 0)
            return &k->verdicts[n];
    return NULL;
}

/* Which verdict each fault turns, and how bad it is: basic, print, web, fem. */
static void profiles_grade_faults(void **state)
{
    (void)state;
    enum { F = CW_GRADE_FAIL, W = CW_GRADE_WARN, O = CW_GRADE_OK, N = CW_GRADE_NOTE };
    static const struct {
        const char *mesh, *verdict;
        int grade[4];
        double number;
    } rows[] = {
        {"ball", "closed", {O, O, O, O}, 0},
        {"missing_triangle", "closed", {N, F, N, F}, 3},
        {"duplicate", "manifold", {F, F, W, F}, 3},
        {"duplicate", "duplicates", {F, F, W, F}, 1},
        {"fin", "manifold", {F, F, W, F}, 1},
        {"bow_tie", "manifold", {O, O, O, O}, 0},
        {"bow_tie", "contacts", {N, N, N, W}, 1},
        {"shared_edge", "contacts", {N, N, N, W}, 1},
        {"flipped_triangle", "oriented", {F, F, F, F}, 3},
        {"inside_out_cube", "outward", {F, F, F, F}, 1},
        {"open_inside_out", "facing", {W, W, W, W}, 1},
        {"cavity", "outward", {O, O, O, O}, 0},
        {"nested", "nested", {W, W, N, F}, 1},
        {"zero_band", "degenerate", {F, F, W, F}, 24},
        {"spike", "self-intersections", {F, F, W, F}, -1},
        {"needles", "shapes", {N, N, N, F}, -1},
        {"unused_points", "unused", {N, N, W, N}, 2},
    };
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        known k;
        learn(&k, rows[r].mesh);
        for (int p = 0; p < 4; p++) {
            const cw_verdict *v = judge(&k, (cw_profile)p, rows[r].verdict);
            if (!v || (int)v->grade != rows[r].grade[p])
                fail_msg("%s, %s, profile %d: %s", rows[r].mesh, rows[r].verdict, p,
                         v ? cw_grade_name(v->grade) : "not judged");
            if (rows[r].number >= 0)
                assert_true(v->number == rows[r].number);
            assert_true(strlen(v->text) > 0);
            assert_true(v->grade != CW_GRADE_FAIL || v->advice);
        }
        forget(&k);
    }
}

static void a_promise_that_was_not_looked_at_does_not_hold(void **state)
{
    (void)state;
    known k;
    learn(&k, "ball");
    judge(&k, CW_PROFILE_PRINT, "");
    assert_true(cw_check_holds(k.verdicts, k.count));
    k.findings.crossings = NULL;
    assert_int_equal(judge(&k, CW_PROFILE_PRINT, "self-intersections")->grade,
                     CW_GRADE_UNKNOWN);
    assert_false(cw_check_holds(k.verdicts, k.count));
    assert_int_equal(judge(&k, CW_PROFILE_BASIC, "self-intersections")->grade, CW_GRADE_NOTE);
    assert_true(cw_check_holds(k.verdicts, k.count));
    k.findings.crossings = &(cw_crossings){.undecided = true};
    assert_int_equal(judge(&k, CW_PROFILE_BASIC, "self-intersections")->grade,
                     CW_GRADE_UNKNOWN);
    assert_false(cw_check_holds(k.verdicts, k.count));
    forget(&k);
}

/* A number just at a limit is within it. */
static void limits_belong_to_what_they_allow(void **state)
{
    (void)state;
    static const struct {
        double number;
        cw_grade grade;
    } sizes[] = {{4.99, CW_GRADE_WARN},
                 {CW_PRINT_MIN_MM, CW_GRADE_OK},
                 {CW_PRINT_MAX_MM, CW_GRADE_OK},
                 {400.01, CW_GRADE_WARN}};
    known k;
    learn(&k, "ball");
    for (size_t n = 0; n < 4; n++) {
        for (int a = 0; a < 3; a++) {
            k.quality.min[a] = 0;
            k.quality.max[a] = a == 1 ? sizes[n].number : 1;
        }
        assert_int_equal(judge(&k, CW_PROFILE_PRINT, "size")->grade, sizes[n].grade);
    }
    for (int n = 0; n < 3; n++) {
        k.quality.shapes.min_angle_deg = n == 1 ? 9.99 : CW_FEM_MIN_ANGLE_DEG;
        k.quality.shapes.max_aspect = n == 2 ? 10.01 : CW_FEM_MAX_ASPECT;
        assert_int_equal(judge(&k, CW_PROFILE_FEM, "shapes")->grade,
                         n ? CW_GRADE_FAIL : CW_GRADE_OK);
    }
    forget(&k);
}

static void size_and_weight_are_looked_at(void **state)
{
    (void)state;
    known k;
    learn(&k, "ball"); /* 20 mm */
    assert_int_equal(judge(&k, CW_PROFILE_PRINT, "size")->grade, CW_GRADE_OK);
    k.quality.max[0] = 900;
    assert_int_equal(judge(&k, CW_PROFILE_PRINT, "size")->grade, CW_GRADE_WARN);
    assert_null(judge(&k, CW_PROFILE_FEM, "size"));
    assert_int_equal(judge(&k, CW_PROFILE_WEB, "weight")->grade, CW_GRADE_OK);
    assert_int_equal(judge(&k, CW_PROFILE_WEB, "normals")->grade, CW_GRADE_WARN);
    static const cw_profile drawn[] = {CW_PROFILE_WEB, CW_PROFILE_GAME, CW_PROFILE_MOBILE};
    assert_null(cw_check_budget(CW_PROFILE_PRINT));
    for (size_t n = 0; n < 3; n++) {
        const cw_budget *budget = cw_check_budget(drawn[n]);
        k.quality.triangles = budget->triangles[0];
        k.findings.file_bytes = budget->file_bytes;
        assert_int_equal(judge(&k, drawn[n], "weight")->grade, CW_GRADE_OK);
        assert_int_equal(judge(&k, drawn[n], "file size")->grade, CW_GRADE_OK);
        k.quality.triangles++;
        k.findings.file_bytes++;
        assert_int_equal(judge(&k, drawn[n], "weight")->grade, CW_GRADE_WARN);
        assert_int_equal(judge(&k, drawn[n], "file size")->grade, CW_GRADE_WARN);
    }
    k.quality = (cw_quality){0};
    assert_int_equal(judge(&k, CW_PROFILE_BASIC, "triangles")->grade, CW_GRADE_FAIL);
    forget(&k);
}

static void distances_are_held_against_the_tolerance_in_both_directions(void **state)
{
    (void)state;
    known k;
    const cw_distance near = {.max_mm = 0.09, .bound_mm = 0.095, .triangles = 1},
                      far = {.max_mm = 0.2, .bound_mm = 0.21, .triangles = 1};
    learn(&k, "ball");
    k.findings.to_field = &near;
    k.findings.from_field = &near;
    assert_int_equal(judge(&k, CW_PROFILE_BASIC, "to field")->grade, CW_GRADE_NOTE);
    k.findings.tolerance_mm = 0.1;
    assert_int_equal(judge(&k, CW_PROFILE_BASIC, "to field")->grade, CW_GRADE_OK);
    assert_int_equal(judge(&k, CW_PROFILE_BASIC, "covered")->grade, CW_GRADE_OK);
    k.findings.from_field = &far;
    assert_int_equal(judge(&k, CW_PROFILE_BASIC, "to field")->grade, CW_GRADE_OK);
    assert_int_equal(judge(&k, CW_PROFILE_BASIC, "covered")->grade, CW_GRADE_FAIL);
    k.findings.to_field = &far;
    assert_int_equal(judge(&k, CW_PROFILE_BASIC, "to field")->grade, CW_GRADE_FAIL);
    k.findings.to_reference = &near;
    k.findings.tolerance_mm = 0.094;
    assert_int_equal(judge(&k, CW_PROFILE_BASIC, "to reference")->grade, CW_GRADE_FAIL);
    forget(&k);
}

static void another_topology_and_another_opinion_are_told(void **state)
{
    (void)state;
    known k;
    learn(&k, "torus");
    cw_quality field = k.quality;
    k.findings.field = &field;
    assert_int_equal(judge(&k, CW_PROFILE_BASIC, "topology")->grade, CW_GRADE_OK);
    field.components = 2;
    assert_int_equal(judge(&k, CW_PROFILE_BASIC, "topology")->grade, CW_GRADE_WARN);
    cw_cgal_facts facts = {.is_polygon_mesh = true, .closed = true, .components = 1};
    k.findings.cgal = &facts;
    assert_int_equal(judge(&k, CW_PROFILE_BASIC, "cgal")->grade, CW_GRADE_OK);
    facts.self_intersections = 1;
    assert_int_equal(judge(&k, CW_PROFILE_BASIC, "cgal")->grade, CW_GRADE_FAIL);
    facts.is_polygon_mesh = false;
    assert_int_equal(judge(&k, CW_PROFILE_BASIC, "cgal")->grade, CW_GRADE_FAIL);
    forget(&k);
}

static bool has_color(const cw_mesh *mesh, uint32_t vertex, const uint8_t rgb[3])
{
    return memcmp(mesh->colors + 4 * (size_t)vertex, rgb, 3) == 0;
}

static const cw_paint *paint_of(cw_defect defect)
{
    size_t count;
    const cw_paint *paints = cw_check_paints(&count);
    for (size_t n = 0; n < count; n++)
        if (paints[n].defect == defect)
            return &paints[n];
    fail_msg("defect %d has no paint", (int)defect);
    return NULL;
}

static void every_defect_has_a_colour_of_its_own(void **state)
{
    (void)state;
    size_t count;
    unsigned all = 0;
    const cw_paint *paints = cw_check_paints(&count);
    for (size_t n = 0; n < count; n++) {
        all |= (unsigned)paints[n].defect;
        for (size_t m = 0; m < n; m++)
            assert_memory_not_equal(paints[n].rgb, paints[m].rgb, 3);
    }
    assert_int_equal(all, 0xff);
}

/* All corners of a triangle with the defect have its colour, and no others have. */
static void painted_triangles_are_painted_all_over(void **state)
{
    (void)state;
    known k;
    cw_mesh painted;
    cw_error err = {0};
    const uint8_t *red = paint_of(CW_DEFECT_OPEN)->rgb, grey[3] = {200, 200, 200};
    learn(&k, "two_holes");
    assert_ok(cw_check_paint(&k.mesh, k.defects, NULL, 0, &painted, &err), err);
    assert_ok(cw_mesh_check(&painted, &err), err);
    assert_int_equal(painted.triangle_count, k.mesh.triangle_count);
    size_t reds = 0;
    for (size_t t = 0; t < painted.triangle_count; t++) {
        const bool open = k.defects[t] & CW_DEFECT_OPEN;
        reds += open;
        for (size_t c = 3 * t; c < 3 * t + 3; c++) {
            assert_true(has_color(&painted, painted.triangles[c], open ? red : grey));
            assert_memory_equal(painted.positions + 3 * painted.triangles[c],
                                k.mesh.positions + 3 * k.mesh.triangles[c], 12);
        }
    }
    assert_int_equal(reds, 6);
    cw_mesh_free(&painted);
    forget(&k);
}

static void every_planted_fault_is_marked_where_it_is(void **state)
{
    (void)state;
    for (size_t n = 0; n < test_planted_count; n++) {
        const test_planted *row = &test_planted_meshes[n];
        known k;
        unsigned marked = 0, expected = 0;
        learn(&k, row->name);
        for (size_t t = 0; t < k.mesh.triangle_count; t++)
            marked |= k.defects[t];
        expected |= row->open_edges ? CW_DEFECT_OPEN : 0;
        expected |=
            row->nonmanifold_edges || row->nonmanifold_vertices ? CW_DEFECT_NONMANIFOLD : 0;
        expected |= row->misoriented_edges ? CW_DEFECT_MISORIENTED : 0;
        expected |= row->duplicates ? CW_DEFECT_DUPLICATE : 0;
        expected |= row->degenerate ? CW_DEFECT_DEGENERATE : 0;
        expected |= row->needles || row->caps ? CW_DEFECT_SLIVER : 0;
        expected |=
            row->inside_out || row->nested || row->open_inward ? CW_DEFECT_INSIDE_OUT : 0;
        expected |= row->meets_itself ? CW_DEFECT_INTERSECTING : 0;
        if (marked != expected)
            fail_msg("%s: marked as %#x, not %#x", row->name, marked, expected);
        forget(&k);
    }
}

static void what_has_no_area_is_shown_by_its_neighbours(void **state)
{
    (void)state;
    known k;
    cw_mesh painted;
    cw_error err = {0};
    size_t black = 0;
    learn(&k, "zero_band");
    assert_ok(cw_check_paint(&k.mesh, k.defects, NULL, 0, &painted, &err), err);
    for (size_t t = 0; t < painted.triangle_count; t++)
        black +=
            has_color(&painted, painted.triangles[3 * t], paint_of(CW_DEFECT_DEGENERATE)->rgb);
    assert_int_equal(black, 24 + 48); /* the band, and a band on either side */
    cw_mesh_free(&painted);
    forget(&k);
}

static void distances_run_from_grey_to_red(void **state)
{
    (void)state;
    cw_mesh cube, painted;
    cw_error err = {0};
    const uint8_t defects[12] = {0}, grey[3] = {200, 200, 200}, red[3] = {200, 0, 0},
                  yellow[3] = {255, 220, 60};
    const float distances[8] = {0, 0.5f, -0.5f, 1, -1, 2, 0, 0};
    test_make_cube(&cube);
    assert_ok(cw_check_paint(&cube, defects, distances, 1, &painted, &err), err);
    assert_int_equal(painted.vertex_count, 8);
    assert_non_null(painted.normals);
    for (uint32_t c = 0; c < 36; c++) {
        const uint32_t v = cube.triangles[c], n = painted.triangles[c];
        const double d = fabs((double)distances[v]);
        assert_true(has_color(&painted, n, d == 0 ? grey : d == 0.5 ? yellow : red));
        assert_true(painted.scalars[n] == distances[v]);
    }
    cw_mesh_free(&painted);
    for (long n = 0;; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st = cw_check_paint(&cube, defects, distances, 1, &painted, &err);
        const bool failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        assert_int_equal(painted.vertex_count, failed ? 0 : 8);
        cw_mesh_free(&painted);
        if (!failed)
            break;
    }
    cw_mesh_free(&cube);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(profiles_grade_faults),
        cmocka_unit_test(a_promise_that_was_not_looked_at_does_not_hold),
        cmocka_unit_test(limits_belong_to_what_they_allow),
        cmocka_unit_test(size_and_weight_are_looked_at),
        cmocka_unit_test(distances_are_held_against_the_tolerance_in_both_directions),
        cmocka_unit_test(another_topology_and_another_opinion_are_told),
        cmocka_unit_test(every_defect_has_a_colour_of_its_own),
        cmocka_unit_test(painted_triangles_are_painted_all_over),
        cmocka_unit_test(every_planted_fault_is_marked_where_it_is),
        cmocka_unit_test(what_has_no_area_is_shown_by_its_neighbours),
        cmocka_unit_test(distances_run_from_grey_to_red),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
