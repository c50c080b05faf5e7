/* Writes glTF: a module makes the JSON, and the bytes are written separately, piece by
 * piece. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/base64.h"
#include "formats/gltf/gltf_formats.h"
#include "formats/gltf/gltf_pack.h"
#include "formats/gltf/gltf_wrap.h"

#include <stdio.h>

enum { CHUNK_BYTES = 3 << 14, GLB_HEADER = 12, CHUNK_HEADER = 8 };

/* --- the buffer's bytes ------------------------------------------------------------------- */

/* A pipe of bytes to the file: unchanged, or (text) as base64. */
typedef struct byte_pipe {
    cwi_mesh_output *out;
    bool text;
    size_t held;
    unsigned char bytes[CHUNK_BYTES];
} byte_pipe;

static cw_status flush_pipe(byte_pipe *p, cw_error *err)
{
    char text[CHUNK_BYTES / 3 * 4 + 4];
    const size_t size = p->text ? cwi_base64_encode(p->bytes, p->held, text) : p->held;
    cw_status st =
        cwi_outfile_write(p->out->file, p->text ? (void *)text : p->bytes, size, err);
    p->out->done += p->held;
    p->held = 0;
    return st == CW_OK ? cwi_progress(p->out->progress, "writing",
                                      (double)p->out->done / (double)p->out->total, err)
                       : st;
}

static cw_status push_bytes(byte_pipe *p, const unsigned char *bytes, size_t size,
                            cw_error *err)
{
    cw_status st = CW_OK;
    while (st == CW_OK && size > 0) {
        const size_t left = CHUNK_BYTES - p->held, step = size < left ? size : left;
        memcpy(p->bytes + p->held, bytes, step);
        p->held += step;
        bytes += step;
        size -= step;
        if (p->held == CHUNK_BYTES)
            st = flush_pipe(p, err);
    }
    return st;
}

static cw_status push_zeros(byte_pipe *p, size_t size, cw_error *err)
{
    static const unsigned char zeros[8];
    return push_bytes(p, zeros, size, err);
}

/* Leaves a gap for the elements of other processes. */
static cw_status skip_elements(byte_pipe *p, const cwi_gltf_array *a, size_t count,
                               cw_error *err)
{
    const size_t size = count * (size_t)a->stride;
    cw_status st = flush_pipe(p, err);
    p->out->done += size;
    return st == CW_OK ? cwi_outfile_skip(p->out->file, size, err) : st;
}

static cw_status push_elements(byte_pipe *p, const cwi_gltf_plan *plan,
                               const cwi_gltf_piece *piece, const cwi_gltf_array *a,
                               size_t count, cw_error *err)
{
    unsigned char element[16];
    cw_status st = CW_OK;
    for (size_t i = 0; st == CW_OK && i < count; i++) {
        cwi_gltf_put(plan, piece, a, i, element);
        st = push_bytes(p, element, (size_t)a->stride, err);
    }
    return st;
}

/* Reads a spool piece by piece; of one that a team shares, the piece of this process. */
static cw_status push_spooled(byte_pipe *p, const cwi_gltf_plan *plan,
                              const cwi_gltf_piece *whole, const cwi_gltf_array *a,
                              cw_error *err)
{
    const bool corners = a->use == CWI_GLTF_INDICES;
    cwi_spool_reader reader;
    cw_status st = cwi_spool_open(&reader, whole->part->spool,
                                  corners ? CWI_TRIANGLES : CWI_VERTICES, err);
    const size_t each = corners ? 3 : 1, all = reader.end;
    if (p->out->shared)
        cwi_spool_read_own(&reader);
    const size_t after = all - reader.end;
    if (st == CW_OK && p->out->shared)
        st = skip_elements(p, a, each * reader.first, err);
    if (st == CW_OK)
        st = cwi_spool_next(&reader, err);
    while (st == CW_OK && reader.count) {
        cwi_gltf_piece piece = *whole;
        cwi_part part = *whole->part;
        piece.part = &part;
        part.mesh.positions = reader.mesh.positions;
        part.mesh.normals = reader.mesh.normals;
        part.mesh.triangles = reader.mesh.triangles;
        st = push_elements(p, plan, &piece, a, each * reader.count, err);
        if (st == CW_OK)
            st = cwi_spool_next(&reader, err);
    }
    cwi_spool_close(&reader);
    return st == CW_OK && p->out->shared ? skip_elements(p, a, each * after, err) : st;
}

static cw_status push_array(byte_pipe *p, const cwi_gltf_plan *plan,
                            const cwi_gltf_piece *piece, const cwi_gltf_array *a, cw_error *err)
{
    cw_status st = piece->part->spool ? push_spooled(p, plan, piece, a, err)
                                      : push_elements(p, plan, piece, a, a->count, err);
    return st == CW_OK ? push_zeros(p, (size_t)(-(a->count * a->stride) % 4), err) : st;
}

