/* Divides a view's depth into slabs, and marks, in tiles of the picture, those that meet
 * something visible. */
#include "viewer/proxy/view_slabs.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"

#include <math.h>
#include <string.h>

/* Depth of a layer of thin slabs: half of an empty block. Deep scenes have thicker layers, to
 * save memory. */
enum { LAYER_DEPTH = 4, MAX_LAYERS = 1 << 16, MAX_SLABS = 1 << 24 };

/* Finds the depths, from the eye's plane, of the nearest and the farthest corner of the
 * volume. */
static void find_depths(const cwi_frame *f, double depth[2])
{
    depth[0] = INFINITY;
    depth[1] = -INFINITY;
    for (int n = 0; n < 8; n++) {
        double p[3], eye[3];
        for (int a = 0; a < 3; a++)
            p[a] = n >> a & 1 ? f->high[a] : f->low[a];
        cwi_affine_apply(f->eye_from_index, p, eye);
        depth[0] = fmin(depth[0], -eye[2]);
        depth[1] = fmax(depth[1], -eye[2]);
    }
    if (f->perspective)
        depth[0] = fmax(depth[0], f->near);
}

cw_status cwi_slabs_init(const cwi_frame *f, cwi_slabs *s, cw_error *err)
{
    double depth[2];
    *s = (cwi_slabs){.thickness = f->scene.sampling.step_vox};
    find_depths(f, depth);
    s->first = depth[0];
    const double extent = fmax(depth[1] - depth[0], 0);
    const double count = ceil(extent / s->thickness);
    if (count > MAX_SLABS)
        return cwi_fail(err, CW_ERR_LIMIT, "%.3g slices: at most %d are drawn", count,
                        MAX_SLABS);
    s->count = (size_t)count;
    s->per_layer =
        (size_t)fmax(1, floor(fmax(LAYER_DEPTH, extent / MAX_LAYERS) / s->thickness));
    s->layer_count = (s->count + s->per_layer - 1) / s->per_layer;
    const size_t longest = f->scene.width > f->scene.height ? f->scene.width : f->scene.height;
    s->tile = (longest + CWI_SLAB_TILES - 1) / CWI_SLAB_TILES;
    s->rows = cwi_alloc_zeroed(s->layer_count, sizeof *s->rows);
    return s->rows ? CW_OK : cwi_fail_memory(err);
}

void cwi_slabs_free(cwi_slabs *s)
{
    cwi_free(s->rows);
    *s = (cwi_slabs){0};
}

void cwi_slabs_clear(cwi_slabs *s)
{
    memset(s->rows, 0, s->layer_count * sizeof *s->rows);
}

/* Bounds of a box: samples of the picture, and depths. */
typedef struct bounds {
    double low[3], high[3];
} bounds;

/* Widens bounds by a corner in eye space. A point beside the eye may be seen anywhere. */
static void widen_bounds(const cwi_frame *f, const double eye[3], bounds *b)
{
    const double depth = -eye[2], w = f->perspective ? depth : 1;
    const double size[2] = {(double)f->scene.width, (double)f->scene.height};
    b->low[2] = fmin(b->low[2], depth);
    b->high[2] = fmax(b->high[2], depth);
    for (int a = 0; a < 2; a++) {
        const bool is_seen = !f->perspective || depth >= f->near;
        const double at = (eye[a] / w / f->half[a] + 1) / 2 * size[a];
        b->low[a] = is_seen ? fmin(b->low[a], at) : 0;
        b->high[a] = is_seen ? fmax(b->high[a], at) : size[a];
    }
}

static bounds bounds_of(const cwi_frame *f, const double low[3], const double high[3])
{
    bounds b = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    const double *m = f->eye_from_index;
    double base[3], eye[3];
    cwi_affine_apply(m, low, base);
    for (int n = 0; n < 8; n++) {
        memcpy(eye, base, sizeof eye);
        for (int c = 0; c < 3; c++)
            for (int r = 0; r < 3 && (n >> c & 1); r++)
                eye[r] += m[4 * r + c] * (high[c] - low[c]);
        widen_bounds(f, eye, &b);
    }
    return b;
}

/* Finds which of `count` parts of a length an interval touches; returns false if none. */
static bool parts_of(double low, double high, double part, size_t count, size_t parts[2])
{
    const double first = fmax(floor(low / part), 0);
    const double last = fmin(floor(high / part), (double)count - 1);
    if (!(first <= last))
        return false;
    parts[0] = (size_t)first;
    parts[1] = (size_t)last;
    return true;
}

void cwi_slabs_mark(cwi_slabs *s, const cwi_frame *f, const double low[3], const double high[3])
{
    const double ROUNDING = 1e-3; /* rays and corners are rounded */
    const bounds b = bounds_of(f, low, high);
    const double layer = s->thickness * (double)s->per_layer, tile = (double)s->tile;
    size_t x[2], y[2], z[2];
    if (!parts_of(b.low[0] - ROUNDING, b.high[0] + ROUNDING, tile, CWI_SLAB_TILES, x) ||
        !parts_of(b.low[1] - ROUNDING, b.high[1] + ROUNDING, tile, CWI_SLAB_TILES, y) ||
        !parts_of(b.low[2] - s->first - ROUNDING, b.high[2] - s->first + ROUNDING, layer,
                  s->layer_count, z))
        return;
    const uint64_t mask = UINT64_MAX >> (CWI_SLAB_TILES - 1 - (x[1] - x[0])) << x[0];
    for (size_t k = z[0]; k <= z[1]; k++)
        for (size_t j = y[0]; j <= y[1]; j++)
            s->rows[k][j] |= mask;
}

/* Finds the lowest run of ones of a number that is not 0. */
static void first_run(uint64_t bits, size_t run[2])
{
    run[0] = 0;
    while (!(bits >> run[0] & 1))
        run[0]++;
    run[1] = run[0];
    while (run[1] < CWI_SLAB_TILES && (bits >> run[1] & 1))
        run[1]++;
}

static uint16_t sample_of(const cwi_slabs *s, size_t tile, size_t size)
{
    return (uint16_t)(tile * s->tile < size ? tile * s->tile : size);
}

/* Makes rectangles: each run of tiles grows upward as long as it is marked. */
size_t cwi_slabs_rects(const cwi_slabs *s, const cwi_frame *f, size_t layer,
                       cwi_slab_rect rects[CWI_SLAB_RECTS])
{
    uint64_t rows[CWI_SLAB_TILES];
    size_t count = 0, run[2];
    memcpy(rows, s->rows[layer], sizeof rows);
    for (size_t j = 0; j < CWI_SLAB_TILES; j++)
        while (rows[j]) {
            size_t top = j;
            first_run(rows[j], run);
            const uint64_t mask = UINT64_MAX >> (CWI_SLAB_TILES - (run[1] - run[0])) << run[0];
            while (top < CWI_SLAB_TILES && (rows[top] & mask) == mask)
                rows[top++] &= ~mask;
            rects[count++] = (cwi_slab_rect){
                sample_of(s, run[0], f->scene.width), sample_of(s, j, f->scene.height),
                sample_of(s, run[1], f->scene.width), sample_of(s, top, f->scene.height)};
        }
    return count;
}

void cwi_slabs_texture_matrix(const cwi_frame *f, const size_t first[3], const size_t count[3],
                              double m[12])
{
    for (size_t r = 0; r < 3; r++) {
        for (size_t c = 0; c < 4; c++)
            m[4 * r + c] = f->index_from_eye[4 * r + c] / (double)count[r];
        m[4 * r + 3] += (0.5 - (double)first[r]) / (double)count[r];
    }
}
