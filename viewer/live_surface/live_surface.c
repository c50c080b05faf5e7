/* Checks what a live surface needs, keeps what is of a volume, and hands the surface out. */
#include "viewer/live_surface/live_internal.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/mesh/mesh.h"
#include "core/volume/volume.h"

#include <float.h>
#include <string.h>

/* Capacities to begin with; they grow as surfaces need. */
enum { FIRST_SLOTS = 1 << 15, FIRST_OPEN = 1 << 15 };

/* ---- what this OpenGL can --------------------------------------------------------------- */

/* Checks everything that can be known without a volume. */
static cw_status check_opengl(const cw_live_surface *desc, cw_error *err)
{
    GLint blocks = 0, bindings = 0;
    if (epoxy_gl_version() < 43)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "a live surface needs OpenGL 4.3; this one is %d.%d",
                        epoxy_gl_version() / 10, epoxy_gl_version() % 10);
    glGetIntegerv(GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS, &blocks);
    glGetIntegerv(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS, &bindings);
    if (blocks < CWI_LIVE_BUFFERS || bindings < CWI_LIVE_BUFFERS)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "a live surface needs %d storage buffers; OpenGL has %d here",
                        CWI_LIVE_BUFFERS, blocks < bindings ? blocks : bindings);
    if (cwi_gl_is_software((const char *)glGetString(GL_RENDERER)) && !desc->on_software)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "OpenGL runs in software here; CPU extraction is faster");
    return CW_OK;
}

static cwi_live_capacity find_capacity(const cwi_live_limits *limits)
{
    GLint edge = 0;
    GLint64 bytes = 0;
    glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &edge);
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &bytes);
    cwi_live_capacity c = {(size_t)edge, bytes < 0 ? (size_t)INT32_MAX : (size_t)bytes};
    if (limits && limits->texture_edge && limits->texture_edge < c.texture_edge)
        c.texture_edge = limits->texture_edge;
    if (limits && limits->buffer_bytes && limits->buffer_bytes < c.buffer_bytes)
        c.buffer_bytes = limits->buffer_bytes;
    return c;
}

/* Checks what the CPU's extraction asks of a volume, and what the shaders do beyond it. */
static cw_status check_volume(const cw_volume *v, cw_error *err)
{
    double spacing[3];
    const char *kind = cwi_volume_kind(v);
    if (kind)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "OpenGL extracts from evenly spaced volumes, not from %s", kind);
    if (v->type == CW_F64)
        return cwi_fail(err, CW_ERR_UNSUPPORTED, "live surfaces do not support f64 volumes");
    cw_volume_spacing(v, spacing);
    for (int a = 0; a < 3; a++) {
        if (v->dim[a] < 2)
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "the volume has %zu voxel along %c; a surface needs 2", v->dim[a],
                            "xyz"[a]);
        if (spacing[a] < (double)FLT_MIN ||
            spacing[a] * (double)v->dim[a] > 0.5 * (double)FLT_MAX)
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "%zu voxels of %g mm along %c are beyond what positions can hold",
                            v->dim[a], spacing[a], "xyz"[a]);
    }
    return CW_OK;
}

void cwi_live_forget(cwi_live *live)
{
    cwi_live empty = {0};
    if (!live)
        return;
    glDeleteBuffers(CWI_LIVE_BUFFERS, live->buffers);
    glDeleteVertexArrays(1, &live->array);
    glDeleteTextures(1, &live->voxels);
    glDeleteQueries(sizeof live->times / sizeof *live->times, live->times);
    cwi_memory_give(live->counted_bytes);
    empty.program_type = live->program_type;
    empty.finished = live->finished;
    memcpy(empty.programs, live->programs, sizeof empty.programs);
    *live = empty;
}

static void drop_programs(cwi_live *live)
{
    for (int n = 0; n < CWI_LIVE_PASSES; n++)
        glDeleteProgram(live->programs[n]);
    memset(live->programs, 0, sizeof live->programs);
    live->finished = 0;
}

void cwi_live_drop(cwi_live *live)
{
    if (!live)
        return;
    cwi_live_forget(live);
    drop_programs(live);
    cwi_free(live);
}

/* ---- calls ------------------------------------------------------------------------------ */

static cw_status set_up(cwi_live *live, const cwi_live_limits *limits, cw_error *err)
{
    live->capacity = find_capacity(limits);
    live->block_count = 1;
    for (int a = 0; a < 3; a++) {
        live->blocks[a] = (live->key.dim[a] + 8) / 8; /* of dim + 1 cells */
        live->block_count *= live->blocks[a];
    }
    live->slots = live->block_count < FIRST_SLOTS ? live->block_count : FIRST_SLOTS;
    live->open_cells = FIRST_OPEN;
    if (live->block_count > (size_t)1 << 23)
        return cwi_fail(err, CW_ERR_LIMIT, "%zu blocks: a live surface has at most %d",
                        live->block_count, 1 << 23);
    bool ready;
    cwi_live_start_programs(live);
    cw_status st = cwi_live_finish_programs(live, true, &ready, err);
    if (st != CW_OK)
        drop_programs(live);
    if (st == CW_OK)
        st = cwi_live_upload(live, err);
    if (st == CW_OK)
        st = cwi_live_make_buffers(live, err);
    if (st != CW_OK)
        return st;
    glGenQueries(sizeof live->times / sizeof *live->times, live->times);
    return cwi_gl_check(err);
}

