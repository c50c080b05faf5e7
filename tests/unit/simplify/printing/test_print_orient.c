/* The orientation of a print: known shapes, every base of random solids, the plate, and errors. */
#include "support/solids.h"

#include "core/base/memory.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "simplify/printing/rest_pose.h"

#include <cubewright/print.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

static cw_orient_facts orient(const cw_mesh *mesh, const cw_print_desc *desc)
{
    cw_orient_facts facts;
    cw_error err = {0};
    assert_ok(cw_orient_print(mesh, desc, &facts, &err), err);
    return facts;
}

/* A rotation by random angles. */
static void make_rotation(double m[12])
{
    double q[4], length = 0;
    for (int k = 0; k < 4; k++) {
        q[k] = test_random() - 0.5;
        length += q[k] * q[k];
    }
    for (int k = 0; k < 4; k++)
        q[k] /= sqrt(length);
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double r[12] = {
        1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),     7,
        2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),     -300,
        2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y), 55};
    memcpy(m, r, sizeof r);
}

static cw_mesh make_block(double x, double y, double z)
{
    cw_mesh box = test_make_boxes(1);
    test_add_box(&box, (const double[3]){0, 0, 0}, (const double[3]){x, y, z}, false);
    return box;
}

/* However a block lies, it comes to lie flat, on its largest side. */
static void a_block_lies_down(void **state)
{
    (void)state;
    srand(test_seed(5));
    for (int n = 0; n < test_some(12); n++) {
        cw_mesh box = make_block(40, 25, 10);
        cw_error err = {0};
        double m[12], low[3], high[3];
        make_rotation(m);
        assert_ok(cw_mesh_transform(&box, m, &err), err);
        const cw_orient_facts facts = orient(&box, NULL);
        assert_false(facts.is_kept);
        assert_true(facts.is_stable);
        assert_near(facts.after.height_mm, 10, 1e-3);
        assert_near(facts.after.overhang_mm2, 0, 1e-9);
        assert_within(facts.after.hull_mm2, 1000, 1e-3);
        assert_near(facts.after.tip_deg, atan2(12.5, 5) * 180 / 3.14159265358979, 0.1);
        assert_ok(cw_mesh_transform(&box, facts.matrix, &err), err);
        cw_mesh_bounds(&box, low, high);
        assert_near(high[2] - low[2], 10, 1e-3);
        const cw_orient_facts again = orient(&box, NULL);
        assert_true(again.is_kept && again.matrix[0] == 1 && again.matrix[5] == 1);
        cw_mesh_free(&box);
    }
}

/* A table stands on its top; a pyramid on its base, not on its tip. */
static void shapes_stand_as_they_should(void **state)
{
    (void)state;
    cw_mesh table = test_make_boxes(2);
    test_add_box(&table, (const double[3]){15, 15, 0}, (const double[3]){25, 25, 30}, false);
    test_add_box(&table, (const double[3]){0, 0, 30}, (const double[3]){40, 40, 34}, false);
    cw_orient_facts facts = orient(&table, NULL);
    assert_true(facts.after.up[2] == -1);
    assert_near(facts.before.overhang_mm2, 1600, 1e-6);
    assert_near(facts.after.height_mm, 34, 1e-4);
    assert_true(facts.after.overhang_mm2 < 150); /* where the leg meets the top */
    cw_mesh_free(&table);
    cw_mesh tip;
    test_make_tetrahedron(&tip);
    for (size_t i = 0; i < 3 * tip.vertex_count; i++)
        tip.positions[i] *= 30;
    facts = orient(&tip, NULL);
    assert_true(facts.is_stable && facts.after.hull_mm2 > 400);
    cw_mesh_free(&tip);
}

/* Lays a triangle of a copy on the plate, and measures that print. Returns false if points are below the triangle, or it
 * has no area. */
