/* The entries of a zip archive: found by its directory, checked against each other and the
 * file, and inflated as they are read. */
#ifndef FORMATS_BYTES_ZIP_READ_H
#define FORMATS_BYTES_ZIP_READ_H

#include "formats/bytes/inflate_stream.h"
#include "formats/bytes/input_file.h"

/* A zeroed one is closed. */
typedef struct cwi_unzip {
    const cwi_input *in;      /* borrowed */
    unsigned char *directory; /* its records */
    size_t bytes, count;
    uint64_t start; /* of the directory in the file: entries end before it */
} cwi_unzip;

typedef struct cwi_unzip_entry {
    char name[256];
    bool deflated;
    uint32_t crc;
    uint64_t start, packed, size; /* of its bytes in the file; as they are there, and whole */
} cwi_unzip_entry;

/* Reads the directory. Returns CW_ERR_FORMAT where it is none or does not fit the file; for
 * more than 65,535 entries, or more than 4 MiB of records; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_unzip_open(cwi_unzip *z, const cwi_input *in, cw_error *err);
void cwi_unzip_close(cwi_unzip *z);

/* Finds an entry of a name, in any case of letters and with or without a slash in front.
 * Returns CW_ERR_FORMAT when there is none, when it is encrypted or packed in another way than
 * by deflate, its headers differ, or it claims a size that deflate cannot reach. */
CW_NODISCARD cw_status cwi_unzip_find(const cwi_unzip *z, const char *name,
                                      cwi_unzip_entry *entry, cw_error *err);

bool cwi_unzip_has(const cwi_unzip *z, const char *name);

/* The bytes of an entry, one after another. A zeroed one is closed. */
typedef struct cwi_unzip_stream {
    const cwi_input *in; /* borrowed */
    cwi_unzip_entry entry;
    uint64_t taken, given; /* bytes of the file, and of the entry */
    uint32_t crc;
    bool inflates, ended;
    z_stream z;
    unsigned char *buffer;
} cwi_unzip_stream;

CW_NODISCARD cw_status cwi_unzip_start(cwi_unzip_stream *s, const cwi_unzip *z,
                                       const cwi_unzip_entry *entry, cw_error *err);

/* Reads up to size bytes; s is a cwi_unzip_stream. *got is 0 only at the end, where size and
 * checksum are looked at. Returns CW_ERR_FORMAT for data that are damaged */
CW_NODISCARD cw_status cwi_unzip_some(void *s, void *to, size_t size, size_t *got,
                                      cw_error *err);
void cwi_unzip_end(cwi_unzip_stream *s);

#endif
