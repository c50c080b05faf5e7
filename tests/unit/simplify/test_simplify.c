/* Simplification: what it must not change, and what it promises. */
#include "core/mesh/attribute_transfer.h"
#include "support/hostile.h"
#include "support/planted.h"
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/base/sandbox.h"
#include "simplify/attribute_weights.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

static cw_mesh simplify_in(const cw_mesh *mesh, const cw_simplify_desc *desc, size_t *passes)
{
    cw_mesh out;
    cw_simplify_facts facts;
    cw_error err = {0};
    assert_ok(cw_simplify(mesh, desc, &out, &facts, &err), err);
    assert_int_equal(facts.vertices, out.vertex_count);
    assert_int_equal(facts.triangles, out.triangle_count);
    assert_true(facts.passes >= 1);
    *passes = facts.passes;
    return out;
}

static cw_mesh simplify(const cw_mesh *mesh, const cw_simplify_desc *desc)
{
    size_t passes;
    return simplify_in(mesh, desc, &passes);
}

static cw_mesh reduce(const cw_mesh *mesh, double ratio)
{
    return simplify(mesh, &(cw_simplify_desc){.ratio = ratio});
}

static cw_mesh noisy_gyroid(size_t n, double noise, bool open)
{
    const cw_field_desc field = {
        .field = CW_FIELD_GYROID, .dim = {n, n, n}, .type = CW_F32, .noise = noise};
    cw_volume volume;
    cw_error err = {0};
    assert_ok(cw_field_sample(&field, &volume, &err), err);
    const cw_mesh mesh = test_extract(&volume, &(cw_extract_desc){.leave_open = open}, NULL);
    cw_volume_free(&volume);
    return mesh;
}

static cw_quality measure_shells(const cw_mesh *mesh)
{
    cw_quality q;
    cw_error err = {0};
    assert_ok(cw_quality_measure(mesh, &(cw_quality_desc){.shells = true}, &q, &err), err);
    return q;
}

/* Of small shells all of one side moves at once: it must not pass through the other. */
static void shells_face_where_they_did(void **state)
{
    (void)state;
    const cw_field_desc field = {
        .field = CW_FIELD_MARSCHNER_LOBB, .dim = {30, 30, 30}, .type = CW_F32, .noise = 0.4};
    cw_volume volume;
    cw_error err = {0};
    assert_ok(cw_field_sample(&field, &volume, &err), err);
    cw_mesh mesh = test_extract(&volume, &(cw_extract_desc){.isovalue = 0.5}, NULL);
    const cw_quality before = measure_shells(&mesh);
    const cw_simplify_desc descs[] = {{.ratio = 0.05}, {.error_mm = 0.2}};
    assert_true(before.components > 100 && before.inside_out == 0);
    for (size_t n = 0; n < 2; n++) {
        cw_mesh out = simplify(&mesh, descs + n);
        const cw_quality after = measure_shells(&out);
        assert_int_equal(after.components, before.components);
        assert_int_equal(after.cavities + after.inside_out, before.cavities);
        cw_mesh_free(&out);
    }
    cw_mesh_free(&mesh);
    cw_volume_free(&volume);
}

/* Large enough for several blocks. */
static void topology_stays(void **state)
{
    (void)state;
    static const double ratios[] = {0.3, 0.02};
    for (int n = test_is_short() ? 1 : 0; n < 2; n++) {
        cw_mesh mesh = noisy_gyroid(42, 0.1, n), out = reduce(&mesh, ratios[n]);
        assert_true(mesh.triangle_count > 1 << 15);
        test_assert_sound(&mesh, &out);
        if (n == 0)
            assert_within((double)out.triangle_count, 0.3 * (double)mesh.triangle_count, 0.01);
        cw_mesh_free(&out);
        cw_mesh_free(&mesh);
    }
}

/* Surfaces that extractors break on are no easier to simplify. */
static void hostile_surfaces_stay_sound(void **state)
{
    (void)state;
    const test_hostile *h;
    for (size_t n = 0; (h = test_hostile_at(n)); n += test_is_short() ? 5 : 1) {
        cw_volume volume;
        cw_error err = {0};
        assert_ok(test_hostile_make(h, &volume, &err), err);
        const cw_extract_desc desc = {.isovalue = h->isovalue, .leave_open = n % 2};
        cw_mesh mesh = test_extract(&volume, &desc, NULL), out = reduce(&mesh, 0.1);
        const char *fault = test_reduced_fault(&mesh, &out);
        if (fault)
            fail_msg("%s: the result %s", h->name, fault);
        cw_mesh_free(&out);
        cw_mesh_free(&mesh);
        cw_volume_free(&volume);
    }
}

