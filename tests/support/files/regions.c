/* Compares regions read from a file with crops of the whole volume, at every box or some of
 * each kind. */
#include "support/files/regions.h"

#include "support/support.h"

#include <stdlib.h>
#include <string.h>

static const char *voxel(const cw_volume *v, const size_t at[3], size_t component, size_t step)
{
    const char *p = v->data;
    for (int a = 0; a < 3; a++)
        p += (ptrdiff_t)at[a] * v->stride[a];
    return p + (ptrdiff_t)component * v->component_stride + (ptrdiff_t)step * v->step_stride;
}

static bool same_voxels(const cw_volume *a, const cw_volume *b)
{
    const size_t bytes = cw_type_size(a->type);
    size_t at[3];
    for (size_t t = 0; t < a->steps; t++)
        for (size_t c = 0; c < a->components; c++)
            for (at[2] = 0; at[2] < a->dim[2]; at[2]++)
                for (at[1] = 0; at[1] < a->dim[1]; at[1]++)
                    for (at[0] = 0; at[0] < a->dim[0]; at[0]++)
                        if (memcmp(voxel(a, at, c, t), voxel(b, at, c, t), bytes) != 0)
                            return false;
    return true;
}

static bool same_coordinates(const cw_volume *a, const cw_volume *b)
{
    for (int i = 0; i < 3; i++)
        if (!a->coordinates[i] != !b->coordinates[i] ||
            (a->coordinates[i] && memcmp(a->coordinates[i], b->coordinates[i],
                                         a->dim[i] * sizeof *a->coordinates[i]) != 0))
            return false;
    return true;
}

static bool same_shape(const cw_volume *a, const cw_volume *b)
{
    return a->type == b->type && memcmp(a->dim, b->dim, sizeof a->dim) == 0 &&
           a->components == b->components && a->steps == b->steps &&
           a->step_seconds == b->step_seconds && a->slope == b->slope &&
           a->intercept == b->intercept && a->known == b->known &&
           a->has_nodata == b->has_nodata && same_coordinates(a, b) &&
           memcmp(a->affine, b->affine, sizeof a->affine) == 0;
}

static uint64_t count_voxels(const cw_volume *v)
{
    return (uint64_t)v->steps * v->dim[0] * v->dim[1] * v->dim[2];
}

static uint64_t count_bytes(const cw_volume *v)
{
    return count_voxels(v) * v->components * cw_type_size(v->type);
}

static void check_limits(const char *name, const cw_read_desc *desc, const cw_volume *whole)
{
    cw_read_desc d = *desc;
    cw_volume v;
    cw_error err = {0};
    d.max_voxels = count_voxels(whole);
    d.max_bytes = count_bytes(whole) - 1;
    if (d.max_bytes > 0)
        assert_fails(cw_volume_read(test_path(name), &d, &v, NULL, &err), CW_ERR_LIMIT,
                     "(desc->max_bytes)", err);
    d.max_bytes++;
    assert_ok(cw_volume_read(test_path(name), &d, &v, NULL, &err), err);
    cw_volume_free(&v);
    if (--d.max_voxels > 0)
        assert_fails(cw_volume_read(test_path(name), &d, &v, NULL, &err), CW_ERR_LIMIT,
                     "(desc->max_voxels)", err);
}

/* Slices that are compared with those of a volume. */
typedef struct expected {
    const cw_volume *volume;
    size_t component, step, compared;
} expected;

static cw_status compare_slices(void *user, const cw_slice_source *source, cw_error *err)
{
    static const double aligned = 0;
    expected *e = user;
    cw_volume one, all = source->shape, slab;
    cw_status st = cw_volume_select(e->volume, e->component, e->step, &one, err);
    all.data = &aligned; /* to have strides */
    assert_ok(cw_volume_resolve(&all, &all, err), *err);
    if (memcmp(all.affine, one.affine, sizeof one.affine) != 0 ||
        memcmp(all.dim, one.dim, sizeof one.dim) != 0 || !same_coordinates(&all, &one))
        fail_msg("slices have another shape than the whole");
    for (int pass = 0; pass < 2; pass++) /* twice: from the start again */
        for (size_t z = 0, count; z < one.dim[2] && st == CW_OK; z += count) {
            const size_t wanted = 1 + (z + e->step) % 3, left = one.dim[2] - z;
            count = wanted < left ? wanted : left;
            const cw_box box = {.first = {0, 0, z}, .count = {one.dim[0], one.dim[1], count}};
            cw_volume part;
            void *voxels = malloc(count * (size_t)all.stride[2]);
            st = source->read(source->user, z, count, voxels, err);
            slab = all;
            slab.data = voxels;
            slab.dim[2] = count;
            assert_ok(cw_volume_crop(&one, &box, &part, err), *err);
            if (st == CW_OK && !same_voxels(&part, &slab))
                fail_msg("slices %zu to %zu are not those of the whole", z, z + count - 1);
            free(voxels);
            e->compared += count;
        }
    return st;
}

/* True where the slices of a file with these strides are one block each. */
static bool has_slices(const cw_volume *whole)
{
    const ptrdiff_t slice = whole->stride[2];
    const bool steps = whole->steps > 1 && whole->step_stride < slice;
    return (whole->dim[0] == 1 || whole->stride[0] < slice) &&
           (whole->dim[1] == 1 || whole->stride[1] < slice) && !steps &&
           (whole->components < 2 || whole->component_stride < slice);
}

