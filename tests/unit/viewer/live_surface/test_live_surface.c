/* Tests surfaces that OpenGL extracts against cw_extract(): the same vertices to the bit, the
 * same triangles. Normals are the same to the bit but where they come from triangles, whose sum
 * has another order. */
#define _POSIX_C_SOURCE 199309L /* nanosleep */
#include "support/live_surfaces.h"
#include "support/noise_volume.h"
#include "support/pictures.h"
#include "support/surface.h"

#include "core/base/clock.h"
#include "core/base/sandbox.h"
#include "core/synthetic/random_fill.h"

#include <math.h>
#include <string.h>
#include <time.h>

/* Largest difference of normals that are sums over triangles. */
#define MENDED 1e-4

/* Noise of a type without gaps: whole numbers below `steps`, so that many equal an isovalue. */
static cw_volume make_steps(cw_type type, const size_t dim[3], unsigned steps, uint64_t seed)
{
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, type, dim, 1, 1, &err), err);
    for (size_t n = 0; n < dim[0] * dim[1] * dim[2]; n++) {
        const double x = floor(cwi_chance(seed, n) * steps);
        char *to = (char *)cw_volume_voxels(&v) + n * cw_type_size(type);
        switch (type) {
#define CASE(name, ctype, text)                                                                \
    case name:                                                                                 \
        *(ctype *)(void *)to = (ctype)x;                                                       \
        break;
            CW_TYPE_TABLE(CASE)
#undef CASE
        default:
            break;
        }
    }
    return v;
}

static void report(const char *what, size_t triangles, const live_difference *d)
{
    print_message("%s: %zu triangles, %zu normals differ, by up to %g\n", what, triangles,
                  d->normals, d->normal);
    assert_true(triangles > 0);
}

static size_t check_fields(cw_type type, int round, live_difference *d)
{
    size_t triangles = 0;
    for (int f = 0; f < 2; f++) {
        const cw_field field = f ? CW_FIELD_GYROID : CW_FIELD_SPHERE;
        cw_volume v = test_sample(field, round % 2 ? 37 : 24, type);
        const double stored = cw_field_stored(field, type, cw_field_isovalue(field));
        test_turn(&v, round);
        triangles += live_check(&v, stored * v.slope + v.intercept, f, MENDED, d);
        cw_volume_free(&v);
    }
    return triangles;
}

/* Ambiguous cells of all kinds, samples on the isovalue, and volumes of any size. */
static size_t check_noise(cw_type type, int round, live_difference *d)
{
    static const size_t dims[][3] = {{2, 2, 2},  {2, 19, 2},  {9, 2, 8},  {8, 8, 8},
                                     {7, 9, 15}, {17, 16, 9}, {40, 3, 25}};
    static const double isovalues[] = {1, 1.5, 2, 0.3};
    size_t triangles = 0;
    for (size_t n = 0; n < sizeof dims / sizeof *dims; n++) {
        cw_volume v =
            make_steps(type, dims[n], 3 + (unsigned)(n % 3), 97 * (uint64_t)round + n);
        test_turn(&v, round + (int)n);
        for (size_t i = 0; i < sizeof isovalues / sizeof *isovalues; i++)
            triangles += live_check(&v, isovalues[i], (i + n) % 2, MENDED, d);
        cw_volume_free(&v);
    }
    return triangles;
}

/* Voxels without a value. */
static size_t check_gaps(cw_type type, live_difference *d)
{
    static const size_t dim[3] = {21, 12, 17};
    cw_volume v = make_noise_volume(type, dim, true);
    double low = INFINITY, high = -INFINITY;
    size_t triangles = 0;
    for (size_t k = 0; k < dim[2]; k++)
        for (size_t i = 0; i < dim[0]; i++)
            if (!is_gap(&v, stored_at(&v, i, 5, k))) {
                low = fmin(low, stored_at(&v, i, 5, k));
                high = fmax(high, stored_at(&v, i, 5, k));
            }
    for (int i = 1; i < 4; i++)
        triangles += live_check(&v, v.slope * (low + i * (high - low) / 4) + v.intercept, i % 2,
                                MENDED, d);
    cw_volume_free(&v);
    return triangles;
}

