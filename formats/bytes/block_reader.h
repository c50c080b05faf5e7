/* Data cut into blocks of one size, each compressed by itself, behind a table of their sizes:
 * as VTK's XML files hold them. */
#ifndef FORMATS_BYTES_BLOCK_READER_H
#define FORMATS_BYTES_BLOCK_READER_H

#include "formats/bytes/inflate_stream.h"

typedef enum cwi_codec { CWI_CODEC_ZLIB, CWI_CODEC_LZ4, CWI_CODEC_COUNT } cwi_codec;

/* How the table and the blocks are written. */
typedef struct cwi_block_form {
    cwi_codec codec;
    size_t word_bytes; /* of each number of the table: 4 or 8 */
    bool big_endian;
} cwi_block_form;

/* Blocks of a stream, read one after another, and what they hold as one sequence. A zeroed one
 * is closed. */
typedef struct cwi_packed_blocks {
    cwi_stream *stream; /* borrowed */
    cwi_block_form form;
    size_t count, next;
    size_t bytes, last; /* of each block, of the last one, decoded */
    unsigned char *table;
    unsigned char *packed; /* room for the largest block as it is in the file */
    uint64_t skipped;      /* decoded bytes to leave out before the next that are read */
    unsigned char *held;   /* a block of which only a part was wanted so far */
    size_t held_bytes, held_next;
} cwi_packed_blocks;

/* Reads the table, and checks that the blocks decode to exactly `wanted` bytes, that `there`
 * bytes can hold them, and that none claims to have been packed closer than its codec can.
 * Nothing larger than the file is allocated.
 * Returns CW_ERR_FORMAT, CW_ERR_NO_MEMORY, CW_ERR_IO */
CW_NODISCARD cw_status cwi_blocks_open(cwi_packed_blocks *b, cwi_stream *stream,
                                       const cwi_block_form *form, uint64_t wanted,
                                       uint64_t there, cw_error *err);

/* Decodes the next bytes: a block at its place if the room is enough for it, else a part of
 * one, which then is kept beside until it is used up. No more than all that `wanted` said may
 * be asked for. Returns CW_ERR_FORMAT, CW_ERR_NO_MEMORY, CW_ERR_IO */
CW_NODISCARD cw_status cwi_blocks_some(cwi_packed_blocks *b, unsigned char *to, size_t room,
                                       size_t *got, cw_error *err);

/* Leaves out bytes; blocks that hold nothing else are not decoded. */
void cwi_blocks_skip(cwi_packed_blocks *b, uint64_t bytes);
void cwi_blocks_close(cwi_packed_blocks *b);

/* Whether this build has the codec, and decoding of one block, which must give `size` bytes. */
bool cwi_lz4_present(void);
bool cwi_lz4_decode(const unsigned char *packed, size_t packed_size, unsigned char *to,
                    size_t size);

#endif
