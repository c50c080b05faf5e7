/* Splats voxels into sheets [Westover1990]: adds up the footprints of a sheet's voxels, and
 * blends sheets. */
#include "viewer/modes/splat_sheets.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/geometry/vec3.h"
#include "core/volume/volume.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

extern const char cwi_glsl_splat[], cwi_glsl_sheet[];

enum {
    CHUNK = 1 << 11, /* splats: so few that a software renderer takes no new pages for them */
    UNIT_SHEET = CWI_UNIT_FREE,
    UNIT_SPLATS,
    UNIT_FOOTPRINT
};

/* Makes a buffer in which splats are added up, behind the mesh's depth. */
static void make_sheet(cwi_splats *s)
{
    const cwi_gl_target *t = &s->gl->target;
    s->sheet = cwi_gl_texture(GL_TEXTURE_2D, UNIT_SHEET, false);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, t->width, t->height, 0, GL_RGBA, GL_FLOAT, NULL);
    glGenFramebuffers(1, &s->framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, s->framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, s->sheet, 0);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, t->depth, 0);
    glClear(GL_COLOR_BUFFER_BIT);
}

/* Makes the indices of a batch's triangles. */
static cw_status make_indices(cwi_splat_batch *b, const cwi_splat_kernel *kernel, cw_error *err)
{
    b->triangles = kernel ? kernel->triangles : 2;
    const size_t bytes = CHUNK * 3 * b->triangles * sizeof(uint32_t);
    uint32_t *all = cwi_alloc_array(CHUNK, 3 * b->triangles * sizeof *all);
    if (!all)
        return cwi_fail_memory(err);
    cwi_splat_indices(kernel, CHUNK, all);
    glGenVertexArrays(1, &b->array);
    glBindVertexArray(b->array);
    glGenBuffers(1, &b->indices);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, b->indices);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)bytes, all, GL_STATIC_DRAW);
    cwi_free(all);
    return CW_OK;
}

static void make_buffer(cwi_splats *s)
{
    glGenBuffers(1, &s->buffer);
    glBindBuffer(GL_TEXTURE_BUFFER, s->buffer);
    glBufferData(GL_TEXTURE_BUFFER, CHUNK * sizeof(cwi_splat), NULL, GL_STREAM_DRAW);
    glGenTextures(1, &s->splats);
    glActiveTexture(GL_TEXTURE0 + UNIT_SPLATS);
    glBindTexture(GL_TEXTURE_BUFFER, s->splats);
    glTexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, s->buffer);
}

static cw_status make_composite(cwi_splats *s, cw_error *err)
{
    cw_status st =
        cwi_gl_use(s->gl, cwi_glsl_screen, cwi_glsl_sheet,
                   s->kernel->is_in_plane ? s->kernel->defines : "", &s->composite, err);
    if (st != CW_OK)
        return st;
    glUniform1i(glGetUniformLocation(s->composite, "sheet"), UNIT_SHEET);
    glUniform1i(glGetUniformLocation(s->composite, "axis"), s->axis);
    return CW_OK;
}

/* Makes the program of voxels or of nodes. They are apart because a renderer in software runs
 * through both sides of a branch. */
static cw_status make_batch(cwi_splats *s, bool is_of_nodes, cw_error *err)
{
    char defines[128];
    const cwi_frame *f = s->frame;
    cwi_splat_batch *b = &s->batches[is_of_nodes];
    const bool is_blob = is_of_nodes && !s->kernel->is_in_plane;
    snprintf(defines, sizeof defines, "%s%s%s%s%s", f->scene.lit ? "#define LIT\n" : "",
             f->scene.clip_count ? "#define CLIPS\n" : "",
             f->transfer.gradient_count ? "#define FACTOR\n" : "",
             is_of_nodes ? "#define NODES\n" : "", is_blob ? "" : s->kernel->defines);
    b->chunk = cwi_alloc_array(CHUNK, sizeof *b->chunk);
    if (!b->chunk)
        return cwi_fail_memory(err);
    cw_status st = make_indices(b, is_of_nodes ? NULL : s->kernel, err);
    if (st == CW_OK)
        st = cwi_gl_use(s->gl, cwi_glsl_splat, cwi_glsl_splat, defines, &b->program, err);
    if (st != CW_OK)
        return st;
    glUniform1i(glGetUniformLocation(b->program, "splats"), UNIT_SPLATS);
    glUniform1i(glGetUniformLocation(b->program, "footprint"), UNIT_FOOTPRINT);
    glUniform1i(glGetUniformLocation(b->program, "axis"), s->axis);
    cwi_gl_set(b->program, "cell", (float)fabs(cwi_affine_determinant(f->eye_from_index)));
    cwi_splat_kernel_set(s->kernel, &f->scene, b->program);
    return CW_OK;
}

