/* Smoothing of meshes: noise falls, shapes keep their volume, and no vertex leaves its ball. */
#include "support/hostile.h"
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/mesh/mesh.h"
#include "core/synthetic/random_fill.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of the field CW_FIELD_SPHERE, mm. */
static const double RADIUS = 30;

static cw_mesh extract_field(cw_field field, size_t n, bool open)
{
    cw_volume volume = test_sample(field, n, CW_F32);
    cw_mesh mesh = test_extract(&volume, &(cw_extract_desc){.leave_open = open}, NULL);
    cw_volume_free(&volume);
    return mesh;
}

static double radius_of(const cw_mesh *m, size_t v)
{
    double square = 0;
    for (size_t a = 0; a < 3; a++) {
        const double x = m->origin[a] + (double)m->positions[3 * v + a];
        square += x * x;
    }
    return sqrt(square);
}

/* A sphere whose vertices are off by white noise along the radius, in units of scale mm. */
static cw_mesh noisy_sphere(size_t n, double noise_mm, double scale)
{
    cw_mesh m = extract_field(CW_FIELD_SPHERE, n, false);
    for (size_t v = 0; v < m.vertex_count; v++) {
        const double factor = (RADIUS + noise_mm * cwi_gaussian(5, v)) / radius_of(&m, v);
        for (size_t a = 0; a < 3; a++) {
            const double x = m.origin[a] + (double)m.positions[3 * v + a];
            m.positions[3 * v + a] = (float)(x * factor * scale);
        }
    }
    memset(m.origin, 0, sizeof m.origin);
    return m;
}

static double rms_error(const cw_mesh *m, double scale)
{
    double sum = 0;
    for (size_t v = 0; v < m->vertex_count; v++) {
        const double off = radius_of(m, v) / scale - RADIUS;
        sum += off * off;
    }
    return sqrt(sum / (double)m->vertex_count);
}

static float *copy_positions(const cw_mesh *m)
{
    float *copy = cwi_alloc_array(m->vertex_count, 3 * sizeof *copy);
    assert_non_null(copy);
    memcpy(copy, m->positions, 3 * m->vertex_count * sizeof *copy);
    return copy;
}

static double largest_move(const cw_mesh *m, const float *first)
{
    double largest = 0;
    for (size_t v = 0; v < m->vertex_count; v++) {
        const float *p = m->positions + 3 * v, *q = first + 3 * v;
        const double x = (double)p[0] - (double)q[0], y = (double)p[1] - (double)q[1],
                     z = (double)p[2] - (double)q[2];
        largest = fmax(largest, fmax(hypot(hypot(x, y), z), sqrt(x * x + y * y + z * z)));
    }
    return largest;
}

static cw_smooth_facts smooth_mesh(cw_mesh *m, const cw_smooth_desc *desc)
{
    cw_smooth_facts facts;
    cw_error err = {0};
    assert_ok(cw_mesh_smooth(m, desc, &facts, &err), err);
    return facts;
}

/* Voxels of 1.27 mm: the noise is a sixth of one. */
static void noise_of_a_sphere_falls(void **state)
{
    (void)state;
    static const struct {
        cw_smooth_desc desc;
        double times; /* how much smaller the error must be */
    } rows[] = {{{0}, 3}, {{.iterations = 80}, 4.8}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        cw_mesh m = noisy_sphere(64, 0.2, 1);
        const double before = rms_error(&m, 1);
        const cw_smooth_facts facts = smooth_mesh(&m, &rows[n].desc);
        assert_near(before, 0.2, 0.01);
        assert_true(rms_error(&m, 1) < before / rows[n].times);
        assert_true(facts.flipped < 4); /* of thin triangles that the noise had turned over */
        assert_int_equal(facts.border, 0);
        assert_true(facts.mean_mm > 0 && facts.mean_mm < facts.max_mm && facts.max_mm < 1.1);
        assert_int_equal(test_count_crossings(&m), 0);
        test_check_promise(&m, false);
        cw_mesh_free(&m);
    }
}

