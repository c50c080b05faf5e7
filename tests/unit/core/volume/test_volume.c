/* Tests volumes: types, views, crops, coarsening, world points, sampling, statistics and made
 * fields. */
#include "core/volume/volume.h"
#include "support/support.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

static void a_zeroed_volume_resolves_to_its_defaults(void **state)
{
    (void)state;
    const uint16_t voxels[24] = {0};
    const cw_volume in = {.data = voxels, .type = CW_U16, .dim = {4, 3, 2}};
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_resolve(&in, &v, &err), err);
    assert_int_equal(v.stride[0], 2);
    assert_int_equal(v.stride[1], 8);
    assert_int_equal(v.stride[2], 24);
    assert_int_equal(v.components, 1);
    assert_int_equal(v.steps, 1);
    assert_true(v.slope == 1 && v.affine[1][1] == 1 && v.affine[0][1] == 0);
}

static void unusable_volumes_are_refused_by_name(void **state)
{
    (void)state;
    static const double voxels[8];
    const cw_volume good = {.data = voxels, .type = CW_F64, .dim = {2, 2, 2}, .slope = 1};
    cw_volume v = good, out;
    cw_error err = {0};
    assert_ok(cw_volume_resolve(&v, &out, &err), err);
    v.dim[1] = 0;
    assert_fails(cw_volume_resolve(&v, &out, &err), CW_ERR_ARGUMENT, "2 x 0 x 2", err);
    v = good;
    v.data = NULL;
    assert_fails(cw_volume_resolve(&v, &out, &err), CW_ERR_ARGUMENT, "no voxels", err);
    v = good;
    v.type = (cw_type)77;
    assert_fails(cw_volume_resolve(&v, &out, &err), CW_ERR_ARGUMENT, "77", err);
    v = good;
    v.affine[0][0] = NAN;
    assert_fails(cw_volume_resolve(&v, &out, &err), CW_ERR_ARGUMENT, "not finite", err);
    v = good;
    v.affine[0][0] = v.affine[1][0] = 1;
    assert_fails(cw_volume_resolve(&v, &out, &err), CW_ERR_ARGUMENT, "determinant 0", err);
    v = good;
    v.slope = INFINITY;
    assert_fails(cw_volume_resolve(&v, &out, &err), CW_ERR_ARGUMENT, "slope", err);
    v = good;
    v.stride[0] = 4;
    assert_fails(cw_volume_resolve(&v, &out, &err), CW_ERR_ARGUMENT, "multiples of 8", err);
    v = good;
    v.dim[0] = v.dim[1] = v.dim[2] = (size_t)1 << 31;
    assert_fails(cw_volume_resolve(&v, &out, &err), CW_ERR_ARGUMENT, "larger", err);
}

/* Every type holds the numbers 1, 2, ... and gives them back through a scaled view. */
static void all_eight_types_read_the_same(void **state)
{
    (void)state;
    for (int type = 0; type < CW_TYPE_COUNT; type++) {
        cw_volume v;
        cw_error err = {0};
        assert_ok(cw_volume_alloc(&v, (cw_type)type, (size_t[3]){3, 2, 2}, 1, 1, &err), err);
        for (int n = 0; n < 12; n++)
            switch (type) {
#define CASE(name, ctype, text)                                                                \
    case name:                                                                                 \
        ((ctype *)cw_volume_voxels(&v))[n] = (ctype)(n + 1);                                   \
        break;
                CW_TYPE_TABLE(CASE)
#undef CASE
            }
        v.slope = 2;
        v.intercept = -1;
        assert_true(cw_volume_value(&v, 0, 0, 0) == 1);
        assert_true(cw_volume_value(&v, 2, 1, 1) == 23);
        assert_true(isnan(cw_volume_value(&v, 3, 0, 0)));
        cw_volume_free(&v);
        cw_volume_free(&v);
        assert_null(v.data);
    }
}

static void components_and_steps_are_views(void **state)
{
    (void)state;
    uint8_t voxels[2 * 2 * 2 * 3 * 2]; /* three components, two steps */
    for (int n = 0; n < 48; n++)
        voxels[n] = (uint8_t)n;
    const cw_volume in = {.data = voxels, .dim = {2, 2, 2}, .components = 3, .steps = 2};
    cw_volume out;
    cw_error err = {0};
    assert_ok(cw_volume_select(&in, 2, 1, &out, &err), err);
    assert_true(cw_volume_value(&out, 0, 0, 0) == 26);
    assert_true(cw_volume_value(&out, 1, 0, 0) == 29);
    assert_int_equal(out.components, 1);
    assert_fails(cw_volume_select(&in, 3, 0, &out, &err), CW_ERR_ARGUMENT, "3 components", err);
    assert_fails(cw_volume_select(&in, 0, 2, &out, &err), CW_ERR_ARGUMENT, "2 steps", err);
}

