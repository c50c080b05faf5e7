/* ISA-L in zlib's place: twice as fast or more on machines it knows. */
#ifndef FORMATS_BYTES_ISAL_H
#define FORMATS_BYTES_ISAL_H

#include <cubewright/core.h>
#include <zlib.h>

/* A state that inflates gzip or zlib data, told apart by their first byte. NULL without ISA-L
 * in this build; false when memory is out. Free with cwi_free(). */
bool cwi_isal_open(void **state);

/* As inflate() on the stream's input and output, with zlib's codes; z->msg is set on
 * Z_DATA_ERROR. After Z_STREAM_END the next call begins another member; next_in may then have
 * gone back by up to 8 bytes, also to before where it was at the call. */
int cwi_isal_inflate(void *state, z_stream *z);

#endif
