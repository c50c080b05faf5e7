/* Booleans of meshes: volumes known on paper, random pairs whose volumes must add up, contacts, and results that
 * are sound after rounding. */
#include "support/solids.h"

#include "core/base/memory.h"
#include "core/geometry/big_integer.h"
#include "core/mesh/mesh.h"

#include <cubewright/boolean.h>
#include <cubewright/field.h>
#include <cubewright/quality.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

static cw_mesh make_box(double x, double y, double z, double size)
{
    cw_mesh m = test_make_boxes(1);
    test_add_box(&m, (const double[3]){x, y, z},
                 (const double[3]){x + size, y + size, z + size}, false);
    return m;
}

/* Runs a boolean of two meshes, checks the result, and returns its volume before rounding. */
static double check_boolean(const cw_mesh *a, const cw_mesh *b, cw_boolean_op op,
                            cw_boolean_facts *facts)
{
    const cw_mesh *meshes[2] = {a, b};
    cw_error err = {0};
    cw_mesh out[2];
    double area = 0;
    for (int n = 0; n < 2; n++)
        area += meshes[n]->triangle_count ? test_measure(meshes[n]).area_mm2 : 0;
    *facts = (cw_boolean_facts){0};
    assert_ok(cw_mesh_boolean(meshes, 2, &(cw_boolean_desc){.op = op}, out, facts, &err), err);
    for (int n = 0; n < (op == CW_BOOLEAN_SPLIT ? 2 : 1); n++) {
        test_check_solid(&out[n]);
        const double volume = out[n].triangle_count ? test_measure(&out[n]).volume_mm3 : 0;
        const double slack =
            1e-6 * (fabs(volume) + facts->volume_mm3[n]) + 2 * facts->moved_mm * area;
        assert_true(fabs(volume - facts->volume_mm3[n]) <= slack);
        cw_mesh_free(&out[n]);
    }
    return facts->volume_mm3[0];
}

/* Boxes beside a cube of size 4 at 0: where they are, and the volumes that are known on paper. */
static const struct box_row {
    double at[3], size;
    double both;            /* the volume of the intersection */
    size_t edges, vertices; /* contacts of the union */
} box_rows[] = {
    {{2, 2, 2}, 4, 8, 0, 0},  /* corners in each other */
    {{4, 0, 0}, 4, 0, 0, 0},  /* a whole face */
    {{4, 1, 1}, 2, 0, 0, 0},  /* a part of a face */
    {{4, 2, 2}, 4, 0, 0, 0},  /* faces that overlap */
    {{4, 4, 0}, 4, 0, 1, 2},  /* an edge */
    {{4, 4, 2}, 4, 0, 1, 2},  /* parts of edges */
    {{4, 4, 4}, 4, 0, 0, 1},  /* a corner */
    {{1, 1, 1}, 2, 8, 0, 0},  /* inside */
    {{1, 1, 0}, 2, 8, 0, 0},  /* inside, at a face */
    {{0, 0, 0}, 2, 8, 0, 0},  /* inside, at a corner */
    {{2, 0, 0}, 4, 32, 0, 0}, /* four faces in common planes */
    {{0, 0, 0}, 4, 64, 0, 0}, /* the same */
    {{9, 9, 9}, 4, 0, 0, 0},  /* apart */
};

