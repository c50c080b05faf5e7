/* Filters of slices as they are read: the bytes of the filter on the whole volume. */
#include "support/support.h"

#include "core/base/memory.h"
#include "core/synthetic/random_fill.h"
#include "core/volume/volume.h"

#include <cubewright/slice_filter.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NX = 19, NY = 14, NZ = 47 };

static cw_volume make_noise(cw_type type, bool gaps)
{
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, type, (size_t[]){NX, NY, NZ}, 1, 1, &err), err);
    char *p = cw_volume_voxels(&v);
    for (size_t n = 0; n < (size_t)NX * NY * NZ; n++, p += cw_type_size(type))
        cwi_voxel_put(type, p, fmin(fmax(100 + 30 * cwi_gaussian(11, n), 10), 250));
    if (gaps) {
        v.has_nodata = true;
        v.nodata = 7;
        for (size_t n = NX * NY * 20; n < NX * NY * 23; n += 3)
            cwi_voxel_put(type, (char *)cw_volume_voxels(&v) + n * cw_type_size(type), 7);
    }
    return v;
}

/* A source that fails the test when slices are not asked for in rising order. */
typedef struct memory_source {
    const cw_volume *volume;
    size_t next, reads;
} memory_source;

static cw_status read_memory(void *user, size_t first, size_t count, void *to, cw_error *err)
{
    memory_source *m = user;
    const size_t bytes = NX * NY * cw_type_size(m->volume->type);
    (void)err;
    assert_true(first >= m->next || m->reads > 0); /* or from the beginning again */
    assert_true(count > 0 && first + count <= NZ);
    memcpy(to, (const char *)m->volume->data + first * bytes, count * bytes);
    m->next = first + count;
    m->reads++;
    return CW_OK;
}

static cw_slice_source source_of(memory_source *m)
{
    cw_slice_source source = {.shape = *m->volume, .read = read_memory, .user = m};
    source.shape.data = NULL;
    source.shape.owned = NULL;
    return source;
}

static cw_volume filter_whole(const cw_volume *v, const cw_slice_filter_desc *d)
{
    cw_volume out;
    cw_error err = {0};
    assert_ok(d->kind == CW_SLICE_GAUSS ? cw_volume_gauss(v, d->sigma_voxels, NULL, &out, &err)
                                        : cw_volume_median(v, d->radius, NULL, &out, &err),
              err);
    return out;
}

/* Reads all slices, `step` at a time, twice: the second time from the beginning again. */
static void expect_slices(const cw_volume *v, const cw_volume *whole,
                          const cw_slice_filter_desc *desc, size_t step)
{
    memory_source m = {.volume = v};
    const cw_slice_source source = source_of(&m);
    const size_t bytes = NX * NY * cw_type_size(whole->type);
    char *slices = malloc(step * bytes);
    cw_slice_filter *filter;
    cw_error err = {0};
    assert_ok(cw_slice_filter_new(&source, desc, &filter, &err), err);
    const cw_slice_source filtered = cw_slice_filter_source(filter);
    assert_int_equal(filtered.shape.dim[2], NZ);
    assert_int_equal(filtered.shape.type, whole->type);
    assert_int_equal(filtered.shape.stride[2], bytes);
    for (int pass = 0; pass < 2; pass++)
        for (size_t k = 0; k < NZ; k += step) {
            const size_t count = k + step < NZ ? step : NZ - k;
            assert_ok(filtered.read(filtered.user, k, count, slices, &err), err);
            assert_memory_equal(slices, (const char *)whole->data + k * bytes, count * bytes);
        }
    assert_true(cw_slice_filter_bytes(v, desc) >= bytes);
    cw_slice_filter_free(filter);
    free(slices);
}

/* A Gaussian of bytes takes them, floats of them and sums of a thread; few slices take less. */
static void memory_is_told(void **state)
{
    (void)state;
    cw_slice_filter_desc desc = {.sigma_voxels = {1, 1, 1}, .slices = 30, .threads = 1};
    cw_volume v = make_noise(CW_U8, false);
    const size_t slice = NX * NY;
    assert_int_equal(cw_slice_filter_bytes(&v, &desc), 38 * slice * 5 + 10 * slice * 8);
    desc.slices = 1; /* as many as it looks ahead */
    assert_int_equal(cw_slice_filter_bytes(&v, &desc), 13 * slice * 5 + 10 * slice * 8);
    desc.kind = CW_SLICE_MEDIAN;
    assert_int_equal(cw_slice_filter_bytes(&v, &desc), 0); /* no radius */
    desc.radius = 2;
    assert_int_equal(cw_slice_filter_bytes(&v, &desc), 7 * slice * 2);
    assert_int_equal(cw_slice_filter_bytes(NULL, &desc), 0);
    cw_volume_free(&v);
}

