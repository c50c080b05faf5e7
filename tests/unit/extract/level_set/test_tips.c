/* Tests that shapes sharper, or thinner, than voxels come back from a level set all the
 * same. */
#include "support/surface.h"

#include <math.h>
#include <string.h>

enum { MAX_SIDES = 8 };

/* A mesh in memory of its own: nothing to free. */
typedef struct shape {
    float positions[3 * 2 * MAX_SIDES];
    uint32_t triangles[3 * 4 * MAX_SIDES];
    cw_mesh mesh;
} shape;

static void add_vertex(shape *s, double x, double y, double z)
{
    const double p[3] = {x, y, z};
    for (size_t a = 0; a < 3; a++)
        s->positions[3 * s->mesh.vertex_count + a] = (float)p[a];
    s->mesh.vertex_count++;
}

static void add_triangle(shape *s, uint32_t a, uint32_t b, uint32_t c)
{
    const uint32_t v[3] = {a, b, c};
    memcpy(s->triangles + 3 * s->mesh.triangle_count++, v, sizeof v);
}

/* Between z = 0 and some height, over a polygon that runs counter-clockwise and is a fan around
 * its first corner. */
static void make_prism(shape *s, const double (*corner)[2], uint32_t count, double height)
{
    memset(s, 0, sizeof *s);
    for (uint32_t n = 0; n < 2 * count; n++)
        add_vertex(s, corner[n % count][0], corner[n % count][1], n < count ? 0 : height);
    for (uint32_t n = 0; n < count; n++) {
        const uint32_t next = (n + 1) % count;
        add_triangle(s, n, next, count + next);
        add_triangle(s, n, count + next, count + n);
    }
    for (uint32_t n = 1; n + 1 < count; n++) {
        add_triangle(s, 0, n + 1, n);
        add_triangle(s, count, count + n, count + n + 1);
    }
}

static void make_wedge(shape *s, double degrees)
{
    const double half = 15 * tan(degrees / 360 * PI);
    make_prism(s, (const double[][2]){{0, 0}, {15, -half}, {15, half}}, 3, 12);
}

static void make_box(shape *s, double x, double y, double z)
{
    make_prism(s, (const double[][2]){{0, 0}, {x, 0}, {x, y}, {0, y}}, 4, z);
}

/* A block with a groove from above, whose floor is the first corner. */
static void make_groove(shape *s, double degrees)
{
    const double half = 8 * tan(degrees / 360 * PI);
    make_prism(s,
               (const double[][2]){
                   {0, 4}, {-half, 12}, {-10, 12}, {-10, 0}, {10, 0}, {10, 12}, {half, 12}},
               7, 14);
}

/* A block with two teeth, and the gap between them as sharp. */
static void make_teeth(shape *s, double degrees)
{
    const double half = 8 * tan(degrees / 360 * PI);
    make_prism(s,
               (const double[][2]){{0, 4},
                                   {-half, 12},
                                   {-2 * half, 4},
                                   {-2 * half, 0},
                                   {2 * half, 0},
                                   {2 * half, 4},
                                   {half, 12}},
               7, 14);
}

/* A pyramid on a polygon with equal sides. */
static void make_needle(shape *s, uint32_t sides, double radius, double height)
{
    memset(s, 0, sizeof *s);
    for (uint32_t n = 0; n < sides; n++)
        add_vertex(s, radius * cos(2 * PI * n / sides), radius * sin(2 * PI * n / sides), 0);
    add_vertex(s, 0, 0, height);
    for (uint32_t n = 0; n < sides; n++)
        add_triangle(s, n, (n + 1) % sides, sides);
    for (uint32_t n = 1; n + 1 < sides; n++)
        add_triangle(s, 0, n + 1, n);
}

/* By an angle about (1, 2, 3) and then the same about x; 0 leaves it. */
static void turn(shape *s, double angle)
{
    const double k = 1 / sqrt(14.0), n[3] = {k, 2 * k, 3 * k};
    for (size_t v = 0; v < s->mesh.vertex_count; v++) {
        float *p = s->positions + 3 * v;
        const double x[3] = {(double)p[0], (double)p[1], (double)p[2]};
        const double along = n[0] * x[0] + n[1] * x[1] + n[2] * x[2];
        double y[3];
        for (int a = 0; a < 3; a++) {
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            y[a] = x[a] * cos(angle) + (n[b] * x[c] - n[c] * x[b]) * sin(angle) +
                   n[a] * along * (1 - cos(angle));
        }
        p[0] = (float)y[0];
        p[1] = (float)(y[1] * cos(angle) - y[2] * sin(angle));
        p[2] = (float)(y[1] * sin(angle) + y[2] * cos(angle));
    }
    s->mesh.positions = s->positions;
    s->mesh.triangles = s->triangles;
}

