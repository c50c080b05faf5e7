/* The formats that this project knows, and how one is found by its name. */
#ifndef FORMATS_FORMAT_REGISTRY_H
#define FORMATS_FORMAT_REGISTRY_H

#include "formats/driver/format_driver.h"

/* The n-th format; NULL when there are fewer. */
const cwi_format_driver *cwi_format_at(size_t n);

/* NULL: no format has that name. */
const cwi_format_driver *cwi_find_format(const char *name);

/* Whether it reads volumes from what is in a file; voxels without a header need a layout. */
bool cwi_reads_volume(const cwi_format_driver *format);

/* The extensions of files that are read as volumes. */
const char *cwi_volume_extensions(const cwi_format_driver *format);

#endif
