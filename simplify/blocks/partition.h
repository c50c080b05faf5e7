/* A mesh cut into blocks, each with a box of space of its own, that are simplified apart. */
#ifndef SIMPLIFY_BLOCKS_PARTITION_H
#define SIMPLIFY_BLOCKS_PARTITION_H

#include "simplify/collapse/openmesh_wrap.h"

#include <cubewright/mesh.h>

void cwi_block_free(cwi_mesh_block *block);

/* All of the block's triangles are its own, and they may be anywhere. */
void cwi_block_span(cwi_mesh_block *block);

/* Own triangles of a block as a mesh. Borrows all. */
cw_mesh cwi_block_view(const cwi_mesh_block *block);

/* Vertices get their numbers for names. */
void cwi_block_number(cwi_mesh_block *block);

/* Puts triangles behind a block's own, in the way: each with vertices of its own, which are
 * held. The block has all arrays of a joined one, and no attributes.
 * points     count x 9: of their corners
 * Returns    CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_block_obstruct(cwi_mesh_block *block, const float *points,
                                          size_t count, cw_error *err);

/* Shares the triangles of a block out to blocks of about `max_triangles` at the most: boxes that fill
 * space, divided where a share of the triangles is below. Triangles that do not lie in
 * one box are held: they stay in one block, and are in the way in the others that they reach.
 * What moves inside one box then never meets what moves inside another.
 *
 * whole      vertices are named by their numbers; triangles behind its own are in the way
 * share      of a box's triangles, about a half: with others of it places are others
 * out        *count blocks; free each, and the array with cwi_free()
 * Returns    CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_blocks_cut(const cwi_mesh_block *whole, size_t max_triangles,
                                      double cut_fraction, cwi_mesh_block **out, size_t *count,
                                      cw_error *err);

/* The blocks' own triangles as one block; held vertices of the same name become one, whose
 * quadric is the sum. `seam` is what was held.
 * id_count  global ids are below it */
CW_NODISCARD cw_status cwi_blocks_join(const cwi_mesh_block *blocks, size_t count,
                                       size_t id_count, cwi_mesh_block *whole, cw_error *err);

#endif
