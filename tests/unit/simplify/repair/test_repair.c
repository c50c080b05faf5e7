/* Repair of broken meshes: each defect is counted by itself, and every result is sound. */
#include "support/planted.h"
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/mesh/mesh.h"
#include "core/synthetic/random_fill.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Closed, oriented, without crossings; those who weld equal points may find contacts of solids. */
static void assert_repaired(const cw_mesh *m, const char *name)
{
    for (int weld = CW_WELD_NONE; weld <= CW_WELD_LOCAL; weld += CW_WELD_LOCAL) {
        const cw_quality_desc desc = {.weld = (cw_weld)weld, .shells = true};
        const cw_crossings_desc crossings_desc = {.weld = CW_WELD_LOCAL};
        cw_quality q;
        cw_crossings found;
        cw_error err = {0};
        assert_ok(cw_quality_measure(m, &desc, &q, &err), err);
        assert_ok(cw_self_intersections(m, &crossings_desc, &found, &err), err);
        q.nonmanifold_edges -= q.contact_edges;
        q.nonmanifold_vertices -= q.contact_vertices;
        if (!cw_quality_is_closed_manifold(&q) || q.degenerate || q.inside_out || found.count ||
            found.undecided || !q.triangles || q.unused_vertices)
            fail_msg("%s, weld %d: %zu open, %zu and %zu not manifold, %zu misoriented, %zu "
                     "flat, %zu inside out, %zu crossings, %zu unused",
                     name, weld, q.open_edges, q.nonmanifold_edges, q.nonmanifold_vertices,
                     q.misoriented_edges, q.degenerate, q.inside_out, found.count,
                     q.unused_vertices);
        cw_crossings_free(&found);
    }
}

/* Repairs a mesh in its place. */
static cw_repair_facts repair_mesh(cw_mesh *m, const cw_repair_desc *desc)
{
    cw_repair_facts facts;
    cw_mesh out;
    cw_error err = {0};
    assert_ok(cw_mesh_repair(m, desc, &out, &facts, &err), err);
    cw_mesh_free(m);
    *m = out;
    return facts;
}

static cw_mesh copy_mesh(const cw_mesh *m)
{
    cw_mesh copy;
    cw_error err = {0};
    assert_ok(cwi_mesh_copy(m, &copy, &err), err);
    return copy;
}

static cw_mesh plant_mesh(const char *name)
{
    for (size_t n = 0; n < test_planted_count; n++)
        if (strcmp(test_planted_meshes[n].name, name) == 0)
            return test_plant(&test_planted_meshes[n]);
    fail_msg("no planted mesh %s", name);
    return (cw_mesh){0};
}

/* The distance both ways. */
static double measure_distance(const cw_mesh *a, const cw_mesh *b)
{
    cw_mesh_comparison c = {0};
    cw_error err = {0};
    assert_ok(cw_mesh_compare(a, b, NULL, &c, &err), err);
    return cw_mesh_comparison_max(&c);
}

/* Counts of one planted mesh; those not named are 0. */
typedef struct told_row {
    const char *name;
    size_t duplicates, degenerate, flipped, shells, edges, twisted, vertices, sheets, holes,
        crossings, touching, united, split, welded; /* beyond equal positions */
    double distance;                                /* largest to the input, both ways */
} told_row;

