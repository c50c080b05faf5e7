/* Draws one picture: uploads new data, draws the mesh, then the mode, and reads the picture
 * back. */
#include "viewer/modes/gl_draw.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

/* The uniform block of shaders/common.glsl, laid out by std140. Matrices are columns. */
typedef struct frame_block {
    float projection[16], eye_from_index[16], index_from_eye[16], gradient_to_eye[16];
    float picture[4], view[4], cue_range[4], low[4], high[4], dim[4], texels[4], limits[4],
        material[4];
    float light_direction[CW_MAX_LIGHTS][4], light_color[CW_MAX_LIGHTS][4];
    float background[2][4];
    float clips[CW_MAX_CLIPS][4];
    int32_t counts[4];
} frame_block;

static const cwi_gl_mode *const modes[] = {
    &cwi_gl_mesh_mode,  &cwi_gl_composite, &cwi_gl_mip,          &cwi_gl_minip,
    &cwi_gl_average,    &cwi_gl_local_mip, &cwi_gl_projection,   &cwi_gl_splat,
    &cwi_gl_splat_tree, &cwi_gl_slices,    &cwi_gl_texture_mode, &cwi_gl_shaded_texture};

const cwi_gl_mode *cwi_gl_find_mode(cw_mode mode)
{
    for (size_t n = 0; n < sizeof modes / sizeof *modes; n++)
        if (modes[n]->mode == mode)
            return modes[n];
    return NULL;
}

static void put_affine(const double m[12], float out[16])
{
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 4; r++)
            out[4 * c + r] = r < 3 ? (float)m[4 * r + c] : c == 3;
}

static void put_vec3(const double v[3], float out[4])
{
    for (int a = 0; a < 3; a++)
        out[a] = (float)v[a];
}

static void put_projection(const cwi_frame *f, float m[16])
{
    const double depth = f->far - f->near;
    memset(m, 0, 16 * sizeof *m);
    m[0] = (float)(1 / f->half[0]);
    m[5] = (float)(1 / f->half[1]);
    if (f->perspective) {
        m[10] = (float)(-(f->far + f->near) / depth);
        m[11] = -1;
        m[14] = (float)(-2 * f->far * f->near / depth);
    } else {
        m[10] = (float)(-2 / depth);
        m[14] = (float)(-(f->far + f->near) / depth);
        m[15] = 1;
    }
}

static void put_lights(const cw_scene *s, frame_block *b)
{
    for (size_t n = 0; n < s->light_count; n++) {
        const double *d = s->lights[n].direction;
        const double length = cwi_length(d);
        for (int a = 0; a < 3 && length > 0; a++)
            b->light_direction[n][a] = (float)(d[a] / length);
        memcpy(b->light_color[n], s->lights[n].color, sizeof s->lights[n].color);
    }
}

static void put_volume(const cwi_gl *gl, frame_block *b)
{
    const cwi_frame *f = gl->frame;
    double m[3][3];
    put_affine(f->eye_from_index, b->eye_from_index);
    put_affine(f->index_from_eye, b->index_from_eye);
    cwi_frame_gradient_matrix(f, m);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            b->gradient_to_eye[4 * c + r] = (float)m[r][c];
    put_vec3(f->low, b->low);
    put_vec3(f->high, b->high);
    for (int a = 0; a < 3; a++)
        b->dim[a] = (float)f->volume.dim[a];
    b->dim[3] = (float)gl->transfer.segment_rows;
    const cwi_table *t = &gl->transfer.table;
    b->texels[0] = (float)(gl->volume.scale / (t->high - t->low));
    b->texels[1] = (float)((gl->volume.bias - t->low) / (t->high - t->low));
    b->texels[2] = (float)(gl->volume.scale / gl->volume.gradient_unit);
    b->limits[1] = (float)gl->transfer.factor_end;
    b->limits[3] = (float)f->faces;
    b->limits[2] = (float)(f->surface * gl->volume.gradient_unit);
}

