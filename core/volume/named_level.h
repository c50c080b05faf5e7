/* Isovalues that have names, such as otsu and bone. */
#ifndef CORE_VOLUME_NAMED_LEVEL_H
#define CORE_VOLUME_NAMED_LEVEL_H

#include <cubewright/volume.h>

/* Bins of a histogram for Otsu's method. */
enum { CWI_LEVEL_BINS = 512 };

/* Returns true if values are in Hounsfield units: as the file says, or as those of a CT are, with
 * air near -1000.
 * values  statistics of the volume, with bins */
bool cwi_is_hounsfield(const cw_volume *volume, const cw_statistics *values);

/* Returns the isovalue of a CT in Hounsfield units between a tissue and what surrounds it.
 * name     bone, skin, soft, lung or metal
 * Returns false for others. */
bool cwi_hounsfield_level(const char *name, double *level);

/* Rounds a level to the six digits that are printed, so that these name the same surface. */
double cwi_round_level(double value);

#endif
