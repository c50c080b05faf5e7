/* Level sets of meshes: that they lead back to the mesh, and what is made from them. */
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/base/sandbox.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static cw_mesh surface_of(cw_field field, size_t n)
{
    cw_volume volume = test_sample(field, n, CW_F32);
    cw_mesh mesh =
        test_extract(&volume, &(cw_extract_desc){.isovalue = cw_field_isovalue(field)}, NULL);
    cw_volume_free(&volume);
    return mesh;
}

/* A cube with sides of `side` millimetres. */
static cw_mesh make_cube(float side)
{
    cw_mesh mesh = {0};
    test_make_cube(&mesh);
    for (size_t i = 0; i < 3 * mesh.vertex_count; i++)
        mesh.positions[i] *= side;
    return mesh;
}

static cw_mesh offset(const cw_mesh *mesh, double by, double voxel)
{
    cw_mesh out;
    cw_offset_facts facts;
    cw_error err = {0};
    const cw_offset_desc desc = {.offset_mm = by, .voxel_mm = voxel};
    assert_ok(cw_mesh_offset(mesh, &desc, &out, &facts, &err), err);
    assert_true(voxel == 0 || facts.voxel_mm == voxel ||
                (by == 0 && facts.voxel_mm == voxel / 2));
    assert_false(facts.is_astray);
    const cw_quality q = test_measure(&out); /* not as STL would have it, far from zero */
    assert_true(cw_quality_is_closed_manifold(&q) && q.volume_mm3 > 0 && !q.degenerate);
    return out;
}

static cw_mesh hollow(const cw_mesh *mesh, const cw_hollow_desc *desc, cw_hollow_facts *facts)
{
    cw_mesh out;
    cw_error err = {0};
    assert_ok(cw_mesh_hollow(mesh, desc, &out, facts, &err), err);
    test_check_promise(&out, false);
    return out;
}

/* The largest distance of a point of one mesh from the other. */
static double farthest(const cw_mesh *a, const cw_mesh *b)
{
    cw_distance d;
    cw_error err = {0};
    assert_ok(cw_distance_to_mesh(a, b, NULL, &d, NULL, &err), err);
    return d.max_mm;
}

/* --- there and back ----------------------------------------------------------------------- */

static void a_mesh_comes_back_within_half_a_voxel(void **state)
{
    (void)state;
    static const struct {
        cw_field field;
        size_t dim;
        double voxel, there, back; /* in voxels; the last has sharp edges, where it is cut */
    } rows[] = {{CW_FIELD_SPHERE, 32, 2.6, 0.5, 0.5},
                {CW_FIELD_TORUS, 32, 1.8, 0.5, 0.5},
                {CW_FIELD_GYROID, 20, 1.7, 0.5, 0.5}};
    for (size_t n = 0; n < (size_t)test_some(3); n++) {
        const double voxel = rows[n].voxel;
        cw_mesh mesh = surface_of(rows[n].field, rows[n].dim), back = offset(&mesh, 0, voxel);
        const cw_quality before = test_measure(&mesh), after = test_measure(&back);
        assert_true(farthest(&back, &mesh) <= rows[n].there * voxel);
        assert_true(farthest(&mesh, &back) <= rows[n].back * voxel);
        assert_int_equal(before.euler, after.euler);
        assert_int_equal(before.components, after.components);
        cw_mesh_free(&back);
        cw_mesh_free(&mesh);
    }
}

/* The loss of a cube at its edges and corners, whatever the place of the samples. */
static void edges_lose_no_more_than_is_said(void **state)
{
    (void)state;
    double most = 0;
    for (double voxel = 0.5; voxel < 1; voxel += 0.07) {
        const cw_offset_desc desc = {.voxel_mm = voxel, .no_sharpen = true};
        cw_mesh cube = make_cube(20), back;
        cw_error err = {0};
        assert_ok(cw_mesh_offset(&cube, &desc, &back, NULL, &err), err);
        assert_true(farthest(&back, &cube) <= 0.5 * voxel);
        most = fmax(most, farthest(&cube, &back) / voxel);
        cw_mesh_free(&back);
        cw_mesh_free(&cube);
    }
    assert_true(most > 0.7 && most <= 1.16);
}

