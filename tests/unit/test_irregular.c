/* Irregular grids: surfaces in cells of four shapes, whichever way round they are, that fit
 * together and end where the cells do. */
#include "support/cells.h"
#include "support/surface.h"

#include "core/memory.h"
#include "core/status.h"
#include "extract/cases.h"
#include "extract/topology.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double radius = 0.7;

static double sphere(const double p[3])
{
    return radius - sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
}

static double random_number(double low, double high)
{
    return low + (high - low) * rand() / RAND_MAX;
}

/* --- tables ------------------------------------------------------------------------------ */

/* How often a triangle's side runs from one edge of the cell to another. */
typedef struct sides {
    uint8_t from[CWI_CELL_INNER + CWI_CELL_MAX_VERTICES]
                [CWI_CELL_INNER + CWI_CELL_MAX_VERTICES];
} sides;

static bool share_face(const cwi_shape *s, int e, int f)
{
    bool shared = false;
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++)
            shared = shared || s->edge_faces[e][i] == s->edge_faces[f][j];
    return shared;
}

/* Loops run through each crossed edge once; every step of them is in a face, from where that
 * face, seen from outside, enters the inside. */
static void check_loops(const cwi_shape *s, unsigned inside, const cwi_config *config)
{
    bool met[12] = {false};
    const uint8_t *edge = config->loop_edges;
    for (int l = 0; l < config->loop_count; edge += config->loop_length[l++])
        for (int n = 0; n < config->loop_length[l]; n++) {
            assert_false(met[edge[n]]);
            met[edge[n]] = true;
            assert_true(share_face(s, edge[n], edge[(n + 1) % config->loop_length[l]]));
        }
    for (int e = 0; e < s->edge_count; e++)
        assert_int_equal(met[e], (inside >> s->edges[e][0] ^ inside >> s->edges[e][1]) & 1);
}

/* What bounds the triangles is the loops, and no other side of them is in a wall. */
static void check_triangles(const cwi_shape *s, const cwi_config *config, unsigned code)
{
    sides all = {0};
    cwi_cell_plan plan;
    cwi_cell cell;
    cwi_cell_plan_unpack(code, &plan);
    cwi_cell_build(&plan, (double[12]){0}, &cell);
    for (int n = 0; n < 3 * plan.triangle_count; n++)
        all.from[cell.triangles[n]][cell.triangles[n - n % 3 + (n + 1) % 3]]++;
    const uint8_t *edge = config->loop_edges;
    for (int l = 0; l < config->loop_count; edge += config->loop_length[l++])
        for (int n = 0; n < config->loop_length[l]; n++) {
            const int a = edge[n], b = edge[(n + 1) % config->loop_length[l]];
            assert_int_equal(all.from[a][b], 1);
            all.from[a][b] = 0;
        }
    for (int a = 0; a < CWI_CELL_INNER + plan.vertex_count; a++)
        for (int b = 0; b < CWI_CELL_INNER + plan.vertex_count; b++) {
            assert_true(all.from[a][b] <= 1);
            assert_int_equal(all.from[a][b], all.from[b][a]);
            if (a < CWI_CELL_INNER && b < CWI_CELL_INNER && all.from[a][b])
                assert_false(share_face(s, a, b));
        }
}

static void every_case_of_every_shape_has_closed_loops(void **state)
{
    (void)state;
    unsigned count = 0;
    for (int shape = CW_SHAPE_COUNT - 1; shape >= 0; shape--) {
        const cwi_shape *s = &cwi_shapes[shape];
        assert_int_equal(s->corner_count - s->edge_count + s->face_count, 2);
        for (unsigned inside = 0; inside < 1u << s->corner_count; inside++) {
            const int ways = 1 << __builtin_popcount(s->ambiguous_faces[inside]);
            assert_int_equal(s->first_config[inside], count);
            for (int n = 0; n < ways; n++, count++) {
                check_loops(s, inside, &cwi_configs[count]);
                check_triangles(s, &cwi_configs[count], count);
            }
        }
    }
    assert_int_equal(count, CWI_CONFIGS);
}

/* --- fields that are known --------------------------------------------------------------- */

static double farthest_from_sphere(const cw_mesh *m)
{
    double most = 0;
    for (size_t v = 0; v < m->vertex_count; v++) {
        double square = 0;
        for (size_t a = 0; a < 3; a++) {
            const double x = m->origin[a] + (double)m->positions[3 * v + a];
            square += x * x;
        }
        most = fmax(most, fabs(sqrt(square) - radius));
    }
    return most;
}

