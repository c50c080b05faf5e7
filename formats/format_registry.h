/* The two tables of formats: readers and writers are rows, found by content, extension or name.
 */
#ifndef FORMATS_FORMAT_REGISTRY_H
#define FORMATS_FORMAT_REGISTRY_H

#include <cubewright/formats.h>

/* Whether a path ends in one of the blank-separated extensions, in any case of letters. */
bool cwi_has_extension(const char *path, const char *extensions);

#endif
