/* Attributes of every kind go through what changes meshes. Their values are functions of the place, so
 * that each result tells what they must be. */
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/geometry/point_triangle.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_attributes.h"

#include <math.h>
#include <string.h>

/* One row for each kind of element, type and interpolation that values are computed for below. */
static const cw_attribute rows[] = {
    {"place", CW_ON_VERTICES, CW_F32, 3, CW_INTERPOLATE_LINEAR, NULL},
    {"tenth", CW_ON_VERTICES, CW_I16, 1, CW_INTERPOLATE_LINEAR, NULL},
    {"away", CW_ON_VERTICES, CW_F64, 3, CW_INTERPOLATE_DIRECTION, NULL},
    {"tint", CW_ON_VERTICES, CW_U8, 4, CW_INTERPOLATE_COLOR, NULL},
    {"vertex", CW_ON_VERTICES, CW_U32, 1, CW_INTERPOLATE_NEAREST, NULL},
    {"corner", CW_ON_CORNERS, CW_F64, 2, CW_INTERPOLATE_LINEAR, NULL},
    {"piece", CW_ON_TRIANGLES, CW_U32, 1, CW_INTERPOLATE_NEAREST, NULL},
    {"frame", CW_ON_PARTS, CW_F32, 16, CW_INTERPOLATE_LINEAR, NULL},
};
enum { ROWS = sizeof rows / sizeof *rows };

static void *data_of(const cw_mesh *m, const char *name)
{
    const cw_attribute *found = cw_mesh_attribute_find(m, name);
    assert_non_null(found);
    return found->data;
}

static void load_point(const cw_mesh *m, size_t v, double p[3])
{
    for (size_t a = 0; a < 3; a++)
        p[a] = (double)m->positions[3 * v + a];
}

/* The values of a point. Numbers of triangles begin with 1: 0 is that of no triangle. */
static void set_values(cw_mesh *m)
{
    float *position = data_of(m, "place"), *frame = data_of(m, "frame");
    int16_t *tenth = data_of(m, "tenth");
    double *away = data_of(m, "away"), *corner = data_of(m, "corner");
    uint8_t *tint = data_of(m, "tint");
    uint32_t *vertex = data_of(m, "vertex"), *piece = data_of(m, "piece");
    for (size_t v = 0; v < m->vertex_count; v++) {
        double p[3];
        load_point(m, v, p);
        memcpy(position + 3 * v, m->positions + 3 * v, 3 * sizeof *position);
        tenth[v] = (int16_t)lround(100 * p[0]);
        memcpy(away + 3 * v, p, sizeof p);
        cwi_normalise(away + 3 * v);
        for (size_t k = 0; k < 4; k++)
            tint[4 * v + k] = (uint8_t)lround(128 + 4 * p[k % 3]);
        vertex[v] = (uint32_t)v;
    }
    for (size_t c = 0; c < 3 * m->triangle_count; c++) {
        corner[2 * c] = (double)(c / 3 + 1);
        corner[2 * c + 1] = (double)m->positions[3 * (size_t)m->triangles[c] + 2];
        piece[c / 3] = (uint32_t)(c / 3 + 1);
    }
    for (int n = 0; n < 16; n++)
        frame[n] = (float)n;
}

static void add_rows(cw_mesh *m)
{
    cw_error err = {0};
    for (size_t n = 0; n < ROWS; n++)
        assert_ok(cw_mesh_attribute_add(m, &rows[n], NULL, &err), err);
    set_values(m);
}

/* A sphere with all rows, of radius 7 mm and edges of about 1 mm. */
static cw_mesh make_ball(void)
{
    cw_volume volume = test_sample(CW_FIELD_SPHERE, 16, CW_F32);
    cw_mesh m = test_extract(&volume, &(cw_extract_desc){.isovalue = 0}, NULL);
    cw_volume_free(&volume);
    const double scale =
        7 / sqrt(cwi_point_distance_sq(m.positions, (const float[3]){0, 0, 0}));
    for (size_t n = 0; n < 3 * m.vertex_count; n++)
        m.positions[n] = (float)(scale * (double)m.positions[n]);
    add_rows(&m);
    return m;
}