static void a_crop_stays_where_it_was(void **state)
{
    (void)state;
    cw_field_desc desc = {.field = CW_FIELD_PLANE, .dim = {9, 8, 7}, .type = CW_F32};
    cw_volume v, part;
    cw_error err = {0};
    double a[3], b[3];
    assert_ok(cw_field_sample(&desc, &v, &err), err);
    assert_ok(cw_volume_crop(&v, &(cw_box){{2, 3, 1}, {4, 4, 4}}, &part, &err), err);
    cw_volume_to_world(&v, (const double[3]){4, 5, 3}, a);
    cw_volume_to_world(&part, (const double[3]){2, 2, 2}, b);
    for (int n = 0; n < 3; n++)
        assert_near(a[n], b[n], 1e-12);
    assert_true(cw_volume_value(&v, 4, 5, 3) == cw_volume_value(&part, 2, 2, 2));
    assert_fails(cw_volume_crop(&v, &(cw_box){{2, 3, 1}, {8, 1, 1}}, &part, &err),
                 CW_ERR_ARGUMENT, "along x", err);
    assert_fails(cw_volume_crop(&v, &(cw_box){{0, 0, 0}, {1, 1, 0}}, &part, &err),
                 CW_ERR_ARGUMENT, "along z", err);
    cw_volume_free(&v);
}

/* Every voxel of the view is the one it says it is, in value and in place. */
static void assert_picks(const cw_volume *v, const size_t step[3], const cw_volume *view)
{
    for (size_t k = 0; k < view->dim[2]; k++)
        for (size_t j = 0; j < view->dim[1]; j++)
            for (size_t i = 0; i < view->dim[0]; i++) {
                const size_t at[3] = {i * step[0], j * step[1], k * step[2]};
                double a[3], b[3];
                cw_volume_to_world(
                    v, (const double[3]){(double)at[0], (double)at[1], (double)at[2]}, a);
                cw_volume_to_world(view, (const double[3]){(double)i, (double)j, (double)k}, b);
                for (int n = 0; n < 3; n++)
                    assert_near(a[n], b[n], 1e-9);
                assert_true(cw_volume_value(v, at[0], at[1], at[2]) ==
                            cw_volume_value(view, i, j, k));
            }
}

static void a_coarse_view_picks_voxels_where_they_are(void **state)
{
    (void)state;
    static const size_t steps[][3] = {{1, 1, 1}, {2, 3, 4}, {4, 4, 4}, {12, 8, 1}, {5, 1, 5}};
    const cw_box box = {{1, 2, 3}, {12, 10, 7}};
    cw_volume v, part, coarse;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, CW_U16, (size_t[3]){13, 12, 11}, 2, 2, &err), err);
    for (size_t n = 0; n < 2 * 2 * 13 * 12 * 11; n++)
        ((uint16_t *)cw_volume_voxels(&v))[n] = (uint16_t)n;
    memcpy(v.affine, (const double[3][4]){{0.5, 2, 0, 9}, {-4, 1, 0.3, -7}, {0.1, 0, -3, 1e3}},
           sizeof v.affine);
    v.slope = -2;
    for (size_t n = 0; n < sizeof steps / sizeof *steps; n++) {
        assert_ok(cw_volume_coarsen(&v, steps[n], &coarse, &err), err);
        for (int a = 0; a < 3; a++)
            assert_int_equal(coarse.dim[a], (v.dim[a] - 1) / steps[n][a] + 1);
        assert_picks(&v, steps[n], &coarse);
    }
    assert_ok(cw_volume_select(&v, 1, 1, &part, &err), err);
    assert_ok(cw_volume_crop(&part, &box, &part, &err), err);
    assert_ok(cw_volume_coarsen(&part, steps[1], &coarse, &err), err);
    assert_picks(&part, steps[1], &coarse);
    cw_volume_free(&coarse); /* borrowed */
    cw_volume_free(&v);
}

static void steps_that_leave_a_single_voxel_are_refused(void **state)
{
    (void)state;
    const uint8_t voxels[4 * 3] = {0};
    cw_volume v = {.data = voxels, .dim = {4, 3, 1}}, out;
    cw_error err = {0};
    assert_ok(cw_volume_coarsen(&v, (const size_t[3]){3, 2, 1}, &out, &err), err);
    assert_true(out.dim[0] == 2 && out.dim[1] == 2 && out.dim[2] == 1);
    assert_fails(cw_volume_coarsen(&v, (const size_t[3]){0, 1, 1}, &out, &err), CW_ERR_ARGUMENT,
                 "a step of 0 along x", err);
    assert_fails(cw_volume_coarsen(&v, (const size_t[3]){1, 3, 1}, &out, &err), CW_ERR_ARGUMENT,
                 "a step of 3 along y: expected 1, or less than the 3", err);
    assert_fails(cw_volume_coarsen(&v, (const size_t[3]){1, 1, SIZE_MAX}, &out, &err),
                 CW_ERR_ARGUMENT, "along z", err);
    v.affine[0][0] = 1e308;
    v.affine[1][1] = v.affine[2][2] = 1e-150;
    assert_fails(cw_volume_coarsen(&v, (const size_t[3]){3, 1, 1}, &out, &err), CW_ERR_ARGUMENT,
                 "not finite", err);
}

