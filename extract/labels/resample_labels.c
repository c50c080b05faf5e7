/* Samples a label map at other distances: each new sample gets the label with the largest share of a
 * Gaussian around it. Only the few labels within the Gaussian's reach are looked at.
 *
 * Weights along each axis are whole numbers, and so are products and sums below 2^53. Sums are exact
 * then, in any order, and equal shares are found to be equal. */
#include <cubewright/labels.h>

#include "core/volume/key_counts.h"
#include "extract/labels/label_layers.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/base/thread_pool.h"
#include "core/filter/resample_grid.h"
#include "core/filter/separable.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

/* The Gaussian in the larger of the old and the new distance: standard deviation, and its reach. */
static const double SIGMA = 0.5, REACH = 2;

/* Whole weights along an axis add up to about this: 2^17. */
static const double WHOLE = 131072;

/* Rounding of a place half way between two samples. */
static const double SLACK = 1e-6;

/* Input samples that a tile has beside its reach, along y and z; and labels that are listed. */
enum { TILE_Y = 32, TILE_Z = 16, LISTED = 32 };

static const char *const names[CW_LABEL_KERNEL_COUNT] = {
    [CW_LABEL_KERNEL_MAJORITY] = "majority", [CW_LABEL_KERNEL_NEAREST] = "nearest"};

const char *cw_label_kernel_name(cw_label_kernel k)
{
    return (unsigned)k < CW_LABEL_KERNEL_COUNT ? names[k] : NULL;
}

typedef struct sampler {
    cwi_label_layers layers;
    const cw_volume *in;
    uint32_t *out;
    cwi_axis_weights w[3];
    size_t tile[3], tiles[3]; /* output samples of a tile along y and z, and their number */
    bool starved, has_bad;
} sampler;

/* The voxels that the output samples of a tile reach over: whole rows. */
typedef struct tile {
    const sampler *s;
    size_t first[3], rows, slices; /* first: of the input */
    uint32_t *labels;              /* slices x rows x samples of a row */
    uint32_t *column_label,
        *label; /* the first label along z of each column; then along y and z */
    uint8_t *column_mixed, *mixed; /* 1: there are several */
} tile;

/* The shares of labels in a sample. */
typedef struct ballot {
    size_t listed;
    uint32_t label[LISTED];
    double share[LISTED];
    cwi_key_counts more; /* of the labels that the list does not hold, plus 1 */
} ballot;

static double gaussian(double x, double width)
{
    const double d = x / (SIGMA * width);
    return exp(-0.5 * d * d);
}

/* Sets the weights of an axis. Of two samples as near as each other the lower one is the nearest. */
static cw_status set_weights(cwi_axis_weights *w, const cw_volume *in, int a,
                             const cwi_sample_axis *axis, bool nearest, cw_error *err)
{
    const double reach = REACH * axis->wider, most = nearest ? 1 : floor(2 * reach) + 1;
    const size_t samples = in->dim[a], taps = most < (double)samples ? (size_t)most : samples;
    cw_status st = cwi_axis_weights_init(w, axis->count, taps, err);
    for (size_t n = 0; n < axis->count && st == CW_OK; n++) {
        const double at = cwi_sample_position(in, a, axis, n),
                     near = fmin(fmax(ceil(at - 0.5 - SLACK), 0), (double)(samples - 1));
        double *weights = w->weights + n * taps;
        if (nearest) {
            w->first[n] = (size_t)near;
            weights[0] = 1;
        } else {
            cwi_axis_weights_set(w, n, at, samples, reach, gaussian, axis->wider);
        }
        w->nearest[n] = (size_t)near;
        for (size_t t = 0; t < taps && !nearest; t++)
            weights[t] = rint(weights[t] * WHOLE);
    }
    return st;
}

/* Returns the number of input samples that output sample n reaches over. */
static size_t count_taps(const sampler *s, int a, size_t n)
{
    const size_t left = s->in->dim[a] - s->w[a].first[n];
    return left < s->w[a].taps ? left : s->w[a].taps;
}

/* --- the label of a sample with several around ------------------------------------------- */

