/* Reading of data that are cut into blocks of one size, each compressed by itself, behind a
 * table of their sizes, as in VTK's XML files. */
#ifndef FORMATS_BYTES_BLOCK_READER_H
#define FORMATS_BYTES_BLOCK_READER_H

#include "formats/bytes/inflate_stream.h"

typedef enum cwi_codec { CWI_CODEC_ZLIB, CWI_CODEC_LZ4, CWI_CODEC_COUNT } cwi_codec;

/* The encoding of the table and the blocks. */
typedef struct cwi_block_form {
    cwi_codec codec;
    size_t word_bytes; /* of each number of the table: 4 or 8 */
    bool big_endian;
} cwi_block_form;

/* The blocks of a stream, read one after another, and their content as one sequence. A zeroed
 * one is closed. */
typedef struct cwi_packed_blocks {
    cwi_stream *stream; /* borrowed */
    cwi_block_form form;
    size_t count, next;
    size_t bytes, last; /* of each block, of the last one; decoded */
    unsigned char *table;
    unsigned char *packed; /* room for the largest compressed block */
    uint64_t skipped;      /* decoded bytes to leave out before the next read */
    unsigned char *held;   /* a block of which only a part was read so far */
    size_t held_bytes, held_next;
} cwi_packed_blocks;

/* Reads the table. Checks that the blocks decode to exactly `expected` bytes, that `there` bytes
 * can hold them, and that none claims a better compression than its codec can reach. Nothing
 * larger than the file is allocated.
 * Returns CW_ERR_FORMAT, CW_ERR_NO_MEMORY, CW_ERR_IO */
CW_NODISCARD cw_status cwi_blocks_open(cwi_packed_blocks *b, cwi_stream *stream,
                                       const cwi_block_form *form, uint64_t expected,
                                       uint64_t there, cw_error *err);

/* Decodes the next bytes: a whole block if `capacity` is enough for it, else a part of one. The
 * rest of that block is kept until it is used up. The caller must not request more than
 * `expected` bytes in total. Returns CW_ERR_FORMAT, CW_ERR_NO_MEMORY, CW_ERR_IO */
CW_NODISCARD cw_status cwi_blocks_some(cwi_packed_blocks *b, unsigned char *to, size_t capacity,
                                       size_t *got, cw_error *err);

/* Leaves out bytes; blocks that hold nothing else are not decoded. */
void cwi_blocks_skip(cwi_packed_blocks *b, uint64_t bytes);
void cwi_blocks_close(cwi_packed_blocks *b);

/* Tell if this build has the codec, and decode one block, which must give `size` bytes. */
bool cwi_lz4_present(void);
bool cwi_lz4_decode(const unsigned char *packed, size_t packed_size, unsigned char *to,
                    size_t size);

#endif
