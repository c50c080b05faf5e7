/* Uploads a volume as 3D textures: one, or bricks where one would be too large. */
#include "viewer/gl/gl_internal.h"
#include "viewer/scene/voxel_rows.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/volume/volume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    CHUNK_BYTES = 1 << 22,
    MAX_BRICKS = 4096,
    GRADIENT_BYTES = 8,
    MAX_GRADIENTS = 1 << 24 /* voxels that have their gradients in a texture */
};

/* Returns the format of texels. Eight and sixteen bits are normalised, and stay exact; others
 * become floats. */
static cwi_gl_texels kind_of(const cw_volume *v)
{
    const cwi_gl_texels single = {GL_R32F, GL_FLOAT, 4, v->type == CW_F32 && !v->has_nodata,
                                  1,       0};
    if (v->has_nodata) /* becomes NaN */
        return single;
    switch (v->type) {
    case CW_U8:
        return (cwi_gl_texels){GL_R8, GL_UNSIGNED_BYTE, 1, true, 255, 0};
    case CW_I8:
        return (cwi_gl_texels){GL_R8, GL_UNSIGNED_BYTE, 1, false, 255, -128};
    case CW_U16:
        return (cwi_gl_texels){GL_R16, GL_UNSIGNED_SHORT, 2, true, 65535, 0};
    case CW_I16:
        return (cwi_gl_texels){GL_R16, GL_UNSIGNED_SHORT, 2, false, 65535, -32768};
    case CW_F32:
        return single;
    default:
        return (cwi_gl_texels){GL_R32F, GL_FLOAT, 4, false, 1, 0};
    }
}

/* Finds the range of the volume's values; 0, 1 when it has none. */
static void find_range(const cwi_ranges *ranges, double range[2])
{
    range[0] = INFINITY;
    range[1] = -INFINITY;
    for (size_t n = 0; n < ranges->dim[0] * ranges->dim[1] * ranges->dim[2]; n++)
        if (ranges->blocks[n][0] <= ranges->blocks[n][1]) {
            range[0] = fmin(range[0], (double)ranges->blocks[n][0]);
            range[1] = fmax(range[1], (double)ranges->blocks[n][1]);
        }
    if (!(range[0] < range[1])) {
        range[0] = 0;
        range[1] = 1;
    }
}

/* Scales wide types: their numbers are uploaded relative to the middle, in units of half their
 * range. */
static void fit_wide(const cw_volume *v, const double range[2], cwi_gl_texels *kind)
{
    if (kind->type != GL_FLOAT || v->type == CW_F32)
        return;
    kind->bias = ((range[0] + range[1]) / 2 - v->intercept) / v->slope;
    kind->scale = fabs((range[1] - range[0]) / 2 / v->slope);
}

/* A row of the type that most scans have. */
static void put_shorts(const char *from, ptrdiff_t stride, size_t count, uint16_t *to)
{
    if (stride == (ptrdiff_t)sizeof(int16_t))
        for (size_t i = 0; i < count; i++)
            to[i] = (uint16_t)(((const int16_t *)from)[i] + 32768);
    else
        for (size_t i = 0; i < count; i++)
            to[i] = (uint16_t)(*(const int16_t *)(from + (ptrdiff_t)i * stride) + 32768);
}

static void put_row(const cw_volume *v, const cwi_gl_texels *kind, const char *from,
                    size_t count, void *to)
{
    if (v->type == CW_I16 && kind->type == GL_UNSIGNED_SHORT) {
        put_shorts(from, v->stride[0], count, to);
        return;
    }
    for (size_t i = 0; i < count; i++, from += v->stride[0]) {
        const double x = cwi_voxel_at(v->type, from);
        if (kind->type == GL_UNSIGNED_BYTE)
            ((uint8_t *)to)[i] = (uint8_t)(x - kind->bias);
        else if (kind->type == GL_UNSIGNED_SHORT)
            ((uint16_t *)to)[i] = (uint16_t)(x - kind->bias);
        else
            ((float *)to)[i] =
                v->has_nodata && x == v->nodata ? NAN : (float)((x - kind->bias) / kind->scale);
    }
}