/* Makes the state, and drops what is of another volume, or of another type of voxels. */
static cw_status make_state(cwi_live **live, const cw_volume *v, cw_error *err)
{
    if (*live && (*live)->is_set_up && memcmp(&(*live)->key, v, sizeof *v) == 0)
        return CW_OK;
    if (!*live && !(*live = cwi_alloc_zeroed(1, sizeof **live)))
        return cwi_fail_memory(err);
    cwi_live *l = *live;
    cwi_live_forget(l);
    if (l->program_type != v->type) /* those of a type stay: they take long to compile */
        drop_programs(l);
    l->program_type = v->type;
    l->key = *v;
    return CW_OK;
}

static cw_status need_live(cwi_live **live, const cw_volume *v, const cwi_live_limits *limits,
                           cw_error *err)
{
    cw_status st = make_state(live, v, err);
    if (st == CW_OK && !(*live)->is_set_up) {
        st = set_up(*live, limits, err);
        (*live)->is_set_up = st == CW_OK;
    }
    return st;
}

/* Leaves no binding behind that other passes, or a compute shader's textures, could be confused
 * by. */
static void release(void)
{
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, 0);
    glBindBuffer(GL_SHADER_STORAGE_BUFFER, 0);
    for (GLuint n = 0; n < CWI_LIVE_BUFFERS; n++)
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, n, 0);
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_FREE);
    glBindTexture(GL_TEXTURE_3D, 0);
    glUseProgram(0);
}

/* Checks the context, and resolves and checks the volume. */
static cw_status check_all(const cw_live_surface *desc, cw_volume *v, cw_error *err)
{
    cw_status st = check_opengl(desc, err);
    if (st == CW_OK)
        st = cw_volume_select(desc->volume, 0, 0, v, err);
    return st == CW_OK ? check_volume(v, err) : st;
}

cw_status cwi_live_prepare(cwi_live **live, const cw_live_surface *desc, bool *ready,
                           cw_error *err)
{
    cw_volume v;
    cw_status st = check_all(desc, &v, err);
    if (st == CW_OK)
        st = make_state(live, &v, err);
    if (st != CW_OK)
        return st;
    cwi_live_start_programs(*live);
    st = cwi_live_finish_programs(*live, false, ready, err);
    if (st == CW_OK && *ready)
        st = need_live(live, &v, NULL, err);
    release();
    if (st != CW_OK) {
        drop_programs(*live);
        cwi_live_forget(*live);
        *ready = false;
    }
    return st;
}

cw_status cwi_live_take(cwi_live **live, const cw_live_surface *desc,
                        const cwi_live_limits *limits, cwi_live_times *times,
                        cwi_live_mesh *mesh, cw_error *err)
{
    cw_volume v;
    memset(mesh, 0, sizeof *mesh);
    cw_status st = check_all(desc, &v, err);
    if (st != CW_OK)
        return st;
    st = need_live(live, &v, limits, err);
    if (st == CW_OK && (times || !(*live)->has_surface || (*live)->isovalue != desc->isovalue ||
                        (*live)->inside_is_low != desc->inside_is_low))
        st = cwi_live_extract(*live, desc, times, err);
    if (*live)
        release();
    if (st == CW_OK)
        *mesh = (cwi_live_mesh){(*live)->array, (*live)->vertex_count, (*live)->triangle_count};
    else
        cwi_live_forget(*live);
    return st;
}

cw_status cwi_live_read(const cwi_live *live, cw_mesh *mesh, cw_error *err)
{
    const size_t vertices = live->vertex_count, triangles = live->triangle_count;
    memset(mesh, 0, sizeof *mesh);
    if (!triangles)
        return CW_OK;
    float *both = cwi_alloc_array(vertices, CWI_LIVE_VERTEX_BYTES);
    cw_status st =
        both ? cwi_mesh_renew(mesh, vertices, triangles, true, err) : cwi_fail_memory(err);
    if (st == CW_OK) {
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        glBindBuffer(GL_SHADER_STORAGE_BUFFER, live->buffers[CWI_LIVE_INDICES]);
        glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0,
                           (GLsizeiptr)(CWI_LIVE_TRIANGLE_BYTES * triangles), mesh->triangles);
        glBindBuffer(GL_SHADER_STORAGE_BUFFER, live->buffers[CWI_LIVE_VERTICES]);
        glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0,
                           (GLsizeiptr)(CWI_LIVE_VERTEX_BYTES * vertices), both);
        for (size_t v = 0; v < vertices; v++) {
            memcpy(mesh->positions + 3 * v, both + 6 * v, 12);
            memcpy(mesh->normals + 3 * v, both + 6 * v + 3, 12);
        }
        glBindBuffer(GL_SHADER_STORAGE_BUFFER, 0);
        cwi_affine_apply(live->key.affine[0], live->params.numbers + 19, mesh->origin);
        memcpy(mesh->affine, live->key.affine, sizeof mesh->affine);
        st = cwi_gl_check(err);
    }
    cwi_free(both);
    return st;
}
