/* Transforms by which files of surfaces state how their coordinates lie in the scanner. */
#ifndef FORMATS_MESH_SCANNER_FRAME_H
#define FORMATS_MESH_SCANNER_FRAME_H

#include "formats/mesh/mesh_reader.h"

/* Applies an affine to the points read so far, before cwi_build_finish(): p becomes m p. A shift alone is
 * added to the mesh's origin, and the points keep their bits. A map that mirrors turns the windings
 * round.
 * m         in the file's axes; within 1e-6 of no turn it is a shift
 * name      of the transform in the file, for metadata->placed, which stays empty where m changes nothing
 * Returns   CW_ERR_FORMAT for numbers that are not finite or a map onto a plane */
CW_NODISCARD cw_status cwi_place_in_scanner(double m[3][4], const char *name,
                                            cwi_mesh_build *build, cw_mesh *mesh,
                                            cw_mesh_file *metadata, cw_error *err);

#endif