/* Layers of a brick that are converted for an upload. */
typedef struct layer_copy {
    const cw_volume *v;
    const cwi_gl_texels *kind;
    const cwi_gl_brick *brick;
    size_t from; /* the first layer, counted in the brick */
    char *to;
} layer_copy;

static void put_layer(void *context, size_t k)
{
    const layer_copy *c = context;
    const cwi_gl_brick *b = c->brick;
    const size_t row = b->count[0] * c->kind->size;
    for (size_t j = 0; j < b->count[1]; j++)
        put_row(
            c->v, c->kind,
            cwi_voxel_address(c->v, b->first[0], b->first[1] + j, b->first[2] + c->from + k),
            b->count[0], c->to + (k * b->count[1] + j) * row);
}

static size_t layers_at_once(size_t layer_bytes, size_t layers)
{
    const size_t fit = CHUNK_BYTES / layer_bytes;
    return fit < 1 ? 1 : fit < layers ? fit : layers;
}

/* Makes a texture of values. Mesa's software renderer interpolates eight bits in eight bits,
 * unless a texture is mirrored at its ends. Up to half a texel beyond them that is the same as
 * clamping. */
static GLuint values_texture(const cwi_gl_texels *kind)
{
    const GLuint name = cwi_gl_texture(GL_TEXTURE_3D, CWI_UNIT_VOLUME, true);
    if (kind->inner == GL_R8)
        glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_WRAP_R, GL_MIRRORED_REPEAT);
    return name;
}

/* Counts OpenGL's memory, which is this process's where OpenGL is software. */
static cw_status take_memory(cwi_gl_volume *g, size_t bytes, cw_error *err)
{
    if (!cwi_memory_take(bytes))
        return cwi_fail_memory(err);
    g->texture_bytes += bytes;
    return CW_OK;
}

/* Uploads a brick in chunks, without a copy of the voxels where possible. */
static cw_status upload_brick(cwi_gl *gl, const cwi_gl_texels *kind, const cwi_gl_brick *b,
                              cw_error *err)
{
    const cw_volume *v = &gl->volume.key;
    const GLsizei w = (GLsizei)b->count[0], h = (GLsizei)b->count[1], d = (GLsizei)b->count[2];
    const bool as_is = kind->as_is && cwi_gl_is_packed(v) && b->count[0] == v->dim[0] &&
                       b->count[1] == v->dim[1];
    const size_t layer = b->count[0] * b->count[1] * kind->size;
    const size_t step = layers_at_once(layer, b->count[2]);
    char *chunk = as_is ? NULL : cwi_alloc_array(step, layer);
    if (!chunk && !as_is)
        return cwi_fail_memory(err);
    cw_status st = take_memory(&gl->volume, layer * b->count[2], err);
    if (st != CW_OK) {
        cwi_free(chunk);
        return st;
    }
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage3D(GL_TEXTURE_3D, 0, (GLint)kind->inner, w, h, d, 0, GL_RED, kind->type, NULL);
    for (size_t k = 0; k < b->count[2] && st == CW_OK; k += step) {
        const size_t n = b->count[2] - k < step ? b->count[2] - k : step;
        layer_copy copy = {v, kind, b, k, chunk};
        if (!as_is)
            cwi_parallel_for_all(n, b->count[0] * b->count[1], gl->frame->scene.threads,
                                 put_layer, &copy);
        glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, (GLint)k, w, h, (GLsizei)n, GL_RED, kind->type,
                        as_is ? cwi_voxel_address(v, 0, 0, b->first[2] + k) : chunk);
        st = cwi_gl_report_soon(gl, "uploading", (double)(k + n) / (double)b->count[2], err);
    }
    cwi_free(chunk);
    return st;
}

/* Returns true if this OpenGL makes such a texture: only a proxy texture shows that. */
static bool texture_fits(GLenum inner, size_t w, size_t h, size_t d)
{
    GLint got = 0, max = 0;
    glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &max);
    if (w > (size_t)max || h > (size_t)max || d > (size_t)max)
        return false;
    glTexImage3D(GL_PROXY_TEXTURE_3D, 0, (GLint)inner, (GLsizei)w, (GLsizei)h, (GLsizei)d, 0,
                 inner == GL_RGBA16F ? GL_RGBA : GL_RED, GL_FLOAT, NULL);
    glGetTexLevelParameteriv(GL_PROXY_TEXTURE_3D, 0, GL_TEXTURE_WIDTH, &got);
    return got != 0;
}

