/* Draws slices through 3D textures [Wilson1994]. A slice stands for the slab of space around
 * it, and each of its fragments for the part of a ray in that slab, in one brick's box: so
 * slabs need no outline, and rays that leave the volume within a slab are right. */
#include "viewer/modes/slab_textures.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

extern const char cwi_glsl_slab[], cwi_glsl_texture[], cwi_glsl_over[];

enum { CORNERS = 6 }; /* of two triangles */

typedef struct corner {
    uint16_t x, y;
} corner;

/* The rectangles of a brick, layer after layer. */
typedef struct drawing {
    cwi_slabs slabs;
    cwi_slab_rect *rects; /* of one layer */
    corner *corners;
    size_t count, capacity;
    size_t *first; /* corner of each layer, and the end */
} drawing;

void cwi_gl_drop_slices(cwi_gl_slabs *s)
{
    glDeleteVertexArrays(1, &s->array);
    glDeleteBuffers(1, &s->corners);
    glDeleteFramebuffers(1, &s->framebuffer);
    glDeleteTextures(1, &s->color);
    *s = (cwi_gl_slabs){0};
}

static void free_drawing(drawing *d)
{
    cwi_slabs_free(&d->slabs);
    cwi_free(d->rects);
    cwi_free(d->corners);
    cwi_free(d->first);
}

static cw_status init_drawing(const cwi_frame *f, drawing *d, cw_error *err)
{
    *d = (drawing){0};
    cw_status st = cwi_slabs_init(f, &d->slabs, err);
    if (st != CW_OK)
        return st;
    d->rects = cwi_alloc_array(CWI_SLAB_RECTS, sizeof *d->rects);
    d->first = cwi_alloc_zeroed(d->slabs.layer_count + 1, sizeof *d->first);
    return d->rects && d->first ? CW_OK : cwi_fail_memory(err);
}

/* Finds the blocks of cells of a brick's samples: first and last block along each axis. */
static void blocks_of(const cwi_gl_brick *b, const size_t dim[3], size_t from[3], size_t to[3])
{
    for (int a = 0; a < 3; a++) {
        const size_t last = b->first[a] + b->count[a] - 1;
        from[a] = b->first[a] / CWI_RANGE_EDGE;
        to[a] = (last > 0 ? last - 1 : 0) / CWI_RANGE_EDGE;
        if (to[a] >= dim[a])
            to[a] = dim[a] - 1;
    }
}

/* Finds the part of a range of cells that is in a brick, in index space. */
static void box_of(const cwi_frame *f, const cwi_gl_brick *b, const size_t from[3],
                   const size_t to[3], double low[3], double high[3])
{
    for (int a = 0; a < 3; a++) {
        const size_t first = from[a] * CWI_RANGE_EDGE, end = (to[a] + 1) * CWI_RANGE_EDGE;
        const size_t last = b->first[a] + b->count[a] - 1;
        const bool is_flat = f->volume.dim[a] == 1;
        low[a] = is_flat ? f->low[a] : (double)(first > b->first[a] ? first : b->first[a]);
        high[a] = is_flat ? f->high[a] : (double)(end < last ? end : last);
    }
}

static void mark_brick(const cwi_gl *gl, const cwi_gl_brick *b, cwi_slabs *slabs)
{
    const size_t *dim = gl->volume.ranges.dim;
    const uint8_t *away = gl->transfer.away;
    const bool all = gl->frame->scene.sampling.no_skipping;
    size_t from[3], to[3], at[3];
    double low[3], high[3];
    blocks_of(b, dim, from, to);
    cwi_slabs_clear(slabs);
    for (at[2] = from[2]; at[2] <= to[2]; at[2]++)
        for (at[1] = from[1]; at[1] <= to[1]; at[1]++)
            for (at[0] = from[0]; at[0] <= to[0]; at[0]++)
                if (all || away[(at[2] * dim[1] + at[1]) * dim[0] + at[0]] == 0) {
                    box_of(gl->frame, b, at, at, low, high);
                    cwi_slabs_mark(slabs, gl->frame, low, high);
                }
}

static bool ensure_capacity(drawing *d, size_t count)
{
    if (d->count + count <= d->capacity)
        return true;
    const size_t capacity = 2 * (d->count + count);
    corner *more = cwi_realloc_array(d->corners, capacity, sizeof *more);
    if (!more)
        return false;
    d->corners = more;
    d->capacity = capacity;
    return true;
}

static cw_status gather_slabs(const cwi_frame *f, drawing *d, cw_error *err)
{
    d->count = 0;
    for (size_t n = 0; n < d->slabs.layer_count; n++) {
        const size_t count = cwi_slabs_rects(&d->slabs, f, n, d->rects);
        d->first[n] = d->count;
        if (!ensure_capacity(d, count * CORNERS))
            return cwi_fail_memory(err);
        for (size_t i = 0; i < count; i++) {
            const cwi_slab_rect r = d->rects[i];
            const corner all[CORNERS] = {{r.left, r.bottom},  {r.right, r.bottom},
                                         {r.left, r.top},     {r.left, r.top},
                                         {r.right, r.bottom}, {r.right, r.top}};
            memcpy(d->corners + d->count, all, sizeof all);
            d->count += CORNERS;
        }
    }
    d->first[d->slabs.layer_count] = d->count;
    return CW_OK;
}

