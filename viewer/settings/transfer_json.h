/* Parses transfer functions from bytes in memory. */
#ifndef VIEWER_SETTINGS_TRANSFER_JSON_H
#define VIEWER_SETTINGS_TRANSFER_JSON_H

#include <cubewright/transfer.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Does the same as cw_transfer_read(), for the file's bytes; transfer is unchanged on
 * failure. */
CW_NODISCARD cw_status cwi_transfer_parse(const char *bytes, size_t size, cw_transfer *transfer,
                                          cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