/* Coarse spheres are what smoothing shrinks most. */
static void volumes_are_kept(void **state)
{
    (void)state;
    for (size_t n = 8; n <= 32; n *= 2) {
        cw_mesh m = noisy_sphere(n, 0, 1);
        const double before = test_measure(&m).volume_mm3;
        const cw_smooth_facts facts =
            smooth_mesh(&m, &(cw_smooth_desc){.iterations = 50, .max_move_mm = 20});
        assert_within(test_measure(&m).volume_mm3, before, 2e-7);
        assert_within(facts.volume_before_mm3, before, 1e-9);
        assert_within(facts.volume_after_mm3, before, 2e-7);
        cw_mesh_free(&m);
    }
}

/* Each keeps its own: a small one beside a large one does not pay for it. */
static void components_keep_their_volumes(void **state)
{
    (void)state;
    cw_mesh large = noisy_sphere(24, 0.3, 1), small = noisy_sphere(10, 0, 0.1), both;
    cw_error err = {0};
    const double volumes[2] = {test_measure(&large).volume_mm3,
                               test_measure(&small).volume_mm3};
    const size_t split = large.vertex_count;
    assert_ok(cwi_mesh_alloc(&both, split + small.vertex_count,
                             large.triangle_count + small.triangle_count, false, &err),
              err);
    for (size_t n = 0; n < 3 * both.vertex_count; n++)
        both.positions[n] =
            n < 3 * split ? large.positions[n] : small.positions[n - 3 * split] + 100;
    for (size_t n = 0; n < 3 * both.triangle_count; n++)
        both.triangles[n] =
            n < 3 * large.triangle_count
                ? large.triangles[n]
                : small.triangles[n - 3 * large.triangle_count] + (uint32_t)split;
    smooth_mesh(&both, &(cw_smooth_desc){.max_move_mm = 2});
    const cw_mesh parts[2] = {{.vertex_count = split,
                               .triangle_count = large.triangle_count,
                               .positions = both.positions,
                               .triangles = both.triangles},
                              {.vertex_count = small.vertex_count,
                               .triangle_count = small.triangle_count,
                               .positions = both.positions + 3 * split,
                               .triangles = small.triangles}};
    assert_within(test_measure(&parts[0]).volume_mm3, volumes[0], 1e-6);
    assert_within(test_measure(&parts[1]).volume_mm3, volumes[1], 1e-4);
    cw_mesh_free(&large);
    cw_mesh_free(&small);
    cw_mesh_free(&both);
}

/* Returns the volume between a surface and zero. While the rim stays, it changes as the volume between
 * the surface and any other point does. */
static double volume_to_zero(const cw_mesh *m)
{
    double sum = 0;
    for (size_t t = 0; t < m->triangle_count; t++) {
        const float *p[3];
        for (size_t c = 0; c < 3; c++)
            p[c] = m->positions + 3 * (size_t)m->triangles[3 * t + c];
        for (int a = 0; a < 3; a++) {
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            sum += (double)p[0][a] *
                   ((double)p[1][b] * (double)p[2][c] - (double)p[1][c] * (double)p[2][b]);
        }
    }
    return sum / 6;
}

/* A coarse sphere without its top, which smoothing shrinks. Where the rim moves, no volume is left to
 * keep. */