/* The sphere in n x n x n boxes: closed, round and full. Returns how far off it is. */
static double measure_sphere(test_cut cut, size_t n)
{
    test_grid g;
    cw_extract_counts counts, predicted;
    cw_error err = {0};
    test_grid_make(&g, cut, n, 0.2);
    test_grid_fill(&g, sphere);
    cw_mesh m = test_extract(&g.volume, NULL, &counts);
    const cw_quality q = test_check_promise(&m, false);
    assert_int_equal(q.euler, 2);
    assert_int_equal(q.components, 1);
    assert_true(test_normals_agree(&m));
    assert_within(q.volume_mm3, 4.0 / 3 * PI * pow(radius, 3), 9.0 / (double)(n * n));
    assert_int_equal(test_count_crossings(&m), 0);
    assert_int_equal(counts.border_loops, 0);
    assert_int_equal(counts.vertices, m.vertex_count);
    assert_int_equal(counts.triangles, m.triangle_count);
    assert_ok(cw_extract_predict(&g.volume, NULL, &predicted, &err), err);
    assert_memory_equal(&predicted, &counts, sizeof counts);
    const double off = farthest_from_sphere(&m);
    cw_mesh_free(&m);
    test_grid_free(&g);
    return off;
}

static void spheres_are_closed_and_of_second_order(void **state)
{
    (void)state;
    srand(1);
    for (int cut = 0; cut < TEST_CUT_COUNT; cut++) {
        const double coarse = measure_sphere((test_cut)cut, 15),
                     fine = measure_sphere((test_cut)cut, 30);
        print_message("cut %d: %g, %g\n", cut, coarse, fine);
        assert_true(coarse < 0.02);
        assert_true(fine < 0.35 * coarse);
    }
}

static double slope(const double p[3])
{
    return 1e3 * (0.3 * p[0] - 0.5 * p[1] + 0.7 * p[2] + 0.1);
}

/* Whichever the cells, the gradient of a linear field is exact; with open ends there are no
 * normals of caps. */
static void normals_of_linear_fields_are_exact(void **state)
{
    (void)state;
    srand(2);
    for (int cut = 0; cut < TEST_CUT_COUNT; cut++) {
        test_grid g;
        test_grid_make(&g, (test_cut)cut, 10, 0.3);
        test_grid_fill(&g, slope);
        cw_mesh m = test_extract(&g.volume, &(cw_extract_desc){.leave_open = true}, NULL);
        test_check_promise(&m, true);
        const double wanted[3] = {-0.3, 0.5, -0.7}, length = sqrt(0.09 + 0.25 + 0.49);
        for (size_t i = 0; i < 3 * m.vertex_count; i++)
            assert_near((double)m.normals[i], wanted[i % 3] / length, 1e-6);
        cw_mesh_free(&m);
        test_grid_free(&g);
    }
}

/* --- any field --------------------------------------------------------------------------- */

static void fill_with_noise(test_grid *g, int round)
{
    for (size_t n = 0; n < g->samples; n++)
        g->values[n] = round % 3 == 0   ? (double)(rand() % 3 - 1)
                       : round % 3 == 1 ? random_number(-1, 1)
                       : rand() % 10    ? random_number(-1, 1)
                                        : NAN;
}

/* Whole numbers stand on the isovalue; no value, and cells meet in an edge or a corner. */
static void any_field_gives_a_sound_surface(void **state)
{
    (void)state;
    srand(3);
    for (int round = 0; round < 36; round++)
        for (int cut = 0; cut < TEST_CUT_COUNT; cut++) {
            test_grid g;
            cw_extract_counts counts;
            test_grid_make(&g, (test_cut)cut, 7, 0.1);
            fill_with_noise(&g, round);
            test_turn(&g.volume, round);
            const cw_extract_desc desc = {.leave_open = round & 1,
                                          .inside_is_low = round & 2,
                                          .simple_topology = round % 5 == 0};
            g.volume.slope = round & 4 ? -2 : 2;
            cw_mesh m = test_extract(&g.volume, &desc, &counts);
            cw_quality q;
            const char *fault = test_mesh_fault(&m, desc.leave_open, &q);
            if (fault)
                fail_msg("round %d, cut %d: the mesh has %s", round, cut, fault);
            if (desc.leave_open)
                assert_int_equal(q.border_loops, counts.border_loops);
            else
                assert_true(q.volume_mm3 > 0);
            cw_mesh_free(&m);
            test_grid_free(&g);
        }
}

/* In undistorted cells, where all are convex, nothing crosses anything. */
static void no_surface_crosses_itself(void **state)
{
    (void)state;
    srand(4);
    for (int round = 0; round < 8; round++)
        for (int cut = 0; cut < TEST_CUT_COUNT; cut++) {
            test_grid g;
            test_grid_make(&g, (test_cut)cut, 7, 0);
            fill_with_noise(&g, round % 2);
            cw_mesh m = test_extract(&g.volume, NULL, NULL);
            if (test_count_crossings(&m))
                fail_msg("round %d, cut %d: %zu crossings", round, cut,
                         test_count_crossings(&m));
            cw_mesh_free(&m);
            test_grid_free(&g);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_case_of_every_shape_has_closed_loops),
        cmocka_unit_test(spheres_are_closed_and_of_second_order),
        cmocka_unit_test(normals_of_linear_fields_are_exact),
        cmocka_unit_test(any_field_gives_a_sound_surface),
        cmocka_unit_test(no_surface_crosses_itself),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
