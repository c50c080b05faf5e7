/* Cuts of meshes by planes: both halves are closed solids, and sections have the areas known on paper. */
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/mesh/mesh.h"

#include <cubewright/cut.h>
#include <cubewright/field.h>
#include <cubewright/hard.h>
#include <cubewright/remesh.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static cw_mesh extract_field(cw_field field, size_t n)
{
    cw_volume volume = test_sample(field, n, CW_F32);
    cw_mesh mesh = test_extract(
        &volume, &(cw_extract_desc){.isovalue = (float)cw_field_isovalue(field)}, NULL);
    cw_volume_free(&volume);
    return mesh;
}

static double random_number(void)
{
    return rand() / ((double)RAND_MAX + 1);
}

static cw_cut_desc reverse_plane(const cw_cut_desc *desc)
{
    cw_cut_desc d = *desc;
    for (int a = 0; a < 3; a++)
        d.normal[a] = -d.normal[a];
    return d;
}

/* Distance of vertices below the plane at most, as a fraction of the largest coordinate. */
static const double MAX_BELOW = 3e-7;

/* Checks that a half is closed, a manifold, oriented, without crossings, on one side of the plane. */
static cw_quality check_half(const cw_mesh *m, const cw_cut_desc *d, const char *name)
{
    cw_quality q = test_measure(m);
    double length = 0, largest = 0, lowest = INFINITY;
    if (q.open_edges || q.nonmanifold_edges || q.misoriented_edges || q.nonmanifold_vertices ||
        q.duplicates || q.unused_vertices)
        fail_msg(
            "%s: %zu open edges, %zu nonmanifold, %zu misoriented, %zu vertices, %zu twice",
            name, q.open_edges, q.nonmanifold_edges, q.misoriented_edges,
            q.nonmanifold_vertices, q.duplicates);
    if (q.degenerate)
        fail_msg("%s: %zu triangles without area", name, q.degenerate);
    const size_t crossings = test_count_crossings(m);
    if (crossings)
        fail_msg("%s: %zu crossings", name, crossings);
    for (int a = 0; a < 3; a++)
        length += d->normal[a] * d->normal[a];
    for (size_t v = 0; v < m->vertex_count; v++) {
        double height = 0;
        for (size_t a = 0; a < 3; a++) {
            const double x = (double)m->positions[3 * v + a];
            height += d->normal[a] * (x + m->origin[a] - d->point[a]) / sqrt(length);
            largest = fmax(largest, fabs(x));
        }
        lowest = fmin(lowest, height);
    }
    assert_true(lowest > -MAX_BELOW * largest);
    return q;
}

/* Cuts a closed mesh, checks both halves, and returns the facts of the upper one. */
static cw_cut_facts check_cut(const cw_mesh *m, const cw_cut_desc *d, const char *name)
{
    const cw_cut_desc reversed = reverse_plane(d);
    const double whole = test_measure(m).volume_mm3;
    cw_mesh above, below;
    cw_cut_facts facts, other;
    cw_error err = {0};
    const cw_status st = cw_mesh_cut(m, d, &above, &facts, &err);
    const cw_status under = cw_mesh_cut(m, &reversed, &below, &other, &err);
    if (st == CW_ERR_EMPTY ||
        under == CW_ERR_EMPTY) { /* at a side of the box: the other is all */
        test_assert_same_mesh(st == CW_OK ? &above : &below, m);
        cw_mesh_free(&above);
        cw_mesh_free(&below);
        return facts;
    }
    assert_int_equal(st, CW_OK);
    assert_ok(under, err);
    const double up = check_half(&above, d, name).volume_mm3,
                 down = check_half(&below, &reversed, name).volume_mm3;
    assert_near(up + down, whole, 1e-6 * fabs(whole));
    const size_t flat = facts.dropped_triangles + other.dropped_triangles +
                        facts.cut_triangles - m->triangle_count;
    /* triangles in the plane, and loops around vertices at which surfaces touch, are of one half alone; where the surface
     * is nearly along the plane, a vertex that moves into it moves the loop farther */
    if (flat == 0 && facts.loops_closed == other.loops_closed)
        assert_near(facts.area_mm2, other.area_mm2, 1e-3 * facts.area_mm2 + 1e-9);
    cw_mesh_free(&above);
    cw_mesh_free(&below);
    return facts;
}

