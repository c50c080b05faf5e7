/* The folder of a path that is written, and the name of the hidden temporary in it. */
#ifndef CORE_FILES_TEMPORARY_NAME_H
#define CORE_FILES_TEMPORARY_NAME_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Bytes of a file's name in its folder, with the zero at the end: NAME_MAX of Linux + 1. */
enum { CWI_FILE_NAME_BYTES = 256 };

/* Opens the folder that a path with resolved links is in, and copies its last name. Returns
 * CW_ERR_OUTPUT for a folder that is missing or cannot be opened, and for a path that ends in a
 * slash. */
CW_NODISCARD cw_status cwi_open_parent(const char *path, int *folder,
                                       char name[CWI_FILE_NAME_BYTES], cw_error *err);

/* Makes a name such as ".head.glb.k3x0aq.part", another one at each call. Long names are cut to
 * fit a directory entry. */
void cwi_name_temporary(const char *name, char temporary[CWI_FILE_NAME_BYTES]);

#ifdef __cplusplus
}
#endif

#endif