/* Programs are compiled for each type, which takes long: all of a type comes together. */
static void each_type_is_the_same(void **state)
{
    (void)state;
    static const cw_type types[] = {CW_U32, CW_I32, CW_U16, CW_I8, CW_U8, CW_I16, CW_F32};
    live_difference d = {0};
    size_t triangles = 0;
    const int step = !test_is_short() ? 1 : CWI_SANITIZED ? 7 : 3;
    for (int n = 0; n < (int)(sizeof types / sizeof *types); n += step) {
        triangles += check_fields(types[n], n, &d);
        triangles += check_noise(types[n], n, &d);
        triangles += check_gaps(types[n], &d);
    }
    report("types", triangles, &d);
}

static void hard_cases_are_the_same(void **state)
{
    (void)state;
    live_difference d = {0};
    size_t triangles = 0;
    for (size_t n = 0; cw_hard_at(n); n += test_is_short() ? 4 : 1) {
        const cw_hard_desc desc = {.number = n, .dim = {33, 20, 26}, .type = CW_F32, .seed = n};
        cw_volume v;
        cw_error err = {0};
        assert_ok(cw_hard_sample(&desc, &v, &err), err);
        triangles += live_check(&v, cw_hard_at(n)->isovalue, n % 2, MENDED, &d);
        cw_volume_free(&v);
    }
    report("hard", triangles, &d);
}

static void infinite_values_are_the_same(void **state)
{
    (void)state;
    static const size_t dim[3] = {19, 18, 11};
    live_difference d = {0};
    cw_volume v = make_steps(CW_F32, dim, 5, 3);
    float *x = cw_volume_voxels(&v);
    for (size_t n = 0; n < dim[0] * dim[1] * dim[2]; n++)
        if (cwi_chance(4, n) < 0.1)
            x[n] = cwi_chance(5, n) < 0.3 ? NAN : cwi_chance(6, n) < 0.5 ? INFINITY : -INFINITY;
    size_t triangles = live_check(&v, 2, false, MENDED, &d);
    triangles += live_check(&v, 1.7, true, MENDED, &d);
    for (size_t n = 0; n < dim[0] * dim[1] * dim[2]; n++) /* subnormal and huge */
        x[n] = (float)(cwi_chance(7, n) < 0.5 ? cwi_chance(8, n) * 1e-42 - 5e-43
                                              : (cwi_chance(9, n) - 0.5) * 6e38);
    triangles += live_check(&v, 0, false, MENDED, &d);
    cw_volume_free(&v);
    report("infinite", triangles, &d);
}

/* Falling slopes, views, and isovalues that nothing reaches. */
static void views_are_the_same(void **state)
{
    (void)state;
    static const size_t dim[3] = {23, 20, 18};
    live_difference d = {0};
    cw_volume v = make_steps(CW_I16, dim, 200, 11);
    v.slope = -0.5;
    v.intercept = 10;
    size_t triangles = live_check(&v, -20, false, MENDED, &d);
    triangles += live_check(&v, -20.25, true, MENDED, &d);
    assert_int_equal(live_check(&v, 1000, false, MENDED, &d), 0);
    assert_int_equal(live_check(&v, -1000, false, MENDED, &d), 0);
    cw_volume part = v;
    part.stride[0] = 2 * (ptrdiff_t)sizeof(int16_t);
    part.stride[1] = (ptrdiff_t)(dim[0] * sizeof(int16_t));
    part.stride[2] = (ptrdiff_t)(dim[0] * dim[1] * sizeof(int16_t));
    part.dim[0] = 11;
    part.dim[1] = 17;
    triangles += live_check(&part, -33, false, MENDED, &d);
    cw_volume_free(&v);
    report("views", triangles, &d);
}

/* Volumes of more blocks than a group of a scan sums, of more active ones than there is room for
 * at first, and of more open cells. */
static void lists_grow(void **state)
{
    (void)state;
    static const size_t dim[3] = {150, 90, 70};
    live_difference d = {0};
    cw_volume v = make_steps(CW_U8, dim, 256, 21);
    const size_t triangles = live_check(&v, 127.5, false, MENDED, &d);
    cw_volume_free(&v);
    report("lists", triangles, &d);
}

