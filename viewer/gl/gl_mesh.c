/* Uploads the frame's mesh to the GPU, and allocates the textures for its layers and cut
 * faces. */
#include "viewer/gl/gl_mesh.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "viewer/scene/mesh_tint.h"

#include <math.h>
#include <string.h>

enum { CHUNK = 1 << 16, RAMP_ROWS = 1024 };

/* A vertex in a buffer; without normals they are 0. */
typedef struct vertex {
    float position[3], normal[3];
    uint8_t color[4];
    float tint;
} vertex;

static void drop_sized(cwi_gl_mesh *m)
{
    glDeleteFramebuffers(2, m->layers);
    glDeleteFramebuffers(CWI_WINDINGS, m->winding_targets);
    glDeleteTextures(1, &m->layer_color);
    glDeleteTextures(2, m->layer_depth);
    glDeleteTextures(CWI_WINDINGS, m->windings);
    m->layer_color = 0;
    memset(m->windings, 0, sizeof m->windings);
    memset(m->winding_targets, 0, sizeof m->winding_targets);
    memset(m->layers, 0, sizeof m->layers);
    memset(m->layer_depth, 0, sizeof m->layer_depth);
}

static void drop_buffers(cwi_gl_mesh *m)
{
    glDeleteVertexArrays(1, &m->array);
    glDeleteBuffers(1, &m->vertices);
    glDeleteBuffers(1, &m->indices);
    m->array = m->vertices = m->indices = 0;
    m->is_uploaded = false;
}

void cwi_gl_drop_mesh(void *state)
{
    cwi_gl_mesh *m = state;
    drop_sized(m);
    drop_buffers(m);
    glDeleteTextures(1, &m->ramp);
    glDeleteQueries(1, &m->query);
    cwi_free(m);
}

static void put_vertex(const cw_mesh *mesh, size_t v, double tint, vertex *out)
{
    memcpy(out->position, mesh->positions + 3 * v, sizeof out->position);
    if (mesh->normals)
        memcpy(out->normal, mesh->normals + 3 * v, sizeof out->normal);
    if (mesh->colors)
        memcpy(out->color, mesh->colors + 4 * v, sizeof out->color);
    out->tint = (float)tint;
}

/* Writes vertices or, for an expanded mesh, corners, from a number on. */
static void put_chunk(const cwi_gl_mesh *m, size_t first, size_t count, vertex *out)
{
    const cw_mesh *mesh = &m->key;
    memset(out, 0, count * sizeof *out);
    for (size_t n = 0; n < count; n++) {
        const size_t v = m->is_expanded ? mesh->triangles[first + n] : first + n;
        double tint = 0;
        if (m->tint == CW_TINT_SCALARS)
            tint = (double)mesh->scalars[v];
        else if (m->tint == CW_TINT_QUALITY)
            tint = cwi_triangle_shape(mesh, (first + n) / 3);
        put_vertex(mesh, v, tint, out + n);
    }
}

static cw_status upload_vertices(cwi_gl *gl, const cwi_gl_mesh *m, cw_error *err)
{
    const size_t count = m->is_expanded ? 3 * m->key.triangle_count : m->key.vertex_count;
    vertex *chunk = cwi_alloc_array(CHUNK, sizeof *chunk);
    if (!chunk)
        return cwi_fail_memory(err);
    glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(count * sizeof *chunk), NULL, GL_STATIC_DRAW);
    cw_status st = CW_OK;
    for (size_t first = 0; first < count && st == CW_OK; first += CHUNK) {
        const size_t n = count - first < CHUNK ? count - first : CHUNK;
        put_chunk(m, first, n, chunk);
        glBufferSubData(GL_ARRAY_BUFFER, (GLintptr)(first * sizeof *chunk),
                        (GLsizeiptr)(n * sizeof *chunk), chunk);
        st = cwi_gl_report(gl, "uploading", (double)(first + n) / (double)count, err);
    }
    cwi_free(chunk);
    return st;
}