static void bowls_keep_what_they_hold(void **state)
{
    (void)state;
    for (int method = 0; method < CW_SMOOTH_METHOD_COUNT; method++)
        for (int moves = 0; moves < 2; moves++) {
            cw_mesh m = noisy_sphere(12, 0, 1);
            size_t kept = 0;
            for (size_t t = 0; t < m.triangle_count; t++) {
                const uint32_t *corners = m.triangles + 3 * t;
                bool is_top = false;
                for (int c = 0; c < 3; c++)
                    is_top = is_top || m.positions[3 * (size_t)corners[c] + 2] > 15;
                if (!is_top)
                    memmove(m.triangles + 3 * kept++, corners, 3 * sizeof *corners);
            }
            m.triangle_count = kept;
            const double before = volume_to_zero(&m);
            const cw_smooth_desc desc = {.method = (cw_smooth_method)method,
                                         .iterations = 20,
                                         .max_move_mm = 5,
                                         .width_mm = method == CW_SMOOTH_FAIR ? 30 : 0,
                                         .move_border = moves};
            const cw_smooth_facts facts = smooth_mesh(&m, &desc);
            assert_true(facts.border > 10 && facts.max_mm > 0.1);
            const double change = volume_to_zero(&m) / before - 1;
            if (moves)
                assert_true(fabs(change) > 1e-3);
            else
                assert_near(change, 0, 1e-6);
            cw_mesh_free(&m);
        }
}

/* By any way to compute a distance, and at limits below the spacing of single precision. */
static void no_vertex_moves_farther_than_allowed(void **state)
{
    (void)state;
    static const double limits[] = {1e-8, 3e-6, 1e-5, 0.001, 0.05, 0.3, 1};
    for (size_t n = 0; n < sizeof limits / sizeof *limits; n++) {
        cw_mesh m = noisy_sphere(24, 0.5, 1);
        for (size_t v = 0; v < m.vertex_count; v++)
            m.positions[3 * v + 1] += 300;
        float *first = copy_positions(&m);
        const cw_smooth_facts facts =
            smooth_mesh(&m, &(cw_smooth_desc){.iterations = 30, .max_move_mm = limits[n]});
        assert_true(largest_move(&m, first) <= limits[n]);
        assert_near(facts.max_mm, largest_move(&m, first), 1e-12);
        if (limits[n] >= 0.001 && limits[n] < 1)
            assert_true(facts.max_mm > 0.9 * limits[n]);
        assert_true(facts.limit_mm == limits[n]);
        cwi_free(first);
        cw_mesh_free(&m);
    }
}

static void default_limit_is_half_an_edge(void **state)
{
    (void)state;
    cw_mesh m = noisy_sphere(24, 0.5, 1);
    double sum = 0;
    for (size_t c = 0; c < 3 * m.triangle_count; c++) {
        const float *p = m.positions + 3 * (size_t)m.triangles[c],
                    *q = m.positions + 3 * (size_t)m.triangles[c % 3 == 2 ? c - 2 : c + 1];
        sum += hypot(hypot((double)p[0] - (double)q[0], (double)p[1] - (double)q[1]),
                     (double)p[2] - (double)q[2]);
    }
    const cw_smooth_facts facts = smooth_mesh(&m, NULL);
    assert_within(facts.limit_mm, sum / (6 * (double)m.triangle_count), 1e-9);
    assert_true(facts.max_mm <= facts.limit_mm);
    cw_mesh_free(&m);
}

