/* The lattice and the octree of multi-resolution meshes, and triangles cut at its nodes. */
#ifndef FORMATS_NEUROGLANCER_LOD_GRID_H
#define FORMATS_NEUROGLANCER_LOD_GRID_H

#include "formats/mesh/mesh_writer.h"

/* The lattice of all positions, and the octree of cubes on it. All segments share both, so that
 * neighbours still meet. Along an axis a node has positions 0 to 2^bits - 1, and its last position
 * is the first one of the next node. Level l has steps and nodes of 2^l times the size. */
typedef struct cwi_lod_grid {
    double origin[3]; /* in the file's coordinates, a multiple of the step */
    double step_mm;   /* of level 0: a power of two */
    int bits;
    uint32_t nodes[3]; /* of level 0, along each axis */
} cwi_lod_grid;

/* The maximum distance of the surface of level 0 from the mesh, in steps: a vertex moves by half
 * a step along each axis, and each cut along an axis moves two coordinates of a new vertex. */
#define CWI_LOD_ERROR_STEPS 3.0

/* The maximum number of nodes along an axis: with 16 bits, as fine as single precision. */
enum { CWI_LOD_NODES = 256 };

/* Returns the steps of a node's edge, and the position at which viewers part a node in eight. */
static inline uint32_t cwi_lod_steps(const cwi_lod_grid *grid)
{
    return (1u << grid->bits) - 1;
}

static inline uint32_t cwi_lod_middle(const cwi_lod_grid *grid)
{
    return 1u << (grid->bits - 1);
}

/* Lays the grid around all parts: with a node around all of the coarsest level where the
 * tolerance allows it. level_count: the most levels of a segment.
 * Returns CW_ERR_ARGUMENT for a tolerance beyond single precision; CW_ERR_LIMIT for a box that
 * single precision cannot hold; CW_ERR_CHECK for one without extent */
CW_NODISCARD cw_status cwi_lod_choose(cwi_lod_grid *grid, const cwi_parts *parts,
                                      size_t level_count, const cw_write_desc *desc,
                                      cw_error *err);

/* A triangle within a node, with the node's Morton code; x has the lowest bit. */
typedef struct cwi_lod_piece {
    uint32_t vertex[3], node;
} cwi_lod_piece;

/* A level of a segment. Free it with cwi_lod_free(). */
typedef struct cwi_lod_level {
    uint32_t *positions; /* vertex_count x 3, on the lattice of the level */
    size_t vertex_count, vertex_capacity;
    cwi_lod_piece *pieces; /* in rising order of nodes; no corners coincide */
    size_t piece_count, piece_capacity;
    size_t collapsed; /* triangles of the mesh whose corners coincide on the lattice */
    double move_mm;   /* the largest move of a vertex */
    bool is_cut;
} cwi_lod_level;

/* Rounds a part to the lattice of its level, and cuts its triangles at the nodes' faces; above
 * level 0 at the planes between the eight parts of a node, too. An edge is cut at the same
 * positions for both of its triangles. Returns CW_ERR_NO_MEMORY; CW_ERR_LIMIT for 2^32 vertices */
CW_NODISCARD cw_status cwi_lod_cut(const cwi_lod_grid *grid, const cwi_part *part,
                                   cwi_lod_level *level, cw_error *err);
void cwi_lod_free(cwi_lod_level *level);

/* Leaves out pairs of needles with the same corners that face each other: rounding folds needles
 * flat. A closed mesh stays closed. Sheets with two sides stay, as their triangles are no needles.
 * keys: of the positions that are the vertices.
 * Returns false without memory. */
bool cwi_lod_cancel(cw_mesh *mesh, const uint64_t *keys);

/* Unpacks a Morton code. */
void cwi_lod_node(uint32_t code, uint32_t node[3]);

#endif
