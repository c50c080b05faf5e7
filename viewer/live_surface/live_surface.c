/* Runs the passes that extract a surface on the GPU, and keeps what they need. */
#include "viewer/live_surface/live_internal.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/mesh/mesh.h"
#include "core/volume/volume.h"

#include <float.h>
#include <string.h>

/* Capacities to begin with; they grow as surfaces need. */
enum { FIRST_SLOTS = 1 << 15, FIRST_OPEN = 1 << 15, MAX_TRIES = 8 };

/* Entries that a group of a scan sums, and groups along x, as in live_common.glsl. */
enum { SCAN = 1024, GROUPS_X = 32768 };

/* ---- what this OpenGL can --------------------------------------------------------------- */

static bool is_software(void)
{
    static const char *const names[] = {"llvmpipe", "softpipe", "swrast", "SwiftShader"};
    const char *name = (const char *)glGetString(GL_RENDERER);
    bool found = false;
    for (size_t n = 0; name && n < sizeof names / sizeof *names; n++)
        found = found || strstr(name, names[n]);
    return found;
}

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
    if (is_software() && !desc->on_software)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "OpenGL runs on the CPU here, which is faster by itself");
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
        return cwi_fail(err, CW_ERR_UNSUPPORTED, "OpenGL extracts from no volume of doubles");
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

/* ---- buffers ---------------------------------------------------------------------------- */

cw_status cwi_live_need(cwi_live *live, cwi_live_buffer n, size_t bytes, cw_error *err)
{
    if (bytes <= live->bytes[n])
        return CW_OK;
    if (bytes > live->capacity.buffer_bytes)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "a live surface needs %zu bytes in one buffer; OpenGL holds %zu", bytes,
                        live->capacity.buffer_bytes);
    if (!cwi_memory_take(bytes - live->bytes[n]))
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for a live surface");
    live->counted_bytes += bytes - live->bytes[n];
    live->bytes[n] = bytes;
    glBindBuffer(GL_SHADER_STORAGE_BUFFER, live->buffers[n]);
    glBufferData(GL_SHADER_STORAGE_BUFFER, (GLsizeiptr)bytes, NULL, GL_DYNAMIC_COPY);
    return cwi_gl_check(err);
}

/* Returns a size with room to grow, but no more than fits. */
static size_t with_room(const cwi_live *live, size_t bytes)
{
    const size_t most = live->capacity.buffer_bytes, roomy = bytes + bytes / 4;
    return roomy <= most || bytes > most ? roomy : most;
}

static cw_status need_room(cwi_live *live, cwi_live_buffer n, size_t bytes, cw_error *err)
{
    return bytes <= live->bytes[n] ? CW_OK
                                   : cwi_live_need(live, n, with_room(live, bytes), err);
}

/* Makes the buffers of active blocks and open cells. */
static cw_status fit_slots(cwi_live *live, cw_error *err)
{
    static const struct {
        cwi_live_buffer buffer;
        size_t bytes;
    } a_slot[] = {{CWI_LIVE_ACTIVE, 4},
                  {CWI_LIVE_RECORDS, 4 * CWI_LIVE_RECORD},
                  {CWI_LIVE_COUNTS, 8},
                  {CWI_LIVE_BASES, 8},
                  {CWI_LIVE_OPEN_FIRST, 4}};
    cw_status st = CW_OK;
    for (size_t n = 0; n < sizeof a_slot / sizeof *a_slot && st == CW_OK; n++)
        st = cwi_live_need(live, a_slot[n].buffer, a_slot[n].bytes * (live->slots + 1), err);
    return st == CW_OK ? cwi_live_need(live, CWI_LIVE_OPEN, 16 * live->open_cells, err) : st;
}

static cw_status make_buffers(cwi_live *live, cw_error *err)
{
    static const uint32_t nothing[CWI_LIVE_TOTAL_WORDS] = {[CWI_LIVE_LOWEST] = UINT32_MAX};
    uint32_t tables[CWI_LIVE_TABLE_WORDS];
    const size_t blocks = live->block_count;
    glGenBuffers(CWI_LIVE_BUFFERS, live->buffers);
    cwi_live_fill_tables(tables);
    cw_status st = cwi_live_need(live, CWI_LIVE_PARAMS, sizeof live->params, err);
    if (st == CW_OK)
        st = cwi_live_need(live, CWI_LIVE_TOTALS, sizeof nothing, err);
    if (st == CW_OK)
        glBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, sizeof nothing, nothing);
    if (st == CW_OK)
        st = cwi_live_need(live, CWI_LIVE_TABLES, sizeof tables, err);
    if (st == CW_OK)
        glBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, sizeof tables, tables);
    if (st == CW_OK)
        st = cwi_live_need(live, CWI_LIVE_RANGES, 12 * blocks, err);
    if (st == CW_OK)
        st = cwi_live_need(live, CWI_LIVE_SLOTS, 4 * blocks, err);
    if (st == CW_OK)
        st = cwi_live_need(live, CWI_LIVE_SUMS, 8 * (blocks / SCAN + 1), err);
    if (st == CW_OK)
        st = cwi_live_need(live, CWI_LIVE_MISSING, 16 * (size_t)CWI_LIVE_MENDED, err);
    return st == CW_OK ? fit_slots(live, err) : st;
}