/* Broken meshes are not repaired, but not made worse. */
static void broken_meshes_become_no_worse(void **state)
{
    (void)state;
    for (size_t n = 0; n < test_planted_count; n++) {
        cw_mesh mesh = test_plant(test_planted_meshes + n), out = reduce(&mesh, 0.01);
        const cw_quality a = test_measure(&mesh), b = test_measure(&out);
        if (b.nonmanifold_edges > a.nonmanifold_edges ||
            b.nonmanifold_vertices > a.nonmanifold_vertices || b.degenerate > a.degenerate ||
            b.duplicates > a.duplicates || b.components > a.components ||
            b.border_loops > a.border_loops ||
            test_count_crossings(&out) > test_count_crossings(&mesh))
            fail_msg("%s is worse than before", test_planted_meshes[n].name);
        cw_mesh_free(&out);
        cw_mesh_free(&mesh);
    }
}

/* Collapses refuse what goes too far, so the judgement afterwards finds nothing to be done
 * again. It would hide bounds that are too loose: the error is kept, by more passes and
 * triangles. */
static void no_error_is_exceeded(double noise, bool open)
{
    cw_mesh mesh = noisy_gyroid(10, noise, open);
    double low[3], high[3];
    assert_true(cw_mesh_bounds(&mesh, low, high));
    size_t before = mesh.triangle_count;
    for (double error = 0.001 * (high[0] - low[0]); error < 0.03 * (high[0] - low[0]);
         error *= 5) {
        size_t passes;
        cw_mesh out = simplify_in(&mesh, &(cw_simplify_desc){.error_mm = error}, &passes);
        assert_int_equal(passes, 1);
        test_bound_is_kept(&mesh, &out, error);
        test_bound_is_kept(&out, &mesh, error);
        test_assert_sound(&mesh, &out);
        assert_true(out.triangle_count < before);
        before = out.triangle_count;
        cw_mesh_free(&out);
    }
    cw_mesh_free(&mesh);
}

static void the_error_is_never_exceeded(void **state)
{
    (void)state;
    if (!test_is_short())
        no_error_is_exceeded(0.1, false);
    no_error_is_exceeded(0.3, false);
    no_error_is_exceeded(0.1, true);
}

/* An error and a number: what is met first ends it. */
static void what_is_met_first_ends_it(void **state)
{
    (void)state;
    cw_volume volume = test_sample(CW_FIELD_SPHERE, 32, CW_F32);
    cw_mesh mesh = test_extract(&volume, NULL, NULL);
    cw_mesh coarse = simplify(&mesh, &(cw_simplify_desc){.error_mm = 100, .triangles = 1000});
    assert_int_equal(coarse.triangle_count, 1000);
    cw_mesh fine = simplify(&mesh, &(cw_simplify_desc){.error_mm = 1e-5, .triangles = 1000});
    assert_true(fine.triangle_count > 1000);
    cw_mesh_free(&fine);
    cw_mesh_free(&coarse);
    cw_mesh_free(&mesh);
    cw_volume_free(&volume);
}

static int by_number(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

static int by_bytes(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(float[6]));
}

static void put_place(float *to, const cw_mesh *mesh, uint64_t vertex)
{
    memcpy(to, mesh->positions + 3 * vertex, 3 * sizeof *to);
}

/* Sides of one triangle only, from place to place, in an order that numbers do not change. */
static float (*border_of(const cw_mesh *mesh, size_t *count))[6]
{
    const size_t sides = 3 * mesh->triangle_count;
    uint64_t *side = malloc(sides * sizeof *side);
    float(*border)[6] = malloc(sides * sizeof *border);
    assert_true(side && border);
    for (size_t c = 0; c < sides; c++) {
        const uint64_t a = mesh->triangles[c], b = mesh->triangles[c % 3 == 2 ? c - 2 : c + 1];
        side[c] = a < b ? a << 32 | b : b << 32 | a;
    }
    qsort(side, sides, sizeof *side, by_number);
    *count = 0;
    for (size_t c = 0; c < sides; c++) {
        if ((c > 0 && side[c - 1] == side[c]) || (c + 1 < sides && side[c + 1] == side[c]))
            continue;
        float(*to)[6] = border + (*count)++;
        put_place(*to, mesh, side[c] >> 32);
        put_place(*to + 3, mesh, side[c] & UINT32_MAX);
        if (memcmp(*to, *to + 3, sizeof(float[3])) > 0) {
            put_place(*to + 3, mesh, side[c] >> 32);
            put_place(*to, mesh, side[c] & UINT32_MAX);
        }
    }
    free(side);
    qsort(border, *count, sizeof *border, by_bytes);
    return border;
}

static void assert_same_border(const cw_mesh *a, const cw_mesh *b)
{
    size_t count, other;
    float(*before)[6] = border_of(a, &count), (*after)[6] = border_of(b, &other);
    assert_true(count > 0);
    assert_int_equal(count, other);
    assert_memory_equal(before, after, count * sizeof *before);
    free(before);
    free(after);
}

