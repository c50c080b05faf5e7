/* Reads the image-label of OME-Zarr, which is in its stores, and in files of labels by
 * themselves. */
#ifndef FORMATS_TEXT_LABEL_OME_H
#define FORMATS_TEXT_LABEL_OME_H

#include <cubewright/label_table.h>

struct json_t;

/* Reads a whole number from 0 to max, which may be written as 5.0. Returns CW_ERR_FORMAT, which names
 * the field. */
CW_NODISCARD cw_status cwi_json_read_whole(const struct json_t *json, const char *field,
                                           uint32_t max, uint32_t *value, cw_error *err);

/* Returns the text of a string, borrowed, or NULL for an empty one and anything else. */
char *cwi_json_text(const struct json_t *json);

/* Fills a zeroed table from the object "image-label": its colors, and the names among its
 * properties. The caller frees the table, on failure too.
 * Returns CW_ERR_FORMAT, which names the key; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_label_ome_read(const struct json_t *image, cw_label_table *table,
                                          cw_error *err);

#endif