static cw_status push_buffer(byte_pipe *p, const cwi_gltf_plan *plan, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t b = 0; st == CW_OK && b < plan->block_count; b++) {
        st = push_bytes(p, plan->blocks[b].bytes, plan->blocks[b].size, err);
        if (st == CW_OK)
            st = push_zeros(p, -plan->blocks[b].size % 8, err);
    }
    for (size_t n = 0; !plan->blocks && n < plan->parts.count; n++)
        for (size_t a = 0; st == CW_OK && a < plan->pieces[n].array_count; a++)
            st = push_array(p, plan, &plan->pieces[n], &plan->pieces[n].arrays[a], err);
    if (st == CW_OK)
        st = push_bytes(p, plan->keys, plan->keys_size, err);
    for (size_t n = 0; st == CW_OK && n < plan->document.image_count; n++) {
        const cw_texture *file = &plan->document.images[n].file;
        st = push_bytes(p, file->bytes, file->size, err);
        if (st == CW_OK)
            st = push_zeros(p, -file->size % 4, err);
    }
    return st == CW_OK ? flush_pipe(p, err) : st;
}

static cw_status write_buffer(const cwi_gltf_plan *plan, cwi_mesh_output *out, bool text,
                              cw_error *err)
{
    byte_pipe *p = cwi_alloc_zeroed(1, sizeof *p);
    if (!p)
        return cwi_fail_memory(err);
    p->out = out;
    p->text = text;
    cw_status st = push_buffer(p, plan, err);
    cwi_free(p);
    return st;
}

/* --- the file ----------------------------------------------------------------------------- */

/* Prints "buffers", which goes before the module's JSON; the module leaves it out, as it has no
 * bytes. The second buffer is that of meshopt's unpacked bytes, which no file has. */
static int print_buffers(const cwi_gltf_plan *plan, const char *uri, char *text, size_t size)
{
    const cwi_gltf_document *d = &plan->document;
    return snprintf(text, size, "{\"buffers\":[{\"byteLength\":%llu%s",
                    (unsigned long long)d->bytes, uri);
}

static int print_unpacked(const cwi_gltf_plan *plan, char *text, size_t size)
{
    const unsigned long long bytes = plan->document.unpacked;
    if (!bytes)
        return snprintf(text, size, "}],");
    return snprintf(text, size,
                    "},{\"byteLength\":%llu,\"extensions\":{\"EXT_meshopt_compression\":"
                    "{\"fallback\":true}}}],",
                    bytes);
}

static cw_status write_glb(const cwi_gltf_plan *plan, const char *json, size_t size,
                           cwi_mesh_output *out, cw_error *err)
{
    unsigned char header[GLB_HEADER + CHUNK_HEADER] = "glTF", chunk[CHUNK_HEADER];
    char first[128], second[160];
    const size_t a = (size_t)print_buffers(plan, "", first, sizeof first);
    const size_t b = (size_t)print_unpacked(plan, second, sizeof second);
    const size_t text = a + b + size - 1, padded = (text + 3) / 4 * 4;
    const uint32_t bytes = (uint32_t)plan->document.bytes;
    cwi_put_u32(header + 4, 2);
    cwi_put_u32(header + 8, (uint32_t)(sizeof header + padded + CHUNK_HEADER + bytes));
    cwi_put_u32(header + 12, (uint32_t)padded);
    memcpy(header + 16, "JSON", 4);
    cwi_put_u32(chunk, bytes);
    memcpy(chunk + 4, "BIN", 4);
    cw_status st = cwi_outfile_write(out->file, header, sizeof header, err);
    if (st == CW_OK)
        st = cwi_outfile_printf(out->file, err, "%s%s", first, second);
    if (st == CW_OK)
        st = cwi_outfile_write(out->file, json + 1, size - 1, err);
    if (st == CW_OK)
        st = cwi_outfile_write(out->file, "   ", padded - text, err);
    if (st == CW_OK)
        st = cwi_outfile_write(out->file, chunk, sizeof chunk, err);
    return st == CW_OK ? write_buffer(plan, out, false, err) : st;
}

static cw_status write_gltf(const cwi_gltf_plan *plan, const char *json, size_t size,
                            cwi_mesh_output *out, cw_error *err)
{
    static const char uri[] = ",\"uri\":\"data:application/octet-stream;base64,";
    char first[128], second[160];
    print_buffers(plan, uri, first, sizeof first);
    print_unpacked(plan, second, sizeof second);
    cw_status st = cwi_outfile_printf(out->file, err, "%s", first);
    if (st == CW_OK)
        st = write_buffer(plan, out, true, err);
    if (st == CW_OK)
        st = cwi_outfile_printf(out->file, err, "\"%s", second);
    return st == CW_OK ? cwi_outfile_write(out->file, json + 1, size - 1, err) : st;
}

static cw_status write_scene(const cwi_parts *parts, cwi_mesh_output *out, bool binary,
                             cw_error *err)
{
    cwi_gltf_plan plan = {0};
    char *json = NULL;
    size_t size = 0;
    cw_status st = cwi_gltf_plan_make(&plan, parts, out, err);
    if (st == CW_OK)
        st = cwi_gltf_make_json(&plan.document, &json, &size, err);
    out->total = plan.document.bytes ? (size_t)plan.document.bytes : 1;
    if (st == CW_OK)
        st = binary ? write_glb(&plan, json, size, out, err)
                    : write_gltf(&plan, json, size, out, err);
    cwi_free(json);
    cwi_gltf_plan_free(&plan);
    return st;
}

cw_status cwi_glb_write(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err)
{
    return write_scene(parts, out, true, err);
}

cw_status cwi_gltf_write(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err)
{
    return write_scene(parts, out, false, err);
}
