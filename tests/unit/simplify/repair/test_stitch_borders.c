/* Borders that nearly meet are stitched, real holes are not, and what is closed stays as it is. */
#include "support/planted.h"
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/mesh/mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static cw_mesh make_ball(void)
{
    cw_volume volume = test_sample(CW_FIELD_SPHERE, 16, CW_F32);
    cw_mesh mesh = test_extract(&volume, NULL, NULL);
    cw_volume_free(&volume);
    return mesh;
}

static double mean_edge(const cw_mesh *m)
{
    double sum = 0;
    for (size_t c = 0; c < 3 * m->triangle_count; c++) {
        const float *p = m->positions + 3 * (size_t)m->triangles[c],
                    *q = m->positions + 3 * (size_t)m->triangles[c % 3 == 2 ? c - 2 : c + 1];
        sum += hypot(hypot((double)p[0] - (double)q[0], (double)p[1] - (double)q[1]),
                     (double)p[2] - (double)q[2]);
    }
    return sum / (double)(3 * m->triangle_count);
}

/* Gives each triangle vertices of its own, scaled, and moved by up to a share of the mean edge. */
static cw_mesh take_apart(const cw_mesh *m, double scale, double share)
{
    const double apart = share * mean_edge(m);
    cw_mesh out;
    cw_error err = {0};
    assert_ok(cwi_mesh_alloc(&out, 3 * m->triangle_count, m->triangle_count, false, &err), err);
    for (uint32_t c = 0; c < 3 * m->triangle_count; c++) {
        out.triangles[c] = c;
        for (size_t a = 0; a < 3; a++) {
            const double by = apart * (2.0 * rand() / RAND_MAX - 1);
            const double at = (double)m->positions[3 * (size_t)m->triangles[c] + a];
            out.positions[3 * (size_t)c + a] = (float)(scale * (at + by));
        }
    }
    return out;
}

static cw_mesh repair_mesh(const cw_mesh *m, const cw_repair_desc *desc, cw_repair_facts *facts)
{
    cw_mesh out;
    cw_error err = {0};
    assert_ok(cw_mesh_repair(m, desc, &out, facts, &err), err);
    assert_true(facts->is_sound);
    return out;
}

static void gaps_of_any_width_are_closed(void **state)
{
    (void)state;
    static const double shares[] = {1e-6, 1e-4, 3e-3}, scales[] = {1e-4, 1, 1e4};
    cw_mesh whole = make_ball();
    const double truth = test_measure(&whole).volume_mm3;
    test_seed(1);
    for (int n = 0; n < 9; n++) {
        const double scale = scales[n / 3], share = shares[n % 3];
        cw_mesh apart = take_apart(&whole, scale, share);
        cw_repair_facts facts;
        cw_mesh out = repair_mesh(&apart, NULL, &facts);
        assert_true(facts.is_needed && facts.weld_mm > 0);
        assert_true(facts.weld_mm < 10 * (share + 1e-6) * scale * mean_edge(&whole));
        assert_true(facts.welded > 0 &&
                    facts.holes_filled < 4); /* shorter edges than the gaps */
        assert_int_equal(test_measure(&out).components, 1);
        assert_within(test_measure(&out).volume_mm3, truth * scale * scale * scale, 1e-3);
        cw_mesh_free(&apart);
        cw_mesh_free(&out);
    }
    cw_mesh_free(&whole);
}

/* A cube whose facets are smaller than their places: the middle of corners would be inside of it. */
static void corners_come_back_where_planes_meet(void **state)
{
    (void)state;
    cw_mesh cube, apart, out;
    cw_repair_facts facts;
    test_make_cube(&cube);
    apart = take_apart(&cube, 1, 0);
    for (size_t t = 0; t < 12; t++)
        for (size_t a = 0; a < 3; a++) {
            float *p = apart.positions + 9 * t + a;
            const double middle = ((double)p[0] + (double)p[3] + (double)p[6]) / 3;
            for (size_t k = 0; k < 9; k += 3)
                p[k] = (float)(middle + 0.99 * ((double)p[k] - middle));
        }
    out = repair_mesh(&apart, &(cw_repair_desc){.max_move_mm = 1}, &facts);
    assert_int_equal(out.triangle_count, 12);
    assert_within(test_measure(&out).volume_mm3, test_measure(&cube).volume_mm3, 1e-3);
    cw_mesh_free(&cube);
    cw_mesh_free(&apart);
    cw_mesh_free(&out);
}

