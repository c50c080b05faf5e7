/* Filters slices as they are read: a slab of them, with those around that the filter looks at, is
 * filtered as a volume of its own, and its inner slices are those of the whole volume. */
#include <cubewright/slice_filter.h>

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/thread_pool.h"
#include "core/filter/filter_work.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

/* Limits of the slices that are made together: their bytes, their number. */
enum { BLOCK_BYTES = 32 << 20, MAX_SLICES = 64 };

struct cw_slice_filter {
    cw_slice_source source;
    cw_slice_filter_desc desc;
    cw_type type; /* of filtered slices */
    size_t ahead, raw_bytes,
        slice_bytes; /* bytes of a slice of the source; of a filtered one */
    char *raw;       /* slices of the source from raw_first on, packed */
    size_t raw_first, raw_count, capacity;
    cw_volume made;                /* filtered slices: */
    size_t made_first, made_count; /* of the volume; made has others before them: */
    size_t made_skip;
};

/* Returns the shape of packed slices of a type, of one component and step. */
static cw_volume packed_shape(const cw_slice_filter *f, cw_type type)
{
    cw_volume shape = f->source.shape;
    shape.type = type;
    shape.stride[0] = (ptrdiff_t)cw_type_size(type);
    shape.stride[1] = shape.stride[0] * (ptrdiff_t)shape.dim[0];
    shape.stride[2] = shape.stride[1] * (ptrdiff_t)shape.dim[1];
    shape.components = shape.steps = 1;
    shape.component_stride = shape.step_stride = 0;
    shape.owned = shape.owned_grid = NULL;
    return shape;
}

/* The slab as a volume of its own. Its place in the world does not matter to the filter. */
static cw_volume slab_of(const cw_slice_filter *f)
{
    cw_volume slab = packed_shape(f, f->source.shape.type);
    slab.data = f->raw;
    slab.dim[2] = f->raw_count;
    return slab;
}

static cw_status filter_slab(cw_slice_filter *f, cw_error *err)
{
    const cw_volume slab = slab_of(f);
    const cw_filter_desc desc = {.threads = f->desc.threads};
    cw_volume_free(&f->made);
    return f->desc.kind == CW_SLICE_GAUSS
               ? cw_volume_gauss(&slab, f->desc.sigma_voxels, &desc, &f->made, err)
               : cw_volume_median(&slab, f->desc.radius, &desc, &f->made, err);
}

/* Makes the block that begins at a slice. Keeps slices of the source that the last block had. */
static cw_status make_block(cw_slice_filter *f, size_t first, cw_error *err)
{
    const size_t all = f->source.shape.dim[2];
    const size_t end = first + f->desc.slices < all ? first + f->desc.slices : all;
    const size_t from = first > f->ahead ? first - f->ahead : 0,
                 to = end + f->ahead < all ? end + f->ahead : all;
    size_t have = f->raw_first + f->raw_count;
    if (from < f->raw_first || from >= have) { /* the first, or from the beginning again */
        f->raw_first = from;
        f->raw_count = 0;
        have = from;
    }
    const size_t gone = from - f->raw_first;
    memmove(f->raw, f->raw + gone * f->raw_bytes, (f->raw_count - gone) * f->raw_bytes);
    f->raw_first = from;
    f->raw_count = have - from;
    f->made_count = 0;
    cw_status st = to > have ? f->source.read(f->source.user, have, to - have,
                                              f->raw + f->raw_count * f->raw_bytes, err)
                             : CW_OK;
    if (st != CW_OK) {
        f->raw_count = 0;
        return st;
    }
    f->raw_count = to - from;
    st = filter_slab(f, err);
    if (st == CW_OK) {
        f->made_first = first;
        f->made_count = end - first;
        f->made_skip = first - from;
    }
    return st;
}

static cw_status read_filtered(void *user, size_t first, size_t count, void *to, cw_error *err)
{
    cw_slice_filter *f = user;
    char *next = to;
    cw_status st = CW_OK;
    for (size_t k = first; k < first + count && st == CW_OK; k++) {
        if (k < f->made_first || k >= f->made_first + f->made_count)
            st = make_block(f, k, err);
        if (st != CW_OK)
            return st;
        memcpy(next,
               (const char *)cw_volume_voxels(&f->made) +
                   (k - f->made_first + f->made_skip) * f->slice_bytes,
               f->slice_bytes);
        next += f->slice_bytes;
    }
    return st;
}

