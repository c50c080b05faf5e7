/* Numbers of an array in memory: held as voxels are, whole ones of 64 bits among them. */
#ifndef FORMATS_VOLUME_GRID_ARRAYS_H
#define FORMATS_VOLUME_GRID_ARRAYS_H

#include "formats/volume/voxel_source.h"

/* A zeroed one is empty. */
typedef struct cwi_tuples {
    cw_volume data;
    size_t count, components;
    bool wide;    /* of 64 bits: as two halves, in the machine's order */
    size_t bytes; /* in memory */
} cwi_tuples;

/* Describes so many tuples, but for where and how they are written. wide: whole numbers of 64
 * bits, and type that of their halves. field is where the file counts them. */
CW_NODISCARD cw_status cwi_tuples_describe(cwi_source *src, const char *field, cw_type type,
                                           bool wide, size_t components, size_t count,
                                           cw_error *err);

/* Reads what was described so, of which wide, components and count are given once more. */
CW_NODISCARD cw_status cwi_tuples_load(const cwi_source *src, const cwi_input *in,
                                       const cw_read_desc *desc, bool wide, cwi_tuples *tuples,
                                       cw_error *err);
void cwi_tuples_free(cwi_tuples *tuples);

double cwi_tuples_real(const cwi_tuples *tuples, size_t i, size_t component);

/* The first of a tuple, as a whole number; what is beyond 2^53 names nothing here, and stays
 * so. */
int64_t cwi_tuples_whole(const cwi_tuples *tuples, size_t i);

#endif
