/* Extraction of a volume slice by slice: for volumes and surfaces larger than memory. */
#ifndef CLI_EXTRACT_STREAM_RUN_H
#define CLI_EXTRACT_STREAM_RUN_H

#include "cli/extract/extract_run.h"

/* Lets go of the voxels if a status says that --memory was too low beside them, and slices
 * suffice. Returns false if not. */
bool cli_turn_to_slices(cli_extract_run *run, cw_status st);

/* Gives the slices of the run's volume at a moment to a visitor. Says so if the run was not asked
 * for it. */
CW_NODISCARD cw_status cli_visit_moment(const cli_extract_run *run, const cli_moment *moment,
                                        const cw_slice_visitor *visitor, cw_error *err);

/* Computes the settings of the surface of slices at an isovalue, within --memory. Returns
 * CW_ERR_LIMIT when that is not enough. */
CW_NODISCARD cw_status cli_plan_slices(const cli_extract_run *run, double iso,
                                       const cw_slice_source *source,
                                       cli_surface_settings *settings, cw_error *err);

/* A surface of slices: simplified in memory, else in a spool beside its file. */
typedef struct cli_streamed {
    cw_mesh mesh;
    cw_mesh_spool *spool; /* NULL: in memory */
} cli_streamed;

/* Makes a surface of the run's volume, whose voxels were not read. Free it with cli_free_streamed().
 * Unless the run says otherwise, it measures the surface and holds it to the promise: CW_ERR_CHECK. */
CW_NODISCARD cw_status cli_extract_streamed(cli_extract_run *run, const cli_moment *moment,
                                            cli_made *made, cli_streamed *surface,
                                            cw_error *err);

/* Harmless on a zeroed one. */
void cli_free_streamed(cli_streamed *surface);

#endif