static void check_vertex(const cw_mesh *m, const cw_mesh *first, size_t v, double margin)
{
    const float *position = (float *)data_of(m, "place") + 3 * v;
    const double *away = (double *)data_of(m, "away") + 3 * v;
    const uint8_t *tint = (uint8_t *)data_of(m, "tint") + 4 * v;
    const uint32_t source = ((uint32_t *)data_of(m, "vertex"))[v];
    double p[3], q[3], unit[3];
    load_point(m, v, p);
    memcpy(unit, p, sizeof unit);
    cwi_normalise(unit);
    for (int a = 0; a < 3; a++)
        assert_near((double)position[a], p[a], margin);
    assert_near((double)((int16_t *)data_of(m, "tenth"))[v], 100 * p[0], 1.01 + 100 * margin);
    assert_near(cwi_dot(away, away), 1, 1e-9);
    assert_true(cwi_dot(away, unit) > 0.98);
    for (int k = 0; k < 4; k++)
        assert_near((double)tint[k], 128 + 4 * p[k % 3], 1.01 + 4 * margin);
    assert_true(source < first->vertex_count);
    load_point(first, source, q);
    assert_true(cwi_distance(p, q) < 1.5);
}

/* Returns how far a point is from the triangle of the first mesh that has this number. */
static double measure_distance(const cw_mesh *first, size_t number, const double p[3])
{
    const uint32_t *v = first->triangles + 3 * (number - 1);
    const float *f = first->positions;
    return sqrt(cwi_facet_distance_sq(f + 3 * (size_t)v[0], f + 3 * (size_t)v[1],
                                      f + 3 * (size_t)v[2], p));
}

/* Returns how far the middle of a triangle is from the first mesh's triangle whose number it has. */
static double check_triangle(const cw_mesh *m, const cw_mesh *first, size_t t, double margin)
{
    const uint32_t number = ((uint32_t *)data_of(m, "piece"))[t];
    const double *corner = (double *)data_of(m, "corner") + 6 * t;
    double p[3], middle[3] = {0};
    assert_true(number <= first->triangle_count);
    for (int k = 0; k < 3; k++) {
        const size_t of_corner = (size_t)lround(corner[2 * k]);
        load_point(m, m->triangles[3 * t + (size_t)k], p);
        cwi_add_scaled(middle, 1.0 / 3, p, middle);
        assert_near(corner[2 * k], (double)of_corner, 1e-6);
        assert_near(corner[2 * k + 1], number ? p[2] : 0, margin);
        assert_int_equal(of_corner > 0, number > 0);
        assert_true(!number || measure_distance(first, of_corner, p) < margin);
    }
    return number ? measure_distance(first, number, middle) : 0;
}

/* Checks that a mesh has all rows, and values as computed.
 * distant  set to the triangles that are not where the one of their number was; may be NULL
 * Returns  the triangles that have no number */
static size_t check_rows(const cw_mesh *m, const cw_mesh *first, double margin, size_t *distant)
{
    size_t unnumbered = 0, far = 0;
    assert_int_equal(m->attribute_count, ROWS);
    for (size_t n = 0; n < ROWS; n++) {
        const cw_attribute *a = cw_mesh_attribute_find(m, rows[n].name);
        assert_true(a && a->on == rows[n].on && a->type == rows[n].type &&
                    a->components == rows[n].components &&
                    a->interpolation == rows[n].interpolation);
    }
    for (size_t v = 0; v < m->vertex_count; v++)
        check_vertex(m, first, v, margin);
    for (size_t t = 0; t < m->triangle_count; t++) {
        unnumbered += !((uint32_t *)data_of(m, "piece"))[t];
        far += check_triangle(m, first, t, margin) > 1e-4;
    }
    for (int n = 0; n < 16; n++)
        assert_near((double)((float *)data_of(m, "frame"))[n], n, 0);
    if (distant)
        *distant = far;
    else
        assert_int_equal(far, 0);
    return unnumbered;
}

