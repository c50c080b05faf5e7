/* Files without a path: bytes in memory, or from and to functions of the caller. */
#ifndef CUBEWRIGHT_STORED_FILE_H
#define CUBEWRIGHT_STORED_FILE_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The bytes of one file: an array, or a function that gives them piece by piece. Zero-initialise
 * it and set what you need. */
typedef struct cw_byte_source {
    uint32_t version; /* 0: the first version of this struct */
    const char
        *name; /* a file name such as "scan.nrrd": its extension counts where content does
                         not tell the format, and messages begin with it; default: "(memory)",
                         with read "(stream)" */
    const void *bytes; /* size of them, or NULL: then read is called */
    uint64_t size; /* with read: the number of bytes that it will give; 0: as many as come */

    /* Stores the next bytes, up to `capacity`, and sets *got to their number; 0: the end. A
     * status other than CW_OK ends the call, which then returns it. Called on the calling thread,
     * until the end alone. */
    cw_status (*read)(void *user, void *to, size_t capacity, size_t *got, cw_error *err);
    void *user;         /* passed to read */
    uint64_t max_bytes; /* more are CW_ERR_LIMIT; default: no limit */
    const char *folder; /* the bytes are kept in a temporary file in it; default: in memory */
} cw_byte_source;

/* The bytes of a file that has no path, kept for calls that read them. They are in a file without
 * a name, which ends with the process at the latest. Several threads may read it at the same time. */
typedef struct cw_stored_file cw_stored_file;

/* Keeps the bytes of a source, to be read as often as needed: cw_read_desc.stored and
 * cw_mesh_read_desc.stored. For one call alone there are cw_volume_read_memory() and
 * cw_mesh_read_memory().
 *
 * source   borrowed until the call returns
 * file     set to the stored file, to be closed with cw_stored_file_close(); NULL on failure
 * Returns  CW_ERR_ARGUMENT   neither bytes nor read, or both; read reports more than its capacity
 *          CW_ERR_IO         no bytes; fewer or more than `size` states, naming both numbers
 *          CW_ERR_LIMIT      more than max_bytes
 *          CW_ERR_NO_MEMORY  cw_memory_limit() leaves no room for them
 *          CW_ERR_OUTPUT     the folder cannot be written, or its disk is full; what read returned
 * Cost     one copy of the bytes. In memory they count for cw_memory_limit() */
CW_NODISCARD CW_API cw_status cw_stored_file_open(const cw_byte_source *source,
                                                  cw_stored_file **file, cw_error *err);

/* Drops the bytes.
 * file  a stored file that no call reads any more, or NULL */
CW_API void cw_stored_file_close(cw_stored_file *file);

/* Returns the number of bytes; 0 for NULL.
 * file  a stored file, or NULL */
CW_API uint64_t cw_stored_file_size(const cw_stored_file *file);

/* A receiver of the bytes of a file that is written, in place of a path: cw_write_desc.sink. It
 * is called on the calling thread once the whole file is made, so that it gets all of it or
 * nothing, unless it fails itself. A status other than CW_OK ends the call, which then returns
 * it. Zero-initialise it and set what you need. */
typedef struct cw_byte_sink {
    uint32_t version; /* 0: the first version of this struct */
    /* Called first, with the number of bytes that follow. Default: none */
    cw_status (*begin)(void *user, uint64_t size, cw_error *err);
    /* Takes the next bytes, up to 1 MiB at a time. Required */
    cw_status (*write)(void *user, const void *bytes, size_t size, cw_error *err);
    void *user;         /* passed to both */
    const char *folder; /* until then the file is a temporary one in it; default: in memory,
                           where it counts for cw_memory_limit() */
} cw_byte_sink;

#ifdef __cplusplus
}
#endif

#endif