static const told_row told_rows[] = {
    {"cube", .distance = 0},
    {"ball", .distance = 0},
    {"torus", .distance = 0},
    {"two_cubes", .distance = 0},
    {"soup", .distance = 0},
    {"unused_points", .distance = 0},
    {"cavity", .distance = 0},
    {"solid_in_cavity", .distance = 0},
    {"needles", .distance = 0},
    {"cap", .distance = 0},
    {"missing_triangle", .holes = 1, .distance = 3},
    {"two_holes", .holes = 2, .distance = 1},
    {"touching_holes", .holes = 2, .distance = 1},
    {"tube", .holes = 2, .distance = 13},
    {"crack", .welded = 1, .distance = 0.001},
    {"t_junction", .split = 1, .distance = 0},
    {"flipped_triangle", .flipped = 1, .distance = 0},
    {"half_flipped", .flipped = 6, .shells = 1, .distance = 0},
    {"inside_out_cube", .shells = 1, .distance = 0},
    {"open_inside_out", .shells = 1, .holes = 1, .distance = 1},
    {"one_inside_out", .shells = 1, .distance = 0},
    {"nested", .shells = 1, .distance = 0},
    {"twice_nested", .shells = 1, .distance = 0},
    {"duplicate", .duplicates = 1, .distance = 0},
    {"opposite_duplicate", .duplicates = 1, .distance = 0},
    {"coincident_cubes", .duplicates = 12, .distance = 0},
    {"fin", .edges = 1, .sheets = 1, .distance = 5.7},
    {"shared_edge", .edges = 1, .vertices = 2, .distance = 0},
    {"bow_tie", .vertices = 1, .distance = 0},
    {"crossed_bars", .crossings = 22, .united = 2, .distance = 1.5},
    {"touching_faces", .crossings = 18, .united = 2, .distance = 3},
    {"touching_tip", .crossings = 12, .united = 2, .distance = 0.011},
    {"spike", .crossings = 24, .united = 1, .distance = 10},
    {"flat_split", .degenerate = 1, .distance = 0},
    {"zero_band", .degenerate = 24, .distance = 0},
};

static void check_told(const told_row *row, const cw_repair_facts *f)
{
    const size_t told[] = {f->duplicates,           f->degenerate,
                           f->flipped_triangles,    f->flipped_shells,
                           f->nonmanifold_edges,    f->twisted_edges,
                           f->nonmanifold_vertices, f->sheets,
                           f->holes_filled,         f->crossings_before,
                           f->touching_vertices,    f->united_shells,
                           f->split_edges,          f->weld_mm > 0 ? f->welded : 0};
    const size_t expected[] = {row->duplicates, row->degenerate, row->flipped,  row->shells,
                               row->edges,      row->twisted,    row->vertices, row->sheets,
                               row->holes,      row->crossings,  row->touching, row->united,
                               row->split,      row->welded};
    bool needed = false;
    for (size_t n = 0; n < sizeof told / sizeof *told; n++) {
        if (told[n] != expected[n])
            fail_msg("%s: fact %zu is %zu, not %zu", row->name, n, told[n], expected[n]);
        needed = needed || expected[n];
    }
    assert_int_equal(f->is_needed, needed);
    assert_true(f->is_sound && !f->is_wrapped && !f->is_undecided && !f->is_union_lacking);
    assert_int_equal(f->crossings_after, 0);
    assert_int_equal(f->holes_left, 0);
}

static void each_defect_is_told_apart_and_repaired(void **state)
{
    (void)state;
    for (size_t n = 0; n < sizeof told_rows / sizeof *told_rows; n++) {
        const told_row *row = &told_rows[n];
        cw_mesh before = plant_mesh(row->name), m = plant_mesh(row->name);
        const cw_repair_facts facts = repair_mesh(&m, NULL);
        check_told(row, &facts);
        assert_repaired(&m, row->name);
        if (!(measure_distance(&m, &before) <= row->distance + 1e-5))
            fail_msg("%s: distance %g mm", row->name, measure_distance(&m, &before));
        cw_mesh_free(&before);
        cw_mesh_free(&m);
    }
}