/* Adds to the share of a label. Returns false when memory is out. */
static bool add_share(ballot *b, uint32_t label, double share)
{
    for (size_t n = 0; n < b->listed; n++)
        if (b->label[n] == label) {
            b->share[n] += share;
            return true;
        }
    if (b->listed < LISTED) {
        b->label[b->listed] = label;
        b->share[b->listed++] = share;
        return true;
    }
    cwi_key_count *e = cwi_key_counts_need(&b->more, (uint64_t)label + 1);
    if (e)
        e->count += (size_t)share;
    return e != NULL;
}

/* The label in front: of equal shares that of the nearest voxel, else the lowest. */
typedef struct leader {
    uint32_t label, nearest;
    double share;
} leader;

static void compare_share(leader *l, uint32_t label, double share)
{
    const bool wins_tie = l->label != l->nearest && (label == l->nearest || label < l->label);
    if (share > l->share || (share == l->share && wins_tie)) {
        l->label = label;
        l->share = share;
    }
}

static uint32_t find_leader(const ballot *b, uint32_t nearest)
{
    leader l = {.label = b->label[0], .nearest = nearest, .share = -1};
    for (size_t n = 0; n < b->listed; n++)
        compare_share(&l, b->label[n], b->share[n]);
    for (size_t n = 0; n < b->more.size; n++)
        if (b->more.entries[n].key)
            compare_share(&l, (uint32_t)(b->more.entries[n].key - 1),
                          (double)b->more.entries[n].count);
    return l.label;
}

static const uint32_t *find_row(const tile *t, size_t j, size_t k)
{
    return t->labels + ((k - t->first[2]) * t->rows + (j - t->first[1])) * t->s->in->dim[0];
}

/* Finds the label of the largest share around output sample n. Returns false when memory is out. */
static bool find_majority(const tile *t, const size_t n[3], uint32_t *label)
{
    const sampler *s = t->s;
    const cwi_axis_weights *w = s->w;
    const double *wx = w[0].weights + n[0] * w[0].taps;
    const size_t nx = count_taps(s, 0, n[0]), ny = count_taps(s, 1, n[1]),
                 nz = count_taps(s, 2, n[2]);
    const uint32_t nearest =
        find_row(t, w[1].nearest[n[1]], w[2].nearest[n[2]])[w[0].nearest[n[0]]];
    ballot b = {.listed = 0};
    bool fits = true;
    for (size_t z = 0; z < nz; z++)
        for (size_t y = 0; y < ny; y++) {
            const uint32_t *row =
                find_row(t, w[1].first[n[1]] + y, w[2].first[n[2]] + z) + w[0].first[n[0]];
            const double wyz =
                w[2].weights[n[2] * w[2].taps + z] * w[1].weights[n[1] * w[1].taps + y];
            for (size_t x = 0, end; x < nx && fits; x = end) {
                double share = wx[x];
                for (end = x + 1; end < nx && row[end] == row[x]; end++)
                    share += wx[end];
                fits = add_share(&b, row[x], share * wyz);
            }
        }
    if (fits)
        *label = find_leader(&b, nearest);
    cwi_key_counts_free(&b.more);
    return fits;
}

/* --- tiles ------------------------------------------------------------------------------- */

/* Finds the columns along z with one label, around output slice k. */
static void merge_slices(tile *t, size_t k)
{
    const size_t first = t->s->w[2].first[k], taps = count_taps(t->s, 2, k),
                 size = t->rows * t->s->in->dim[0];
    const uint32_t *from = find_row(t, t->first[1], first);
    memcpy(t->column_label, from, size * sizeof *from);
    memset(t->column_mixed, 0, size);
    for (size_t z = 1; z < taps; z++)
        for (size_t i = 0; i < size; i++)
            t->column_mixed[i] |= from[z * size + i] != from[i];
}

/* Joins those columns along y, around output row j. */
static void merge_rows(tile *t, size_t j)
{
    const size_t size = t->s->in->dim[0], taps = count_taps(t->s, 1, j),
                 at = (t->s->w[1].first[j] - t->first[1]) * size;
    const uint32_t *label = t->column_label + at;
    const uint8_t *mixed = t->column_mixed + at;
    memcpy(t->label, label, size * sizeof *label);
    memcpy(t->mixed, mixed, size);
    for (size_t y = 1; y < taps; y++)
        for (size_t i = 0; i < size; i++)
            t->mixed[i] |= mixed[y * size + i] | (label[y * size + i] != label[i]);
}

