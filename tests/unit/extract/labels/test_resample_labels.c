/* A sample has the label of the largest share of a Gaussian, as sums over all labels by hand tell. */
#include "support/support.h"

#include <cubewright/filter.h>
#include <cubewright/labels.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 14, MOST = SIDE * SIDE * SIDE };

/* A random map: runs of labels, or each voxel by itself. */
typedef struct random_map {
    uint32_t voxels[MOST];
    cw_volume volume;
    int labels;
} random_map;

static void make_map(random_map *m, int round)
{
    static const int kinds[] = {2, 4, 40, 3000};
    size_t count = 1;
    m->volume = (cw_volume){.data = m->voxels, .type = CW_U32};
    m->labels = kinds[round % 4];
    for (int a = 0; a < 3; a++) {
        m->volume.dim[a] = 4 + (size_t)rand() % (SIDE - 3);
        count *= m->volume.dim[a];
        for (int r = 0; r < 4; r++)
            m->volume.affine[a][r] = a == r ? 0.5 + rand() % 5 : 0.1 * (rand() % 3);
    }
    for (size_t n = 0; n < count; n++)
        m->voxels[n] = n > 0 && rand() % 3 && m->labels < 99
                           ? m->voxels[n - 1]
                           : (uint32_t)(rand() % m->labels) * 7;
}

/* Returns the label of a voxel; beyond the border of the one beside. */
static uint32_t label_at(const cw_volume *v, const double at[3])
{
    size_t n[3];
    for (int a = 0; a < 3; a++)
        n[a] = (size_t)fmin(fmax(at[a], 0), (double)v->dim[a] - 1);
    return ((const uint32_t *)v->data)[(n[2] * v->dim[1] + n[1]) * v->dim[0] + n[0]];
}

/* Adds up the shares of all labels around a place, by definition. */
static void sum_shares(const cw_volume *v, const double at[3], const double wider[3],
                       double *shares)
{
    double p[3], all = 0;
    memset(shares, 0, 3000 * sizeof *shares);
    for (p[2] = ceil(at[2] - 2 * wider[2]); p[2] <= at[2] + 2 * wider[2]; p[2]++)
        for (p[1] = ceil(at[1] - 2 * wider[1]); p[1] <= at[1] + 2 * wider[1]; p[1]++)
            for (p[0] = ceil(at[0] - 2 * wider[0]); p[0] <= at[0] + 2 * wider[0]; p[0]++) {
                double sum = 0;
                for (int a = 0; a < 3; a++)
                    sum += pow((p[a] - at[a]) / (0.5 * wider[a]), 2);
                shares[label_at(v, p) / 7] += exp(-0.5 * sum);
                all += exp(-0.5 * sum);
            }
    for (int n = 0; n < 3000; n++)
        shares[n] /= all;
}

static void each_sample_has_the_label_of_the_largest_share(void **state)
{
    static double shares[3000];
    static random_map m;
    (void)state;
    test_seed(7);
    for (int round = 0; round < test_some(40); round++) {
        double old[3], wider[3], ratio[3];
        cw_volume out;
        cw_error err = {0};
        cw_label_resample_desc desc = {.threads = 1 + round % 3};
        size_t checked = 0;
        make_map(&m, round);
        cw_volume_spacing(&m.volume, old);
        for (int a = 0; a < 3; a++) {
            ratio[a] = (int[]){1, 3, 7, 13}[rand() % 4] / (rand() % 2 ? 5.0 : 11.0);
            desc.spacing_mm[a] = old[a] * ratio[a];
            wider[a] = fmax(1, ratio[a]);
        }
        assert_ok(cw_labels_resample(&m.volume, &desc, &out, &err), err);
        const uint32_t *got = out.data;
        for (size_t z = 0; z < out.dim[2]; z++)
            for (size_t y = 0; y < out.dim[1]; y++)
                for (size_t x = 0; x < out.dim[0]; x++, got++) {
                    const double at[3] = {(double)x * ratio[0], (double)y * ratio[1],
                                          (double)z * ratio[2]};
                    double most = 0;
                    if ((x + y + z) % 5)
                        continue;
                    sum_shares(&m.volume, at, wider, shares);
                    for (int n = 0; n < 3000; n++)
                        most = fmax(most, shares[n]);
                    assert_int_equal(*got % 7, 0);
                    if (shares[*got / 7] < most - 3e-4) /* weights are rounded */
                        fail_msg("round %d: sample %zu %zu %zu", round, x, y, z);
                    checked++;
                }
        assert_true(checked > 0);
        cw_volume_free(&out);
    }
}