static void put_frame(cwi_gl *gl)
{
    const cwi_frame *f = gl->frame;
    const cw_scene *s = &f->scene;
    frame_block b = {
        .picture = {(float)s->width, (float)s->height, (float)f->half[0], (float)f->half[1]},
        .view = {f->perspective, (float)f->near, (float)f->far, s->depth_cue},
        .cue_range = {(float)f->cue_start, (float)f->cue_end, (float)f->cue_decay},
        .limits = {s->sampling.stop_opacity},
        .material = {s->material.ambient, s->material.diffuse, s->material.specular,
                     s->material.shininess},
        .counts = {(int32_t)s->light_count, (int32_t)s->clip_count, s->cut_away, s->one_sided},
    };
    put_projection(f, b.projection);
    put_lights(s, &b);
    for (int n = 0; n < 2; n++)
        memcpy(b.background[n], s->background[n], sizeof s->background[n]);
    for (size_t n = 0; n < s->clip_count; n++)
        for (int a = 0; a < 4; a++)
            b.clips[n][a] = (float)f->clips[n][a];
    if (f->volume.data)
        put_volume(gl, &b);
    glBindBuffer(GL_UNIFORM_BUFFER, gl->frame_block);
    glBufferData(GL_UNIFORM_BUFFER, sizeof b, &b, GL_DYNAMIC_DRAW);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, gl->frame_block);
}

/* Reads the picture back; GL's rows go up. */
static void read_back(const cwi_gl *gl, cw_picture *picture)
{
    const size_t row = 4 * picture->width;
    glBindFramebuffer(GL_FRAMEBUFFER, gl->target.framebuffer);
    glReadPixels(0, 0, gl->target.width, gl->target.height, GL_RGBA, GL_FLOAT, picture->pixels);
    for (size_t y = 0; y < picture->height / 2; y++) {
        float *a = picture->pixels + y * row;
        float *b = picture->pixels + (picture->height - 1 - y) * row;
        for (size_t x = 0; x < row; x++) {
            const float keep = a[x];
            a[x] = b[x];
            b[x] = keep;
        }
    }
}

/* Resets GL's state: a cancelled picture leaves it unfinished. */
static void reset_state(void)
{
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glBlendEquation(GL_FUNC_ADD);
    glDepthMask(GL_TRUE);
}

static cw_status draw_scene(cwi_gl *gl, const cwi_gl_mode *mode, cw_error *err)
{
    reset_state();
    cw_status st = cwi_gl_take_target(gl, err);
    if (st == CW_OK && gl->frame->volume.data)
        st = cwi_gl_take_volume(gl, mode->needs_textures || !gl->frame->scene.sampling.lean,
                                err);
    if (st == CW_OK && gl->frame->volume.data)
        st = cwi_gl_take_transfer(gl, err);
    if (st != CW_OK)
        return st;
    put_frame(gl);
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    if (gl->frame->scene.mesh && mode->mode != CW_MODE_MESH)
        st = cwi_gl_draw_mesh(gl, err);
    if (st != CW_OK)
        return st;
    if (mode->goes_along_rays)
        glBindFramebuffer(GL_FRAMEBUFFER, gl->target.rays);
    return mode->draw(gl, &gl->state[mode->mode], err);
}

cw_status cwi_gl_draw(cwi_gl *gl, const cwi_frame *frame, cw_picture *picture, cw_error *err)
{
    const cwi_gl_mode *mode = cwi_gl_find_mode(frame->scene.mode);
    if (!mode)
        return cwi_fail(err, CW_ERR_UNSUPPORTED, "the mode %s is not drawn by OpenGL",
                        cw_mode_name(frame->scene.mode));
    if (!cwi_gl_enter(gl))
        return cwi_fail(err, CW_ERR_BACKEND,
                        "the OpenGL context was lost, or another library's is on this thread");
    gl->frame = frame;
    cwi_gl_start_watch(gl);
    cw_status st = draw_scene(gl, mode, err);
    if (st == CW_OK)
        read_back(gl, picture);
    else
        glFinish(); /* nothing reads the caller's voxels afterwards */
    const cw_status after = cwi_gl_check(st == CW_OK ? err : NULL);
    if (gl->watch.is_astray)
        st = cwi_fail(err, CW_ERR_BACKEND,
                      "progress left another library's OpenGL context on this thread");
    gl->frame = NULL;
    cwi_gl_leave(gl);
    return st == CW_OK ? after : st;
}
