/* Removes the table of a CT, and what else lies beside the body.
 *
 * The body is the largest component above -300 HU. Where the table touches it, erosion by a ball of 5 mm
 * parts them, and thin shells go. What is left is grown again by the ball, which gives the body without
 * its thin parts, such as ears and nose. These come back unless they are large, as a table
 * is. Cavities are filled slice by slice, so that lungs and airways stay. If erosion leaves less than
 * half of the component, it is a shell, such as a phantom's: it is filled before it is eroded. */
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/filter/byte_runs.h"
#include "core/filter/inside.h"
#include "core/geometry/affine.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

static const double TISSUE = -300, AIR = -1000; /* HU; between air and fat; air */
static const double BALL_MM = 5;                /* tables have shells of 1 to 8 mm */
static const double SMALL_MM3 = 40000;  /* the thin parts of a face have 35 ml, an ear 10 */
static const double MAX_LOST = 1.0 / 3; /* of the component */
enum { MAX_RADIUS = 250 };              /* voxels, of cwi_spread_bytes() */
static const double EDGE = 2; /* voxels around the body that keep what is partly air */

typedef struct work {
    const cw_volume *in;
    cw_volume *out;
    const cw_inside *inside;
    const cw_filter_desc *desc;
    uint8_t *tissue, *body, *other;   /* a byte a voxel */
    double radius[3], voxel_mm3, air; /* stored number of air */
    size_t *removed;                  /* tissue voxels that are removed, of each slice */
    bool starved;
} work;

static size_t count_voxels(const work *k)
{
    return k->in->dim[0] * k->in->dim[1] * k->in->dim[2];
}

static void fill_run(const cwi_byte_runs *r, size_t row, size_t n, uint8_t value,
                     uint8_t *bytes)
{
    memset(bytes + row * r->dim[0] + r->runs[n].first, value,
           r->runs[n].end - r->runs[n].first);
}

/* Sets bytes of the largest component of those that are 0 to 1, and all others to 0. */
static cw_status keep_largest(const work *k, uint8_t *bytes, cw_error *err)
{
    cwi_byte_runs r;
    size_t largest = 0;
    cw_status st = cwi_byte_runs_init(bytes, 0, k->in->dim, &r, err);
    if (st != CW_OK)
        return st;
    size_t *voxels = cwi_alloc_array(r.count, sizeof *voxels);
    if (!voxels)
        st = cwi_fail_memory(err);
    else if (!r.count)
        st = cwi_fail(err, CW_ERR_EMPTY, "nothing above %g HU is thicker than %g mm", TISSUE,
                      2 * BALL_MM);
    if (st == CW_OK) {
        cwi_byte_runs_measure(&r, voxels);
        for (size_t n = 1; n < r.count; n++)
            largest = voxels[n] > voxels[largest] ? n : largest;
        memset(bytes, 0, count_voxels(k));
        for (size_t row = 0; row < r.dim[1] * r.dim[2]; row++)
            for (size_t n = r.rows[row]; n < r.rows[row + 1]; n++)
                if (r.component[n] == largest)
                    fill_run(&r, row, n, 1, bytes);
    }
    cwi_free(voxels);
    cwi_byte_runs_free(&r);
    return st;
}

/* Returns true if a run is next to a voxel whose byte is 2. */
static bool touches_body(const cwi_byte_runs *r, size_t row, size_t n, const uint8_t *bytes)
{
    const size_t nx = r->dim[0], first = r->runs[n].first, end = r->runs[n].end;
    const size_t y = row % r->dim[1], z = row / r->dim[1];
    const uint8_t *at = bytes + row * nx;
    bool found = (first > 0 && at[first - 1] == 2) || (end < nx && at[end] == 2);
    for (size_t i = first; i < end && !found; i++)
        found = (y > 0 && at[(ptrdiff_t)i - (ptrdiff_t)nx] == 2) ||
                (y + 1 < r->dim[1] && at[i + nx] == 2) ||
                (z > 0 && at[(ptrdiff_t)i - (ptrdiff_t)(nx * r->dim[1])] == 2) ||
                (z + 1 < r->dim[2] && at[i + nx * r->dim[1]] == 2);
    return found;
}

