/* Computes shadows: rays from every second voxel along each axis, in steps of a unit of eye space,
 * through the interpolated extinction of voxels. Blocks without any are leapt over, by whole
 * steps. The voxels between are interpolated. */
#include "viewer/scene/shadow_volume.h"

#include "viewer/scene/cell_lattice.h"
#include "viewer/scene/transfer_table.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

enum {
    BLOCK = 8,
    MARGIN = 2,
    RADIUS = 12,
    WORK = 32 /* cost of a voxel, relative to those of other loops */
};

/* Optical depth of a shadow that is black to 1/255. */
static const double BLACK_DEPTH = 6;

typedef struct job {
    const cwi_frame *frame;
    const cwi_shadow_key *key;
    const cwi_table *table;
    double to_eye[3][3]; /* gradients */
    size_t dim[3], blocks[3];
    float *extinctions; /* per unit */
    uint8_t *is_dense;  /* blocks with extinction in them, or within MARGIN voxels */
    float *out;
} job;

static size_t number_of(const size_t dim[3], size_t x, size_t y, size_t z)
{
    return (z * dim[1] + y) * dim[0] + x;
}

/* Returns the extinction of a voxel with a coordinate in the table, 0 to 1. */
static float classify(const job *w, float coordinate, const size_t at[3])
{
    const cwi_table *t = w->table;
    const cwi_frame *f = w->frame;
    double gradient[3], eye[3];
    if (coordinate != coordinate)
        return 0;
    const float max = (float)(t->count - 1), position = coordinate * max;
    const float row = position < 0 ? 0 : position > max ? max : position;
    const size_t n = (size_t)row < t->count - 2 ? (size_t)row : t->count - 2;
    const float low = t->rows[4 * n + 3], high = t->rows[4 * n + 7];
    const float extinction = low + (row - (float)n) * (high - low);
    if (f->transfer.gradient_count == 0 || !(extinction > 0))
        return extinction;
    cwi_lattice_gradient(&f->gradient_volume, at, gradient);
    for (int a = 0; a < 3; a++)
        eye[a] = f->gradient_volume.slope * cwi_dot(w->to_eye[a], gradient);
    const double length = cwi_length(eye);
    return extinction * (float)cwi_frame_gradient_factor(f, isfinite(length) ? length : 0);
}

static void classify_layer(void *context, size_t k)
{
    job *w = context;
    float *to = w->extinctions + k * w->dim[0] * w->dim[1];
    cwi_lattice_load(&w->frame->volume, w->table, (size_t[]){0, 0, k},
                     (size_t[]){w->dim[0], w->dim[1], 1}, to);
    for (size_t n = 0; n < w->dim[0] * w->dim[1]; n++)
        to[n] = classify(w, to[n], (size_t[]){n % w->dim[0], n / w->dim[0], k});
}

/* Marks the blocks of a layer of blocks that have extinction, or voxels close to them have. */
static void mark_layer(void *context, size_t bz)
{
    job *w = context;
    for (size_t b = 0; b < w->blocks[0] * w->blocks[1]; b++) {
        const size_t at[3] = {b % w->blocks[0], b / w->blocks[0], bz};
        size_t low[3], high[3];
        bool is_dense = false;
        for (int a = 0; a < 3; a++) {
            low[a] = at[a] > 0 ? at[a] * BLOCK - MARGIN : 0;
            high[a] = at[a] * BLOCK + BLOCK + MARGIN;
            high[a] = high[a] < w->dim[a] ? high[a] : w->dim[a];
        }
        for (size_t z = low[2]; z < high[2] && !is_dense; z++)
            for (size_t y = low[1]; y < high[1] && !is_dense; y++)
                for (size_t x = low[0]; x < high[0]; x++)
                    is_dense = is_dense || w->extinctions[number_of(w->dim, x, y, z)] > 0;
        w->is_dense[number_of(w->blocks, at[0], at[1], at[2])] = is_dense;
    }
}

