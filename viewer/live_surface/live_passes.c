/* Runs the passes that extract a surface on the GPU. */
#include "viewer/live_surface/live_internal.h"

#include "core/base/status.h"

#include <string.h>

/* How often counts are made before their differing is an error. */
enum { MAX_TRIES = 8 };

/* Groups along x, as in live_common.glsl. */
enum { GROUPS_X = 32768 };

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
    const size_t groups = (live->block_count + CWI_LIVE_SCAN - 1) / CWI_LIVE_SCAN;
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
        st = cwi_live_fit_slots(live, err);
        if (st != CW_OK)
            return st;
    }
    return cwi_fail(err, CW_ERR_BACKEND, "OpenGL counts a live surface differently each time");
}

cw_status cwi_live_extract(cwi_live *live, const cw_live_surface *desc, cwi_live_times *times,
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
    st = cwi_live_ensure_capacity(live, CWI_LIVE_VERTICES,
                                  CWI_LIVE_VERTEX_BYTES * live->vertex_count, err);
    if (st == CW_OK)
        st = cwi_live_ensure_capacity(live, CWI_LIVE_INDICES,
                                      CWI_LIVE_TRIANGLE_BYTES * live->triangle_count, err);
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
