/* Records which triangles of a result each triangle of the input was found near, so that a later
 * proof need not look where nothing has changed. */
#ifndef SIMPLIFY_BLOCKS_PROOF_RECORD_H
#define SIMPLIFY_BLOCKS_PROOF_RECORD_H

#include "simplify/blocks/distance_proof.h"

/* Makes an empty record for `blocks` blocks of the remembered input.
 * Returns CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_proof_record_init(cwi_proof_record *record, const cwi_passes *passes,
                                             size_t blocks, cw_error *err);
void cwi_proof_record_free(cwi_proof_record *record);

/* Forgets what triangles of an input are near. */
void cwi_near_facets_clear(cwi_near_facets *near, size_t count);

/* Adds a facet; with too many of them nothing is known. */
void cwi_near_facets_add(cwi_near_facets *near, uint32_t facet);

/* Takes what the proof of a block found. Threads may do so for several blocks at once.
 * near   one for each of the part's input */
void cwi_proof_record_take(cwi_proof_record *record, const cwi_passes *passes,
                           const cwi_block_part *part, const cwi_near_facets *near,
                           size_t block);

/* Sets 1 for triangles of the input and of the result that need no new proof: what they are near
 * has stayed since the blocks were joined.
 * part         all of the surface; `from` is what was joined */
CW_NODISCARD cw_status cwi_proof_record_compare(const cwi_proof_record *record,
                                                const cwi_block_part *part,
                                                size_t global_id_count, uint8_t *input_known,
                                                uint8_t *left_known, cw_error *err);

#endif
