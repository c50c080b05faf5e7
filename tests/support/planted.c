/* Builds meshes with one known fault each, from cubes, balls, rings and fans. */
#include "support/planted.h"

#include <math.h>
#include <stdlib.h>

enum { CAPACITY = 1024 };

struct test_builder {
    float points[3 * CAPACITY];
    uint32_t corners[3 * CAPACITY];
    uint32_t points_used, triangles_used;
};

static uint32_t point(test_builder *b, double x, double y, double z)
{
    assert_true(b->points_used < CAPACITY);
    const double p[3] = {x, y, z};
    for (int a = 0; a < 3; a++)
        b->points[3 * b->points_used + (uint32_t)a] = (float)p[a];
    return b->points_used++;
}

static void triangle(test_builder *b, uint32_t u, uint32_t v, uint32_t w)
{
    assert_true(b->triangles_used < CAPACITY);
    uint32_t *c = b->corners + 3 * b->triangles_used++;
    c[0] = u;
    c[1] = v;
    c[2] = w;
}

static void quad(test_builder *b, uint32_t u, uint32_t v, uint32_t w, uint32_t x)
{
    triangle(b, u, v, w);
    triangle(b, u, w, x);
}

static void flip(test_builder *b, uint32_t first, uint32_t end)
{
    for (uint32_t t = first; t < end; t++) {
        uint32_t *c = b->corners + 3 * t, swap = c[0];
        c[0] = c[1];
        c[1] = swap;
    }
}

/* Number x + 2y + 4z is the corner that is high in x, y and z. */
static void box(test_builder *b, double x0, double y0, double z0, double x1, double y1,
                double z1)
{
    const uint32_t v = b->points_used;
    for (int n = 0; n < 8; n++)
        point(b, n & 1 ? x1 : x0, n & 2 ? y1 : y0, n & 4 ? z1 : z0);
    quad(b, v, v + 4, v + 6, v + 2);
    quad(b, v + 1, v + 3, v + 7, v + 5);
    quad(b, v, v + 1, v + 5, v + 4);
    quad(b, v + 2, v + 6, v + 7, v + 3);
    quad(b, v, v + 2, v + 3, v + 1);
    quad(b, v + 4, v + 5, v + 7, v + 6);
}

/* A cube of side 2 * r around a place. */
static void cube(test_builder *b, double x, double y, double z, double r)
{
    box(b, x - r, y - r, z - r, x + r, y + r, z + r);
}

enum { AROUND = 12 };

/* A ring of points around the z axis. */
static uint32_t ring(test_builder *b, double radius, double z)
{
    const uint32_t first = b->points_used;
    for (int n = 0; n < AROUND; n++)
        point(b, radius * cos(2 * PI * n / AROUND), radius * sin(2 * PI * n / AROUND), z);
    return first;
}

static void band(test_builder *b, uint32_t low, uint32_t high)
{
    for (uint32_t n = 0, m = 1; n < AROUND; n++, m = (m + 1) % AROUND)
        quad(b, low + n, low + m, high + m, high + n);
}

/* A fan from a point below or above a ring. */
static void fan(test_builder *b, uint32_t tip, uint32_t first, bool above)
{
    for (uint32_t n = 0, m = 1; n < AROUND; n++, m = (m + 1) % AROUND)
        triangle(b, tip, first + (above ? n : m), first + (above ? m : n));
}

static void ball_with(test_builder *b, bool twice)
{
    uint32_t last = 0;
    for (int k = 1; k < 6; k++) {
        const uint32_t next = ring(b, 10 * sin(PI * k / 6), -10 * cos(PI * k / 6));
        if (k == 1)
            fan(b, point(b, 0, 0, -10), next, false);
        else
            band(b, last, next);
        last = next;
        if (k == 3 && twice) {
            last = ring(b, 10 * sin(PI * k / 6), -10 * cos(PI * k / 6));
            band(b, next, last);
        }
    }
    fan(b, point(b, 0, 0, 10), last, true);
}

