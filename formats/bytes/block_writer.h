/* Writing of data in blocks that are each compressed by zlib, behind a table of their sizes.
 * VTK's XML files hold them, and block_reader.h reads them. Words have 64 bits,
 * little-endian. */
#ifndef FORMATS_BYTES_BLOCK_WRITER_H
#define FORMATS_BYTES_BLOCK_WRITER_H

#include "formats/bytes/deflate_file.h"

/* A writer of blocks. A zeroed one is closed. */
typedef struct cwi_block_sink {
    cwi_outfile *file;           /* borrowed */
    struct cwi_block *blocks;    /* some for each thread, compressed at the same time */
    size_t capacity, full, held; /* of them: all, full ones; bytes in the next */
    unsigned char *table;        /* of the current array */
    size_t table_bytes, count, next;
    uint64_t table_at;
} cwi_block_sink;

CW_NODISCARD cw_status cwi_block_sink_open(cwi_block_sink *b, cwi_outfile *file, cw_error *err);

/* Starts an array; `bytes` is its size (not 0). Its table is filled in when it ends. */
CW_NODISCARD cw_status cwi_block_sink_begin(cwi_block_sink *b, uint64_t bytes, cw_error *err);

/* Adds bytes to the array; b is a cwi_block_sink. */
CW_NODISCARD cw_status cwi_block_sink_put(void *b, const void *bytes, size_t size,
                                          cw_error *err);
CW_NODISCARD cw_status cwi_block_sink_end(cwi_block_sink *b, cw_error *err);
void cwi_block_sink_close(cwi_block_sink *b);

#endif
