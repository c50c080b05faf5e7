/* A picture of pieces before they are written. */
#ifndef CLI_CUT_CUT_PREVIEW_H
#define CLI_CUT_CUT_PREVIEW_H

#include <cubewright/pieces.h>

/* Makes one mesh of pieces pulled apart, each in its colour, with pegs and frames in the planes.
 * pieces  at their places in the whole
 * planes  count of them
 * mesh    set; free it with cw_mesh_free()
 * Returns CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cli_make_cut_preview(const cw_pieces *pieces, const cw_cut_desc *planes,
                                            size_t count, cw_mesh *mesh, cw_error *err);

/* Draws that mesh, and writes a PNG.
 * Returns CW_ERR_NO_MEMORY; or as cw_render_mesh() and cw_image_write() */
CW_NODISCARD cw_status cli_write_cut_preview(const char *path, const cw_pieces *pieces,
                                             const cw_cut_desc *planes, size_t count,
                                             int threads, cw_error *err);

#endif
