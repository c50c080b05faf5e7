/* What a caller says of a file's coordinates, held against what the file says, and applied. */
#ifndef FORMATS_VOLUME_FRAME_CLAIM_H
#define FORMATS_VOLUME_FRAME_CLAIM_H

#include <cubewright/formats.h>

/* Turns and scales a volume that was read to LPS millimetres by what its file says. Returns
 * CW_ERR_ARGUMENT where the file says something else, and the rule is to agree. */
CW_NODISCARD cw_status cwi_claim_volume(const cw_claim *claim, cw_volume *volume,
                                        cw_error *err);

/* Puts what is claimed of a mesh file into what it says, before its mesh is turned. A format
 * that fixes its axes (glTF: metres, y up) was turned by its reader: then the mesh is turned
 * here. */
CW_NODISCARD cw_status cwi_claim_mesh(const cw_claim *claim, cw_mesh_file *said, cw_mesh *mesh,
                                      cw_error *err);

#endif
