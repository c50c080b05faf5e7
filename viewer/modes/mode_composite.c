/* Draws a volume by ray casting: emission and absorption along each ray, by a fragment
 * shader. */

#include "core/base/memory.h"
#include "core/base/status.h"
#include "viewer/modes/gl_draw.h"

#include <stdio.h>

extern const char cwi_glsl_composite[];

/* Pre-integration is for narrow functions. Of wide ones a sample in the middle of a step is
 * closer to the integral than a straight line between its ends, and costs less. */
static bool needs_segments(const cwi_gl *gl)
{
    return !gl->frame->scene.sampling.no_preintegration &&
           cwi_table_is_narrow(&gl->transfer.table);
}

static void describe_shader(const cw_scene *s, const cw_transfer *t, bool has_segments,
                            const char *gradients, char *defines, size_t size)
{
    snprintf(defines, size, "%s%s%s%s%s%s%s%s%s%s", gradients,
             has_segments ? "#define SEGMENTS\n" : "",
             s->sampling.no_skipping ? "" : "#define SKIP\n",
             s->sampling.cell_steps ? "#define CELLS\n" : "", cwi_gl_ray_defines(s),
             s->sampling.jitter ? "#define JITTER\n" : "",
             s->depth_cue > 0 ? "#define CUE\n" : "", s->lit ? "#define LIT\n" : "",
             t->gradient_count ? "#define FACTOR\n" : "",
             s->sampling.exact_filter ? "#define EXACT_FILTER\n" : "");
}

static cw_status draw_composite_mode(cwi_gl *gl, void **state, cw_error *err)
{
    (void)state;
    char defines[256];
    const char *gradients = "";
    GLuint program;
    const cw_scene *s = &gl->frame->scene;
    const bool has_segments = needs_segments(gl);
    cw_status st = cwi_gl_need_skip(gl, err);
    if (st == CW_OK && has_segments)
        st = cwi_gl_need_segments(gl, s->sampling.step_vox, err);
    if (st == CW_OK && cwi_frame_needs_gradients(gl->frame))
        st = cwi_gl_need_gradients(gl, &gradients, err);
    describe_shader(s, &gl->frame->transfer, has_segments, gradients, defines, sizeof defines);
    if (st == CW_OK)
        st = cwi_gl_use(gl, cwi_glsl_screen, cwi_glsl_composite, defines, &program, err);
    if (st != CW_OK)
        return st;
    size_t *order = cwi_gl_order_bricks(gl);
    if (!order)
        return cwi_fail_memory(err);
    cwi_gl_set(program, "step_length", (float)s->sampling.step_vox);
    cwi_gl_set_last_block(program, gl->volume.ranges.dim);
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    for (size_t n = 0; n < gl->volume.brick_count && st == CW_OK; n++) {
        cwi_gl_bind_brick(program, &gl->volume.bricks[order[n]]);
        cwi_gl_part(gl, n, gl->volume.brick_count);
        st = cwi_gl_draw_rays(gl, err);
    }
    glDisable(GL_BLEND);
    cwi_free(order);
    return st;
}

const cwi_gl_mode cwi_gl_composite = {CW_MODE_COMPOSITE, true, draw_composite_mode, NULL,
                                      false};
