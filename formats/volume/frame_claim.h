/* A caller's claim on a file's coordinates: compared with the file's statement, and applied. */
#ifndef FORMATS_VOLUME_FRAME_CLAIM_H
#define FORMATS_VOLUME_FRAME_CLAIM_H

#include <cubewright/formats.h>

/* Turns and scales a volume that was read to LPS millimetres by its file's statement. Returns
 * CW_ERR_ARGUMENT where the file contradicts the claim, and the rule is to agree. */
CW_NODISCARD cw_status cwi_claim_volume(const cw_claim *claim, cw_volume *volume,
                                        cw_error *err);

/* Applies the claim to the facts of a mesh file, before its mesh is turned. Formats with fixed
 * axes (glTF: metres, y up) were turned by their reader; then the mesh is turned here. */
CW_NODISCARD cw_status cwi_claim_mesh(const cw_claim *claim, cw_mesh_file *metadata,
                                      cw_mesh *mesh, cw_error *err);

#endif
