/* Masks, opening and closing of what is inside, held against balls around every voxel. */
#include "support/noise_volume.h"
#include "support/support.h"

#include "core/base/memory.h"
#include "core/volume/volume.h"

#include <cubewright/filter.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_VOXELS = 12 * 11 * 10 };

static bool is_inside(const cw_volume *v, const cw_inside *inside, double stored)
{
    const double value = v->slope * stored + v->intercept;
    if (is_gap(v, stored))
        return false;
    return inside->inside_is_low ? value < inside->level : value >= inside->level;
}

static size_t voxel_count(const cw_volume *v)
{
    return v->dim[0] * v->dim[1] * v->dim[2];
}

static double stored_number(const cw_volume *v, size_t n)
{
    return stored_at(v, n % v->dim[0], n / v->dim[0] % v->dim[1], n / v->dim[0] / v->dim[1]);
}

/* Sets what is within a ball of a voxel that is set. */
static void spread_by_hand(const cw_volume *v, const bool *from, bool value,
                           const double radius[3], bool *to)
{
    const size_t *dim = v->dim;
    for (size_t n = 0; n < voxel_count(v); n++) {
        to[n] = false;
        for (size_t m = 0; m < voxel_count(v) && !to[n]; m++) {
            const double by[3] = {(double)(n % dim[0]) - (double)(m % dim[0]),
                                  (double)(n / dim[0] % dim[1]) - (double)(m / dim[0] % dim[1]),
                                  (double)(n / dim[0] / dim[1]) -
                                      (double)(m / dim[0] / dim[1])};
            double sum = 0;
            for (int a = 0; a < 3; a++)
                sum += by[a] == 0 ? 0 : radius[a] > 0 ? pow(by[a] / radius[a], 2) : 9;
            to[n] = from[m] == value && sum <= 1 + 1e-9;
        }
    }
}

/* Sets what no ball without an inside voxel reaches; balls may lie beyond the border. */
static void close_by_hand(const cw_volume *v, const bool *is, const double radius[3], bool *to)
{
    const size_t *dim = v->dim;
    long pad[3], c[3];
    for (int a = 0; a < 3; a++)
        pad[a] = (long)ceil(radius[a]);
    memset(to, 1, voxel_count(v) * sizeof *to);
    for (c[2] = -pad[2]; c[2] < (long)dim[2] + pad[2]; c[2]++)
        for (c[1] = -pad[1]; c[1] < (long)dim[1] + pad[1]; c[1]++)
            for (c[0] = -pad[0]; c[0] < (long)dim[0] + pad[0]; c[0]++) {
                bool reached[MOST_VOXELS], empty = true;
                for (size_t n = 0; n < voxel_count(v); n++) {
                    const long at[3] = {(long)(n % dim[0]), (long)(n / dim[0] % dim[1]),
                                        (long)(n / dim[0] / dim[1])};
                    double sum = 0;
                    for (int a = 0; a < 3; a++) {
                        const double by = (double)(at[a] - c[a]);
                        sum += by == 0 ? 0 : radius[a] > 0 ? pow(by / radius[a], 2) : 9;
                    }
                    reached[n] = sum <= 1 + 1e-9;
                    empty = empty && !(reached[n] && is[n]);
                }
                for (size_t n = 0; empty && n < voxel_count(v); n++)
                    to[n] = to[n] && !reached[n];
            }
}

/* Holds a result against what should be inside: changed voxels are mirrored, others have their bytes. */
static void assert_changed(const cw_volume *v, const cw_volume *out, const cw_inside *inside,
                           const bool *expected)
{
    const double mirror = (inside->level - v->intercept) / v->slope;
    for (size_t n = 0; n < voxel_count(v); n++) {
        const double was = stored_number(v, n), is = stored_number(out, n);
        if (is_gap(v, was)) {
            assert_true(is_gap(out, is));
            continue;
        }
        assert_int_equal(is_inside(out, inside, is), expected[n]);
        if (is_inside(v, inside, was) == expected[n])
            assert_true(is == was);
        else if (v->type == CW_F32 || v->type == CW_F64)
            assert_true(fabs(is + was - 2 * mirror) < 1e-4);
    }
}