static void threads_and_types_give_the_same(void **state)
{
    static random_map m;
    static float floats[MOST];
    (void)state;
    test_seed(3);
    for (int round = 0; round < 12; round++) {
        cw_volume one, out;
        cw_error err = {0};
        cw_label_resample_desc desc = {.spacing_mm = {0.4, 0.7, 0.3},
                                       .kernel = (cw_label_kernel)(round % 2),
                                       .threads = 1};
        make_map(&m, round);
        assert_ok(cw_labels_resample(&m.volume, &desc, &one, &err), err);
        for (int n = 0; n < MOST; n++)
            floats[n] = (float)m.voxels[n];
        for (int way = 0; way < 3; way++) {
            cw_volume v = m.volume;
            desc.threads = (int[]){2, 7, 0}[way];
            if (way == 2) {
                v.data = floats;
                v.type = CW_F32;
            }
            assert_ok(cw_labels_resample(&v, &desc, &out, &err), err);
            assert_memory_equal(out.dim, one.dim, sizeof out.dim);
            assert_memory_equal(out.data, one.data,
                                out.dim[0] * out.dim[1] * out.dim[2] * sizeof(uint32_t));
            cw_volume_free(&out);
        }
        cw_volume_free(&one);
    }
}

static void the_grid_is_that_of_values(void **state)
{
    static random_map m;
    (void)state;
    test_seed(5);
    for (int round = 0; round < 12; round++) {
        static const double uneven[SIDE] = {0, 1, 3, 4, 6, 9, 10, 12, 13, 15, 16, 19, 20, 22};
        const double mm[3] = {0.4 + 0.5 * (round % 3), 0.7, round % 2 ? 0 : 1.1};
        cw_label_resample_desc desc = {.spacing_mm = {mm[0], mm[1], mm[2]}};
        cw_volume labels, values;
        cw_error err = {0};
        make_map(&m, round);
        for (int a = 0; a < 3; a++)
            m.volume.coordinates[a] = round % 4 == 1 ? uneven : NULL;
        assert_ok(cw_labels_resample(&m.volume, &desc, &labels, &err), err);
        assert_ok(cw_volume_resample(&m.volume, mm, CW_KERNEL_LINEAR, NULL, &values, &err),
                  err);
        assert_memory_equal(labels.dim, values.dim, sizeof labels.dim);
        assert_memory_equal(labels.affine, values.affine, sizeof labels.affine);
        assert_null(labels.coordinates[1]);
        cw_volume_free(&labels);
        cw_volume_free(&values);
    }
}

/* Balls in slices of 3 mm, which become 1 mm thick. */
static void balls_keep_their_volume(void **state)
{
    enum { EDGE = 61, SLICES = 21 };
    static uint8_t voxels[EDGE * EDGE * SLICES];
    (void)state;
    for (int round = 0; round < 8; round++) {
        const double radius = 16 + round, z0 = 30 + 0.4 * round;
        const cw_volume v = {.data = voxels,
                             .type = CW_U8,
                             .dim = {EDGE, EDGE, SLICES},
                             .affine = {{1}, {0, 1}, {0, 0, 3}}};
        const cw_label_resample_desc desc = {.spacing_mm = {1, 1, 1},
                                             .kernel = (cw_label_kernel)(round % 2)};
        cw_volume out;
        cw_label_count *counts;
        size_t count, before = 0;
        cw_error err = {0};
        for (int n = 0; n < EDGE * EDGE * SLICES; n++) {
            const double x = n % EDGE - 30, y = n / EDGE % EDGE - 30,
                         z = 3.0 * (n / EDGE / EDGE) - z0;
            voxels[n] = x * x + y * y + z * z < radius * radius ? 5 : 0;
            before += voxels[n] == 5;
        }
        assert_ok(cw_labels_resample(&v, &desc, &out, &err), err);
        assert_ok(cw_label_counts(&out, 0, &counts, &count, &err), err);
        assert_int_equal(count, 1);
        assert_within((double)counts->voxels, 3 * (double)before, 0.002);
        assert_within((double)counts->voxels, 4 * acos(-1.0) / 3 * pow(radius, 3), 0.02);
        cw_label_counts_free(counts);
        cw_volume_free(&out);
    }
}