/* Returns the number of parts, of at most `edge` samples, into which an axis of n samples is
 * cut; neighbours share a sample. */
static size_t parts_of(size_t n, size_t edge)
{
    return n <= edge ? 1 : (n - 2) / (edge - 1) + 1;
}

/* Chooses the largest bricks of values and gradients that fit; longest axes are cut first. */
static void choose_edges(const cw_volume *v, const cwi_gl_texels *kind, size_t requested,
                         size_t edge[3])
{
    for (int a = 0; a < 3; a++)
        edge[a] = requested >= 2 && requested < v->dim[a] ? requested : v->dim[a];
    while (!(texture_fits(kind->inner, edge[0], edge[1], edge[2]) &&
             texture_fits(GL_RGBA16F, edge[0], edge[1], edge[2]))) {
        int longest = 0;
        for (int a = 1; a < 3; a++)
            if (edge[a] > edge[longest])
                longest = a;
        if (edge[longest] <= 32)
            break;
        edge[longest] = edge[longest] / 2 + 1;
    }
}

static cw_status plan_bricks(cwi_gl_volume *g, const size_t edge[3], cw_error *err)
{
    const cw_volume *v = &g->key;
    size_t parts[3];
    for (int a = 0; a < 3; a++)
        parts[a] = parts_of(v->dim[a], edge[a]);
    const size_t count = parts[0] * parts[1] * parts[2];
    if (count > MAX_BRICKS)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "the volume makes %zu textures: at most %d are drawn", count,
                        MAX_BRICKS);
    g->bricks = cwi_alloc_zeroed(count, sizeof *g->bricks);
    if (!g->bricks)
        return cwi_fail_memory(err);
    g->brick_count = count;
    for (size_t n = 0; n < count; n++) {
        const size_t at[3] = {n % parts[0], n / parts[0] % parts[1], n / parts[0] / parts[1]};
        for (int a = 0; a < 3; a++) {
            const size_t first = at[a] * (edge[a] - 1), left = v->dim[a] - first;
            g->bricks[n].first[a] = first;
            g->bricks[n].count[a] = left < edge[a] ? left : edge[a];
        }
    }
    return CW_OK;
}

void cwi_gl_drop_volume(cwi_gl *gl)
{
    cwi_gl_volume *g = &gl->volume;
    for (size_t n = 0; n < g->brick_count; n++) {
        glDeleteTextures(1, &g->bricks[n].values);
        glDeleteTextures(1, &g->bricks[n].gradients);
        glDeleteTextures(1, &g->bricks[n].voxels);
        glDeleteBuffers(1, &g->bricks[n].buffer);
    }
    cwi_memory_give(g->texture_bytes);
    cwi_free(g->bricks);
    cwi_ranges_free(&g->ranges);
    *g = (cwi_gl_volume){0};
}

void cwi_gl_drop_scene(cwi_gl *gl)
{
    gl->drop_states(gl);
    cwi_gl_drop_volume(gl);
    cwi_gl_drop_transfer(gl);
}

/* Returns the unit of gradients that is best for a frame: they are about 1 in it. */
static double find_gradient_unit(const cwi_gl_volume *g, const cwi_frame *f)
{
    return f->surface > 0 ? 1 : g->range;
}

static bool is_there(const cwi_gl_volume *g, const cwi_frame *f)
{
    return g->bricks && g->edge == f->scene.sampling.texture_edge &&
           memcmp(&g->key, &f->volume, sizeof g->key) == 0;
}