static void indices_and_world_points_are_inverse(void **state)
{
    (void)state;
    const cw_volume v = {.affine = {{0.5, 2, 0, 9}, {-4, 1, 0.3, -7}, {0.1, 0, -3, 1e6}}};
    const double index[3] = {12.25, -3, 40};
    double world[3], back[3];
    cw_error err = {0};
    cw_volume_to_world(&v, index, world);
    assert_ok(cw_volume_to_index(&v, world, back, &err), err);
    for (int a = 0; a < 3; a++)
        assert_near(back[a], index[a], 1e-6);
    const cw_volume identity = {.dim = {1, 1, 1}};
    assert_ok(cw_volume_to_index(&identity, index, back, &err), err);
    assert_true(back[0] == 12.25 && back[1] == -3 && back[2] == 40);
    const cw_volume flat = {.affine = {{1, 1, 0, 0}, {1, 1, 0, 0}, {0, 0, 1, 0}}};
    assert_fails(cw_volume_to_index(&flat, world, back, &err), CW_ERR_ARGUMENT, "determinant",
                 err);
}

static void spacing_is_the_length_of_an_axis(void **state)
{
    (void)state;
    double s[3];
    const cw_volume v = {.affine = {{3, 0, 0, 9}, {4, 2, 0, 9}, {0, 0, -0.5, 9}}};
    cw_volume_spacing(&v, s);
    assert_near(s[0], 5, 1e-12);
    assert_near(s[1], 2, 1e-12);
    assert_near(s[2], 0.5, 1e-12);
}

static void statistics_tell_values_from_the_rest(void **state)
{
    (void)state;
    const float voxels[8] = {1, 2, NAN, INFINITY, -5, 4, 4, -5};
    const cw_volume v = {
        .data = voxels, .type = CW_F32, .dim = {2, 2, 2}, .has_nodata = true, .nodata = -5};
    cw_statistics s;
    cw_error err = {0};
    assert_ok(cw_volume_statistics(&v, 3, 1, &s, &err), err);
    assert_true(s.min == 1 && s.max == 4);
    assert_int_equal(s.finite, 4);
    assert_int_equal(s.not_finite, 2);
    assert_int_equal(s.nodata, 2);
    assert_int_equal(s.bins[0], 1);
    assert_int_equal(s.bins[1], 1);
    assert_int_equal(s.bins[2], 2);
    cw_statistics_free(&s);
    cw_statistics_free(&s);
}

/* Two voxels have no value, though their number lies between those of the others. */
static void no_bin_counts_what_has_no_value(void **state)
{
    (void)state;
    static const int stored[8] = {1, 3, 4, 2, 4, 3, 4, 4}; /* values: 1, none, 7, 3, ... */
    static const uint64_t wanted[4] = {1, 1, 0, 4};
    for (int type = 0; type < CW_TYPE_COUNT; type++)
        for (int threads = 1; threads <= 2; threads++) {
            double voxels[8];
            const cw_volume v = {.data = voxels,
                                 .type = (cw_type)type,
                                 .dim = {2, 2, 2},
                                 .slope = 2,
                                 .intercept = -1,
                                 .has_nodata = true,
                                 .nodata = 3};
            cw_statistics s;
            cw_error err = {0};
            for (int n = 0; n < 8; n++)
                cwi_voxel_put(v.type, (char *)voxels + (size_t)n * cw_type_size(v.type),
                              stored[n]);
            assert_ok(cw_volume_statistics(&v, 4, threads, &s, &err), err);
            assert_true(s.min == 1 && s.max == 7);
            assert_int_equal(s.finite, 6);
            assert_int_equal(s.nodata, 2);
            assert_int_equal(s.bin_count, 4);
            assert_memory_equal(s.bins, wanted, sizeof wanted);
            cw_statistics_free(&s);
        }
}

static void integers_get_no_more_bins_than_values(void **state)
{
    (void)state;
    uint8_t voxels[64];
    for (int n = 0; n < 64; n++)
        voxels[n] = (uint8_t)(10 + n % 4);
    const cw_volume v = {.data = voxels, .dim = {4, 4, 4}, .slope = 2, .intercept = 1};
    cw_statistics s;
    cw_error err = {0};
    assert_ok(cw_volume_statistics(&v, 100, 0, &s, &err), err);
    assert_int_equal(s.bin_count, 4);
    assert_true(s.bin_width == 2 && s.min == 21 && s.max == 27);
    for (int b = 0; b < 4; b++)
        assert_int_equal(s.bins[b], 16);
    cw_statistics_free(&s);
}

/* Each of 30,000 values has a bin, and is in it, though the slope is no number of binary
 * digits. */