static void random_planes_leave_two_solids(void **state)
{
    (void)state;
    static const cw_field fields[] = {CW_FIELD_SPHERE, CW_FIELD_TORUS, CW_FIELD_GYROID};
    test_seed(11);
    for (size_t f = 0; f < 3; f++) {
        cw_mesh m = extract_field(fields[f], 24);
        double low[3], high[3];
        cw_mesh_bounds(&m, low, high);
        for (int n = 0; n < test_some(80); n++) {
            cw_cut_desc d = {.leave_open = false};
            char name[64];
            for (int a = 0; a < 3; a++) {
                d.point[a] = low[a] + (high[a] - low[a]) * (0.3 + 0.4 * random_number());
                d.normal[a] = random_number() - 0.5;
            }
            if (n % 3 == 0)
                d.normal[n % 2] = d.normal[2] = 0;
            snprintf(name, sizeof name, "field %zu, plane %d", f, n);
            check_cut(&m, &d, name);
        }
        cw_mesh_free(&m);
    }
}

/* Cuts fields by planes through vertices, also of three, in any direction. */
static void cut_through_vertices(unsigned seed)
{
    static const cw_field fields[] = {CW_FIELD_SPHERE, CW_FIELD_TORUS, CW_FIELD_GYROID};
    test_seed(seed);
    for (size_t f = 0; f < 3; f++) {
        cw_mesh m = extract_field(fields[f], 16);
        for (int n = 0; n < test_some(80); n++) {
            char name[64];
            double p[3][3];
            cw_cut_desc d = {.leave_open = false};
            for (size_t k = 0; k < 3; k++) {
                const size_t v = (size_t)(random_number() * (double)m.vertex_count);
                for (size_t a = 0; a < 3; a++)
                    p[k][a] = m.origin[a] + (double)m.positions[3 * v + a];
            }
            for (int a = 0; a < 3; a++) {
                const int b = (a + 1) % 3, c = (a + 2) % 3;
                d.point[a] = p[0][a];
                d.normal[a] = (p[1][b] - p[0][b]) * (p[2][c] - p[0][c]) -
                              (p[1][c] - p[0][c]) * (p[2][b] - p[0][b]);
            }
            if (n % 2) {
                memset(d.normal, 0, sizeof d.normal);
                d.normal[n % 3] = 1;
            }
            snprintf(name, sizeof name, "field %zu, vertices %d", f, n);
            if (d.normal[0] != 0 || d.normal[1] != 0 || d.normal[2] != 0) /* not on a line */
                check_cut(&m, &d, name);
        }
        cw_mesh_free(&m);
    }
}

/* Without care for rounding, halves of seeds 15 to 17 and 52 cross themselves. */
static void planes_through_vertices_leave_two_solids(void **state)
{
    (void)state;
    static const unsigned seeds[] = {12, 15, 16, 17, 52};
    for (size_t n = 0; n < sizeof seeds / sizeof *seeds; n++)
        cut_through_vertices(seeds[n]);
}

static cw_cut_desc describe_plane(double x, double y, double z, double nx, double ny, double nz)
{
    return (cw_cut_desc){.point = {x, y, z}, .normal = {nx, ny, nz}};
}

static cw_mesh make_empty(size_t vertices, size_t triangles)
{
    cw_mesh m;
    cw_error err = {0};
    assert_ok(cwi_mesh_alloc(&m, vertices, triangles, false, &err), err);
    m.vertex_count = m.triangle_count = 0;
    return m;
}

static uint32_t add_vertex(cw_mesh *m, double x, double y, double z)
{
    const float p[3] = {(float)x, (float)y, (float)z};
    memcpy(m->positions + 3 * m->vertex_count, p, sizeof p);
    return (uint32_t)m->vertex_count++;
}

static void add_triangle(cw_mesh *m, uint32_t a, uint32_t b, uint32_t c)
{
    const uint32_t v[3] = {a, b, c};
    memcpy(m->triangles + 3 * m->triangle_count++, v, sizeof v);
}

