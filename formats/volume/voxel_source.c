/* Reads voxels from files as a source describes them: checks sizes first, then decodes all or a
 * region. */
#define _GNU_SOURCE /* close */
#include "formats/volume/voxel_source.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/geometry/affine.h"
#include "core/volume/volume.h"
#include "formats/bytes/bzip2.h"
#include "formats/bytes/inflate_stream.h"
#include "formats/text/ascii_voxels.h"
#include "formats/volume/region_runs.h"
#include "formats/volume/slice_visit.h"

#include <assert.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

enum { SLAB_BYTES = 1 << 20, MAX_COMPONENTS = 16 };

static const char *name_source(const cwi_source *src)
{
    return src->noun ? src->noun : "voxels";
}

cw_status cwi_fail_type(cw_error *err, const char *field, const char *name)
{
#define NAME(constant, ctype, text) " " text
    return cwi_fail(err, CW_ERR_FORMAT,
                    "'%s' is %.60s; the types that are read are" CW_TYPE_TABLE(NAME), field,
                    name);
#undef NAME
}

bool cwi_machine_is_big_endian(void)
{
    const uint16_t one = 1;
    return *(const unsigned char *)&one == 0;
}

void cwi_flip_ras(double affine[3][4])
{
    for (int r = 0; r < 2; r++)
        for (int c = 0; c < 4; c++)
            affine[r][c] = 0.0 - affine[r][c]; /* no negative zeros */
}

static bool is_zero_column(double affine[3][4], int c)
{
    return affine[0][c] == 0 && affine[1][c] == 0 && affine[2][c] == 0;
}

void cwi_fill_columns(double affine[3][4])
{
    for (int c = 0; c < 3; c++) {
        const int a = (c + 1) % 3, b = (c + 2) % 3;
        if (!is_zero_column(affine, c))
            continue;
        double normal[3];
        for (int r = 0; r < 3; r++)
            normal[r] = affine[(r + 1) % 3][a] * affine[(r + 2) % 3][b] -
                        affine[(r + 2) % 3][a] * affine[(r + 1) % 3][b];
        const double length = hypot(hypot(normal[0], normal[1]), normal[2]);
        for (int r = 0; r < 3 && length > 0; r++)
            affine[r][c] = normal[r] / length;
    }
}

void cwi_swap_bytes(void *numbers, size_t count, size_t size)
{
    uint16_t *u16 = numbers;
    uint32_t *u32 = numbers;
    uint64_t *u64 = numbers;
    for (size_t i = 0; size == 2 && i < count; i++)
        u16[i] = __builtin_bswap16(u16[i]);
    for (size_t i = 0; size == 4 && i < count; i++)
        u32[i] = __builtin_bswap32(u32[i]);
    for (size_t i = 0; size == 8 && i < count; i++)
        u64[i] = __builtin_bswap64(u64[i]);
}

void cwi_source_free(cwi_source *src)
{
    cwi_names_free(&src->files);
    cwi_free(src->shape.owned_grid);
    *src = (cwi_source){0};
}

cw_status cwi_source_set_axes(cwi_source *src, const cwi_axis *axes, size_t count,
                              cw_error *err)
{
    const size_t voxel = cw_type_size(src->shape.type);
    size_t sizes[CWI_ROLE_COUNT] = {1, 1, 1, 1, 1}, strides[CWI_ROLE_COUNT] = {0};
    size_t bytes = voxel;
    assert(count <= CWI_ROLE_COUNT);
    src->axis_count = count;
    for (size_t i = 0; i < count; i++) {
        src->axes[i] = axes[i];
        sizes[axes[i].role] = axes[i].size;
        strides[axes[i].role] = bytes;
        if (!cwi_size_mul(bytes, axes[i].size, &bytes) || bytes > PTRDIFF_MAX)
            return cwi_fail(err, CW_ERR_LIMIT,
                            "'%s' asks for more %s than an address space holds",
                            src->size_field, name_source(src));
    }
    if (sizes[CWI_AXIS_COMPONENT] > MAX_COMPONENTS)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'%s' asks for %zu values per voxel; at most %d are read",
                        src->size_field, sizes[CWI_AXIS_COMPONENT], MAX_COMPONENTS);
    for (int r = 0; r < CWI_ROLE_COUNT; r++) /* never used as a step, but as in packed data */
        if (strides[r] == 0)
            strides[r] = r == CWI_AXIS_COMPONENT ? voxel : bytes;
    cw_volume *v = &src->shape;
    for (int a = 0; a < 3; a++) {
        v->dim[a] = sizes[a];
        v->stride[a] = (ptrdiff_t)strides[a];
    }
    v->components = sizes[CWI_AXIS_COMPONENT];
    v->component_stride = (ptrdiff_t)strides[CWI_AXIS_COMPONENT];
    v->steps = sizes[CWI_AXIS_STEP];
    v->step_stride = (ptrdiff_t)strides[CWI_AXIS_STEP];
    src->bytes = bytes;
    return CW_OK;
}

