/* The methods of smoothing: what each does to waves, shapes, rims and junctions. */
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/mesh/mesh.h"
#include "core/synthetic/random_fill.h"

#include <math.h>
#include <string.h>

static cw_smooth_facts smooth_mesh(cw_mesh *m, const cw_smooth_desc *desc)
{
    cw_smooth_facts facts;
    cw_error err = {0};
    assert_ok(cw_mesh_smooth(m, desc, &facts, &err), err);
    return facts;
}

/* A rectangle of n x n squares with sides of 1, two triangles each. */
static cw_mesh make_sheet(size_t n)
{
    cw_mesh m;
    cw_error err = {0};
    assert_ok(cwi_mesh_alloc(&m, (n + 1) * (n + 1), 2 * n * n, false, &err), err);
    for (size_t v = 0; v < m.vertex_count; v++) {
        m.positions[3 * v] = (float)(v % (n + 1));
        m.positions[3 * v + 1] = (float)(v / (n + 1));
        m.positions[3 * v + 2] = 0;
    }
    for (size_t s = 0; s < n * n; s++) {
        const uint32_t v = (uint32_t)(s / n * (n + 1) + s % n), up = (uint32_t)n + 1;
        const uint32_t corners[6] = {v, v + 1, v + up, v + 1, v + up + 1, v + up};
        memcpy(m.triangles + 6 * s, corners, sizeof corners);
    }
    return m;
}

/* The height of a wave along x in the middle of a sheet, after smoothing. */
static double smooth_wave(double length, const cw_smooth_desc *desc)
{
    enum { N = 96 };
    cw_mesh m = make_sheet(N);
    double most = 0;
    for (size_t v = 0; v < m.vertex_count; v++)
        m.positions[3 * v + 2] =
            (float)(0.01 * sin(2 * PI * (double)m.positions[3 * v] / length));
    smooth_mesh(&m, desc);
    for (size_t x = N / 4; x < 3 * N / 4; x++)
        most = fmax(most, fabs((double)m.positions[3 * (x + N / 2 * (N + 1)) + 2]));
    cw_mesh_free(&m);
    return most / 0.01;
}

/* The law of its width, whatever the steps: half of the height is kept. */
static void fairing_halves_waves_of_its_width(void **state)
{
    (void)state;
    for (size_t steps = 1; steps <= 4; steps++) {
        const cw_smooth_desc desc = {
            .method = CW_SMOOTH_FAIR, .iterations = steps, .width_mm = 16, .max_move_mm = 1};
        const double time = pow(2, 1 / (double)steps) - 1;
        for (double length = 8; length <= 32; length *= 2) {
            const double waves = 16 / length;
            const double kept = pow(1 + time * waves * waves, -(double)steps);
            assert_near(smooth_wave(length, &desc), kept, 0.02);
        }
    }
}

/* Long waves stay, short ones go. */
static void averages_part_waves(void **state)
{
    (void)state;
    for (int method = CW_SMOOTH_TAUBIN; method <= CW_SMOOTH_HC; method++) {
        const cw_smooth_desc desc = {.method = (cw_smooth_method)method, .max_move_mm = 1};
        assert_true(smooth_wave(32, &desc) > 0.85);
        assert_true(smooth_wave(3, &desc) < 0.2);
    }
}

static cw_mesh noisy_field(cw_field field, size_t n, double noise_mm, double scale)
{
    cw_volume volume = test_sample(field, n, CW_F32);
    cw_mesh m = test_extract(&volume, NULL, NULL);
    cw_volume_free(&volume);
    for (size_t c = 0; c < 3 * m.vertex_count; c++)
        m.positions[c] =
            (float)(scale * ((double)m.positions[c] + noise_mm * cwi_gaussian(7, c)));
    for (int a = 0; a < 3; a++)
        m.origin[a] *= scale;
    return m;
}

static double rms_radius(const cw_mesh *m, double radius)
{
    double sum = 0;
    for (size_t v = 0; v < m->vertex_count; v++) {
        double square = 0;
        for (size_t a = 0; a < 3; a++)
            square += pow(m->origin[a] + (double)m->positions[3 * v + a], 2);
        sum += pow(sqrt(square) - radius, 2);
    }
    return sqrt(sum / (double)m->vertex_count);
}

