/* Writes the records of a mesh to a file: vertices, triangles, lines of text. */
#include "core/base/status.h"
#include "formats/mesh/place_parts.h"
#include "formats/text/number_format.h"

#include <float.h>
#include <stdio.h>

enum { PROGRESS_STEP = 65536, BATCH_BYTES = 16 << 10 };

static cw_status drain_bytes(const cwi_mesh_output *out, const void *bytes, size_t size,
                             cw_error *err)
{
    return out->drain ? out->drain(out->drain_to, bytes, size, err)
                      : cwi_outfile_write(out->file, bytes, size, err);
}

/* Encodes `count` records of a part in memory. */
static cw_status write_held(const cwi_part *part, cwi_mesh_output *out,
                            cwi_record_encoder *encode, size_t count, cw_error *err)
{
    unsigned char batch[BATCH_BYTES], *to = batch;
    cw_status st = CW_OK;
    for (size_t i = 0; i < count && st == CW_OK; i++) {
        to = encode(part, i, to);
        if (to > batch + BATCH_BYTES - CWI_RECORD_BYTES || i + 1 == count) {
            st = drain_bytes(out, batch, (size_t)(to - batch), err);
            to = batch;
        }
        if (st == CW_OK && out->done++ % PROGRESS_STEP == 0)
            st = cwi_progress(out->progress, "writing", (double)out->done / (double)out->total,
                              err);
    }
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