/* Gives each triangle vertices of its own. */
static cw_mesh make_soup(const cw_mesh *m)
{
    cw_mesh soup;
    cw_error err = {0};
    assert_ok(cwi_mesh_alloc(&soup, 3 * m->triangle_count, m->triangle_count, false, &err),
              err);
    assert_ok(cwi_attributes_alloc(m, &soup, &err), err);
    for (size_t c = 0; c < 3 * m->triangle_count; c++) {
        const size_t v = m->triangles[c];
        memcpy(soup.positions + 3 * c, m->positions + 3 * v, 3 * sizeof *soup.positions);
        soup.triangles[c] = (uint32_t)c;
        cwi_attributes_put(m, v, &soup, c);
    }
    for (size_t t = 0; t < m->triangle_count; t++)
        cwi_attributes_put_triangle(m, t, m->triangles + 3 * t, &soup, t);
    return soup;
}

static void attributes_are_added_found_and_removed(void **state)
{
    (void)state;
    cw_mesh m = make_ball();
    cw_error err = {0};
    cw_attribute *row = NULL, wrong = rows[0];
    assert_null(cw_mesh_attribute_find(&m, "other"));
    assert_null(cw_mesh_attribute_find(&m, "normals"));
    cw_mesh_attribute_remove(&m, "other");
    cw_mesh_attribute_remove(&m, "tenth");
    assert_null(cw_mesh_attribute_find(&m, "tenth"));
    assert_int_equal(m.attribute_count, ROWS - 1);
    assert_memory_equal(data_of(&m, "place"), m.positions, 12 * m.vertex_count);
    assert_ok(cw_mesh_attribute_add(&m, &rows[1], &row, &err), err);
    assert_ptr_equal(row, cw_mesh_attribute_find(&m, "tenth"));
    for (size_t v = 0; v < m.vertex_count; v++)
        assert_int_equal(((int16_t *)row->data)[v], 0);
    assert_fails(cw_mesh_attribute_add(&m, &wrong, NULL, &err), CW_ERR_ARGUMENT, "in use", err);
    strcpy(wrong.name, "labels");
    assert_fails(cw_mesh_attribute_add(&m, &wrong, NULL, &err), CW_ERR_ARGUMENT, "in use", err);
    wrong.name[0] = 0;
    assert_fails(cw_mesh_attribute_add(&m, &wrong, NULL, &err), CW_ERR_ARGUMENT, "1 to 31",
                 err);
    memset(wrong.name, 'x', sizeof wrong.name);
    assert_fails(cw_mesh_attribute_add(&m, &wrong, NULL, &err), CW_ERR_ARGUMENT, "1 to 31",
                 err);
    strcpy(wrong.name, "new");
    wrong.components = 5;
    assert_fails(cw_mesh_attribute_add(&m, &wrong, NULL, &err), CW_ERR_ARGUMENT, "5", err);
    wrong.components = 3;
    wrong.on = CW_ON_COUNT;
    assert_fails(cw_mesh_attribute_add(&m, &wrong, NULL, &err), CW_ERR_ARGUMENT, "on 4", err);
    assert_int_equal(m.attribute_count, ROWS);
    cw_mesh_free(&m);
    assert_int_equal(m.attribute_count, 0);
}

static void welding_keeps_those_of_the_first_vertex(void **state)
{
    (void)state;
    cw_mesh m = make_ball(), soup = make_soup(&m);
    cw_error err = {0};
    check_rows(&soup, &m, 1e-6, NULL);
    assert_ok(cw_mesh_weld(&soup, NULL, &err), err);
    assert_int_equal(soup.vertex_count, m.vertex_count);
    assert_int_equal(check_rows(&soup, &m, 1e-6, NULL), 0);
    cw_mesh_free(&m);
    cw_mesh_free(&soup);
}