static void each_method_removes_noise(void **state)
{
    (void)state;
    for (int method = 0; method < CW_SMOOTH_METHOD_COUNT; method++) {
        cw_mesh m = noisy_field(CW_FIELD_SPHERE, 48, 0.2, 1);
        const double volume = test_measure(&m).volume_mm3, before = rms_radius(&m, 30);
        const size_t crossings = test_count_crossings(&m);
        const cw_smooth_facts facts =
            smooth_mesh(&m, &(cw_smooth_desc){.method = (cw_smooth_method)method});
        assert_true(rms_radius(&m, 30) < before / 2);
        assert_within(test_measure(&m).volume_mm3, volume, 2e-5);
        assert_true(test_count_crossings(&m) <= crossings);
        assert_int_equal(facts.iterations, method == CW_SMOOTH_FAIR ? 3 : 10);
        assert_true((facts.width_mm > 0) == (method == CW_SMOOTH_FAIR));
        assert_true(facts.max_mm <= facts.limit_mm);
        cw_mesh_free(&m);
    }
}

/* Units and threads change nothing but the last digits, and threads not even these. */
static void units_and_threads_do_not_matter(void **state)
{
    (void)state;
    for (int method = 1; method < CW_SMOOTH_METHOD_COUNT; method++) {
        cw_smooth_desc desc = {.method = (cw_smooth_method)method, .threads = 1};
        cw_mesh one = noisy_field(CW_FIELD_GYROID, 48, 0.05, 1),
                other = noisy_field(CW_FIELD_GYROID, 48, 0.05, 1);
        assert_true(one.vertex_count > 1 << 13);
        smooth_mesh(&one, &desc);
        desc.threads = 5;
        smooth_mesh(&other, &desc);
        test_assert_same_mesh(&one, &other);
        cw_mesh_free(&other);
        for (double scale = 1e-4; scale < 1e5; scale *= 1e8) {
            size_t apart = 0;
            other = noisy_field(CW_FIELD_GYROID, 48, 0.05, scale);
            smooth_mesh(&other, &desc);
            for (size_t c = 0; c < 3 * one.vertex_count; c++)
                apart +=
                    fabs((double)other.positions[c] / scale - (double)one.positions[c]) > 1e-3;
            assert_true(apart < one.vertex_count / 1000); /* vertices that went back */
            cw_mesh_free(&other);
        }
        cw_mesh_free(&one);
    }
}

/* Three sheets that meet along x = 0: of books, pages and both covers. */
static cw_mesh make_junction(size_t n)
{
    cw_mesh sheet = make_sheet(n), m;
    cw_error err = {0};
    const size_t vertices = sheet.vertex_count, corners = 3 * sheet.triangle_count;
    assert_ok(cwi_mesh_alloc(&m, 3 * vertices, 3 * sheet.triangle_count, false, &err), err);
    for (size_t k = 0; k < 3; k++) {
        for (size_t v = 0; v < vertices; v++) {
            const double x = (double)sheet.positions[3 * v], angle = 2 * PI * (double)k / 3;
            m.positions[3 * (k * vertices + v)] = (float)(x * cos(angle));
            m.positions[3 * (k * vertices + v) + 1] =
                sheet.positions[3 * v + 1] + (float)(0.2 * cwi_gaussian(3, v));
            m.positions[3 * (k * vertices + v) + 2] =
                (float)(x * sin(angle) + 0.2 * cwi_gaussian(4 + k, v));
        }
        for (size_t c = 0; c < corners; c++) {
            const uint32_t v = sheet.triangles[c];
            m.triangles[k * corners + c] =
                v % (n + 1) == 0 ? v : (uint32_t)(k * vertices) + v; /* x = 0: one for all */
        }
    }
    cw_mesh_free(&sheet);
    return m;
}

static void junctions_stay_unless_they_may_move(void **state)
{
    (void)state;
    enum { N = 24 };
    for (int method = 0; method < CW_SMOOTH_METHOD_COUNT; method++)
        for (int moves = 0; moves < 2; moves++) {
            cw_mesh m = make_junction(N), first = make_junction(N);
            const cw_smooth_facts facts =
                smooth_mesh(&m, &(cw_smooth_desc){.method = (cw_smooth_method)method,
                                                  .move_border = moves,
                                                  .allow_crossings = true,
                                                  .max_move_mm = 2});
            size_t moved = 0, elsewhere = 0;
            for (size_t v = 0; v < m.vertex_count; v++) {
                const bool differs =
                    memcmp(m.positions + 3 * v, first.positions + 3 * v, 12) != 0;
                if (v < (N + 1) * (N + 1) && v % (N + 1) == 0)
                    moved += differs;
                else
                    elsewhere += differs;
            }
            assert_int_equal(facts.junction, N - 1); /* its ends are at open edges, too */
            assert_int_equal(facts.border, 3 * (3 * N - 1) + 2);
            assert_true(moves ? moved >= N - 1 : moved == 0);
            assert_true(elsewhere > 3 * (N - 1) * (N - 1) - 1);
            assert_true(facts.volume_before_mm3 == 0 && facts.volume_after_mm3 == 0);
            cw_mesh_free(&m);
            cw_mesh_free(&first);
        }
}

