/* Reading of zip archives. Entries are found by the directory, checked against each other and
 * the file, and inflated as they are read. */
#ifndef FORMATS_BYTES_ZIP_READ_H
#define FORMATS_BYTES_ZIP_READ_H

#include "formats/bytes/inflate_stream.h"
#include "formats/bytes/input_file.h"

/* An open archive. A zeroed one is closed. */
typedef struct cwi_unzip {
    const cwi_input *in;      /* borrowed */
    unsigned char *directory; /* its records */
    size_t bytes, count;
    uint64_t start; /* start of the directory in the file: entries end before it */
} cwi_unzip;

typedef struct cwi_unzip_entry {
    char name[256];
    bool deflated;
    uint32_t crc;
    uint64_t start, packed, size; /* of its bytes in the file: start, size there, and size when
                                     inflated */
} cwi_unzip_entry;

/* Reads the directory. Returns CW_ERR_FORMAT where it is invalid or does not fit the file, for
 * more than 65,535 entries, or for more than 4 MiB of records; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_unzip_open(cwi_unzip *z, const cwi_input *in, cw_error *err);
void cwi_unzip_close(cwi_unzip *z);

/* Finds an entry by name, in any letter case and with or without a leading slash. Returns
 * CW_ERR_FORMAT when there is none, when it is encrypted or packed by another method than
 * deflate, its headers differ, or it claims a size that deflate cannot reach. */
CW_NODISCARD cw_status cwi_unzip_find(const cwi_unzip *z, const char *name,
                                      cwi_unzip_entry *entry, cw_error *err);

/* Copies the name of the next entry, or nothing if it is too long. Returns false behind the last one.
 * at  place in the directory; 0 at first */
bool cwi_unzip_next(const cwi_unzip *z, size_t *at, char name[256]);

bool cwi_unzip_has(const cwi_unzip *z, const char *name);

/* A stream of the bytes of an entry. A zeroed one is closed. */
typedef struct cwi_unzip_stream {
    const cwi_input *in; /* borrowed */
    cwi_unzip_entry entry;
    uint64_t taken, given; /* number of bytes read from the file, and returned from the entry */
    uint32_t crc;
    bool inflates, ended;
    z_stream z;
    unsigned char *buffer;
} cwi_unzip_stream;

CW_NODISCARD cw_status cwi_unzip_start(cwi_unzip_stream *s, const cwi_unzip *z,
                                       const cwi_unzip_entry *entry, cw_error *err);

/* Reads up to size bytes; s is a cwi_unzip_stream. *got is 0 only at the end, where size and
 * checksum are checked. Returns CW_ERR_FORMAT for damaged data */
CW_NODISCARD cw_status cwi_unzip_some(void *s, void *to, size_t size, size_t *got,
                                      cw_error *err);
void cwi_unzip_end(cwi_unzip_stream *s);

#endif