/* Limits lengths: vertices are written as 32-bit floats in places, and products of three
 * lengths are taken. */
static bool is_moderate(double x)
{
    return fabs(x) < 1e30;
}

cw_status cwi_check_frame(const cw_volume *v, const char *field, cw_error *err)
{
    double unit[3][4] = {{0}};
    for (int c = 0; c < 4; c++) {
        const double length = hypot(hypot(v->affine[0][c], v->affine[1][c]), v->affine[2][c]);
        if (!is_moderate(length * (c < 3 ? (double)v->dim[c] : 1.0)))
            return cwi_fail(err, CW_ERR_FORMAT,
                            "'%s' has numbers that are not finite or too large", field);
        if (c < 3 && !(length > 1e-30))
            return cwi_fail(err, CW_ERR_FORMAT, "'%s' gives axis %d no length", field, c);
        for (int r = 0; r < 3; r++)
            unit[r][c] = v->affine[r][c] / length;
    }
    const double volume = cwi_affine_determinant(unit[0]);
    if (!(fabs(volume) > 1e-6))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'%s' gives directions that lie in one plane (determinant %g)", field,
                        volume);
    return CW_OK;
}

/* An open file with voxels. */
typedef struct part {
    int fd;
    uint64_t size;  /* of the file; less where the voxels end earlier */
    uint64_t start; /* of the (encoded) voxels in it */
    bool own;       /* fd is closed together with the part */
} part;

static size_t share_bytes(const cwi_source *src)
{
    return src->files.count ? src->bytes / src->files.count : src->bytes;
}

/* Moves *start behind the lines to leave out. */
static cw_status skip_lines(const part *p, uint64_t lines, uint64_t *start, cw_error *err)
{
    char text[4096];
    size_t got = 0, used = 0;
    for (uint64_t line = 0; line < lines; used++, *start += 1) {
        if (used == got) {
            cw_status st = cwi_input_read_at(p->fd, *start, text, sizeof text, &got, err);
            if (st != CW_OK)
                return st;
            if (got == 0)
                return cwi_fail(err, CW_ERR_FORMAT,
                                "the file has %llu lines; %llu are to be skipped",
                                (unsigned long long)line, (unsigned long long)lines);
            used = 0;
        }
        line += text[used] == '\n';
    }
    return CW_OK;
}

/* Returns the bytes to skip after decoding. */
static uint64_t decoded_skip(const cwi_source *src)
{
    const bool packed = src->encoding == CWI_DEFLATED || src->encoding == CWI_BZIP2;
    return packed || src->base64 ? src->skip : 0;
}

/* Returns the bytes of the file, or the maximum that base64 text of that size can hold. */
static uint64_t bytes_of_text(const cwi_source *src, uint64_t encoded)
{
    return src->base64 ? encoded / 4 * 3 + encoded % 4 : encoded;
}

/* Returns the maximum of voxel bytes that the encoded bytes in the file can stand for. Deflate
 * expands data at most 1032 times, bzip2 by its blocks. A number and its blank take two bytes;
 * the last may lack the blank. For CWI_BLOCKS the table states the sizes. */