/* A cube turned by some angle about an axis. */
static cw_mesh make_turned_cube(float side, double angle, const double axis[3])
{
    const double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    const double n[3] = {axis[0] / length, axis[1] / length, axis[2] / length};
    cw_mesh m = make_cube(side);
    for (size_t v = 0; v < m.vertex_count; v++) {
        float *p = m.positions + 3 * v;
        const double x[3] = {(double)p[0], (double)p[1], (double)p[2]};
        const double along = n[0] * x[0] + n[1] * x[1] + n[2] * x[2];
        for (int a = 0; a < 3; a++) {
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            p[a] = (float)(x[a] * cos(angle) + (n[b] * x[c] - n[c] * x[b]) * sin(angle) +
                           n[a] * along * (1 - cos(angle)));
        }
    }
    return m;
}

/* Within half a voxel of the cube, and the cube of them. By the root of the
 * mean square at most a quarter is lost of what is without. */
static void edges_and_corners_come_back(void **state)
{
    (void)state;
    for (int n = test_is_short() ? 7 : 0; n < 16; n += test_is_short() ? 8 : 1) {
        const double voxel = 0.5 + 0.07 * (n % 8);
        cw_mesh cube = n < 8 ? make_cube(12)
                             : make_turned_cube(12, 0.2 * n, (const double[]){1, 0.3 * n, 2}),
                back = offset(&cube, 0, voxel), blunt;
        const cw_offset_desc desc = {.voxel_mm = voxel, .no_sharpen = true};
        cw_distance sharp_off, blunt_off;
        cw_error err = {0};
        assert_ok(cw_mesh_offset(&cube, &desc, &blunt, NULL, &err), err);
        assert_ok(cw_distance_to_mesh(&cube, &back, NULL, &sharp_off, NULL, &err), err);
        assert_ok(cw_distance_to_mesh(&cube, &blunt, NULL, &blunt_off, NULL, &err), err);
        assert_true(sharp_off.max_mm <= 0.5 * voxel && farthest(&back, &cube) <= 0.5 * voxel);
        assert_true(sharp_off.rms_mm <= 0.25 * blunt_off.rms_mm);
        test_check_promise(&back, false);
        cw_mesh_free(&blunt);
        cw_mesh_free(&back);
        cw_mesh_free(&cube);
    }
}

/* Inward a cube stays one. */
static void an_offset_inward_has_edges(void **state)
{
    (void)state;
    cw_mesh cube = make_cube(20), in = offset(&cube, -3, 0.7), truth = make_cube(14);
    for (size_t i = 0; i < 3 * truth.vertex_count; i++)
        truth.positions[i] += 3;
    assert_true(farthest(&truth, &in) <= 0.35 && farthest(&in, &truth) <= 0.35);
    cw_mesh_free(&truth);
    cw_mesh_free(&in);
    cw_mesh_free(&cube);
}

/* The first mesh is kept; every other is the same, and freed. */
static void keep_or_compare(cw_mesh *first, cw_mesh *out)
{
    if (!first->triangle_count) {
        *first = *out;
        return;
    }
    test_assert_same_mesh(first, out);
    cw_mesh_free(out);
}

static void edges_are_the_same_for_any_number_of_threads(void **state)
{
    (void)state;
    cw_mesh cube = make_turned_cube(20, 1, (const double[]){1, 2, 3}), first = {0}, out;
    cw_error err = {0};
    for (int threads = 1; threads <= 3; threads++) {
        const cw_offset_desc desc = {.voxel_mm = 0.7, .threads = threads};
        assert_ok(cw_mesh_offset(&cube, &desc, &out, NULL, &err), err);
        keep_or_compare(&first, &out);
    }
    cw_mesh_free(&first);
    cw_mesh_free(&cube);
}

static double value_at(const cw_volume *v, const uint32_t leaf[3], size_t in_leaf, size_t n,
                       double p[3])
{
    const size_t in[3] = {in_leaf % 8, in_leaf / 8 % 8, in_leaf / 64};
    for (int a = 0; a < 3; a++)
        p[a] = v->affine[a][a] * (double)(8 * leaf[a] + in[a]) + v->affine[a][3];
    return (double)((const float *)v->data)[512 * n + in_leaf];
}

