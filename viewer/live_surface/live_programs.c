/* Compiles the compute shaders of a live surface. */
#include "viewer/live_surface/live_internal.h"

#include "core/base/clock.h"
#include "core/base/status.h"

#include <stdio.h>
#include <string.h>

extern const char cwi_glsl_live_common[], cwi_glsl_live_ranges[], cwi_glsl_live_scan[],
    cwi_glsl_live_count[], cwi_glsl_live_size[], cwi_glsl_live_exact[], cwi_glsl_live_plan[],
    cwi_glsl_live_place[], cwi_glsl_live_emit[], cwi_glsl_live_build[], cwi_glsl_live_mend[];

/* Seconds after which a call that does not wait finishes no further program. Drivers with threads
 * may still link when a program is asked for its status: half a second for a large one. */
static const double SOON_S = 0.02;

/* A program: what its source needs before it, or NULL, and what chooses among its steps. */
static const struct {
    const char *before, *source, *defines;
} programs[CWI_LIVE_PASSES] = {
    [CWI_LIVE_FIND_RANGES] = {NULL, cwi_glsl_live_ranges, ""},
    [CWI_LIVE_SUM_BLOCKS] = {NULL, cwi_glsl_live_scan,
                             "#define BLOCKS_STEP\n#define SUM_STEP\n"},
    [CWI_LIVE_TOP_BLOCKS] = {NULL, cwi_glsl_live_scan,
                             "#define BLOCKS_STEP\n#define TOP_STEP\n"},
    [CWI_LIVE_PLACE_BLOCKS] = {NULL, cwi_glsl_live_scan, "#define BLOCKS_STEP\n"},
    [CWI_LIVE_COUNT] = {NULL, cwi_glsl_live_count, ""},
    [CWI_LIVE_SIZE_OPEN] = {NULL, cwi_glsl_live_size, ""},
    [CWI_LIVE_PLAN] = {cwi_glsl_live_exact, cwi_glsl_live_plan, ""},
    [CWI_LIVE_SUM_COUNTS] = {NULL, cwi_glsl_live_scan, "#define SUM_STEP\n"},
    [CWI_LIVE_TOP_COUNTS] = {NULL, cwi_glsl_live_scan, "#define TOP_STEP\n"},
    [CWI_LIVE_PLACE_COUNTS] = {NULL, cwi_glsl_live_scan, ""},
    [CWI_LIVE_EMIT] = {cwi_glsl_live_place, cwi_glsl_live_emit, ""},
    [CWI_LIVE_BUILD] = {cwi_glsl_live_place, cwi_glsl_live_build, ""},
    [CWI_LIVE_SIZE_MEND] = {NULL, cwi_glsl_live_size, "#define MEND_STEP\n"},
    [CWI_LIVE_MEND] = {NULL, cwi_glsl_live_mend, ""},
};

/* The number by which shaders know a type of voxels; 0: they do not. */
static int number_of(cw_type type)
{
    static const int numbers[CW_TYPE_COUNT] = {
        [CW_U8] = 1,  [CW_I8] = 2,  [CW_U16] = 3, [CW_I16] = 4,
        [CW_U32] = 6, [CW_I32] = 7, [CW_F32] = 8,
    };
    return numbers[type];
}

/* Starts to compile and to link; nothing is asked, so that drivers with threads for it go on to
 * the next program meanwhile. */
static GLuint start_program(cwi_live_pass pass, cw_type type)
{
    char head[256];
    snprintf(head, sizeof head, "#version 430 core\n#define TYPE %d\n%s", number_of(type),
             programs[pass].defines);
    const char *parts[] = {head,
                           "#line 1 1\n",
                           cwi_glsl_live_common,
                           "#line 1 2\n",
                           programs[pass].before ? programs[pass].before : "",
                           "#line 1 3\n",
                           programs[pass].source};
    const GLuint shader = glCreateShader(GL_COMPUTE_SHADER), program = glCreateProgram();
    glShaderSource(shader, sizeof parts / sizeof *parts, parts, NULL);
    glCompileShader(shader);
    glAttachShader(program, shader);
    glLinkProgram(program);
    glDeleteShader(shader);
    return program;
}

/* Waits for a program. What a shader lacks is in the log of its program, too. */
static cw_status finish_program(GLuint program, cwi_live_pass pass, cw_error *err)
{
    GLint is_linked = 0;
    GLuint shader = 0;
    char log[4096] = "";
    glGetProgramiv(program, GL_LINK_STATUS, &is_linked);
    if (is_linked) {
        glUseProgram(program);
        glUniform1i(glGetUniformLocation(program, "voxels"), CWI_UNIT_FREE);
        return CW_OK;
    }
    glGetAttachedShaders(program, 1, NULL, &shader);
    glGetShaderInfoLog(shader, sizeof log, NULL, log);
    if (!*log)
        glGetProgramInfoLog(program, sizeof log, NULL, log);
    const char *first = strstr(log, "error"); /* warnings may come before */
    return cwi_fail(err, CW_ERR_BACKEND, "OpenGL refuses compute program %d: %s", (int)pass,
                    first ? first : log);
}

void cwi_live_start_programs(cwi_live *live)
{
    if (epoxy_has_gl_extension("GL_KHR_parallel_shader_compile"))
        glMaxShaderCompilerThreadsKHR(UINT32_MAX);
    for (int pass = 0; pass < CWI_LIVE_PASSES; pass++)
        if (!live->programs[pass])
            live->programs[pass] = start_program((cwi_live_pass)pass, live->program_type);
}

/* Returns true if the driver does not compile this program any more. */
static bool is_complete(GLuint program)
{
    GLint complete = GL_TRUE;
    if (epoxy_has_gl_extension("GL_KHR_parallel_shader_compile"))
        glGetProgramiv(program, GL_COMPLETION_STATUS_KHR, &complete);
    return complete;
}

cw_status cwi_live_finish_programs(cwi_live *live, bool waits, bool *ready, cw_error *err)
{
    const double start = cwi_now_s();
    cw_status st = CW_OK;
    while (live->finished < CWI_LIVE_PASSES && st == CW_OK) {
        const GLuint program = live->programs[live->finished];
        if (!waits && (cwi_now_s() - start > SOON_S || !is_complete(program)))
            break;
        st = finish_program(program, (cwi_live_pass)live->finished, err);
        live->finished += st == CW_OK;
    }
    *ready = live->finished == CWI_LIVE_PASSES;
    return st;
}
