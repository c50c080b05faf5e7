/* Makes volumes, fills in their defaults, checks them, takes parts of them, and maps indices to
 * the world. */
#include "core/volume/volume.h"
#include "core/volume/label_ids.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/geometry/box.h"

#include <math.h>
#include <string.h>

static const struct {
    size_t size;
    const char *name;
} types[CW_TYPE_COUNT] = {
#define ROW(name, ctype, text) {sizeof(ctype), text},
    CW_TYPE_TABLE(ROW)
#undef ROW
};

size_t cw_type_size(cw_type type)
{
    if (cwi_id_is_wide(type))
        return sizeof(int64_t);
    return (unsigned)type < CW_TYPE_COUNT ? types[type].size : 0;
}

const char *cw_type_name(cw_type type)
{
    if (cwi_id_is_wide(type))
        return (int)type == CWI_I64 ? "i64" : "u64";
    return (unsigned)type < CW_TYPE_COUNT ? types[type].name : "unknown";
}

static bool packed_bytes(const cw_volume *v, size_t *bytes)
{
    const size_t in_leaves[3] = {CWI_LEAF_VOXELS, v->sparse ? v->sparse->leaf_count : 0, 1};
    const size_t *dim = v->sparse ? in_leaves : v->dim;
    size_t n = cw_type_size(v->type);
    bool fits = true;
    for (int a = 0; a < 3; a++)
        fits = fits && cwi_size_mul(n, dim[a], &n);
    fits = fits && cwi_size_mul(n, v->components, &n) && cwi_size_mul(n, v->steps, &n);
    *bytes = n;
    return fits && n <= PTRDIFF_MAX;
}

/* Sets strides: x fastest, components interleaved in front of it, time slowest; on a sparse
 * grid within leaves. */
static void set_packed_strides(cw_volume *v)
{
    const size_t leaf[3] = {CWI_LEAF, CWI_LEAF, CWI_LEAF}, *dim = v->sparse ? leaf : v->dim;
    const ptrdiff_t size = (ptrdiff_t)cw_type_size(v->type);
    v->component_stride = size;
    v->stride[0] = size * (ptrdiff_t)v->components;
    v->stride[1] = v->stride[0] * (ptrdiff_t)dim[0];
    v->stride[2] = v->stride[1] * (ptrdiff_t)dim[1];
    v->step_stride = v->stride[2] * (ptrdiff_t)dim[2];
}

static void set_identity(double affine[3][4])
{
    memset(affine, 0, sizeof(double[3][4]));
    for (int a = 0; a < 3; a++)
        affine[a][a] = 1;
}

static bool is_zero(const double *affine)
{
    for (int n = 0; n < 12; n++)
        if (affine[n] != 0)
            return false;
    return true;
}

cw_status cw_volume_alloc(cw_volume *volume, cw_type type, const size_t dim[3],
                          size_t components, size_t steps, cw_error *err)
{
    CWI_REQUIRE(err, volume, dim);
    size_t bytes;
    cw_volume v = {.type = type,
                   .dim = {dim[0], dim[1], dim[2]},
                   .components = components ? components : 1,
                   .steps = steps ? steps : 1,
                   .slope = 1};
    memset(volume, 0, sizeof *volume);
    if ((unsigned)type >= CW_TYPE_COUNT || !dim[0] || !dim[1] || !dim[2])
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "a volume needs a voxel type and sizes of at least 1; got type %d, %zu x "
            "%zu x %zu",
            (int)type, dim[0], dim[1], dim[2]);
    if (!packed_bytes(&v, &bytes))
        return cwi_fail(err, CW_ERR_LIMIT, "%zu x %zu x %zu voxels do not fit an address space",
                        dim[0], dim[1], dim[2]);
    v.owned = cwi_alloc_zeroed(bytes, 1);
    if (!v.owned)
        return cwi_fail_memory(err);
    v.data = v.owned;
    set_packed_strides(&v);
    set_identity(v.affine);
    *volume = v;
    return CW_OK;
}

void cw_volume_free(cw_volume *volume)
{
    if (!volume)
        return;
    cwi_free(volume->owned);
    cwi_free(volume->owned_grid);
    memset(volume, 0, sizeof *volume);
}

void *cw_volume_voxels(cw_volume *volume)
{
    if (!volume)
        return NULL;
    return volume->owned;
}

static cw_status check_numbers(const cw_volume *v, cw_error *err)
{
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++)
            if (!isfinite(v->affine[r][c]))
                return cwi_fail(err, CW_ERR_ARGUMENT, "the volume's affine is not finite");
    const double det = cwi_affine_determinant(v->affine[0]);
    if (!isnormal(det))
        return cwi_fail(err, CW_ERR_ARGUMENT, "the volume's affine has determinant %g", det);
    if (!isfinite(v->slope) || !isfinite(v->intercept))
        return cwi_fail(err, CW_ERR_ARGUMENT, "slope %g and intercept %g must be finite",
                        v->slope, v->intercept);
    return CW_OK;
}