/* Samples an output row. Returns false when memory is out. */
static bool sample_row(const tile *t, size_t j, size_t k, uint32_t *to)
{
    const cwi_axis_weights *w = t->s->w;
    for (size_t i = 0; i < w[0].count; i++) {
        const size_t first = w[0].first[i], end = first + count_taps(t->s, 0, i);
        bool mixed = false;
        for (size_t x = first; x < end && !mixed; x++)
            mixed = t->mixed[x] || t->label[x] != t->label[first];
        to[i] = t->label[first];
        if (mixed && !find_majority(t, (const size_t[3]){i, j, k}, &to[i]))
            return false;
    }
    return true;
}

/* Finds the input samples that output samples first to end reach over. */
static size_t find_span(const sampler *s, int a, size_t first, size_t end, size_t *start)
{
    *start = s->w[a].first[first];
    return s->w[a].first[end - 1] + count_taps(s, a, end - 1) - *start;
}

static size_t end_tile(const sampler *s, int a, size_t first)
{
    const size_t left = s->w[a].count - first;
    return first + (left < s->tile[a] ? left : s->tile[a]);
}

/* Loads the voxels of a tile. Returns false where one is no label. */
static bool load_tile(tile *t)
{
    const cw_volume *in = t->s->in;
    for (size_t k = t->first[2]; k < t->first[2] + t->slices; k++)
        for (size_t j = t->first[1]; j < t->first[1] + t->rows; j++) {
            uint32_t *row =
                t->labels + ((k - t->first[2]) * t->rows + (j - t->first[1])) * in->dim[0];
            if (cwi_label_row_load(&t->s->layers, cwi_voxel_address(in, 0, j, k), row) <
                in->dim[0])
                return false;
        }
    return true;
}

/* Returns the bytes of a tile's voxels, and of what it knows of their columns. */
static size_t tile_bytes(const sampler *s, size_t rows, size_t slices)
{
    const size_t pixel = sizeof(uint32_t) + sizeof(uint8_t);
    return s->in->dim[0] * (rows * slices * sizeof(uint32_t) + (rows + 1) * pixel);
}

static void sample_tile(void *context, size_t number)
{
    sampler *s = context;
    tile t = {.s = s};
    const size_t y = number % s->tiles[1] * s->tile[1], z = number / s->tiles[1] * s->tile[2],
                 end_y = end_tile(s, 1, y), end_z = end_tile(s, 2, z), nx = s->in->dim[0];
    t.rows = find_span(s, 1, y, end_y, &t.first[1]);
    t.slices = find_span(s, 2, z, end_z, &t.first[2]);
    t.labels = cwi_alloc_array(tile_bytes(s, t.rows, t.slices), 1);
    if (!t.labels) {
        cwi_set_flag(&s->starved);
        return;
    }
    t.column_label = t.labels + t.slices * t.rows * nx;
    t.label = t.column_label + t.rows * nx;
    t.column_mixed = (uint8_t *)(t.label + nx);
    t.mixed = t.column_mixed + t.rows * nx;
    bool fits = true;
    if (!load_tile(&t))
        cwi_set_flag(&s->has_bad);
    else
        for (size_t k = z; k < end_z && fits; k++) {
            merge_slices(&t, k);
            for (size_t j = y; j < end_y && fits; j++) {
                merge_rows(&t, j);
                fits = sample_row(&t, j, k, s->out + (k * s->w[1].count + j) * s->w[0].count);
            }
        }
    if (!fits)
        cwi_set_flag(&s->starved);
    cwi_free(t.labels);
}

/* --- the call ---------------------------------------------------------------------------- */

/* Fails with the first voxel whose value is no label. */
static cw_status fail_voxel(const sampler *s, cw_error *err)
{
    const cw_volume *in = s->in;
    uint32_t *row = cwi_alloc_array(in->dim[0], sizeof *row);
    size_t bad[3] = {in->dim[0]};
    if (!row)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < in->dim[1] * in->dim[2] && bad[0] == in->dim[0]; n++) {
        bad[1] = n % in->dim[1];
        bad[2] = n / in->dim[1];
        bad[0] = cwi_label_row_load(&s->layers, cwi_voxel_address(in, 0, bad[1], bad[2]), row);
    }
    cwi_free(row);
    return cwi_label_fail_voxel(&s->layers, bad, err);
}

