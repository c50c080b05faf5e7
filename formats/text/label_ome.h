/* Reads the image-label of OME-Zarr, which is in its stores, and in files of labels by
 * themselves. */
#ifndef FORMATS_TEXT_LABEL_OME_H
#define FORMATS_TEXT_LABEL_OME_H

#include <cubewright/label_table.h>

struct json_t;

/* Fills a zeroed table from the object "image-label": its colors, and the names among its
 * properties. The caller frees the table, on failure too.
 * Returns CW_ERR_FORMAT, which names the key; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_label_ome_read(const struct json_t *image, cw_label_table *table,
                                          cw_error *err);

#endif
