/* Meshes with planted faults: our checks know each, and CGAL agrees where it takes the mesh. */
#include "support/planted.h"

#include <math.h>

static void expect(const char *mesh, const char *what, long long got, long long expected)
{
    if (got != expected)
        fail_msg("%s: %s is %lld, not %lld", mesh, what, got, expected);
}

#define EXPECT(field) expect(row->name, #field, (long long)q.field, (long long)row->field)

static cw_quality measure(const cw_mesh *mesh)
{
    cw_quality q;
    cw_error err = {0};
    const cw_quality_desc desc = {.weld = CW_WELD_LOCAL, .shells = true};
    assert_ok(cw_quality_measure(mesh, &desc, &q, &err), err);
    return q;
}

static size_t count_crossings(const cw_mesh *mesh)
{
    cw_crossings x;
    cw_error err = {0};
    const cw_crossings_desc desc = {.weld = CW_WELD_LOCAL};
    assert_ok(cw_self_intersections(mesh, &desc, &x, &err), err);
    assert_false(x.undecided);
    const size_t count = x.count;
    cw_crossings_free(&x);
    return count;
}

static void what_was_planted_is_found(void **state)
{
    (void)state;
    for (size_t n = 0; n < test_planted_count; n++) {
        const test_planted *row = &test_planted_meshes[n];
        cw_mesh mesh = test_plant(row);
        const cw_quality q = measure(&mesh);
        EXPECT(components);
        EXPECT(open_edges);
        EXPECT(border_loops);
        EXPECT(nonmanifold_edges);
        EXPECT(misoriented_edges);
        EXPECT(nonmanifold_vertices);
        EXPECT(contact_edges);
        EXPECT(contact_vertices);
        EXPECT(duplicates);
        EXPECT(degenerate);
        EXPECT(needles);
        EXPECT(caps);
        EXPECT(cavities);
        EXPECT(inside_out);
        EXPECT(nested);
        EXPECT(open_inward);
        EXPECT(genus);
        expect(row->name, "meets itself", count_crossings(&mesh) > 0, row->meets_itself);
        EXPECT(unused_vertices);
        cw_mesh_free(&mesh);
    }
}

static void cgal_agrees(void **state)
{
    (void)state;
    size_t taken = 0;
    if (!cw_quality_has_cgal())
        skip();
    for (size_t n = 0; n < test_planted_count; n++) {
        const test_planted *row = &test_planted_meshes[n];
        cw_mesh mesh = test_plant(row);
        cw_cgal_facts q;
        cw_error err = {0};
        assert_ok(cw_quality_ask_cgal(&mesh, CW_WELD_LOCAL, &q, &err), err);
        expect(row->name, "polygon mesh", q.is_polygon_mesh, row->genus >= 0);
        if (q.is_polygon_mesh) {
            taken++;
            expect(row->name, "closed", q.closed, row->open_edges == 0);
            EXPECT(components);
            EXPECT(border_loops);
            EXPECT(needles);
            EXPECT(caps);
            expect(row->name, "self-intersections", (long long)q.self_intersections,
                   (long long)count_crossings(&mesh));
            const cw_quality ours = measure(&mesh);
            assert_near(q.area_mm2, ours.area_mm2, 1e-9 * ours.area_mm2);
            if (q.closed)
                assert_near(q.volume_mm3, ours.volume_mm3, 1e-9 * fabs(ours.volume_mm3));
            if (q.closed && !row->meets_itself)
                expect(row->name, "bounds a volume", q.bounds_volume && q.outward,
                       !row->inside_out && !row->nested);
        }
        cw_mesh_free(&mesh);
    }
    assert_true(taken >= 25);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_was_planted_is_found),
        cmocka_unit_test(cgal_agrees),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
