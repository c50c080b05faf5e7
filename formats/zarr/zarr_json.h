/* The JSON documents of a Zarr store, and checked access to their members. */
#ifndef FORMATS_ZARR_ZARR_JSON_H
#define FORMATS_ZARR_ZARR_JSON_H

#include "formats/bytes/input_file.h"

#include <jansson.h>

/* A parsed document. A zeroed one is closed. */
typedef struct cwi_zarr_json {
    json_t *root;
    size_t taken; /* bytes that it takes of the memory limit */
} cwi_zarr_json;

/* Opens and parses a file below the store's folder; root stays NULL where the file is missing.
 * All numbers become reals. Messages name the file.
 * Returns CW_ERR_LIMIT for more than 16 MiB, CW_ERR_FORMAT for anything but an object,
 * CW_ERR_UNSAFE, CW_ERR_IO, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_zarr_json_open(cwi_zarr_json *json, const cwi_input *in,
                                          const char *name, cw_error *err);
void cwi_zarr_json_close(cwi_zarr_json *json);

/* Returns true if the store's folder has a file. */
bool cwi_zarr_has_file(const cwi_input *in, const char *name);

/* Returns an item's text; NULL when it is missing or no text. */
const char *cwi_zarr_text(const json_t *object, const char *key);

/* Returns true if an item is missing or null. */
bool cwi_zarr_is_absent(const json_t *object, const char *key);

/* Reads a list of `count` numbers, or of whole numbers from 1 to 2^53. */
CW_NODISCARD cw_status cwi_zarr_numbers(const json_t *object, const char *key, size_t count,
                                        double *out, cw_error *err);
CW_NODISCARD cw_status cwi_zarr_sizes(const json_t *object, const char *key, size_t count,
                                      size_t *out, cw_error *err);

/* Prints "'key' is VALUE; WANTED was expected". */
cw_status cwi_zarr_fail(cw_error *err, const json_t *object, const char *key,
                        const char *expected);

#endif
