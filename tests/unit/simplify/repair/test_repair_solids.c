/* Solids that cross or touch, or a shell that crosses itself: the repair unites them, and volumes are known. */
#include "support/support.h"

#include "core/base/memory.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_attributes.h"

#include <cubewright/quality.h>
#include <cubewright/repair.h>

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

enum { ROUND = 48 }; /* sides of a cylinder */

/* Makes room for a number of triangles. */
static cw_mesh make_empty(size_t triangles)
{
    cw_mesh m;
    cw_error err = {0};
    assert_ok(cwi_mesh_alloc(&m, 3 * triangles, triangles, false, &err), err);
    m.vertex_count = m.triangle_count = 0;
    return m;
}

static void push_triangle(cw_mesh *m, size_t a, size_t b, size_t c)
{
    const size_t v[3] = {a, b, c};
    for (int k = 0; k < 3; k++)
        m->triangles[3 * m->triangle_count + (size_t)k] = (uint32_t)v[k];
    m->triangle_count++;
}

static size_t push_point(cw_mesh *m, double x, double y, double z)
{
    const double p[3] = {x, y, z};
    for (int k = 0; k < 3; k++)
        m->positions[3 * m->vertex_count + (size_t)k] = (float)p[k];
    return m->vertex_count++;
}

/* Adds a prism over a polygon: lids are fans around its middle, which may cover a place twice. */
static void add_prism(cw_mesh *m, const double middle[2], const double (*at)[2], size_t count,
                      double low, double high)
{
    const size_t down = push_point(m, middle[0], middle[1], low),
                 up = push_point(m, middle[0], middle[1], high), first = m->vertex_count;
    for (size_t n = 0; n < count; n++) {
        push_point(m, at[n][0], at[n][1], low);
        push_point(m, at[n][0], at[n][1], high);
    }
    for (size_t n = 0; n < count; n++) {
        const size_t a = first + 2 * n, b = first + 2 * ((n + 1) % count);
        push_triangle(m, down, b, a);
        push_triangle(m, up, a + 1, b + 1);
        push_triangle(m, a, b, b + 1);
        push_triangle(m, a, b + 1, a + 1);
    }
}

static void add_cube(cw_mesh *m, double x, double y, double z, double size)
{
    const double middle[2] = {x + size / 2, y + size / 2};
    const double at[4][2] = {{x, y}, {x + size, y}, {x + size, y + size}, {x, y + size}};
    add_prism(m, middle, at, 4, z, z + size);
}

/* Adds a prism over a polygon on a circle that goes round a number of times. */
static void add_round(cw_mesh *m, size_t sides, int turns, double radius, double low,
                      double high)
{
    double at[ROUND][2];
    for (size_t n = 0; n < sides; n++) {
        const double angle = 2 * PI * turns * (double)n / (double)sides;
        at[n][0] = radius * cos(angle);
        at[n][1] = radius * sin(angle);
    }
    add_prism(m, (const double[2]){0, 0}, (const double(*)[2])at, sides, low, high);
}

/* Adds a torus around z. */
static void add_torus(cw_mesh *m, double x, double outer, double inner)
{
    const size_t first = m->vertex_count, n = ROUND;
    for (size_t i = 0; i < n * n; i++) {
        const double u = 2 * PI * (double)(i / n) / (double)n,
                     v = 2 * PI * (double)(i % n) / (double)n;
        push_point(m, x + (outer + inner * cos(v)) * cos(u), (outer + inner * cos(v)) * sin(u),
                   inner * sin(v));
    }
    for (size_t i = 0; i < n * n; i++) {
        const size_t next = i / n * n + (i + 1) % n, far = (i + n) % (n * n),
                     corner = (next + n) % (n * n);
        push_triangle(m, first + i, first + far, first + corner);
        push_triangle(m, first + i, first + corner, first + next);
    }
}