/* Of a cube the distance is known on paper, everywhere. */
static double cube_distance(const double p[3], double side)
{
    double out[3], inside = -INFINITY, square = 0;
    for (int a = 0; a < 3; a++) {
        out[a] = fabs(p[a] - side / 2) - side / 2;
        inside = fmax(inside, out[a]);
        square += out[a] > 0 ? out[a] * out[a] : 0;
    }
    return inside < 0 ? inside : sqrt(square);
}

static void distances_are_those_from_the_mesh(void **state)
{
    (void)state;
    cw_mesh cube = make_cube(20);
    cw_volume v;
    cw_error err = {0};
    const cw_level_set_desc desc = {.voxel_mm = 0.5, .inside_mm = 4, .outside_mm = 3};
    assert_ok(cw_level_set_from_mesh(&cube, &desc, &v, &err), err);
    assert_int_equal(v.known, CW_KNOWN_UNIT | CW_KNOWN_LEVEL_SET);
    assert_true(v.sparse->background == 3 && v.sparse->tile_count > 0);
    for (size_t n = 0; n < v.sparse->leaf_count; n++)
        for (size_t in_leaf = 0; in_leaf < 512; in_leaf++) {
            double p[3];
            const double value = value_at(&v, v.sparse->leaves[n], in_leaf, n, p);
            assert_near(value, fmax(-4, fmin(3, cube_distance(p, 20))), 1e-4);
        }
    for (size_t n = 0; n < v.sparse->tile_count; n++)
        assert_true(v.sparse->tiles[n].value == -4);
    cw_volume_free(&v);
    cw_mesh_free(&cube);
}

/* A hollow shape stays hollow on the inside, too. */
static void cavities_stay(void **state)
{
    (void)state;
    const double voxel = 2;
    cw_mesh ball = surface_of(CW_FIELD_SPHERE, 32);
    cw_mesh shell = hollow(&ball, &(cw_hollow_desc){.wall_mm = 6, .voxel_mm = voxel}, NULL);
    cw_mesh back = offset(&shell, 0, voxel), thinner = offset(&shell, -1, voxel / 2);
    assert_int_equal(test_measure(&back).components, 2);
    assert_true(farthest(&back, &shell) < 0.5 * voxel && farthest(&shell, &back) < 0.5 * voxel);
    const double outer = 4 / 3.0 * PI * 29 * 29 * 29, inner = 4 / 3.0 * PI * 25 * 25 * 25;
    assert_within(test_measure(&thinner).volume_mm3, outer - inner, 0.01);
    cw_mesh_free(&thinner);
    cw_mesh_free(&back);
    cw_mesh_free(&shell);
    cw_mesh_free(&ball);
}

/* Where a mesh crosses itself, inside is what is inside of any part. */
static void what_overlaps_becomes_one(void **state)
{
    (void)state;
    cw_mesh ball = surface_of(CW_FIELD_SPHERE, 32), pair = ball;
    const size_t v = ball.vertex_count, t = ball.triangle_count;
    float *positions = pair.positions = malloc(6 * v * sizeof *positions);
    uint32_t *triangles = pair.triangles = malloc(6 * t * sizeof *triangles);
    assert_true(positions && triangles);
    pair.normals = NULL;
    pair.vertex_count = 2 * v;
    pair.triangle_count = 2 * t;
    for (size_t i = 0; i < 3 * v; i++) {
        positions[i] = ball.positions[i];
        positions[3 * v + i] = ball.positions[i] + (i % 3 == 0 ? 30 : 0);
    }
    for (size_t i = 0; i < 3 * t; i++) {
        triangles[i] = ball.triangles[i];
        triangles[3 * t + i] = ball.triangles[i] + (uint32_t)v;
    }
    cw_mesh one = offset(&pair, 0, test_is_short() ? 2 : 1);
    const cw_quality q = test_measure(&one);
    assert_int_equal(q.components, 1);
    assert_int_equal(q.euler, 2);
    /* two balls of radius 30, 30 apart, less the lens that is in both */
    assert_within(q.volume_mm3, PI * 27000 * (8 / 3.0 - 5 / 12.0), 0.01);
    cw_mesh_free(&one);
    cw_mesh_free(&ball);
    free(positions);
    free(triangles);
}

/* --- offsets ------------------------------------------------------------------------------ */