/* In one block and in several, by number, error and level. */
static void a_border_can_be_kept(void **state)
{
    (void)state;
    static const cw_simplify_desc ways[] = {
        {.keep_border = true, .ratio = 0.3},
        {.keep_border = true, .ratio = 0.7, .error_mm = 0.5},
    };
    static const size_t levels[] = {20000, 15000};
    cw_mesh large = noisy_gyroid(42, 0.05, true), small = noisy_gyroid(20, 0, true), out[2];
    cw_error err = {0};
    for (int n = 0; n < 4; n += test_is_short() ? 3 : 1) {
        const cw_mesh *mesh = n % 2 ? &small : &large;
        out[0] = simplify(mesh, &ways[n / 2]);
        assert_same_border(mesh, out);
        test_assert_sound(mesh, out);
        assert_within((double)out->triangle_count,
                      ways[n / 2].ratio * (double)mesh->triangle_count, 0.01);
        cw_mesh_free(out);
    }
    assert_ok(cw_simplify_levels(&large, &(cw_simplify_desc){.keep_border = true}, levels, 2,
                                 out, NULL, &err),
              err);
    for (int n = 0; n < 2; n++) {
        assert_within((double)out[n].triangle_count, (double)levels[n], 1e-3);
        assert_same_border(&large, out + n);
        cw_mesh_free(out + n);
    }
    cw_mesh_free(&large);
    cw_mesh_free(&small);
}

/* Vertices of a simplified sphere are as near to it as those of a good approximation. */
static void a_sphere_stays_round(void **state)
{
    (void)state;
    cw_volume volume = test_sample(CW_FIELD_SPHERE, 64, CW_F32);
    cw_mesh mesh = test_extract(&volume, NULL, NULL), out = reduce(&mesh, 0.05);
    const double before = test_measure(&mesh).volume_mm3, after = test_measure(&out).volume_mm3;
    assert_within(after, before, 5e-3);
    assert_true(test_normals_agree(&out));
    cw_mesh_free(&out);
    cw_mesh_free(&mesh);
    cw_volume_free(&volume);
}

static void scale(cw_mesh *mesh, int exponent)
{
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        mesh->positions[i] = ldexpf(mesh->positions[i], exponent);
}

/* Squares of squares of such lengths are no floats. */
static void size_does_not_matter(void **state)
{
    (void)state;
    static const int exponents[] = {-60, 60};
    cw_volume volume = test_sample(CW_FIELD_SPHERE, test_is_short() ? 20 : 32, CW_F32);
    cw_mesh mesh = test_extract(&volume, NULL, NULL);
    for (int n = 0; n < 4; n += test_is_short() ? 3 : 1) {
        const int exponent = exponents[n / 2];
        cw_simplify_desc desc = {
            .ratio = 0.1, .error_mm = n % 2 ? 0.1 : 0, .normal_weight = (float)(n % 2)};
        cw_mesh plain = simplify(&mesh, &desc);
        scale(&mesh, exponent);
        desc.error_mm = ldexp(desc.error_mm, exponent);
        cw_mesh scaled = simplify(&mesh, &desc);
        scale(&mesh, -exponent);
        scale(&plain, exponent);
        test_assert_same_mesh(&plain, &scaled);
        cw_mesh_free(&plain);
        cw_mesh_free(&scaled);
    }
    cw_mesh_free(&mesh);
    cw_volume_free(&volume);
}

/* An origin is far from the mesh, here. */
static void place_does_not_matter(void **state)
{
    (void)state;
    const cw_simplify_desc desc = {.error_mm = 0.1};
    cw_volume volume = test_sample(CW_FIELD_SPHERE, test_is_short() ? 20 : 32, CW_F32);
    cw_mesh mesh = test_extract(&volume, NULL, NULL), near = simplify(&mesh, &desc);
    for (int a = 0; a < 3; a++)
        mesh.origin[a] = near.origin[a] = 12345.678 * (a + 1);
    cw_mesh far = simplify(&mesh, &desc);
    test_assert_same_mesh(&near, &far);
    cw_mesh_free(&far);
    cw_mesh_free(&near);
    cw_mesh_free(&mesh);
    cw_volume_free(&volume);
}

/* A flat square, a unit wide, with n x n squares of two triangles on it. */
static cw_mesh make_flat(uint32_t n)
{
    cw_mesh mesh = {.vertex_count = (n + 1) * (n + 1), .triangle_count = 2 * n * n};
    mesh.positions = cwi_alloc_array(3 * mesh.vertex_count, sizeof *mesh.positions);
    mesh.triangles = cwi_alloc_array(3 * mesh.triangle_count, sizeof *mesh.triangles);
    assert_true(mesh.positions && mesh.triangles);
    for (uint32_t v = 0; v < mesh.vertex_count; v++) {
        mesh.positions[3 * v] = (float)(v % (n + 1)) / (float)n;
        mesh.positions[3 * v + 1] = (float)(v / (n + 1)) / (float)n;
        mesh.positions[3 * v + 2] = 0;
    }
    uint32_t *t = mesh.triangles;
    for (uint32_t y = 0; y < n; y++)
        for (uint32_t x = 0; x < n; x++, t += 6) {
            const uint32_t v = y * (n + 1) + x;
            const uint32_t corners[6] = {v, v + 1, v + n + 2, v, v + n + 2, v + n + 1};
            memcpy(t, corners, sizeof corners);
        }
    return mesh;
}