/* Gives small parts back that touch the body. bytes: 2 body, 1 other tissue */
static cw_status rejoin_parts(const work *k, uint8_t *bytes, cw_error *err)
{
    cwi_byte_runs r;
    cw_status st = cwi_byte_runs_init(bytes, 1, k->in->dim, &r, err);
    if (st != CW_OK)
        return st;
    size_t *voxels = cwi_alloc_array(r.count, sizeof *voxels);
    bool *touches = cwi_alloc_zeroed(r.count, sizeof *touches);
    if (voxels && touches) {
        cwi_byte_runs_measure(&r, voxels);
        for (size_t row = 0; row < r.dim[1] * r.dim[2]; row++)
            for (size_t n = r.rows[row]; n < r.rows[row + 1]; n++)
                touches[r.component[n]] =
                    touches[r.component[n]] || touches_body(&r, row, n, bytes);
        for (size_t row = 0; row < r.dim[1] * r.dim[2]; row++)
            for (size_t n = r.rows[row]; n < r.rows[row + 1]; n++)
                if (touches[r.component[n]] &&
                    (double)voxels[r.component[n]] * k->voxel_mm3 <= SMALL_MM3)
                    fill_run(&r, row, n, 2, bytes);
    } else {
        st = cwi_fail_memory(err);
    }
    cwi_free(voxels);
    cwi_free(touches);
    cwi_byte_runs_free(&r);
    return st;
}

/* Fills the cavities of a slice: what is not connected to its border. */
static void fill_slice(void *context, size_t z)
{
    work *k = context;
    const size_t nx = k->in->dim[0], ny = k->in->dim[1], dim[3] = {nx, ny, 1};
    uint8_t *body = k->body + z * nx * ny;
    cwi_byte_runs r = {.count = 0};
    bool *open = NULL;
    if (cwi_byte_runs_init(body, 0, dim, &r, NULL) == CW_OK)
        open = cwi_alloc_zeroed(r.count, sizeof *open);
    if (!open) {
        cwi_byte_runs_free(&r);
        cwi_set_flag(&k->starved);
        return;
    }
    for (size_t row = 0; row < ny; row++)
        for (size_t n = r.rows[row]; n < r.rows[row + 1]; n++)
            if (row == 0 || row + 1 == ny || r.runs[n].first == 0 || r.runs[n].end == nx)
                open[r.component[n]] = true;
    for (size_t row = 0; row < ny; row++)
        for (size_t n = r.rows[row]; n < r.rows[row + 1]; n++)
            if (!open[r.component[n]])
                fill_run(&r, row, n, 1, body);
    cwi_free(open);
    cwi_byte_runs_free(&r);
}

/* Fills the cavities of the body in all slices. */
static cw_status fill_slices(work *k, cw_error *err)
{
    const size_t *dim = k->in->dim;
    cw_status st = cwi_parallel_for(dim[2], dim[0] * dim[1], k->desc->threads,
                                    &k->desc->progress, "filling", fill_slice, k, err);
    return st == CW_OK && k->starved ? cwi_fail_memory(err) : st;
}

/* Sets `other` to the largest component after erosion of `from`, grown again. */
static cw_status find_solid(work *k, const uint8_t *from, cw_error *err)
{
    const size_t *dim = k->in->dim;
    cw_status st = cwi_spread_bytes(from, 0, dim, k->radius, k->desc, k->body, err);
    if (st == CW_OK)
        st = keep_largest(k, k->body, err);
    return st == CW_OK ? cwi_spread_bytes(k->body, 1, dim, k->radius, k->desc, k->other, err)
                       : st;
}

/* Returns true if `other` holds less than half of the tissue: the body is a shell. */
static bool misses_tissue(const work *k)
{
    size_t all = 0, shared = 0;
    for (size_t n = 0; n < count_voxels(k); n++) {
        all += k->tissue[n];
        shared += k->tissue[n] && k->other[n];
    }
    return shared < all / 2;
}

/* Leaves the largest component of the tissue. */
static cw_status find_component(work *k, cw_error *err)
{
    const size_t count = count_voxels(k);
    cw_status st = cwi_find_inside(k->in, k->inside, k->desc, k->body, err);
    for (size_t n = 0; n < count && st == CW_OK; n++)
        k->tissue[n] = !k->body[n];
    return st == CW_OK ? keep_largest(k, k->tissue, err) : st;
}

/* Fails where most of the component would go: then what stays is no body. */
static cw_status hold_body(const work *k, size_t component, cw_error *err)
{
    size_t lost = 0;
    for (size_t n = 0; n < count_voxels(k); n++)
        lost += k->tissue[n] == 1;
    if ((double)lost <= MAX_LOST * (double)component)
        return CW_OK;
    return cwi_fail(err, CW_ERR_UNSAFE,
                    "the table cannot be told from the body: %.3g of the %.3g ml above %g HU "
                    "would go",
                    (double)lost * k->voxel_mm3 / 1000, (double)component * k->voxel_mm3 / 1000,
                    TISSUE);
}

