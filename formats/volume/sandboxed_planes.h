/* Planes of pixels that a library in a sandboxed process reads from files: the common interface
 * of the modules "tiff", "picture", "hdf5", "dicom" and "openvdb". */
#ifndef FORMATS_VOLUME_SANDBOXED_PLANES_H
#define FORMATS_VOLUME_SANDBOXED_PLANES_H

#include "core/base/sandbox.h"

#include <cubewright/formats.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum cwi_plane_op {
    CWI_PLANE_FACTS, /* open the file handed over and put its facts into the shared memory */
    CWI_PLANE_PIXELS /* put rows of one of its planes there: packed, native byte order */
} cwi_plane_op;

typedef struct cwi_plane_request {
    cwi_plane_op op;
    uint32_t plane, first_row, row_count;
    uint32_t image; /* which one of several in the file */
    uint64_t file_bytes;
} cwi_plane_request;

enum { CWI_PLANES_SHARED = 64 << 20 };

/* The functions that a module exports. The facts have a struct of the module's own. */
typedef struct cwi_plane_functions {
    void *(*state_new)(void); /* NULL: out of memory */
    void (*state_free)(void *state);
    cw_status (*prepare)(cw_error *err); /* while files may still be opened; may be NULL */
    cwi_sandbox_work work;               /* handles a cwi_plane_request */
} cwi_plane_functions;

/* A library in its process. A zeroed one is closed. It must not move after it was opened. */
typedef struct cwi_planes {
    const char *module;
    const cwi_plane_functions *functions; /* in the process that reads */
    void *state;                          /* also there */
    uint32_t image;                       /* which one of several in each file; default: 0 */
    cwi_sandbox box;
} cwi_planes;

/* Starts a process and loads a module in it; `library` names the library inside, for messages.
 * Returns  CW_ERR_UNSUPPORTED  not in this build; as cwi_sandbox_open() */
CW_NODISCARD cw_status cwi_planes_open(cwi_planes *planes, const char *module,
                                       const char *library, const cw_read_desc *desc,
                                       cw_error *err);
void cwi_planes_close(cwi_planes *planes);

/* Starts the process again where it has ended. */
CW_NODISCARD cw_status cwi_planes_restart(cwi_planes *planes, cw_error *err);

/* Hands a file over. Returns its facts, or fails as the module does. Copy them, then check. */
CW_NODISCARD cw_status cwi_planes_facts(cwi_planes *planes, int fd, uint64_t file_bytes,
                                        const void **facts, cw_error *err);

/* Reads rows of a plane of the file that was handed over last.
 * row_bytes  of each row as the module packs it, at most CWI_PLANES_SHARED */
CW_NODISCARD cw_status cwi_planes_read(cwi_planes *planes, uint32_t plane, size_t first_row,
                                       size_t row_count, size_t row_bytes, void *to,
                                       cw_error *err);

/* Reads the first planes of that file, and drops the pixels: a damaged one is an error. */
CW_NODISCARD cw_status cwi_planes_try(cwi_planes *planes, uint32_t count, size_t row_count,
                                      size_t row_bytes, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