/* Nothing is lost until two triangles are left. */
static void a_flat_square_becomes_two_triangles(void **state)
{
    (void)state;
    cw_mesh mesh = make_flat(20);
    cw_mesh out = simplify(&mesh, &(cw_simplify_desc){.triangles = 2});
    assert_int_equal(out.triangle_count, 2);
    assert_near(test_measure(&out).area_mm2, 1, 0.01);
    cw_mesh_free(&out);
    out = simplify(&mesh, &(cw_simplify_desc){.error_mm = 0.0005});
    assert_true(out.triangle_count < 20);
    assert_near(test_measure(&out).area_mm2, 1, 0.002);
    cw_mesh_free(&out);
    cw_mesh_free(&mesh);
}

/* Values on a flat mesh: in_circle() parts both sides of a circle of radius 0.3; on_cone() has
 * a dent where a cone stands. */
static double in_circle(double x, double y)
{
    return hypot(x - 0.5, y - 0.5) < 0.3 ? 1 : 0;
}

static double on_cone(double x, double y)
{
    return fmax(0, 0.3 - hypot(x - 0.5, y - 0.5));
}

static void paint(cw_mesh *mesh, double (*what)(double x, double y), const char *how)
{
    const size_t count = mesh->vertex_count;
    mesh->scalars = cwi_alloc_zeroed(count, sizeof *mesh->scalars);
    mesh->colors = cwi_alloc_zeroed(4 * count, sizeof *mesh->colors);
    mesh->normals = cwi_alloc_zeroed(3 * count, sizeof *mesh->normals);
    assert_true(mesh->scalars && mesh->colors && mesh->normals);
    for (size_t v = 0; v < count; v++) {
        const double x =
            what((double)mesh->positions[3 * v], (double)mesh->positions[3 * v + 1]);
        if (how[0] == 's')
            mesh->scalars[v] = (float)(1000 + 500 * x);
        else if (how[0] == 'c')
            mesh->colors[4 * v + 1] = (uint8_t)(20 + 200 * x);
        mesh->normals[3 * v] = how[0] == 'n' ? (float)sin(x) : 0;
        mesh->normals[3 * v + 2] = how[0] == 'n' ? (float)cos(x) : 1;
    }
}

/* The attribute in a corner, from 0 to 1. */
static double painted(const cw_mesh *mesh, size_t v, const char *how)
{
    if (how[0] == 's')
        return ((double)mesh->scalars[v] - 1000) / 500;
    return how[0] == 'c' ? (mesh->colors[4 * v + 1] - 20) / 200.0
                         : asin((double)mesh->normals[3 * v]);
}

/* The barycentric weight of a corner at a point of a flat triangle. */
static double weight_in(const float *p0, const float *b, const float *c, const float *a)
{
    const double u = (double)(b[0] - p0[0]), v = (double)(b[1] - p0[1]),
                 w = (double)(c[0] - p0[0]), z = (double)(c[1] - p0[1]);
    const double all = (double)(b[0] - a[0]) * (double)(c[1] - a[1]) -
                       (double)(b[1] - a[1]) * (double)(c[0] - a[0]);
    return (u * z - v * w) / all;
}

/* The root of the mean square of what a result is off in the vertices of the original. */
static double painted_wrong(const cw_mesh *mesh, const cw_mesh *out, const char *how)
{
    double sum = 0;
    size_t seen = 0;
    const size_t step = test_is_short() ? 7 : 1;
    for (size_t v = 0; v < mesh->vertex_count; v += step) {
        const float *p0 = mesh->positions + 3 * v;
        for (size_t t = 0; t < out->triangle_count; t++) {
            const uint32_t *c = out->triangles + 3 * t;
            const float *p[3];
            double at = 0;
            bool inside = true;
            for (int k = 0; k < 3; k++)
                p[k] = out->positions + 3 * (size_t)c[k];
            for (int k = 0; k < 3 && inside; k++) {
                const double weight = weight_in(p0, p[(k + 1) % 3], p[(k + 2) % 3], p[k]);
                inside = weight >= -1e-4;
                at += weight * painted(out, c[k], how);
            }
            if (!inside)
                continue;
            sum += pow(at - painted(mesh, v, how), 2);
            seen++;
            break;
        }
    }
    assert_true(step * seen > 0.9 * (double)mesh->vertex_count);
    return sqrt(sum / (double)seen);
}

