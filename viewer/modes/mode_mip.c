/* Projections of values along rays: maximum, minimum, mean, and local maximum [Sato1998]. */

#include "core/base/memory.h"
#include "core/base/status.h"
#include "viewer/modes/gl_draw.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

extern const char cwi_glsl_mip[];

/* State of a projection. Values found so far pass from brick to brick in two textures, used
 * alternately. */
typedef struct projector {
    GLuint ranges;
    size_t blocks[3];
    GLuint found[2], framebuffer[2];
    GLsizei width, height;
} projector;

enum { UNIT_RANGES = CWI_UNIT_FREE, UNIT_BEFORE };

static void drop_found(projector *p)
{
    glDeleteTextures(2, p->found);
    glDeleteFramebuffers(2, p->framebuffer);
    p->width = p->height = 0;
}

static void drop_mip_mode(void *state)
{
    projector *p = state;
    glDeleteTextures(1, &p->ranges);
    drop_found(p);
    cwi_free(p);
}

/* Converts ranges of values to ranges of texels, which rise with values; without values: from infinity down. */
static void to_texels(const cwi_gl_volume *v, cwi_ranges *ranges, size_t count)
{
    for (size_t n = 0; n < count; n++) {
        float *r = ranges->blocks[n];
        const bool is_empty = r[0] > r[1];
        const double a = ((double)r[0] - v->bias) / fabs(v->scale),
                     b = ((double)r[1] - v->bias) / fabs(v->scale);
        r[0] = is_empty ? INFINITY : nextafterf((float)fmin(a, b), -INFINITY);
        r[1] = is_empty ? -INFINITY : nextafterf((float)fmax(a, b), INFINITY);
    }
}

static cw_status make_ranges(const cwi_gl_volume *v, projector *p, cw_error *err)
{
    cwi_ranges ranges;
    cw_status st = cwi_ranges_halve(&v->ranges, &ranges, err);
    if (st != CW_OK)
        return st;
    memcpy(p->blocks, ranges.dim, sizeof p->blocks);
    to_texels(v, &ranges, ranges.dim[0] * ranges.dim[1] * ranges.dim[2]);
    p->ranges = cwi_gl_texture(GL_TEXTURE_3D, UNIT_RANGES, false);
    glTexImage3D(GL_TEXTURE_3D, 0, GL_RG32F, (GLsizei)ranges.dim[0], (GLsizei)ranges.dim[1],
                 (GLsizei)ranges.dim[2], 0, GL_RG, GL_FLOAT, ranges.blocks);
    cwi_ranges_free(&ranges);
    return CW_OK;
}

static cw_status take_state(cwi_gl *gl, void **state, cw_error *err)
{
    if (*state)
        return CW_OK;
    projector *p = cwi_alloc_zeroed(1, sizeof *p);
    if (!p)
        return cwi_fail_memory(err);
    *state = p;
    return make_ranges(&gl->volume, p, err);
}

static void make_found(const cwi_gl *gl, projector *p)
{
    if (p->width == gl->target.width && p->height == gl->target.height)
        return;
    drop_found(p);
    p->width = gl->target.width;
    p->height = gl->target.height;
    glGenFramebuffers(2, p->framebuffer);
    for (int n = 0; n < 2; n++) {
        p->found[n] = cwi_gl_texture(GL_TEXTURE_2D, UNIT_BEFORE, false);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, p->width, p->height, 0, GL_RGBA, GL_FLOAT,
                     NULL);
        glBindFramebuffer(GL_FRAMEBUFFER, p->framebuffer[n]);
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, p->found[n],
                               0);
    }
}

static const char *define_mode(const cw_scene *s)
{
    return s->mode == CW_MODE_MIP       ? "#define MIP\n"
           : s->mode == CW_MODE_AVERAGE ? "#define AVERAGE\n"
           : s->mode != CW_MODE_MINIP   ? "#define LOCAL\n"
           : s->intensity.minip_inside  ? "#define MINIP\n#define INSIDE\n"
                                        : "#define MINIP\n";
}