static void a_sphere_becomes_a_larger_or_smaller_one(void **state)
{
    (void)state;
    static const double rows[] = {4, 0.4, -0.4, -12};
    cw_mesh ball = surface_of(CW_FIELD_SPHERE, 64);
    for (int n = 0; n < 4; n += test_is_short() ? 3 : 1) {
        cw_mesh out = offset(&ball, rows[n], 2);
        for (size_t v = 0; v < out.vertex_count; v++) {
            const float *p = out.positions + 3 * v;
            const double x = (double)p[0] + out.origin[0], y = (double)p[1] + out.origin[1],
                         z = (double)p[2] + out.origin[2];
            assert_near(sqrt(x * x + y * y + z * z), 30 + rows[n], 0.25);
        }
        assert_int_equal(test_measure(&out).euler, 2);
        cw_mesh_free(&out);
    }
    cw_mesh_free(&ball);
}

/* Outward its edges become round, inward they stay. */
static void a_cube_becomes_a_round_box(void **state)
{
    (void)state;
    const double s = 20, r = 3, voxel = test_is_short() ? 0.4 : 0.3;
    cw_mesh cube = make_cube(20), out = offset(&cube, r, voxel), in = offset(&cube, -r, voxel);
    const double round =
        s * s * s + 6 * s * s * r + 3 * PI * s * r * r + 4 / 3.0 * PI * r * r * r;
    assert_within(test_measure(&out).volume_mm3, round, 0.002);
    assert_within(test_measure(&in).volume_mm3, pow(s - 2 * r, 3), 0.005);
    cw_mesh_free(&in);
    cw_mesh_free(&out);
    cw_mesh_free(&cube);
}

static void far_from_zero_nothing_changes(void **state)
{
    (void)state;
    cw_mesh ball = surface_of(CW_FIELD_SPHERE, 32), far = ball;
    for (int a = 0; a < 3; a++)
        far.origin[a] += 1e6;
    const double voxel = test_is_short() ? 2 : 1;
    cw_mesh near_out = offset(&ball, 2, voxel), far_out = offset(&far, 2, voxel);
    assert_int_equal(near_out.vertex_count, far_out.vertex_count);
    for (int a = 0; a < 3; a++)
        assert_near(far_out.origin[a] - near_out.origin[a], 1e6, 1e-6);
    for (size_t i = 0; i < 3 * far_out.vertex_count; i++)
        assert_near((double)far_out.positions[i], (double)near_out.positions[i], 1e-4);
    cw_mesh_free(&far_out);
    cw_mesh_free(&near_out);
    cw_mesh_free(&ball);
}

/* --- hollowing ---------------------------------------------------------------------------- */

static void a_sphere_gets_a_wall(void **state)
{
    (void)state;
    cw_mesh ball = surface_of(CW_FIELD_SPHERE, 40);
    const double wall = 4;
    cw_hollow_facts facts;
    cw_mesh out = hollow(&ball, &(cw_hollow_desc){.wall_mm = wall}, &facts);
    const cw_quality q = test_measure(&out);
    assert_true(facts.voxel_mm == wall / 4 && facts.cavities == 1 && facts.sealed == 1);
    assert_int_equal(q.components, 2);
    assert_memory_equal(out.positions, ball.positions,
                        3 * ball.vertex_count * sizeof *ball.positions);
    assert_memory_equal(out.normals, ball.normals,
                        3 * ball.vertex_count * sizeof *ball.normals);
    assert_memory_equal(out.triangles, ball.triangles,
                        3 * ball.triangle_count * sizeof *ball.triangles);
    assert_near(facts.wall_min_mm, wall, 0.25);
    assert_near(facts.wall_max_mm, wall, 0.25);
    assert_within(facts.removed_mm3, 4 / 3.0 * PI * pow(30 - wall, 3), 0.005);
    assert_true(test_normals_agree(&out));
    assert_int_equal(test_count_crossings(&out), 0);
    cw_mesh_free(&out);
    cw_mesh_free(&ball);
}