/* Chooses the axis of index space whose layers face the eye most. */
static int choose_axis(const cwi_frame *f)
{
    int best = 0;
    double max = -1, middle[3], view[3] = {0, 0, 1};
    cwi_midpoint(f->low, f->high, middle);
    if (f->perspective)
        cwi_affine_apply(f->eye_from_index, middle, view);
    for (int a = 0; a < 3; a++) {
        const double *normal = f->index_from_eye + (ptrdiff_t)4 * a;
        const double slope = fabs(cwi_dot(normal, view)) / cwi_length(normal);
        if (slope > max) {
            max = slope;
            best = a;
        }
    }
    return best;
}

static void start_bounds(cwi_splats *s)
{
    s->bounds[0] = s->bounds[2] = INFINITY;
    s->bounds[1] = s->bounds[3] = -INFINITY;
}

static void measure_splats(cwi_splats *s)
{
    const double *m = s->frame->eye_from_index;
    double sum = 0;
    for (int n = 0; n < 12; n++)
        sum += n % 4 < 3 ? m[n] * m[n] : 0;
    s->kernel = cwi_splat_kernel_of(&s->frame->scene);
    /* of a ball around the ellipsoid, or around the rectangle */
    s->radius = s->frame->scene.splat.width * s->kernel->reach * sqrt(sum);
    s->axis = choose_axis(s->frame);
    s->needs_gradients = cwi_frame_needs_gradients(s->frame);
    cwi_lattice_eye(s->frame, s->eye);
    start_bounds(s);
}

cw_status cwi_splats_open(cwi_splats *s, cwi_gl *gl, bool has_nodes, cw_error *err)
{
    s->gl = gl;
    s->frame = gl->frame;
    s->err = err;
    s->has_gaps = gl->volume.ranges.has_gaps;
    measure_splats(s);
    cw_status st = cwi_visible_make(&gl->transfer.table, &s->visible, err);
    if (st == CW_OK)
        st = make_composite(s, err);
    for (int n = 0; n < (has_nodes ? 2 : 1) && st == CW_OK; n++)
        st = make_batch(s, n, err);
    if (st != CW_OK)
        return st;
    s->footprint = cwi_splat_footprint(s->kernel, UNIT_FOOTPRINT);
    make_buffer(s);
    make_sheet(s);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glEnable(GL_SCISSOR_TEST);
    return CW_OK;
}

void cwi_splats_close(cwi_splats *s)
{
    glDepthMask(GL_TRUE);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glDisable(GL_SCISSOR_TEST);
    glBindVertexArray(0);
    for (int n = 0; n < 2; n++) {
        glDeleteVertexArrays(1, &s->batches[n].array);
        glDeleteBuffers(1, &s->batches[n].indices);
        cwi_free(s->batches[n].chunk);
        s->batches[n].chunk = NULL;
    }
    glDeleteBuffers(1, &s->buffer);
    glDeleteTextures(1, &s->splats);
    glDeleteTextures(1, &s->footprint);
    glDeleteTextures(1, &s->sheet);
    glDeleteFramebuffers(1, &s->framebuffer);
    cwi_visible_free(&s->visible);
}

/* Adds the splats of a batch to the sheet. */
static void flush_splats(cwi_splats *s, cwi_splat_batch *b)
{
    if (b->count == 0 || s->status != CW_OK)
        return;
    glDisable(GL_SCISSOR_TEST);
    glEnable(GL_DEPTH_TEST);
    glBlendFunc(GL_ONE, GL_ONE);
    glUseProgram(b->program);
    glBindVertexArray(b->array);
    glBindBuffer(GL_TEXTURE_BUFFER, s->buffer);
    glBufferData(GL_TEXTURE_BUFFER, CHUNK * sizeof *b->chunk, NULL, GL_STREAM_DRAW);
    glBufferSubData(GL_TEXTURE_BUFFER, 0, (GLsizeiptr)(b->count * sizeof *b->chunk), b->chunk);
    s->status = cwi_gl_draw_triangles(s->gl, b->triangles * b->count, true, s->err);
    b->count = 0;
}