static cw_status find_body(work *k, cw_error *err)
{
    const size_t count = count_voxels(k), *dim = k->in->dim;
    const double edge[3] = {EDGE, EDGE, EDGE};
    size_t component = 0;
    cw_status st = find_component(k, err);
    if (st != CW_OK)
        return st;
    for (size_t n = 0; n < count; n++)
        component += k->tissue[n];
    st = find_solid(k, k->tissue, err);
    if (st == CW_ERR_EMPTY || (st == CW_OK && misses_tissue(k))) {
        memcpy(k->body, k->tissue, count);
        st = fill_slices(k, err);
        if (st == CW_OK) {
            memcpy(k->other, k->body, count);
            st = find_solid(k, k->other, err);
        }
    }
    for (size_t n = 0; n < count && st == CW_OK; n++)
        k->body[n] = k->tissue[n] && k->other[n];
    if (st == CW_OK)
        st = fill_slices(k, err);
    for (size_t n = 0; n < count && st == CW_OK; n++)
        k->tissue[n] = k->body[n] ? 2 : k->tissue[n];
    if (st == CW_OK)
        st = rejoin_parts(k, k->tissue, err);
    if (st == CW_OK)
        st = hold_body(k, component, err);
    for (size_t n = 0; n < count && st == CW_OK; n++)
        k->body[n] = k->tissue[n] == 2;
    if (st == CW_OK)
        st = fill_slices(k, err);
    return st == CW_OK ? cwi_spread_bytes(k->body, 1, dim, edge, k->desc, k->other, err) : st;
}

/* Stores a slice: the body and its edge as they are, air elsewhere. */
static void store_slice(void *context, size_t z)
{
    work *k = context;
    const size_t nx = k->in->dim[0], ny = k->in->dim[1], size = cw_type_size(k->in->type);
    char *to = (char *)cw_volume_voxels(k->out) + z * nx * ny * size;
    for (size_t n = 0; n < nx * ny; n++, to += size) {
        const size_t at = z * nx * ny + n;
        const void *from = cwi_voxel_address(k->in, n % nx, n / nx, z);
        const double stored = cwi_voxel_at(k->in->type, from);
        const bool is_gap = !isfinite(stored) || (k->in->has_nodata && stored == k->in->nodata);
        const bool is_tissue = cwi_value_is_inside(k->in, k->inside, stored);
        if (k->body[at] || is_gap || (k->other[at] && !is_tissue)) {
            memcpy(to, from, size);
            continue;
        }
        cwi_filter_store(k->out, to, k->air);
        k->removed[z] += is_tissue;
    }
}

static cw_status make_result(work *k, double *removed_mm3, cw_error *err)
{
    const size_t *dim = k->in->dim;
    size_t removed = 0;
    cw_status st =
        cwi_filter_result(k->in, k->in->type, dim, k->desc, 3 * count_voxels(k), k->out, err);
    if (st == CW_OK)
        st = cwi_parallel_for(dim[2], dim[0] * dim[1], k->desc->threads, &k->desc->progress,
                              "removing the table", store_slice, k, err);
    for (size_t z = 0; z < dim[2] && st == CW_OK; z++)
        removed += k->removed[z];
    if (st == CW_OK && removed_mm3)
        *removed_mm3 = (double)removed * k->voxel_mm3;
    if (st != CW_OK)
        cw_volume_free(k->out);
    return st;
}

cw_status cw_volume_remove_table(const cw_volume *volume, const cw_filter_desc *desc,
                                 cw_volume *out, double *removed_mm3, cw_error *err)
{
    CWI_REQUIRE(err, volume, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_filter_desc none = {0};
    const cw_inside inside = {.level = TISSUE};
    cw_volume in;
    double mm[3];
    *out = (cw_volume){0};
    cw_status st = cwi_filter_input(volume, "removal of a table", &in, err);
    if (st != CW_OK)
        return st;
    work k = {.in = &in, .out = out, .inside = &inside, .desc = desc ? desc : &none};
    const size_t count = count_voxels(&k);
    cw_volume_spacing(&in, mm);
    for (int a = 0; a < 3; a++)
        k.radius[a] = mm[a] > 0 ? fmin(BALL_MM / mm[a], MAX_RADIUS) : 0;
    k.voxel_mm3 = fabs(cwi_affine_determinant(in.affine[0]));
    k.air = (AIR - in.intercept) / in.slope;
    k.tissue = cwi_alloc_array(count, 3);
    k.removed = cwi_alloc_zeroed(in.dim[2], sizeof *k.removed);
    if (k.tissue && k.removed) {
        k.body = k.tissue + count;
        k.other = k.body + count;
        st = find_body(&k, err);
        if (st == CW_OK)
            st = make_result(&k, removed_mm3, err);
    } else {
        st = cwi_fail_memory(err);
    }
    cwi_free(k.tissue);
    cwi_free(k.removed);
    return st;
}