/* Sheets enclose nothing and are left out, and so are one-sided strips. */
static void sheets_and_strips_leave_nothing(void **state)
{
    (void)state;
    static const char *const sheets[] = {"sheet", "one_triangle", "folded"};
    cw_error err = {0};
    for (int n = 0; n < 3; n++) {
        cw_mesh m = plant_mesh(sheets[n]), out;
        cw_repair_facts facts;
        assert_fails(cw_mesh_repair(&m, NULL, &out, &facts, &err), CW_ERR_EMPTY,
                     "the mesh encloses no volume", err);
        assert_true(facts.sheets == 1 && facts.is_needed && !facts.is_sound);
        assert_true(!out.positions && !out.triangles);
        cw_mesh_free(&m);
    }
    cw_mesh m = plant_mesh("moebius"), out;
    cw_repair_facts facts;
    assert_fails(cw_mesh_repair(&m, NULL, &out, &facts, &err), CW_ERR_EMPTY,
                 "the mesh is one-sided", err);
    assert_true(facts.twisted_edges == 1 && facts.one_sided == 1 && !out.positions);
    cw_mesh_free(&m);
}

static void wraps_are_solids_around_sheets(void **state)
{
    (void)state;
    static const char *const names[] = {"sheet", "folded", "one_triangle"};
    cw_error err = {0};
    for (int n = 0; n < 3; n++) {
        cw_mesh before = plant_mesh(names[n]), m = plant_mesh(names[n]);
        const cw_repair_desc desc = {.wrap_mm = 0.5};
        cw_repair_facts facts;
        if (!cw_repair_has_cgal() && n < 2) {
            cw_mesh out;
            assert_fails(cw_mesh_repair(&m, &desc, &out, &facts, &err), CW_ERR_UNSUPPORTED,
                         "libcgal", err);
            assert_true(!out.positions && !out.triangles);
        } else if (cw_repair_has_cgal()) {
            facts = repair_mesh(&m, &desc);
            assert_true(facts.is_wrapped);
            assert_repaired(&m, names[n]);
            assert_true(measure_distance(&m, &before) < 0.6);
        }
        cw_mesh_free(&before);
        cw_mesh_free(&m);
    }
    cw_mesh m = plant_mesh("sheet");
    assert_fails(cw_mesh_repair(&m, &(cw_repair_desc){.wrap_mm = 1e-4}, NULL, NULL, &err),
                 CW_ERR_LIMIT, "wrap_mm is 0.0001: the wrap would have more than 2e+07", err);
    cw_mesh_free(&m);
}

/* A sound mesh is wrapped where that is asked for, at most wrap_mm / 30 outside, and otherwise stays to the bit. */
static void sound_meshes_are_wrapped_if_asked_for(void **state)
{
    (void)state;
    cw_mesh before = plant_mesh("cube"), m = plant_mesh("cube");
    cw_repair_facts facts = repair_mesh(&m, NULL);
    assert_false(facts.is_needed || facts.is_wrapped);
    assert_int_equal(m.vertex_count, before.vertex_count);
    assert_memory_equal(m.positions, before.positions, 12 * m.vertex_count);
    assert_memory_equal(m.triangles, before.triangles, 12 * m.triangle_count);
    if (cw_repair_has_cgal()) {
        facts = repair_mesh(&m, &(cw_repair_desc){.wrap_mm = 0.5});
        assert_true(facts.is_wrapped && facts.is_sound && !facts.is_needed);
        assert_repaired(&m, "cube");
        assert_true(measure_distance(&m, &before) > 0 && measure_distance(&m, &before) < 0.5);
    }
    cw_mesh_free(&m);
    cw_mesh_free(&before);
}

/* The volume of two bars less what they share. */
static void crossing_solids_are_united(void **state)
{
    (void)state;
    cw_mesh m = plant_mesh("crossed_bars");
    repair_mesh(&m, NULL);
    assert_int_equal(test_measure(&m).components, 1);
    assert_within(test_measure(&m).volume_mm3, 20 * 2 * 2 + 20 * 3 * 3 - 3 * 2 * 2, 1e-6);
    cw_mesh_free(&m);
}

/* --- broken scans ------------------------------------------------------------------------- */

