/* From a volume that was read to its surface: for every command that needs one. */
#ifndef CLI_INPUTS_EXTRACT_SURFACE_H
#define CLI_INPUTS_EXTRACT_SURFACE_H

#include "cli/inputs/cut_options.h"
#include "cli/inputs/filter_options.h"
#include "cli/inputs/volume_input.h"

#include <cubewright/extract.h>
#include <cubewright/simplify.h>
#include <cubewright/smooth.h>
#include <cubewright/stream.h>

/* Memory beside the slices and the program so far, when a surface is made slice by slice: the
 * writer of a file, threads, buffers. */
enum { CLI_BESIDE_SLICES = 10 << 20 };

/* Returns the bytes that checking and writing a surface take for a triangle. */
size_t cli_check_bytes(void);

/* A volume whose surface is to be made slice by slice. */
typedef struct cli_slices {
    const char *path;
    size_t limit; /* of --memory */
    bool turned;  /* its voxels were read first, and freed: their peak does not count */
} cli_slices;

/* Returns the memory that a program which makes the surface slice by slice needs at least.
 * taken: by the program so far */
size_t cli_slices_bytes(const cw_volume *shape, const cw_stream_desc *desc, size_t taken);

/* Limits the memory of a description to that which is left of --memory.
 * Returns CW_ERR_LIMIT when that is not enough */
CW_NODISCARD cw_status cli_limit_slices(const cli_slices *slices, const cw_volume *shape,
                                        cw_stream_desc *desc, cw_error *err);

/* cw_extract() with progress, within the memory that is left, and with an empty result turned
 * into CW_ERR_EMPTY that tells the range of the values. Errors name the file.
 * extractor  of volume->view, for another surface of it; NULL: this one by itself */
CW_NODISCARD cw_status cli_extract_surface(const cli_volume *volume, cw_extractor *extractor,
                                           const cw_extract_desc *desc, cw_mesh *mesh,
                                           cw_extract_counts *counts, cw_error *err);

/* Settings of a surface to extract. */
typedef struct cli_wanted {
    cw_extract_desc extract;
    double least_mm3;       /* components that enclose less are left out; default: none is */
    size_t largest;         /* components to keep; default: all */
    bool fill_voids;        /* closed components in others are left out, too */
    cw_drop_counts *filled; /* set to their counts; may be NULL */
    cw_drop_counts
        *smaller; /* set to the counts of those that `largest` leaves out; may be NULL */
    bool smooths; /* then, by this: */
    cw_smooth_desc smooth;
    cw_smooth_facts *smoothed; /* set to what that did; may be NULL */
    const cli_plane *cut;      /* plane to cut the surface by at last; default: it is not cut */
    cw_cut_facts *cut_facts;   /* set to what that did; may be NULL */
} cli_wanted;

/* Returns true if components are left out, or all is smoothed: the surface is needed as a whole. */
bool cli_wants_whole(const cli_wanted *wanted);

/* Fails with CW_ERR_EMPTY: all components enclose less than a volume. */
cw_status cli_fail_dropped(double least_mm3, const cw_drop_counts *dropped, cw_error *err);

/* The same without the components that are too small, smoothed and cut, if it is to be.
 * dropped   may be NULL
 * Returns   CW_ERR_EMPTY also when all are, and how much the largest encloses */
CW_NODISCARD cw_status cli_extract_wanted(const cli_volume *volume, cw_extractor *extractor,
                                          const cli_wanted *wanted, cw_mesh *mesh,
                                          cw_extract_counts *counts, cw_drop_counts *dropped,
                                          cw_error *err);

/* The same, simplified slab by slab while it is extracted, so that all of it never is in
 * memory, unless it is needed as a whole. With normals of the field, unless there are to be none,
 * or the surface is smoothed.
 * simplify  as for cw_simplifier_new()
 * counts    of the surface as it came */
CW_NODISCARD cw_status cli_extract_simplified(const cli_volume *volume,
                                              const cli_wanted *wanted,
                                              const cw_simplify_desc *simplify, cw_mesh *mesh,
                                              cw_extract_counts *counts,
                                              cw_drop_counts *dropped, cw_error *err);

#endif
