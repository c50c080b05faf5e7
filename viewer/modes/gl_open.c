/* Opens and closes the OpenGL renderer, and lists the functions of its module. */
#include "viewer/live_surface/live_surface.h"
#include "viewer/modes/gl_draw.h"

#include "core/base/memory.h"
#include "core/base/status.h"

static void drop_states(cwi_gl *gl)
{
    for (int m = 0; m < CW_MODE_COUNT; m++) {
        const cwi_gl_mode *mode = cwi_gl_find_mode((cw_mode)m);
        if (mode && mode->drop && gl->state[m])
            mode->drop(gl->state[m]);
        gl->state[m] = NULL;
    }
    cwi_live_forget(gl->live);
}

/* Memory that Mesa's software OpenGL was seen to take before anything is drawn. */
enum { DRIVER_BYTES = 72 << 20 };

static cw_status gl_open(cwi_gl **out, cw_error *err)
{
    if (!cwi_memory_take(DRIVER_BYTES))
        return cwi_fail_memory(err);
    cwi_gl *gl = cwi_alloc_zeroed(1, sizeof *gl);
    cw_status st = gl ? cwi_gl_context_open(&gl->context, err) : cwi_fail_memory(err);
    if (st != CW_OK) {
        cwi_free(gl);
        cwi_memory_give(DRIVER_BYTES);
        return st;
    }
    cwi_gl_describe(gl->name, sizeof gl->name);
    glGenBuffers(1, &gl->frame_block);
    glGenVertexArrays(1, &gl->empty_array);
    gl->drop_states = drop_states;
    cwi_gl_leave(gl);
    *out = gl;
    return CW_OK;
}

static void gl_forget(cwi_gl *gl)
{
    cwi_gl_enter(gl);
    cwi_gl_drop_scene(gl);
    cwi_gl_leave(gl);
}

static void gl_close(cwi_gl *gl)
{
    cwi_gl_enter(gl);
    cwi_gl_drop_scene(gl);
    cwi_live_drop(gl->live);
    cwi_gl_drop_target(gl);
    for (size_t n = 0; n < gl->program_count; n++)
        glDeleteProgram(gl->programs[n].name);
    glDeleteBuffers(1, &gl->frame_block);
    glDeleteVertexArrays(1, &gl->empty_array);
    cwi_gl_context_close(&gl->context);
    cwi_free(gl);
    cwi_memory_give(DRIVER_BYTES);
}

static const char *gl_name(const cwi_gl *gl)
{
    return gl->name;
}

static cw_status gl_extract(cwi_gl *gl, const cw_live_surface *desc,
                            const cwi_live_limits *limits, cwi_live_times *times,
                            size_t size[2], cw_mesh *mesh, cw_error *err)
{
    cwi_live_mesh live;
    if (!cwi_gl_enter(gl))
        return cwi_fail(err, CW_ERR_BACKEND, "the OpenGL context was lost");
    cw_status st = cwi_live_take(&gl->live, desc, limits, times, &live, err);
    size[0] = live.vertex_count;
    size[1] = live.triangle_count;
    if (st == CW_OK && mesh)
        st = cwi_live_read(gl->live, mesh, err);
    cwi_gl_leave(gl);
    return st;
}

static cw_status gl_prepare(cwi_gl *gl, const cw_live_surface *desc, bool *ready, cw_error *err)
{
    if (!cwi_gl_enter(gl))
        return cwi_fail(err, CW_ERR_BACKEND, "the OpenGL context was lost");
    cw_status st = cwi_live_prepare(&gl->live, desc, ready, err);
    cwi_gl_leave(gl);
    return st;
}

CW_API extern const cwi_gl_functions cwi_module_gl;
const cwi_gl_functions cwi_module_gl = {gl_open,     gl_close,   gl_name,   gl_forget,
                                        cwi_gl_draw, gl_prepare, gl_extract};
