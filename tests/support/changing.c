/* Paints volumes that change. */
#include "support/changing.h"

#include "support/hostile.h"

#include <math.h>
#include <stdlib.h>

double test_random_number(double limit)
{
    return limit * rand() / ((double)RAND_MAX + 1);
}

static cw_box random_box(const cw_volume *v)
{
    cw_box box;
    for (int a = 0; a < 3; a++) {
        box.first[a] = (size_t)rand() % v->dim[a];
        box.count[a] = (size_t)rand() % (v->dim[a] - box.first[a]) + 1;
        if (rand() % 2 && box.count[a] > 12)
            box.count[a] = 12;
    }
    return box;
}

static double value_of(test_pattern kind, const size_t at[3], double base)
{
    switch (kind) {
    case TEST_WAVES:
        return 50 + 40 * sin(0.4 * (double)at[0] + base) * cos(0.3 * (double)at[1]) +
               10 * sin(0.5 * (double)at[2]);
    case TEST_NOISE:
        return test_random_number(100);
    case TEST_SPOTS:
        return at[0] % 4 == 1 && at[1] % 4 == 1 && at[2] % 4 != 3 ? 90 : 10;
    case TEST_GAPS:
        return rand() % 3 ? base : NAN;
    default:
        return base;
    }
}

void test_paint(cw_volume *v, const cw_box *box, test_pattern kind)
{
    const bool has_nan = v->type == CW_F32 || v->type == CW_F64;
    const double base = floor(test_random_number(100));
    for (size_t k = box->first[2]; k < box->first[2] + box->count[2]; k++)
        for (size_t j = box->first[1]; j < box->first[1] + box->count[1]; j++)
            for (size_t i = box->first[0]; i < box->first[0] + box->count[0]; i++) {
                const double x = value_of(kind, (size_t[3]){i, j, k}, base);
                test_store(v->type, cw_volume_voxels(v), (k * v->dim[1] + j) * v->dim[0] + i,
                           isnan(x) && !has_nan ? 7 : x);
            }
}

void test_paint_all(cw_volume *v, test_pattern kind)
{
    const cw_box all = {{0, 0, 0}, {v->dim[0], v->dim[1], v->dim[2]}};
    test_paint(v, &all, kind);
}

cw_volume test_changing_volume(cw_type type, const size_t dim[3])
{
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, type, dim, 1, 1, &err), err);
    test_paint_all(&v, rand() % TEST_PATTERNS);
    v.slope = rand() % 4 ? 1 : -1;
    v.has_nodata = rand() % 3 == 0;
    v.nodata = 7;
    return v;
}

cw_volume test_some_changing_volume(int round)
{
    static const size_t sizes[][3] = {{2, 2, 2},    {7, 8, 9},    {15, 16, 17}, {33, 40, 24},
                                      {64, 31, 20}, {80, 33, 31}, {130, 9, 20}, {70, 5, 71}};
    return test_changing_volume((cw_type)(round % CW_TYPE_COUNT), sizes[rand() % 8]);
}

const cwi_engine *test_some_engine(int round)
{
    size_t engines = 0;
    while (cwi_engine_at(engines))
        engines++;
    return cwi_engine_at((size_t)round % engines);
}

cw_extract_desc test_random_settings(const cw_volume *v)
{
    return (cw_extract_desc){.isovalue = (rand() % 3 ? 50.3 : floor(test_random_number(100))) *
                                         (v->slope ? v->slope : 1),
                             .inside_is_low = rand() % 2,
                             .leave_open = rand() % 3 == 0,
                             .simple_topology = rand() % 4 == 0,
                             .cubic_placement = rand() % 4 == 0,
                             .no_normals = rand() % 5 == 0,
                             .threads = 1 + rand() % 2};
}

void test_change(cw_volume *v, cw_extractor *e)
{
    cw_error err = {0};
    const int boxes = rand() % 4;
    if (rand() % 6 == 0) {
        test_paint_all(v, rand() % TEST_PATTERNS);
        assert_ok(cw_extractor_update(e, NULL, &err), err);
    }
    for (int n = 0; n < boxes; n++) {
        const cw_box box = random_box(v);
        test_paint(v, &box, rand() % TEST_PATTERNS);
        assert_ok(cw_extractor_update(e, &box, &err), err);
    }
}