static void boxes_have_their_volumes(void **state)
{
    (void)state;
    static const double scales[] = {1, 1e-6, 1e6, 0.3};
    for (size_t i = 0; i < sizeof box_rows / sizeof *box_rows; i++)
        for (int s = 0; s < 4; s++) {
            const struct box_row *row = &box_rows[i];
            const double k = scales[s], unit = k * k * k;
            cw_mesh a = make_box(0, 0, 0, 4 * k);
            cw_mesh b = make_box(k * row->at[0], k * row->at[1], k * row->at[2], k * row->size);
            const double va = 64 * unit, vb = pow(k * row->size, 3), both = row->both * unit;
            cw_boolean_facts f;
            /* not all multiples of 1e-6 and 0.3 are floats */
            const double slack = s == 0 ? 0 : 1e-5 * va;
            assert_true(fabs(check_boolean(&a, &b, CW_BOOLEAN_UNION, &f) - (va + vb - both)) <=
                        slack);
            if (s == 0) {
                assert_int_equal(f.contact_edges, row->edges);
                assert_int_equal(f.contact_vertices, row->vertices);
            }
            assert_true(fabs(check_boolean(&a, &b, CW_BOOLEAN_DIFFERENCE, &f) - (va - both)) <=
                        slack);
            assert_true(fabs(check_boolean(&a, &b, CW_BOOLEAN_INTERSECTION, &f) - both) <=
                        slack);
            assert_true(fabs(check_boolean(&a, &b, CW_BOOLEAN_XOR, &f) -
                             (va + vb - 2 * both)) <= slack);
            assert_true(fabs(check_boolean(&a, &b, CW_BOOLEAN_SPLIT, &f) - (va - both)) <=
                        slack);
            assert_true(fabs(f.volume_mm3[1] - both) <= slack);
            cw_mesh_free(&a);
            cw_mesh_free(&b);
        }
}

/* A box between 0 and `size` whose lower and upper faces are n x n squares of two triangles. They come first. */
static cw_mesh make_plate(size_t n, float size)
{
    const size_t row = n + 1, sheet = row * row;
    cw_mesh m;
    cw_error err = {0};
    assert_ok(cwi_mesh_alloc(&m, 2 * sheet, 4 * n * n + 8 * n, false, &err), err);
    for (size_t v = 0; v < 2 * sheet; v++) {
        m.positions[3 * v] = size * (float)(v % row) / (float)n;
        m.positions[3 * v + 1] = size * (float)(v % sheet / row) / (float)n;
        m.positions[3 * v + 2] = v < sheet ? 0 : size;
    }
    uint32_t *t = m.triangles;
    for (size_t c = 0; c < 2 * n * n; c++) {
        const uint32_t a = (uint32_t)(c / (n * n) * sheet + c % (n * n) / n * row + c % n);
        const uint32_t b = a + 1, d = a + (uint32_t)row, e = d + 1;
        const bool up = c >= n * n;
        const uint32_t both[6] = {a, up ? b : e, up ? e : b, a, up ? e : d, up ? d : e};
        memcpy(t, both, sizeof both);
        t += 6;
    }
    for (size_t c = 0; c < 4 * n; c++) { /* around, against the clock seen from above */
        const size_t k = c % n, side = c / n;
        const size_t from = side == 0   ? k
                            : side == 1 ? n + k * row
                            : side == 2 ? sheet - 1 - k
                                        : (n - k) * row;
        const size_t to = side == 0   ? k + 1
                          : side == 1 ? n + (k + 1) * row
                          : side == 2 ? sheet - 2 - k
                                      : (n - k - 1) * row;
        const uint32_t a = (uint32_t)from, b = (uint32_t)to, d = (uint32_t)(from + sheet),
                       e = (uint32_t)(to + sheet);
        const uint32_t both[6] = {a, b, e, a, e, d};
        memcpy(t, both, sizeof both);
        t += 6;
    }
    return m;
}

/* Lines along x tell nothing in faces along x, of which there may be any number before the others. */
static void many_triangles_lie_along_x(void **state)
{
    (void)state;
    static const size_t counts[] = {1, 30, 60};
    for (int n = 0; n < 3; n++) {
        cw_mesh plate = make_plate(counts[n], 4), cube = make_box(1, 1, 1, 2),
                corner = make_box(2, 2, 2, 4);
        cw_boolean_facts f;
        assert_true(fabs(check_boolean(&plate, &cube, CW_BOOLEAN_DIFFERENCE, &f) - 56) < 1e-6);
        assert_true(fabs(check_boolean(&plate, &corner, CW_BOOLEAN_DIFFERENCE, &f) - 56) <
                    1e-6);
        assert_true(fabs(check_boolean(&corner, &plate, CW_BOOLEAN_UNION, &f) - 120) < 1e-6);
        cw_mesh_free(&plate);
        cw_mesh_free(&cube);
        cw_mesh_free(&corner);
    }
}

