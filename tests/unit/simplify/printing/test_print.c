/* Printability of shapes whose walls, gaps, overhangs, islands and centers of mass are known. */
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/mesh/mesh.h"

#include <cubewright/print.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_VERTICES = 20000, MOST_TRIANGLES = 40000 };

static cw_mesh make_empty(void)
{
    cw_mesh m;
    cw_error err = {0};
    assert_ok(cwi_mesh_alloc(&m, MOST_VERTICES, MOST_TRIANGLES, false, &err), err);
    m.vertex_count = m.triangle_count = 0;
    return m;
}

static uint32_t add_vertex(cw_mesh *m, double x, double y, double z)
{
    const float p[3] = {(float)x, (float)y, (float)z};
    assert_true(m->vertex_count < MOST_VERTICES);
    memcpy(m->positions + 3 * m->vertex_count, p, sizeof p);
    return (uint32_t)m->vertex_count++;
}

static void add_triangle(cw_mesh *m, uint32_t a, uint32_t b, uint32_t c)
{
    const uint32_t v[3] = {a, b, c};
    assert_true(m->triangle_count < MOST_TRIANGLES);
    memcpy(m->triangles + 3 * m->triangle_count++, v, sizeof v);
}

/* A box from low to high, of 12 triangles; facing inward if asked for. */
static void add_box(cw_mesh *m, const double low[3], const double high[3], bool inward)
{
    static const uint32_t faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                                          {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                          {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    const uint32_t first = (uint32_t)m->vertex_count;
    for (int n = 0; n < 8; n++)
        add_vertex(m, n & 1 ? high[0] : low[0], n & 2 ? high[1] : low[1],
                   n & 4 ? high[2] : low[2]);
    for (int t = 0; t < 12; t++)
        add_triangle(m, first + faces[t][0], first + faces[t][inward ? 2 : 1],
                     first + faces[t][inward ? 1 : 2]);
}

#define BOX(m, x0, y0, z0, x1, y1, z1)                                                         \
    add_box(m, (const double[3]){x0, y0, z0}, (const double[3]){x1, y1, z1}, false)

/* A solid of revolution around z: a closed outline of radii above 0 and heights, against the clock
 * in the plane of x and z. */
static void add_ring(cw_mesh *m, const double (*outline)[2], size_t corners, size_t turns)
{
    const uint32_t first = (uint32_t)m->vertex_count;
    for (size_t n = 0; n < turns; n++)
        for (size_t c = 0; c < corners; c++) {
            const double angle = 2 * PI * (double)n / (double)turns;
            add_vertex(m, outline[c][0] * cos(angle), outline[c][0] * sin(angle),
                       outline[c][1]);
        }
    for (size_t n = 0; n < turns; n++)
        for (size_t c = 0; c < corners; c++) {
            const uint32_t a = first + (uint32_t)(n * corners + c),
                           b = first + (uint32_t)(n * corners + (c + 1) % corners),
                           d = first + (uint32_t)((n + 1) % turns * corners + c),
                           e = first +
                               (uint32_t)((n + 1) % turns * corners + (c + 1) % corners);
            add_triangle(m, a, d, b);
            add_triangle(m, b, d, e);
        }
}

static cw_print_facts measure_print(const cw_mesh *m, const cw_print_desc *desc)
{
    cw_print_facts facts;
    cw_error err = {0};
    assert_ok(cw_print_measure(m, desc, &facts, &err), err);
    return facts;
}

/* Plates, tubes, rods and shells: within 2 percent, whatever the triangles. */
static void walls_are_as_thick_as_they_are(void **state)
{
    (void)state;
    static const double walls[] = {0.3, 0.79, 1, 2.5, 8};
    for (size_t n = 0; n < sizeof walls / sizeof *walls; n += test_is_short() ? 2 : 1) {
        const double t = walls[n];
        const double tube[4][2] = {{10, 0}, {10 + t, 0}, {10 + t, 20}, {10, 20}};
        cw_mesh plate = make_empty(), ring = make_empty(), hollow = make_empty();
        BOX(&plate, -10, -15, 3, 10, 15, 3 + t);
        cw_print_facts f = measure_print(&plate, NULL);
        assert_within(f.wall_mm, t, 1e-5);
        assert_true(f.wall_at[2] == 3 || fabs(f.wall_at[2] - 3 - t) < 1e-6);
        assert_within(f.thin_mm2, t < 0.8 ? 2 * 20 * 30 : 0, 1e-5);
        assert_true(isinf(f.gap_mm) && f.narrow_mm2 == 0);
        add_ring(&ring, tube, 4, test_is_short() ? 60 : 180);
        f = measure_print(&ring, NULL);
        assert_within(f.wall_mm, t, 0.01);
        add_box(&hollow, (const double[3]){0, 0, 0}, (const double[3]){30, 30, 30}, false);
        add_box(&hollow, (const double[3]){9, 9, 9}, (const double[3]){30 - t, 21, 21}, true);
        f = measure_print(&hollow, NULL);
        assert_within(f.wall_mm, t, 1e-5);
        cw_mesh_free(&plate);
        cw_mesh_free(&ring);
        cw_mesh_free(&hollow);
    }
}

/* Extracted ones, whose triangles are small and thin: rods, balls and tori have walls as thick as
 * they are. */
static void walls_of_extracted_shapes_are_known(void **state)
{
    (void)state;
    static const struct {
        cw_field field;
        double wall;
    } rows[] = {{CW_FIELD_SPHERE, 60}, {CW_FIELD_TORUS, 20}};
    for (size_t n = test_is_short() ? 1 : 0; n < 2; n++) {
        cw_volume volume = test_sample(rows[n].field, 64, CW_F32);
        cw_mesh m = test_extract(&volume, NULL, NULL);
        for (double limit = 0.8; limit < 100; limit *= 100) {
            const cw_print_facts f = measure_print(&m, &(cw_print_desc){.min_wall_mm = limit});
            assert_within(f.wall_mm, rows[n].wall, 0.02);
            assert_true(limit < 1 ? f.thin_mm2 == 0 : f.thin_mm2 > 0.99 * f.area_mm2);
        }
        cw_mesh_free(&m);
        cw_volume_free(&volume);
    }
}

/* A wedge has no wall where its sides do not face each other. */
static void sharp_edges_are_no_walls(void **state)
{
    (void)state;
    static const double angles[] = {90, 60, 40};
    for (size_t n = 0; n < 3; n++) {
        cw_mesh m = make_empty();
        const double half = 10 * tan(angles[n] / 2 * PI / 180);
        for (int y = 0; y < 2; y++) {
            add_vertex(&m, 0, 20 * y, 0);
            add_vertex(&m, half, 20 * y, 10);
            add_vertex(&m, -half, 20 * y, 10);
        }
        add_triangle(&m, 0, 1, 2);
        add_triangle(&m, 3, 5, 4);
        for (uint32_t c = 0; c < 3; c++) {
            const uint32_t a = c, b = (c + 1) % 3;
            add_triangle(&m, a, a + 3, b);
            add_triangle(&m, b, a + 3, b + 3);
        }
        const cw_print_facts f = measure_print(&m, &(cw_print_desc){.min_wall_mm = 1});
        assert_true(f.volume_mm3 > 0);
        assert_true(f.thin_mm2 == 0 && f.wall_mm > 1);
        cw_mesh_free(&m);
    }
}

static void gaps_are_as_wide_as_they_are(void **state)
{
    (void)state;
    static const double gaps[] = {0.05, 0.39, 0.41, 1.5, 1.7};
    for (size_t n = 0; n < sizeof gaps / sizeof *gaps; n++) {
        cw_mesh m = make_empty();
        BOX(&m, 0, 0, 0, 10, 10, 10);
        BOX(&m, 10 + gaps[n], 2, 0, 20, 8, 10);
        const cw_print_facts f = measure_print(&m, NULL);
        if (gaps[n] > 1.6)
            assert_true(isinf(f.gap_mm));
        else
            assert_within(f.gap_mm, gaps[n], 1e-4);
        /* both sides, and on the larger one what faces the other, give or take a point */
        assert_within(f.narrow_mm2, gaps[n] < 0.4 ? 2 * 6 * 10 : 0, 0.03);
        assert_within(f.wall_mm, 10 - gaps[n] < 6 ? 10 - gaps[n] : 6, 1e-5);
        cw_mesh_free(&m);
    }
}

/* A table: the top hangs over all around its leg. A second one stands below its top. */
static void overhangs_and_feet_are_summed(void **state)
{
    (void)state;
    const size_t facets = test_is_short() ? 90 : 360;
    const double table[8][2] = {{1, 0}, {5, 0}, {5, 10}, {20, 10}, {20, 12}, {1, 12}};
    const double cone[4][2] = {{1, 0}, {5, 0}, {15, 10}, {1, 10}};
    cw_mesh m = make_empty();
    add_ring(&m, table, 6, facets);
    cw_print_facts f = measure_print(&m, NULL);
    const double circle = PI * (sin(2 * PI / (double)facets) / (2 * PI / (double)facets));
    assert_within(f.overhang_mm2, circle * (400 - 25), 1e-5);
    assert_within(f.foot_mm2, circle * (25 - 1), 1e-5);
    assert_near(f.center[0], 0, 1e-4);
    assert_true(f.margin_mm > 4.99 && f.margin_mm < 5);
    assert_within(f.tip_deg, atan2(f.margin_mm, f.center[2]) * 180 / PI, 1e-12);
    assert_int_equal(f.islands, 0);
    cw_mesh_free(&m);
    m = make_empty();
    add_ring(&m, cone, 4, facets); /* leans by 45 degrees, but for the facets' rounding */
    f = measure_print(&m, &(cw_print_desc){.overhang_deg = 44.9});
    assert_within(f.overhang_mm2, circle * (15 * 15 - 5 * 5) * sqrt(2), 1e-3);
    f = measure_print(&m, &(cw_print_desc){.overhang_deg = 45.1});
    assert_true(f.overhang_mm2 == 0);
    cw_mesh_free(&m);
}

static void islands_begin_in_the_air(void **state)
{
    (void)state;
    cw_mesh m = make_empty();
    BOX(&m, 0, 0, 0, 10, 10, 10);
    BOX(&m, 20, 0, 0.1, 30, 10, 10); /* within a layer of the plate */
    assert_int_equal(measure_print(&m, NULL).islands, 0);
    BOX(&m, 0, 0, 15, 10, 10, 20);
    BOX(&m, 20, 0, 12, 30, 10, 20);
    add_box(&m, (const double[3]){2, 2, 2}, (const double[3]){8, 8, 8}, true); /* a cavity */
    cw_print_facts f = measure_print(&m, NULL);
    assert_int_equal(f.islands, 2);
    assert_int_equal(f.trapped, 1);
    assert_within(f.trapped_mm3, 216, 1e-6);
    assert_within(f.volume_mm3, 1000 + 990 + 500 + 800 - 216, 1e-5);
    cw_mesh_free(&m);
    /* an icicle below a roof, 3 mm long */
    const double roof[6][2] = {{1, 0}, {3, 0}, {3, 10}, {6, 10}, {6, 7}, {7, 7}};
    const double rest[2][2] = {{7, 12}, {1, 12}};
    double outline[8][2];
    memcpy(outline, roof, sizeof roof);
    memcpy(outline + 6, rest, sizeof rest);
    m = make_empty();
    add_ring(&m, (const double(*)[2])outline, 8, 90);
    f = measure_print(&m, NULL);
    assert_int_equal(f.islands, 1);
    assert_near(f.island_at[2], 7, 1e-6);
    assert_int_equal(measure_print(&m, &(cw_print_desc){.layer_mm = 3.5}).islands, 0);
    cw_mesh_free(&m);
}

/* An L: it stands as long as its centre of mass is above its foot. */
static void what_is_off_its_foot_tips_over(void **state)
{
    (void)state;
    for (int far = 0; far < 2; far++) {
        cw_mesh m = make_empty();
        const double reach = far ? 30 : 12;
        BOX(&m, 0, 0, 0, 10, 10, 10);
        BOX(&m, 0, 0, 10, reach, 10, 20);
        const double x = (10 * 5 + reach * reach / 2) / (10 + reach);
        cw_print_facts f = measure_print(&m, NULL);
        assert_near(f.center[0], x, 1e-5);
        assert_near(f.center[1], 5, 1e-5);
        assert_near(f.margin_mm, 10 - x < 5 ? 10 - x : 5, 1e-5);
        assert_true(far ? f.tip_deg == 0 : f.tip_deg > 0);
        cw_mesh_free(&m);
    }
    cw_mesh ball = make_empty();
    const double spike[3][2] = {{0.001, 0}, {5, 5}, {0.001, 10}};
    add_ring(&ball, spike, 3, 60);
    assert_true(measure_print(&ball, NULL).margin_mm < 0.25);
    cw_mesh_free(&ball);
}

static void plates_are_turned_by_90_degrees(void **state)
{
    (void)state;
    static const struct {
        double plate[3];
        bool fits;
    } rows[] = {{{0, 0, 0}, true},       {{20, 30, 10}, true},   {{30, 20, 10}, true},
                {{19, 40, 10}, false},   {{40, 40, 9.9}, false}, {{25, 25, 50}, false},
                {{0.9, 0.8, 0.7}, false}};
    cw_mesh m = make_empty();
    BOX(&m, 5, 5, 5, 25, 35, 15);
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        cw_print_desc desc = {0};
        memcpy(desc.plate_mm, rows[n].plate, sizeof desc.plate_mm);
        assert_true(measure_print(&m, &desc).fits == rows[n].fits);
    }
    cw_mesh_free(&m);
}

static cw_mesh extract_gyroid(double scale)
{
    cw_volume volume = test_sample(CW_FIELD_GYROID, test_is_short() ? 16 : 40, CW_F32);
    cw_mesh m = test_extract(&volume, NULL, NULL);
    cw_volume_free(&volume);
    for (size_t c = 0; c < 3 * m.vertex_count; c++)
        m.positions[c] = (float)((double)m.positions[c] * scale);
    for (int a = 0; a < 3; a++)
        m.origin[a] = 100 * scale;
    return m;
}

/* Neither threads nor units matter, nor corners that are not shared. */
static void threads_units_and_sharing_do_not_matter(void **state)
{
    (void)state;
    cw_mesh m = extract_gyroid(1);
    float *wall = cwi_alloc_array(m.vertex_count, sizeof *wall),
          *gap = cwi_alloc_array(m.vertex_count, sizeof *gap),
          *other = cwi_alloc_array(3 * m.triangle_count, sizeof *other);
    cw_print_desc desc = {
        .min_wall_mm = 10, .min_gap_mm = 10, .threads = 1, .wall = wall, .gap = gap};
    const cw_print_facts one = measure_print(&m, &desc);
    desc.wall = other;
    desc.threads = 5;
    desc.gap = NULL;
    cw_print_facts many = measure_print(&m, &desc);
    many.limits.threads = 1;
    assert_memory_equal(&one, &many, sizeof one);
    assert_memory_equal(wall, other, m.vertex_count * sizeof *wall);
    double least = INFINITY;
    for (size_t v = 0; v < m.vertex_count; v++)
        least = fmin(least, (double)wall[v]);
    assert_near(least, one.wall_mm, 1e-5);
    /* as STL has it */
    cw_mesh soup = make_empty();
    soup.vertex_count = soup.triangle_count = 0;
    assert_true(3 * m.triangle_count <= 1000000);
    cwi_free(soup.positions);
    cwi_free(soup.triangles);
    soup.positions = cwi_alloc_array(3 * m.triangle_count, 3 * sizeof *soup.positions);
    soup.triangles = cwi_alloc_array(m.triangle_count, 3 * sizeof *soup.triangles);
    soup.vertex_count = 3 * m.triangle_count;
    soup.triangle_count = m.triangle_count;
    memcpy(soup.origin, m.origin, sizeof soup.origin);
    for (size_t c = 0; c < 3 * m.triangle_count; c++) {
        memcpy(soup.positions + 3 * c, m.positions + 3 * (size_t)m.triangles[c], 12);
        soup.triangles[c] = (uint32_t)c;
    }
    const cw_print_facts apart = measure_print(&soup, &desc);
    assert_within(apart.wall_mm, one.wall_mm, 1e-9);
    assert_within(apart.thin_mm2, one.thin_mm2, 1e-9);
    assert_int_equal(apart.islands, one.islands);
    for (size_t c = 0; c < soup.vertex_count; c++)
        assert_true(other[c] == wall[m.triangles[c]]);
    for (double scale = 1e-4; scale < 1e5; scale *= 1e8) {
        cw_mesh scaled = extract_gyroid(scale);
        const cw_print_facts f =
            measure_print(&scaled, &(cw_print_desc){.min_wall_mm = 10 * scale,
                                                    .min_gap_mm = 10 * scale,
                                                    .layer_mm = 0.2 * scale});
        assert_within(f.wall_mm / scale, one.wall_mm, 1e-3);
        assert_within(f.thin_mm2 / scale / scale, one.thin_mm2, 1e-3);
        assert_within(f.center[0] / scale, one.center[0], 1e-4);
        assert_int_equal(f.islands, one.islands);
        cw_mesh_free(&scaled);
    }
    cw_mesh_free(&soup);
    cw_mesh_free(&m);
    cwi_free(wall);
    cwi_free(gap);
    cwi_free(other);
}

/* Compares what is measured with and without the widths at each vertex. */
static void compare_with_widths(const cw_mesh *m, cw_print_desc desc)
{
    float *wall = malloc(m->vertex_count * sizeof *wall),
          *gap = malloc(m->vertex_count * sizeof *gap),
          *alone = malloc(m->vertex_count * sizeof *alone);
    assert_true(wall && gap && alone);
    desc.wall = desc.gap = NULL;
    const cw_print_facts plain = measure_print(m, &desc);
    desc.wall = wall;
    desc.gap = gap;
    const cw_print_facts full = measure_print(m, &desc);
    assert_memory_equal(&plain, &full, sizeof plain);
    desc.wall = NULL;
    desc.gap = alone;
    const cw_print_facts gaps = measure_print(m, &desc);
    assert_memory_equal(&plain, &gaps, sizeof plain);
    assert_memory_equal(gap, alone, m->vertex_count * sizeof *gap);
    float min_mm = INFINITY;
    for (size_t v = 0; v < m->vertex_count; v++)
        min_mm = fminf(min_mm, wall[v]);
    assert_true(min_mm == (float)plain.wall_mm);
    free(wall);
    free(gap);
    free(alone);
}

/* Rays end where walls are thick unless each vertex wants its own wall: thick and thin walls, gaps, and
 * slabs that lean, so that rays around the first one count. */
static void widths_at_vertices_change_no_figure(void **state)
{
    (void)state;
    const double wedge[4][2] = {{10, 0}, {10.1, 0}, {14, 20}, {10, 20}};
    for (double t = 0.5; t < 40; t *= 4) {
        cw_mesh boxes = make_empty(), ring = make_empty();
        BOX(&boxes, 0, 0, 0, 20, 20, t);
        BOX(&boxes, 0, 0, t + 0.3, 20, 20, 2 * t + 0.3);
        add_ring(&ring, wedge, 4, 60);
        for (double limit = 0.2; limit < 20; limit *= 7) {
            const cw_print_desc desc = {.min_wall_mm = limit, .min_gap_mm = limit};
            compare_with_widths(&boxes, desc);
            compare_with_widths(&ring, desc);
        }
        cw_mesh_free(&boxes);
        cw_mesh_free(&ring);
    }
    cw_volume volume = test_sample(CW_FIELD_GYROID, 32, CW_F32);
    cw_mesh m = test_extract(&volume, NULL, NULL);
    for (double limit = 0.1; limit < 100; limit *= 5)
        compare_with_widths(&m, (cw_print_desc){.min_wall_mm = limit, .min_gap_mm = limit});
    cw_mesh_free(&m);
    cw_volume_free(&volume);
}

/* Open, flat and empty meshes, and triangles without area: no crash, and numbers that are finite. */
static void odd_meshes_are_measured(void **state)
{
    (void)state;
    cw_mesh m = make_empty();
    float wall[8];
    cw_print_facts f = measure_print(&m, &(cw_print_desc){.wall = wall});
    assert_true(isinf(f.wall_mm) && f.area_mm2 == 0 && f.fits);
    for (int v = 0; v < 4; v++)
        add_vertex(&m, v & 1, v >> 1, 0);
    f = measure_print(&m, &(cw_print_desc){.wall = wall});
    assert_true(isinf(wall[3]));
    add_triangle(&m, 0, 1, 2);
    add_triangle(&m, 1, 3, 2);
    add_triangle(&m, 0, 0, 1);
    add_triangle(&m, 2, 2, 2);
    f = measure_print(&m, &(cw_print_desc){.wall = wall});
    assert_near(f.area_mm2, 1, 1e-9);
    assert_true(isfinite(f.center[0]) && isfinite(f.margin_mm) && f.volume_mm3 == 0);
    cw_mesh_free(&m);
}

static void bad_arguments_are_named(void **state)
{
    (void)state;
    static const struct {
        cw_print_desc desc;
        const char *text;
    } rows[] = {
        {{.min_wall_mm = -1}, "min_wall_mm is -1"},
        {{.min_gap_mm = NAN}, "min_gap_mm is"},
        {{.layer_mm = INFINITY}, "layer_mm is inf"},
        {{.overhang_deg = 90}, "overhang_deg is 90; it must be below 90"},
        {{.plate_mm = {100, 100, -5}}, "plate_mm is -5"},
        {{.plate_mm = {100, 100, 0}}, "plate_mm is 100 x 100 x 0; all three"},
    };
    cw_mesh m = make_empty();
    cw_print_facts facts;
    cw_error err;
    BOX(&m, 0, 0, 0, 1, 1, 1);
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++)
        assert_fails(cw_print_measure(&m, &rows[n].desc, &facts, &err), CW_ERR_ARGUMENT,
                     rows[n].text, err);
    m.triangles[5] = 99;
    assert_fails(cw_print_measure(&m, NULL, &facts, &err), CW_ERR_ARGUMENT, "99", err);
    cw_mesh_free(&m);
}

