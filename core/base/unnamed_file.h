/* Temporary files without a name, which end with the process. */
#ifndef CORE_BASE_UNNAMED_FILE_H
#define CORE_BASE_UNNAMED_FILE_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Returns the folder of a path, "." where it names none. NULL when memory is out; free it with cwi_free(). */
char *cwi_folder_of(const char *path);

/* Opens an empty file in a folder, to be closed with close(). *file is -1 on failure.
 * Returns CW_ERR_OUTPUT, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_unnamed_open(const char *folder, int *file, cw_error *err);

/* Opens an empty file in memory, to be closed with close(). *file is -1 on failure.
 * Returns CW_ERR_OUTPUT */
CW_NODISCARD cw_status cwi_unnamed_open_memory(int *file, cw_error *err);

/* Writes bytes at an offset. folder: of the file, for the message
 * Returns CW_ERR_OUTPUT when the disk is full. */
CW_NODISCARD cw_status cwi_unnamed_write(const char *folder, int file, size_t at,
                                         const void *from, size_t bytes, cw_error *err);

/* Reads bytes at an offset, all of which were written. Returns CW_ERR_IO. */
CW_NODISCARD cw_status cwi_unnamed_read(int file, size_t at, void *to, size_t bytes,
                                        cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