static bool measure_on(const cw_mesh *mesh, size_t triangle, cw_print_facts *facts)
{
    double e[2][3], down[3], x[3] = {0}, y[3], length = 0, bottom = 0;
    const float *p[3];
    for (size_t k = 0; k < 3; k++)
        p[k] = mesh->positions + 3 * (size_t)mesh->triangles[3 * triangle + k];
    for (int a = 0; a < 3; a++) {
        e[0][a] = (double)p[1][a] - (double)p[0][a];
        e[1][a] = (double)p[2][a] - (double)p[0][a];
    }
    for (int a = 0; a < 3; a++) {
        down[a] = e[0][(a + 1) % 3] * e[1][(a + 2) % 3] - e[0][(a + 2) % 3] * e[1][(a + 1) % 3];
        length += down[a] * down[a];
    }
    if (!(length > 1e-3))
        return false;
    for (int a = 0; a < 3; a++) {
        down[a] /= sqrt(length);
        bottom += down[a] * (double)p[0][a];
    }
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const float *q = mesh->positions + 3 * v;
        if ((double)q[0] * down[0] + (double)q[1] * down[1] + (double)q[2] * down[2] >
            bottom + 1e-3)
            return false;
    }
    length = sqrt(e[0][0] * e[0][0] + e[0][1] * e[0][1] + e[0][2] * e[0][2]);
    for (int a = 0; a < 3; a++)
        x[a] = e[0][a] / length;
    for (int a = 0; a < 3; a++)
        y[a] = x[(a + 1) % 3] * down[(a + 2) % 3] - x[(a + 2) % 3] * down[(a + 1) % 3];
    const double m[12] = {x[0], x[1], x[2],     0,        y[0],     y[1],
                          y[2], 0,    -down[0], -down[1], -down[2], 0};
    cw_mesh copy = {0};
    cw_error err = {0};
    assert_ok(cwi_mesh_copy(mesh, &copy, &err), err);
    assert_ok(cw_mesh_transform(&copy, m, &err), err);
    assert_ok(cw_print_measure(&copy, NULL, facts, &err), err);
    cw_mesh_free(&copy);
    return true;
}

/* Each triangle of random solids that can lie on the plate is tried: where it stands, it has no fewer overhangs than
 * the pose that is found, to a thousandth of the surface. */