enum { SHAPES = 10 };

static void make_shape(shape *s, int n, double angle)
{
    switch (n) {
    case 0:
        make_wedge(s, 37);
        break;
    case 1:
        make_wedge(s, 20);
        break;
    case 2:
        make_wedge(s, 8);
        break;
    case 3:
        make_needle(s, 3, 12, 17);
        break; /* a tetrahedron, nearly */
    case 4:
        make_needle(s, 3, 1.5, 20);
        break;
    case 5:
        make_needle(s, 4, 1.5, 20);
        break;
    case 6:
        make_groove(s, 30);
        break;
    case 7:
        make_box(s, 12, 14, 0.3);
        break;
    case 8:
        make_teeth(s, 15);
        break;
    default:
        make_box(s, 0.3, 0.3, 14);
        break;
    }
    turn(s, angle);
}

static double farthest(const cw_mesh *a, const cw_mesh *b)
{
    cw_distance d;
    cw_error err = {0};
    assert_ok(cw_distance_to_mesh(a, b, NULL, &d, NULL, &err), err);
    return d.max_mm;
}

static void assert_comes_back(const cw_mesh *mesh, double voxel, int *refined)
{
    cw_mesh back;
    cw_offset_facts facts;
    cw_error err = {0};
    assert_ok(cw_mesh_offset(mesh, &(cw_offset_desc){.voxel_mm = voxel}, &back, &facts, &err),
              err);
    assert_false(facts.is_astray);
    assert_true(facts.asked_mm == voxel);
    assert_true(facts.voxel_mm == voxel || facts.voxel_mm == voxel / 2 ||
                facts.voxel_mm == voxel / 4);
    *refined += facts.voxel_mm < voxel;
    assert_true(farthest(mesh, &back) <= 0.5 * voxel);
    assert_true(farthest(&back, mesh) <= 0.5 * voxel);
    const cw_quality q = test_measure(&back);
    assert_true(cw_quality_is_closed_manifold(&q) && q.volume_mm3 > 0 && !q.degenerate);
    assert_int_equal(q.components, 1);
    assert_int_equal(q.euler, 2);
    assert_int_equal(test_count_crossings(&back), 0);
    cw_mesh_free(&back);
}

/* Smaller voxels are the exception. */
static void tips_needles_grooves_and_fins_come_back(void **state)
{
    (void)state;
    int count = 0, refined = 0;
    for (int n = 0; n < SHAPES; n++)
        for (int t = 0; t < test_some(3); t++, count++) {
            shape s;
            make_shape(&s, n, 0.7 * t);
            assert_comes_back(&s.mesh, 1 + 0.13 * t, &refined);
        }
    assert_true(3 * refined <= count);
}

/* Without finer voxels a shape may be lost, and that is reported. */
static void what_is_lost_is_told(void **state)
{
    (void)state;
    shape s;
    cw_mesh back;
    cw_offset_facts facts;
    cw_error err = {0};
    make_shape(&s, 6, 2);
    for (int refine = 0; refine < 2; refine++) {
        const cw_offset_desc desc = {.voxel_mm = 6, .no_refine = !refine};
        assert_ok(cw_mesh_offset(&s.mesh, &desc, &back, &facts, &err), err);
        const double most = fmax(farthest(&s.mesh, &back), farthest(&back, &s.mesh));
        assert_int_equal(facts.is_astray, most > 3 || test_measure(&back).components > 1);
        assert_true(facts.voxel_mm == (refine ? 3 : 6) && facts.is_astray == !refine);
        cw_mesh_free(&back);
    }
}

static void tips_are_the_same_for_any_number_of_threads(void **state)
{
    (void)state;
    static const int shapes[] = {1, 6};
    cw_error err = {0};
    for (int n = 0; n < 2; n++) {
        shape s;
        cw_mesh one, three;
        make_shape(&s, shapes[n], 1);
        assert_ok(cw_mesh_offset(&s.mesh, &(cw_offset_desc){.voxel_mm = 1.1, .threads = 1},
                                 &one, NULL, &err),
                  err);
        assert_ok(cw_mesh_offset(&s.mesh, &(cw_offset_desc){.voxel_mm = 1.1, .threads = 3},
                                 &three, NULL, &err),
                  err);
        test_assert_same_mesh(&one, &three);
        cw_mesh_free(&one);
        cw_mesh_free(&three);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tips_needles_grooves_and_fins_come_back),
        cmocka_unit_test(what_is_lost_is_told),
        cmocka_unit_test(tips_are_the_same_for_any_number_of_threads),
    };
    return cw_level_set_available() ? cmocka_run_group_tests(tests, NULL, NULL) : 0;
}
