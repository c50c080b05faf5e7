/* The proof of the case table: whatever the program that made it did, these hold. */
#include "support/support.h"

#include "core/cases/case_tables.h"
#include "core/cases/cube_numbering.h"
#include "extract/dense/cell_bits.h"

#include <stdlib.h>
#include <string.h>

static bool inside(int cube, int corner)
{
    return cube >> corner & 1;
}

static bool crossed(int cube, int edge)
{
    const int corner = cwi_edge_corner(edge);
    return inside(cube, corner) != inside(cube, corner | 1 << cwi_edge_axis(edge));
}

static bool on_face(int edge, int face)
{
    const int corner = cwi_edge_corner(edge), axis = face >> 1;
    return cwi_edge_axis(edge) != axis && (corner >> axis & 1) == (face & 1);
}

/* How often the case's triangles run from one edge's vertex to another's. */
static void count_sides(int cube, int sides[12][12])
{
    memset(sides, 0, 144 * sizeof(int));
    for (int t = 0; t < cwi_case_count[cube]; t++)
        for (int c = 0; c < 3; c++)
            sides[cwi_case_triangles[cube][3 * t + c]]
                 [cwi_case_triangles[cube][3 * t + (c + 1) % 3]]++;
}

/* The surface's trace on one face, as directed sides that no second triangle undoes. */
static void trace(int cube, int face, int segments[12][12])
{
    int sides[12][12];
    count_sides(cube, sides);
    for (int a = 0; a < 12; a++)
        for (int b = 0; b < 12; b++)
            segments[a][b] =
                on_face(a, face) && on_face(b, face) ? sides[a][b] - sides[b][a] : 0;
}

static void corners_edges_and_faces_agree(void **state)
{
    (void)state;
    for (int edge = 0; edge < 12; edge++) {
        const int low = cwi_edge_corner(edge), high = low | 1 << cwi_edge_axis(edge);
        assert_int_not_equal(low, high);
        assert_int_equal(cwi_edge_between(low, high), edge);
        assert_int_equal(cwi_edge_between(high, low), edge);
    }
    for (int face = 0; face < 6; face++)
        for (int n = 0; n < 4; n++) {
            const int a = cwi_face_corner(face, n), b = cwi_face_corner(face, (n + 1) % 4);
            assert_int_equal(a >> (face >> 1) & 1, face & 1);
            assert_int_equal(__builtin_popcount((unsigned)(a ^ b)), 1);
        }
}

static void triangles_use_exactly_the_crossed_edges(void **state)
{
    (void)state;
    for (int cube = 0; cube < 256; cube++) {
        bool used[12] = {false};
        assert_true(cwi_case_count[cube] <= CWI_CASE_MAX_TRIANGLES);
        for (int n = 0; n < 3 * cwi_case_count[cube]; n++)
            used[cwi_case_triangles[cube][n]] = true;
        for (int edge = 0; edge < 12; edge++)
            assert_int_equal(used[edge], crossed(cube, edge));
    }
}

/* Counts made without the tables, 64 cells a word, equal those of the tables: some cases, a
 * cell each. */
static void expect_counts(int first)
{
    enum { CELLS = 64 * CWI_WORDS };
    cwi_words corner[8] = {{0}}, edges[12], ambiguous;
    for (int n = 0; n < CELLS; n++)
        for (int c = 0; c < 8; c++)
            corner[c][n / 64] |= (uint64_t)inside(first + n, c) << n % 64;
    cwi_cross_edges(corner, edges);
    cwi_find_ambiguous(edges, &ambiguous);
    for (int n = 0, cube = first; n < CELLS && cube < 256; n++, cube++) {
        const uint64_t bit = UINT64_C(1) << n % 64;
        cwi_words cell = {0}, triangles = {0};
        cell[n / 64] = bit;
        cwi_add_triangles(edges, &cell, &triangles);
        for (int edge = 0; edge < 12; edge++)
            assert_int_equal((edges[edge][n / 64] & bit) != 0, crossed(cube, edge));
        assert_int_equal((ambiguous[n / 64] & bit) != 0, cwi_case_is_ambiguous[cube]);
        if (cube != 0 && cube != 255 && !cwi_case_is_ambiguous[cube])
            assert_int_equal(triangles[n / 64], cwi_case_count[cube]);
    }
}

static void words_count_as_the_tables(void **state)
{
    (void)state;
    for (int cube = 0; cube < 256; cube += 64 * CWI_WORDS)
        expect_counts(cube);
}

/* Sums that the tables hold twice are the same. */
static void summaries_agree(void **state)
{
    (void)state;
    for (int n = 0; n < CWI_CONFIGS; n++) {
        const cwi_config *config = &cwi_configs[n];
        int triangles = 0, vertices = 0;
        for (int l = 0; l < config->loop_count; l++) {
            triangles += config->loop_length[l] - (config->cone[l] ? 0 : 2);
            vertices += config->cone[l];
        }
        assert_int_equal(config->triangle_count, triangles);
        assert_int_equal(config->vertex_count, vertices);
    }
}

/* Inside the cube every side is shared by two triangles that run through it in opposite ways;
 * the others lie on faces and pass each face's edges once in, once out. */
