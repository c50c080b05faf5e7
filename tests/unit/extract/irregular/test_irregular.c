/* Irregular grids: surfaces in cells of four shapes, whichever way round they are, that fit
 * together and end where the cells do. */
#include "support/cells.h"
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "extract/cases/case_tables.h"
#include "extract/cases/cell_topology.h"

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

/* Triangles this thin may face any way: a share of the box, a thousandth of a cell's side. */
static const double NEEDLE = 5e-4;

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
    assert_true(test_normals_agree_but(&m, NEEDLE));
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
    test_seed(1);
    for (int cut = 0; cut < TEST_CUT_COUNT; cut++) {
        const double coarse = measure_sphere((test_cut)cut, 15);
        assert_true(coarse < 0.02);
        if (!TEST_IS_SLOW)
            assert_true(measure_sphere((test_cut)cut, 30) < 0.35 * coarse);
    }
}

static double slope(const double p[3])
{
    return 1e3 * (0.3 * p[0] - 0.5 * p[1] + 0.7 * p[2] + 0.1);
}

/* The outward direction of the field in the world. */
static void outward_slope(const cw_volume *v, double sign, double normal[3])
{
    double index[4][3], length = 0;
    cw_error err = {0};
    for (int a = 0; a < 4; a++)
        assert_ok(cw_volume_to_index(v, (double[3]){a == 0, a == 1, a == 2}, index[a], &err),
                  err);
    for (int a = 0; a < 3; a++) {
        normal[a] = sign * (slope(index[a]) - slope(index[3]));
        length += normal[a] * normal[a];
    }
    for (int a = 0; a < 3; a++)
        normal[a] /= sqrt(length);
}

/* Whichever the cells, the gradient of a linear field is exact; with open ends there are no
 * normals of caps. */
