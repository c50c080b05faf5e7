/* Reads and decodes the blocks of N5. */
#define _GNU_SOURCE /* close */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/byte_order.h"
#include "formats/n5/n5.h"
#include "formats/zarr/zarr_decode.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* The header of a block: a mode, the number of dimensions, sizes, and in mode 1 the number of
 * elements. */
enum { MODE_SIZES = 0, MODE_COUNTED = 1, START_BYTES = 4, SIZE_BYTES = 4 };
enum { HEADER_BYTES = START_BYTES + SIZE_BYTES * (CWI_ZARR_RANK + 1) };

typedef struct block_header {
    size_t sizes[CWI_ZARR_RANK];
    size_t elements; /* the product of the sizes */
    size_t bytes;    /* of the header */
    bool is_cropped; /* it reaches over the end of the array, whose voxels alone are kept */
} block_header;

static uint32_t read_number(const unsigned char *bytes, size_t count)
{
    uint32_t number = 0;
    for (size_t n = 0; n < count; n++)
        number = number << 8 | bytes[n];
    return number;
}

static cw_status read_sizes(const cwi_zarr_array *a, const unsigned char *bytes,
                            block_header *header, cw_error *err)
{
    header->elements = 1;
    for (size_t d = 0; d < a->rank; d++) {
        const size_t size = read_number(bytes + START_BYTES + SIZE_BYTES * d, SIZE_BYTES);
        if (size < 1 || size > a->chunk[d])
            return cwi_fail(err, CW_ERR_FORMAT,
                            "the header of a block says size %zu along dimension %zu; 1 to the "
                            "'blockSize' of %zu were expected",
                            size, d, a->chunk[d]);
        header->sizes[d] = size;
        header->is_cropped |= size > a->inner[d];
        if (!cwi_size_mul(header->elements, size, &header->elements) ||
            header->elements > INT32_MAX / a->stored_bytes)
            return cwi_fail(err, CW_ERR_LIMIT, "the header of a block asks for 2 GiB or more");
    }
    return CW_OK;
}

static cw_status read_header(const cwi_zarr_array *a, int fd, block_header *header,
                             cw_error *err)
{
    unsigned char bytes[HEADER_BYTES] = {0};
    size_t got;
    const size_t sizes_end = START_BYTES + SIZE_BYTES * a->rank;
    cw_status st = cwi_input_read_at(fd, 0, bytes, sizes_end + SIZE_BYTES, &got, err);
    const uint32_t mode = read_number(bytes, 2), rank = read_number(bytes + 2, 2);
    *header = (block_header){.bytes = sizes_end + (mode == MODE_COUNTED ? SIZE_BYTES : 0)};
    if (st != CW_OK)
        return st;
    if (got < START_BYTES || (mode <= MODE_COUNTED && rank == a->rank && got < header->bytes))
        return cwi_fail(err, CW_ERR_FORMAT, "the file ends inside the header of a block");
    if (mode > MODE_COUNTED)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the header of a block says mode %u; 0 or 1 was expected", mode);
    if (rank != a->rank)
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "the header of a block says %u dimensions; the %zu of 'dimensions' were "
            "expected",
            rank, a->rank);
    st = read_sizes(a, bytes, header, err);
    const uint32_t count = read_number(bytes + sizes_end, SIZE_BYTES);
    if (st == CW_OK && mode == MODE_COUNTED && count != header->elements)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the header of a block says %u elements; its sizes are %zu", count,
                        header->elements);
    return st;
}

/* Copies the rows of a block that lie within the array, packed. Its sizes become those of them. */
static void crop_block(const cwi_zarr_array *a, block_header *header, const char *block,
                       char *to)
{
    size_t kept[CWI_ZARR_RANK] = {0}, rows = 1;
    for (size_t d = 0; d < a->rank; d++) {
        kept[d] = header->sizes[d] < a->inner[d] ? header->sizes[d] : a->inner[d];
        rows *= d ? kept[d] : 1;
    }
    const size_t row = kept[0] * a->stored_bytes;
    for (size_t n = 0; n < rows; n++) {
        size_t rest = n, from = 0, stride = header->sizes[0];
        for (size_t d = 1; d < a->rank; d++) {
            from += rest % kept[d] * stride;
            rest /= kept[d];
            stride *= header->sizes[d];
        }
        memcpy(to + n * row, block + from * a->stored_bytes, row);
    }
    memcpy(header->sizes, kept, sizeof kept);
}

/* Decodes a block that reaches over the end of the array into memory of its own. */
static cw_status decode_cropped(const cwi_zarr_array *a, int fd, uint64_t size,
                                block_header *header, void **to, cw_error *err)
{
    const size_t bytes = header->elements * a->stored_bytes;
    void *block = NULL;
    cw_status st = cwi_zarr_packed_check(&a->chain, size - header->bytes, bytes, err);
    if (st != CW_OK)
        return st;
    block = cwi_alloc_large(bytes, 1);
    if (!*to)
        *to = cwi_alloc_large(a->chunk_bytes, 1);
    st = block && *to ? cwi_zarr_decode_part(a, fd, header->bytes, size - header->bytes, bytes,
                                             &block, err)
                      : cwi_fail_memory(err);
    if (st == CW_OK)
        crop_block(a, header, block, *to);
    cwi_free(block);
    return st;
}

static cw_status decode_block(const cwi_zarr_array *a, int fd, uint64_t size, void **to,
                              cw_error *err)
{
    block_header header;
    cw_status st = read_header(a, fd, &header, err);
    if (st == CW_OK && header.is_cropped)
        st = decode_cropped(a, fd, size, &header, to, err);
    else if (st == CW_OK)
        st = cwi_zarr_decode_part(a, fd, header.bytes, size - header.bytes,
                                  header.elements * a->stored_bytes, to, err);
    if (st == CW_OK && memcmp(header.sizes, a->inner, a->rank * sizeof *a->inner) != 0)
        cwi_zarr_spread(a, header.sizes, *to);
    return st;
}

cw_status cwi_n5_load_block(cwi_zarr *z, const size_t at[CWI_ZARR_RANK], void **to,
                            bool *missing, cw_error *err)
{
    char key[CWI_ZARR_KEY_BYTES];
    uint64_t size = 0;
    int fd;
    cwi_zarr_print_key(&z->array, at, key);
    cw_status st = cwi_input_find_side(&z->in, key, &fd, &size, err);
    *missing = st == CW_OK && fd < 0;
    if (st == CW_OK && fd >= 0) {
        st = decode_block(&z->array, fd, size, to, err);
        close(fd);
    }
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, key);
}