/* Interpolates the extinction at a position in the volume. */
static inline float extinction_at(const job *w, const double p[3])
{
    const size_t x = (size_t)p[0], y = (size_t)p[1], z = (size_t)p[2];
    const size_t dx = x + 1 < w->dim[0] ? 1 : 0;
    const size_t dy = y + 1 < w->dim[1] ? w->dim[0] : 0;
    const size_t dz = z + 1 < w->dim[2] ? w->dim[0] * w->dim[1] : 0;
    const float *e = w->extinctions + number_of(w->dim, x, y, z);
    const float s = (float)(p[0] - (double)x), t = (float)(p[1] - (double)y),
                u = (float)(p[2] - (double)z);
    const float a = e[0] + s * (e[dx] - e[0]), b = e[dy] + s * (e[dy + dx] - e[dy]);
    const float c = e[dz] + s * (e[dz + dx] - e[dz]);
    const float d = e[dz + dy] + s * (e[dz + dy + dx] - e[dz + dy]);
    const float low = a + t * (b - a), high = c + t * (d - c);
    return low + u * (high - low);
}

/* Returns true if clip planes leave a position visible: what is cut away casts no shadow. */
static bool is_kept(const cwi_shadow_key *key, const double p[3])
{
    bool kept = true;
    for (size_t n = 0; n < key->clip_count; n++)
        kept = kept && cwi_dot(key->clips[n], p) >= key->clips[n][3];
    return kept != (key->cut_away != 0);
}

/* Returns the number of steps from a position that stay in its empty block, at least 1. */
static double steps_in_block(const double p[3], const double step[3])
{
    double min = 1e9;
    for (int a = 0; a < 3; a++) {
        const double low = floor(p[a] / BLOCK) * BLOCK;
        const double distance = step[a] > 0 ? low + BLOCK - p[a] : low - p[a];
        if (step[a] != 0)
            min = fmin(min, distance / step[a]);
    }
    return fmax(floor(min), 1);
}

/* Returns the number of steps after which a ray from a voxel leaves the volume. */
static double steps_in_volume(const job *w, const size_t at[3], const double step[3])
{
    double min = INFINITY;
    for (int a = 0; a < 3; a++) {
        const double distance = step[a] > 0 ? (double)(w->dim[a] - 1 - at[a]) : -(double)at[a];
        if (step[a] != 0)
            min = fmin(min, distance / step[a]);
    }
    return min - 1e-9; /* rounding may put the last point outside */
}

/* Returns the light that comes to a voxel along a ray of a number of steps. The first step,
 * which is mostly the voxel itself, does not count. */
static double follow_ray(const job *w, const size_t at[3], const double step[3], double steps)
{
    const double end = fmin(steps, steps_in_volume(w, at, step));
    double depth = 0;
    for (double n = 1.5; n < end && depth < BLACK_DEPTH;) {
        double p[3];
        for (int a = 0; a < 3; a++)
            p[a] = fmax((double)at[a] + n * step[a], 0);
        const size_t block = number_of(w->blocks, (size_t)p[0] / BLOCK, (size_t)p[1] / BLOCK,
                                       (size_t)p[2] / BLOCK);
        if (!w->is_dense[block]) {
            n += steps_in_block(p, step);
            continue;
        }
        if (w->key->clip_count == 0 || is_kept(w->key, p))
            depth += (double)extinction_at(w, p);
        n++;
    }
    return exp(-depth);
}

/* Computes the voxels of a layer whose numbers are even. */
static void shade_layer(void *context, size_t half)
{
    job *w = context;
    const cwi_shadow_key *key = w->key;
    const size_t k = 2 * half;
    for (size_t j = 0; j < w->dim[1]; j += 2)
        for (size_t i = 0; i < w->dim[0]; i += 2) {
            const size_t at[3] = {i, j, k};
            double light = 0;
            float *to = &w->out[number_of(w->dim, i, j, k)];
            *to = 1;
            if (!w->is_dense[number_of(w->blocks, i / BLOCK, j / BLOCK, k / BLOCK)])
                continue;
            for (size_t r = 0; r < key->count; r++)
                light += follow_ray(w, at, key->steps[r], key->count == 1 ? INFINITY : RADIUS);
            /* half of the rays end in the object itself, where a surface is flat */
            *to = (float)(key->count == 1 ? light : fmin(2 * light / (double)key->count, 1));
        }
}