/* Points, needles, doubled and collapsed triangles have no cotangents. */
static void odd_triangles_are_smoothed(void **state)
{
    (void)state;
    static const uint32_t triangles[] = {0, 1, 2, 2, 1, 3, 2, 1, 3, 4, 4, 5,
                                         6, 7, 8, 0, 2, 9, 0, 9, 1, 5, 6, 5};
    for (int method = 0; method < CW_SMOOTH_METHOD_COUNT; method++)
        for (int moves = 0; moves < 2; moves++) {
            float positions[30] = {0};
            for (size_t v = 0; v < 6; v++)
                positions[3 * v] = (float)(v % 3) * 1e-20F;
            positions[9] = 1e10F;
            positions[20] = 1;
            cw_mesh m = {.vertex_count = 10,
                         .triangle_count = sizeof triangles / 12,
                         .positions = positions,
                         .triangles = (uint32_t *)(uintptr_t)triangles};
            smooth_mesh(&m, &(cw_smooth_desc){.method = (cw_smooth_method)method,
                                              .move_border = moves});
            for (size_t c = 0; c < 30; c++)
                assert_true(isfinite(positions[c]));
        }
}

static bool cancel_late(void *user, const char *step, double done)
{
    (void)step;
    int *calls = user;
    assert_true(done >= 0 && done <= 1);
    return --*calls > 0;
}

static void failures_and_cancelling_leave_the_mesh(void **state)
{
    (void)state;
    cw_error err;
    for (int method = 1; method < CW_SMOOTH_METHOD_COUNT; method++) {
        cw_smooth_desc desc = {
            .method = (cw_smooth_method)method, .threads = 1, .move_border = true};
        cw_mesh m = noisy_field(CW_FIELD_SPHERE, 16, 0.1, 1),
                first = noisy_field(CW_FIELD_SPHERE, 16, 0.1, 1);
        for (long n = 0;; n++) {
            cwi_alloc_fail_after(n);
            const cw_status st = cw_mesh_smooth(&m, &desc, NULL, &err);
            if (!cwi_alloc_fail_after(-1)) {
                assert_ok(st, err);
                assert_true(n > 10);
                break;
            }
            assert_fails(st, CW_ERR_NO_MEMORY, "no memory", err);
            test_assert_same_mesh(&m, &first);
        }
        cw_mesh_free(&m);
        for (int calls = 1; calls < 30; calls += 4) {
            int left = calls;
            m = noisy_field(CW_FIELD_SPHERE, 16, 0.1, 1);
            desc.progress = (cw_progress){cancel_late, &left};
            const cw_status st = cw_mesh_smooth(&m, &desc, NULL, &err);
            if (st != CW_OK) {
                assert_int_equal(st, CW_ERR_CANCELLED);
                test_assert_same_mesh(&m, &first);
            } else
                assert_true(calls > 5);
            cw_mesh_free(&m);
        }
        cw_mesh_free(&first);
    }
}

static void bad_arguments_are_named(void **state)
{
    (void)state;
    static const struct {
        cw_smooth_desc desc;
        const char *text;
    } rows[] = {
        {{.method = (cw_smooth_method)3}, "method is 3; it must be 0 to 2"},
        {{.method = CW_SMOOTH_FAIR, .width_mm = -1}, "width_mm is -1"},
        {{.method = CW_SMOOTH_FAIR, .width_mm = NAN}, "width_mm is"},
        {{.method = CW_SMOOTH_FAIR, .width_mm = INFINITY}, "width_mm is inf"},
        {{.method = CW_SMOOTH_HC, .width_mm = 1}, "width_mm is for CW_SMOOTH_FAIR, not for hc"},
    };
    cw_mesh m = make_sheet(2);
    cw_error err;
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++)
        assert_fails(cw_mesh_smooth(&m, &rows[n].desc, NULL, &err), CW_ERR_ARGUMENT,
                     rows[n].text, err);
    cw_mesh_free(&m);
    assert_string_equal(cw_smooth_method_name(CW_SMOOTH_FAIR), "fair");
    assert_null(cw_smooth_method_name((cw_smooth_method)3));
    assert_null(cw_smooth_method_name((cw_smooth_method)-1));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fairing_halves_waves_of_its_width),
        cmocka_unit_test(averages_part_waves),
        cmocka_unit_test(each_method_removes_noise),
        cmocka_unit_test(units_and_threads_do_not_matter),
        cmocka_unit_test(junctions_stay_unless_they_may_move),
        cmocka_unit_test(odd_triangles_are_smoothed),
        cmocka_unit_test(failures_and_cancelling_leave_the_mesh),
        cmocka_unit_test(bad_arguments_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