/* Texture coordinates on a plane at a depth are origin + x right + y up, with (x, y) the slope
 * (perspective) or the place (else) of a ray. In double precision: the eye may be far away. */
typedef struct plane {
    double origin[3], right[3], up[3];
} plane;

static plane plane_at(const cwi_frame *f, const double m[12], double depth)
{
    plane p;
    const double w = f->perspective ? depth : 1;
    for (int r = 0; r < 3; r++) {
        p.origin[r] = m[4 * r + 3] - depth * m[4 * r + 2];
        p.right[r] = w * m[4 * r];
        p.up[r] = w * m[4 * r + 1];
    }
    return p;
}

static void set_step(GLuint program, const char *name, const double from[3], const double to[3])
{
    const double step[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
    cwi_gl_set3(program, name, step);
}

/* The rectangles of a layer, once for each of its slabs. */
typedef struct instances {
    GLint first;
    GLsizei corners, count;
} instances;

static void draw_instances(void *context)
{
    const instances *all = context;
    glDrawArraysInstanced(GL_TRIANGLES, all->first, all->corners, all->count);
}

static cw_status draw_layer(cwi_gl *gl, GLuint program, const drawing *d,
                            const double matrix[12], size_t layer, cw_error *err)
{
    const cwi_frame *f = gl->frame;
    const cwi_slabs *s = &d->slabs;
    const size_t first = layer * s->per_layer, left = s->count - first;
    const size_t count = left < s->per_layer ? left : s->per_layer;
    const double depth = s->first + (double)first * s->thickness;
    const plane a = plane_at(f, matrix, depth), b = plane_at(f, matrix, depth + s->thickness);
    cwi_gl_set3(program, "plane_origin", a.origin);
    cwi_gl_set3(program, "plane_right", a.right);
    cwi_gl_set3(program, "plane_up", a.up);
    set_step(program, "origin_step", a.origin, b.origin);
    set_step(program, "right_step", a.right, b.right);
    set_step(program, "up_step", a.up, b.up);
    cwi_gl_set(program, "layer_depth", (float)depth);
    cwi_gl_set(program, "layer_slabs", (float)count);
    instances all = {(GLint)d->first[layer], (GLsizei)(d->first[layer + 1] - d->first[layer]),
                     (GLsizei)count};
    return cwi_gl_draw_layer(gl, draw_instances, &all, err);
}

/* Sets the brick's box in texture coordinates: samples stand in the middle of texels. */
static void set_box(const cwi_frame *f, GLuint program, const cwi_gl_brick *b)
{
    double low[3], high[3];
    for (int a = 0; a < 3; a++) {
        const double size = (double)b->count[a];
        const bool is_flat = f->volume.dim[a] == 1;
        low[a] = is_flat ? 0 : 0.5 / size;
        high[a] = is_flat ? 1 : (size - 0.5) / size;
    }
    cwi_gl_set3(program, "box_low", low);
    cwi_gl_set3(program, "box_high", high);
}

static cw_status draw_brick(cwi_gl *gl, cwi_gl_slabs *slices, GLuint program, drawing *d,
                            const cwi_gl_brick *b, cw_error *err)
{
    double matrix[12];
    mark_brick(gl, b, &d->slabs);
    cw_status st = gather_slabs(gl->frame, d, err);
    if (st != CW_OK || d->count == 0)
        return st;
    glBindVertexArray(slices->array);
    glBindBuffer(GL_ARRAY_BUFFER, slices->corners);
    glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(d->count * sizeof *d->corners), d->corners,
                 GL_STREAM_DRAW);
    cwi_slabs_texture_matrix(gl->frame, b->first, b->count, matrix);
    set_box(gl->frame, program, b);
    for (size_t n = d->slabs.layer_count; n-- > 0 && st == CW_OK;)
        if (d->first[n + 1] > d->first[n]) {
            cwi_gl_part(gl, d->slabs.layer_count - 1 - n, d->slabs.layer_count);
            st = draw_layer(gl, program, d, matrix, n, err);
        }
    return st;
}

static void make_array(cwi_gl_slabs *s)
{
    if (s->array)
        return;
    glGenVertexArrays(1, &s->array);
    glGenBuffers(1, &s->corners);
    glBindVertexArray(s->array);
    glBindBuffer(GL_ARRAY_BUFFER, s->corners);
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 2, GL_UNSIGNED_SHORT, GL_FALSE, sizeof(corner), NULL);
}

static void make_color(cwi_gl_slabs *s, const cwi_gl_target *like, cw_target target)
{
    static const GLint formats[CW_TARGET_COUNT] = {GL_RGBA32F, GL_RGBA16, GL_RGBA16F, GL_RGBA8};
    glDeleteFramebuffers(1, &s->framebuffer);
    glDeleteTextures(1, &s->color);
    s->width = like->width;
    s->height = like->height;
    s->target = target;
    s->color = cwi_gl_texture(GL_TEXTURE_2D, CWI_UNIT_SLICES, false);
    glTexImage2D(GL_TEXTURE_2D, 0, formats[target], s->width, s->height, 0, GL_RGBA, GL_FLOAT,
                 NULL);
    glGenFramebuffers(1, &s->framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, s->framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, s->color, 0);
}