enum { DELETED = 1, DOUBLED = 2, FLIPPED = 4, CROSSING = 8, CUT = 16, ALL_WAYS = 32 };

static cw_mesh extract_field(cw_field field, size_t n)
{
    cw_volume volume = test_sample(field, n, CW_F32);
    cw_mesh mesh = test_extract(&volume, NULL, NULL);
    cw_volume_free(&volume);
    return mesh;
}

static double random_number(void)
{
    return rand() / ((double)RAND_MAX + 1);
}

static void push_triangle(cw_mesh *m, const float p[3][3], bool is_flipped)
{
    for (size_t k = 0; k < 3; k++) {
        memcpy(m->positions + 3 * m->vertex_count, p[is_flipped ? 2 - k : k],
               3 * sizeof(float));
        m->triangles[3 * m->triangle_count + k] = (uint32_t)m->vertex_count++;
    }
    m->triangle_count++;
}

/* Breaks a mesh in several ways, a fraction of the triangles in each. Triangles get vertices of
 * their own, as in STL. */
static cw_mesh break_mesh(const cw_mesh *m, int ways, double fraction, double noise_mm)
{
    const float cut_from = 20;
    cw_mesh out;
    cw_error err = {0};
    assert_ok(cwi_mesh_alloc(&out, 6 * m->triangle_count, 2 * m->triangle_count, false, &err),
              err);
    out.vertex_count = out.triangle_count = 0;
    for (size_t t = 0; t < m->triangle_count; t++) {
        const double dice = random_number() / fraction;
        float p[3][3];
        for (size_t k = 0; k < 9; k++) {
            const uint32_t v = m->triangles[3 * t + k / 3];
            const double noise =
                ways & CROSSING && v % 97 == 13 ? noise_mm * cwi_gaussian(1, 3 * v + k % 3) : 0;
            p[k / 3][k % 3] = (float)((double)m->positions[3 * (size_t)v + k % 3] + noise);
        }
        if ((ways & DELETED && dice < 1) || (ways & CUT && p[0][0] > cut_from))
            continue;
        push_triangle(&out, (const float(*)[3])p, ways & FLIPPED && dice >= 1 && dice < 2);
        if (ways & DOUBLED && dice >= 2 && dice < 3)
            push_triangle(&out, (const float(*)[3])p, false);
    }
    return out;
}

static void broken_scans_become_solids(void **state)
{
    (void)state;
    static const cw_field fields[] = {CW_FIELD_SPHERE, CW_FIELD_GYROID};
    test_seed(1);
    for (int field = 0; field < 2; field++) {
        cw_mesh whole = extract_field(fields[field], field ? 12 : 16);
        for (int ways = 0; ways < ALL_WAYS; ways += test_is_short() ? 5 : 1) {
            char name[64];
            cw_mesh m = break_mesh(&whole, ways, 0.03, 2);
            snprintf(name, sizeof name, "field %d, ways %d", field, ways);
            const cw_repair_facts facts = repair_mesh(&m, NULL);
            assert_true(facts.is_sound);
            assert_repaired(&m, name);
            assert_int_equal(facts.duplicates > 0, (ways & DOUBLED) != 0);
            assert_int_equal(facts.flipped_triangles > 0, (ways & FLIPPED) != 0);
            assert_int_equal(facts.holes_filled > 0, (ways & (DELETED | CUT)) != 0);
            if (!(ways & (CUT | CROSSING)))
                assert_true(measure_distance(&m, &whole) < (ways & DELETED ? 3 : 1e-4));
            cw_mesh_free(&m);
        }
        cw_mesh_free(&whole);
    }
}