/* A flat mesh has nothing to lose but what is painted on it. */
static void what_has_a_weight_stays_sharp(void **state)
{
    (void)state;
    static const struct {
        uint32_t edge;
        const char *how;
        double (*what)(double x, double y);
        double times;
        cw_simplify_desc desc;
    } rows[] = {
        {60, "scalar", in_circle, 10, {.scalar_weight = 1}},
        {60, "scalar", on_cone, 2, {.scalar_weight = 1}},
        {60, "color", in_circle, 10, {.color_weight = 1}},
        {60, "normal", in_circle, 10, {.normal_weight = 1}},
        {140, "scalar", in_circle, 10, {.scalar_weight = 1}}, /* of several blocks */
    };
    for (size_t n = test_is_short() ? 2 : 0; n < sizeof rows / sizeof *rows; n++) {
        cw_mesh mesh = make_flat(rows[n].edge);
        paint(&mesh, rows[n].what, rows[n].how);
        cw_simplify_desc desc = rows[n].desc;
        cw_mesh without = simplify(&mesh, &(cw_simplify_desc){.ratio = 0.1});
        desc.triangles = without.triangle_count;
        cw_mesh with = simplify(&mesh, &desc);
        const double sharp = painted_wrong(&mesh, &with, rows[n].how),
                     dull = painted_wrong(&mesh, &without, rows[n].how);
        if (!(sharp * rows[n].times < dull))
            fail_msg("%s of row %zu is off by %g, and by %g without a weight", rows[n].how, n,
                     sharp, dull);
        test_assert_sound(&mesh, &with);
        assert_within((double)with.triangle_count, (double)without.triangle_count, 2e-3);
        cw_mesh_free(&with);
        cw_mesh_free(&without);
        cw_mesh_free(&mesh);
    }
}

/* The least closed surface is a tetrahedron. */
static void nothing_vanishes(void **state)
{
    (void)state;
    cw_mesh cube = {0}, empty = {0};
    test_make_cube(&cube);
    cw_mesh out = simplify(&cube, &(cw_simplify_desc){.triangles = 1});
    assert_true(out.triangle_count >= 4);
    test_assert_sound(&cube, &out);
    cw_mesh_free(&out);
    cw_mesh_free(&cube);
    out = simplify(&empty, &(cw_simplify_desc){.error_mm = 1});
    assert_int_equal(out.triangle_count, 0);
    cw_mesh_free(&out);
}

static void threads_change_nothing(void **state)
{
    (void)state;
    cw_mesh mesh = noisy_gyroid(42, 0.1, false);
    for (int kind = test_is_short() ? 1 : 0; kind < 3; kind += test_is_short() ? 2 : 1) {
        cw_simplify_desc desc = {.threads = 1, .ratio = kind == 1 ? 0.6 : 0.2};
        desc.error_mm = kind == 1 ? 0.5 : 0;
        desc.normal_weight = kind == 2 ? 0.5f : 0;
        cw_mesh one = simplify(&mesh, &desc);
        desc.threads = 3;
        cw_mesh three = simplify(&mesh, &desc);
        test_assert_same_mesh(&one, &three);
        cw_mesh_free(&one);
        cw_mesh_free(&three);
    }
    cw_mesh_free(&mesh);
}

/* Large enough for its seams to be cut into blocks once more, with a border, and what normals
 * cost going along. */
static void seams_of_many_blocks_are_sound(void **state)
{
    (void)state;
    cw_mesh mesh = noisy_gyroid(88, 0.1, true);
    cw_simplify_desc desc = {.threads = 1, .ratio = 0.1, .normal_weight = 0.5f};
    cw_mesh one = simplify(&mesh, &desc);
    desc.threads = 3;
    cw_mesh three = simplify(&mesh, &desc);
    test_assert_same_mesh(&one, &three);
    test_assert_sound(&mesh, &one);
    assert_within((double)one.triangle_count, 0.1 * (double)mesh.triangle_count, 0.001);
    cw_mesh_free(&one);
    cw_mesh_free(&three);
    cw_mesh_free(&mesh);
}

/* The same within an error: seams in blocks that are cut elsewhere, and then the rest. */
static void seams_keep_the_error(void **state)
{
    (void)state;
    cw_mesh mesh = noisy_gyroid(44, 0.05, true);
    cw_simplify_desc desc = {.threads = 1, .error_mm = 0.02};
    cw_mesh one = simplify(&mesh, &desc);
    desc.threads = 3;
    cw_mesh three = simplify(&mesh, &desc);
    test_assert_same_mesh(&one, &three);
    test_assert_sound(&mesh, &one);
    test_bound_is_measured(&mesh, &one, desc.error_mm);
    test_bound_is_measured(&one, &mesh, desc.error_mm);
    assert_true(one.triangle_count < mesh.triangle_count);
    cw_mesh_free(&one);
    cw_mesh_free(&three);
    cw_mesh_free(&mesh);
}