/* Adds a sphere: two tips, and rings between them. */
static void add_sphere(cw_mesh *m, double x, double radius)
{
    const size_t n = ROUND, rings = ROUND / 2 - 1;
    const size_t low = push_point(m, x, 0, -radius), high = push_point(m, x, 0, radius),
                 first = m->vertex_count;
    for (size_t i = 0; i < n * rings; i++) {
        const double u = 2 * PI * (double)(i % n) / (double)n,
                     v = PI * (double)(i / n + 1) / (double)(rings + 1);
        push_point(m, x + radius * sin(v) * cos(u), radius * sin(v) * sin(u), -radius * cos(v));
    }
    for (size_t i = 0; i < n; i++) {
        const size_t next = (i + 1) % n, last = first + n * (rings - 1);
        push_triangle(m, low, first + next, first + i);
        push_triangle(m, high, last + i, last + next);
        for (size_t k = 0; k + 1 < rings; k++) {
            const size_t a = first + k * n + i, b = first + k * n + next;
            push_triangle(m, a, b, b + n);
            push_triangle(m, a, b + n, a + n);
        }
    }
}

static void turn_from(cw_mesh *m, size_t first)
{
    for (size_t t = first; t < m->triangle_count; t++)
        cwi_mesh_swap_corners(m, t, 1, 2);
}

static double measure_volume(const cw_mesh *m)
{
    cw_quality q;
    cw_error err = {0};
    assert_ok(cw_quality_measure(m, NULL, &q, &err), err);
    return q.volume_mm3;
}

/* --- what is united ----------------------------------------------------------------------- */

/* Builds a mesh, and returns the volume of its union. */
typedef double (*builder)(cw_mesh *m);

static double build_wall(cw_mesh *m)
{
    add_cube(m, 0, 0, 0, 10);
    add_cube(m, 10, 0, 0, 10);
    return 2000;
}

/* The second cube is inside out. */
static double build_wall_turned(cw_mesh *m)
{
    add_cube(m, 0, 0, 0, 10);
    const size_t first = m->triangle_count;
    add_cube(m, 10, 0, 0, 10);
    turn_from(m, first);
    return 2000;
}

static double build_row(cw_mesh *m)
{
    for (int n = 0; n < 4; n++)
        add_cube(m, 10 * n, 0, 0, 10);
    return 4000;
}

/* Eight cubes around a vertex share walls, edges and the vertex. */
static double build_block(cw_mesh *m)
{
    for (int n = 0; n < 8; n++)
        add_cube(m, 10 * (n & 1), 10 * (n >> 1 & 1), 10 * (n >> 2), 10);
    return 8000;
}

static double build_plate(cw_mesh *m)
{
    add_cube(m, -20, -20, -40, 40);
    add_round(m, ROUND, 1, 8, 0, 30);
    return 40 * 40 * 40 + ROUND / 2.0 * 8 * 8 * sin(2 * PI / ROUND) * 30;
}

/* A cylinder that begins inside of a cube, and is inside out. */
static double build_crossing_turned(cw_mesh *m)
{
    add_cube(m, -20, -20, -40, 40);
    const size_t first = m->triangle_count;
    add_round(m, ROUND, 1, 8, -5, 25);
    turn_from(m, first);
    return 40 * 40 * 40 + ROUND / 2.0 * 8 * 8 * sin(2 * PI / ROUND) * 25;
}

/* Two spheres of 10 mm, 12 mm apart; what is in both has two caps of 4 mm. */
static double build_spheres(cw_mesh *m)
{
    add_sphere(m, 0, 10);
    const double one = measure_volume(m);
    add_sphere(m, 12, 10);
    const double lens = 2 * PI * 4 * 4 * (3 * 10 - 4) / 3;
    return 2 * one - lens;
}

/* A star of five tips: its outline goes round its middle twice. */
static double build_star(cw_mesh *m)
{
    add_round(m, 5, 2, 10, 0, 7);
    const double between = 10 * cos(2 * PI / 5) / cos(PI / 5);
    return 7 * 5 * 10 * between * sin(PI / 5);
}

/* A ball around a cavity in the form of a torus. */
static double build_cavity(cw_mesh *m)
{
    add_torus(m, 0, 8, 3);
    turn_from(m, 0);
    add_sphere(m, 0, 20);
    return measure_volume(m);
}

/* The same with a bar through the cavity's hole and out of the ball. */
static double build_cavity_bar(cw_mesh *m)
{
    const double hollow = build_cavity(m);
    const double before = measure_volume(m);
    add_round(m, ROUND, 1, 2, 10, 40);
    const double bar = measure_volume(m) - before, inside = bar * (20 - 10) / 30;
    return hollow + bar - inside;
}