static void borders_stay_unless_they_may_move(void **state)
{
    (void)state;
    for (int moves = 0; moves < 2; moves++) {
        cw_mesh m = extract_field(CW_FIELD_PLANE, 24, true);
        const cw_quality before = test_measure(&m);
        assert_true(before.open_edges > 0);
        bool *is_border = cwi_alloc_zeroed(m.vertex_count, sizeof *is_border);
        uint8_t *defects = cwi_alloc_zeroed(m.triangle_count, 1);
        float *first = copy_positions(&m);
        size_t border = 0, stayed = 0;
        for (size_t v = 0; v < m.vertex_count; v++)
            m.positions[3 * v] += first[3 * v] += (float)(0.5 * cwi_gaussian(1, v));
        memcpy(m.positions, first, 3 * m.vertex_count * sizeof *first);
        const cw_smooth_facts facts = smooth_mesh(
            &m, &(cw_smooth_desc){.move_border = moves, .max_move_mm = 3, .iterations = 5});
        for (size_t c = 0; c < 3 * m.triangle_count; c++) { /* open edges, the slow way */
            const size_t at = c - c % 3;
            const uint32_t v = m.triangles[c], w = m.triangles[at + (c + 1) % 3];
            size_t others = 0;
            for (size_t d = 0; d < 3 * m.triangle_count; d++)
                others += m.triangles[d] == w && m.triangles[d - d % 3 + (d + 1) % 3] == v;
            if (!others)
                is_border[v] = is_border[w] = true;
        }
        for (size_t v = 0; v < m.vertex_count; v++) {
            border += is_border[v];
            stayed += is_border[v] &&
                      memcmp(m.positions + 3 * v, first + 3 * v, 3 * sizeof *first) == 0;
        }
        assert_int_equal(facts.border, border);
        assert_true(moves ? stayed < border / 2 : stayed == border);
        if (!moves)
            assert_within(facts.volume_after_mm3, facts.volume_before_mm3, 1e-5);
        cwi_free(is_border);
        cwi_free(defects);
        cwi_free(first);
        cw_mesh_free(&m);
    }
}

/* The unit does not matter, but for the digits of single precision. */
static void scales_give_the_same_shape(void **state)
{
    (void)state;
    static const double scales[] = {1e-4, 1e4};
    cw_mesh one = noisy_sphere(24, 0.5, 1);
    const cw_smooth_facts facts = smooth_mesh(&one, NULL);
    for (int n = 0; n < 2; n++) {
        const double scale = scales[n];
        cw_mesh m = noisy_sphere(24, 0.5, scale);
        const cw_smooth_facts scaled = smooth_mesh(&m, NULL);
        for (size_t c = 0; c < 3 * m.vertex_count; c++)
            assert_near((double)m.positions[c] / scale, (double)one.positions[c], 2e-5);
        assert_within(scaled.mean_mm / scale, facts.mean_mm, 1e-5);
        assert_within(scaled.volume_after_mm3 / pow(scale, 3), facts.volume_after_mm3, 1e-5);
        assert_int_equal(scaled.flipped, facts.flipped);
        cw_mesh_free(&m);
    }
    cw_mesh_free(&one);
}

static void threads_do_not_matter(void **state)
{
    (void)state;
    cw_mesh one = extract_field(CW_FIELD_GYROID, 48, true);
    for (size_t c = 0; c < 3 * one.vertex_count; c++)
        one.positions[c] += (float)(0.3 * cwi_gaussian(2, c));
    cw_mesh many = one;
    many.positions = copy_positions(&one);
    many.normals = cwi_alloc_array(one.vertex_count, 3 * sizeof *many.normals);
    const cw_smooth_facts a = smooth_mesh(&one, &(cw_smooth_desc){.threads = 1}),
                          b = smooth_mesh(&many, &(cw_smooth_desc){.threads = 5});
    assert_true(one.vertex_count > 1 << 14);
    test_assert_same_mesh(&one, &many);
    assert_memory_equal(&a, &b, offsetof(cw_smooth_facts, undecided));
    cwi_free(many.positions);
    cwi_free(many.normals);
    cw_mesh_free(&one);
}

