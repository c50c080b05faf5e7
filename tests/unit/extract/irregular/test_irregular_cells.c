/* Irregular grids: curvilinear, collapsed and single cells, and their borders. */
#include "support/irregular_cases.h"

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

int main(void)
{
    const struct CMUnitTest tests[] = {
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
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
