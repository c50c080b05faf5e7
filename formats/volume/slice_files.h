/* Slices in files of their own: which files count, whether they belong together, and their places. */
#ifndef FORMATS_VOLUME_SLICE_FILES_H
#define FORMATS_VOLUME_SLICE_FILES_H

#include "formats/volume/slice_stack.h"
#include "formats/volume/volume_reader.h"

/* A format of slices, by the functions of its reader. */
typedef struct cwi_slice_kind {
    const char *name, *extensions; /* "TIFF", ".tif .tiff" */
    cwi_volume_sniffer *sniff;
    /* Reads the facts of an open file; those of the first one are kept. */
    cw_status (*look)(void *user, int fd, uint64_t size, bool is_first, cw_error *err);
    /* Checks that the last file belongs to the first one. */
    cw_status (*compare)(void *user, cw_error *err);
    void *user;
} cwi_slice_kind;

/* Finds the files of the format, by name, else by content: a damaged slice counts, too. They must be in
 * one folder, unless a pattern names them.
 * Returns CW_ERR_FORMAT where there is none, CW_ERR_UNSAFE for several folders */
CW_NODISCARD cw_status cwi_slice_files_find(const cwi_slice_kind *kind, const cwi_input *in,
                                            const cwi_names *names, const cw_read_desc *desc,
                                            cwi_names *files, cw_error *err);

/* Looks into every file, before any pixels are read. Damaged ones are left out of the names if
 * desc->skip_damaged is set. */
CW_NODISCARD cw_status cwi_slice_files_look(const cwi_slice_kind *kind, const cwi_input *in,
                                            cwi_planes *planes, const cw_read_desc *desc,
                                            cwi_names *files, cw_error *err);

/* Stacks planes of a file each by the numbers in which their names differ. *count is set to that of the
 * slices, which desc->gaps may make more. */
CW_NODISCARD cw_status cwi_slice_files_stack(const cwi_names *files, const cw_read_desc *desc,
                                             cwi_stack *stack, size_t *count, cw_error *err);

#endif
