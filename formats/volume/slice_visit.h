/* Reading a volume slice by slice while its reader holds the file open: the reader calls back. */
#ifndef FORMATS_VOLUME_SLICE_VISIT_H
#define FORMATS_VOLUME_SLICE_VISIT_H

#include <cubewright/formats.h>

/* A request for slices in place of all voxels. A reader that can give slices calls
 * cwi_visit_slices() once; others read as always, or fail. */
typedef struct cwi_slice_visit {
    size_t component, step; /* of the values that are wanted */
    cw_status (*visit)(void *user, const cw_slice_source *source, cw_error *err);
    void *user;
    bool called;
} cwi_slice_visit;

/* Calls the visitor with slices of the chosen component.
 *
 * shape     of all slices, with the step chosen: dim, type, packed strides of slices with all
 *           components; components beyond a slice cannot be
 * read      gives slices, as in cw_slice_source; `user` is its state
 * Returns   CW_ERR_UNSUPPORTED when slices are not contiguous; what the visitor returned */
CW_NODISCARD cw_status cwi_visit_slices(cwi_slice_visit *v, const cw_volume *shape,
                                        cw_status (*read)(void *user, size_t first,
                                                          size_t count, void *to,
                                                          cw_error *err),
                                        void *user, cw_error *err);

#endif
