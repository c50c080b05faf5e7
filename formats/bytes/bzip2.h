/* Decompression of bzip2 data by libbz2, with the interface of zlib's inflate(). */
#ifndef FORMATS_BYTES_BZIP2_H
#define FORMATS_BYTES_BZIP2_H

#include <cubewright/core.h>

#ifndef ZLIB_CONST
#define ZLIB_CONST
#endif
#include <zlib.h>

/* Bounds of bzip2. A block of 900 000 bytes can stand for this many bytes, when each 5 of them
 * are a run of 259. The minimum size of a block in a file is its header, tables, and a run of
 * runs. */
enum { CWI_BZIP2_BLOCK = 900000 / 5 * 259, CWI_BZIP2_PACKED = 32 };

bool cwi_bzip2_present(void);

/* Makes a state that decompresses; returns false when memory is out. */
bool cwi_bzip2_open(void **state);
void cwi_bzip2_close(void *state);

/* Decompresses like inflate() on the stream's input and output, with zlib's codes. z->msg is
 * set on Z_DATA_ERROR. After Z_STREAM_END the next call begins another stream. */
int cwi_bzip2_inflate(void *state, z_stream *z);

#endif