/* Returns the number of the even voxel above an odd one; at the border that below. */
static size_t even_above(size_t n, size_t dim)
{
    return n + 1 < dim ? n + 1 : n - 1;
}

/* Interpolates rows and voxels between those of a layer that is even. */
static void fill_layer(void *context, size_t half)
{
    job *w = context;
    float *layer = w->out + 2 * half * w->dim[0] * w->dim[1];
    for (size_t j = 0; j < w->dim[1]; j += 2)
        for (size_t i = 1; i < w->dim[0]; i += 2) {
            float *row = layer + j * w->dim[0];
            row[i] = 0.5f * (row[i - 1] + row[even_above(i, w->dim[0])]);
        }
    for (size_t j = 1; j < w->dim[1]; j += 2) {
        const float *low = layer + (j - 1) * w->dim[0];
        const float *high = layer + even_above(j, w->dim[1]) * w->dim[0];
        for (size_t i = 0; i < w->dim[0]; i++)
            layer[j * w->dim[0] + i] = 0.5f * (low[i] + high[i]);
    }
}

/* Interpolates an odd layer. */
static void fill_between(void *context, size_t half)
{
    job *w = context;
    const size_t k = 2 * half + 1, count = w->dim[0] * w->dim[1];
    const float *low = w->out + (k - 1) * count;
    const float *high = w->out + even_above(k, w->dim[2]) * count;
    for (size_t n = 0; n < count; n++)
        w->out[k * count + n] = 0.5f * (low[n] + high[n]);
}

/* Converts a direction of unit length in the world to a step in index space. */
static cw_status find_step(const cwi_frame *f, const double world[3], double step[3],
                           cw_error *err)
{
    double there[3], zero[3] = {0}, at_zero[3], scaled[3];
    for (int a = 0; a < 3; a++)
        scaled[a] = f->unit_mm * world[a];
    cw_status st = cw_volume_to_index(&f->volume, zero, at_zero, err);
    if (st == CW_OK)
        st = cw_volume_to_index(&f->volume, scaled, there, err);
    for (int a = 0; a < 3 && st == CW_OK; a++)
        step[a] = there[a] - at_zero[a];
    return st;
}

/* Finds the rays: one to the first light, or to the sides and corners of a cube. */
static cw_status find_rays(const cwi_frame *f, cwi_shadow_key *key, cw_error *err)
{
    double light[3], world[3];
    cw_status st = CW_OK;
    memcpy(light, f->scene.lights[0].direction, sizeof light);
    cwi_to_unit(light);
    for (int a = 0; a < 3; a++)
        world[a] =
            light[0] * f->axes[0][a] + light[1] * f->axes[1][a] + light[2] * f->axes[2][a];
    if (f->scene.shadow == CW_SHADOW_LIGHT) {
        key->count = 1;
        return find_step(f, world, key->steps[0], err);
    }
    for (size_t n = 0; n < CWI_SHADOW_RAYS && st == CW_OK; n++) {
        for (size_t a = 0; a < 3; a++)
            world[a] = n >= 6 ? ((n - 6) >> a & 1 ? 1 : -1) : n / 2 == a ? (n & 1 ? 1 : -1) : 0;
        cwi_to_unit(world);
        st = find_step(f, world, key->steps[key->count++], err);
    }
    return st;
}

static cw_status make_key(const cwi_frame *f, cwi_shadow_key *key, cw_error *err)
{
    const cw_scene *s = &f->scene;
    memset(key, 0, sizeof *key);
    key->volume = f->volume;
    memcpy(&key->transfer, &f->transfer, sizeof key->transfer);
    key->opacity_units = f->opacity_units;
    key->surface = f->surface;
    key->gradient_version = f->gradient_version;
    key->clip_count = s->clip_count;
    key->cut_away = s->cut_away;
    for (size_t n = 0; n < s->clip_count; n++) {
        const cw_clip *c = &s->clips[n];
        const double *affine = f->volume.affine[0];
        key->clips[n][3] = c->distance_mm;
        for (int r = 0; r < 3; r++) {
            key->clips[n][3] -= c->normal[r] * affine[4 * r + 3];
            for (int a = 0; a < 3; a++)
                key->clips[n][a] += c->normal[r] * affine[4 * r + a];
        }
    }
    return find_rays(f, key, err);
}