/* A mesh's points may be counted from anywhere: walls stay where they are. */
static void a_mesh_far_from_zero_gets_the_same_wall(void **state)
{
    (void)state;
    cw_mesh ball = surface_of(CW_FIELD_SPHERE, 24);
    const cw_hollow_desc desc = {.wall_mm = 8, .voxel_mm = 4, .no_measure = true};
    for (int a = 0; a < 3; a++)
        ball.origin[a] = 1000 * (a + 1);
    cw_mesh out = hollow(&ball, &desc, NULL);
    double low[3], high[3], outer[2][3];
    assert_int_equal(test_measure(&out).components, 2);
    assert_true(cw_mesh_bounds(&ball, outer[0], outer[1]));
    out.positions += 3 * ball.vertex_count; /* the cavity's alone */
    out.vertex_count -= ball.vertex_count;
    assert_true(cw_mesh_bounds(&out, low, high));
    for (int a = 0; a < 3; a++) {
        assert_near(low[a] - outer[0][a], 8, 1);
        assert_near(outer[1][a] - high[a], 8, 1);
    }
    out.positions -= 3 * ball.vertex_count;
    cw_mesh_free(&out);
    cw_mesh_free(&ball);
}

/* How often a line along z, through x and y, meets a mesh. */
static int meets(const cw_mesh *m, double x, double y)
{
    int count = 0;
    for (size_t t = 0; t < m->triangle_count; t++) {
        double p[3][2];
        bool left = true, right = true;
        for (size_t c = 0; c < 3; c++)
            for (size_t a = 0; a < 2; a++)
                p[c][a] = (double)m->positions[3 * (size_t)m->triangles[3 * t + c] + a] +
                          m->origin[a];
        for (int c = 0; c < 3; c++) {
            const double *a = p[c], *b = p[(c + 1) % 3];
            const double side = (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
            left = left && side > 0;
            right = right && side < 0;
        }
        count += left || right;
    }
    return count;
}

static void a_drain_opens_the_cavity_where_it_should(void **state)
{
    (void)state;
    const double scale = 2, wall = 2 * scale;
    const cw_drain down = {4 * scale, {0, 0, -1}}, both[] = {down, {6 * scale, {0, 0, 9}}};
    cw_mesh ball = surface_of(CW_FIELD_SPHERE, 32);
    cw_hollow_facts facts;
    cw_mesh one = hollow(
        &ball, &(cw_hollow_desc){.wall_mm = wall, .drains = &down, .drain_count = 1}, &facts);
    assert_true(facts.cavities == 1 && facts.sealed == 0);
    assert_near(facts.wall_min_mm, wall, 0.25);
    assert_int_equal(test_measure(&one).components, 1);
    assert_int_equal(test_measure(&one).euler,
                     2); /* a ball's skin, and another, joined: a disc */
    assert_int_equal(meets(&one, 0.01, 0.02), 2); /* the top only */
    assert_int_equal(meets(&one, 2.5 * scale, 2.5 * scale), 4);
    cw_mesh two = hollow(
        &ball, &(cw_hollow_desc){.wall_mm = wall, .drains = both, .drain_count = 2}, &facts);
    assert_int_equal(test_measure(&two).components, 1);
    assert_int_equal(test_measure(&two).euler, 0);
    assert_int_equal(meets(&two, 0.01, 0.02), 0);
    assert_int_equal(meets(&two, 1.7 * scale, 1.7 * scale), 2);
    cw_mesh_free(&two);
    cw_mesh_free(&one);
    cw_mesh_free(&ball);
}

/* A cube's corners stay, and the rim of a drain is a regular polygon of 64 corners in the cube's floor. */
static void a_drain_is_round_and_leaves_the_rest(void **state)
{
    (void)state;
    const cw_drain drain = {6, {0, 0, -2}};
    cw_mesh cube;
    test_make_cube(&cube);
    for (size_t c = 0; c < 3 * cube.vertex_count; c++)
        cube.positions[c] = 40 * cube.positions[c] - 20;
    const cw_hollow_desc desc = {.wall_mm = 4, .drains = &drain, .drain_count = 1};
    cw_mesh out = hollow(&cube, &desc, NULL);
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    size_t corners = 0, rim = 0;
    for (int pass = 0; pass < 2; pass++)
        for (size_t v = 0; v < out.vertex_count; v++) {
            const float *p = out.positions + 3 * v;
            if (pass == 0 && fabsf(p[0]) == 20 && fabsf(p[1]) == 20 && fabsf(p[2]) == 20)
                corners++;
            if (p[2] != -20 || fabsf(p[0]) > 19)
                continue;
            for (int a = 0; a < 2 && pass == 0; a++) {
                low[a] = fmin(low[a], (double)p[a]);
                high[a] = fmax(high[a], (double)p[a]);
            }
            const double radius = hypot((double)p[0] - (low[0] + high[0]) / 2,
                                        (double)p[1] - (low[1] + high[1]) / 2);
            if (pass == 1)
                assert_true(radius > 3 * cos(PI / 64) - 1e-5 && radius < 3 + 1e-5);
            rim += pass == 1;
        }
    assert_true(corners == 8 && rim >= 64);
    assert_int_equal(out.attribute_count, 0);
    assert_int_equal(test_count_crossings(&out), 0);
    cw_mesh_free(&out);
    cw_mesh_free(&cube);
}

/* A floor that leans by less than a voxel is flat: the drain is in its middle, not at the side
 * that is a little lower. */
static void a_flat_floor_is_drained_in_its_middle(void **state)
{
    (void)state;
    const cw_drain down = {4, {0, 0, -1}};
    cw_mesh cube;
    test_make_cube(&cube);
    for (size_t v = 0; v < cube.vertex_count; v++) {
        float *p = cube.positions + 3 * v;
        for (int a = 0; a < 3; a++)
            p[a] = 30 * p[a] - 15;
        p[2] += 0.015f * p[0];
    }
    const cw_hollow_desc desc = {
        .wall_mm = 3, .drains = &down, .drain_count = 1, .no_measure = true};
    cw_mesh out = hollow(&cube, &desc, NULL);
    assert_int_equal(meets(&out, 0.01, 0.02), 2); /* the top only */
    assert_int_equal(meets(&out, 9.01, 0.02), 4);
    assert_int_equal(meets(&out, -9.01, 0.02), 4);
    cw_mesh_free(&out);
    cw_mesh_free(&cube);
}

/* Two cubes, of which a drain opens the larger one. */
static void cavities_that_stay_sealed_are_counted(void **state)
{
    (void)state;
    cw_mesh cube = make_cube(10), pair = cube;
    float positions[48];
    uint32_t triangles[72];
    assert_true(cube.vertex_count == 8 && cube.triangle_count == 12);
    pair.positions = positions;
    pair.triangles = triangles;
    pair.normals = NULL;
    pair.vertex_count = 16;
    pair.triangle_count = 24;
    for (size_t i = 0; i < 24; i++) {
        positions[i] = cube.positions[i];
        positions[24 + i] = 2 * cube.positions[i] + (i % 3 == 0 ? 15 : -5);
    }
    for (size_t i = 0; i < 36; i++) {
        triangles[i] = cube.triangles[i];
        triangles[36 + i] = cube.triangles[i] + 8;
    }
    const cw_drain drains[] = {{2, {0, 1, 0}}, {2, {-1, 0, 0}}};
    cw_hollow_desc desc = {.wall_mm = 1,
                           .voxel_mm = test_is_short() ? 0.5 : 0,
                           .drains = drains,
                           .drain_count = 1};
    cw_hollow_facts facts;
    cw_mesh out = hollow(&pair, &desc, &facts);
    assert_true(facts.cavities == 2 && facts.sealed == 1);
    assert_int_equal(test_measure(&out).components, 3);
    cw_mesh_free(&out);
    desc.drain_count = 2; /* the second goes through the other cube */
    out = hollow(&pair, &desc, &facts);
    assert_true(facts.cavities == 2 && facts.sealed == 0);
    assert_int_equal(test_measure(&out).components, 2);
    cw_mesh_free(&out);
    cw_mesh_free(&cube);
}

/* --- threads, limits, errors -------------------------------------------------------------- */

static void threads_change_nothing(void **state)
{
    (void)state;
    static const cw_drain down = {8, {1, 2, -3}};
    cw_mesh mesh = surface_of(CW_FIELD_TORUS, 32), first = {0}, out;
    cw_error err = {0};
    for (int threads = 1; threads <= 4; threads += test_is_short() ? 2 : 1) {
        const cw_hollow_desc desc = {.wall_mm = 3,
                                     .voxel_mm = test_is_short() ? 1.5 : 1,
                                     .drains = &down,
                                     .drain_count = 1,
                                     .threads = threads};
        assert_ok(cw_mesh_hollow(&mesh, &desc, &out, NULL, &err), err);
        keep_or_compare(&first, &out);
    }
    cw_mesh_free(&first);
    cw_mesh_free(&mesh);
}

static void what_makes_no_sense_is_refused(void **state)
{
    (void)state;
    static const cw_drain narrow = {0.1, {0, 0, 1}}, nowhere = {3, {0, 0, 0}};
    const struct {
        cw_hollow_desc desc;
        cw_status status;
        const char *words;
    } rows[] = {
        {{.wall_mm = 0}, CW_ERR_ARGUMENT, "a wall of 0 mm"},
        {{.wall_mm = -1}, CW_ERR_ARGUMENT, "a wall of -1 mm"},
        {{.wall_mm = NAN}, CW_ERR_ARGUMENT, "a wall of nan mm"},
        {{.wall_mm = 1, .voxel_mm = -1}, CW_ERR_ARGUMENT, "voxels of -1 mm"},
        {{.wall_mm = 1, .voxel_mm = 0.6}, CW_ERR_ARGUMENT, "too large for a wall of 1 mm"},
        {{.wall_mm = 1, .voxel_mm = 0.5, .drains = &narrow, .drain_count = 1},
         CW_ERR_ARGUMENT,
         "too large for a drain of 0.1 mm"},
        {{.wall_mm = 1, .drains = &nowhere, .drain_count = 1},
         CW_ERR_ARGUMENT,
         "a direction of length 0"},
        {{.wall_mm = 60}, CW_ERR_EMPTY, "leaves no cavity"},
        {{.wall_mm = 0.02, .max_bytes = 100000000}, CW_ERR_LIMIT, "mm would do"},
        {{.wall_mm = 1e-5}, CW_ERR_LIMIT, "more than 65535 along an axis"},
    };
    cw_mesh ball = surface_of(CW_FIELD_SPHERE, 32), out;
    cw_error err = {0};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        assert_fails(cw_mesh_hollow(&ball, &rows[n].desc, &out, NULL, &err), rows[n].status,
                     rows[n].words, err);
        assert_null(out.positions);
    }
    assert_fails(cw_mesh_offset(&ball, &(cw_offset_desc){.offset_mm = -40, .voxel_mm = 2}, &out,
                                NULL, &err),
                 CW_ERR_EMPTY, "no point is 40 mm inside", err);
    assert_fails(
        cw_mesh_offset(&ball, &(cw_offset_desc){.offset_mm = INFINITY}, &out, NULL, &err),
        CW_ERR_ARGUMENT, "finite", err);
    cw_volume volume;
    assert_fails(cw_level_set_from_mesh(&ball, &(cw_level_set_desc){0}, &volume, &err),
                 CW_ERR_ARGUMENT, "more than 0 mm", err);
    cw_mesh_free(&ball);
}

