/* Smooths a volume by means of those around with similar values: a bilateral filter [Tomasi1998]. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/filter/fast_exp.h"
#include "core/filter/tiles.h"
#include "core/volume/volume.h"

#include <math.h>

static const double MAX_RADIUS = 4, REACH = 2.5; /* in voxels; in standard deviations */

/* sigma_value / noise where it is not given. */
static const double SIMILAR = 2.5;

/* A voxel around another one: where it is in a tile, and half the square of its distance in standard
 * deviations. */
typedef struct neighbor {
    ptrdiff_t at;
    float exponent;
} neighbor;

typedef struct neighbors {
    neighbor *items;
    size_t count;
} neighbors;

/* Lists the voxels of the ellipsoid, in the order of their places, without the one in the middle. */
static cw_status list_neighbors(const double sigma[3], const size_t halo[3], neighbors *out,
                                cw_error *err)
{
    const ptrdiff_t h[3] = {(ptrdiff_t)halo[0], (ptrdiff_t)halo[1], (ptrdiff_t)halo[2]};
    const size_t max_neighbors = (2 * halo[0] + 1) * (2 * halo[1] + 1) * (2 * halo[2] + 1);
    ptrdiff_t row, slice;
    cwi_tile_strides(halo, &row, &slice);
    *out = (neighbors){.items = cwi_alloc_array(max_neighbors, sizeof *out->items)};
    if (!out->items)
        return cwi_fail_memory(err);
    for (ptrdiff_t z = -h[2]; z <= h[2]; z++)
        for (ptrdiff_t y = -h[1]; y <= h[1]; y++)
            for (ptrdiff_t x = -h[0]; x <= h[0]; x++) {
                const double by[3] = {(double)x, (double)y, (double)z};
                double distance_sq = 0;
                for (int a = 0; a < 3; a++)
                    distance_sq += sigma[a] > 0 ? by[a] * by[a] / (sigma[a] * sigma[a]) : 0;
                if ((x || y || z) && distance_sq <= REACH * REACH)
                    out->items[out->count++] = (neighbor){
                        .at = z * slice + y * row + x, .exponent = (float)(0.5 * distance_sq)};
            }
    return CW_OK;
}

/* Adds the weighted differences to a neighbour, for a row of a tile. */
static void add_neighbor(const float *restrict values, const neighbor *to,
                         float *restrict weights, float *restrict sums)
{
    const float *other = values + to->at;
    const float exponent = to->exponent;
#ifndef __clang__ /* which warns where optimisation is off */
#pragma omp simd
#endif
    for (int i = 0; i < CWI_TILE_WIDE; i++) {
        const float d = other[i] - values[i];
        const float weight = cwi_fast_exp(exponent + 0.5f * d * d); /* 0 for NaN */
        weights[i] += weight;
        sums[i] += weight > 0 ? weight * d : 0;
    }
}

static void correct_tile(const void *context, const cwi_filter_tile *tile, float *work,
                         float *corrections)
{
    const neighbors *around = context;
    for (size_t z = 0; z < tile->size[2]; z++)
        for (size_t y = 0; y < tile->size[1]; y++) {
            const float *values =
                tile->values + (ptrdiff_t)z * tile->slice + (ptrdiff_t)y * tile->row;
            float *sums = corrections + (z * CWI_TILE_HIGH + y) * CWI_TILE_WIDE;
            for (int i = 0; i < CWI_TILE_WIDE; i++) {
                work[i] = 1; /* of the voxel itself */
                sums[i] = 0;
            }
            for (size_t n = 0; n < around->count; n++)
                add_neighbor(values, around->items + n, work, sums);
            for (int i = 0; i < CWI_TILE_WIDE; i++)
                sums[i] /= work[i];
        }
}

cw_status cw_volume_bilateral(const cw_volume *volume, const double sigma[3],
                              double sigma_value, const cw_filter_desc *desc, cw_volume *out,
                              cw_error *err)
{
    CWI_REQUIRE(err, volume, sigma, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_filter_desc none = {0}, *d = desc ? desc : &none;
    cwi_tile_filter filter = {
        .work_floats = CWI_TILE_WIDE, .step = "smoothing", .correct = correct_tile};
    neighbors around;
    cw_volume in;
    *out = (cw_volume){0};
    for (int a = 0; a < 3; a++)
        if (!(sigma[a] >= 0 && sigma[a] <= MAX_RADIUS))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "sigma_voxels[%d] is %g; 0 to %g were expected", a, sigma[a],
                            MAX_RADIUS);
    if (!(sigma_value >= 0 && isfinite(sigma_value)))
        return cwi_fail(err, CW_ERR_ARGUMENT, "sigma_value is %g; 0 or more was expected",
                        sigma_value);
    cw_status st = cwi_filter_input(volume, "a bilateral filter", &in, err);
    if (st == CW_OK && sigma_value == 0) {
        st = cw_volume_noise(&in, d->threads, &sigma_value, err);
        sigma_value *= SIMILAR;
    }
    if (st != CW_OK)
        return st;
    for (int a = 0; a < 3; a++)
        filter.halo[a] = (size_t)floor(REACH * sigma[a]);
    filter.unit = sigma_value / fabs(in.slope);
    st = list_neighbors(sigma, filter.halo, &around, err);
    if (st != CW_OK)
        return st;
    filter.context = &around;
    filter.cost = around.count + 1;
    st = cwi_filter_tiles(&in, &filter, d, out, err);
    cwi_free(around.items);
    return st;
}
