/* Makes volumes of noise, and reads single voxels of them. */
#include "support/noise_volume.h"

#include "core/volume/volume.h"
#include "support/support.h"

#include <math.h>
#include <stdlib.h>

const cw_type noise_types[NOISE_TYPES] = {CW_U8,  CW_I8,  CW_U16, CW_I16,
                                          CW_U32, CW_I32, CW_F32, CW_F64};

cw_volume make_noise_volume(cw_type type, const size_t dim[3], bool gaps)
{
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, type, dim, 1, 1, &err), err);
    char *p = cw_volume_voxels(&v);
    const bool is_float = type == CW_F32 || type == CW_F64;
    const int low = type == CW_I8 || type == CW_I16 || type == CW_I32 ? -100 : 0;
    v.has_nodata = gaps;
    v.nodata = 7;
    for (size_t n = 0; n < dim[0] * dim[1] * dim[2]; n++, p += cw_type_size(type)) {
        const double x = low + rand() % 120 + (is_float ? 0.25 : 0);
        const bool gap = gaps && rand() % 9 == 0;
        cwi_voxel_put(type, p, !gap ? (x == 7 ? 8 : x) : is_float && n % 2 ? (double)NAN : 7);
    }
    v.affine[0][0] = 0.5;
    v.affine[1][1] = 2;
    v.affine[2][2] = 0.75;
    v.affine[0][3] = -11;
    return v;
}

double stored_at(const cw_volume *v, size_t i, size_t j, size_t k)
{
    return cwi_voxel_at(v->type, cwi_voxel_address(v, i, j, k));
}

bool is_gap(const cw_volume *v, double x)
{
    return !isfinite(x) || (v->has_nodata && x == v->nodata);
}

size_t clamp_index(long n, size_t count)
{
    return n < 0 ? 0 : n < (long)count ? (size_t)n : count - 1;
}

double value_near(const cw_volume *v, const size_t at[3], long x, long y, long z)
{
    return stored_at(v, clamp_index((long)at[0] + x, v->dim[0]),
                     clamp_index((long)at[1] + y, v->dim[1]),
                     clamp_index((long)at[2] + z, v->dim[2]));
}

void assert_filtered(const cw_volume *in, const cw_volume *out,
                     double (*expected)(const cw_volume *, const size_t[3], const void *),
                     const void *context)
{
    for (size_t k = 0; k < in->dim[2]; k++)
        for (size_t j = 0; j < in->dim[1]; j++)
            for (size_t i = 0; i < in->dim[0]; i++) {
                const double got = stored_at(out, i, j, k),
                             right = expected(in, (size_t[]){i, j, k}, context);
                assert_int_equal(is_gap(out, got), isnan(right));
                assert_true(isnan(right) || fabs(got - right) <= 1e-3);
            }
}