static void meshes_that_enclose_nothing_are_refused(void **state)
{
    (void)state;
    cw_mesh cube = make_cube(10), out;
    cw_error err = {0};
    const cw_offset_desc desc = {.offset_mm = 1};
    cube.triangle_count = 11;
    assert_fails(cw_mesh_offset(&cube, &desc, &out, NULL, &err), CW_ERR_ARGUMENT,
                 "3 open edges", err);
    cube.triangle_count = 0;
    assert_fails(cw_mesh_offset(&cube, &desc, &out, NULL, &err), CW_ERR_ARGUMENT,
                 "no triangles", err);
    cube.triangle_count = 12;
    for (size_t t = 0; t < 12; t++) {
        const uint32_t swap = cube.triangles[3 * t];
        cube.triangles[3 * t] = cube.triangles[3 * t + 1];
        cube.triangles[3 * t + 1] = swap;
        if (t == 0)
            assert_fails(cw_mesh_offset(&cube, &desc, &out, NULL, &err), CW_ERR_ARGUMENT,
                         "3 between triangles that face opposite ways", err);
    }
    assert_fails(cw_mesh_offset(&cube, &desc, &out, NULL, &err), CW_ERR_ARGUMENT,
                 "faces inward", err);
    cw_mesh_free(&cube);
}

