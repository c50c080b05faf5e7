/* Allocates the buffers of a live surface. */
#include "viewer/live_surface/live_internal.h"

#include "core/base/memory.h"
#include "core/base/status.h"

cw_status cwi_live_need(cwi_live *live, cwi_live_buffer n, size_t bytes, cw_error *err)
{
    if (bytes <= live->bytes[n])
        return CW_OK;
    if (bytes > live->capacity.buffer_bytes)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "a live surface needs %zu bytes in one buffer; OpenGL holds %zu", bytes,
                        live->capacity.buffer_bytes);
    if (!cwi_memory_take(bytes - live->bytes[n]))
        return cwi_fail_memory(err);
    live->counted_bytes += bytes - live->bytes[n];
    live->bytes[n] = bytes;
    glBindBuffer(GL_SHADER_STORAGE_BUFFER, live->buffers[n]);
    glBufferData(GL_SHADER_STORAGE_BUFFER, (GLsizeiptr)bytes, NULL, GL_DYNAMIC_COPY);
    return cwi_gl_check(err);
}

/* Returns a size with room to grow, but no more than fits. */
static size_t with_room(const cwi_live *live, size_t bytes)
{
    const size_t max = live->capacity.buffer_bytes, padded = bytes + bytes / 4;
    return padded <= max || bytes > max ? padded : max;
}

cw_status cwi_live_ensure_capacity(cwi_live *live, cwi_live_buffer n, size_t bytes,
                                   cw_error *err)
{
    return bytes <= live->bytes[n] ? CW_OK
                                   : cwi_live_need(live, n, with_room(live, bytes), err);
}

cw_status cwi_live_fit_slots(cwi_live *live, cw_error *err)
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

/* Describes the buffers of vertices and triangles for drawing. */
static void make_array(cwi_live *live)
{
    const size_t NORMAL_OFFSET = 12; /* bytes: a position of three floats comes first */
    glGenVertexArrays(1, &live->array);
    glBindVertexArray(live->array);
    glBindBuffer(GL_ARRAY_BUFFER, live->buffers[CWI_LIVE_VERTICES]);
    for (GLuint n = 0; n < 2; n++) {
        glVertexAttribPointer(n, 3, GL_FLOAT, GL_FALSE, CWI_LIVE_VERTEX_BYTES,
                              (const void *)(n * NORMAL_OFFSET));
        glEnableVertexAttribArray(n);
    }
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, live->buffers[CWI_LIVE_INDICES]);
    glBindVertexArray(0);
}

cw_status cwi_live_make_buffers(cwi_live *live, cw_error *err)
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
        st = cwi_live_need(live, CWI_LIVE_SUMS, 8 * (blocks / CWI_LIVE_SCAN + 1), err);
    if (st == CW_OK)
        st = cwi_live_need(live, CWI_LIVE_MISSING, 16 * (size_t)CWI_LIVE_MENDED, err);
    if (st == CW_OK)
        st = cwi_live_fit_slots(live, err);
    if (st == CW_OK)
        make_array(live);
    return st;
}
