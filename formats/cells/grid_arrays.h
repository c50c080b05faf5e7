/* Arrays of tuples in memory, stored like voxels, including whole numbers of 64 bits. */
#ifndef FORMATS_CELLS_GRID_ARRAYS_H
#define FORMATS_CELLS_GRID_ARRAYS_H

#include "formats/volume/voxel_source.h"

/* An array in memory. A zeroed one is empty. */
typedef struct cwi_tuples {
    cw_volume data;
    size_t count, components;
    bool wide;    /* numbers of 64 bits: two halves, in the machine's order */
    size_t bytes; /* in memory */
} cwi_tuples;

/* Describes an array of `count` tuples, without the place and encoding of its numbers. wide:
 * whole numbers of 64 bits; type is then that of their halves. field: name of the count in the
 * file. */
CW_NODISCARD cw_status cwi_tuples_describe(cwi_source *src, const char *field, cw_type type,
                                           bool wide, size_t components, size_t count,
                                           cw_error *err);

/* Reads an array that was described; wide, components and count are passed again. */
CW_NODISCARD cw_status cwi_tuples_load(const cwi_source *src, const cwi_input *in,
                                       const cw_read_desc *desc, bool wide, cwi_tuples *tuples,
                                       cw_error *err);
void cwi_tuples_free(cwi_tuples *tuples);

double cwi_tuples_real(const cwi_tuples *tuples, size_t i, size_t component);

/* Returns the first number of a tuple as a whole number. Numbers beyond 2^53 are invalid here,
 * and stay invalid. */
int64_t cwi_tuples_whole(const cwi_tuples *tuples, size_t i);

#endif