static void it_can_be_stopped(void **state)
{
    (void)state;
    static const cw_drain down = {4, {0, 0, -1}};
    cw_mesh ball = surface_of(CW_FIELD_SPHERE, 32), out;
    cw_error err = {0};
    for (int n = 0, st = CW_ERR_CANCELLED; st != CW_OK; n = 2 * n + 1) {
        int polls = n;
        const cw_hollow_desc desc = {.wall_mm = 2,
                                     .voxel_mm = 1,
                                     .drains = &down,
                                     .drain_count = 1,
                                     .progress = {test_stop_after, &polls}};
        st = (int)cw_mesh_hollow(&ball, &desc, &out, NULL, &err);
        assert_true(st == CW_OK || (st == CW_ERR_CANCELLED && !out.positions));
        assert_true(n > 0 || st != CW_OK);
    }
    cw_mesh_free(&out);
    cw_mesh_free(&ball);
}

static void running_out_of_memory_is_told(void **state)
{
    (void)state;
    static const cw_drain down = {20, {0, 0, -1}};
    cw_mesh ball = surface_of(CW_FIELD_SPHERE, 16), out;
    for (size_t drains = 0; drains < 2; drains++)
        for (long n = 0;; n += 1 + n / 8) {
            cw_error err = {0};
            const cw_hollow_desc desc = {.wall_mm = 8,
                                         .voxel_mm = test_is_short() ? 4 : 0,
                                         .drains = &down,
                                         .drain_count = drains,
                                         .threads = 1};
            cwi_alloc_fail_after(n);
            const cw_status st = cw_mesh_hollow(&ball, &desc, &out, NULL, &err);
            if (!cwi_alloc_fail_after(-1)) {
                assert_ok(st, err);
                cw_mesh_free(&out);
                break;
            }
            if (st == CW_OK) /* what was asked back could stay */
                cw_mesh_free(&out);
            else
                assert_fails(st, CW_ERR_NO_MEMORY, "no memory", err);
            assert_null(out.positions);
        }
    cw_mesh_free(&ball);
}