/* Sets up a volume, without its textures. */
static cw_status make_volume(cwi_gl *gl, cw_error *err)
{
    cwi_gl_volume *g = &gl->volume;
    size_t edge[3];
    double range[2];
    cwi_gl_drop_scene(gl);
    g->key = gl->frame->volume;
    g->edge = gl->frame->scene.sampling.texture_edge;
    cw_status st = cwi_ranges_make(&g->key, gl->frame->scene.threads, &gl->watch.progress,
                                   &g->ranges, err);
    if (st != CW_OK)
        return st;
    find_range(&g->ranges, range);
    g->kind = kind_of(&g->key);
    fit_wide(&g->key, range, &g->kind);
    g->range = range[1] - range[0];
    g->scale = g->key.slope * g->kind.scale;
    g->bias = g->key.slope * g->kind.bias + g->key.intercept;
    choose_edges(&g->key, &g->kind, g->edge, edge);
    return plan_bricks(g, edge, err);
}

static cw_status upload_bricks(cwi_gl *gl, cw_error *err)
{
    cwi_gl_volume *g = &gl->volume;
    cw_status st = CW_OK;
    for (size_t n = 0; n < g->brick_count && st == CW_OK; n++)
        if (!g->bricks[n].values) {
            g->bricks[n].values = values_texture(&g->kind);
            st = upload_brick(gl, &g->kind, &g->bricks[n], err);
        }
    return st;
}

/* Drops gradients that are not the frame's. */
static void choose_gradients(cwi_gl_volume *g, const cwi_frame *f)
{
    const double unit = find_gradient_unit(g, f);
    if (g->gradient_version == f->gradient_version && g->shadow_version == f->shadow_version &&
        g->gradient_unit == unit)
        return;
    for (size_t n = 0; n < g->brick_count; n++) {
        const size_t *count = g->bricks[n].count;
        const size_t bytes = count[0] * count[1] * count[2] * GRADIENT_BYTES;
        if (!g->bricks[n].gradients)
            continue;
        glDeleteTextures(1, &g->bricks[n].gradients);
        g->bricks[n].gradients = 0;
        cwi_memory_give(bytes);
        g->texture_bytes -= bytes;
    }
    g->gradient_version = f->gradient_version;
    g->shadow_version = f->shadow_version;
    g->gradient_unit = unit;
}

cw_status cwi_gl_take_volume(cwi_gl *gl, bool as_textures, cw_error *err)
{
    cw_status st = is_there(&gl->volume, gl->frame) ? CW_OK : make_volume(gl, err);
    if (st == CW_OK && (cwi_frame_needs_gradients(gl->frame) || gl->volume.gradient_unit == 0))
        choose_gradients(&gl->volume, gl->frame);
    gl->volume.in_place = st == CW_OK && !as_textures && cwi_gl_find_voxels(gl);
    if (st == CW_OK && !gl->volume.in_place)
        st = upload_bricks(gl, err);
    if (st != CW_OK)
        cwi_gl_drop_volume(gl);
    return st;
}

/* Converts to half precision, rounded to the nearest, at most the largest; NaN becomes 0. It
 * has no branches, so that rows are vectorised. */
static uint16_t to_half(float x)
{
    float small;
    uint32_t bits, tiny;
    memcpy(&bits, &x, sizeof bits);
    const uint32_t sign = bits >> 16 & 0x8000u, size = bits & 0x7fffffffu;
    small = fabsf(x) + 0.5f; /* whose last bit is 2^-24, as that of halves below 2^-14 */
    memcpy(&tiny, &small, sizeof tiny);
    const uint32_t normal = (size - 0x38000000u + 0xfffu + (size >> 13 & 1)) >> 13;
    const uint32_t half = size < 0x38800000u   ? tiny - 0x3f000000u
                          : size < 0x477ff000u ? normal
                          : size < 0x7f800000u ? 0x7bffu
                                               : 0;
    return (uint16_t)(sign | half);
}

/* Returns the row n before or after one, or that one at the border; and the distance of two
 * such rows. */
static const char *row_at(const cw_volume *v, const char *row, int axis, size_t at, int n)
{
    const bool is_there = n < 0 ? at > 0 : at + 1 < v->dim[axis];
    return is_there ? row + n * v->stride[axis] : row;
}

static float step_length(const cw_volume *v, int axis, size_t at)
{
    return at > 0 && at + 1 < v->dim[axis] ? 0.5f : 1;
}