static void opening_and_closing_are_those_of_balls(void **state)
{
    (void)state;
    const double radii[][3] = {{1, 1, 1}, {2.3, 1.5, 0}, {0, 0, 3}, {3, 2, 2}, {0, 0, 0}};
    srand(test_seed(13));
    for (size_t n = 0; n < NOISE_TYPES * 5; n += test_is_short() ? 3 : 1) {
        const double *radius = radii[n % 5];
        cw_volume v = make_noise_volume(noise_types[n % NOISE_TYPES], (size_t[]){12, 11, 10},
                                        n % 3 == 0),
                  out;
        bool is[MOST_VOXELS], work[MOST_VOXELS], expected[MOST_VOXELS];
        const double stored =
            v.type == CW_I8 || v.type == CW_I16 || v.type == CW_I32 ? -70 : 30;
        cw_error err = {0};
        v.slope = n % 4 == 1 ? -2 : 0.5;
        v.intercept = 3;
        const cw_inside inside = {.level = v.slope * stored + v.intercept,
                                  .inside_is_low = n % 2 == 1};
        for (int closes = 0; closes < 2; closes++) {
            for (size_t i = 0; i < voxel_count(&v); i++)
                is[i] = is_inside(&v, &inside, stored_number(&v, i));
            spread_by_hand(&v, is, false, radius, work);
            spread_by_hand(&v, work, false, radius, expected);
            if (closes)
                close_by_hand(&v, is, radius, expected);
            assert_ok(closes ? cw_volume_close(&v, radius, &inside, NULL, &out, &err)
                             : cw_volume_open(&v, radius, &inside, NULL, &out, &err),
                      err);
            assert_int_equal(out.type, v.type);
            assert_memory_equal(out.affine, v.affine, sizeof v.affine);
            assert_changed(&v, &out, &inside, expected);
            cw_volume_free(&out);
        }
        cw_volume_free(&v);
    }
}

/* The mask has other voxels, turned axes, and ends within the volume. */
static void masks_are_sampled_in_the_world(void **state)
{
    (void)state;
    srand(test_seed(14));
    for (size_t n = 0; n < NOISE_TYPES; n++) {
        cw_volume v = make_noise_volume(noise_types[n], (size_t[]){12, 11, 10}, n % 2 == 0),
                  out,
                  mask = make_noise_volume(noise_types[n], (size_t[]){9, 5, 6}, n % 3 == 0);
        bool expected[MOST_VOXELS];
        cw_error err = {0};
        const cw_inside inside = {.level = n % 2 ? 40 : 25, .inside_is_low = n > 4};
        char *p = cw_volume_voxels(&mask);
        for (size_t i = 0; i < voxel_count(&mask); i++, p += cw_type_size(mask.type))
            if (rand() % 2)
                cwi_voxel_put(mask.type, p, 0);
        memset(mask.affine, 0, sizeof mask.affine);
        mask.affine[0][1] = -1.1; /* its y runs along -x */
        mask.affine[1][0] = 2.3;
        mask.affine[2][2] = 1.7;
        mask.affine[0][3] = -7;
        for (size_t i = 0; i < voxel_count(&v); i++) {
            const double index[3] = {(double)(i % 12), (double)(i / 12 % 11),
                                     (double)(i / 132)};
            double world[3], at[3];
            bool is_there = true;
            cw_volume_to_world(&v, index, world);
            assert_ok(cw_volume_to_index(&mask, world, at, &err), err);
            for (int a = 0; a < 3; a++) {
                at[a] = floor(at[a] + 0.5);
                is_there = is_there && at[a] >= 0 && at[a] < (double)mask.dim[a];
            }
            const double m =
                is_there ? stored_at(&mask, (size_t)at[0], (size_t)at[1], (size_t)at[2]) : 0;
            expected[i] =
                is_inside(&v, &inside, stored_number(&v, i)) && m != 0 && !is_gap(&mask, m);
        }
        assert_ok(cw_volume_mask(&v, &mask, &inside, NULL, &out, &err), err);
        assert_changed(&v, &out, &inside, expected);
        cw_volume_free(&out);
        cw_volume_free(&mask);
        cw_volume_free(&v);
    }
}

static void boxes_hold_what_is_inside(void **state)
{
    (void)state;
    cw_volume v;
    cw_box box;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, CW_I16, (size_t[]){20, 30, 40}, 1, 1, &err), err);
    int16_t *p = cw_volume_voxels(&v);
    memset(p, 0, 20 * 30 * 40 * sizeof *p);
    const cw_inside inside = {.level = 5}, low = {.level = 5, .inside_is_low = true},
                    none = {.level = 50};
    p[(7 * 30 + 3) * 20 + 6] = 5;
    p[(9 * 30 + 28) * 20 + 4] = 9;
    assert_ok(cw_volume_inside_box(&v, &inside, 0, 1, &box, &err), err);
    assert_memory_equal(&box, (&(cw_box){{4, 3, 7}, {3, 26, 3}}), sizeof box);
    assert_ok(cw_volume_inside_box(&v, &inside, 2, 3, &box, &err), err);
    assert_memory_equal(&box, (&(cw_box){{2, 1, 5}, {7, 29, 7}}), sizeof box);
    assert_ok(cw_volume_inside_box(&v, &low, 2, 0, &box, &err), err);
    assert_memory_equal(&box, (&(cw_box){{0, 0, 0}, {20, 30, 40}}), sizeof box);
    assert_fails(cw_volume_inside_box(&v, &none, 2, 0, &box, &err), CW_ERR_EMPTY,
                 "no voxel is at or above 50", err);
    cw_volume_free(&v);
}