static void drop(test_builder *b, uint32_t t)
{
    const uint32_t last = --b->triangles_used;
    for (uint32_t c = 0; c < 3; c++)
        b->corners[3 * t + c] = b->corners[3 * last + c];
}

/* Triangle t in three, around a point on the side from its corner 0 to 1, or near it. */
static void split(test_builder *b, uint32_t t, uint32_t m)
{
    uint32_t *c = b->corners + 3 * t;
    const uint32_t u = c[0], v = c[1], w = c[2];
    c[2] = m;
    triangle(b, v, w, m);
    triangle(b, w, u, m);
}

static void a_cube(test_builder *b)
{
    cube(b, 0, 0, 0, 5);
}

static void a_ball(test_builder *b)
{
    ball_with(b, false);
}

static void a_torus(test_builder *b)
{
    uint32_t rings[AROUND];
    for (int k = 0; k < AROUND; k++)
        rings[k] = ring(b, 10 - 4 * cos(2 * PI * k / AROUND), -4 * sin(2 * PI * k / AROUND));
    for (int k = 0; k < AROUND; k++)
        band(b, rings[k], rings[(k + 1) % AROUND]);
}

static void two_cubes(test_builder *b)
{
    cube(b, 0, 0, 0, 5);
    cube(b, 20, 0, 0, 5);
}

static void missing_triangle(test_builder *b)
{
    a_cube(b);
    drop(b, 5);
}

static void two_holes(test_builder *b)
{
    a_ball(b);
    drop(b, b->triangles_used - 1); /* of the fans at either end */
    drop(b, 0);
}

static void touching_holes(test_builder *b)
{
    a_ball(b);
    drop(b, 6);
    drop(b, 0);
}

static void tube(test_builder *b)
{
    const uint32_t low = ring(b, 10, 0);
    band(b, low, ring(b, 10, 10));
}

static void sheet(test_builder *b)
{
    for (int n = 0; n < 4; n++)
        point(b, n & 1 ? 8 : 0, n & 2 ? 8 : 0, 0);
    quad(b, 0, 1, 3, 2);
}

static void one_triangle(test_builder *b)
{
    sheet(b);
    b->triangles_used = 1;
    b->points_used = 4;
}

static void flipped_triangle(test_builder *b)
{
    a_ball(b);
    flip(b, 30, 31);
}

static void half_flipped(test_builder *b)
{
    a_cube(b);
    flip(b, 0, 6); /* -x, +x and -y: eight edges are between these and the others */
}

static void inside_out_cube(test_builder *b)
{
    a_cube(b);
    flip(b, 0, b->triangles_used);
}

static void open_inside_out(test_builder *b)
{
    a_ball(b);
    drop(b, 6);
    flip(b, 0, b->triangles_used);
}

static void one_inside_out(test_builder *b)
{
    two_cubes(b);
    flip(b, 12, 24);
}

static void duplicate(test_builder *b)
{
    a_cube(b);
    triangle(b, b->corners[0], b->corners[1], b->corners[2]);
}

static void opposite_duplicate(test_builder *b)
{
    duplicate(b);
    flip(b, 12, 13);
}

static void coincident_cubes(test_builder *b)
{
    a_cube(b);
    a_cube(b);
}

static void t_junction(test_builder *b)
{
    a_cube(b);
    split(b, 10, point(b, 0, -5, 5)); /* +z, on its side along x at low y */
    drop(b, 10);
}

static void flat_split(test_builder *b)
{
    a_cube(b);
    split(b, 10, point(b, 0, -5, 5));
}

static void cap(test_builder *b)
{
    a_cube(b);
    split(b, 10, point(b, 0, -4.9, 5));
}

static void zero_band(test_builder *b)
{
    ball_with(b, true);
}

static void bow_tie(test_builder *b)
{
    cube(b, 0, 0, 0, 5);
    cube(b, 10, 10, 10, 5);
}

static void shared_edge(test_builder *b)
{
    cube(b, 0, 0, 0, 5);
    cube(b, 10, 10, 0, 5);
}