static void scaled_integers_fall_into_their_own_bins(void **state)
{
    (void)state;
    enum { VALUES = 30000 };
    static int16_t voxels[VALUES];
    for (int n = 0; n < VALUES; n++)
        voxels[n] = (int16_t)n;
    const cw_volume v = {
        .data = voxels, .type = CW_I16, .dim = {VALUES, 1, 1}, .slope = 2.0222414};
    cw_statistics s;
    cw_error err = {0};
    assert_ok(cw_volume_statistics(&v, 65536, 0, &s, &err), err);
    assert_int_equal(s.bin_count, VALUES);
    for (int b = 0; b < VALUES; b++)
        assert_int_equal(s.bins[b], 1);
    cw_statistics_free(&s);
    assert_ok(cw_volume_statistics(&v, 1000, 0, &s, &err), err);
    for (int b = 0; b < 1000; b++)
        assert_int_equal(s.bins[b], VALUES / 1000);
    cw_statistics_free(&s);
}

/* Four flat classes: any level between two of them is as good, and none is a sample's value. */
static void otsu_parts_classes(void **state)
{
    (void)state;
    uint8_t voxels[64];
    static const uint8_t grey[4] = {10, 60, 120, 200};
    for (int n = 0; n < 64; n++)
        voxels[n] = grey[n % 4];
    const cw_volume v = {.data = voxels, .dim = {4, 4, 4}};
    cw_statistics s;
    cw_error err = {0};
    double one, three[3];
    assert_ok(cw_volume_statistics(&v, 256, 0, &s, &err), err);
    assert_true(cw_statistics_otsu(&s, 1, &one));
    assert_true(cw_statistics_otsu(&s, 3, three));
    assert_true(one > 60 && one < 120);
    for (int n = 0; n < 3; n++)
        assert_true(three[n] > grey[n] && three[n] < grey[n + 1]);
    assert_near(three[0], 35, 1);
    cw_statistics_free(&s);
    const cw_volume flat = {.data = (const uint8_t[8]){0}, .dim = {2, 2, 2}};
    assert_ok(cw_volume_statistics(&flat, 256, 0, &s, &err), err);
    assert_false(cw_statistics_otsu(&s, 1, &one));
    cw_statistics_free(&s);
}

static void levels_have_names(void **state)
{
    (void)state;
    enum { SIZE = 16 };
    static const int16_t density[4] = {-1000, -90, 50, 1000}; /* air, fat, muscle, bone */
    int16_t voxels[SIZE * SIZE * SIZE];
    for (int n = 0; n < SIZE * SIZE * SIZE; n++)
        voxels[n] = density[n % 4];
    const cw_volume v = {.data = voxels, .dim = {SIZE, SIZE, SIZE}, .type = CW_I16};
    double level = 7, three[3];
    cw_error err = {0};
    cw_statistics s;
    assert_ok(cw_volume_statistics(&v, 512, 0, &s, &err), err);
    assert_true(cw_statistics_otsu(&s, 3, three));
    static const char *const names[] = {"dark", "medium", "bright"};
    for (int n = 0; n < 3; n++) {
        assert_ok(cw_statistics_level(&s, &v, names[n], &level, &err), err);
        assert_near(level, three[n], 1e-5 * fabs(three[n]));
        assert_true(level > density[n] && level < density[n + 1]);
    }
    cw_statistics_free(&s);
    assert_ok(cw_volume_level(&v, "25%", 0, &level, &err), err);
    assert_near(level, -500, 1e-9);
    assert_ok(cw_volume_level(&v, "bone", 0, &level, &err), err);
    assert_near(level, 226, 1e-9);
    assert_int_equal(cw_volume_level(&v, "bones", 0, &level, &err), CW_ERR_ARGUMENT);
    assert_non_null(strstr(err.message, "isovalue bones; a number, otsu"));
    assert_near(level, 226, 1e-9);
    const cw_volume flat = {.data = (const uint8_t[8]){0}, .dim = {2, 2, 2}};
    assert_int_equal(cw_volume_level(&flat, "skin", 0, &level, &err), CW_ERR_ARGUMENT);
    assert_non_null(strstr(err.message, "Hounsfield"));
    assert_int_equal(cw_volume_level(&flat, "otsu", 0, &level, &err), CW_ERR_EMPTY);
    assert_non_null(strstr(err.message, "too few"));
}

static void statistics_do_not_depend_on_threads(void **state)
{
    (void)state;
    const cw_field_desc desc = {
        .field = CW_FIELD_GYROID, .dim = {33, 20, 17}, .type = CW_F32, .noise = 1};
    cw_volume v;
    cw_statistics one, four;
    cw_error err = {0};
    assert_ok(cw_field_sample(&desc, &v, &err), err);
    assert_ok(cw_volume_statistics(&v, 50, 1, &one, &err), err);
    assert_ok(cw_volume_statistics(&v, 50, 4, &four, &err), err);
    assert_true(one.min == four.min && one.max == four.max && one.finite == four.finite);
    assert_memory_equal(one.bins, four.bins, 50 * sizeof *one.bins);
    cw_statistics_free(&one);
    cw_statistics_free(&four);
    cw_volume_free(&v);
}