/* Strong noise makes triangles meet; smoothing adds no pair, unless it may. */
static void no_triangles_meet_that_did_not_before(void **state)
{
    (void)state;
    static const double noises[] = {0.1, 0.5};
    size_t added = 0;
    for (int n = 0; n < 2; n++)
        for (int allow = 0; allow < 2; allow++) {
            cw_mesh m = extract_field(CW_FIELD_GYROID, 28, false);
            for (size_t c = 0; c < 3 * m.vertex_count; c++)
                m.positions[c] += (float)(noises[n] * cwi_gaussian(2, c));
            cw_crossings before, after;
            cw_error err = {0};
            assert_ok(cw_self_intersections(&m, NULL, &before, &err), err);
            const cw_smooth_facts facts = smooth_mesh(
                &m, &(cw_smooth_desc){
                        .allow_crossings = allow, .iterations = 60, .max_move_mm = 9});
            assert_ok(cw_self_intersections(&m, NULL, &after, &err), err);
            size_t more = 0, old = 0;
            for (size_t i = 0; i < after.count; i++) {
                const uint32_t *pair = after.pairs + 2 * i;
                while (old < before.count && (before.pairs[2 * old] < pair[0] ||
                                              (before.pairs[2 * old] == pair[0] &&
                                               before.pairs[2 * old + 1] < pair[1])))
                    old++;
                more += old == before.count || memcmp(before.pairs + 2 * old, pair, 8) != 0;
            }
            assert_true(allow || more == 0);
            assert_int_equal(test_measure(&m).degenerate, 0);
            assert_false(facts.undecided);
            assert_true(allow ? facts.put_back == 0 : facts.put_back < m.vertex_count / 4);
            added += more;
            cw_crossings_free(&before);
            cw_crossings_free(&after);
            cw_mesh_free(&m);
        }
    assert_true(added > 0); /* else nothing was tested */
}

static void flipped_triangles_are_counted(void **state)
{
    (void)state;
    cw_mesh m = noisy_sphere(16, 3, 1);
    float *first = copy_positions(&m);
    const cw_smooth_facts facts =
        smooth_mesh(&m, &(cw_smooth_desc){.max_move_mm = 20, .allow_crossings = true});
    size_t flipped = 0;
    for (size_t t = 0; t < m.triangle_count; t++) {
        double normals[2][3];
        for (int n = 0; n < 2; n++) {
            const float *at = n ? m.positions : first;
            double p[3][3];
            for (size_t c = 0; c < 9; c++)
                p[c / 3][c % 3] = (double)at[3 * (size_t)m.triangles[3 * t + c / 3] + c % 3];
            for (int a = 0; a < 3; a++) {
                const int b = (a + 1) % 3, c = (a + 2) % 3;
                normals[n][a] = (p[1][b] - p[0][b]) * (p[2][c] - p[0][c]) -
                                (p[1][c] - p[0][c]) * (p[2][b] - p[0][b]);
            }
        }
        flipped += normals[0][0] * normals[1][0] + normals[0][1] * normals[1][1] +
                       normals[0][2] * normals[1][2] <=
                   0;
    }
    assert_true(flipped > 0);
    assert_int_equal(facts.flipped, flipped);
    cwi_free(first);
    cw_mesh_free(&m);
}

/* Surfaces that extractors break on keep their topology, and get no new defect. */
static void hostile_surfaces_stay_sound(void **state)
{
    (void)state;
    const test_hostile *h;
    for (size_t n = 0; (h = test_hostile_at(n)); n += test_is_short() ? 3 : 1) {
        cw_volume volume;
        cw_error err = {0};
        assert_ok(test_hostile_make(h, &volume, &err), err);
        const cw_extract_desc desc = {.isovalue = h->isovalue, .leave_open = n % 2};
        cw_mesh mesh = test_extract(&volume, &desc, NULL), out;
        assert_ok(cwi_mesh_copy(&mesh, &out, &err), err);
        const cw_smooth_facts facts = smooth_mesh(&out, NULL);
        const char *fault = test_reduced_fault(&mesh, &out);
        if (fault)
            fail_msg("hostile case %zu: %s", n, fault);
        assert_false(facts.undecided);
        cw_mesh_free(&out);
        cw_mesh_free(&mesh);
        cw_volume_free(&volume);
    }
}