/* Checks slices of the region, of one component and step. */
static void check_slices(const char *name, const cw_read_desc *desc, const cw_volume *part)
{
    expected e = {.volume = part,
                  .component = part->dim[0] % part->components,
                  .step = part->dim[1] % part->steps};
    const cw_slice_visitor visitor = {compare_slices, &e};
    cw_error err = {0};
    const cw_status st =
        cw_volume_visit(test_path(name), desc, e.component, e.step, &visitor, NULL, &err);
    if (st == CW_ERR_UNSUPPORTED && !has_slices(part))
        return;
    assert_ok(st, err);
    assert_int_equal(e.compared, 2 * part->dim[2]);
}

/* Checks every n-th voxel of the box against the crop after coarsening. */
static void check_thin(const char *name, const cw_read_desc *desc, const cw_volume *crop)
{
    cw_read_desc d = *desc;
    cw_volume thin, part, shape;
    cw_error err = {0};
    for (int a = 0; a < 3; a++) {
        const size_t every = 1 + (desc->region->first[a] + crop->dim[a] + (size_t)a) % 4;
        d.every[a] = every < crop->dim[a] ? every : 1;
    }
    if (crop->coordinates[0] || crop->coordinates[1] || crop->coordinates[2])
        return; /* a rectilinear grid is not coarsened */
    assert_ok(cw_volume_coarsen(crop, d.every, &thin, &err), err);
    assert_ok(cw_volume_read(test_path(name), &d, &part, NULL, &err), err);
    d.header_only = true;
    assert_ok(cw_volume_read(test_path(name), &d, &shape, NULL, &err), err);
    if (!same_shape(&thin, &part) || !same_shape(&thin, &shape) || !same_voxels(&thin, &part))
        fail_msg("%s: every %zu, %zu, %zu-th voxel of a region is not the coarsened crop", name,
                 d.every[0], d.every[1], d.every[2]);
    d.header_only = false;
    check_slices(name, &d, &part);
    cw_volume_free(&part);
    cw_volume_free(&shape);
}

static void check_box(const char *name, const cw_read_desc *desc, const cw_volume *whole,
                      const cw_box *box)
{
    cw_read_desc d = *desc;
    cw_volume crop, part, shape;
    cw_error err = {0};
    d.region = box;
    assert_ok(cw_volume_crop(whole, box, &crop, &err), err);
    d.max_bytes = count_bytes(&crop);
    assert_ok(cw_volume_read(test_path(name), &d, &part, NULL, &err), err);
    d.header_only = true;
    assert_ok(cw_volume_read(test_path(name), &d, &shape, NULL, &err), err);
    assert_null(shape.data);
    if (!same_shape(&crop, &part) || !same_shape(&crop, &shape) || !same_voxels(&crop, &part))
        fail_msg("%s: the region %zu+%zu, %zu+%zu, %zu+%zu is not the crop of the whole", name,
                 box->first[0], box->count[0], box->first[1], box->count[1], box->first[2],
                 box->count[2]);
    d.header_only = false;
    check_slices(name, &d, &part);
    cw_volume_free(&part);
    cw_volume_free(&shape);
    check_thin(name, &d, &crop);
}

/* Range n of those that lie in an axis: from each voxel to it, or to one behind it. */
static bool nth_range(size_t n, size_t size, size_t *first, size_t *count)
{
    for (*first = 0; *first < size; n -= size - *first, ++*first)
        if (n < size - *first) {
            *count = n + 1;
            return true;
        }
    return false;
}

static void check_all(const char *name, const cw_read_desc *desc, const cw_volume *whole)
{
    cw_box box;
    for (size_t z = 0; nth_range(z, whole->dim[2], &box.first[2], &box.count[2]); z++)
        for (size_t y = 0; nth_range(y, whole->dim[1], &box.first[1], &box.count[1]); y++)
            for (size_t x = 0; nth_range(x, whole->dim[0], &box.first[0], &box.count[0]); x++)
                check_box(name, desc, whole, &box);
}

/* An axis from end to end, a single voxel of it, or any range. */
static void random_range(uint32_t *seed, size_t size, size_t *first, size_t *count)
{
    uint32_t r[3];
    for (int i = 0; i < 3; i++)
        r[i] = (*seed = *seed * 1664525u + 1013904223u) >> 8;
    *first = r[0] % 3 == 0 ? 0 : r[1] % size;
    *count = r[0] % 3 == 0 ? size : r[0] % 3 == 1 ? 1 : 1 + r[2] % (size - *first);
}

static void check_some(const char *name, const cw_read_desc *desc, const cw_volume *whole)
{
    enum { ROUNDS = 15 };
    uint32_t seed = 1;
    cw_box box;
    for (int round = 0; round < ROUNDS; round++) {
        for (int a = 0; a < 3; a++)
            random_range(&seed, whole->dim[a], &box.first[a], &box.count[a]);
        check_box(name, desc, whole, &box);
    }
}

void check_regions(const char *name, const cw_read_desc *desc)
{
    const cw_read_desc defaults = {0};
    cw_volume whole;
    cw_error err = {0};
    desc = desc ? desc : &defaults;
    assert_ok(cw_volume_read(test_path(name), desc, &whole, NULL, &err), err);
    check_limits(name, desc, &whole);
    if (whole.dim[0] * whole.dim[1] * whole.dim[2] <= 12)
        check_all(name, desc, &whole);
    else
        check_some(name, desc, &whole);
    cw_volume_free(&whole);
}