/* Cuts triangles in four where x is above a limit: their neighbours have vertices on their edges. */
static cw_mesh refine_half(const cw_mesh *m, float from)
{
    static const int parts[4][3] = {{0, 3, 5}, {1, 4, 3}, {2, 5, 4}, {3, 4, 5}};
    cw_mesh out;
    cw_error err = {0};
    assert_ok(cwi_mesh_alloc(&out, 12 * m->triangle_count, 4 * m->triangle_count, false, &err),
              err);
    out.triangle_count = out.vertex_count = 0;
    for (size_t t = 0; t < m->triangle_count; t++) {
        float p[6][3];
        for (size_t n = 0; n < 9; n++)
            p[n / 3][n % 3] = m->positions[3 * (size_t)m->triangles[3 * t + n / 3] + n % 3];
        for (size_t n = 0; n < 9; n++)
            p[3 + n / 3][n % 3] = (p[n / 3][n % 3] + p[(n / 3 + 1) % 3][n % 3]) / 2;
        const bool is_fine = p[0][0] + p[1][0] + p[2][0] > 3 * from;
        for (int k = 0; k < (is_fine ? 4 : 1); k++, out.triangle_count++)
            for (size_t c = 0; c < 3; c++, out.vertex_count++) {
                memcpy(out.positions + 3 * out.vertex_count, p[is_fine ? parts[k][c] : (int)c],
                       sizeof *p);
                out.triangles[out.vertex_count] = (uint32_t)out.vertex_count;
            }
    }
    return out;
}

static void vertices_on_edges_split_them(void **state)
{
    (void)state;
    cw_mesh whole = make_ball(), fine = refine_half(&whole, 3), out;
    cw_repair_facts facts;
    cw_error err = {0};
    uint32_t *number;
    cw_attribute *made;
    const cw_attribute like = {.name = "face",
                               .on = CW_ON_TRIANGLES,
                               .type = CW_U32,
                               .components = 1,
                               .interpolation = CW_INTERPOLATE_NEAREST};
    assert_ok(cw_mesh_attribute_add(&fine, &like, &made, &err), err);
    number = made->data;
    for (uint32_t t = 0; t < fine.triangle_count; t++)
        number[t] = t;
    out = repair_mesh(&fine, NULL, &facts);
    assert_true(facts.split_edges > 10 && !facts.holes_filled && !facts.sheets);
    assert_int_equal(facts.added_triangles, 0);
    assert_int_equal(out.triangle_count, fine.triangle_count + facts.split_edges);
    assert_within(test_measure(&out).volume_mm3, test_measure(&whole).volume_mm3, 1e-6);
    /* each triangle lies in the one whose number it has */
    for (size_t t = 0; t < out.triangle_count; t++) {
        const uint32_t from = ((const uint32_t *)out.attributes->data)[t];
        size_t same = 0;
        for (size_t k = 0; k < 9; k++)
            for (size_t n = 0; n < 3 && k % 3 == 0; n++)
                same += memcmp(out.positions + 3 * (size_t)out.triangles[3 * t + k / 3],
                               fine.positions + 9 * (size_t)from + 3 * n, 12) == 0;
        assert_true(same >= 1);
    }
    cw_mesh_free(&whole);
    cw_mesh_free(&fine);
    cw_mesh_free(&out);
}

/* Holes, narrow ones too, are filled: their rims do not lie along each other. */
static void holes_are_not_zipped(void **state)
{
    (void)state;
    cw_mesh m = make_ball(), out;
    cw_repair_facts facts;
    cw_error err = {0};
    bool *gone = cwi_alloc_zeroed(m.triangle_count, sizeof *gone);
    assert_non_null(gone);
    gone[m.triangle_count / 2] = gone[m.triangle_count / 3] = gone[7] = true;
    assert_ok(cwi_mesh_drop_marked(&m, gone, &err), err);
    out = repair_mesh(&m, NULL, &facts);
    assert_true(facts.weld_mm == 0 && !facts.welded && !facts.split_edges);
    assert_int_equal(facts.holes_filled, 3);
    cwi_free(gone);
    cw_mesh_free(&m);
    cw_mesh_free(&out);
}

