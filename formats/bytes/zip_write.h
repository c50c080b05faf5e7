/* Writing of zip archives as a stream. Each entry is deflated on its way; the sizes before it
 * are filled in afterwards. */
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

/* An archive being written. A zeroed one is closed. */
typedef struct cwi_zip {
    cwi_outfile *file; /* borrowed */
    cwi_sink sink;     /* of the current entry */
    cwi_zip_entry entries[CWI_ZIP_ENTRIES];
    size_t count;
} cwi_zip;

/* Starts an entry. huge: it may reach 4 GiB or more; some readers do not support such entries.
 * Returns CW_ERR_NO_MEMORY, CW_ERR_OUTPUT */
CW_NODISCARD cw_status cwi_zip_begin(cwi_zip *z, const char *name, bool huge, cw_error *err);

/* Adds bytes to the entry; z is a cwi_zip. */
CW_NODISCARD cw_status cwi_zip_put(void *z, const void *bytes, size_t size, cw_error *err);

/* Ends the entry. Returns CW_ERR_LIMIT when it has 4 GiB and is not huge; CW_ERR_OUTPUT */
CW_NODISCARD cw_status cwi_zip_end(cwi_zip *z, cw_error *err);

/* Writes an entry of one text. */
CW_NODISCARD cw_status cwi_zip_text(cwi_zip *z, const char *name, const char *text,
                                    cw_error *err);

/* Writes the directory at the end of the file. */
CW_NODISCARD cw_status cwi_zip_finish(cwi_zip *z, cw_error *err);
void cwi_zip_close(cwi_zip *z);

#endif