static void fin(test_builder *b)
{
    a_cube(b);
    triangle(b, 0, 1, point(b, 0, -9, -9));
}

static void cavity(test_builder *b)
{
    cube(b, 0, 0, 0, 2);
    flip(b, 0, 12);
    cube(b, 0, 0, 0, 5);
}

static void nested(test_builder *b)
{
    cube(b, 0, 0, 0, 2);
    cube(b, 0, 0, 0, 5);
}

static void solid_in_cavity(test_builder *b)
{
    cavity(b);
    cube(b, 0, 0, 0, 1);
}

static void twice_nested(test_builder *b)
{
    nested(b);
    cube(b, 0, 0, 0, 1);
}

static void crossed_bars(test_builder *b)
{
    box(b, -10, -1, -1, 10, 1, 1);
    box(b, -1.5, -10, -1.5, 1.5, 10, 1.5);
}

static void touching_faces(test_builder *b)
{
    cube(b, 0, 0, 0, 5);
    cube(b, 8, 0, 0, 3);
}

static void touching_tip(test_builder *b)
{
    const uint32_t first = ring(b, 4, 10);
    fan(b, point(b, 0.5, 0.25, 5), first, false);
    fan(b, point(b, 0, 0, 12), first, true);
    cube(b, 0, 0, 0, 5);
}

static void needles(test_builder *b)
{
    box(b, 0, 0, 0, 1, 1, 50);
}

static void spike(test_builder *b)
{
    const uint32_t low = ring(b, 10, 0), high = ring(b, 10, 5);
    fan(b, point(b, 0, 0, 0), low, false);
    band(b, low, high);
    fan(b, point(b, 0.5, 0.25, -5), high, true);
}

static void folded(test_builder *b)
{
    sheet(b);
    b->points[3 * 2] = 6; /* over the other triangle, in its plane */
    b->points[3 * 2 + 1] = 2;
}

static void soup(test_builder *b)
{
    test_builder *whole = calloc(1, sizeof *whole);
    assert_non_null(whole);
    a_cube(whole);
    for (uint32_t c = 0; c < 3 * whole->triangles_used; c++) {
        const float *p = whole->points + 3 * whole->corners[c];
        point(b, (double)p[0], (double)p[1], (double)p[2]);
    }
    for (uint32_t t = 0; t < whole->triangles_used; t++)
        triangle(b, 3 * t, 3 * t + 1, 3 * t + 2);
    free(whole);
}

static void unused_points(test_builder *b)
{
    a_cube(b);
    point(b, 1, 2, 3);
    point(b, 30, 2, 3);
}

static void moebius(test_builder *b)
{
    enum { STEPS = 24 };
    for (int n = 0; n < STEPS; n++)
        for (int side = -1; side <= 1; side += 2) {
            const double turn = 2 * PI * n / STEPS, r = 10 + side * 2 * cos(turn / 2);
            point(b, r * cos(turn), r * sin(turn), side * 2 * sin(turn / 2));
        }
    for (uint32_t n = 0; n < STEPS - 1; n++)
        quad(b, 2 * n, 2 * n + 2, 2 * n + 3, 2 * n + 1);
    quad(b, 2 * STEPS - 2, 1, 0, 2 * STEPS - 1);
}

static void crack(test_builder *b)
{
    a_cube(b);
    b->corners[3 * 10 + 1] = point(b, 5, -5, 5.001);
}

