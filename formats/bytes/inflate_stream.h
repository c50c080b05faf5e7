/* Sequential bytes of an open file, made of base64 text and inflated on the way where they are
 * so written. */
#ifndef FORMATS_BYTES_INFLATE_STREAM_H
#define FORMATS_BYTES_INFLATE_STREAM_H

#include "formats/bytes/base64.h"

#ifndef ZLIB_CONST
#define ZLIB_CONST /* zlib does not write to its input: let its header say so */
#endif
#include <zlib.h>

/* A zeroed stream is closed. */
typedef struct cwi_stream {
    int fd;          /* borrowed */
    uint64_t offset; /* in the file, of the next byte to fetch */
    uint64_t end;    /* in the file: what is there is no part of the stream */
    uint64_t given;  /* bytes handed out so far, decoded */
    bool deflated;
    bool ended;          /* the compressed data are over, whole or not */
    bool truncated;      /* ... because the file ended first */
    uint64_t packed_end; /* ... else where in the file */
    void *isal;          /* inflates in zlib's place; NULL: zlib does */
    void *bzip2;         /* the same, of what bzip2 compressed */
    z_stream z;
    unsigned char *buffer; /* compressed bytes on their way into z */
    char *text;            /* on its way to bytes; NULL: the file holds them as they are */
    size_t text_next, text_size;
    cwi_base64 base64;
    bool is_hex;    /* the text is hexadecimal, not base64 */
    bool has_digit; /* ... and the first digit of a byte is there: high */
    unsigned char high;
} cwi_stream;

/* Makes zlib take its memory from core/base/memory.h, so that tests can make it run out. */
void cwi_zlib_use_memory(z_stream *z);

/* Starts reading at an offset: the bytes as they are, or (deflated) as gzip or zlib data, told
 * apart by their own headers. Several gzip members in a row are read as one.
 * Returns CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_stream_open(cwi_stream *s, int fd, uint64_t offset, bool deflated,
                                       cw_error *err);

/* The same of data that bzip2 compressed; several streams in a row are read as one.
 * Returns CW_ERR_NO_MEMORY, CW_ERR_UNSUPPORTED: libbz2 is not in this build. */
CW_NODISCARD cw_status cwi_stream_open_bzip2(cwi_stream *s, int fd, uint64_t offset,
                                             cw_error *err);

/* All before anything is read: nothing from an offset of the file on is part of the stream;
 * the file holds the bytes as base64 text, or as two hexadecimal digits each.
 * Returns CW_ERR_NO_MEMORY. */
void cwi_stream_end_at(cwi_stream *s, uint64_t end);
CW_NODISCARD cw_status cwi_stream_from_base64(cwi_stream *s, cw_error *err);
CW_NODISCARD cw_status cwi_stream_from_hex(cwi_stream *s, cw_error *err);

/* Reads up to size bytes; *got is less only at the end.
 * Returns CW_ERR_FORMAT for damaged data or a wrong checksum, CW_ERR_IO. */
CW_NODISCARD cw_status cwi_stream_some(cwi_stream *s, void *to, size_t size, size_t *got,
                                       cw_error *err);

/* Reads exactly size bytes; fewer are CW_ERR_FORMAT, and the message says how many. */
CW_NODISCARD cw_status cwi_stream_read(cwi_stream *s, void *to, size_t size, cw_error *err);

/* Leaves out bytes; there may turn out to be fewer only when the next are read. */
CW_NODISCARD cw_status cwi_stream_skip(cwi_stream *s, uint64_t size, cw_error *err);

/* Reads on to the checksum of compressed data, which must be there and right, and to the end of
 * the file, up to which only zeros may follow. A stream that has more left than was read of it,
 * and more than 64 KiB, is let be: its end is not what was asked for.
 * Returns CW_ERR_FORMAT, naming the byte of the file that should not be there; CW_ERR_IO. */
CW_NODISCARD cw_status cwi_stream_finish(cwi_stream *s, cw_error *err);

/* Reads the first bytes of a file, inflated when it is a gzip file; *got is less where
 * it ends. */
CW_NODISCARD cw_status cwi_stream_head(int fd, void *to, size_t size, size_t *got,
                                       bool *gzipped, cw_error *err);

/* Harmless on a zeroed or already closed stream. */
void cwi_stream_close(cwi_stream *s);

#endif