static void levels_follow_each_other(void **state)
{
    (void)state;
    static const size_t triangles[] = {20000, 5000, 1000};
    cw_mesh mesh = noisy_gyroid(40, 0.02, false), levels[3];
    cw_simplify_facts facts[3];
    cw_error err = {0};
    assert_ok(
        cw_simplify_levels(&mesh, &(cw_simplify_desc){0}, triangles, 3, levels, facts, &err),
        err);
    for (int n = 0; n < 3; n++) {
        assert_int_equal(facts[n].triangles, levels[n].triangle_count);
        if (n < 2)
            assert_int_equal(levels[n].triangle_count, triangles[n]);
        test_assert_sound(&mesh, levels + n);
    }
    cw_mesh first = simplify(&mesh, &(cw_simplify_desc){.triangles = triangles[0]});
    test_assert_same_mesh(&first, levels);
    cw_mesh_free(&first);
    for (int n = 0; n < 3; n++)
        cw_mesh_free(levels + n);
    cw_mesh_free(&mesh);
}

/* The attributes of vertices are a function of place here, so they are known for the result. */
static void what_vertices_carry_comes_along(void **state)
{
    (void)state;
    cw_volume volume = test_sample(CW_FIELD_SPHERE, 32, CW_F32);
    cw_mesh mesh = test_extract(&volume, NULL, NULL);
    const size_t n = mesh.vertex_count;
    mesh.scalars = cwi_alloc_array(n, sizeof *mesh.scalars);
    mesh.colors = cwi_alloc_array(4 * n, sizeof *mesh.colors);
    mesh.labels = cwi_alloc_array(n, sizeof *mesh.labels);
    assert_true(mesh.scalars && mesh.colors && mesh.labels);
    for (size_t v = 0; v < n; v++) {
        const float z = mesh.positions[3 * v + 2];
        mesh.scalars[v] = z;
        mesh.labels[v] = z > 0 ? 7 : 9;
        for (size_t k = 0; k < 4; k++)
            mesh.colors[4 * v + k] = (uint8_t)(128 + z + (float)k);
    }
    cw_mesh out = reduce(&mesh, 0.2);
    const double voxel = volume.affine[0][0];
    assert_true(out.normals && out.scalars && out.colors && out.labels);
    for (size_t v = 0; v < out.vertex_count; v++) {
        const float *p = out.positions + 3 * v, *normal = out.normals + 3 * v, z = p[2];
        const double length = sqrt((double)(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]));
        assert_near((double)out.scalars[v], (double)z, 0.1 * voxel);
        for (int k = 0; k < 4; k++)
            assert_near(out.colors[4 * v + (size_t)k], 128 + (double)z + k, 0.6 + voxel);
        if (fabs((double)z) > voxel)
            assert_int_equal(out.labels[v], z > 0 ? 7 : 9);
        for (int k = 0; k < 3; k++)
            assert_near((double)normal[k], (double)p[k] / length, 0.02);
    }
    cw_mesh_free(&out);
    cw_mesh_free(&mesh);
    cw_volume_free(&volume);
}

/* Between the corners of one triangle, at shares that are known. */
static void what_is_carried_is_blended_and_rounded(void **state)
{
    (void)state;
    float corners[] = {0, 0, 0, 10, 0, 0, 0, 10, 0}, scalars[] = {1, 2, 4};
    float normals[] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    uint8_t colors[] = {0, 100, 251, 9, 1, 100, 0, 9, 2, 201, 0, 9};
    uint32_t triangle[] = {0, 1, 2};
    uint32_t labels[] = {7, 8, 9};
    float points[] = {1, 3, 5, 3, 6, -5, 5, 2, 0}; /* shares of 0.6, 0.1, 0.3 and so on */
    const double shares[3][3] = {{0.6, 0.1, 0.3}, {0.1, 0.3, 0.6}, {0.3, 0.5, 0.2}};
    const uint32_t nearest[] = {7, 9, 8};
    const cw_mesh from = {.vertex_count = 3,
                          .triangle_count = 1,
                          .positions = corners,
                          .triangles = triangle,
                          .normals = normals,
                          .colors = colors,
                          .scalars = scalars,
                          .labels = labels};
    cw_mesh to = {.vertex_count = 3, .positions = points};
    cw_error err = {0};
    assert_ok(cwi_carry(&from, NULL, 1, &(cw_progress){0}, &to, &err), err);
    for (size_t v = 0; v < 3; v++) {
        const double *s = shares[v], length = sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
        assert_int_equal(to.labels[v], nearest[v]);
        assert_near((double)to.scalars[v], s[0] + 2 * s[1] + 4 * s[2], 1e-6);
        for (size_t k = 0; k < 3; k++)
            assert_near((double)to.normals[3 * v + k], s[k] / length, 1e-6);
        for (size_t k = 0; k < 4; k++)
            assert_int_equal(
                to.colors[4 * v + k],
                (int)rint(s[0] * colors[k] + s[1] * colors[4 + k] + s[2] * colors[8 + k]));
    }
    cwi_free(to.normals);
    cwi_free(to.colors);
    cwi_free(to.scalars);
    cwi_free(to.labels);
}