static cw_status check_desc(const cw_slice_filter_desc *d, cw_error *err)
{
    if (d->kind != CW_SLICE_GAUSS && d->kind != CW_SLICE_MEDIAN)
        return cwi_fail(err, CW_ERR_ARGUMENT, "kind is %d; it must be 0 or 1", (int)d->kind);
    for (int a = 0; a < 3 && d->kind == CW_SLICE_GAUSS; a++)
        if (!(d->sigma_voxels[a] >= 0 && d->sigma_voxels[a] <= CWI_GAUSS_MAX))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "sigma_voxels[%d] is %g; 0 to %d were expected", a,
                            d->sigma_voxels[a], CWI_GAUSS_MAX);
    if (d->kind == CW_SLICE_MEDIAN && (d->radius < 1 || d->radius > 3))
        return cwi_fail(err, CW_ERR_ARGUMENT, "radius is %zu; 1 to 3 were expected", d->radius);
    return CW_OK;
}

/* Returns an error for shapes that the filters do not take. */
static cw_status check_shape(const cw_volume *shape, cw_error *err)
{
    if (shape->sparse || shape->cells || shape->coordinates[0])
        return cwi_fail(err, CW_ERR_UNSUPPORTED, "slices of even grids alone are filtered");
    if (!cw_type_size(shape->type) || !shape->dim[0] || !shape->dim[1] || !shape->dim[2])
        return cwi_fail(err, CW_ERR_ARGUMENT, "the source has no voxels");
    return CW_OK;
}

/* Sets how many slices are filtered together, and their bytes. */
static void plan_slices(cw_slice_filter *f)
{
    const size_t *dim = f->source.shape.dim;
    f->ahead = f->desc.kind == CW_SLICE_GAUSS
                   ? (size_t)ceil(CWI_GAUSS_REACH * f->desc.sigma_voxels[2])
                   : f->desc.radius;
    f->type = f->desc.kind == CW_SLICE_GAUSS ? cw_filter_type(&f->source.shape)
                                             : f->source.shape.type;
    f->raw_bytes = dim[0] * dim[1] * cw_type_size(f->source.shape.type);
    f->slice_bytes = dim[0] * dim[1] * cw_type_size(f->type);
    if (!f->desc.slices)
        f->desc.slices = BLOCK_BYTES / f->slice_bytes < MAX_SLICES
                             ? BLOCK_BYTES / f->slice_bytes
                             : MAX_SLICES;
    /* as many as the filter looks at, so that its window is never cut but at the ends */
    if (f->desc.slices <= f->ahead)
        f->desc.slices = f->ahead + 1;
    f->capacity = f->desc.slices + 2 * f->ahead;
    f->capacity = f->capacity < dim[2] ? f->capacity : dim[2];
}

size_t cw_slice_filter_bytes(const cw_volume *shape, const cw_slice_filter_desc *desc)
{
    enum { LAYERS = 32 }; /* a thread's part of a Gaussian */
    if (!shape || !desc || check_desc(desc, NULL) != CW_OK || check_shape(shape, NULL) != CW_OK)
        return 0;
    cw_slice_filter f = {.source = {.shape = *shape}, .desc = *desc};
    plan_slices(&f);
    const bool has_gaps = shape->has_nodata || shape->type == CW_F32 || shape->type == CW_F64;
    const size_t window = 2 * f.ahead + 1, threads = (size_t)cwi_threads(desc->threads),
                 parts = (f.capacity + LAYERS - 1) / LAYERS,
                 rings = desc->kind == CW_SLICE_GAUSS ? (parts < threads ? parts : threads) : 0,
                 ring = (window < f.capacity ? window : f.capacity) + 1;
    return f.capacity * (f.raw_bytes + f.slice_bytes) +
           rings * ring * (has_gaps ? 2 : 1) * shape->dim[0] * shape->dim[1] * sizeof(double);
}

cw_status cw_slice_filter_new(const cw_slice_source *source, const cw_slice_filter_desc *desc,
                              cw_slice_filter **out, cw_error *err)
{
    CWI_REQUIRE(err, source, desc, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    *out = NULL;
    cw_status st = check_desc(desc, err);
    if (st == CW_OK)
        st = check_shape(&source->shape, err);
    if (st != CW_OK)
        return st;
    cw_slice_filter *f = cwi_alloc_zeroed(1, sizeof *f);
    if (!f)
        return cwi_fail_memory(err);
    f->source = *source;
    f->desc = *desc;
    plan_slices(f);
    f->raw = cwi_alloc_large(f->capacity, f->raw_bytes);
    if (!f->raw) {
        cwi_free(f);
        return cwi_fail_memory(err);
    }
    *out = f;
    return CW_OK;
}
cw_slice_source cw_slice_filter_source(cw_slice_filter *filter)
{
    return filter ? (cw_slice_source){.shape = packed_shape(filter, filter->type),
                                      .read = read_filtered,
                                      .user = filter}
                  : (cw_slice_source){0};
}

void cw_slice_filter_free(cw_slice_filter *filter)
{
    if (!filter)
        return;
    cw_volume_free(&filter->made);
    cwi_free(filter->raw);
    cwi_free(filter);
}
