/* Normals, scalars, colours and labels of vertices, carried from one mesh to another. */
#ifndef SIMPLIFY_ATTRIBUTE_TRANSFER_H
#define SIMPLIFY_ATTRIBUTE_TRANSFER_H

#include <cubewright/mesh.h>

/* Gives a mesh the normals, scalars, colours and labels of another, of those that it has: each
 * vertex those of the closest point, between corners in proportion, labels of the nearest
 * corner. Both have the same origin. */
CW_NODISCARD cw_status cwi_carry(const cw_mesh *from, int threads, const cw_progress *progress,
                                 cw_mesh *to, cw_error *err);

#endif