bool cwi_splats_keep(const cwi_splats *s, const double at[3], double eye[3])
{
    const cwi_frame *f = s->frame;
    bool is_kept = true;
    cwi_affine_apply(f->eye_from_index, at, eye);
    if (f->perspective && -eye[2] <= fmax(f->near, s->radius))
        return false;
    for (size_t n = 0; n < f->scene.clip_count && is_kept; n++)
        is_kept = cwi_dot(f->clips[n], eye) >= f->clips[n][3];
    return f->scene.clip_count == 0 || is_kept != f->scene.cut_away;
}

/* Finds the bounds of a splat on the picture, widened to at least half a pixel; returns false
 * if it is beside the picture. */
static bool find_bounds(const cwi_splats *s, const cwi_splat *splat, const double eye[3],
                        double bounds[4])
{
    const cwi_frame *f = s->frame;
    const double size =
        1 + (double)fmaxf(fmaxf(splat->size[0], splat->size[1]), splat->size[2]);
    const double scale = f->perspective ? -1 / eye[2] : 1;
    const size_t points[2] = {f->scene.width, f->scene.height};
    for (int a = 0; a < 2; a++) {
        const double at = eye[a] * scale, slant = f->perspective ? sqrt(1 + at * at) : 1;
        const double reach = s->radius * size * scale * slant / f->half[a] +
                             2 * s->kernel->reach / (double)points[a];
        bounds[2 * a] = at / f->half[a] - reach;
        bounds[2 * a + 1] = at / f->half[a] + reach;
    }
    return bounds[0] < 1 && bounds[1] > -1 && bounds[2] < 1 && bounds[3] > -1;
}

void cwi_splats_add(cwi_splats *s, const cwi_splat *splat, const double eye[3])
{
    double bounds[4];
    if (!find_bounds(s, splat, eye, bounds))
        return;
    for (int a = 0; a < 2; a++) {
        s->bounds[2 * a] = cwi_lesser(s->bounds[2 * a], bounds[2 * a]);
        s->bounds[2 * a + 1] = cwi_greater(s->bounds[2 * a + 1], bounds[2 * a + 1]);
    }
    cwi_splat_batch *b = &s->batches[splat->is_node > 0];
    if (b->count == CHUNK)
        flush_splats(s, b);
    b->chunk[b->count++] = *splat;
}

/* Restricts drawing to the bounds of the sheet's splats. */
static void cut_to_bounds(const cwi_splats *s)
{
    GLint at[4];
    const double points[2] = {(double)s->gl->target.width, (double)s->gl->target.height};
    for (int n = 0; n < 4; n++) {
        const double p = (cwi_lesser(cwi_greater(s->bounds[n], -1), 1) + 1) / 2 * points[n / 2];
        at[n] = (GLint)(n & 1 ? ceil(p) : floor(p));
    }
    glEnable(GL_SCISSOR_TEST);
    glScissor(at[0], at[2], at[1] - at[0], at[3] - at[2]);
}

cw_status cwi_splats_end_sheet(cwi_splats *s, size_t n, cw_error *err)
{
    const double done = (double)(n + 1) / (double)s->frame->volume.dim[s->axis];
    for (int b = 0; b < 2; b++)
        flush_splats(s, &s->batches[b]);
    if (s->status != CW_OK)
        return s->status;
    if (s->bounds[0] < s->bounds[1]) {
        cut_to_bounds(s);
        glDisable(GL_DEPTH_TEST);
        glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
        glBindFramebuffer(GL_FRAMEBUFFER, s->gl->target.rays);
        glUseProgram(s->composite);
        glActiveTexture(GL_TEXTURE0 + UNIT_SHEET);
        glBindTexture(GL_TEXTURE_2D, s->sheet);
        cwi_gl_draw_screen(s->gl);
        glBindFramebuffer(GL_FRAMEBUFFER, s->framebuffer);
        glClear(GL_COLOR_BUFFER_BIT);
        start_bounds(s);
    }
    return cwi_gl_report(s->gl, "splats", done, err);
}