/* Normals follow, and nothing else does. */
static void attributes_stay_and_normals_follow(void **state)
{
    (void)state;
    cw_mesh m = noisy_sphere(16, 0.5, 1);
    const cw_mesh arrays = m;
    cw_error err = {0};
    assert_non_null(m.normals);
    m.scalars = cwi_alloc_array(m.vertex_count, sizeof *m.scalars);
    m.colors = cwi_alloc_array(m.vertex_count, 4);
    m.labels = cwi_alloc_array(m.vertex_count, sizeof *m.labels);
    for (size_t v = 0; v < m.vertex_count; v++) {
        m.scalars[v] = (float)v;
        m.labels[v] = (uint32_t)v + 7;
        memset(m.colors + 4 * v, (int)(v % 251), 4);
    }
    smooth_mesh(&m, NULL);
    assert_ptr_equal(m.positions, arrays.positions);
    assert_ptr_equal(m.normals, arrays.normals);
    float *normals = cwi_alloc_array(m.vertex_count, 3 * sizeof *normals);
    memcpy(normals, m.normals, 3 * m.vertex_count * sizeof *normals);
    assert_ok(cw_mesh_normals(&m, &err), err);
    assert_memory_equal(normals, m.normals, 3 * m.vertex_count * sizeof *normals);
    for (size_t v = 0; v < m.vertex_count; v++)
        assert_true(m.scalars[v] == (float)v && m.labels[v] == v + 7 &&
                    m.colors[4 * v + 3] == v % 251);
    cwi_free(normals);
    cw_mesh_free(&m);
}

/* Meshes that nobody wants, but anybody may have. */
static void odd_meshes_are_smoothed(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_mesh none = {0};
    cw_smooth_facts facts = smooth_mesh(&none, NULL);
    assert_true(facts.limit_mm == 0 && facts.max_mm == 0);

    /* an edge of three triangles, a collapsed one, one without area, and a lone vertex */
    float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 5, 5, 5, 2, 0, 0};
    uint32_t triangles[] = {0, 1, 2, 0, 1, 3, 0, 1, 4, 2, 2, 0, 0, 1, 6, 4, 4, 4};
    float first[21];
    cw_mesh odd = {
        .vertex_count = 7, .triangle_count = 6, .positions = positions, .triangles = triangles};
    memcpy(first, positions, sizeof first);
    smooth_mesh(&odd, &(cw_smooth_desc){.move_border = true, .max_move_mm = 0.5});
    assert_memory_equal(positions + 15, first + 15, 3 * sizeof(float));
    assert_ok(cw_mesh_check(&odd, &err), err);

    /* the largest numbers do not overflow */
    cw_mesh cube;
    test_make_cube(&cube);
    for (size_t c = 0; c < 24; c++)
        cube.positions[c] = cube.positions[c] > 0.5f ? FLT_MAX : -FLT_MAX;
    smooth_mesh(&cube, &(cw_smooth_desc){.allow_crossings = true});
    assert_ok(cw_mesh_check(&cube, &err), err);
    cw_mesh_free(&cube);
}

static void bad_arguments_are_named(void **state)
{
    (void)state;
    cw_mesh m = noisy_sphere(8, 0, 1);
    float *first = copy_positions(&m);
    cw_smooth_facts facts;
    cw_error err = {0};
    assert_fails(cw_mesh_smooth(NULL, NULL, NULL, &err), CW_ERR_ARGUMENT, "'mesh' is NULL",
                 err);
    assert_fails(cw_mesh_smooth(&m, &(cw_smooth_desc){.max_move_mm = -1}, &facts, &err),
                 CW_ERR_ARGUMENT, "max_move_mm is -1; it must be finite, and 0 or more", err);
    assert_fails(
        cw_mesh_smooth(&m, &(cw_smooth_desc){.max_move_mm = (double)NAN}, &facts, &err),
        CW_ERR_ARGUMENT, "max_move_mm is", err);
    assert_fails(
        cw_mesh_smooth(&m, &(cw_smooth_desc){.max_move_mm = (double)INFINITY}, &facts, &err),
        CW_ERR_ARGUMENT, "max_move_mm is inf", err);
    assert_fails(cw_mesh_smooth(&m, &(cw_smooth_desc){.iterations = 1001}, &facts, &err),
                 CW_ERR_ARGUMENT, "iterations is 1001; it must be at most 1000", err);
    assert_memory_equal(m.positions, first, 3 * m.vertex_count * sizeof *first);
    m.positions[5] = (float)NAN;
    assert_fails(cw_mesh_smooth(&m, NULL, &facts, &err), CW_ERR_ARGUMENT,
                 "position of vertex 1 is not finite", err);
    m.positions[5] = first[5];
    m.triangles[0] = (uint32_t)m.vertex_count;
    assert_fails(cw_mesh_smooth(&m, NULL, &facts, &err), CW_ERR_ARGUMENT, "triangle 0 names",
                 err);
    cwi_free(first);
    cw_mesh_free(&m);
}

