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

/* Lists formats for a message: what `text_of` gives of each, where it is not NULL, each behind a
 * separator, without which the first begins. Returns list. */
enum { CWI_FORMAT_LIST = 256 };
const char *cwi_list_formats(const char *(*text_of)(const cwi_format_driver *),
                             const char *separator, char list[CWI_FORMAT_LIST]);

/* The extensions of files that are read as volumes. */
const char *cwi_volume_extensions(const cwi_format_driver *format);

#endif
