/* Numbers in files that no type of voxels has: integers of 64 bits, and floats of 16. */
#ifndef FORMATS_BYTES_STORED_NUMBERS_H
#define FORMATS_BYTES_STORED_NUMBERS_H

#include <cubewright/volume.h>

/* The form of numbers in a file. */
typedef enum cwi_stored {
    CWI_STORED_PLAIN, /* that of the type of voxels */
    CWI_STORED_I64,   /* integers of 64 bits; they become CW_I32 or CW_U32 */
    CWI_STORED_U64,
    CWI_STORED_F16 /* IEEE 754 floats of 16 bits; they become CW_F32 */
} cwi_stored;

/* Returns the bytes of a number in the file. `type` is that of the voxels. */
size_t cwi_stored_size(cwi_stored stored, cw_type type);

/* Returns the type of voxels for a form other than CWI_STORED_PLAIN. */
cw_type cwi_stored_type(cwi_stored stored);

/* Returns the name of the form, such as "int64". */
const char *cwi_stored_name(cwi_stored stored);

/* Converts numbers in this machine's order to voxels of a type, packed. `stride` bytes are between
 * the numbers. Returns the count of those converted: less than `count` where the next one does not
 * fit the type. */
CW_API size_t cwi_stored_convert(cwi_stored stored, cw_type type, const void *from,
                                 size_t stride, size_t count, void *to);

/* Returns the float of 16 bits that is nearest to a value. */
uint16_t cwi_stored_half(double value);

/* Reports an integer that does not fit. Returns CW_ERR_FORMAT. */
CW_API cw_status cwi_stored_fail(cwi_stored stored, cw_type type, const void *number,
                                 cw_error *err);

/* Returns true for an integer that does not fit CW_I32, but CW_U32. */
bool cwi_stored_needs_u32(cwi_stored stored, const void *number);

#endif
