/* The module "picture": opens a PNG or BMP file, and gives its facts and rows of its pixels. */
#define _GNU_SOURCE /* pread */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/picture/picture_file.h"

#include <string.h>
#include <unistd.h>

bool cwi_picture_read_at(const cwi_picture_file *f, uint64_t offset, void *to, size_t size)
{
    size_t got = 0;
    if (offset > f->size || f->size - offset < size)
        return false;
    while (got < size) {
        const ssize_t n = pread(f->fd, (char *)to + got, size - got, (off_t)(offset + got));
        if (n <= 0)
            return false;
        got += (size_t)n;
    }
    return true;
}

size_t cwi_picture_row(const cwi_picture_facts *f)
{
    return (size_t)f->columns * f->samples * cw_type_size(f->type);
}

cw_status cwi_picture_reserve(cwi_picture_file *f, cw_error *err)
{
    const uint64_t row = cwi_picture_row(&f->facts); /* < 2^34 */
    const uint64_t stored =
        ((uint64_t)f->facts.columns * f->facts.samples * f->facts.bits + 7) / 8;
    if (stored / f->facts.max_ratio > f->size / f->facts.rows)
        return cwi_fail(err, CW_ERR_FORMAT, "%u x %u pixels are more than %llu bytes can hold",
                        f->facts.columns, f->facts.rows, (unsigned long long)f->size);
    if (row > CWI_PLANES_SHARED)
        return cwi_fail(err, CW_ERR_LIMIT, "a row takes %llu bytes; the most are %d",
                        (unsigned long long)row, CWI_PLANES_SHARED);
    f->pixels = cwi_alloc_array(f->facts.rows, row);
    return f->pixels ? CW_OK : cwi_fail_memory(err);
}

bool cwi_picture_is_grey(const unsigned char *palette, size_t count, size_t step)
{
    for (size_t i = 0; i < count; i++, palette += step)
        if (palette[0] != palette[1] || palette[0] != palette[2])
            return false;
    return true;
}

static void close_file(cwi_picture_file *f)
{
    if (f->fd >= 0)
        close(f->fd);
    cwi_free(f->pixels);
    *f = (cwi_picture_file){.fd = -1};
}

static cw_status read_picture(cwi_picture_file *f, bool with_pixels, cw_error *err)
{
    unsigned char magic[2] = {0};
    f->at = 0;
    return cwi_picture_read_at(f, 0, magic, 2) && memcmp(magic, "BM", 2) == 0
               ? cwi_picture_bmp(f, with_pixels, err)
               : cwi_picture_png(f, with_pixels, err);
}

static cw_status copy_rows(cwi_picture_file *f, const cwi_plane_request *q, void *shared,
                           cw_error *err)
{
    const size_t row = cwi_picture_row(&f->facts);
    if (f->fd < 0 || q->plane > 0 || q->first_row > f->facts.rows ||
        q->row_count > f->facts.rows - q->first_row || q->row_count > CWI_PLANES_SHARED / row)
        return cwi_fail(err, CW_ERR_FORMAT, "there are no rows %u to %u", q->first_row,
                        q->first_row + q->row_count);
    cw_status st = f->pixels ? CW_OK : read_picture(f, true, err);
    if (st == CW_OK)
        memcpy(shared, f->pixels + q->first_row * row, q->row_count * row);
    return st;
}

static cw_status work_on_request(void *state, int fd, const void *request, void *shared,
                                 cw_error *err)
{
    cwi_picture_file *f = state;
    cwi_plane_request q;
    memcpy(&q, request, sizeof q);
    if (q.op == CWI_PLANE_PIXELS)
        return copy_rows(f, &q, shared, err);
    close_file(f);
    f->fd = fd;
    f->size = q.file_bytes;
    cw_status st = read_picture(f, false, err);
    memcpy(shared, &f->facts, sizeof f->facts);
    return st;
}

static void *state_new(void)
{
    cwi_picture_file *f = cwi_alloc_zeroed(1, sizeof *f);
    if (f)
        f->fd = -1;
    return f;
}

static void state_free(void *state)
{
    close_file(state);
    cwi_free(state);
}

const cwi_plane_functions cwi_module_picture = {state_new, state_free, NULL, work_on_request};
