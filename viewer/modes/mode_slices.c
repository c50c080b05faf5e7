/* Draws slices: the volume's values in a few planes, with a ray for each sample of the
 * picture. */

#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "viewer/modes/gl_draw.h"
#include "viewer/scene/slice.h"

#include <stdio.h>

extern const char cwi_glsl_slices[];

/* Pixels. */
static const float FRAME_WIDTH = 1.5f;

static void set_slice(const cwi_frame *f, GLuint program, const cw_slice *s)
{
    double normal[3], color[3];
    for (int a = 0; a < 3; a++)
        normal[a] = cwi_dot(f->axes[a], s->normal);
    const double distance = (s->distance_mm - cwi_dot(s->normal, f->eye_mm)) / f->unit_mm;
    glUniform4f(glGetUniformLocation(program, "plane"), (float)normal[0], (float)normal[1],
                (float)normal[2], (float)distance);
    cwi_slice_color(s, color);
    cwi_gl_set3(program, "frame_color", color);
}

static cw_status draw_slices_mode(cwi_gl *gl, void **state, cw_error *err)
{
    (void)state;
    const cwi_frame *f = gl->frame;
    cw_slice slices[CW_MAX_SLICES];
    size_t count;
    GLuint program;
    char defines[64];
    snprintf(defines, sizeof defines, "#define RAYS\n%s%s",
             f->scene.clip_count ? "#define CLIPS\n" : "",
             f->scene.sampling.exact_filter ? "#define EXACT_FILTER\n" : "");
    cw_status st = cwi_slices_of(&f->scene, &f->volume, slices, &count, err);
    if (st == CW_OK)
        st = cwi_gl_use(gl, cwi_glsl_screen, cwi_glsl_slices, defines, &program, err);
    if (st != CW_OK)
        return st;
    cwi_gl_set(program, "frame_width", FRAME_WIDTH * (float)f->scene.samples);
    glDisable(GL_BLEND);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    const size_t bricks = gl->volume.brick_count;
    for (size_t n = 0; n < count * bricks && st == CW_OK; n++) {
        if (n % bricks == 0)
            set_slice(f, program, &slices[n / bricks]);
        cwi_gl_bind_brick(program, &gl->volume.bricks[n % bricks]);
        cwi_gl_part(gl, n, count * bricks);
        st = cwi_gl_draw_rays(gl, err);
    }
    glDisable(GL_DEPTH_TEST);
    return st;
}

const cwi_gl_mode cwi_gl_slices = {CW_MODE_SLICES, false, draw_slices_mode, NULL, false};
