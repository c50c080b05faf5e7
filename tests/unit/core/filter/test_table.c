/* Removal of a CT's table, on a body with lungs and an ear that lies on a shell. */
#include "support/noise_volume.h"
#include "support/support.h"

#include "core/base/memory.h"
#include "core/volume/volume.h"

#include <cubewright/filter.h>

#include <math.h>
#include <string.h>

enum { NX = 120, NY = 100, NZ = 30 };

enum part { AIR, BODY, LUNG, EAR, TABLE, BLANKET };

/* Voxels of 2 x 2 x 3 mm. The table touches the body along y, and is 8 mm thick. */
static enum part part_at(size_t i, size_t j, size_t k)
{
    const double x = (double)i - 60, y = (double)j - 45, body = hypot(x / 40, y / 30);
    if (hypot((fabs(x) - 18) / 12, y / 15) < 1)
        return LUNG;
    if (body < 1)
        return BODY;
    if (fabs(y) <= 1 && x >= 38 && x < 46 && k > 10 && k < 16)
        return EAR;
    if (j >= 74 && j < 78 && i > 3 && i < 117)
        return TABLE;
    return j < 5 && i > 50 && i < 80 ? BLANKET : AIR;
}

/* Returns Hounsfield units; the skin has a voxel that is half air. */
static double value_at(size_t i, size_t j, size_t k)
{
    static const double values[] = {
        [AIR] = -1010, [BODY] = 40, [LUNG] = -850, [EAR] = 20, [TABLE] = 100, [BLANKET] = -200};
    const double body = hypot(((double)i - 60) / 41, ((double)j - 45) / 31);
    const enum part p = part_at(i, j, k);
    return p == AIR && body < 1 ? -480 : values[p];
}

static cw_volume make_scan(cw_type type, double slope, double intercept)
{
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, type, (size_t[]){NX, NY, NZ}, 1, 1, &err), err);
    v.slope = slope;
    v.intercept = intercept;
    v.affine[0][0] = v.affine[1][1] = 2;
    v.affine[2][2] = 3;
    char *p = cw_volume_voxels(&v);
    for (size_t n = 0; n < (size_t)NX * NY * NZ; n++, p += cw_type_size(type))
        cwi_voxel_put(type, p,
                      (value_at(n % NX, n / NX % NY, n / NX / NY) - intercept) / slope);
    return v;
}

static void the_body_stays_and_the_rest_is_air(void **state)
{
    (void)state;
    static const struct {
        cw_type type;
        double slope, intercept;
    } rows[] = {{CW_I16, 1, 0}, {CW_U16, 1, -1024}, {CW_F32, 0.5, 3}, {CW_I32, -1, 0}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        cw_volume v = make_scan(rows[n].type, rows[n].slope, rows[n].intercept), out;
        cw_error err = {0};
        double removed, expected = 0;
        size_t lost = 0;
        assert_ok(cw_volume_remove_table(&v, NULL, &out, &removed, &err), err);
        assert_int_equal(out.type, v.type);
        for (size_t k = 0; k < NZ; k++)
            for (size_t j = 0; j < NY; j++)
                for (size_t i = 0; i < NX; i++) {
                    const enum part p = part_at(i, j, k);
                    const double was = stored_at(&v, i, j, k), is = stored_at(&out, i, j, k);
                    const double value = out.slope * is + out.intercept;
                    const bool is_skin = p == AIR && value_at(i, j, k) > -1000;
                    expected += p == TABLE || p == BLANKET ? 12 : 0;
                    if (p == BODY || p == LUNG || p == EAR)
                        assert_true(is == was);
                    else if (p == TABLE || p == BLANKET)
                        lost += fabs(value + 1000) > 0.5;
                    else if (is_skin) /* the table is not a part of the edge */
                        assert_true(is == was || j > 70);
                    else
                        assert_true(is == was || fabs(value + 1000) < 0.5);
                }
        assert_true((double)lost * 12 < 0.3 * expected); /* under the contact */
        assert_within(removed, expected - 12 * (double)lost, 0.02);
        cw_volume_free(&out);
        cw_volume_free(&v);
    }
}