static uint64_t most_bytes(const cwi_source *src, uint64_t encoded)
{
    const uint64_t voxel = cw_type_size(src->shape.type);
    const uint64_t most = src->encoding == CWI_ASCII   ? voxel
                          : src->encoding == CWI_BZIP2 ? CWI_BZIP2_BLOCK / CWI_BZIP2_PACKED
                                                       : 1032;
    encoded = bytes_of_text(src, encoded);
    if (src->encoding == CWI_RAW || src->encoding == CWI_HEX)
        return src->encoding == CWI_HEX ? encoded / 2 : encoded;
    if (src->encoding == CWI_ASCII)
        encoded = encoded / 2 + 1;
    return encoded > UINT64_MAX / most ? UINT64_MAX : encoded * most;
}

static cw_status check_share(const cwi_source *src, part *p, cw_error *err)
{
    const size_t share = share_bytes(src);
    uint64_t wanted;
    if (src->at_end)
        p->start = p->size > share ? p->size - share : 0;
    const uint64_t encoded = p->size > p->start ? p->size - p->start : 0;
    if (!__builtin_add_overflow(decoded_skip(src), share, &wanted) &&
        wanted <= most_bytes(src, encoded))
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "'%s' asks for %zu bytes of %s%s%s; the file holds %llu bytes behind the "
                    "first %llu",
                    src->size_field, share, name_source(src),
                    src->encoding == CWI_RAW ? "" : ", encoded",
                    src->files.count > 1 ? " in each file" : "", (unsigned long long)encoded,
                    (unsigned long long)p->start);
}

/* Opens a stream over the encoded voxels of a part, and the table of their blocks, if any.
 * Close both in any case. */
static cw_status open_stream(const cwi_source *src, const part *p, cwi_stream *stream,
                             cwi_packed_blocks *blocks, cw_error *err)
{
    cw_status st =
        src->encoding == CWI_BZIP2
            ? cwi_stream_open_bzip2(stream, p->fd, p->start, err)
            : cwi_stream_open(stream, p->fd, p->start, src->encoding == CWI_DEFLATED, err);
    if (st != CW_OK)
        return st;
    cwi_stream_end_at(stream, p->size);
    if (src->base64)
        st = cwi_stream_from_base64(stream, err);
    if (src->encoding == CWI_HEX)
        st = cwi_stream_from_hex(stream, err);
    if (st == CW_OK)
        st = cwi_stream_skip(stream, decoded_skip(src), err);
    if (st == CW_OK && src->encoding == CWI_BLOCKS)
        st = cwi_blocks_open(blocks, stream, &src->blocks, share_bytes(src),
                             bytes_of_text(src, p->size - p->start), err);
    return st;
}

/* Checks a table of blocks, which states sizes more precisely than the size of the file. */
static cw_status check_blocks(const cwi_source *src, const part *p, cw_error *err)
{
    cwi_stream stream = {0};
    cwi_packed_blocks blocks = {0};
    if (src->encoding != CWI_BLOCKS)
        return CW_OK;
    cw_status st = open_stream(src, p, &stream, &blocks, err);
    cwi_blocks_close(&blocks);
    cwi_stream_close(&stream);
    return st;
}

static void close_part(part *p)
{
    if (p->own)
        close(p->fd);
    *p = (part){0};
}

static const char *part_name(const cwi_source *src, size_t index)
{
    return src->files.count ? src->files.items[index] : NULL;
}

static cw_status open_part(const cwi_source *src, const cwi_input *in, size_t index, part *p,
                           cw_error *err)
{
    const char *name = part_name(src, index);
    *p = (part){.fd = in->fd, .size = in->size, .start = src->offset};
    cw_status st = name ? cwi_input_open_side(in, name, &p->fd, &p->size, err) : CW_OK;
    p->own = name && st == CW_OK;
    if (st == CW_OK)
        st = skip_lines(p, src->lines, &p->start, err);
    if (__builtin_add_overflow(p->start, src->skip - decoded_skip(src), &p->start))
        p->start = UINT64_MAX;
    if (src->span && p->start < p->size && src->span < p->size - p->start)
        p->size = p->start + src->span;
    if (st == CW_OK && src->packed > p->size - (p->start < p->size ? p->start : p->size))
        st = cwi_fail(err, CW_ERR_FORMAT,
                      "'CompressedDataSize' is %llu; the file holds %llu bytes",
                      (unsigned long long)src->packed,
                      (unsigned long long)(p->start < p->size ? p->size - p->start : 0));
    if (st == CW_OK)
        st = check_share(src, p, err);
    if (st == CW_OK)
        st = check_blocks(src, p, err);
    if (st != CW_OK)
        close_part(p);
    return st;
}