typedef struct stopper {
    int calls, stop_at;
    double last;
    bool fell;
} stopper;

static bool count_calls(void *user, const char *step, double done)
{
    stopper *s = user;
    assert_string_equal(step[0] ? "named" : "", "named");
    s->fell = s->fell || done < s->last || done > 1;
    s->last = done;
    return ++s->calls != s->stop_at;
}

static void failures_and_cancelling_leave_the_mesh(void **state)
{
    (void)state;
    cw_mesh m = noisy_sphere(16, 3, 1);
    float *first = copy_positions(&m),
          *normals = cwi_alloc_array(m.vertex_count, 3 * sizeof *normals);
    memcpy(normals, m.normals, 3 * m.vertex_count * sizeof *normals);
    const size_t bytes = 3 * m.vertex_count * sizeof *first;
    cw_smooth_desc desc = {.max_move_mm = 20, .threads = 1};
    cw_error err = {0};
    stopper s = {0};
    desc.progress = (cw_progress){count_calls, &s};
    int calls = 1;
    for (int stop = 1; stop<calls + 1; stop += stop> 3 ? 7 : 1) {
        s = (stopper){.stop_at = stop};
        const cw_status st = cw_mesh_smooth(&m, &desc, NULL, &err);
        if (st == CW_OK)
            break;
        assert_int_equal(st, CW_ERR_CANCELLED);
        assert_memory_equal(m.positions, first, bytes);
        calls = s.calls + 7;
    }
    assert_true(s.calls > 20 && !s.fell);
    desc.progress = (cw_progress){0};
    for (long n = 0;; n++) {
        memcpy(m.positions, first, bytes);
        memcpy(m.normals, normals, bytes);
        cwi_alloc_fail_after(n);
        const cw_status st = cw_mesh_smooth(&m, &desc, NULL, &err);
        if (!cwi_alloc_fail_after(-1)) {
            assert_ok(st, err);
            assert_true(n > 10);
            break;
        }
        assert_fails(st, CW_ERR_NO_MEMORY, "no memory", err);
        assert_memory_equal(m.positions, first, bytes);
        assert_memory_equal(m.normals, normals, bytes);
    }
    cwi_free(first);
    cwi_free(normals);
    cw_mesh_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_of_a_sphere_falls),
        cmocka_unit_test(volumes_are_kept),
        cmocka_unit_test(components_keep_their_volumes),
        cmocka_unit_test(bowls_keep_what_they_hold),
        cmocka_unit_test(no_vertex_moves_farther_than_allowed),
        cmocka_unit_test(default_limit_is_half_an_edge),
        cmocka_unit_test(borders_stay_unless_they_may_move),
        cmocka_unit_test(scales_give_the_same_shape),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(no_triangles_meet_that_did_not_before),
        cmocka_unit_test(flipped_triangles_are_counted),
        cmocka_unit_test(hostile_surfaces_stay_sound),
        cmocka_unit_test(attributes_stay_and_normals_follow),
        cmocka_unit_test(odd_meshes_are_smoothed),
        cmocka_unit_test(bad_arguments_are_named),
        cmocka_unit_test(failures_and_cancelling_leave_the_mesh),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