static cw_status check_coordinates(const cw_volume *v, cw_error *err)
{
    for (int a = 0; a < 3; a++) {
        const double *at = v->coordinates[a];
        if (!at != !v->coordinates[0])
            return cwi_fail(err, CW_ERR_ARGUMENT, "coordinates along %c are missing",
                            "xyz"[at ? 0 : a]);
        for (size_t i = 0; at && i < v->dim[a]; i++)
            if (!isfinite(at[i]) || (i && !(at[i] > at[i - 1])))
                return cwi_fail(err, CW_ERR_ARGUMENT,
                                "coordinate %zu along %c is %g; finite, rising ones were "
                                "expected",
                                i, "xyz"[a], at[i]);
    }
    return CW_OK;
}

/* Checks that the arrays of the grid exist and do not contradict each other. */
static cw_status check_grid(const cw_volume *v, cw_error *err)
{
    const cw_cells *c = v->cells;
    const cw_sparse *s = v->sparse;
    if ((c != NULL) + (s != NULL) + cwi_is_rectilinear(v) > 1)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "the volume has more than one of coordinates, cells and leaves");
    if (c && (v->dim[1] != 1 || v->dim[2] != 1 || v->dim[0] > UINT32_MAX))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "an irregular grid has size %zu x %zu x %zu; samples x 1 x 1 was "
                        "expected, at most 2^32 - 1 of them",
                        v->dim[0], v->dim[1], v->dim[2]);
    if (c && (!c->points || (c->count && (!c->shapes || !c->corners))))
        return cwi_fail(err, CW_ERR_ARGUMENT, "an irregular grid lacks points or cells");
    if (s && ((s->leaf_count && !s->leaves) || (s->tile_count && !s->tiles)))
        return cwi_fail(err, CW_ERR_ARGUMENT, "a sparse grid lacks its leaves or tiles");
    if (s && (v->components > 1 || v->steps > 1))
        return cwi_fail(err, CW_ERR_ARGUMENT, "a sparse grid has one component and one step");
    return check_coordinates(v, err);
}

static cw_status check_strides(const cw_volume *v, cw_error *err)
{
    const ptrdiff_t size = (ptrdiff_t)cw_type_size(v->type);
    const ptrdiff_t all[5] = {v->stride[0], v->stride[1], v->stride[2], v->component_stride,
                              v->step_stride};
    bool aligned = (uintptr_t)v->data % (uintptr_t)size == 0;
    for (int a = 0; a < 5; a++)
        aligned = aligned && all[a] % size == 0;
    if (!aligned)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "data and strides must be multiples of %d bytes (%s)", (int)size,
                        cw_type_name(v->type));
    return CW_OK;
}

cw_status cw_volume_resolve(const cw_volume *in, cw_volume *out, cw_error *err)
{
    CWI_REQUIRE(err, in, out);
    cw_volume v = *in;
    size_t bytes;
    if ((unsigned)v.type >= CW_TYPE_COUNT)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%d is not a voxel type", (int)v.type);
    if (!v.dim[0] || !v.dim[1] || !v.dim[2])
        return cwi_fail(err, CW_ERR_ARGUMENT, "the volume is empty: %zu x %zu x %zu", v.dim[0],
                        v.dim[1], v.dim[2]);
    if (!v.data && !(v.sparse && !v.sparse->leaf_count))
        return cwi_fail(err, CW_ERR_ARGUMENT, "the volume has no voxels");
    v.components = v.components ? v.components : 1;
    v.steps = v.steps ? v.steps : 1;
    if (!packed_bytes(&v, &bytes))
        return cwi_fail(err, CW_ERR_ARGUMENT, "the volume is larger than an address space");
    if (!v.stride[0] && !v.stride[1] && !v.stride[2])
        set_packed_strides(&v);
    if (is_zero(v.affine[0]))
        set_identity(v.affine);
    v.slope = v.slope != 0 ? v.slope : 1;
    cw_status st = check_numbers(&v, err);
    if (st == CW_OK)
        st = check_strides(&v, err);
    if (st == CW_OK)
        st = check_grid(&v, err);
    if (st == CW_OK)
        *out = v;
    return st;
}

cw_status cwi_volume_own_coordinates(cw_volume *v, cw_error *err)
{
    v->owned_grid = NULL;
    if (!cwi_is_rectilinear(v))
        return CW_OK;
    double *all = cwi_alloc_array(v->dim[0] + v->dim[1] + v->dim[2], sizeof *all), *to = all;
    if (!all)
        return cwi_fail_memory(err);
    for (int a = 0; a < 3; to += v->dim[a++]) {
        memcpy(to, v->coordinates[a], v->dim[a] * sizeof *to);
        v->coordinates[a] = to;
    }
    v->owned_grid = all;
    return CW_OK;
}