/* Subtracts the row below from the one above; the result may be NaN, which to_half() makes
 * 0. */
static void subtract_rows(const float *low, const float *high, size_t n, float scale,
                          float *out)
{
    for (size_t i = 0; i < n; i++)
        out[i] = (high[i] - low[i]) * scale;
}

static void along_row(const float *row, size_t n, float scale, float *out)
{
    out[0] = out[n - 1] = 0;
    if (n < 2)
        return;
    subtract_rows(row, row + 2, n - 2, scale / 2, out + 1);
    subtract_rows(row, row + 1, 1, scale, out);
    subtract_rows(row + n - 2, row + n - 1, 1, scale, out + n - 1);
}

/* Derivatives along a row: central inside, one-sided at the border; 0 where a neighbour has no
 * value; and shadows, if there are some. rows: room for five rows */
static void put_gradient_row(const cw_volume *v, const cwi_gl_brick *b, size_t j, size_t k,
                             const float *shadows, float scale, float *rows, uint16_t (*out)[4])
{
    const size_t n = v->dim[0];
    const char *row = cwi_voxel_address(v, 0, j, k);
    float *x = rows, *y = rows + n, *z = rows + 2 * n, *low = rows + 3 * n, *high = low + n;
    along_row(cwi_row_of(v, row, n, low), n, scale, x);
    subtract_rows(cwi_row_of(v, row_at(v, row, 1, j, -1), n, low),
                  cwi_row_of(v, row_at(v, row, 1, j, 1), n, high), n,
                  scale * step_length(v, 1, j), y);
    subtract_rows(cwi_row_of(v, row_at(v, row, 2, k, -1), n, low),
                  cwi_row_of(v, row_at(v, row, 2, k, 1), n, high), n,
                  scale * step_length(v, 2, k), z);
    for (size_t i = 0, at = b->first[0]; i < b->count[0]; i++, at++) {
        out[i][0] = to_half(x[at]);
        out[i][1] = to_half(y[at]);
        out[i][2] = to_half(z[at]);
        out[i][3] = shadows ? to_half(shadows[(k * v->dim[1] + j) * n + at]) : 0x3c00; /* 1 */
    }
}

/* Layers of a brick whose gradients are computed for an upload. */
typedef struct gradient_copy {
    const cwi_frame *frame;
    const cwi_gl_brick *brick;
    float scale;
    size_t from; /* the first layer, counted in the brick */
    uint16_t (*to)[4];
    bool is_starved;
} gradient_copy;

static void put_gradient_layer(void *context, size_t k)
{
    gradient_copy *c = context;
    const cwi_gl_brick *b = c->brick;
    const cw_volume *v = &c->frame->gradient_volume;
    float *rows = cwi_alloc_array(v->dim[0], 5 * sizeof *rows);
    if (!rows)
        cwi_set_flag(&c->is_starved);
    for (size_t j = 0; j < b->count[1] && rows; j++)
        put_gradient_row(v, b, b->first[1] + j, b->first[2] + c->from + k, c->frame->shadows,
                         c->scale, rows, c->to + (k * b->count[1] + j) * b->count[0]);
    cwi_free(rows);
}