static void refuses_what_it_cannot(void **state)
{
    (void)state;
    cwi_gl *gl;
    const cwi_gl_functions *f = live_functions(&gl);
    cw_volume v = test_sample(CW_FIELD_SPHERE, 40, CW_F32), doubles;
    cw_live_surface live = {
        .volume = &v, .isovalue = cw_field_isovalue(CW_FIELD_SPHERE), .on_software = true};
    const cwi_live_limits small_texture = {.texture_edge = 39},
                          small_buffer = {.buffer_bytes = 4096};
    const cwi_live_limits small_surface = {.buffer_bytes = (size_t)1 << 20};
    cw_error err = {0};
    cw_mesh mesh = {0};
    size_t size[2];
    f->forget(gl); /* limits are those of a volume that comes */
    assert_fails(f->extract(gl, &live, &small_texture, NULL, size, &mesh, &err), CW_ERR_LIMIT,
                 "textures of up to 39", err);
    assert_fails(f->extract(gl, &live, &small_buffer, NULL, size, &mesh, &err), CW_ERR_LIMIT,
                 "OpenGL holds 4096", err);
    assert_ok(f->extract(gl, &live, NULL, NULL, size, NULL, &err), err);
    assert_true(size[1] > 0);
    cw_volume noise = make_steps(CW_U8, (const size_t[3]){60, 60, 60}, 256, 5);
    live.volume = &noise;
    live.isovalue = 128;
    assert_fails(f->extract(gl, &live, &small_surface, NULL, size, &mesh, &err), CW_ERR_LIMIT,
                 "in one buffer", err);
    cw_volume_free(&noise);
    live.volume = &v;
    live.isovalue = NAN;
    assert_fails(f->extract(gl, &live, NULL, NULL, size, &mesh, &err), CW_ERR_ARGUMENT,
                 "not finite", err);
    live.isovalue = 1e-200;
    assert_fails(f->extract(gl, &live, NULL, NULL, size, &mesh, &err), CW_ERR_UNSUPPORTED,
                 "not at 1e-200", err);
    doubles = test_sample(CW_FIELD_SPHERE, 10, CW_F64);
    live.volume = &doubles;
    live.isovalue = 1;
    assert_fails(f->extract(gl, &live, NULL, NULL, size, &mesh, &err), CW_ERR_UNSUPPORTED,
                 "f64", err);
    cw_volume_free(&doubles);
    cw_volume_free(&v);
}

/* A surface is prepared in calls that do not wait, and is ready in the end. */
static void prepares(void **state)
{
    (void)state;
    cwi_gl *gl;
    const cwi_gl_functions *f = live_functions(&gl);
    cw_volume v = test_sample(CW_FIELD_SPHERE, 20, CW_U8);
    cw_live_surface live = {.volume = &v, .isovalue = 128, .on_software = true};
    cw_error err = {0};
    size_t size[2];
    bool ready = false;
    f->forget(gl);
    for (const double until = cwi_now_s() + test_limit_s(); !ready && cwi_now_s() < until;) {
        const struct timespec pause = {.tv_nsec = 1000000};
        assert_ok(f->prepare(gl, &live, &ready, &err), err);
        nanosleep(&pause, NULL);
    }
    assert_true(ready);
    assert_ok(f->extract(gl, &live, NULL, NULL, size, NULL, &err), err);
    assert_true(size[1] > 0);
    v.dim[2] = 1;
    assert_fails(f->prepare(gl, &live, &ready, &err), CW_ERR_ARGUMENT, "1 voxel along z", err);
    v.dim[2] = 20;
    cw_volume_free(&v);
}

