/* Fragments: files with a part of a surface each, between its extraction and the join of all parts.
 *
 * A header of HEADER_BYTES, little-endian; positions, normals (if there are any) and triangles, 12
 * bytes each; the CRC-32 of all that. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/files/atomic_file.h"
#include "formats/bytes/input_file.h"
#include "formats/bytes/little_endian.h"
#include "formats/mesh/mesh_spool.h"

#include <math.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

enum { HEADER_BYTES = 192, ELEMENT_BYTES = 12, PIECE = 16384, CHECKSUM_BYTES = 4 };
enum { HAS_NORMALS = 1, HAS_INSIDE = 2, HAS_OUTSIDE = 4 };
static const char magic[8] = "CWPART1\n";

/* --- writing -------------------------------------------------------------------------------- */

/* A file, and the checksum of what it holds. */
typedef struct checked_file {
    cwi_outfile *file;
    uint32_t sum;
} checked_file;

static cw_status put_bytes(checked_file *f, const void *bytes, size_t size, cw_error *err)
{
    f->sum = (uint32_t)crc32(f->sum, bytes, (uInt)size);
    return cwi_outfile_write(f->file, bytes, size, err);
}

static unsigned char *put_doubles(unsigned char *to, const double *x, size_t count)
{
    for (size_t n = 0; n < count; n++) {
        uint64_t bits;
        memcpy(&bits, x + n, sizeof bits);
        to = cwi_put_u64(to, bits);
    }
    return to;
}

static cw_status put_header(checked_file *f, const cw_fragment *fragment,
                            const cw_mesh_spool *spool, cw_error *err)
{
    const cw_mesh *frame = cw_mesh_spool_frame(spool);
    unsigned char header[HEADER_BYTES] = {0}, *to = header + sizeof magic;
    const uint64_t flags = (cwi_spool_arrays(spool) & CW_KEEPS_NORMALS ? HAS_NORMALS : 0u) |
                           (fragment->counts.has_inside ? HAS_INSIDE : 0u) |
                           (fragment->counts.has_outside ? HAS_OUTSIDE : 0u);
    memcpy(header, magic, sizeof magic);
    to = cwi_put_u64(to, fragment->job);
    to = cwi_put_u64(to, fragment->part);
    to = cwi_put_u64(to, fragment->parts);
    to = cwi_put_u64(to, frame->vertex_count);
    to = cwi_put_u64(to, frame->triangle_count);
    to = cwi_put_u64(to, flags);
    to = put_doubles(to, frame->origin, 3);
    put_doubles(to, frame->affine[0], 12);
    return put_bytes(f, header, sizeof header, err);
}

typedef enum array { POSITIONS, NORMALS, TRIANGLES } array;

static cw_status put_array(checked_file *f, const cw_mesh_spool *spool, array which,
                           cw_error *err)
{
    cwi_spool_reader r;
    cw_status st =
        cwi_spool_open(&r, spool, which == TRIANGLES ? CWI_TRIANGLES : CWI_VERTICES, err);
    r.is_part = true;
    if (st == CW_OK)
        st = cwi_spool_next(&r, err);
    while (st == CW_OK && r.count) {
        const void *elements = which == TRIANGLES ? (void *)r.mesh.triangles
                               : which == NORMALS ? r.mesh.normals
                                                  : r.mesh.positions;
        st = put_bytes(f, elements, r.count * ELEMENT_BYTES, err);
        if (st == CW_OK)
            st = cwi_spool_next(&r, err);
    }
    cwi_spool_close(&r);
    return st;
}

cw_status cw_fragment_write(const char *path, const cw_fragment *fragment,
                            const cw_mesh_spool *spool, cw_error *err)
{
    CWI_REQUIRE(err, path, fragment, spool);
    checked_file f = {0};
    unsigned char sum[CHECKSUM_BYTES];
    cw_status st = cwi_outfile_open(&f.file, path, false, err);
    if (st == CW_OK)
        st = put_header(&f, fragment, spool, err);
    if (st == CW_OK)
        st = put_array(&f, spool, POSITIONS, err);
    if (st == CW_OK && cwi_spool_arrays(spool) & CW_KEEPS_NORMALS)
        st = put_array(&f, spool, NORMALS, err);
    if (st == CW_OK)
        st = put_array(&f, spool, TRIANGLES, err);
    cwi_put_u32(sum, f.sum);
    if (st == CW_OK)
        st = cwi_outfile_write(f.file, sum, sizeof sum, err);
    if (st == CW_OK)
        st = cwi_outfile_commit(&f.file, err);
    cwi_outfile_abort(&f.file);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}

/* --- reading -------------------------------------------------------------------------------- */

/* An open fragment, read from its start to its end. */
typedef struct opened {
    cwi_input in;
    cw_fragment facts;
    cw_mesh frame; /* counts, origin, affine */
    bool has_normals;
    uint64_t at;  /* of the arrays */
    uint32_t sum; /* of the header */
} opened;

static uint64_t get_u64(const unsigned char *from)
{
    uint64_t x = 0;
    for (int b = 7; b >= 0; b--)
        x = x << 8 | from[b];
    return x;
}

