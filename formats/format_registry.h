/* The list of the formats that this project knows, and functions to find one of them. */
#ifndef FORMATS_FORMAT_REGISTRY_H
#define FORMATS_FORMAT_REGISTRY_H

#include "formats/driver/format_driver.h"

/* Returns the n-th format; NULL when there are fewer. */
const cwi_format_driver *cwi_format_at(size_t n);

/* Finds a format by its name; returns NULL when there is none. */
const cwi_format_driver *cwi_find_format(const char *name);

/* Returns true if the format reads volumes from the content of files; voxels without a header
 * need a layout. */
bool cwi_reads_volume(const cwi_format_driver *format);

/* Lists formats for a message: the text that `text_of` gives for each, where it is not NULL. A
 * separator stands before each but the first. Returns list. */
enum { CWI_FORMAT_LIST = 256 };
const char *cwi_list_formats(const char *(*text_of)(const cwi_format_driver *),
                             const char *separator, char list[CWI_FORMAT_LIST]);

/* Returns the extensions of files that are read as volumes. */
const char *cwi_volume_extensions(const cwi_format_driver *format);

#endif
