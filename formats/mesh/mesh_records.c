/* Writes the records of a mesh to a file: vertices, triangles, lines of text. */
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/base/thread_pool.h"
#include "formats/mesh/place_parts.h"
#include "formats/text/number_format.h"

#include <float.h>
#include <stdio.h>

enum { BATCH_RECORDS = 512, BATCHES = 4 }; /* BATCHES: for each thread */

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

static cw_status drain_bytes(const cwi_mesh_output *out, const void *bytes, size_t size,
                             cw_error *err)
{
    return out->drain ? out->drain(out->drain_to, bytes, size, err)
                      : cwi_outfile_write(out->file, bytes, size, err);
}

/* Batches of records that threads encode at the same time; they are written one after the other. */
typedef struct batches {
    const cwi_part *part;
    cwi_record_encoder *encode;
    size_t first, count; /* records of all batches */
    unsigned char *bytes;
    size_t *sizes; /* of each batch, encoded */
} batches;

static void encode_batch(void *context, size_t n)
{
    const batches *b = context;
    const size_t first = n * BATCH_RECORDS, end = least(first + BATCH_RECORDS, b->count);
    unsigned char *begin = b->bytes + n * BATCH_RECORDS * CWI_RECORD_BYTES, *to = begin;
    for (size_t i = first; i < end; i++)
        to = b->encode(b->part, b->first + i, to);
    b->sizes[n] = (size_t)(to - begin);
}

static cw_status write_batches(const batches *b, cwi_mesh_output *out, cw_error *err)
{
    enum { WORTH = 1 << 19 }; /* each is worth a thread */
    const size_t number = (b->count + BATCH_RECORDS - 1) / BATCH_RECORDS;
    cw_status st = CW_OK;
    cwi_parallel_for_all(number, WORTH, 0, encode_batch, (void *)b);
    for (size_t n = 0; n < number && st == CW_OK; n++)
        st =
            drain_bytes(out, b->bytes + n * BATCH_RECORDS * CWI_RECORD_BYTES, b->sizes[n], err);
    out->done += b->count;
    return st == CW_OK ? cwi_progress(out->progress, "writing",
                                      (double)out->done / (double)out->total, err)
                       : st;
}

/* Encodes `count` records of a part in memory, some batches a thread at a time. */
static cw_status write_held(const cwi_part *part, cwi_mesh_output *out,
                            cwi_record_encoder *encode, size_t count, cw_error *err)
{
    const size_t all = (count + BATCH_RECORDS - 1) / BATCH_RECORDS;
    const size_t number = least(all, BATCHES * (size_t)cwi_threads(0));
    batches b = {.part = part, .encode = encode};
    cw_status st = CW_OK;
    if (count == 0)
        return CW_OK;
    b.bytes = cwi_alloc_array(number, BATCH_RECORDS * CWI_RECORD_BYTES);
    b.sizes = cwi_alloc_array(number, sizeof *b.sizes);
    if (!b.bytes || !b.sizes)
        st = cwi_fail_memory(err);
    for (; b.first < count && st == CW_OK; b.first += b.count) {
        b.count = least(number * BATCH_RECORDS, count - b.first);
        st = write_batches(&b, out, err);
    }
    cwi_free(b.bytes);
    cwi_free(b.sizes);
    return st;
}

/* Returns the bytes of a record, of a format in which all have the same. */
static size_t measure_record(const cwi_part *part, cwi_record_encoder *encode)
{
    static float zeros[9];
    static uint32_t corners[3];
    unsigned char record[CWI_RECORD_BYTES];
    cwi_part piece = *part;
    piece.mesh.positions = zeros;
    piece.mesh.normals = cwi_spool_arrays(part->spool) & CW_KEEPS_NORMALS ? zeros : NULL;
    piece.mesh.triangles = corners;
    return (size_t)(encode(&piece, 0, record) - record);
}