/* Describes the buffers of vertices and triangles for drawing. */
static void make_array(cwi_live *live)
{
    const size_t normal = 12;
    glGenVertexArrays(1, &live->array);
    glBindVertexArray(live->array);
    glBindBuffer(GL_ARRAY_BUFFER, live->buffers[CWI_LIVE_VERTICES]);
    for (GLuint n = 0; n < 2; n++) {
        glVertexAttribPointer(n, 3, GL_FLOAT, GL_FALSE, CWI_LIVE_VERTEX_BYTES,
                              (const void *)(n * normal));
        glEnableVertexAttribArray(n);
    }
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, live->buffers[CWI_LIVE_INDICES]);
    glBindVertexArray(0);
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

/* ---- passes ----------------------------------------------------------------------------- */

static void finish_pass(void)
{
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT |
                    GL_BUFFER_UPDATE_BARRIER_BIT);
}

static void run_groups(const cwi_live *live, cwi_live_pass pass, size_t groups)
{
    glUseProgram(live->programs[pass]);
    glDispatchCompute((GLuint)(groups < GROUPS_X ? groups : GROUPS_X),
                      (GLuint)((groups + GROUPS_X - 1) / GROUPS_X), 1);
    finish_pass();
}

/* Runs as many groups as an earlier pass has found. */
static void run_found(const cwi_live *live, cwi_live_pass pass, int size_at)
{
    glUseProgram(live->programs[pass]);
    glDispatchComputeIndirect((GLintptr)(4 * size_at));
    finish_pass();
}

static void bind_all(const cwi_live *live)
{
    for (GLuint n = 0; n < CWI_LIVE_BUFFERS; n++)
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, n, live->buffers[n]);
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, live->buffers[CWI_LIVE_TOTALS]);
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_FREE);
    glBindTexture(GL_TEXTURE_3D, live->voxels);
}

static void put_params(cwi_live *live)
{
    glBindBuffer(GL_SHADER_STORAGE_BUFFER, live->buffers[CWI_LIVE_PARAMS]);
    glBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, sizeof live->params, &live->params);
}

static void get_totals(const cwi_live *live, uint32_t totals[CWI_LIVE_TOTAL_WORDS])
{
    glBindBuffer(GL_SHADER_STORAGE_BUFFER, live->buffers[CWI_LIVE_TOTALS]);
    glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, CWI_LIVE_TOTAL_WORDS * sizeof *totals,
                       totals);
}

/* Finds the ranges of blocks, once, and whether voxels are without a value. */
static cw_status find_ranges(cwi_live *live, const cw_live_surface *desc, cw_error *err)
{
    uint32_t totals[CWI_LIVE_TOTAL_WORDS];
    if (live->has_ranges)
        return CW_OK;
    cw_status st = cwi_live_fill_params(live, desc, &live->params, err);
    if (st != CW_OK)
        return st;
    put_params(live);
    bind_all(live);
    run_groups(live, CWI_LIVE_FIND_RANGES, live->block_count);
    get_totals(live, totals);
    live->has_gaps = totals[CWI_LIVE_GAPS] != 0;
    live->range[0] = (int64_t)totals[CWI_LIVE_LOWEST] + INT32_MIN;
    live->range[1] = (int64_t)totals[CWI_LIVE_HIGHEST] + INT32_MIN;
    live->has_ranges = true;
    return cwi_gl_check(err);
}

static void mark_time(const cwi_live *live, const cwi_live_times *times, int n)
{
    if (times)
        glQueryCounter(live->times[n], GL_TIMESTAMP);
}

/* Lists the blocks that are crossed, counts, and finds the first numbers of each block. */
static void count_surface(cwi_live *live, const cwi_live_times *times)
{
    const size_t groups = (live->block_count + SCAN - 1) / SCAN;
    bind_all(live);
    mark_time(live, times, 0);
    run_groups(live, CWI_LIVE_SUM_BLOCKS, groups);
    run_groups(live, CWI_LIVE_TOP_BLOCKS, 1);
    run_groups(live, CWI_LIVE_PLACE_BLOCKS, groups);
    run_found(live, CWI_LIVE_COUNT, CWI_LIVE_FOR_ACTIVE);
    run_groups(live, CWI_LIVE_SIZE_OPEN, 1);
    run_found(live, CWI_LIVE_PLAN, CWI_LIVE_FOR_OPEN);
    mark_time(live, times, 1);
    run_found(live, CWI_LIVE_SUM_COUNTS, CWI_LIVE_FOR_SCAN);
    run_groups(live, CWI_LIVE_TOP_COUNTS, 1);
    run_found(live, CWI_LIVE_PLACE_COUNTS, CWI_LIVE_FOR_SCAN);
    mark_time(live, times, 2);
}