/* The state of reading all parts, and of the open one. */
typedef struct reading {
    const cwi_source *src;
    const cw_progress *progress;
    cwi_runs runs;     /* the wanted bytes */
    uint64_t at;       /* offset among the bytes of all voxels */
    unsigned char *to; /* destination of the next wanted bytes */
    cwi_stream stream;
    cwi_packed_blocks blocks;
    cwi_numbers numbers;
} reading;

/* Decodes whole blocks directly to their place. Their ends need not be those of voxels. */
static cw_status take_blocks(reading *r, size_t most, size_t *got, cw_error *err)
{
    const size_t voxel = cw_type_size(r->src->shape.type);
    size_t n = 0;
    cw_status st = CW_OK;
    for (*got = 0; st == CW_OK && (*got == 0 || *got % voxel); *got += n)
        st = cwi_blocks_some(&r->blocks, r->to + *got, most - *got, &n, err);
    return st;
}

/* Reads the next voxels to their place: a portion of at most `most` bytes. */
static cw_status take_bytes(reading *r, size_t most, size_t *got, cw_error *err)
{
    const cwi_source *src = r->src;
    const size_t voxel = cw_type_size(src->shape.type);
    cw_status st;
    *got = most < SLAB_BYTES ? most : SLAB_BYTES;
    if (src->encoding == CWI_ASCII)
        return cwi_numbers_read(&r->numbers, src->shape.type, r->to, *got / voxel, err);
    if (src->encoding == CWI_BLOCKS)
        st = take_blocks(r, most, got, err);
    else
        st = cwi_stream_read(&r->stream, r->to, *got, err);
    if (st == CW_OK && src->big_endian != cwi_machine_is_big_endian())
        cwi_swap_bytes(r->to, *got / voxel, voxel);
    return st;
}

/* Skips the next voxels: a portion of at most `most` bytes. */
static cw_status drop_bytes(reading *r, uint64_t most, size_t *got, cw_error *err)
{
    const cw_type type = r->src->shape.type;
    *got = most < SLAB_BYTES ? (size_t)most : SLAB_BYTES;
    if (r->src->encoding == CWI_ASCII)
        return cwi_numbers_read(&r->numbers, type, NULL, *got / cw_type_size(type), err);
    if (r->src->encoding != CWI_BLOCKS)
        return cwi_stream_skip(&r->stream, *got, err);
    cwi_blocks_skip(&r->blocks, *got);
    return CW_OK;
}

/* Reads or skips the next bytes of the part, portion by portion. */
static cw_status pass_bytes(reading *r, uint64_t bytes, bool wanted, cw_error *err)
{
    cw_status st = CW_OK;
    while (st == CW_OK && bytes > 0) {
        size_t n = 0;
        st = cwi_progress(r->progress, "reading", (double)r->at / (double)r->runs.end, err);
        if (st == CW_OK)
            st = wanted ? take_bytes(r, (size_t)bytes, &n, err) : drop_bytes(r, bytes, &n, err);
        r->at += n;
        bytes -= n;
        if (wanted)
            r->to += n;
    }
    return st;
}

/* Checks if compressed data end later than the header states. A stated end that is too far is
 * accepted: there is only padding. So is one that is too near in a file of voxels alone, whose
 * checksum proves it complete: VTK's sample frogtissue.mhd names 260 020 of 262 087 bytes. */
static cw_status check_packed(const reading *r, uint64_t start, cw_error *err)
{
    const cwi_stream *s = &r->stream;
    if (!r->src->packed || r->src->files.count || !s->ended || s->truncated ||
        s->packed_end - start <= r->src->packed)
        return CW_OK;
    return cwi_fail(
        err, CW_ERR_FORMAT, "'CompressedDataSize' is %llu; the compressed data take %llu bytes",
        (unsigned long long)r->src->packed, (unsigned long long)(s->packed_end - start));
}

/* Reads the wanted bytes of a part that ends at this offset of all. Bytes behind the last
 * wanted one are not read, so the checksum is verified only where the part was read to its
 * end. */