static cw_status run_change(int which, const cw_volume *v, const cw_inside *inside,
                            const cw_filter_desc *d, cw_volume *out, cw_error *err)
{
    const double two[3] = {2, 2, 2};
    return which == 0   ? cw_volume_open(v, two, inside, d, out, err)
           : which == 1 ? cw_volume_close(v, two, inside, d, out, err)
                        : cw_volume_mask(v, v, inside, d, out, err);
}

static bool refuse_progress(void *user, const char *step, double share)
{
    (void)user;
    (void)step;
    (void)share;
    return false;
}

static void limits_are_kept(void **state)
{
    (void)state;
    srand(test_seed(15));
    cw_volume v = make_noise_volume(CW_F32, (size_t[]){12, 11, 10}, true), out, more;
    const cw_inside inside = {.level = 50};
    cw_error err = {0};
    for (int which = 0; which < 3; which++) {
        const cw_filter_desc stopped = {.threads = 1, .progress = {.report = refuse_progress}};
        assert_int_equal(run_change(which, &v, &inside, &stopped, &out, &err),
                         CW_ERR_CANCELLED);
        assert_null(out.data);
        assert_int_equal(
            run_change(which, &v, &inside, &(cw_filter_desc){.max_bytes = 6000}, &out, &err),
            CW_ERR_LIMIT);
        assert_null(out.data);
        long n = 0;
        for (cw_status st = CW_ERR_NO_MEMORY; st != CW_OK; n++) {
            cwi_alloc_fail_after(n);
            st = run_change(which, &v, &inside, &(cw_filter_desc){.threads = 1}, &out, &err);
            cwi_alloc_fail_after(-1);
            assert_true(st == CW_OK || (st == CW_ERR_NO_MEMORY && !out.data));
        }
        assert_true(n > 10);
        assert_ok(run_change(which, &v, &inside, &(cw_filter_desc){.threads = 5}, &more, &err),
                  err);
        assert_memory_equal(out.data, more.data, voxel_count(&v) * sizeof(float));
        cw_volume_free(&more);
        cw_volume_free(&out);
    }
    cw_volume_free(&v);
}

static void bad_arguments_are_named(void **state)
{
    (void)state;
    cw_volume v = make_noise_volume(CW_U8, (size_t[]){9, 9, 9}, false), out;
    const double one[3] = {1, 1, 1};
    const cw_inside inside = {.level = 50}, zero = {.level = 0}, nan = {.level = (double)NAN};
    cw_box box;
    cw_error err = {0};
    assert_fails(cw_volume_open(&v, (double[]){1, -1, 1}, &inside, NULL, &out, &err),
                 CW_ERR_ARGUMENT, "radius_voxels[1] is -1; 0 to 250", err);
    assert_fails(cw_volume_close(&v, (double[]){1, 1, 251}, &inside, NULL, &out, &err),
                 CW_ERR_ARGUMENT, "radius_voxels[2]", err);
    assert_fails(cw_volume_open(&v, one, &nan, NULL, &out, &err), CW_ERR_ARGUMENT,
                 "inside->level is nan", err);
    assert_fails(cw_volume_inside_box(&v, &nan, 1, 0, &box, &err), CW_ERR_ARGUMENT,
                 "inside->level is nan", err);
    ((uint8_t *)cw_volume_voxels(&v))[0] = 0;
    cw_volume mask = v;
    mask.affine[0][3] = 1e6; /* far away: all is outside */
    assert_fails(cw_volume_mask(&v, &mask, &zero, NULL, &out, &err), CW_ERR_ARGUMENT,
                 "voxels of type u8 have no value on its other side", err);
    assert_null(out.data);
    assert_fails(cw_volume_mask(&v, NULL, &zero, NULL, &out, &err), CW_ERR_ARGUMENT, "mask",
                 err);
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(opening_and_closing_are_those_of_balls),
        cmocka_unit_test(masks_are_sampled_in_the_world),
        cmocka_unit_test(boxes_hold_what_is_inside),
        cmocka_unit_test(limits_are_kept),
        cmocka_unit_test(bad_arguments_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
