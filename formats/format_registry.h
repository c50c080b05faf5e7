/* The two tables of formats: readers and writers are rows, found by content, extension
 * or name. */
#ifndef FORMATS_FORMAT_REGISTRY_H
#define FORMATS_FORMAT_REGISTRY_H

#include <cubewright/formats.h>

#endif