/* The rim of a narrow triangle that is missing lies along itself, and filling it moves nothing. */
static void narrow_holes_are_filled(void **state)
{
    (void)state;
    for (size_t t = 0; t < 12; t++) {
        cw_mesh m, out;
        cw_repair_facts facts;
        bool gone[12] = {false};
        cw_error err = {0};
        test_make_cube(&m);
        for (size_t v = 0; v < m.vertex_count; v++)
            m.positions[3 * v + 2] *= 0.05f;
        gone[t] = true;
        assert_ok(cwi_mesh_drop_marked(&m, gone, &err), err);
        out = repair_mesh(&m, NULL, &facts);
        assert_true(facts.weld_mm == 0 && facts.holes_filled == 1);
        assert_within(test_measure(&out).volume_mm3, 0.05, 1e-5);
        cw_mesh_free(&m);
        cw_mesh_free(&out);
    }
}

/* Walls that are thin beside their edges keep their two sides, though all triangles are apart. */
static void thin_walls_stay(void **state)
{
    (void)state;
    cw_mesh cube, plate, apart, out;
    cw_repair_facts facts;
    test_make_cube(&cube);
    plate = refine_half(&cube, -100);
    const double height = 0.02;
    for (size_t v = 0; v < plate.vertex_count; v++)
        plate.positions[3 * v + 2] *= (float)height;
    test_seed(2);
    apart = take_apart(&plate, 1, 1e-4);
    out = repair_mesh(&apart, NULL, &facts);
    assert_within(test_measure(&out).volume_mm3, height * test_measure(&cube).volume_mm3, 0.02);
    cw_mesh_free(&cube);
    cw_mesh_free(&plate);
    cw_mesh_free(&apart);
    cw_mesh_free(&out);
}

static void closed_meshes_stay_to_the_bit(void **state)
{
    (void)state;
    static const char *const names[] = {"cube",   "torus",   "two_cubes",
                                        "cavity", "needles", "cap"};
    for (size_t n = 0; n < test_planted_count; n++)
        for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
            if (strcmp(test_planted_meshes[n].name, names[k]) != 0)
                continue;
            cw_mesh m = test_plant(&test_planted_meshes[n]), out;
            cw_repair_facts facts;
            out = repair_mesh(&m, NULL, &facts);
            assert_true(!facts.is_needed && facts.weld_mm == 0 && !facts.split_edges);
            test_assert_same_mesh(&m, &out);
            cw_mesh_free(&m);
            cw_mesh_free(&out);
        }
}

static void cracks_stay_when_asked(void **state)
{
    (void)state;
    cw_mesh whole = make_ball(), apart, out;
    cw_repair_facts facts;
    cw_error err = {0};
    test_seed(3);
    apart = take_apart(&whole, 1, 1e-4);
    assert_fails(
        cw_mesh_repair(&apart, &(cw_repair_desc){.keep_cracks = true}, &out, &facts, &err),
        CW_ERR_EMPTY, "encloses no volume", err);
    assert_int_equal(facts.sheets, whole.triangle_count);
    assert_true(facts.weld_mm == 0);
    cw_mesh_free(&whole);
    cw_mesh_free(&apart);
}

static void failures_leave_nothing(void **state)
{
    (void)state;
    cw_mesh cube, fine, apart;
    test_make_cube(&cube);
    test_seed(4);
    fine = refine_half(&cube, 0.5f);
    apart = take_apart(&fine, 1, 1e-4);
    test_repair_without_memory(&apart, &(cw_repair_desc){.threads = 1}, 40);
    cw_mesh_free(&cube);
    cw_mesh_free(&fine);
    cw_mesh_free(&apart);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gaps_of_any_width_are_closed),
        cmocka_unit_test(corners_come_back_where_planes_meet),
        cmocka_unit_test(vertices_on_edges_split_them),
        cmocka_unit_test(holes_are_not_zipped),
        cmocka_unit_test(narrow_holes_are_filled),
        cmocka_unit_test(thin_walls_stay),
        cmocka_unit_test(closed_meshes_stay_to_the_bit),
        cmocka_unit_test(cracks_stay_when_asked),
        cmocka_unit_test(failures_leave_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