static cw_status read_runs(reading *r, uint64_t end, cw_error *err)
{
    cw_status st = CW_OK;
    while (st == CW_OK && r->runs.left > 0 && r->runs.next < end) {
        const uint64_t rest = end - r->runs.next;
        const uint64_t bytes = r->runs.left < rest ? r->runs.left : rest;
        st = pass_bytes(r, r->runs.next - r->at, false, err);
        if (st == CW_OK)
            st = pass_bytes(r, bytes, true, err);
        cwi_runs_take(&r->runs, bytes);
    }
    return st == CW_OK && r->at == end ? cwi_stream_finish(&r->stream, err) : st;
}

static cw_status read_part(reading *r, const part *p, size_t index, cw_error *err)
{
    const uint64_t share = share_bytes(r->src);
    r->at = index * share;
    r->numbers = (cwi_numbers){.stream = &r->stream, .noun = name_source(r->src)};
    cw_status st = open_stream(r->src, p, &r->stream, &r->blocks, err);
    if (st == CW_OK)
        st = read_runs(r, r->at + share, err);
    if (st == CW_OK)
        st = check_packed(r, p->start, err);
    cwi_blocks_close(&r->blocks);
    cwi_stream_close(&r->stream);
    return st;
}

static bool has_wanted(const reading *r, size_t index)
{
    return r->runs.left > 0 && r->runs.next / share_bytes(r->src) == index;
}

/* Opens every part and checks it, or opens the parts with wanted voxels, and reads them. A
 * header may name more files than a program may keep open. So they are opened again for
 * reading, and checked again. */
static cw_status walk_parts(const cwi_source *src, const cwi_input *in, reading *r,
                            cw_error *err)
{
    const size_t count = src->files.count ? src->files.count : 1;
    cw_status st = CW_OK;
    for (size_t i = 0; st == CW_OK && i < count; i++) {
        part p;
        if (r && !has_wanted(r, i))
            continue;
        st = open_part(src, in, i, &p, err);
        if (st == CW_OK && r)
            st = read_part(r, &p, i, err);
        close_part(&p);
        if (st != CW_OK && part_name(src, i) && st != CW_ERR_CANCELLED)
            cwi_fail_in(err, st, part_name(src, i));
    }
    return st;
}

static cw_status check_files(const cwi_source *src, const cwi_input *in, cw_error *err)
{
    const size_t count = src->files.count;
    if (count && (src->bytes % count || share_bytes(src) % cw_type_size(src->shape.type)))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'%s' asks for %zu bytes, which %zu files cannot share",
                        src->size_field, src->bytes, count);
    return walk_parts(src, in, NULL, err);
}

cw_status cwi_check_limits(const cw_volume *v, size_t bytes, const char *field,
                           const cw_read_desc *desc, cw_error *err)
{
    const uint64_t most = desc->max_voxels ? desc->max_voxels : (uint64_t)1 << 40;
    const uint64_t voxels = bytes / cw_type_size(v->type) / v->components;
    if (voxels > most)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "'%s' asks for %llu voxels; the limit is %llu (--max-voxels)", field,
                        (unsigned long long)voxels, (unsigned long long)most);
    if (desc->max_bytes && bytes > desc->max_bytes) {
        char asked[CWI_MEMORY_TEXT], limit[CWI_MEMORY_TEXT];
        cwi_print_memory(bytes, asked);
        cwi_print_memory(desc->max_bytes, limit);
        return cwi_fail(err, CW_ERR_LIMIT,
                        "'%s' asks for %s of voxels; the limit is %s (--memory)", field, asked,
                        limit);
    }
    return CW_OK;
}

/* Replaces sizes, place, strides and bytes by those of a region. */
static cw_status narrow_to_region(const cwi_source *src, const cw_box *region, cwi_source *out,
                                  cw_error *err)
{
    cwi_axis axes[CWI_ROLE_COUNT];
    cw_status st = cwi_volume_shrink(&out->shape, region, err);
    for (size_t a = 0; a < src->axis_count; a++) {
        axes[a] = src->axes[a];
        if (axes[a].role <= CWI_AXIS_Z)
            axes[a].size = region->count[axes[a].role];
    }
    out->size_field = "region";
    return st == CW_OK ? cwi_source_set_axes(out, axes, src->axis_count, err) : st;
}

