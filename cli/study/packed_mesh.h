/* A mesh as a page holds it: quantised, and small. */
#ifndef CLI_STUDY_PACKED_MESH_H
#define CLI_STUDY_PACKED_MESH_H

#include <cubewright/mesh.h>

/* Maximum of triangles: a page of three such meshes takes a few megabytes. */
enum { CLI_PACKED_TRIANGLES = 200000, CLI_PACKED_STEPS = 65535 };

/* Bytes of a mesh, in this order:
 *
 *   positions  of each vertex x, y, z: the difference from the vertex before (of the first from
 *              0), in steps of 1 / CLI_PACKED_STEPS of the box along that axis
 *   bytes      one for each vertex, if has_bytes: a place on the scale of errors, or a label
 *   triangles  of each its three corners: how far below the lowest number that no corner had
 *              so far; 0 is that number itself. Vertices are numbered as corners name them
 *
 * Differences and corners are integers of 7 bits a byte, the low ones first; the high bit says
 * that another byte follows. Signs are in the lowest bit: 0, -1, 1, -2, ... are 0, 1, 2, 3. */
typedef struct cli_packed {
    char *bytes; /* owned; NULL: none */
    size_t size, vertices, triangles;
    size_t made_of; /* triangles before it was simplified for the page; 0: it was not */
    bool has_bytes;
    double low[3], high[3]; /* the box, in mm of the world */
    char why[128];          /* it is left out; empty: it is not */
} cli_packed;

/* Packs a mesh. Vertices without triangles are left out.
 * values  vertex_count; NULL: none
 * packed  set on success; free it with cli_free_packed(). CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cli_pack_mesh(const cw_mesh *mesh, const uint8_t *values,
                                     cli_packed *packed, cw_error *err);
void cli_free_packed(cli_packed *packed);

#endif