/* In percent of the diagonal, which is 50 mm. */
static void weights_are_lengths_of_the_largest_difference(void **state)
{
    (void)state;
    float points[] = {0, 0, 0, 30, 40, 0}, scalars[] = {-5, 15};
    float normals[] = {1, 0, 0, 0, 0, -1};
    uint8_t colors[] = {0, 255, 0, 255, 255, 255, 51, 255};
    const cw_mesh mesh = {.vertex_count = 2,
                          .positions = points,
                          .normals = normals,
                          .colors = colors,
                          .scalars = scalars};
    const cw_simplify_desc desc = {.normal_weight = 2, .color_weight = 3, .scalar_weight = 4};
    const double expected[2][8] = {{1, 0, 0, 0, 1.5, 0, 1.5, -0.5},
                                   {0, 0, -1, 1.5, 1.5, 0.3, 1.5, 1.5}};
    float values[16];
    assert_int_equal(cwi_attributes_count(&desc), 8);
    cwi_attributes_weigh(&mesh, &desc, values);
    for (size_t n = 0; n < 16; n++)
        assert_near((double)values[n], expected[n / 8][n % 8], 1e-6);
}

static void crossings_may_be_allowed(void **state)
{
    (void)state;
    cw_mesh mesh = noisy_gyroid(40, 0.3, false);
    cw_mesh out = simplify(&mesh, &(cw_simplify_desc){.ratio = 0.05, .allow_crossings = true});
    const cw_quality a = test_measure(&mesh), b = test_measure(&out);
    assert_int_equal(a.euler, b.euler);
    assert_int_equal(a.components, b.components);
    assert_int_equal(b.nonmanifold_edges, 0);
    assert_true(test_count_crossings(&out) > 0);
    cw_mesh_free(&out);
    cw_mesh_free(&mesh);
}

static void wishes_that_make_no_sense_are_refused(void **state)
{
    (void)state;
    static const struct {
        cw_simplify_desc desc;
        const char *words;
    } rows[] = {
        {{0}, "an error, a number of triangles or a ratio"},
        {{.error_mm = -1}, "error_mm is -1; it must be 0 or more"},
        {{.error_mm = INFINITY}, "error_mm is inf"},
        {{.error_mm = NAN}, "error_mm is"},
        {{.ratio = 1}, "ratio is 1; it must be at least 0 and below 1"},
        {{.ratio = -0.5}, "ratio is -0.5"},
        {{.ratio = 0.5, .normal_weight = -1}, "normal_weight is -1; it must be 0 or more"},
        {{.ratio = 0.5, .color_weight = NAN}, "color_weight is"},
        {{.ratio = 0.5, .color_weight = 1}, "color_weight is 1; the mesh has no colors"},
        {{.ratio = 0.5, .scalar_weight = 2}, "scalar_weight is 2; the mesh has no scalars"},
    };
    static const size_t rising[] = {10, 20}, none[] = {10, 0}, falling[] = {20, 10};
    cw_mesh mesh = {0}, out[2];
    cw_error err = {0};
    test_make_cube(&mesh);
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++)
        assert_fails(cw_simplify(&mesh, &rows[n].desc, out, NULL, &err), CW_ERR_ARGUMENT,
                     rows[n].words, err);
    const cw_simplify_desc plain = {0}, both = {.ratio = 0.5};
    assert_fails(cw_simplify_levels(&mesh, &plain, rising, 2, out, NULL, &err), CW_ERR_ARGUMENT,
                 "level 1 has 20 triangles", err);
    assert_fails(cw_simplify_levels(&mesh, &plain, none, 2, out, NULL, &err), CW_ERR_ARGUMENT,
                 "level 1 has 0 triangles", err);
    assert_fails(cw_simplify_levels(&mesh, &both, falling, 2, out, NULL, &err), CW_ERR_ARGUMENT,
                 "and nothing else", err);
    mesh.triangles[0] = 1000;
    assert_fails(cw_simplify(&mesh, &both, out, NULL, &err), CW_ERR_ARGUMENT,
                 "names vertex 1000", err);
    cw_mesh_free(&mesh);
}

typedef struct listener {
    pthread_t caller;
    size_t calls, stop_at; /* 0: never */
    bool elsewhere;
} listener;

static bool listen(void *user, const char *step, double done)
{
    listener *l = user;
    (void)step;
    assert_true(done >= 0 && done <= 1);
    l->elsewhere |= !pthread_equal(pthread_self(), l->caller);
    return ++l->calls != l->stop_at;
}

