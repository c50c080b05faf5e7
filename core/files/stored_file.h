/* Files without a path, as readers and writers see them. */
#ifndef CORE_FILES_STORED_FILE_H
#define CORE_FILES_STORED_FILE_H

#include <cubewright/stored_file.h>

#include "core/files/atomic_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A file whose bytes are kept. */
struct cw_stored_file {
    int fd;
    uint64_t size;
    size_t counted; /* bytes of it that count as memory */
    char *name;     /* for extensions and messages */
};

/* Keeps a regular file that is open already, without a copy of its bytes.
 * fd       becomes the stored file's on success
 * Returns  CW_ERR_IO for an empty file, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_stored_file_adopt(int fd, uint64_t size, const char *name,
                                             cw_stored_file **file, cw_error *err);

/* Opens the bytes once more, with a position of their own. The caller closes *fd.
 * Returns CW_ERR_IO */
CW_NODISCARD cw_status cwi_stored_file_reopen(const cw_stored_file *file, int *fd,
                                              cw_error *err);

/* A file that is written for a sink. Zeroed, with fd -1: none. */
typedef struct cwi_byte_output {
    const cw_byte_sink *sink;
    int fd;
} cwi_byte_output;

/* Opens an output whose bytes will go to a sink. Commit or abort `out`, then close the sink's file.
 * Returns CW_ERR_ARGUMENT for a sink without write; CW_ERR_OUTPUT, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_byte_output_open(cwi_byte_output *file, const cw_byte_sink *sink,
                                            cwi_outfile **out, cw_error *err);

/* Passes the bytes of a committed output to its sink. Returns what the sink returned; CW_ERR_IO,
 * CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_byte_output_deliver(const cwi_byte_output *file, cw_error *err);

/* Harmless on a file that is not open. */
void cwi_byte_output_close(cwi_byte_output *file);

#ifdef __cplusplus
}
#endif

#endif
