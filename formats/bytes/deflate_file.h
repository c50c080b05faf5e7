/* Writing of bytes to a file, plain or deflated. */
#ifndef FORMATS_BYTES_DEFLATE_FILE_H
#define FORMATS_BYTES_DEFLATE_FILE_H

#include "core/files/atomic_file.h"

#ifndef ZLIB_CONST
#define ZLIB_CONST /* makes zlib's header declare its input const */
#endif
#include <zlib.h>

/* The kinds of packing. CWI_DEFLATE has neither header nor checksum. */
typedef enum cwi_packing { CWI_STORED, CWI_GZIP, CWI_ZLIB, CWI_DEFLATE } cwi_packing;

/* A zeroed sink is closed. */
typedef struct cwi_sink {
    cwi_outfile *file; /* borrowed; NULL: bytes are only counted */
    uint64_t written;  /* number of bytes that went to the file, compressed */
    bool deflates;
    z_stream z;
    unsigned char *buffer;
} cwi_sink;

/* Starts a sink at the fastest level: most of the gain for a fraction of the time. */
CW_NODISCARD cw_status cwi_sink_open(cwi_sink *s, cwi_outfile *file, cwi_packing packing,
                                     cw_error *err);
CW_NODISCARD cw_status cwi_sink_write(cwi_sink *s, const void *bytes, size_t size,
                                      cw_error *err);

/* Writes the remaining output, and the checksum. */
CW_NODISCARD cw_status cwi_sink_finish(cwi_sink *s, cw_error *err);
void cwi_sink_close(cwi_sink *s);

#endif
