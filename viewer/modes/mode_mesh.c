/* Draws triangles, lit as by the CPU's reference when the scene has neither lights nor a
 * material, else by these. Opaque ones need one pass; translucent ones are peeled: pass n draws
 * the nearest surface behind that of pass n - 1, and is blended behind it [Everitt2001], so
 * that the order of the triangles does not matter. Of several surfaces at exactly one depth one
 * counts.
 *
 * Cuts are filled where the winding number of the mesh around a plane's point is not 0: how
 * often the ray leaves the mesh behind that point, minus how often it enters it. */
#include "viewer/gl/gl_mesh.h"
#include "viewer/live_surface/live_surface.h"
#include "viewer/scene/srgb.h"

#include "core/base/status.h"
#include "viewer/modes/gl_draw.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

extern const char cwi_glsl_mesh[], cwi_glsl_layer[];

/* The maximum number of layers; those behind them are left out. */
enum { MAX_LAYERS = 128 };

/* Half the width of edges, in pixels. */
static const float LINE_WIDTH = 0.6f;

static bool has_colors(const cw_scene *s)
{
    return s->mesh_look.tint == CW_TINT_COLORS && s->mesh->colors;
}

/* Sets the scene's colour; faces of a cut are a little darker and warmer. */
static void set_plain(const cw_scene *s, GLuint program, bool cut, bool opaque)
{
    static const float darker[3] = {0.86f, 0.72f, 0.62f};
    float c[4];
    for (int a = 0; a < 3; a++)
        c[a] = (float)cwi_srgb_to_linear((double)s->mesh_look.color[a]) * (cut ? darker[a] : 1);
    c[3] = opaque || (cut && has_colors(s)) ? 1 : s->mesh_look.color[3];
    glUniform4fv(glGetUniformLocation(program, "plain"), 1, c);
}

static void set_look(const cwi_gl *gl, const cwi_gl_mesh *m, GLuint program)
{
    const cw_scene *s = &gl->frame->scene;
    const double low = m->tint_range[0], high = m->tint_range[1];
    GLint rows;
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_RAMP);
    glGetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_WIDTH, &rows);
    cwi_gl_set3(program, "tint_range", (const double[3]){low, 1 / (high - low), rows});
    cwi_gl_set(program, "line_width", LINE_WIDTH * (float)s->samples);
}

/* Options by which a surface is drawn. */
typedef struct manner {
    bool opaque, peels;
} manner;

static cw_status use_program(cwi_gl *gl, const char *vertex, const char *kind, manner how,
                             GLuint *program, cw_error *err)
{
    const cw_scene *s = &gl->frame->scene;
    char defines[256];
    snprintf(
        defines, sizeof defines, "%s%s%s%s%s%s%s%s", kind,
        gl->frame->studio_light ? "#define STUDIO\n" : "", how.peels ? "#define PEEL\n" : "",
        s->mesh_look.tint != CW_TINT_COLORS ? "#define TINTED\n" : "",
        has_colors(s) ? "#define COLORED\n" : "",
        s->mesh_look.wireframe ? "#define EDGES\n" : "", how.opaque ? "#define SOLID\n" : "",
        s->mesh_look.same_inside ? "#define SAME_INSIDE\n" : "");
    cw_status st = cwi_gl_use(gl, vertex, cwi_glsl_mesh, defines, program, err);
    if (st == CW_OK)
        cwi_gl_set_mesh(gl, *program);
    return st;
}

static bool draws_caps(const cw_scene *s)
{
    return s->mesh_look.cap && s->clip_count > 0;
}

/* Computes winding numbers around the points of a few planes. */
static cw_status count_windings(cwi_gl *gl, cwi_gl_mesh *m, size_t n, cw_error *err)
{
    GLuint program;
    cw_status st = cwi_gl_need_winding(gl, m, n, err);
    if (st == CW_OK)
        st = use_program(gl, cwi_glsl_mesh, "#define COUNT\n", (manner){0}, &program, err);
    if (st != CW_OK)
        return st;
    glBindFramebuffer(GL_FRAMEBUFFER, m->winding_targets[n]);
    glClear(GL_COLOR_BUFFER_BIT);
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendEquation(GL_FUNC_ADD);
    glBlendFunc(GL_ONE, GL_ONE);
    cwi_gl_set(program, "first_plane", (float)(n * CWI_PLANES_A_PASS));
    st = cwi_gl_draw_whole_mesh(gl, m, err);
    glDisable(GL_BLEND);
    return st;
}

static cw_status draw_caps(cwi_gl *gl, const cwi_gl_mesh *m, manner how, cw_error *err)
{
    const cw_scene *s = &gl->frame->scene;
    GLuint program;
    cw_status st = use_program(gl, cwi_glsl_screen, "#define CAP\n", how, &program, err);
    if (st != CW_OK)
        return st;
    set_plain(s, program, true, how.opaque);
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_WINDING);
    for (size_t n = 0; n < s->clip_count; n++) {
        glBindTexture(GL_TEXTURE_2D, m->windings[n / CWI_PLANES_A_PASS]);
        cwi_gl_set(program, "plane", (float)n);
        cwi_gl_draw_screen(gl);
    }
    return CW_OK;
}

/* Draws the nearest surface into the framebuffer that is bound. */
static cw_status draw_surface(cwi_gl *gl, cwi_gl_mesh *m, manner how, cw_error *err)
{
    GLuint program;
    glDisable(GL_BLEND);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    cw_status st = use_program(gl, cwi_glsl_mesh, "", how, &program, err);
    if (st != CW_OK)
        return st;
    set_plain(&gl->frame->scene, program, false, how.opaque);
    set_look(gl, m, program);
    st = cwi_gl_draw_whole_mesh(gl, m, err);
    return st == CW_OK && draws_caps(&gl->frame->scene) ? draw_caps(gl, m, how, err) : st;
}

