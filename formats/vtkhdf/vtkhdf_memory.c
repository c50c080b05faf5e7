/* Makes a VTK file in memory of a VTKHDF file: elements first, then room for its arrays, which is filled
 * with those that are needed. Memory is taken where numbers are written alone. */
#define _GNU_SOURCE /* memfd_create, fallocate */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/base/unnamed_file.h"
#include "formats/vtkhdf/vtkhdf_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

enum { PART_BYTES = 16 << 20 };

/* The last tag, as other files have it behind the appended data. */
static const char last_tag[] = "</AppendedData></VTKFile>";

static cw_status write_at(const cwi_vtkhdf *h, uint64_t at, const void *from, size_t bytes,
                          cw_error *err)
{
    return cwi_unnamed_write("memory", h->made.fd, at, from, bytes, err);
}

cw_status cwi_vtkhdf_make(cwi_vtkhdf *h, cw_error *err)
{
    fprintf(h->xml, "<AppendedData encoding=\"raw\">_");
    const bool is_whole = cwi_text_close(h->xml, &h->text);
    h->xml = NULL;
    if (!is_whole)
        return cwi_fail_memory(err);
    h->made = *h->in;
    h->made.fd = memfd_create("cubewright", MFD_CLOEXEC);
    h->is_made = h->made.fd >= 0;
    h->made.size = h->text_size + h->appended_bytes + sizeof last_tag - 1;
    if (!h->is_made || ftruncate(h->made.fd, (off_t)h->made.size) != 0)
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for a file of %llu bytes",
                        (unsigned long long)h->made.size);
    cw_status st = write_at(h, 0, h->text, h->text_size, err);
    if (st == CW_OK)
        st = write_at(h, h->made.size - (sizeof last_tag - 1), last_tag, sizeof last_tag - 1,
                      err);
    for (size_t n = 0; n < h->item_count && st == CW_OK; n++)
        st = write_at(h, h->text_size + h->items[n].at, &h->items[n].bytes, sizeof(uint64_t),
                      err);
    return st;
}

/* Counts memory that is about to be filled. Of images the limit is for voxels, which come later. */
static cw_status take_bytes(cwi_vtkhdf *h, uint64_t bytes, cw_error *err)
{
    const uint64_t max = cwi_vtkhdf_is(h, "ImageData") ? 0 : h->desc->max_bytes;
    const uint64_t all = h->filled_bytes + bytes;
    char requested[CWI_MEMORY_TEXT], limit[CWI_MEMORY_TEXT];
    cwi_print_memory(all, requested);
    cwi_print_memory(max, limit);
    if (max && all > max)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "its arrays take %s; the limit is %s (desc->max_bytes)", requested,
                        limit);
    if (!cwi_memory_take(bytes))
        return cwi_fail_memory(err);
    h->filled_bytes = all;
    return CW_OK;
}

/* Gives back the memory of an item's bytes before one. */
static void drop_before(cwi_vtkhdf *h, cwi_vtkhdf_item *item, uint64_t end)
{
    const uint64_t bytes = end - item->kept,
                   at = h->text_size + item->at + sizeof(uint64_t) + item->kept;
    if (bytes && fallocate(h->made.fd, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, (off_t)at,
                           (off_t)bytes) == 0) {
        cwi_memory_give(bytes);
        h->filled_bytes -= bytes;
    }
    item->kept = end;
}

/* Reads rows behind those that are in memory, `rows` of them, part by part. */
static cw_status append_rows(cwi_vtkhdf *h, cwi_vtkhdf_item *item, uint64_t rows, uint64_t row,
                             cw_error *err)
{
    const uint64_t to = h->text_size + item->at + sizeof(uint64_t), all = rows,
                   before = item->first * cwi_vtkhdf_rows(item->array),
                   step = row < PART_BYTES ? PART_BYTES / row : 1;
    void *part = cwi_alloc_array(step < rows ? step : rows, row);
    cw_status st = part ? CW_OK : cwi_fail_memory(err);
    while (rows && st == CW_OK) {
        const uint64_t count = rows < step ? rows : step;
        h->planes.box.done = 1 - (double)rows / (double)all;
        st = cwi_progress(&h->desc->progress, "reading", h->planes.box.done, err);
        if (st == CW_OK)
            st = cwi_vtkhdf_fetch_rows(h, item->array, before + item->filled / row, count, part,
                                       err);
        if (st == CW_OK)
            st = write_at(h, to + item->filled, part, count * row, err);
        item->filled += st == CW_OK ? count * row : 0;
        rows -= count;
    }
    cwi_free(part);
    return st;
}

cw_status cwi_vtkhdf_fill_range(cwi_vtkhdf *h, cwi_vtkhdf_item *item, uint64_t first,
                                uint64_t end, cw_error *err)
{
    const uint64_t rows = cwi_vtkhdf_rows(item->array);
    if (item->bytes == 0 || rows == 0)
        return CW_OK;
    const uint64_t row = cwi_vtkhdf_row_bytes(item->array) / rows;
    first = first / row * row;
    end = (end + row - 1) / row * row;
    if (first < item->kept || first > item->filled) {
        drop_before(h, item, item->filled);
        item->kept = item->filled = first;
    }
    drop_before(h, item, first);
    if (end <= item->filled)
        return CW_OK;
    cw_status st = take_bytes(h, end - item->filled, err);
    return st == CW_OK ? append_rows(h, item, (end - item->filled) / row, row, err) : st;
}

cw_status cwi_vtkhdf_fill(cwi_vtkhdf *h, cwi_vtkhdf_item *item, cw_error *err)
{
    return cwi_vtkhdf_fill_range(h, item, 0, item->bytes, err);
}

cw_status cwi_vtkhdf_fill_structure(cwi_vtkhdf *h, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t n = 0; n < h->item_count && st == CW_OK; n++)
        if (!h->items[n].is_value)
            st = cwi_vtkhdf_fill(h, &h->items[n], err);
    return st;
}