static void no_triangle_is_a_better_base(void **state)
{
    (void)state;
    static const test_pair_kind kinds[] = {PAIR_STARS, PAIR_BOXES, PAIR_NEEDLES};
    const unsigned solids =
        (unsigned)(test_some(9) < 3 ? 3 : test_some(9)); /* one of each kind */
    size_t stood = 0;
    for (unsigned n = 0; n < solids; n++) {
        cw_mesh pair[2];
        double low[3], high[3], m[12];
        cw_error err = {0};
        test_make_pair(kinds[n % 3], test_seed(70 + n), pair);
        cw_mesh *mesh = &pair[0];
        cw_mesh_bounds(mesh, low, high);
        const double scale =
            60 / fmax(fmax(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
        const double map[12] = {scale, 0, 0, 0, 0, scale, 0, 0, 0, 0, scale, 0};
        assert_ok(cw_mesh_transform(mesh, map, &err), err);
        make_rotation(m);
        assert_ok(cw_mesh_transform(mesh, m, &err), err);
        const cw_orient_facts found = orient(mesh, NULL);
        for (size_t t = 0; t < mesh->triangle_count; t++) {
            cw_print_facts print;
            if (!measure_on(mesh, t, &print) || print.tip_deg < CW_MIN_TIP_DEG + 0.5)
                continue;
            stood++;
            assert_true(found.is_stable);
            assert_true(found.after.overhang_mm2 <= print.overhang_mm2 + 2e-3 * print.area_mm2);
        }
        cw_mesh_free(&pair[0]);
        cw_mesh_free(&pair[1]);
    }
    assert_true(stood > 0);
}

/* A ball tips over nowhere in particular: it may stay. Another angle counts other surfaces. */
static void a_ball_stays(void **state)
{
    (void)state;
    cw_mesh ball = test_extract_field(CW_FIELD_SPHERE, 40);
    const cw_orient_facts facts = orient(&ball, NULL);
    const cw_orient_facts flat = orient(&ball, &(cw_print_desc){.overhang_deg = 80});
    assert_true(flat.after.overhang_mm2 < facts.after.overhang_mm2);
    assert_int_equal(facts.directions, 10000);
    assert_true(facts.before.hull_mm2 > 0);
    cw_mesh_free(&ball);
}

/* A block too long for the plate stands up. */
static void the_plate_holds_the_print(void **state)
{
    (void)state;
    cw_mesh box = make_block(40, 25, 10);
    const cw_orient_facts facts = orient(&box, &(cw_print_desc){.plate_mm = {30, 30, 60}});
    assert_near(facts.after.height_mm, 40, 1e-3);
    cw_mesh_free(&box);
}

static void threads_change_nothing(void **state)
{
    (void)state;
    cw_mesh mesh = test_extract_field(CW_FIELD_GYROID, 24);
    const cw_orient_facts one = orient(&mesh, &(cw_print_desc){.threads = 1}),
                          many = orient(&mesh, &(cw_print_desc){.threads = 5});
    assert_memory_equal(&one, &many, sizeof one);
    cw_mesh_free(&mesh);
}

static void what_makes_no_sense_is_refused(void **state)
{
    (void)state;
    cw_mesh box = make_block(4, 2, 1), empty = {0};
    cw_orient_facts facts;
    cw_error err = {0};
    assert_fails(cw_orient_print(&empty, NULL, &facts, &err), CW_ERR_EMPTY, "no triangles",
                 err);
    assert_fails(cw_orient_print(&box, &(cw_print_desc){.overhang_deg = 90}, &facts, &err),
                 CW_ERR_ARGUMENT, "overhang_deg", err);
    long n = 0;
    for (;; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st =
            cw_orient_print(&box, &(cw_print_desc){.threads = 1}, &facts, NULL);
        const bool failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        if (!failed)
            break;
    }
    assert_true(n > 8);
    cw_mesh_free(&box);
}

/* Returns how far a body reaches along a direction. */
static double find_support(const cwi_rest_body *body, const double direction[3])
{
    double max = -INFINITY;
    for (size_t n = 0; n < body->count; n++)
        max = fmax(max, cwi_dot(body->points[n], direction));
    return max;
}

/* A ball, an ellipsoid, or a shell with points all through it. */
static void fill_body(cwi_rest_body *body, size_t count, int shape)
{
    body->points = cwi_alloc_array(count, sizeof *body->points);
    assert_non_null(body->points);
    for (body->count = 0; body->count < count;) {
        double *p = body->points[body->count], length_sq = 0;
        for (int a = 0; a < 3; a++) {
            p[a] = 2 * test_random() - 1;
            length_sq += p[a] * p[a];
        }
        if (length_sq > 1 || (shape == 2 && length_sq < 0.9 && test_random() < 0.8))
            continue;
        for (int a = 0; a < 3; a++)
            p[a] = (shape == 1 ? 20 * (a + 1) : 50) * p[a] + 1000;
        body->count++;
    }
}

/* Dropped points are deeper than asked for, whichever way is down. */
static void points_near_the_hull_stay(void **state)
{
    (void)state;
    enum { COUNT = 20000, DIRECTIONS = 500 };
    const double depth = 0.2;
    srand(test_seed(8));
    for (int shape = 0; shape < 3; shape++) {
        cwi_rest_body all = {0}, kept = {0};
        cw_error err = {0};
        fill_body(&all, COUNT, shape);
        kept.points = cwi_alloc_array(COUNT, sizeof *kept.points);
        assert_non_null(kept.points);
        memcpy(kept.points, all.points, COUNT * sizeof *kept.points);
        kept.count = COUNT;
        assert_ok(cwi_rest_body_drop_inner(&kept, depth, &err), err);
        assert_true(kept.count < 0.9 * COUNT);
        for (int n = 0; n < DIRECTIONS; n++) {
            double d[3] = {test_random() - 0.5, test_random() - 0.5, test_random() - 0.5};
            if (n < 3)
                memcpy(d, (const double[3]){n == 0, n == 1, n == 2}, sizeof d);
            if (!cwi_normalise(d))
                continue;
            const double support = find_support(&all, d);
            assert_true(find_support(&kept, d) == support);
            size_t near[2] = {0, 0};
            for (size_t k = 0; k < COUNT; k++) {
                near[0] += support - cwi_dot(all.points[k], d) <= depth;
                near[1] += k < kept.count && support - cwi_dot(kept.points[k], d) <= depth;
            }
            assert_int_equal(near[0], near[1]);
        }
        cwi_rest_body_free(&all);
        cwi_rest_body_free(&kept);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_block_lies_down),
        cmocka_unit_test(shapes_stand_as_they_should),
        cmocka_unit_test(no_triangle_is_a_better_base),
        cmocka_unit_test(a_ball_stays),
        cmocka_unit_test(the_plate_holds_the_print),
        cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(points_near_the_hull_stay),
        cmocka_unit_test(what_makes_no_sense_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