enum { GRID = 6, MAX_BOXES = 8 };

/* Counts the cells of a grid that an operation keeps, by the boxes around each: bit n of box n. */
static int count_cells(const unsigned cells[GRID][GRID][GRID], int boxes, cw_boolean_op op)
{
    int count = 0;
    for (int c = 0; c < GRID * GRID * GRID; c++) {
        const unsigned in = cells[c / GRID / GRID][c / GRID % GRID][c % GRID];
        const int number = __builtin_popcount(in);
        count += op == CW_BOOLEAN_UNION          ? number > 0
                 : op == CW_BOOLEAN_DIFFERENCE   ? in == 1
                 : op == CW_BOOLEAN_INTERSECTION ? number == boxes
                                                 : number % 2;
    }
    return count;
}

/* Boxes between the points of a small grid: they touch and overlap in every way, and volumes are numbers of cells. */
static void boxes_on_a_grid_have_whole_volumes(void **state)
{
    (void)state;
    const int count = test_some(60);
    srand(test_seed(76));
    for (int n = 0; n < count; n++) {
        unsigned cells[GRID][GRID][GRID] = {0};
        cw_mesh boxes[MAX_BOXES];
        const cw_mesh *meshes[MAX_BOXES];
        const int number = 2 + rand() % (MAX_BOXES - 1);
        for (int i = 0; i < number; i++) {
            int low[3], high[3];
            double from[3], to[3];
            for (int k = 0; k < 3; k++) {
                low[k] = rand() % (GRID - 1);
                high[k] = low[k] + 1 + rand() % 3;
                high[k] = high[k] < GRID ? high[k] : GRID;
                from[k] = low[k];
                to[k] = high[k];
            }
            for (int x = low[0]; x < high[0]; x++)
                for (int y = low[1]; y < high[1]; y++)
                    for (int z = low[2]; z < high[2]; z++)
                        cells[x][y][z] |= 1u << i;
            boxes[i] = test_make_boxes(1);
            test_add_box(&boxes[i], from, to, false);
            meshes[i] = &boxes[i];
        }
        for (int op = 0; op < CW_BOOLEAN_SPLIT; op++) {
            cw_mesh out;
            cw_error err = {0};
            cw_boolean_facts f = {0};
            const int volume =
                count_cells((const unsigned(*)[GRID][GRID])cells, number, (cw_boolean_op)op);
            assert_ok(cw_mesh_boolean(meshes, (size_t)number,
                                      &(cw_boolean_desc){.op = (cw_boolean_op)op}, &out, &f,
                                      &err),
                      err);
            test_check_solid(&out);
            if (fabs(f.volume_mm3[0] - volume) > 1e-9)
                fail_msg("boxes %d, operation %d: the volume is %.12g, not %d", n, op,
                         f.volume_mm3[0], volume);
            cw_mesh_free(&out);
        }
        for (int i = 0; i < number; i++)
            cw_mesh_free(&boxes[i]);
    }
}

