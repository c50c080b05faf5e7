/* Sequential bytes of an open file, decoded from base64 or hexadecimal text and inflated where
 * needed. */
#ifndef FORMATS_BYTES_INFLATE_STREAM_H
#define FORMATS_BYTES_INFLATE_STREAM_H

#include "formats/bytes/base64.h"

#ifndef ZLIB_CONST
#define ZLIB_CONST /* makes zlib's header declare its input const */
#endif
#include <zlib.h>

/* A zeroed stream is closed. */
typedef struct cwi_stream {
    int fd;          /* borrowed */
    uint64_t offset; /* place in the file of the next byte to read */
    uint64_t end;    /* place in the file where the stream ends at the latest */
    uint64_t given;  /* number of decoded bytes returned so far */
    bool deflated;
    bool is_bare; /* the compressed data have neither header nor checksum */
    uint32_t crc,
        expected_crc;    /* of such data: so far, and of all, which is stated elsewhere */
    bool ended;          /* the compressed data have ended, complete or not */
    bool truncated;      /* ... because the file ended first */
    uint64_t packed_end; /* ... else where they end in the file */
    void *isal;          /* ISA-L's state, in place of zlib; NULL: zlib inflates */
    void *bzip2;         /* the same for bzip2 data */
    z_stream *z;
    unsigned char *buffer; /* compressed bytes, the input of z */
    char *text;            /* text to be decoded; NULL: the file holds plain bytes */
    size_t text_next, text_size;
    cwi_base64 base64;
    struct cwi_stream_ahead *ahead; /* a thread inflates, into buffers; NULL: the reader does */
    bool is_hex;                    /* the text is hexadecimal, not base64 */
    bool has_digit;                 /* ... and the first digit of a byte was read: high */
    unsigned char high;
} cwi_stream;

/* Makes zlib allocate by core/base/memory.h, so that tests can make it run out. */
void cwi_zlib_use_memory(z_stream *z);

/* Starts reading at an offset: plain bytes, or (deflated) gzip or zlib data, distinguished by
 * their own headers. Several gzip members in a row are read as one.
 * Returns CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_stream_open(cwi_stream *s, int fd, uint64_t offset, bool deflated,
                                       cw_error *err);

/* Starts reading an entry of a zip archive: deflated data without header and checksum. End it at its
 * last byte. crc: of all decoded bytes, which is checked at the end.
 * Returns CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_stream_open_bare(cwi_stream *s, int fd, uint64_t offset,
                                            uint32_t crc, cw_error *err);

/* Starts reading bzip2 data; several streams in a row are read as one.
 * Returns CW_ERR_NO_MEMORY, CW_ERR_UNSUPPORTED: libbz2 is not in this build. */
CW_NODISCARD cw_status cwi_stream_open_bzip2(cwi_stream *s, int fd, uint64_t offset,
                                             cw_error *err);

/* Sets up the stream, before anything is read. The first one ends it at an offset of the file.
 * The others say that the file holds the bytes as base64 text, or as two hexadecimal digits
 * each.
 * Returns CW_ERR_NO_MEMORY. */
void cwi_stream_end_at(cwi_stream *s, uint64_t end);
CW_NODISCARD cw_status cwi_stream_from_base64(cwi_stream *s, cw_error *err);
CW_NODISCARD cw_status cwi_stream_from_hex(cwi_stream *s, cw_error *err);

/* Lets a thread of its own inflate what follows, ahead of the reader; the stream is set up by then.
 * Does nothing for plain bytes, where one thread was requested, and where none can be had. */
void cwi_stream_inflate_ahead(cwi_stream *s);

/* Reads up to size bytes; *got is less only at the end.
 * Returns CW_ERR_FORMAT for damaged data or a wrong checksum, CW_ERR_IO. */
CW_NODISCARD cw_status cwi_stream_some(cwi_stream *s, void *to, size_t size, size_t *got,
                                       cw_error *err);

/* Reads exactly size bytes; fewer are CW_ERR_FORMAT, and the message states the number. */
CW_NODISCARD cw_status cwi_stream_read(cwi_stream *s, void *to, size_t size, cw_error *err);

/* Leaves out bytes; a shortage is only found when the next bytes are read. */
CW_NODISCARD cw_status cwi_stream_skip(cwi_stream *s, uint64_t size, cw_error *err);

/* Reads on to the checksum of compressed data, which must be there and right, and to the end of
 * the file. Only zeros may follow the data. If more than 64 KiB are left, and more than was
 * read, the stream is not read on: its end was not requested.
 * Returns CW_ERR_FORMAT, naming the byte of the file that should not be there; CW_ERR_IO. */
CW_NODISCARD cw_status cwi_stream_finish(cwi_stream *s, cw_error *err);

/* Reads the first bytes of a file, inflated when it is a gzip file; *got is less where it
 * ends. */
CW_NODISCARD cw_status cwi_stream_head(int fd, void *to, size_t size, size_t *got,
                                       bool *gzipped, cw_error *err);

/* Closes the stream. Harmless on a zeroed or already closed one. */
void cwi_stream_close(cwi_stream *s);

#endif
