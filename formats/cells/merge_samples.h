/* Merging of samples with the same place and the same value. */
#ifndef FORMATS_CELLS_MERGE_SAMPLES_H
#define FORMATS_CELLS_MERGE_SAMPLES_H

#include <cubewright/core.h>

/* Maps every sample to the first one that is the same to the bit in place and value.
 * points       count x 3, without negative zeros; count below 2^32 - 1
 * values       count x value_bytes
 * map          count; on success every entry is at most its index
 * same         set to the number of samples that are not the first
 * Returns false when memory is out; takes 8 to 16 bytes a sample. */
bool cwi_samples_map(const double *points, const void *values, size_t value_bytes, size_t count,
                     uint32_t *map, size_t *same);

/* Keeps only the first ones of equal samples, in their order, and makes map give their new
 * numbers. */
void cwi_samples_drop(double *points, void *values, size_t value_bytes, size_t count,
                      uint32_t *map);

#endif
