/* From a volume that was read to its surface: for every command that needs one. */
#ifndef CLI_SURFACE_H
#define CLI_SURFACE_H

#include "cli/input.h"

#include <cubewright/extract.h>
#include <cubewright/simplify.h>

/* cw_extract() with progress, within the memory that is left, and with an empty result turned
 * into CW_ERR_EMPTY that tells the range of the values. Errors name the file.
 * extractor  of volume->view, for another surface of it; NULL: this one by itself */
cw_status cli_extract_surface(const cli_volume *volume, cw_extractor *extractor,
                              const cw_extract_desc *desc, cw_mesh *mesh,
                              cw_extract_counts *counts, cw_error *err);

/* The same surface, simplified slab by slab while it is extracted, so that all of it never is
 * in memory; with normals of the field, unless desc says that there are to be none.
 * simplify  as for cw_simplifier_new()
 * counts    of the surface as it came */
cw_status cli_extract_simplified(const cli_volume *volume, const cw_extract_desc *desc,
                                 const cw_simplify_desc *simplify, cw_mesh *mesh,
                                 cw_extract_counts *counts, cw_error *err);

/* The level where nobody said one: of level sets 0, else by Otsu. how  is set to a word for
 * it. CW_ERR_EMPTY: no level parts the values. */
cw_status cli_find_level(const cli_volume *volume, int threads, double *iso, const char **how,
                         cw_error *err);

#endif
