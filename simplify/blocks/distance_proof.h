/* Proof that a part of a surface and what became of it are near each other. */
#ifndef SIMPLIFY_BLOCKS_DISTANCE_PROOF_H
#define SIMPLIFY_BLOCKS_DISTANCE_PROOF_H

#include "simplify/blocks/block_passes.h"

/* A part of the input and what became of it. */
typedef struct cwi_block_part {
    const cwi_mesh_block *from;
    cw_mesh input;              /* a view of it */
    const uint32_t *global_ids; /* of its vertices in all of the input; NULL: their numbers */
    cwi_mesh_block *left;
    float cost; /* how far it went */
    size_t target;
    int threads;
} cwi_block_part;

/* Finds the triangles of both that are farther from the other than allowed, or may be.
 * input_beyond  one for each of the part's input, set to 0 or 1
 * left_beyond   one for each of the part's own triangles that are left
 * near          one for each of the part's input: what it is near; or NULL. What blocks have
 *               recorded of the whole surface is not proved again */
CW_NODISCARD cw_status cwi_block_part_prove(const cwi_passes *passes,
                                            const cwi_block_part *part, uint8_t *input_beyond,
                                            uint8_t *left_beyond, cwi_near_facets *near,
                                            cw_error *err);

#endif