static void a_build_without_openvdb_says_so(void **state)
{
    (void)state;
    cw_mesh cube = make_cube(10), out;
    cw_error err = {0};
    assert_fails(cw_mesh_offset(&cube, &(cw_offset_desc){.offset_mm = 1}, &out, NULL, &err),
                 CW_ERR_UNSUPPORTED, "libopenvdb-dev", err);
    cw_mesh_free(&cube);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_mesh_comes_back_within_half_a_voxel),
        cmocka_unit_test(edges_lose_no_more_than_is_said),
        cmocka_unit_test(edges_and_corners_come_back),
        cmocka_unit_test(an_offset_inward_has_edges),
        cmocka_unit_test(edges_are_the_same_for_any_number_of_threads),
        cmocka_unit_test(distances_are_those_from_the_mesh),
        cmocka_unit_test(cavities_stay),
        cmocka_unit_test(what_overlaps_becomes_one),
        cmocka_unit_test(a_sphere_becomes_a_larger_or_smaller_one),
        cmocka_unit_test(a_cube_becomes_a_round_box),
        cmocka_unit_test(far_from_zero_nothing_changes),
        cmocka_unit_test(a_sphere_gets_a_wall),
        cmocka_unit_test(a_mesh_far_from_zero_gets_the_same_wall),
        cmocka_unit_test(a_drain_opens_the_cavity_where_it_should),
        cmocka_unit_test(a_drain_is_round_and_leaves_the_rest),
        cmocka_unit_test(a_flat_floor_is_drained_in_its_middle),
        cmocka_unit_test(cavities_that_stay_sealed_are_counted),
        cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(what_makes_no_sense_is_refused),
        cmocka_unit_test(meshes_that_enclose_nothing_are_refused),
        cmocka_unit_test(it_can_be_stopped),
        cmocka_unit_test(running_out_of_memory_is_told),
    };
    const struct CMUnitTest without[] = {cmocka_unit_test(a_build_without_openvdb_says_so)};
    return cw_level_set_available() ? cmocka_run_group_tests(tests, NULL, NULL)
                                    : cmocka_run_group_tests(without, NULL, NULL);
}