/* Cuts the output into tiles, and checks that they and the result fit the memory. */
static cw_status plan_tiles(sampler *s, const cwi_sample_axis axes[3],
                            const cw_label_resample_desc *desc, cw_error *err)
{
    static const size_t most[3] = {1, TILE_Y, TILE_Z};
    const size_t dim[3] = {axes[0].count, axes[1].count, axes[2].count};
    size_t work = 0, span[3] = {0};
    for (int a = 0; a < 3; a++) {
        const double samples = (double)most[a] / axes[a].wider;
        s->tile[a] = samples > 1 ? (size_t)samples : 1;
        s->tiles[a] = (dim[a] + s->tile[a] - 1) / s->tile[a];
        work += dim[a] * (s->w[a].taps * sizeof(double) + 2 * sizeof(size_t));
        for (size_t n = 0, start; n < dim[a]; n += s->tile[a]) {
            const size_t samples_of_tile = find_span(s, a, n, end_tile(s, a, n), &start);
            span[a] = samples_of_tile > span[a] ? samples_of_tile : span[a];
        }
    }
    const size_t threads = (size_t)cwi_threads(desc->threads),
                 tiles = s->tiles[1] * s->tiles[2];
    work += (threads < tiles ? threads : tiles) * tile_bytes(s, span[1], span[2]);
    const cw_filter_desc limit = {.max_bytes = desc->max_bytes};
    return cwi_filter_check_size(CW_U32, dim, &limit, work, err);
}

/* Makes the output, with the frame of the new grid. */
static cw_status make_output(sampler *s, const cwi_sample_axis axes[3], cw_volume *out,
                             cw_error *err)
{
    const size_t dim[3] = {axes[0].count, axes[1].count, axes[2].count};
    cw_status st = cw_volume_alloc(out, CW_U32, dim, 1, 1, err);
    if (st != CW_OK)
        return st;
    cwi_sample_affine(s->in, axes, out);
    out->known = s->in->known;
    out->said_unit_mm = s->in->said_unit_mm;
    out->said_ras = s->in->said_ras;
    s->out = cw_volume_voxels(out);
    return CW_OK;
}

static cw_status sample_all(sampler *s, const cw_label_resample_desc *desc, cw_volume *out,
                            cw_error *err)
{
    cwi_sample_axis axes[3];
    cw_status st = cwi_sample_axes_plan(s->in, desc->spacing_mm, axes, err);
    for (int a = 0; a < 3 && st == CW_OK; a++)
        st = set_weights(&s->w[a], s->in, a, &axes[a], desc->kernel == CW_LABEL_KERNEL_NEAREST,
                         err);
    if (st == CW_OK)
        st = plan_tiles(s, axes, desc, err);
    if (st == CW_OK)
        st = make_output(s, axes, out, err);
    if (st == CW_OK)
        st = cwi_parallel_for(s->tiles[1] * s->tiles[2],
                              s->tile[1] * s->tile[2] * axes[0].count, desc->threads,
                              &desc->progress, "resampling labels", sample_tile, s, err);
    if (st == CW_OK && s->has_bad)
        st = fail_voxel(s, err);
    if (st == CW_OK && s->starved)
        st = cwi_fail_memory(err);
    for (int a = 0; a < 3; a++)
        cwi_axis_weights_free(&s->w[a]);
    if (st != CW_OK)
        cw_volume_free(out);
    return st;
}

cw_status cw_labels_resample(const cw_volume *volume, const cw_label_resample_desc *desc,
                             cw_volume *out, cw_error *err)
{
    CWI_REQUIRE(err, volume, desc, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_volume in;
    sampler s = {.in = &in, .layers = {.volume = &in, .background = desc->background}};
    *out = (cw_volume){0};
    cw_status st = cw_volume_select(volume, 0, 0, &in, err);
    if (st == CW_OK)
        st = cwi_volume_expect_dense(&in, "resampling labels", err);
    if (st == CW_OK && !cw_label_kernel_name(desc->kernel))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "kernel is %d; a cw_label_kernel was expected",
                      (int)desc->kernel);
    return st == CW_OK ? sample_all(&s, desc, out, err) : st;
}
