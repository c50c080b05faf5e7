/* libbz2 in zlib's place, for data that bzip2 compressed. */
#ifndef FORMATS_BYTES_BZIP2_H
#define FORMATS_BYTES_BZIP2_H

#include <cubewright/core.h>

#ifndef ZLIB_CONST
#define ZLIB_CONST
#endif
#include <zlib.h>

/* Bytes that a block of 900 000 can stand for, when each 5 of them are a run of 259, and the
 * fewest that it takes in a file: its header, tables, and a run of runs. */
enum { CWI_BZIP2_BLOCK = 900000 / 5 * 259, CWI_BZIP2_PACKED = 32 };

bool cwi_bzip2_present(void);

/* A state that decompresses; false when memory is out. */
bool cwi_bzip2_open(void **state);
void cwi_bzip2_close(void *state);

/* As inflate() on the stream's input and output, with zlib's codes; z->msg is set on
 * Z_DATA_ERROR. After Z_STREAM_END the next call begins another stream. */
int cwi_bzip2_inflate(void *state, z_stream *z);

#endif