const char *cwi_volume_kind(const cw_volume *v)
{
    return v->cells                ? "an irregular grid"
           : v->sparse             ? "a sparse grid"
           : cwi_is_rectilinear(v) ? "a rectilinear grid"
                                   : NULL;
}

static cw_status refuse_kind(const cw_volume *v, const char *what, cw_error *err)
{
    return cwi_fail(err, CW_ERR_UNSUPPORTED,
                    "%s on %s is not supported: an even one was expected", what,
                    cwi_volume_kind(v));
}

cw_status cwi_volume_expect_even(const cw_volume *v, const char *what, cw_error *err)
{
    return cwi_volume_kind(v) ? refuse_kind(v, what, err) : CW_OK;
}

cw_status cwi_volume_expect_dense(const cw_volume *v, const char *what, cw_error *err)
{
    return v->cells || v->sparse ? refuse_kind(v, what, err) : CW_OK;
}

cw_status cwi_volume_resolve_shape(const cw_volume *shape, cw_volume *whole, cw_error *err)
{
    static const double none = 0;
    cw_volume v = *shape;
    if (v.sparse || v.cells)
        return cwi_fail(err, CW_ERR_UNSUPPORTED, "%s is not extracted slice by slice",
                        cwi_volume_kind(&v));
    v.data = &none; /* only to be present */
    cw_status st = cw_volume_select(&v, 0, 0, whole, err);
    whole->data = NULL;
    return st;
}

double cwi_coordinate_index(const cw_volume *v, int axis, double coordinate)
{
    const double *at = v->coordinates[axis];
    size_t low = 0, high = v->dim[axis] - 1;
    if (!at)
        return coordinate;
    if (high == 0)
        return 0;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (at[middle] <= coordinate)
            low = middle;
        else
            high = middle;
    }
    return (double)low + (coordinate - at[low]) / (at[high] - at[low]);
}

cw_status cw_volume_select(const cw_volume *in, size_t component, size_t step, cw_volume *out,
                           cw_error *err)
{
    CWI_REQUIRE(err, in, out);
    cw_volume v;
    cw_status st = cw_volume_resolve(in, &v, err);
    if (st != CW_OK)
        return st;
    if (component >= v.components || step >= v.steps)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "component %zu of step %zu: the volume has %zu components, %zu steps",
                        component, step, v.components, v.steps);
    if (v.data)
        v.data = (const char *)v.data + (ptrdiff_t)component * v.component_stride +
                 (ptrdiff_t)step * v.step_stride;
    v.components = v.steps = 1;
    v.owned = v.owned_grid = NULL;
    *out = v;
    return CW_OK;
}

cw_status cwi_volume_shrink(cw_volume *v, const cw_box *box, cw_error *err)
{
    for (int a = 0; a < 3; a++)
        if (!box->count[a] || box->first[a] >= v->dim[a] ||
            box->count[a] > v->dim[a] - box->first[a])
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "box %zu+%zu leaves the volume's %zu voxels along %c",
                            box->first[a], box->count[a], v->dim[a], "xyz"[a]);
    const double corner[3] = {(double)box->first[0], (double)box->first[1],
                              (double)box->first[2]};
    double world[3];
    cwi_affine_apply(v->affine[0], corner, world);
    for (int a = 0; a < 3; a++) {
        v->dim[a] = box->count[a];
        if (v->coordinates[a])
            v->coordinates[a] += box->first[a];
        else
            v->affine[a][3] = world[a];
    }
    return CW_OK;
}

cw_status cw_volume_crop(const cw_volume *in, const cw_box *box, cw_volume *out, cw_error *err)
{
    CWI_REQUIRE(err, in, box, out);
    cw_volume v;
    cw_status st = cw_volume_resolve(in, &v, err);
    if (st == CW_OK)
        st = cwi_volume_expect_dense(&v, "a crop", err);
    if (st == CW_OK)
        st = cwi_volume_shrink(&v, box, err);
    if (st != CW_OK)
        return st;
    v.data = cwi_voxel_address(&v, box->first[0], box->first[1], box->first[2]);
    v.owned = v.owned_grid = NULL;
    *out = v;
    return CW_OK;
}