const test_planted test_planted_meshes[] = {
    {"cube", a_cube, .components = 1},
    {"ball", a_ball, .components = 1},
    {"torus", a_torus, .components = 1, .genus = 1},
    {"two_cubes", two_cubes, .components = 2},
    {"soup", soup, .components = 1},
    {"unused_points", unused_points, .components = 1, .unused_vertices = 2},
    {"cavity", cavity, .components = 2, .cavities = 1},
    {"solid_in_cavity", solid_in_cavity, .components = 3, .cavities = 1},
    {"missing_triangle", missing_triangle, .components = 1, .open_edges = 3, .border_loops = 1},
    {"two_holes", two_holes, .components = 1, .open_edges = 6, .border_loops = 2},
    {"touching_holes", touching_holes, .components = 1, .open_edges = 6, .border_loops = 1,
     .nonmanifold_vertices = 1, .genus = -1},
    {"tube", tube, .components = 1, .open_edges = 24, .border_loops = 2},
    {"sheet", sheet, .components = 1, .open_edges = 4, .border_loops = 1},
    {"one_triangle", one_triangle, .components = 1, .open_edges = 3, .border_loops = 1,
     .unused_vertices = 1},
    {"crack", crack, .components = 1, .open_edges = 4, .border_loops = 1},
    {"t_junction", t_junction, .components = 1, .open_edges = 3, .border_loops = 1,
     .meets_itself = true},
    {"moebius", moebius, .components = 1, .open_edges = 48, .border_loops = 1,
     .misoriented_edges = 1, .genus = -1},
    {"flipped_triangle", flipped_triangle, .components = 1, .misoriented_edges = 3,
     .genus = -1},
    {"half_flipped", half_flipped, .components = 1, .misoriented_edges = 8, .genus = -1},
    {"inside_out_cube", inside_out_cube, .components = 1, .inside_out = 1},
    {"open_inside_out", open_inside_out, .components = 1, .open_edges = 3, .border_loops = 1,
     .open_inward = 1},
    {"one_inside_out", one_inside_out, .components = 2, .inside_out = 1},
    {"nested", nested, .components = 2, .nested = 1},
    {"twice_nested", twice_nested, .components = 3, .nested = 2},
    {"duplicate", duplicate, .components = 1, .nonmanifold_edges = 3, .duplicates = 1,
     .genus = -1, .meets_itself = true},
    {"opposite_duplicate", opposite_duplicate, .components = 1, .nonmanifold_edges = 3,
     .duplicates = 1, .genus = -1, .meets_itself = true},
    {"coincident_cubes", coincident_cubes, .components = 1, .nonmanifold_edges = 18,
     .contact_edges = 18, .duplicates = 12, .genus = -1, .meets_itself = true},
    {"fin", fin, .components = 1, .open_edges = 2, .border_loops = 1, .nonmanifold_edges = 1,
     .genus = -1},
    {"shared_edge", shared_edge, .components = 1, .nonmanifold_edges = 1, .contact_edges = 1,
     .genus = -1},
    {"bow_tie", bow_tie, .components = 1, .nonmanifold_vertices = 1, .contact_vertices = 1,
     .genus = -1},
    {"crossed_bars", crossed_bars, .components = 2, .meets_itself = true},
    {"touching_faces", touching_faces, .components = 2, .meets_itself = true},
    {"touching_tip", touching_tip, .components = 2, .meets_itself = true},
    {"spike", spike, .components = 1, .meets_itself = true},
    {"folded", folded, .components = 1, .open_edges = 4, .border_loops = 1,
     .meets_itself = true},
    {"needles", needles, .components = 1, .needles = 8},
    {"cap", cap, .components = 1, .caps = 1},
    {"flat_split", flat_split, .components = 1, .degenerate = 1, .meets_itself = true},
    {"zero_band", zero_band, .components = 1, .degenerate = 24},
};
const size_t test_planted_count = sizeof test_planted_meshes / sizeof *test_planted_meshes;

cw_mesh test_plant(const test_planted *row)
{
    test_builder *b = calloc(1, sizeof *b);
    assert_non_null(b);
    row->build(b);
    cw_mesh mesh = {.vertex_count = b->points_used, .triangle_count = b->triangles_used};
    mesh.positions = malloc(3 * sizeof *mesh.positions * b->points_used);
    mesh.triangles = malloc(3 * sizeof *mesh.triangles * b->triangles_used);
    assert_true(mesh.positions && mesh.triangles);
    for (uint32_t n = 0; n < 3 * b->points_used; n++)
        mesh.positions[n] = b->points[n];
    for (uint32_t n = 0; n < 3 * b->triangles_used; n++)
        mesh.triangles[n] = b->corners[n];
    free(b);
    return mesh;
}