size_t *cwi_splats_order(const cwi_splats *s, cw_error *err)
{
    const size_t count = s->frame->volume.dim[s->axis];
    size_t *order = cwi_alloc_array(count, sizeof *order);
    if (order)
        cwi_lattice_order(count, 0, 1, s->eye[s->axis], order);
    else
        cwi_fail_memory(err);
    return order;
}

void cwi_splats_voxel(cwi_splats *s, const size_t at[3])
{
    double eye[3], gradient[3];
    cwi_splat splat = {0};
    const cwi_frame *f = s->frame;
    const double index[3] = {(double)at[0], (double)at[1], (double)at[2]};
    cwi_lattice_load(&f->volume, &s->gl->transfer.table, at, (size_t[]){1, 1, 1}, &splat.value);
    if (!cwi_visible_any(&s->visible, splat.value, splat.value) ||
        !cwi_splats_keep(s, index, eye))
        return;
    splat.mass = (float)cwi_lattice_mass(&f->volume, at, s->has_gaps);
    if (!(splat.mass > 0))
        return;
    if (s->needs_gradients) {
        cwi_lattice_gradient(&f->gradient_volume, at, gradient);
        for (int a = 0; a < 3; a++)
            splat.gradient[a] =
                (float)(gradient[a] * f->gradient_volume.slope / s->gl->volume.gradient_unit);
    }
    for (int a = 0; a < 3; a++)
        splat.at[a] = (float)at[a];
    cwi_splats_add(s, &splat, eye);
}

static bool shows_block(const cwi_splats *s, const size_t block[3])
{
    const cwi_ranges *r = &s->gl->volume.ranges;
    const cwi_table *t = &s->gl->transfer.table;
    const float *range = r->blocks[(block[2] * r->dim[1] + block[1]) * r->dim[0] + block[0]];
    const double scale = 1 / (t->high - t->low);
    return cwi_visible_any(&s->visible, (float)(((double)range[0] - t->low) * scale),
                           (float)(((double)range[1] - t->low) * scale));
}

/* Returns the end of the voxels of a block: those at its high faces are the next block's, if
 * there is one. */
static size_t block_end(const cwi_splats *s, int axis, size_t block)
{
    const cwi_ranges *r = &s->gl->volume.ranges;
    return block + 1 == r->dim[axis] ? s->frame->volume.dim[axis]
                                     : CWI_RANGE_EDGE * (block + 1);
}

static void splat_layer(cwi_splats *s, size_t layer)
{
    const cwi_ranges *r = &s->gl->volume.ranges;
    const int a = s->axis, b = (a + 1) % 3, c = (a + 2) % 3;
    size_t block[3], at[3];
    const size_t last = r->dim[a] - 1, own = layer / CWI_RANGE_EDGE;
    block[a] = own < last ? own : last;
    at[a] = layer;
    for (block[c] = 0; block[c] < r->dim[c] && s->status == CW_OK; block[c]++) {
        s->status = cwi_gl_report_soon(s->gl, "splats", s->gl->watch.from, s->err);
        for (block[b] = 0; block[b] < r->dim[b]; block[b]++) {
            if (!shows_block(s, block))
                continue;
            for (at[c] = CWI_RANGE_EDGE * block[c]; at[c] < block_end(s, c, block[c]); at[c]++)
                for (at[b] = CWI_RANGE_EDGE * block[b]; at[b] < block_end(s, b, block[b]);
                     at[b]++)
                    cwi_splats_voxel(s, at);
        }
    }
}

cw_status cwi_splats_flat(cwi_splats *s, cw_error *err)
{
    cw_status st = CW_OK;
    size_t *order = cwi_splats_order(s, err);
    if (!order)
        return CW_ERR_NO_MEMORY;
    for (size_t n = 0; n < s->frame->volume.dim[s->axis] && st == CW_OK; n++) {
        cwi_gl_part(s->gl, n, s->frame->volume.dim[s->axis]);
        splat_layer(s, order[n]);
        st = cwi_splats_end_sheet(s, n, err);
    }
    cwi_free(order);
    return st;
}