static void name_attributes(void)
{
    static const struct {
        GLint size;
        GLenum type;
        size_t at;
    } attributes[] = {{3, GL_FLOAT, offsetof(vertex, position)},
                      {3, GL_FLOAT, offsetof(vertex, normal)},
                      {4, GL_UNSIGNED_BYTE, offsetof(vertex, color)},
                      {1, GL_FLOAT, offsetof(vertex, tint)}};
    for (GLuint n = 0; n < sizeof attributes / sizeof *attributes; n++) {
        glVertexAttribPointer(n, attributes[n].size, attributes[n].type,
                              attributes[n].type == GL_UNSIGNED_BYTE, sizeof(vertex),
                              (const void *)attributes[n].at);
        glEnableVertexAttribArray(n);
    }
}

static cw_status upload_mesh(cwi_gl *gl, cwi_gl_mesh *m, cw_error *err)
{
    drop_buffers(m);
    glGenVertexArrays(1, &m->array);
    glBindVertexArray(m->array);
    glGenBuffers(1, &m->vertices);
    glBindBuffer(GL_ARRAY_BUFFER, m->vertices);
    name_attributes();
    if (!m->is_expanded) {
        glGenBuffers(1, &m->indices);
        glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, m->indices);
        glBufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)(12 * m->key.triangle_count),
                     m->key.triangles, GL_STATIC_DRAW);
    }
    cw_status st = upload_vertices(gl, m, err);
    m->has_alpha = false;
    for (size_t v = 0; m->key.colors && v < m->key.vertex_count && !m->has_alpha; v++)
        m->has_alpha = m->key.colors[4 * v + 3] < 255;
    m->is_uploaded = st == CW_OK;
    return st;
}

static void make_ramp(cwi_gl_mesh *m)
{
    float rows[RAMP_ROWS][3];
    for (int n = 0; n < RAMP_ROWS; n++) {
        double srgb[3];
        cwi_ramp_color(n / (double)(RAMP_ROWS - 1), srgb);
        for (int c = 0; c < 3; c++)
            rows[n][c] = (float)srgb[c];
    }
    m->ramp = cwi_gl_texture(GL_TEXTURE_2D, CWI_UNIT_RAMP, true);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB32F, RAMP_ROWS, 1, 0, GL_RGB, GL_FLOAT, rows);
}

static bool is_same(const cw_mesh *a, const cw_mesh *b)
{
    return a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count &&
           a->positions == b->positions && a->normals == b->normals &&
           a->triangles == b->triangles && a->scalars == b->scalars && a->colors == b->colors;
}

/* Makes the state at the first call. */
static cw_status need_mesh(void **state, cw_error *err)
{
    cwi_gl_mesh *m = *state;
    if (!m && !(m = *state = cwi_alloc_zeroed(1, sizeof *m)))
        return cwi_fail_memory(err);
    if (!m->ramp) {
        make_ramp(m);
        glGenQueries(1, &m->query);
    }
    return CW_OK;
}

cw_status cwi_gl_lend_mesh(void **state, GLuint array, size_t triangles, cwi_gl_mesh **mesh,
                           cw_error *err)
{
    cw_status st = need_mesh(state, err);
    if (st != CW_OK)
        return st;
    cwi_gl_mesh *m = *mesh = *state;
    m->live_array = array;
    m->live_triangles = triangles;
    m->tint_range[0] = 0;
    m->tint_range[1] = 1;
    m->has_alpha = false;
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_RAMP);
    glBindTexture(GL_TEXTURE_2D, m->ramp);
    return CW_OK;
}

cw_status cwi_gl_take_mesh(cwi_gl *gl, void **state, cwi_gl_mesh **mesh, cw_error *err)
{
    const cw_scene *s = &gl->frame->scene;
    const bool expanded = s->mesh_look.wireframe || s->mesh_look.tint == CW_TINT_QUALITY;
    cwi_gl_mesh *m;
    double range[2];
    cw_status st = cwi_tint_range(s, range, err);
    if (st != CW_OK)
        return st;
    if (s->mesh->triangle_count > INT32_MAX / 3)
        return cwi_fail(err, CW_ERR_LIMIT, "%zu triangles: OpenGL draws up to %d",
                        s->mesh->triangle_count, INT32_MAX / 3);
    st = need_mesh(state, err);
    if (st != CW_OK)
        return st;
    m = *state;
    m->live_array = 0;
    memcpy(m->tint_range, range, sizeof range);
    if (!m->is_uploaded || !is_same(&m->key, s->mesh) || m->is_expanded != expanded ||
        m->tint != s->mesh_look.tint) {
        m->key = *s->mesh;
        m->is_expanded = expanded;
        m->tint = s->mesh_look.tint;
        st = upload_mesh(gl, m, err);
    }
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_RAMP);
    glBindTexture(GL_TEXTURE_2D, m->ramp);
    *mesh = m;
    return st;
}

