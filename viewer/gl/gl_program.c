/* Compiles and links shaders, and caches programs by their sources and definitions. */
#include "viewer/gl/gl_internal.h"

#include "core/base/status.h"

#include <stdio.h>
#include <string.h>

static GLuint compile_shader(GLenum stage, const char *defines, const char *source,
                             cw_error *err)
{
    const char *parts[] = {"#version 330 core\n",
                           stage == GL_VERTEX_SHADER ? "#define VERTEX\n"
                                                     : "#define FRAGMENT\n",
                           defines,
                           "#line 1 1\n",
                           cwi_glsl_common,
                           "#line 1 2\n",
                           source};
    GLint is_compiled = 0;
    char log[300] = "";
    const GLuint shader = glCreateShader(stage);
    glShaderSource(shader, sizeof parts / sizeof *parts, parts, NULL);
    glCompileShader(shader);
    glGetShaderiv(shader, GL_COMPILE_STATUS, &is_compiled);
    if (is_compiled)
        return shader;
    glGetShaderInfoLog(shader, sizeof log, NULL, log);
    glDeleteShader(shader);
    cwi_fail(err, CW_ERR_BACKEND, "OpenGL refuses a shader: %s", log);
    return 0;
}

/* Sets texture units and blocks, which GLSL 3.30 cannot declare. */
static void set_units(GLuint program)
{
    static const struct {
        const char *name;
        GLint unit;
    } samplers[] = {{"volume", CWI_UNIT_VOLUME},     {"table", CWI_UNIT_TABLE},
                    {"segments", CWI_UNIT_SEGMENTS}, {"skip", CWI_UNIT_SKIP},
                    {"depth", CWI_UNIT_DEPTH},       {"gradients", CWI_UNIT_GRADIENT},
                    {"factor", CWI_UNIT_FACTOR}};
    const GLuint block = glGetUniformBlockIndex(program, "Frame");
    glUseProgram(program);
    for (size_t n = 0; n < sizeof samplers / sizeof *samplers; n++)
        glUniform1i(glGetUniformLocation(program, samplers[n].name), samplers[n].unit);
    if (block != GL_INVALID_INDEX)
        glUniformBlockBinding(program, block, 0);
}

static cw_status link_program(GLuint vertex, GLuint fragment, GLuint *program, cw_error *err)
{
    GLint is_linked = 0;
    char log[300] = "";
    *program = glCreateProgram();
    glAttachShader(*program, vertex);
    glAttachShader(*program, fragment);
    glLinkProgram(*program);
    glGetProgramiv(*program, GL_LINK_STATUS, &is_linked);
    if (is_linked) {
        set_units(*program);
        return CW_OK;
    }
    glGetProgramInfoLog(*program, sizeof log, NULL, log);
    glDeleteProgram(*program);
    return cwi_fail(err, CW_ERR_BACKEND, "OpenGL refuses a program: %s", log);
}

static cw_status build_program(const char *vertex, const char *fragment, const char *defines,
                               GLuint *program, cw_error *err)
{
    const GLuint v = compile_shader(GL_VERTEX_SHADER, defines, vertex, err);
    const GLuint f = v ? compile_shader(GL_FRAGMENT_SHADER, defines, fragment, err) : 0;
    cw_status st = f ? link_program(v, f, program, err) : CW_ERR_BACKEND;
    glDeleteShader(v); /* 0 is ignored */
    glDeleteShader(f);
    return st;
}

/* Returns the definitions that shaders of this volume need. */
static const char *volume_defines(const cwi_gl_volume *g)
{
    return !g->in_place            ? ""
           : g->key.type == CW_I16 ? "#define IN_PLACE\n#define SHORTS\n"
                                   : "#define IN_PLACE\n";
}

cw_status cwi_gl_use(cwi_gl *gl, const char *vertex, const char *fragment, const char *defines,
                     GLuint *program, cw_error *err)
{
    char all[sizeof gl->programs->defines];
    snprintf(all, sizeof all, "%s%s", volume_defines(&gl->volume), defines);
    for (size_t n = 0; n < gl->program_count; n++) {
        const cwi_gl_program *p = &gl->programs[n];
        if (p->vertex == vertex && p->fragment == fragment && strcmp(p->defines, all) == 0) {
            glUseProgram(*program = p->name);
            return CW_OK;
        }
    }
    if (gl->program_count == CWI_GL_PROGRAMS) /* cache is full: empty it */
        while (gl->program_count > 0)
            glDeleteProgram(gl->programs[--gl->program_count].name);
    cwi_gl_program *p = &gl->programs[gl->program_count];
    *p = (cwi_gl_program){.vertex = vertex, .fragment = fragment};
    memcpy(p->defines, all, sizeof all);
    cw_status st = build_program(vertex, fragment, p->defines, &p->name, err);
    if (st == CW_OK) {
        gl->program_count++;
        *program = p->name;
    }
    return st;
}

void cwi_gl_set(GLuint program, const char *name, float value)
{
    glUniform1f(glGetUniformLocation(program, name), value);
}

void cwi_gl_set3(GLuint program, const char *name, const double value[3])
{
    glUniform3f(glGetUniformLocation(program, name), (float)value[0], (float)value[1],
                (float)value[2]);
}

const char *cwi_gl_ray_defines(const cw_scene *scene)
{
    static const char *const rows[2][3] = {
        {"#define RAYS\n", "#define RAYS\n#define CLIPS\n",
         "#define RAYS\n#define CLIPS\n#define CUT_AWAY\n"},
        {"#define RAYS\n#define MESH\n", "#define RAYS\n#define MESH\n#define CLIPS\n",
         "#define RAYS\n#define MESH\n#define CLIPS\n#define CUT_AWAY\n"}};
    return rows[scene->mesh != NULL][scene->clip_count == 0 ? 0 : scene->cut_away ? 2 : 1];
}

void cwi_gl_draw_screen(cwi_gl *gl)
{
    glBindVertexArray(gl->empty_array);
    glDrawArrays(GL_TRIANGLES, 0, 3);
}
