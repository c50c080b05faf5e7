/* Measures values of a volume inside of a mesh, weighted by the fraction of each voxel that is inside. */
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/volume/volume.h"
#include "extract/voxelize/voxel_grid.h"

#include <math.h>

/* Sums of a layer. */
typedef struct layer_sum {
    double weight, values, squares; /* the squares are of differences from the mean */
    double min[2], max[2];          /* of voxels partly inside, and at least half */
    size_t count[2];
} layer_sum;

typedef struct work {
    const cw_volume *volume, *fractions; /* of the same voxels */
    double mean;
    layer_sum *sums; /* of each layer */
} work;

static bool has_value(const cw_volume *v, double stored)
{
    return isfinite(stored) && !(v->has_nodata && stored == v->nodata);
}

static void add_value(layer_sum *s, double weight, double value, double mean)
{
    s->weight += weight;
    s->values += weight * value;
    s->squares += weight * (value - mean) * (value - mean);
    for (int half = 0; half < 2 && (half == 0 || weight >= 0.5); half++) {
        s->min[half] = s->count[half] ? fmin(s->min[half], value) : value;
        s->max[half] = s->count[half] ? fmax(s->max[half], value) : value;
        s->count[half]++;
    }
}

static void sum_layer(void *context, size_t k)
{
    work *w = context;
    const cw_volume *v = w->volume;
    const size_t *dim = v->dim;
    const float *weight = (const float *)w->fractions->data + k * dim[1] * dim[0];
    layer_sum sum = {0};
    for (size_t j = 0; j < dim[1]; j++)
        for (size_t i = 0; i < dim[0]; i++, weight++) {
            if (*weight == 0)
                continue;
            const double stored = cwi_voxel_at(v->type, cwi_voxel_address(v, i, j, k));
            if (has_value(v, stored))
                add_value(&sum, (double)*weight, v->slope * stored + v->intercept, w->mean);
        }
    w->sums[k] = sum;
}

/* Joins the sums of all layers, in their order. */
static layer_sum join_layers(const work *w)
{
    layer_sum all = {0};
    for (size_t k = 0; k < w->volume->dim[2]; k++) {
        const layer_sum *s = &w->sums[k];
        all.weight += s->weight;
        all.values += s->values;
        all.squares += s->squares;
        for (int half = 0; half < 2; half++) {
            if (!s->count[half])
                continue;
            all.min[half] = all.count[half] ? fmin(all.min[half], s->min[half]) : s->min[half];
            all.max[half] = all.count[half] ? fmax(all.max[half], s->max[half]) : s->max[half];
            all.count[half] += s->count[half];
        }
    }
    return all;
}

static cw_status sum_values(const cw_volume *volume, const cw_volume *fractions, int threads,
                            cw_within *out, cw_error *err)
{
    const size_t layers = volume->dim[2], size = volume->dim[0] * volume->dim[1];
    const double voxel_mm3 = fabs(cwi_affine_determinant(volume->affine[0]));
    work w = {.volume = volume,
              .fractions = fractions,
              .sums = cwi_alloc_array(layers, sizeof *w.sums)};
    if (!w.sums)
        return cwi_fail_memory(err);
    cwi_parallel_for_all(layers, size, threads, sum_layer, &w);
    layer_sum all = join_layers(&w);
    if (all.weight > 0) {
        w.mean = out->mean = all.values / all.weight;
        cwi_parallel_for_all(layers, size, threads, sum_layer, &w);
        all = join_layers(&w);
        const int half = all.count[1] > 0;
        out->sd = sqrt(all.squares / all.weight);
        out->min = all.min[half];
        out->max = all.max[half];
    }
    out->volume_mm3 = voxel_mm3 * all.weight;
    out->voxels = all.count[0];
    out->halves = all.count[1];
    cwi_free(w.sums);
    return CW_OK;
}

/* Finds the voxels in the box of a mesh, and one more on all sides. Without any, the box is the first
 * voxel. Returns false if the mesh is outside. */
static cw_status find_box(const cw_volume *volume, const cw_mesh *mesh, int threads,
                          cw_box *box, bool *meets, cw_error *err)
{
    double(*points)[3] = cwi_alloc_array(mesh->vertex_count, sizeof *points);
    if (!points)
        return cwi_fail_memory(err);
    cwi_voxel_grid_map(volume, mesh, threads, points);
    *meets = true;
    for (int a = 0; a < 3 && *meets; a++) {
        const double last = (double)volume->dim[a] - 1;
        double low = INFINITY, high = -INFINITY;
        for (size_t n = 0; n < mesh->vertex_count; n++) {
            low = fmin(low, points[n][a]);
            high = fmax(high, points[n][a]);
        }
        *meets = low < last + 0.5 && high > -0.5;
        low = fmax(floor(low) - 1, 0);
        high = fmin(ceil(high) + 1, last);
        box->first[a] = *meets ? (size_t)low : 0;
        box->count[a] = *meets ? (size_t)(high - low) + 1 : 1;
    }
    cwi_free(points);
    return CW_OK;
}

cw_status cw_volume_within(const cw_volume *volume, const cw_mesh *mesh, int threads,
                           cw_within *out, cw_error *err)
{
    CWI_REQUIRE(err, volume, mesh, out);
    *out = (cw_within){0};
    cw_volume whole, part, fractions = {0};
    cw_box box;
    bool meets = false;
    cw_status st = cwi_volume_expect_even(volume, "measuring inside of a mesh", err);
    if (st == CW_OK)
        st = cw_volume_resolve(volume, &whole, err);
    if (st == CW_OK)
        st = cw_mesh_check(mesh, err);
    if (st == CW_OK)
        st = find_box(&whole, mesh, threads, &box, &meets, err);
    if (st == CW_OK)
        st = meets ? cw_volume_crop(&whole, &box, &part, err)
                   : cw_volume_select(&whole, 0, 0, &part, err);
    const cw_voxelize_desc desc = {
        .like = &part, .partial = true, .threads = threads, .parts = &out->mesh};
    if (st == CW_OK)
        st = cw_voxelize(&mesh, 1, &desc, &fractions, err);
    if (st == CW_OK)
        st = sum_values(&part, &fractions, threads, out, err);
    cw_volume_free(&fractions);
    if (st != CW_OK)
        *out = (cw_within){.mesh.open = out->mesh.open};
    return st;
}