static const struct solids_row {
    const char *name;
    builder build;
    size_t united, components;
    double tolerance; /* of the volume, as a fraction */
} solids_rows[] = {
    {"wall", build_wall, 2, 1, 1e-6},
    {"wall, one inside out", build_wall_turned, 2, 1, 1e-6},
    {"row", build_row, 4, 1, 1e-6},
    {"block", build_block, 8, 1, 1e-6},
    {"plate", build_plate, 2, 1, 1e-6},
    {"crossing, one inside out", build_crossing_turned, 2, 1, 1e-6},
    {"spheres", build_spheres, 2, 1, 2e-3},
    {"star", build_star, 1, 1, 1e-6},
    {"cavity", build_cavity, 0, 2, 1e-6},
    {"cavity and bar", build_cavity_bar, 2, 2, 1e-3},
};

static void check_solids(const struct solids_row *row, double scale)
{
    cw_mesh m = make_empty(20000), out;
    cw_repair_facts facts;
    cw_error err = {0};
    const double volume = row->build(&m);
    for (size_t c = 0; c < 3 * m.vertex_count; c++)
        m.positions[c] = (float)(scale * (double)m.positions[c]);
    assert_ok(cw_mesh_repair(&m, NULL, &out, &facts, &err), err);
    const cw_quality_desc desc = {.weld = CW_WELD_LOCAL, .shells = true};
    cw_quality q;
    assert_ok(cw_quality_measure(&out, &desc, &q, &err), err);
    const double found = q.volume_mm3 / pow(scale, 3);
    if (!facts.is_sound || facts.is_union_lacking || facts.united_shells != row->united ||
        facts.removed_triangles || q.components != row->components || q.inside_out ||
        !cw_quality_is_closed_manifold(&q) ||
        !(fabs(found - volume) <= row->tolerance * volume))
        fail_msg("%s by %g: sound %d, %zu united, %zu removed, %zu components, volume %.9g, "
                 "expected %.9g",
                 row->name, scale, facts.is_sound, facts.united_shells, facts.removed_triangles,
                 q.components, found, volume);
    cw_mesh_free(&m);
    cw_mesh_free(&out);
}

static void solids_have_the_volume_of_their_union(void **state)
{
    (void)state;
    static const double scales[] = {1, 1e-4, 1e4};
    for (size_t n = 0; n < sizeof solids_rows / sizeof *solids_rows; n++)
        for (int k = 0; k < 3; k++)
            check_solids(&solids_rows[n], scales[k]);
}

/* --- the outer boundary ------------------------------------------------------------------- */

/* Builds a cube of 20 mm with something inside, and returns the volume inside of its outer boundary. */
static double build_nested(cw_mesh *m)
{
    add_cube(m, 0, 0, 0, 20);
    add_cube(m, 0.5, 0.5, 0.5, 19);
    return 8000;
}

static double build_hollow(cw_mesh *m)
{
    add_cube(m, 0, 0, 0, 20);
    const size_t first = m->triangle_count;
    add_cube(m, 0.5, 0.5, 0.5, 19);
    turn_from(m, first);
    return 8000;
}

/* A part in a cavity, and one beside. */
static double build_island(cw_mesh *m)
{
    const double volume = build_hollow(m);
    add_cube(m, 5, 5, 5, 3);
    add_cube(m, 30, 0, 0, 10);
    return volume + 1000;
}

/* An inner wall that faces inward, and crosses the outer one on one side. */
static double build_pierced(cw_mesh *m)
{
    add_cube(m, 0, 0, 0, 20);
    const size_t first = m->triangle_count;
    add_cube(m, 1.5, 0.5, 0.5, 19);
    turn_from(m, first);
    return 8000 + 0.5 * 19 * 19;
}

/* Six plates, three inside out: a void that only their union encloses. */
static double build_joined(cw_mesh *m)
{
    for (int n = 0; n < 3; n++) {
        const size_t first = m->vertex_count;
        add_cube(m, 0, 0, 0, 20);
        add_cube(m, 0, 0, 0, 20);
        for (size_t v = first; v < m->vertex_count; v++) {
            float *x = &m->positions[3 * v + (size_t)n];
            *x = v < first + 10 ? *x / 10 : 20 - *x / 10;
        }
    }
    return 8000;
}

