/* Passes over blocks that keep a distance: the base of every way to simplify. */
#ifndef SIMPLIFY_BLOCKS_BLOCK_PASSES_H
#define SIMPLIFY_BLOCKS_BLOCK_PASSES_H

#include "core/base/stop.h"
#include "simplify/collapse/openmesh_wrap.h"
#include "simplify/views/view_tolerance.h"

#include <cubewright/simplify.h>

/* Triangles of a block: as few as pay for its seams, as many as a cache holds. */
enum { CWI_BLOCK = 1 << 15 };

/* Facets of a result that a triangle of the input was found near: all of it is near them. A count
 * of 0, or above CWI_NEAR_FACETS: they are not known. */
enum { CWI_NEAR_FACETS = 3 };
typedef struct cwi_near_facets {
    uint32_t count, facets[CWI_NEAR_FACETS];
} cwi_near_facets;

/* These for the whole input, by block. NULL: nothing is recorded. */
typedef struct cwi_proof_record {
    cwi_near_facets *near; /* triangles of the input */
    uint32_t *block_of;    /* triangles of the input: whose facets these are */
    size_t *first_facet;   /* blocks: where their facets begin among those joined */
} cwi_proof_record;

/* State that passes over one surface share. */
typedef struct cwi_passes {
    const cwi_openmesh_functions *openmesh;
    const cw_simplify_desc *desc;
    cwi_stop stop;
    cw_progress poll; /* asks stop, from any thread */
    cwi_block_desc block_desc;
    double error;          /* to keep; 0: none */
    cwi_views views;       /* where it is less */
    cw_mesh input;         /* a view of what the distance is kept from */
    cwi_original original; /* the same; next is NULL without an error to keep */
    uint32_t *first, *around, *across, *next;
    uint8_t *tighten_level, *folded;
    float *allowed;       /* NULL without views */
    float *normals;       /* of what a view sees; NULL where they do not matter */
    uint32_t *saved_next; /* next as it was before the pass */
    size_t repeats;       /* with higher tighten levels */
    bool keeps_record;    /* the blocks' surface is also that of the last pass */
    cwi_proof_record record;
} cwi_passes;

/* Free with cwi_passes_free(), also after an error. They must not move.
 * desc      borrowed; its progress is asked on the thread that calls this
 * Returns   CW_ERR_ARGUMENT for what is out of range; CW_ERR_UNSUPPORTED without OpenMesh */
CW_NODISCARD cw_status cwi_passes_init(cwi_passes *passes, const cw_simplify_desc *desc,
                                       cw_error *err);
void cwi_passes_free(cwi_passes *passes);

/* All places that follow are those meant by desc, less the origin, times so much. */
void cwi_passes_place(cwi_passes *passes, const double origin[3], double scale);

/* Remembers the surface that the error is kept from, at tighten level 0.
 * input     borrowed, with its arrays */
CW_NODISCARD cw_status cwi_passes_remember(cwi_passes *passes, const cw_mesh *input,
                                           cw_error *err);

/* Puts every point of a block that is in no list yet into that of a triangle around it. The
 * block's vertices have the numbers that they have in the input. */
CW_NODISCARD cw_status cwi_passes_list(cwi_passes *passes, cwi_mesh_block *block,
                                       cw_error *err);

/* Simplifies a block in smaller ones, each by itself, and joins them: a seam between them stays
 * as it was. Down to `target` triangles or so; 0: as far as the error allows.
 * whole    vertices have their numbers for names; replaced */
CW_NODISCARD cw_status cwi_passes_blocks(cwi_passes *passes, cwi_mesh_block *whole,
                                         size_t target, cw_error *err);

/* Does so once more, without an error to keep and where that pays: where seams have left far
 * more triangles than the target. These blocks are cut elsewhere, and have most
 * seams inside. */
CW_NODISCARD cw_status cwi_passes_seams(cwi_passes *passes, cwi_mesh_block *whole,
                                        size_t target, cw_error *err);

/* Simplifies all of a block, seams included, down to each of the targets in turn.
 * targets  levels, falling; 0: as far as the error allows
 * left     levels; with an error to keep, one
 */
CW_NODISCARD cw_status cwi_passes_whole(cwi_passes *passes, const cwi_mesh_block *whole,
                                        const size_t *targets, size_t levels,
                                        cwi_mesh_block *left, cw_error *err);

#endif
