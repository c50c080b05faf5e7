/* Reads the surface of a spool back in chunks. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/mesh/mesh_spool.h"

/* Triangles of a chunk. */
enum { CHUNK = CWI_SPOOL_PIECE };

/* A spool on its way to a sink. */
typedef struct reading {
    const cw_mesh_spool *spool;
    size_t chunks;
    uint32_t *lowest; /* vertex that a chunk or a later one names */
    float *positions, *normals;
    size_t capacity; /* vertices */
    uint32_t triangles[3 * CHUNK];
} reading;

static size_t count_chunk(const reading *r, size_t chunk)
{
    const size_t left = cw_mesh_spool_frame(r->spool)->triangle_count - chunk * CHUNK;
    return left < CHUNK ? left : CHUNK;
}

/* Finds where the vertices of each chunk begin: none before is named again. */
static cw_status find_lowest(reading *r, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t c = 0; c < r->chunks && st == CW_OK; c++) {
        const size_t count = count_chunk(r, c);
        st = cwi_spool_read(r->spool, CWI_SPOOL_TRIANGLES, c * CHUNK, count, r->triangles, err);
        r->lowest[c] = UINT32_MAX;
        for (size_t n = 0; n < 3 * count && st == CW_OK; n++)
            r->lowest[c] = r->triangles[n] < r->lowest[c] ? r->triangles[n] : r->lowest[c];
    }
    for (size_t c = r->chunks; c-- > 1;)
        r->lowest[c - 1] = r->lowest[c] < r->lowest[c - 1] ? r->lowest[c] : r->lowest[c - 1];
    return st;
}

static cw_status reserve_vertices(reading *r, size_t count, cw_error *err)
{
    if (count <= r->capacity)
        return CW_OK;
    r->capacity = count + count / 2;
    cwi_free(r->positions);
    cwi_free(r->normals);
    r->positions = cwi_alloc_array(r->capacity, CWI_SPOOL_ELEMENT);
    r->normals = cwi_alloc_array(r->capacity, CWI_SPOOL_ELEMENT);
    return r->positions && r->normals ? CW_OK : cwi_fail_memory(err);
}

/* Gives away chunk c: its triangles, and the vertices from its lowest to that of the next. */
static cw_status give_chunk(reading *r, size_t c, cw_chunk_sink sink, cw_error *err)
{
    const cw_mesh *frame = cw_mesh_spool_frame(r->spool);
    const size_t first = c ? r->lowest[c] : 0,
                 end = c + 1 < r->chunks ? r->lowest[c + 1] : frame->vertex_count;
    cw_mesh_chunk chunk = {.mesh = *frame, .first_vertex = first, .first_triangle = c * CHUNK};
    cw_mesh *m = &chunk.mesh;
    m->vertex_count = end - first;
    m->triangle_count = count_chunk(r, c);
    cw_status st = reserve_vertices(r, m->vertex_count, err);
    m->positions = r->positions;
    m->triangles = r->triangles;
    m->normals = r->spool->has_normals ? r->normals : NULL;
    if (st == CW_OK)
        st = cwi_spool_read(r->spool, CWI_SPOOL_POSITIONS, first, m->vertex_count, m->positions,
                            err);
    if (st == CW_OK && m->normals)
        st = cwi_spool_read(r->spool, CWI_SPOOL_NORMALS, first, m->vertex_count, m->normals,
                            err);
    if (st == CW_OK)
        st = cwi_spool_read(r->spool, CWI_SPOOL_TRIANGLES, c * CHUNK, m->triangle_count,
                            m->triangles, err);
    return st == CW_OK ? sink.take(sink.user, &chunk, err) : st;
}

cw_status cw_mesh_spool_read(const cw_mesh_spool *spool, cw_chunk_sink sink, cw_error *err)
{
    CWI_REQUIRE(err, spool);
    reading *r = cwi_alloc_zeroed(1, sizeof *r);
    if (!r)
        return cwi_fail_memory(err);
    r->spool = spool;
    r->chunks = (cw_mesh_spool_frame(spool)->triangle_count + CHUNK - 1) / CHUNK;
    r->lowest = cwi_alloc_array(r->chunks, sizeof *r->lowest);
    cw_status st = r->lowest ? find_lowest(r, err) : cwi_fail_memory(err);
    for (size_t c = 0; c < r->chunks && st == CW_OK; c++)
        st = give_chunk(r, c, sink, err);
    cwi_free(r->positions);
    cwi_free(r->normals);
    cwi_free(r->lowest);
    cwi_free(r);
    return st;
}