/* Asked often, on the calling thread alone, and obeyed at once, wherever it is. */
static void it_can_be_stopped(void **state)
{
    (void)state;
    const cw_simplify_desc descs[] = {{.ratio = 0.1, .threads = 1},
                                      {.error_mm = 0.02, .threads = 1},
                                      {.error_mm = 0.02, .threads = 2}};
    cw_mesh mesh = noisy_gyroid(40, 0.1, false), out;
    for (size_t d = 0; d < 3; d++) {
        cw_error err = {0};
        cw_simplify_desc desc = descs[d];
        listener l = {.caller = pthread_self()};
        desc.progress = (cw_progress){listen, &l};
        assert_ok(cw_simplify(&mesh, &desc, &out, NULL, &err), err);
        cw_mesh_free(&out);
        const size_t calls = l.calls;
        if (desc.threads == 1) /* otherwise others do what they do */
            assert_true(calls > mesh.triangle_count / 4096);
        /* sanitizers do not know exceptions of modules, by which C++ is left */
        for (size_t n = 0; n < (CWI_SANITIZED ? 1 : 6); n += test_is_short() ? 3 : 1) {
            const size_t at = desc.threads == 1 ? n * (calls - 1) / 5 : n;
            l = (listener){.caller = pthread_self(), .stop_at = 1 + at};
            assert_fails(cw_simplify(&mesh, &desc, &out, NULL, &err), CW_ERR_CANCELLED,
                         "interrupted", err);
            assert_true(l.calls == l.stop_at);
            assert_null(out.positions);
        }
        assert_false(l.elsewhere);
    }
    cw_mesh_free(&mesh);
}

#if !CWI_SANITIZED
/* Sets every step-th allocation in turn to fail. */
static void starve(const cw_mesh *mesh, const cw_simplify_desc *desc, long step)
{
    cw_mesh out;
    bool failed = true;
    for (long n = 0; failed; n += step + (test_is_short() ? n / 4 : 0)) {
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        const cw_status st = cw_simplify(mesh, desc, &out, NULL, &err);
        failed = cwi_alloc_fail_after(-1);
        if (failed) {
            assert_fails(st, CW_ERR_NO_MEMORY, "memory", err);
            assert_null(out.positions);
        } else {
            assert_ok(st, err);
        }
        cw_mesh_free(&out);
    }
}

static void running_out_of_memory_is_told(void **state)
{
    (void)state;
    cw_mesh several_blocks = noisy_gyroid(40, 0.02, false),
            small = noisy_gyroid(10, 0.1, false);
    assert_true(several_blocks.triangle_count > 40000);
    starve(&several_blocks,
           &(cw_simplify_desc){
               .ratio = 0.95, .allow_crossings = true, .normal_weight = 1, .threads = 1},
           1);
    starve(&several_blocks, &(cw_simplify_desc){.error_mm = 1e-4, .threads = 1}, 20);
    starve(&small, &(cw_simplify_desc){.error_mm = 1, .threads = 1}, 1);
    cw_mesh_free(&several_blocks);
    cw_mesh_free(&small);
}
#endif

static void a_build_without_openmesh_says_so(void **state)
{
    (void)state;
    cw_mesh mesh = {0}, out;
    cw_error err = {0};
    test_make_cube(&mesh);
    assert_fails(cw_simplify(&mesh, &(cw_simplify_desc){.ratio = 0.5}, &out, NULL, &err),
                 CW_ERR_UNSUPPORTED, "libopenmesh-dev", err);
    cw_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shells_face_where_they_did),
        cmocka_unit_test(topology_stays),
        cmocka_unit_test(hostile_surfaces_stay_sound),
        cmocka_unit_test(broken_meshes_become_no_worse),
        cmocka_unit_test(the_error_is_never_exceeded),
        cmocka_unit_test(what_is_met_first_ends_it),
        cmocka_unit_test(a_border_can_be_kept),
        cmocka_unit_test(a_sphere_stays_round),
        cmocka_unit_test(size_does_not_matter),
        cmocka_unit_test(place_does_not_matter),
        cmocka_unit_test(a_flat_square_becomes_two_triangles),
        cmocka_unit_test(what_has_a_weight_stays_sharp),
        cmocka_unit_test(nothing_vanishes),
        cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(seams_of_many_blocks_are_sound),
        cmocka_unit_test(seams_keep_the_error),
        cmocka_unit_test(levels_follow_each_other),
        cmocka_unit_test(what_vertices_carry_comes_along),
        cmocka_unit_test(what_is_carried_is_blended_and_rounded),
        cmocka_unit_test(weights_are_lengths_of_the_largest_difference),
        cmocka_unit_test(crossings_may_be_allowed),
        cmocka_unit_test(wishes_that_make_no_sense_are_refused),
        cmocka_unit_test(it_can_be_stopped),
#if !CWI_SANITIZED /* asan in a C program knows of no exceptions */
        cmocka_unit_test(running_out_of_memory_is_told),
#endif
    };
    const struct CMUnitTest without[] = {cmocka_unit_test(a_build_without_openmesh_says_so)};
    return cw_simplify_available() ? cmocka_run_group_tests(tests, NULL, NULL)
                                   : cmocka_run_group_tests(without, NULL, NULL);
}