static void get_doubles(const unsigned char *from, double *x, size_t count)
{
    for (size_t n = 0; n < count; n++) {
        const uint64_t bits = get_u64(from + 8 * n);
        memcpy(x + n, &bits, sizeof bits);
    }
}

static cw_status read_bytes(const opened *o, uint64_t at, void *to, size_t size, cw_error *err)
{
    size_t got;
    cw_status st = cwi_input_read_at(o->in.fd, at, to, size, &got, err);
    return st == CW_OK && got < size
               ? cwi_fail(err, CW_ERR_FORMAT, "the fragment ends at byte %llu",
                          (unsigned long long)(at + got))
               : st;
}

static cw_status read_header(opened *o, cw_error *err)
{
    unsigned char header[HEADER_BYTES];
    const unsigned char *from = header + sizeof magic;
    uint64_t numbers[6];
    if (o->in.size < HEADER_BYTES + CHECKSUM_BYTES)
        return cwi_fail(err, CW_ERR_FORMAT, "this is no fragment: it has %llu bytes",
                        (unsigned long long)o->in.size);
    cw_status st = read_bytes(o, 0, header, sizeof header, err);
    if (st == CW_OK && memcmp(header, magic, sizeof magic) != 0)
        st = cwi_fail(err, CW_ERR_FORMAT, "this is no fragment of a surface");
    if (st != CW_OK)
        return st;
    for (int n = 0; n < 6; n++)
        numbers[n] = get_u64(from + 8 * n);
    get_doubles(from + 48, o->frame.origin, 3);
    get_doubles(from + 72, o->frame.affine[0], 12);
    o->facts = (cw_fragment){.job = numbers[0],
                             .part = (size_t)numbers[1],
                             .parts = (size_t)numbers[2],
                             .counts = {.vertices = (size_t)numbers[3],
                                        .triangles = (size_t)numbers[4],
                                        .has_inside = numbers[5] & HAS_INSIDE,
                                        .has_outside = numbers[5] & HAS_OUTSIDE}};
    o->has_normals = numbers[5] & HAS_NORMALS;
    o->at = HEADER_BYTES;
    o->sum = (uint32_t)crc32(0, header, HEADER_BYTES);
    const uint64_t max = UINT64_C(1) << 40; /* elements, so that no product overflows */
    const uint64_t elements = numbers[3] > max || numbers[4] > max
                                  ? max * max
                                  : numbers[3] * (o->has_normals ? 2 : 1) + numbers[4];
    if (numbers[3] > UINT32_MAX || elements > max ||
        o->in.size != HEADER_BYTES + elements * ELEMENT_BYTES + CHECKSUM_BYTES)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the fragment has %llu bytes, which its counts (%llu vertices, %llu "
                        "triangles) do not ask for",
                        (unsigned long long)o->in.size, (unsigned long long)numbers[3],
                        (unsigned long long)numbers[4]);
    bool is_finite = true;
    for (int n = 0; n < 12; n++)
        is_finite = is_finite && isfinite(o->frame.affine[n / 4][n % 4]) &&
                    isfinite(o->frame.origin[n % 3]);
    if (!is_finite)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the fragment's origin or affine has a number that is not finite");
    return CW_OK;
}

static cw_status open_fragment(opened *o, const char *path, cw_error *err)
{
    *o = (opened){.in = {.allow_external = true}};
    cw_status st = cwi_input_open(&o->in, path, err);
    if (st != CW_OK)
        return st;
    st = read_header(o, err);
    if (st != CW_OK)
        cwi_input_close(&o->in);
    return st;
}

cw_status cw_fragment_read(const char *path, cw_fragment *fragment, cw_error *err)
{
    CWI_REQUIRE(err, path, fragment);
    opened o;
    cw_status st = open_fragment(&o, path, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, path);
    *fragment = o.facts;
    cwi_input_close(&o.in);
    return CW_OK;
}

/* Reads `count` elements of an array from element `first` on. The array begins at element `before`
 * of all. */
static cw_status read_elements(const opened *o, uint64_t before, size_t first, size_t count,
                               void *to, cw_error *err)
{
    return read_bytes(o, o->at + (before + first) * ELEMENT_BYTES, to, count * ELEMENT_BYTES,
                      err);
}

/* Reads all arrays in the order of the file, for the checksum. */
static cw_status verify_sum(const opened *o, void *buffer, cw_error *err)
{
    unsigned char stored[CHECKSUM_BYTES];
    const uint64_t end = o->in.size - CHECKSUM_BYTES;
    const size_t max = (size_t)PIECE * ELEMENT_BYTES;
    uint32_t sum = o->sum;
    cw_status st = read_bytes(o, end, stored, sizeof stored, err);
    for (uint64_t at = o->at; at < end && st == CW_OK;) {
        const size_t size = end - at < max ? (size_t)(end - at) : max;
        st = read_bytes(o, at, buffer, size, err);
        sum = (uint32_t)crc32(sum, buffer, (uInt)size);
        at += size;
    }
    unsigned char made[CHECKSUM_BYTES];
    cwi_put_u32(made, sum);
    return st == CW_OK && memcmp(made, stored, sizeof made) != 0
               ? cwi_fail(err, CW_ERR_FORMAT,
                          "the fragment is damaged: its checksum is not that of its data")
               : st;
}