/* Sheets of one voxel keep all their voxels, in whatever direction they lie. */
static void thin_sheets_stay(void **state)
{
    static const int normals[][3] = {{1, 0, 0},  {0, 0, 1}, {1, 1, 0},
                                     {0, 1, -1}, {1, 1, 1}, {1, -1, 1}};
    enum { EDGE = 12, FINER = 3 };
    static uint16_t voxels[EDGE * EDGE * EDGE];
    (void)state;
    for (size_t s = 0; s < sizeof normals / sizeof *normals; s++) {
        const int *m = normals[s];
        const cw_volume v = {.data = voxels, .type = CW_U16, .dim = {EDGE, EDGE, EDGE}};
        const cw_label_resample_desc desc = {
            .spacing_mm = {1.0 / FINER, 1.0 / FINER, 1.0 / FINER}};
        cw_volume out;
        cw_error err = {0};
        for (int n = 0; n < EDGE * EDGE * EDGE; n++) {
            const int x = n % EDGE - 6, y = n / EDGE % EDGE - 6, z = n / EDGE / EDGE - 6;
            voxels[n] = m[0] * x + m[1] * y + m[2] * z == 0 ? 300 : 9;
        }
        assert_ok(cw_labels_resample(&v, &desc, &out, &err), err);
        for (size_t n = 0; n < EDGE * EDGE * EDGE; n++) {
            const size_t x = n % EDGE * FINER, y = n / EDGE % EDGE * FINER,
                         z = n / EDGE / EDGE * FINER;
            if (voxels[n] == 300)
                assert_int_equal(
                    ((const uint32_t *)out.data)[(z * out.dim[1] + y) * out.dim[0] + x], 300);
        }
        cw_volume_free(&out);
    }
}

/* Half way between two voxels shares are equal. */
static void ties_go_to_the_nearest_voxel_or_to_the_lowest_label(void **state)
{
    static const struct {
        uint8_t voxels[9];
        size_t dim;
        double spacing;
        uint8_t expected[9];
        size_t count;
    } cases[] = {
        {{5, 3}, 2, 0.5, {5, 5, 3}, 3},
        {{3, 5}, 2, 0.5, {3, 3, 5}, 3},
        {{0, 4, 4, 0}, 4, 0.5, {0, 0, 4, 4, 4, 4, 0}, 7}, /* as thick as before */
        {{2, 2, 2, 2, 9, 1, 1, 1, 1}, 9, 4, {2, 1, 1}, 3},
    };
    (void)state;
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        const cw_volume v = {.data = cases[c].voxels, .dim = {cases[c].dim, 1, 1}};
        const cw_label_resample_desc desc = {.spacing_mm = {cases[c].spacing}};
        cw_volume out;
        cw_error err = {0};
        assert_ok(cw_labels_resample(&v, &desc, &out, &err), err);
        assert_int_equal(out.dim[0], cases[c].count);
        for (size_t n = 0; n < cases[c].count; n++)
            assert_int_equal(((const uint32_t *)out.data)[n], cases[c].expected[n]);
        cw_volume_free(&out);
    }
}