enum { TEAM = 4, ROUNDS = 6, BINS = 1 << 16 };

/* An allocator by which threads that ask for counts of their own go on when all of a team have
 * asked. Before and after them, counts are asked for that are those of no thread. */
typedef struct meeting {
    pthread_mutex_t lock;
    pthread_cond_t changed;
    int asked; /* how often; -1 at first */
} meeting;

static void *allocate_together(void *user, size_t bytes)
{
    meeting *m = user;
    if (bytes >= BINS * sizeof(uint64_t)) {
        pthread_mutex_lock(&m->lock);
        const int before = m->asked++, team = before / TEAM;
        pthread_cond_broadcast(&m->changed);
        while (before >= 0 && team < ROUNDS && m->asked < (team + 1) * TEAM)
            pthread_cond_wait(&m->changed, &m->lock);
        pthread_mutex_unlock(&m->lock);
    }
    return aligned_alloc(64, (bytes + 63) / 64 * 64);
}

static void release_memory(void *user, void *memory, size_t bytes)
{
    (void)user;
    (void)bytes;
    free(memory);
}

/* All threads of a team count before the first of them adds its counts to the totals. So the thread
 * sanitizer always sees an access to the totals that no lock guards. Without it such a fault shows
 * now and then, by counts that are lost. */
static void counts_of_threads_are_added_one_after_another(void **state)
{
    (void)state;
    enum {
        WIDTH = 1024,
        HEIGHT = 1025
    }; /* a layer is more than the least that a thread takes */
    static float voxels[WIDTH * HEIGHT];
    static uint64_t wanted[BINS];
    static const cw_type types[] = {CW_U16, CW_F32};
    for (int t = 0; t < 2; t++) {
        meeting m = {PTHREAD_MUTEX_INITIALIZER, PTHREAD_COND_INITIALIZER, .asked = -1};
        const cw_allocator together = {allocate_together, release_memory, &m};
        const ptrdiff_t size = (ptrdiff_t)cw_type_size(types[t]);
        cw_volume v = {.data = voxels,
                       .type = types[t],
                       .dim = {WIDTH, HEIGHT, 1},
                       .stride = {size, WIDTH * size, 0}}; /* all layers are the same voxels */
        cw_statistics s;
        cw_error err = {0};
        for (size_t n = 0; n < WIDTH * HEIGHT; n++)
            cwi_voxel_put(v.type, (char *)voxels + n * (size_t)size, (double)(n % BINS));
        assert_ok(cw_volume_statistics(&v, BINS, 1, &s, &err), err);
        assert_int_equal(s.bin_count, BINS);
        v.dim[2] = TEAM * ROUNDS;
        for (size_t b = 0; b < BINS; b++)
            wanted[b] = v.dim[2] * s.bins[b];
        cw_statistics_free(&s);
        assert_ok(cw_allocator_set(&together, &err), err);
        assert_ok(cw_volume_statistics(&v, BINS, TEAM, &s, &err), err);
        assert_true(m.asked >= TEAM * ROUNDS);
        assert_int_equal(s.finite, v.dim[2] * WIDTH * HEIGHT);
        assert_memory_equal(s.bins, wanted, sizeof wanted);
        cw_statistics_free(&s);
        assert_ok(cw_allocator_set(NULL, &err), err);
    }
}

/* The statistics of two halves, joined, are those of the whole: every integer keeps its bin. */
static void joined_statistics_are_those_of_the_whole(void **state)
{
    (void)state;
    int16_t voxels[600];
    for (int n = 0; n < 600; n++)
        voxels[n] = (int16_t)(n < 300 ? n % 100 : 3 * n - 800);
    const cw_volume whole = {
        .data = voxels, .type = CW_I16, .dim = {600, 1, 1}, .slope = 2.0222414};
    cw_volume half = whole;
    half.dim[0] = 300;
    cw_statistics all, parts[3] = {{0}}, joined;
    cw_error err = {0};
    assert_ok(cw_volume_statistics(&whole, 2048, 0, &all, &err), err);
    assert_ok(cw_volume_statistics(&half, 2048, 0, &parts[0], &err), err);
    half.data = voxels + 300;
    assert_ok(cw_volume_statistics(&half, 2048, 0, &parts[1], &err), err);
    assert_ok(cw_statistics_join(parts, 3, 2048, &joined, &err), err);
    assert_true(joined.min == all.min && joined.max == all.max);
    assert_int_equal(joined.finite, 600);
    assert_int_equal(joined.bin_count, all.bin_count);
    assert_memory_equal(joined.bins, all.bins, all.bin_count * sizeof *all.bins);
    cw_statistics_free(&joined);
    cw_statistics_free(&all);

    /* of floats and integers: a bin counts what its middle is within */
    const cw_volume floats = {
        .data = (const float[3]){-1, 0.25f, NAN}, .type = CW_F32, .dim = {3, 1, 1}};
    cw_statistics_free(&parts[1]);
    assert_ok(cw_volume_statistics(&floats, 4, 0, &parts[1], &err), err);
    assert_ok(cw_statistics_join(parts, 2, 10, &joined, &err), err);
    assert_true(joined.min == -1 && joined.max == parts[0].max && joined.quantum == 0);
    assert_int_equal(joined.finite, 302);
    assert_int_equal(joined.not_finite, 1);
    uint64_t sum = 0;
    for (size_t b = 0; b < joined.bin_count; b++)
        sum += joined.bins[b];
    assert_int_equal(sum, 302);
    cw_statistics_free(&joined);
    for (int n = 0; n < 3; n++)
        cw_statistics_free(&parts[n]);

    assert_ok(cw_statistics_join(parts, 2, 10, &joined, &err), err); /* of nothing */
    assert_true(joined.finite == 0 && !joined.bins && joined.min == 0 && joined.max == 0);
}