/* Chooses the distances of the voxels that are read. Along the fastest of x, y and z they are
 * neighbours, since these are contiguous in the file. */
static void choose_steps(const cwi_source *src, const cw_read_desc *desc, size_t step[3],
                         int *fastest)
{
    *fastest = -1;
    for (int a = 0; a < 3; a++)
        step[a] = desc->every[a] ? desc->every[a] : 1;
    for (size_t a = 0; a < src->axis_count && *fastest < 0; a++)
        if (src->axes[a].role <= CWI_AXIS_Z)
            *fastest = (int)src->axes[a].role;
    if (*fastest >= 0)
        step[*fastest] = 1;
}

/* Replaces shape and bytes by those of every n-th voxel. */
static cw_status thin_source(const cw_read_desc *desc, cwi_source *out, cw_error *err)
{
    size_t every[3], step[3];
    cwi_axis axes[CWI_ROLE_COUNT];
    int fastest;
    cw_volume *v = &out->shape;
    choose_steps(out, desc, step, &fastest);
    for (int a = 0; a < 3; a++)
        every[a] = desc->every[a] ? desc->every[a] : 1;
    memcpy(axes, out->axes, sizeof axes);
    for (size_t a = 0; a < out->axis_count; a++)
        if (axes[a].role <= CWI_AXIS_Z)
            axes[a].size = (axes[a].size - 1) / step[axes[a].role] + 1;
    cw_status st = cwi_volume_thin(v, every, err);
    const size_t dim[3] = {v->dim[0], v->dim[1], v->dim[2]};
    if (st == CW_OK)
        st = cwi_source_set_axes(out, axes, out->axis_count, err);
    memcpy(v->dim, dim, sizeof dim);
    if (fastest >= 0) /* skipped in memory */
        v->stride[fastest] *= (ptrdiff_t)every[fastest];
    return st;
}

/* Loads the voxels. `wanted` is the source or, narrowed and thinned, a part of it. */
static cw_status load_voxels(const cwi_source *src, const cwi_source *wanted,
                             const cwi_input *in, const cw_read_desc *desc, cw_volume *volume,
                             cw_error *err)
{
    size_t step[3];
    int fastest;
    cw_volume v = wanted->shape;
    v.owned = cwi_alloc_large(wanted->bytes, 1);
    if (!v.owned)
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu bytes of %s", wanted->bytes,
                        name_source(wanted));
    v.data = v.owned;
    reading r = {.src = src, .progress = &desc->progress, .to = v.owned};
    choose_steps(src, desc, step, &fastest);
    cwi_runs_plan(&r.runs, src, desc->region, step);
    cw_status st = cwi_volume_own_coordinates(&v, err);
    if (st == CW_OK)
        st = walk_parts(src, in, &r, err);
    if (st == CW_OK)
        st = cwi_progress(&desc->progress, "reading", 1, err);
    if (st == CW_OK)
        *volume = v;
    else
        cw_volume_free(&v);
    return st;
}

/* --- slices --------------------------------------------------------------------------------- */

/* The slices of a region, read in rising order. A part of the files stays open between them, so
 * that compressed data are inflated once. */
typedef struct slice_reading {
    const cwi_input *in;
    cw_box box; /* all wanted voxels */
    size_t step[3];
    uint64_t offset; /* bytes of the time steps before the wanted one */
    reading reading;
    part part;
    size_t index; /* of the open part */
    bool open;
} slice_reading;

static void close_reading(slice_reading *s)
{
    cwi_blocks_close(&s->reading.blocks);
    cwi_stream_close(&s->reading.stream);
    if (s->open)
        close_part(&s->part);
    s->open = false;
}

/* Opens the part with the next wanted byte, unless it is open and not yet beyond that byte. */
static cw_status open_next_part(slice_reading *s, cw_error *err)
{
    reading *r = &s->reading;
    const uint64_t share = share_bytes(r->src);
    const size_t index = (size_t)(r->runs.next / share);
    if (s->open && s->index == index && r->at <= r->runs.next)
        return CW_OK;
    close_reading(s);
    cw_status st = open_part(r->src, s->in, index, &s->part, err);
    if (st != CW_OK)
        return st;
    s->open = true;
    s->index = index;
    r->at = index * share;
    r->numbers = (cwi_numbers){.stream = &r->stream, .noun = name_source(r->src)};
    return open_stream(r->src, &s->part, &r->stream, &r->blocks, err);
}