static void normals_of_linear_fields_are_exact(void **state)
{
    (void)state;
    test_seed(2);
    for (int round = 0; round < 4 * TEST_CUT_COUNT; round++) {
        test_grid g;
        double wanted[3];
        test_grid_make(&g, (test_cut)(round % TEST_CUT_COUNT), 10, 0.2);
        test_grid_fill(&g, slope);
        test_turn(&g.volume, round);
        const cw_extract_desc desc = {.leave_open = true, .inside_is_low = round & 1};
        g.volume.slope = round & 2 ? -3 : 3;
        cw_mesh m = test_extract(&g.volume, &desc, NULL);
        test_check_promise(&m, true);
        outward_slope(&g.volume, (round & 1) == (round >> 1 & 1) ? -1 : 1, wanted);
        for (size_t i = 0; i < 3 * m.vertex_count; i++)
            assert_near((double)m.normals[i], wanted[i % 3], 1e-6);
        assert_true(test_normals_agree_but(&m, NEEDLE));
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

static void mirror_some(test_grid *g)
{
    for (size_t n = 0; n < g->cells.count; n++)
        if (rand() % 2)
            test_grid_mirror(g, n);
}

/* Whole numbers stand on the isovalue; no value, and cells meet in an edge or a corner. */
static void any_field_gives_a_sound_surface(void **state)
{
    (void)state;
    test_seed(3);
    for (int round = 0; round < 36; round += TEST_IS_SLOW ? 7 : 1)
        for (int cut = 0; cut < TEST_CUT_COUNT; cut++) {
            test_grid g;
            cw_extract_counts counts;
            test_grid_make(&g, (test_cut)cut, 7, 0.1);
            fill_with_noise(&g, round);
            test_turn(&g.volume, round);
            if (round & 8)
                mirror_some(&g);
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

/* In cells with flat faces nothing crosses anything. Where quadrilaterals are warped a few
 * triangles of noise may. */
static void no_surface_crosses_itself(void **state)
{
    (void)state;
    test_seed(4);
    for (int round = 0; round < 8; round++)
        for (int cut = 0; cut < TEST_CUT_COUNT; cut++) {
            test_grid g;
            test_grid_make(&g, (test_cut)cut, 7, round < 4 ? 0 : 0.1);
            fill_with_noise(&g, round % 2);
            cw_mesh m = test_extract(&g.volume, NULL, NULL);
            const size_t crossings = test_count_crossings(&m);
            if (crossings > (round < 4 ? 0 : m.triangle_count / 200))
                fail_msg("round %d, cut %d: %zu crossings of %zu triangles", round, cut,
                         crossings, m.triangle_count);
            cw_mesh_free(&m);
            test_grid_free(&g);
        }
}

/* --- the same grid in another guise ------------------------------------------------------ */

/* The lattice's samples as a dense grid. */
static cw_volume as_dense(const test_grid *g, size_t n)
{
    cw_volume v = {.type = CW_F64, .data = g->values, .dim = {n + 1, n + 1, n + 1}};
    for (int a = 0; a < 3; a++) {
        v.affine[a][a] = 2.0 / (double)n;
        v.affine[a][3] = -1;
    }
    return v;
}

/* Every vertex of one stands where a vertex of the other does, with its normal if asked for. */
static void assert_same_places(const cw_mesh *a, const cw_mesh *b, bool normals)
{
    assert_int_equal(a->vertex_count, b->vertex_count);
    bool *taken = calloc(b->vertex_count + 1, sizeof *taken);
    assert_non_null(taken);
    for (size_t v = 0; v < a->vertex_count; v++) {
        size_t w = 0;
        for (; w < b->vertex_count; w++) {
            double most = 0;
            for (size_t i = 0; i < 3; i++)
                most = fmax(most, fabs(a->origin[i] + (double)a->positions[3 * v + i] -
                                       b->origin[i] - (double)b->positions[3 * w + i]));
            if (most < 1e-6 && !taken[w])
                break;
        }
        if (w == b->vertex_count)
            fail_msg("vertex %zu is at no place of the other mesh", v);
        for (size_t i = 0; i < 3 && normals; i++)
            assert_near((double)a->normals[3 * v + i], (double)b->normals[3 * w + i], 1e-4);
        taken[w] = true;
    }
    free(taken);
}

/* Noise has tunnels and every other case: the cells of a lattice give what the lattice does.
 * Caps of a dense grid stand a little beyond it. */
static void a_lattice_of_hexahedra_is_a_dense_grid(void **state)
{
    (void)state;
    enum { N = 9 };
    test_seed(5);
    for (int round = 0; round < 24; round++) {
        test_grid g;
        cw_extract_counts counts, wanted_counts;
        test_grid_make(&g, TEST_HEXAHEDRA, N, 0);
        fill_with_noise(&g, round % 2);
        const cw_volume dense = as_dense(&g, N);
        const cw_extract_desc desc = {
            .leave_open = round & 2, .inside_is_low = round & 4, .simple_topology = round & 8};
        cw_mesh m = test_extract(&g.volume, &desc, &counts),
                wanted = test_extract(&dense, &desc, &wanted_counts);
        const cw_quality q = test_check_promise(&m, desc.leave_open),
                         wanted_q = test_measure(&wanted);
        assert_int_equal(q.euler, wanted_q.euler);
        assert_int_equal(q.components, wanted_q.components);
        assert_int_equal(counts.border_loops, wanted_counts.border_loops);
        if (desc.leave_open) {
            assert_int_equal(m.triangle_count, wanted.triangle_count);
            /* one rule has no vertices inside cells, where a dense grid knows less */
            assert_same_places(&m, &wanted, desc.simple_topology && round % 2);
            assert_within(q.area_mm2, wanted_q.area_mm2, 1e-6);
        }
        cw_mesh_free(&m);
        cw_mesh_free(&wanted);
        test_grid_free(&g);
    }
}

/* Cells numbered as mirror images, in files of another mind: neighbours agree all the same. */
static void cells_may_be_inside_out(void **state)
{
    (void)state;
    test_seed(6);
    for (int round = 0; round < 3; round++)
        for (int cut = 0; cut < TEST_CUT_COUNT; cut++) {
            test_grid g;
            test_grid_make(&g, (test_cut)cut, 8, 0.1);
            test_grid_fill(&g, sphere);
            cw_mesh straight = test_extract(&g.volume, NULL, NULL);
            for (size_t n = 0; n < g.cells.count && round == 2; n++)
                test_grid_mirror(&g, n);
            mirror_some(&g);
            cw_mesh m = test_extract(&g.volume, NULL, NULL);
            const cw_quality q = test_check_promise(&m, false);
            assert_int_equal(q.triangles, straight.triangle_count);
            assert_int_equal(q.euler, 2);
            assert_within(q.volume_mm3, test_measure(&straight).volume_mm3, 1e-3);
            assert_same_places(&m, &straight, true);
            assert_true(test_normals_agree_but(&m, NEEDLE));
            cw_mesh_free(&m);
            cw_mesh_free(&straight);
            test_grid_free(&g);
        }
}

/* --- curvilinear grids ------------------------------------------------------------------- */

/* A box of cells between samples whose numbers a map gives. */
static void add_cells_between(test_grid *g, const size_t n[3],
                              uint32_t (*number)(size_t i, size_t j, size_t k))
{
    for (size_t k = 0; k < n[2]; k++)
        for (size_t j = 0; j < n[1]; j++)
            for (size_t i = 0; i < n[0]; i++)
                test_grid_cell(g, CW_HEXAHEDRON,
                               (uint32_t[8]){number(i, j, k), number(i + 1, j, k),
                                             number(i + 1, j + 1, k), number(i, j + 1, k),
                                             number(i, j, k + 1), number(i + 1, j, k + 1),
                                             number(i + 1, j + 1, k + 1),
                                             number(i, j + 1, k + 1)});
}

enum { RINGS = 4, TURNS = 40, STORIES = 3 };

static uint32_t in_annulus(size_t i, size_t j, size_t k)
{
    return (uint32_t)((k * TURNS + j % TURNS) * (RINGS + 1) + i);
}

/* Radius, angle, height; clockwise the grid is left-handed. All of it inside is a ring, closed
 * by caps alone; the field cuts a smaller ring out of it. */
static void an_annulus_is_a_ring_either_way_round(void **state)
{
    (void)state;
    for (int clockwise = 0; clockwise < 2; clockwise++) {
        test_grid g = {0};
        for (size_t n = 0; n < (RINGS + 1) * TURNS * (STORIES + 1); n++) {
            const double r = 1 + (double)(n % (RINGS + 1)) / RINGS,
                         turn = 2 * PI * (double)(n / (RINGS + 1) % TURNS) / TURNS,
                         z = (double)(n / (RINGS + 1) / TURNS);
            test_grid_sample(&g, r * cos(turn), r * sin(turn) * (clockwise ? -1 : 1), z);
            g.values[n] = r - 1.3;
        }
        add_cells_between(&g, (size_t[3]){RINGS, TURNS, STORIES}, in_annulus);
        for (int whole = 0; whole < 2; whole++) {
            const cw_extract_desc desc = {.isovalue = whole ? -10 : 0};
            cw_extract_counts counts;
            cw_mesh m = test_extract(&g.volume, &desc, &counts);
            const cw_quality q = test_check_promise(&m, false);
            const double inner = whole ? 1 : 1.3, polygon = sin(2 * PI / TURNS) * TURNS / 2;
            assert_int_equal(q.euler, 0);
            assert_int_equal(q.components, 1);
            assert_int_equal(counts.border_loops, whole ? 0 : 2);
            assert_within(q.volume_mm3, polygon * (4 - inner * inner) * STORIES, 1e-5);
            cw_mesh_free(&m);
        }
        test_grid_free(&g);
    }
}

static uint32_t in_cut_annulus(size_t i, size_t j, size_t k)
{
    return (uint32_t)((k * (TURNS + 1) + j) * (RINGS + 1) + i);
}

/* Where the ring closes its samples are there twice: it ends on both sides, and the caps do not
 * touch. */
static void samples_in_one_place_are_two(void **state)
{
    (void)state;
    test_grid g = {0};
    for (size_t n = 0; n < (RINGS + 1) * (TURNS + 1) * (STORIES + 1); n++) {
        const double r = 1 + (double)(n % (RINGS + 1)) / RINGS,
                     turn = 2 * PI * (double)(n / (RINGS + 1) % (TURNS + 1) % TURNS) / TURNS;
        test_grid_sample(&g, r * cos(turn), r * sin(turn),
                         (double)(n / (RINGS + 1) / (TURNS + 1)));
    }
    add_cells_between(&g, (size_t[3]){RINGS, TURNS, STORIES}, in_cut_annulus);
    cw_mesh m = test_extract(&g.volume, &(cw_extract_desc){.isovalue = -1}, NULL);
    assert_int_equal(test_check_promise(&m, false).euler, 2);
    assert_int_equal(test_count_crossings(&m), 0);
    cw_mesh_free(&m);
    test_grid_free(&g);
}

enum { SHELLS = 6, RAYS = 24, ROWS = 12 };

/* The middle is one sample, and so is each pole of each shell. */
static uint32_t in_ball(size_t i, size_t j, size_t k)
{
    if (i == 0)
        return 0;
    const size_t shell = 1 + (i - 1) * (2 + (ROWS - 1) * RAYS);
    return (uint32_t)(j == 0      ? shell
                      : j == ROWS ? shell + 1
                                  : shell + 2 + (j - 1) * RAYS + k % RAYS);
}

static void make_ball(test_grid *g)
{
    memset(g, 0, sizeof *g);
    test_grid_sample(g, 0, 0, 0);
    for (int shell = 1; shell <= SHELLS; shell++) {
        const double r = (double)shell / SHELLS;
        test_grid_sample(g, 0, 0, r);
        test_grid_sample(g, 0, 0, -r);
        for (int row = 1; row < ROWS; row++)
            for (int ray = 0; ray < RAYS; ray++) {
                const double down = PI * row / ROWS, turn = 2 * PI * ray / RAYS;
                test_grid_sample(g, r * sin(down) * cos(turn), r * sin(down) * sin(turn),
                                 r * cos(down));
            }
    }
    add_cells_between(g, (size_t[3]){SHELLS, ROWS, RAYS}, in_ball);
}

static double beside_the_middle(const double p[3])
{
    const double x = p[0] - 0.1, y = p[1] - 0.05, z = p[2] - 0.15;
    return 0.5 - sqrt(x * x + y * y + z * z);
}

/* Spherical coordinates: hexahedra at the axis are wedges, and in the middle tetrahedra and
 * pyramids. */
static void hexahedra_may_collapse(void **state)
{
    (void)state;
    test_grid g;
    make_ball(&g);
    test_grid_fill(&g, beside_the_middle);
    cw_mesh m = test_extract(&g.volume, NULL, NULL);
    cw_quality q = test_check_promise(&m, false);
    assert_int_equal(q.euler, 2);
    assert_within(q.volume_mm3, 4.0 / 3 * PI * 0.125, 0.08);
    assert_int_equal(test_count_crossings(&m), 0);
    cw_mesh_free(&m);
    m = test_extract(&g.volume, &(cw_extract_desc){.isovalue = -10}, NULL);
    q = test_check_promise(&m, false);
    assert_int_equal(q.euler, 2);
    assert_int_equal(q.vertices, 2 + (ROWS - 1) * RAYS); /* nothing is left open inside */
    cw_mesh_free(&m);
    test_grid_free(&g);
}

static void check_manifold(const cw_mesh *m, bool open)
{
    cw_quality q;
    cw_error err = {0};
    assert_ok(cw_quality_measure(m, NULL, &q, &err), err);
    assert_int_equal(q.nonmanifold_edges + q.nonmanifold_vertices, 0);
    assert_int_equal(q.misoriented_edges, 0);
    assert_true(open || q.open_edges == 0);
}

static double distance(const test_grid *g, uint32_t a, uint32_t b)
{
    const double *p = g->points + 3 * (size_t)a, *q = g->points + 3 * (size_t)b;
    return sqrt(pow(p[0] - q[0], 2) + pow(p[1] - q[1], 2) + pow(p[2] - q[2], 2));
}

/* Makes the ends of a cell's first edge one sample, if it is one of the lattice's, and not near
 * another such place: cells that have more in common than a face, an edge or a corner would be
 * no grid. */
static void collapse_edge(test_grid *g, size_t cell, bool *near)
{
    const uint32_t *corners = test_grid_corners(g, cell);
    const uint32_t from = corners[0], to = corners[1];
    bool apart = distance(g, from, to) < 0.34;
    for (int round = 0; round < 2 && apart; round++) {
        const uint32_t *c = g->corners;
        for (size_t n = 0; n < g->cells.count; n++) {
            const size_t count = (size_t)cwi_shapes[g->shapes[n]].corner_count;
            bool around = false;
            for (size_t i = 0; i < count; i++)
                around = around || c[i] == from || c[i] == to;
            for (size_t i = 0; i < count && around; i++) {
                apart = apart && (round || !near[c[i]]);
                near[c[i]] = near[c[i]] || round;
            }
            c += count;
        }
    }
    for (size_t c = 0; c < g->corner_count && apart; c++)
        g->corners[c] = g->corners[c] == from ? to : g->corners[c];
}

/* Neighbours made one sample, anywhere: there are cells of seven corners, and ones that enclose
 * nothing. */
static void any_edge_may_collapse(void **state)
{
    (void)state;
    test_seed(7);
    for (int round = 0; round < 60; round++) {
        test_grid g;
        test_grid_make(&g, (test_cut)(round % TEST_CUT_COUNT), 6, 0);
        bool *near = calloc(g.samples, sizeof *near);
        assert_non_null(near);
        fill_with_noise(&g, round % 3 ? 1 : 0);
        for (int n = 0; n < 30; n++)
            collapse_edge(&g, (size_t)rand() % g.cells.count, near);
        cw_mesh m = test_extract(&g.volume, &(cw_extract_desc){.leave_open = round & 2}, NULL);
        check_manifold(&m, round & 2);
        cw_mesh_free(&m);
        free(near);
        test_grid_free(&g);
    }
}

/* Of hexahedra also many in one place, edges and diagonals. */
static void hexahedra_may_collapse_to_anything(void **state)
{
    (void)state;
    test_seed(17);
    for (int round = 0; round < 40; round++) {
        test_grid g;
        test_grid_make(&g, TEST_HEXAHEDRA, 5, 0.1);
        fill_with_noise(&g, round % 3 ? 1 : 0);
        for (int n = 0; n < 12; n++) {
            const uint32_t *cell = test_grid_corners(&g, (size_t)rand() % g.cells.count);
            const uint32_t from = cell[0], to = cell[1 + rand() % 3];
            for (size_t c = 0; c < g.corner_count; c++)
                g.corners[c] = g.corners[c] == from ? to : g.corners[c];
        }
        cw_mesh m = test_extract(&g.volume, &(cw_extract_desc){.leave_open = round & 2}, NULL);
        check_manifold(&m, round & 2);
        cw_mesh_free(&m);
        test_grid_free(&g);
    }
}

/* --- cells by themselves ----------------------------------------------------------------- */

/* A hexahedron whose corners are named so encloses what another shape does, or as
 * many faces. */
static void a_cell_is_what_its_corners_leave(void **state)
{
    (void)state;
    const struct {
        uint32_t corners[8];
        size_t triangles; /* of its caps; 0: it is nothing */
    } rows[] = {
        {{0, 1, 2, 3, 4, 5, 6, 7}, 12}, /* itself */
        {{0, 1, 2, 3, 0, 1, 6, 7}, 8},  /* a wedge */
        {{0, 0, 2, 3, 4, 4, 6, 7}, 8},  /* a wedge, from the side */
        {{0, 1, 2, 3, 4, 4, 4, 4}, 6},  /* a pyramid */
        {{0, 1, 2, 2, 4, 4, 4, 4}, 4},  /* a tetrahedron */
        {{0, 1, 2, 3, 0, 5, 6, 7}, 10}, /* seven corners */
        {{0, 1, 2, 3, 0, 1, 2, 3}, 0},  /* flat */
        {{0, 1, 0, 3, 4, 5, 6, 7}, 0},  /* folded */
        {{0, 0, 0, 0, 0, 0, 0, 0}, 0},
    };
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++)
        for (int mirror = 0; mirror < 2; mirror++) {
            test_grid g = {0};
            for (int n = 0; n < 8; n++)
                test_grid_sample(&g, n % 4 == 1 || n % 4 == 2, n % 4 > 1, n / 4);
            test_grid_cell(&g, CW_HEXAHEDRON, rows[r].corners);
            if (mirror)
                test_grid_mirror(&g, 0);
            cw_mesh m = test_extract(&g.volume, &(cw_extract_desc){.isovalue = -1}, NULL);
            const cw_quality q = test_check_promise(&m, false);
            assert_int_equal(m.triangle_count, rows[r].triangles);
            assert_true(rows[r].triangles == 0 || (q.volume_mm3 > 0.1 && q.euler == 2));
            cw_mesh_free(&m);
            test_grid_free(&g);
        }
}

/* Cells that a file names twice overlap: their surfaces stand in one place, but have nothing
 * to do with each other. */
static void cells_named_twice_are_two(void **state)
{
    (void)state;
    test_seed(12);
    for (int round = 0; round < 20; round++) {
        test_grid g;
        test_grid_make(&g, (test_cut)(round % TEST_CUT_COUNT), 5, 0.1);
        fill_with_noise(&g, 1);
        const size_t count = g.cells.count;
        for (int n = 0; n < 20; n++) {
            uint32_t corners[8];
            const size_t cell = (size_t)rand() % count;
            memcpy(corners, test_grid_corners(&g, cell),
                   cwi_shapes[g.shapes[cell]].corner_count * sizeof *corners);
            test_grid_cell(&g, (cw_shape)g.shapes[cell], corners);
        }
        cw_mesh m = test_extract(&g.volume, &(cw_extract_desc){.leave_open = round & 1}, NULL);
        check_manifold(&m, round & 1);
        cw_mesh_free(&m);
        test_grid_free(&g);
    }
}

/* --- borders ----------------------------------------------------------------------------- */

/* A lattice of n boxes, of which some are left out. */
static void make_boxes(test_grid *g, const size_t n[3], const bool *there)
{
    memset(g, 0, sizeof *g);
    const size_t rows = n[0] + 1, layers = rows * (n[1] + 1);
    for (size_t m = 0; m < layers * (n[2] + 1); m++)
        test_grid_sample(g, (double)(m % rows), (double)(m / rows % (n[1] + 1)),
                         (double)(m / layers));
    for (size_t m = 0; m < n[0] * n[1] * n[2]; m++) {
        const size_t at[3] = {m % n[0], m / n[0] % n[1], m / n[0] / n[1]};
        const uint32_t c = (uint32_t)(at[2] * layers + at[1] * rows + at[0]);
        const uint32_t r = (uint32_t)rows, l = (uint32_t)layers;
        if (there[m])
            test_grid_cell(g, CW_HEXAHEDRON,
                           (uint32_t[8]){c, c + 1, c + r + 1, c + r, c + l, c + l + 1,
                                         c + l + r + 1, c + l + r});
    }
}

/* Cells that touch in an edge or a corner only stay apart, wherever the surface goes; and a
 * solid that touches itself in an edge is closed there all the same. */
static void pinched_borders_are_parted(void **state)
{
    (void)state;
    const struct {
        size_t n[3];
        bool there[12];
        size_t components; /* when all is inside */
        long euler;
    } rows[] = {
        {{2, 2, 1}, {1, 0, 0, 1}, 2, 4},
        {{2, 2, 2}, {1, 0, 0, 0, 0, 0, 0, 1}, 2, 4},
        {{2, 2, 2}, {0, 1, 1, 1, 1, 1, 1, 0}, 1, 2},
        {{2, 2, 2}, {1, 1, 1, 0, 0, 1, 1, 1}, 1, 2},
        {{2, 2, 3}, {1, 1, 1, 1, 0, 1, 1, 0, 1, 1, 1, 1}, 1, 0},
    };
    test_seed(8);
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        test_grid g;
        make_boxes(&g, rows[r].n, rows[r].there);
        cw_mesh m = test_extract(&g.volume, &(cw_extract_desc){.isovalue = -1}, NULL);
        const cw_quality q = test_check_promise(&m, false);
        assert_int_equal(q.components, rows[r].components);
        assert_int_equal(q.euler, rows[r].euler);
        cw_mesh_free(&m);
        for (int round = 0; round < 200; round++) {
            fill_with_noise(&g, round % 2);
            m = test_extract(&g.volume, &(cw_extract_desc){.leave_open = round & 2}, NULL);
            test_check_promise(&m, round & 2);
            cw_mesh_free(&m);
        }
        test_grid_free(&g);
    }
}

/* Two tetrahedra where the neighbour has a quadrangle: not the same faces, so both are closed,
 * also where the cells around hold them together. */
static void cells_that_do_not_fit_are_closed_apart(void **state)
{
    (void)state;
    test_seed(9);
    for (int round = 0; round < 200; round++) {
        test_grid g;
        make_boxes(&g, (size_t[3]){3, 3, 2},
                   (bool[18]){1, 1, 1, 1, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1});
        const uint32_t c = 5, r = 4, l = 16, tip = test_grid_sample(&g, 1.5, 1.5, 0.5);
        const uint32_t q[6][4] = {
            {c, c + r, c + r + 1, c + 1}, {c + l, c + l + 1, c + l + r + 1, c + l + r},
            {c, c + 1, c + l + 1, c + l}, {c + r, c + l + r, c + l + r + 1, c + r + 1},
            {c, c + l, c + l + r, c + r}, {c + 1, c + r + 1, c + l + r + 1, c + l + 1}};
        for (int n = 0; n < 6; n++) {
            if (rand() % 3) {
                test_grid_cell(&g, CW_PYRAMID,
                               (uint32_t[5]){q[n][0], q[n][1], q[n][2], q[n][3], tip});
                continue;
            }
            test_grid_cell(&g, CW_TETRAHEDRON, (uint32_t[4]){q[n][0], q[n][1], q[n][2], tip});
            test_grid_cell(&g, CW_TETRAHEDRON, (uint32_t[4]){q[n][0], q[n][2], q[n][3], tip});
        }
        fill_with_noise(&g, 1);
        cw_quality found;
        cw_mesh m = test_extract(&g.volume, NULL, NULL);
        assert_ok(cw_quality_measure(&m, NULL, &found, NULL), (cw_error){0});
        assert_true(cw_quality_is_closed_manifold(&found));
        cw_mesh_free(&m);
        test_grid_free(&g);
    }
}

/* A face that three cells have is a border of each; a ring of cells that comes back as its
 * mirror image is cut open. */
static void faces_that_no_two_sides_have_are_borders(void **state)
{
    (void)state;
    test_grid g = {0};
    test_grid_sample(&g, 0, 0, 0);
    test_grid_sample(&g, 1, 0, 0);
    test_grid_sample(&g, 0, 1, 0);
    for (int n = 0; n < 3; n++) {
        test_grid_sample(&g, 0.2 * n, 0.1, n ? n : -1);
        test_grid_cell(&g, CW_TETRAHEDRON, (uint32_t[4]){0, 1, 2, 3 + (uint32_t)n});
    }
    cw_mesh m = test_extract(&g.volume, &(cw_extract_desc){.isovalue = -1}, NULL);
    const cw_quality q = test_check_promise(&m, false);
    assert_int_equal(q.components, 3);
    assert_int_equal(q.euler, 6);
    cw_mesh_free(&m);
    test_grid_free(&g);

    enum { CELLS = 7 };
    memset(&g, 0, sizeof g);
    for (int n = 0; n < 4 * CELLS; n++) {
        const double turn = 2 * PI * (n / 4) / CELLS, r = n % 4 == 1 || n % 4 == 2 ? 3 : 2;
        test_grid_sample(&g, r * cos(turn), r * sin(turn), n % 4 > 1);
    }
    for (uint32_t n = 0; n < CELLS; n++) {
        const uint32_t a = 4 * n, b = 4 * (n + 1) % (4 * CELLS);
        const bool last = n + 1 == CELLS;
        test_grid_cell(&g, CW_HEXAHEDRON,
                       (uint32_t[8]){a, a + 1, a + 2, a + 3, last ? b + 1 : b, last ? b : b + 1,
                                     last ? b + 3 : b + 2, last ? b + 2 : b + 3});
    }
    m = test_extract(&g.volume, &(cw_extract_desc){.isovalue = -1}, NULL);
    cw_quality strip;
    assert_ok(cw_quality_measure(&m, NULL, &strip, NULL), (cw_error){0});
    assert_true(cw_quality_is_closed_manifold(&strip));
    assert_int_equal(strip.euler, 2);
    cw_mesh_free(&m);
    test_grid_free(&g);
}

/* --- calls ------------------------------------------------------------------------------- */

static void threads_do_not_change_a_byte(void **state)
{
    (void)state;
    test_seed(10);
    for (int round = 0; round < TEST_SOME(6); round++) {
        test_grid g;
        test_grid_make(&g, TEST_MIXED, 22, 0.2);
        fill_with_noise(&g, round);
        cw_mesh one = test_extract(&g.volume, &(cw_extract_desc){.threads = 1}, NULL),
                three = test_extract(&g.volume, &(cw_extract_desc){.threads = 3}, NULL);
        test_assert_same_mesh(&one, &three);
        cw_mesh_free(&one);
        cw_mesh_free(&three);
        test_grid_free(&g);
    }
}

static cw_status take_whole(void *user, const cw_slab *slab, cw_error *err)
{
    const cw_mesh *whole = user;
    (void)err;
    assert_true(slab->last && slab->low < -1e300 && slab->high > 1e300);
    assert_int_equal(slab->triangles, whole->triangle_count);
    assert_int_equal(slab->mesh->triangle_count, whole->triangle_count);
    assert_memory_equal(slab->mesh->triangles, whole->triangles, 12 * whole->triangle_count);
    for (size_t v = 0; v < slab->mesh->vertex_count; v++)
        assert_int_equal(slab->seam[v], 0);
    return CW_OK;
}

/* A slab is all of it, and an extractor makes it anew. */
static void slabs_and_extractors_give_the_same(void **state)
{
    (void)state;
    test_grid g;
    cw_extractor *e;
    cw_error err = {0};
    cw_mesh again;
    cw_extract_counts counts, predicted;
    test_grid_make(&g, TEST_MIXED, 10, 0.2);
    test_grid_fill(&g, slope);
    cw_mesh m = test_extract(&g.volume, NULL, &counts);
    assert_true(m.triangle_count > 0);
    assert_ok(cw_extract_slabs(&g.volume, NULL, 10, (cw_slab_sink){take_whole, &m}, NULL, &err),
              err);
    assert_ok(cw_extractor_new(&g.volume, &e, &err), err);
    for (int n = 0; n < 2; n++) {
        assert_ok(cw_extractor_predict(e, NULL, &predicted, &err), err);
        assert_memory_equal(&predicted, &counts, sizeof counts);
        assert_ok(cw_extractor_extract(e, NULL, &again, NULL, &err), err);
        test_assert_same_mesh(&m, &again);
        cw_mesh_free(&again);
    }
    cw_extractor_free(e);
    cw_mesh_free(&m);
    test_grid_free(&g);
}

static void what_is_wrong_is_named(void **state)
{
    (void)state;
    test_grid g;
    cw_error err = {0};
    cw_mesh m;
    test_grid_make(&g, TEST_MIXED, 10, 0);
    test_grid_fill(&g, sphere);
#define FAILS(desc, status, words)                                                             \
    assert_fails(cw_extract(&g.volume, &(cw_extract_desc)desc, &m, NULL, &err), status, words, \
                 err)
    FAILS({.snap = 0.3}, CW_ERR_UNSUPPORTED, "snap on an irregular grid");
    FAILS({.cubic_placement = true}, CW_ERR_UNSUPPORTED, "cubic");
    FAILS({.isovalue = NAN}, CW_ERR_ARGUMENT, "isovalue");
    FAILS({.max_triangles = 5}, CW_ERR_LIMIT, "triangles; the limit is 5");
    FAILS({.max_bytes = 500}, CW_ERR_LIMIT, "500 bytes are left");
    uint32_t *corner = test_grid_corners(&g, 20) + 3;
    const uint32_t own = *corner;
    *corner = (uint32_t)g.samples;
    FAILS({0}, CW_ERR_ARGUMENT, "cell 20 has a corner at sample");
    *corner = own;
    const uint8_t shape = g.shapes[30];
    g.shapes[30] = 4;
    FAILS({0}, CW_ERR_ARGUMENT, "cell 30 has shape 4");
    g.shapes[30] = shape;
    const double x = g.points[3 * 17];
    g.points[3 * 17] = INFINITY;
    FAILS({0}, CW_ERR_ARGUMENT, "sample 17 is not finite");
    g.points[3 * 17] = 1e300;
    FAILS({0}, CW_ERR_ARGUMENT, "beyond what positions can hold");
    g.points[3 * 17] = x;
    g.volume.affine[0][0] = g.volume.affine[1][1] = g.volume.affine[2][2] = 1e-60;
    FAILS({0}, CW_ERR_ARGUMENT, "beyond what positions can hold");
    g.volume.affine[0][0] = g.volume.affine[1][1] = g.volume.affine[2][2] = 1;
    m = test_extract(&g.volume, NULL, NULL);
    assert_fails(cw_extract_normals(&g.volume, NULL, &m, &err), CW_ERR_UNSUPPORTED,
                 "irregular grid", err);
    cw_mesh_free(&m);
    g.cells.count = 0;
    m = test_extract(&g.volume, NULL, NULL);
    assert_int_equal(m.vertex_count, 0);
    test_grid_free(&g);
}

static void it_can_be_stopped_anywhere(void **state)
{
    (void)state;
    test_grid g;
    cw_error err = {0};
    cw_mesh m;
    cw_status st = CW_ERR_CANCELLED;
    test_grid_make(&g, TEST_MIXED, 10, 0);
    test_grid_fill(&g, slope);
    int polls = 0;
    for (int n = 0; st == CW_ERR_CANCELLED; n++) {
        polls = n;
        const cw_extract_desc desc = {.progress = {test_stop_after, &polls}};
        st = cw_extract(&g.volume, &desc, &m, NULL, &err);
        assert_true(n < 200 && (st == CW_OK) == (m.triangles != NULL));
    }
    assert_ok(st, err);
    cw_mesh_free(&m);
    st = CW_ERR_NO_MEMORY;
    for (long n = 0; st == CW_ERR_NO_MEMORY; n++) {
        cwi_alloc_fail_after(n);
        st = cw_extract(&g.volume, &(cw_extract_desc){.threads = 1}, &m, NULL, &err);
        cwi_alloc_fail_after(-1);
        assert_true(n < 200 && (st == CW_OK) == (m.triangles != NULL));
    }
    assert_ok(st, err);
    cw_mesh_free(&m);
    test_grid_free(&g);
}

/* Values of any size, and infinite ones, make no bad number; so do cells of no volume. */
static void extremes_stay_finite(void **state)
{
    (void)state;
    test_seed(11);
    const double scales[] = {1e-320, 1e-160, 1, 1e160, 1.7e308};
    for (size_t s = 0; s < sizeof scales / sizeof *scales; s++)
        for (int round = 0; round < 4; round++) {
            test_grid g;
            test_grid_make(&g, TEST_MIXED, 6, 0.1);
            for (size_t n = 0; n < g.samples; n++)
                g.values[n] = round & 1 && rand() % 4 == 0 ? (rand() % 2 ? INFINITY : -INFINITY)
                                                           : random_number(-1, 1) * scales[s];
            if (round & 2)
                for (size_t n = 0; n < g.samples; n++)
                    g.points[3 * n + 2] = 0;
            cw_quality q;
            cw_mesh m = test_extract(&g.volume, NULL, NULL);
            cw_error err = {0};
            assert_ok(cw_mesh_check(&m, &err), err);
            assert_ok(cw_quality_measure(&m, NULL, &q, &err), err);
            assert_true(cw_quality_is_closed_manifold(&q));
            for (size_t v = 0; v < m.vertex_count; v++) {
                const float *n = m.normals + 3 * v;
                assert_near((double)(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), 1, 1e-5);
            }
            cw_mesh_free(&m);
            test_grid_free(&g);
        }
}

/* Cells between samples at random overlap in every way: no promise holds, but nothing breaks,
 * and all is made that was counted. */
static void any_cells_give_a_mesh(void **state)
{
    (void)state;
    test_seed(13);
    for (int round = 0; round < 400; round++) {
        test_grid g = {0};
        const size_t samples = 4 + (size_t)rand() % 20;
        for (size_t n = 0; n < samples; n++)
            test_grid_sample(&g, rand() % 4, rand() % 4, rand() % 4);
        for (int n = rand() % 60; n >= 0; n--) {
            uint32_t corners[8];
            for (int c = 0; c < 8; c++)
                corners[c] = (uint32_t)((size_t)rand() % samples);
            test_grid_cell(&g, (cw_shape)(rand() % CW_SHAPE_COUNT), corners);
        }
        fill_with_noise(&g, round % 2);
        for (int open = 0; open < 2; open++) {
            cw_quality q;
            cw_error err = {0};
            cw_extract_counts counts;
            cw_mesh m =
                test_extract(&g.volume, &(cw_extract_desc){.leave_open = open}, &counts);
            assert_ok(cw_mesh_check(&m, &err), err);
            assert_ok(cw_quality_measure(&m, NULL, &q, &err), err);
            assert_int_equal(m.triangle_count, counts.triangles);
            assert_int_equal(q.unused_vertices, 0);
            if (!open)
                assert_int_equal(q.open_edges, 0);
            cw_mesh_free(&m);
        }
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
        cmocka_unit_test(a_lattice_of_hexahedra_is_a_dense_grid),
        cmocka_unit_test(cells_may_be_inside_out),
        cmocka_unit_test(an_annulus_is_a_ring_either_way_round),
        cmocka_unit_test(samples_in_one_place_are_two),
        cmocka_unit_test(hexahedra_may_collapse),
        cmocka_unit_test(any_edge_may_collapse),
        cmocka_unit_test(hexahedra_may_collapse_to_anything),
        cmocka_unit_test(a_cell_is_what_its_corners_leave),
        cmocka_unit_test(cells_named_twice_are_two),
        cmocka_unit_test(pinched_borders_are_parted),
        cmocka_unit_test(cells_that_do_not_fit_are_closed_apart),
        cmocka_unit_test(faces_that_no_two_sides_have_are_borders),
        cmocka_unit_test(threads_do_not_change_a_byte),
        cmocka_unit_test(slabs_and_extractors_give_the_same),
        cmocka_unit_test(what_is_wrong_is_named),
        cmocka_unit_test(it_can_be_stopped_anywhere),
        cmocka_unit_test(extremes_stay_finite),
        cmocka_unit_test(any_cells_give_a_mesh),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