static void fields_are_the_same_bytes_for_any_number_of_threads(void **state)
{
    (void)state;
    for (int f = 0; f < CW_FIELD_COUNT; f++)
        for (int type = 0; type < CW_TYPE_COUNT; type++) {
            cw_field_desc desc = {.field = (cw_field)f,
                                  .dim = {9, 10, 11},
                                  .type = (cw_type)type,
                                  .noise = 0.1,
                                  .threads = 1};
            cw_volume one, four;
            cw_error err = {0};
            assert_ok(cw_field_sample(&desc, &one, &err), err);
            desc.threads = 4;
            assert_ok(cw_field_sample(&desc, &four, &err), err);
            assert_memory_equal(one.data, four.data, 990 * cw_type_size((cw_type)type));
            cw_volume_free(&one);
            cw_volume_free(&four);
        }
}

/* A stored number is the field's value to half a step of the type, and the isovalue with it. */
static void integer_fields_keep_their_level(void **state)
{
    (void)state;
    const cw_field_desc desc = {.field = CW_FIELD_SPHERE, .dim = {21, 21, 21}, .type = CW_U8};
    cw_volume v;
    cw_error err = {0};
    double world[3];
    assert_ok(cw_field_sample(&desc, &v, &err), err);
    cw_volume_to_world(&v, (const double[3]){3, 11, 7}, world);
    const double value = cw_field_value(CW_FIELD_SPHERE, world);
    assert_near(cw_volume_value(&v, 3, 11, 7), cw_field_stored(CW_FIELD_SPHERE, CW_U8, value),
                0.5);
    assert_near(cw_field_stored(CW_FIELD_SPHERE, CW_U8, 0), 127.5, 1e-9);
    assert_true(cw_field_stored(CW_FIELD_CT_HEAD, CW_I16, 300) == 300);
    assert_true(cw_field_stored(CW_FIELD_CT_HEAD, CW_U16, 300) == 1324);
    cw_volume_free(&v);
    const cw_field_desc bad = {.field = (cw_field)99};
    assert_fails(cw_field_sample(&bad, &v, &err), CW_ERR_ARGUMENT, "99", err);
}

static void world_of(const cw_volume *v, double i, double j, double k, double world[3])
{
    cw_volume_to_world(v, (const double[3]){i, j, k}, world);
}

/* A field that is linear in the world is linear between voxels, however they are sheared; and
 * on a rectilinear grid however far they are apart. */
static void linear_fields_are_sampled_exactly(void **state)
{
    (void)state;
    static const double coordinates[3][6] = {
        {0, 0.5, 2, 2.25, 7, 9}, {-3, 0, 1, 1.5, 4}, {10, 10.5, 30, 31}};
    double voxels[6 * 5 * 4];
    cw_volume v = {.data = voxels,
                   .type = CW_F64,
                   .dim = {6, 5, 4},
                   .affine = {{2, 0.3, -0.4, 100}, {0.1, -1.5, 0.2, 50}, {0, 0.6, 3, -20}},
                   .slope = 0.5,
                   .intercept = 7};
    for (int rectilinear = 0; rectilinear < 2; rectilinear++) {
        double world[3];
        for (size_t a = 0; a < 3 && rectilinear; a++)
            v.coordinates[a] = coordinates[a];
        for (size_t n = 0; n < 120; n++) {
            world_of(&v, (double)(n % 6), (double)(n / 6 % 5), (double)(n / 30), world);
            voxels[n] = 2 * (3 * world[0] - 2 * world[1] + world[2] + 5 - 7);
        }
        for (int n = 0; n < 200; n++) {
            world_of(&v, n % 26 * 0.2, n % 21 * 0.2, n % 16 * 0.2, world);
            assert_near(cw_volume_sample(&v, world), 3 * world[0] - 2 * world[1] + world[2] + 5,
                        1e-9);
        }
        for (int a = 0; a < 3; a++)
            for (int side = 0; side < 2; side++) {
                double index[3] = {2.5, 2.5, 1.5};
                index[a] = side ? (double)v.dim[a] - 0.99 : -0.01;
                cw_volume_to_world(&v, index, world);
                assert_true(isnan(cw_volume_sample(&v, world)));
            }
    }
}