/* Where a third of all triangles is missing, little is certain, but the result is sound; any shape is accepted. */
static void hopeless_meshes_become_solids(void **state)
{
    (void)state;
    cw_mesh whole = extract_field(CW_FIELD_GYROID, 12);
    test_seed(2);
    for (int n = 0; n < test_some(8); n++) {
        cw_mesh m = break_mesh(&whole, DELETED | DOUBLED | FLIPPED | CROSSING, 0.3, 8);
        const cw_repair_facts facts = repair_mesh(&m, &(cw_repair_desc){.max_move_mm = 1e3});
        assert_true(facts.is_sound && facts.crossings_before > 0);
        assert_repaired(&m, "hopeless");
        cw_mesh_free(&m);
    }
    cw_mesh_free(&whole);
}

/* The unit does not matter, but for the digits of single precision. */
static void scales_give_the_same_repair(void **state)
{
    (void)state;
    static const double scales[] = {1e-4, 1e4};
    cw_mesh whole = extract_field(CW_FIELD_SPHERE, 16);
    for (int n = 0; n < 2; n++) {
        test_seed(3);
        cw_mesh one = break_mesh(&whole, ALL_WAYS - 1, 0.05, 2), scaled = copy_mesh(&one);
        for (size_t c = 0; c < 3 * one.vertex_count; c++)
            scaled.positions[c] = (float)((double)scaled.positions[c] * scales[n]);
        const cw_repair_facts a = repair_mesh(&one, NULL), b = repair_mesh(&scaled, NULL);
        assert_repaired(&scaled, "scaled");
        assert_int_equal(a.holes_filled, b.holes_filled);
        assert_int_equal(a.duplicates, b.duplicates);
        assert_int_equal(a.flipped_triangles, b.flipped_triangles);
        assert_within(b.largest_hole_mm / scales[n], a.largest_hole_mm, 1e-5);
        assert_within(test_measure(&scaled).volume_mm3 / pow(scales[n], 3),
                      test_measure(&one).volume_mm3, 0.01);
        cw_mesh_free(&one);
        cw_mesh_free(&scaled);
    }
    cw_mesh_free(&whole);
}

static void threads_and_repetition_do_not_matter(void **state)
{
    (void)state;
    cw_mesh whole = extract_field(CW_FIELD_GYROID, 20);
    test_seed(4);
    cw_mesh one = break_mesh(&whole, ALL_WAYS - 1, 0.05, 4), many = copy_mesh(&one);
    const cw_repair_facts a = repair_mesh(&one, &(cw_repair_desc){.threads = 1}),
                          b = repair_mesh(&many, &(cw_repair_desc){.threads = 5});
    test_assert_same_mesh(&one, &many);
    assert_int_equal(a.removed_triangles, b.removed_triangles);
    const cw_repair_facts again = repair_mesh(&one, NULL);
    assert_true(a.is_needed && !again.is_needed && again.is_sound);
    test_assert_same_mesh(&one, &many);
    cw_mesh_free(&whole);
    cw_mesh_free(&one);
    cw_mesh_free(&many);
}

/* --- options ------------------------------------------------------------------------------ */

static void large_holes_stay_when_a_limit_says_so(void **state)
{
    (void)state;
    cw_mesh m = plant_mesh("tube"), flat = plant_mesh("tube");
    cw_repair_facts facts = repair_mesh(&m, &(cw_repair_desc){.max_hole_mm = 20});
    assert_true(facts.holes_left == 2 && facts.holes_filled == 0 && !facts.is_sound);
    assert_int_equal(test_measure(&m).border_loops, 2);
    assert_within(facts.largest_hole_mm, 20 * sqrt(2), 1e-6);
    assert_within(facts.largest_rim_mm, 24 * 10 * sin(PI / 12), 1e-6);
    assert_true(facts.largest_fill_mm2 == 0);
    facts = repair_mesh(&flat, &(cw_repair_desc){.max_hole_mm = 30, .flat_holes = true});
    assert_true(facts.holes_filled == 2 && facts.is_sound);
    assert_within(facts.largest_fill_mm2, 12 * 50 * sin(PI / 6), 1e-6);
    assert_within(test_measure(&flat).volume_mm3, 10 * 12 * 50 * sin(PI / 6), 1e-6);
    cw_mesh_free(&m);
    cw_mesh_free(&flat);
}

