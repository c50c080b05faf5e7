/* One-sided surfaces: checks count them, and a repair names and drops them. A twist in a small place is damage. */
#include "support/support.h"

#include "core/mesh/mesh.h"

#include <cubewright/quality.h>
#include <cubewright/repair.h>

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

enum { AROUND = 60, ACROSS = 24 };

typedef enum surface { TORUS, KLEIN, MOEBIUS, CROSSCAP, SURFACES } surface;

static void find_point(surface kind, double u, double v, double p[3])
{
    const double half = u / 2, s = kind == MOEBIUS ? v / PI - 1 : 0;
    const double klein = 2 + cos(half) * sin(v) - sin(half) * sin(2 * v);
    const double r = kind == KLEIN ? klein : kind == MOEBIUS ? 3 + s * cos(half) : 3 + cos(v);
    p[0] = r * cos(u);
    p[1] = r * sin(u);
    p[2] = kind == KLEIN     ? sin(half) * sin(v) + cos(half) * sin(2 * v)
           : kind == MOEBIUS ? s * sin(half)
                             : sin(v);
}

/* Returns the vertex at a place of the grid. The last column is the first one, mirrored where a surface is one-sided. */
static uint32_t find_vertex(surface kind, uint32_t i, uint32_t j)
{
    if (i == AROUND) {
        i = 0;
        j = kind == KLEIN || kind == MOEBIUS ? ACROSS - j : j;
    }
    j = kind == MOEBIUS ? j : j % ACROSS;
    if (kind == CROSSCAP && i >= 5 && i <= 7 &&
        j == 6) { /* opposite corners of a hole are one */
        i = 12 - i;
        j = 5;
    }
    return i * (ACROSS + 1) + j;
}

static void add_quad(cw_mesh *m, surface kind, uint32_t i, uint32_t j)
{
    const uint32_t a = find_vertex(kind, i, j), b = find_vertex(kind, i + 1, j),
                   c = find_vertex(kind, i + 1, j + 1), d = find_vertex(kind, i, j + 1);
    const uint32_t corners[6] = {a, b, c, a, c, d};
    for (int k = 0; k < 6; k++)
        m->triangles[3 * m->triangle_count + (size_t)k] = corners[k];
    m->triangle_count += 2;
}

static cw_mesh make_surface(surface kind)
{
    cw_mesh m;
    cw_error err = {0};
    assert_ok(cwi_mesh_alloc(&m, AROUND * (ACROSS + 1), 2 * AROUND * ACROSS, false, &err), err);
    m.triangle_count = 0;
    for (uint32_t v = 0; v < m.vertex_count; v++) {
        double p[3];
        find_point(kind, 2 * PI * (v / (ACROSS + 1)) / AROUND,
                   2 * PI * (v % (ACROSS + 1)) / ACROSS, p);
        for (int k = 0; k < 3; k++)
            m.positions[3 * v + (uint32_t)k] = (float)p[k];
    }
    for (uint32_t i = 0; i < AROUND; i++)
        for (uint32_t j = 0; j < ACROSS; j++)
            if (kind != CROSSCAP || i < 5 || i > 6 || j != 5)
                add_quad(&m, kind, i, j);
    return m;
}

static const struct {
    const char *name;
    size_t one_sided;
    bool is_dropped;
} rows[SURFACES] = {
    [TORUS] = {"torus", 0, false},
    [KLEIN] = {"Klein bottle", 1, true},
    [MOEBIUS] = {"Moebius strip", 1, true},
    [CROSSCAP] = {"torus with a crosscap in place of two quads", 1, false},
};

static void one_sided_surfaces_are_counted(void **state)
{
    (void)state;
    for (int kind = 0; kind < SURFACES; kind++) {
        cw_mesh m = make_surface((surface)kind);
        cw_quality q;
        cw_error err = {0};
        assert_ok(cw_quality_measure(&m, &(cw_quality_desc){.shells = true}, &q, &err), err);
        if (q.one_sided != rows[kind].one_sided)
            fail_msg("%s: %zu one-sided", rows[kind].name, q.one_sided);
        for (uint32_t t = 0; t < m.triangle_count;
             t += 3) { /* turned triangles change nothing */
            const uint32_t v = m.triangles[3 * t];
            m.triangles[3 * t] = m.triangles[3 * t + 1];
            m.triangles[3 * t + 1] = v;
        }
        assert_ok(cw_quality_measure(&m, &(cw_quality_desc){.shells = true}, &q, &err), err);
        if (q.one_sided != rows[kind].one_sided)
            fail_msg("%s, some triangles turned: %zu one-sided", rows[kind].name, q.one_sided);
        assert_true(q.misoriented_edges > 0);
        cw_mesh_free(&m);
    }
}

static void one_sided_surfaces_leave_nothing(void **state)
{
    (void)state;
    for (int kind = 0; kind < SURFACES; kind++) {
        cw_mesh m = make_surface((surface)kind), out;
        cw_repair_facts f;
        cw_error err = {0};
        const cw_status st = cw_mesh_repair(&m, NULL, &out, &f, &err);
        if (st != (rows[kind].is_dropped ? CW_ERR_EMPTY : CW_OK) ||
            f.one_sided != rows[kind].is_dropped || f.is_sound == rows[kind].is_dropped ||
            (f.twisted_edges > 0) != (rows[kind].one_sided > 0) ||
            f.is_needed != (kind != TORUS))
            fail_msg("%s: status %d (%s), %zu one-sided, sound %d, %zu twisted edges",
                     rows[kind].name, st, err.message, f.one_sided, f.is_sound,
                     f.twisted_edges);
        if (rows[kind].is_dropped)
            assert_non_null(strstr(err.message, "one-sided (like a Moebius strip)"));
        cw_mesh_free(&m);
        cw_mesh_free(&out);
    }
}

/* The rest of a mesh is repaired as without the strip, which the guard leaves out. */
static void a_strip_beside_a_solid_goes(void **state)
{
    (void)state;
    cw_mesh solid = make_surface(TORUS), strip = make_surface(MOEBIUS), both, out;
    cw_repair_facts f;
    cw_error err = {0};
    for (size_t v = 0; v < strip.vertex_count; v++)
        strip.positions[3 * v] += 10;
    const size_t first = solid.vertex_count;
    assert_ok(cwi_mesh_alloc(&both, first + strip.vertex_count,
                             solid.triangle_count + strip.triangle_count, false, &err),
              err);
    memcpy(both.positions, solid.positions, 12 * first);
    memcpy(both.positions + 3 * first, strip.positions, 12 * strip.vertex_count);
    memcpy(both.triangles, solid.triangles, 12 * solid.triangle_count);
    for (size_t c = 0; c < 3 * strip.triangle_count; c++)
        both.triangles[3 * solid.triangle_count + c] = strip.triangles[c] + (uint32_t)first;
    assert_ok(cw_mesh_repair(&both, NULL, &out, &f, &err), err);
    assert_true(f.is_sound && f.is_needed && f.one_sided == 1);
    assert_int_equal(out.triangle_count, solid.triangle_count);
    cw_mesh_free(&solid);
    cw_mesh_free(&strip);
    cw_mesh_free(&both);
    cw_mesh_free(&out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_sided_surfaces_are_counted),
        cmocka_unit_test(one_sided_surfaces_leave_nothing),
        cmocka_unit_test(a_strip_beside_a_solid_goes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