/* A scene's live surface looks as the mesh does. Others are refused. */
static void scenes_have_one(void **state)
{
    (void)state;
    enum { SIDE = 160 };
    cwi_gl *gl;
    live_functions(&gl);
    cw_renderer *r = test_renderer(), *cpu;
    cw_volume v = test_sample(CW_FIELD_GYROID, 40, CW_I16);
    const cw_live_surface live = {.volume = &v, .isovalue = 100, .on_software = true};
    const cw_extract_desc desc = {.isovalue = 100};
    cw_mesh mesh = {0};
    cw_error err = {0};
    bool ready;
    assert_ok(cw_extract(&v, &desc, &mesh, NULL, &err), err);
    cw_scene scene = {.mode = CW_MODE_MESH, .mesh = &mesh, .width = SIDE, .height = SIDE};
    double min[3], max[3];
    assert_true(cw_mesh_bounds(&mesh, min, max));
    cw_fit_desc fit = {.aspect = 1, .fov_deg = 30};
    memcpy(fit.min, min, sizeof min);
    memcpy(fit.max, max, sizeof max);
    assert_ok(cw_camera_fit(&fit, &scene.camera, &err), err);
    cw_picture a = test_draw(r, &scene), b;
    scene.mesh_look.live = &live;
    assert_fails(cw_render(r, &scene, &b, &err), CW_ERR_ARGUMENT, "not both", err);
    scene.mesh = NULL;
    b = test_draw(r, &scene);
    size_t far = 0;
    for (size_t n = 0; n < (size_t)4 * SIDE * SIDE; n++)
        far += fabs((double)a.pixels[n] - (double)b.pixels[n]) > 2.0 / 255;
    assert_true(far <= SIDE * SIDE / 1000);
    cw_picture_free(&a);
    cw_picture_free(&b);
    scene.mesh_look.wireframe = true;
    assert_fails(cw_render(r, &scene, &b, &err), CW_ERR_UNSUPPORTED, "without wireframe", err);
    scene.mesh_look.wireframe = false;
    assert_ok(cw_renderer_new(CW_BACKEND_CPU, &cpu, &err), err);
    assert_fails(cw_render(cpu, &scene, &b, &err), CW_ERR_UNSUPPORTED, "OpenGL alone", err);
    assert_fails(cw_renderer_prepare(cpu, &live, &ready, &err), CW_ERR_UNSUPPORTED,
                 "OpenGL alone", err);
    cw_renderer_free(cpu);
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

/* Without memory for a part of it there is no surface, and nothing stays behind. */
static void memory_runs_out(void **state)
{
    (void)state;
    cwi_gl *gl;
    const cwi_gl_functions *f = live_functions(&gl);
    cw_volume v = make_steps(CW_U8, (const size_t[3]){50, 50, 50}, 256, 5);
    const cw_live_surface live = {.volume = &v, .isovalue = 128, .on_software = true};
    cw_error err = {0};
    cw_status st = CW_ERR_NO_MEMORY;
    size_t size[2], failed = 0;
    f->forget(gl);
    const size_t before = cw_memory_used();
    for (size_t room = 1000; st != CW_OK && room < (size_t)1 << 30; room *= 2) {
        cw_memory_limit(before + room);
        st = f->extract(gl, &live, NULL, NULL, size, NULL, &err);
        cw_memory_limit(0);
        if (st != CW_OK) {
            assert_int_equal(st, CW_ERR_NO_MEMORY);
            assert_int_equal(cw_memory_used(), before);
            failed++;
        }
    }
    assert_int_equal(st, CW_OK);
    assert_true(failed > 5 && size[1] > 0);
    f->forget(gl);
    assert_int_equal(cw_memory_used(), before);
    cw_volume_free(&v);
}

static int close_all(void **state)
{
    test_renderer_close(state);
    return live_close(state);
}

/* Times of the GPU are found, and the same surface is there again. */
static void times_are_told(void **state)
{
    (void)state;
    cwi_gl *gl;
    const cwi_gl_functions *f = live_functions(&gl);
    cw_volume v = test_sample(CW_FIELD_GYROID, 40, CW_U8);
    const cw_live_surface live = {
        .volume = &v, .isovalue = cw_field_isovalue(CW_FIELD_GYROID), .on_software = true};
    cwi_live_times times = {-1, -1, -1};
    cw_mesh a = {0}, b = {0};
    cw_error err = {0};
    size_t size[2];
    assert_ok(f->extract(gl, &live, NULL, NULL, size, &a, &err), err);
    assert_ok(f->extract(gl, &live, NULL, &times, size, &b, &err), err);
    assert_true(times.classify_ms >= 0 && times.scan_ms >= 0 && times.emit_ms >= 0);
    live_compare(&a, &b);
    cw_mesh_free(&a);
    cw_mesh_free(&b);
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_type_is_the_same),
        cmocka_unit_test(hard_cases_are_the_same),
        cmocka_unit_test(infinite_values_are_the_same),
        cmocka_unit_test(views_are_the_same),
        cmocka_unit_test(lists_grow),
        cmocka_unit_test(refuses_what_it_cannot),
        cmocka_unit_test(times_are_told),
        cmocka_unit_test(prepares),
        cmocka_unit_test(scenes_have_one),
        cmocka_unit_test(memory_runs_out),
    };
    return cmocka_run_group_tests(tests, NULL, close_all);
}