static void emit_surface(cwi_live *live, const cwi_live_times *times)
{
    bind_all(live);
    run_found(live, CWI_LIVE_EMIT, CWI_LIVE_FOR_ACTIVE);
    run_found(live, CWI_LIVE_BUILD, CWI_LIVE_FOR_OPEN);
    run_groups(live, CWI_LIVE_SIZE_MEND, 1);
    run_found(live, CWI_LIVE_MEND, CWI_LIVE_FOR_MEND);
    glMemoryBarrier(GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT | GL_ELEMENT_ARRAY_BARRIER_BIT);
    mark_time(live, times, 3);
}

static void read_times(const cwi_live *live, cwi_live_times *times)
{
    GLuint64 at[4];
    for (int n = 0; n < 4; n++)
        glGetQueryObjectui64v(live->times[n], GL_QUERY_RESULT, &at[n]);
    times->classify_ms = (double)(at[1] - at[0]) / 1e6;
    times->scan_ms = (double)(at[2] - at[1]) / 1e6;
    times->emit_ms = (double)(at[3] - at[2]) / 1e6;
}

/* Counts, and again with more room where lists were too short. */
static cw_status count_all(cwi_live *live, const cw_live_surface *desc,
                           const cwi_live_times *times, uint32_t *totals, cw_error *err)
{
    memset(totals, 0, CWI_LIVE_TOTAL_WORDS * sizeof *totals);
    for (int tries = 0; tries < MAX_TRIES; tries++) {
        cw_status st = cwi_live_fill_params(live, desc, &live->params, err);
        if (st != CW_OK || !cwi_live_is_crossed(live))
            return st;
        put_params(live);
        count_surface(live, times);
        get_totals(live, totals);
        const size_t slots = totals[CWI_LIVE_ACTIVE_COUNT], open = totals[CWI_LIVE_OPEN_COUNT];
        if (slots <= live->slots && open <= live->open_cells)
            return cwi_gl_check(err);
        if (slots > live->slots)
            live->slots =
                slots + slots / 4 < live->block_count ? slots + slots / 4 : live->block_count;
        if (open > live->open_cells)
            live->open_cells = open + open / 4;
        st = fit_slots(live, err);
        if (st != CW_OK)
            return st;
    }
    return cwi_fail(err, CW_ERR_BACKEND, "OpenGL counts a live surface differently each time");
}

static cw_status extract(cwi_live *live, const cw_live_surface *desc, cwi_live_times *times,
                         cw_error *err)
{
    uint32_t totals[CWI_LIVE_TOTAL_WORDS];
    live->has_surface = false;
    cw_status st = find_ranges(live, desc, err);
    if (st == CW_OK)
        st = count_all(live, desc, times, totals, err);
    if (st != CW_OK)
        return st;
    live->vertex_count = totals[CWI_LIVE_VERTEX_COUNT];
    live->triangle_count = totals[CWI_LIVE_TRIANGLE_COUNT];
    if (live->triangle_count > INT32_MAX / 3)
        return cwi_fail(err, CW_ERR_LIMIT, "%zu triangles: OpenGL draws up to %d",
                        live->triangle_count, INT32_MAX / 3);
    st = need_room(live, CWI_LIVE_VERTICES, CWI_LIVE_VERTEX_BYTES * live->vertex_count, err);
    if (st == CW_OK)
        st = need_room(live, CWI_LIVE_INDICES, CWI_LIVE_TRIANGLE_BYTES * live->triangle_count,
                       err);
    if (st != CW_OK)
        return st;
    if (live->triangle_count)
        emit_surface(live, times);
    if (times)
        *times = (cwi_live_times){0};
    if (times && live->triangle_count)
        read_times(live, times);
    st = cwi_gl_check(err);
    live->has_surface = st == CW_OK;
    live->isovalue = desc->isovalue;
    live->inside_is_low = desc->inside_is_low;
    return st;
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
        st = make_buffers(live, err);
    if (st != CW_OK)
        return st;
    glGenQueries(sizeof live->times / sizeof *live->times, live->times);
    make_array(live);
    return cwi_gl_check(err);
}

/* Makes the state, and drops what is of another volume, or of another type of voxels. */
static cw_status make_state(cwi_live **live, const cw_volume *v, cw_error *err)
{
    if (*live && (*live)->is_set_up && memcmp(&(*live)->key, v, sizeof *v) == 0)
        return CW_OK;
    if (!*live && !(*live = cwi_alloc_zeroed(1, sizeof **live)))
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for a live surface");
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
        st = extract(*live, desc, times, err);
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
    cw_status st = both ? cwi_mesh_renew(mesh, vertices, triangles, true, err)
                        : cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for a mesh");
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