/* A box from low to high, of 12 triangles; facing inward if asked for. */
static void add_box(cw_mesh *m, double low, double high, bool inward)
{
    static const uint32_t faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                                          {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                          {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    const uint32_t first = (uint32_t)m->vertex_count;
    for (int n = 0; n < 8; n++)
        add_vertex(m, n & 1 ? high : low, n & 2 ? high : low, n & 4 ? high : low);
    for (int t = 0; t < 12; t++)
        add_triangle(m, first + faces[t][0], first + faces[t][inward ? 2 : 1],
                     first + faces[t][inward ? 1 : 2]);
}

static cw_cut_facts cut_once(const cw_mesh *m, const cw_cut_desc *d, cw_mesh *out)
{
    cw_cut_facts facts;
    cw_error err = {0};
    assert_ok(cw_mesh_cut(m, d, out, &facts, &err), err);
    return facts;
}

/* Circles and rings: the areas of polygons with as many corners are within 2 percent. */
static void sections_have_the_areas_of_circles(void **state)
{
    (void)state;
    cw_mesh ball = extract_field(CW_FIELD_SPHERE, 48),
            torus = extract_field(CW_FIELD_TORUS, 48), half;
    cw_cut_desc d = describe_plane(0.1, 0.2, 0.3, 1, 2, -3);
    cw_cut_facts f = cut_once(&ball, &d, &half);
    const double radius = cbrt(test_measure(&ball).volume_mm3 * 3 / (4 * PI));
    assert_within(f.area_mm2, PI * radius * radius, 0.02);
    assert_true(f.loops_closed == 1 && f.loops_open == 0 && f.cap_triangles > 50);
    cw_mesh_free(&half);
    d = describe_plane(0, 0, 0.05, 0, 0, 1);
    f = cut_once(&torus, &d, &half);
    double low[3], high[3];
    cw_mesh_bounds(&torus, low, high);
    const double tube = high[2], ring = high[0] - tube;
    assert_within(f.area_mm2, PI * (high[0] * high[0] - pow(ring - tube, 2)), 0.02);
    assert_int_equal(f.loops_closed, 2);
    const cw_quality q = check_half(&half, &d, "half a torus");
    assert_true(q.components == 1 && q.genus == 1);
    cw_mesh_free(&half);
    d = describe_plane(0.05, 0, 0, 1, 0, 0);
    f = cut_once(&torus, &d, &half);
    assert_within(f.area_mm2, 2 * PI * tube * tube, 0.03);
    assert_true(f.loops_closed == 2 && test_measure(&half).genus == 0);
    cw_mesh_free(&half);
    cw_mesh_free(&ball);
    cw_mesh_free(&torus);
}

/* Boxes in boxes: solid, cavity, island. The section is even-odd. */
static void islands_in_holes_are_filled(void **state)
{
    (void)state;
    cw_mesh m = make_empty(64, 96), half;
    for (int n = 0; n < 4; n++)
        add_box(&m, -10 + 2 * n, 10 - 2 * n, n % 2);
    static const double area = 400 - 256 + 144 - 64;
    const cw_cut_desc planes[] = {describe_plane(0, 0, 0, 0, 0, 1),
                                  describe_plane(0, 0, 0, 0, -2, 0),
                                  describe_plane(0.125, 0, 0, 1e-30, 0, 0)};
    for (size_t n = 0; n < 3; n++) {
        const cw_cut_facts f = check_cut(&m, &planes[n], "boxes");
        assert_within(f.area_mm2, area, 1e-9);
        assert_true(f.loops_closed == 4 && f.moved_mm == 0);
    }
    test_seed(13);
    for (int n = 0; n < 50; n++) {
        const cw_cut_desc d =
            describe_plane(random_number(), random_number(), random_number(),
                           random_number() - 0.5, random_number() - 0.5, random_number());
        check_cut(&m, &d, "boxes, any plane");
    }
    /* the whole inside out: so is the half */
    for (size_t t = 0; t < m.triangle_count; t++) {
        const uint32_t corner = m.triangles[3 * t];
        m.triangles[3 * t] = m.triangles[3 * t + 1];
        m.triangles[3 * t + 1] = corner;
    }
    const cw_cut_facts f = check_cut(&m, &planes[0], "boxes inside out");
    assert_within(f.area_mm2, area, 1e-9);
    cw_mesh_free(&m);
    /* a cavity without a solid around it is filled by itself */
    m = make_empty(64, 96);
    add_box(&m, -9, -8, false);
    add_box(&m, -5, 5, false);
    add_box(&m, 6, 7, true);
    const cw_cut_desc d = describe_plane(0, 0, 0, 1, -1, 0);
    cut_once(&m, &d, &half);
    check_half(&half, &d, "a lone cavity");
    cw_mesh_free(&half);
    cw_mesh_free(&m);
}

/* Shells within each other that all face outward: their caps lie on each other. Moving vertices would not help, and none
 * moves. */
static void shells_within_each_other_stay_in_place(void **state)
{
    (void)state;
    enum { SHELLS = 30 };
    cw_mesh m = make_empty(8 * SHELLS, 12 * SHELLS), half;
    double area = 0;
    for (int n = 0; n < SHELLS; n++) {
        add_box(&m, n - 40, 40 - n, false);
        area += 4 * (40 - n) * (40 - n);
    }
    const cw_cut_desc d = describe_plane(0, 0, 0.5, 0, 0, 1);
    const cw_cut_facts f = cut_once(&m, &d, &half);
    assert_within(f.area_mm2, area, 1e-9);
    assert_true(f.loops_closed == SHELLS);
    for (size_t v = 0; v < half.vertex_count; v++) {
        const float *p = half.positions + 3 * v;
        assert_true(p[0] == floorf(p[0]) || p[1] == floorf(p[1]));
    }
    cw_mesh_free(&half);
    cw_mesh_free(&m);
}

/* Planes along faces: nothing is below, or nothing is above; in a step, its tread goes. */
static void planes_along_faces_are_clear(void **state)
{
    (void)state;
    cw_mesh m = make_empty(64, 96), out;
    cw_error err = {0};
    cw_cut_facts f;
    add_box(&m, -1, 1, false);
    cw_cut_desc d = describe_plane(0, 0, -1, 0, 0, 1);
    f = cut_once(&m, &d, &out);
    test_assert_same_mesh(&m, &out);
    assert_true(f.cut_triangles == 0 && f.dropped_triangles == 0 && f.area_mm2 == 0);
    cw_mesh_free(&out);
    d = describe_plane(0, 0, 1, 0, 0, 1);
    assert_fails(cw_mesh_cut(&m, &d, &out, &f, &err), CW_ERR_EMPTY, "no triangle is above",
                 err);
    assert_true(!out.positions && !out.triangles && f.cut_triangles == 0);
    /* through four edges of the box, and through two: triangles with one or two corners in the plane */
    const cw_cut_desc diagonals[] = {
        describe_plane(0, 0, 0, 1, 1, 0),  describe_plane(0, 0, 0, 1, -1, 0),
        describe_plane(0, 0, 0, 0, 1, 1),  describe_plane(0, 0, 0, 1, 1, 1),
        describe_plane(1, 1, 1, 1, 1, -1), describe_plane(0, 0, 0, 1, 0, 2)};
    for (size_t n = 0; n < sizeof diagonals / sizeof *diagonals; n++)
        check_cut(&m, &diagonals[n], "a box");
    cw_mesh_free(&m);
    /* capped volumes: whole planes of voxels, along their caps */
    m = extract_field(CW_FIELD_GYROID, 16);
    double low[3], high[3];
    cw_mesh_bounds(&m, low, high);
    for (int n = 0; n < 3; n++) {
        d = describe_plane(low[0], low[1], low[2], n == 0, n == 1, n == 2);
        check_cut(&m, &d, "along caps");
        for (int k = 1; k < 15; k += 3) {
            const double z = low[n] + (high[n] - low[n]) * k / 15;
            d = describe_plane(z, z, z, n == 0, n == 1, n == 2);
            check_cut(&m, &d, "along voxels");
        }
    }
    cw_mesh_free(&m);
}

static cw_mesh extract_hard(size_t number)
{
    cw_volume volume;
    cw_error err = {0};
    const cw_hard_desc desc = {.number = number, .dim = {32, 32, 32}, .type = CW_F32};
    assert_ok(cw_hard_sample(&desc, &volume, &err), err);
    cw_mesh m = test_extract(
        &volume, &(cw_extract_desc){.isovalue = (float)cw_hard_at(number)->isovalue}, NULL);
    cw_volume_free(&volume);
    return m;
}

/* Extracted surfaces of fields made to be hard. */
static void hard_surfaces_leave_two_solids(void **state)
{
    (void)state;
    test_seed(14);
    for (size_t h = 0; cw_hard_at(h); h++) {
        cw_mesh m = extract_hard(h);
        double low[3], high[3];
        cw_mesh_bounds(&m, low, high);
        const int planes = test_is_short() ? 1 : 10, first = (int)(h % 4);
        for (int n = first; n < first + planes && m.triangle_count; n++) {
            char name[64];
            cw_cut_desc d = {.leave_open = false};
            for (int a = 0; a < 3; a++) {
                d.point[a] = low[a] + (high[a] - low[a]) * random_number();
                d.normal[a] = n % 4 == a ? 1 : n % 4 == 3 ? random_number() - 0.5 : 0;
            }
            snprintf(name, sizeof name, "%s, plane %d", cw_hard_at(h)->name, n);
            check_cut(&m, &d, name);
        }
        cw_mesh_free(&m);
    }
}

/* Planes at which rounding puts vertices of two loops at one place, or an edge of the section into a
 * triangle that leans on it. */
static void rounded_sections_do_not_cross(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double point[3], normal[3]; /* the point from the mesh's origin */
    } planes[] = {
        {"hard/last-digits", {-13.833628459274223, 0, 0}, {1, 0, 0}},
        {"hard/denormal-values",
         {-6.9095212322113184, -3.727055360160648, -6.7574111887438448},
         {0.29458506824448705, -0.45075914077460766, -0.4055112418718636}},
    };
    for (size_t n = 0; n < sizeof planes / sizeof *planes; n++) {
        size_t h = 0;
        while (strcmp(cw_hard_at(h)->name, planes[n].name) != 0)
            assert_non_null(cw_hard_at(++h));
        cw_mesh m = extract_hard(h);
        cw_cut_desc d = {.leave_open = false};
        for (int a = 0; a < 3; a++) {
            d.point[a] = planes[n].point[a] + m.origin[a];
            d.normal[a] = planes[n].normal[a];
        }
        check_cut(&m, &d, planes[n].name);
        cw_mesh_free(&m);
    }
}

/* Chains of an open mesh stay open; loops are closed; with leave_open none is. */
static void open_meshes_keep_their_openings(void **state)
{
    (void)state;
    cw_mesh m = make_empty(64, 96), out;
    add_box(&m, -1, 1, false);
    m.triangle_count -= 2; /* without the side at x = 1 */
    cw_cut_desc d = describe_plane(0, 0, 0.25, 0, 0, 1);
    cw_cut_facts f = cut_once(&m, &d, &out);
    assert_true(f.loops_closed == 0 && f.loops_open == 1 && f.cap_triangles == 0);
    assert_true(test_measure(&out).open_edges > 0);
    cw_mesh_free(&out);
    d = describe_plane(0.25, 0, 0, -1, 0, 0);
    f = cut_once(&m, &d, &out);
    assert_true(f.loops_closed == 1 && f.loops_open == 0);
    assert_within(f.area_mm2, 4, 1e-9);
    check_half(&out, &d, "a box closed by its section");
    cw_mesh_free(&out);
    d.leave_open = true;
    f = cut_once(&m, &d, &out);
    assert_true(f.loops_closed == 0 && f.loops_open == 1 && f.cap_triangles == 0);
    assert_within(f.area_mm2, 4, 1e-9);
    assert_int_equal(test_measure(&out).border_loops, 1);
    cw_mesh_free(&out);
    /* an edge of three triangles, and a triangle that names a vertex twice: no crash */
    add_triangle(&m, 0, 5, 7);
    add_triangle(&m, 0, 7, 7);
    add_triangle(&m, 1, 2, 4);
    for (int n = 0; n < 3; n++) {
        d = describe_plane(0, 0, n * 0.5 - 0.5, n == 0, 0.1 * n, 1);
        cut_once(&m, &d, &out);
        cw_mesh_free(&out);
    }
    cw_mesh_free(&m);
}

/* Attributes of new vertices lie between those of the ends of their edges. */
static void attributes_are_interpolated(void **state)
{
    (void)state;
    cw_mesh m = extract_field(CW_FIELD_SPHERE, 16), out;
    m.scalars = cwi_alloc_array(m.vertex_count, sizeof *m.scalars);
    m.colors = cwi_alloc_array(m.vertex_count, 4);
    m.labels = cwi_alloc_array(m.vertex_count, sizeof *m.labels);
    for (size_t v = 0; v < m.vertex_count; v++) {
        m.scalars[v] = m.positions[3 * v];
        m.labels[v] = m.positions[3 * v] > 0 ? 7 : 3;
        memset(m.colors + 4 * v, m.positions[3 * v] > 0 ? 200 : 100, 4);
    }
    const cw_cut_desc d = describe_plane(0, 0, 0.7, 0, 0, 1);
    cut_once(&m, &d, &out);
    for (size_t v = 0; v < out.vertex_count; v++) {
        const float *n = out.normals + 3 * v, x = out.positions[3 * v];
        const bool is_rim =
            fabsf(out.positions[3 * v + 2] + (float)out.origin[2] - 0.7f) < 1e-5f;
        assert_true(fabsf(out.scalars[v] - x) < 1e-4f);
        assert_true(out.labels[v] == 7 || out.labels[v] == 3);
        assert_true(out.colors[4 * v] >= 100 && out.colors[4 * v + 3] <= 200);
        assert_true(fabsf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-5f);
        if (is_rim)
            assert_true(n[2] < -0.5f);
    }
    cw_mesh_free(&m);
    cw_mesh_free(&out);
}

static void scales_give_the_same_cut(void **state)
{
    (void)state;
    static const double scales[] = {1e-4, 1e4};
    cw_mesh m = extract_field(CW_FIELD_GYROID, 20), one, other;
    cw_cut_desc d = describe_plane(1, 2, 3, 1, 2, 0.5);
    const cw_cut_facts f = cut_once(&m, &d, &one);
    for (int n = 0; n < 2; n++) {
        cw_mesh scaled;
        cw_error err = {0};
        assert_ok(cwi_mesh_copy(&m, &scaled, &err), err);
        for (size_t c = 0; c < 3 * m.vertex_count; c++)
            scaled.positions[c] = (float)((double)scaled.positions[c] * scales[n]);
        cw_cut_desc e = d;
        for (int a = 0; a < 3; a++) {
            scaled.origin[a] *= scales[n];
            e.point[a] *= scales[n];
        }
        const cw_cut_facts g = cut_once(&scaled, &e, &other);
        assert_int_equal(f.cut_triangles, g.cut_triangles);
        assert_int_equal(f.loops_closed, g.loops_closed);
        assert_within(g.area_mm2 / (scales[n] * scales[n]), f.area_mm2, 1e-5);
        check_half(&other, &e, "scaled");
        cw_mesh_free(&scaled);
        cw_mesh_free(&other);
    }
    cw_mesh_free(&m);
    cw_mesh_free(&one);
}

static bool stop_after(void *user, const char *step, double done)
{
    (void)step;
    assert_true(done >= 0 && done <= 1);
    return (*(int *)user)-- > 0;
}

static void bad_arguments_are_refused(void **state)
{
    (void)state;
    cw_mesh m = extract_field(CW_FIELD_GYROID, 12), out;
    cw_error err = {0};
    cw_cut_desc d = describe_plane(0, 0, 0, 0, 0, 0);
    assert_fails(cw_mesh_cut(&m, &d, &out, NULL, &err), CW_ERR_ARGUMENT, "normal is 0, 0, 0",
                 err);
    d.normal[1] = NAN;
    assert_fails(cw_mesh_cut(&m, &d, &out, NULL, &err), CW_ERR_ARGUMENT, "normal[1] is", err);
    d = describe_plane(0, 0, INFINITY, 0, 0, 1);
    assert_fails(cw_mesh_cut(&m, &d, &out, NULL, &err), CW_ERR_ARGUMENT, "point[2] is inf",
                 err);
    assert_fails(cw_mesh_cut(&m, NULL, &out, NULL, &err), CW_ERR_ARGUMENT, "desc", err);
    d = describe_plane(0, 0, 1e6, 0, 0, 1);
    assert_fails(cw_mesh_cut(&m, &d, &out, NULL, &err), CW_ERR_EMPTY, "nothing is left", err);
    d = describe_plane(0, 0, 0, 1, 2, 3);
    for (int steps = 0, stopped = true; stopped; steps++) {
        int left = steps;
        d.progress = (cw_progress){stop_after, &left};
        const cw_status st = cw_mesh_cut(&m, &d, &out, NULL, &err);
        stopped = left < 0;
        assert_int_equal(st, stopped ? CW_ERR_CANCELLED : CW_OK);
        assert_true(st == CW_OK || !out.positions);
        cw_mesh_free(&out);
    }
    cw_mesh_free(&m);
}

static void failing_allocations_leave_nothing(void **state)
{
    (void)state;
    cw_mesh m = make_empty(64, 96), out;
    cw_error err = {0};
    for (int n = 0; n < 4; n++)
        add_box(&m, -10 + 2 * n, 10 - 2 * n, n % 2);
    const cw_cut_desc d = describe_plane(0, 0, 0, 1, -1, 0.5);
    bool failed = true;
    for (long n = 0; failed; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st = cw_mesh_cut(&m, &d, &out, NULL, &err);
        failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        assert_true(st == CW_OK || !out.positions);
        cw_mesh_free(&out);
    }
    cw_mesh_free(&m);
}

static double find_shortest_edge(const cw_mesh *m, double *largest)
{
    double shortest_sq = INFINITY;
    for (size_t n = 0; n < 3 * m->triangle_count; n++) {
        const float *a = m->positions + 3 * (size_t)m->triangles[n],
                    *b = m->positions + 3 * (size_t)m->triangles[n % 3 == 2 ? n - 2 : n + 1];
        double length_sq = 0;
        for (int k = 0; k < 3; k++) {
            length_sq += ((double)a[k] - (double)b[k]) * ((double)a[k] - (double)b[k]);
            *largest = fmax(*largest, fabs((double)a[k]));
        }
        shortest_sq = fmin(shortest_sq, length_sq);
    }
    return sqrt(shortest_sq);
}

/* Planes that pass vertices as near as extraction leaves them to samples. */
static void planes_near_vertices_make_no_slivers(void **state)
{
    (void)state;
    cw_mesh rough = extract_field(CW_FIELD_SPHERE, 24), ball;
    cw_error err = {0};
    double largest = 0;
    test_seed(18);
    assert_ok(cw_mesh_remesh(&rough, &(cw_remesh_desc){.edge_mm = 4}, &ball, NULL, &err), err);
    assert_true(find_shortest_edge(&ball, &largest) > 1);
    const double near = 0x1p-16 * largest;
    for (int n = 0; n < test_some(24); n++) {
        const float *p =
            ball.positions + 3 * (size_t)(random_number() * (double)ball.vertex_count);
        cw_cut_desc d = {.normal = {random_number() - 0.5, random_number() - 0.5, 1}};
        const double off = (n % 3 - 1) * 0.7 * near; /* above it, at it, below it */
        for (int a = 0; a < 3; a++)
            d.point[a] = ball.origin[a] + (double)p[a];
        d.point[2] += off;
        const cw_cut_facts facts = check_cut(&ball, &d, "near a vertex");
        cw_mesh out;
        assert_ok(cw_mesh_cut(&ball, &d, &out, NULL, &err), err);
        assert_true(find_shortest_edge(&out, &largest) > near);
        assert_true(facts.moved_mm <= near);
        cw_mesh_free(&out);
    }
    cw_mesh_free(&ball);
    cw_mesh_free(&rough);
}

/* A slab thinner than vertices may be near to the plane is kept: nothing may be lost. */
static void thin_slabs_stay(void **state)
{
    (void)state;
    cw_mesh cube, out;
    cw_error err = {0};
    test_make_cube(&cube);
    cw_cut_desc d = {.point = {0, 0, 0.99999}, .normal = {0, 0, 1}};
    assert_ok(cw_mesh_cut(&cube, &d, &out, NULL, &err), err);
    assert_within(test_measure(&out).volume_mm3, 1e-5, 0.01);
    cw_mesh_free(&out);
    d.normal[2] = -1;
    assert_ok(cw_mesh_cut(&cube, &d, &out, NULL, &err), err);
    assert_within(test_measure(&out).volume_mm3, 0.99999, 1e-6);
    cw_mesh_free(&out);
    cw_mesh_free(&cube);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_planes_leave_two_solids),
        cmocka_unit_test(planes_through_vertices_leave_two_solids),
        cmocka_unit_test(planes_near_vertices_make_no_slivers),
        cmocka_unit_test(thin_slabs_stay),
        cmocka_unit_test(sections_have_the_areas_of_circles),
        cmocka_unit_test(islands_in_holes_are_filled),
        cmocka_unit_test(shells_within_each_other_stay_in_place),
        cmocka_unit_test(planes_along_faces_are_clear),
        cmocka_unit_test(hard_surfaces_leave_two_solids),
        cmocka_unit_test(rounded_sections_do_not_cross),
        cmocka_unit_test(open_meshes_keep_their_openings),
        cmocka_unit_test(attributes_are_interpolated),
        cmocka_unit_test(scales_give_the_same_cut),
        cmocka_unit_test(bad_arguments_are_refused),
        cmocka_unit_test(failing_allocations_leave_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