/* A sphere of 30 mm lost a cap of 10 mm: a smooth patch brings most of it back, at any resolution. */
static void patches_continue_the_surface(void **state)
{
    (void)state;
    for (size_t n = 16; n <= 64; n *= 2) {
        cw_mesh whole = extract_field(CW_FIELD_SPHERE, n), m = copy_mesh(&whole), flat;
        size_t kept = 0;
        for (size_t t = 0; t < m.triangle_count; t++)
            if (m.positions[3 * (size_t)m.triangles[3 * t]] < 20)
                memmove(m.triangles + 3 * kept++, m.triangles + 3 * t, 3 * sizeof *m.triangles);
        m.triangle_count = kept;
        flat = copy_mesh(&m);
        repair_mesh(&m, NULL);
        repair_mesh(&flat, &(cw_repair_desc){.flat_holes = true});
        assert_true(measure_distance(&m, &whole) < 2);
        assert_true(measure_distance(&flat, &whole) > 6);
        cw_mesh_free(&whole);
        cw_mesh_free(&m);
        cw_mesh_free(&flat);
    }
}

/* Corners of neighbours differ by less than a micrometre. */
static void near_vertices_are_welded(void **state)
{
    (void)state;
    cw_mesh whole = extract_field(CW_FIELD_SPHERE, 16), m;
    test_seed(5);
    m = break_mesh(&whole, 0, 0.1, 0);
    for (size_t c = 0; c < 3 * m.vertex_count; c++)
        m.positions[c] += (float)(0.0005 * random_number());
    cw_mesh apart = copy_mesh(&m);
    cw_repair_facts facts = repair_mesh(&m, &(cw_repair_desc){.weld_mm = 0.002});
    assert_int_equal(facts.welded, 3 * whole.triangle_count - whole.vertex_count);
    assert_true(!facts.holes_filled && facts.is_sound);
    assert_repaired(&m, "welded");
    cw_error err = {0};
    assert_int_equal(
        cw_mesh_repair(&apart, &(cw_repair_desc){.keep_cracks = true}, NULL, &facts, &err),
        CW_ERR_EMPTY);
    assert_int_equal(facts.sheets, whole.triangle_count);
    cw_mesh_free(&whole);
    cw_mesh_free(&m);
    cw_mesh_free(&apart);
}

static void facts_come_without_a_mesh(void **state)
{
    (void)state;
    cw_mesh m = plant_mesh("fin");
    cw_repair_facts facts;
    cw_error err = {0};
    assert_ok(cw_mesh_repair(&m, NULL, NULL, &facts, &err), err);
    assert_true(facts.is_needed && facts.is_sound && facts.sheets == 1);
    assert_ok(cw_mesh_repair(&m, NULL, NULL, NULL, &err), err);
    cw_mesh_free(&m);
    m = plant_mesh("crossed_bars");
    const cw_repair_facts kept = repair_mesh(&m, &(cw_repair_desc){.keep_crossings = true});
    assert_true(kept.crossings_before == 22 && kept.crossings_after == 22 && !kept.is_sound);
    cw_mesh_free(&m);
}