/* Fails for a position that is not finite. */
static cw_status check_positions(const float *positions, size_t first, size_t count,
                                 cw_error *err)
{
    for (size_t n = 0; n < 3 * count; n++)
        if (!isfinite(positions[n]))
            return cwi_fail(err, CW_ERR_FORMAT, "the position of vertex %zu is not finite",
                            first + n / 3);
    return CW_OK;
}

/* Adds `base` to corners, each of which must be below `vertices`. */
static cw_status shift_corners(uint32_t *corners, size_t first, size_t count, size_t vertices,
                               uint32_t base, cw_error *err)
{
    for (size_t n = 0; n < 3 * count; n++) {
        if (corners[n] >= vertices)
            return cwi_fail(err, CW_ERR_FORMAT, "triangle %zu names vertex %u of %zu",
                            first + n / 3, corners[n], vertices);
        corners[n] += base;
    }
    return CW_OK;
}

/* Gives the vertices, and then the triangles, to the spool's sink. */
static cw_status append_arrays(const opened *o, cw_mesh_spool *spool, cw_mesh *piece,
                               cw_error *err)
{
    const cw_chunk_sink sink = cw_mesh_spool_sink(spool);
    const size_t vertices = o->facts.counts.vertices, triangles = o->facts.counts.triangles;
    const uint64_t normals = o->has_normals ? vertices : 0;
    const cw_mesh *frame = cw_mesh_spool_frame(spool);
    const size_t base = frame->vertex_count;
    /* Triangles on the seam name vertices of the next part, which the last part lacks. */
    const bool is_last = o->facts.part + 1 == o->facts.parts;
    const size_t named = is_last ? vertices : UINT32_MAX - base;
    cw_mesh_chunk chunk = {.mesh = *piece};
    cw_status st = CW_OK;
    for (size_t first = 0; first < vertices && st == CW_OK; first += PIECE) {
        const size_t count = vertices - first < PIECE ? vertices - first : PIECE;
        st = read_elements(o, 0, first, count, piece->positions, err);
        if (st == CW_OK)
            st = check_positions(piece->positions, first, count, err);
        if (st == CW_OK && piece->normals)
            st = read_elements(o, vertices, first, count, piece->normals, err);
        chunk.first_vertex = frame->vertex_count;
        chunk.first_triangle = frame->triangle_count;
        chunk.mesh.vertex_count = count;
        chunk.mesh.triangle_count = 0;
        if (st == CW_OK)
            st = sink.take(sink.user, &chunk, err);
    }
    for (size_t first = 0; first < triangles && st == CW_OK; first += PIECE) {
        const size_t count = triangles - first < PIECE ? triangles - first : PIECE;
        st = read_elements(o, vertices + normals, first, count, piece->triangles, err);
        if (st == CW_OK)
            st = shift_corners(piece->triangles, first, count, named, (uint32_t)base, err);
        chunk.first_vertex = frame->vertex_count;
        chunk.first_triangle = frame->triangle_count;
        chunk.mesh.vertex_count = 0;
        chunk.mesh.triangle_count = count;
        if (st == CW_OK)
            st = sink.take(sink.user, &chunk, err);
    }
    return st;
}

static cw_status append_opened(const opened *o, cw_mesh_spool *spool, cw_error *err)
{
    const cw_mesh *frame = cw_mesh_spool_frame(spool);
    const size_t before = frame->vertex_count;
    cw_mesh piece = o->frame;
    if (before && o->facts.counts.vertices &&
        (memcmp(frame->origin, piece.origin, sizeof piece.origin) != 0 ||
         memcmp(frame->affine, piece.affine, sizeof piece.affine) != 0))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the fragment's origin or affine is not that of the parts before it");
    if (before + o->facts.counts.vertices > UINT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "the surface has more than %u vertices, which is what a mesh holds",
                        UINT32_MAX);
    piece.positions = cwi_alloc_array(PIECE, ELEMENT_BYTES);
    piece.normals = o->has_normals ? cwi_alloc_array(PIECE, ELEMENT_BYTES) : NULL;
    piece.triangles = cwi_alloc_array(PIECE, ELEMENT_BYTES);
    cw_status st = CW_OK;
    if (!piece.positions || !piece.triangles || (o->has_normals && !piece.normals))
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        st = verify_sum(o, piece.positions, err);
    if (st == CW_OK)
        st = append_arrays(o, spool, &piece, err);
    cwi_free(piece.positions);
    cwi_free(piece.normals);
    cwi_free(piece.triangles);
    return st;
}

cw_status cw_fragment_append(const char *path, cw_mesh_spool *spool, cw_error *err)
{
    CWI_REQUIRE(err, path, spool);
    opened o;
    cw_status st = open_fragment(&o, path, err);
    if (st == CW_OK) {
        st = append_opened(&o, spool, err);
        cwi_input_close(&o.in);
    }
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}
