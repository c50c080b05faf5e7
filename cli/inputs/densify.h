/* Sparse volumes as dense ones, for what is made for those. */
#ifndef CLI_INPUTS_DENSIFY_H
#define CLI_INPUTS_DENSIFY_H

#include <cubewright/volume.h>

/* All voxels of the box around a sparse volume's leaves and tiles; free it with
 * cw_volume_free().
 * max_voxels  of the box
 * Returns     CW_ERR_LIMIT, with the box; CW_ERR_FORMAT for leaves and tiles that leave it;
 *             CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cli_make_dense(const cw_volume *sparse, size_t max_voxels,
                                      cw_volume *dense, cw_error *err);

#endif
