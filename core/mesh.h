/* Allocating a mesh. */
#ifndef CORE_MESH_H
#define CORE_MESH_H

#include <cubewright/mesh.h>

/* Uninitialised positions, triangles and, if asked, normals. */
CW_API cw_status cwi_mesh_alloc(cw_mesh *mesh, size_t vertices, size_t triangles, bool normals,
                                cw_error *err);

#endif