static cw_status upload_gradients(cwi_gl *gl, cwi_gl_brick *b, cw_error *err)
{
    const cw_volume *v = &gl->frame->gradient_volume;
    const double scale = v->slope / gl->volume.gradient_unit;
    const GLsizei w = (GLsizei)b->count[0], h = (GLsizei)b->count[1];
    const size_t layer = b->count[0] * b->count[1] * GRADIENT_BYTES;
    const size_t step = layers_at_once(layer, b->count[2]);
    cw_status st = take_memory(&gl->volume, layer * b->count[2], err);
    if (st != CW_OK)
        return st;
    void *chunk = cwi_alloc_array(step, layer);
    if (!chunk)
        return cwi_fail_memory(err);
    b->gradients = cwi_gl_texture(GL_TEXTURE_3D, CWI_UNIT_GRADIENT, true);
    glTexImage3D(GL_TEXTURE_3D, 0, GL_RGBA16F, w, h, (GLsizei)b->count[2], 0, GL_RGBA,
                 GL_HALF_FLOAT, NULL);
    for (size_t k = 0; k < b->count[2] && st == CW_OK; k += step) {
        const size_t n = b->count[2] - k < step ? b->count[2] - k : step;
        gradient_copy copy = {
            .frame = gl->frame, .brick = b, .scale = (float)scale, .from = k, .to = chunk};
        cwi_parallel_for_all(n, b->count[0] * b->count[1], gl->frame->scene.threads,
                             put_gradient_layer, &copy);
        if (copy.is_starved)
            st = cwi_fail_memory(err);
        else
            glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, (GLint)k, w, h, (GLsizei)n, GL_RGBA,
                            GL_HALF_FLOAT, chunk);
        if (st == CW_OK)
            st =
                cwi_gl_report_soon(gl, "uploading", (double)(k + n) / (double)b->count[2], err);
    }
    cwi_free(chunk);
    if (st != CW_OK) { /* half of them are none */
        glDeleteTextures(1, &b->gradients);
        b->gradients = 0;
    }
    return st;
}

/* Returns true if differences can be computed: they need neighbours, and the next brick's are
 * not available. */
static bool has_differences(const cwi_gl *gl)
{
    const cwi_gl_volume *g = &gl->volume;
    const size_t *dim = g->key.dim;
    return g->brick_count == 1 && !g->ranges.has_gaps && !gl->frame->gradient_version &&
           !gl->frame->shadows &&
           (gl->frame->scene.sampling.lean || dim[0] * dim[1] * dim[2] > MAX_GRADIENTS);
}

cw_status cwi_gl_need_gradients(cwi_gl *gl, const char **defines, cw_error *err)
{
    cwi_gl_volume *g = &gl->volume;
    cw_status st = CW_OK;
    const bool differs = has_differences(gl);
    *defines = differs                                      ? "#define DIFFERENCES\n"
               : !gl->frame->shadows                        ? ""
               : gl->frame->scene.shadow == CW_SHADOW_LIGHT ? "#define SHADOW\n"
                                                            : "#define OCCLUSION\n";
    for (size_t n = 0; n < g->brick_count && !differs && st == CW_OK; n++)
        if (!g->bricks[n].gradients)
            st = upload_gradients(gl, &g->bricks[n], err);
    return st;
}

typedef struct placed {
    double distance;
    size_t brick;
} placed;

static int farther_first(const void *a, const void *b)
{
    const placed *x = a, *y = b;
    return x->distance < y->distance   ? 1
           : x->distance > y->distance ? -1
           : x->brick < y->brick       ? -1
                                       : x->brick > y->brick;
}

/* Returns the sum over axes of the eye's distance from a brick's faces. A brick that hides
 * another is nearer along some axes, and farther along none. */
static double brick_distance(const cwi_gl_brick *b, const double eye[3])
{
    double sum = 0;
    for (int a = 0; a < 3; a++) {
        const double low = (double)b->first[a], high = low + (double)b->count[a] - 1;
        sum += eye[a] < low ? low - eye[a] : eye[a] > high ? eye[a] - high : 0;
    }
    return sum;
}

size_t *cwi_gl_order_bricks(const cwi_gl *gl)
{
    const cwi_gl_volume *g = &gl->volume;
    const double back[3] = {0, 0, gl->frame->perspective ? 0 : 1e6 * fmax(gl->frame->far, 1)};
    double eye[3];
    size_t *order = cwi_alloc_array(g->brick_count, sizeof *order);
    placed *all = cwi_alloc_array(g->brick_count, sizeof *all);
    cwi_affine_apply(gl->frame->index_from_eye, back, eye);
    for (size_t n = 0; order && all && n < g->brick_count; n++)
        all[n] = (placed){brick_distance(&g->bricks[n], eye), n};
    if (order && all) {
        qsort(all, g->brick_count, sizeof *all, farther_first);
        for (size_t n = 0; n < g->brick_count; n++)
            order[n] = all[n].brick;
    } else {
        cwi_free(order);
        order = NULL;
    }
    cwi_free(all);
    return order;
}