static GLuint sized_texture(const cwi_gl *gl, int unit, GLenum inner, GLenum format)
{
    const GLuint name = cwi_gl_texture(GL_TEXTURE_2D, unit, false);
    glTexImage2D(GL_TEXTURE_2D, 0, (GLint)inner, gl->target.width, gl->target.height, 0, format,
                 GL_FLOAT, NULL);
    return name;
}

static cw_status make_target(GLuint *name, GLuint color, GLuint depth, cw_error *err)
{
    glGenFramebuffers(1, name);
    glBindFramebuffer(GL_FRAMEBUFFER, *name);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, color, 0);
    if (depth)
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth, 0);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return cwi_fail(err, CW_ERR_BACKEND, "OpenGL does not draw into layers of floats");
    return CW_OK;
}

static void fit_mesh(const cwi_gl *gl, cwi_gl_mesh *m)
{
    if (m->width == gl->target.width && m->height == gl->target.height)
        return;
    drop_sized(m);
    m->width = gl->target.width;
    m->height = gl->target.height;
}

cw_status cwi_gl_need_layers(cwi_gl *gl, cwi_gl_mesh *m, cw_error *err)
{
    cw_status st = CW_OK;
    fit_mesh(gl, m);
    if (m->layer_color)
        return CW_OK;
    m->layer_color = sized_texture(gl, CWI_UNIT_LAYER, GL_RGBA32F, GL_RGBA);
    for (int n = 0; n < 2 && st == CW_OK; n++) {
        m->layer_depth[n] =
            sized_texture(gl, CWI_UNIT_PEELED, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT);
        st = make_target(&m->layers[n], m->layer_color, m->layer_depth[n], err);
    }
    return st;
}

cw_status cwi_gl_need_winding(cwi_gl *gl, cwi_gl_mesh *m, size_t n, cw_error *err)
{
    fit_mesh(gl, m);
    if (m->windings[n])
        return CW_OK;
    m->windings[n] = sized_texture(gl, CWI_UNIT_WINDING, GL_RGBA32F, GL_RGBA);
    return make_target(&m->winding_targets[n], m->windings[n], 0, err);
}

/* Makes the matrix for the mesh's numbers: its origin is subtracted from the eye in double
 * precision. */
static void put_matrix(const cwi_frame *f, float m[16])
{
    double d[3];
    memset(m, 0, 16 * sizeof *m);
    m[15] = 1;
    for (int a = 0; a < 3; a++)
        d[a] = (f->scene.mesh->origin[a] - f->eye_mm[a]) / f->unit_mm;
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++)
            m[4 * c + r] = (float)(f->axes[r][c] / f->unit_mm);
        m[12 + r] = (float)cwi_dot(f->axes[r], d);
    }
}

void cwi_gl_set_mesh(const cwi_gl *gl, GLuint program)
{
    static const struct {
        const char *name;
        GLint unit;
    } samplers[] = {{"ramp", CWI_UNIT_RAMP},
                    {"peeled", CWI_UNIT_PEELED},
                    {"covered", CWI_UNIT_COVERED},
                    {"layer", CWI_UNIT_LAYER},
                    {"winding", CWI_UNIT_WINDING}};
    float matrix[16];
    for (size_t n = 0; n < sizeof samplers / sizeof *samplers; n++)
        glUniform1i(glGetUniformLocation(program, samplers[n].name), samplers[n].unit);
    put_matrix(gl->frame, matrix);
    glUniformMatrix4fv(glGetUniformLocation(program, "eye_from_mesh"), 1, GL_FALSE, matrix);
}

cw_status cwi_gl_draw_whole_mesh(cwi_gl *gl, const cwi_gl_mesh *m, cw_error *err)
{
    if (m->live_array) {
        glBindVertexArray(m->live_array);
        return cwi_gl_draw_triangles(gl, m->live_triangles, true, err);
    }
    glBindVertexArray(m->array);
    return cwi_gl_draw_triangles(gl, m->key.triangle_count, !m->is_expanded, err);
}