static void attributes_stay_and_new_vertices_get_near_ones(void **state)
{
    (void)state;
    cw_mesh m = extract_field(CW_FIELD_SPHERE, 24);
    assert_non_null(m.normals);
    m.scalars = cwi_alloc_array(m.vertex_count, sizeof *m.scalars);
    m.colors = cwi_alloc_array(m.vertex_count, 4);
    m.labels = cwi_alloc_array(m.vertex_count, sizeof *m.labels);
    for (size_t v = 0; v < m.vertex_count; v++) {
        m.scalars[v] = m.positions[3 * v + 2];
        m.labels[v] = m.positions[3 * v] < 0 ? 1 : 2;
        memset(m.colors + 4 * v, m.positions[3 * v] < 0 ? 10 : 200, 4);
    }
    size_t kept = 0;
    for (size_t t = 0; t < m.triangle_count; t++)
        if (m.positions[3 * (size_t)m.triangles[3 * t]] < 20)
            memmove(m.triangles + 3 * kept++, m.triangles + 3 * t, 3 * sizeof *m.triangles);
    m.triangle_count = kept;
    const size_t vertices = m.vertex_count;
    const cw_repair_facts facts = repair_mesh(&m, NULL);
    assert_true(facts.holes_filled > 0 && facts.is_sound && facts.added_triangles > 20);
    assert_true(m.scalars && m.colors && m.labels && m.normals && m.vertex_count < vertices);
    for (size_t v = 0; v < m.vertex_count; v++) {
        const float *p = m.positions + 3 * v;
        assert_near((double)m.scalars[v], (double)p[2], p[0] < 15 ? 1e-5 : 25);
        if (fabsf(p[0]) > 3)
            assert_true(m.labels[v] == (p[0] < 0 ? 1 : 2) &&
                        m.colors[4 * v] == (p[0] < 0 ? 10 : 200));
    }
    cw_mesh again = copy_mesh(&m);
    cw_error err = {0};
    assert_ok(cw_mesh_normals(&again, &err), err);
    test_assert_same_mesh(&m, &again);
    cw_mesh_free(&again);
    cw_mesh_free(&m);
}

/* --- failures ----------------------------------------------------------------------------- */

/* A result that moves, or has another volume, is refused; the volume before is known though the mesh is broken. */
static void other_shapes_are_refused(void **state)
{
    (void)state;
    cw_mesh m = plant_mesh("touching_tip"), out;
    cw_repair_facts facts;
    cw_error err = {0};
    assert_fails(cw_mesh_repair(&m, &(cw_repair_desc){.max_move_mm = 1e-6}, &out, &facts, &err),
                 CW_ERR_CHECK, "a repair would change", err);
    assert_true(facts.is_refused && facts.moves_far && facts.changes_volume && !out.positions);
    cw_mesh_free(&m);
    m = plant_mesh("ball");
    const double volume = test_measure(&m).volume_mm3;
    for (size_t t = 0; t < m.triangle_count; t += 37) { /* holes, and triangles inside out */
        uint32_t *c = m.triangles + 3 * t, corner = c[0];
        c[0] = t % 2 ? c[1] : c[0];
        c[1] = t % 2 ? corner : c[0];
    }
    facts = repair_mesh(&m, NULL);
    assert_true(fabs(facts.volume_before_mm3 - volume) < 0.02 * volume);
    assert_true(facts.volume_changed < 0.01 && !facts.is_refused);
    cw_mesh_free(&m);
}