/* Returns true if the range of a block holds for every ray through it, and for every part. */
static bool can_foresee(const cwi_gl *gl)
{
    const cw_scene *s = &gl->frame->scene;
    return (s->mode == CW_MODE_MIP ||
            (s->mode == CW_MODE_MINIP && !s->intensity.minip_inside)) &&
           !gl->volume.ranges.has_gaps;
}

/* Draws one brick, the n-th from the front of `count`. */
static cw_status draw_brick(cwi_gl *gl, const projector *p, const cwi_gl_brick *brick, size_t n,
                            size_t count, cw_error *err)
{
    GLuint program;
    char defines[256];
    const cw_scene *s = &gl->frame->scene;
    const bool is_last = n + 1 == count;
    snprintf(defines, sizeof defines, "%s%s%s%s%s%s%s", cwi_gl_ray_defines(s), define_mode(s),
             n == 0 ? "#define FIRST\n" : "", is_last ? "#define LAST\n" : "",
             can_foresee(gl) ? "#define FORESEE\n" : "",
             s->sampling.cell_steps ? "#define CELLS\n" : "",
             s->sampling.exact_filter ? "#define EXACT_FILTER\n" : "");
    cw_status st = cwi_gl_use(gl, cwi_glsl_screen, cwi_glsl_mip, defines, &program, err);
    if (st != CW_OK)
        return st;
    glBindFramebuffer(GL_FRAMEBUFFER, is_last ? gl->target.rays : p->framebuffer[n % 2]);
    glUniform1i(glGetUniformLocation(program, "ranges"), UNIT_RANGES);
    glUniform1i(glGetUniformLocation(program, "before"), UNIT_BEFORE);
    cwi_gl_set(program, "step_length", (float)s->sampling.step_vox);
    cwi_gl_set_last_block(program, p->blocks);
    cwi_gl_set(program, "threshold",
               (float)((s->intensity.threshold - gl->volume.bias) / fabs(gl->volume.scale)));
    cwi_gl_set(program, "rise", gl->volume.scale < 0 ? -1.0f : 1.0f);
    cwi_gl_bind_brick(program, brick);
    glActiveTexture(GL_TEXTURE0 + UNIT_RANGES);
    glBindTexture(GL_TEXTURE_3D, p->ranges);
    glActiveTexture(GL_TEXTURE0 + UNIT_BEFORE);
    glBindTexture(GL_TEXTURE_2D, p->found[(n + 1) % 2]);
    if (is_last) {
        glEnable(GL_BLEND);
        glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    }
    cwi_gl_part(gl, n, count);
    st = cwi_gl_draw_rays(gl, err);
    glDisable(GL_BLEND);
    return st;
}

static cw_status draw_mip_mode(cwi_gl *gl, void **state, cw_error *err)
{
    const size_t count = gl->volume.brick_count;
    cw_status st = take_state(gl, state, err);
    size_t *order = st == CW_OK ? cwi_gl_order_bricks(gl) : NULL;
    if (st == CW_OK && !order)
        st = cwi_fail_memory(err);
    if (st == CW_OK && count > 1)
        make_found(gl, *state);
    glDisable(GL_DEPTH_TEST);
    for (size_t n = 0; n < count && st == CW_OK; n++)
        st = draw_brick(gl, *state, &gl->volume.bricks[order[count - 1 - n]], n, count, err);
    cwi_free(order);
    return st;
}

const cwi_gl_mode cwi_gl_mip = {CW_MODE_MIP, true, draw_mip_mode, drop_mip_mode, false};
const cwi_gl_mode cwi_gl_minip = {CW_MODE_MINIP, true, draw_mip_mode, drop_mip_mode, false};
const cwi_gl_mode cwi_gl_average = {CW_MODE_AVERAGE, true, draw_mip_mode, drop_mip_mode, false};
const cwi_gl_mode cwi_gl_local_mip = {CW_MODE_LOCAL_MIP, true, draw_mip_mode, drop_mip_mode,
                                      false};