static void slices_are_those_of_the_whole_volume(void **state)
{
    (void)state;
    static const cw_slice_filter_desc rows[] = {
        {.sigma_voxels = {1, 1, 1}},
        {.sigma_voxels = {0.5, 0, 2.6}},
        {.sigma_voxels = {2, 1, 0}},
        {.sigma_voxels = {1, 1, 20}}, /* reaches beyond all slices */
        {.kind = CW_SLICE_MEDIAN, .radius = 1},
        {.kind = CW_SLICE_MEDIAN, .radius = 3},
    };
    static const cw_type types[] = {CW_U8, CW_I16, CW_F32, CW_F64};
    static const size_t blocks[] = {0, 1, 5, 16};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++)
        for (size_t t = 0; t < 4; t++)
            for (int gaps = 0; gaps < 2; gaps++) {
                cw_volume v = make_noise(types[t], gaps);
                cw_volume whole = filter_whole(&v, &rows[n]);
                for (size_t b = 0; b < 4; b++) {
                    cw_slice_filter_desc desc = rows[n];
                    desc.slices = blocks[b];
                    desc.threads = 1 + (int)b;
                    expect_slices(&v, &whole, &desc, 1 + 3 * b);
                }
                cw_volume_free(&whole);
                cw_volume_free(&v);
            }
}

/* As a part of a job reads them. */
static void slices_may_begin_anywhere(void **state)
{
    (void)state;
    const cw_slice_filter_desc desc = {.sigma_voxels = {1, 1, 1}, .slices = 6};
    cw_volume v = make_noise(CW_F32, false), whole = filter_whole(&v, &desc);
    memory_source m = {.volume = &v};
    const cw_slice_source source = source_of(&m);
    cw_slice_filter *filter;
    cw_error err = {0};
    float slice[NX * NY];
    assert_ok(cw_slice_filter_new(&source, &desc, &filter, &err), err);
    const cw_slice_source filtered = cw_slice_filter_source(filter);
    static const size_t at[] = {30, 31, 44, 46, 3, 4, 0, 40};
    for (size_t n = 0; n < sizeof at / sizeof *at; n++) {
        assert_ok(filtered.read(filtered.user, at[n], 1, slice, &err), err);
        assert_memory_equal(slice, (const float *)whole.data + at[n] * NX * NY, sizeof slice);
    }
    cw_slice_filter_free(filter);
    cw_volume_free(&whole);
    cw_volume_free(&v);
}

static cw_status fail_read(void *user, size_t first, size_t count, void *to, cw_error *err)
{
    (void)user, (void)first, (void)count, (void)to;
    snprintf(err->message, sizeof err->message, "the disk is gone");
    err->status = CW_ERR_IO;
    return CW_ERR_IO;
}

static void failures_are_told(void **state)
{
    (void)state;
    static const struct {
        cw_slice_filter_desc desc;
        const char *text;
    } bad[] = {{{.kind = (cw_slice_filter_kind)7}, "kind is 7"},
               {{.sigma_voxels = {-1, 0, 0}}, "sigma_voxels[0] is -1"},
               {{.sigma_voxels = {0, 0, NAN}}, "sigma_voxels[2]"},
               {{.kind = CW_SLICE_MEDIAN}, "radius is 0"}};
    cw_volume v = make_noise(CW_F32, false);
    memory_source m = {.volume = &v};
    cw_slice_source source = source_of(&m);
    cw_slice_filter *filter;
    cw_error err;
    float slice[NX * NY];
    for (size_t n = 0; n < sizeof bad / sizeof *bad; n++) {
        assert_fails(cw_slice_filter_new(&source, &bad[n].desc, &filter, &err), CW_ERR_ARGUMENT,
                     bad[n].text, err);
        assert_null(filter);
    }
    const cw_slice_filter_desc desc = {.sigma_voxels = {1, 1, 1}};
    for (long n = 0;; n++) {
        cwi_alloc_fail_after(n);
        cw_status st = cw_slice_filter_new(&source, &desc, &filter, &err);
        if (st == CW_OK)
            st = cw_slice_filter_source(filter).read(filter, 0, 1, slice, &err);
        const bool failed = cwi_alloc_fail_after(-1);
        cw_slice_filter_free(filter);
        if (!failed) {
            assert_ok(st, err);
            assert_true(n > 4);
            break;
        }
        assert_fails(st, CW_ERR_NO_MEMORY, "no memory", err);
    }
    source.read = fail_read;
    assert_ok(cw_slice_filter_new(&source, &desc, &filter, &err), err);
    assert_fails(cw_slice_filter_source(filter).read(filter, 0, 1, slice, &err), CW_ERR_IO,
                 "the disk is gone", err);
    cw_slice_filter_free(filter);
    source.shape.dim[1] = 0;
    assert_fails(cw_slice_filter_new(&source, &desc, &filter, &err), CW_ERR_ARGUMENT,
                 "no voxels", err);
    cw_slice_filter_free(NULL);
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slices_are_those_of_the_whole_volume),
        cmocka_unit_test(slices_may_begin_anywhere),
        cmocka_unit_test(memory_is_told),
        cmocka_unit_test(failures_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