static void nearest_copies_voxels(void **state)
{
    static random_map m;
    (void)state;
    test_seed(9);
    for (int round = 0; round < 12; round++) {
        double old[3];
        cw_label_resample_desc desc = {.kernel = CW_LABEL_KERNEL_NEAREST};
        cw_volume out;
        cw_error err = {0};
        make_map(&m, round);
        cw_volume_spacing(&m.volume, old);
        for (int a = 0; a < 3 && round % 3; a++)
            desc.spacing_mm[a] = old[a] * (round % 3 == 1 ? 0.3 : 2.3);
        assert_ok(cw_labels_resample(&m.volume, &desc, &out, &err), err);
        const uint32_t *got = out.data;
        for (size_t n = 0; n < out.dim[0] * out.dim[1] * out.dim[2]; n++) {
            const double step = (double[]){1, 0.3, 2.3}[round % 3],
                         x = step * (double)(n % out.dim[0]),
                         y = step * (double)(n / out.dim[0] % out.dim[1]),
                         z = step * (double)(n / out.dim[0] / out.dim[1]);
            const double at[3] = {ceil(x - 0.5 - 1e-5), ceil(y - 0.5 - 1e-5),
                                  ceil(z - 0.5 - 1e-5)};
            assert_int_equal(got[n], label_at(&m.volume, at));
        }
        cw_volume_free(&out);
    }
}

static void what_cannot_be_sampled_is_told(void **state)
{
    float voxels[27] = {0};
    const cw_volume v = {.data = voxels, .type = CW_F32, .dim = {3, 3, 3}};
    cw_label_resample_desc desc = {.spacing_mm = {0.5, 0.5, 0.5}};
    cw_volume out;
    cw_error err = {0};
    int polls = 0;
    (void)state;
    voxels[4] = NAN; /* background */
    desc.background = 8;
    assert_ok(cw_labels_resample(&v, &desc, &out, &err), err);
    assert_int_equal(((const uint32_t *)out.data)[2 * 5 + 2], 8);
    cw_volume_free(&out);
    voxels[13] = 0.5f;
    voxels[22] = -1;
    assert_fails(cw_labels_resample(&v, &desc, &out, &err), CW_ERR_ARGUMENT,
                 "voxel 1, 1, 1 is 0.5", err);
    assert_null(out.data);
    voxels[13] = 0;
    assert_fails(cw_labels_resample(&v, &desc, &out, &err), CW_ERR_ARGUMENT,
                 "voxel 1, 1, 2 is -1", err);
    voxels[22] = 0;
    desc.spacing_mm[1] = -1;
    assert_fails(cw_labels_resample(&v, &desc, &out, &err), CW_ERR_ARGUMENT, "spacing_mm[1]",
                 err);
    desc.spacing_mm[1] = 5;
    assert_fails(cw_labels_resample(&v, &desc, &out, &err), CW_ERR_ARGUMENT, "two samples",
                 err);
    desc.spacing_mm[1] = 1e-12;
    assert_fails(cw_labels_resample(&v, &desc, &out, &err), CW_ERR_LIMIT, "spacing_mm[1]", err);
    desc.spacing_mm[1] = 0.01;
    desc.max_bytes = 10000;
    assert_fails(cw_labels_resample(&v, &desc, &out, &err), CW_ERR_LIMIT, "10000", err);
    desc.max_bytes = 0;
    desc.kernel = (cw_label_kernel)7;
    assert_fails(cw_labels_resample(&v, &desc, &out, &err), CW_ERR_ARGUMENT, "kernel is 7",
                 err);
    desc.kernel = CW_LABEL_KERNEL_MAJORITY;
    desc.progress = (cw_progress){.report = test_stop_after, .user = &polls};
    assert_int_equal(cw_labels_resample(&v, &desc, &out, &err), CW_ERR_CANCELLED);
    assert_string_equal(cw_label_kernel_name(CW_LABEL_KERNEL_NEAREST), "nearest");
    assert_null(cw_label_kernel_name(CW_LABEL_KERNEL_COUNT));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_sample_has_the_label_of_the_largest_share),
        cmocka_unit_test(threads_and_types_give_the_same),
        cmocka_unit_test(the_grid_is_that_of_values),
        cmocka_unit_test(balls_keep_their_volume),
        cmocka_unit_test(thin_sheets_stay),
        cmocka_unit_test(ties_go_to_the_nearest_voxel_or_to_the_lowest_label),
        cmocka_unit_test(nearest_copies_voxels),
        cmocka_unit_test(what_cannot_be_sampled_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