/* Joins a ball and a small one far away, and drops the small one again. */
static void joined_meshes_keep_what_both_have(void **state)
{
    (void)state;
    cw_mesh m = make_ball(), small = make_ball(), both;
    cw_error err = {0};
    size_t dropped, kept;
    for (size_t n = 0; n < 3 * small.vertex_count; n++)
        small.positions[n] *= 0.1f;
    small.origin[0] = m.origin[0] + 50;
    assert_ok(cwi_mesh_copy(&m, &both, &err), err);
    assert_ok(cwi_mesh_append(&both, &small, &err), err);
    assert_int_equal(both.triangle_count, 2 * m.triangle_count);
    assert_near((double)both.positions[3 * m.vertex_count], (double)small.positions[0] + 50,
                1e-5);
    const uint32_t *pieces = data_of(&both, "piece");
    assert_memory_equal(pieces + m.triangle_count, pieces, 4 * m.triangle_count);
    assert_ok(cw_mesh_drop_components(&both, 5, &dropped, &kept, &err), err);
    assert_int_equal(dropped, 1);
    assert_int_equal(check_rows(&both, &m, 1e-6, NULL), 0);
    cw_mesh_attribute_remove(&small, "away");
    cw_mesh_attribute_find(&small, "tint")->interpolation = CW_INTERPOLATE_LINEAR;
    cwi_free(small.normals);
    small.normals = NULL;
    assert_ok(cwi_mesh_append(&both, &small, &err), err);
    assert_null(cw_mesh_attribute_find(&both, "away"));
    assert_null(cw_mesh_attribute_find(&both, "tint"));
    assert_null(both.normals);
    assert_int_equal(both.attribute_count, ROWS - 2);
    cw_mesh_free(&m);
    cw_mesh_free(&small);
    cw_mesh_free(&both);
}

static void dropped_triangles_take_theirs_along(void **state)
{
    (void)state;
    cw_mesh m = make_ball(), left;
    cw_error err = {0};
    bool *marked = cwi_alloc_zeroed(m.triangle_count, sizeof *marked);
    size_t kept = 0;
    for (size_t t = 0; t < m.triangle_count; t++)
        kept += !(marked[t] = m.positions[3 * (size_t)m.triangles[3 * t]] < 0 || t % 7 == 0);
    assert_ok(cwi_mesh_copy(&m, &left, &err), err);
    assert_ok(cwi_mesh_drop_marked(&left, marked, &err), err);
    assert_int_equal(left.triangle_count, kept);
    assert_true(left.vertex_count < m.vertex_count);
    assert_int_equal(check_rows(&left, &m, 1e-6, NULL), 0);
    cwi_free(marked);
    cw_mesh_free(&m);
    cw_mesh_free(&left);
}

static void cuts_interpolate(void **state)
{
    (void)state;
    cw_mesh m = make_ball(), half;
    cw_error err = {0};
    cw_cut_facts facts;
    const cw_cut_desc desc = {
        .point = {m.origin[0] + 0.3, m.origin[1] + 0.2, m.origin[2] + 0.1},
        .normal = {1, 2, 0.5}};
    assert_ok(cw_mesh_cut(&m, &desc, &half, &facts, &err), err);
    assert_true(facts.cap_triangles > 10 && facts.cut_triangles > 10);
    assert_int_equal(check_rows(&half, &m, 1e-4, NULL), facts.cap_triangles);
    cw_mesh_free(&m);
    cw_mesh_free(&half);
}

/* Plants a hole, a double triangle and one that faces the other way. The repair fills the hole by
 * triangles that take the attributes of those near them. */
static void repairs_carry(void **state)
{
    (void)state;
    cw_mesh m = make_ball(), broken, repaired;
    cw_error err = {0};
    cw_repair_facts facts;
    size_t distant;
    assert_ok(cwi_mesh_copy(&m, &broken, &err), err);
    cwi_mesh_swap_corners(&broken, 20, 0, 2);
    cwi_mesh_move_triangle(&broken, 30, 10);
    assert_ok(cw_mesh_repair(&broken, NULL, &repaired, &facts, &err), err);
    assert_int_equal(facts.duplicates, 1);
    assert_int_equal(facts.flipped_triangles, 1);
    assert_int_equal(facts.holes_filled, 1);
    assert_int_equal(repaired.triangle_count, m.triangle_count);
    test_check_promise(&repaired, false);
    assert_int_equal(check_rows(&repaired, &m, 1e-4, &distant), 0);
    assert_true(distant <= facts.added_triangles);
    cw_mesh_free(&m);
    cw_mesh_free(&broken);
    cw_mesh_free(&repaired);
}

