/* Draws slices through 3D textures of data, or of colours when these are interpolated
 * [Wilson1994]. */
#include "viewer/modes/slab_textures.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/volume/volume.h"
#include "viewer/modes/gl_draw.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct texture_state {
    cwi_gl_slabs slices;
    size_t class_count; /* as many as bricks, or 0 */
    GLuint *classes;    /* textures of classified voxels */
    cw_transfer key;    /* they were made for */
    double opacity_units;
} texture_state;

static void drop_classes(texture_state *t)
{
    if (t->class_count)
        glDeleteTextures((GLsizei)t->class_count, t->classes);
    cwi_free(t->classes);
    t->classes = NULL;
    t->class_count = 0;
}

static void drop_texture_mode(void *state)
{
    texture_state *t = state;
    cwi_gl_drop_slices(&t->slices);
    drop_classes(t);
    cwi_free(t);
}

/* Computes emission and extinction per unit. These are linear in the amount of a material, and
 * so may be interpolated. Without a value both are 0. */
enum { WORK = 8 }; /* of a voxel, in samples that are read */

static void classify_value(const cwi_table *t, double value, float out[4])
{
    memset(out, 0, 4 * sizeof *out);
    if (isnan(value))
        return;
    const double fraction = fmin(fmax((value - t->low) / (t->high - t->low), 0), 1);
    const double at = fraction * (double)(t->count - 1);
    const size_t n = (size_t)fmin(floor(at), (double)t->count - 2);
    const float s = (float)(at - (double)n), *row = t->rows + 4 * n;
    for (int c = 0; c < 4; c++)
        out[c] = row[c] + s * (row[4 + c] - row[c]);
    for (int c = 0; c < 3; c++)
        out[c] *= out[3];
}

/* Returns a voxel's value; NaN: it has none. */
static double value_of(const cw_volume *v, const cwi_gl_brick *b, size_t i, size_t j, size_t k)
{
    const double x = cwi_voxel_at(
        v->type, cwi_voxel_address(v, b->first[0] + i, b->first[1] + j, b->first[2] + k));
    return v->has_nodata && x == v->nodata ? (double)NAN : v->slope * x + v->intercept;
}

/* A layer of a brick that is classified for an upload. */
typedef struct layer_copy {
    const cwi_gl *gl;
    const cwi_gl_brick *brick;
    size_t k; /* the layer */
    float (*to)[4];
} layer_copy;

static void classify_row(void *context, size_t j)
{
    const layer_copy *c = context;
    const size_t count = c->brick->count[0];
    for (size_t i = 0; i < count; i++)
        classify_value(&c->gl->transfer.table,
                       value_of(&c->gl->frame->volume, c->brick, i, j, c->k),
                       c->to[j * count + i]);
}

/* Uploads classified voxels. Half precision is relative: enough for colours that add up,
 * whatever the opacity. */
static cw_status upload_classes(cwi_gl *gl, const cwi_gl_brick *b, GLuint *name, cw_error *err)
{
    const GLsizei w = (GLsizei)b->count[0], h = (GLsizei)b->count[1], d = (GLsizei)b->count[2];
    float(*layer)[4] = cwi_alloc_array(b->count[0] * b->count[1], sizeof *layer);
    if (!layer)
        return cwi_fail_memory(err);
    *name = cwi_gl_texture(GL_TEXTURE_3D, CWI_UNIT_CLASSES, true);
    glTexImage3D(GL_TEXTURE_3D, 0, GL_RGBA16F, w, h, d, 0, GL_RGBA, GL_FLOAT, NULL);
    cw_status st = CW_OK;
    for (GLint k = 0; k < d && st == CW_OK; k++) {
        layer_copy copy = {gl, b, (size_t)k, layer};
        cwi_parallel_for_all(b->count[1], WORK * b->count[0], gl->frame->scene.threads,
                             classify_row, &copy);
        glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, k, w, h, 1, GL_RGBA, GL_FLOAT, layer);
        st = cwi_gl_report_soon(gl, "uploading", (double)k / (double)d, err);
    }
    cwi_free(layer);
    return st;
}

static cw_status need_classes(cwi_gl *gl, texture_state *t, cw_error *err)
{
    const size_t count = gl->volume.brick_count;
    cw_status st = CW_OK;
    if (t->classes && memcmp(&t->key, &gl->frame->transfer, sizeof t->key) == 0 &&
        t->opacity_units == gl->frame->opacity_units)
        return CW_OK;
    drop_classes(t);
    t->classes = cwi_alloc_zeroed(count, sizeof *t->classes);
    if (!t->classes)
        return cwi_fail_memory(err);
    t->class_count = count;
    t->key = gl->frame->transfer;
    t->opacity_units = gl->frame->opacity_units;
    for (size_t n = 0; n < count && st == CW_OK; n++)
        st = upload_classes(gl, &gl->volume.bricks[n], &t->classes[n], err);
    if (st != CW_OK)
        drop_classes(t);
    return st;
}

static void bind_classes(const void *state, size_t brick)
{
    const texture_state *t = state;
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_CLASSES);
    glBindTexture(GL_TEXTURE_3D, t->classes[brick]);
}

static cw_status draw_texture_mode(cwi_gl *gl, void **state, cw_error *err)
{
    const cw_scene *s = &gl->frame->scene;
    char defines[64];
    const char *gradients = "";
    cw_status st = CW_OK;
    if (!*state)
        *state = cwi_alloc_zeroed(1, sizeof(texture_state));
    texture_state *t = *state;
    if (!t)
        return cwi_fail_memory(err);
    if (cwi_frame_needs_gradients(gl->frame))
        st = cwi_gl_need_gradients(gl, &gradients, err);
    if (st == CW_OK && s->texture.colors_first)
        st = need_classes(gl, t, err);
    if (st != CW_OK)
        return st;
    snprintf(defines, sizeof defines, "%s%s", gradients,
             s->texture.colors_first ? "#define COLORS\n" : "");
    return cwi_gl_draw_slices(gl, &t->slices, defines,
                              s->texture.colors_first ? bind_classes : NULL, t, err);
}

const cwi_gl_mode cwi_gl_texture_mode = {CW_MODE_TEXTURE, true, draw_texture_mode,
                                         drop_texture_mode, true};