static cw_status run_job(job *w, cw_error *err)
{
    const cw_scene *s = &w->frame->scene;
    const size_t layer = w->dim[0] * w->dim[1];
    cw_status st = cwi_parallel_for(w->dim[2], 4 * layer, s->threads, &s->progress,
                                    "classifying", classify_layer, w, err);
    if (st == CW_OK)
        st = cwi_parallel_for(w->blocks[2], BLOCK * layer, s->threads, &s->progress,
                              "classifying", mark_layer, w, err);
    if (st == CW_OK)
        st = cwi_parallel_for((w->dim[2] + 1) / 2, WORK * layer, s->threads, &s->progress,
                              "casting shadows", shade_layer, w, err);
    if (st == CW_OK)
        st = cwi_parallel_for((w->dim[2] + 1) / 2, layer, s->threads, &s->progress,
                              "casting shadows", fill_layer, w, err);
    if (st == CW_OK)
        st = cwi_parallel_for(w->dim[2] / 2, layer, s->threads, &s->progress, "casting shadows",
                              fill_between, w, err);
    return st;
}

static cw_status make_values(const cwi_frame *f, const cwi_shadow_key *key, float *values,
                             cw_error *err)
{
    job w = {.frame = f, .key = key, .out = values};
    cwi_table table;
    cw_status st = cwi_table_make(f, &table, err);
    if (st != CW_OK)
        return st;
    w.table = &table;
    cwi_frame_gradient_matrix(f, w.to_eye);
    for (int a = 0; a < 3; a++) {
        w.dim[a] = f->volume.dim[a];
        w.blocks[a] = (w.dim[a] + BLOCK - 1) / BLOCK;
    }
    w.extinctions = cwi_alloc_array(w.dim[0] * w.dim[1] * w.dim[2], sizeof *w.extinctions);
    w.is_dense = cwi_alloc_array(w.blocks[0] * w.blocks[1] * w.blocks[2], 1);
    st = w.extinctions && w.is_dense ? run_job(&w, err) : cwi_fail_memory(err);
    cwi_free(w.extinctions);
    cwi_free(w.is_dense);
    cwi_table_free(&table);
    return st;
}

static cw_status make_shadows(cwi_shadow_volume *made, const cwi_frame *f,
                              const cwi_shadow_key *key, cw_error *err)
{
    const size_t count = f->volume.dim[0] * f->volume.dim[1] * f->volume.dim[2];
    cwi_shadow_volume_free(made);
    float *values = cwi_alloc_array(count, sizeof *values);
    if (!values)
        return cwi_fail_memory(err);
    cw_status st = make_values(f, key, values, err);
    if (st != CW_OK) {
        cwi_free(values);
        return st;
    }
    made->values = values;
    memcpy(&made->key, key, sizeof *key);
    made->version++;
    return CW_OK;
}

cw_status cwi_shadow_volume_take(cwi_shadow_volume *made, cwi_frame *f, cw_error *err)
{
    cwi_shadow_key key;
    const cw_mode mode = f->scene.mode;
    if (f->scene.shadow == CW_SHADOW_NONE || !f->scene.lit || !f->volume.data)
        return CW_OK;
    if (mode != CW_MODE_COMPOSITE && mode != CW_MODE_TEXTURE && mode != CW_MODE_VBUFFER &&
        mode != CW_MODE_REFERENCE)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "the mode %s has no shadows; composite, texture, vbuffer and reference "
                        "have",
                        cw_mode_name(mode));
    if (cwi_volume_kind(&f->volume))
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "shadows fall in evenly spaced volumes, not in %s",
                        cwi_volume_kind(&f->volume));
    cw_status st = make_key(f, &key, err);
    if (st == CW_OK && (!made->values || memcmp(&key, &made->key, sizeof key) != 0))
        st = make_shadows(made, f, &key, err);
    if (st != CW_OK)
        return st;
    f->shadows = made->values;
    f->shadow_version = made->version;
    return CW_OK;
}

void cwi_shadow_volume_free(cwi_shadow_volume *made)
{
    const size_t version = made->version; /* numbers go on */
    cwi_free(made->values);
    memset(made, 0, sizeof *made);
    made->version = version;
}
