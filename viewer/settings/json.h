/* Reads small files of settings in JSON, with errors that name the field or the line. */
#ifndef VIEWER_SETTINGS_JSON_H
#define VIEWER_SETTINGS_JSON_H

#include <cubewright/core.h>

#include <jansson.h>

/* Calls parse with all bytes of a file of up to 1 MiB; errors name the file.
 * Returns CW_ERR_IO, CW_ERR_FORMAT for a larger one, CW_ERR_NO_MEMORY, or what parse does. */
CW_NODISCARD cw_status cwi_json_read(const char *path,
                                     cw_status (*parse)(const char *bytes, size_t size,
                                                        void *out, cw_error *err),
                                     void *out, cw_error *err);

/* Parses one object whose 'schema' is `schema`, and whose keys are all in `keys`, a list that
 * ends with NULL. Free it with json_decref(). CW_ERR_FORMAT */
CW_NODISCARD cw_status cwi_json_object(const char *bytes, size_t size, const char *schema,
                                       const char *const *keys, json_t **root, cw_error *err);

/* Reads a number of an object, if it is present. CW_ERR_FORMAT for other types. */
CW_NODISCARD cw_status cwi_json_number(const json_t *root, const char *key, double *value,
                                       cw_error *err);

/* Print the shortest text that reads back as the same double, or as the same float. */
enum { CWI_JSON_NUMBER = 32 };
const char *cwi_json_double(char text[CWI_JSON_NUMBER], double value);
const char *cwi_json_float(char text[CWI_JSON_NUMBER], float value);

#endif