/* Binds a target for slabs. The module's own target has single precision; other targets are
 * drawn over it in the end. */
static cw_status begin_slabs(cwi_gl *gl, cwi_gl_slabs *s, cw_error *err)
{
    const cwi_gl_target *t = &gl->target;
    const cw_target target = gl->frame->scene.texture.target;
    make_array(s);
    if (target == CW_TARGET_32F)
        return CW_OK;
    if (!s->color || s->width != t->width || s->height != t->height || s->target != target)
        make_color(s, t, target);
    glBindFramebuffer(GL_FRAMEBUFFER, s->framebuffer);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return cwi_fail(err, CW_ERR_BACKEND, "OpenGL does not draw in this precision");
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT);
    return CW_OK;
}

static cw_status end_slabs(cwi_gl *gl, const cwi_gl_slabs *s, cw_error *err)
{
    GLuint program;
    if (gl->frame->scene.texture.target == CW_TARGET_32F)
        return CW_OK;
    cw_status st = cwi_gl_use(gl, cwi_glsl_screen, cwi_glsl_over, "", &program, err);
    if (st != CW_OK)
        return st;
    glBindFramebuffer(GL_FRAMEBUFFER, gl->target.rays);
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_SLICES);
    glBindTexture(GL_TEXTURE_2D, s->color);
    glUniform1i(glGetUniformLocation(program, "slices"), CWI_UNIT_SLICES);
    cwi_gl_draw_screen(gl);
    return CW_OK;
}

static void describe_slabs(const cwi_frame *f, const char *own, char *defines, size_t size)
{
    const cw_scene *s = &f->scene;
    snprintf(defines, size, "#define RAYS\n%s%s%s%s%s%s%s%s", own,
             s->sampling.no_preintegration ? "" : "#define SEGMENTS\n",
             s->lit ? "#define LIT\n" : "",
             f->transfer.gradient_count ? "#define FACTOR\n" : "",
             s->sampling.exact_filter ? "#define EXACT_FILTER\n" : "",
             s->clip_count ? "#define CLIPS\n" : "", s->mesh ? "#define MESH\n" : "",
             s->depth_cue > 0 ? "#define CUE\n" : "");
}

static cw_status draw_bricks(cwi_gl *gl, cwi_gl_slabs *slices, GLuint program,
                             void (*bind)(const void *, size_t), const void *state,
                             cw_error *err)
{
    drawing d;
    size_t *order = cwi_gl_order_bricks(gl);
    cw_status st = order ? init_drawing(gl->frame, &d, err) : cwi_fail_memory(err);
    if (!order)
        return st;
    for (size_t n = 0; n < gl->volume.brick_count && st == CW_OK; n++) {
        const cwi_gl_brick *b = &gl->volume.bricks[order[n]];
        cwi_gl_bind_brick(program, b);
        if (bind)
            bind(state, order[n]);
        st = draw_brick(gl, slices, program, &d, b, err);
    }
    free_drawing(&d);
    cwi_free(order);
    return st;
}

static void set_samplers(GLuint program)
{
    glUniform1i(glGetUniformLocation(program, "classes"), CWI_UNIT_CLASSES);
    glUniform1i(glGetUniformLocation(program, "normals"), CWI_UNIT_NORMALS);
    glUniform1i(glGetUniformLocation(program, "shades"), CWI_UNIT_SHADES);
    glUniform1i(glGetUniformLocation(program, "directions"), CWI_UNIT_DIRECTIONS);
    glUniform1i(glGetUniformLocation(program, "materials"), CWI_UNIT_MATERIALS);
}

cw_status cwi_gl_draw_slices(cwi_gl *gl, cwi_gl_slabs *slices, const char *own,
                             void (*bind)(const void *state, size_t brick), const void *state,
                             cw_error *err)
{
    char defines[256];
    GLuint program;
    const cw_scene *s = &gl->frame->scene;
    cw_status st = cwi_gl_need_skip(gl, err);
    describe_slabs(gl->frame, own, defines, sizeof defines);
    if (st == CW_OK && !s->sampling.no_preintegration && !s->texture.colors_first)
        st = cwi_gl_need_segments(gl, s->sampling.step_vox, err);
    if (st == CW_OK)
        st = begin_slabs(gl, slices, err);
    if (st == CW_OK)
        st = cwi_gl_use(gl, cwi_glsl_slab, cwi_glsl_texture, defines, &program, err);
    if (st != CW_OK)
        return st;
    set_samplers(program);
    cwi_gl_set(program, "thickness", (float)s->sampling.step_vox);
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    st = draw_bricks(gl, slices, program, bind, state, err);
    if (st == CW_OK)
        st = end_slabs(gl, slices, err);
    glDisable(GL_BLEND);
    return st;
}
