/* Only what pictures need: a surface simplified for cameras, and the proof that it does. */
#ifndef CLI_EXTRACT_PIXEL_PROOF_H
#define CLI_EXTRACT_PIXEL_PROOF_H

#include "cli/inputs/extract_surface.h"
#include "cli/results/run_report.h"

typedef struct cli_pixel_args {
    const char *camera; /* .json files by comma, or the text of one; NULL: none */
    cli_number pixels, shading;
    cli_sizes size; /* of pictures */
    cli_length most;
    bool cull;
} cli_pixel_args;

/* Reads the cameras. Fails for what is not usable, or would do nothing without a camera.
 * views  CLI_MAX_VIEWS; *count of them are used */
CW_NODISCARD cw_status cli_read_views(const cli_pixel_args *args, cw_simplify_view *views,
                                      size_t *count, cw_error *err);

/* The length of some pixels where they are widest in the volume: the error bound of what is
 * out of sight. */
CW_NODISCARD cw_status cli_widest_error(const cli_volume *volume, const cw_simplify_view *views,
                                        size_t count, double pixels, double *error_mm,
                                        cw_error *err);

/* Extracts the full surface, which is compared with the mesh: distances both ways in pixels of
 * each view, and pictures of both, drawn on the CPU. */
CW_NODISCARD cw_status cli_prove_views(const cli_volume *volume,
                                       const cli_surface_settings *settings,
                                       const cw_mesh *mesh, cli_proof *proof, cw_error *err);

#endif