static const struct outer_row {
    const char *name;
    builder build;
    size_t inner, components;
    double gained;
} outer_rows[] = {
    {"nested", build_nested, 1, 1, 6859},         {"hollow", build_hollow, 1, 1, 6859},
    {"island", build_island, 2, 2, 6859 - 27},    {"pierced", build_pierced, 0, 1, 0},
    {"joined", build_joined, 1, 1, 16 * 16 * 16}, {"wall", build_wall, 0, 1, 0},
};

static void check_outer(const struct outer_row *row, bool is_turned)
{
    cw_mesh m = make_empty(1000), out;
    cw_repair_facts facts;
    cw_error err = {0};
    const cw_repair_desc desc = {.outer_only = true};
    const double volume = row->build(&m);
    if (is_turned)
        turn_from(&m, 0);
    assert_ok(cw_mesh_repair(&m, &desc, &out, &facts, &err), err);
    const cw_quality_desc shells = {.weld = CW_WELD_LOCAL, .shells = true};
    cw_quality q;
    assert_ok(cw_quality_measure(&out, &shells, &q, &err), err);
    if (!facts.is_sound || facts.inner_shells != row->inner ||
        q.components != row->components || q.cavities || q.nested ||
        !(fabs(q.volume_mm3 - volume) <= 1e-5 * volume) ||
        !(fabs(facts.inner_mm3 - row->gained) <= 1e-4 * volume) ||
        !(facts.volume_changed < 0.02))
        fail_msg(
            "%s%s: sound %d, %zu inner, gained %.9g, %zu components, volume %.9g, expected "
            "%.9g; changed %g",
            row->name, is_turned ? ", turned" : "", facts.is_sound, facts.inner_shells,
            facts.inner_mm3, q.components, q.volume_mm3, volume, facts.volume_changed);
    cw_mesh_free(&m);
    cw_mesh_free(&out);
}

static void the_outer_boundary_has_nothing_inside(void **state)
{
    (void)state;
    for (size_t n = 0; n < sizeof outer_rows / sizeof *outer_rows; n++)
        for (int turned = 0; turned < 2; turned++)
            check_outer(&outer_rows[n], turned);
}

/* --- attributes --------------------------------------------------------------------------- */

/* A union keeps the sources of what stays, and mixes at new vertices. It adds no attribute of its own. */
static void attributes_go_through_a_union(void **state)
{
    (void)state;
    cw_mesh m = make_empty(1000), out;
    cw_error err = {0};
    cw_repair_facts facts;
    add_cube(&m, -20, -20, -40, 40);
    const size_t first = m.triangle_count;
    add_round(&m, ROUND, 1, 8, -5, 25);
    const cw_attribute part = {.name = "part",
                               .on = CW_ON_TRIANGLES,
                               .type = CW_U32,
                               .components = 1,
                               .interpolation = CW_INTERPOLATE_NEAREST};
    cw_attribute *row;
    assert_ok(cw_mesh_attribute_add(&m, &part, &row, &err), err);
    for (size_t t = 0; t < m.triangle_count; t++)
        ((uint32_t *)row->data)[t] = t < first ? 1 : 2;
    m.scalars = cwi_alloc_array(m.vertex_count, sizeof *m.scalars);
    for (size_t v = 0; v < m.vertex_count; v++)
        m.scalars[v] = m.positions[3 * v] + 2 * m.positions[3 * v + 2];
    assert_ok(cw_mesh_repair(&m, NULL, &out, &facts, &err), err);
    assert_true(facts.is_sound && facts.united_shells == 2 && out.attribute_count == 1);
    const uint32_t *parts = cw_mesh_attribute_find(&out, "part")->data;
    for (size_t t = 0; t < out.triangle_count; t++) {
        double top = -INFINITY;
        for (size_t k = 0; k < 3; k++)
            top = fmax(top, (double)out.positions[3 * (size_t)out.triangles[3 * t + k] + 2]);
        assert_int_equal(parts[t], top > 0 ? 2 : 1);
    }
    for (size_t v = 0; v < out.vertex_count; v++)
        assert_within((double)out.scalars[v] + 100,
                      (double)out.positions[3 * v] + 2 * (double)out.positions[3 * v + 2] + 100,
                      1e-5);
    cw_mesh_free(&m);
    cw_mesh_free(&out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solids_have_the_volume_of_their_union),
        cmocka_unit_test(the_outer_boundary_has_nothing_inside),
        cmocka_unit_test(attributes_go_through_a_union),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
