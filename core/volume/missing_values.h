/* The words in which messages tell of voxels that have no value. */
#ifndef CORE_VOLUME_MISSING_VALUES_H
#define CORE_VOLUME_MISSING_VALUES_H

#include <cubewright/volume.h>

enum { CWI_MISSING_TEXT = 192 };

/* Prints how many voxels have no value, why, and what makes values of them, as the end of a sentence that says
 * why nothing was found. Prints an empty text where all have one.
 * Without counts (NULL) it tells the no-data value alone. */
void cwi_tell_missing(const cw_volume *volume, const cw_statistics *counts,
                      char text[CWI_MISSING_TEXT]);

#endif