static void nothing_solid_is_an_error(void **state)
{
    (void)state;
    cw_volume v = make_scan(CW_I16, 1, 0), out;
    cw_error err = {0};
    memset(cw_volume_voxels(&v), 0x80, (size_t)NX * NY * NZ * 2);
    assert_fails(cw_volume_remove_table(&v, NULL, &out, NULL, &err), CW_ERR_EMPTY,
                 "nothing above -300 HU", err);
    assert_null(out.data);
    cw_volume_free(&v);
}

/* A thing that is a plate for the most part: what stays would be a lump on it. */
static void what_is_mostly_thin_is_no_body(void **state)
{
    (void)state;
    cw_volume v = make_scan(CW_I16, 1, 0), out;
    cw_error err = {0};
    int16_t *values = cw_volume_voxels(&v);
    for (size_t n = 0; n < (size_t)NX * NY * NZ; n++) {
        const size_t i = n % NX, j = n / NX % NY;
        const bool is_plate = j >= 50 && j < 53 && i > 3 && i < 117,
                   is_lump = j >= 38 && j < 53 && i >= 50 && i < 62;
        values[n] = is_plate || is_lump ? 100 : -1000;
    }
    assert_fails(cw_volume_remove_table(&v, NULL, &out, NULL, &err), CW_ERR_UNSAFE,
                 "cannot be told from the body", err);
    assert_null(out.data);
    cw_volume_free(&v);
}

/* A hollow head: its shell is thinner than the ball. */
static void shells_are_filled(void **state)
{
    (void)state;
    cw_volume v, out;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, CW_F32, (size_t[]){60, 60, 60}, 1, 1, &err), err);
    float *p = cw_volume_voxels(&v);
    v.affine[0][0] = v.affine[1][1] = v.affine[2][2] = 2;
    for (size_t n = 0; n < 60 * 60 * 60; n++) {
        const double x = (double)(n % 60) - 30, y = (double)(n / 60 % 60) - 30,
                     z = (double)(n / 3600) - 30;
        const double r = sqrt(x * x + y * y + z * z);
        p[n] = (r > 20 && r < 23) || n % 60 < 2 ? 300 : -1000;
    }
    assert_ok(cw_volume_remove_table(&v, NULL, &out, NULL, &err), err);
    for (size_t n = 0; n < 60 * 60 * 60; n++)
        assert_true(((const float *)out.data)[n] == (n % 60 < 2 ? -1000 : p[n]));
    cw_volume_free(&out);
    cw_volume_free(&v);
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
    cw_volume v = make_scan(CW_I16, 1, 0), out, more;
    cw_error err = {0};
    const cw_filter_desc stopped = {.threads = 1, .progress = {.report = refuse_progress}},
                         small = {.max_bytes = 1000}, one = {.threads = 1},
                         five = {.threads = 5};
    assert_int_equal(cw_volume_remove_table(&v, &stopped, &out, NULL, &err), CW_ERR_CANCELLED);
    assert_null(out.data);
    assert_int_equal(cw_volume_remove_table(&v, &small, &out, NULL, &err), CW_ERR_LIMIT);
    assert_null(out.data);
    long n = 0;
    for (cw_status st = CW_ERR_NO_MEMORY; st != CW_OK; n += n < 20 ? 1 : 37) {
        cwi_alloc_fail_after(n);
        st = cw_volume_remove_table(&v, &one, &out, NULL, &err);
        cwi_alloc_fail_after(-1);
        assert_true(st == CW_OK || (st == CW_ERR_NO_MEMORY && !out.data));
    }
    assert_true(n > 20);
    assert_ok(cw_volume_remove_table(&v, &five, &more, NULL, &err), err);
    assert_memory_equal(out.data, more.data, (size_t)NX * NY * NZ * 2);
    assert_fails(cw_volume_remove_table(NULL, NULL, &out, NULL, &err), CW_ERR_ARGUMENT,
                 "volume", err);
    cw_volume_free(&more);
    cw_volume_free(&out);
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_body_stays_and_the_rest_is_air),
        cmocka_unit_test(nothing_solid_is_an_error),
        cmocka_unit_test(what_is_mostly_thin_is_no_body),
        cmocka_unit_test(shells_are_filled),
        cmocka_unit_test(limits_are_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