/* Writes the records of a spool; of one that a team shares, those of this process at their
 * place. */
static cw_status write_spooled(const cwi_part *part, cwi_elements elements,
                               cwi_mesh_output *out, cwi_record_encoder *encode, cw_error *err)
{
    cwi_spool_reader reader;
    cw_status st = cwi_spool_open(&reader, part->spool, elements, err);
    const size_t all = reader.end, bytes = out->shared ? measure_record(part, encode) : 0;
    if (out->shared)
        cwi_spool_read_own(&reader);
    const size_t after = all - reader.end;
    if (st == CW_OK && out->shared)
        st = cwi_outfile_skip(out->file, reader.first * bytes, err);
    if (st == CW_OK)
        st = cwi_spool_next(&reader, err);
    while (st == CW_OK && reader.count) {
        cwi_part piece = *part;
        piece.mesh.positions = reader.mesh.positions;
        piece.mesh.normals = reader.mesh.normals;
        piece.mesh.triangles = reader.mesh.triangles;
        piece.first_triangle += elements == CWI_VERTICES ? 0 : reader.first;
        st = write_held(&piece, out, encode, reader.count, err);
        if (st == CW_OK)
            st = cwi_spool_next(&reader, err);
    }
    cwi_spool_close(&reader);
    return st == CW_OK && out->shared ? cwi_outfile_skip(out->file, after * bytes, err) : st;
}

cw_status cwi_write_records(const cwi_part *part, cwi_elements elements, cwi_mesh_output *out,
                            cwi_record_encoder *encode, cw_error *err)
{
    const cw_mesh *m = &part->mesh;
    return part->spool
               ? write_spooled(part, elements, out, encode, err)
               : write_held(part, out, encode,
                            elements == CWI_VERTICES ? m->vertex_count : m->triangle_count,
                            err);
}

static cw_status write_all_parts(const cwi_parts *parts, cwi_elements elements,
                                 cwi_mesh_output *out, cwi_record_encoder *encode,
                                 cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t i = 0; i < parts->count && st == CW_OK; i++)
        st = cwi_write_records(&parts->items[i], elements, out, encode, err);
    return st;
}

cw_status cwi_write_part_vertices(const cwi_parts *parts, cwi_mesh_output *out,
                                  cwi_record_encoder *encode, cw_error *err)
{
    return write_all_parts(parts, CWI_VERTICES, out, encode, err);
}

cw_status cwi_write_triangles(const cwi_parts *parts, cwi_mesh_output *out,
                              cwi_record_encoder *encode, cw_error *err)
{
    return write_all_parts(parts, CWI_TRIANGLES, out, encode, err);
}

cw_status cwi_write_facets(const cwi_parts *parts, cwi_mesh_output *out,
                           cwi_record_encoder *encode, cw_error *err)
{
    return write_all_parts(parts, CWI_FACETS, out, encode, err);
}

static cw_status check_single(const cwi_part *part, cw_error *err)
{
    double low[3], high[3];
    cwi_part_bounds(part, low, high);
    for (int a = 0; a < 3; a++)
        if (low[a] < -(double)FLT_MAX || high[a] > (double)FLT_MAX)
            return cwi_fail(
                err, CW_ERR_LIMIT,
                "the mesh stands at %g, which the format's single precision cannot hold",
                high[a]);
    return CW_OK;
}

cw_status cwi_check_single(const cwi_parts *parts, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t i = 0; i < parts->count && st == CW_OK; i++)
        st = check_single(&parts->items[i], err);
    return st;
}

void cwi_print_origin(const cwi_mesh_output *out, const char *before, const char *after,
                      char text[CWI_ORIGIN_BYTES])
{
    char point[CWI_POINT_BYTES];
    text[0] = '\0';
    if (!out->local_origin)
        return;
    cwi_print_point(out->local_origin, point);
    snprintf(text, CWI_ORIGIN_BYTES, "%s%s%s", before, point, after);
}