cw_status cwi_volume_thin(cw_volume *v, const size_t step[3], cw_error *err)
{
    cw_status st = CW_OK;
    if (step[0] > 1 || step[1] > 1 || step[2] > 1)
        st = cwi_volume_expect_even(v, "a preview", err);
    for (int a = 0; a < 3 && st == CW_OK; a++) {
        if (!step[a] || (step[a] > 1 && step[a] >= v->dim[a]))
            return cwi_fail(
                err, CW_ERR_ARGUMENT,
                "a step of %zu along %c: expected 1, or less than the %zu voxels there",
                step[a], "xyz"[a], v -> dim[a]);
        v->dim[a] = (v->dim[a] - 1) / step[a] + 1;
        for (int r = 0; r < 3; r++)
            v->affine[r][a] *= (double)step[a];
    }
    return st;
}

cw_status cw_volume_coarsen(const cw_volume *in, const size_t step[3], cw_volume *out,
                            cw_error *err)
{
    CWI_REQUIRE(err, in, step, out);
    cw_volume v;
    cw_status st = cw_volume_resolve(in, &v, err);
    if (st == CW_OK)
        st = cwi_volume_thin(&v, step, err);
    if (st != CW_OK)
        return st;
    for (int a = 0; a < 3; a++)
        v.stride[a] *= (ptrdiff_t)step[a];
    v.owned = v.owned_grid = NULL;
    return cw_volume_resolve(&v, out, err);
}

double cw_volume_value(const cw_volume *volume, size_t i, size_t j, size_t k)
{
    cw_volume v;
    if (cw_volume_resolve(volume, &v, NULL) != CW_OK || v.sparse || i >= v.dim[0] ||
        j >= v.dim[1] || k >= v.dim[2])
        return NAN;
    return v.slope * cwi_voxel_at(v.type, cwi_voxel_address(&v, i, j, k)) + v.intercept;
}

void cw_volume_to_world(const cw_volume *volume, const double index[3], double world[3])
{
    double at[3] = {index[0], index[1], index[2]};
    for (int a = 0; a < 3 && cwi_is_rectilinear(volume); a++) {
        const double last = (double)volume->dim[a] - 1,
                     low = floor(fmin(fmax(index[a], 0), last - (last > 0)));
        at[a] = last > 0 ? cwi_grid_coordinate(volume, a, (ptrdiff_t)low, index[a] - low)
                         : volume->coordinates[a][0];
    }
    if (is_zero(volume->affine[0]))
        memcpy(world, at, 3 * sizeof *world);
    else
        cwi_affine_apply(volume->affine[0], at, world);
}

/* The smallest box around the samples of an irregular grid. */
static void find_box_of_cells(const cw_volume *v, double low[3], double high[3])
{
    cwi_box_clear(low, high);
    for (size_t n = 0; n < v->dim[0]; n++) {
        double world[3];
        cw_volume_to_world(v, v->cells->points + 3 * n, world);
        cwi_box_add(low, high, world);
    }
}

void cw_volume_corners(const cw_volume *volume, double corners[8][3])
{
    double box[2][3];
    if (volume->cells)
        find_box_of_cells(volume, box[0], box[1]);
    for (int n = 0; n < 8; n++) {
        double index[3];
        for (int a = 0; a < 3; a++)
            index[a] = n >> a & 1 ? (double)volume->dim[a] - 1 : 0;
        if (!volume->cells)
            cw_volume_to_world(volume, index, corners[n]);
        for (int a = 0; a < 3 && volume->cells; a++)
            corners[n][a] = box[n >> a & 1][a];
    }
}

cw_status cw_volume_to_index(const cw_volume *volume, const double world[3], double index[3],
                             cw_error *err)
{
    CWI_REQUIRE(err, volume, world, index);
    double a[3][4], cofactor[3][3];
    if (is_zero(volume->affine[0]))
        set_identity(a);
    else
        memcpy(a, volume->affine, sizeof a);
    const double det = cwi_affine_determinant(a[0]);
    if (!isnormal(det))
        return cwi_fail(err, CW_ERR_ARGUMENT, "the volume's affine has determinant %g", det);
    cwi_affine_cofactor(a[0], cofactor);
    for (int c = 0; c < 3; c++) {
        index[c] = 0;
        for (int r = 0; r < 3; r++)
            index[c] += cofactor[r][c] * (world[r] - a[r][3]) / det;
        index[c] = cwi_coordinate_index(volume, c, index[c]);
    }
    return CW_OK;
}

void cw_volume_spacing(const cw_volume *volume, double spacing_mm[3])
{
    const bool identity = is_zero(volume->affine[0]);
    for (int c = 0; c < 3; c++) {
        const size_t last = volume->dim[c] - 1;
        const double *at = volume->coordinates[c],
                     step = at && last ? (at[last] - at[0]) / (double)last : 1;
        spacing_mm[c] =
            step * (identity ? 1
                             : hypot(hypot(volume->affine[0][c], volume->affine[1][c]),
                                     volume->affine[2][c]));
    }
}
