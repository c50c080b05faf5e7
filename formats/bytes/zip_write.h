/* A zip archive, written as a stream: each entry is deflated on its way, and the sizes in front
 * of it are filled in behind it. */
#ifndef FORMATS_BYTES_ZIP_WRITE_H
#define FORMATS_BYTES_ZIP_WRITE_H

#include "formats/bytes/deflate_file.h"

enum { CWI_ZIP_ENTRIES = 8 };

typedef struct cwi_zip_entry {
    const char *name; /* static */
    bool huge;        /* its header has room for sizes of 64 bits */
    uint32_t crc;
    uint64_t start, packed, size;
} cwi_zip_entry;

/* A zeroed one is closed. */
typedef struct cwi_zip {
    cwi_outfile *file; /* borrowed */
    cwi_sink sink;     /* of the entry under way */
    cwi_zip_entry entries[CWI_ZIP_ENTRIES];
    size_t count;
} cwi_zip;

/* Starts an entry. huge: it may have 4 GiB or more; some readers know no such entries.
 * Returns CW_ERR_NO_MEMORY, CW_ERR_OUTPUT */
CW_NODISCARD cw_status cwi_zip_begin(cwi_zip *z, const char *name, bool huge, cw_error *err);

/* Bytes of the entry; z is a cwi_zip. */
CW_NODISCARD cw_status cwi_zip_put(void *z, const void *bytes, size_t size, cw_error *err);

/* Ends it. CW_ERR_LIMIT when it has 4 GiB and is not huge; CW_ERR_OUTPUT */
CW_NODISCARD cw_status cwi_zip_end(cwi_zip *z, cw_error *err);

/* An entry of one text. */
CW_NODISCARD cw_status cwi_zip_text(cwi_zip *z, const char *name, const char *text,
                                    cw_error *err);

/* Writes the directory at the end of the file. */
CW_NODISCARD cw_status cwi_zip_finish(cwi_zip *z, cw_error *err);
void cwi_zip_close(cwi_zip *z);

#endif