static void there_is_no_value_beside_a_gap(void **state)
{
    (void)state;
    float voxels[4 * 3] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, NAN};
    const cw_volume v = {
        .data = voxels, .type = CW_F32, .dim = {4, 3, 1}, .has_nodata = true, .nodata = 4};
    const double samples[][3] = {/* x, y, value */
                                 {1.5, 0.25, 2.5}, {0.5, 0.5, NAN}, {2.5, 1.5, NAN},
                                 {2, 2, 10},       {3, 2, NAN},     {0, 1, NAN},
                                 {1, 1, 5},        {-0.1, 0, NAN}};
    for (size_t n = 0; n < sizeof samples / sizeof *samples; n++)
        for (int level = -2; level <= 2; level++) {
            const double world[3] = {samples[n][0], samples[n][1], 0.3 * level};
            const double value = cw_volume_sample(&v, world);
            if (isnan(samples[n][2]) || abs(level) == 2)
                assert_true(isnan(value));
            else
                assert_near(value, samples[n][2], 1e-12);
        }
    assert_true(isnan(cw_volume_sample(&(cw_volume){0}, (const double[3]){0})));
    assert_true(isnan(cw_volume_sample(&v, (const double[3]){NAN, 0, 0})));
}

/* 3, 4 and 12 make 13; a component without a value leaves none. */
static void the_magnitude_is_the_length_of_all_components(void **state)
{
    (void)state;
    const int16_t voxels[] = {3, 4, 12, 0, -5, 0, 1, 99, 1};
    cw_volume v = {.data = voxels,
                   .type = CW_I16,
                   .dim = {3, 1, 1},
                   .components = 3,
                   .slope = 2,
                   .has_nodata = true,
                   .nodata = 99};
    cw_volume m;
    cw_error err = {0};
    v.affine[0][0] = v.affine[1][1] = v.affine[2][2] = 7;
    assert_ok(cw_volume_magnitude(&v, 0, 1, &m, &err), err);
    assert_int_equal(m.type, CW_F32);
    assert_true(cw_volume_value(&m, 0, 0, 0) == 26);
    assert_true(cw_volume_value(&m, 1, 0, 0) == 10);
    assert_true(isnan(cw_volume_value(&m, 2, 0, 0)));
    assert_true(m.affine[1][1] == 7);
    cw_volume_free(&m);
    assert_fails(cw_volume_magnitude(&v, 1, 1, &m, &err), CW_ERR_ARGUMENT, "step 1", err);
    v.components = 1;
    assert_fails(cw_volume_magnitude(&v, 0, 1, &m, &err), CW_ERR_ARGUMENT, "has one", err);
}

enum { SIDE = 40 };

/* Four kinds of values: boxes of labels, the same with noise, a ramp in steps of several
 * voxels, one box of ones. */
static uint8_t value_of_kind(int kind, size_t i, size_t j, size_t k)
{
    const bool inside = i > 5 && i < 35 && j > 5 && j < 35 && k > 5;
    const size_t label = inside ? 3 + i / 12 + 3 * (j / 16) + 5 * (k / 20) : 0;
    const size_t noise = (i + 2 * j + k) % 3;
    switch (kind) {
    case 0:
        return (uint8_t)label;
    case 1:
        return (uint8_t)(inside ? 10 * label + noise : 0);
    case 2:
        return (uint8_t)(i / 5);
    default:
        return inside;
    }
}

static void label_maps_are_told_from_pictures(void **state)
{
    (void)state;
    static uint8_t voxels[SIDE * SIDE * SIDE];
    cw_volume v = {.data = voxels, .type = CW_U8, .dim = {SIDE, SIDE, SIDE}};
    cw_labels labels;
    cw_error err = {0};
    for (int kind = 0; kind < 4; kind++) {
        for (size_t n = 0; n < sizeof voxels; n++)
            voxels[n] = value_of_kind(kind, n % SIDE, n / SIDE % SIDE, n / SIDE / SIDE);
        assert_ok(cw_volume_labels(&v, &labels, &err), err);
        assert_int_equal(labels.found, kind == 0);
        if (kind == 0)
            assert_true(labels.count > 5 && labels.value[0] == 0 && labels.value[1] == 3);
    }
    /* labels beyond a byte, as floats, and more of them than are listed */
    static float floats[SIDE * SIDE * SIDE];
    cw_volume f = {.data = floats, .type = CW_F32, .dim = {SIDE, SIDE, SIDE}};
    for (size_t n = 0; n < sizeof voxels; n++)
        floats[n] = (float)(1000000 + n / 5 * 7919 % 997);
    assert_ok(cw_volume_labels(&f, &labels, &err), err);
    assert_true(labels.found && labels.more && labels.count == CW_LABELS_MAX);
    floats[7] = 0.5f;
    assert_ok(cw_volume_labels(&f, &labels, &err), err);
    assert_false(labels.found);
    v.known = CW_KNOWN_LABELS;
    assert_ok(cw_volume_labels(&v, &labels, &err), err);
    assert_true(labels.found && labels.count == 2 && labels.value[1] == 1);
}