/* Blends a layer behind the picture so far. */
static cw_status put_behind(cwi_gl *gl, const cwi_gl_mesh *m, cw_error *err)
{
    GLuint program;
    cw_status st = cwi_gl_use(gl, cwi_glsl_screen, cwi_glsl_layer, "", &program, err);
    if (st != CW_OK)
        return st;
    cwi_gl_set_mesh(gl, program);
    glBindFramebuffer(GL_FRAMEBUFFER, gl->target.rays);
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_LAYER);
    glBindTexture(GL_TEXTURE_2D, m->layer_color);
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendEquation(GL_FUNC_ADD);
    glBlendFunc(GL_ONE_MINUS_DST_ALPHA, GL_ONE);
    cwi_gl_draw_screen(gl);
    glDisable(GL_BLEND);
    return CW_OK;
}

static void start_layer(const cwi_gl *gl, const cwi_gl_mesh *m, int n)
{
    static const GLfloat nearest = 0;
    if (n == 0) { /* nothing was peeled yet */
        glBindFramebuffer(GL_FRAMEBUFFER, m->layers[1]);
        glClearBufferfv(GL_DEPTH, 0, &nearest);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, m->layers[n % 2]);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_PEELED);
    glBindTexture(GL_TEXTURE_2D, m->layer_depth[(n + 1) % 2]);
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_COVERED);
    glBindTexture(GL_TEXTURE_2D, gl->target.color);
}

/* Draws layers from the nearest on, until one is empty. */
static cw_status peel_layers(cwi_gl *gl, cwi_gl_mesh *m, cw_error *err)
{
    GLuint drawn = 1;
    cw_status st = cwi_gl_need_layers(gl, m, err);
    for (int n = 0; n < MAX_LAYERS && drawn && st == CW_OK; n++) {
        start_layer(gl, m, n);
        glBeginQuery(GL_ANY_SAMPLES_PASSED, m->query);
        st = draw_surface(gl, m, (manner){.peels = true}, err);
        glEndQuery(GL_ANY_SAMPLES_PASSED);
        glGetQueryObjectuiv(m->query, GL_QUERY_RESULT, &drawn);
        if (st == CW_OK && drawn)
            st = put_behind(gl, m, err);
    }
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_COVERED);
    glBindTexture(GL_TEXTURE_2D, 0);
    return st;
}

static cw_status draw_opaque(cwi_gl *gl, cwi_gl_mesh *m, cw_error *err)
{
    glBindFramebuffer(GL_FRAMEBUFFER, gl->target.framebuffer);
    return draw_surface(gl, m, (manner){.opaque = true}, err);
}

static bool is_translucent(const cw_scene *s, const cwi_gl_mesh *m)
{
    return has_colors(s) ? m->has_alpha : s->mesh_look.color[3] < 1;
}

/* Extracts the scene's live surface. Its vertices have no colours, and no corners of their own. */
static cw_status take_live(cwi_gl *gl, void **state, cwi_gl_mesh **m, cw_error *err)
{
    const cw_scene *s = &gl->frame->scene;
    cwi_live_mesh live;
    if (s->mesh_look.wireframe || s->mesh_look.tint != CW_TINT_COLORS)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "a live surface is drawn without wireframe and in one colour");
    cw_status st = cwi_live_take(&gl->live, s->mesh_look.live, NULL, NULL, &live, err);
    return st == CW_OK ? cwi_gl_lend_mesh(state, live.array, live.triangle_count, m, err) : st;
}

/* Uploads the mesh, or extracts it, and prepares the filling of its cuts. */
static cw_status take_mesh(cwi_gl *gl, void **state, cwi_gl_mesh **m, cw_error *err)
{
    const cw_scene *s = &gl->frame->scene;
    cw_status st =
        s->mesh_look.live ? take_live(gl, state, m, err) : cwi_gl_take_mesh(gl, state, m, err);
    for (size_t n = 0; draws_caps(s) && n * CWI_PLANES_A_PASS < s->clip_count; n++)
        if (st == CW_OK)
            st = count_windings(gl, *m, n, err);
    return st;
}

static cw_status draw_mesh_mode(cwi_gl *gl, void **state, cw_error *err)
{
    cwi_gl_mesh *m;
    cw_status st = take_mesh(gl, state, &m, err);
    if (st == CW_OK && is_translucent(&gl->frame->scene, m))
        st = peel_layers(gl, m, err);
    else if (st == CW_OK)
        st = draw_opaque(gl, m, err);
    glDisable(GL_DEPTH_TEST);
    glBindFramebuffer(GL_FRAMEBUFFER, gl->target.framebuffer);
    return st;
}

cw_status cwi_gl_draw_mesh(cwi_gl *gl, cw_error *err)
{
    cwi_gl_mesh *m;
    cw_status st = take_mesh(gl, &gl->state[CW_MODE_MESH], &m, err);
    if (st == CW_OK)
        st = draw_opaque(gl, m, err);
    glDisable(GL_DEPTH_TEST);
    glBindFramebuffer(GL_FRAMEBUFFER, gl->target.framebuffer);
    return st;
}

const cwi_gl_mode cwi_gl_mesh_mode = {CW_MODE_MESH, false, draw_mesh_mode, cwi_gl_drop_mesh,
                                      false};
