/* Extraction of a volume slice by slice: for volumes and surfaces larger than memory. */
#ifndef CLI_EXTRACT_STREAM_RUN_H
#define CLI_EXTRACT_STREAM_RUN_H

#include "cli/extract/extract_run.h"

/* Returns an option of the run that needs the whole volume or surface in memory; NULL: slices
 * suffice. */
const char *cli_find_unstreamed(const cli_extract_args *args);

/* Lets go of the voxels where a surface did not fit memory beside them, if slices suffice. Returns
 * false if they do not. */
bool cli_turn_to_slices(cli_extract_run *run);

/* Plans the extraction of slices at an isovalue within --memory. Returns CW_ERR_LIMIT when that is
 * not enough. */
CW_NODISCARD cw_status cli_plan_slices(const cli_extract_run *run, double iso,
                                       const cw_slice_source *source, cw_stream_desc *desc,
                                       cw_error *err);

/* Extracts a surface of the run's volume, whose voxels were not read, into a spool beside the
 * path. Free it with cw_mesh_spool_free(). Unless the run says otherwise, it measures the surface
 * on the way and holds it to the promise: CW_ERR_CHECK. */
CW_NODISCARD cw_status cli_extract_streamed(cli_extract_run *run, const cli_moment *moment,
                                            cli_made *made, cw_mesh_spool **spool,
                                            cw_error *err);

#endif
