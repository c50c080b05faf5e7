/* The open file of the module "picture". All of it runs in a sandboxed process. */
#ifndef FORMATS_PICTURE_PICTURE_FILE_H
#define FORMATS_PICTURE_PICTURE_FILE_H

#include "formats/picture/picture.h"

typedef struct cwi_picture_file {
    int fd;
    uint64_t size, at;
    cwi_picture_facts facts;
    unsigned char *pixels; /* all rows; NULL: not decoded yet */
} cwi_picture_file;

/* Reads bytes at an offset; false where the file ends before. */
bool cwi_picture_read_at(const cwi_picture_file *f, uint64_t offset, void *to, size_t size);

/* Checks sizes against those of the file, then allocates the pixels. */
CW_NODISCARD cw_status cwi_picture_reserve(cwi_picture_file *f, cw_error *err);

/* Returns the bytes of a row of pixels. */
size_t cwi_picture_row(const cwi_picture_facts *facts);

/* Returns true if a palette has greys alone. `step` bytes are between its colours. */
bool cwi_picture_is_grey(const unsigned char *palette, size_t count, size_t step);

/* Read the facts and, if asked for, all pixels. */
CW_NODISCARD cw_status cwi_picture_png(cwi_picture_file *f, bool with_pixels, cw_error *err);
CW_NODISCARD cw_status cwi_picture_bmp(cwi_picture_file *f, bool with_pixels, cw_error *err);

#endif