/* Boxes of a small grid, turned together and stored as floats: faces that were one are a last digit apart. */
static void boxes_that_touch_may_be_turned(void **state)
{
    (void)state;
    static const int numbers[] = {2, 4, 20, 40};
    const int count = test_some(16);
    srand(test_seed(77));
    for (int n = 0; n < count; n++) {
        unsigned cells[GRID][GRID][GRID] = {0};
        const int number = numbers[n % 4];
        cw_mesh solids[2] = {test_make_boxes(40), test_make_boxes(40)};
        const double angle = pow(10, -n % 3), tilt = test_random();
        for (int i = 0; i < number; i++) {
            double from[3], to[3];
            for (int k = 0; k < 3; k++) {
                from[k] = rand() % (GRID - 2);
                to[k] = from[k] + 1 + rand() % 2;
            }
            for (int c = 0; c < GRID * GRID * GRID; c++) {
                const int at[3] = {c / GRID / GRID, c / GRID % GRID, c % GRID};
                bool inside = true;
                for (int k = 0; k < 3; k++)
                    inside = inside && at[k] >= from[k] && at[k] < to[k];
                cells[at[0]][at[1]][at[2]] |= inside ? 1u << i % 2 : 0;
            }
            test_add_box(&solids[i % 2], from, to, false);
        }
        for (int i = 0; i < 2; i++)
            for (size_t v = 0; v < solids[i].vertex_count; v++) {
                float *p = solids[i].positions + 3 * v;
                const double x = (double)p[0], y = (double)p[1], z = (double)p[2];
                const double turned = x * cos(angle) - y * sin(angle);
                p[0] = (float)(turned * cos(tilt) - z * sin(tilt));
                p[1] = (float)(x * sin(angle) + y * cos(angle));
                p[2] = (float)(turned * sin(tilt) + z * cos(tilt));
            }
        for (int op = 0; op < CW_BOOLEAN_SPLIT; op++) {
            cw_boolean_facts f;
            const int volume =
                count_cells((const unsigned(*)[GRID][GRID])cells, 2, (cw_boolean_op)op);
            const double found = check_boolean(&solids[0], &solids[1], (cw_boolean_op)op, &f);
            if (fabs(found - volume) > 1e-4 || f.moved_mm > 1e-4)
                fail_msg("boxes %d, operation %d: the volume is %.12g, not %d, moved %g", n, op,
                         found, volume, f.moved_mm);
        }
        cw_mesh_free(&solids[0]);
        cw_mesh_free(&solids[1]);
    }
}