static void bad_arguments_are_named(void **state)
{
    (void)state;
    cw_mesh m = plant_mesh("cube"), none = {0}, out;
    cw_repair_facts facts;
    cw_error err = {0};
    assert_fails(cw_mesh_repair(NULL, NULL, NULL, NULL, &err), CW_ERR_ARGUMENT,
                 "'mesh' is NULL", err);
    assert_fails(cw_mesh_repair(&none, NULL, &out, &facts, &err), CW_ERR_EMPTY,
                 "the mesh has no triangles", err);
    assert_fails(cw_mesh_repair(&m, &(cw_repair_desc){.weld_mm = -1}, &out, &facts, &err),
                 CW_ERR_ARGUMENT, "weld_mm is -1; it must be finite, and 0 or more", err);
    assert_fails(
        cw_mesh_repair(&m, &(cw_repair_desc){.max_hole_mm = (double)NAN}, &out, &facts, &err),
        CW_ERR_ARGUMENT, "max_hole_mm is", err);
    assert_fails(
        cw_mesh_repair(&m, &(cw_repair_desc){.wrap_mm = (double)INFINITY}, &out, &facts, &err),
        CW_ERR_ARGUMENT, "wrap_mm is inf", err);
    assert_fails(cw_mesh_repair(&m, &(cw_repair_desc){.max_move_mm = -1}, &out, &facts, &err),
                 CW_ERR_ARGUMENT, "max_move_mm is -1", err);
    m.positions[5] = (float)NAN;
    assert_fails(cw_mesh_repair(&m, NULL, &out, &facts, &err), CW_ERR_ARGUMENT,
                 "position of vertex 1 is not finite", err);
    m.positions[5] = 0;
    m.triangles[0] = 8;
    assert_fails(cw_mesh_repair(&m, NULL, &out, &facts, &err), CW_ERR_ARGUMENT,
                 "triangle 0 names", err);
    cw_mesh_free(&m);
    test_make_cube(&m); /* the largest numbers do not overflow */
    for (size_t c = 0; c < 24; c++)
        m.positions[c] = m.positions[c] > 0.5f ? FLT_MAX : -FLT_MAX;
    m.triangle_count--;
    repair_mesh(&m, &(cw_repair_desc){.weld_mm = 1});
    cw_mesh_free(&m);
}

typedef struct stopper {
    int calls, stop_at;
    double last;
    bool fell;
} stopper;

static bool count_calls(void *user, const char *step, double done)
{
    stopper *s = user;
    assert_true(step[0] != 0);
    s->fell = s->fell || done < s->last || done > 1;
    s->last = done;
    return ++s->calls != s->stop_at;
}

static void failures_and_cancelling_leave_nothing(void **state)
{
    (void)state;
    cw_mesh whole = extract_field(CW_FIELD_SPHERE, 8);
    test_seed(6);
    cw_mesh broken = break_mesh(&whole, ALL_WAYS - 1, 0.1, 9), m = copy_mesh(&broken), out;
    cw_repair_desc desc = {.threads = 1, .weld_mm = 1e-3};
    cw_error err = {0};
    stopper s = {0};
    desc.progress = (cw_progress){count_calls, &s};
    for (int stop = 1;; stop++) {
        s = (stopper){.stop_at = stop};
        const cw_status st = cw_mesh_repair(&m, &desc, &out, NULL, &err);
        if (st == CW_OK)
            break;
        assert_int_equal(st, CW_ERR_CANCELLED);
        assert_true(!out.positions && !out.triangles);
    }
    assert_true(s.calls > 5 && !s.fell && s.last == 1);
    desc.progress = (cw_progress){0};
    cw_mesh_free(&out);
    test_repair_without_memory(&m, &desc, 100);
    test_assert_same_mesh(&m, &broken);
    cw_mesh_free(&whole);
    cw_mesh_free(&broken);
    cw_mesh_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_defect_is_told_apart_and_repaired),
        cmocka_unit_test(sheets_and_strips_leave_nothing),
        cmocka_unit_test(wraps_are_solids_around_sheets),
        cmocka_unit_test(sound_meshes_are_wrapped_if_asked_for),
        cmocka_unit_test(crossing_solids_are_united),
        cmocka_unit_test(broken_scans_become_solids),
        cmocka_unit_test(hopeless_meshes_become_solids),
        cmocka_unit_test(scales_give_the_same_repair),
        cmocka_unit_test(threads_and_repetition_do_not_matter),
        cmocka_unit_test(large_holes_stay_when_a_limit_says_so),
        cmocka_unit_test(patches_continue_the_surface),
        cmocka_unit_test(near_vertices_are_welded),
        cmocka_unit_test(facts_come_without_a_mesh),
        cmocka_unit_test(attributes_stay_and_new_vertices_get_near_ones),
        cmocka_unit_test(other_shapes_are_refused),
        cmocka_unit_test(bad_arguments_are_named),
        cmocka_unit_test(failures_and_cancelling_leave_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
