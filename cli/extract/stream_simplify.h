/* Simplification of a surface while its volume is read slice by slice. */
#ifndef CLI_EXTRACT_STREAM_SIMPLIFY_H
#define CLI_EXTRACT_STREAM_SIMPLIFY_H

#include "cli/extract/extract_run.h"

/* Extracts and simplifies a surface of the run's volume, whose voxels were not read: the mesh is
 * that of cli_extract_make(), to the bit. Free it with cw_mesh_free().
 * Returns  CW_ERR_LIMIT when --memory is too low for slices and mesh */
CW_NODISCARD cw_status cli_simplify_streamed(cli_extract_run *run, const cli_moment *moment,
                                             cli_made *made, cw_mesh *mesh,
                                             cw_extract_counts *counts, cw_error *err);

#endif