/* One mesh of shells that overlap, are nested, doubled or inside out. */
static void shells_of_one_mesh_are_united(void **state)
{
    (void)state;
    static const struct shell_row {
        double low[3][3], size[3];
        bool inward[3];
        int count;
        double volume, lost; /* lost: shells that are inside out, and in no other */
    } rows[] = {
        {{{0, 0, 0}, {2, 2, 2}}, {4, 4}, {0}, 2, 120, 0},          /* overlap */
        {{{0, 0, 0}, {1, 1, 1}}, {4, 2}, {0}, 2, 64, 0},           /* nested: solid */
        {{{0, 0, 0}, {1, 1, 1}}, {4, 2}, {false, true}, 2, 56, 0}, /* nested: a cavity */
        {{{0, 0, 0}, {0, 0, 0}}, {4, 4}, {0}, 2, 64, 0},           /* doubled */
        {{{0, 0, 0}, {4, 0, 0}}, {4, 4}, {0}, 2, 128, 0},          /* share a face */
        {{{0, 0, 0}}, {4}, {true}, 1, 64, 0},                      /* inside out */
        {{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {6, 4, 2}, {false, true, false}, 3, 160, 0},
        {{{0, 0, 0}, {9, 9, 9}}, {4, 2}, {false, true}, 2, 64, 8}, /* beside */
        {{{0, 0, 0}, {3, 3, 3}}, {4, 2}, {false, true}, 2, 63, 7}, /* half in it */
        {{{0, 0, 0}, {9, 9, 9}},
         {2, 4},
         {false, true},
         2,
         64,
         8}, /* the larger one is turned */
        {{{0, 0, 0}, {20, 0, 0}, {21, 1, 1}}, {9, 4, 2}, {false, true, false}, 3, 729, 56},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        cw_mesh m = test_make_boxes(3), out;
        const cw_mesh *meshes[1] = {&m};
        cw_error err = {0};
        cw_boolean_facts f = {0};
        uint8_t input = 0;
        double sum = 0;
        for (int i = 0; i < rows[n].count; i++) {
            sum += pow(rows[n].size[i], 3) * (rows[n].inward[i] ? -1 : 1);
            const double *low = rows[n].low[i], size = rows[n].size[i];
            test_add_box(&m, low,
                         (const double[3]){low[0] + size, low[1] + size, low[2] + size},
                         rows[n].inward[i]);
        }
        assert_ok(
            cw_mesh_boolean(meshes, 1, &(cw_boolean_desc){.inputs = &input}, &out, &f, &err),
            err);
        test_check_solid(&out);
        assert_true(f.volume_mm3[0] == rows[n].volume);
        assert_int_equal(f.turned, sum < 0);
        assert_int_equal(f.negative_regions, rows[n].lost > 0);
        assert_true(f.negative_mm3 == rows[n].lost);
        assert_int_equal(input, (sum < 0 ? CW_BOOLEAN_TURNED : 0) |
                                    (rows[n].lost > 0 ? CW_BOOLEAN_NEGATIVE : 0));
        cw_mesh_free(&m);
        cw_mesh_free(&out);
    }
}

/* A cube less a grid of spheres that do not touch: all volumes are known from the meshes. */
static void many_holes_are_subtracted(void **state)
{
    (void)state;
    enum { SIDE = 4, COUNT = SIDE * SIDE * SIDE };
    cw_mesh meshes[COUNT + 1] = {make_box(0, 0, 0, 40 * SIDE)}, out;
    const cw_mesh *all[COUNT + 1] = {&meshes[0]};
    double removed = 0;
    for (int n = 0; n < COUNT; n++) {
        cw_mesh *m = &meshes[n + 1];
        *m = test_extract_field(CW_FIELD_SPHERE, 8);
        test_move_mesh(m, n, 0.25,
                       (const double[3]){160 * (n % SIDE) + 80, 160 * (n / SIDE % SIDE) + 80,
                                         160 * (n / SIDE / SIDE) + (n < SIDE * SIDE ? 0 : 80)});
        all[n + 1] = m;
    }
    cw_error err = {0};
    cw_boolean_facts f = {0}, g = {0};
    assert_ok(cw_mesh_boolean(all, COUNT + 1, &(cw_boolean_desc){.op = CW_BOOLEAN_DIFFERENCE},
                              &out, &f, &err),
              err);
    test_check_solid(&out);
    for (int n = 1; n <= COUNT; n++) {
        cw_mesh part;
        const cw_mesh *pair[2] = {all[0], all[n]};
        assert_ok(cw_mesh_boolean(pair, 2, &(cw_boolean_desc){.op = CW_BOOLEAN_INTERSECTION},
                                  &part, &g, &err),
                  err);
        removed += g.volume_mm3[0];
        cw_mesh_free(&part);
    }
    const double cube = pow(40 * SIDE, 3);
    assert_true(fabs(f.volume_mm3[0] + removed - cube) < 1e-9 * cube);
    for (int n = 0; n <= COUNT; n++)
        cw_mesh_free(&meshes[n]);
    cw_mesh_free(&out);
}

static void threads_give_the_same_mesh(void **state)
{
    (void)state;
    cw_mesh a = test_extract_field(CW_FIELD_GYROID, 14),
            b = test_extract_field(CW_FIELD_TORUS, 14), out[2];
    const cw_mesh *meshes[2] = {&a, &b};
    cw_error err = {0};
    for (int n = 0; n < 2; n++)
        assert_ok(cw_mesh_boolean(meshes, 2, &(cw_boolean_desc){.threads = 1 + 4 * n}, &out[n],
                                  NULL, &err),
                  err);
    test_assert_same_mesh(&out[0], &out[1]);
    for (int n = 0; n < 2; n++)
        cw_mesh_free(&out[n]);
    cw_mesh_free(&a);
    cw_mesh_free(&b);
}

/* Values that are linear in space stay so; each triangle says which mesh it is from. */
static void attributes_go_through(void **state)
{
    (void)state;
    cw_mesh a = make_box(0, 0, 0, 4), b = make_box(1, 2, 3, 4), out;
    const cw_mesh *meshes[2] = {&a, &b};
    cw_error err = {0};
    cw_attribute *row;
    const cw_attribute like = {"place", CW_ON_CORNERS, CW_F32, 1, CW_INTERPOLATE_LINEAR, NULL};
    a.scalars = cwi_alloc_zeroed(8, sizeof *a.scalars);
    b.colors = cwi_alloc_zeroed(8, 4);
    assert_true(a.scalars && b.colors);
    for (size_t v = 0; v < 8; v++) {
        a.scalars[v] = 2 * a.positions[3 * v] + a.positions[3 * v + 1];
        b.colors[4 * v] = 100;
    }
    assert_ok(cw_mesh_attribute_add(&a, &like, &row, &err), err);
    for (size_t c = 0; c < 3 * a.triangle_count; c++)
        ((float *)row->data)[c] = a.positions[3 * (size_t)a.triangles[c] + 2];
    assert_ok(cw_mesh_boolean(meshes, 2, &(cw_boolean_desc){.op = CW_BOOLEAN_DIFFERENCE}, &out,
                              NULL, &err),
              err);
    const cw_attribute *input = cw_mesh_attribute_find(&out, "input");
    const cw_attribute *place = cw_mesh_attribute_find(&out, "place");
    assert_true(input && place && out.scalars && out.colors);
    size_t of_b = 0;
    for (size_t t = 0; t < out.triangle_count; t++) {
        const bool from_b = ((const uint32_t *)input->data)[t];
        of_b += from_b;
        for (size_t k = 0; k < 3; k++) {
            const float *p = out.positions + 3 * (size_t)out.triangles[3 * t + k];
            const float wanted = from_b ? 0 : p[2];
            assert_true(fabsf(((const float *)place->data)[3 * t + k] - wanted) < 1e-5f);
        }
    }
    assert_true(of_b >= 6); /* three faces */
    for (size_t v = 0; v < out.vertex_count; v++) {
        const float *p = out.positions + 3 * v;
        const bool on_a =
            p[0] == 0 || p[0] == 4 || p[1] == 0 || p[1] == 4 || p[2] == 0 || p[2] == 4;
        if (on_a)
            assert_true(fabsf(out.scalars[v] - (2 * p[0] + p[1])) < 1e-5f);
        assert_int_equal(out.colors[4 * v], on_a ? 255 : 100);
    }
    cw_mesh_free(&a);
    cw_mesh_free(&b);
    cw_mesh_free(&out);
}

/* Meshes relative to other origins meet in the world. */
static void origins_are_taken_into_account(void **state)
{
    (void)state;
    cw_mesh a = make_box(0, 0, 0, 4), b = make_box(0, 0, 0, 4);
    cw_boolean_facts f;
    a.origin[0] = 1000;
    b.origin[0] = 1002;
    assert_true(check_boolean(&a, &b, CW_BOOLEAN_UNION, &f) == 96);
    cw_mesh_free(&a);
    cw_mesh_free(&b);
}

static void empty_meshes_are_nothing(void **state)
{
    (void)state;
    cw_mesh a = make_box(0, 0, 0, 4), none = {0};
    cw_boolean_facts f;
    assert_true(check_boolean(&a, &none, CW_BOOLEAN_UNION, &f) == 64);
    assert_true(check_boolean(&none, &a, CW_BOOLEAN_DIFFERENCE, &f) == 0);
    assert_true(check_boolean(&none, &none, CW_BOOLEAN_UNION, &f) == 0);
    uint8_t inputs[4] = {7, 7, 7, 7};
    cw_mesh flat = make_box(0, 0, 0, 0), turned = test_make_boxes(1), out;
    cw_error err = {0};
    const cw_mesh *meshes[4] = {&none, &a, &flat, &turned};
    test_add_box(&turned, (const double[3]){1, 1, 1}, (const double[3]){2, 3, 5}, true);
    turned.origin[1] = 700;
    assert_ok(
        cw_mesh_boolean(meshes, 4, &(cw_boolean_desc){.inputs = inputs}, &out, NULL, &err),
        err);
    assert_memory_equal(
        inputs, ((uint8_t[]){CW_BOOLEAN_EMPTY, 0, CW_BOOLEAN_EMPTY, CW_BOOLEAN_TURNED}), 4);
    cw_mesh_free(&out);
    cw_mesh_free(&flat);
    cw_mesh_free(&turned);
    cw_mesh_free(&a);
}

static void bad_meshes_are_refused(void **state)
{
    (void)state;
    cw_mesh a = make_box(0, 0, 0, 4), b = make_box(2, 0, 0, 4), out;
    const cw_mesh *meshes[2] = {&a, &b};
    cw_error err = {0};
    assert_int_equal(cw_mesh_boolean(meshes, 0, NULL, &out, NULL, &err), CW_ERR_ARGUMENT);
    assert_int_equal(cw_mesh_boolean(meshes, 2, &(cw_boolean_desc){.op = CW_BOOLEAN_COUNT},
                                     &out, NULL, &err),
                     CW_ERR_ARGUMENT);
    b.triangle_count--;
    cw_boolean_facts f = {0};
    assert_int_equal(cw_mesh_boolean(meshes, 2, NULL, &out, &f, &err), CW_ERR_CHECK);
    assert_int_equal(f.open_mesh, 2);
    assert_non_null(strstr(err.message, "mesh 2 of 2 is open at 3 edges"));
    assert_int_equal(out.triangle_count, 0);
    b.triangle_count++;
    meshes[1] = NULL;
    assert_int_equal(cw_mesh_boolean(meshes, 2, NULL, &out, NULL, &err), CW_ERR_ARGUMENT);
    cw_mesh_free(&a);
    cw_mesh_free(&b);
}

static void failing_allocations_leave_nothing(void **state)
{
    (void)state;
    cw_mesh a = make_box(0, 0, 0, 4), b = make_box(1, 2, 4, 4), out;
    const cw_mesh *meshes[2] = {&a, &b};
    cw_error err = {0};
    bool failed = true;
    for (long n = 0; failed; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st =
            cw_mesh_boolean(meshes, 2, &(cw_boolean_desc){.threads = 1}, &out, NULL, &err);
        failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        assert_true(st == CW_OK || !out.positions);
        cw_mesh_free(&out);
    }
    cw_mesh_free(&a);
    cw_mesh_free(&b);
}

/* Random products and sums, checked by (a + b) (a - b) = a a - b b, and by those that fit 128 bits. */
static void long_integers_obey_the_rules(void **state)
{
    (void)state;
    srand(test_seed(75));
    for (int n = 0; n < 20000; n++) {
        cwi_big a, b, sum, difference, left, x, y, right;
        const cwi_wide p = (cwi_wide)((test_random() - 0.5) * 0x1p62) >> rand() % 60;
        const cwi_wide q = (cwi_wide)((test_random() - 0.5) * 0x1p62) >> rand() % 60;
        cwi_big_set(&a, p);
        cwi_big_set(&b, q);
        cwi_big_mul(&a, &b, &x);
        cwi_big_set(&y, p * q);
        cwi_big_sub(&x, &y, &x);
        assert_int_equal(cwi_big_sign(&x), 0);
        for (int k = 0; k < n % 3; k++) { /* longer ones */
            cwi_big_mul(&a, &b, &x);
            cwi_big_add(&x, &b, &b);
            cwi_big_sub(&x, &a, &a);
        }
        cwi_big_add(&a, &b, &sum);
        cwi_big_sub(&a, &b, &difference);
        cwi_big_mul(&sum, &difference, &left);
        cwi_big_cross(&a, &a, &b, &b, &right);
        cwi_big_sub(&left, &right, &x);
        assert_int_equal(cwi_big_sign(&x), 0);
        if (cwi_big_sign(&b)) {
            cwi_big_mul(&a, &b, &x);
            const double ratio = cwi_big_ratio(&x, &b),
                         wanted = cwi_big_ratio(&a, &(cwi_big){1, false, {1}});
            assert_true(fabs(ratio - wanted) <= 1e-15 * fabs(wanted));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boxes_have_their_volumes),
        cmocka_unit_test(many_triangles_lie_along_x),
        cmocka_unit_test(boxes_on_a_grid_have_whole_volumes),
        cmocka_unit_test(boxes_that_touch_may_be_turned),
        cmocka_unit_test(shells_of_one_mesh_are_united),
        cmocka_unit_test(many_holes_are_subtracted),
        cmocka_unit_test(threads_give_the_same_mesh),
        cmocka_unit_test(attributes_go_through),
        cmocka_unit_test(origins_are_taken_into_account),
        cmocka_unit_test(empty_meshes_are_nothing),
        cmocka_unit_test(bad_meshes_are_refused),
        cmocka_unit_test(failing_allocations_leave_nothing),
        cmocka_unit_test(long_integers_obey_the_rules),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