static void every_case_is_a_surface_bounded_by_its_faces(void **state)
{
    (void)state;
    for (int cube = 0; cube < 256; cube++) {
        int sides[12][12], out[12] = {0}, in[12] = {0};
        count_sides(cube, sides);
        for (int a = 0; a < 12; a++)
            for (int b = 0; b < 12; b++) {
                bool shared = false;
                for (int face = 0; face < 6; face++)
                    shared = shared || (on_face(a, face) && on_face(b, face));
                assert_true(sides[a][b] <= 1);
                assert_true(a != b || sides[a][b] == 0);
                if (!shared)
                    assert_int_equal(sides[a][b], sides[b][a]);
                else if (sides[a][b]) /* a side within a wall is never a diagonal */
                    assert_int_equal(sides[b][a], 0);
                out[a] += sides[a][b] && !sides[b][a];
                in[b] += sides[a][b] && !sides[b][a];
            }
        for (int edge = 0; edge < 12; edge++) {
            assert_int_equal(out[edge], crossed(cube, edge));
            assert_int_equal(in[edge], crossed(cube, edge));
        }
    }
}

/* A face depends on its four corners only, and its two cubes see it mirrored: so the surfaces
 * of neighbours meet along the whole face, in opposite directions. */
static void neighbours_draw_the_same_segments(void **state)
{
    (void)state;
    for (int axis = 0; axis < 3; axis++)
        for (int a = 0; a < 256; a++)
            for (int b = 0; b < 256; b++) {
                bool meet = true;
                for (int corner = 0; corner < 8; corner++)
                    if (corner >> axis & 1)
                        meet = meet && inside(a, corner) == inside(b, corner ^ 1 << axis);
                if (!meet)
                    continue;
                int right[12][12], left[12][12];
                trace(a, 2 * axis + 1, right);
                trace(b, 2 * axis, left);
                for (int e = 0; e < 12; e++)
                    for (int f = 0; f < 12; f++) {
                        if (!on_face(e, 2 * axis + 1) || !on_face(f, 2 * axis + 1))
                            continue;
                        const int bit = 1 << axis;
                        const int e2 = cwi_edge_between(cwi_edge_corner(e) & ~bit,
                                                        (cwi_edge_corner(e) & ~bit) |
                                                            1 << cwi_edge_axis(e));
                        const int f2 = cwi_edge_between(cwi_edge_corner(f) & ~bit,
                                                        (cwi_edge_corner(f) & ~bit) |
                                                            1 << cwi_edge_axis(f));
                        assert_int_equal(right[e][f], left[f2][e2]);
                    }
            }
}

static void midpoint(int edge, double p[3])
{
    for (int a = 0; a < 3; a++)
        p[a] = (cwi_edge_corner(edge) >> a & 1) + (a == cwi_edge_axis(edge) ? 0.5 : 0);
}

/* Around the first vertex of each triangle: the inside end of its edge lies behind the plane of
 * some triangle at that vertex. Summed over a case, normals point from inside to outside. */
static void triangles_wind_outward(void **state)
{
    (void)state;
    for (int cube = 1; cube < 255; cube++) {
        double sum = 0;
        for (int t = 0; t < cwi_case_count[cube]; t++) {
            const uint8_t *e = cwi_case_triangles[cube] + 3 * t;
            double p[3][3], n[3];
            for (int c = 0; c < 3; c++)
                midpoint(e[c], p[c]);
            for (int a = 0; a < 3; a++) {
                const int b = (a + 1) % 3, c = (a + 2) % 3;
                n[a] = (p[1][b] - p[0][b]) * (p[2][c] - p[0][c]) -
                       (p[1][c] - p[0][c]) * (p[2][b] - p[0][b]);
            }
            for (int c = 0; c < 3; c++) {
                const int axis = cwi_edge_axis(e[c]);
                sum += inside(cube, cwi_edge_corner(e[c])) ? n[axis] : -n[axis];
            }
        }
        assert_true(sum > 0);
    }
}

static int turn_corner(int corner, int symmetry)
{
    static const int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                     {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    int turned = 0;
    for (int a = 0; a < 3; a++)
        turned |= (corner >> orders[symmetry / 8][a] & 1) << a;
    return turned ^ (symmetry & 7);
}

/* Under all 48 symmetries a case keeps its number of triangles and the pieces they form. */
static void symmetries_keep_the_surface(void **state)
{
    (void)state;
    for (int cube = 0; cube < 256; cube++)
        for (int symmetry = 0; symmetry < 48; symmetry++) {
            int turned = 0;
            for (int corner = 0; corner < 8; corner++)
                turned |= inside(cube, corner) << turn_corner(corner, symmetry);
            assert_int_equal(cwi_case_count[cube], cwi_case_count[turned]);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(corners_edges_and_faces_agree),
        cmocka_unit_test(triangles_use_exactly_the_crossed_edges),
        cmocka_unit_test(words_count_as_the_tables),
        cmocka_unit_test(summaries_agree),
        cmocka_unit_test(every_case_is_a_surface_bounded_by_its_faces),
        cmocka_unit_test(neighbours_draw_the_same_segments),
        cmocka_unit_test(triangles_wind_outward),
        cmocka_unit_test(symmetries_keep_the_surface),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
