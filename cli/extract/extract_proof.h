/* Checks what was promised of a surface against the full surface, and measures the savings. */
#ifndef CLI_EXTRACT_EXTRACT_PROOF_H
#define CLI_EXTRACT_EXTRACT_PROOF_H

#include "cli/inputs/extract_surface.h"
#include "cli/results/run_report.h"

/* Extracts the full surface, and notes in the proof what it is and costs. Free it with
 * cw_mesh_free(). */
CW_NODISCARD cw_status cli_extract_full(const cli_volume *volume,
                                        const cli_surface_settings *settings, cli_proof *proof,
                                        cw_mesh *full, cw_error *err);

/* Measures how far a mesh is from the full surface, and that from it.
 * Where the mesh was measured from the field, the full surface is, too.
 * Returns   CW_ERR_CHECK when one of the two is farther than the error that was promised, if any was */
CW_NODISCARD cw_status cli_prove_error(const cli_volume *volume,
                                       const cli_surface_settings *settings,
                                       const cw_mesh *mesh, cli_proof *proof,
                                       cli_comparison *compared, cw_error *err);

/* Reads and extracts the whole volume, too: its triangles in the cells that --crop left must be
 * those of the part, one for one, but for the part's caps.
 * Returns   CW_ERR_CHECK when one is not */
CW_NODISCARD cw_status cli_prove_crop(const cli_volume *part, const cli_input *input,
                                      const cw_extract_desc *extract, cli_crop_proof *proof,
                                      cw_error *err);

#endif