/* Corners swapped twice are as before; swapped once, they take their attributes along. */
static void turned_triangles_turn_their_corners(void **state)
{
    (void)state;
    cw_mesh m = make_ball(), turned;
    cw_error err = {0};
    assert_ok(cwi_mesh_copy(&m, &turned, &err), err);
    for (size_t t = 0; t < m.triangle_count; t++)
        cwi_mesh_swap_corners(&turned, t, 1, 2);
    assert_memory_not_equal(turned.triangles, m.triangles, 12 * m.triangle_count);
    check_rows(&turned, &m, 1e-6, NULL);
    assert_ok(cw_mesh_orient(&turned, 1, NULL, &err), err);
    assert_memory_equal(turned.triangles, m.triangles, 12 * m.triangle_count);
    assert_memory_equal(data_of(&turned, "corner"), data_of(&m, "corner"),
                        48 * m.triangle_count);
    cw_mesh_free(&m);
    cw_mesh_free(&turned);
}

/* A simplified surface takes attributes from the closest points. */
static void new_surfaces_take_the_closest(void **state)
{
    (void)state;
    cw_mesh m = make_ball(), reduced;
    cw_error err = {0};
    size_t distant;
    if (cw_simplify_available()) {
        const cw_simplify_desc desc = {.error_mm = 0.05};
        assert_ok(cw_simplify(&m, &desc, &reduced, NULL, &err), err);
        assert_true(reduced.triangle_count < m.triangle_count);
        assert_int_equal(check_rows(&reduced, &m, 0.06, &distant), 0);
        cw_mesh_free(&reduced);
    }
    cw_mesh_free(&m);
}

/* Another order of triangles and vertices keeps what belongs together. */
static void orders_keep_what_belongs_together(void **state)
{
    (void)state;
    cw_mesh m = make_ball(), ordered;
    cw_error err = {0};
    assert_ok(cwi_mesh_copy(&m, &ordered, &err), err);
    if (cw_mesh_optimize(&ordered, &err) != CW_ERR_UNSUPPORTED) {
        assert_ok(err.status, err);
        assert_memory_not_equal(ordered.triangles, m.triangles, 12 * m.triangle_count);
        assert_int_equal(check_rows(&ordered, &m, 1e-6, NULL), 0);
    }
    cw_mesh_free(&m);
    cw_mesh_free(&ordered);
}

/* Each allocation of a copy and of a join may fail; then nothing is left of the result. */
static void memory_may_run_out(void **state)
{
    (void)state;
    cw_mesh m = make_ball(), made;
    cw_error err = {0};
    cw_status st = CW_ERR_NO_MEMORY;
    for (long n = 0; st != CW_OK; n++) {
        cwi_alloc_fail_after(n);
        st = cwi_mesh_copy(&m, &made, &err);
        if (st == CW_OK)
            st = cwi_mesh_append(&made, &m, &err);
        cwi_alloc_fail_after(-1);
        assert_true(st == CW_OK || (st == CW_ERR_NO_MEMORY && !made.positions &&
                                    !made.attributes && !made.attribute_count));
    }
    cw_mesh_free(&made);
    cw_mesh_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(attributes_are_added_found_and_removed),
        cmocka_unit_test(welding_keeps_those_of_the_first_vertex),
        cmocka_unit_test(joined_meshes_keep_what_both_have),
        cmocka_unit_test(dropped_triangles_take_theirs_along),
        cmocka_unit_test(cuts_interpolate),
        cmocka_unit_test(repairs_carry),
        cmocka_unit_test(turned_triangles_turn_their_corners),
        cmocka_unit_test(new_surfaces_take_the_closest),
        cmocka_unit_test(orders_keep_what_belongs_together),
        cmocka_unit_test(memory_may_run_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