static bool cancel_late(void *user, const char *step, double done)
{
    (void)step;
    assert_true(done >= 0 && done <= 1);
    return --*(int *)user > 0;
}

static void memory_failures_and_cancelling_are_told(void **state)
{
    (void)state;
    cw_mesh m = make_empty();
    cw_print_facts facts;
    cw_error err;
    BOX(&m, 0, 0, 0, 10, 10, 10);
    for (long n = 0;; n += test_is_short() ? 1 + n / 8 : 1) {
        cwi_alloc_fail_after(n);
        const cw_status st = cw_print_measure(&m, &(cw_print_desc){.threads = 1}, &facts, &err);
        if (!cwi_alloc_fail_after(-1)) {
            assert_ok(st, err);
            assert_true(n > 15);
            break;
        }
        assert_fails(st, CW_ERR_NO_MEMORY, "no memory", err);
    }
    int left = 1;
    assert_fails(
        cw_print_measure(&m, &(cw_print_desc){.progress = {cancel_late, &left}}, &facts, &err),
        CW_ERR_CANCELLED, "", err);
    cw_mesh_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(walls_are_as_thick_as_they_are),
        cmocka_unit_test(walls_of_extracted_shapes_are_known),
        cmocka_unit_test(sharp_edges_are_no_walls),
        cmocka_unit_test(gaps_are_as_wide_as_they_are),
        cmocka_unit_test(overhangs_and_feet_are_summed),
        cmocka_unit_test(islands_begin_in_the_air),
        cmocka_unit_test(what_is_off_its_foot_tips_over),
        cmocka_unit_test(plates_are_turned_by_90_degrees),
        cmocka_unit_test(threads_units_and_sharing_do_not_matter),
        cmocka_unit_test(widths_at_vertices_change_no_figure),
        cmocka_unit_test(odd_meshes_are_measured),
        cmocka_unit_test(bad_arguments_are_named),
        cmocka_unit_test(memory_failures_and_cancelling_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
