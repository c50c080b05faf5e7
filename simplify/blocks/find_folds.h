/* Folds of the surface that a distance is kept from. */
#ifndef SIMPLIFY_BLOCKS_FIND_FOLDS_H
#define SIMPLIFY_BLOCKS_FIND_FOLDS_H

#include "simplify/blocks/block_passes.h"

/* Sets `folded` for the vertices of the remembered input. */
void cwi_passes_find_folds(cwi_passes *passes);

#endif