static cw_status read_slices(void *user, size_t first, size_t count, void *to, cw_error *err)
{
    slice_reading *s = user;
    reading *r = &s->reading;
    const cwi_source *src = r->src;
    const uint64_t share = share_bytes(src);
    cw_box box = s->box;
    box.first[2] += first * s->step[2];
    box.count[2] = (count - 1) * s->step[2] + 1;
    cwi_source one_step = *src; /* its files are borrowed */
    for (size_t a = 0; a < src->axis_count; a++)
        if (src->axes[a].role == CWI_AXIS_STEP)
            one_step.axes[a].size = 1;
    cwi_runs_plan(&r->runs, &one_step, &box, s->step);
    r->runs.next += s->offset;
    r->runs.end += s->offset;
    r->to = to;
    cw_status st = CW_OK;
    while (st == CW_OK && r->runs.left > 0) {
        st = open_next_part(s, err);
        if (st == CW_OK)
            st = read_runs(r, (s->index + 1) * share, err);
        if (st == CW_OK && r->at == (s->index + 1) * share)
            st = check_packed(r, s->part.start, err);
        if (st != CW_OK && part_name(src, s->index) && st != CW_ERR_CANCELLED)
            cwi_fail_in(err, st, part_name(src, s->index));
    }
    return st;
}

/* Gives slices to the input's visitor. `wanted`: as in load_voxels() */
static cw_status visit_slices(const cwi_source *src, const cwi_source *wanted,
                              const cwi_input *in, const cw_read_desc *desc, cw_error *err)
{
    static const cw_progress quiet = {0};
    const cw_volume *all = &src->shape;
    slice_reading s = {.in = in, .reading = {.src = src, .progress = &quiet}};
    int fastest;
    for (int a = 0; a < 3; a++)
        s.box.count[a] = all->dim[a];
    if (desc->region)
        s.box = *desc->region;
    choose_steps(src, desc, s.step, &fastest);
    s.offset = in->visit->step * (uint64_t)all->step_stride;
    for (size_t a = 0; a + 1 < src->axis_count; a++)
        if (src->axes[a].role == CWI_AXIS_STEP && src->axes[a].size > 1)
            return cwi_fail(err, CW_ERR_UNSUPPORTED,
                            "time steps are not the slowest axis of this file; it is only read "
                            "as a whole");
    cw_status st = cwi_visit_slices(in->visit, &wanted->shape, read_slices, &s, err);
    close_reading(&s);
    return st;
}

/* Checks the files, and makes the source of the wanted voxels: a region, every n-th of them. */
static cw_status want_part(const cwi_source *src, const cwi_input *in, const cw_read_desc *desc,
                           cwi_source *wanted, cw_error *err)
{
    *wanted = *src; /* its files are borrowed */
    cw_status st = check_files(src, in, err);
    if (st == CW_OK && desc->region)
        st = narrow_to_region(src, desc->region, wanted, err);
    if (st == CW_OK)
        st = thin_source(desc, wanted, err);
    return st == CW_OK
               ? cwi_check_limits(&wanted->shape, wanted->bytes, wanted->size_field, desc, err)
               : st;
}

cw_status cwi_source_load(const cwi_source *src, const cwi_input *in, const cw_read_desc *desc,
                          cw_volume *volume, cw_error *err)
{
    cwi_source wanted;
    cw_status st = want_part(src, in, desc, &wanted, err);
    if (st != CW_OK || !desc->header_only)
        return st == CW_OK ? load_voxels(src, &wanted, in, desc, volume, err) : st;
    st = cwi_volume_own_coordinates(&wanted.shape, err);
    if (st == CW_OK)
        *volume = wanted.shape;
    return st;
}

cw_status cwi_source_visit(const cwi_source *src, const cwi_input *in, const cw_read_desc *desc,
                           cw_error *err)
{
    cw_read_desc limits = *desc;
    cwi_source wanted;
    limits.max_bytes = 0; /* voxels are not read at once */
    cw_status st = want_part(src, in, &limits, &wanted, err);
    return st == CW_OK ? visit_slices(src, &wanted, in, desc, err) : st;
}