/* Noise of many values is no label map; noise of few may be one, and many flat blocks are. */
static void amounts_are_told_from_labels(void **state)
{
    (void)state;
    static const struct {
        uint32_t values, block; /* block: voxels in a run of one value */
        bool scattered;
    } rows[] = {{200, 1, true}, {20, 1, false}, {200, 8, false}, {33, 1, true}};
    static uint8_t voxels[SIDE * SIDE * SIDE];
    cw_volume v = {.data = voxels, .type = CW_U8, .dim = {SIDE, SIDE, SIDE}};
    cw_labels labels;
    cw_error err = {0};
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        for (uint32_t n = 0; n < sizeof voxels; n++)
            voxels[n] = (uint8_t)((n / rows[r].block * 2654435761u >> 8) % rows[r].values);
        v.known = 0;
        assert_ok(cw_volume_labels(&v, &labels, &err), err);
        assert_int_equal(labels.scattered, rows[r].scattered);
        v.known = CW_KNOWN_LABELS;
        assert_ok(cw_volume_labels(&v, &labels, &err), err);
        assert_false(labels.scattered);
    }
}

/* Some rows decide; a label that is in none of them is listed like the others. Of many labels
 * the lowest are listed, whatever their order and size. */
static void labels_of_all_voxels_are_listed(void **state)
{
    (void)state;
    enum { EDGE = 200, COUNT = EDGE * EDGE * EDGE };
    float *voxels = calloc(COUNT, sizeof *voxels);
    cw_volume v = {.data = voxels, .type = CW_F32, .dim = {EDGE, EDGE, EDGE}};
    cw_labels labels;
    cw_error err = {0};
    assert_non_null(voxels);
    for (size_t n = 0; n < COUNT; n++)
        voxels[n] = (float)(n % EDGE < 50 ? 0 : 2 + 3 * (n / 7 % EDGE / 30));
    for (int many = 0; many < 2; many++) {
        for (size_t n = 0; n < 300; n++) /* each in one voxel, of rows far apart */
            if (many || n == 0)
                voxels[25000 * n + 25] = (float)(many ? 1000000 - 100 * n : 1);
        assert_ok(cw_volume_labels(&v, &labels, &err), err);
        assert_true(labels.found);
        assert_int_equal(labels.more, many);
        for (size_t n = 1; n < labels.count; n++)
            assert_true(labels.value[n] > labels.value[n - 1]);
        if (many)
            assert_true(labels.count == CW_LABELS_MAX && labels.value[0] == 0 &&
                        labels.value[1] == 2 &&
                        labels.value[CW_LABELS_MAX - 1] == 1000000 - 100 * (300 - 247));
        else
            assert_true(labels.count == 9 && labels.value[1] == 1);
    }
    free(voxels);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(labels_of_all_voxels_are_listed),
        cmocka_unit_test(amounts_are_told_from_labels),
        cmocka_unit_test(the_magnitude_is_the_length_of_all_components),
        cmocka_unit_test(label_maps_are_told_from_pictures),
        cmocka_unit_test(a_zeroed_volume_resolves_to_its_defaults),
        cmocka_unit_test(unusable_volumes_are_refused_by_name),
        cmocka_unit_test(all_eight_types_read_the_same),
        cmocka_unit_test(components_and_steps_are_views),
        cmocka_unit_test(a_crop_stays_where_it_was),
        cmocka_unit_test(a_coarse_view_picks_voxels_where_they_are),
        cmocka_unit_test(steps_that_leave_a_single_voxel_are_refused),
        cmocka_unit_test(indices_and_world_points_are_inverse),
        cmocka_unit_test(linear_fields_are_sampled_exactly),
        cmocka_unit_test(there_is_no_value_beside_a_gap),
        cmocka_unit_test(spacing_is_the_length_of_an_axis),
        cmocka_unit_test(statistics_tell_values_from_the_rest),
        cmocka_unit_test(no_bin_counts_what_has_no_value),
        cmocka_unit_test(integers_get_no_more_bins_than_values),
        cmocka_unit_test(otsu_parts_classes),
        cmocka_unit_test(levels_have_names),
        cmocka_unit_test(scaled_integers_fall_into_their_own_bins),
        cmocka_unit_test(statistics_do_not_depend_on_threads),
        cmocka_unit_test(joined_statistics_are_those_of_the_whole),
        cmocka_unit_test(fields_are_the_same_bytes_for_any_number_of_threads),
        cmocka_unit_test(integer_fields_keep_their_level),
        /* last, as it sets the allocator */
        cmocka_unit_test(counts_of_threads_are_added_one_after_another),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
