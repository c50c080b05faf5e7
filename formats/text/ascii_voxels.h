/* Reading of voxels that are written as decimal numbers. */
#ifndef FORMATS_TEXT_ASCII_VOXELS_H
#define FORMATS_TEXT_ASCII_VOXELS_H

#include "formats/bytes/inflate_stream.h"

#include <cubewright/volume.h>

/* Blank-separated numbers of a plain stream, one after another. Zero it, except for its
 * stream. */
typedef struct cwi_numbers {
    cwi_stream *stream; /* borrowed */
    const char *noun;   /* name of the numbers' meaning, for messages */
    uint64_t count;     /* numbers read so far, for messages */
    size_t next, size;  /* in text */
    char text[4096];
} cwi_numbers;

/* Reads the next count numbers into voxels of a type. `to` may be NULL: they are then only
 * checked.
 * Returns CW_ERR_FORMAT for fewer, for anything else, for a number the type cannot hold. */
CW_NODISCARD cw_status cwi_numbers_read(cwi_numbers *numbers, cw_type type, void *to,
                                        size_t count, cw_error *err);

#endif
